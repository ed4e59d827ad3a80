//! Why a network cannot be blended.

/// Why a network of B-splines cannot be blended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlendError {
    /// The parts of the network do not fit together.
    #[error("the network is inconsistent: {what}")]
    Inconsistent {
        /// What does not fit.
        what: String,
    },
    /// A corner has too few or too many segments.
    #[error(
        "{valence} segments meet at corner {corner}; blends exist for 3 to 8: \
         merge segments there, or put a small segment around the corner"
    )]
    Valence {
        /// The corner.
        corner: usize,
        /// Number of segments.
        valence: usize,
    },
    /// An arc has a sample that is not finite.
    #[error("sample {sample} of arc {arc} is not finite")]
    NotFinite {
        /// The arc.
        arc: usize,
        /// The sample.
        sample: usize,
    },
    /// A width is not positive, or not finite.
    #[error("the width {name} = {value} must be positive and finite")]
    Width {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The partials of a surface are so nearly dependent that no metric exists.
    #[error(
        "the surface of segment {segment} is singular at {at:?}: its partials are parallel there; split the segment"
    )]
    Singular {
        /// The segment.
        segment: usize,
        /// The parameter.
        at: [f64; 2],
    },
    /// No width fits on an arc.
    #[error(
        "arc {arc} between corners {} and {} is too short for any blend: it is {length:e} of the diagonal long and would need \
         a width below {limit:e}; merge the segments beside it or move its corners apart",
        corners[0], corners[1]
    )]
    ArcTooShort {
        /// The arc.
        arc: usize,
        /// Its corners.
        corners: [usize; 2],
        /// Its length relative to the diagonal.
        length: f64,
        /// The smallest width tried, relative to the diagonal.
        limit: f64,
    },
    /// A map folds.
    #[error(
        "the map of {place} into segment {segment} folds (smallest Jacobian {jacobian:.3} of its largest); use a smaller width \
         (--d-in, --d-out) or smoother arcs"
    )]
    Fold {
        /// Which strip or N-blend.
        place: String,
        /// The segment.
        segment: usize,
        /// Smallest Jacobian relative to the largest.
        jacobian: f64,
    },
    /// The two sides of a strip lie farther apart than the strip is wide: one of the surfaces is evaluated where it no longer
    /// follows the shape.
    #[error(
        "the surfaces of segments {} and {} are {distance:.1} widths apart in {place}; use a smaller width (--d-in, --d-out) or \
         split these segments", segments[0], segments[1]
    )]
    Apart {
        /// Which strip.
        place: String,
        /// The segments.
        segments: [usize; 2],
        /// Largest distance of points that are blended, in widths.
        distance: f64,
    },
    /// A blend folds though its maps do not.
    #[error(
        "{place} folds (its smallest area is {ratio:.2} of that of the surfaces it blends): these lie too far apart for its width; use \
         a larger width (--d-in, --d-out) or split these segments"
    )]
    Crumpled {
        /// Which strip or N-blend.
        place: String,
        /// Smallest area element relative to those of the blended surfaces; negative where the blend turns over.
        ratio: f64,
    },
    /// The ring of blending regions of a segment crosses itself.
    #[error(
        "the blends around segment {segment} overlap inside it; use a smaller width (--d-in, --d-out) or a segmentation without \
         a neck there"
    )]
    Overlap {
        /// The segment.
        segment: usize,
    },
    /// A map leaves the domain of its B-spline.
    #[error(
        "the map of {place} leaves the domain of the surface of segment {segment} by {overshoot:.3} of its size; use a smaller \
         width or a wider collar"
    )]
    OutsideDomain {
        /// Which strip or N-blend.
        place: String,
        /// The segment.
        segment: usize,
        /// How far it leaves the domain, relative to the domain's size.
        overshoot: f64,
    },
    /// No width makes all maps usable.
    #[error("{first}{}", more(segments.len()))]
    Obstacles {
        /// The first obstacle at the narrowest width.
        first: Box<BlendError>,
        /// The segments into which maps fold, overlap or leave the domain, ascending: splitting them may help.
        segments: Vec<usize>,
        /// The arcs along which that happens, ascending: drawing them differently may help.
        arcs: Vec<usize>,
    },
    /// Patches and seams do not form a surface.
    #[error(transparent)]
    Surface(#[from] suture_surface::SurfaceError),
}

fn more(segments: usize) -> String {
    if segments > 1 { format!(" ({segments} segments have maps that cannot be used)") } else { String::new() }
}

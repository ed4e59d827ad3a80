//! How wide the blends are: by default as wide as wanted where there is room, narrower where an arc is short.

use serde::{Deserialize, Serialize};

use crate::gon;
use crate::{BlendError, CornerMaps, Network};

/// What the blends are for: sets the ratio of the width inside to the width outside a segment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Intent {
    /// 1 : 1. The blend lies where the surfaces lie: reproduces a smooth shape.
    #[default]
    Fidelity,
    /// 2 : 1, the ratio of the paper. The blend averages points on either side of the arc: rounds edges.
    Fillet,
}

/// Widths of the blends; lengths relative to the diagonal of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WidthOptions {
    /// Sets the ratio of `d_in` to `d_out` where they are not given.
    pub intent: Intent,
    /// Width wanted, `d_in + d_out`, where neither is given; narrower at corners of short arcs.
    pub wanted: f64,
    /// Narrowest width to which blends shrink where a map cannot be used. Default 5e-4: below, the curvature of the blends amplifies
    /// rounding and says nothing of the shape.
    pub narrowest: f64,
    /// How far blends reach into a segment: overrides the automatic width everywhere.
    pub d_in: Option<f64>,
    /// How far blends reach out of a segment: overrides the automatic width everywhere.
    pub d_out: Option<f64>,
    /// Shortest strip; the width where it is not given (Section 6.5 of the paper).
    pub d_min: Option<f64>,
    /// Step along the second differences by which points of arcs are moved before they are used (Section 6.5 of the paper: 0.3).
    pub d_curv: f64,
}

impl Default for WidthOptions {
    fn default() -> Self {
        Self {
            intent: Intent::default(),
            wanted: 0.03,
            narrowest: 5e-4,
            d_in: None,
            d_out: None,
            d_min: None,
            d_curv: 0.3,
        }
    }
}

/// Widths resolved for one network, in its units.
#[derive(Clone, Debug, PartialEq)]
pub struct Widths {
    /// Full width `d_in + d_out` at every corner; it varies linearly along an arc.
    pub corner: Vec<f64>,
    /// How often the width of every corner was reduced because a map could not be used.
    pub reductions: Vec<u32>,
    /// Share of `d_in` in the full width.
    pub inner: f64,
    /// Shortest strip on every arc. It does not shrink with the widths: a narrow blend needs no more strips than a wide one to
    /// follow its arc.
    pub shortest: Vec<f64>,
    /// See [`WidthOptions::d_curv`].
    pub d_curv: f64,
}

/// Distance, in widths, between a corner of valence `n` and the line where the strips along its arcs begin, for equal angles
/// and a ratio of 2 : 1, the worst case of the two intents: 23/12 · cot(π/n), that is 1.107, 1.917, 2.638, 3.320 for 3, 4, 5, 6.
pub fn reach(n: usize) -> f64 {
    23.0 / 6.0 * gon::apothem(n)
}

/// How far the blends at a corner of valence `n` extend out of the segments they blend, in widths: the N-gon lies about the corner,
/// the strips half outside.
pub fn outward_reach(n: usize) -> f64 {
    gon::circumradius(n).max(0.5)
}

/// Largest admissible width at every corner from the lengths of its arcs alone, before any map exists: both ends' reach plus one strip
/// of the width's length must fit on every arc. `arcs` holds per arc its two corners and its length; `reach` is that of the maps ([`CornerMaps::reach`]); the
/// result is in the units of the lengths.
pub fn admissible(
    valences: &[usize],
    arcs: &[([usize; 2], f64)],
    wanted: f64,
    reach: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let mut widths = vec![wanted; valences.len()];
    for &([a, b], length) in arcs {
        let limit = length / (reach(valences[a]) + reach(valences[b]) + 1.0);
        for c in [a, b] {
            widths[c] = widths[c].min(limit);
        }
    }
    widths
}

impl Widths {
    /// Resolves the options for a network.
    ///
    /// # Errors
    /// [`BlendError::Width`] when a given width is not positive.
    pub fn resolve(
        network: &Network,
        maps: &dyn CornerMaps,
        options: &WidthOptions,
    ) -> Result<Self, BlendError> {
        for (name, value) in [
            ("wanted", Some(options.wanted)),
            ("narrowest", Some(options.narrowest)),
            ("d_in", options.d_in),
            ("d_out", options.d_out),
            ("d_min", options.d_min),
        ] {
            if let Some(value) = value.filter(|v| !(*v > 0.0 && v.is_finite())) {
                return Err(BlendError::Width { name, value });
            }
        }
        let ratio = match options.intent {
            Intent::Fidelity => 0.5,
            Intent::Fillet => 2.0 / 3.0,
        };
        let (given, inner) = match (options.d_in, options.d_out) {
            (Some(i), Some(o)) => (Some(i + o), i / (i + o)),
            (Some(i), None) => (Some(i / ratio), ratio),
            (None, Some(o)) => (Some(o / (1.0 - ratio)), ratio),
            (None, None) => (None, ratio),
        };
        let valences: Vec<usize> = network.corners.iter().map(|c| c.arcs.len()).collect();
        let corner: Vec<f64> = match given {
            Some(width) => vec![width * network.diagonal; valences.len()],
            None => {
                let arcs: Vec<_> = network
                    .arcs
                    .iter()
                    .map(|a| (a.corners, a.lengths().last().copied().unwrap_or(0.0)))
                    .collect();
                let wanted = options.wanted * network.diagonal;
                let admissible = admissible(&valences, &arcs, wanted, |n| maps.reach(n));
                admissible.into_iter().zip(&network.corners).map(|(w, c)| w.min(c.widest)).collect()
            }
        };
        let shortest = network
            .arcs
            .iter()
            .map(|arc| {
                let mean = 0.5 * (corner[arc.corners[0]] + corner[arc.corners[1]]);
                options.d_min.map_or(mean, |d| d * network.diagonal)
            })
            .collect();
        Ok(Self { reductions: vec![0; corner.len()], corner, inner, shortest, d_curv: options.d_curv })
    }
}

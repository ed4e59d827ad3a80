//! A whole surface of splined patches, and its dial.

use rayon::prelude::*;
use suture_surface::{Continuity, Patch, Seam, Surface};

use super::{LEAST, MOST, SplinePatch};
use crate::{BubbleError, BubbleSurface};

/// How many intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Intervals {
    /// So many along every edge, 4 to 1024.
    Count(usize),
    /// As many, doubled from 4 on, as it takes for the normals to jump by no more than this angle in radians; 1024 at most.
    Angle(f64),
}

/// How data become splines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineOptions {
    /// How many intervals. Default 16.
    pub intervals: Intervals,
    /// Whether the boundary curves stay polynomials of degree `4n + 1`, which makes jumps smaller and bidegrees larger. Default true.
    pub exact_height: bool,
}

impl Default for SplineOptions {
    fn default() -> Self {
        Self { intervals: Intervals::Count(16), exact_height: true }
    }
}

/// Splined patches, one per face.
#[derive(Debug)]
pub struct SplineSurface {
    /// The patches, in the order of faces.
    pub patches: Vec<SplinePatch>,
    /// The seams; of most only positions agree to rounding, so this is claimed.
    pub seams: Vec<Seam>,
    /// Number of intervals.
    pub intervals: usize,
    /// Largest distance across seams, at four samples per interval.
    pub position: f64,
    /// Largest angle of normals across seams other than creases, in radians.
    pub normal: f64,
}

impl SplineSurface {
    /// The surface for tessellation, certificate and pictures.
    ///
    /// # Errors
    /// [`BubbleError::Surface`], which would be a defect of this crate.
    pub fn into_surface(self) -> Result<Surface, BubbleError> {
        let patches = self.patches.into_iter().map(|p| Box::new(p) as Box<dyn Patch>).collect();
        Ok(Surface::new(patches, self.seams)?)
    }
}

/// The spline variant of a surface of order 0, 1 or 2.
///
/// # Errors
/// [`BubbleError::Order`] for higher orders, [`BubbleError::Option`] for a number of intervals or an angle out of range, and for an angle that 1024
/// intervals do not reach.
pub fn spline_surface(
    surface: &BubbleSurface,
    options: &SplineOptions,
) -> Result<SplineSurface, BubbleError> {
    let order = surface.report().order;
    if order > 2 {
        return Err(BubbleError::Order { order, limit: 2 });
    }
    match options.intervals {
        Intervals::Count(k) if (LEAST..=MOST).contains(&k) => Ok(build(surface, k, options.exact_height)),
        Intervals::Count(k) => {
            Err(BubbleError::Option { name: "intervals", value: k as f64, range: "4 to 1024" })
        }
        Intervals::Angle(angle) if angle > 0.0 => {
            let mut k = LEAST;
            loop {
                let made = build(surface, k, options.exact_height);
                if order == 0 || made.normal <= angle {
                    return Ok(made);
                }
                if k == MOST {
                    let range = "an angle that 1024 intervals reach";
                    return Err(BubbleError::Option { name: "angle", value: angle, range });
                }
                k *= 2;
            }
        }
        Intervals::Angle(value) => Err(BubbleError::Option { name: "angle", value, range: "above 0" }),
    }
}

fn build(surface: &BubbleSurface, intervals: usize, exact_height: bool) -> SplineSurface {
    let patches: Vec<SplinePatch> =
        surface.patches().par_iter().map(|p| SplinePatch::new(p, intervals, exact_height)).collect();
    let mut seams = surface.seams().to_vec();
    let jumps: Vec<[f64; 2]> = seams.par_iter().map(|s| jump(&patches, s, intervals)).collect();
    let worst = |i: usize| jumps.iter().map(|j| j[i]).fold(0.0, f64::max);
    let (position, normal) = (worst(0), worst(1));
    seams.iter_mut().for_each(|s| s.claimed = Continuity::C0);
    SplineSurface { patches, seams, intervals, position, normal }
}

/// Largest distance and largest angle across a seam.
fn jump(patches: &[SplinePatch], seam: &Seam, intervals: usize) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    for i in 0..4 * intervals + 1 {
        let t = i as f64 / (4 * intervals) as f64;
        let jet = |e: suture_surface::EdgeRef, t: f64| {
            let patch = &patches[e.patch.0 as usize];
            Some(patch.jet(patch.domain().edge(e.edge as usize)?.point(t)))
        };
        let (Some(a), Some(b)) = (jet(seam.a, t), jet(seam.b, seam.opposite(t))) else { continue };
        worst[0] = worst[0].max(a.p.distance(b.p));
        if let (Some(m), Some(n)) = (a.normal(), b.normal())
            && seam.claimed > Continuity::C0
        {
            // Patches of other orientation, or one that folds, turn the normal.
            worst[1] = worst[1].max(m.cross(n).length().atan2(m.dot(n).abs()));
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BubbleOptions, bubble, bubble_creased, height::tests::quad_and_triangle};
    use glam::DVec2;

    #[test]
    fn nets_are_the_patches_and_have_the_stated_degrees() {
        for (order, exact_height) in (0..3).flat_map(|n| [(n, false), (n, true)]) {
            for tagged in [vec![], vec![[2, 3]]] {
                let options = BubbleOptions { order, ..Default::default() };
                let s = bubble_creased(&quad_and_triangle(), &tagged, &options).unwrap();
                let options = SplineOptions { intervals: Intervals::Count(6), exact_height };
                let splines = spline_surface(&s, &options).unwrap();
                for (patch, triangle) in splines.patches.iter().zip([false, true]) {
                    let net = patch.bspline().unwrap();
                    if !exact_height && tagged.is_empty() {
                        let want = if triangle { [5, 7, 11][order] } else { [4, 4, 6][order] };
                        assert_eq!(net.points.degree(), [want; 2], "{order} {triangle}");
                    }
                    assert_eq!(patch.exact.bent(), !tagged.is_empty());
                    assert_eq!(net.weights.is_some(), triangle);
                    for (u, v) in [(0.2, 0.3), (0.5, 0.0), (0.7, 0.1), (0.0, 0.4), (0.35, 0.65)] {
                        let (a, b) = (patch.jet(DVec2::new(u, v)), net.jet(DVec2::new(u, v)));
                        for (a, b) in [(a.p, b.p), (a.du, b.du), (a.dv, b.dv)] {
                            assert!(a.distance(b) < 1e-10, "{order} {triangle} {u} {v}: {a} {b}");
                        }
                        assert!(a.duv.distance(b.duv) + a.dvv.distance(b.dvv) < 1e-7);
                    }
                }
            }
        }
    }

    #[test]
    fn more_intervals_bring_the_exact_surface() {
        for order in 0..3 {
            let s = bubble(&quad_and_triangle(), &BubbleOptions { order, ..Default::default() }).unwrap();
            let jumps = [8, 32].map(|k| {
                let options = SplineOptions { intervals: Intervals::Count(k), exact_height: true };
                let splines = spline_surface(&s, &options).unwrap();
                // Both sides of a seam sum some hundred products of size one.
                assert!(splines.position < 200.0 * f64::EPSILON, "{}", splines.position);
                splines.normal
            });
            assert!(order == 0 || jumps[0] > 60.0 * jumps[1], "{order} {jumps:?}");
        }
        let s = bubble(&quad_and_triangle(), &BubbleOptions { order: 1, ..Default::default() }).unwrap();
        let options = |intervals| SplineOptions { intervals, exact_height: false };
        let made = spline_surface(&s, &options(Intervals::Angle(1e-6))).unwrap();
        assert!(made.normal <= 1e-6 && made.intervals > 4);
        assert!(spline_surface(&s, &options(Intervals::Count(3))).is_err());
        assert!(spline_surface(&s, &options(Intervals::Angle(-1.0))).is_err());
    }
}

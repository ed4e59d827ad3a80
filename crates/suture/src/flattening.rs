//! The test of merging whether a union of segments can still be flattened: by making its chart.

use glam::DVec2;
use suture_mesh::{Topology, TriMesh};
use suture_param::{Chart, CollarOptions, Disc, Limits, Parameterize, Recommended, disc_with_collar};
use suture_segment::{Flatten, NormalSpread};

/// [`Flatten`] by the chart that the union would get.
///
/// What [`NormalSpread`] refuses is refused without a chart.
#[derive(Clone, Copy, Debug, Default)]
pub struct ByChart<P = Recommended> {
    /// The method of the charts.
    pub parameterize: P,
    /// The estimate that is asked first.
    pub spread: NormalSpread,
}

/// Rings of collar that are flattened with the union, since blends evaluate there too.
const RINGS: usize = 1;
/// Largest quotient of any two area scales: the side of a hole may be a thousandth of a chart that squeezes it by ten thousand.
const SQUEEZED: f64 = 30.0;
/// Shares of the area that have smaller and larger scales than the two that are compared.
const TAIL: f64 = 0.01;

impl<P: Parameterize> Flatten for ByChart<P> {
    fn distortion(&self, mesh: &TriMesh, topology: &Topology, faces: &[u32]) -> Option<f64> {
        self.spread.distortion(mesh, topology, faces)?;
        let collar = CollarOptions { max_rings: RINGS, ..CollarOptions::default() };
        let disc = disc_with_collar(mesh, topology, faces, &collar).ok()?;
        let chart = Chart::flatten(disc, &self.parameterize, &Limits::default()).ok()?;
        let distortion = &chart.distortion;
        let sound = distortion.flips == 0 && distortion.overlaps == 0 && distortion.area_ratio <= SQUEEZED;
        sound.then(|| area_ratio(&chart.disc, &chart.uv))
    }
}

/// Quotient of the 99th and the first percentile, by area, of the area scales.
fn area_ratio(disc: &Disc, uv: &[DVec2]) -> f64 {
    let mut scales: Vec<(f64, f64)> = disc
        .faces
        .iter()
        .map(|f| {
            let [a, b, c] = f.map(|v| disc.positions[v as usize]);
            let [p, q, r] = f.map(|v| uv[v as usize]);
            let area = (b - a).cross(c - a).length();
            ((q - p).perp_dot(r - p) / area, area)
        })
        .filter(|(scale, _)| scale.is_finite())
        .collect();
    scales.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = scales.iter().map(|s| s.1).sum();
    let percentile = |share: f64| {
        let mut sum = 0.0;
        let found = scales.iter().find(|(_, area)| {
            sum += area;
            sum >= share * total
        });
        found.or(scales.last()).map_or(1.0, |s| s.0)
    };
    percentile(1.0 - TAIL) / percentile(TAIL)
}

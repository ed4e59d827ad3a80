//! The test whether a chart can be flattened, as merging asks for it.

use glam::DVec3;
use suture_mesh::{Topology, TriMesh};

/// Tells how badly a chart is distorted when it is flattened.
///
/// Merging asks this for every union that is clearly curved. The best answer comes from the map that the charts will be
/// parameterised with, over the chart and one ring of collar, since blends evaluate there too.
pub trait Flatten {
    /// Ratio of the largest to the smallest area scale (99th and 1st percentile by area) of a flat map of the disc of `faces`
    /// (ascending), at least 1; `None` when the map folds or overlaps itself. It must not depend on anything but its arguments.
    fn distortion(&self, mesh: &TriMesh, topology: &Topology, faces: &[u32]) -> Option<f64>;
}

/// An estimate from the spread of the normals alone, without a map.
///
/// E = 1 − |Σ A n| / Σ A is (1 − cos t)/2 for a spherical cap of half angle t, whose conformal map scales areas by up to
/// (1 − E)⁻². That is the answer for every chart; a chart above the limit counts as not flattenable. It knows nothing of overlaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalSpread {
    /// Largest E. The default 0.6 is a cap of half angle 102°; half a cylinder has 0.363. Merging refuses 0.45 by itself unless an
    /// arc is too short.
    pub limit: f64,
}

impl Default for NormalSpread {
    fn default() -> Self {
        Self { limit: 0.6 }
    }
}

impl NormalSpread {
    /// E = 1 − |Σ A n| / Σ A of some faces: 0 in a plane, 1 where the normals cancel, NaN without area.
    ///
    /// # Panics
    /// When a face does not exist.
    pub fn spread(mesh: &TriMesh, faces: &[u32]) -> f64 {
        let (mut area, mut sum) = (0.0, DVec3::ZERO);
        for &f in faces {
            let a = mesh.area_vector(f as usize);
            area += a.length();
            sum += a;
        }
        1.0 - sum.length() / area
    }
}

impl Flatten for NormalSpread {
    fn distortion(&self, mesh: &TriMesh, _: &Topology, faces: &[u32]) -> Option<f64> {
        let spread = Self::spread(mesh, faces);
        (spread <= self.limit).then(|| (1.0 - spread).powi(-2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cap of half angle `t` of the unit sphere, in rings of latitude.
    fn cap(t: f64) -> TriMesh {
        let (rings, around) = (60, 120);
        let mut positions = vec![DVec3::Z];
        for i in 1..=rings {
            let (s, c) = (t * i as f64 / rings as f64).sin_cos();
            for j in 0..around {
                let (sin, cos) = (std::f64::consts::TAU * j as f64 / around as f64).sin_cos();
                positions.push(DVec3::new(s * cos, s * sin, c));
            }
        }
        let at = |i: u32, j: u32| 1 + (i - 1) * around + j % around;
        let mut faces: Vec<[u32; 3]> = (0..around).map(|j| [0, at(1, j), at(1, j + 1)]).collect();
        for i in 1..rings {
            for j in 0..around {
                faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        TriMesh::new(positions, faces)
    }

    #[test]
    fn a_cap_scales_areas_like_its_stereographic_map() {
        for t in [0.2_f64, 0.7, 1.4] {
            let mesh = cap(t);
            let topology = Topology::build(&mesh).unwrap();
            let faces: Vec<u32> = (0..mesh.faces.len() as u32).collect();
            let ratio = NormalSpread::default().distortion(&mesh, &topology, &faces).unwrap();
            assert!((ratio - (t / 2.0).cos().powi(-4)).abs() < 2e-3, "{t}: {ratio}");
        }
    }

    #[test]
    fn more_than_the_limit_is_refused() {
        let mesh = cap(1.9);
        let topology = Topology::build(&mesh).unwrap();
        let faces: Vec<u32> = (0..mesh.faces.len() as u32).collect();
        assert_eq!(NormalSpread::default().distortion(&mesh, &topology, &faces), None);
        assert_eq!(NormalSpread::default().distortion(&mesh, &topology, &[]), None, "no faces");
    }
}

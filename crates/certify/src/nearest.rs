//! The point of a triangle soup nearest to a point.

use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhLeafCost, BvhNode};
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::Triangle;

use crate::CertifyError;

/// Triangles in a tree of boxes, moved and scaled so that the units of the input do not matter to it.
pub(crate) struct Nearest {
    centre: DVec3,
    scale: f64,
    /// The triangles of positive area, scaled, and their numbers in the input.
    triangles: Vec<(Triangle, u32)>,
    tree: Bvh,
}

/// A point of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) triangle: u32,
    pub(crate) barycentric: [f64; 3],
    /// Distance in the unit `scale` of the tree.
    pub(crate) distance: f64,
}

impl BvhLeafCost for Hit {
    fn cost(&self) -> f64 {
        self.distance
    }
}

impl Nearest {
    /// A tree over triangles of valid indices and finite corners; `centre` and `scale` map to the unit in which it measures.
    pub(crate) fn new(
        of: &'static str,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        centre: DVec3,
        scale: f64,
    ) -> Result<Self, CertifyError> {
        let place = |v: u32| (positions[v as usize] - centre) / scale;
        let solid: Vec<(Triangle, u32)> = (0u32..)
            .zip(triangles)
            .map(|(i, t)| (Triangle::new(place(t[0]), place(t[1]), place(t[2])), i))
            .filter(|(t, _)| has_area(t))
            .collect();
        if solid.is_empty() {
            return Err(CertifyError::NoArea { of });
        }
        let boxes: Vec<Aabb> = solid.iter().map(|(t, _)| t.local_aabb()).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::default(), &boxes);
        Ok(Self { centre, scale, triangles: solid, tree })
    }

    /// The nearest point; `None` only if `p` is not finite.
    pub(crate) fn find(&self, p: DVec3) -> Option<Hit> {
        let q = (p - self.centre) / self.scale;
        if !q.is_finite() {
            return None;
        }
        let reach = |node: &BvhNode, _| {
            let (lo, hi) = (node.mins(), node.maxs());
            (lo - q).max(q - hi).max(DVec3::ZERO).length()
        };
        let leaf = |i: u32, _| self.project(i, q);
        self.tree.find_best(f64::MAX, reach, leaf).map(|(_, hit)| hit)
    }

    fn project(&self, i: u32, q: DVec3) -> Option<Hit> {
        let (triangle, number) = self.triangles.get(i as usize)?;
        let (projection, place) = triangle.project_local_point_and_get_location(q, false);
        let barycentric = place.barycentric_coordinates()?;
        Some(Hit { triangle: *number, barycentric, distance: projection.point.distance(q) })
    }
}

/// Whether rounding cannot explain the area of a triangle. Needles are left out: their edges belong to neighbours as well.
fn has_area(t: &Triangle) -> bool {
    let (ab, ac, bc) = (t.b - t.a, t.c - t.a, t.c - t.b);
    let longest = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    ab.cross(ac).length() > 16.0 * f64::EPSILON * longest
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Distance to a triangle by plane and edges, unlike the library's walk through Voronoi regions.
    fn brute(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
        let n = (b - a).cross(c - a);
        let inside = [(a, b), (b, c), (c, a)].iter().all(|(x, y)| n.dot((*y - *x).cross(p - *x)) >= 0.0);
        let edge = |x: DVec3, y: DVec3| {
            let s = ((p - x).dot(y - x) / (y - x).length_squared()).clamp(0.0, 1.0);
            p.distance(x + (y - x) * s)
        };
        let edges = edge(a, b).min(edge(b, c)).min(edge(c, a));
        if inside { edges.min((p - a).dot(n.normalize()).abs()) } else { edges }
    }

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from)
    }

    proptest! {
        #[test]
        fn the_tree_agrees_with_brute_force(
            corners in prop::collection::vec(point(), 3..90),
            queries in prop::collection::vec(point(), 1..20),
            power in -20..20i32,
        ) {
            let scale = 2f64.powi(power);
            let positions: Vec<DVec3> = corners.iter().map(|p| *p * scale).collect();
            let triangles: Vec<[u32; 3]> = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let tree = Nearest::new("mesh", &positions, &triangles, DVec3::ZERO, scale).unwrap();
            for q in queries {
                let hit = tree.find(q * scale).unwrap();
                let want = triangles.iter().map(|t| brute(q, t.map(|v| corners[v as usize]))).fold(f64::MAX, f64::min);
                prop_assert!((hit.distance - want).abs() < 1e-12, "{} {want}", hit.distance);
                let [a, b, c] = triangles[hit.triangle as usize].map(|v| corners[v as usize]);
                let [r, s, t] = hit.barycentric;
                prop_assert!(((a * r + b * s + c * t).distance(q) - want).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn degenerate_and_repeated_triangles_are_survived() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 2.0];
        let mut triangles = vec![[0, 1, 2]; 1000];
        triangles.extend([[0, 0, 0], [0, 1, 3], [2, 2, 1]]);
        let tree = Nearest::new("mesh", &positions, &triangles, DVec3::ZERO, 1.0).unwrap();
        assert_eq!(tree.find(DVec3::new(0.2, 0.2, 3.0)).unwrap().distance, 3.0);
        assert!(tree.find(DVec3::splat(f64::NAN)).is_none());
        let none = Nearest::new("mesh", &positions, &triangles[1000..], DVec3::ZERO, 1.0);
        assert!(matches!(none, Err(CertifyError::NoArea { of: "mesh" })));
    }
}

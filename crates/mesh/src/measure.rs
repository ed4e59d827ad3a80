//! Lengths, angles and normals of a mesh.

use glam::DVec3;

use crate::{Topology, TriMesh};

/// Unit normals of all vertices: the area vectors of the faces around each, summed and normalised; zero where no face with area
/// meets the vertex or where they cancel.
///
/// Faces that name missing vertices are skipped. The sum runs in the order of faces, which alone decides its bits.
/// For vertices between faces of very different size, weights by angle follow the surface better.
///
/// # References
/// H. Gouraud, *Continuous shading of curved surfaces*, 1971.
pub fn vertex_normals_area_weighted(mesh: &TriMesh) -> Vec<DVec3> {
    let scale = positive(mesh.diagonal());
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for &face in &mesh.faces {
        let Some(corners) = corners(mesh, face) else { continue };
        let n = cross(corners, scale);
        for v in face {
            sums[v as usize] += n;
        }
    }
    sums.iter().map(|&n| unit(n).unwrap_or_default()).collect()
}

/// Angle between the normals of the two faces at half-edge `h`, in `[−π, π]`: 0 where they are coplanar, positive where the edge is
/// convex (a ridge seen from outside), negative in a valley. `None` on the boundary and where a face has no area.
///
/// # Panics
/// When `h` does not exist or `topology` is not that of `mesh`.
pub fn dihedral_angle(topology: &Topology, mesh: &TriMesh, h: u32) -> Option<f64> {
    let o = topology.opposite(h)?;
    let [p, q] = [h, o].map(|h| {
        let c = corners(mesh, mesh.faces[topology.face(h) as usize])?;
        unit(cross(c, positive(longest_edge(c))))
    });
    let (p, q) = (p?, q?);
    let along = unit(mesh.positions[topology.head(h) as usize] - mesh.positions[topology.tail(h) as usize])?;
    // The sine and the cosine: either alone loses half the digits near 0 or π/2.
    Some(p.cross(q).dot(along).atan2(p.dot(q)))
}

/// Median length of the edges, each counted once; the mean of the two middle ones where their number is even. 0 without edges.
/// Faces that name missing vertices and edges that are not finite are left out.
pub fn median_edge_length(mesh: &TriMesh) -> f64 {
    let mut edges = Vec::with_capacity(3 * mesh.faces.len());
    for &face in &mesh.faces {
        if corners(mesh, face).is_some() {
            edges.extend((0..3).map(|k| (face[k], face[(k + 1) % 3])).map(|(a, b)| (a.min(b), a.max(b))));
        }
    }
    edges.sort_unstable();
    edges.dedup();
    let of = |&(a, b): &(u32, u32)| length(mesh.positions[a as usize] - mesh.positions[b as usize]);
    let mut lengths: Vec<f64> =
        edges.iter().filter(|e| e.0 != e.1).map(of).filter(|l| l.is_finite()).collect();
    median(&mut lengths)
}

fn median(values: &mut [f64]) -> f64 {
    let n = values.len();
    if n == 0 {
        return 0.0;
    }
    let (below, &mut upper, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    if n % 2 == 1 {
        return upper;
    }
    let lower = below.iter().copied().max_by(f64::total_cmp).unwrap_or(upper);
    0.5 * lower + 0.5 * upper
}

/// The corners of a face; `None` where it names a missing vertex.
pub(crate) fn corners(mesh: &TriMesh, face: [u32; 3]) -> Option<[DVec3; 3]> {
    let p = |v: u32| mesh.positions.get(v as usize).copied();
    Some([p(face[0])?, p(face[1])?, p(face[2])?])
}

/// Length of the longest edge.
pub(crate) fn longest_edge([a, b, c]: [DVec3; 3]) -> f64 {
    length(b - a).max(length(c - b)).max(length(a - c))
}

/// The length of `v`, also where its square overflows or vanishes.
pub(crate) fn length(v: DVec3) -> f64 {
    // A power of two, so that the result differs from `v.length()` only where that fails.
    let s = power_of_two_below(v.abs().max_element());
    (v / s).length() * s
}

/// The largest power of two not above `x`; the smallest normal one for what is below it, the largest for infinity.
pub(crate) fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.clamp(f64::MIN_POSITIVE, f64::MAX).to_bits() & !((1 << 52) - 1))
}

/// Twice the area vector, in units of `scale²`.
pub(crate) fn cross([a, b, c]: [DVec3; 3], scale: f64) -> DVec3 {
    ((b - a) / scale).cross((c - a) / scale)
}

/// The direction of `v`, also where its square overflows or vanishes; `None` for zero and for what is not finite.
pub(crate) fn unit(v: DVec3) -> Option<DVec3> {
    let s = v.abs().max_element();
    (s > 0.0 && s.is_finite()).then(|| (v / s).normalize()).filter(|u| u.is_finite())
}

/// `x` as a divisor: 1 where it is zero or not finite.
pub(crate) fn positive(x: f64) -> f64 {
    if x > 0.0 && x.is_finite() { x } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn normals_of_a_sphere_point_outwards_at_any_size() {
        for scale in [1.0, 2f64.powi(300), 2f64.powi(-300)] {
            let mut mesh = shapes::sphere(3);
            for p in &mut mesh.positions {
                *p *= scale;
            }
            for (p, n) in mesh.positions.iter().zip(vertex_normals_area_weighted(&mesh)) {
                assert!(n.dot(*p / scale) > 0.999);
            }
        }
    }

    #[test]
    fn a_box_has_right_angles_on_its_ridges_and_flat_diagonals() {
        let mesh = shapes::cuboid(DVec3::new(1.0, 2.0, 3.0), 2);
        let topology = Topology::build(&mesh).unwrap();
        let mut ridges = 0.0;
        for h in 0..topology.half_edge_count() as u32 {
            let angle = dihedral_angle(&topology, &mesh, h).unwrap();
            if angle > 1.0 {
                assert!((angle - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
                let d = mesh.positions[topology.head(h) as usize] - mesh.positions[topology.tail(h) as usize];
                ridges += d.length();
            } else {
                assert!(angle.abs() < 1e-15);
            }
        }
        assert!((ridges - 2.0 * 4.0 * 6.0).abs() < 1e-12);
    }

    #[test]
    fn valleys_are_negative() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, 1.0, 1.0), DVec3::new(0.0, -1.0, 1.0)];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [1, 0, 3]]);
        let topology = Topology::build(&mesh).unwrap();
        let angle = dihedral_angle(&topology, &mesh, 0).unwrap();
        assert!((angle + std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert_eq!(dihedral_angle(&topology, &mesh, 1), None);
    }

    #[test]
    fn the_median_counts_every_edge_once() {
        let mesh = TriMesh::new(
            vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)],
            vec![[0, 1, 2], [2, 1, 3], [0, 9, 1]],
        );
        assert_eq!(median_edge_length(&mesh), 1.0);
        assert_eq!(median_edge_length(&TriMesh::default()), 0.0);
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
    }
}

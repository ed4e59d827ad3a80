//! Every defect of a mesh, with its place.

use std::collections::HashMap;

use glam::DVec3;

use crate::{
    TriMesh,
    edges::{Orientation, Sets, Side, face_components, orientation, same_edge, sides, usable_faces},
    loops::boundary_loops,
    measure::{self, corners, cross, length, longest_edge, positive},
    report::{
        BadIndex, CoincidentVertex, Component, DuplicateFace, MeshReport, MisorientedEdge, NonManifoldEdge,
    },
    weld_key,
};

/// Examines a mesh. Never fails, whatever the mesh; takes O(n log n).
///
/// A face counts as without area where its height over its longest edge is at most `1e-12` of that edge, or at most four rounding
/// errors of its largest coordinate: less cannot be told from zero. Self-intersections are not looked for.
pub fn check(mesh: &TriMesh) -> MeshReport {
    let mut report = MeshReport {
        vertices: mesh.positions.len(),
        faces: mesh.faces.len(),
        median_edge_length: measure::median_edge_length(mesh),
        ..MeshReport::default()
    };
    let usable = usable_faces(mesh);
    vertices(mesh, &usable, &mut report);
    faces(mesh, &usable, &mut report);
    let sides = sides(mesh, &usable);
    let orientation = orientation(mesh.faces.len(), &sides);
    edges(&sides, &mut report);
    let pinched = pinched_vertices(mesh, &usable, &sides);
    report.non_manifold_vertices.extend(pinched.iter().copied());
    components(mesh, &usable, &sides, &orientation, &pinched, &mut report);
    report
}

fn vertices(mesh: &TriMesh, usable: &[bool], report: &mut MeshReport) {
    let mut used = vec![false; mesh.positions.len()];
    for face in mesh.faces.iter().zip(usable).filter(|(_, u)| **u).map(|(face, _)| face) {
        face.iter().for_each(|&v| used[v as usize] = true);
    }
    let mut known = HashMap::with_capacity(mesh.positions.len());
    let mut bounds: Option<[DVec3; 2]> = None;
    for (v, &p) in mesh.positions.iter().enumerate() {
        let vertex = v as u32;
        if !used[v] {
            report.isolated.push(vertex);
        }
        if !p.is_finite() {
            report.non_finite.push(vertex);
            continue;
        }
        let of = *known.entry(weld_key(p)).or_insert(vertex);
        if of != vertex {
            report.coincident.push(CoincidentVertex { vertex, of });
        }
        if used[v] {
            let [lo, hi] = bounds.unwrap_or([p; 2]);
            bounds = Some([lo.min(p), hi.max(p)]);
        }
    }
    report.diagonal = bounds.map_or(0.0, |[lo, hi]| length(hi - lo));
}

fn faces(mesh: &TriMesh, usable: &[bool], report: &mut MeshReport) {
    let mut known: HashMap<[u32; 3], usize> = HashMap::with_capacity(mesh.faces.len());
    for (f, &face) in mesh.faces.iter().enumerate() {
        let Some(corners) = corners(mesh, face) else {
            let missing = face.into_iter().find(|&v| v as usize >= mesh.positions.len());
            report.bad_indices.extend(missing.map(|vertex| BadIndex { face: f, vertex }));
            continue;
        };
        if !usable[f] {
            report.repeated_vertices.push(f);
            continue;
        }
        if is_flat(corners) {
            report.zero_area.push(f);
        }
        let mut key = face;
        key.sort_unstable();
        let of = *known.entry(key).or_insert(f);
        if of != f {
            let reversed = is_even(face, key) != is_even(mesh.faces[of], key);
            report.duplicate_faces.push(DuplicateFace { face: f, of, reversed });
        }
    }
}

/// Whether `face` is a rotation of `sorted`.
fn is_even([a, b, c]: [u32; 3], sorted: [u32; 3]) -> bool {
    [[a, b, c], [b, c, a], [c, a, b]].contains(&sorted)
}

fn is_flat(corners: [DVec3; 3]) -> bool {
    let longest = longest_edge(corners);
    let largest = corners.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    // Twice the area over the longest edge is the height; both sides in units of that edge.
    let height = cross(corners, positive(longest)).length();
    longest == 0.0 || height <= (4.0 * f64::EPSILON * (largest / longest)).max(1e-12)
}

fn edges(sides: &[Side], report: &mut MeshReport) {
    report.closed = !sides.is_empty();
    for edge in sides.chunk_by(same_edge) {
        report.edges += 1;
        let ends = [edge[0].low, edge[0].high];
        match edge {
            [_] => report.closed = false,
            [a, b] if a.forward == b.forward => {
                report.misoriented.push(MisorientedEdge { edge: ends, faces: [a.face(), b.face()] });
            }
            [_, _] => {}
            many => report.non_manifold_edges.push(NonManifoldEdge { edge: ends, faces: many.len() }),
        }
    }
    report.oriented = report.misoriented.is_empty() && report.non_manifold_edges.is_empty();
}

/// Vertices whose faces form more than one fan, ascending. Faces that share an edge at the vertex, however many, are of one fan: a
/// non-manifold edge is a defect of its own, not one of its ends.
fn pinched_vertices(mesh: &TriMesh, usable: &[bool], sides: &[Side]) -> Vec<u32> {
    // One element per corner of a face.
    let mut sets = Sets::new(3 * mesh.faces.len());
    let corner = |face: usize, v: u32| {
        let k = mesh.faces[face].iter().position(|&w| w == v).unwrap_or(0);
        (3 * face + k) as u32
    };
    for edge in sides.chunk_by(same_edge) {
        for pair in edge.windows(2) {
            for v in [pair[0].low, pair[0].high] {
                sets.union(corner(pair[0].face(), v), corner(pair[1].face(), v));
            }
        }
    }
    let mut fan = vec![None; mesh.positions.len()];
    let mut pinched = Vec::new();
    for (f, face) in mesh.faces.iter().enumerate().filter(|&(f, _)| usable[f]) {
        for (k, &v) in face.iter().enumerate() {
            let root = sets.find((3 * f + k) as u32);
            if *fan[v as usize].get_or_insert(root) != root {
                pinched.push(v);
            }
        }
    }
    pinched.sort_unstable();
    pinched.dedup();
    pinched
}

fn components(
    mesh: &TriMesh,
    usable: &[bool],
    sides: &[Side],
    orientation: &Orientation,
    pinched: &[u32],
    report: &mut MeshReport,
) {
    let (label, count) = face_components(mesh, usable);
    let blank = Component {
        first_face: usize::MAX,
        vertices: 0,
        edges: 0,
        faces: 0,
        boundary_loops: 0,
        euler_characteristic: 0,
        manifold: true,
        orientable: true,
        closed: true,
        genus: None,
        volume: None,
    };
    let mut list = vec![blank; count];
    let mut home = vec![None; mesh.positions.len()];
    for (f, face) in mesh.faces.iter().enumerate() {
        let Some(c) = label[f] else { continue };
        list[c].faces += 1;
        list[c].first_face = list[c].first_face.min(f);
        for &v in face {
            if home[v as usize].replace(c).is_none() {
                list[c].vertices += 1;
            }
        }
    }
    let mut oriented = vec![true; count];
    for edge in sides.chunk_by(same_edge) {
        let Some(c) = label[edge[0].face()] else { continue };
        list[c].edges += 1;
        list[c].closed &= edge.len() > 1;
        list[c].manifold &= edge.len() <= 2;
        oriented[c] &= matches!(edge, [a, b] if a.forward != b.forward);
    }
    for &v in pinched {
        if let Some(c) = home[v as usize] {
            list[c].manifold = false;
        }
    }
    for &f in &orientation.contradictory {
        if let Some(c) = label[f as usize] {
            list[c].orientable = false;
        }
    }
    for boundary in boundary_loops(mesh, sides) {
        if let Some(c) = boundary.vertices.first().and_then(|&v| home[v as usize]) {
            list[c].boundary_loops += 1;
        }
        report.boundary_loops.push(boundary);
    }
    let volumes = volumes(mesh, &label, count, positive(report.diagonal));
    for (c, component) in list.iter_mut().enumerate() {
        let (v, e, f) = (component.vertices as i64, component.edges as i64, component.faces as i64);
        component.euler_characteristic = v - e + f;
        let handles = 2 - component.boundary_loops as i64 - component.euler_characteristic;
        if component.manifold && component.orientable {
            component.genus = usize::try_from(handles / 2).ok();
        }
        if component.closed && oriented[c] {
            let (volume, area) = volumes[c];
            component.volume = Some(volume * report.diagonal.powi(3));
            // Flat components enclose nothing but rounding errors.
            report.inside_out += usize::from(volume < -1e-12 * area);
        }
    }
    report.euler_characteristic = list.iter().map(|c| c.euler_characteristic).sum();
    report.genus = list.iter().map(|c| c.genus).sum::<Option<usize>>().filter(|_| count > 0);
    // Not `sum`, whose zero is −0.
    report.volume = list.iter().filter_map(|c| c.volume).fold(0.0, |sum, v| sum + v);
    report.manifold = count > 0 && list.iter().all(|c| c.manifold);
    report.orientable = list.iter().all(|c| c.orientable);
    report.non_orientable.extend(list.iter().filter(|c| !c.orientable).map(|c| c.first_face));
    report.components.extend(list);
}

/// Signed volume and area of every component, in units of `scale`.
fn volumes(mesh: &TriMesh, label: &[Option<usize>], count: usize, scale: f64) -> Vec<(f64, f64)> {
    // From a point of the component: from the origin, a part far away would drown in rounding errors.
    let mut origin = vec![None; count];
    let mut sums = vec![(0.0, 0.0); count];
    for (f, &face) in mesh.faces.iter().enumerate() {
        let (Some(c), Some(p)) = (label[f], corners(mesh, face)) else { continue };
        let o = *origin[c].get_or_insert(p[0]);
        let n = cross(p, scale);
        sums[c].0 += n.dot((p[0] - o) / scale) / 6.0;
        sums[c].1 += 0.5 * n.length();
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    #[test]
    fn an_empty_mesh_has_no_defects_and_is_not_sound() {
        let report = check(&TriMesh::default());
        assert!(
            report.defects().is_empty() && !report.is_sound() && !report.closed && report.genus.is_none()
        );
    }

    #[test]
    fn anything_at_all_is_survived() {
        let mut mesh = shapes::sphere(1);
        mesh.positions[3].x = f64::NAN;
        mesh.positions[5].y = 1e308;
        mesh.positions[6].y = -1e308;
        mesh.faces.extend([[0, 0, 0], [1, 1, 2], [u32::MAX, 0, 1], [0, 1, 4]]);
        mesh.faces.extend_from_within(..3);
        let report = check(&mesh);
        assert_eq!(report.non_finite.first, [3]);
        assert_eq!(report.bad_indices.first, [BadIndex { face: 82, vertex: u32::MAX }]);
        assert_eq!(report.repeated_vertices.first, [80, 81]);
        assert_eq!(report.duplicate_faces.total, 3);
    }

    #[test]
    fn lists_are_bounded_and_totals_are_not() {
        let report = check(&TriMesh::new(vec![DVec3::ZERO; 5000], Vec::new()));
        assert_eq!((report.isolated.total, report.isolated.first.len()), (5000, MeshReport::LIST_LIMIT));
        assert_eq!(report.coincident.total, 4999);
    }

    #[test]
    fn volume_has_a_sign_even_far_from_the_origin() {
        let mut mesh = shapes::cuboid(DVec3::ONE, 2);
        for p in &mut mesh.positions {
            *p += DVec3::splat(1e6);
        }
        let report = check(&mesh);
        assert!((report.volume - 1.0).abs() < 1e-12 && report.inside_out == 0);
        mesh.faces.iter_mut().for_each(|f| f.swap(0, 1));
        let report = check(&mesh);
        assert!((report.volume + 1.0).abs() < 1e-12 && report.inside_out == 1);
    }

    /// Powers of two change no verdict, nor does the order of vertices and faces.
    #[test]
    fn verdicts_do_not_depend_on_units_or_order() {
        let mut mesh = shapes::torus(1.0, 0.3, 9, 7);
        mesh.faces.truncate(100);
        mesh.positions.push(DVec3::new(0.25, 0.5, 0.0));
        mesh.positions.push(DVec3::new(0.75, 1.5, 0.0));
        mesh.faces.push([63, 64, 3]);
        let report = check(&mesh);
        for k in [-600, -20, 20, 300] {
            let mut scaled = mesh.clone();
            scaled.positions.iter_mut().for_each(|p| *p *= 2f64.powi(k));
            let mut other = check(&scaled);
            assert_eq!(other.diagonal, report.diagonal * 2f64.powi(k));
            (other.diagonal, other.median_edge_length) = (report.diagonal, report.median_edge_length);
            assert_eq!(other.defects(), report.defects());
        }
        let n = mesh.positions.len() as u32;
        mesh.positions.reverse();
        mesh.faces.reverse();
        mesh.faces.iter_mut().flatten().for_each(|v| *v = n - 1 - *v);
        let other = check(&mesh);
        assert_eq!(
            (other.edges, other.euler_characteristic, other.boundary_loops.total, other.genus),
            (report.edges, report.euler_characteristic, report.boundary_loops.total, report.genus)
        );
    }
}

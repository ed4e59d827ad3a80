//! Repairs that lose nothing one could want to keep, each on request, each telling what it did.
//!
//! A sensible order: [`weld_coincident`], [`drop_degenerate_faces`], [`drop_duplicate_faces`], [`drop_isolated_vertices`], [`orient`].
//! What is not repaired: holes, non-manifold edges and vertices, self-intersections, slivers.

use std::collections::HashMap;

use glam::DVec3;

use crate::{
    MeshError, TriMesh,
    edges::{orientation, same_edge, sides, usable_faces},
    io::mean_normal,
    measure::{corners, cross, positive},
    weld_key,
};

/// What welding did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Welded {
    /// Number of vertices that were merged into another one.
    pub merged: usize,
    /// For every old vertex its new index.
    pub new_index: Vec<u32>,
    /// Faces that now name one vertex twice; [`drop_degenerate_faces`] removes them.
    pub collapsed_faces: Vec<usize>,
}

/// What orienting did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Oriented {
    /// The faces that were reversed.
    pub flipped: Vec<usize>,
    /// First faces of the parts that cannot be oriented and were left alone.
    pub non_orientable: Vec<usize>,
}

/// Merges vertices at exactly the same position (−0 is 0) into the first of them. Vertices that are not finite are left alone.
/// Where merged normals differ, their mean direction is taken.
pub fn weld_coincident(mesh: &mut TriMesh) -> Welded {
    let mut known = HashMap::with_capacity(mesh.positions.len());
    let target: Vec<u32> = (0u32..)
        .zip(&mesh.positions)
        .map(|(v, &p)| if p.is_finite() { *known.entry(weld_key(p)).or_insert(v) } else { v })
        .collect();
    merge(mesh, &target)
}

/// Merges every vertex into the nearest earlier one that stays and is at most `tolerance` times the diagonal away. A vertex that
/// stays keeps its place, and no vertex moves farther than the tolerance. 0 welds exactly.
///
/// # Errors
/// [`MeshError::Tolerance`] outside `[0, 1)`.
pub fn weld_within(mesh: &mut TriMesh, tolerance: f64) -> Result<Welded, MeshError> {
    if !(0.0..1.0).contains(&tolerance) {
        return Err(MeshError::Tolerance { value: tolerance });
    }
    let reach = tolerance * mesh.diagonal();
    if !(reach > 0.0 && reach.is_finite()) {
        return Ok(weld_coincident(mesh));
    }
    // Vertices that stay, by cells of the size of the reach: those of one cell and its neighbours are few, for they keep their
    // distance. Whole numbers as floats: far-away vertices cannot overflow them.
    let mut cells: HashMap<[u64; 3], Vec<u32>> = HashMap::new();
    let mut target = Vec::with_capacity(mesh.positions.len());
    for (v, &p) in (0u32..).zip(&mesh.positions) {
        if !p.is_finite() {
            target.push(v);
            continue;
        }
        let cell = (p / reach).floor();
        let mut nearest: Option<(f64, u32)> = None;
        for d in 0..27 {
            let neighbour = DVec3::from([d % 3, d / 3 % 3, d / 9].map(|d| f64::from(d - 1)));
            for &w in cells.get(&weld_key(cell + neighbour)).into_iter().flatten() {
                let distance = ((mesh.positions[w as usize] - p) / reach).length();
                if distance <= 1.0 && nearest.is_none_or(|n| (distance, w) < n) {
                    nearest = Some((distance, w));
                }
            }
        }
        match nearest {
            Some((_, w)) => target.push(w),
            None => {
                cells.entry(weld_key(cell)).or_default().push(v);
                target.push(v);
            }
        }
    }
    Ok(merge(mesh, &target))
}

/// Renumbers so that vertex `v` becomes `target[v] ≤ v`, which is its own target.
fn merge(mesh: &mut TriMesh, target: &[u32]) -> Welded {
    let mut new_index = Vec::with_capacity(target.len());
    let mut stay = 0;
    for (v, &t) in (0u32..).zip(target) {
        if t == v {
            new_index.push(stay);
            stay += 1;
        } else {
            new_index.push(new_index[t as usize]);
        }
    }
    let merged = target.len() - stay as usize;
    let mut collapsed_faces = Vec::new();
    if merged > 0 {
        let was_usable = usable_faces(mesh);
        merge_normals(mesh, target);
        keep_vertices(mesh, |v| target[v] == v as u32);
        for face in &mut mesh.faces {
            *face = face.map(|v| new_index.get(v as usize).copied().unwrap_or(v));
        }
        let usable = usable_faces(mesh);
        collapsed_faces = (0..usable.len()).filter(|&f| was_usable[f] && !usable[f]).collect();
    }
    Welded { merged, new_index, collapsed_faces }
}

fn merge_normals(mesh: &mut TriMesh, target: &[u32]) {
    let Some(normals) = mesh.normals.as_mut().filter(|n| n.len() == target.len()) else { return };
    let mut groups: Vec<(u32, u32)> = target.iter().copied().zip(0..).collect();
    groups.sort_unstable();
    for group in groups.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
        let members: Vec<DVec3> = group.iter().map(|&(_, v)| normals[v as usize]).collect();
        normals[group[0].0 as usize] = mean_normal(&members).unwrap_or_default();
    }
}

/// Removes vertices and their normals, without renumbering faces.
fn keep_vertices(mesh: &mut TriMesh, keep: impl Fn(usize) -> bool) {
    let vertices = mesh.positions.len();
    let filter = |list: &mut Vec<DVec3>| {
        let mut v = 0;
        list.retain(|_| {
            v += 1;
            keep(v - 1)
        });
    };
    filter(&mut mesh.positions);
    if let Some(normals) = mesh.normals.as_mut().filter(|n| n.len() == vertices) {
        filter(normals);
    }
}

/// Removes the faces of `drop` (ascending).
fn drop_faces(mesh: &mut TriMesh, drop: &[usize]) {
    let (mut f, mut next) = (0, 0);
    mesh.faces.retain(|_| {
        let gone = drop.get(next) == Some(&f);
        next += usize::from(gone);
        f += 1;
        !gone
    });
}

/// Removes the faces that name one vertex twice or a vertex that does not exist, and returns their indices. Faces with three
/// different vertices stay, even without area: removing them would open a hole.
pub fn drop_degenerate_faces(mesh: &mut TriMesh) -> Vec<usize> {
    let usable = usable_faces(mesh);
    let drop: Vec<usize> = (0..usable.len()).filter(|&f| !usable[f]).collect();
    drop_faces(mesh, &drop);
    drop
}

/// Removes the faces with the vertices of an earlier face, in either orientation, and returns their indices.
pub fn drop_duplicate_faces(mesh: &mut TriMesh) -> Vec<usize> {
    let mut known = HashMap::with_capacity(mesh.faces.len());
    let mut drop = Vec::new();
    for (f, &face) in mesh.faces.iter().enumerate() {
        let mut key = face;
        key.sort_unstable();
        if *known.entry(key).or_insert(f) != f {
            drop.push(f);
        }
    }
    drop_faces(mesh, &drop);
    drop
}

/// Removes the vertices that no face uses and returns their old indices; the others keep their order.
pub fn drop_isolated_vertices(mesh: &mut TriMesh) -> Vec<u32> {
    let mut used = vec![false; mesh.positions.len()];
    for &v in mesh.faces.iter().flatten() {
        if let Some(used) = used.get_mut(v as usize) {
            *used = true;
        }
    }
    let mut next = 0;
    let new_index: Vec<u32> = used
        .iter()
        .map(|&used| {
            next += u32::from(used);
            next.wrapping_sub(1)
        })
        .collect();
    let dropped: Vec<u32> = (0u32..).zip(&used).filter(|(_, used)| !**used).map(|(v, _)| v).collect();
    if !dropped.is_empty() {
        keep_vertices(mesh, |v| used[v]);
        for face in &mut mesh.faces {
            *face = face.map(|v| new_index.get(v as usize).copied().unwrap_or(v));
        }
    }
    dropped
}

/// Makes the faces of each part (joined by edges with two faces) agree in orientation: outwards where the part is closed, and
/// otherwise the way most of its faces are already (the way of its first face, if there are as many of either kind). Normals of
/// vertices are left alone, and so are parts that cannot be oriented.
///
/// Every closed part is turned outwards, also one that lies inside another and was meant as a cavity.
pub fn orient(mesh: &mut TriMesh) -> Oriented {
    let usable = usable_faces(mesh);
    let sides = sides(mesh, &usable);
    let orientation = orientation(mesh.faces.len(), &sides);
    // All sums below are kept at the first face of each part.
    let n = mesh.faces.len();
    let mut closed = vec![true; n];
    for edge in sides.chunk_by(same_edge).filter(|edge| edge.len() != 2) {
        for side in edge {
            closed[orientation.patch[side.face()] as usize] = false;
        }
    }
    let scale = positive(mesh.diagonal());
    let mut balance = vec![0i64; n];
    let mut volume = vec![0.0; n];
    for f in (0..n).filter(|&f| usable[f]) {
        let part = orientation.patch[f] as usize;
        let sign = if orientation.against[f] { -1 } else { 1 };
        balance[part] += sign;
        if let (Some(p), Some(o)) = (corners(mesh, mesh.faces[f]), corners(mesh, mesh.faces[part])) {
            volume[part] += sign as f64 * cross(p, scale).dot((p[0] - o[0]) / scale);
        }
    }
    let mut turn: Vec<bool> = (0..n)
        .map(|p| if closed[p] && volume[p] != 0.0 { volume[p] < 0.0 } else { balance[p] < 0 })
        .collect();
    let mut result = Oriented::default();
    let mut left_alone = vec![false; n];
    for &first in &orientation.contradictory {
        result.non_orientable.push(first as usize);
        left_alone[first as usize] = true;
        turn[first as usize] = false;
    }
    for f in (0..n).filter(|&f| usable[f]) {
        let part = orientation.patch[f] as usize;
        if !left_alone[part] && orientation.against[f] != turn[part] {
            mesh.faces[f].swap(1, 2);
            result.flipped.push(f);
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check, shapes};

    /// Every triangle with three vertices of its own.
    fn soup(mesh: &TriMesh) -> TriMesh {
        let positions: Vec<DVec3> = (0..mesh.faces.len()).flat_map(|f| mesh.corners(f)).collect();
        let faces = (0..mesh.faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        TriMesh::new(positions, faces)
    }

    #[test]
    fn welding_undoes_the_soup() {
        let mesh = shapes::pebble();
        let mut welded = soup(&mesh);
        let did = weld_coincident(&mut welded);
        assert_eq!(did.merged, 3 * mesh.faces.len() - mesh.positions.len());
        assert!(did.collapsed_faces.is_empty());
        assert_eq!(check(&welded).genus, Some(0));
        assert_eq!(weld_coincident(&mut welded).merged, 0);
    }

    #[test]
    fn welding_within_a_tolerance_undoes_a_shaken_soup_at_any_size() {
        for scale in [1.0, 2f64.powi(20), 2f64.powi(-20), 2f64.powi(-300)] {
            let mesh = shapes::sphere(2);
            let mut shaken = soup(&mesh);
            for (k, p) in shaken.positions.iter_mut().enumerate() {
                let shift = [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_X][k % 4];
                *p = (*p + 1e-7 * shift) * scale;
            }
            let mut exact = shaken.clone();
            assert!(weld_coincident(&mut exact).merged < 800);
            let did = weld_within(&mut shaken, 1e-6).unwrap();
            assert_eq!(shaken.positions.len(), mesh.positions.len());
            assert_eq!(did.new_index.len(), 960);
            assert!(check(&shaken).is_sound());
        }
        assert!(weld_within(&mut shapes::sphere(0), f64::NAN).is_err());
        assert!(weld_within(&mut shapes::sphere(0), -1.0).is_err());
    }

    #[test]
    fn welding_merges_normals() {
        let mut mesh = soup(&shapes::cuboid(DVec3::ONE, 1));
        let normals = (0..12).flat_map(|f| [2.0 * mesh.area_vector(f); 3]).collect();
        mesh.normals = Some(normals);
        weld_coincident(&mut mesh);
        for (p, n) in mesh.positions.iter().zip(mesh.normals.unwrap()) {
            assert!((n.length() - 1.0).abs() < 1e-14 && n.dot(*p) > 0.7);
        }
    }

    #[test]
    fn orientation_is_restored_and_points_outwards() {
        let mesh = shapes::torus(2.0, 0.7, 12, 9);
        let mut shuffled = mesh.clone();
        for (f, face) in shuffled.faces.iter_mut().enumerate() {
            if f == 0 || f % 7 < 4 {
                face.swap(1, 2);
            }
        }
        let flipped = (0..mesh.faces.len()).filter(|&f| f == 0 || f % 7 < 4).collect::<Vec<_>>();
        assert_eq!(orient(&mut shuffled), Oriented { flipped, non_orientable: Vec::new() });
        assert!(check(&shuffled).volume > 0.0);
        assert_eq!(orient(&mut shuffled), Oriented::default());
    }

    #[test]
    fn an_open_part_follows_the_majority_and_a_moebius_strip_is_left_alone() {
        let mut open = shapes::cuboid(DVec3::ONE, 3);
        open.faces.truncate(90);
        let wanted = open.faces.clone();
        open.faces[0].swap(1, 2);
        open.faces[50].swap(1, 2);
        assert_eq!(orient(&mut open).flipped, [0, 50]);
        assert_eq!(
            open.faces.iter().map(|f| f[0]).collect::<Vec<_>>(),
            wanted.iter().map(|f| f[0]).collect::<Vec<_>>()
        );
        assert!(check(&open).oriented);
        let mut moebius = TriMesh::new(
            (0..5).map(|k| DVec3::new(f64::from(k), f64::from(k * k), 1.0)).collect(),
            (0..5).map(|k| [k, (k + 1) % 5, (k + 2) % 5]).collect(),
        );
        let before = moebius.clone();
        assert_eq!(orient(&mut moebius), Oriented { flipped: Vec::new(), non_orientable: vec![0] });
        assert_eq!(moebius, before);
    }

    #[test]
    fn drops_say_what_they_dropped() {
        let mut mesh = shapes::sphere(0);
        let wanted = mesh.clone();
        mesh.positions.insert(0, DVec3::ONE);
        mesh.faces.iter_mut().flatten().for_each(|v| *v += 1);
        let [a, b, c] = mesh.faces[3];
        mesh.faces.extend([[b, c, a], [c, b, a], [a, a, b], [a, b, 99]]);
        assert_eq!(drop_degenerate_faces(&mut mesh), [22, 23]);
        assert_eq!(drop_duplicate_faces(&mut mesh), [20, 21]);
        assert_eq!(drop_isolated_vertices(&mut mesh), [0]);
        assert_eq!(mesh, wanted);
    }
}

//! The boundary of any mesh, as loops.

use std::collections::HashMap;

use crate::{
    TriMesh,
    edges::{Sets, Side, same_edge},
    report::BoundaryLoop,
};

/// The loops of edges with one face, in the order of their first edges.
///
/// Where several fans of faces meet in one vertex, each fan has its own passage through it, so that loops which merely touch stay
/// two; only at a non-manifold edge can a loop branch.
pub(crate) fn boundary_loops(mesh: &TriMesh, sides: &[Side]) -> Vec<BoundaryLoop> {
    let mut border: Vec<Side> =
        sides.chunk_by(same_edge).filter(|edge| edge.len() == 1).map(|edge| edge[0]).collect();
    if border.is_empty() {
        return Vec::new();
    }
    border.sort_unstable_by_key(|side| side.half_edge);
    let corner = |face: usize, v: u32| {
        let k = mesh.faces[face].iter().position(|&w| w == v).unwrap_or(0);
        (3 * face + k) as u32
    };
    let mut fans = Sets::new(3 * mesh.faces.len());
    for edge in sides.chunk_by(same_edge) {
        for pair in edge.windows(2) {
            for v in [pair[0].low, pair[0].high] {
                fans.union(corner(pair[0].face(), v), corner(pair[1].face(), v));
            }
        }
    }
    // A node is a passage of the border through a vertex: the fan it belongs to.
    let mut nodes = HashMap::with_capacity(border.len());
    let mut edges_at: Vec<Vec<usize>> = Vec::new();
    let mut ends = Vec::with_capacity(border.len());
    for (e, side) in border.iter().enumerate() {
        let (tail, head) = if side.forward { (side.low, side.high) } else { (side.high, side.low) };
        ends.push([tail, head].map(|v| {
            let node = *nodes.entry(fans.find(corner(side.face(), v))).or_insert_with(|| {
                edges_at.push(Vec::new());
                edges_at.len() - 1
            });
            edges_at[node].push(e);
            (node, v)
        }));
    }
    let mut seen = vec![false; border.len()];
    let mut visited = vec![false; edges_at.len()];
    let mut loops = Vec::new();
    for first in 0..border.len() {
        if seen[first] {
            continue;
        }
        let mut walk = BoundaryLoop { vertices: Vec::new(), simple: true };
        // Depth first, backwards edges last: a simple loop comes out in its order.
        let mut stack = vec![ends[first][0]];
        while let Some((node, v)) = stack.pop() {
            if std::mem::replace(&mut visited[node], true) {
                continue;
            }
            walk.vertices.push(v);
            walk.simple &= edges_at[node].len() == 2;
            for leaving in [false, true] {
                for &e in &edges_at[node] {
                    let [tail, head] = ends[e];
                    seen[e] = true;
                    if leaving == (tail.0 == node) {
                        stack.push(if leaving { head } else { tail });
                    }
                }
            }
        }
        loops.push(walk);
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check, shapes};
    use glam::DVec3;

    fn loops(mesh: &TriMesh) -> Vec<BoundaryLoop> {
        check(mesh).boundary_loops.first
    }

    #[test]
    fn a_square_is_walked_with_the_surface_on_the_left() {
        let mesh = TriMesh::new(vec![DVec3::ZERO; 4], vec![[0, 1, 2], [0, 2, 3]]);
        assert_eq!(loops(&mesh), [BoundaryLoop { vertices: vec![0, 1, 2, 3], simple: true }]);
    }

    #[test]
    fn loops_that_touch_in_a_vertex_stay_two() {
        let mesh = TriMesh::new(vec![DVec3::ZERO; 5], vec![[0, 1, 2], [0, 3, 4]]);
        let found = loops(&mesh);
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|l| l.simple && l.vertices.len() == 3));
    }

    #[test]
    fn a_fin_branches() {
        let mesh = TriMesh::new(vec![DVec3::ZERO; 5], vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        let found = loops(&mesh);
        assert_eq!((found.len(), found[0].simple, found[0].vertices.len()), (1, false, 5));
    }

    #[test]
    fn a_long_loop_needs_no_deep_stack() {
        let mut mesh = shapes::torus(2.0, 1.0, 256, 256);
        mesh.faces.retain(|f| f.iter().any(|v| v % 256 != 0));
        mesh.faces.truncate(2 * 255 * 256);
        assert_eq!(loops(&mesh).iter().map(|l| l.vertices.len()).collect::<Vec<_>>(), [256, 256]);
    }
}

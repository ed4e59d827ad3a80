//! Tangents where projections fail: a vertex whose faces no single normal sees from the front.
//!
//! There the projected edges are not in cyclic order, patches fold and edges may have no tangent at all. Their tangents are laid out instead like
//! the faces unrolled into the tangent plane; the boundary curves are bent ([`crate::bend`]) by the difference.

use glam::{DVec2, DVec3};

use crate::{network::Edges, poly_mesh::PolyMesh};

/// Shortest tangent relative to the edge.
const SHORTEST: f64 = 0.5;

/// Widest angle between the tangents of neighbouring edges: 144°.
const WIDEST: f64 = 0.8 * std::f64::consts::PI;

/// What to add to the derivative of the boundary curve at the ends of edges, each in the parameter that grows from its end; `None` where nothing
/// is. Empty when `vertices` is.
pub(crate) fn fans(mesh: &PolyMesh, edges: &Edges, vertices: &[u32]) -> Vec<Option<[DVec3; 2]>> {
    if vertices.is_empty() {
        return Vec::new();
    }
    let mut corners: Vec<Vec<(u32, u32, f64)>> = vec![Vec::new(); vertices.len()];
    for face in &mesh.faces {
        let v = face.vertices();
        for k in 0..v.len() {
            let Ok(at) = vertices.binary_search(&v[k]) else { continue };
            let (next, prev) = (v[(k + 1) % v.len()], v[(k + v.len() - 1) % v.len()]);
            let from = |w: u32| mesh.positions[w as usize] - mesh.positions[v[k] as usize];
            corners[at].push((next, prev, from(next).angle_between(from(prev))));
        }
    }
    let mut out = vec![None; edges.edges.len()];
    for (&v, corners) in vertices.iter().zip(&corners) {
        let Some((order, closed)) = unroll(corners) else { continue };
        for (w, add) in tangents(mesh, v, &order, closed) {
            let key = [v.min(w), v.max(w)];
            if let Ok(e) = edges.edges.binary_search_by_key(&key, |e| e.vertices) {
                out[e].get_or_insert([DVec3::ZERO; 2])[usize::from(w < v)] = add;
            }
        }
    }
    out
}

/// The neighbours in cyclic order, each with the angle to the next one; whether they close. `None` where the faces are no disc.
fn unroll(corners: &[(u32, u32, f64)]) -> Option<(Vec<(u32, f64)>, bool)> {
    let first = corners.iter().map(|c| c.0).filter(|next| !corners.iter().any(|c| c.1 == *next)).min();
    let start = first.or_else(|| corners.iter().map(|c| c.0).min())?;
    let mut order = Vec::with_capacity(corners.len() + 1);
    let mut at = start;
    for _ in 0..corners.len() {
        let mut here = corners.iter().filter(|c| c.0 == at);
        let corner = here.next()?;
        if here.next().is_some() || !corner.2.is_finite() {
            return None;
        }
        order.push((at, corner.2));
        at = corner.1;
        if at == start && order.len() < corners.len() {
            return None;
        }
    }
    let closed = at == start;
    if !closed {
        order.push((at, 0.0));
    }
    Some((order, closed))
}

fn tangents(mesh: &PolyMesh, v: u32, order: &[(u32, f64)], closed: bool) -> Vec<(u32, DVec3)> {
    let Some(n) = mesh.normals[v as usize].try_normalize() else { return Vec::new() };
    let (a, b) = n.any_orthonormal_pair();
    let (a, b) = if a.cross(b).dot(n) > 0.0 { (a, b) } else { (b, a) };
    let whole: f64 = order.iter().map(|o| o.1).sum();
    let most = if closed { std::f64::consts::TAU } else { whole.min(1.5 * std::f64::consts::PI) };
    if !(whole > 0.0) {
        return Vec::new();
    }
    let angles = spread(&order.iter().map(|o| o.1).collect::<Vec<_>>(), most);
    let mut angle = 0.0;
    let mut laid = Vec::with_capacity(order.len());
    // The turn that brings the unrolled edges nearest to the projected ones.
    let mut turn = DVec2::ZERO;
    for (&(w, _), opening) in order.iter().zip(angles) {
        let e = mesh.positions[w as usize] - mesh.positions[v as usize];
        let (direction, projected) = (DVec2::from_angle(angle), DVec2::new(e.dot(a), e.dot(b)));
        turn += DVec2::new(direction.dot(projected), direction.perp_dot(projected)) / e.length();
        laid.push((w, e, projected, direction));
        angle += opening;
    }
    let turn = turn.try_normalize().unwrap_or(DVec2::X);
    let mut out = Vec::with_capacity(laid.len());
    for (w, e, projected, direction) in laid {
        let tangent = turn.rotate(direction) * projected.length().max(SHORTEST * e.length()) - projected;
        out.push((w, a * tangent.x + b * tangent.y));
    }
    out
}

/// Angles scaled to the sum `most`, none above [`WIDEST`]: a patch cannot open further.
fn spread(angles: &[f64], most: f64) -> Vec<f64> {
    let mut capped = vec![false; angles.len()];
    loop {
        let free: f64 = angles.iter().zip(&capped).filter(|c| !c.1).map(|c| c.0).sum();
        let left = most - WIDEST * capped.iter().filter(|c| **c).count() as f64;
        let scale = if free > 0.0 { (left / free).max(0.0) } else { 0.0 };
        let mut more = false;
        for (angle, capped) in angles.iter().zip(&mut capped) {
            if !*capped && angle * scale > WIDEST {
                *capped = true;
                more = true;
            }
        }
        if !more {
            let scaled = |(angle, capped): (&f64, &bool)| if *capped { WIDEST } else { angle * scale };
            return angles.iter().zip(&capped).map(scaled).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Face;

    #[test]
    fn no_angle_reaches_a_half_turn() {
        let s = spread(&[1.09, 1.09, 2.19], std::f64::consts::TAU);
        assert!((s.iter().sum::<f64>() - std::f64::consts::TAU).abs() < 1e-12);
        assert!(s[2] == WIDEST && (s[0] - s[1]).abs() < 1e-12);
        assert_eq!(spread(&[0.5, 0.25], 1.5), [1.0, 0.5]);
    }

    #[test]
    fn tangents_turn_the_curve_at_both_ends() {
        // The curve leaves either end with what is added there, seen from that end.
        let (a, b) = (DVec3::new(0.1, 0.4, 0.0), DVec3::new(0.0, -0.2, 0.3));
        let bend = crate::bend::tangents(a, b);
        for (end, want) in [a, b].into_iter().enumerate() {
            let d = crate::bend::taylor::<2>(&bend, end);
            assert!(DVec3::from_array([d[0][1], d[1][1], d[2][1]]).distance(want) < 1e-15, "{end}");
        }
    }

    #[test]
    fn a_fan_that_projects_well_is_kept() {
        // A regular hexagon around a vertex: unrolled it is itself.
        let ring = |k: u32| DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 6.0).extend(0.0);
        let mut positions = vec![DVec3::ZERO];
        positions.extend((0..6).map(ring));
        let faces = (0..6).map(|k| Face::Triangle([0, 1 + k, 1 + (k + 1) % 6])).collect();
        let mut mesh = PolyMesh { positions, normals: vec![DVec3::Z; 7], faces };
        let edges = Edges::of(&mesh);
        let kept = fans(&mesh, &edges, &[0]);
        assert!(kept.iter().flatten().all(|d| d[0].length() < 1e-12 && d[1] == DVec3::ZERO));
        assert_eq!(kept.iter().flatten().count(), 6);
        // One neighbour folded over: its tangent is laid between the two beside it.
        mesh.positions[2] = mesh.positions[5] * 0.5 + 0.2 * DVec3::Z;
        let folded = fans(&mesh, &edges, &[0]);
        let e = edges.edges.iter().position(|e| e.vertices == [0, 2]).unwrap();
        let tangent = mesh.positions[2] * DVec3::new(1.0, 1.0, 0.0) + folded[e].unwrap()[0];
        assert!(tangent.dot(ring(1)) > 0.0, "{tangent}");
    }
}

//! Parameter correction: every vertex moves to the foot point of its position on the surface.

use glam::{DVec2, DVec3};

use crate::Cells;

/// Newton steps per round, and the longest step per coordinate in cells.
const STEPS: usize = 2;
const LONGEST: f64 = 0.3;
/// A triangle keeps at least this part of the area that it had before all corrections; otherwise the displacements of its vertices are
/// halved, and in the second half of so many rounds taken back.
const KEPT_AREA: f64 = 0.3;
const HALVINGS: usize = 8;

/// The corrected parameters, or `None` when no admissible displacement was found.
///
/// A vertex that does not come closer keeps its parameter; the corrected triangles keep their orientation and three tenths of the area
/// that they have in the `original` parameters.
pub(crate) fn correct(
    cells: &Cells,
    net: &[DVec3],
    points: &[DVec3],
    params: &[DVec2],
    original: &[DVec2],
    triangles: &[[u32; 3]],
) -> Option<Vec<DVec2>> {
    let mut shift: Vec<DVec2> =
        params.iter().zip(points).map(|(&p, &x)| foot_point(cells, net, x, p) - p).collect();
    if shift.iter().all(|&s| s == DVec2::ZERO) {
        return None;
    }
    let area = |p: &[DVec2], t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| p[v as usize]);
        (b - a).perp_dot(c - a)
    };
    // Only the vertices of what would flip hold back; the last halving takes them back altogether.
    for halving in 0..=HALVINGS {
        let moved: Vec<DVec2> = params.iter().zip(&shift).map(|(&p, &s)| p + s).collect();
        let kept = |t: &&[u32; 3]| {
            let (old, new) = (area(original, t), area(&moved, t));
            old == 0.0 || new * old.signum() >= KEPT_AREA * old.abs()
        };
        let mut held: Vec<u32> = triangles.iter().filter(|t| !kept(t)).flatten().copied().collect();
        held.extend((0..moved.len() as u32).filter(|&v| !cells.covers(moved[v as usize])));
        if held.is_empty() {
            return Some(moved);
        }
        held.sort_unstable();
        held.dedup();
        let part = if halving < HALVINGS / 2 { 0.5 } else { 0.0 };
        held.into_iter().for_each(|v| shift[v as usize] *= part);
    }
    None
}

/// Two guarded Newton steps for the nearest point of the surface to `x`, from `start`; `start` when they do not help.
fn foot_point(cells: &Cells, net: &[DVec3], x: DVec3, start: DVec2) -> DVec2 {
    let grid = cells.grid();
    let longest = grid.step * LONGEST;
    let mut at = start;
    let first = grid.jet(net, at);
    let before = first.p.distance_squared(x);
    let mut jet = first;
    for _ in 0..STEPS {
        let r = jet.p - x;
        let gradient = DVec2::new(jet.du.dot(r), jet.dv.dot(r));
        let gauss = [jet.du.dot(jet.du), jet.du.dot(jet.dv), jet.dv.dot(jet.dv)];
        let full = [gauss[0] + jet.duu.dot(r), gauss[1] + jet.duv.dot(r), gauss[2] + jet.dvv.dot(r)];
        // Gauss–Newton where the full Hessian does not lead downhill.
        let Some(step) = newton(full, gradient).or_else(|| newton(gauss, gradient)) else { break };
        at = (at - step.clamp(-longest, longest)).clamp(grid.lower, grid.upper());
        jet = grid.jet(net, at);
    }
    let closer = jet.p.distance_squared(x) < before;
    if closer && cells.covers(at) { at } else { start }
}

/// `H⁻¹ g` for a symmetric `H = [a, b; b, c]`, if it is safely positive definite.
fn newton([a, b, c]: [f64; 3], g: DVec2) -> Option<DVec2> {
    let det = a * c - b * b;
    (a > 0.0 && det > 1e-12 * a * c).then(|| DVec2::new(c * g.x - b * g.y, a * g.y - b * g.x) / det)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    #[test]
    fn foot_points_on_a_plane_are_found_at_once() {
        let grid = Grid::new(DVec2::ZERO, DVec2::splat(4.0), [4, 4]).unwrap();
        let net: Vec<DVec3> =
            (0..49).map(|k| DVec3::new((k / 7) as f64 - 1.0, (k % 7) as f64 - 1.0, 0.0)).collect();
        let cells = Cells::all(grid);
        let x = DVec3::new(2.2, 1.9, 0.5);
        let at = foot_point(&cells, &net, x, DVec2::new(2.0, 2.0));
        assert!(at.distance(DVec2::new(2.2, 1.9)) < 1e-14);
        // Two steps of at most 0.3 cells.
        let far = foot_point(&cells, &net, DVec3::new(4.0, 2.0, 0.0), DVec2::new(2.0, 2.0));
        assert!(far.distance(DVec2::new(2.6, 2.0)) < 1e-14);
    }

    #[test]
    fn a_correction_never_flips_a_triangle() {
        let grid = Grid::new(DVec2::ZERO, DVec2::splat(4.0), [4, 4]).unwrap();
        let net: Vec<DVec3> =
            (0..49).map(|k| DVec3::new((k / 7) as f64 - 1.0, (k % 7) as f64 - 1.0, 0.0)).collect();
        let params = [DVec2::new(2.0, 2.0), DVec2::new(2.2, 2.0), DVec2::new(2.0, 2.2)];
        // The points are reflected: the foot points flip the triangle.
        let points = [DVec3::new(2.15, 2.15, 0.0), DVec3::new(2.0, 2.15, 0.0), DVec3::new(2.15, 2.0, 0.0)];
        let moved = correct(&Cells::all(grid), &net, &points, &params, &params, &[[0, 1, 2]]).unwrap();
        let area = |p: &[DVec2]| (p[1] - p[0]).perp_dot(p[2] - p[0]);
        assert!(area(&moved) >= KEPT_AREA * area(&params));
        assert!(moved[0] != params[0]);
    }
}

//! The chart as the methods see it: unit size around a local origin, every triangle laid flat.

use glam::{DVec2, DVec3};

use crate::ParamError;
use crate::rim::boundary_loop;

/// Least height of a triangle relative to its longest edge, and least edge relative to [`THIN`] chart diameters: a thinner
/// triangle is laid flat with that height. Cotangents then stay below 1 / `THIN`, and every element matrix stays positive
/// semidefinite, because it belongs to a real triangle.
const THIN: f64 = 1e-6;

/// A disc in unit size.
pub(crate) struct Sheet<'a> {
    /// Positions relative to the centre of the bounding box, divided by its diagonal.
    pub(crate) x: Vec<DVec3>,
    pub(crate) faces: &'a [[u32; 3]],
    pub(crate) flats: Vec<Flat>,
    /// Boundary loop, counter-clockwise.
    pub(crate) boundary: Vec<u32>,
    /// The diagonal.
    pub(crate) scale: f64,
}

/// A triangle laid flat, counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat {
    pub(crate) area: f64,
    /// Gradients of the three hat functions.
    pub(crate) grad: [DVec2; 3],
    /// Angles at the three corners.
    pub(crate) angle: [f64; 3],
}

impl<'a> Sheet<'a> {
    pub(crate) fn new(positions: &[DVec3], faces: &'a [[u32; 3]]) -> Result<Self, ParamError> {
        let boundary = boundary_loop(positions.len(), faces)?;
        let (x, scale) = unit(positions)?;
        let flats = flatten(&x, faces);
        Ok(Self { x, faces, flats, boundary, scale })
    }

    /// Sum of the areas.
    pub(crate) fn area(&self) -> f64 {
        self.flats.iter().map(|t| t.area).sum()
    }

    /// Length of the boundary edge from `boundary[i]` to the next, not shorter than a small part of the mean, so that
    /// vertices that coincide in space still get separate places.
    pub(crate) fn boundary_lengths(&self) -> Vec<f64> {
        let b = &self.boundary;
        let length = |i: usize| self.x[b[i] as usize].distance(self.x[b[(i + 1) % b.len()] as usize]);
        let lengths: Vec<f64> = (0..b.len()).map(length).collect();
        let least = 1e-3 * lengths.iter().sum::<f64>() / b.len() as f64;
        lengths.iter().map(|&l| l.max(least).max(THIN * THIN)).collect()
    }

    /// Number of every vertex among the interior ones, and how many there are; `None` on the boundary.
    pub(crate) fn interior(&self) -> (Vec<Option<usize>>, usize) {
        let mut index = vec![Some(0); self.x.len()];
        for &v in &self.boundary {
            index[v as usize] = None;
        }
        let mut count = 0;
        for i in index.iter_mut().flatten() {
            *i = count;
            count += 1;
        }
        (index, count)
    }
}

/// Relative to the centre of the bounding box, divided by its diagonal.
pub(crate) fn unit(positions: &[DVec3]) -> Result<(Vec<DVec3>, f64), ParamError> {
    if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
        return Err(ParamError::NotFinite { vertex, value: positions[vertex] });
    }
    let Some(&first) = positions.first() else { return Err(ParamError::Empty) };
    let (lo, hi) = positions.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    // Halves before the difference: coordinates near the largest number do not overflow.
    let centre = 0.5 * lo + 0.5 * hi;
    let half = 0.5 * hi - 0.5 * lo;
    let largest = half.max_element();
    if largest == 0.0 {
        return Err(ParamError::Collapsed { area: 0.0 });
    }
    let scale = 2.0 * largest * (half / largest).length();
    if !scale.is_finite() {
        return Err(ParamError::Collapsed { area: scale });
    }
    Ok((positions.iter().map(|p| (*p - centre) / scale).collect(), scale))
}

/// Lays every triangle flat.
pub(crate) fn flatten(x: &[DVec3], faces: &[[u32; 3]]) -> Vec<Flat> {
    faces.iter().map(|f| Flat::new(f.map(|v| x[v as usize]))).collect()
}

impl Flat {
    /// Triangles thinner than the limit (see the constant `THIN`) get the least height.
    pub(crate) fn new(p: [DVec3; 3]) -> Self {
        // The longest edge goes along the first axis: the height is then the smallest one and free of cancellation.
        let edge = |k: usize| p[(k + 1) % 3] - p[k];
        let k = (0..3).fold(0, |best, k| if edge(k).length() > edge(best).length() { k } else { best });
        let base = edge(k);
        let side = p[(k + 2) % 3] - p[k];
        let l = base.length();
        let (l, x, y) = if l > THIN * THIN {
            (l, base.dot(side) / l, (base.cross(side).length() / l).max(THIN * l))
        } else {
            (THIN * THIN, 0.5 * THIN * THIN, THIN * THIN)
        };
        let q = [DVec2::ZERO, DVec2::new(l, 0.0), DVec2::new(x, y)];
        let area = 0.5 * l * y;
        let mut flat = Self { area, grad: [DVec2::ZERO; 3], angle: [0.0; 3] };
        for i in 0..3 {
            let (a, b, c) = (q[i], q[(i + 1) % 3], q[(i + 2) % 3]);
            let at = (k + i) % 3;
            flat.grad[at] = (c - b).perp() / (2.0 * area);
            flat.angle[at] = (b - a).perp_dot(c - a).atan2((b - a).dot(c - a));
        }
        flat
    }

    /// Gradients of both parameters, as rows: the Jacobian of the map from the flat triangle.
    pub(crate) fn jacobian(&self, q: [DVec2; 3]) -> [DVec2; 2] {
        // Differences to one corner: exact for coordinates far from the origin of the plane.
        let (a, b) = (q[1] - q[0], q[2] - q[0]);
        [self.grad[1] * a.x + self.grad[2] * b.x, self.grad[1] * a.y + self.grad[2] * b.y]
    }

    /// Entry of the cotangent Laplacian (positive semidefinite) for two corners.
    pub(crate) fn stiffness(&self, i: usize, j: usize) -> f64 {
        self.area * self.grad[i].dot(self.grad[j])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_triangles_keep_angles_and_areas() {
        let p = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.4, 0.1, 0.2), DVec3::new(0.2, 0.5, 0.6)];
        let t = Flat::new(p);
        for i in 0..3 {
            let (a, b, c) = (p[i], p[(i + 1) % 3], p[(i + 2) % 3]);
            assert!((t.angle[i] - (b - a).angle_between(c - a)).abs() < 1e-14);
            // Off-diagonal entries are minus half the cotangent of the opposite angle.
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            assert!((t.stiffness(j, k) + 0.5 / t.angle[i].tan()).abs() < 1e-13);
        }
        assert!((t.area - 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length()).abs() < 1e-16);
    }

    #[test]
    fn degenerate_triangles_stay_finite() {
        let p = DVec3::new(0.3, 0.1, 0.2);
        let line = [p, p + DVec3::X * 0.1, p + DVec3::X * 0.2];
        for corners in [[p, p, p], [p, p, p + DVec3::X * 0.1], line] {
            let t = Flat::new(corners);
            assert!(t.area > 0.0 && t.grad.iter().all(|g| g.is_finite()));
            assert!((t.angle.iter().sum::<f64>() - std::f64::consts::PI).abs() < 1e-9);
        }
    }

    #[test]
    fn the_laplacian_does_not_see_powers_of_two() {
        let p = [DVec3::new(0.1, 0.7, 0.3), DVec3::new(1.4, 0.1, 0.2), DVec3::new(0.2, 0.5, 1.6)];
        let s = 2f64.powi(20);
        assert_eq!(unit(&p).unwrap().0, unit(&p.map(|x| x * s)).unwrap().0);
        assert!(unit(&[DVec3::ZERO; 3]).is_err());
        assert!(unit(&[DVec3::splat(f64::MAX), -DVec3::splat(f64::MAX)]).is_err());
    }
}

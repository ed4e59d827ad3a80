//! The shape operator as a symmetric tensor in space.

use glam::{DMat3, DVec3};
use suture_bernstein::Jet2;

/// Normal and curvature of a patch at one point, independent of its parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// Unit normal `S_u × S_v / |S_u × S_v|`.
    pub(crate) normal: DVec3,
    /// `W = Σ (S_ij · n) aⁱ ⊗ aʲ` with the dual basis `aⁱ · S_j = δ_ij`: the second fundamental form as a tensor of the tangent plane,
    /// zero along the normal. Its other two eigenvalues are the principal curvatures (do Carmo 1976, §3.2), positive where the
    /// surface bends towards the normal.
    pub(crate) tensor: DMat3,
}

impl Shape {
    /// The shape at a jet, or `None` where the patch is singular or not finite.
    pub(crate) fn of(jet: &Jet2) -> Option<Self> {
        let normal = jet.normal().filter(|n| n.is_finite() && jet.finite())?;
        let area = jet.du.cross(jet.dv).length();
        let (au, av) = (jet.dv.cross(normal) / area, normal.cross(jet.du) / area);
        let (l, m, n) = (jet.duu.dot(normal), jet.duv.dot(normal), jet.dvv.dot(normal));
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let mixed = outer(au, av) + outer(av, au);
        let tensor = outer(au, au) * l + mixed * m + outer(av, av) * n;
        tensor.is_finite().then_some(Self { normal, tensor })
    }

    /// The same surface seen from its other side.
    pub(crate) fn flipped(self) -> Self {
        Self { normal: -self.normal, tensor: self.tensor * -1.0 }
    }

    /// Largest absolute principal curvature.
    pub(crate) fn curvature(&self) -> f64 {
        spectral(self.tensor, self.normal)
    }

    /// Angle between the normals. Both arguments of the arc tangent keep their digits for tiny angles and for angles near π, where
    /// the arc cosine loses half of them.
    pub(crate) fn angle(&self, other: &Self) -> f64 {
        self.normal.cross(other.normal).length().atan2(self.normal.dot(other.normal))
    }

    /// Spectral norm of the difference of the tensors in the mean tangent plane: the largest difference of normal curvature over all
    /// directions. A tilt of one side by an angle enters with its square only, so that a jump of the normal is not counted twice.
    pub(crate) fn jump(&self, other: &Self) -> f64 {
        let mean = (self.normal + other.normal).try_normalize().unwrap_or(self.normal);
        spectral(self.tensor - other.tensor, mean)
    }
}

/// Largest absolute eigenvalue of a symmetric tensor restricted to the plane across `normal`.
fn spectral(tensor: DMat3, normal: DVec3) -> f64 {
    let (e, f) = normal.any_orthonormal_pair();
    let (te, tf) = (tensor * e, tensor * f);
    let (a, b, c) = (te.dot(e), te.dot(f), tf.dot(f));
    (0.5 * (a + c)).abs() + (0.5 * (a - c)).hypot(b)
}

/// `|S_u × S_v| / (|S_u| |S_v|)`, the sine of the angle between the parameter lines; 0 where that is not a number.
pub(crate) fn regularity(jet: &Jet2) -> f64 {
    let sine = jet.du.cross(jet.dv).length() / (jet.du.length() * jet.dv.length());
    if sine.is_finite() { sine.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use glam::DMat2;

    use super::*;

    /// `z = (a x² + 2 b x y + c y²)/2` at the origin in skew, stretched parameters `(x, y) = M (u, v)`.
    fn quadric(a: f64, b: f64, c: f64, m: DMat2) -> Jet2 {
        let lift = |d: glam::DVec2| DVec3::new(d.x, d.y, 0.0);
        let bend = |p: glam::DVec2, q: glam::DVec2| {
            DVec3::Z * (a * p.x * q.x + b * (p.x * q.y + p.y * q.x) + c * p.y * q.y)
        };
        let (u, v) = (m.x_axis, m.y_axis);
        Jet2 { p: DVec3::ZERO, du: lift(u), dv: lift(v), duu: bend(u, u), duv: bend(u, v), dvv: bend(v, v) }
    }

    #[test]
    fn the_tensor_does_not_depend_on_parameters() {
        let m = DMat2::from_cols_array(&[3.0, 0.5, -0.2, 0.01]);
        let plain = Shape::of(&quadric(2.0, 0.7, -5.0, DMat2::IDENTITY)).unwrap();
        let skew = Shape::of(&quadric(2.0, 0.7, -5.0, m)).unwrap();
        assert!(plain.jump(&skew) < 1e-11, "{}", plain.jump(&skew));
        assert!((plain.tensor.x_axis.y - 0.7).abs() < 1e-15 && (plain.tensor.y_axis.y + 5.0).abs() < 1e-15);
        // Eigenvalues of [[2, .7], [.7, −5]].
        assert!((plain.curvature() - (1.5 + 12.74_f64.sqrt())).abs() < 1e-14);
    }

    #[test]
    fn second_derivatives_along_the_surface_do_not_count() {
        let mut jet = quadric(1.0, 0.0, 1.0, DMat2::IDENTITY);
        jet.duu += DVec3::new(40.0, -3.0, 0.0);
        assert!((Shape::of(&jet).unwrap().curvature() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn tiny_angles_keep_their_digits() {
        let plane = |a: f64| Shape { normal: DVec3::new(a.sin(), 0.0, a.cos()), tensor: DMat3::ZERO };
        for angle in [1e-12, 1e-4, 1.0, 3.125] {
            assert!((plane(0.0).angle(&plane(angle)) - angle).abs() < 1e-15 * (1.0 + angle));
        }
    }

    #[test]
    fn singular_and_endless_jets_have_no_shape() {
        assert!(Shape::of(&Jet2::default()).is_none());
        let mut jet = quadric(1.0, 0.0, 1.0, DMat2::IDENTITY);
        jet.duv = DVec3::splat(f64::NAN);
        assert!(Shape::of(&jet).is_none());
        assert_eq!(regularity(&Jet2::default()), 0.0);
    }
}

//! The metric reparameterisation T(p) (Wagner et al. 2003, Section 6.2, Equation 13).

use glam::{DMat2, DVec2, DVec3};
use suture_bernstein::Jet2;

/// The linear map from locally isometric coordinates to parameters: `F ∘ T` has the identity as its first fundamental form at
/// the point where `jet` was taken, and the orientation of `F`.
///
/// `None` where `F_u` and `F_v` are so nearly dependent that `T` is undefined (relative to their lengths).
pub fn isometry(jet: &Jet2<DVec3>) -> Option<DMat2> {
    let (e, f, g) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
    let determinant = jet.du.cross(jet.dv).length_squared();
    // sin² of the angle between F_u and F_v; 1e-12 leaves half of the digits to the directions computed from T.
    if !(determinant > 1e-12 * e * g) {
        return None;
    }
    let t11 = 1.0 / e.sqrt();
    let c = -f / e;
    // |F_v + C F_u|² = det / E, written so without the cancellation of the printed form.
    let t22 = (e / determinant).sqrt();
    Some(DMat2::from_cols(DVec2::new(t11, 0.0), DVec2::new(t22 * c, t22)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_metric_becomes_the_identity() {
        let jet = Jet2 { du: DVec3::new(2.0, 0.3, -0.1), dv: DVec3::new(0.5, 3.0, 1.0), ..Jet2::default() };
        let t = isometry(&jet).unwrap();
        let along = |d: DVec2| jet.du * d.x + jet.dv * d.y;
        let (a, b) = (along(t.x_axis), along(t.y_axis));
        assert!(
            (a.length() - 1.0).abs() < 1e-15 && (b.length() - 1.0).abs() < 1e-15 && a.dot(b).abs() < 1e-15
        );
        assert!(t.determinant() > 0.0);
        // (13) as printed.
        let c = -jet.du.dot(jet.dv) / jet.du.length_squared();
        let (e, f, g) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
        assert!((t.y_axis.y - 1.0 / (c * c * e + 2.0 * c * f + g).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn parallel_partials_have_no_metric_in_any_unit() {
        for scale in [1.0, 2.0_f64.powi(-300), 2.0_f64.powi(200)] {
            let jet =
                Jet2 { du: DVec3::X * scale, dv: DVec3::new(1.0, 1e-8, 0.0) * scale, ..Jet2::default() };
            assert_eq!(isometry(&jet), None);
        }
        assert_eq!(isometry(&Jet2::default()), None);
    }
}

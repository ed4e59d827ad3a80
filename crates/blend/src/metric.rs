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

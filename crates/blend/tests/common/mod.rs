//! What the tests of blended spheres share.

use glam::DVec3;
use suture_surface::{Jet2, Surface};

/// Shape operator as a symmetric bilinear form in space, with the normal.
pub(crate) fn shape(j: &Jet2) -> (DVec3, glam::DMat3) {
    let n = j.normal().unwrap();
    let (e, f, g) = (j.du.dot(j.du), j.du.dot(j.dv), j.dv.dot(j.dv));
    let (l, m, k) = (j.duu.dot(n), j.duv.dot(n), j.dvv.dot(n));
    let det = e * g - f * f;
    // Dual basis of the tangent plane.
    let (a, b) = ((j.du * g - j.dv * f) / det, (j.dv * e - j.du * f) / det);
    let outer = |x: DVec3, y: DVec3| glam::DMat3::from_cols(x * y.x, x * y.y, x * y.z);
    (n, outer(a, a) * l + (outer(a, b) + outer(b, a)) * m + outer(b, b) * k)
}

/// Largest jumps of position, normal and shape operator over all seams.
pub(crate) fn jumps(surface: &Surface) -> [f64; 3] {
    let mut worst = [0.0_f64; 3];
    for seam in surface.seams() {
        let side = |e: suture_surface::EdgeRef, t: f64| {
            let patch = surface.patch(e.patch).unwrap();
            patch.jet(patch.domain().edge(e.edge as usize).unwrap().point(t))
        };
        for k in 0..=10 {
            let t = k as f64 / 10.0;
            let (a, b) = (side(seam.a, t), side(seam.b, seam.opposite(t)));
            let ((na, sa), (nb, sb)) = (shape(&a), shape(&b));
            worst[0] = worst[0].max(a.p.distance(b.p));
            worst[1] = worst[1].max(na.cross(nb).length());
            let d = sa - sb;
            worst[2] = worst[2].max(d.x_axis.length().max(d.y_axis.length()).max(d.z_axis.length()));
        }
    }
    worst
}

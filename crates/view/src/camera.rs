//! The camera: a position and three axes.

use glam::DVec3;
use suture_mesh::TriMesh;

use crate::{Camera, ViewError, ViewOptions};

/// Share of the half picture that a fitted mesh fills.
const FILL: f64 = 0.94;

/// A camera in place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) eye: DVec3,
    pub(crate) right: DVec3,
    pub(crate) up: DVec3,
    /// From the target towards the eye.
    pub(crate) back: DVec3,
    /// Pixels per unit of tangent.
    pub(crate) focal: f64,
    /// Nearest depth that is drawn.
    pub(crate) near: f64,
    pub(crate) middle: [f64; 2],
}

impl View {
    pub(crate) fn new(mesh: &TriMesh, options: &ViewOptions) -> Result<Self, ViewError> {
        let [lo, hi] = mesh.bounding_box().ok_or(ViewError::Empty)?;
        let diagonal = mesh.diagonal();
        if !(diagonal.is_finite() && diagonal > 0.0) {
            return Err(ViewError::Extent { diagonal });
        }
        let centre = lo + (hi - lo) * 0.5;
        let (width, height) = (f64::from(options.width), f64::from(options.height));
        let focal = 0.5 * height / (0.5 * options.field_of_view).tan();
        let placed = |eye: DVec3, back: DVec3| {
            let [right, up] = axes(back, options.up);
            Self { eye, right, up, back, focal, near: 1e-3 * diagonal, middle: [0.5 * width, 0.5 * height] }
        };
        let fitted = |back: DVec3, factor: f64| {
            let view = placed(centre, back);
            let tan = view.middle.map(|m| FILL * m / focal);
            // A vertex (x, y, z) is in the picture of an eye at (X, Y, Z) if |x − X| ≤ tan (Z − z), and alike for y: with the largest
            // x + tan z and −x + tan z, half the difference centres the picture and half the sum is the least tan Z.
            let mut reach = [[f64::NEG_INFINITY; 2]; 2];
            for &v in mesh.faces.iter().flatten() {
                let [x, y, depth] = view.local(mesh.positions[v as usize]);
                for (axis, c) in [x, y].into_iter().enumerate() {
                    for (side, c) in [c, -c].into_iter().enumerate() {
                        reach[axis][side] = reach[axis][side].max(c - tan[axis] * depth);
                    }
                }
            }
            let [x, y] = reach.map(|[plus, minus]| 0.5 * (plus - minus));
            let [dx, dy] = [0, 1].map(|axis| 0.5 * (reach[axis][0] + reach[axis][1]) / tan[axis]);
            let distance = dx.max(dy) * factor;
            let eye = centre + view.right * x + view.up * y + back * distance;
            // Close up, the near plane must come along.
            Self { eye, near: view.near.min(1e-2 * distance), ..view }
        };
        Ok(match options.camera {
            Camera::LookAt { eye, target } => placed(eye, (eye - target).normalize()),
            Camera::Orbit { azimuth, elevation, distance } => {
                fitted(direction(options.up, azimuth, elevation), distance)
            }
            Camera::Auto => {
                let candidates = (0..8).map(|i| {
                    direction(options.up, (0.125 + 0.125 * f64::from(i)) * std::f64::consts::TAU - 0.2, 0.45)
                });
                let mut best = (DVec3::X, f64::NEG_INFINITY);
                for back in candidates {
                    let area: f64 =
                        (0..mesh.faces.len()).map(|f| mesh.area_vector(f).dot(back).max(0.0)).sum();
                    // A closed mesh has the same area from behind, but for rounding: the first one stays.
                    if area > best.1 * (1.0 + 1e-9) || best.1 == f64::NEG_INFINITY {
                        best = (back, area);
                    }
                }
                fitted(best.0, 1.0)
            }
        })
    }

    /// Coordinates to the right, upwards and away from the eye.
    pub(crate) fn local(&self, p: DVec3) -> [f64; 3] {
        let d = p - self.eye;
        [d.dot(self.right), d.dot(self.up), -d.dot(self.back)]
    }

    /// Position in the picture (x to the right, y down, in pixels) and depth, from local coordinates.
    pub(crate) fn pixels(&self, [x, y, depth]: [f64; 3]) -> [f64; 3] {
        [self.middle[0] + self.focal * x / depth, self.middle[1] - self.focal * y / depth, depth]
    }
}

/// Unit vector of an orbit angle. At azimuth 0 it lies in the plane of `up` and the coordinate axis after it.
fn direction(up: DVec3, azimuth: f64, elevation: f64) -> DVec3 {
    let up = up.normalize();
    let a = up.abs();
    let axis = if a.z >= a.x && a.z >= a.y {
        DVec3::X
    } else if a.x >= a.y {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let front = (axis - up * axis.dot(up)).normalize();
    let side = up.cross(front);
    let ((sa, ca), (se, ce)) = (azimuth.sin_cos(), elevation.sin_cos());
    (front * ca + side * sa) * ce + up * se
}

/// Axes to the right and upwards.
fn axes(back: DVec3, up: DVec3) -> [DVec3; 2] {
    let mut up = up.normalize();
    if up.cross(back).length() < 1e-6 {
        let a = back.abs();
        up = if a.x <= a.y && a.x <= a.z {
            DVec3::X
        } else if a.y <= a.z {
            DVec3::Y
        } else {
            DVec3::Z
        };
    }
    let right = up.cross(back).normalize();
    [right, back.cross(right)]
}

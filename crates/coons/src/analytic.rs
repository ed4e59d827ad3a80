//! Analytic surfaces.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use suture_surface::{Jet2, Record, SplinePool};

use crate::constituent::Constituent;
use crate::real::Real;
use crate::taylor::{Enclosure, Expansion, Taylor, jet2};

/// An analytic surface with parameters `(a, b)`, in the frame `origin`, `x`, `y`, `z`; a frame whose axes are not unit vectors
/// stretches the surface. Angles in radians.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Analytic {
    /// Which surface.
    #[serde(flatten)]
    pub shape: Shape,
    /// Origin of the frame.
    #[serde(default)]
    pub origin: DVec3,
    /// Direction of local x.
    #[serde(default = "x_axis")]
    pub x: DVec3,
    /// Direction of local y.
    #[serde(default = "y_axis")]
    pub y: DVec3,
    /// Direction of local z.
    #[serde(default = "z_axis")]
    pub z: DVec3,
}

fn x_axis() -> DVec3 {
    DVec3::X
}

fn y_axis() -> DVec3 {
    DVec3::Y
}

fn z_axis() -> DVec3 {
    DVec3::Z
}

/// The surface in its own frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Shape {
    /// `(a, b, 0)`.
    Plane,
    /// `(r cos a, r sin a, b)`.
    Cylinder {
        /// `r`.
        radius: f64,
    },
    /// `(ρ cos a, ρ sin a, b)` with `ρ = radius + slope b`.
    Cone {
        /// Radius at `b = 0`.
        radius: f64,
        /// Growth of the radius with `b`.
        slope: f64,
    },
    /// `(r sin b cos a, r sin b sin a, r cos b)`: `b` is the angle from the pole.
    Sphere {
        /// `r`.
        radius: f64,
    },
    /// As the sphere, with three half axes.
    Ellipsoid {
        /// Half axes.
        radii: DVec3,
    },
    /// `((R + r cos b) cos a, (R + r cos b) sin a, r sin b)`.
    Torus {
        /// `R`.
        major: f64,
        /// `r`.
        minor: f64,
    },
    /// A Bézier curve of `a` swept along a line: `c(a) + b direction`; a general cylinder.
    Swept {
        /// Control points of the curve, at most 32.
        net: Vec<DVec3>,
        /// Direction of the sweep.
        direction: DVec3,
    },
    /// `(a, b, h cos(p a) cos(q b))`: a plane with periodic bulges.
    Bulges {
        /// Height `h`.
        height: f64,
        /// Frequencies `p`, `q`.
        frequency: DVec2,
    },
}

impl Analytic {
    /// The surface in the standard frame.
    pub fn new(shape: Shape) -> Self {
        Self { shape, origin: DVec3::ZERO, x: DVec3::X, y: DVec3::Y, z: DVec3::Z }
    }

    /// Whether every number is finite and the surface can be evaluated.
    pub fn valid(&self) -> bool {
        let frame = [self.origin, self.x, self.y, self.z].iter().all(|p| p.is_finite());
        frame
            && match &self.shape {
                Shape::Plane => true,
                Shape::Cylinder { radius } | Shape::Sphere { radius } => radius.is_finite(),
                Shape::Cone { radius, slope } => radius.is_finite() && slope.is_finite(),
                Shape::Ellipsoid { radii } => radii.is_finite(),
                Shape::Torus { major, minor } => major.is_finite() && minor.is_finite(),
                Shape::Swept { net, direction } => {
                    (1..=suture_bernstein::MAX_DEGREE + 1).contains(&net.len())
                        && net.iter().all(|p| p.is_finite())
                        && direction.is_finite()
                }
                Shape::Bulges { height, frequency } => height.is_finite() && frequency.is_finite(),
            }
    }

    /// The point at `(a, b)` in any number type.
    pub fn at<R: Real>(&self, a: R, b: R) -> [R; 3] {
        let c = R::of;
        let ball = |r: DVec3| {
            let ((sa, ca), (sb, cb)) = (a.sin_cos(), b.sin_cos());
            [c(r.x) * sb * ca, c(r.y) * sb * sa, c(r.z) * cb]
        };
        let round = |r: R, z: R| {
            let (s, k) = a.sin_cos();
            [r * k, r * s, z]
        };
        let local = match &self.shape {
            Shape::Plane => [a, b, c(0.0)],
            Shape::Cylinder { radius } => round(c(*radius), b),
            Shape::Cone { radius, slope } => round(c(*radius) + c(*slope) * b, b),
            Shape::Sphere { radius } => ball(DVec3::splat(*radius)),
            Shape::Ellipsoid { radii } => ball(*radii),
            Shape::Torus { major, minor } => {
                let (s, k) = b.sin_cos();
                round(c(*major) + c(*minor) * k, c(*minor) * s)
            }
            Shape::Swept { net, direction } => {
                let p = crate::spline::bezier_curve(net, a);
                [0, 1, 2].map(|i| p[i] + c(direction[i]) * b)
            }
            Shape::Bulges { height, frequency } => {
                let (_, p) = (c(frequency.x) * a).sin_cos();
                let (_, q) = (c(frequency.y) * b).sin_cos();
                [a, b, c(*height) * p * q]
            }
        };
        [0, 1, 2].map(|i| {
            c(self.origin[i]) + c(self.x[i]) * local[0] + c(self.y[i]) * local[1] + c(self.z[i]) * local[2]
        })
    }
}

impl Constituent for Analytic {
    fn jet(&self, at: DVec2) -> Jet2 {
        jet2(&self.at(Taylor::<f64, 3>::u(at.x), Taylor::<f64, 3>::v(at.y)))
    }

    fn expand(&self, u: &Expansion, v: &Expansion) -> Option<[Expansion; 3]> {
        Some(self.at(*u, *v))
    }

    fn enclose(&self, u: &Enclosure, v: &Enclosure) -> Option<[Enclosure; 3]> {
        Some(self.at(*u, *v))
    }

    fn record(&self, _: &mut SplinePool) -> Option<Record> {
        let data = serde_json::to_value(self).ok()?;
        Some(Record { kind: crate::record::ANALYTIC.into(), data })
    }
}

impl From<Analytic> for Arc<dyn Constituent> {
    fn from(surface: Analytic) -> Self {
        Arc::new(surface)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jets_match_differences_and_json_round_trips() {
        let shapes = [
            Shape::Plane,
            Shape::Cylinder { radius: 2.0 },
            Shape::Cone { radius: 1.0, slope: -0.3 },
            Shape::Sphere { radius: 1.5 },
            Shape::Ellipsoid { radii: DVec3::new(1.0, 2.0, 3.0) },
            Shape::Torus { major: 3.0, minor: 1.0 },
            Shape::Swept { net: vec![DVec3::ZERO, DVec3::X, DVec3::ONE], direction: DVec3::Y },
            Shape::Bulges { height: 0.2, frequency: DVec2::new(2.0, 3.0) },
        ];
        for shape in shapes {
            let s = Analytic { origin: DVec3::ONE, x: DVec3::new(1.0, 0.2, 0.0), ..Analytic::new(shape) };
            assert!(s.valid());
            let (at, h) = (DVec2::new(0.4, 0.7), 1e-5);
            let j = s.jet(at);
            let p = |du: f64, dv: f64| s.jet(at + DVec2::new(du, dv));
            assert!(((p(h, 0.0).p - p(-h, 0.0).p) / (2.0 * h)).distance(j.du) < 1e-8);
            assert!(((p(h, 0.0).du - p(-h, 0.0).du) / (2.0 * h)).distance(j.duu) < 1e-8);
            assert!(((p(0.0, h).du - p(0.0, -h).du) / (2.0 * h)).distance(j.duv) < 1e-8);
            assert!(((p(0.0, h).dv - p(0.0, -h).dv) / (2.0 * h)).distance(j.dvv) < 1e-8);
            let json = serde_json::to_string(&s).unwrap();
            assert_eq!(serde_json::from_str::<Analytic>(&json).unwrap(), s);
        }
    }

    #[test]
    fn a_surface_without_frame_reads_in_the_standard_one() {
        let s: Analytic = serde_json::from_str(r#"{"type": "sphere", "radius": 2}"#).unwrap();
        assert_eq!(s, Analytic::new(Shape::Sphere { radius: 2.0 }));
    }
}

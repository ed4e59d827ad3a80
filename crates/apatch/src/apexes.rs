//! Where the apexes of a face go: directions and heights (specification, sections 2 and 9).

use glam::DVec3;

use crate::ApatchOptions;
use crate::coefficients::Corners;
use crate::hull::Class;

/// The apexes of one face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apexes {
    /// `u` and `v`.
    pub(crate) points: [Option<DVec3>; 2],
    /// The unit direction from the centroid to `u`.
    pub(crate) d: DVec3,
    /// Whether that is not the normal of the face.
    pub(crate) turned: bool,
    /// Whether even the best direction is steeper than wanted.
    pub(crate) steep: bool,
}

impl Apexes {
    /// The apexes of a face without any.
    pub(crate) const NONE: Self = Self { points: [None; 2], d: DVec3::ZERO, turned: false, steep: false };
}

/// Cosine of the largest angle (about 107 degrees) between a normal and a face for which a tetrahedron is built by all means.
const FARTHEST: f64 = -0.3;

/// Least cosine between an apex direction and a normal, by all means.
const LEAST_LIFT: f64 = 1e-3;

/// What does not depend on the direction.
pub(crate) struct Site {
    sides: [bool; 2],
    c: DVec3,
    /// Square root of the area.
    pub(crate) ell: f64,
    eps: f64,
    steepness: f64,
    pub(crate) normal: DVec3,
    pub(crate) units: [DVec3; 3],
    /// `m_k` at the centroid.
    at: [f64; 3],
    /// The gradients of `m_k`: affine functions of the apex.
    rise: [DVec3; 3],
    /// `(p_l − c)·g_l / |g_l|`.
    below: [f64; 3],
}

/// How a direction does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) points: [Option<DVec3>; 2],
    /// The larger of the two heights, in units of [`Site::ell`].
    pub(crate) height: f64,
    /// Least cosine between the direction and the normals of the face and its corners.
    pub(crate) lift: f64,
    /// Whether every `m_k` grows along the direction.
    pub(crate) rises: bool,
}

impl Site {
    pub(crate) fn new(corners: &Corners, class: Class, options: &ApatchOptions) -> Self {
        let [a, b, c] = corners.p;
        let ell = (0.5 * (b - a).cross(c - a).length()).sqrt();
        let (normal, units) = normals(corners);
        let c = corners.centroid();
        Self {
            sides: class.sides(),
            c,
            ell,
            eps: options.clearance * ell,
            steepness: options.steepness,
            normal,
            units,
            at: corners.m(c, &corners.h(c)),
            rise: corners.m_gradients(),
            below: [0, 1, 2].map(|l| (corners.p[l] - c).dot(units[l])),
        }
    }

    /// Mean of the normals at the corners.
    pub(crate) fn mean(&self) -> DVec3 {
        (self.units[0] + self.units[1] + self.units[2]).normalize_or_zero()
    }

    /// The normals of the face and its corners.
    fn facing(&self) -> [DVec3; 4] {
        [self.normal, self.units[0], self.units[1], self.units[2]]
    }

    /// Centre of the smallest cap of directions around the face normal and the vertex normals: it rises above all of them if any does.
    pub(crate) fn cap_centre(&self) -> DVec3 {
        cap_centre(&self.facing())
    }

    /// The same with the gradients of the `m_k`: every `m_k` grows along it too if there is such a direction.
    pub(crate) fn rising_centre(&self) -> DVec3 {
        let [a, b, c] = self.rise.map(DVec3::normalize_or_zero);
        let [n, x, y, z] = self.facing();
        cap_centre(&[n, x, y, z, a, b, c])
    }

    /// Least cosine between a direction and the normals.
    pub(crate) fn lift(&self, d: DVec3) -> f64 {
        self.units.iter().fold(d.dot(self.normal), |m, g| m.min(d.dot(*g)))
    }

    /// Whether a direction keeps the wanted distance from all tangent planes.
    pub(crate) fn is_good(&self, placed: &Placed) -> bool {
        placed.lift > self.steepness && placed.rises
    }

    /// The lowest apexes in a direction that are high enough: beyond the tangent planes, with every `m_k` of the right sign.
    pub(crate) fn place(&self, d: DVec3) -> Placed {
        let (mut up, mut down) = (self.eps, -self.eps);
        for l in 0..3 {
            let t = self.below[l] / d.dot(self.units[l]);
            (up, down) = (up.max(t + self.eps), down.min(t - self.eps));
        }
        let mut rises = true;
        for k in 0..3 {
            let slope = d.dot(self.rise[k]);
            if slope > 0.0 {
                let t = -self.at[k] / slope;
                (up, down) = (up.max(t), down.min(t));
            } else {
                rises = false;
            }
        }
        let [above, below] = self.sides;
        Placed {
            points: [above.then(|| self.c + d * up), below.then(|| self.c + d * down)],
            height: if above { up } else { 0.0 }.max(if below { -down } else { 0.0 }) / self.ell,
            lift: self.lift(d),
            rises,
        }
    }

    /// The apexes over the face normal, or over another direction where that is too steep; the corner whose normal stands worst where no
    /// direction rises above all tangent planes.
    pub(crate) fn first(&self) -> Result<Apexes, usize> {
        let made = |d: DVec3, placed: &Placed, i: usize, steep: bool| Apexes {
            points: placed.points,
            d,
            turned: i != 0,
            steep,
        };
        // Normals far on the other side are a mistake of the input, not a steep place.
        let facing = self.units.iter().all(|g| g.dot(self.normal) > FARTHEST);
        let mut best: Option<(f64, Apexes)> = None;
        for i in 0..4 {
            let d = match i {
                0 => self.normal,
                1 => self.mean(),
                2 => self.cap_centre(),
                _ => self.rising_centre(),
            };
            let placed = self.place(d);
            if self.is_good(&placed) {
                return Ok(made(d, &placed, i, false));
            }
            // Steep ones where nothing else is left; those under which an m_k does not rise last of all.
            let rank = if placed.rises { placed.lift } else { placed.lift - 1.0 };
            if placed.lift > LEAST_LIFT && (placed.rises || facing) && best.is_none_or(|b| rank > b.0) {
                best = Some((rank, made(d, &placed, i, true)));
            }
        }
        best.map(|b| b.1).ok_or_else(|| {
            let lift = |k: usize| self.units[k].dot(self.normal);
            (0..3).fold(0, |w, k| if lift(k) < lift(w) { k } else { w })
        })
    }
}

/// Unit normals of a face and of its corners.
pub(crate) fn normals(corners: &Corners) -> (DVec3, [DVec3; 3]) {
    let [a, b, c] = corners.p;
    ((b - a).cross(c - a).normalize_or_zero(), corners.g.map(DVec3::normalize_or_zero))
}

/// Centre of the smallest cap around unit vectors, by the two or three on its rim.
fn cap_centre(all: &[DVec3]) -> DVec3 {
    let mut best = (f64::NEG_INFINITY, all.first().copied().unwrap_or_default());
    let mut offer = |d: DVec3| {
        let least = all.iter().fold(f64::INFINITY, |m, v| m.min(v.dot(d)));
        if least > best.0 {
            best = (least, d);
        }
    };
    for i in 0..all.len() {
        for j in 0..i {
            offer((all[i] + all[j]).normalize_or_zero());
            for k in 0..j {
                let d = (all[i] - all[j]).cross(all[j] - all[k]).normalize_or_zero();
                offer(d);
                offer(-d);
            }
        }
    }
    best.1
}

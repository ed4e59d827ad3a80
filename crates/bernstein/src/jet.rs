//! Value and partials to second order, with the rules that combine them.

use glam::{DVec2, DVec3};

use crate::Vector;

/// Value and all partials to second order, at one point, of a function of two variables.
///
/// `Jet2` (of `DVec3`) is the jet of a patch, `Jet2<f64>` that of a weight, `Jet2<DVec2>` that of a map between parameter planes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Jet2<T = DVec3> {
    /// Value.
    pub p: T,
    /// First partial in `u`.
    pub du: T,
    /// First partial in `v`.
    pub dv: T,
    /// Second partial in `u`.
    pub duu: T,
    /// Mixed partial.
    pub duv: T,
    /// Second partial in `v`.
    pub dvv: T,
}

impl<T: Vector> Jet2<T> {
    /// The jet of a constant.
    pub fn constant(p: T) -> Self {
        Self { p, ..Self::default() }
    }

    /// Applies the linear map `f` to every entry.
    pub fn map<S>(self, f: impl Fn(T) -> S) -> Jet2<S> {
        Jet2 {
            p: f(self.p),
            du: f(self.du),
            dv: f(self.dv),
            duu: f(self.duu),
            duv: f(self.duv),
            dvv: f(self.dvv),
        }
    }

    /// Sum of two functions.
    pub fn add(self, other: Self) -> Self {
        Self {
            p: self.p + other.p,
            du: self.du + other.du,
            dv: self.dv + other.dv,
            duu: self.duu + other.duu,
            duv: self.duv + other.duv,
            dvv: self.dvv + other.dvv,
        }
    }

    /// Product rule: the jet of `w · self` for a scalar weight `w` of the same variables.
    pub fn weighted(self, w: &Jet2<f64>) -> Self {
        Self {
            p: self.p * w.p,
            du: self.du * w.p + self.p * w.du,
            dv: self.dv * w.p + self.p * w.dv,
            duu: self.duu * w.p + self.du * (2.0 * w.du) + self.p * w.duu,
            duv: self.duv * w.p + self.du * w.dv + self.dv * w.du + self.p * w.duv,
            dvv: self.dvv * w.p + self.dv * (2.0 * w.dv) + self.p * w.dvv,
        }
    }

    /// Chain rule: `self` is the jet of `F` at `map.p`; returns the jet of `F ∘ map` in the variables of `map`.
    pub fn compose(&self, map: &Jet2<DVec2>) -> Self {
        let first = |d: DVec2| self.du * d.x + self.dv * d.y;
        let second = |a: DVec2, b: DVec2| {
            self.duu * (a.x * b.x) + self.duv * (a.x * b.y + a.y * b.x) + self.dvv * (a.y * b.y)
        };
        Self {
            p: self.p,
            du: first(map.du),
            dv: first(map.dv),
            duu: second(map.du, map.du) + first(map.duu),
            duv: second(map.du, map.dv) + first(map.duv),
            dvv: second(map.dv, map.dv) + first(map.dvv),
        }
    }

    /// Whether every entry is finite.
    pub fn finite(&self) -> bool {
        [self.p, self.du, self.dv, self.duu, self.duv, self.dvv].into_iter().all(Vector::finite)
    }
}

impl Jet2<DVec3> {
    /// Unit normal `S_u × S_v / |S_u × S_v|`, or `None` where the patch is singular: `|S_u × S_v| ≤ ε |S_u| |S_v|` with `ε` a
    /// few rounding errors, so that the verdict does not depend on units.
    pub fn normal(&self) -> Option<DVec3> {
        let n = self.du.cross(self.dv);
        (n.length() > 16.0 * f64::EPSILON * self.du.length() * self.dv.length()).then(|| n.normalize())
    }
}

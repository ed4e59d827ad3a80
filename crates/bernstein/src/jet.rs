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

    /// Sum of two functions; also the operator `+`.
    #[expect(
        clippy::should_implement_trait,
        reason = "callers chain it with the other rules without an import"
    )]
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

impl<T: Vector> std::ops::Add for Jet2<T> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::add(self, other)
    }
}

impl Jet2<DVec3> {
    /// Unit normal `S_u × S_v / |S_u × S_v|`, or `None` where the patch is singular: `|S_u × S_v| ≤ ε |S_u| |S_v|` with `ε` a
    /// few rounding errors, so that the verdict does not depend on units.
    pub fn normal(&self) -> Option<DVec3> {
        // Scaled first: neither tiny nor huge units may under- or overflow in the products. NaN fails the comparison.
        let (a, b) = (self.du / self.du.abs().max_element(), self.dv / self.dv.abs().max_element());
        let n = a.cross(b);
        (n.length() > 16.0 * f64::EPSILON * a.length() * b.length()).then(|| n.normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The jet at `at` of the quadratic with coefficients `c` of `1, u, v, u², u v, v²`.
    fn quadratic(c: [f64; 6], at: DVec2) -> Jet2<f64> {
        let DVec2 { x: u, y: v } = at;
        Jet2 {
            p: c[0] + c[1] * u + c[2] * v + c[3] * u * u + c[4] * u * v + c[5] * v * v,
            du: c[1] + 2.0 * c[3] * u + c[4] * v,
            dv: c[2] + c[4] * u + 2.0 * c[5] * v,
            duu: 2.0 * c[3],
            duv: c[4],
            dvv: 2.0 * c[5],
        }
    }

    fn join(x: Jet2<f64>, y: Jet2<f64>) -> Jet2<DVec2> {
        x.map(|x| DVec2::new(x, 0.0)).add(y.map(|y| DVec2::new(0.0, y)))
    }

    #[track_caller]
    fn check(got: Jet2<f64>, want: Jet2<f64>, scale: f64) {
        let entries = |j: Jet2<f64>| [j.p, j.du, j.dv, j.duu, j.duv, j.dvv];
        for (g, w) in entries(got).into_iter().zip(entries(want)) {
            assert!((g - w).abs() <= 1e-13 * scale, "{got:?} ≠ {want:?}");
        }
    }

    fn coefficients() -> impl Strategy<Value = [f64; 6]> {
        prop::array::uniform6(-1.0..1.0)
    }

    proptest! {
        #[test]
        fn product_rule((a, b) in (coefficients(), coefficients()), u in -1.0..1.0, v in -1.0..1.0) {
            // The square of the sum against the sum of squares: (f + g)² − (f − g)² = 4 f g.
            let at = DVec2::new(u, v);
            let (f, g) = (quadratic(a, at), quadratic(b, at));
            let (sum, difference) = (f + g, f + g.map(|x| -x));
            let left = sum.weighted(&sum) + difference.weighted(&difference).map(|x| -x);
            check(left, f.weighted(&g).map(|x| 4.0 * x), 1e3);
            check(f.weighted(&g), g.weighted(&f), 1e3);
        }

        #[test]
        fn product_of_lines_is_the_quadratic(
            [a, b, c, d, e, f] in prop::array::uniform6(-1.0..1.0_f64), u in -1.0..1.0, v in -1.0..1.0
        ) {
            let at = DVec2::new(u, v);
            let (l, m) = (quadratic([a, b, c, 0.0, 0.0, 0.0], at), quadratic([d, e, f, 0.0, 0.0, 0.0], at));
            let product = [a * d, a * e + b * d, a * f + c * d, b * e, b * f + c * e, c * f];
            check(l.weighted(&m), quadratic(product, at), 1e2);
        }

        #[test]
        fn chain_rule(c in coefficients(), x in coefficients(), y in coefficients(), u in -1.0..1.0, v in -1.0..1.0) {
            // F(X, Y) by the product rule alone against the chain rule.
            let at = DVec2::new(u, v);
            let (x, y) = (quadratic(x, at), quadratic(y, at));
            let one = Jet2::constant(1.0);
            let terms = [one, x, y, x.weighted(&x), x.weighted(&y), y.weighted(&y)];
            let want = terms.into_iter().zip(c).fold(Jet2::default(), |sum, (t, c)| sum + t.map(|t| c * t));
            let map = join(x, y);
            check(quadratic(c, map.p).compose(&map), want, 1e3);
        }

        #[test]
        fn composing_with_the_identity_changes_nothing(c in coefficients(), u in -1.0..1.0, v in -1.0..1.0) {
            let at = DVec2::new(u, v);
            let identity = Jet2 { p: at, du: DVec2::X, dv: DVec2::Y, ..Jet2::default() };
            prop_assert_eq!(quadratic(c, at).compose(&identity), quadratic(c, at));
        }
    }

    #[test]
    fn the_normal_ignores_units_and_sees_singular_points() {
        let jet =
            |scale: f64| Jet2 { du: DVec3::X * scale, dv: (DVec3::X + DVec3::Y) / scale, ..Jet2::default() };
        for scale in [1.0, 1e-200, 1e200, f64::from_bits(1 << 60)] {
            assert!(jet(scale).normal().unwrap().distance(DVec3::Z) < 1e-15, "{scale}");
        }
        let singular = |du, dv| Jet2 { du, dv, ..Jet2::default() }.normal();
        assert_eq!(singular(DVec3::ZERO, DVec3::X), None);
        assert_eq!(singular(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, 0.6, 0.9)), None);
        assert_eq!(singular(DVec3::NAN, DVec3::X), None);
    }
}

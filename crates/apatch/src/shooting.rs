//! The shooting polynomial: a cubic along a ray from the mesh to an apex, its minimal root and the bound that makes it simple.

/// Coefficients `B₀..B₃` of `P(t) = Σ B_s B_s³(t)` along the ray `(1 − t) q + t A`, multiplied by the sign of the side, so that
/// `B₀ ≤ 0` where the surface lies over `q` on this side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shooting(pub [f64; 4]);

/// The root that the surface takes on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Parameter on the ray, 0 at the mesh, 1 at the apex.
    pub t: f64,
    /// Whether `t` is the minimal root and simple. Otherwise the ray has no such root and `t` is where it comes closest to one.
    pub simple: bool,
}

impl Shooting {
    /// Coefficients of `1, t, t², t³`.
    fn powers(&self) -> [f64; 4] {
        let [b0, b1, b2, b3] = self.0;
        [b0, 3.0 * (b1 - b0), 3.0 * (b2 - 2.0 * b1 + b0), b3 - 3.0 * b2 + 3.0 * b1 - b0]
    }

    /// The minimal root by Newton's method, bracketed where the method alone does not prove which root it found.
    pub fn root(&self) -> Root {
        let [b0, b1, b2, _] = self.0;
        if b0 >= 0.0 {
            // Also where the ray starts on the other side: the surface is not on this one.
            return Root { t: 0.0, simple: true };
        }
        let c = self.powers();
        if c[1] > 0.0 {
            let disc = c[1] * c[1] - 4.0 * c[2] * c[0];
            let start = if disc >= 0.0 { -2.0 * c[0] / (c[1] + disc.sqrt()) } else { -c[0] / c[1] };
            if let Some(t) = newton(&c, start) {
                // Left part of the subdivision at the root, (B₀, F₁, F₂, 0): without a sign change no root comes before it.
                let (f1, f12) = (b0 * (1.0 - t) + b1 * t, b1 * (1.0 - t) + b2 * t);
                let f2 = f1 * (1.0 - t) + f12 * t;
                if f1 <= 0.0 && f2 < 0.0 {
                    return Root { t, simple: true };
                }
            }
        }
        self.bracketed()
    }

    /// The minimal root by bisection and Newton's method between 0 and the parameter where the bound is taken: `P(t)/t²` rises all the
    /// way there, so that it holds exactly one root.
    pub fn bracketed(&self) -> Root {
        let b0 = self.0[0];
        if b0 >= 0.0 {
            return Root { t: 0.0, simple: true };
        }
        let c = self.powers();
        let t1 = first_root_of_psi(&c).unwrap_or(1.0);
        let value = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        // Not `<=`: a ray that is not a number has no root.
        if !(value(t1) > 0.0) {
            return Root { t: t1, simple: false };
        }
        let (mut lo, mut hi) = (0.0, t1);
        let mut t = 0.5 * t1;
        for _ in 0..100 {
            let (f, d) = (value(t), c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]));
            if f > 0.0 {
                hi = t;
            } else {
                lo = t;
            }
            let step = t - f / d;
            let next = if step > lo && step < hi { step } else { 0.5 * (lo + hi) };
            if (next - t).abs() <= f64::EPSILON * t {
                t = next;
                break;
            }
            t = next;
        }
        Root { t, simple: true }
    }

    /// The minimal root by Cardano's formulas and one Newton step; the bracketed root where the leading coefficient is small.
    ///
    /// # References
    /// G. Xu, H. Huang, C. Bajaj, *C¹ modeling with A-patches from rational trivariate functions*, 2001, Equations (4.18)–(4.21);
    /// the branch is decided ray by ray from the signs of the coefficients.
    pub fn cardano(&self) -> Root {
        let [d, c, b, a] = self.0;
        let scale = self.0.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if !(d < 0.0 && c >= 0.0 && a.abs() >= 1e-4 * scale) {
            return self.bracketed();
        }
        let p = 3.0 * (a * c - b * b) / (a * a);
        let q = (2.0 * b * b * b - 3.0 * a * b * c + a * a * d) / (a * a * a);
        let delta = (0.5 * q).powi(2) + (p / 3.0).powi(3);
        let x = if delta >= 0.0 {
            let root = delta.sqrt();
            (-0.5 * q + root).cbrt() + (-0.5 * q - root).cbrt()
        } else {
            let r = (-p / 3.0).sqrt();
            let theta = (-delta).sqrt().atan2(-0.5 * q);
            let turn = if a < 0.0 {
                -std::f64::consts::TAU / 3.0
            } else if b < 0.0 {
                std::f64::consts::TAU / 3.0
            } else {
                0.0
            };
            2.0 * r * (theta / 3.0 + turn).cos()
        };
        let s = x - b / a;
        let start = s / (1.0 + s);
        // Cancellation costs the formulas half their digits.
        match newton(&self.powers(), start) {
            Some(t) => Root { t, simple: true },
            None => self.bracketed(),
        }
    }

    /// Infimum of all `D` such that `P + D β t²` has a minimal root in `(0, 1)` that is simple; `−∞` where `B₀ ≥ 0` (the root is
    /// then `t = 0`). Falls when any coefficient rises, so that lower bounds of the coefficients give an upper bound.
    ///
    /// # References
    /// Xu, Huang, Bajaj (2001), Lemma 2.3; the crossing of `3 F₂` and `F₃` is a root of a cubic without quadratic term.
    pub fn required(&self, beta: f64) -> f64 {
        let [b0, b1, b2, _] = self.0;
        if b0 >= 0.0 {
            return f64::NEG_INFINITY;
        }
        let c = self.powers();
        match first_root_of_psi(&c) {
            Some(t) => -(c[0] / (t * t) + c[1] / t + c[2] + c[3] * t) / beta,
            None => {
                let tau = if b1 > b0 { (b0 / (b0 - b1)).min(1.0) } else { 1.0 };
                let (f1, f12) = (b0 * (1.0 - tau) + b1 * tau, b1 * (1.0 - tau) + b2 * tau);
                -3.0 * (f1 * (1.0 - tau) + f12 * tau) / (tau * tau * beta)
            }
        }
    }

    /// Whether [`required`](Self::required) is negative: the root is there without any increment. Cheaper, as the coefficients mostly tell.
    #[inline]
    pub fn is_content(&self) -> bool {
        let [b0, _, b2, b3] = self.0;
        // One change of sign, whatever B₁ is: one root.
        b0 >= 0.0 || (b2 > 0.0 && b3 > 0.0) || self.required(1.0) < 0.0
    }

    /// All coefficients of the other sign.
    pub(crate) fn negative(self) -> Self {
        Self(self.0.map(|b| -b))
    }

    /// An increment that suffices for all polynomials between this one and `high`, as [`required`](Self::required) does, but no more than
    /// [`required_sharp`](Self::required_sharp) when the two are one: where `P` is positive at some `t` up to which `P/t²` rises, it holds
    /// one root. That it rises is the sign of `ψ`, which grows with `B₀`, `B₁` and `B₂` and falls with `B₃`.
    pub(crate) fn required_up_to(&self, high: &Self) -> f64 {
        let lemma = self.required(1.0);
        let [h0, h1, h2, _] = high.0;
        // Not `<`: what is not a number rises nowhere.
        if !(h0 < 0.0) {
            return lemma;
        }
        let t = first_root_of_psi(&Self([h0, h1, h2, self.0[3]]).powers()).unwrap_or(1.0);
        let c = self.powers();
        lemma.min(-(c[0] / (t * t) + c[1] / t + c[2] + c[3] * t))
    }

    /// The same for one ray, where the sharp value is known: `−P(t)/(β t²)` at its first minimum.
    pub fn required_sharp(&self, beta: f64) -> f64 {
        if self.0[0] >= 0.0 {
            return f64::NEG_INFINITY;
        }
        let c = self.powers();
        let t = first_root_of_psi(&c).unwrap_or(1.0);
        -(c[0] / (t * t) + c[1] / t + c[2] + c[3] * t) / beta
    }
}

/// Newton's method for the cubic of power coefficients `c`; `None` unless it settles in `(0, 1)` on a rising root.
fn newton(c: &[f64; 4], start: f64) -> Option<f64> {
    let mut t = start;
    for _ in 0..12 {
        let f = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        let d = c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
        if !(d > 0.0) {
            return None;
        }
        let next = t - f / d;
        if !(next > 0.0 && next < 1.0) {
            return None;
        }
        // Convergence is quadratic: the next step would change nothing.
        let close = (next - t).abs() <= 1e-9 * next;
        t = next;
        if close {
            return Some(t);
        }
    }
    None
}

/// First root in `(0, 1]` of `ψ(t) = 2 c₀ + c₁ t − c₃ t³`, `c₀ < 0`: where `P(t)/t²` stops to rise.
fn first_root_of_psi(c: &[f64; 4]) -> Option<f64> {
    let [c0, c1, _, c3] = *c;
    let psi = |t: f64| 2.0 * c0 + t * (c1 - c3 * t * t);
    let mut t;
    if c3 > 0.0 {
        if !(c1 > 0.0) {
            return None;
        }
        let top = (c1 / (3.0 * c3)).sqrt().min(1.0);
        if psi(top) < 0.0 {
            return None;
        }
        // Concave and rising up to `top`: Newton's method climbs monotonically from the left.
        t = (-2.0 * c0 / c1).min(top);
    } else {
        if !(psi(1.0) >= 0.0) {
            return None;
        }
        // Convex: it descends monotonically from the right.
        t = 1.0;
    }
    for _ in 0..60 {
        let d = c1 - 3.0 * c3 * t * t;
        if !(d > 0.0) {
            break;
        }
        let next = (t - psi(t) / d).clamp(f64::MIN_POSITIVE, 1.0);
        let close = (next - t).abs() <= 1e-10 * t;
        t = next;
        if close {
            break;
        }
    }
    Some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whether `t` is the first zero of the cubic: no positive value before it, one right behind it. The samples lie relative to
    /// `t`: the cubic may be positive on no more than 3e-4 of it before it falls again.
    fn is_first_root(b: &Shooting, t: f64) -> bool {
        const SAMPLES: u32 = 20_000;
        let c = b.powers();
        let value = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        let share = |i: u32| f64::from(i) / f64::from(SAMPLES);
        (0..SAMPLES).all(|i| value(share(i) * t) <= 0.0)
            && (1..=SAMPLES).any(|i| value(t * (1.0 + 0.01 * share(i))) > 0.0)
    }

    fn admissible() -> impl Strategy<Value = [f64; 4]> {
        (0.001..1.0f64, 0.0..2.0f64, -2.0..3.0f64, -3.0..3.0f64).prop_map(|(d, c, b, a)| [-d, c, b, a])
    }

    proptest! {
        #[test]
        fn above_the_bound_the_root_is_minimal_and_simple(mut b in admissible(), margin in 1e-3..1.0f64) {
            let needed = Shooting(b).required_sharp(1.0);
            b[2] += (needed + margin) / 3.0;
            b[3] += needed + margin;
            let shot = Shooting(b);
            let root = shot.root();
            prop_assert!(root.simple);
            prop_assert!(is_first_root(&shot, root.t), "{root:?}");
            prop_assert!((shot.bracketed().t - root.t).abs() < 1e-12);
        }

        #[test]
        fn cardano_finds_the_same_root(mut b in admissible(), margin in 1e-2..1.0f64) {
            let needed = Shooting(b).required_sharp(1.0);
            b[2] += (needed + margin) / 3.0;
            b[3] += needed + margin;
            let (x, y) = (Shooting(b).cardano(), Shooting(b).bracketed());
            prop_assert!((x.t - y.t).abs() < 1e-9, "{x:?} {y:?}");
        }

        #[test]
        fn below_the_bound_there_is_no_root_before_the_bracket(mut b in admissible(), margin in 1e-3..1.0f64) {
            let needed = Shooting(b).required_sharp(1.0);
            b[2] += (needed - margin) / 3.0;
            b[3] += needed - margin;
            prop_assert!(!Shooting(b).bracketed().simple);
        }

        #[test]
        fn lower_coefficients_need_no_less(b in admissible(), less in prop::array::uniform4(0.0..0.5)) {
            let low = Shooting([0, 1, 2, 3].map(|i| b[i] - less[i]));
            prop_assert!(low.required(1.0) >= Shooting(b).required(1.0) - 1e-9);
            prop_assert!(Shooting(b).required(1.0) >= Shooting(b).required_sharp(1.0) - 1e-9);
            prop_assert!(!low.is_content() || low.required_sharp(1.0) < 1e-9);
        }
    }

    proptest! {
        /// What is asked for a box of coefficients suffices for all polynomials in it, and is no more than they need when it is small.
        #[test]
        fn increments_for_boxes_suffice(
            b in admissible(), half in prop::array::uniform4(0.0..0.3f64),
            at in prop::collection::vec(prop::array::uniform4(-1.0..1.0f64), 3),
        ) {
            for size in [1.0, 0.1, 0.01, 0.0] {
                let mixed = |x: [f64; 4]| [0, 1, 2, 3].map(|i| b[i] + x[i] * size * half[i]);
                let need = Shooting(mixed([-1.0; 4])).required_up_to(&Shooting(mixed([1.0; 4])));
                for &x in &at {
                    let mut p = mixed(x);
                    prop_assert!(Shooting(p).required_sharp(1.0) <= need + 1e-9);
                    p[2] += (need + 1e-3) / 3.0;
                    p[3] += need + 1e-3;
                    let root = Shooting(p).root();
                    prop_assert!(root.simple && (p[0] >= 0.0 || is_first_root(&Shooting(p), root.t)), "{p:?} {root:?}");
                }
                if size == 0.0 {
                    prop_assert!((need - Shooting(b).required_sharp(1.0)).abs() < 1e-9 * (1.0 + need.abs()));
                }
            }
        }
    }

    /// The branch at which the printed rule is silent: the leading coefficient changes its sign, the root does not jump.
    #[test]
    fn the_branch_changes_with_the_sign_of_the_leading_coefficient() {
        for (a, want) in [(0.05, 0.3131), (-0.05, 0.3147)] {
            let shot = Shooting([-1.0, 0.5, 0.5, a]);
            assert!((shot.cardano().t - want).abs() < 1e-4, "{:?}", shot.cardano());
        }
    }

    #[test]
    fn anything_at_all_is_survived() {
        for x in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e308, -1e308, 0.0, 1e-320] {
            for k in 0..4 {
                let mut b = [-1.0, 0.5, 0.5, 1.0];
                b[k] = x;
                let (r, s) = (Shooting(b).root(), Shooting(b).cardano());
                let _ = (r, s, Shooting(b).required(1.0));
            }
        }
    }
}

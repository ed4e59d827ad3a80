//! The surfaces and curves of the specification's reference cases.
#![allow(dead_code, unreachable_pub)]

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use suture_coons::{
    Blend, BlendFunction, BorderCurve, Constituent, CurveData, Enclosure, Expansion, FourSided, Real, Taylor,
    border_curve,
};
use suture_surface::Jet2;

pub type Sheet = Arc<dyn Constituent>;
pub type Border = Arc<dyn BorderCurve>;

#[derive(Clone, Copy, Debug)]
pub enum Case {
    S1,
    S2,
    T1,
    T2,
    T3,
}

/// `e^(x/2 − 1/2)` by its series about the constant term.
fn exp_half<R: Real + FromF64>(v: Taylor<R, 4>) -> Taylor<R, 4> {
    let e = R::enclosing(((v.mid() - 1.0) / 2.0).exp());
    let mut c = vec![e];
    for k in 1..4 {
        c.push(c[k - 1] * R::of(0.5 / k as f64));
    }
    v.apply(&c)
}

/// A number known to a few units in the last place.
pub trait FromF64: Sized {
    fn enclosing(x: f64) -> Self;
}

impl FromF64 for f64 {
    fn enclosing(x: f64) -> Self {
        x
    }
}

impl FromF64 for suture_coons::Interval {
    fn enclosing(x: f64) -> Self {
        Self { lo: x.next_down().next_down(), hi: x.next_up().next_up() }
    }
}

impl Case {
    pub fn sheet(self) -> Sheet {
        Arc::new(self)
    }

    fn at<R: Real + FromF64>(self, u: Taylor<R, 4>, v: Taylor<R, 4>) -> [Taylor<R, 4>; 3] {
        type T<R> = Taylor<R, 4>;
        let c = |x: f64| T::<R>::of(x);
        match self {
            Self::S1 => {
                let (s, _) = v.sin_cos();
                let (k, _) = (c(1.3) * u + c(0.2)).sin_cos();
                let (_, l) = (c(0.9) * v).sin_cos();
                [u + s * c(0.1), v + u * u * c(0.05), c(0.4) * k * l + c(0.15) * v * v]
            }
            Self::S2 => {
                let (_, k) = (c(2.0) * u).sin_cos();
                let (_, l) = (c(0.7) * u).sin_cos();
                let z = c(0.3) * l * exp_half(v) - c(0.2) * u * v;
                [u + c(0.08) * v * (c(1.0) - v), v + c(0.03) * k, z]
            }
            Self::T1 | Self::T2 => {
                let ((sp, cp), (sq, cq)) = ((c(FRAC_PI_2) * u).sin_cos(), (c(FRAC_PI_2) * v).sin_cos());
                match self {
                    Self::T1 => [sp * cq, c(0.8) * sp * sq, cp],
                    _ => [c(1.2) * sp * cq, sp * sq, c(0.9) * cp + c(0.1)],
                }
            }
            Self::T3 => {
                let (s, k) = (c(FRAC_PI_2) * v).sin_cos();
                let b = v * v * (c(3.0) - c(2.0) * v);
                let w = c(1.0) - u;
                let z = (c(1.0) - b) * c(FRAC_PI_2) * w + b * (c(0.9 * FRAC_PI_2) * w + c(0.1));
                [k, s, z]
            }
        }
    }
}

impl Constituent for Case {
    fn jet(&self, at: DVec2) -> Jet2 {
        let p = self.at(Expansion::u(at.x), Expansion::v(at.y));
        let d = |i, j| DVec3::new(p[0].partial(i, j), p[1].partial(i, j), p[2].partial(i, j));
        Jet2 { p: d(0, 0), du: d(1, 0), dv: d(0, 1), duu: d(2, 0), duv: d(1, 1), dvv: d(0, 2) }
    }

    fn expand(&self, u: &Expansion, v: &Expansion) -> Option<[Expansion; 3]> {
        Some(self.at(*u, *v))
    }

    fn enclose(&self, u: &Enclosure, v: &Enclosure) -> Option<[Enclosure; 3]> {
        Some(self.at(*u, *v))
    }
}

pub fn case_a_sheets() -> [Sheet; 2] {
    [Case::S1.sheet(), Case::S2.sheet()]
}

/// `v³ (1 − v)³ b` as a Bézier curve.
fn bump(b: DVec3) -> CurveData {
    CurveData::Bezier { net: [0.0, 0.0, 0.0, 1.0 / 20.0, 0.0, 0.0, 0.0].iter().map(|&w| b * w).collect() }
}

/// `C3`, `C4`.
pub fn case_a_borders() -> [Border; 2] {
    let r = case_a_sheets();
    [(0.0, DVec3::new(1.0, -2.0, 4.0)), (1.0, DVec3::new(-1.0, 1.0, -3.0))].map(|(u, b)| {
        let curve = border_curve(&r, u, 2).unwrap();
        let hermite = CurveData::Bezier { net: curve.net().to_vec() };
        CurveData::Sum { of: Box::new([hermite, bump(b)]) }.build().unwrap()
    })
}

pub fn blends(alpha: BlendFunction, beta: BlendFunction) -> [Arc<dyn Blend>; 2] {
    [Arc::new(alpha), Arc::new(beta)]
}

pub fn case_a(alpha: BlendFunction, beta: BlendFunction) -> FourSided {
    FourSided::raw(case_a_sheets(), case_a_borders(), blends(alpha, beta))
}

pub fn blend_named(name: &str) -> BlendFunction {
    let k = name.as_bytes()[name.len() - 1] - b'0';
    match &name[..name.len() - 1] {
        "trig" => BlendFunction::Trigonometric(k),
        "poly" => BlendFunction::Polynomial(k),
        "rat" => BlendFunction::Rational(k),
        _ => BlendFunction::SymmetricRational(k),
    }
}

/// Entries of a jet in the specification's order.
pub fn entries(j: &Jet2) -> [DVec3; 6] {
    [j.p, j.du, j.dv, j.duu, j.duv, j.dvv]
}

/// Largest differences of all six entries between `f` and `r` along an edge, at `n` points.
pub fn edge_maxima(
    f: &dyn Fn(DVec2) -> Jet2,
    r: &dyn Fn(DVec2) -> Jet2,
    edge: impl Fn(f64) -> DVec2,
    n: u32,
) -> [f64; 6] {
    let mut worst = [0.0f64; 6];
    for i in 0..=n {
        let at = edge(f64::from(i) / f64::from(n));
        let (a, b) = (entries(&f(at)), entries(&r(at)));
        (0..6).for_each(|k| worst[k] = worst[k].max(a[k].distance(b[k])));
    }
    worst
}

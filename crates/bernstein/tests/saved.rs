//! Saved nets load to the same bits, and what is loaded is checked like what is built.
#![cfg(feature = "serde")]

mod common;

use common::{curve, patch, spline, surface, triangle};
use glam::DVec3;
use proptest::prelude::*;
use suture_bernstein::{BSplineCurve, BSplineSurface, BezierCurve, BezierPatch, BezierTriangle};

fn reload<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
    serde_json::from_str(&serde_json::to_string(value).unwrap()).unwrap()
}

proptest! {
    #[test]
    fn nets_survive(c in curve(5), s in spline(4), p in patch(4), q in surface(3), t in triangle(5)) {
        prop_assert_eq!(&reload(&c), &c);
        prop_assert_eq!(&reload(&s), &s);
        prop_assert_eq!(&reload(&p), &p);
        prop_assert_eq!(&reload(&q), &q);
        prop_assert_eq!(&reload(&t), &t);
    }
}

#[test]
fn the_form_is_stable() {
    let json = |text: &str| text.replace(' ', "");
    let surface =
        BSplineSurface::new([1, 0], [vec![0.0, 0.0, 1.0, 1.0], vec![0.0, 2.0]], vec![0.5, 1.5]).unwrap();
    let want = r#"{"degree": [1, 0], "knots": [[0.0, 0.0, 1.0, 1.0], [0.0, 2.0]], "net": [0.5, 1.5]}"#;
    assert_eq!(serde_json::to_string(&surface).unwrap(), json(want));
    let curve = BezierCurve::new(vec![DVec3::X]).unwrap();
    assert_eq!(serde_json::to_string(&curve).unwrap(), r#"{"net":[[1.0,0.0,0.0]]}"#);
}

#[test]
fn bad_nets_do_not_load() {
    assert!(serde_json::from_str::<BezierCurve<f64>>(r#"{"net": []}"#).is_err());
    assert!(serde_json::from_str::<BezierPatch<f64>>(r#"{"degree": [3, 3], "net": [1.0]}"#).is_err());
    assert!(serde_json::from_str::<BezierTriangle<f64>>(r#"{"degree": 99, "net": [1.0]}"#).is_err());
    let decreasing = r#"{"degree": 1, "knots": [0, 2, 1, 3], "net": [1.0, 2.0]}"#;
    let error = serde_json::from_str::<BSplineCurve<f64>>(decreasing).unwrap_err();
    assert!(error.to_string().contains("knot 2"), "{error}");
    assert!(
        serde_json::from_str::<BSplineSurface<f64>>(r#"{"degree": [0, 0], "knots": [[], []], "net": []}"#)
            .is_err()
    );
}

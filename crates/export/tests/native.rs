//! The native format: lossless, and patient with what it is given.

mod common;

use common::*;
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use suture_export::{ExportError, Loader, read_native, write_native};
use suture_surface::{RecordError, Surface};

const LOADERS: &[(&str, Loader)] = &[("test.window", load)];

fn file() -> String {
    String::from_utf8(write_native(&two(1.0 / 3.0, DVec3::new(0.1, -1e-17, 1e6))).unwrap()).unwrap()
}

fn refused(text: &str) -> ExportError {
    read_native(text.as_bytes(), LOADERS).unwrap_err()
}

#[test]
fn a_surface_loads_back_to_the_same_bits() {
    let surface = two(1.0 / 3.0, DVec3::new(0.1, -1e-17, 1e6));
    let bytes = write_native(&surface).unwrap();
    let again = read_native(&bytes, LOADERS).unwrap();
    assert_eq!(surface.seams(), again.seams());
    let bits = |s: &Surface, p: usize, at| {
        let j = s.patches()[p].jet(at);
        [j.p, j.du, j.dv, j.duu, j.duv, j.dvv].map(|x| x.to_array().map(f64::to_bits))
    };
    for p in 0..2 {
        assert_eq!(surface.patches()[p].domain(), again.patches()[p].domain());
        for i in 0..50 {
            let at = DVec2::new(f64::from(i) / 25.0, (f64::from(i) * 0.37).fract());
            assert_eq!(bits(&surface, p, at), bits(&again, p, at));
        }
    }
    assert_eq!(bytes, write_native(&again).unwrap());
}

#[test]
fn a_shared_spline_is_written_once() {
    let value: serde_json::Value = serde_json::from_str(&file()).unwrap();
    assert_eq!(value["splines"].as_array().unwrap().len(), 1);
    assert_eq!(value["schema"], 1);
    assert_eq!(value["patches"][1]["type"], "test.window");
    assert_eq!(value["patches"][1]["data"]["spline"], 0);
}

#[test]
fn every_truncation_is_an_error_with_its_place() {
    let file = file();
    for end in 0..file.trim_end().len() {
        match refused(&file[..end]) {
            ExportError::Json { line, .. } => assert!(line <= 1),
            other => panic!("cut at {end}: {other}"),
        }
    }
}

#[test]
fn errors_name_what_is_wrong() {
    let file = file();
    let with = |from: &str, to: &str| {
        assert!(file.contains(from), "{from} in {file}");
        refused(&file.replacen(from, to, 1))
    };
    assert!(matches!(with("\"schema\":1", "\"schema\":7"), ExportError::Schema { found: 7, supported: 1 }));
    assert!(with("\"schema\":1", "\"scheme\":1").to_string().contains("missing field `schema`"));
    assert!(matches!(with("\"degree\":[2,2]", "\"degree\":[99,2]"), ExportError::Spline { index: 0, .. }));
    assert!(matches!(with("\"degree\":[2,2]", "\"degree\":[3,2]"), ExportError::Spline { index: 0, .. }));
    assert!(matches!(with("\"degree\":[2,2]", "\"degree\":[4096,2]"), ExportError::Json { .. }));
    assert!(matches!(with("0.0,0.0,0.0,1.0", "0.0,0.0,2.0,1.0"), ExportError::Spline { index: 0, .. }));
    assert!(matches!(with("0.0,0.0,0.0,1.0", "0.0,0.0,1e999,1.0"), ExportError::Json { .. }));
    let unknown = with("test.window", "blend.nothing");
    assert!(
        matches!(&unknown, ExportError::Patch { index: 0, source: RecordError::UnknownKind { kind } } if kind == "blend.nothing")
    );
    assert_eq!(unknown.to_string(), "patch 0: no method loads patches of type \"blend.nothing\"");
    assert!(matches!(with("\"spline\":0", "\"spline\":9"), ExportError::Patch { index: 0, .. }));
    assert!(matches!(with("\"edge\":1", "\"edge\":8"), ExportError::Surface(_)));
    assert!(matches!(refused(&format!("{file}x")), ExportError::Json { line: 2, column: 1, .. }));
    assert!(matches!(refused("ISO-10303-21;"), ExportError::Json { line: 1, .. }));
    assert!(matches!(refused(&"[".repeat(1_000_000)), ExportError::Json { .. }));
    assert!(matches!(refused(&"{\"schema\":1,\"patches\":".repeat(100_000)), ExportError::Json { .. }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]
    #[test]
    fn damaged_files_do_not_panic(at in 0usize..2000, with in prop::collection::vec(any::<u8>(), 0..6), skip in 0usize..6) {
        let mut bytes = file().into_bytes();
        let at = at % bytes.len();
        let end = (at + skip).min(bytes.len());
        bytes.splice(at..end, with);
        if let Ok(surface) = read_native(&bytes, LOADERS) {
            prop_assert_eq!(surface.patches().len(), 2);
        }
    }
}

//! `suture fill` as a user meets it.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn suture(args: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_suture")).args(args).current_dir(folder).output().unwrap()
}

/// Runs it; exit code, report and message.
fn fill(args: &[&str], folder: &Path) -> (Option<i32>, Value, String) {
    let out = suture(&[&["fill"], args, &["--json", "r.json"]].concat(), folder);
    let report = std::fs::read(folder.join("r.json")).unwrap();
    (
        out.status.code(),
        serde_json::from_slice(&report).unwrap(),
        String::from_utf8_lossy(&out.stderr).into_owned(),
    )
}

fn scene(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../coons/examples/scenes").join(name);
    path.to_str().unwrap().to_owned()
}

/// Three bands of a sphere, one beside the other, with gaps between them.
const BANDS: &str = r#"{
  "schema": 1,
  "surfaces": {
    "a": { "analytic": { "type": "sphere", "radius": 1, "x": [0, 1, 0], "y": [1, 0, 0] }, "domain": [[0, 0.8], [0.6, 1.4]] },
    "b": { "analytic": { "type": "sphere", "radius": 1, "x": [0, 1, 0], "y": [1, 0, 0] }, "domain": [[0.9, 0.8], [1.5, 1.4]] },
    "c": { "analytic": { "type": "sphere", "radius": 1, "x": [0, 1, 0], "y": [1, 0, 0] }, "domain": [[1.8, 0.8], [2.4, 1.4]] }
  }
}"#;

#[test]
fn the_figures_of_the_paper_are_filled() {
    let folder = tempfile::tempdir().unwrap();
    let figures = [
        ("fig3.json", "C2", 1, 2),
        ("fig4.json", "G1", 1, 2),
        ("fig5.json", "C2", 1, 2),
        ("fig6.json", "G1", 1, 3),
        ("fig10.json", "G1", 1, 3),
        ("fig11.json", "G1", 1, 3),
        ("hole5.json", "G1", 5, 5),
    ];
    for (name, order, fills, given) in figures {
        let (code, r, message) = fill(
            &[
                &scene(name),
                "-o",
                "a.json",
                "-o",
                "a.glb",
                "-o",
                "a.png",
                "--size",
                "80x60",
                "--chord",
                "0.005",
            ],
            folder.path(),
        );
        assert_eq!(code, Some(0), "{name}: {message}");
        assert_eq!(
            (&r["certificate"]["claimed"], &r["certificate"]["measured"]),
            (&order.into(), &order.into()),
            "{name}"
        );
        assert_eq!(
            (r["surface"]["patches"]["fill"].as_u64(), r["surface"]["patches"]["given"].as_u64()),
            (Some(fills), Some(given))
        );
        assert!(
            r["certificate"]["position"].as_f64().unwrap() < 1e-14
                && r["certificate"]["normal"].as_f64().unwrap() < 1e-13
        );
        assert!(r["surface"]["construction"]["fills"][0]["certificate"].is_object(), "{name}");
        // The saved surface measures the same again.
        let again = suture(&["certify", "a.json", "--json", "c.json"], folder.path());
        assert_eq!(again.status.code(), Some(0), "{name}");
        let c: Value = serde_json::from_slice(&std::fs::read(folder.path().join("c.json")).unwrap()).unwrap();
        // Lengths are relative to the diagonal of the tessellation, which is finer there.
        for key in ["claimed", "measured", "normal", "seams", "regularity"] {
            assert_eq!(c["certificate"][key], r["certificate"][key], "{name} {key}");
        }
    }
}

#[test]
fn gaps_are_found_named_and_filled_again() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bands.json"), BANDS).unwrap();
    let fills = |r: &Value| r["surface"]["construction"]["fills"].as_array().unwrap().len();
    for order in ["C0", "C1", "C2", "C3", "G1", "G2"] {
        let (code, r, message) = fill(&["bands.json", "-o", "all.json", "--order", order], folder.path());
        assert_eq!((code, fills(&r)), (Some(0), 2), "{order}: {message}");
        let measured = r["certificate"]["measured"].as_str().unwrap();
        // There is no name for C³ there, and positions may fit better than asked for.
        assert!(
            measured == order || (order, measured) == ("C3", "C2") || order == "C0",
            "{order}: {measured}"
        );
        assert_eq!(r["surface"]["construction"]["fills"][0]["asked"], order);
    }
    let (code, r, _) = fill(&["bands.json", "-o", "one.json", "--gap", "a:1,b:3"], folder.path());
    assert_eq!((code, fills(&r), r["certificate"]["seams"].as_u64()), (Some(0), 1, Some(2)));
    // The file holds what was named; scenes without fills hold all surfaces, so that the rest can be filled.
    std::fs::write(folder.path().join("bands.json"), BANDS).unwrap();
    let (code, r, message) = fill(&["all.json", "-o", "b.json"], folder.path());
    assert_eq!((code, r["error"]["kind"].as_str()), (Some(2), Some("fill")), "nothing is left: {message}");
    assert!(message.contains("no gap was found between the 12 open edges"), "{message}");

    // Without its second fill the saved surface has one gap left, which is found, or named.
    let path = folder.path().join("all.json");
    let mut saved: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(saved["patches"].as_array().unwrap().len(), 5);
    saved["patches"].as_array_mut().unwrap().truncate(4);
    saved["seams"].as_array_mut().unwrap().retain(|s| s["a"]["patch"] != 4 && s["b"]["patch"] != 4);
    std::fs::write(&path, saved.to_string()).unwrap();
    let (code, r, message) = fill(&["all.json", "-o", "found.json"], folder.path());
    // The first fill is of the last order above.
    assert_eq!((code, r["certificate"]["measured"].as_str()), (Some(0), Some("G2")), "{message}");
    assert_eq!(
        (r["surface"]["patches"]["fill"].as_u64(), r["surface"]["patches"]["given"].as_u64()),
        (Some(2), Some(3))
    );
    let gaps = r["surface"]["construction"]["fills"][0].clone();
    let (code, r, message) = fill(&["all.json", "-o", "named.json", "--gap", "1:1,2:3"], folder.path());
    assert_eq!(code, Some(0), "{message}");
    assert_eq!(r["surface"]["construction"]["fills"][0]["asked"], gaps["asked"]);
    // Fills of fills and given patches are saved, too.
    assert_eq!(suture(&["certify", "found.json", "--json", "c.json"], folder.path()).status.code(), Some(0));
}

#[test]
fn what_does_not_fit_is_refused_or_repaired() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(scene("fig3.json")).unwrap();
    let curves = r#""order": "C2", "curves": [{ "type": "bezier", "net": [[0, 1.2, 0.2], [0, 1.5, -0.3], [0, 2, -0.3]] }, null]"#;
    assert!(text.contains(r#""order": "C2""#));
    std::fs::write(folder.path().join("bent.json"), text.replace(r#""order": "C2""#, curves)).unwrap();
    let (code, r, message) = fill(&["bent.json", "-o", "a.json"], folder.path());
    assert_eq!((code, r["error"]["kind"].as_str()), (Some(2), Some("fill")));
    assert!(
        message.contains("at the corner v = 0, u = 0 derivative 1") && message.contains("repair"),
        "{message}"
    );
    assert!(!folder.path().join("a.json").exists());
    let (code, r, message) = fill(&["bent.json", "-o", "a.json", "--repair"], folder.path());
    assert_eq!((code, r["certificate"]["measured"].as_str()), (Some(0), Some("C2")), "{message}");
    assert!(r["surface"]["construction"]["fills"][0]["moved"][0].as_f64().unwrap() > 1e-3);
    assert!(r["warnings"][0].as_str().unwrap().contains("were moved by"));

    for order in ["C3", "G2"] {
        let (code, _, message) =
            fill(&[&scene("fig10.json"), "-o", "b.json", "--order", order], folder.path());
        assert_eq!(code, Some(2));
        assert!(message.contains(&format!("{order} is not offered for three-sided holes")), "{message}");
    }
    let (code, _, message) =
        fill(&[&scene("fig3.json"), "-o", "b.json", "--gap", "left2,right:0"], folder.path());
    assert!(code == Some(2) && message.contains("SURFACE:EDGE"), "{message}");
    let (code, _, message) =
        fill(&[&scene("fig3.json"), "-o", "b.json", "--gap", "left:2,middle:0"], folder.path());
    assert!(code == Some(2) && message.contains("there is no surface \"middle\""), "{message}");
    std::fs::write(folder.path().join("no.json"), "{\"schema\": 1, \"surfaces\": 3}").unwrap();
    let (code, _, message) = fill(&["no.json", "-o", "b.json"], folder.path());
    assert!(code == Some(2) && message.contains("line 1 column"), "{message}");
    std::fs::write(folder.path().join("no.json"), "solid").unwrap();
    let (code, _, message) = fill(&["no.json", "-o", "b.json"], folder.path());
    assert!(code == Some(2) && message.contains("not JSON"), "{message}");
}

#[test]
fn surfaces_of_opposite_orientation_are_joined_and_noted() {
    let folder = tempfile::tempdir().unwrap();
    let turned = BANDS.replacen(r#""x": [0, 1, 0], "y": [1, 0, 0] }"#, r#""z": [0, 0, 1] }"#, 1);
    let turned = turned
        .replace(r#"[[0, 0.8], [0.6, 1.4]]"#, r#"[[0.9707963267948966, 0.8], [1.5707963267948966, 1.4]]"#);
    std::fs::write(folder.path().join("turned.json"), turned).unwrap();
    let (code, r, message) = fill(&["turned.json", "-o", "a.json"], folder.path());
    assert_eq!((code, r["certificate"]["measured"].as_str()), (Some(0), Some("C2")), "{message}");
    assert_eq!(r["certificate"]["turned_seams"], 1);
    assert!(r["warnings"].to_string().contains("opposite orientation"));
}

#[test]
fn surfaces_of_other_methods_are_filled_and_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0.1\nv 0 1.3 0.1\nv 1 1.3 0.1\nv 1 2.3 0\nv 0 2.3 0\n\
                f 1 2 3\nf 1 3 4\nf 5 6 7\nf 5 7 8\n";
    std::fs::write(folder.path().join("m.obj"), mesh).unwrap();
    for method in ["bubble", "apatch"] {
        assert_eq!(suture(&[method, "m.obj", "-o", "m.json"], folder.path()).status.code(), Some(0));
        let (code, r, message) = fill(&["m.json", "-o", "f.json"], folder.path());
        assert_eq!(
            (code, r["surface"]["patches"]["fill"].as_u64()),
            (Some(0), Some(1)),
            "{method}: {message}"
        );
        assert_eq!(r["surface"]["construction"]["fills"][0]["asked"], "C2");
        assert_eq!(suture(&["certify", "f.json"], folder.path()).status.code(), Some(0), "{method}");
        let (code, _, message) = fill(&["m.json", "-o", "f.json", "--order", "C3"], folder.path());
        assert!(code == Some(2) && message.contains("third derivatives"), "{method}: {message}");
    }
}

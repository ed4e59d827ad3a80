//! Pages from the command line: what they are made of, and what is refused.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn suture(args: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_suture")).args(args).current_dir(folder).output().unwrap()
}

fn data(name: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/paper").join(name);
    path.display().to_string()
}

#[track_caller]
fn page(folder: &Path, name: &str) -> String {
    let html = std::fs::read_to_string(folder.join(name)).unwrap();
    assert!(html.starts_with("<!doctype html>") && html.contains("id=\"suture-data\""), "{name}");
    html
}

#[test]
fn every_method_writes_pages_and_saved_surfaces_are_viewed() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = data("deformed_octahedron.obj");
    for method in ["reconstruct", "apatch", "bubble"] {
        let args = [
            method,
            &mesh,
            "-o",
            "a.html",
            "-o",
            "a.json",
            "-o",
            "d.png",
            "--shade",
            "deviation",
            "--size",
            "80x60",
        ];
        let out = suture(&args, folder.path());
        assert_eq!(out.status.code(), Some(0), "{method}: {}", String::from_utf8_lossy(&out.stderr));
        let html = page(folder.path(), "a.html");
        assert!(html.contains(&format!("<title>deformed_octahedron.obj · {method}</title>")));
        let out =
            suture(&["view", "a.json", "--mesh", &mesh, "-o", "b.html", "--json", "r.json"], folder.path());
        assert_eq!(out.status.code(), Some(0), "{method}: {}", String::from_utf8_lossy(&out.stderr));
        page(folder.path(), "b.html");
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(folder.path().join("r.json")).unwrap()).unwrap();
        assert_eq!(report["command"], "view");
        assert!(report["deviation"]["mesh_to_surface"]["max"].as_f64().unwrap() < 0.05);
    }
}

#[test]
fn meshes_are_viewed_with_their_segments() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, labels) = (data("l_shape.obj"), data("l_shape.labels"));
    let out = suture(&["view", &mesh, "--labels", &labels, "-o", "m.html", "-o", "m.png"], folder.path());
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    page(folder.path(), "m.html");
    let out = suture(&["view", &mesh, "--labels", &data("torus_2304.labels"), "-o", "n.html"], folder.path());
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&out.stderr).contains("2304 labels for 448 faces"));
    // Nothing to compare with: no distances to show.
    let out = suture(&["view", &mesh, "--shade", "deviation", "-o", "n.png"], folder.path());
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&out.stderr).contains("no distances"));
    assert!(!folder.path().join("n.png").exists() && !folder.path().join("n.html").exists());
}

#[test]
fn segments_leave_as_labels_colours_and_page() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, labels) = (data("l_shape.obj"), data("l_shape.labels"));
    let args = [
        "segment", &mesh, "--labels", &labels, "-o", "s.labels", "-o", "s.ply", "-o", "s.html", "--json",
        "r.json",
    ];
    let out = suture(&args, folder.path());
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    page(folder.path(), "s.html");
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(String::from_utf8(read("s.labels")).unwrap(), std::fs::read_to_string(&labels).unwrap());
    let report: serde_json::Value = serde_json::from_slice(&read("r.json")).unwrap();
    let list = |key: &str| report["segments"][key].as_array().unwrap().clone();
    let (charts, corners, arcs) = (list("charts"), list("corners"), list("arcs"));
    assert_eq!((charts.len(), corners.len(), arcs.len()), (12, 16, 26));
    let sum = |key: &str| charts.iter().map(|c| c[key].as_f64().unwrap()).sum::<f64>();
    assert!((sum("area") - 1.0).abs() < 1e-12 && sum("faces") == 448.0);
    // Every arc lies beside two charts.
    let around: f64 = arcs.iter().map(|a| a["length"].as_f64().unwrap()).sum();
    assert!((sum("circumference") - 2.0 * around).abs() < 1e-9);
    assert!(
        charts
            .iter()
            .all(|c| c["flattening"]["flips"] == 0 && c["flattening"]["area_ratio"].as_f64().unwrap() >= 1.0)
    );
    // The coloured mesh is the mesh, and its neighbours differ.
    let ply = suture::mesh::io::read(folder.path().join("s.ply")).unwrap().mesh;
    assert_eq!(ply.faces.len(), 448);
    assert!(String::from_utf8_lossy(&read("s.ply")[..400]).contains("property uchar red"));
    let out = suture(&["segment", &mesh, "--labels", &labels, "-o", "s.step"], folder.path());
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&out.stderr).contains("coloured mesh (.ply)"));
}

#[test]
fn methods_are_compared_on_one_page() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = data("deformed_octahedron.obj");
    let out = suture(&["compare", &mesh, "-o", "c.html", "--json", "c.json"], folder.path());
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    assert!(page(folder.path(), "c.html").contains("class=\"many\""));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("c.json")).unwrap()).unwrap();
    let compared = report["compared"].as_array().unwrap();
    let column = |key: &str| compared.iter().map(|c| c[key].as_str().unwrap().to_owned()).collect::<Vec<_>>();
    assert_eq!(column("method"), ["reconstruct", "apatch", "bubble"]);
    assert_eq!(column("measured"), ["C2", "C1", "G2"]);
    for c in compared {
        assert!(c["seconds"].as_f64().unwrap() > 0.0 && c["patches"].as_u64().unwrap() > 100, "{c}");
        assert!(
            c["mesh_to_surface"]["rms"].as_f64().unwrap() < 0.01 && !c["degree"].as_str().unwrap().is_empty()
        );
    }
    let out = suture(&["compare", &mesh, "-o", "c.png"], folder.path());
    assert_eq!(out.status.code(), Some(2));
}

//! The commands that lay one patch over every face: what they write, measure and refuse.

use std::path::Path;
use std::process::{Command, Output};

use suture::mesh::{TriMesh, io, shapes};

fn suture(args: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_suture")).args(args).current_dir(folder).output().unwrap()
}

fn report(folder: &Path, name: &str) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(folder.join(name)).unwrap()).unwrap()
}

/// Runs a command that must end well.
#[track_caller]
fn good(args: &[&str], folder: &Path) {
    let out = suture(args, folder);
    assert_eq!(out.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&out.stderr));
}

/// A closed mesh without symmetry, neither convex.
fn blob() -> TriMesh {
    let mut mesh = shapes::sphere(1);
    for p in &mut mesh.positions {
        *p *= 1.0 + 0.3 * (2.0 * p.x + p.y).sin() * (1.5 * p.z).cos();
    }
    mesh
}

/// Half of a sphere: open.
fn bowl() -> TriMesh {
    let mut mesh = shapes::sphere(1);
    let positions = mesh.positions.clone();
    mesh.faces.retain(|f| f.iter().map(|&v| positions[v as usize].z).sum::<f64>() < 0.0);
    suture::mesh::repair::drop_isolated_vertices(&mut mesh);
    mesh
}

#[test]
fn every_output_is_written_and_the_report_counts_the_patches() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = blob();
    io::write(folder.path().join("m.ply"), &mesh).unwrap();
    for (command, claimed, kind) in [("apatch", "C1", "face"), ("bubble", "G2", "bubble")] {
        let mut args = vec![command, "m.ply", "--resolution", "4", "--json", "r.json"];
        let outputs = ["a.glb", "a.obj", "a.stl", "a.ply", "a.json", "a.png"];
        outputs.iter().for_each(|o| args.extend(["-o", o]));
        good(&args, folder.path());
        for file in outputs {
            assert!(std::fs::metadata(folder.path().join(file)).unwrap().len() > 100, "{command} {file}");
        }
        let r = report(folder.path(), "r.json");
        assert_eq!(r["command"], command);
        assert_eq!(r["certificate"]["claimed"], claimed);
        assert_eq!(r["certificate"]["measured"], claimed, "{}", r["certificate"]);
        let (patches, faces) = (&r["surface"]["patches"], mesh.faces.len() as u64);
        assert_eq!(patches[kind].as_u64(), Some(faces));
        assert!(command != "apatch" || patches["edge"].as_u64() >= Some(3 * faces / 2));
        assert_eq!(r["tessellation"]["closed"], true);
        // Vertices are interpolated.
        assert!(r["deviation"]["mesh_to_surface"]["max"].as_f64().unwrap() < 1e-12);
        assert!(r["surface"]["construction"].is_object());
        let materials = std::fs::read_to_string(folder.path().join("a.obj")).unwrap();
        assert!(materials.contains(&format!("usemtl {kind}")));

        good(&["certify", "a.json", "--mesh", "m.ply", "--json", "c.json"], folder.path());
        let c = report(folder.path(), "c.json");
        assert_eq!(c["certificate"], r["certificate"], "{command}");
    }
}

#[test]
fn open_meshes_stay_open() {
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("bowl.ply"), &bowl()).unwrap();
    for args in [&["apatch"][..], &["bubble", "--order", "1"]] {
        let rest = ["bowl.ply", "-o", "a.json", "--resolution", "3", "--json", "r.json"];
        let out = suture(&[args, &rest].concat(), folder.path());
        let text = String::from_utf8_lossy(&out.stdout).into_owned();
        assert_eq!(out.status.code(), Some(0), "{text}");
        assert!(text.contains("open as the mesh is"), "{text}");
        let r = report(folder.path(), "r.json");
        assert_eq!(r["tessellation"]["boundary_loops"], 1);
        assert!(r["certificate"]["open_edges"].as_u64() > Some(0));
        good(&["certify", "a.json"], folder.path());
    }
}

#[test]
fn normals_of_the_file_win_and_reproduce_their_quadric() {
    let folder = tempfile::tempdir().unwrap();
    let mut mesh = shapes::sphere(0);
    mesh.normals = Some(mesh.positions.clone());
    io::write(folder.path().join("ball.ply"), &mesh).unwrap();
    // The icosahedron with the normals of its sphere: the sphere, whose sagitta is known.
    good(&["apatch", "ball.ply", "-o", "a.ply", "--json", "r.json"], folder.path());
    let ball = io::read(folder.path().join("a.ply")).unwrap().mesh;
    assert!(ball.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-14));
    let r = report(folder.path(), "r.json");
    assert!(r["certificate"]["curvature"].as_f64().unwrap() < 1e-4, "{}", r["certificate"]);
    for order in ["0", "1", "2", "3", "4"] {
        good(&["bubble", "ball.ply", "--order", order, "-o", "a.ply", "--resolution", "4"], folder.path());
        let ball = io::read(folder.path().join("a.ply")).unwrap().mesh;
        let worst = ball.positions.iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f64::max);
        let limit = [0.1, 1e-2, 5e-4, 1e-4, 1e-4][order.parse::<usize>().unwrap()];
        assert!(worst < limit, "order {order}: {worst:e}");
    }
}

#[test]
fn mistakes_name_the_element() {
    let folder = tempfile::tempdir().unwrap();
    let mut mesh = blob();
    io::write(folder.path().join("plain.off"), &mesh).unwrap();
    let mut normals = suture::vertex_normals(&mesh, suture::NormalSource::Loop).unwrap();
    normals[7] = glam::DVec3::ZERO;
    mesh.normals = Some(normals);
    io::write(folder.path().join("zero.ply"), &mesh).unwrap();
    let cases: [(&[&str], &str); 8] = [
        (&["apatch", "missing.obj", "-o", "a.glb"], "missing.obj"),
        (&["apatch", "plain.off", "-o", "a.dwg"], "dwg"),
        (&["apatch", "plain.off", "--normals", "file", "-o", "a.glb"], "no normals"),
        (&["apatch", "zero.ply", "-o", "a.glb"], "vertex 7"),
        (&["bubble", "zero.ply", "-o", "a.glb"], "vertex 7"),
        (&["bubble", "plain.off", "--resolution", "0", "-o", "a.glb"], "1024"),
        (&["apatch", "plain.off", "--resolution", "2000", "-o", "a.glb"], "1024"),
        (&["bubble", "plain.off", "--refuse", "0.99", "-o", "a.glb"], "edge"),
    ];
    for (args, word) in cases {
        let out = suture(&[args, &["--quiet", "--json", "r.json"]].concat(), folder.path());
        let message = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.contains(word) && message.trim_end().lines().count() == 1, "{args:?}: {message}");
        assert!(report(folder.path(), "r.json")["error"]["message"].as_str().unwrap().contains(word));
        assert!(!folder.path().join("a.glb").exists());
    }
    assert_eq!(report(folder.path(), "r.json")["error"]["kind"], "bubble");
    // What was refused is estimated on request.
    good(&["apatch", "zero.ply", "--normals", "quadric", "-o", "a.glb", "-q"], folder.path());
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    io::write(folder.path().join("m.ply"), &blob()).unwrap();
    for command in ["apatch", "bubble"] {
        let read = |threads: &str| {
            let outputs = ["a.glb", "a.json"];
            let args =
                ["m.ply", "-q", "--resolution", "3", "-o", "a.glb", "-o", "a.json", "--threads", threads];
            good(&[&[command], &args[..]].concat(), folder.path());
            outputs.map(|o| std::fs::read(folder.path().join(o)).unwrap())
        };
        assert!(read("1") == read("4"), "{command}");
    }
}

#[test]
fn bubbles_are_written_as_splines() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = blob();
    io::write(folder.path().join("m.ply"), &mesh).unwrap();
    let args =
        ["bubble", "m.ply", "--order", "1", "--seam-angle", "0.1", "--cubic-curves", "--nets", "n.json"];
    let rest = ["-o", "s.json", "--resolution", "3", "--json", "r.json"];
    good(&[&args[..], &rest].concat(), folder.path());
    let nets = report(folder.path(), "n.json");
    assert_eq!(nets.as_array().map(Vec::len), Some(mesh.faces.len()));
    assert_eq!(nets[3]["face"], 3);
    assert_eq!(nets[3]["points"]["degree"], serde_json::json!([7, 7]));
    assert!(nets[3]["weights"]["net"].is_array());
    let r = report(folder.path(), "r.json");
    let angle = r["surface"]["construction"]["seam_angle"].as_f64().unwrap();
    assert!(angle > 0.0 && angle <= 0.1_f64.to_radians());
    assert!(r["certificate"]["position"].as_f64().unwrap() < 1e-12, "{}", r["certificate"]);
    assert_eq!(r["tessellation"]["closed"], true);
    // What is saved is the same surface.
    good(&["certify", "s.json", "--mesh", "m.ply", "--json", "c.json"], folder.path());
    assert_eq!(report(folder.path(), "c.json")["certificate"], r["certificate"]);
    let out = suture(&["bubble", "m.ply", "--nets", "n.json", "-o", "x.json"], folder.path());
    assert_eq!(out.status.code(), Some(2), "{}", String::from_utf8_lossy(&out.stderr));
    let out = suture(&["bubble", "m.ply", "--splines", "3", "-o", "x.json"], folder.path());
    assert_eq!(out.status.code(), Some(2), "{}", String::from_utf8_lossy(&out.stderr));
}

//! Scanned and modelled meshes: smooth, proven and watertight. The whole table comes from `examples/measure.rs`.

mod common;

use common::wall_jumps;
use suture_apatch::{ApatchOptions, apatch};
use suture_mesh::normals::{EstimateNormals, LoopLimit};
use suture_mesh::{Topology, check, io};

#[test]
fn good_meshes_become_c1_surfaces() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/good/");
    for name in
        ["eight.off", "nefertiti_coarse.off", "three_peaks.off", "sphere.obj", "elephant.off", "hand.off"]
    {
        let path = format!("{folder}{name}");
        if !std::path::Path::new(&path).exists() {
            println!("skipped: {name} is not there");
            continue;
        }
        let mesh = io::read(&path).unwrap().mesh;
        let normals = LoopLimit.estimate(&mesh, &Topology::build(&mesh).unwrap()).unwrap();
        let options = ApatchOptions { estimated: true, ..ApatchOptions::default() };
        let s = apatch(&mesh, &normals, &options).unwrap();
        let r = s.report();
        assert!(
            r.unproven_faces.is_empty() && r.unproven_edges.is_empty() && r.bad_edges.is_empty(),
            "{name}: {r:?}"
        );
        let jumps = wall_jumps(&s);
        assert!(jumps.value < 1e-12 && jumps.gradient < 1e-11, "{name}: {jumps:?}");
        let t = s.tessellate(4, 2).unwrap();
        let (coarse, fine) = (check(&mesh), check(&t.mesh));
        assert_eq!((t.missed, fine.closed, fine.genus), (0, coarse.closed, coarse.genus), "{name}");
        assert!(fine.manifold && fine.oriented, "{name}");
    }
}

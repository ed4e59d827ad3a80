//! Prints what the construction achieves on the meshes named on the command line (or on spheres of growing size, without).
//!
//! `cargo run --release -p suture-apatch --example measure_apatch -- MESH…`

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use common::wall_jumps;
use glam::{DVec2, DVec3};
use suture_apatch::{ApatchOptions, ApatchSurface, Class, apatch};
use suture_mesh::normals::{EstimateNormals, LoopLimit};
use suture_mesh::{Topology, TriMesh, io, shapes};

fn main() {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let mut meshes: Vec<(String, TriMesh)> = Vec::new();
    for name in names {
        match io::read(std::path::Path::new(&name)) {
            Ok(loaded) => meshes.push((name.rsplit('/').next().unwrap_or(&name).to_string(), loaded.mesh)),
            Err(e) => println!("{name}: {e}"),
        }
    }
    if meshes.is_empty() {
        meshes.extend((0..=5).map(|level| (format!("sphere {level}"), shapes::sphere(level))));
        // 102 400 faces.
        meshes.push(("torus".into(), shapes::torus(1.0, 0.4, 256, 200)));
    }
    for (name, mesh) in meshes {
        measure(&name, &mesh);
    }
}

fn measure(name: &str, mesh: &TriMesh) {
    let normals = match &mesh.normals {
        Some(n) => Ok(n.clone()),
        None => Topology::build(mesh)
            .map_err(|e| e.to_string())
            .and_then(|t| LoopLimit.estimate(mesh, &t).map_err(|e| e.to_string())),
    };
    let normals = match normals {
        Ok(n) => n,
        Err(e) => return println!("{name}: {e}"),
    };
    let options = ApatchOptions { estimated: mesh.normals.is_none(), ..ApatchOptions::default() };
    let quick = ApatchOptions { intersections: false, ..options.clone() };
    let start = Instant::now();
    let surface = apatch(mesh, &normals, &quick);
    let build = start.elapsed().as_secs_f64();
    let surface = match surface {
        Ok(s) => s,
        Err(e) => return println!("{name}: {e}"),
    };
    let full = apatch(mesh, &normals, &options);
    let pairs = full.ok().and_then(|s| s.report().intersections.as_ref().map(|i| i.pairs)).unwrap_or(0);
    let r = surface.report();
    println!(
        "\n{name}: {} faces, refined to {} in {} rounds; {build:.2} s",
        r.input_faces, r.faces, r.refinements
    );
    println!("  turned edges {}, normals estimated again {}", r.turned_edges.len(), r.estimated_again.len());
    println!(
        "  faces {:?}\n  edges {:?}, {} on the boundary",
        r.face_classes, r.edge_classes, r.boundary_edges
    );
    println!(
        "  turned {}, steep {}, bad edges {}, raised faces {}, rounds {}, weighted edges {}, intersecting pairs {pairs}",
        r.turned_faces,
        r.steep_faces.len(),
        r.bad_edges.len(),
        r.raised_faces,
        r.edge_rounds,
        r.weighted_edges
    );
    println!(
        "  unproven faces {} (violated {}), unproven edges {} (violated {})",
        r.unproven_faces.len(),
        r.violated_faces.len(),
        r.unproven_edges.len(),
        r.violated_edges.len()
    );
    println!(
        "  pieces: {} over faces, {} along edges, {:.3} per face of the mesh",
        r.face_pieces,
        r.edge_pieces,
        (r.face_pieces + r.edge_pieces) as f64 / r.faces as f64
    );
    println!("  patches against 8:5: {}", counts(&surface));
    let jumps = wall_jumps(&surface);
    println!("  walls {}: value jump {:.1e}, gradient jump {:.1e}", jumps.walls, jumps.value, jumps.gradient);
    let [position, normal] = vertices(&surface);
    println!("  vertices: distance {position:.1e}, angle {normal:.1e}");
    let (rays, missed, steep) = rays(&surface);
    println!(
        "  rays {rays}: {missed} without a simple minimal root, {steep} of them at faces with normals beyond 60 degrees"
    );
    let start = Instant::now();
    match surface.tessellate(8, 2) {
        Ok(t) => {
            let seconds = start.elapsed().as_secs_f64();
            let check = suture_mesh::check(&t.mesh);
            println!(
                "  tessellation: {} vertices, {} triangles, closed {}, oriented {}, manifold {}, boundary loops {}, {:.2} M points/s",
                t.mesh.positions.len(),
                t.mesh.faces.len(),
                check.closed,
                check.oriented,
                check.manifold,
                check.boundary_loops.total,
                t.mesh.positions.len() as f64 / seconds / 1e6
            );
        }
        Err(e) => println!("  tessellation: {e}"),
    }
    println!("  evaluation: {:.2} M points with normals/s on one core", speed(&surface) / 1e6);
    seams(&surface);
}

/// Patches and pieces of `F`, and how many there would be with every edge divided, as in the scheme before (Bajaj, Chen, Xu 1995): the
/// paper counts `2v + 2·3v` against `2v + 3v`, 8 to 5.
fn counts(surface: &ApatchSurface) -> String {
    let r = surface.report();
    let faces = r.face_classes.positive + r.face_classes.negative + r.face_classes.nonconvex;
    let edges = r.edge_classes.positive + r.edge_classes.negative + r.edge_classes.nonconvex;
    let of = |faces: usize, edges: usize| {
        let (before, now) = (faces + 2 * edges, faces + edges);
        format!("{before} : {now} = 8 : {:.2}", 8.0 * now as f64 / before.max(1) as f64)
    };
    format!("patches {}, pieces {}", of(faces, edges), of(r.face_pieces, r.edge_pieces))
}

/// Largest distance and angle at the corners of faces, distances relative to the diagonal.
fn vertices(surface: &ApatchSurface) -> [f64; 2] {
    let mesh = surface.mesh();
    let normals = mesh.normals.as_deref().unwrap_or(&[]);
    let mut worst = [0.0_f64; 2];
    for (f, face) in mesh.faces.iter().enumerate() {
        for k in 0..3 {
            let mut q = [0.0; 3];
            q[k] = 1.0;
            let Some(p) = surface.face_point(f, q) else { continue };
            let (v, n) = (mesh.positions[face[k] as usize], normals[face[k] as usize].normalize_or_zero());
            worst[0] = worst[0].max(p.position.distance(v) / mesh.diagonal());
            worst[1] = worst[1].max(p.normal().cross(n).length());
        }
    }
    worst
}

/// Rays sampled over faces and edges, those without a simple root, and of these the ones whose faces have steep normals.
fn rays(surface: &ApatchSurface) -> (usize, usize, usize) {
    let mesh = surface.mesh();
    let normals = mesh.normals.as_deref().unwrap_or(&[]);
    let topology = Topology::build(mesh).ok();
    let steep: Vec<bool> = (0..mesh.faces.len())
        .map(|f| {
            let n = mesh.area_vector(f).normalize_or_zero();
            mesh.faces[f].iter().any(|&v| normals[v as usize].normalize_or_zero().dot(n) < 0.5)
        })
        .collect();
    let (mut all, mut missed, mut beyond) = (0, 0, 0);
    for f in 0..mesh.faces.len() {
        for i in 0..=12 {
            for j in 0..=12 - i {
                let (x, y) = (f64::from(i) / 12.0, f64::from(j) / 12.0);
                let simple = surface.face_point(f, [1.0 - x - y, x, y]).is_none_or(|p| p.simple);
                all += 1;
                missed += usize::from(!simple);
                beyond += usize::from(!simple && steep[f]);
            }
        }
    }
    for e in 0..surface.edge_count() {
        let near = surface.edge_vertices(e).zip(topology.as_ref()).is_some_and(|([a, b], t)| {
            [t.half_edge(a, b), t.half_edge(b, a)].into_iter().flatten().any(|h| steep[t.face(h) as usize])
        });
        for i in 0..=12 {
            for j in 0..=12 {
                let Some(p) = surface.edge_point(e, f64::from(i) / 12.0, f64::from(j) / 12.0) else {
                    continue;
                };
                all += 1;
                missed += usize::from(!p.simple);
                beyond += usize::from(!p.simple && near);
            }
        }
    }
    (all, missed, beyond)
}

fn speed(surface: &ApatchSurface) -> f64 {
    let start = Instant::now();
    let (mut count, mut sum) = (0usize, DVec3::ZERO);
    'all: loop {
        for f in 0..surface.face_classes().len() {
            if surface.face_classes()[f] == Class::Zero {
                continue;
            }
            for i in 1..8 {
                for j in 1..8 - i {
                    let (x, y) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
                    if let Some(p) = surface.face_point(f, [1.0 - x - y, x, y]) {
                        sum += p.position + p.normal();
                        count += 1;
                    }
                }
            }
            if start.elapsed().as_secs_f64() > 0.5 {
                break 'all;
            }
        }
        if count == 0 {
            break;
        }
    }
    std::hint::black_box(sum);
    count as f64 / start.elapsed().as_secs_f64()
}

/// Gaps and angles of normals across the seams of the parametric patches.
fn seams(surface: &ApatchSurface) {
    let s = match surface.surface() {
        Ok(s) => s,
        Err(e) => return println!("  patches: {e}"),
    };
    let diagonal = surface.mesh().diagonal();
    let (mut gap, mut angle, mut blind) = (0.0_f64, 0.0_f64, 0);
    for seam in s.seams() {
        let ends = [seam.a, seam.b].map(|e| s.patch(e.patch).map(|p| (p, p.domain(), e.edge as usize)));
        let [Some(a), Some(b)] = ends else { continue };
        for i in 0..=8 {
            let t = f64::from(i) / 8.0;
            let jet = |(p, d, e): &(&dyn suture_surface::Patch, suture_surface::Domain, usize), t: f64| {
                let at: DVec2 = d.edge(*e).map(|c| c.point(t)).unwrap_or_default();
                p.jet(at)
            };
            let (x, y) = (jet(&a, t), jet(&b, seam.opposite(t)));
            gap = gap.max(x.p.distance(y.p) / diagonal);
            match (x.normal(), y.normal()) {
                (Some(m), Some(n)) => angle = angle.max(m.cross(n).length().atan2(m.dot(n))),
                _ => blind += 1,
            }
        }
    }
    println!(
        "  patches {}, seams {}: gap {gap:.1e}, angle {angle:.1e}, {blind} samples without normal",
        s.patches().len(),
        s.seams().len()
    );
}

//! All charts of seven labelled meshes: flips, area ratios and stretches.

mod common;

use common::*;
use suture_mesh::Topology;
use suture_param::*;

struct Row {
    name: &'static str,
    mesh: &'static str,
    labels: &'static str,
    rings: usize,
    /// Largest admitted area ratio and stretch of the recommended charts.
    worst: [f64; 2],
}

#[test]
fn census() {
    let rows = [
        Row { name: "blobby", mesh: "blobby.off", labels: "blobby.vor", rings: 3, worst: [8.0, 7.0] },
        Row { name: "fish", mesh: "fish.obj", labels: "fish.vor", rings: 3, worst: [8.0, 7.0] },
        Row { name: "eight", mesh: "eight.off", labels: "eight.vor", rings: 2, worst: [8.0, 7.0] },
        Row {
            name: "fandisk",
            mesh: "fandisk.off",
            labels: "fandisk.dihedral25_raw",
            rings: 2,
            worst: [8.0, 7.0],
        },
        Row { name: "knot1", mesh: "knot1.off", labels: "knot1.vor", rings: 3, worst: [4.0, 2.0] },
        Row { name: "sphere", mesh: "sphere.obj", labels: "sphere.cube6", rings: 3, worst: [4.0, 2.0] },
        Row { name: "torus", mesh: "torus.obj", labels: "torus.grid8", rings: 3, worst: [4.0, 2.0] },
    ];
    for row in rows {
        let Some(mesh) = mesh(&format!("good/{}", row.mesh)) else { continue };
        let Some(segments) = segments(&format!("labels/{}.labels", row.labels)) else { continue };
        let topology = Topology::build(&mesh).unwrap();
        let mut lines = [const { Vec::new() }; 3];
        let (mut refused, mut duplicates) = (0, 0);
        for segment in &segments {
            // All edges are crossed, as in the table of the specification.
            let options = CollarOptions { max_rings: row.rings, ..smooth() };
            let disc = match disc_with_collar(&mesh, &topology, segment, &options) {
                Ok(disc) => disc,
                Err(ParamError::NotDisc { .. }) => {
                    refused += 1;
                    continue;
                }
                Err(e) => panic!("{e}"),
            };
            let mut faces = disc.mesh_faces.clone();
            faces.sort_unstable();
            duplicates += faces.windows(2).filter(|w| w[0] == w[1]).count();
            let methods: [&dyn Parameterize; 3] =
                [&Lscm::default(), &BoundaryScaleOne, &Recommended::default()];
            for (line, method) in lines.iter_mut().zip(methods) {
                line.push(Chart::flatten(disc.clone(), &method, &Limits::default()).unwrap().distortion);
            }
        }
        for (method, line) in ["LSCM", "boundary scale 1", "recommended"].iter().zip(&lines) {
            let flips = line.iter().filter(|d| d.flips > 0).count();
            let mut ratios: Vec<f64> = line.iter().filter(|d| d.flips == 0).map(|d| d.area_ratio).collect();
            ratios.sort_by(f64::total_cmp);
            let above = ratios.iter().filter(|&&r| r > 8.0).count();
            let stretch = line.iter().filter(|d| d.flips == 0).map(|d| d.stretch).fold(1.0, f64::max);
            let overlaps = line.iter().filter(|d| d.overlaps > 0).count();
            println!(
                "{} ({} charts, {refused} refused, {duplicates} duplicate faces), {method}: {flips} with flips / ratio {:.2}, \
                 {:.1} / {above} above 8; s1/s2 {stretch:.2}; {overlaps} overlap",
                row.name,
                line.len(),
                ratios.get(ratios.len() / 2).unwrap_or(&0.0),
                ratios.last().unwrap_or(&0.0),
            );
        }
        for d in &lines[2] {
            assert!(
                d.flips == 0 && d.area_ratio <= row.worst[0] && d.stretch <= row.worst[1],
                "{}: {d:?}",
                row.name
            );
        }
        assert!(lines[1].iter().all(|d| d.flips == 0), "{}: {:?}", row.name, lines[1]);
        // The least range of scales among conformal maps; on gentle charts the discretisation decides.
        let worst = |line: &[Distortion]| line.iter().map(|d| d.area_ratio).fold(1.0, f64::max);
        assert!(worst(&lines[1]) <= worst(&lines[0]).max(4.0), "{}", row.name);
    }
}

//! Automatic segmentation of real meshes.

mod common;

use std::time::Instant;

use common::mesh;
use suture_segment::{Automatic, Segment};

#[test]
#[ignore]
fn table() {
    for name in std::env::var("MESHES").unwrap_or("paper/sphere_320.obj".into()).split_whitespace() {
        let Some((mesh, topology)) = mesh(name) else { continue };
        let start = Instant::now();
        match Automatic::default().segment(&mesh, &topology) {
            Err(e) => println!("{name:32} {e}"),
            Ok(s) => {
                let mut valence = [0; 9];
                s.corners.iter().for_each(|c| valence[c.arcs.len()] += 1);
                let mut w = s.arc_widths(&mesh);
                w.sort_by(f64::total_cmp);
                println!(
                    "{name:32} faces {} charts {} corners {:?} w {:.4} {:.4} {:.4} s {:.2}",
                    mesh.faces.len(),
                    s.charts.len(),
                    &valence[3..7],
                    w[0],
                    w[1],
                    w[w.len() / 2],
                    start.elapsed().as_secs_f64()
                );
            }
        }
    }
}

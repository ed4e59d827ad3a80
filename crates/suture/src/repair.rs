//! All safe repairs at once.

use suture_mesh::{TriMesh, repair};

/// Welds vertices that coincide exactly, drops faces that name a vertex twice or stand twice, orients faces consistently
/// (outwards where they close) and drops vertices without faces; returns what was done, in words.
pub fn repair_all(mesh: &mut TriMesh) -> Vec<String> {
    let mut done = Vec::new();
    let mut say = |count: usize, what: &str| {
        if count > 0 {
            done.push(format!("repair: {count} {what}"));
        }
    };
    say(repair::weld_coincident(mesh).merged, "coincident vertices welded");
    say(repair::drop_degenerate_faces(mesh).len(), "degenerate faces dropped");
    say(repair::drop_duplicate_faces(mesh).len(), "duplicate faces dropped");
    say(repair::orient(mesh).flipped.len(), "faces reversed");
    say(repair::drop_isolated_vertices(mesh).len(), "isolated vertices dropped");
    done
}

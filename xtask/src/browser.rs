//! `cargo xtask browser`: opens HTML pages in Chromium and drives every control.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::step::{cargo, run, step};
use crate::viewer::packages;

/// Makes the pages, then runs `tests/browser/run.mjs` on them. Pages and pictures stay in `target/browser`.
///
/// # Errors
/// When Node.js, Chromium or a package is missing, when a page cannot be made, when checks fail.
pub(crate) fn run_checks(root: &Path) -> Result<(), String> {
    let tests = root.join("tests/browser");
    let pages = root.join("target/browser");
    step("packages", || packages(&tests))?;
    // Pages of an earlier run would be tested again.
    let _ = std::fs::remove_dir_all(&pages);
    std::fs::create_dir_all(&pages).map_err(|e| format!("{}: {e}", pages.display()))?;
    step("pages", || make_pages(root, &pages))?;
    step("browser", || run(Command::new("node").arg("run.mjs").arg(&pages).current_dir(&tests)))
}

fn make_pages(root: &Path, pages: &Path) -> Result<(), String> {
    let paper = |name: &str| root.join("tests/data/paper").join(name).display().to_string();
    let suture = |page: &str, words: &[&str]| {
        let mut command = cargo();
        command.args(["run", "--release", "--quiet", "-p", "suture", "--"]);
        command.args(words).arg("--quiet").arg("-o").arg(pages.join(page)).current_dir(root);
        run(&mut command)
    };
    let (sphere, sphere_labels) = (paper("sphere_320.obj"), paper("sphere_320.labels"));
    let (torus, torus_labels) = (paper("torus_2304.obj"), paper("torus_2304.labels"));
    let octahedron = paper("deformed_octahedron.obj");
    suture("sphere.html", &["reconstruct", &sphere, "--labels", &sphere_labels])?;
    suture("folded.html", &["bubble", &sphere, "--order", "0", "--flat", "--resolution", "4"])?;
    suture("mesh.html", &["view", &torus, "--labels", &torus_labels])?;
    suture("compare.html", &["compare", &octahedron])?;
    suture("large.html", &["reconstruct", &torus, "--labels", &torus_labels, "--chord", "5e-5"])?;
    let scene = root.join("crates/coons/examples/scenes/fig3.json");
    suture("fill.html", &["fill", &scene.display().to_string()])?;
    // Spot where the collection of meshes is at hand, else the torus.
    let (mesh, up) = spot(root).map_or((torus, "z"), |spot| (spot.display().to_string(), "y"));
    suture("reconstruct.html", &["reconstruct", &mesh, "--up", up])?;
    // Coarse: without graphics hardware every look at half a million triangles takes its time.
    suture("apatch.html", &["apatch", &mesh, "--up", up, "--resolution", "2"])?;
    suture("bubble.html", &["bubble", &mesh, "--up", up, "--resolution", "2"])
}

/// A mesh of the collection that is not part of the project.
pub(crate) fn spot(root: &Path) -> Option<PathBuf> {
    let path = root.join("../shared/data/good/spot.obj");
    path.exists().then_some(path)
}

//! `cargo xtask viewer`: bundles the program of the HTML pages.
//!
//! Its sources and the pinned versions of three.js and of the bundler are in `crates/view/viewer`; the result is committed in
//! `crates/view/assets`, so that nothing but Rust is needed to build and check the project.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::step::{run, step, works};

/// The files that are made, from the sources of the viewer: source, result, options of the bundler.
const FILES: [(&str, &str, &[&str]); 2] = [
    (
        "src/main.js",
        "viewer.js",
        &["--bundle", "--minify", "--format=iife", "--target=es2022", "--legal-comments=inline"],
    ),
    ("src/style.css", "viewer.css", &["--minify"]),
];

/// Bundles; with `check` nothing is written, and stale files are an error.
///
/// # Errors
/// When Node.js or a package is missing, when the bundler refuses the sources, which file is stale.
pub(crate) fn bundle(root: &Path, check: bool) -> Result<(), String> {
    let source = root.join("crates/view/viewer");
    let assets = root.join("crates/view/assets");
    step("packages", || packages(&source))?;
    step("bundle", || {
        let results = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
        for (from, to, options) in FILES {
            let result = results.path().join(to);
            run(Command::new(program(&source, "esbuild"))
                .arg(from)
                .args(options)
                .args(["--log-level=warning", &format!("--outfile={}", result.display())])
                .current_dir(&source))?;
            let made = read(&result)?;
            let kept = assets.join(to);
            if check && fs::read(&kept).ok().as_ref() != Some(&made) {
                return Err(format!(
                    "{} is stale: run `cargo xtask viewer` and commit the result",
                    kept.display()
                ));
            }
            if !check {
                fs::write(&kept, made).map_err(|e| format!("{}: {e}", kept.display()))?;
            }
        }
        Ok(())
    })
}

/// Installs exactly the packages of the lock file, unless they are there.
///
/// # Errors
/// When npm is missing or fails.
pub(crate) fn packages(folder: &Path) -> Result<(), String> {
    let lock = read(&folder.join("package-lock.json"))?;
    // Written last: an interrupted installation leaves no stamp and is begun anew.
    let stamp = folder.join("node_modules/.installed");
    if fs::read(&stamp).ok().as_ref() == Some(&lock) {
        return Ok(());
    }
    if !works(Command::new("npm").arg("--version")) {
        return Err("no npm in PATH: install Node.js 20 or later (Debian: npm) and run this again".into());
    }
    run(Command::new("npm").args(["ci", "--no-fund", "--no-audit"]).current_dir(folder))?;
    fs::write(&stamp, lock).map_err(|e| format!("{}: {e}", stamp.display()))
}

fn program(folder: &Path, name: &str) -> PathBuf {
    let file = if cfg!(windows) { format!("{name}.cmd") } else { name.to_owned() };
    folder.join("node_modules/.bin").join(file)
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

//! `cargo xtask ci`: everything that a change must pass. Needs nothing but Rust.

use std::path::Path;

use crate::codegen;
use crate::step::{cargo, run, step, works};

/// Runs the steps in order; the first failure ends it.
///
/// # Errors
/// The step that failed.
pub(crate) fn all(root: &Path) -> Result<(), String> {
    let call = |words: &[&str]| run(cargo().args(words).current_dir(root));
    step("format", || {
        call(&["fmt", "--all", "--check"])
            .map_err(|e| format!("{e}; run `cargo fmt --all` and commit the result"))
    })?;
    // All targets: libraries, binaries, tests, examples and benches are all built.
    step("clippy", || call(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    // Doc tests included; --all-targets would leave them out. Examples are built, not run.
    step("test", || call(&["test", "--workspace", "--no-fail-fast"]))?;
    step("doc", || {
        run(cargo()
            .args(["doc", "--workspace", "--no-deps"])
            .env("RUSTDOCFLAGS", "-D warnings")
            .current_dir(root))
    })?;
    step("codegen", || codegen::run(root, true))?;
    if works(cargo().args(["deny", "--version"])) {
        step("deny", || call(&["deny", "--workspace", "check"]))?;
    } else {
        eprintln!(
            "==> deny: SKIPPED, cargo-deny is not installed: licences and advisories were not checked \
             (`cargo install --locked cargo-deny`)"
        );
    }
    eprintln!("==> all steps are good");
    Ok(())
}

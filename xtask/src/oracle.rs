//! `cargo xtask oracle`: compares results with libigl, SciPy, trimesh and OpenCASCADE.
//!
//! The programs are Python packages pinned in `tests/oracle/requirements.txt`; they live in a virtual environment beside it. The
//! results to compare are JSON files written by `oracle-dump` of `suture-tests`; `tests/oracle/README.md` says what is in them.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::step::{cargo, run, step, works};

/// Prepares the environment, writes the results and runs every `check_*.py` on them.
///
/// # Errors
/// When Python or a package is missing, when the dump cannot be written, and which checks failed.
pub(crate) fn run_checks(root: &Path) -> Result<(), String> {
    let folder = root.join("tests/oracle");
    let checks = checks(&folder)?;
    let mut python = PathBuf::new();
    step("python environment", || {
        python = environment(&folder)?;
        Ok(())
    })?;
    let results = tempfile::tempdir().map_err(|e| format!("no temporary folder: {e}"))?;
    step("oracle-dump", || {
        run(cargo()
            .args(["run", "--quiet", "-p", "suture-tests", "--bin", "oracle-dump", "--"])
            .arg(results.path())
            .current_dir(root))
    })?;
    // Every check runs, so that one failure does not hide another.
    let mut failed = Vec::new();
    for check in &checks {
        let name = check.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if let Err(e) = step(&name, || run(Command::new(&python).arg(check).arg(results.path()))) {
            eprintln!("{e}");
            failed.push(name);
        }
    }
    if failed.is_empty() {
        eprintln!("==> {} oracle checks are good", checks.len());
        Ok(())
    } else {
        Err(format!("{} of {} oracle checks failed: {}", failed.len(), checks.len(), failed.join(", ")))
    }
}

fn checks(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut checks: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("check_") && name.ends_with(".py")
        })
        .collect();
    if checks.is_empty() {
        return Err(format!("no check_*.py in {}", folder.display()));
    }
    checks.sort();
    Ok(checks)
}

/// The Python of the virtual environment, made when it is missing, broken or older than the requirements.
fn environment(folder: &Path) -> Result<PathBuf, String> {
    let venv = folder.join(".venv");
    let inside = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
    let python = venv.join(inside);
    let requirements = folder.join("requirements.txt");
    let wanted =
        std::fs::read_to_string(&requirements).map_err(|e| format!("{}: {e}", requirements.display()))?;
    // Written last: an interrupted installation leaves no stamp and is begun anew.
    let stamp = venv.join("installed.txt");
    let current = std::fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted);
    if current && works(Command::new(&python).arg("--version")) {
        return Ok(python);
    }
    let system = ["python3", "python"]
        .into_iter()
        .find(|name| {
            works(Command::new(name).args(["-c", "import sys, venv; sys.exit(sys.version_info < (3, 11))"]))
        })
        .ok_or("no Python 3.11 or later with `venv` in PATH: install python3 (Debian: python3-venv) and run this again")?;
    run(Command::new(system).args(["-m", "venv", "--clear"]).arg(&venv))?;
    run(Command::new(&python)
        .args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            "--only-binary",
            ":all:",
            "-r",
        ])
        .arg(&requirements))?;
    std::fs::write(&stamp, wanted).map_err(|e| format!("{}: {e}", stamp.display()))?;
    Ok(python)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_checks_are_found_and_in_order() {
        let folder = tempfile::tempdir().unwrap();
        assert!(checks(folder.path()).unwrap_err().contains("no check_*.py"));
        for name in ["check_b.py", "check_a.py", "common.py", "check_c.txt"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found = checks(folder.path()).unwrap();
        let names: Vec<_> = found.iter().map(|p| p.file_name().unwrap().to_string_lossy()).collect();
        assert_eq!(names, ["check_a.py", "check_b.py"]);
    }
}

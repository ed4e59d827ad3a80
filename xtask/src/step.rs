//! Running other programs, one announced step at a time.

use std::process::{Command, Stdio};
use std::time::Instant;

/// Runs `work` between two lines that say its name and how long it took.
///
/// # Errors
/// Those of `work`, with the name in front.
pub(crate) fn step(name: &str, work: impl FnOnce() -> Result<(), String>) -> Result<(), String> {
    eprintln!("==> {name}");
    let start = Instant::now();
    let result = work();
    let seconds = start.elapsed().as_secs_f64();
    match result {
        Ok(()) => {
            eprintln!("==> {name}: good, {seconds:.1} s");
            Ok(())
        }
        Err(e) => Err(format!("{name} failed after {seconds:.1} s: {e}")),
    }
}

/// Runs `command` to its end; its output goes where ours goes.
///
/// # Errors
/// When it cannot be started or ends with anything but success.
pub(crate) fn run(command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|e| format!("`{}` cannot be started: {e}", shown(command)))?;
    if status.success() { Ok(()) } else { Err(format!("`{}` ended with {status}", shown(command))) }
}

/// Whether `command` can be started and succeeds, in silence.
pub(crate) fn works(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|s| s.success())
}

/// The cargo that called us.
pub(crate) fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

fn shown(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|w| w.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failing_program_is_named_with_its_step() {
        let e =
            step("nonsense", || run(cargo().arg("no-such-subcommand").stderr(Stdio::null()))).unwrap_err();
        assert!(e.starts_with("nonsense failed after") && e.contains("no-such-subcommand"), "{e}");
        assert!(
            run(&mut Command::new("no-such-program-anywhere")).unwrap_err().contains("cannot be started")
        );
        assert!(!works(&mut Command::new("no-such-program-anywhere")));
    }
}

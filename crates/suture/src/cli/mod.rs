//! Arguments in, files and one message out.

mod apatch;
mod args;
mod bubble;
mod commands;
mod compare;
mod export;
mod fill;
mod input;
mod local;
mod output;
mod progress;
mod segment;
mod view;

use std::process::ExitCode;

use clap::Parser;
use suture::SutureError;

/// Everything worked and every measured claim holds.
const GOOD: u8 = 0;
/// There is a result, but it failed its own checks.
const FAILED_CHECKS: u8 = 1;
/// The arguments or the input are not usable.
const UNUSABLE: u8 = 2;
/// A defect of the program.
const INTERNAL: u8 = 3;
/// Stopped by Ctrl-C.
const INTERRUPTED: u8 = 130;

/// Parses the arguments, runs the command, prints at most one message, and tells how it went.
pub(crate) fn main() -> ExitCode {
    let args = args::Args::parse();
    // A panic is a defect of this program, whatever the input; it gets the same one message as every other failure.
    std::panic::set_hook(Box::new(|info| {
        eprintln!("suture: internal error: {info}; please report it with the input");
    }));
    let code = match std::panic::catch_unwind(|| commands::run(&args)) {
        Ok(Ok(true)) => GOOD,
        Ok(Ok(false)) => FAILED_CHECKS,
        Ok(Err(error)) => {
            eprintln!("suture: {error}");
            match error {
                SutureError::Internal { .. } => INTERNAL,
                SutureError::Interrupted => INTERRUPTED,
                _ => UNUSABLE,
            }
        }
        Err(_) => INTERNAL,
    };
    ExitCode::from(code)
}

//! Maintenance commands: `cargo xtask codegen`, `cargo xtask ci`, `cargo xtask oracle`.

mod ci;
mod codegen;
mod oracle;
mod step;

use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Maintenance commands of the workspace.
#[derive(Parser)]
#[command(bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Writes the generated tables.
    Codegen {
        /// Writes nothing: fails when a file is stale and proves every condition that the tables claim.
        #[arg(long)]
        check: bool,
    },
    /// Runs every check that needs nothing but Rust.
    Ci,
    /// Compares results with libigl, SciPy and trimesh (needs Python 3.11 and, the first time, a package registry).
    Oracle,
}

fn main() -> ExitCode {
    // The workspace is the parent of this package, wherever the command was called from.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    let result = match Arguments::parse().command {
        Command::Codegen { check } => codegen::run(root, check),
        Command::Ci => ci::all(root),
        Command::Oracle => oracle::run_checks(root),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

//! Maintenance commands: `cargo xtask codegen`, `ci`, `oracle`, `viewer`, `browser`, `gallery`.

mod browser;
mod ci;
mod codegen;
mod gallery;
mod oracle;
mod step;
mod viewer;

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
    /// Bundles the program of the HTML pages (needs Node.js and, the first time, a package registry).
    Viewer {
        /// Writes nothing: fails when the committed bundle is stale.
        #[arg(long)]
        check: bool,
    },
    /// Opens HTML pages in Chromium and drives every control (needs Node.js, Chromium and, the first time, a package registry).
    Browser,
    /// Draws the pictures of docs/gallery.md.
    Gallery,
}

fn main() -> ExitCode {
    // The workspace is the parent of this package, wherever the command was called from.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    let result = match Arguments::parse().command {
        Command::Codegen { check } => codegen::run(root, check),
        Command::Ci => ci::all(root),
        Command::Oracle => oracle::run_checks(root),
        Command::Viewer { check } => viewer::bundle(root, check),
        Command::Browser => browser::run_checks(root),
        Command::Gallery => gallery::draw(root),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

//! Progress: a bar on a terminal, plain lines elsewhere, nothing when quiet; and Ctrl-C.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use indicatif::{ProgressBar, ProgressStyle};
use suture::{Stage, Watch};

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Shows progress on standard error.
pub(crate) struct Progress {
    look: Look,
    bar: Mutex<Option<ProgressBar>>,
}

enum Look {
    Silent,
    Lines,
    Bar,
}

impl Progress {
    /// The look that fits the place, and the first Ctrl-C turned into a request to stop; the second one kills.
    pub(crate) fn new(quiet: bool) -> Self {
        // A handler that cannot be installed leaves the system's: the process dies at once, which loses nothing.
        let _ = ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
        });
        let look = match (quiet, std::io::stderr().is_terminal()) {
            (true, _) => Look::Silent,
            (false, true) => Look::Bar,
            (false, false) => Look::Lines,
        };
        Self { look, bar: Mutex::new(None) }
    }

    fn replace(&self, bar: Option<ProgressBar>) {
        let old = std::mem::replace(&mut *self.bar.lock().unwrap_or_else(PoisonError::into_inner), bar);
        if let Some(old) = old {
            old.finish_and_clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.replace(None);
    }
}

impl Watch for Progress {
    fn begin(&self, stage: Stage, steps: usize) {
        match self.look {
            Look::Silent => {}
            Look::Lines => eprintln!("{} …", stage.name()),
            Look::Bar => {
                let bar = ProgressBar::new(steps as u64);
                if let Ok(style) = ProgressStyle::with_template("{msg:11} {wide_bar} {pos}/{len}") {
                    bar.set_style(style);
                }
                bar.set_message(stage.name());
                self.replace(Some(bar));
            }
        }
    }

    fn step(&self) {
        if let Some(bar) = &*self.bar.lock().unwrap_or_else(PoisonError::into_inner) {
            bar.inc(1);
        }
    }

    fn interrupted(&self) -> bool {
        STOP.load(Ordering::SeqCst)
    }
}

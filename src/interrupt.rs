//! Ctrl-C: what is under way ends cleanly, files are finished, and nothing new begins.

use std::sync::atomic::{AtomicBool, Ordering};

/// What was under way, or not yet begun, when Ctrl-C was pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Interrupted {
    /// It was ended on the way.
    #[error("interrupted")]
    UnderWay,
    /// It was not begun.
    #[error("interrupted before this log was begun")]
    NotBegun,
}

impl Interrupted {
    /// Whether an error comes of Ctrl-C.
    pub fn caused(error: &anyhow::Error) -> bool {
        error.chain().any(<dyn std::error::Error>::is::<Interrupted>)
    }
}

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Notes Ctrl-C (and a request to terminate) instead of dying of it. A second one ends the program
/// at once, in case the clean end hangs.
pub fn install() {
    let installed = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        crate::output::note("\ninterrupted: finishing what is open (again to stop at once)");
    });
    if let Err(error) = installed {
        crate::output::note(&format!("warning: Ctrl-C will not end this run cleanly: {error}"));
    }
}

/// Ends what is under way, where it has nothing to finish.
pub fn check() -> anyhow::Result<()> {
    anyhow::ensure!(!pressed(), Interrupted::UnderWay);
    Ok(())
}

/// Whether Ctrl-C was pressed.
pub fn pressed() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

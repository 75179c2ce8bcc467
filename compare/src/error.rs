//! Why a run cannot be measured or two runs cannot be compared.

/// Everything that can go wrong in this crate.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A run without a controller step says nothing about a controller.
    #[error("no controller step among {events} events: nothing to measure")]
    NoSteps {
        /// How many events the run had.
        events: u64,
    },
    /// Two runs without one step or command between them.
    #[error("neither run holds a controller step or a command: nothing to compare")]
    NothingToDiff,
    /// A comparison over no log at all.
    #[error("no log to compare")]
    NoLogs,
    /// Neither controller ever took over, so nothing was put to the test.
    #[error("in none of {logs} logs does either controller ever take over: nothing to compare")]
    NeverEngaged {
        /// How many logs were compared.
        logs: usize,
    },
    /// A tolerance file that cannot be used.
    #[error("tolerance file: {0}")]
    Tolerance(String),
    /// A gate file that cannot be used.
    #[error("gate file: {0}")]
    Gate(String),
    /// A golden file that cannot be used.
    #[error("golden file: {0}")]
    Golden(String),
    /// The HTML page could not be filled in.
    #[error("report page: {0}")]
    Page(#[from] minijinja::Error),
    /// The result could not be written as JSON.
    #[error("report as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

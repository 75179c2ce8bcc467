//! How sure a change is: numbers in, numbers out.
//!
//! Replay is deterministic, so the only uncertainty is over logs: which sessions happened to be
//! recorded. Every quantity here is a paired difference per log, B − A.
//!
//! - [`bca`], [`bca_clustered`]: an interval for the mean difference, from resampling the logs, or
//!   clusters of logs that belong together;
//! - [`sign_flip()`]: how often chance alone would give so large a mean difference;
//! - [`holm()`]: several such tests at once.

mod bootstrap;
mod generator;
mod holm;
mod normal;
mod sign_flip;

#[cfg(test)]
mod tests;

pub use bootstrap::{Cluster, Interval, bca, bca_clustered};
pub use generator::Generator;
pub use holm::holm;
pub use normal::{normal_cdf, normal_quantile};
pub use sign_flip::sign_flip;

/// The arithmetic mean; `None` of nothing.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

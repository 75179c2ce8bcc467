//! JSON for machines: the result object itself.

use crate::CompareError;
use crate::comparison::Comparison;

/// The comparison as indented JSON with a newline at its end. Values without a meaning are `null`.
///
/// # Errors
/// [`CompareError::Json`]; every field has a JSON form, so that is not expected.
pub fn json(comparison: &Comparison) -> Result<String, CompareError> {
    let mut text = serde_json::to_string_pretty(comparison)?;
    text.push('\n');
    Ok(text)
}

//! A diff as text.

use std::fmt::Write;

use super::number::number;
use super::table::{Align, columns};
use crate::diff::Diff;

/// The first cause in a sentence, then every field that differs, in the order of the data flow.
pub fn diff_text(diff: &Diff) -> String {
    use Align::{Left, Right};
    let compared = diff.compared;
    if diff.same {
        return format!(
            "= same: {} steps, {} messages compared, no difference\n",
            compared.steps, compared.messages
        );
    }
    if diff.fields.is_empty() {
        return format!(
            "? no difference in {} steps, {} messages, as far as both runs can be read\n",
            compared.steps, compared.messages
        );
    }
    let mut text = format!(
        "≠ different: {} of {} messages both runs have ({} steps)\n",
        compared.differing, compared.messages, compared.steps
    );
    if let Some(cause) = &diff.first_cause {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "first cause: {}", cause.reason);
    }
    if !diff.whole {
        text.push_str("compared as far as both runs can be read\n");
    }
    text.push('\n');
    let head = [
        "stage",
        "field",
        "unit",
        "first at s",
        "count",
        "max |A - B|",
        "at s",
        "max relative",
        "lag",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for field in &diff.fields {
        let mut count = field.count.to_string();
        if field.undefined > 0 {
            count = format!("{count} ({} NaN in one)", field.undefined);
        }
        rows.push(vec![
            field.node.clone(),
            field.field.clone(),
            field.unit.clone(),
            format!("{:.3}", field.first_at_s),
            count,
            number(field.max_abs),
            field.max_abs_at_s.map_or_else(|| number(None), |t_s| format!("{t_s:.3}")),
            number(field.max_rel),
            field.lag_steps.map_or_else(String::new, lag),
        ]);
    }
    text.push_str(&columns(&[Left, Left, Left, Right, Right, Right, Right, Right, Left], &rows));
    text
}

/// `B 2 steps later`.
fn lag(steps: i32) -> String {
    let (count, side) = (steps.unsigned_abs(), if steps > 0 { "later" } else { "earlier" });
    format!("B {count} {} {side}", if count == 1 { "step" } else { "steps" })
}

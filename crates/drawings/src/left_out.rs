//! What of a file is not drawn, in words.

use std::collections::BTreeMap;

/// Sentences for what of a file is not drawn, and how often.
pub(crate) fn not_drawn(left_out: BTreeMap<String, usize>) -> Vec<String> {
    let sentence = |(what, times)| match times {
        1 => format!("not drawn: {what}"),
        _ => format!("not drawn: {what} ({times} times)"),
    };
    left_out.into_iter().map(sentence).collect()
}

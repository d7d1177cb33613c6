//! The line of a script that an error is about, with a mark under its place.
//!
//! In: an error and the script's text. Out: the line that the error names, with
//! the line before it and a caret below; nothing if the error names no place in
//! the script.

use isoslice::model::LoadError;

/// Longest part of a line that is shown, characters.
const LONGEST: usize = 100;

/// The error of a model's loading behind an error, of whichever part of a plate.
pub(super) fn of_loading(error: &anyhow::Error) -> Option<&LoadError> {
    error.chain().find_map(|e| {
        let boxed = || e.downcast_ref::<Box<LoadError>>().map(AsRef::as_ref);
        e.downcast_ref::<LoadError>().or_else(boxed)
    })
}

/// The place of an error in the script that caused it. `text` gives the text of
/// a file.
pub(super) fn excerpt(
    error: &anyhow::Error,
    text: impl FnOnce(&str) -> Option<String>,
) -> Option<String> {
    let LoadError::Script { file, error, .. } = of_loading(error)? else {
        return None;
    };
    let text = text(file)?;
    let (line, column) = error.place();
    let line = line?.checked_sub(1)?;
    let mut shown = String::new();
    for at in line.saturating_sub(1)..=line {
        let Some(text) = text.lines().nth(at) else {
            continue;
        };
        let text: String = text.chars().take(LONGEST).collect();
        let text = text.replace('\t', " ");
        shown.push_str(&format!("{:>5} | {text}\n", at + 1));
    }
    if let Some(column) = column.filter(|c| (1..=LONGEST).contains(c)) {
        shown.push_str(&format!("      | {:>column$}\n", '^'));
    }
    Some(shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice::model::{Source, load};

    fn failing(text: &str) -> Option<String> {
        let source = Source::script("part", text);
        let error = load(&source, &[]).err().unwrap().into();
        excerpt(&error, |_| Some(text.to_owned()))
    }

    #[test]
    fn a_caret_stands_under_the_mistake() {
        let shown = failing("let r = 2.0;\nx - rr").unwrap();
        assert_eq!(
            shown,
            "    1 | let r = 2.0;\n    2 | x - rr\n      |     ^\n"
        );
        assert_eq!(failing("1.5"), None);
    }

    #[test]
    fn a_long_line_is_cut() {
        let shown = failing(&format!("{}+ rr", "x + ".repeat(99))).unwrap();
        assert!(shown.lines().all(|l| l.chars().count() <= LONGEST + 8));
    }
}

//! Cura's formulas, as far as they are arithmetic: `speed_print * 0.5`,
//! `'brim'`. Formulas with conditions or functions stay as they are.

use crate::values::{Values, parse};

/// Greatest length of a formula, bytes, and depth of its brackets and names.
const LONGEST: usize = 200;
const DEEPEST: usize = 12;
/// Greatest number of names that one formula may lead to.
const MOST_NAMES: usize = 100;

/// Replaces formulas by their results.
pub(crate) fn solve(values: &mut Values) {
    let keys: Vec<String> = values.keys().map(ToOwned::to_owned).collect();
    for key in keys {
        let Some(text) = values.text(&key) else {
            continue;
        };
        let formula = text.strip_prefix('=').unwrap_or(text).trim();
        let quoted = formula
            .strip_prefix('\'')
            .and_then(|rest| rest.strip_suffix('\''))
            .filter(|inner| !inner.contains('\''));
        if let Some(word) = quoted {
            let word = word.to_owned();
            values.set(&key, vec![word]);
            continue;
        }
        if parse(formula).is_some() {
            continue;
        }
        let mut left = MOST_NAMES;
        if let Some(result) = result(formula, values, 0, &mut left) {
            let rounded = (result * 1e6).round() / 1e6;
            values.set(&key, vec![rounded.to_string()]);
        }
    }
}

fn result(
    formula: &str,
    values: &Values,
    depth: usize,
    left: &mut usize,
) -> Option<f64> {
    let formula = formula.trim().trim_start_matches('=');
    if formula.len() > LONGEST || depth > DEEPEST || *left == 0 {
        return None;
    }
    *left -= 1;
    let mut work = Work {
        rest: formula.trim(),
        values,
        depth,
        left,
    };
    let result = work.sum()?;
    (work.rest.is_empty() && result.is_finite()).then_some(result)
}

struct Work<'a> {
    rest: &'a str,
    values: &'a Values,
    depth: usize,
    left: &'a mut usize,
}

impl Work<'_> {
    fn take(&mut self, sign: char) -> bool {
        match self.rest.strip_prefix(sign) {
            Some(rest) => {
                self.rest = rest.trim_start();
                true
            }
            None => false,
        }
    }

    fn sum(&mut self) -> Option<f64> {
        let mut x = self.product()?;
        loop {
            if self.take('+') {
                x += self.product()?;
            } else if self.take('-') {
                x -= self.product()?;
            } else {
                return Some(x);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut x = self.atom()?;
        loop {
            if self.take('*') {
                x *= self.atom()?;
            } else if self.take('/') {
                x /= self.atom()?;
            } else {
                return Some(x);
            }
        }
    }

    fn atom(&mut self) -> Option<f64> {
        if self.take('(') {
            self.depth += 1;
            if self.depth > DEEPEST {
                return None;
            }
            let x = self.sum()?;
            self.depth -= 1;
            return self.take(')').then_some(x);
        }
        let of = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
        let end = self.rest.find(|c| !of(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        if word.is_empty() {
            return None;
        }
        self.rest = rest.trim_start();
        if word.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            return parse(word);
        }
        let text = self.values.text(word)?;
        result(text, self.values, self.depth + 1, self.left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_of_known_names_is_solved_and_the_rest_is_left() {
        let mut values = Values::default();
        for (key, text) in [
            ("speed_print", "60"),
            ("speed_wall", "=speed_print / 2"),
            ("speed_wall_0", "(speed_wall + 2*3) * 0.5"),
            ("adhesion_type", "'brim'"),
            ("a", "b"),
            ("b", "a"),
            ("c", "max(speed_print, 3)"),
            ("d", "1 / 0"),
            ("e", "G28"),
        ] {
            values.set(key, vec![text.to_owned()]);
        }
        solve(&mut values);
        for (key, expected) in [
            ("speed_wall", "30"),
            ("speed_wall_0", "18"),
            ("adhesion_type", "brim"),
            ("a", "b"),
            ("c", "max(speed_print, 3)"),
            ("d", "1 / 0"),
            ("e", "G28"),
        ] {
            assert_eq!(values.text(key), Some(expected), "{key}");
        }
    }
}

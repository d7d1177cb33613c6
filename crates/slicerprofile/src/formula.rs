//! Cura's formulas, which are Python's: `speed_print * 0.5`,
//! `'off' if retraction_hop_enabled else 'infill'`, `max(5, line_width * 10)`.
//! Formulas with names or functions that are not known stay as they are.

use crate::values::{Values, parse};
use std::borrow::Cow;

/// Greatest length of a formula, bytes, and depth of its brackets and names.
const LONGEST: usize = 400;
const DEEPEST: usize = 12;
/// Greatest number of names that one formula may lead to.
const MOST_NAMES: usize = 100;

/// What Cura takes for settings that neither the printer nor the profile gives,
/// as far as formulas ask for them and filaments do not change them.
const DEFAULTS: &[(&str, &str)] = &[
    ("infill_sparse_density", "20"),
    ("layer_height", "0.1"),
    ("line_width", "machine_nozzle_size"),
    ("machine_nozzle_size", "0.4"),
    ("retraction_hop_enabled", "False"),
    ("retraction_speed", "25"),
    ("speed_print", "60"),
    ("support_enable", "False"),
    ("support_structure", "'normal'"),
    ("support_type", "'everywhere'"),
    ("wall_line_width", "line_width"),
    ("wall_line_width_0", "wall_line_width"),
    ("wall_line_width_x", "wall_line_width"),
];

/// Words that are no names of settings.
const WORDS: [&str; 5] = ["if", "else", "and", "or", "not"];

/// What a formula may come to.
#[derive(Clone, Debug, PartialEq)]
enum Solved {
    Number(f64),
    Switch(bool),
    Word(String),
}

impl Solved {
    fn number(&self) -> Option<f64> {
        match self {
            Solved::Number(x) => Some(*x),
            Solved::Switch(on) => Some(f64::from(u8::from(*on))),
            Solved::Word(_) => None,
        }
    }

    fn holds(&self) -> bool {
        match self {
            Solved::Number(x) => *x != 0.0,
            Solved::Switch(on) => *on,
            Solved::Word(word) => !word.is_empty(),
        }
    }

    fn text(&self) -> String {
        match self {
            Solved::Number(x) => ((x * 1e6).round() / 1e6).to_string(),
            Solved::Switch(true) => "True".to_owned(),
            Solved::Switch(false) => "False".to_owned(),
            Solved::Word(word) => word.clone(),
        }
    }
}

/// Replaces formulas by their results.
pub(crate) fn solve(values: &mut Values) {
    let keys: Vec<String> = values.keys().map(ToOwned::to_owned).collect();
    let mut solved = Vec::new();
    for key in keys {
        let Some(text) = values.text(&key) else {
            continue;
        };
        if parse(text).is_some() {
            continue;
        }
        let mut left = MOST_NAMES;
        if let Some(result) = result(text, values, 0, &mut left) {
            solved.push((key, result.text()));
        }
    }
    for (key, result) in solved {
        values.set(&key, vec![result]);
    }
}

fn result(
    formula: &str,
    values: &Values,
    depth: usize,
    left: &mut usize,
) -> Option<Solved> {
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
    let result = work.choice()?;
    let finite = result.number().is_none_or(f64::is_finite);
    (work.rest.is_empty() && finite).then_some(result)
}

struct Work<'a> {
    rest: &'a str,
    values: &'a Values,
    depth: usize,
    left: &'a mut usize,
}

impl<'a> Work<'a> {
    fn take(&mut self, sign: &str) -> bool {
        match self.rest.strip_prefix(sign) {
            Some(rest) => {
                self.rest = rest.trim_start();
                true
            }
            None => false,
        }
    }

    /// The name or the number at the beginning of what is left.
    fn word(&self) -> &'a str {
        let of = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
        let end = self.rest.find(|c| !of(c)).unwrap_or(self.rest.len());
        &self.rest[..end]
    }

    fn take_word(&mut self, word: &str) -> bool {
        self.word() == word && self.take(word)
    }

    /// Does work on something in brackets, or a choice's other side.
    fn deeper<T>(
        &mut self,
        work: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return None;
        }
        let done = work(self);
        self.depth -= 1;
        done
    }

    /// `a if b else c`.
    fn choice(&mut self) -> Option<Solved> {
        let first = self.any();
        if !self.take_word("if") {
            return first;
        }
        let holds = self.any()?.holds();
        if !self.take_word("else") {
            return None;
        }
        let second = self.deeper(Self::choice);
        if holds { first } else { second }
    }

    fn any(&mut self) -> Option<Solved> {
        let mut a = self.all()?;
        while self.take_word("or") {
            let b = self.all()?;
            a = if a.holds() { a } else { b };
        }
        Some(a)
    }

    fn all(&mut self) -> Option<Solved> {
        let mut a = self.negated()?;
        while self.take_word("and") {
            let b = self.negated()?;
            a = if a.holds() { b } else { a };
        }
        Some(a)
    }

    fn negated(&mut self) -> Option<Solved> {
        if self.take_word("not") {
            let a = self.deeper(Self::negated)?;
            return Some(Solved::Switch(!a.holds()));
        }
        let a = self.sum()?;
        for sign in ["==", "!=", "<=", ">=", "<", ">"] {
            if self.take(sign) {
                let b = self.sum()?;
                return Some(Solved::Switch(compared(sign, &a, &b)?));
            }
        }
        Some(a)
    }

    fn sum(&mut self) -> Option<Solved> {
        let mut a = self.product()?;
        loop {
            if self.take("+") {
                a = Solved::Number(a.number()? + self.product()?.number()?);
            } else if self.take("-") {
                a = Solved::Number(a.number()? - self.product()?.number()?);
            } else {
                return Some(a);
            }
        }
    }

    fn product(&mut self) -> Option<Solved> {
        let mut a = self.signed()?;
        loop {
            let of = |a: f64, b: Solved, f: fn(f64, f64) -> f64| {
                Some(Solved::Number(f(a, b.number()?)))
            };
            if self.take("*") {
                a = of(a.number()?, self.signed()?, |a, b| a * b)?;
            } else if self.take("//") {
                a = of(a.number()?, self.signed()?, |a, b| (a / b).floor())?;
            } else if self.take("/") {
                a = of(a.number()?, self.signed()?, |a, b| a / b)?;
            } else if self.take("%") {
                a = of(a.number()?, self.signed()?, f64::rem_euclid)?;
            } else {
                return Some(a);
            }
        }
    }

    fn signed(&mut self) -> Option<Solved> {
        if self.take("-") {
            let a = self.deeper(Self::signed)?;
            return Some(Solved::Number(-a.number()?));
        }
        self.atom()
    }

    fn atom(&mut self) -> Option<Solved> {
        if self.take("(") {
            let a = self.deeper(Self::choice)?;
            return self.take(")").then_some(a);
        }
        for quote in ["'", "\""] {
            if let Some(rest) = self.rest.strip_prefix(quote) {
                let (word, rest) = rest.split_once(quote)?;
                self.rest = rest.trim_start();
                return Some(Solved::Word(word.to_owned()));
            }
        }
        let word = self.word();
        if word.is_empty() || WORDS.contains(&word) {
            return None;
        }
        self.take(word);
        if word.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            return parse(word).map(Solved::Number);
        }
        if self.take("(") {
            let mut given = Vec::new();
            while !self.take(")") {
                given.push(self.deeper(Self::choice)?);
                if !self.take(",") && !self.rest.starts_with(')') {
                    return None;
                }
            }
            return self.called(word, &given);
        }
        match word {
            "True" | "true" => Some(Solved::Switch(true)),
            "False" | "false" => Some(Solved::Switch(false)),
            "math.pi" => Some(Solved::Number(std::f64::consts::PI)),
            name => self.of_name(name),
        }
    }

    /// The value of a setting.
    fn of_name(&mut self, name: &str) -> Option<Solved> {
        let default = || DEFAULTS.iter().find(|(known, _)| *known == name);
        let text: Cow<'_, str> = match self.values.text(name) {
            Some(text) => text.into(),
            None => default()?.1.into(),
        };
        let solved = result(&text, self.values, self.depth + 1, self.left);
        // A word that is no formula is a word.
        let is_word = text.chars().all(|c| c.is_ascii_alphabetic() || c == '_');
        let is_word = is_word && self.values.text(&text).is_none();
        solved.or_else(|| is_word.then(|| Solved::Word(text.into_owned())))
    }

    /// What a function makes of what it is given.
    fn called(&mut self, name: &str, given: &[Solved]) -> Option<Solved> {
        let numbers: Option<Vec<f64>> =
            given.iter().map(Solved::number).collect();
        let number = match (name, given) {
            // There is one extruder.
            ("defaultExtruderPosition", []) => 0.0,
            ("resolveOrValue" | "extruderValues", [Solved::Word(setting)])
            | ("extruderValue", [_, Solved::Word(setting)]) => {
                let mut left = *self.left;
                let depth = self.depth + 1;
                let found = result(setting, self.values, depth, &mut left);
                *self.left = left;
                return found;
            }
            _ => match (name, numbers?.as_slice()) {
                ("max", [first, rest @ ..]) => {
                    rest.iter().copied().fold(*first, f64::max)
                }
                ("min", [first, rest @ ..]) => {
                    rest.iter().copied().fold(*first, f64::min)
                }
                ("round", [x]) => x.round_ties_even(),
                ("round", [x, digits]) => {
                    let scale = 10_f64.powf(digits.clamp(0.0, 9.0).trunc());
                    (x * scale).round() / scale
                }
                ("int", [x]) => x.trunc(),
                ("float", [x]) => *x,
                ("abs", [x]) => x.abs(),
                ("math.floor", [x]) => x.floor(),
                ("math.ceil", [x]) => x.ceil(),
                ("math.sqrt", [x]) => x.sqrt(),
                ("math.tan", [x]) => x.tan(),
                ("math.atan", [x]) => x.atan(),
                ("math.degrees", [x]) => x.to_degrees(),
                ("math.radians", [x]) => x.to_radians(),
                _ => return None,
            },
        };
        Some(Solved::Number(number))
    }
}

/// Whether a comparison holds, if the two can be compared.
fn compared(sign: &str, a: &Solved, b: &Solved) -> Option<bool> {
    let equal = match (a, b) {
        (Solved::Word(a), Solved::Word(b)) => a == b,
        (Solved::Word(_), _) | (_, Solved::Word(_)) => false,
        (a, b) => a.number() == b.number(),
    };
    Some(match sign {
        "==" => equal,
        "!=" => !equal,
        "<=" => a.number()? <= b.number()?,
        ">=" => a.number()? >= b.number()?,
        "<" => a.number()? < b.number()?,
        _ => a.number()? > b.number()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(given: &[(&str, &str)]) -> Values {
        let mut values = Values::default();
        for (key, text) in given {
            values.set(key, vec![(*text).to_owned()]);
        }
        solve(&mut values);
        values
    }

    #[test]
    fn arithmetic_of_known_names_is_solved_and_the_rest_is_left() {
        let values = solved(&[
            ("speed_print", "60"),
            ("speed_wall", "=speed_print / 2"),
            ("speed_wall_0", "(speed_wall + 2*3) * 0.5"),
            ("adhesion_type", "'brim'"),
            ("a", "b"),
            ("b", "a"),
            ("c", "sum(speed_print, 3)"),
            ("d", "1 / 0"),
            ("e", "G28"),
            ("f", "speed_print and"),
            ("g", "unknown * 2"),
        ]);
        for (key, expected) in [
            ("speed_wall", "30"),
            ("speed_wall_0", "18"),
            ("adhesion_type", "brim"),
            ("a", "b"),
            ("c", "sum(speed_print, 3)"),
            ("d", "1 / 0"),
            ("e", "G28"),
            ("f", "speed_print and"),
            ("g", "unknown * 2"),
        ] {
            assert_eq!(values.text(key), Some(expected), "{key}");
        }
    }

    /// Formulas of Cura's own printers.
    #[test]
    fn conditions_and_functions_are_solved() {
        let values = solved(&[
            ("layer_height", "0.12"),
            ("support_structure", "tree"),
            ("support_enable", "True"),
            (
                "a",
                "layer_height if layer_height >= 0.16 else layer_height*2",
            ),
            ("b", "'lines' if infill_sparse_density > 50 else 'cubic'"),
            (
                "c",
                "0 if support_enable and support_structure == 'tree' else 20",
            ),
            (
                "d",
                "math.floor(math.degrees(math.atan(line_width/2.0/layer_height)))",
            ),
            (
                "e",
                "150.0 if speed_print < 60 else 250.0 if speed_print > 100 \
                 else speed_print * 2.5",
            ),
            ("f", "max(retraction_speed - 30, 5)"),
            ("g", "round(machine_nozzle_size / 1.5, 2)"),
            ("h", "'off' if retraction_hop_enabled else 'infill'"),
            ("i", "not support_enable or 3 != 3"),
            (
                "j",
                "extruderValue(support_extruder_nr, 'layer_height') * 2",
            ),
            ("k", "7 if unknown else 8"),
            ("support_extruder_nr", "0"),
            ("l", "7 if layer_height > 1 else -8 % 3"),
        ]);
        for (key, expected) in [
            ("a", "0.24"),
            ("b", "cubic"),
            ("c", "0"),
            ("d", "59"),
            ("e", "150"),
            ("f", "5"),
            ("g", "0.27"),
            ("h", "infill"),
            ("i", "False"),
            ("j", "0.24"),
            ("k", "7 if unknown else 8"),
            ("l", "1"),
        ] {
            assert_eq!(values.text(key), Some(expected), "{key}");
        }
    }

    #[test]
    fn what_goes_too_deep_is_left() {
        for text in [
            format!("{}1{}", "(".repeat(50), ")".repeat(50)),
            format!("{}1", "-".repeat(300)),
            format!("{}1", "not ".repeat(90)),
            format!("{}1", "1 if 0 else ".repeat(30)),
        ] {
            let values = solved(&[("a", &text)]);
            assert_eq!(values.text("a"), Some(text.as_str()));
        }
    }
}

//! Options of functions that read data: `#{ width: 60, border: "repeat" }`.

use crate::param::nearest;
use isoslice_base::units::human_number;
use std::collections::BTreeMap;
use std::fmt;

/// What an option is given as.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Given {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// Several numbers or texts.
    List(Vec<Given>),
}

impl fmt::Display for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Given::Number(v) => f.write_str(&human_number(*v)),
            Given::Text(t) => write!(f, "{t:?}"),
            Given::List(all) => {
                let all: Vec<String> =
                    all.iter().map(Given::to_string).collect();
                write!(f, "[{}]", all.join(", "))
            }
        }
    }
}

/// Options by their names.
pub(crate) type Options = BTreeMap<String, Given>;

/// Reads the options of a function, each once.
pub(super) struct Reader<'a> {
    function: &'static str,
    given: &'a Options,
    known: Vec<&'static str>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(function: &'static str, given: &'a Options) -> Self {
        Reader {
            function,
            given,
            known: Vec::new(),
        }
    }

    fn take(&mut self, name: &'static str) -> Option<&'a Given> {
        self.known.push(name);
        self.given.get(name)
    }

    fn wrong(&self, name: &str, wants: &str, found: &Given) -> String {
        format!("{}: {name} is {wants}, not {found}", self.function)
    }

    /// A number.
    pub(super) fn number(
        &mut self,
        name: &'static str,
    ) -> Result<Option<f64>, String> {
        match self.take(name) {
            None => Ok(None),
            Some(Given::Number(v)) if v.is_finite() => Ok(Some(*v)),
            Some(other) => Err(self.wrong(name, "a number", other)),
        }
    }

    /// As many numbers as there are axes; one number stands for all of them.
    pub(super) fn numbers(
        &mut self,
        name: &'static str,
    ) -> Result<Option<[f64; 3]>, String> {
        let wrong = |of: &Self, given: &Given| {
            of.wrong(name, "a number, or a list of three", given)
        };
        match self.take(name) {
            None => Ok(None),
            Some(Given::Number(v)) => Ok(Some([*v; 3])),
            Some(given @ Given::List(all)) => {
                let number = |g: &Given| match g {
                    Given::Number(v) => Some(*v),
                    _ => None,
                };
                let all: Option<Vec<f64>> = all.iter().map(number).collect();
                let all: Option<[f64; 3]> =
                    all.and_then(|all| all.try_into().ok());
                all.map(Some).ok_or_else(|| wrong(self, given))
            }
            Some(given) => Err(wrong(self, given)),
        }
    }

    /// A text.
    pub(super) fn text(
        &mut self,
        name: &'static str,
    ) -> Result<Option<String>, String> {
        match self.take(name) {
            None => Ok(None),
            Some(Given::Text(text)) => Ok(Some(text.clone())),
            Some(other) => Err(self.wrong(name, "a text in quotes", other)),
        }
    }

    /// Several texts; one text stands for a list of it.
    pub(super) fn texts(
        &mut self,
        name: &'static str,
    ) -> Result<Option<Vec<String>>, String> {
        let text = |given: &Given| match given {
            Given::Text(text) => Some(text.clone()),
            _ => None,
        };
        let Some(given) = self.take(name) else {
            return Ok(None);
        };
        let all: Option<Vec<String>> = match given {
            Given::List(all) => all.iter().map(text).collect(),
            one => text(one).map(|text| vec![text]),
        };
        all.map(Some).ok_or_else(|| {
            self.wrong(name, "a text in quotes, or a list of texts", given)
        })
    }

    /// One of some words.
    pub(super) fn word<T: Copy>(
        &mut self,
        name: &'static str,
        words: &[(&str, T)],
    ) -> Result<Option<T>, String> {
        match self.take(name) {
            None => Ok(None),
            Some(given) => self.one_of(name, words, given).map(Some),
        }
    }

    /// One of some words for each axis; one word stands for all of them.
    pub(super) fn words<T: Copy, const N: usize>(
        &mut self,
        name: &'static str,
        words: &[(&str, T)],
    ) -> Result<Option<[T; N]>, String> {
        let Some(given) = self.take(name) else {
            return Ok(None);
        };
        let all: Vec<T> = match given {
            Given::List(all) => all
                .iter()
                .map(|g| self.one_of(name, words, g))
                .collect::<Result<_, _>>()?,
            one => vec![self.one_of(name, words, one)?; N],
        };
        let found = all.try_into().ok();
        let wants = format!("a word, or a list of {N} words");
        found
            .map(Some)
            .ok_or_else(|| self.wrong(name, &wants, given))
    }

    fn one_of<T: Copy>(
        &self,
        name: &str,
        words: &[(&str, T)],
        given: &Given,
    ) -> Result<T, String> {
        let found = match given {
            Given::Text(text) => words.iter().find(|(word, _)| word == text),
            _ => None,
        };
        found.map(|(_, value)| *value).ok_or_else(|| {
            let all: Vec<String> =
                words.iter().map(|(word, _)| format!("{word:?}")).collect();
            self.wrong(name, &format!("one of {}", all.join(", ")), given)
        })
    }

    /// Checks that every option was read.
    pub(super) fn finish(self) -> Result<(), String> {
        let unknown = |name: &&String| !self.known.contains(&name.as_str());
        let Some(name) = self.given.keys().find(unknown) else {
            return Ok(());
        };
        let function = self.function;
        if self.known.is_empty() {
            return Err(format!("{function} has no options"));
        }
        let meant = nearest(name, self.known.iter().copied())
            .map(|meant| format!("; did you mean {meant}?"))
            .unwrap_or_default();
        Err(format!(
            "{function} has no option {name:?}{meant} (it has {})",
            self.known.join(", ")
        ))
    }
}

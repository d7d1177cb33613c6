//! Parameters of a script: `param(name, default, description, bounds)` in the
//! script, `-D name=value` on the command line.
//!
//! In: the definitions given by the user, and the calls made by the script.
//! Out: the value of each call, the list of parameters, and an error for a
//! definition that no call has asked for. A value has the type of its default;
//! numbers are of one type, unless the parameter counts (`Allowed`).

use super::allowed::{Allowed, Said};
use super::value::Value;

/// A parameter that a script declares.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name, as in `-D name=value`.
    pub name: String,
    /// Value without `-D`.
    pub default: String,
    /// Value in this run.
    pub value: String,
    /// The script's description; empty if it gives none.
    pub description: String,
    /// What the parameter may be set to.
    pub allowed: Allowed,
    /// It takes whole numbers only.
    pub counts: bool,
}

/// Why a parameter has no value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParamError {
    /// A value of the wrong type.
    #[error(
        "-D {name}={value}: `{value}` is not {expected} (the default of \
         `{name}` is {default})"
    )]
    WrongType {
        /// Parameter.
        name: String,
        /// The text given.
        value: String,
        /// What the value should be.
        expected: &'static str,
        /// The default.
        default: String,
    },
    /// A value that the script does not allow.
    #[error("-D {name}={value}: the script allows {allowed}")]
    NotAllowed {
        /// Parameter.
        name: String,
        /// The value given.
        value: String,
        /// What is allowed, in words.
        allowed: String,
    },
    /// Bounds that make no sense.
    #[error("the parameter `{name}`: {what}")]
    BadBounds {
        /// Parameter.
        name: String,
        /// What is wrong with its bounds.
        what: String,
    },
    /// The parameter is declared twice, with different defaults.
    #[error(
        "the parameter `{name}` is declared twice, with the defaults {first} \
         and {second}; declare it once and keep its value in a variable"
    )]
    Redeclared {
        /// Parameter.
        name: String,
        /// Default of the first call.
        first: String,
        /// Default of the second.
        second: String,
    },
    /// The name is not usable.
    #[error("`{name}` cannot be a parameter's name; use letters, digits and _")]
    BadName {
        /// The name.
        name: String,
    },
    /// There are more parameters than anybody could set.
    #[error("the script declares more than {limit} parameters")]
    TooMany {
        /// The limit.
        limit: usize,
    },
    /// `-D` for a parameter that does not exist.
    #[error("unknown parameter -D {name}{}; {}",
        meant.as_ref().map(|m| format!(" (did you mean `{m}`?)"))
            .unwrap_or_default(),
        if known.is_empty() {
            "the model has no parameters (scripts declare them with \
             param(\"name\", default))".to_owned()
        } else {
            format!("the model has {}", known.join(", "))
        })]
    Unknown {
        /// The name given.
        name: String,
        /// The nearest known name.
        meant: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
}

/// Greatest number of parameters that a script may declare.
const MAX_PARAMETERS: usize = 1000;

/// The parameters of one run of a script.
#[derive(Debug, Default)]
pub(super) struct Table {
    defines: Vec<(String, String)>,
    declared: Vec<(Parameter, Value)>,
}

impl Table {
    pub(super) fn new(defines: &[(String, String)]) -> Self {
        Self {
            defines: defines.to_vec(),
            declared: Vec::new(),
        }
    }

    /// The value of `param(name, default, description, bounds)`.
    pub(super) fn declare(
        &mut self,
        name: &str,
        default: Value,
        description: &str,
        bounds: &[(String, Said)],
    ) -> Result<Value, ParamError> {
        let shown = default.to_string();
        let mut allowed = Allowed::default();
        bounds
            .iter()
            .try_for_each(|(bound, said)| allowed.say(bound, said, default))
            .and_then(|()| allowed.check(default))
            .map_err(|what| ParamError::BadBounds {
                name: name.chars().take(64).collect(),
                what,
            })?;
        let counts = allowed.counts(default);
        let value = self
            .defines
            .iter()
            // The last of several definitions wins, as with other options.
            .rfind(|d| d.0 == name)
            .map(|(_, text)| {
                let value = default.parse_like(text).and_then(|v| match v {
                    Value::Float(_) if counts => Err("a whole number"),
                    v => Ok(v),
                });
                value.map_err(|expected| ParamError::WrongType {
                    name: name.to_owned(),
                    value: text.clone(),
                    expected,
                    default: shown.clone(),
                })
            })
            .transpose()?
            .unwrap_or(default);
        if !allowed.holds(value) {
            return Err(ParamError::NotAllowed {
                name: name.to_owned(),
                value: value.to_string(),
                allowed: allowed.to_string(),
            });
        }
        if let Some((first, value)) =
            self.declared.iter().find(|p| p.0.name == name)
        {
            if first.default != shown {
                return Err(ParamError::Redeclared {
                    name: name.to_owned(),
                    first: first.default.clone(),
                    second: shown,
                });
            }
            return Ok(*value);
        }
        let good = !name.is_empty()
            && name.len() <= 64
            && name.chars().all(|c| c.is_alphanumeric() || c == '_');
        if !good {
            return Err(ParamError::BadName {
                name: name.chars().take(64).collect(),
            });
        }
        if self.declared.len() >= MAX_PARAMETERS {
            return Err(ParamError::TooMany {
                limit: MAX_PARAMETERS,
            });
        }
        let parameter = Parameter {
            name: name.to_owned(),
            default: shown,
            value: value.to_string(),
            description: description.to_owned(),
            allowed,
            counts,
        };
        self.declared.push((parameter, value));
        Ok(value)
    }

    /// The list of parameters, if every definition was for one of them.
    pub(super) fn finish(self) -> Result<Vec<Parameter>, ParamError> {
        let parameters: Vec<Parameter> =
            self.declared.into_iter().map(|p| p.0).collect();
        for (name, _) in &self.defines {
            if !parameters.iter().any(|p| p.name == *name) {
                return Err(unknown(name, &parameters));
            }
        }
        Ok(parameters)
    }
}

/// The error for `-D name` without such a parameter.
fn unknown(name: &str, parameters: &[Parameter]) -> ParamError {
    let known: Vec<String> =
        parameters.iter().map(|p| p.name.clone()).collect();
    ParamError::Unknown {
        name: name.to_owned(),
        meant: nearest(name, known.iter().map(String::as_str))
            .map(str::to_owned),
        known,
    }
}

/// Refuses definitions for a model without parameters.
pub(super) fn none_wanted(
    defines: &[(String, String)],
) -> Result<(), ParamError> {
    match defines.first() {
        None => Ok(()),
        Some((name, _)) => Err(unknown(name, &[])),
    }
}

/// The known name that `name` is most likely a misspelling of.
pub(super) fn nearest<'a>(
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> Option<&'a str> {
    // Words of a hostile file may be megabytes long.
    if name.len() > 64 {
        return None;
    }
    known
        .map(|k| (strsim::damerau_levenshtein(name, k), k))
        .filter(|(d, k)| *d <= 1 + k.len() / 4 && *d < k.len())
        .min_by_key(|(d, _)| *d)
        .map(|(_, k)| k)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(defines: &[(&str, &str)]) -> Table {
        let defines: Vec<_> = defines
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
            .collect();
        Table::new(&defines)
    }

    #[test]
    fn values_have_the_type_of_their_default() {
        let mut t = table(&[("n", "4"), ("r", "4"), ("b", "false")]);
        assert_eq!(t.declare("n", Value::Int(2), "", &[]), Ok(Value::Int(4)));
        assert_eq!(
            t.declare("r", Value::Float(2.0), "radius", &[]),
            Ok(Value::Float(4.0))
        );
        assert_eq!(
            t.declare("b", Value::Bool(true), "", &[]),
            Ok(Value::Bool(false))
        );
        let all = t.finish().unwrap();
        assert_eq!(all[1].default, "2.0");
        assert_eq!(all[1].value, "4.0");
        assert_eq!(all[1].description, "radius");
    }

    #[test]
    fn wrong_types_name_the_parameter() {
        let step = |v| vec![("step".to_owned(), Said::One(Value::Int(v)))];
        let mut t = table(&[("n", "2.5"), ("r", "inf"), ("b", "1")]);
        for (name, default, bounds, words) in [
            ("n", Value::Int(2), step(1), "a whole number"),
            ("n", Value::Int(2), step(5), "a whole number"),
            ("r", Value::Float(2.0), vec![], "a number"),
            ("r", Value::Int(2), vec![], "a number"),
            ("b", Value::Bool(true), vec![], "true or false"),
        ] {
            let error = t.declare(name, default, "", &bounds).unwrap_err();
            let error = error.to_string();
            assert!(error.contains(words), "{error}");
            assert!(error.contains(&format!("-D {name}=")), "{error}");
        }
    }

    #[test]
    fn whole_defaults_take_fractions_unless_they_count() {
        let half = |v| vec![("step".to_owned(), Said::One(Value::Float(v)))];
        for (given, bounds, wanted) in [
            ("12.5", vec![], Value::Float(12.5)),
            ("12.5", half(0.5), Value::Float(12.5)),
            ("12", vec![], Value::Int(12)),
            ("12.0", half(1.0), Value::Int(12)),
            ("1e2", vec![], Value::Int(100)),
        ] {
            let mut t = table(&[("n", given)]);
            let value = t.declare("n", Value::Int(10), "", &bounds);
            assert_eq!(value, Ok(wanted), "{given}");
        }
        let all = [Value::Int(2), Value::Float(2.5)];
        let choices = [("choices".to_owned(), Said::Many(all.to_vec()))];
        let mut t = table(&[("n", "2.5")]);
        let value = t.declare("n", Value::Int(2), "", &choices);
        assert_eq!(value, Ok(Value::Float(2.5)));
    }

    #[test]
    fn the_last_definition_wins() {
        let mut t = table(&[("n", "1"), ("n", "2")]);
        assert_eq!(t.declare("n", Value::Int(0), "", &[]), Ok(Value::Int(2)));
    }

    #[test]
    fn a_second_declaration_must_agree() {
        let mut t = table(&[]);
        t.declare("n", Value::Int(1), "", &[]).unwrap();
        t.declare("n", Value::Int(1), "", &[]).unwrap();
        assert!(matches!(
            t.declare("n", Value::Int(2), "", &[]),
            Err(ParamError::Redeclared { .. })
        ));
        assert!(matches!(
            t.declare("n", Value::Float(1.0), "", &[]),
            Err(ParamError::Redeclared { .. })
        ));
    }

    #[test]
    fn unknown_definitions_list_the_known() {
        let mut t = table(&[("cel", "1")]);
        t.declare("cell", Value::Int(1), "", &[]).unwrap();
        t.declare("wall", Value::Int(1), "", &[]).unwrap();
        assert_eq!(
            t.finish().unwrap_err().to_string(),
            "unknown parameter -D cel (did you mean `cell`?); the model \
             has cell, wall"
        );
    }

    #[test]
    fn values_out_of_bounds_are_refused() {
        let bounds = [("max".to_owned(), Said::One(Value::Int(5)))];
        let mut t = table(&[("n", "6")]);
        let error = t.declare("n", Value::Int(2), "", &bounds).unwrap_err();
        assert_eq!(error.to_string(), "-D n=6: the script allows at most 5");
        let error = t.declare("m", Value::Int(7), "", &bounds).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the parameter `m`: its default, 7, is not at most 5"
        );
    }
}

//! What a parameter of a script may be set to.
//!
//! In: what the script says of the parameter, `#{ min: 2, max: 20, step: 0.5 }`
//! or `#{ choices: [3, 4, 6] }`. Out: whether a value is allowed, and the
//! bounds in words and numbers for a user interface. The step is that of a
//! slider, and does not bind values that are typed, but for this: a step of
//! whole numbers from a whole default takes whole numbers only.

use super::value::Value;
use isoslice_base::units::human_list;
use std::fmt;

/// Greatest number of choices of a parameter: more than a person would read.
const MAX_CHOICES: usize = 100;

/// What a parameter may be set to. Without any bound every value of its type is
/// allowed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Allowed {
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
    /// Step of a slider.
    pub step: Option<f64>,
    /// The only values, as they are written; empty if others are allowed.
    pub choices: Vec<String>,
}

impl Allowed {
    /// Takes over what a script says under a name, for a parameter whose
    /// default is `default`.
    ///
    /// # Errors
    /// What is wrong with the bound.
    pub(super) fn say(
        &mut self,
        name: &str,
        said: &Said,
        default: Value,
    ) -> Result<(), String> {
        let number = || match (said, default) {
            (_, Value::Bool(_)) => Err(format!(
                "{name} is for numbers, and its default is {default}"
            )),
            (Said::One(value), _) => value
                .number()
                .ok_or_else(|| format!("{name} must be a number")),
            (Said::Many(_), _) => Err(format!("{name} must be a number")),
        };
        match (name, said) {
            ("min", _) => self.min = Some(number()?),
            ("max", _) => self.max = Some(number()?),
            ("step", _) => {
                self.step = Some(number()?);
                if !self.step.is_some_and(|step| step > 0.0) {
                    return Err("step must be more than 0".to_owned());
                }
            }
            ("choices", Said::Many(values)) => {
                if values.is_empty() || values.len() > MAX_CHOICES {
                    return Err(format!(
                        "choices must have from 1 to {MAX_CHOICES} values"
                    ));
                }
                let written = values.iter().map(|value| {
                    let value = value.like(default);
                    value.map(|v| v.to_string()).ok_or_else(|| {
                        format!(
                            "all choices must have the type of the default, \
                             {default}"
                        )
                    })
                });
                self.choices = written.collect::<Result<_, _>>()?;
            }
            ("choices", Said::One(_)) => {
                return Err("choices must be an array, as in [3, 4, 6]".into());
            }
            _ => {
                return Err(format!(
                    "`{name}` is unknown: there are min, max, step and choices"
                ));
            }
        }
        Ok(())
    }

    /// True if a parameter with this default takes whole numbers only.
    pub(super) fn counts(&self, default: Value) -> bool {
        let whole = self.step.is_some_and(|step| step.fract() == 0.0);
        whole && matches!(default, Value::Int(_))
    }

    /// Tells whether the bounds fit together, and fit the default.
    ///
    /// # Errors
    /// What is wrong with the bounds.
    pub(super) fn check(&self, default: Value) -> Result<(), String> {
        let bounds = self.min.is_some() || self.max.is_some();
        if !self.choices.is_empty() && (bounds || self.step.is_some()) {
            return Err("choices leave no room for min, max or step".into());
        }
        if let (Some(min), Some(max)) = (self.min, self.max)
            && min >= max
        {
            return Err(format!("min ({min}) must be less than max ({max})"));
        }
        if self.holds(default) {
            Ok(())
        } else {
            Err(format!("its default, {default}, is not {self}"))
        }
    }

    /// True if a value may be set.
    pub(super) fn holds(&self, value: Value) -> bool {
        let number = value.number();
        let low = self.min.zip(number).is_none_or(|(min, n)| n >= min);
        let high = self.max.zip(number).is_none_or(|(max, n)| n <= max);
        let written = value.to_string();
        low && high
            && (self.choices.is_empty() || self.choices.contains(&written))
    }

    /// True if any value of the type is allowed.
    pub fn is_anything(&self) -> bool {
        self.min.is_none() && self.max.is_none() && self.choices.is_empty()
    }
}

/// What a script says under a name: a value, or several.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Said {
    One(Value),
    Many(Vec<Value>),
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.min, self.max, &self.choices[..]) {
            (Some(min), Some(max), []) => write!(f, "from {min} to {max}"),
            (Some(min), None, []) => write!(f, "at least {min}"),
            (None, Some(max), []) => write!(f, "at most {max}"),
            (_, _, []) => f.write_str("anything"),
            (_, _, choices) => f.write_str(&human_list(choices, "or")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn allowed(
        said: &[(&str, Said)],
        default: Value,
    ) -> Result<Allowed, String> {
        let mut allowed = Allowed::default();
        for (name, said) in said {
            allowed.say(name, said, default)?;
        }
        allowed.check(default)?;
        Ok(allowed)
    }

    #[test]
    fn ranges_hold_their_ends() {
        let one = |v| Said::One(Value::Int(v));
        let range =
            allowed(&[("min", one(2)), ("max", one(9))], Value::Float(2.0))
                .unwrap();
        for (value, held) in [(2.0, true), (9.0, true), (9.001, false)] {
            assert_eq!(range.holds(Value::Float(value)), held, "{value}");
        }
        assert!(!range.holds(Value::Float(1.999)));
        assert_eq!(range.to_string(), "from 2 to 9");
    }

    #[test]
    fn choices_are_of_the_defaults_type() {
        let of = |values: &[i64]| {
            Said::Many(values.iter().map(|v| Value::Int(*v)).collect())
        };
        let choices =
            allowed(&[("choices", of(&[3, 4, 6]))], Value::Float(4.0)).unwrap();
        assert!(choices.holds(Value::Float(6.0)));
        assert!(!choices.holds(Value::Float(5.0)));
        assert_eq!(choices.to_string(), "3.0, 4.0 or 6.0");
        for (said, default, words) in [
            (of(&[3]), Value::Int(4), "its default, 4, is not 3"),
            (of(&[3]), Value::Bool(true), "the type of the default"),
            (of(&[]), Value::Int(4), "from 1 to"),
        ] {
            let error = allowed(&[("choices", said)], default).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn bounds_that_make_no_sense_are_refused() {
        let one = |v| Said::One(Value::Float(v));
        for (said, words) in [
            (vec![("min", one(3.0)), ("max", one(3.0))], "less than"),
            (vec![("min", one(5.0))], "is not at least 5"),
            (vec![("step", one(0.0))], "more than 0"),
            (vec![("step", one(f64::NAN))], "a number"),
            (vec![("mim", one(1.0))], "there are min"),
            (vec![("choices", one(1.0))], "array"),
        ] {
            let error = allowed(&said, Value::Float(4.0)).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
        let error = allowed(&[("min", one(0.0))], Value::Bool(true));
        assert!(error.unwrap_err().contains("for numbers"));
    }
}

//! Values by steps: `25: 80%, 50: 30, 100: 10`.
//!
//! Each step is a share and the value there. Between steps the value changes
//! evenly, so that no step shows on the part.

use super::value::{Measure, Range, Raw, Refused, Value};
use isoslice_base::units::Percent;

/// Greatest number of steps.
const MOST_STEPS: usize = 20;

/// The value at a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum At {
    /// A value in the setting's unit.
    Value(f64),
    /// A share of the value without steps.
    OfOwn(Percent),
}

/// The quantity that steps give values of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Of {
    /// The values are speeds of the nozzle, mm/s, or shares of the speed
    /// without steps.
    Speed,
    /// The values are speeds of the fan, %.
    Fan,
}

impl Of {
    fn measure(self) -> Measure {
        let (unit, min, max) = match self {
            Of::Speed => ("mm/s", 0.1, 2000.0),
            Of::Fan => ("%", 0.0, 100.0),
        };
        let range = Some(Range::between(min, max));
        Measure { unit, range }
    }
}

/// Values at some shares above 0 to 100 %, interpolated between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    steps: Vec<(Percent, At)>,
}

impl Steps {
    /// The value at a share. `own` is the value without steps, and at 0 %. From
    /// the last step on the value stays as it is.
    pub fn at(&self, share: Percent, own: f64) -> f64 {
        let value = |at: At| match at {
            At::Value(value) => value,
            At::OfOwn(share) => 0.01 * share * own,
        };
        let mut from = (0.0, own);
        for (place, at) in &self.steps {
            let to = (*place, value(*at));
            if share < to.0 {
                let t = ((share - from.0) / (to.0 - from.0)).max(0.0);
                return from.1 + t * (to.1 - from.1);
            }
            from = to;
        }
        from.1
    }

    /// Reads steps, at least one.
    pub(super) fn read(text: &str, of: Of) -> Result<Steps, Refused> {
        let mut all = Steps { steps: Vec::new() };
        let mut last = 0.0;
        for step in text.split(',') {
            let (share, at) = read(step, of)?;
            if !(share > last && share <= 100.0)
                || all.steps.len() == MOST_STEPS
            {
                return Err(Refused::Type);
            }
            last = share;
            all.steps.push((share, at));
        }
        Ok(all)
    }
}

/// Reads one step.
fn read(text: &str, of: Of) -> Result<(Percent, At), Refused> {
    let (share, value) = text.split_once(':').ok_or(Refused::Type)?;
    let share = share.trim();
    let share = share.strip_suffix('%').unwrap_or(share).trim_end();
    let share: f64 = share.parse().map_err(|_| Refused::Type)?;
    let value = value.trim();
    if of == Of::Speed
        && let Some(own) = value.strip_suffix('%')
    {
        let own: f64 = own.trim_end().parse().map_err(|_| Refused::Type)?;
        return if (1.0..=100.0).contains(&own) {
            Ok((share, At::OfOwn(own)))
        } else {
            Err(Refused::Range)
        };
    }
    let number = Value::read(Raw::Word(value), of.measure())?;
    Ok((share, At::Value(number)))
}

impl Steps {
    pub(super) fn to_toml(&self) -> String {
        let steps = self.steps.iter().map(|(share, at)| {
            let share = share.to_toml();
            match at {
                At::Value(value) => format!("{share}: {}", value.to_toml()),
                At::OfOwn(own) => format!("{share}: {}%", own.to_toml()),
            }
        });
        format!("\"{}\"", steps.collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn values_go_on_evenly_between_steps() {
        let read = |text| Steps::read(text, Of::Speed).unwrap();
        let steps = read("10: 100%, 50%: 50 %, 100: 10");
        for (share, value) in [
            (0.0, 40.0),
            (10.0, 40.0),
            (30.0, 30.0),
            (50.0, 20.0),
            (75.0, 15.0),
            (100.0, 10.0),
        ] {
            assert!((steps.at(share, 40.0) - value).abs() < 1e-9, "{share}");
        }
        // Before the first step the value changes from `own` on, and after the
        // last one it no longer changes.
        let one = read("50: 20");
        let found = [0.0, 25.0, 80.0].map(|share| one.at(share, 60.0));
        assert_eq!(found, [60.0, 40.0, 20.0]);
    }

    #[test]
    fn steps_are_read_written_and_refused() {
        let written =
            |text: &str, of| Steps::read(text, of).map(|s| s.to_toml());
        let same = "\"10: 100%, 12.5: 40, 100: 0.5\"";
        let given = " 10%:100% , 12.5: 40,100 :.5";
        assert_eq!(written(given, Of::Speed), Ok(same.into()));
        // A fan's values are percentages themselves, so they cannot be shares
        // of another value.
        assert_eq!(written("5: 80%", Of::Fan), Ok("\"5: 80\"".into()));
        for bad in [
            "25",
            "25:",
            ":30",
            "25: 30,",
            "50: 30, 25: 20",
            "25: 3, 25: 2",
            "-1: 30",
            "0: 30",
            "0%: 30, 50: 20",
            "101: 30",
            "nan: 3",
            "a: b",
            "25: 30 40",
            "on",
            "off",
            "",
            " ",
        ] {
            assert_eq!(written(bad, Of::Speed), Err(Refused::Type), "{bad}");
        }
        for bad in ["25: 0", "25: 3000", "25: 101%", "25: 0%", "25: inf"] {
            assert_eq!(written(bad, Of::Speed), Err(Refused::Range), "{bad}");
        }
        let many: Vec<String> = (1..=21).map(|i| format!("{i}: 9")).collect();
        assert_eq!(written(&many.join(","), Of::Speed), Err(Refused::Type));
        assert!(written(&many[..20].join(","), Of::Speed).is_ok());
    }
}

//! Reads samples from text: a sample a line, columns between commas,
//! semicolons, tabs or spaces.

use super::{Read, SamplesOptions};
use glam::DVec3;
use isoslice_base::problem::{Problem, go_on};

/// The most samples of a file.
const MOST: usize = 10_000_000;

/// Which columns count.
struct Columns {
    x: usize,
    y: usize,
    /// None if all samples are in the plane.
    z: Option<usize>,
    value: usize,
}

/// What is between the columns of a file.
#[derive(Clone, Copy, PartialEq)]
enum Between {
    Comma,
    Semicolon,
    Tab,
    Spaces,
}

impl Between {
    fn of(line: &str) -> Between {
        if line.contains(';') {
            Between::Semicolon
        } else if line.contains('\t') {
            Between::Tab
        } else if line.contains(',') {
            Between::Comma
        } else {
            Between::Spaces
        }
    }

    fn fields(self, line: &str) -> Vec<&str> {
        let all: Vec<&str> = match self {
            Between::Comma => line.split(',').collect(),
            Between::Semicolon => line.split(';').collect(),
            Between::Tab => line.split('\t').collect(),
            Between::Spaces => line.split_whitespace().collect(),
        };
        all.into_iter()
            .map(|f| f.trim().trim_matches('"').trim())
            .collect()
    }

    /// A number. Between semicolons and tabs, a comma may stand for the point.
    fn number(self, text: &str) -> Option<f64> {
        if let Ok(number) = text.parse() {
            return Some(number);
        }
        let decimal = matches!(self, Between::Semicolon | Between::Tab);
        let comma = decimal && text.matches(',').count() == 1;
        comma.then(|| text.replace(',', ".").parse().ok()).flatten()
    }
}

pub(super) fn read(text: &str, options: &SamplesOptions) -> Problem<Read> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.trim()))
        .filter(|(_, l)| !l.is_empty() && !l.starts_with(['#', '%']))
        .peekable();
    let Some((_, first)) = lines.peek().copied() else {
        return Err("it has no samples; each is a line: x, y, z, value".into());
    };
    let between = Between::of(first);
    let names = between.fields(first);
    let number = |f: &&str| f.is_empty() || between.number(f).is_some();
    let numbers = names.iter().all(number);
    let columns = if numbers {
        unnamed(names.len(), options)?
    } else {
        lines.next();
        named(&names, options)?
    };
    let mut read = Read {
        points: Vec::new(),
        values: Vec::new(),
        flat: columns.z.is_none(),
    };
    for (number, line) in lines {
        go_on()?;
        let fields = between.fields(line);
        let get = |column: usize| {
            let text = fields.get(column).copied().unwrap_or("");
            (text, between.number(text))
        };
        let need = |column: usize| match get(column) {
            (_, Some(v)) if v.is_finite() => Ok(v),
            (text, _) => Err(format!(
                "line {number}: column {} is {text:?}, and a number has to \
                 stand there",
                column + 1
            )),
        };
        let z = columns.z.map_or(Ok(0.0), need)?;
        let point = DVec3::new(need(columns.x)?, need(columns.y)?, z);
        match get(columns.value) {
            // Places without a value.
            ("", _) => continue,
            (_, Some(v)) if !v.is_finite() => continue,
            _ => {}
        }
        read.points.push(point);
        read.values.push(need(columns.value)?);
        if read.points.len() > MOST {
            return Err(format!(
                "it has more than {MOST} samples; leave some out"
            ));
        }
    }
    Ok(read)
}

/// The columns of a file whose first line is a sample.
fn unnamed(count: usize, options: &SamplesOptions) -> Problem<Columns> {
    if let Some(name) = &options.column {
        return Err(format!(
            "its columns have no names, so there is no {name:?}; write names \
             into the first line"
        ));
    }
    let z = match count {
        3 => None,
        4 => Some(2),
        _ => {
            return Err(format!(
                "it has {count} columns; write x, y, z, value, or names into \
                 the first line"
            ));
        }
    };
    Ok(Columns {
        x: 0,
        y: 1,
        z,
        value: count - 1,
    })
}

/// The columns by their names in the first line.
fn named(names: &[&str], options: &SamplesOptions) -> Problem<Columns> {
    let lower: Vec<String> = names.iter().map(|n| n.to_lowercase()).collect();
    let axis = |axis: usize| {
        let letter = ["x", "y", "z"][axis];
        lower.iter().position(|name| {
            let after = name.strip_prefix(letter);
            let alone = after.is_some_and(|rest| {
                !rest.starts_with(|c: char| c.is_alphanumeric())
            });
            // ParaView's names.
            alone
                || *name == format!("points:{axis}")
                || *name == format!("points_{axis}")
        })
    };
    let all = names.join(", ");
    let need = |a: usize| {
        axis(a).ok_or_else(|| {
            format!(
                "the first line has no {}: its columns are {all}; name them x, \
                 y, z and as you like",
                ["x", "y", "z"][a]
            )
        })
    };
    let (x, y, z) = (need(0)?, need(1)?, axis(2));
    let value = if let Some(wanted) = &options.column {
        let wanted = wanted.to_lowercase();
        let exact = lower.iter().position(|name| *name == wanted);
        let begins = || lower.iter().position(|n| n.starts_with(&wanted));
        exact.or_else(begins).ok_or_else(|| {
            format!("there is no column {wanted:?}: there are {all}")
        })?
    } else {
        let number = |name: &str| {
            ["node", "id", "index", "point", "cell", "number", "nr"]
                .iter()
                .any(|n| name.starts_with(n))
        };
        let others: Vec<usize> = (0..names.len())
            .filter(|i| ![Some(x), Some(y), z].contains(&Some(*i)))
            .filter(|i| names.len() == 4 || !number(&lower[*i]))
            .collect();
        match others[..] {
            [one] => one,
            [] => return Err(format!("it has no values: only {all}")),
            _ => {
                return Err(format!(
                    "which of its columns is meant? Name it with `column`: \
                     {all}"
                ));
            }
        }
    };
    Ok(Columns { x, y, z, value })
}

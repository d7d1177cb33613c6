//! The pairs of lines that a DXF file is made of: a group code, which says what
//! follows, and a value. A record is a pair of code 0, its kind, and all pairs up to
//! the next.

use glam::DVec2;
use isoslice_base::problem::Problem;
use isoslice_base::units::human_start;

/// The code at which a record begins.
const KIND: i32 = 0;
/// The code of remarks.
const REMARK: i32 = 999;
/// The most characters of a name of a layer or a block, as of CAD programs.
const MOST_NAME: usize = 255;

#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<'a> {
    pub(super) code: i32,
    pub(super) value: &'a str,
    /// The number of the value's line in the file.
    pub(super) line: usize,
}

impl<'a> Pair<'a> {
    pub(super) fn number(&self) -> Problem<f64> {
        let number = self.value.parse::<f64>().ok();
        number.filter(|v| v.is_finite()).ok_or_else(|| {
            format!("line {}: {} is no number", self.line, shown(self.value))
        })
    }

    /// A name, which is no longer than names are.
    pub(super) fn name(&self) -> Problem<&'a str> {
        if self.value.chars().nth(MOST_NAME).is_some() {
            return Err(format!(
                "line {}: the name {} has more than {MOST_NAME} characters; \
                 give it a shorter one",
                self.line,
                shown(self.value)
            ));
        }
        Ok(self.value)
    }

    pub(super) fn integer(&self) -> Problem<i64> {
        self.value.parse().map_err(|_| {
            let (line, value) = (self.line, shown(self.value));
            format!("line {line}: {value} is no whole number")
        })
    }
}

/// A text of a file in quotes, as much of it as people read.
pub(super) fn shown(text: &str) -> String {
    const MOST: usize = 40;
    format!("`{}`", human_start(text, MOST))
}

/// The pairs from some place in a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pairs<'a> {
    rest: &'a str,
    /// How many lines were read.
    line: usize,
}

impl<'a> Pairs<'a> {
    pub(super) fn new(text: &'a str) -> Pairs<'a> {
        Pairs {
            rest: text,
            line: 0,
        }
    }

    fn line(&mut self) -> Option<&'a str> {
        if self.rest.is_empty() {
            return None;
        }
        // Lines are so short that this is faster than what finds ends far away.
        let end = self.rest.bytes().position(|b| b == b'\n');
        let end = end.unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = self.rest.get(end + 1..).unwrap_or_default();
        self.line += 1;
        Some(line.trim())
    }

    /// The next pair that is no remark. None at the end.
    pub(super) fn pair(&mut self) -> Problem<Option<Pair<'a>>> {
        while let Some(code) = self.line() {
            if code.is_empty() && self.rest.trim().is_empty() {
                break;
            }
            let line = self.line;
            let code: i32 = code.parse().map_err(|_| {
                format!(
                    "line {line}: {} is no group code, with which each pair of \
                     lines of a DXF begins; save it as DXF in text (ASCII)",
                    shown(code)
                )
            })?;
            let value = self.line().ok_or_else(|| {
                format!("line {line}: it is cut off; copy or save it again")
            })?;
            if code != REMARK {
                let line = self.line;
                return Ok(Some(Pair { code, value, line }));
            }
        }
        Ok(None)
    }

    /// The next record.
    pub(super) fn record(&mut self) -> Problem<Option<Record<'a>>> {
        while let Some(pair) = self.pair()? {
            if pair.code == KIND {
                let pairs = *self;
                return Ok(Some(Record {
                    kind: pair.value,
                    line: pair.line,
                    pairs,
                    length: self.pass(),
                }));
            }
        }
        Ok(None)
    }

    /// Passes the pairs up to the next record, or to a mistake, which is then found
    /// when that record is read. Gives their number.
    fn pass(&mut self) -> usize {
        let mut count = 0;
        loop {
            let before = *self;
            match self.pair() {
                Ok(Some(pair)) if pair.code != KIND => count += 1,
                _ => {
                    *self = before;
                    return count;
                }
            }
        }
    }
}

/// A record, such as a line or a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record<'a> {
    pub(super) kind: &'a str,
    /// The number of its first line in the file.
    pub(super) line: usize,
    pairs: Pairs<'a>,
    /// How many pairs it has, which each look at it may pass.
    pub(super) length: usize,
}

impl<'a> Record<'a> {
    /// Its pairs. A mistake in one of them was found when the record after it was
    /// looked for.
    pub(super) fn pairs(&self) -> impl Iterator<Item = Pair<'a>> {
        let mut pairs = self.pairs;
        std::iter::from_fn(move || pairs.pair().ok().flatten())
            .take_while(|pair| pair.code != KIND)
    }

    fn find(&self, code: i32) -> Option<Pair<'a>> {
        self.pairs().find(|pair| pair.code == code)
    }

    /// The text of a code; nothing if there is none.
    pub(super) fn text(&self, code: i32) -> &'a str {
        self.find(code).map_or("", |pair| pair.value)
    }

    /// The name of a layer or a block; nothing if there is none.
    pub(super) fn name(&self, code: i32) -> Problem<&'a str> {
        self.find(code).map_or(Ok(""), |pair| pair.name())
    }

    pub(super) fn number(&self, code: i32) -> Problem<Option<f64>> {
        self.find(code).map(|pair| pair.number()).transpose()
    }

    /// The number of a code that has to be there.
    pub(super) fn needed(&self, code: i32) -> Problem<f64> {
        self.number(code)?.ok_or_else(|| {
            let (line, kind) = (self.line, shown(self.kind));
            format!("line {line}: {kind} has no value of group code {code}")
        })
    }

    pub(super) fn integer(&self, code: i32) -> Problem<Option<i64>> {
        self.find(code).map(|pair| pair.integer()).transpose()
    }

    /// Bits of group code 70.
    pub(super) fn has_flag(&self, flag: i64) -> Problem<bool> {
        Ok(self.integer(70)?.unwrap_or(0) & flag != 0)
    }

    /// The point whose x has a code, and whose y has that code plus 10.
    pub(super) fn point(&self, code: i32) -> Problem<DVec2> {
        let y = self.number(code + 10)?.unwrap_or(0.0);
        Ok(DVec2::new(self.needed(code)?, y))
    }
}

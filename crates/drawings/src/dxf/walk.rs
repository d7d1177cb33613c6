//! Goes through the entities of a file, those of inserted blocks too, and collects
//! the lines that are drawn.

use super::file::{Block, File, folded};
use super::pairs::{Record, shown};
use super::pen::too_many;
use super::shape::{Shape, is_wide, shape, space};
use crate::area::MOST_CURVES;
use crate::curve::Curve;
use crate::drawing::MOST_DRAWING_BYTES;
use glam::{DAffine2, DMat2, DVec2};
use isoslice_base::problem::{Problem, go_on};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// The most blocks in one another.
const DEEPEST: usize = 32;

/// The most entities that are drawn, those of blocks as often as they are inserted.
const MOST_ENTITIES: usize = 200_000;

/// The most pairs of lines of the file that entities have, those of blocks as often
/// as they are inserted: as many as a file may have, at 4 bytes each. To look at so
/// many for all codes takes some 2 seconds.
const MOST_PAIRS: usize = MOST_DRAWING_BYTES / 4;

/// The most rows and columns of an inserted block, which is what files can say.
const MOST_TIMES: i64 = 32_767;

/// The most things that are named that are not drawn.
const MOST_NAMED: usize = 20;

/// What of wide polylines is not drawn.
const WIDTH: &str = "the width of polylines, of which the middle lines count";

/// Greatest coordinate, mm. Beyond it the drawing is refused anyway.
const FARTHEST: f64 = 1e6;

/// A line of curves that follow one another; there is at least one.
pub(super) struct Line {
    pub(super) curves: Vec<Curve>,
    /// True if it is a ring.
    pub(super) is_closed: bool,
    /// The number of its first line in the file.
    pub(super) line: usize,
}

impl Line {
    /// Where it begins and ends.
    pub(super) fn ends(&self) -> impl Iterator<Item = DVec2> {
        let start = self.curves.first().map(Curve::start);
        let end = self.curves.last().map(Curve::end);
        start.into_iter().chain(end)
    }
}

/// Where entities are drawn.
#[derive(Clone, Copy)]
struct Place<'p> {
    to_mm: DAffine2,
    /// The folded name of the layer of what is on layer 0.
    layer: &'p str,
    depth: usize,
}

pub(super) struct Walk<'a, 'f> {
    file: &'f File<'a>,
    /// The folded names of the layers to draw, if not all.
    layers: Option<BTreeSet<String>>,
    pub(super) lines: Vec<Line>,
    /// How many curves they have.
    curves: usize,
    entities: usize,
    /// How many pairs of lines these have.
    pairs: usize,
    /// What is not drawn, and how often.
    pub(super) left_out: BTreeMap<String, usize>,
}

impl<'a, 'f> Walk<'a, 'f> {
    pub(super) fn new(
        file: &'f File<'a>,
        layers: Option<BTreeSet<String>>,
    ) -> Walk<'a, 'f> {
        Walk {
            file,
            layers,
            lines: Vec::new(),
            curves: 0,
            entities: 0,
            pairs: 0,
            left_out: BTreeMap::new(),
        }
    }

    /// Draws the whole file, of whose units one has so many mm.
    pub(super) fn all(&mut self, unit: f64) -> Problem<()> {
        let place = Place {
            to_mm: DAffine2::from_scale(DVec2::splat(unit)),
            layer: "0",
            depth: 0,
        };
        self.records(&self.file.entities, place)
    }

    fn leave_out(&mut self, what: String) {
        let is_named = self.left_out.contains_key(&what);
        let what = if is_named || self.left_out.len() < MOST_NAMED {
            what
        } else {
            "other things".into()
        };
        *self.left_out.entry(what).or_default() += 1;
    }

    /// Counts an entity, or a block that may have none, and its pairs.
    fn count(&mut self, pairs: usize) -> Problem<()> {
        go_on()?;
        self.pairs += pairs;
        if self.pairs > MOST_PAIRS {
            return Err(format!(
                "what is drawn is more than {MOST_PAIRS} pairs of lines of the \
                 file, those of blocks as often as they are inserted; simplify \
                 the drawing"
            ));
        }
        self.entities += 1;
        if self.entities > MOST_ENTITIES {
            return Err(format!(
                "more than {MOST_ENTITIES} entities are drawn, those of blocks \
                 as often as they are inserted; simplify the drawing"
            ));
        }
        Ok(())
    }

    fn records(
        &mut self,
        records: &'f [Record<'a>],
        place: Place<'_>,
    ) -> Problem<()> {
        let mut rest = records;
        while let Some((record, after)) = rest.split_first() {
            let is_point = |record: &&Record| record.kind == "VERTEX";
            let count = after.iter().take_while(is_point).count();
            let (points, after) = after.split_at(count);
            rest = after;
            let with_points = std::iter::once(record).chain(points);
            self.count(with_points.map(|r| r.length + 1).sum())?;
            let looks = Looks::of(record)?;
            let layer = looks.layer(place);
            if self.is_seen(record, &looks, &layer) {
                self.record(
                    record,
                    points,
                    Place {
                        layer: &layer,
                        ..place
                    },
                )?;
            }
        }
        Ok(())
    }

    /// Whether an entity on a layer is to be drawn.
    fn is_seen(
        &mut self,
        record: &Record<'a>,
        looks: &Looks<'a>,
        layer: &str,
    ) -> bool {
        // Sheets for paper show the drawing again.
        if looks.on_paper == Some(1) {
            self.leave_out("what is on paper only".into());
            return false;
        }
        if looks.hidden == Some(1) {
            self.leave_out("what is hidden".into());
            return false;
        }
        let is_insert = record.kind == "INSERT";
        if let Some(layers) = &self.layers {
            // What is in a block has layers of its own.
            return is_insert || layers.contains(layer);
        }
        let known = self.file.layers.get(layer).copied().unwrap_or_default();
        let hidden = known.is_frozen || known.is_off && !is_insert;
        if hidden {
            self.leave_out("what is on layers that are off".into());
        }
        !hidden
    }

    fn record(
        &mut self,
        record: &Record<'a>,
        points: &[Record<'a>],
        place: Place<'_>,
    ) -> Problem<()> {
        let left = MOST_CURVES.saturating_sub(self.curves);
        match record.kind {
            "INSERT" => self.insert(record, place),
            // The end of a polyline, and texts that a block asks for.
            "SEQEND" | "ATTDEF" | "VIEWPORT" => Ok(()),
            _ => match shape(record, points, left)? {
                Some(shape) => {
                    if is_wide(record, points)? {
                        self.leave_out(WIDTH.into());
                    }
                    self.draw(record, shape, place)
                }
                None => {
                    self.leave_out(shown(record.kind));
                    Ok(())
                }
            },
        }
    }

    fn draw(
        &mut self,
        record: &Record<'a>,
        shape: Shape,
        place: Place<'_>,
    ) -> Problem<()> {
        let curves = shape.line.mapped(place.to_mm).into_curves();
        if !curves.iter().all(|curve| curve.is_within(FARTHEST)) {
            return Err(format!(
                "line {}: {} has a coordinate beyond 1 km; is the unit right? \
                 Say how many mm it has with unit",
                record.line, record.kind
            ));
        }
        self.curves += curves.len();
        if self.curves > MOST_CURVES {
            return too_many();
        }
        if !curves.is_empty() {
            self.lines.push(Line {
                curves,
                is_closed: shape.is_closed,
                line: record.line,
            });
        }
        Ok(())
    }

    fn insert(&mut self, record: &Record<'a>, place: Place<'_>) -> Problem<()> {
        let name = record.name(2)?;
        let Some(block) = self.file.blocks.get(&folded(name)) else {
            self.leave_out(format!(
                "block {}, which there is not",
                shown(name)
            ));
            return Ok(());
        };
        if place.depth == DEEPEST {
            return Err(format!(
                "line {}: blocks are in one another more than {DEEPEST} deep; \
                 does block {} hold itself?",
                record.line,
                shown(name)
            ));
        }
        let number = |code: i32, usual: f64| {
            record.number(code).map(|v| v.unwrap_or(usual))
        };
        let scale = DVec2::new(number(41, 1.0)?, number(42, 1.0)?);
        let angle = number(50, 0.0)?.rem_euclid(360.0).to_radians();
        let x = DVec2::new(libm::cos(angle), libm::sin(angle));
        let own = DAffine2 {
            matrix2: DMat2::from_cols(x, x.perp()),
            translation: record.point(10)?,
        };
        let to_mm = place.to_mm * space(record)? * own;
        let step = DVec2::new(number(44, 0.0)?, number(45, 0.0)?);
        for [column, row] in places(record)? {
            self.count(1)?;
            let by = DVec2::new(column as f64, row as f64) * step;
            let Block { base, records } = block;
            let inner = DAffine2::from_translation(by)
                * DAffine2::from_scale(scale)
                * DAffine2::from_translation(-*base);
            let inner = Place {
                to_mm: to_mm * inner,
                layer: place.layer,
                depth: place.depth + 1,
            };
            self.records(records, inner)?;
        }
        Ok(())
    }
}

/// What decides whether an entity is drawn, by the first pair of each code.
#[derive(Default)]
struct Looks<'a> {
    layer: Option<&'a str>,
    hidden: Option<i64>,
    on_paper: Option<i64>,
}

impl<'a> Looks<'a> {
    fn of(record: &Record<'a>) -> Problem<Looks<'a>> {
        let mut looks = Looks::default();
        for pair in record.pairs() {
            match pair.code {
                8 if looks.layer.is_none() => looks.layer = Some(pair.name()?),
                60 if looks.hidden.is_none() => {
                    looks.hidden = Some(pair.integer()?);
                }
                67 if looks.on_paper.is_none() => {
                    looks.on_paper = Some(pair.integer()?);
                }
                _ => {}
            }
        }
        Ok(looks)
    }

    /// The folded name of the entity's layer.
    fn layer<'p>(&self, place: Place<'p>) -> Cow<'p, str> {
        match self.layer {
            None | Some("" | "0") => Cow::Borrowed(place.layer),
            Some(own) => Cow::Owned(folded(own)),
        }
    }
}

/// The columns and rows at which a block is inserted.
fn places(record: &Record<'_>) -> Problem<impl Iterator<Item = [i64; 2]>> {
    let times = |code: i32| {
        let times = record.integer(code)?.unwrap_or(1).max(1);
        if times > MOST_TIMES {
            return Err(format!(
                "line {}: a block is inserted {times} times in a row; \
                 {MOST_TIMES} are the most",
                record.line
            ));
        }
        Ok(times)
    };
    let (columns, rows) = (times(70)?, times(71)?);
    Ok((0..rows).flat_map(move |row| (0..columns).map(move |c| [c, row])))
}

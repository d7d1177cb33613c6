//! Joins lines at their ends to rings.
//!
//! What is filled is what an odd number of rings go round. So it makes no
//! difference which of several lines goes on where more than two end at a place,
//! as long as their number is even.

use super::cells::{Cell, around, cell};
use super::same::each_once;
use super::walk::Line;
use crate::curve::Curve;
use crate::outline::{Fill, Outline};
use glam::DVec2;
use isoslice_base::problem::{Problem, go_on};
use isoslice_base::units::human_number;
use std::collections::{HashMap, HashSet};

/// How far apart ends are taken as one place and moved there, mm: a hundredth of a
/// micrometre, which is what rounding does to files of 9 digits and less than the
/// error of arcs of 150 mm.
const SAME: f64 = 1e-5;

/// The most pairs of ends that are looked at to close gaps.
const MOST_PAIRS: usize = 1_000_000;

/// Rings of lines, filled by the even-odd rule, and warnings of lines and rings that
/// are left out since they are drawn twice. Ends that are up to `gap` apart, mm, are
/// joined by a straight line.
///
/// # Errors
/// If a line ends where no other goes on.
pub(super) fn rings(
    mut lines: Vec<Line>,
    gap: f64,
) -> Problem<(Outline, Vec<String>)> {
    let before = lines.len();
    let mut seen = HashSet::new();
    lines.retain(|line| seen.insert(points(line)));
    let twice = before - lines.len();
    let (closed, open): (Vec<Line>, Vec<Line>) =
        lines.into_iter().partition(|line| line.is_closed);
    let closed = closed.iter().map(|line| ring(line.curves.iter().copied()));
    let mut rings: Vec<Outline> = closed.collect();
    let mut ends = Ends::new(&open)?;
    ends.bridge(gap)?;
    ends.all_go_on(&open)?;
    ends.trails(&open, |trail| {
        rings.push(ring(trail.iter().flat_map(|end| from(&open, *end))));
    })?;
    let (rings, rings_twice) = each_once(rings)?;
    let mut outline = Outline::new(Fill::EvenOdd);
    rings.iter().for_each(|ring| outline.append(ring));
    let warnings = [left_out(twice, "line"), left_out(rings_twice, "outline")];
    Ok((outline, warnings.into_iter().flatten().collect()))
}

/// What is said of lines that are drawn more than once, however often.
fn left_out(count: usize, what: &str) -> Option<String> {
    match count {
        0 => None,
        1 => Some(format!(
            "1 {what} is drawn again where one is, and left out"
        )),
        _ => Some(format!(
            "{count} {what}s are drawn again where one is, and left out"
        )),
    }
}

/// The curves of a line from one of its ends to the other.
fn from(lines: &[Line], end: usize) -> Vec<Curve> {
    let curves = &lines[end / 2].curves;
    if end.is_multiple_of(2) {
        curves.clone()
    } else {
        curves.iter().rev().map(Curve::reversed).collect()
    }
}

fn ring(curves: impl Iterator<Item = Curve>) -> Outline {
    let mut outline = Outline::new(Fill::EvenOdd);
    for (i, curve) in curves.enumerate() {
        if i == 0 {
            outline.move_to(curve.start());
        }
        outline.along(&curve, SAME);
    }
    outline.close_within(SAME);
    outline
}

/// All control points of a line, from the same end whichever way it is drawn.
fn points(line: &Line) -> Vec<[u64; 2]> {
    // Adding 0 makes no difference but for -0.
    let bits = |p: &DVec2| (*p + 0.0).to_array().map(f64::to_bits);
    let all = line.curves.iter().flat_map(Curve::control);
    let forth: Vec<[u64; 2]> = all.map(bits).collect();
    let back = forth.iter().rev().copied().collect();
    forth.min(back)
}

/// The places where lines end. Of line i, the ends are 2 i and 2 i + 1.
struct Ends {
    places: Vec<DVec2>,
    /// The ends at each place.
    at: Vec<Vec<usize>>,
    /// The place of each end.
    of: Vec<usize>,
}

impl Ends {
    fn new(lines: &[Line]) -> Problem<Ends> {
        let mut ends = Ends {
            places: Vec::new(),
            at: Vec::new(),
            of: Vec::new(),
        };
        let mut grid: HashMap<Cell, Vec<usize>> = HashMap::new();
        for (end, p) in lines.iter().flat_map(Line::ends).enumerate() {
            go_on()?;
            let own = cell(p, SAME);
            let near = around(own).filter_map(|c| grid.get(&c)).flatten();
            let near = near.copied().map(|i| (ends.places[i].distance(p), i));
            let nearest = near
                .filter(|(far, _)| *far <= SAME)
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let place = nearest.map_or(ends.places.len(), |(_, i)| i);
            if place == ends.places.len() {
                ends.places.push(p);
                ends.at.push(Vec::new());
                grid.entry(own).or_default().push(place);
            }
            ends.at[place].push(end);
            ends.of.push(place);
        }
        Ok(ends)
    }

    /// The places where an odd number of lines end.
    fn odd(&self) -> impl Iterator<Item = usize> {
        (0..self.places.len()).filter(|i| self.at[*i].len() % 2 == 1)
    }

    /// Makes one of each two odd places that are near each other, the nearest first.
    fn bridge(&mut self, gap: f64) -> Problem<()> {
        // Ends that are as near are at one place already.
        if gap <= SAME {
            return Ok(());
        }
        let mut grid: HashMap<Cell, Vec<usize>> = HashMap::new();
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for place in self.odd() {
            go_on()?;
            let p = self.places[place];
            let own = cell(p, gap);
            for other in around(own).filter_map(|c| grid.get(&c)).flatten() {
                let far = self.places[*other].distance(p);
                if far <= gap {
                    pairs.push((far, *other, place));
                }
                if pairs.len() > MOST_PAIRS {
                    return Err(format!(
                        "too many lines end within {} mm of one another; give \
                         a smaller gap",
                        human_number(gap)
                    ));
                }
            }
            grid.entry(own).or_default().push(place);
        }
        pairs.sort_by(|a, b| {
            a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2)))
        });
        for (_, a, b) in pairs {
            if self.at[a].len() % 2 == 1 && self.at[b].len() % 2 == 1 {
                let ends = std::mem::take(&mut self.at[b]);
                ends.iter().for_each(|end| self.of[*end] = a);
                self.at[a].extend(ends);
            }
        }
        Ok(())
    }

    /// Checks that an even number of lines end wherever one ends.
    fn all_go_on(&self, lines: &[Line]) -> Problem<()> {
        let Some(place) = self.odd().next() else {
            return Ok(());
        };
        let p = self.places[place];
        let [x, y] = p.to_array().map(human_number);
        let line = self.at[place].first().map_or(0, |e| lines[e / 2].line);
        let wrong = match self.at[place].len() {
            1 => format!("an outline ends at x = {x}, y = {y} mm"),
            n => format!("{n} lines meet at x = {x}, y = {y} mm"),
        };
        let others = self.odd().filter(|other| *other != place);
        let far = others.map(|other| self.places[other].distance(p));
        let nearest = far.fold(f64::INFINITY, f64::min);
        let next = if nearest.is_finite() {
            let far = human_number(nearest);
            format!(", and {far} mm from there another ends")
        } else {
            String::new()
        };
        let more = match self.odd().count() {
            0..=2 => String::new(),
            n => format!(" ({n} such places in all)"),
        };
        Err(format!(
            "{wrong} (line {line} of the file){next}{more}; close the outline, \
             allow a wider gap with gap, or choose layers with layers"
        ))
    }

    /// Goes along all lines, from end to end, until a trail comes back to where it
    /// began. Each is given by the ends at which its lines are entered.
    fn trails(
        mut self,
        lines: &[Line],
        mut f: impl FnMut(&[usize]),
    ) -> Problem<()> {
        let mut used = vec![false; lines.len()];
        for first in 0..lines.len() {
            go_on()?;
            if used[first] {
                continue;
            }
            let mut trail = Vec::new();
            let mut next = Some(2 * first);
            while let Some(end) = next {
                used[end / 2] = true;
                trail.push(end);
                let here = &mut self.at[self.of[end ^ 1]];
                next = None;
                while let Some(end) = here.pop() {
                    if !used[end / 2] {
                        next = Some(end);
                        break;
                    }
                }
            }
            f(&trail);
        }
        Ok(())
    }
}

//! Follows the outline between the two vertices of a cell, where the straight
//! line between them is not within tolerance of it.
//!
//! ```text
//!        │          Gradients u, v at the ends say how far the outline may
//!   p ───┼─╳ c      stand off the chord p q. If that is too far, the outline
//!    \m  │ │        may turn at a corner c, where the tangents meet and the
//!      \─r q        field is zero. Otherwise the outline is looked for along
//!                   the chord's normal from its middle m, found at r, and p r
//!                   and r q become chords.
//! ```
//!
//! The corners are after Kobbelt et al., Feature sensitive surface extraction
//! from volume data (2001), in two dimensions. The search is between an inside
//! and an outside point, so it needs no gradient. Where the field jumps no
//! gradient is used: the pieces across a corner are then halved until they are
//! shorter than the tolerance.
//!
//! Everything found lies in the chord's own cell, or as far beyond it as its
//! caller allows. Only a corner may always lie in a cell beside it, if no
//! outline passes through that cell. All chords of a batch are followed
//! together, a round of bulk evaluations at a time.
//!
//! Not guaranteed: that the outline has no bends between points at which chord
//! and gradients agree.

use super::link::Crossing;
use super::refine::{Bracket, End, refine};
use super::samples::Eyes;
use crate::Length;
use crate::field::FieldError;
use crate::plane::Rect;
use glam::DVec2;

/// A vertex of the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub end: End,
    /// The number of the lattice edge on which the vertex lies, if it lies on
    /// one.
    pub crossing: Crossing,
}

/// Cosine of the least angle between the gradients at a corner, 15°.
const COS_TURN: f64 = 0.966;
/// Greatest distance of a corner from the zero set, as a share of the corner's
/// distance from the chord that it replaces.
const RESIDUE: f64 = 0.1;
/// Length below which chords are not looked at, as a share of the tolerance.
const SHORT: f64 = 0.3;
/// Greatest distance of an arc from the zero set in its middle and in its
/// quarters, as a share of the tolerance.
const ARC: f64 = 0.25;
/// Halvings of a chord: from 2 mm to below a micrometre.
const DEPTH: u8 = 12;

/// A piece of outline across a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub from: End,
    pub to: End,
    /// The cell.
    pub cell: Rect,
    /// How far beyond the cell the outline may be followed, in cells.
    pub beyond: f64,
    /// Height.
    pub z: f32,
}

/// The outcome for a chord.
#[derive(Clone, Debug, Default)]
pub(super) struct Traced {
    /// Points between the chord's ends, with their place along the chord from 0
    /// to 1.
    pub points: Vec<(f64, DVec2)>,
    /// True if the outline could not be followed within the cell.
    pub lost: bool,
    /// Columns and rows to the cell in which the chord's corner lies, if that
    /// is not its own cell.
    pub beside: Option<[i32; 2]>,
}

/// Part of a chord that has not been settled.
struct Open {
    chord: usize,
    a: End,
    b: End,
    /// Places of the ends along the chord.
    span: [f64; 2],
    depth: u8,
}

impl Open {
    /// The place of its middle along the chord.
    fn place(&self) -> f64 {
        0.5 * (self.span[0] + self.span[1])
    }
}

/// A part of a chord about which the field is asked.
struct Asked {
    o: Open,
    question: Question,
    /// Number of points along the part at which the field is asked, one of them
    /// in the middle.
    count: usize,
}

/// What the gradients at a chord's ends say about it.
pub(super) enum Look {
    /// The outline follows the chord.
    Straight,
    /// The outline bends a little, and passes through this point.
    Bent(DVec2),
    /// The field must be asked.
    Ask(Question),
}

/// The questions about a chord that the field has to answer.
#[derive(Clone, Copy)]
pub(super) struct Question {
    /// How far off the chord the outline may be.
    reach: Length,
    /// The chord is straight after all if the field in its middle is no greater
    /// than this.
    flat: f64,
    /// Points of the outline if it is an arc. It is an arc if the field at
    /// these points is no greater than the given number.
    arc: Option<([DVec2; 3], f64)>,
}

/// True if, by the gradients at its ends, a chord is within the tolerance and
/// has no corner.
fn fits(p: End, q: End, tolerance: Length) -> bool {
    let chord = q.point - p.point;
    let bound = 16.0 * tolerance * tolerance;
    // Outwards is to the right of the chord. A NaN does not fit.
    let fits = |g: DVec2| {
        let along = g.dot(chord);
        g.perp_dot(chord) > 0.0 && along * along <= bound * g.length_squared()
    };
    let (u, v) = (p.gradient, q.gradient);
    let turn = u.dot(v);
    fits(u)
        && fits(v)
        && turn > 0.0
        && turn * turn
            >= COS_TURN * COS_TURN * u.length_squared() * v.length_squared()
}

/// What the gradients at a chord's ends say about it. They are believed if the
/// chord is no longer than `trusted`.
pub(super) fn look(p: End, q: End, tolerance: Length, trusted: Length) -> Look {
    let chord = q.point - p.point;
    let fits = fits(p, q, tolerance);
    if fits && chord.length_squared() <= trusted * trusted {
        return Look::Straight;
    }
    let length = chord.length();
    if length <= SHORT * tolerance {
        return Look::Straight;
    }
    let least = 0.4 * tolerance;
    let ask = |reach, flat, arc| Look::Ask(Question { reach, flat, arc });
    let unknown = ask(least, 0.0, None);
    let (Some(u), Some(v)) =
        (p.gradient.try_normalize(), q.gradient.try_normalize())
    else {
        return unknown;
    };
    if fits {
        let slope = p.gradient.length().min(q.gradient.length());
        return ask(least, tolerance * slope, None);
    }
    let out = -chord.perp() / length;
    if u.dot(out) <= 0.0 || v.dot(out) <= 0.0 {
        return unknown;
    }
    let (s, t) = (u.dot(chord), v.dot(chord));
    let bound = 0.25 * s.abs().max(t.abs());
    let reach = (1.25 * bound).max(least);
    if u.dot(v) <= COS_TURN || length > trusted {
        return ask(reach, 0.0, None);
    }
    // How far the cubic with the directions at both ends stands off the chord
    // in its middle and in its quarters.
    let on = |along: f64, near: f64, far: f64| {
        p.point + chord * along + out * (far * t - near * s)
    };
    let middle = on(0.5, 0.125, 0.125);
    // An arc of equal angles at both ends.
    if bound <= 2.0 * tolerance {
        return Look::Bent(middle);
    }
    // The outline may be any other kind of curve. The halves of an arc stand
    // off a quarter as far.
    let even = (s + t).abs() <= 0.25 * (t - s).abs();
    let arc = (even && bound <= 3.0 * tolerance).then(|| {
        let slope = p.gradient.length().min(q.gradient.length());
        let first = on(0.25, 9.0 / 64.0, 3.0 / 64.0);
        let third = on(0.75, 3.0 / 64.0, 9.0 / 64.0);
        ([first, middle, third], ARC * tolerance * slope)
    });
    ask(reach, 0.0, arc)
}

/// Number of chords that are followed together. One chord may become thousands
/// of pieces, each of which needs a hundred times the memory of a point.
const AT_ONCE: usize = 256;

/// Follows the outline beside chords to within `tolerance`. Along chords that are
/// no longer than `trusted`, the gradients at the ends may tell its course.
pub(super) fn trace(
    chords: &[Chord],
    tolerance: Length,
    trusted: Length,
    eyes: &mut Eyes<'_>,
) -> Result<Vec<Traced>, FieldError> {
    let mut traced = Vec::with_capacity(chords.len());
    for chords in chords.chunks(AT_ONCE) {
        traced.extend(follow(chords, tolerance, trusted, eyes)?);
    }
    Ok(traced)
}

/// Follows the outline for at most [`AT_ONCE`] chords, all at once.
fn follow(
    chords: &[Chord],
    tolerance: Length,
    trusted: Length,
    eyes: &mut Eyes<'_>,
) -> Result<Vec<Traced>, FieldError> {
    let mut traced = vec![Traced::default(); chords.len()];
    let mut open: Vec<Open> = chords
        .iter()
        .enumerate()
        .map(|(chord, c)| Open {
            chord,
            a: c.from,
            b: c.to,
            span: [0.0, 1.0],
            depth: 0,
        })
        .collect();
    let mut round = Round {
        chords,
        tolerance,
        eyes,
    };
    while !open.is_empty() {
        let mut asked: Vec<Asked> = Vec::new();
        for o in open {
            match look(o.a, o.b, tolerance, trusted) {
                Look::Straight => {}
                Look::Bent(p) => {
                    traced[o.chord].points.push((o.place(), p));
                }
                Look::Ask(question) if o.depth < DEPTH => {
                    let length = o.a.point.distance(o.b.point);
                    let mut parts = 2;
                    while question.flat > 0.0
                        && parts < 64
                        && length > trusted * parts as f64
                    {
                        parts *= 2;
                    }
                    asked.push(Asked {
                        o,
                        question,
                        count: parts - 1,
                    });
                }
                Look::Ask(_) => {}
            }
        }
        let (middles, asked) = round.corners(asked, &mut traced)?;
        open = round.halve(asked, &middles, &mut traced)?;
    }
    for t in &mut traced {
        t.points.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    }
    for (t, c) in traced.iter_mut().zip(chords) {
        let line: Vec<DVec2> = line(c, t).collect();
        if crosses_itself(&line) {
            t.points.clear();
            t.lost = true;
        }
    }
    Ok(traced)
}

/// A chord's points, ends included.
pub(super) fn line<'a>(
    chord: &'a Chord,
    traced: &'a Traced,
) -> impl Iterator<Item = DVec2> + 'a {
    std::iter::once(chord.from.point)
        .chain(traced.points.iter().map(|p| p.1))
        .chain(std::iter::once(chord.to.point))
}

/// True if the segments a b and c d have a point in common.
pub(super) fn cross(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) <= 0.0
        && side(c, d, a) * side(c, d, b) <= 0.0
        && a.min(b).cmple(c.max(d)).all()
        && c.min(d).cmple(a.max(b)).all()
}

fn crosses_itself(line: &[DVec2]) -> bool {
    // A line that never turns back does not cross itself. Hardly any line does,
    // and looking at all pairs of segments takes long for lines of thousands.
    if let (Some(first), Some(last)) = (line.first(), line.last()) {
        let way = last - first;
        if line.windows(2).all(|s| (s[1] - s[0]).dot(way) > 0.0) {
            return false;
        }
    }
    (0..line.len().saturating_sub(1)).any(|i| {
        (i + 2..line.len() - 1)
            .any(|j| cross(line[i], line[i + 1], line[j], line[j + 1]))
    })
}

/// True if two lines meet.
pub(super) fn lines_cross(a: &[DVec2], b: &[DVec2]) -> bool {
    a.windows(2)
        .any(|s| b.windows(2).any(|t| cross(s[0], s[1], t[0], t[1])))
}

/// What a round of questions needs.
struct Round<'r, 'e> {
    chords: &'r [Chord],
    tolerance: Length,
    eyes: &'r mut Eyes<'e>,
}

/// A point at which the tangents at a chord's ends meet.
struct Candidate {
    point: DVec2,
    /// Distance from the chord.
    height: Length,
    /// Steepness at the ends.
    slope: [f64; 2],
    beside: Option<[i32; 2]>,
}

impl Round<'_, '_> {
    /// Settles the chords that turn at a corner or are part of an arc. Returns
    /// the other chords, and the field at their middles.
    fn corners(
        &mut self,
        asked: Vec<Asked>,
        traced: &mut [Traced],
    ) -> Result<(Vec<f64>, Vec<Asked>), FieldError> {
        self.eyes.clear();
        let candidates: Vec<Option<Candidate>> = asked
            .iter()
            .map(|Asked { o, .. }| candidate(o, &self.chords[o.chord]))
            .collect();
        for (asked, candidate) in asked.iter().zip(&candidates) {
            let Asked { o, question, count } = asked;
            let Chord { z, cell, .. } = self.chords[o.chord];
            for k in 1..=*count {
                let t = k as f64 / (count + 1) as f64;
                self.eyes.push(o.a.point.lerp(o.b.point, t), z);
            }
            for p in question.arc.iter().flat_map(|a| a.0) {
                self.eyes.push(p, z);
            }
            let Some(c) = candidate else { continue };
            self.eyes.push(c.point, z);
            self.eyes.push(0.5 * (o.a.point + c.point), z);
            self.eyes.push(0.5 * (o.b.point + c.point), z);
            if let Some([i, j]) = c.beside {
                let size = cell.size();
                let min =
                    cell.min + size * DVec2::new(f64::from(i), f64::from(j));
                for (di, dj) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
                {
                    self.eyes.push(min + size * DVec2::new(di, dj), z);
                }
            }
        }
        let mut values = self.eyes.values()?.iter().map(|&f| f64::from(f));
        let mut next = || values.next().unwrap_or(f64::NAN);
        let (mut middles, mut rest) = (Vec::new(), Vec::new());
        for (asked, candidate) in asked.into_iter().zip(candidates) {
            let along: Vec<f64> = (0..asked.count).map(|_| next()).collect();
            let middle = along[asked.count / 2];
            let place = asked.o.place();
            if let Some((arc, most)) = asked.question.arc {
                let off = [next(), next(), next()].map(f64::abs);
                let room = grown(&self.chords[asked.o.chord]);
                if off.iter().all(|f| *f <= most) && room.contains(arc[1]) {
                    // An arc needs no test for a corner, so no values of a
                    // candidate follow.
                    traced[asked.o.chord].points.push((place, arc[1]));
                    continue;
                }
            }
            let mut accepted = None;
            if let Some(c) = candidate {
                let [f, a, b] = [next(), next(), next()];
                let [s, t] = c.slope;
                let near = (RESIDUE * c.height).min(self.tolerance);
                let fits = f.abs() <= near * s.max(t)
                    && a.abs() <= self.tolerance * s
                    && b.abs() <= self.tolerance * t;
                let inside = match c.beside {
                    Some(_) => (0..4).filter(|_| next() < 0.0).count(),
                    None => 0,
                };
                if fits && (inside == 0 || inside == 4) {
                    accepted = Some(c);
                }
            }
            let flat = asked.question.flat;
            match accepted {
                Some(c) => {
                    let t = &mut traced[asked.o.chord];
                    t.points.push((place, c.point));
                    t.beside = t.beside.or(c.beside);
                }
                None if along.iter().all(|f| f.abs() <= flat) => {}
                None => {
                    middles.push(middle);
                    rest.push(asked);
                }
            }
        }
        Ok((middles, rest))
    }

    /// Finds the outline across the chords' middles, and returns the halves.
    fn halve(
        &mut self,
        asked: Vec<Asked>,
        middles: &[f64],
        traced: &mut [Traced],
    ) -> Result<Vec<Open>, FieldError> {
        // The search goes from the middle outwards in growing steps, to the
        // cell's border.
        self.eyes.clear();
        let mut searches = Vec::new();
        for (Asked { o, question, .. }, &f) in asked.iter().zip(middles) {
            let chord = &self.chords[o.chord];
            let middle = 0.5 * (o.a.point + o.b.point);
            let out = -(o.b.point - o.a.point).perp().normalize_or_zero();
            let way = if f < 0.0 { out } else { -out };
            let room = grown(chord);
            let limit = 0.999 * leaves_cell(middle, way, room);
            let from = self.eyes.count();
            let mut steps = Vec::new();
            let mut d = question.reach;
            while d < limit {
                steps.push(d);
                d *= 2.0;
            }
            steps.push(limit);
            for &d in &steps {
                self.eyes.push(middle + way * d, chord.z);
            }
            searches.push((middle, way, from, steps));
        }
        let all = self.eyes.values()?;
        let mut brackets = Vec::new();
        let mut found = Vec::new();
        for (k, (middle, way, from, steps)) in searches.iter().enumerate() {
            let inside = middles[k] < 0.0;
            let values = &all[*from..*from + steps.len()];
            let hit = values.iter().position(|&f| (f < 0.0) != inside);
            let Some(n) = hit else {
                traced[asked[k].o.chord].lost = true;
                continue;
            };
            let (d, f) = match n.checked_sub(1) {
                Some(m) => (steps[m], values[m]),
                None => (0.0, middles[k] as f32),
            };
            let ends = [d, steps[n]].map(|d| *middle + *way * d);
            let z = self.chords[asked[k].o.chord].z;
            brackets.push(Bracket::new(ends, [f, values[n]], z));
            found.push(k);
        }
        let mut halves = Vec::new();
        for (root, k) in
            refine(&mut brackets, self.eyes)?.into_iter().zip(found)
        {
            let o = &asked[k].o;
            let place = o.place();
            traced[o.chord].points.push((place, root.point));
            let off = root.point.distance(searches[k].0);
            // Without gradients a corner shows in the middle of its chord, by
            // at least half its height. A single look could be misled.
            if off <= 0.5 * self.tolerance && o.depth > 0 {
                continue;
            }
            for (a, b, span) in [
                (o.a, root, [o.span[0], place]),
                (root, o.b, [place, o.span[1]]),
            ] {
                halves.push(Open {
                    chord: o.chord,
                    a,
                    b,
                    span,
                    depth: o.depth + 1,
                });
            }
        }
        Ok(halves)
    }
}

/// The box in which the outline may be followed.
fn grown(chord: &Chord) -> Rect {
    let Chord { cell, beyond, .. } = *chord;
    let pad = beyond * cell.size();
    Rect::new(cell.min - pad, cell.max + pad)
}

/// The corner that follows from the gradients at a chord's ends. None if it
/// does not lie in the chord's cell, in a cell that shares an edge with it, or
/// as far beyond as the chord may be followed.
fn candidate(o: &Open, chord: &Chord) -> Option<Candidate> {
    let Chord { cell, beyond, .. } = *chord;
    let (p, q) = (o.a, o.b);
    let u = p.gradient.try_normalize()?;
    let v = q.gradient.try_normalize()?;
    let sine = u.perp_dot(v);
    if u.dot(v) > COS_TURN || sine.abs() < 0.05 {
        return None;
    }
    // The corner c has u·(c − p) = 0 and v·(c − q) = 0.
    let chord = q.point - p.point;
    let along = u.perp();
    let point = p.point + along * (v.dot(chord) / v.dot(along));
    let height = chord.perp_dot(point - p.point).abs() / chord.length();
    let size = cell.size();
    let at = ((point - cell.min) / size).floor();
    let free = at.abs().max_element() <= beyond;
    let near = free || at.abs().element_sum() <= 1.0;
    (near && height.is_finite() && height > 1e-6).then(|| Candidate {
        point,
        height,
        slope: [p.gradient.length(), q.gradient.length()],
        beside: (at != DVec2::ZERO && !free)
            .then_some([at.x as i32, at.y as i32]),
    })
}

/// Distance along `way` from a point in a cell to the cell's border.
fn leaves_cell(from: DVec2, way: DVec2, cell: Rect) -> Length {
    let axis = |p: f64, w: f64, lo: f64, hi: f64| {
        let d = if w > 0.0 {
            (hi - p) / w
        } else if w < 0.0 {
            (lo - p) / w
        } else {
            f64::INFINITY
        };
        d.max(0.0)
    };
    let d = axis(from.x, way.x, cell.min.x, cell.max.x)
        .min(axis(from.y, way.y, cell.min.y, cell.max.y));
    if d.is_finite() { d } else { 0.0 }
}

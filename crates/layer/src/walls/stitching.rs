//! Strokes that go on in one another where they meet.
//!
//! ```text
//!   ━━━━━━━╮                 One wide bead ends where two walls begin. It
//!          ╲ ━━━━━━━━━━      goes on in one of them; the other one begins
//!   ━━━━━━━━╲                beside it. Where three strips meet, the two
//!            ╲━━━━━━━━━      that make the least turn become one stroke, and
//!   ━━━━━━━╯                 the third one stops short of it.
//! ```
//!
//! In: the strokes of one wall, those cut open and the beads of thin places.
//! Out: fewer, longer ones. Ends are joined in pairs, those with the least
//! turn first. Between two ends that lie beside each other both strokes are
//! shortened, so that the way across is no steeper than about 25° where they
//! are long enough, and there is as much material as before. An end that is
//! left over is shortened until it lies on no stroke, its own included. A dab
//! that lies nearly all on other strokes is left out.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::{EdgeGrid, nearest_on};
use isoslice_planar::joints::{self, Joints};
use std::cell::LazyCell;

/// Greatest turn between two strokes that go on in one another, radians.
const TURN: f64 = 1.75;
/// Distance of ends that belong together, as a share of their mean width.
const REACH: f64 = 0.75;
/// Distance that joints keep from each other, as a share of their mean width:
/// two joints that cross would lay twice what lies between them.
const APART: f64 = 0.5;
/// Length of the way across from one line to another, as a multiple of the
/// distance between the two lines.
const RAMP: f64 = 2.4;
/// Distance of the places on a way across at which its width is found, mm.
const CROSS_STEP: Mm = 0.1;
/// Least share of its width that a gentle way across has room for.
const ROOMY: f64 = 0.8;
/// Times that a way across may become half as gentle.
const HALVES: usize = 3;
/// Slits between a way across and the border that are as wide as this, mm, do
/// not move the way towards the border: such a border is another strip's. Up to
/// two thirds of this width the slit is closed, beyond that less and less of
/// it.
const SLIT: Mm = 0.15;
/// Difference of two strokes' widths, as a share of the smaller one, from which
/// one of them is a bead in the middle of a strip and the other one a wall.
const UNLIKE: f64 = 0.15;
/// Least width on the way across, as a share of the mean one.
const LEAST: f64 = 0.5;
/// Share of a stroke that may be taken from one of its ends.
const SHARE: f64 = 0.4;
/// Distance at which an end stops short of another stroke's middle, as a share
/// of that one's width: a little less than half, since the end is round.
const STOP: f64 = 0.4;
/// Least distance along a stroke, as a multiple of its width, between its end
/// and a piece of it on which the end can lie. Nearer pieces lead to the end.
const OWN: f64 = 3.0;
/// Strokes whose ends lie on others are left out if what is left of them is
/// shorter than this share of their width.
const STUB: f64 = 0.15;
/// Greatest overlap of an end with a stroke that is left alone, mm.
const OVERLAP_LEFT: Mm = 0.005;
/// A stroke shorter than this many of its widths is a dab.
const DAB: f64 = 2.0;
/// A dab is left out if less than this share of it lies where no other bead does:
/// a pit in the corner of a sheet is not worth a travel there and back.
const NEW: f64 = 0.3;
/// Number of places across a dab at which the beads there are looked up.
const PLACES: u32 = 9;

/// The space around a place for a bead with its middle there.
#[derive(Clone, Copy)]
pub(super) struct Space {
    /// How wide such a bead may be.
    pub width: Mm,
    /// Direction of the nearest border, a unit vector; zero if there is none.
    pub out: DVec2,
}

/// One end of an open stroke.
#[derive(Clone, Copy)]
struct End {
    stroke: usize,
    /// True for its last point, false for its first.
    last: bool,
    at: DVec2,
    /// Direction in which the stroke leads out of its end, a unit vector.
    ahead: DVec2,
    width: Mm,
}

impl End {
    fn new(strokes: &[Stroke], stroke: usize, last: bool) -> Option<End> {
        let s = &strokes[stroke];
        let n = s.points.len();
        let end = n.checked_sub(1)?;
        let index = |k: usize| if last { end - k } else { k };
        let at = s.points[index(0)];
        let width = s.width_at(index(0));
        // The direction is taken from a point farther back, so that a kink at
        // the end does not decide it.
        let far = (0..n)
            .map(|k| s.points[index(k)])
            .find(|p| p.distance(at) > 0.5 * width);
        let back = far.unwrap_or(s.points[index(end)]);
        Some(End {
            stroke,
            last,
            at,
            ahead: (at - back).try_normalize()?,
            width,
        })
    }

    /// The end's number among those of all strokes.
    fn number(&self) -> joints::End {
        2 * self.stroke + usize::from(self.last)
    }

    /// The cost of joining two ends, if they belong together: their turn, and
    /// their distance in widths. The pairs that cost the least are joined
    /// first.
    fn cost(&self, other: &End) -> Option<f64> {
        let mean = 0.5 * (self.width + other.width);
        let way = other.at - self.at;
        let turn = self.ahead.angle_to(-other.ahead).abs();
        let along = (self.ahead - other.ahead).normalize_or_zero();
        let near = way.length() <= REACH * mean
            // The two ends must not have passed each other by much.
            && way.dot(along) >= -mean;
        (near && turn <= TURN).then(|| turn + way.length() / mean)
    }

    /// Length to take from both ends, so that the way across is not steep.
    fn ramp(&self, other: &End) -> Mm {
        let along = (self.ahead - other.ahead).normalize_or_zero();
        let way = other.at - self.at;
        let aside = way.perp_dot(along).abs();
        (0.5 * (RAMP * aside - way.dot(along))).max(0.0)
    }
}

/// Joins the strokes whose ends meet: rings cut open and the beads of thin
/// places. `room` tells how wide a bead may be that has its middle at a
/// place, mm. Where there is no room for a bead wider than `overlap`, mm, the beads
/// of other walls lie; without that number dabs stay. Returns the strokes that are
/// or have a piece of a ring, and those that are beads of thin places all along.
pub(super) fn join(
    rings: Vec<Stroke>,
    beads: Vec<Stroke>,
    overlap: Option<Mm>,
    room: impl Fn(DVec2) -> Space,
) -> (Vec<Stroke>, Vec<Stroke>) {
    if beads.is_empty() && rings.iter().all(|ring| ring.closed) {
        return (rings, beads);
    }
    let count = rings.len();
    let mut strokes = rings;
    strokes.extend(beads);
    let ends: Vec<End> = (0..strokes.len())
        .filter(|&i| !strokes[i].closed)
        .flat_map(|i| [(i, false), (i, true)])
        .filter_map(|(i, last)| End::new(&strokes, i, last))
        .collect();
    let pairs = pairs(&strokes, &ends, &room);
    let mut joints = Joints::new(strokes.len());
    for &(a, b) in &pairs {
        joints.join(ends[a].number(), ends[b].number());
    }
    for &(a, b) in &pairs {
        let length = ramp([&ends[a], &ends[b]], &strokes, &room);
        for end in [&ends[a], &ends[b]] {
            let stroke = &mut strokes[end.stroke];
            let taken = length.min(SHARE * stroke.length());
            *stroke = stroke.shortened(end.last, taken);
        }
    }
    let joined = chains(strokes, count, &joints, &room);
    let widest = ends.iter().map(|e| e.width).fold(0.0, f64::max);
    let taken = overlap.map(|most| move |p: DVec2| room(p).width <= most);
    let joined = stop_short(joined, widest, taken);
    let (rings, beads): (Vec<_>, Vec<_>) =
        joined.into_iter().partition(|chain| chain.ring);
    let strokes = |all: Vec<Chain>| all.into_iter().map(|c| c.stroke).collect();
    (strokes(rings), strokes(beads))
}

/// The pairs of ends that become one, those with the least turn first.
fn pairs(
    strokes: &[Stroke],
    ends: &[End],
    room: &impl Fn(DVec2) -> Space,
) -> Vec<(usize, usize)> {
    let widest = ends.iter().map(|e| e.width).fold(0.0, f64::max);
    let reach = REACH * widest;
    let points = ends.iter().enumerate().map(|(i, e)| (i, (e.at, e.at)));
    let grid = EdgeGrid::of(points, reach);
    let lines = LazyCell::new(|| {
        EdgeGrid::of_lines(strokes.iter().map(Stroke::path), widest)
    });
    let mut all: Vec<(f64, usize, usize)> = Vec::new();
    let mut near = Vec::new();
    for (i, end) in ends.iter().enumerate() {
        near.clear();
        grid.visit_near(end.at, end.at, reach, |j| near.push(j));
        near.sort_unstable();
        near.dedup();
        for &j in near.iter().filter(|&&j| j > i) {
            let other = &ends[j];
            // A short stroke is not closed to a ring.
            let tail = end.stroke == other.stroke
                && strokes[end.stroke].length() < 4.0 * end.width;
            if tail {
                continue;
            }
            if let Some(cost) = end.cost(other)
                && room(end.at.midpoint(other.at)).width
                    > 0.35 * (end.width + other.width)
                // A way across that crosses a stroke would be laid over it.
                && !lines.crosses_way(end.at, other.at)
            {
                all.push((cost, i, j));
            }
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut free = vec![true; ends.len()];
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    // The joint that each end has become part of, if any.
    let mut joints: Vec<Option<DVec2>> = vec![None; ends.len()];
    for (_, i, j) in all {
        let joint = ends[i].at.midpoint(ends[j].at);
        let apart = APART * 0.5 * (ends[i].width + ends[j].width);
        let mut crosses = false;
        grid.visit_near(joint, joint, reach + apart, |k| {
            let near = |other: DVec2| other.distance(joint) < apart;
            crosses |= joints[k].is_some_and(near);
        });
        if free[i] && free[j] && !crosses {
            (free[i], free[j]) = (false, false);
            joints[i] = Some(joint);
            pairs.push((i, j));
        }
    }
    pairs
}

/// How much has to be taken from two ends for a gentle way across, if there is
/// room for that; else as much as leaves room, if anything does.
fn ramp(
    ends: [&End; 2],
    strokes: &[Stroke],
    room: &impl Fn(DVec2) -> Space,
) -> Mm {
    let place = |end: &End, length: Mm| {
        let stroke = &strokes[end.stroke];
        let taken = length.min(SHARE * stroke.length());
        stroke.place(end.last, taken).unwrap_or(end.at)
    };
    let mut length = ends[0].ramp(ends[1]);
    for _ in 0..HALVES {
        let [p, q] = ends.map(|end| place(end, length));
        let [v, w] = ends.map(|end| end.width);
        if across([p, q], [v, w])
            .all(|(at, meant)| room(at).width >= ROOMY * meant)
        {
            break;
        }
        length *= 0.5;
    }
    length
}

/// Places on the straight way from one place and width to others, without its
/// ends, and the widths there.
fn across(
    [p, q]: [DVec2; 2],
    [v, w]: [Mm; 2],
) -> impl Iterator<Item = (DVec2, Mm)> {
    let parts = (p.distance(q) / CROSS_STEP).ceil().clamp(2.0, 32.0);
    (1..parts as usize).map(move |k| {
        let t = k as f64 / parts;
        (p.lerp(q, t), v + t * (w - v))
    })
}

/// Strokes that have become one.
struct Chain {
    stroke: Stroke,
    /// True if one of them is a ring or a piece of one.
    ring: bool,
}

/// Puts strokes together to chains. The first `rings` strokes are pieces of rings.
fn chains(
    strokes: Vec<Stroke>,
    rings: usize,
    joints: &Joints,
    room: &impl Fn(DVec2) -> Space,
) -> Vec<Chain> {
    let mut all = Vec::with_capacity(strokes.len());
    for joints::Chain { pieces, closed } in joints.chains() {
        let mut pieces = pieces.into_iter().map(|(i, reversed)| {
            let mut stroke = strokes[i].clone();
            if reversed {
                stroke.reverse();
            }
            (stroke, i < rings)
        });
        let Some((stroke, ring)) = pieces.next() else {
            continue;
        };
        let mut chain = Chain { stroke, ring };
        for (stroke, ring) in pieces {
            chain.go_on(&stroke, room);
            chain.ring |= ring;
        }
        if closed {
            chain.close(room);
        }
        all.push(chain);
    }
    all
}

impl Chain {
    fn go_on(&mut self, after: &Stroke, room: &impl Fn(DVec2) -> Space) {
        let (mut points, mut widths) = self.take();
        let n = after.points.len();
        cross(&mut points, &mut widths, after, room);
        points.extend(&after.points);
        widths.extend((0..n).map(|i| after.width_at(i)));
        self.stroke = Stroke::varying(points, widths, false);
    }

    /// Leads the stroke back to its beginning.
    fn close(&mut self, room: &impl Fn(DVec2) -> Space) {
        let start = self.stroke.clone();
        let (mut points, mut widths) = self.take();
        cross(&mut points, &mut widths, &start, room);
        self.stroke = Stroke::varying(points, widths, true);
    }

    /// The stroke's points, and a width for each.
    fn take(&mut self) -> (Vec<DVec2>, Vec<Mm>) {
        let n = self.stroke.points.len();
        let widths = (0..n).map(|i| self.stroke.width_at(i)).collect();
        (std::mem::take(&mut self.stroke.points), widths)
    }
}

/// The way across from a stroke's end to where another begins: nowhere wider
/// than there is room, and beside a border if it leads from a bead to a wall.
fn cross(
    points: &mut Vec<DVec2>,
    widths: &mut Vec<Mm>,
    to: &Stroke,
    room: &impl Fn(DVec2) -> Space,
) {
    let (Some(&p), Some(&v), Some(&q)) =
        (points.last(), widths.last(), to.points.first())
    else {
        return;
    };
    let w = to.width_at(0);
    // Only a way from a bead in the middle of a strip to a wall has a border on
    // one side.
    let turns_wall = (v - w).abs() > UNLIKE * v.min(w);
    for (at, meant) in across([p, q], [v, w]) {
        let Space { width, out } = room(at);
        // Beside a curved border a straight way from a bead to a wall would
        // leave a slit open.
        let slit = width - meant;
        if turns_wall && slit > 0.0 && slit < SLIT {
            let closed = slit.min(2.0 * (SLIT - slit));
            points.push(at + 0.5 * closed * out);
            widths.push(meant);
            continue;
        }
        points.push(at);
        // Shortened ends may have moved the way to where there is next to no
        // room. A bead needs some width even there.
        widths.push(meant.min(width.max(LEAST * meant)));
    }
}

/// Shortens ends that lie on strokes, and leaves out strokes that lie on others
/// all along. Of two strokes that lie on each other the shorter one yields. Dabs
/// that lie nearly all on other beads are left out if `taken` is given, which tells
/// where the beads of other walls lie.
fn stop_short(
    chains: Vec<Chain>,
    widest: Mm,
    taken: Option<impl Fn(DVec2) -> bool>,
) -> Vec<Chain> {
    // Most rings close again, and have no ends.
    if chains.iter().all(|chain| chain.stroke.closed) {
        return chains;
    }
    let paths = chains.iter().map(|c| c.stroke.path());
    let grid = EdgeGrid::of_lines(paths, widest);
    let mut lines = Vec::with_capacity(chains.len());
    let mut first = 0;
    for chain in &chains {
        let line = Line::new(&chain.stroke, first);
        first += line.at.len();
        lines.push(line);
    }
    let mut order: Vec<usize> = (0..chains.len()).collect();
    order.sort_by(|&i, &j| {
        let by_length = lines[i].length().total_cmp(&lines[j].length());
        by_length.then(i.cmp(&j))
    });
    order.retain(|&i| !chains[i].stroke.closed);
    for &i in &order {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        // How far a bead with its middle at `p`, at a distance along its
        // stroke, lies on strokes.
        let over = |lines: &[Line], p: DVec2, along: Mm| {
            let mut most: Mm = 0.0;
            grid.visit_edges_near(p, p, STOP * widest, |edge| {
                let other = grid.owner(edge);
                let line = &lines[other];
                let (a, b) = grid.edge(edge);
                let q = nearest_on(p, a, b);
                let (k, at) = (edge - line.first, q.distance(a));
                let lies = line.width(k, at);
                let before = other == i
                    && (line.at[k].0 + at - along).abs() < OWN * lies;
                if !before {
                    most = most.max(STOP * lies - p.distance(q));
                }
            });
            most
        };
        let mut stroke = chains[i].stroke.clone();
        let length = lines[i].length();
        let mut ends = [0.0; 2];
        for (end, taken) in ends.iter_mut().enumerate() {
            let line = Line::new(&stroke, 0);
            while *taken < length {
                let place = line.place(&stroke, *taken);
                let along = if end == 0 { *taken } else { length - *taken };
                let over = over(&lines, place, along);
                if over <= OVERLAP_LEFT {
                    break;
                }
                *taken += over;
                if end == 0 {
                    lines[i].left.0 = *taken;
                }
            }
            stroke.reverse();
        }
        let short = STUB * chains[i].stroke.width;
        let lies = ends != [0.0; 2] && ends[0] + ends[1] > length - short;
        lines[i].left = if lies {
            (0.0, 0.0)
        } else {
            (ends[0], length - ends[1])
        };
    }
    let dabs = taken
        .iter()
        .flat_map(|taken| order.iter().map(move |i| (*i, taken)));
    for (i, taken) in dabs {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let stroke = &chains[i].stroke;
        if new_share(stroke, i, &lines, &grid, widest, taken) < NEW {
            lines[i].left = (0.0, 0.0);
        }
    }
    let mut all = Vec::with_capacity(chains.len());
    for (mut chain, line) in chains.into_iter().zip(lines) {
        let (from, to) = line.left;
        let length = line.length();
        if to <= from && !chain.stroke.closed {
            continue;
        }
        if (from, to) != (0.0, length) {
            chain.stroke = chain.stroke.part(from / length, to / length);
        }
        all.push(chain);
    }
    all
}

/// The share of `stroke`, number `i`, that lies neither on another stroke nor where
/// `taken` says that a bead of another wall lies; 1 if the stroke is too long for a
/// dab, or if the share is large.
fn new_share(
    stroke: &Stroke,
    i: usize,
    lines: &[Line],
    grid: &EdgeGrid,
    widest: Mm,
    taken: &impl Fn(DVec2) -> bool,
) -> f64 {
    let line = &lines[i];
    let (from, to) = line.left;
    let width = stroke.width;
    if to <= from || to - from >= DAB * width {
        return 1.0;
    }
    // Squares of a grid along the dab that its bead covers.
    let radius = 0.5 * width;
    let [a, b] = [from, to].map(|at| line.place(stroke, at));
    let middle = line.place(stroke, 0.5 * (from + to));
    let (low, high) = (a.min(b).min(middle), a.max(b).max(middle));
    let step = width / f64::from(PLACES);
    let (low, high) = (low - radius, high + radius);
    let count = ((high - low) / step).ceil();
    // All that may cover some of them is looked up once.
    let mut near = Vec::new();
    for (a, b) in [(a, middle), (middle, b)] {
        let reach = radius + 0.5 * widest;
        grid.visit_edges_near(a, b, reach, |edge| near.push(edge));
    }
    near.sort_unstable();
    near.dedup();
    let others = near.into_iter().map(|edge| (edge, grid.owner(edge)));
    let others = others.filter(|(_, other)| *other != i);
    let others: Vec<_> = others.map(|(k, other)| (k, &lines[other])).collect();
    let lies_on = |p: DVec2| {
        others.iter().any(|&(edge, line)| {
            let (a, b) = grid.edge(edge);
            let q = nearest_on(p, a, b);
            let off = p.distance(q);
            let lies = || line.width(edge - line.first, q.distance(a));
            off < 0.5 * widest && off < 0.5 * lies()
        })
    };
    let (mut all, mut new) = (0_u32, 0_u32);
    for k in 0..(count.x * count.y) as usize {
        let k = k as f64;
        let at = DVec2::new(k % count.x, (k / count.x).floor()) + 0.5;
        let p = low + step * at;
        let on_dab = [(a, middle), (middle, b)]
            .iter()
            .any(|&(a, b)| nearest_on(p, a, b).distance(p) <= radius);
        if !on_dab {
            continue;
        }
        all += 1;
        let covered = lies_on(p) || taken(p);
        new += u32::from(!covered);
        // However many more there are on the dab, this is enough.
        if f64::from(new) >= NEW * count.x * count.y {
            return 1.0;
        }
    }
    f64::from(new) / f64::from(all.max(1))
}

/// A stroke's segments, and what is left of it.
struct Line {
    /// The number of its first edge in the grid.
    first: usize,
    /// Distance along the stroke, and width, at each point of its path.
    at: Vec<(Mm, Mm)>,
    /// The lengths along the stroke between which it is still laid.
    left: (Mm, Mm),
}

impl Line {
    fn new(stroke: &Stroke, first: usize) -> Line {
        let mut done = 0.0;
        let mut before = None;
        let at: Vec<(Mm, Mm)> = stroke
            .path()
            .enumerate()
            .map(|(k, p)| {
                done += before.replace(p).map_or(0.0, |q| p.distance(q));
                (done, stroke.width_at(k))
            })
            .collect();
        let left = (0.0, done);
        Line { first, at, left }
    }

    fn length(&self) -> Mm {
        self.at.last().map_or(0.0, |at| at.0)
    }

    /// The width on edge `k`, `along` mm from its beginning; 0 where the stroke
    /// is not laid any more.
    fn width(&self, k: usize, along: Mm) -> Mm {
        let (Some(&(from, w)), Some(&(to, v))) =
            (self.at.get(k), self.at.get(k + 1))
        else {
            return 0.0;
        };
        let at = from + along;
        // Nothing is left of a stroke that yields, not even its beginning.
        let laid = self.left.0 < self.left.1
            && (self.left.0..=self.left.1).contains(&at);
        if !laid {
            return 0.0;
        }
        let t = along / (to - from).max(f64::MIN_POSITIVE);
        w + t.min(1.0) * (v - w)
    }

    /// The place at a distance along the stroke.
    fn place(&self, stroke: &Stroke, along: Mm) -> DVec2 {
        let k = self.at.partition_point(|at| at.0 <= along);
        let n = stroke.points.len();
        match (k, self.at.get(k)) {
            (1.., Some(to)) => {
                let from = self.at[k - 1].0;
                let t = (along - from) / (to.0 - from);
                stroke.points[k - 1].lerp(stroke.points[k % n], t)
            }
            _ => stroke.points[n - 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[(f64, f64)], width: f64) -> Stroke {
        let points = points.iter().map(|&(x, y)| DVec2::new(x, y));
        Stroke::new(points.collect(), false, width)
    }

    fn anywhere(_: DVec2) -> Space {
        wide(f64::INFINITY)
    }

    fn wide(width: Mm) -> Space {
        Space {
            width,
            out: DVec2::ZERO,
        }
    }

    /// The volume of a stroke divided by its height, mm².
    fn content(stroke: &Stroke) -> f64 {
        let each = stroke.segments().enumerate();
        each.map(|(i, (a, b))| {
            0.5 * (stroke.width_at(i) + stroke.width_at(i + 1)) * a.distance(b)
        })
        .sum()
    }

    /// A strip of 0.84 mm: one bead at first, then two walls.
    #[test]
    fn a_wide_bead_goes_on_in_one_of_two_walls() {
        let bead = line(&[(0.0, 0.0), (5.0, 0.0)], 0.84);
        let walls = [0.21, -0.21].map(|y| line(&[(5.1, y), (10.0, y)], 0.42));
        let (rings, beads) = join(walls.to_vec(), vec![bead], None, anywhere);
        assert_eq!((rings.len(), beads.len()), (2, 0));
        let longest = rings.iter().map(Stroke::length).fold(0.0, f64::max);
        assert!((longest - 10.1).abs() < 0.2, "{longest}");
        let laid: f64 = rings.iter().map(content).sum();
        assert!((laid - 8.4).abs() < 0.1, "{laid}");
        // The other wall begins where the bead has made way for it.
        let other = rings.iter().find(|r| r.length() < 6.0).unwrap();
        let begins = other.points.iter().map(|p| p.x).fold(9.0, f64::min);
        assert!((5.1..5.6).contains(&begins), "{begins}");
    }

    /// A strip of 0.84 mm round a circle: one bead, which goes on in the outer
    /// one of two walls.
    #[test]
    fn a_way_across_follows_a_curved_border() {
        let (outer, inner) = (3.0, 2.16);
        let arc = |radius: f64, from: f64, to: f64| {
            let at = move |i: u32| {
                let angle = from + (to - from) * f64::from(i) / 100.0;
                DVec2::from_angle(angle) * radius
            };
            (0..=100).map(at).collect::<Vec<DVec2>>()
        };
        let bead = Stroke::new(arc(2.58, 0.0, 1.5), false, 0.84);
        let walls = [2.79, 2.37]
            .map(|radius| Stroke::new(arc(radius, 1.53, 3.0), false, 0.42));
        let room = |p: DVec2| {
            let (to_outer, to_inner) = (outer - p.length(), p.length() - inner);
            let out = p.normalize() * (to_inner - to_outer).signum();
            Space {
                width: 2.0 * to_outer.min(to_inner),
                out,
            }
        };
        let (rings, _) = join(walls.to_vec(), vec![bead], None, room);
        let through = rings
            .iter()
            .max_by(|a, b| a.length().total_cmp(&b.length()));
        let through = through.unwrap();
        for (i, p) in through.points.iter().enumerate() {
            let edge = p.length() + 0.5 * through.width_at(i);
            assert!((edge - outer).abs() < 0.002, "{p}: {edge}");
        }
        assert!(through.length() > 2.58 * 1.5 + 2.79 * 1.4);
    }

    #[test]
    fn of_three_strips_two_go_on_and_one_stops_short() {
        let arms = [0.0, 3.0, 4.7].map(|angle| {
            let away = DVec2::from_angle(angle);
            Stroke::new(vec![0.05 * away, 6.0 * away], false, 0.6)
        });
        let (rings, beads) = join(Vec::new(), arms.to_vec(), None, anywhere);
        assert_eq!((rings.len(), beads.len()), (0, 2));
        let mut lengths: Vec<f64> = beads.iter().map(Stroke::length).collect();
        lengths.sort_by(f64::total_cmp);
        assert!((lengths[1] - 12.0).abs() < 0.05, "{lengths:?}");
        assert!((lengths[0] - 5.76).abs() < 0.05, "{lengths:?}");
    }

    #[test]
    fn strokes_do_not_cross_in_a_joint() {
        let arms =
            [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(|to| {
                let away = DVec2::from(to);
                Stroke::new(vec![0.05 * away, 6.0 * away], false, 0.6)
            });
        let (_, beads) = join(Vec::new(), arms.to_vec(), None, anywhere);
        assert_eq!(beads.len(), 3);
        let laid: f64 = beads.iter().map(content).sum();
        // The area of the cross is 4·6·0.6 − 0.6².
        assert!((laid / 14.04 - 1.0).abs() < 0.01, "{laid}");
    }

    #[test]
    fn a_short_bead_that_reaches_out_of_another_stays() {
        // A lobe beside a bead of 0.6 mm: 0.21 mm of it are its own.
        let bead = line(&[(-1.0, 0.0), (1.0, 0.0)], 0.6);
        let lobe = line(&[(0.0, 0.05), (0.0, 0.45)], 0.5);
        let (_, beads) =
            join(Vec::new(), vec![bead.clone(), lobe], None, anywhere);
        let lengths: Vec<f64> = beads.iter().map(Stroke::length).collect();
        assert_eq!(lengths.len(), 2);
        assert!((lengths[1] - 0.21).abs() < 0.01, "{lengths:?}");
        // A stroke that reaches out by less than its round end covers does not
        // reach out.
        let lobe = line(&[(0.0, 0.05), (0.0, 0.3)], 0.5);
        let (_, beads) =
            join(Vec::new(), vec![bead.clone(), lobe], None, anywhere);
        assert_eq!(beads, [bead]);
    }

    /// A corner of two beads of 0.9 mm, and a dab on its outer side.
    #[test]
    fn a_dab_that_lies_on_others_is_left_out() {
        let corner = line(&[(-4.0, -4.0), (0.0, 0.0), (-4.0, 4.0)], 0.9);
        let laid = |from: f64| {
            let dab = line(&[(from, -0.12), (from, 0.12)], 0.45);
            // The border is 0.5 mm from the corner's middle.
            let room = |p: DVec2| wide(2.0 * (0.5 - p.x));
            join(Vec::new(), vec![corner.clone(), dab], Some(0.0), room)
                .1
                .len()
        };
        assert_eq!(laid(0.37), 1);
        // A dab between the two beads, where the corner is open, stays.
        assert_eq!(laid(-1.5), 2);
    }

    #[test]
    fn an_end_stops_short_of_its_own_stroke() {
        // A loop that comes back to its beginning and goes on across it.
        let bead = line(
            &[(0.0, 0.0), (8.0, 0.0), (8.0, 4.0), (3.0, 4.0), (3.0, 0.1)],
            0.5,
        );
        let (_, beads) = join(Vec::new(), vec![bead.clone()], None, anywhere);
        let end = beads[0].points.last().unwrap();
        assert!((end.y - 0.2).abs() < 0.01, "{end}");
        assert_eq!(beads[0].points[0], DVec2::ZERO);
        // A tight bend is no loop.
        let bend =
            line(&[(0.0, 0.0), (1.0, 0.0), (1.0, 0.15), (0.4, 0.15)], 0.5);
        let (_, beads) = join(Vec::new(), vec![bend.clone()], None, anywhere);
        assert_eq!(beads, [bend]);
    }

    #[test]
    fn of_two_strokes_on_one_track_one_stays() {
        let long = line(&[(0.0, 0.0), (8.0, 0.0)], 0.5);
        let short = line(&[(6.0, 0.04), (3.0, 0.06)], 0.5);
        let (_, beads) =
            join(Vec::new(), vec![short, long.clone()], None, anywhere);
        assert_eq!(beads, [long]);
        // This one leaves the other's way after half of its length, so that
        // half stays.
        let half = line(&[(4.0, 0.05), (8.5, 0.05), (8.5, 6.0)], 0.5);
        let long = line(&[(0.0, 0.0), (9.0, 0.0), (20.0, 0.0)], 0.5);
        let (_, beads) = join(Vec::new(), vec![half, long], None, anywhere);
        assert_eq!(beads.len(), 2);
        let shorter = beads.iter().map(Stroke::length).fold(99.0, f64::min);
        assert!((shorter - 5.8).abs() < 0.05, "{shorter}");
    }

    /// A stroke that yields must not make the other one yield as well.
    #[test]
    fn of_two_strokes_as_long_as_each_other_one_stays() {
        for longer in [0.0, 0.004] {
            let long = line(&[(0.0, 0.0), (4.0 + longer, 0.0)], 0.5);
            let back = line(&[(4.0, 0.0), (0.0, 0.0)], 0.5);
            let (_, thin) = join(Vec::new(), vec![long, back], None, anywhere);
            let length: Mm = thin.iter().map(Stroke::length).sum();
            assert!((length - 4.0).abs() < 0.01, "{thin:?}");
        }
    }

    #[test]
    fn what_lies_between_has_to_be_free() {
        let pieces = [[0.0, 4.0], [4.3, 9.0]]
            .map(|[a, b]| line(&[(a, 0.0), (b, 0.0)], 0.5));
        let joined = |room: f64| {
            let (_, beads) =
                join(Vec::new(), pieces.to_vec(), None, |_| wide(room));
            beads.len()
        };
        assert_eq!(joined(0.5), 1);
        assert_eq!(joined(0.2), 2);
    }

    #[test]
    fn beads_have_a_width_where_there_is_no_room() {
        let bead = line(&[(0.0, 0.0), (5.0, 0.0)], 0.84);
        // Too short for as much to be taken from it as from the bead.
        let wall = line(&[(5.1, 0.21), (5.2, 0.21)], 0.42);
        // There is room where the ends meet, and none where they cross over.
        let room = |p: DVec2| wide(if p.x < 5.045 { -1.0 } else { 1.0 });
        let (rings, _) = join(vec![wall], vec![bead], None, room);
        assert_eq!(rings.len(), 1);
        assert!(rings[0].widths.iter().all(|w| *w > 0.3));
    }

    #[test]
    fn strokes_of_no_points_or_one_do_no_harm() {
        let odd = || vec![line(&[], 0.4), line(&[(1.0, 1.0)], 0.4)];
        join(odd(), odd(), None, anywhere);
    }

    #[test]
    fn rings_that_meet_themselves_are_closed() {
        let most = |i: usize| DVec2::from_angle(i as f64 * 0.063) * 5.0;
        let ring = Stroke::new((0..100).map(most).collect(), false, 0.45);
        let (rings, _) = join(vec![ring], Vec::new(), None, anywhere);
        assert!(rings[0].closed);
        assert!((rings[0].length() - 31.4).abs() < 0.1);
    }
}

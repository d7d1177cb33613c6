//! Centre lines of walls, closed or cut open, of one width or of many.
//!
//! Two changes are made to the plain offsets of an outline. Where an axis's
//! bead takes a thin place, the wall's ring, whose two sides would run into
//! each other there, is cut away. And where what is left between two walls is
//! too thin for a bead of its own, the walls beside it become wider and move
//! in, each taking half.

use super::medial_axis::Axis;
use super::widen::{CORNER, SEEN, Station, across, nowhere, widened};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::along::change;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::{Area, Rect, edges};

/// Distance of the places at which a line near an axis is looked at, mm.
const LOOK_STEP: Mm = 0.2;
/// Length from which a piece of a ring is laid, as a share of its width. Where
/// three strips meet, short pieces are all that lies between their beads at the
/// surface (measured on lattices: pieces longer than their width only leave a
/// third more of the solid uncovered, with as many retractions).
const SHORTEST: f64 = 0.25;
/// Accuracy of the place at which a line has to end, mm.
const END: Mm = 0.005;
/// Distance of the places at which a line's width is looked at, mm.
const WIDEN_STEP: Mm = 0.1;
/// Number of places on an edge that are looked at together. What is near to one
/// of these places is near to the others as well.
const STRETCH: usize = 16;
/// Number of edges of a line that are looked at together at first. No axis is
/// near to most of them.
const GROUP: usize = 8;
/// Least size of the cells in which axes are looked up, mm.
const CELL: Mm = 0.8;
/// Slack in distances that are equal but for rounding and thinning, mm.
const THINNED: Mm = 0.05;

/// Axes, sorted so that the nearest one is found quickly.
pub(super) struct AxisIndex<'a> {
    axes: &'a [Axis],
    grid: EdgeGrid,
    /// Axis and segment of each of the grid's numbers.
    segments: Vec<(u32, u32)>,
}

impl<'a> AxisIndex<'a> {
    pub(super) fn new(axes: &'a [Axis], reach: Mm) -> Self {
        let points = |r: &'a Axis| {
            let closing = if r.closed { 1 } else { 0 };
            r.points.iter().chain(r.points.iter().take(closing))
        };
        let mut segments = Vec::new();
        for (i, r) in axes.iter().enumerate() {
            let all = 0..points(r).count() as u32;
            segments.extend(all.map(|k| (i as u32, k)));
        }
        let lines = axes.iter().map(|r| points(r).copied());
        AxisIndex {
            axes,
            grid: EdgeGrid::of_lines(lines, reach.max(CELL)),
            segments,
        }
    }

    /// True if no axis comes within `reach` of a group of edges, which begins
    /// at the `k`th point. A line that is closed returns to its first point.
    fn group_clear(&self, points: &[DVec2], k: usize, reach: Mm) -> bool {
        let all = points.iter().skip(k).take(GROUP + 1);
        let closing = (k + GROUP >= points.len()).then(|| points.first());
        let bounds = Rect::around(all.chain(closing.flatten()));
        !self.grid.meets(bounds.grown(reach))
    }

    /// True if no axis comes closer than `reach` to the segment from `a` to
    /// `b`. `found` gets the axes' segments that do, unless the `count`
    /// places to be looked at on the segment are more than a stretch.
    fn clear_of(
        &self,
        a: DVec2,
        b: DVec2,
        reach: Mm,
        count: usize,
        found: &mut Vec<u32>,
    ) -> bool {
        if count > STRETCH {
            return self.clear(a, b, reach);
        }
        self.around(a, b, reach, found);
        found.is_empty()
    }

    /// Finds the axes' segments that come closer than `reach` to the segment
    /// from `a` to `b`, and a few that do not.
    fn beside(&self, a: DVec2, b: DVec2, reach: Mm, found: &mut Vec<u32>) {
        found.clear();
        let (lo, hi) = (a.min(b) - reach, a.max(b) + reach);
        self.grid.visit_box(lo, hi, |edge| note(edge, found));
    }

    /// Finds the axes' segments that come closer than `reach` to the segment
    /// from `a` to `b`.
    fn around(&self, a: DVec2, b: DVec2, reach: Mm, found: &mut Vec<u32>) {
        found.clear();
        self.grid
            .visit_edges_near(a, b, reach, |edge| note(edge, found));
    }

    /// Does what [`AxisIndex::nearest`] does, but among some segments only.
    pub(super) fn nearest_of(
        &self,
        segments: &[u32],
        p: DVec2,
        reach: Mm,
    ) -> Option<(DVec2, Mm)> {
        let (edge, q) = self.grid.nearest_of(segments, p, reach)?;
        Some((q, self.thickness(edge, q)))
    }

    /// Does what [`AxisIndex::nearest_of`] does, but only among segments for
    /// whose nearest points `counts` is true.
    pub(super) fn nearest_where(
        &self,
        segments: &[u32],
        p: DVec2,
        reach: Mm,
        counts: impl Fn(DVec2) -> bool,
    ) -> Option<(DVec2, Mm)> {
        let mut best: Option<(DVec2, Mm)> = None;
        for &segment in segments {
            let limit = best.map_or(reach, |(q, _)| p.distance(q));
            let found = self.nearest_of(&[segment], p, limit);
            best = found.filter(|(q, _)| counts(*q)).or(best);
        }
        best
    }

    /// The thickness at a place on a segment.
    fn thickness(&self, edge: usize, q: DVec2) -> Mm {
        let (i, k) = self.segments[edge];
        let (r, k) = (&self.axes[i as usize], k as usize);
        let (a, b) = self.grid.edge(edge);
        let along = b - a;
        let t = (q - a).dot(along) / along.length_squared();
        let t = if t.is_finite() { t } else { 0.0 };
        let next = if k + 1 == r.points.len() { 0 } else { k + 1 };
        let (ta, tb) = (r.thickness[k], r.thickness[next]);
        ta + t * (tb - ta)
    }

    /// True if no axis comes closer than `reach` to the segment.
    pub(super) fn clear(&self, a: DVec2, b: DVec2, reach: Mm) -> bool {
        self.grid.clear(a, b, reach)
    }

    /// The nearest point of an axis within `reach`, and the thickness there.
    pub(super) fn nearest(&self, p: DVec2, reach: Mm) -> Option<(DVec2, Mm)> {
        let (edge, q) = self.grid.nearest_edge(p, reach)?;
        Some((q, self.thickness(edge, q)))
    }
}

/// Adds an edge to those found, unless it is one of them.
#[inline]
fn note(edge: usize, found: &mut Vec<u32>) {
    let edge = edge as u32;
    if !found.contains(&edge) {
        found.push(edge);
    }
}

/// The rings of an offset `depth` below an area's border as lines, without
/// what runs along axes of the area.
pub(super) fn cut(
    rings: &Area,
    axes: &[Axis],
    depth: Mm,
    width: Mm,
) -> Vec<Stroke> {
    let line = |points, closed| Stroke::new(points, closed, width);
    if axes.is_empty() {
        return rings.rings.iter().map(|r| line(r.clone(), true)).collect();
    }
    let thickest = axes.iter().map(Axis::thickest).fold(0.0, f64::max);
    let reach = 0.5 * thickest - depth + 2.0 * THINNED;
    if reach <= 0.0 {
        return rings.rings.iter().map(|r| line(r.clone(), true)).collect();
    }
    let index = AxisIndex::new(axes, reach);
    // True if no axis is too near to a place. `near` are the segments that may
    // be.
    let free = |p: DVec2, near: &[u32]| {
        match index.nearest_of(near, p, reach) {
            // The border is half the place's thickness away from the axis, and
            // the ring is `depth` nearer to the axis than the border is.
            Some((q, t)) => p.distance(q) > 0.5 * t - depth + THINNED,
            None => true,
        }
    };
    let mut near = Vec::new();
    let mut lines = Vec::new();
    for ring in &rings.rings {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        // Points, and whether the line goes on from there.
        let mut all: Vec<(DVec2, bool)> = Vec::with_capacity(ring.len());
        let mut changes = false;
        let mut at_b = None;
        let mut clear = false;
        for (i, (a, b)) in edges(ring).enumerate() {
            if i.is_multiple_of(GROUP) {
                clear = index.group_clear(ring, i, reach);
            }
            if clear {
                at_b = Some(true);
                all.push((a, true));
                continue;
            }
            let count = (a.distance(b) / LOOK_STEP).ceil().clamp(1.0, 1e6);
            let place = |k: usize| match k as f64 / count {
                t if t < 1.0 => a.lerp(b, t),
                _ => b,
            };
            let count = count as usize;
            let clear = if count > STRETCH {
                index.clear(a, b, reach)
            } else {
                // On a short edge the segments that may be near are collected
                // first, because each place on it looks at all of them.
                index.beside(a, b, reach, &mut near);
                near.is_empty()
            };
            if clear {
                at_b = Some(true);
                all.push((a, true));
                continue;
            }
            let mut from = (a, at_b);
            for first in (0..count).step_by(STRETCH) {
                let last = (first + STRETCH).min(count);
                if count > STRETCH {
                    let (p, q) = (place(first), place(last));
                    index.around(p, q, reach, &mut near);
                }
                let free = |p: DVec2| free(p, &near);
                let mut on = from.1.unwrap_or_else(|| free(a));
                if first == 0 {
                    all.push((a, on));
                }
                for k in first + 1..=last {
                    let to = (place(k), free(place(k)));
                    if on != to.1 {
                        changes = true;
                        let same = |p: DVec2| free(p) == on;
                        let [p, q] = change(from.0, to.0, END, same);
                        // A line ends or begins at the point that is free.
                        all.push((if on { p } else { q }, to.1));
                    }
                    on = to.1;
                    from = (to.0, Some(on));
                }
            }
            at_b = from.1;
        }
        if !changes {
            if all.iter().any(|p| p.1) {
                lines.push(line(ring.clone(), true));
            }
            continue;
        }
        // The pieces are collected from a point on at which a line ends.
        let n = all.len();
        let end = (0..n).find(|&i| all[(i + n - 1) % n].1 && !all[i].1);
        all.rotate_left(end.unwrap_or(0));
        let mut points: Vec<DVec2> = Vec::new();
        let mut pieces = Vec::new();
        for &(p, on) in all.iter().chain(all.first()) {
            if on || !points.is_empty() {
                points.push(p);
            }
            if !on && !points.is_empty() {
                pieces.push(line(std::mem::take(&mut points), false));
            }
        }
        for piece in pieces {
            if piece.length() > SHORTEST * width {
                lines.push(piece);
            }
        }
    }
    lines
}

/// Lines that are no wider in their sharp corners than the border leaves room: where
/// a loop ends in a round tip, the border is nearer ahead than beside.
pub(super) fn within(lines: Vec<Stroke>, border: &EdgeGrid) -> Vec<Stroke> {
    /// Cosine of the turn from which on a corner is sharp.
    const SHARP: f64 = 0.7;
    let narrowed = |mut line: Stroke| {
        let n = line.points.len();
        for k in 0..line.widths.len() {
            let [before, here, after] =
                [k + n - 1, k, k + 1].map(|i| line.points[i % n]);
            let way = (here - before).normalize_or_zero();
            let on = (after - here).normalize_or_zero();
            if way.dot(on) < SHARP
                && let Some((_, q)) =
                    border.nearest_edge(here, 0.5 * line.widths[k])
            {
                line.widths[k] = 2.0 * q.distance(here);
            }
        }
        line
    };
    lines.into_iter().map(narrowed).collect()
}

/// Widens the lines beside slivers. `away` is the distance of the lines from
/// the border of the area that has the slivers as its axes.
pub(super) fn absorb(
    lines: Vec<Stroke>,
    slivers: &[Axis],
    away: Mm,
    tolerance: Mm,
) -> Vec<Stroke> {
    widen(lines, slivers, away, tolerance, SEEN, nowhere, nowhere)
}

/// What lines that nobody sees are beside, and what lies beyond slivers' ends.
pub(super) struct Inside<'a> {
    /// The area's edges.
    pub grid: &'a EdgeGrid,
    /// Depth in the area at which begins what the lines leave.
    pub depth: Mm,
    /// Distance of the lines from there.
    pub away: Mm,
}

impl Inside<'_> {
    /// Widens lines beside slivers. They become narrow again beyond the slivers'
    /// ends, where there is room for it.
    pub(super) fn absorb(
        &self,
        lines: Vec<Stroke>,
        slivers: &[Axis],
        tolerance: Mm,
    ) -> Vec<Stroke> {
        // A ball fits there that reaches as far as the line moves its inner side.
        let fits = |place: &Station, inwards: DVec2, moves: Mm| {
            let radius = 2.0 * moves;
            let centre = place.at + (self.away + radius) * inwards;
            self.grid
                .clear(centre, centre, self.depth + radius - THINNED)
        };
        let corner = |p: &Station, moves: Mm| fits(p, p.across, moves);
        let room = |p: &Station, moves: Mm| {
            fits(p, p.across.normalize_or_zero(), moves)
        };
        widen(lines, slivers, self.away, tolerance, CORNER, corner, room)
    }
}

fn widen(
    lines: Vec<Stroke>,
    slivers: &[Axis],
    away: Mm,
    tolerance: Mm,
    slope: f64,
    corner: impl Fn(&Station, Mm) -> bool,
    room: impl Fn(&Station, Mm) -> bool,
) -> Vec<Stroke> {
    if slivers.is_empty() {
        return lines;
    }
    let thickest = slivers.iter().map(Axis::thickest).fold(0.0, f64::max);
    let reach = away + 0.5 * thickest + THINNED;
    let index = AxisIndex::new(slivers, reach);
    let widen = |line: Stroke| {
        let width = line.width;
        let station = |p: DVec2, across: DVec2, _, near: &[u32]| {
            let sliver = index
                .nearest_of(near, p, reach)
                .filter(|(q, t)| p.distance(*q) <= away + 0.5 * t + THINNED);
            let left = across.normalize_or_zero();
            let inwards = |(q, t): (DVec2, Mm)| {
                0.25 * t * left.dot((q - p).normalize_or_zero())
            };
            Station {
                at: p,
                across,
                width,
                // The line moves straight inwards only: otherwise its outer side
                // would move as well.
                moves: sliver.map(inwards),
                narrows: sliver.is_some_and(|(_, t)| t < 0.0),
                passed: false,
            }
        };
        let places = stations(&line, &index, reach, station);
        widened(places, line.closed, tolerance, slope, &corner, &room)
            .unwrap_or(line)
    };
    lines.into_iter().map(widen).collect()
}

/// The places of a line, which are close together where axes come near to it; none if
/// they do so nowhere.
/// `station` gets a place, the way across the line there, the line's width, and the
/// axes' segments within `reach`.
pub(super) fn stations(
    line: &Stroke,
    index: &AxisIndex<'_>,
    reach: Mm,
    station: impl Fn(DVec2, DVec2, Mm, &[u32]) -> Station,
) -> Vec<Station> {
    let n = line.points.len();
    let segments = if line.closed { n } else { n.saturating_sub(1) };
    let is_clear = |k| index.group_clear(&line.points, k, reach);
    if (0..segments).step_by(GROUP).all(is_clear) {
        return Vec::new();
    }
    let mut places: Vec<Station> = Vec::with_capacity(n);
    let mut near = Vec::new();
    let mut clear = false;
    for k in 0..segments {
        if k.is_multiple_of(GROUP) {
            clear = is_clear(k);
        }
        let (a, b) = (line.points[k], line.points[(k + 1) % n]);
        let (v, w) = (line.width_at(k), line.width_at(k + 1));
        let along = (b - a).normalize_or_zero();
        let at_a = across(line, k);
        if clear {
            near.clear();
            places.push(station(a, at_a, v, &[]));
            continue;
        }
        let count = (a.distance(b) / WIDEN_STEP).ceil().clamp(1.0, 1e6);
        let share = |i: usize| i as f64 / count;
        let place = |i: usize| a.lerp(b, share(i));
        let count = count as usize;
        if index.clear_of(a, b, reach, count, &mut near) {
            places.push(station(a, at_a, v, &[]));
            continue;
        }
        for first in (0..count).step_by(STRETCH) {
            let last = (first + STRETCH).min(count);
            if count > STRETCH {
                index.around(place(first), place(last), reach, &mut near);
            }
            for i in first..last {
                let across = if i == 0 { at_a } else { along.perp() };
                let width = v + share(i) * (w - v);
                places.push(station(place(i), across, width, &near));
            }
        }
    }
    if let (false, [_, .., b]) = (line.closed, line.points.as_slice()) {
        let across = across(line, n - 1);
        places.push(station(*b, across, line.width_at(n - 1), &near));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(points: &[(f64, f64)], thickness: f64) -> Axis {
        Axis {
            points: points.iter().map(|&(x, y)| DVec2::new(x, y)).collect(),
            thickness: vec![thickness; points.len()],
            closed: false,
        }
    }

    fn rectangle(x: f64, y: f64) -> Area {
        let ring = [(0.0, -y), (x, -y), (x, y), (0.0, y)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area::from(ring)
    }

    #[test]
    fn rings_are_cut_where_a_axis_runs() {
        // A ring of half width 0.1 at depth 0.2 in a strip 0.6 thick.
        let rings = rectangle(20.0, 0.1);
        let half = axis(&[(0.0, 0.0), (10.0, 0.0)], 0.6);
        let lines = cut(&rings, &[half], 0.2, 0.45);
        assert_eq!(lines.len(), 1);
        assert!(!lines[0].closed);
        assert!((lines[0].length() - 20.2).abs() < 0.4);
        let whole = axis(&[(0.0, 0.0), (20.0, 0.0)], 0.6);
        assert!(cut(&rings, &[whole], 0.2, 0.45).is_empty());
        assert!(cut(&rings, &[], 0.2, 0.45)[0].closed);
    }

    #[test]
    fn slivers_are_shared_by_the_walls_beside_them() {
        let walls = rectangle(20.0, 0.3);
        let lines = cut(&walls, &[], 0.2, 0.45);
        // A sliver 0.2 thick in the middle: the walls are 0.2 from it.
        let sliver = axis(&[(5.0, 0.0), (15.0, 0.0)], 0.2);
        let lines = absorb(lines, &[sliver], 0.2, 0.005);
        let line = &lines[0];
        assert!(line.closed);
        let middle = line
            .points
            .iter()
            .zip(&line.widths)
            .filter(|(p, _)| (6.0..14.0).contains(&p.x));
        for (p, w) in middle {
            assert!((p.y.abs() - 0.25).abs() < 1e-9);
            assert!((w - 0.55).abs() < 1e-9);
        }
        let widest = line.widths.iter().copied().fold(0.0, f64::max);
        let narrowest = line.widths.iter().copied().fold(1.0, f64::min);
        assert!((widest - 0.55).abs() < 1e-9);
        assert!((narrowest - 0.45).abs() < 1e-9);
    }
}

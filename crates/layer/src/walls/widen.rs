//! Lines that become wider or narrower on their way, to one side only.
//!
//! ```text
//!   ━━━━━━━━━━━━━━━━━━━━━━   The outer side of a wall stays where it is: the
//!   ┄┄┄┄┄┄┄╮      ╭┄┄┄┄┄┄┄   centre line moves inwards by half of what the
//!           ╰┄┄┄┄╯           wall is wider.
//!   ━━━━╮            ╭━━━━
//!        ╲━━━━━━━━━━╱
//! ```
//!
//! In: places along a line, and how far each is to move. Out: the stroke.
//!
//! Guarantees: the width changes by no more than a slope along the way, so that
//! pieces of constant width can follow it; the line does not fold over.

use super::medial_axis::Axis;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;

/// Greatest change of a line's width along its way, if the line may be seen. At 0.25 the
/// edge of a gyroid's walls is off by 16.5 µm (99 % of it), at 0.16 by 15.0, and at
/// 0.12 by 13.4, but more than half as much again of the sheet stays uncovered.
pub(super) const SEEN: f64 = 0.16;
/// Greatest change of a line's width along its way where it follows a place that
/// changes its thickness. Around a corner of a strip the way is so short that a gentler
/// one would leave a pocket open.
pub(super) const CORNER: f64 = 0.5;
/// Greatest change of a line's width along its way beyond the places that it moves for,
/// where it becomes narrow again. The line turns
/// by 11°, which a printer drives through at 45 mm/s (with Klipper's usual 5 mm/s at
/// right angles). At 1.0 a star's inner walls take 8 % longer; at 0.3, 0.24 % of the tops
/// of combs are filled below 70 %.
const AWAY: f64 = 0.4;
/// Greatest change of a line's width along its way, if nobody sees the line.
pub(super) const HIDDEN: f64 = 1.0;
/// Gaps between moving places that are shorter than this do not count, mm.
const GAP: Mm = 0.6;
/// Greatest distance of the ends of a gap around the corner of a strip, in widths of the
/// line. What two walls of 0.45 mm share around a right angle ends up to 0.9 mm apart on
/// the outer one.
const CORNER_GAP: f64 = 2.0;
/// A gap is no longer than this many times the distance of its ends, as around a
/// corner.
const ROUND: f64 = 2.0;
/// Greatest distance by which a corner moves, as a multiple of the distance by
/// which its sides move.
const MITRE: f64 = 2.0;
/// Least share of its length by which a piece of the line has to lead ahead
/// when both its ends have moved.
const AHEAD: f64 = 0.4;

/// Share of a move that is left after each round in which places would pass
/// each other.
const LESS: f64 = 0.7;
/// Moves smaller than this do not count, mm.
const LEAST: Mm = 0.003;

/// A place on a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    pub at: DVec2,
    /// Across the line, to its left ([`across`]).
    pub across: DVec2,
    /// The line's own width there.
    pub width: Mm,
    /// How far the line moves to its left; nothing where it stays.
    pub moves: Option<Mm>,
    /// True if the line becomes narrower here, not wider.
    pub narrows: bool,
    /// True if the line goes past here when it moves.
    pub passed: bool,
}

impl Station {
    /// True if the line does not turn here.
    fn is_straight(&self) -> bool {
        self.across.length_squared() < 1.0 + 1e-6
    }

    fn moved(&self) -> DVec2 {
        self.at + self.across * self.moves.unwrap_or(0.0)
    }

    /// The line's width after the move.
    fn widened(&self) -> Mm {
        let more = 2.0 * self.moves.map_or(0.0, f64::abs);
        if self.narrows {
            self.width - more
        } else {
            self.width + more
        }
    }
}

/// The vector across a line to its left at one of its points. If a corner moves
/// by this vector, both of its sides move by 1 mm. Sharp corners move no
/// farther than [`MITRE`].
pub(super) fn across(line: &Stroke, k: usize) -> DVec2 {
    let n = line.points.len();
    let way = |from: usize| {
        let (a, b) = (line.points[from % n], line.points[(from + 1) % n]);
        (b - a).normalize_or_zero()
    };
    let (before, after) = if line.closed {
        (way(k + n - 1), way(k))
    } else {
        (way(k.saturating_sub(1)), way(k.min(n.saturating_sub(2))))
    };
    let along = before + after;
    let cos = 0.5 * along.length();
    along.perp().normalize_or_zero() / cos.max(1.0 / MITRE)
}

/// The line with all places moved, thinned to `tolerance`; nothing if no place
/// moves. `slope` is the greatest change of its width along the way. Where there is
/// `room` for a place to move by so much, the width changes beyond the places that
/// move, and not among them. Where there is room for it at a `corner`, the line is as wide
/// there as beside it.
pub(super) fn widened(
    mut places: Vec<Station>,
    closed: bool,
    tolerance: Mm,
    slope: f64,
    corner: impl Fn(&Station, Mm) -> bool,
    room: impl Fn(&Station, Mm) -> bool,
) -> Option<Stroke> {
    if places.iter().all(|p| p.moves.is_none()) {
        return None;
    }
    bridge_gaps(&mut places, closed, &corner);
    places.retain(|place| !place.passed);
    lead_on(&mut places, closed, 0.5 * slope.min(AWAY), room);
    unfold(&mut places, closed);
    taper(&mut places, closed, slope);
    // The line is thinned as an axis is, with its width as a third coordinate.
    let mut axis = Axis {
        points: places.iter().map(Station::moved).collect(),
        thickness: places.iter().map(Station::widened).collect(),
        closed,
    };
    if closed {
        // Thinning keeps both ends: with the first point there again, the
        // closing segment is thinned as well.
        axis.points.extend(axis.points.first().copied());
        axis.thickness.extend(axis.thickness.first().copied());
    }
    let mut thin = axis.thinned(tolerance);
    if closed {
        thin.points.pop();
        thin.thickness.pop();
        // Only a point is left of a ring that is smaller than the tolerance.
        if thin.points.len() < 2 {
            return None;
        }
    }
    Some(thin.stroke(0.0))
}

/// Moves the places in a short gap between two places that move to the same
/// side: in such a gap the line has no room to come back. A line that leads out of a
/// neck, around a hole, and back to beside where it began has that room. Around the
/// corner of a strip the gap is longer: its corners have `room`, and its other places
/// are left out, as they lie on straight lines between those.
fn bridge_gaps(
    places: &mut [Station],
    closed: bool,
    room: impl Fn(&Station, Mm) -> bool,
) {
    let n = places.len();
    let Some(first) = places.iter().position(|p| p.moves.is_some()) else {
        return;
    };
    let stop = if closed { first + n + 1 } else { n };
    let mut last = first;
    let mut way = 0.0;
    for k in first + 1..stop {
        let (before, place) = (places[(k - 1) % n], places[k % n]);
        way += before.at.distance(place.at);
        if place.moves.is_some() {
            let from = std::mem::replace(&mut last, k);
            bridge(places, from, k, std::mem::take(&mut way), &room);
        }
    }
}

/// Moves the places between two that move, a `way` apart along the line, if they are near
/// to each other. Numbers of places go on around the line.
fn bridge(
    places: &mut [Station],
    from: usize,
    to: usize,
    way: Mm,
    room: impl Fn(&Station, Mm) -> bool,
) {
    let n = places.len();
    let (a, b) = (places[from % n], places[to % n]);
    let apart = a.at.distance(b.at);
    let (Some(v), Some(w)) = (a.moves, b.moves) else {
        return;
    };
    if v * w <= 0.0 || a.narrows != b.narrows || way >= ROUND * apart.max(GAP) {
        return;
    }
    let moves = |k: usize| {
        let t = (k - from) as f64 / (to - from) as f64;
        v + t * (w - v)
    };
    // A corner that moves passes the places on the straight lines beside it.
    let corners = || (from + 1..to).filter(|k| !places[k % n].is_straight());
    // Around a corner to the right nothing is left open.
    let turns_left = |k: usize| {
        let [a, b, c] = [k - 1, k, k + 1].map(|i| places[i % n].at);
        (b - a).perp_dot(c - b) > 0.0
    };
    let has_room = |k| turns_left(k) && room(&places[k % n], moves(k));
    let all_have_room = || corners().all(has_room);
    let is_near =
        apart < CORNER_GAP * a.width && !a.narrows && v.min(w) > LEAST;
    let around_corner =
        || is_near && corners().next().is_some() && all_have_room();
    // Where a closed line begins, no gap is bridged but one around a corner.
    let is_short = apart < GAP && to < n;
    if !is_short && !around_corner() {
        return;
    }
    for k in from + 1..to {
        places[k % n].moves = Some(moves(k));
        places[k % n].narrows = a.narrows;
        places[k % n].passed = !is_short && places[k % n].is_straight();
    }
}

/// Moves places beyond those that move to the left, each by less than the one before
/// it: `rate` times the way. Places without `room` stay.
fn lead_on(
    places: &mut Vec<Station>,
    closed: bool,
    rate: f64,
    room: impl Fn(&Station, Mm) -> bool,
) {
    for _ in 0..2 {
        places.reverse();
        let n = places.len();
        let mut ends: Vec<(usize, Station)> = Vec::new();
        // Around a closed line once more, as its first places may follow its last
        // ones.
        let rounds = if closed { 2 * n } else { n };
        for k in 1..rounds {
            let (a, b) = (places[(k - 1) % n], places[k % n]);
            let from = a.moves.filter(|m| !a.narrows && *m > LEAST);
            let Some(from) = from.filter(|_| b.moves.is_none()) else {
                continue;
            };
            let way = a.at.distance(b.at);
            let left = from - rate * way;
            if left > LEAST {
                let goes_on = room(&b, left);
                places[k % n].moves = goes_on.then_some(left);
            } else if k + n >= rounds {
                ends.push((k % n, between(&a, &b, from / (rate * way))));
            }
        }
        ends.sort_by_key(|end| std::cmp::Reverse(end.0));
        for (k, end) in ends {
            // What closes a line lies behind its last place.
            places.insert(if k == 0 { places.len() } else { k }, end);
        }
    }
}

/// No room anywhere.
pub(super) fn nowhere(_: &Station, _: Mm) -> bool {
    false
}

/// A place between two others, at a share of the way, that stays where it is.
fn between(a: &Station, b: &Station, share: f64) -> Station {
    let t = share.min(1.0);
    Station {
        at: a.at.lerp(b.at, t),
        across: a.across.lerp(b.across, t),
        width: a.width + t * (b.width - a.width),
        moves: Some(0.0),
        narrows: false,
        passed: false,
    }
}

/// Reduces the moves of neighbouring places that would pass each other, as
/// around a corner, where places move towards each other.
fn unfold(places: &mut [Station], closed: bool) {
    let n = places.len();
    let ways = if closed { n } else { n.saturating_sub(1) };
    let mut folded = true;
    while folded {
        folded = false;
        for i in 0..ways {
            let (a, b) = (places[i], places[(i + 1) % n]);
            if a.moves.is_none() && b.moves.is_none() {
                continue;
            }
            let way = b.at - a.at;
            let ahead = (b.moved() - a.moved()).dot(way);
            if ahead < AHEAD * way.length_squared() {
                for place in [i, (i + 1) % n] {
                    let moves = places[place].moves.map(|m| LESS * m);
                    places[place].moves = moves.filter(|m| m.abs() > LEAST);
                }
                folded = true;
            }
        }
    }
}

/// Lets the width change no faster than pieces of constant width can follow.
fn taper(places: &mut [Station], closed: bool, slope: f64) {
    let n = places.len();
    let ways = if closed { 2 * n } else { n };
    let mut limit = |i: usize, j: usize| {
        let (a, b) = (places[i], places[j]);
        let from = a.moves.map_or(0.0, f64::abs);
        // In a corner, places that move come nearer to each other.
        let way = (b.at - a.at).normalize_or_zero();
        let ahead = (b.moved() - a.moved()).dot(way).max(0.0);
        let most = from + 0.5 * slope * ahead;
        if let Some(moves) = &mut places[j].moves {
            *moves = moves.clamp(-most, most);
        }
    };
    for k in 1..ways {
        limit((k - 1) % n, k % n);
    }
    for k in (1..ways).rev() {
        limit(k % n, (k - 1) % n);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A place each 0.1 mm along a line to the right.
    fn row(moves: impl Fn(usize) -> Option<Mm>) -> Vec<Station> {
        (0..100)
            .map(|i| Station {
                at: DVec2::X * (0.1 * i as f64),
                across: DVec2::Y,
                width: 0.45,
                moves: moves(i),
                narrows: false,
                passed: false,
            })
            .collect()
    }

    /// How far the right side is from where it was, and the steepest ramp.
    fn measured(stroke: &Stroke) -> (Mm, f64) {
        let n = stroke.points.len();
        let off = |i: usize| {
            let side = stroke.points[i].y - 0.5 * stroke.width_at(i);
            (side + 0.225).abs()
        };
        let slope = |i: usize| {
            let way = stroke.points[i].distance(stroke.points[i + 1]);
            (stroke.width_at(i + 1) - stroke.width_at(i)).abs() / way
        };
        (
            (0..n).map(off).fold(0.0, f64::max),
            (0..n - 1).map(slope).fold(0.0, f64::max),
        )
    }

    #[test]
    fn the_outer_side_stays_and_the_width_has_no_steps() {
        let places = row(|i| (40..60).contains(&i).then_some(0.05));
        let stroke =
            widened(places, false, 1e-6, SEEN, nowhere, nowhere).unwrap();
        let (off, slope) = measured(&stroke);
        assert!(off < 1e-5 && slope < 1.01 * SEEN, "{off} {slope}");
        let widest = stroke.widths.iter().copied().fold(0.0, f64::max);
        assert!((widest - 0.55).abs() < 1e-9);
    }

    #[test]
    fn a_line_becomes_narrow_beyond_what_moves_if_there_is_room() {
        let places = || row(|i| (40..60).contains(&i).then_some(0.05));
        let at = |line: &Stroke, x: f64| {
            let all = line.segments().enumerate();
            let mut on = all.filter(|(_, (a, b))| a.x <= x && x <= b.x);
            let (k, (a, b)) = on.next().unwrap();
            let t = (x - a.x) / (b.x - a.x);
            let [v, w] = [k, k + 1].map(|i| line.width_at(i));
            v + t * (w - v)
        };
        let widths = |room: bool| {
            let stroke =
                widened(places(), false, 1e-6, CORNER, nowhere, |_, _| room)
                    .unwrap();
            let (off, slope) = measured(&stroke);
            assert!(off < 1e-5 && slope < 1.01 * CORNER, "{off} {slope}");
            [3.5, 3.9, 4.0, 5.9, 6.0, 6.5].map(|x| at(&stroke, x))
        };
        let near = |is: [f64; 6], meant: [f64; 6]| {
            let off = is.iter().zip(meant).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-4, "{is:?}");
        };
        // The width changes by 0.4 mm in 1 mm of the way.
        near(widths(true), [0.45, 0.51, 0.55, 0.55, 0.51, 0.45]);
        near(widths(false), [0.45, 0.45, 0.5, 0.5, 0.45, 0.45]);
        // What moves lies about the place where a closed line begins.
        let mut ring = places();
        ring.rotate_left(50);
        for (k, place) in ring.iter_mut().enumerate() {
            place.at = 2.0 * DVec2::from_angle(0.02 * PI * k as f64);
            place.across = -place.at.normalize();
        }
        let ring =
            widened(ring, true, 1e-6, CORNER, nowhere, |_, _| true).unwrap();
        let wide = (0..ring.points.len()).filter(|&i| ring.width_at(i) > 0.549);
        let wide: Vec<f64> = wide.map(|i| ring.points[i].to_angle()).collect();
        let [low, high] =
            [f64::min, f64::max].map(|f| wide.iter().copied().fold(0.0, f));
        assert!((low + high).abs() < 0.07 && high > 0.55, "{low} {high}");
    }

    #[test]
    fn short_gaps_are_none() {
        let gap = |from: usize, to: usize| {
            let moves = move |i| (!(from..to).contains(&i)).then_some(0.05);
            let stroke =
                widened(row(moves), false, 1e-6, SEEN, nowhere, nowhere)
                    .unwrap();
            let n = stroke.points.len();
            (0..n).map(|i| stroke.width_at(i)).fold(1.0, f64::min)
        };
        assert!((gap(50, 53) - 0.55).abs() < 1e-9);
        assert!((gap(50, 70) - 0.45).abs() < 1e-9);
    }

    #[test]
    fn a_way_around_a_hole_is_no_gap() {
        // A ring that leaves a neck at one place and comes back 0.3 mm beside it.
        let places: Vec<Station> = (0..=100)
            .map(|i| {
                let angle = 0.02 * PI * f64::from(i) * 0.99;
                Station {
                    at: 5.0 * DVec2::from_angle(angle),
                    across: -DVec2::from_angle(angle),
                    width: 0.45,
                    moves: [0, 100].contains(&i).then_some(0.05),
                    narrows: true,
                    passed: false,
                }
            })
            .collect();
        let stroke =
            widened(places, false, 1e-6, SEEN, nowhere, nowhere).unwrap();
        assert!(stroke.length() > 30.0);
        let far: Vec<f64> = (0..stroke.points.len())
            .filter(|&i| stroke.points[i].x < 0.0)
            .map(|i| stroke.width_at(i))
            .collect();
        assert!(far.len() > 4);
        assert!(far.iter().all(|w| (w - 0.45).abs() < 1e-9), "{far:?}");
    }

    #[test]
    fn lines_do_not_fold_over_in_a_corner() {
        // In a turn to the left, the places beside it move towards each other.
        let mut places = row(|_| Some(0.1));
        for (i, place) in places[50..].iter_mut().enumerate() {
            place.at = DVec2::new(5.0, 0.1 * i as f64);
            place.across = -DVec2::X;
        }
        places[50].across = DVec2::new(-1.0, 1.0);
        let stroke =
            widened(places, false, 1e-6, SEEN, nowhere, nowhere).unwrap();
        // It leads to the right and then up, on ramps to the corner and back.
        let least = -0.5 * SEEN - 1e-9;
        for (a, b) in stroke.segments() {
            let way = (b - a).normalize();
            assert!(way.x > least && way.y > least, "{a} {b}");
        }
        let ends = [stroke.width_at(0), stroke.width_at(usize::MAX - 1)];
        assert!(ends[0] > 0.6, "{ends:?}");
    }

    #[test]
    fn both_sides_of_a_corner_move_alike() {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)].map(DVec2::from);
        let line = Stroke::new(points.to_vec(), false, 0.45);
        let all = [0, 1, 2].map(|k| across(&line, k));
        let meant = [DVec2::Y, DVec2::new(-1.0, 1.0), DVec2::NEG_X];
        for (is, meant) in all.into_iter().zip(meant) {
            assert!(is.distance(meant) < 1e-9, "{is} {meant}");
        }
        let back = [(0.0, 0.0), (1.0, 0.0), (0.0, 0.01)].map(DVec2::from);
        let sharp = Stroke::new(back.to_vec(), true, 0.45);
        assert!(across(&sharp, 1).length() < MITRE + 1e-9);
        let ring = [0.0, 1.0, 2.0, 3.0]
            .map(|k| DVec2::from_angle(0.5 * std::f64::consts::PI * k));
        let ring = Stroke::new(ring.to_vec(), true, 0.45);
        assert!((across(&ring, 0) + 2.0_f64.sqrt() * DVec2::X).length() < 1e-9);
    }

    #[test]
    fn lines_that_do_not_move_stay_as_they_are() {
        assert_eq!(
            widened(row(|_| None), false, 1e-6, SEEN, nowhere, nowhere),
            None
        );
        assert_eq!(
            widened(Vec::new(), true, 1e-6, SEEN, nowhere, nowhere),
            None
        );
    }
}

//! Skin over nothing: where lines can hang from support to support, and in
//! which direction.
//!
//! ```text
//!   ▒▒▒▒┌────────────┐▒▒▒▒   ▒ what the layer below holds; lines run across
//!   ▒▒══│════════════│══▒▒   the gap the way that makes them shortest, and
//!   ▒▒══│════════════│══▒▒   reach onto both sides by `bridge_anchor`
//!   ▒▒▒▒└────────────┘▒▒▒▒
//! ```
//!
//! In: an area to be filled, and the layer below. Out: the parts of the area
//! that are bridges, each with the way its lines run. An area that hangs
//! in the air without two sides to hang from (a balcony) is no bridge: it is left,
//! and printed as ordinary skin. Where no supports are to hold what hangs:
//! - a narrow gap between a rim that is held and a hole, as in the ceiling of a
//!   counterbore, or around a stem, is laid in rings;
//! - across wider gaps lines may hang although many of them end at a hole, if some
//!   reach from side to side. The others are laid beside those ([`held_first`]);
//! - wide gaps around holes or a stem that no lines cross are laid in rings as well.
//!
//! The directions tried are a fan of angles and those of the gap's longer
//! sides. The one with the shortest spans wins, where an end that nothing holds
//! makes a span several times as long. Near a corner any slanting line is
//! short, so the shortest lines must not decide: a direction is judged by the
//! span that three quarters of the lines' length stay below.

use super::direction::{Way, across, best, common, fan, rows};
use super::gaps::{Gap, Span, spans};
use super::sweep;
use crate::cover::neighbour::Neighbour;
use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::bead::Stroke;
use isoslice_planar::clip::{difference, intersection};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::hatch::{Lines, Segment, hatch};
use isoslice_planar::nest::Nest;
use isoslice_planar::opening::{is_wider, opened};
use isoslice_planar::{Area, BoxTree, Ring, edges, point_beside, signed_area};
use std::collections::BTreeSet;

/// A part of a fill whose lines hang between supports.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bridge {
    /// The area of the bridge, with the strips on both sides that its lines
    /// reach onto.
    pub area: Area,
    /// How its lines run.
    pub way: Way,
}

/// The lines of bridges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hanging {
    /// Width of the lines.
    pub width: Mm,
    /// How far lines reach onto what holds them.
    pub anchor: Mm,
    /// Width up to which a ring-shaped gap is laid in rings, a spacing of the lines
    /// apart; none if what is held badly is left to supports, or beads are too thin to
    /// touch.
    pub rings: Option<(Mm, Mm)>,
}

/// Tolerance of the offsets. They are borders between lines inside the part,
/// which nobody sees.
const TOLERANCE: Mm = 0.02;
/// Greatest number of directions of sides that are tried.
const SIDES: usize = 16;
/// Number of lines looked at for each direction.
const ROWS: f64 = 24.0;
/// What holds the end of a line is no farther from it than so many widths.
pub const ANCHOR: f64 = 2.0;
/// Share of the lines' length that must be held at both ends.
const HELD: f64 = 0.6;
/// The same where what hangs has no supports. Over a channel, so much reaches across beside
/// holes that take four fifths of its length.
const PARTLY_HELD: f64 = 0.2;
/// Greatest share of a border that hangs where the rest is held, or is held where the
/// rest hangs: so much has a channel with open ends that is four times as long as wide.
const BUT_FOR: f64 = 0.2;

/// The bridges of an area over a layer, and what they leave of the area.
pub(super) fn bridges(
    area: &Area,
    below: &Neighbour<'_>,
    hanging: Hanging,
) -> (Vec<Bridge>, Area) {
    let Hanging { width, anchor, .. } = hanging;
    let below = below.near(area);
    // A gap no wider than a bead is bridged by any bead: no direction is
    // needed.
    let gaps = opened(&difference(area, &below), 0.5 * width, TOLERANCE);
    if gaps.is_empty() {
        return (Vec::new(), area.clone());
    }
    let grid = EdgeGrid::new(&below, width);
    let reach = anchor.max(0.5 * width);
    let gaps = gaps.islands().into_iter().map(|gap| {
        let best = best_way(&gap, &grid, hanging);
        let reach = match (best, hanging.rings) {
            // One ring lies on what holds the others.
            (Some((_, Way::Around)), Some((_, spacing))) => spacing,
            _ => reach,
        };
        Gap::new(gap, best, reach, TOLERANCE)
    });
    let gaps: Vec<Gap> = gaps.collect();
    let span = |gap: &Area, angle| {
        let (span, held) = hang(gap, &grid, angle, width)?;
        (held >= HELD).then_some(span)
    };
    let spans = spans(&gaps, span, reach, TOLERANCE);
    // Several pieces of a bridge are clipped each by itself.
    let (mut owners, mut takers) = (Vec::new(), Vec::new());
    for (i, span) in spans.iter().enumerate() {
        let pieces = span.reached.islands();
        owners.extend(std::iter::repeat_n(i, pieces.len()));
        takers.extend(pieces);
    }
    let bridge = |span: Span| Bridge {
        area: Area::EMPTY,
        way: span.way,
    };
    let mut found: Vec<Bridge> = spans.into_iter().map(bridge).collect();
    let (parts, left) = shared(area, &takers);
    for (i, part) in owners.into_iter().zip(parts) {
        found[i].area.rings.extend(part.rings);
    }
    found.retain(|b| !b.area.is_empty());
    (found, left)
}

/// What each of `takers` takes of an area, and what all of them leave. Where
/// several takers would take one place, the first one does.
pub(super) fn shared(area: &Area, takers: &[Area]) -> (Vec<Area>, Area) {
    let mut parts = vec![Area::EMPTY; takers.len()];
    // Many places are clipped at a time: one by one, each would be clipped with
    // the whole area.
    let mut left = area.clone();
    for set in apart(takers) {
        let rings = set.iter().flat_map(|&i| takers[i].rings.iter().cloned());
        let reached: Area = rings.collect();
        let nest = Nest::new(set.iter().filter_map(|&i| outer(&takers[i])));
        for part in intersection(&left, &reached).islands() {
            let p = part.rings.first().and_then(|r| point_beside(r));
            if let Some(k) = p.and_then(|p| nest.around(p)) {
                parts[set[k]].rings.extend(part.rings);
            }
        }
        left = difference(&left, &reached);
    }
    (parts, left)
}

/// Sorts areas into sets in which no two boxes meet, and returns their numbers.
/// There are few sets if few boxes meet at one place. Empty areas are in no
/// set.
fn apart(areas: &[Area]) -> Vec<Vec<usize>> {
    let filled = (0..areas.len()).filter(|&i| !areas[i].is_empty());
    let boxes: Vec<_> = filled.map(|i| (i, areas[i].bounds())).collect();
    let tree = BoxTree::new(boxes.iter().copied());
    let mut set_of: Vec<Option<usize>> = vec![None; areas.len()];
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for (own, bounds) in boxes {
        let beside = tree.meeting(bounds);
        let taken: BTreeSet<usize> = beside.filter_map(|b| set_of[b]).collect();
        let set = (0..).find(|k| !taken.contains(k)).unwrap_or(sets.len());
        if set == sets.len() {
            sets.push(Vec::new());
        }
        set_of[own] = Some(set);
        sets[set].push(own);
    }
    sets
}

/// The ring around a connected area.
fn outer(area: &Area) -> Option<&Ring> {
    let content = |r: &&Ring| signed_area(r);
    area.rings
        .iter()
        .max_by(|a, b| content(a).total_cmp(&content(b)))
}

/// The best direction of lines across a gap, if they can hang there.
pub fn direction(gap: &Area, below: &EdgeGrid, width: Mm) -> Option<Degrees> {
    best_direction(&directions(gap, below, width)).map(|best| best.1)
}

/// How lines run best over a gap, if they can hang there. Where most of them are held, the
/// span that is common among them comes with it, else a number that means nothing: such a
/// gap has a bridge of its own.
fn best_way(
    gap: &Area,
    below: &EdgeGrid,
    hanging: Hanging,
) -> Option<(Mm, Way)> {
    let directions = directions(gap, below, hanging.width);
    let across = best_direction(&directions)
        .map(|(span, angle)| (span, Way::Across(angle)));
    across.or_else(|| {
        let (narrow, _) = hanging.rings?;
        let borders = borders(gap, below, hanging.width);
        let around = Some((0.0, Way::Around));
        if borders.is_some() && !is_wider(gap, narrow, TOLERANCE) {
            return around;
        }
        // Most lines are not held: their spans tell nothing.
        let partly = directions.iter().filter(|d| d.1 >= PARTLY_HELD);
        best(partly.map(|&(_, held, angle)| (1.0 - held, angle)))
            .map(|(_, angle)| (0.0, Way::Across(angle)))
            .or_else(|| {
                around.filter(|_| borders.is_some_and(|b| b.are_even(below)))
            })
    })
}

/// The borders of a gap that lies around holes that hang, or around what holds it.
struct Borders<'a> {
    held: Vec<&'a Ring>,
    free: Vec<&'a Ring>,
}

/// The borders of a gap; none unless each of them is held or hangs, and some do each.
fn borders<'a>(
    gap: &'a Area,
    below: &EdgeGrid,
    width: Mm,
) -> Option<Borders<'a>> {
    let mut borders = Borders {
        held: Vec::new(),
        free: Vec::new(),
    };
    for ring in &gap.rings {
        let (mut held, mut length) = (0.0, 0.0);
        for (a, b) in edges(ring) {
            let own = a.distance(b);
            let out = -(b - a).perp() / own.max(f64::MIN_POSITIVE);
            length += own;
            if holds(below, a.midpoint(b), out, width) {
                held += own;
            }
        }
        if held >= (1.0 - BUT_FOR) * length {
            borders.held.push(ring);
        } else if held <= BUT_FOR * length {
            borders.free.push(ring);
        } else {
            return None;
        }
    }
    let both = !borders.held.is_empty() && !borders.free.is_empty();
    both.then_some(borders)
}

impl Borders<'_> {
    /// True unless the gap hangs around stems, and what hangs is not about as far from
    /// one of them everywhere: rings would end in the air.
    fn are_even(&self, below: &EdgeGrid) -> bool {
        /// Greatest ratio of the distances.
        const UNEVEN: f64 = 2.0;
        let is_stem = |ring: &&&Ring| signed_area(ring) < 0.0;
        match (self.held.iter().filter(is_stem).count(), self.held.len()) {
            (0, _) => true,
            (1, 1) => {
                let free = || self.free.iter().flat_map(|ring| ring.iter());
                let far = |p: &DVec2| Some(below.nearest(*p)?.1.distance(*p));
                let least =
                    free().filter_map(far).fold(f64::INFINITY, f64::min);
                let most = free().filter_map(far).fold(0.0, f64::max);
                most <= UNEVEN * least
            }
            _ => false,
        }
    }
}

/// For each direction that may suit a gap: the span that is common among lines in it,
/// the share of their length that is held at both ends, and the direction.
fn directions(
    gap: &Area,
    below: &EdgeGrid,
    width: Mm,
) -> Vec<(Mm, f64, Degrees)> {
    let mut sides: Vec<(Mm, Degrees)> = gap
        .rings
        .iter()
        .flat_map(|r| edges(r))
        .map(|(a, b)| {
            let d = b - a;
            (d.length(), d.to_angle().to_degrees().rem_euclid(180.0))
        })
        .collect();
    sides.sort_by(|a, b| b.0.total_cmp(&a.0));
    let longest = sides.first().map_or(0.0, |s| s.0);
    sides.retain(|s| s.0 > 0.2 * longest && s.0 > width);
    sides.truncate(SIDES);
    let sides = sides.iter().map(|s| s.1);
    // The sides come first: of equally good directions the first one wins.
    let tried = sides.clone().chain(sides.map(across)).chain(fan());
    tried
        .filter_map(|angle| {
            let (span, held) = hang(gap, below, angle, width)?;
            Some((span, held, angle))
        })
        .collect()
}

/// The best direction in which lines can hang, after their common span.
fn best_direction(directions: &[(Mm, f64, Degrees)]) -> Option<(Mm, Degrees)> {
    let held = directions.iter().filter(|(_, held, _)| *held >= HELD);
    best(held.map(|&(span, _, angle)| (span, angle)))
}

/// For lines in a direction: the span that is common among them, and the share
/// of their length that is held at both ends.
fn hang(
    gap: &Area,
    below: &EdgeGrid,
    angle: Degrees,
    width: Mm,
) -> Option<(f64, f64)> {
    let lines = rows(gap, angle, ROWS, width);
    let mut spans: Vec<(Mm, Mm)> = Vec::new();
    let (mut held, mut total) = (0.0, 0.0);
    for (line, ends) in hung(gap, below, lines, width) {
        let length = line.from.distance(line.to);
        let span = match ends.iter().filter(|e| **e).count() {
            2 => {
                held += length;
                length
            }
            1 => 4.0 * length,
            _ => 10.0 * length,
        };
        spans.push((span, length));
        total += length;
    }
    common(spans).map(|span| (span, held / total))
}

/// Lines across a gap, and for each one whether `below` holds its ends.
pub fn hung(
    gap: &Area,
    below: &EdgeGrid,
    lines: Lines,
    width: Mm,
) -> Vec<(Segment, [bool; 2])> {
    let along = DVec2::from_angle(lines.angle.to_radians());
    let holds = |p, out| holds(below, p, out, width);
    let ends = |s: Segment| [holds(s.from, -along), holds(s.to, along)];
    let all = hatch(gap, lines, 0.1).into_iter();
    all.map(|s| (s, ends(s))).collect()
}

/// True if `below` holds what ends at a place, or a little farther `out`: a wall may
/// stand between.
fn holds(below: &EdgeGrid, p: DVec2, out: DVec2, width: Mm) -> bool {
    let steps = [0.1, 0.5 * width, width, 1.5 * width, ANCHOR * width];
    steps.iter().any(|d| below.contains(p + out * *d))
}

/// For each line of a bridge those that it waits for, if it has an end that nothing
/// holds: it is laid beside one that is there. Empty if most lines are held.
pub(super) fn held_first(
    lines: &[(i64, Stroke)],
    angle: Degrees,
    below: &EdgeGrid,
    width: Mm,
) -> Vec<Vec<u32>> {
    let is_held = |line: &Stroke| {
        let ends = line.points.first().zip(line.points.last());
        ends.is_some_and(|(&a, &b)| {
            let out = (b - a).normalize_or_zero();
            let holds =
                |p, out| below.contains(p) || holds(below, p, out, width);
            holds(a, -out) && holds(b, out)
        })
    };
    let held: Vec<bool> = lines.iter().map(|(_, l)| is_held(l)).collect();
    let (mut share, mut length) = (0.0, 0.0);
    for ((_, line), held) in lines.iter().zip(&held) {
        length += line.length();
        share += if *held { line.length() } else { 0.0 };
    }
    if share >= HELD * length {
        return Vec::new();
    }
    sweep::outwards(&sweep::after(lines, angle, width), &held)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::shapes::{disc, moved, rect, turned};

    const ANCHORED: Mm = 1.5;

    fn bridges(area: &Area, below: &Area) -> (Vec<Bridge>, Area) {
        hanging(area, below, Some((2.0, 0.4)))
    }

    fn hanging(
        area: &Area,
        below: &Area,
        rings: Option<(Mm, Mm)>,
    ) -> (Vec<Bridge>, Area) {
        let hanging = Hanging {
            width: 0.45,
            anchor: ANCHORED,
            rings,
        };
        super::bridges(area, &Neighbour::new(below), hanging)
    }

    fn angle(bridge: &Bridge) -> Degrees {
        match bridge.way {
            Way::Across(angle) => angle,
            Way::Around => f64::NAN,
        }
    }

    fn joined(parts: &[Area]) -> Area {
        let rings = parts.iter().flat_map(|a| a.rings.clone());
        rings.collect()
    }

    #[test]
    fn lines_run_from_pillar_to_pillar() {
        // The gap is wider than it is long. Its free sides must not attract the
        // lines.
        let deck = rect(0.0, 0.0, 30.0, 40.0);
        let pillars = joined(&[
            rect(-1.0, -1.0, 10.0, 41.0),
            rect(20.0, -1.0, 31.0, 41.0),
        ]);
        let (found, rest) = bridges(&deck, &pillars);
        let all = found[0].area.content() + rest.content();
        assert!((all - deck.content()).abs() < 1e-3, "{all}");
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].way, Way::Across(0.0));
        let reach = 10.0 + 2.0 * ANCHORED;
        let content = found[0].area.content();
        assert!((content - 40.0 * reach).abs() < 1.0, "{content}");
        // The direction turns by 20° when everything else does.
        let turned = |a: &Area| turned(a, 20.0_f64.to_radians());
        let (found, _) = bridges(&turned(&deck), &turned(&pillars));
        assert!((angle(&found[0]) - 20.0).abs() < 0.1);
    }

    #[test]
    fn a_closed_hole_is_crossed_the_short_way() {
        let roof = rect(0.0, 0.0, 40.0, 30.0);
        let hole = rect(10.0, 10.0, 30.0, 16.0);
        let below = difference(&rect(-1.0, -1.0, 41.0, 31.0), &hole);
        let (found, _) = bridges(&roof, &below);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].way, Way::Across(90.0));
    }

    #[test]
    fn a_balcony_is_no_bridge() {
        let deck = rect(0.0, 0.0, 30.0, 10.0);
        let house = rect(-1.0, -1.0, 20.0, 11.0);
        assert!(bridges(&deck, &house).0.is_empty());
        assert!(bridges(&deck, &deck).0.is_empty());
    }

    /// What hangs around a stem, and in the ceiling of a counterbore around its bore.
    #[test]
    fn what_hangs_around_something_is_laid_in_rings() {
        let disc = |r: f64| disc(r, 200);
        let around = |outer: f64, inner: f64| {
            let inner = disc(inner);
            let below =
                difference(&rect(-20.0, -20.0, 20.0, 20.0), &disc(outer));
            (difference(&disc(outer + 5.0), &inner), below)
        };
        // The bore leaves 1.6 mm, and 0.3 mm, which any bead bridges.
        let (ceiling, below) = around(7.0, 5.4);
        let (found, rest) = bridges(&ceiling, &below);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].way, Way::Around);
        let ring = |outer: f64, inner: f64| {
            std::f64::consts::PI * (outer * outer - inner * inner)
        };
        let content = found[0].area.content();
        assert!((content / ring(7.4, 5.4) - 1.0).abs() < 0.01, "{content}");
        let all = content + rest.content();
        assert!((all - ceiling.content()).abs() < 1e-3);
        let (ceiling, below) = around(7.0, 6.7);
        assert!(bridges(&ceiling, &below).0.is_empty());
        // Lines cross a wide ceiling beside its bore.
        let (ceiling, below) = around(15.0, 4.0);
        let found = bridges(&ceiling, &below).0;
        assert!(found.iter().all(|b| b.way != Way::Around) && found.len() == 1);
        for (outer, inner) in [(7.5, 6.0), (12.0, 6.0)] {
            let found = bridges(&disc(outer), &disc(inner)).0;
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].way, Way::Around);
            // Supports may hold it.
            assert!(hanging(&disc(outer), &disc(inner), None).0.is_empty());
        }
    }

    /// A deck between two piers, with a hole that takes most of its width.
    #[test]
    fn lines_hang_beside_a_large_hole_and_the_others_follow_them() {
        let deck = rect(0.0, 0.0, 30.0, 20.0);
        let hole =
            Area::from(moved(disc(7.0, 100).rings.remove(0), 15.0, 10.0));
        let deck = difference(&deck, &hole);
        let piers = joined(&[
            rect(-1.0, -1.0, 5.0, 21.0),
            rect(25.0, -1.0, 31.0, 21.0),
        ]);
        assert!(hanging(&deck, &piers, None).0.is_empty());
        let (found, _) = bridges(&deck, &piers);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].way, Way::Across(0.0));
        let row = |y: i64, from: f64, to: f64| {
            let points = [from, to].map(|x| DVec2::new(x, y as f64));
            (y, Stroke::new(points.to_vec(), false, 0.45))
        };
        // Rows 3 to 7 end at the hole.
        let lines: Vec<_> = (2..9)
            .flat_map(|y| match y {
                3..8 => vec![row(y, 4.0, 12.0), row(y, 18.0, 26.0)],
                _ => vec![row(y, 4.0, 26.0)],
            })
            .collect();
        let after = held_first(&lines, 0.0, &EdgeGrid::new(&piers, 1.0), 0.45);
        let none: &[u32] = &[];
        let waits: Vec<&[u32]> = after.iter().map(Vec::as_slice).collect();
        let left = [&[0][..], &[1], &[3, 7], &[9], &[11]];
        let right = [&[0][..], &[2], &[4, 8], &[10], &[11]];
        assert_eq!((waits[0], waits[11]), (none, none));
        for k in 0..5 {
            let own = [waits[2 * k + 1], waits[2 * k + 2]];
            assert_eq!(own, [left[k], right[k]], "{k}");
        }
        let whole = &lines[..1];
        assert!(
            held_first(whole, 0.0, &EdgeGrid::new(&piers, 1.0), 0.45)
                .is_empty()
        );
    }

    #[test]
    fn two_gaps_have_a_direction_each() {
        let deck = rect(0.0, 0.0, 60.0, 30.0);
        let holes =
            joined(&[rect(5.0, 5.0, 25.0, 9.0), rect(40.0, 5.0, 44.0, 25.0)]);
        let below = difference(&rect(-1.0, -1.0, 61.0, 31.0), &holes);
        let mut angles: Vec<f64> =
            bridges(&deck, &below).0.iter().map(angle).collect();
        angles.sort_by(f64::total_cmp);
        assert_eq!(angles, [0.0, 90.0]);
    }

    #[test]
    fn gaps_of_one_direction_beside_each_other_are_one_bridge() {
        // The holes of the lattice are nearer to each other than two anchors
        // are long.
        let deck = rect(0.0, 0.0, 60.0, 60.0);
        let mut below = rect(-1.0, -1.0, 61.0, 61.0);
        let pitch = 6.0;
        for i in 0..81 {
            let (x, y) = (f64::from(i % 9), f64::from(i / 9));
            let (x, y) = (4.0 + pitch * x, 4.0 + pitch * y);
            let hole = rect(x, y, x + 5.0, y + 4.0);
            below = difference(&below, &hole);
        }
        let (found, rest) = bridges(&deck, &below);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].way, Way::Across(90.0));
        // All of the land between the holes is part of it.
        let holes = rect(4.0, 4.0, 57.0, 56.0);
        let over = intersection(&found[0].area, &holes).content();
        assert!((over - 53.0 * 52.0).abs() < 0.01, "{over}");
        let content = found[0].area.content();
        let all = content + rest.content();
        assert!((all - 3600.0).abs() < 0.01, "{all}");
    }

    #[test]
    fn round_holes_beside_each_other_are_one_bridge() {
        // Each has a best direction of its own, by rounding alone.
        let deck = rect(0.0, 0.0, 30.0, 10.0);
        let hole = |x: f64, turn: f64| {
            let hole = turned(&disc(3.0, 40), turn).rings.remove(0);
            Area::from(moved(hole, x, 5.0))
        };
        let holes = joined(&[hole(8.0, 0.0), hole(14.6, 0.7), hole(21.2, 1.1)]);
        let below = difference(&rect(-1.0, -1.0, 31.0, 11.0), &holes);
        let (found, _) = bridges(&deck, &below);
        assert_eq!(found.len(), 1);
        let over = intersection(&found[0].area, &holes).content();
        assert!((over / holes.content() - 1.0).abs() < 0.01, "{over}");
    }

    #[test]
    fn gaps_of_two_directions_share_the_land_between_them() {
        let deck = rect(0.0, 0.0, 40.0, 30.0);
        // Lines run along y in the first hole and along x in the second one,
        // whichever is found first.
        let (wide, tall) = ([2.0, 20.0, 10.0, 14.0], [20.6, 25.0, 2.0, 28.0]);
        let hole = |[x0, x1, y0, y1]: [f64; 4]| rect(x0, y0, x1, y1);
        let (wide, tall) = (hole(wide), hole(tall));
        let below = rect(-1.0, -1.0, 41.0, 31.0);
        let below = difference(&below, &joined(&[wide.clone(), tall.clone()]));
        let (found, _) = bridges(&deck, &below);
        assert_eq!(found.len(), 2);
        for bridge in found {
            let (own, other, side) = if bridge.way == Way::Across(90.0) {
                (&wide, &tall, rect(20.0, 10.0, 20.6, 14.0))
            } else {
                assert_eq!(bridge.way, Way::Across(0.0));
                (&tall, &wide, rect(20.0, 10.0, 20.6, 14.0))
            };
            let over = |what: &Area| intersection(&bridge.area, what).content();
            assert!(over(other) < 1e-3, "{}", over(other));
            assert!((over(own) - own.content()).abs() < 0.1);
            // Each has half of the land.
            assert!((over(&side) - 1.2).abs() < 0.1, "{}", over(&side));
        }
    }

    #[test]
    fn no_bridge_grows_into_a_gap_that_has_none() {
        let deck = rect(0.0, 0.0, 40.0, 30.0);
        // Beyond a rib of 0.6 mm a balcony hangs on one side alone.
        let below = joined(&[
            rect(-1.0, -1.0, 10.0, 31.0),
            rect(14.0, -1.0, 14.6, 31.0),
        ]);
        let (found, _) = bridges(&deck, &below);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].way, Way::Across(0.0));
        let beyond = rect(14.6, -1.0, 41.0, 31.0);
        let beyond = intersection(&found[0].area, &beyond).content();
        assert!(beyond < 0.05, "{beyond}");
    }
}

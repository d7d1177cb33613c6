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
//! that are bridges, each with the direction of its lines. What hangs in the
//! air and has no two sides to hang from (the next ring of a dome's inside,
//! a balcony) is no bridge, and left to be printed as ordinary skin.
//!
//! The direction is the best of a fan of angles and of the directions of the
//! gap's longer sides: that with the shortest spans, an end that nothing holds
//! counting for several. Corners, where any slant makes short ones, do not
//! count: what does is the span that three quarters of the lines' length stay
//! below.

use crate::plane::clip::{difference, intersection};
use crate::plane::grid::EdgeGrid;
use crate::plane::hatch::{Lines, hatch};
use crate::plane::offset::offset;
use crate::plane::{Area, edges};
use crate::region::cover::near;
use crate::settings::Settings;
use crate::units::{Degrees, Mm};
use glam::DVec2;

/// A part of a fill whose lines hang between supports.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bridge {
    /// Where, with what its lines reach onto.
    pub area: Area,
    /// Direction of the lines.
    pub angle: Degrees,
}

/// Tolerance of the offsets: borders between lines inside the part.
const TOLERANCE: Mm = 0.02;
/// Step of the fan of angles.
const FAN: Degrees = 7.5;
/// At most so many directions of sides are tried.
const SIDES: usize = 16;
/// Lines looked at for each direction.
const ROWS: f64 = 24.0;
/// Share of the lines' length that counts.
const COMMON: f64 = 0.75;
/// Share of the lines' length that must be held at both ends.
const HELD: f64 = 0.6;

/// The bridges of an area over a layer.
pub(super) fn bridges(
    area: &Area,
    below: &Area,
    settings: &Settings,
) -> Vec<Bridge> {
    let width = settings.bottom_skin_width();
    let below = near(area, below);
    let hanging = difference(area, &below);
    // What a bead's own width bridges needs no care.
    let core = offset(&hanging, -0.5 * width, TOLERANCE);
    if core.is_empty() {
        return Vec::new();
    }
    let grid = EdgeGrid::new(&below, width);
    let mut left = area.clone();
    let mut found = Vec::new();
    for island in core.islands() {
        let gap = intersection(&offset(&island, 0.5 * width, TOLERANCE), area);
        let Some(angle) = direction(&gap, &grid, width) else {
            continue;
        };
        let reach = settings.bridge_anchor.max(0.5 * width);
        let grown = offset(&gap, reach, TOLERANCE);
        let area = intersection(&left, &grown);
        left = difference(&left, &area);
        found.push(Bridge { area, angle });
    }
    found
}

/// The best direction of lines across a gap, if they can hang there.
fn direction(gap: &Area, below: &EdgeGrid, width: Mm) -> Option<Degrees> {
    let fan = (0..(180.0 / FAN) as usize).map(|i| i as f64 * FAN);
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
    let across = sides.clone().map(|a| (a + 90.0).rem_euclid(180.0));
    // The sides first: of equals the first one wins.
    sides
        .chain(across)
        .chain(fan)
        .filter_map(|angle| {
            let (cost, held) = hang(gap, below, angle, width)?;
            (held >= HELD).then_some((cost, angle))
        })
        .reduce(|best, next| {
            // Not for what rounding makes better.
            let better = next.0 < best.0 * (1.0 - 1e-3);
            if better { next } else { best }
        })
        .map(|best| best.1)
}

/// The span that `COMMON` of the length of lines in a direction stay below,
/// and the share of their length that is held at both ends.
fn hang(
    gap: &Area,
    below: &EdgeGrid,
    angle: Degrees,
    width: Mm,
) -> Option<(f64, f64)> {
    let along = DVec2::from_angle(angle.to_radians());
    let v = gap.rings.iter().flatten().map(|p| along.perp().dot(*p));
    let (low, high) = v.fold((f64::INFINITY, f64::NEG_INFINITY), |r, v| {
        (r.0.min(v), r.1.max(v))
    });
    let spacing = ((high - low) / ROWS).max(0.5 * width);
    let lines = Lines {
        angle,
        spacing,
        phase: low + 0.5 * spacing,
    };
    // A wall may stand between the end of a line and what holds it.
    let steps = [0.1, 0.5 * width, width, 1.5 * width, 2.0 * width];
    let holds = |p: DVec2, out: DVec2| {
        steps.iter().any(|d| below.contains(p + out * *d))
    };
    let mut spans: Vec<(Mm, Mm)> = Vec::new();
    let (mut held, mut total) = (0.0, 0.0);
    for s in hatch(gap, lines, 0.1) {
        let length = s.from.distance(s.to);
        let ends = [holds(s.from, -along), holds(s.to, along)];
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
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    let common = spans.iter().find(|(_, length)| {
        below += length;
        below >= COMMON * total
    });
    common.map(|(span, _)| (*span, held / total))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Area {
        let ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area { rings: vec![ring] }
    }

    fn joined(parts: &[Area]) -> Area {
        let rings = parts.iter().flat_map(|a| a.rings.clone());
        Area {
            rings: rings.collect(),
        }
    }

    #[test]
    fn lines_run_from_pillar_to_pillar() {
        // Wider than the gap is long: the free sides do not tempt.
        let settings = Settings::default();
        let deck = rect(0.0, 0.0, 30.0, 40.0);
        let pillars = joined(&[
            rect(-1.0, -1.0, 10.0, 41.0),
            rect(20.0, -1.0, 31.0, 41.0),
        ]);
        let found = bridges(&deck, &pillars, &settings);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].angle, 0.0);
        let reach = 10.0 + 2.0 * settings.bridge_anchor;
        let content = found[0].area.content();
        assert!((content - 40.0 * reach).abs() < 1.0, "{content}");
        // Turned by 20° with everything else.
        let turn = DVec2::from_angle(20.0_f64.to_radians());
        let turned = |a: &Area| Area {
            rings: a
                .rings
                .iter()
                .map(|r| r.iter().map(|p| turn.rotate(*p)).collect())
                .collect(),
        };
        let found = bridges(&turned(&deck), &turned(&pillars), &settings);
        assert!((found[0].angle - 20.0).abs() < 0.1, "{}", found[0].angle);
    }

    #[test]
    fn a_closed_hole_is_crossed_the_short_way() {
        let settings = Settings::default();
        let roof = rect(0.0, 0.0, 40.0, 30.0);
        let hole = rect(10.0, 10.0, 30.0, 16.0);
        let below = difference(&rect(-1.0, -1.0, 41.0, 31.0), &hole);
        let found = bridges(&roof, &below, &settings);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].angle, 90.0);
    }

    #[test]
    fn a_balcony_is_no_bridge_nor_is_the_next_ring_of_a_dome() {
        let settings = Settings::default();
        let deck = rect(0.0, 0.0, 30.0, 10.0);
        let house = rect(-1.0, -1.0, 20.0, 11.0);
        assert!(bridges(&deck, &house, &settings).is_empty());
        let disc = |r: f64| Area {
            rings: vec![
                (0..200)
                    .map(|i| {
                        let t = std::f64::consts::TAU * f64::from(i) / 200.0;
                        DVec2::from_angle(t) * r
                    })
                    .collect(),
            ],
        };
        assert!(bridges(&disc(9.0), &disc(6.0), &settings).is_empty());
        assert!(bridges(&deck, &deck, &settings).is_empty());
    }

    #[test]
    fn two_gaps_have_a_direction_each() {
        let settings = Settings::default();
        let deck = rect(0.0, 0.0, 60.0, 30.0);
        let holes =
            joined(&[rect(5.0, 5.0, 25.0, 9.0), rect(40.0, 5.0, 44.0, 25.0)]);
        let below = difference(&rect(-1.0, -1.0, 61.0, 31.0), &holes);
        let mut angles: Vec<f64> = bridges(&deck, &below, &settings)
            .iter()
            .map(|b| b.angle)
            .collect();
        angles.sort_by(f64::total_cmp);
        assert_eq!(angles, [0.0, 90.0]);
    }
}

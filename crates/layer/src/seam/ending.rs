//! How outer walls end where they began: with a gap, a scarf, a wipe inwards.
//!
//! ```text
//!     ▃▃▄▄▅▅████████ … ████████     A scarf: the loop's first way is printed
//!     ▅▅▄▄▃▃                        twice, with a flow that grows at first
//!     └─ scarf ─┘                   and shrinks on the second time round.
//! ```
//!
//! A nozzle cannot lay a bead that is narrower than high, so a scarf that stays
//! level begins with as much as such a bead needs, and ends with it: the seam is
//! in two places, at each of which the flow changes by less than half.
//!
//! In: beads in print order; closed ones begin at their seam. Out: the beads
//! with their ends, and where the nozzle goes after each bead without printing.
//! A bead is as high as its layer, so a scarf changes only the width, unless
//! the scarf is to rise ([`scarf`](super::scarf)).

use super::plan::EndingPlan;
use super::scarf::{Scarf, risen};
#[cfg(test)]
use crate::resolution::Resolution;
use crate::walls::Support;
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::bead::{Bead, Role, Stroke, cross_section, spacing};
use isoslice_planar::grid::EdgeGrid;

/// A bead, and what follows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// The bead.
    pub bead: Bead,
    /// Where the nozzle goes right after the bead.
    pub wipe: Option<DVec2>,
}

impl From<Bead> for Ended {
    fn from(bead: Bead) -> Ended {
        Ended { bead, wipe: None }
    }
}

impl Ended {
    /// Where the nozzle is after the bead.
    pub fn end(&self) -> Option<DVec2> {
        let end = self.bead.stroke.ends();
        self.wipe.or(end.map(|ends| ends.1))
    }
}

/// Length over which a bead goes from a ramp's width to its own, mm.
const JUMP: Mm = 0.05;
/// Number of points of a ramp, between which its width changes evenly.
const STEPS: usize = 8;

/// The beads with their ends. `solid` is the layer's outline. `first` is true
/// for the part's first layer, on the bed or over the air above a raft, where
/// nothing can rise from below.
pub fn endings(
    beads: Vec<Bead>,
    solid: &EdgeGrid,
    first: bool,
    plan: &EndingPlan,
) -> Vec<Ended> {
    let rises = plan.rises && !first;
    let mut beads = beads.into_iter().peekable();
    let mut out: Vec<Ended> = Vec::with_capacity(beads.len());
    while let Some(bead) = beads.next() {
        // A way that leads from a seam into the part is as good as a wipe.
        let goes_on = beads.peek().is_some_and(|next| {
            next.role == Role::GapFill
                && next.stroke.points.first() == bead.stroke.points.first()
        });
        let meant = bead.stroke.closed && bead.role == Role::OuterWall;
        if !meant || bead.stroke.points.len() < 3 {
            out.push(bead.into());
            continue;
        }
        let length = bead.stroke.length();
        // At least half of a loop stays as it is.
        let scarf = plan.scarf.min(0.5 * length);
        let way = out
            .last()
            .map_or(0.0, |before| entered(&bead, &before.bead));
        let gap = (plan.gap + way).min(0.5 * length);
        let beads = if scarf > 0.0 && rises {
            let whole = opened(&bead, length + scarf - gap, &[], None);
            let scarf = Scarf {
                length: scarf,
                round: length,
                start: plan.start,
            };
            risen(&whole, scarf, plan.resolution)
        } else if scarf > 0.0 || gap > 0.0 {
            vec![with_ramps(&bead, length, scarf, gap)]
        } else {
            vec![bead]
        };
        let mut all: Vec<Ended> = beads.into_iter().map(Ended::from).collect();
        if plan.wipe > 0.0
            && !goes_on
            && let Some(last) = all.last_mut()
        {
            last.wipe = inwards(&last.bead, plan, solid);
        }
        out.extend(all);
    }
    out
}

/// Length of a closed wall, mm, with the volume of what a way to its beginning lays
/// within it, which is half of the wall's width of the way. The wall ends earlier by as
/// much; otherwise its seam would get a tenth too much.
fn entered(wall: &Bead, before: &Bead) -> Mm {
    let leads_here = before.role == Role::GapFill
        && before.stroke.points.last() == wall.stroke.points.first();
    if !leads_here {
        return 0.0;
    }
    let plane = |b: &Bead| spacing(b.stroke.width, b.stroke.width, b.height);
    0.5 * wall.stroke.width * plane(before) / plane(wall)
}

/// The beads, with walls cut where they begin or cease to hang over what holds
/// them.
pub fn cut(all: Vec<Ended>, support: &Support<'_>) -> Vec<Ended> {
    let mut out = Vec::with_capacity(all.len());
    for Ended { bead, wipe } in all {
        out.extend(support.cut(bead).into_iter().map(Ended::from));
        if let Some(last) = out.last_mut() {
            last.wipe = wipe;
        }
    }
    out
}

/// A closed bead as an open one that overlaps its beginning by a scarf, and
/// ends a gap earlier.
fn with_ramps(bead: &Bead, length: Mm, scarf: Mm, gap: Mm) -> Bead {
    if scarf <= 0.0 {
        return opened(bead, length - gap, &[], None);
    }
    // The points of the ramps, and where the bead is whole.
    let jump = JUMP.min(0.25 * (length - scarf));
    let step = |k: usize| scarf * k as f64 / STEPS as f64;
    let ramps = (0..=STEPS).flat_map(|k| [step(k), length + step(k)]);
    let ramps: Vec<Mm> = ramps.chain([scarf + jump, length - jump]).collect();
    let height = bead.height;
    let thinned = |s: Mm, w: Mm| {
        // How much is left to the end of the ramp, as a share of its length.
        let left = (1.0 - s / scarf).min(1.0);
        let left = left.max((s - length) / scarf);
        if left < -(1.0 - 1e-9) * jump / scarf {
            return w;
        }
        let whole = cross_section(w, height);
        let least = (cross_section(height, height) / whole).min(0.5);
        let share = 1.0 - least - (1.0 - 2.0 * least) * left.max(0.0);
        width_of(share * whole, height)
    };
    opened(bead, length + scarf - gap, &ramps, Some(&thinned))
}

/// The width at a place along a bead, by its distance from the bead's beginning
/// and by the width that the bead has there.
type WidthAt<'a> = &'a dyn Fn(Mm, Mm) -> Mm;

/// A closed bead as an open one that ends at a distance from its beginning. The
/// distance may be up to twice its length. The bead gets points at the
/// distances `more`, and other widths, if any are given.
fn opened(
    bead: &Bead,
    end: Mm,
    more: &[Mm],
    widths: Option<WidthAt<'_>>,
) -> Bead {
    let n = bead.stroke.points.len();
    let width = |i: usize| bead.stroke.width_at(i);
    let mut stops: Vec<(Mm, DVec2, Mm)> = Vec::new();
    let mut from = 0.0;
    for i in 0..2 * n {
        let (a, b) =
            (bead.stroke.points[i % n], bead.stroke.points[(i + 1) % n]);
        let edge = a.distance(b);
        let at = |s: Mm| {
            let t = ((s - from) / edge).clamp(0.0, 1.0);
            (s, a.lerp(b, t), width(i) + t * (width(i + 1) - width(i)))
        };
        stops.push((from, a, width(i)));
        let first = stops.len();
        let inside = |s: &Mm| *s > from && *s < from + edge;
        stops.extend(more.iter().copied().filter(inside).map(at));
        stops[first..].sort_by(|a, b| a.0.total_cmp(&b.0));
        if from + edge >= end {
            stops.retain(|s| s.0 < end);
            stops.push(at(end));
            break;
        }
        from += edge;
    }
    let widths = match widths {
        Some(of) => stops.iter().map(|&(s, _, w)| of(s, w)).collect(),
        None if bead.stroke.widths.is_empty() => Vec::new(),
        None => stops.iter().map(|s| s.2).collect(),
    };
    Bead {
        stroke: Stroke {
            points: stops.iter().map(|s| s.1).collect(),
            widths,
            closed: false,
            width: bead.stroke.width,
            levels: Vec::new(),
        },
        ..*bead
    }
}

/// Width of a bead of a given cross-section.
fn width_of(area: Mm2, height: Mm) -> Mm {
    use std::f64::consts::FRAC_PI_4;
    let round = FRAC_PI_4 * height * height;
    if area > round {
        (area - round) / height + height
    } else {
        area / (FRAC_PI_4 * height)
    }
}

/// A point farther inside the part than the bead's end; none if there is no
/// such point.
fn inwards(bead: &Bead, plan: &EndingPlan, solid: &EdgeGrid) -> Option<DVec2> {
    let length = plan.wipe;
    /// How far around the end edges are looked at, mm.
    const REACH: Mm = 2.0;
    let n = bead.stroke.points.len();
    let ways: [(DVec2, DVec2); 2] = if bead.stroke.closed {
        [
            (bead.stroke.points[n - 1], bead.stroke.points[0]),
            (bead.stroke.points[0], bead.stroke.points[1]),
        ]
    } else {
        [(bead.stroke.points[n - 2], bead.stroke.points[n - 1]); 2]
    };
    let end = ways[0].1;
    // The part lies to the left of its walls.
    let left = |(a, b): (DVec2, DVec2)| (b - a).perp().normalize_or_zero();
    let inward = (left(ways[0]) + left(ways[1])).try_normalize()?;
    let depth = |p: DVec2| -> Mm {
        let d = solid
            .nearest_within(p, REACH + length)
            .map_or(REACH + length, |(_, q)| p.distance(q));
        if solid.contains(p) { d } else { -d }
    };
    let here = depth(end);
    // The bead may have been turned round. This shows right at its end: farther
    // away the other side of a slot is inside, too.
    let near = 0.25 * bead.stroke.width * inward;
    let side = if plan.reversed {
        [1.0, -1.0]
            .into_iter()
            .find(|side| depth(end + side * near) > here)?
    } else {
        1.0
    };
    [1.0, 0.5, 0.25]
        .into_iter()
        .map(|share| end + side * share * length * inward)
        .find(|&p| depth(p) > here)
}

/// Length of a path. Parts that are printed twice count twice.
#[cfg(test)]
fn printed(bead: &Bead) -> f64 {
    let usual = isoslice_settings::testing::usual_plan(Resolution::of);
    let pieces = usual.pieces(bead.clone());
    pieces.iter().map(|p| p.area() * p.stroke.length()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::Area;
    use isoslice_planar::shapes::square_ring;
    use isoslice_settings::testing::plan_with;

    fn wall(half: f64) -> Bead {
        Bead::new(
            Role::OuterWall,
            Stroke::new(square_ring(half), true, 0.45),
            0.2,
        )
    }

    fn ended(bead: Bead, plan: &EndingPlan) -> Ended {
        let area = Area::from(square_ring(10.0));
        let grid = EdgeGrid::new(&area, 1.0);
        endings(vec![bead], &grid, false, plan).remove(0)
    }

    fn plan(scarf: f64, gap: f64, wipe: f64) -> EndingPlan {
        plan_with(EndingPlan::of, |s| {
            s.seam_scarf = scarf.into();
            s.seam_gap = gap;
            s.seam_wipe = wipe;
        })
    }

    #[test]
    fn without_any_of_it_a_loop_stays_as_it_is() {
        let wall = wall(9.775);
        let own = ended(wall.clone(), &plan(0.0, 0.0, 0.0));
        assert_eq!(own.bead, wall);
        assert_eq!(own.wipe, None);
    }

    #[test]
    fn a_gap_is_left_open() {
        let own = ended(wall(9.775), &plan(0.0, 0.2, 0.0)).bead;
        assert!(!own.stroke.closed && own.stroke.widths.is_empty());
        assert_eq!(own.stroke.points[0], DVec2::splat(-9.775));
        let last = own.stroke.points[own.stroke.points.len() - 1];
        assert!((last - DVec2::new(-9.775, -9.575)).length() < 1e-9);
        // A tiny loop is not opened as a whole.
        let tiny = ended(wall(0.05), &plan(0.0, 2.0, 0.0)).bead;
        assert!((tiny.stroke.length() - 0.2).abs() < 1e-9);
    }

    /// The wall and what lies within it of the way lay what the wall alone did.
    #[test]
    fn a_wall_ends_earlier_where_a_way_leads_to_its_beginning() {
        let wall = wall(9.775);
        let begin = wall.stroke.points[0];
        let way = |to: DVec2| {
            let points = vec![DVec2::splat(-9.3), to];
            let stroke = Stroke::new(points, false, 0.2);
            Bead::new(Role::GapFill, stroke, 0.2)
        };
        let grid = EdgeGrid::new(&Area::from(square_ring(10.0)), 1.0);
        let after = |way: Bead| {
            let beads = vec![way, wall.clone()];
            endings(beads, &grid, false, &plan(0.0, 0.0, 0.0)).remove(1)
        };
        let own = after(way(begin)).bead.stroke;
        assert!(!own.closed && own.points[0] == begin);
        let less = 4.0 * 2.0 * 9.775 - own.length();
        let flat = 0.2 * (1.0 - std::f64::consts::FRAC_PI_4);
        let meant = 0.225 * (0.2 - flat) / (0.45 - flat);
        assert!((less - meant).abs() < 1e-9, "{less} {meant}");
        assert_eq!(after(way(begin + DVec2::X)).bead, wall);
    }

    #[test]
    fn a_scarf_overlaps_and_adds_up_to_the_loop() {
        for gap in [0.0, 0.1] {
            let mut wall = wall(9.775);
            let own = ended(wall.clone(), &plan(25.0, gap, 0.0)).bead;
            // 25 mm are the way round the first corner and back onto the first
            // side.
            assert!(
                (own.stroke.length() - (wall.stroke.length() + 25.0 - gap))
                    .abs()
                    < 1e-9
            );
            let whole = wall.area() * wall.stroke.length();
            let share = printed(&own) / whole;
            assert!((share - 1.0).abs() < 3e-3, "{share}");
            // No bead is narrower than high. Both ways add up at each place.
            assert!((own.stroke.widths[0] - 0.2).abs() < 1e-9);
            let narrowest =
                own.stroke.widths.iter().copied().fold(1.0, f64::min);
            assert!(narrowest > 0.2 - 1e-9, "{narrowest}");
            let part = |from: f64, to: f64| {
                let all = own.stroke.length();
                printed(&Bead {
                    stroke: own.stroke.part(from / all, to / all),
                    ..own.clone()
                })
            };
            for i in 0..24 {
                let (from, round) = (f64::from(i), wall.stroke.length());
                let both = part(from, from + 0.9)
                    + part(round + from, round + from + 0.9);
                let share = both / (0.9 * wall.area());
                assert!((share - 1.0).abs() < 0.01, "{from}: {share}");
            }
            assert_eq!(own.stroke.widths.len(), own.stroke.points.len());
            // A wall of varying width gets the ramps, too.
            wall.stroke.widths = vec![0.4, 0.5, 0.4, 0.5];
            let own = ended(wall.clone(), &plan(25.0, gap, 0.0)).bead;
            let share = printed(&own) / printed(&wall);
            assert!((share - 1.0).abs() < 5e-3, "{share}");
        }
        let half = width_of(0.5 * cross_section(0.45, 0.2), 0.2);
        let area = cross_section(half, 0.2);
        assert!((2.0 * area - cross_section(0.45, 0.2)).abs() < 1e-12);
    }

    #[test]
    fn a_way_that_leads_from_the_seam_takes_the_place_of_a_wipe() {
        let area = Area::from(square_ring(10.0));
        let grid = EdgeGrid::new(&area, 1.0);
        let first = wall(9.775);
        let way = |from: DVec2| {
            let points = vec![from, DVec2::splat(-9.3)];
            Bead::new(Role::GapFill, Stroke::new(points, false, 0.2), 0.2)
        };
        let wipes = |from: DVec2| {
            let beads = vec![first.clone(), way(from)];
            endings(beads, &grid, false, &plan(0.0, 0.0, 0.3))[0].wipe
        };
        assert_eq!(wipes(first.stroke.points[0]), None);
        assert!(wipes(DVec2::splat(-9.0)).is_some());
    }

    #[test]
    fn a_wipe_does_not_cross_a_slot() {
        // A wall 0.45 mm thick, a slot of 0.1 mm, and a block.
        let mut area = isoslice_planar::rect(-10.0, -10.0, -9.55, 10.0);
        area.rings
            .extend(isoslice_planar::rect(-9.45, -10.0, 10.0, 10.0).rings);
        let grid = EdgeGrid::new(&area, 1.0);
        let at = |x: f64, y: f64| DVec2::new(x, y);
        // The block's wall begins in the middle of its side, downwards.
        let (left, right) = (-9.45 + 0.225, 10.0 - 0.225);
        let mut points = vec![
            at(left, 0.0),
            at(left, -9.7),
            at(right, -9.7),
            at(right, 9.7),
            at(left, 9.7),
        ];
        for turned in [false, true] {
            if turned {
                points[1..].reverse();
            }
            let stroke = Stroke::new(points.clone(), true, 0.45);
            let bead = Bead::new(Role::OuterWall, stroke, 0.2);
            // A place 0.24 mm inside the thin wall is no place to go.
            for wipe in [0.3, 0.55, 1.0] {
                let mut plan = plan(0.0, 0.0, wipe);
                plan.reversed = true;
                let all = endings(vec![bead.clone()], &grid, false, &plan);
                let at = all[0].wipe.unwrap();
                assert!(at.x > left, "{turned} {wipe}: {at}");
            }
        }
        // The thin wall has no inside, so there is no way from it.
        let thin = vec![
            at(-9.775, 0.0),
            at(-9.775, -9.7),
            at(-9.774, -9.7),
            at(-9.774, 9.7),
            at(-9.775, 9.7),
        ];
        let stroke = Stroke::new(thin, true, 0.45);
        let bead = Bead::new(Role::OuterWall, stroke, 0.2);
        for wipe in [0.3, 0.6, 1.2] {
            let mut plan = plan(0.0, 0.0, wipe);
            plan.reversed = true;
            let all = endings(vec![bead.clone()], &grid, false, &plan);
            assert_eq!(all[0].wipe, None, "{wipe}");
        }
    }

    #[test]
    fn a_wipe_leads_inwards() {
        let mut begun = wall(9.775);
        begun.stroke.points.insert(0, DVec2::new(-9.775, 0.0));
        let own = ended(begun, &plan(0.0, 0.0, 0.3));
        let wipe = own.wipe.unwrap();
        assert!((wipe - DVec2::new(-9.475, 0.0)).length() < 1e-9, "{wipe}");
        // Around a hole the part is outside.
        let mut hole = wall(2.0);
        hole.stroke.points.reverse();
        let area = Area::from_iter([square_ring(10.0), {
            let mut ring = square_ring(1.775);
            ring.reverse();
            ring
        }]);
        let grid = EdgeGrid::new(&area, 1.0);
        let own = endings(vec![hole], &grid, false, &plan(0.0, 0.0, 0.3));
        let wipe = own[0].wipe.unwrap();
        assert!(wipe.abs().min_element() > 2.2, "{wipe}");
        // A place that is too thin for a wipe gets no wipe.
        let thin = Area::from_iter([square_ring(9.775 + 0.2), {
            let mut ring = square_ring(9.775 - 0.2);
            ring.reverse();
            ring
        }]);
        let grid = EdgeGrid::new(&thin, 1.0);
        let plan = plan(0.0, 0.0, 0.8);
        let mut begun = wall(9.775);
        begun.stroke.points.insert(0, DVec2::new(-9.775, 0.0));
        assert_eq!(endings(vec![begun], &grid, false, &plan)[0].wipe, None);
    }
}

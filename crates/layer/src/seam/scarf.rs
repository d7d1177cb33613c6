//! Scarfs that rise: a loop's first way as a ramp, and its end on top of it.
//!
//! ```text
//!     ▁▂▃▄▅▆▇███████ … ███████      Side view: the nozzle climbs from the
//!     ████████████████████████      layer below while the bead grows, and
//!     ▔▔▔▔▔▔▔                       stays level at the end, where the bead
//!     └─ scarf ─┘                   fills what the ramp has left.
//! ```
//!
//! In: a loop laid open, which goes on over its beginning. Out: its beads, one
//! after the other: the ramp, the rest, and the way over the ramp. The points
//! of the ramp and of the way over it have levels.
//!
//! Guarantees: the ramp is as high at each place as the nozzle is above the
//! layer below. The ramp and the way over it have together what the loop has
//! elsewhere, within 0.1 % where the loop is of one width. The nozzle never
//! leaves the layer.

use crate::resolution::Resolution;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Bead, Level, Stroke, cross_section, height_of};

/// Number of points along the way over a ramp. Between them its height changes
/// evenly, and its cross-section nearly does.
const STEPS: f64 = 8.0;

/// A scarf of a loop.
#[derive(Clone, Copy)]
pub(super) struct Scarf {
    /// Length of the ramp.
    pub length: Mm,
    /// Length of the loop.
    pub round: Mm,
    /// Height at which the ramp begins, as a share of the bead's.
    pub start: f64,
}

/// A loop laid open, as the beads of a scarf.
pub(super) fn risen(
    whole: &Bead,
    scarf: Scarf,
    resolution: Resolution,
) -> Vec<Bead> {
    let length = whole.stroke.length();
    let part = |from: Mm, to: Mm| Bead {
        stroke: whole.stroke.part(from / length, to / length),
        ..*whole
    };
    // Share of the height at a share of the ramp's length.
    let share = |t: f64| scarf.start + (1.0 - scarf.start) * t;
    let height = whole.height;
    let ramp = levelled(part(0.0, scarf.length), 1.0, resolution, |t, _| {
        let less = (share(t) - 1.0) * height;
        Level {
            rise: less,
            extra: less,
        }
    });
    // A gap ends the way over the ramp early.
    let over = (length - scarf.round).max(0.0) / scarf.length;
    let over_ramp =
        levelled(part(scarf.round, length), over, resolution, |t, width| {
            let below = cross_section(width, share(t) * height);
            let left = cross_section(width, height) - below;
            Level {
                rise: 0.0,
                extra: height_of(left, width) - height,
            }
        });
    let rest = part(scarf.length, scarf.round);
    let all = ramp.into_iter().chain([rest]).chain(over_ramp);
    all.filter(|bead| bead.stroke.points.len() > 1).collect()
}

/// A bead in pieces of one width each, whose points have levels by their share
/// of the ramp and their width. The bead covers the share `all` of the ramp.
fn levelled(
    bead: Bead,
    all: f64,
    resolution: Resolution,
    level: impl Fn(f64, Mm) -> Level,
) -> Vec<Bead> {
    let parts = resolution.pieces(bead);
    let length: Mm = parts.iter().map(|part| part.stroke.length()).sum();
    if length <= 0.0 {
        return Vec::new();
    }
    let step = length / (STEPS * all).ceil().max(1.0);
    let mut done = 0.0;
    let mut raise = |part: Bead| {
        let mut points: Vec<DVec2> =
            part.stroke.points.first().copied().into_iter().collect();
        let mut at: Vec<Mm> = vec![done];
        for (a, b) in part.stroke.segments() {
            let edge = a.distance(b);
            // The next multiples of a step within the segment.
            let mut k = (done / step).floor() + 1.0;
            while k * step < done + edge * (1.0 - 1e-9) {
                points.push(a.lerp(b, (k * step - done) / edge));
                at.push(k * step);
                k += 1.0;
            }
            done += edge;
            points.push(b);
            at.push(done);
        }
        let levels = at.iter();
        let levels =
            levels.map(|at| level(all * at / length, part.stroke.width));
        let stroke = Stroke {
            levels: levels.collect(),
            ..Stroke::new(points, false, part.stroke.width)
        };
        Bead { stroke, ..part }
    };
    parts.into_iter().map(&mut raise).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::Role;
    use isoslice_settings::testing::usual_plan;

    /// A loop of 40 mm laid open, for which a straight line stands: its last 10
    /// mm lie over its first ones.
    fn line(length: Mm, widths: &[Mm]) -> Bead {
        let n = widths.len().max(2);
        let at = |i: usize| length * i as f64 / (n - 1) as f64;
        let points = (0..n).map(|i| DVec2::X * at(i)).collect();
        let mut stroke = Stroke::new(points, false, 0.45);
        if !widths.is_empty() {
            stroke.widths = widths.to_vec();
        }
        Bead::new(Role::OuterWall, stroke, 0.2)
    }

    /// Volume that some beads lay between two distances from their beginning.
    fn laid(beads: &[Bead], from: Mm, to: Mm) -> f64 {
        let mut sum = 0.0;
        for bead in beads {
            for (i, (a, b)) in bead.stroke.segments().enumerate() {
                let (low, high) = (a.x.max(from), b.x.min(to));
                if high <= low {
                    continue;
                }
                let level = |x: Mm| {
                    let t = (x - a.x) / (b.x - a.x);
                    bead.stroke.level(i).lerp(bead.stroke.level(i + 1), t)
                };
                // The steps are fine enough for any curve.
                for k in 0..200 {
                    let x = low + (high - low) * (f64::from(k) + 0.5) / 200.0;
                    let height = bead.height + level(x).extra;
                    sum += cross_section(bead.stroke.width, height)
                        * (high - low)
                        / 200.0;
                }
            }
        }
        sum
    }

    #[test]
    fn ramp_and_way_over_it_add_up_at_each_place() {
        for (start, gap) in [(0.0, 0.0), (0.1, 0.0), (0.3, 0.4)] {
            let scarf = Scarf {
                length: 10.0,
                round: 40.0,
                start,
            };
            let resolution = usual_plan(Resolution::of);
            let beads = risen(&line(50.0 - gap, &[]), scarf, resolution);
            let last = beads.len() - 1;
            let area = cross_section(0.45, 0.2);
            for i in 0..20 {
                let (from, to) = (0.5 * f64::from(i), 0.5 * f64::from(i + 1));
                let to = to.min(10.0 - gap);
                let both = laid(&beads[..1], from, to)
                    + laid(&beads[last..], 40.0 + from, 40.0 + to);
                let share = both / (area * (to - from));
                assert!((share - 1.0).abs() < 1e-3, "{start} {from}: {share}");
            }
            // Each bead begins where the one before ends, in space as well.
            for pair in beads.windows(2) {
                assert_eq!(
                    pair[0].stroke.points.last(),
                    Some(&pair[1].stroke.points[0])
                );
                let end = pair[0].stroke.level(pair[0].stroke.points.len() - 1);
                assert!(
                    (end.rise - pair[1].stroke.level(0).rise).abs() < 1e-12
                );
            }
            let first = beads[0].stroke.level(0).rise;
            assert!((first - (start - 1.0) * 0.2).abs() < 1e-12);
            assert!(beads[1].stroke.levels.is_empty());
            let rises =
                beads.iter().flat_map(|b| &b.stroke.levels).map(|l| l.rise);
            assert!(rises.into_iter().all(|r| (-0.2..=1e-12).contains(&r)));
        }
    }

    #[test]
    fn a_loop_of_varying_width_keeps_its_volume() {
        let widths: Vec<Mm> = (0..51)
            .map(|i| 0.45 + 0.1 * (0.3 * f64::from(i)).sin())
            .collect();
        let whole = line(50.0, &widths);
        let scarf = Scarf {
            length: 10.0,
            round: 40.0,
            start: 0.1,
        };
        let resolution = usual_plan(Resolution::of);
        let beads = risen(&whole, scarf, resolution);
        // Beads that leave the plane have one width.
        assert!(
            beads
                .iter()
                .all(|b| b.stroke.levels.is_empty()
                    || b.stroke.widths.is_empty())
        );
        assert!(
            beads.iter().filter(|b| !b.stroke.levels.is_empty()).count() > 4
        );
        let of_part = |from: Mm, to: Mm| {
            let part = Bead {
                stroke: whole.stroke.part(from / 50.0, to / 50.0),
                ..whole
            };
            let parts = resolution.pieces(part);
            parts
                .iter()
                .map(|p| p.area() * p.stroke.length())
                .sum::<f64>()
        };
        let ramps: Vec<Bead> = beads
            .into_iter()
            .filter(|b| !b.stroke.levels.is_empty())
            .collect();
        // The ramp takes its share of one way round, and the way over it takes
        // the rest of the next. In a loop both are equally wide; here they are
        // not.
        let is = laid(&ramps, 0.0, 10.0) + laid(&ramps, 40.0, 50.0);
        let (low, high) = (of_part(0.0, 10.0), of_part(40.0, 50.0));
        let (low, high) = (low.min(high), low.max(high));
        assert!(is > 0.95 * low && is < 1.05 * high, "{is} {low} {high}");
    }
}

//! Parallel lines that fill an area up to its border.
//!
//! ```text
//!    ──────────────────   row 1 ends where the border passes it: between row
//!    ─────────╮           0, the border and the end of row 1 a wedge would
//!    ┄┄┄┄┄┄┄┄┄┄╲┄┄┄┄┄┄    stay open, up to half a row thick. Row 0 grows
//!    ━━━━━━━━━━━━━━━━━    wider there, and moves over by half of that.
//! ```
//!
//! In: an area and where the lines are to run. Out: strokes, row by row, with
//! widths where they vary. How far the border is from a row is known by rows
//! a quarter of the spacing apart: widths are right to a tenth of the spacing.
//!
//! Not filled: places that no line passes, since they are narrower than two
//! rows.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Area;
use isoslice_planar::bead::Stroke;
use isoslice_planar::hatch::{Lines, hatch};

/// Rows looked at for each one that is drawn.
const FINE: i64 = 4;
/// Wedges shorter than this are under the round ends of the lines beside
/// them, mm.
const SHORT: Mm = 0.3;
/// How far the round end of a line covers the side of its row, as a share of
/// the line's width: half a row off the centre line the end is set back.
const ROUND: f64 = 0.3;
/// Length over which a width changes that would otherwise jump, mm.
const JUMP: Mm = 0.05;

/// A range of coordinates along the rows.
type Span = (f64, f64);

/// Growth of a line to one side: pairs of a coordinate along the line and the
/// growth there.
type Profile = Vec<(f64, Mm)>;

/// The lines as strokes `width` wide, each with its row; neighbouring rows
/// have numbers one apart. Pieces shorter than `shortest` are left
/// out.
pub(super) fn strokes(
    area: &Area,
    lines: Lines,
    width: Mm,
    shortest: Mm,
) -> Vec<(i64, Stroke)> {
    let along = DVec2::from_angle(lines.angle.to_radians());
    let across = along.perp();
    let fine = Lines {
        spacing: lines.spacing / FINE as f64,
        ..lines
    };
    let all = hatch(area, fine, 0.0);
    let Some(first) = all.first().map(|s| s.row.div_euclid(FINE)) else {
        return Vec::new();
    };
    let last = all.last().map_or(first, |s| s.row.div_euclid(FINE));
    // The area's spans by fine row, with one more drawn row at both ends.
    let mut rows: Vec<Vec<Span>> =
        vec![Vec::new(); ((last - first + 3) * FINE) as usize];
    let index = |row: i64| (row - (first - 1) * FINE) as usize;
    for s in &all {
        let span = (along.dot(s.from), along.dot(s.to));
        if s.row.rem_euclid(FINE) != 0 || span.1 - span.0 >= shortest {
            rows[index(s.row)].push(span);
        }
    }
    let cap = ROUND * width;
    let mut strokes = Vec::new();
    for row in first..=last {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let at = |offset: i64| rows[index(row * FINE + offset)].as_slice();
        if at(0).is_empty() {
            continue;
        }
        let up = wedges([at(2), at(3), at(4)], lines.spacing, cap);
        let down = wedges([at(-2), at(-3), at(-4)], lines.spacing, cap);
        let base = across * (lines.phase + row as f64 * lines.spacing);
        for &(from, to) in at(0) {
            let within = |p: &&Profile| {
                let ends = p.first().zip(p.last());
                ends.is_some_and(|(a, b)| a.0 < to && b.0 > from)
            };
            let up: Vec<&Profile> = up.iter().filter(within).collect();
            let down: Vec<&Profile> = down.iter().filter(within).collect();
            let mut places: Vec<f64> = vec![from, to];
            if !(up.is_empty() && down.is_empty()) {
                let knots = up.iter().chain(&down).flat_map(|p| p.iter());
                places.extend(
                    knots.map(|k| k.0).filter(|u| (from..to).contains(u)),
                );
                places.sort_by(f64::total_cmp);
                places.dedup_by(|a, b| *a - *b < 1e-6);
            }
            let mut stroke = Stroke::new(Vec::new(), false, width);
            for u in places {
                let (a, b) = (grown(&up, u), grown(&down, u));
                let p = base + along * u + across * (0.5 * (a - b));
                stroke.points.push(p);
                stroke.widths.push(width + a + b);
            }
            if stroke.widths.iter().all(|w| *w == width) {
                stroke.widths.clear();
            }
            strokes.push((row, stroke));
        }
    }
    strokes
}

/// The growth of a row to one side. `beside` has the area's spans half a row
/// away, those three quarters of a row away, and the spans drawn on the next
/// row.
fn wedges(beside: [&[Span]; 3], spacing: Mm, cap: Mm) -> Vec<Profile> {
    let [half, far, next] = beside;
    let mut profiles = Vec::new();
    for &(from, to) in half {
        let mut start = from;
        let covers = next
            .iter()
            .map(|s| (s.0 - cap, s.1 + cap))
            .filter(|s| s.1 > from && s.0 < to);
        for (a, b) in covers.chain([(to, to)]) {
            if a - start >= SHORT {
                let closed = (start > from, a < to);
                profiles.push(profile((start, a), closed, far, spacing));
            }
            start = start.max(b);
        }
    }
    profiles
}

/// The growth along one open span: nothing where the border is half a row
/// away, a quarter row where it is three quarters away, not quite half a row
/// in between. `closed` tells at which ends the next row's line begins.
fn profile(
    open: Span,
    closed: (bool, bool),
    far: &[Span],
    spacing: Mm,
) -> Profile {
    let quarter = 0.25 * spacing;
    let far = far
        .iter()
        .map(|s| (s.0.max(open.0), s.1.min(open.1)))
        .filter(|s| s.1 - s.0 > JUMP);
    let mut knots: Profile = Vec::new();
    if !closed.0 {
        knots.push((open.0, 0.0));
    }
    for (a, b) in far {
        let begins = closed.0 && a <= open.0;
        let ends = closed.1 && b >= open.1;
        knots.push((a, if begins { 1.8 * quarter } else { quarter }));
        if !begins && !ends {
            // Half way a parabola's height is a third more than at its ends.
            knots.push((0.5 * (a + b), 1.6 * quarter));
        }
        knots.push((b, if ends { 1.8 * quarter } else { quarter }));
    }
    let level = |knots: &Profile| knots.first().map_or(0.0, |k| k.1);
    if closed.0 {
        let first = level(&knots).max(0.5 * quarter);
        if knots.first().is_none_or(|k| k.0 > open.0) {
            knots.insert(0, (open.0, first));
        }
        knots.insert(0, (open.0 - JUMP, 0.0));
    }
    if closed.1 {
        if knots.last().is_none_or(|k| k.0 < open.1) {
            knots.push((open.1, 0.5 * quarter));
        }
        knots.push((open.1 + JUMP, 0.0));
    } else {
        knots.push((open.1, 0.0));
    }
    if knots.len() == 2 && knots.iter().all(|k| k.1 == 0.0) {
        // The growth is less than a quarter row at its highest.
        knots.insert(1, (0.5 * (open.0 + open.1), 0.4 * quarter));
    }
    knots
}

/// The growth at a coordinate.
fn grown(profiles: &[&Profile], u: f64) -> Mm {
    let at = |p: &&&Profile| {
        let i = p.iter().position(|k| k.0 >= u)?;
        if i == 0 {
            return (p[0].0 == u).then_some(p[0].1);
        }
        let ((u0, t0), (u1, t1)) = (p[i - 1], p[i]);
        Some(t0 + (t1 - t0) * (u - u0) / (u1 - u0).max(1e-9))
    };
    profiles.iter().filter_map(|p| at(&p)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::shapes::disc;
    use std::f64::consts::PI;

    fn level(spacing: f64, phase: f64) -> Lines {
        Lines {
            angle: 0.0,
            spacing,
            phase,
        }
    }

    /// Content under strokes whose rows are `spacing` apart.
    fn content(strokes: &[(i64, Stroke)], spacing: f64, width: f64) -> f64 {
        let of = |s: &Stroke| {
            let at =
                |i: usize| s.widths.get(i).map_or(0.0, |w| w - width) + spacing;
            (1..s.points.len())
                .map(|i| {
                    let d = s.points[i - 1].distance(s.points[i]);
                    d * 0.5 * (at(i - 1) + at(i))
                })
                .sum::<f64>()
        };
        strokes.iter().map(|(_, s)| of(s)).sum()
    }

    #[test]
    fn lines_across_a_square_are_plain() {
        let ring = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
            .map(DVec2::from)
            .to_vec();
        let area = Area::from(ring);
        let slanted = Lines {
            angle: 45.0,
            ..level(0.4, 0.0)
        };
        let all = strokes(&area, slanted, 0.44, 0.2);
        assert_eq!(all.len(), 35);
        assert!(all.iter().all(|(_, s)| s.widths.is_empty()));
        // The first row is a whole spacing from the border: half a row more.
        let all = strokes(&area, level(0.4, 0.399), 0.44, 0.2);
        let widest = |s: &Stroke| s.widths.iter().copied().fold(0.0, f64::max);
        assert!((0.55..0.65).contains(&widest(&all[0].1)));
    }

    #[test]
    fn a_disc_is_filled_to_its_border() {
        let area = disc(6.0, 3000);
        for phase in [0.0, 0.1, 0.2, 0.3] {
            let all = strokes(&area, level(0.4, phase), 0.44, 0.0);
            let filled = content(&all, 0.4, 0.44);
            let share = filled / (PI * 36.0);
            assert!((share - 1.0).abs() < 0.006, "{phase}: {share}");
            for (_, s) in &all {
                for (i, p) in s.points.iter().enumerate() {
                    let w = s.width_at(i);
                    let side = p.y.abs() + 0.5 * (w - 0.04);
                    let reach = DVec2::new(p.x, side).length();
                    // Ends without growth stand out by half a row, as plain
                    // lines' ends do.
                    if w > 0.45 {
                        assert!(reach < 6.0 + 0.06, "{p} {w}");
                    }
                }
            }
        }
    }
}

//! Inner walls that give way where the walls outside of them have grown wider.
//!
//! ```text
//!   ━━━━━━━━━━━━━━━━━━━━━━   A wall grows wider beside a pocket, and tapers on
//!   ━━━━╮            ╭━━━━   both sides of it. The wall inside of it becomes
//!        ╲━━━━━━━━━━╱        narrower by as much as the two would overlap, and
//!   ━━━━╮            ╭━━━━   its inner side stays where it is.
//!        ╲──────────╱
//!   ──────────────────────
//! ```
//!
//! A bead that lies between two walls becomes narrower on both sides.
//!
//! In: a wall's lines or beads, and the lines of the wall outside of them. Out:
//! the lines, which keep their spacing from the wall outside except where they
//! would become too narrow.

use super::line::{AxisIndex, stations};
use super::medial_axis::Axis;
use super::widen::{HIDDEN, Station, nowhere, widened};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Stroke, spacing};

/// Greatest overlap of walls side by side that is left alone, mm.
const OVERLAP: Mm = 0.01;
/// Share of a wall's width that stays, however much the wall outside of it has
/// grown.
const NARROWEST: f64 = 0.6;

/// Narrows lines beside the walls `outside` of them, which are usually `width`
/// wide, where these have grown wider. Lines are thinned to `tolerance`.
pub(super) fn give_way(
    lines: Vec<Stroke>,
    outside: &[Stroke],
    width: Mm,
    height: Mm,
    tolerance: Mm,
) -> Vec<Stroke> {
    let wider = wider(outside, width);
    if wider.is_empty() || lines.is_empty() {
        return lines;
    }
    let widest = wider.iter().map(Axis::thickest).fold(0.0, f64::max);
    let own = lines.iter().flat_map(|l| &l.widths).copied();
    let own = own.chain(lines.iter().map(|l| l.width)).fold(0.0, f64::max);
    let reach = spacing(widest, own, height);
    let index = AxisIndex::new(&wider, reach);
    // A line may lie between two walls that have grown, so that its left side
    // gives way after its right side.
    let narrowed = |line: Stroke, side: f64| {
        let station = |p: DVec2, across: DVec2, width, near: &[u32]| {
            let inwards = side * across.normalize_or_zero();
            let away = |q: DVec2| inwards.dot((p - q).normalize_or_zero());
            let overlap = index
                .nearest_where(near, p, reach, |q| away(q) > 0.0)
                .map(|(q, w)| {
                    let overlap = spacing(width, w, height) - p.distance(q);
                    overlap * away(q)
                })
                .filter(|overlap| *overlap > OVERLAP)
                .map(|overlap| overlap.min((1.0 - NARROWEST) * width));
            Station {
                at: p,
                across,
                width,
                moves: overlap.map(|overlap| 0.5 * side * overlap),
                narrows: overlap.is_some(),
                passed: false,
            }
        };
        let places = stations(&line, &index, reach, station);
        widened(places, line.closed, tolerance, HIDDEN, nowhere, nowhere)
            .unwrap_or(line)
    };
    let [right, left] = [1.0, -1.0];
    let both = |line| narrowed(narrowed(line, right), left);
    lines.into_iter().map(both).collect()
}

/// The pieces of walls that are wider than `width`.
pub(super) fn wider(walls: &[Stroke], width: Mm) -> Vec<Axis> {
    let mut pieces: Vec<Axis> = Vec::new();
    for wall in walls {
        let mut goes_on = false;
        for (k, (a, b)) in wall.segments().enumerate() {
            let widths = [k, k + 1].map(|i| wall.width_at(i));
            let is_wider = widths.iter().any(|w| *w > width + OVERLAP);
            if is_wider && !goes_on {
                pieces.push(Axis {
                    points: vec![a],
                    thickness: vec![widths[0]],
                    closed: false,
                });
            }
            goes_on = is_wider;
            if let Some(piece) = pieces.last_mut().filter(|_| is_wider) {
                piece.points.push(b);
                piece.thickness.push(widths[1]);
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEIGHT: Mm = 0.2;
    const WIDTH: Mm = 0.45;

    /// A wall to the right, wider from 8 to 12 mm, with its outer side on y = 0.
    fn outside(widest: Mm) -> Stroke {
        let width = |x: f64| {
            let ramp = (1.0 - ((x - 10.0).abs() - 2.0)).clamp(0.0, 1.0);
            WIDTH + ramp * (widest - WIDTH)
        };
        let x = || (0..=200).map(|i| 0.1 * f64::from(i));
        let points = x().map(|x| DVec2::new(x, 0.5 * width(x)));
        Stroke::varying(points.collect(), x().map(width).collect(), false)
    }

    fn inside() -> Stroke {
        let y = 0.5 * WIDTH + spacing(WIDTH, WIDTH, HEIGHT);
        let ends = [DVec2::new(0.0, y), DVec2::new(20.0, y)];
        Stroke::new(ends.to_vec(), false, WIDTH)
    }

    #[test]
    fn an_inner_wall_keeps_its_spacing_and_its_inner_side() {
        let outside = outside(0.6);
        let usual = inside();
        let side = usual.points[0].y + 0.5 * WIDTH;
        let lines = give_way(
            vec![usual],
            std::slice::from_ref(&outside),
            WIDTH,
            HEIGHT,
            1e-4,
        );
        let line = &lines[0];
        let narrowest = line.widths.iter().copied().fold(1.0, f64::min);
        assert!((narrowest - 0.3).abs() < 0.001, "{narrowest}");
        for (p, w) in line.points.iter().zip(&line.widths) {
            assert!((p.y + 0.5 * w - side).abs() < 1e-3, "{p}");
            let k = (10.0 * p.x).round() as usize;
            let q = outside.points[k.min(200)];
            let meant = spacing(*w, outside.width_at(k.min(200)), HEIGHT);
            assert!((p.y - q.y - meant).abs() < OVERLAP + 1e-3, "{p}");
        }
    }

    #[test]
    fn a_bead_between_two_walls_gives_way_to_both() {
        let right = outside(0.55);
        let between = inside();
        let middle = between.points[0].y;
        let mut left = right.clone();
        left.points
            .iter_mut()
            .for_each(|p| p.y = 2.0 * middle - p.y);
        let walls = [right, left];
        let lines = give_way(vec![between], &walls, WIDTH, HEIGHT, 1e-4);
        let line = &lines[0];
        let narrowest = line.widths.iter().copied().fold(1.0, f64::min);
        assert!((narrowest - 0.25).abs() < 0.002, "{narrowest}");
        let beside = |x: f64| (x - 10.0).abs() < 2.0;
        for (p, w) in line.points.iter().zip(&line.widths) {
            if beside(p.x) {
                assert!((p.y - middle).abs() < 0.002, "{p}");
                assert!((w - 0.25).abs() < 0.002, "{p} {w}");
            }
        }
        assert_eq!([line.width_at(0), line.points[0].y], [WIDTH, middle]);
    }

    /// A wall outside that is 0.15 mm wider at once, as beside the pocket of a
    /// crotch, for half a millimetre.
    #[test]
    fn a_wall_gives_way_on_a_short_length() {
        let wide = 0.6;
        let at = |x: f64, w: f64| (DVec2::new(x, 0.5 * w), w);
        let (points, widths) = [
            at(0.0, WIDTH),
            at(9.75, WIDTH),
            at(9.75, wide),
            at(10.25, wide),
            at(10.25, WIDTH),
            at(20.0, WIDTH),
        ]
        .into_iter()
        .unzip();
        let outside = Stroke::varying(points, widths, false);
        let lines = give_way(vec![inside()], &[outside], WIDTH, HEIGHT, 1e-4);
        let line = &lines[0];
        let middle = line.points.iter().zip(&line.widths).min_by(|a, b| {
            let off = |p: &DVec2| (p.x - 10.0).abs();
            off(a.0).total_cmp(&off(b.0))
        });
        let (p, w) = middle.unwrap();
        let meant = 0.5 * wide + spacing(*w, wide, HEIGHT);
        assert!((p.y - meant).abs() < OVERLAP + 1e-3, "{p} {w}");
        // It has its usual width again within 0.3 mm.
        for (p, w) in line.points.iter().zip(&line.widths) {
            let away = (p.x - 10.0).abs() > 0.55;
            assert!(!away || (w - WIDTH).abs() < 1e-3, "{p} {w}");
        }
    }

    #[test]
    fn a_wall_becomes_no_narrower_than_a_share_of_its_width() {
        let lines =
            give_way(vec![inside()], &[outside(0.9)], WIDTH, HEIGHT, 1e-4);
        let narrowest = lines[0].widths.iter().copied().fold(1.0, f64::min);
        assert!((narrowest - NARROWEST * WIDTH).abs() < 1e-6, "{narrowest}");
    }

    #[test]
    fn beside_walls_of_their_usual_width_nothing_changes() {
        let usual = Stroke::new(outside(0.6).points, false, WIDTH);
        let lines = give_way(vec![inside()], &[usual], WIDTH, HEIGHT, 1e-4);
        assert_eq!(lines, [inside()]);
    }
}

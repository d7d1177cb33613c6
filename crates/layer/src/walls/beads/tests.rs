//! Walls of parts whose thickness is known: what they leave open, what they
//! paint outside of the part, and how much they extrude.

use crate::resolution::Resolution;
use crate::walls::beads;
use crate::walls::{WallPlan, walls};
use glam::DVec2;
use isoslice_planar::Area;
use isoslice_planar::bead::Bead;
use isoslice_planar::clip::union;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::shapes::circle;
use isoslice_settings::testing::{plan_with, usual_plan};
use std::f64::consts::PI;

const HEIGHT: f64 = 0.2;
/// Side of the raster's cells.
const CELL: f64 = 0.02;

/// How well beads fill a part.
#[derive(Debug)]
struct Print {
    /// Share of the part that no bead covers.
    open: f64,
    /// Content of the largest connected place that no bead covers, mm².
    hole: f64,
    /// How far beads reach out of the part, mm.
    out: f64,
    /// Extruded volume over the part's.
    volume: f64,
}

/// The walls of a part that is thin all over, as they are printed.
fn print(part: &Area) -> Print {
    let laid = walls(part, None, HEIGHT, &usual_plan(WallPlan::of));
    let pieces: Vec<Bead> = beads(&laid, HEIGHT)
        .into_iter()
        .flat_map(|b| usual_plan(Resolution::of).pieces(b))
        .collect();
    let bounds = part.bounds();
    let origin = bounds.min - 0.5;
    let size = (bounds.size() + 1.0) / CELL;
    let (columns, rows) = (size.x as usize + 1, size.y as usize + 1);
    let centre = |i: usize, j: usize| {
        origin + CELL * (DVec2::new(i as f64, j as f64) + 0.5)
    };
    // Areas that are left to skin or infill count as covered.
    let filled = EdgeGrid::new(&laid.fill, 0.3);
    let edges = EdgeGrid::new(part, 0.3);
    let mut covered = vec![false; columns * rows];
    let mut out: f64 = 0.0;
    for bead in &pieces {
        let r = 0.5 * bead.stroke.width;
        for (a, b) in bead.stroke.segments() {
            let (lo, hi) = (a.min(b) - r - origin, a.max(b) + r - origin);
            let range = |lo: f64, hi: f64, n: usize| {
                let from = (lo / CELL).floor().max(0.0) as usize;
                from..((hi / CELL).ceil().max(0.0) as usize).min(n)
            };
            for j in range(lo.y, hi.y, rows) {
                for i in range(lo.x, hi.x, columns) {
                    let p = centre(i, j);
                    let q = isoslice_planar::grid::nearest_on(p, a, b);
                    if p.distance(q) > r || covered[j * columns + i] {
                        continue;
                    }
                    covered[j * columns + i] = true;
                    if !edges.contains(p)
                        && let Some((_, q)) = edges.nearest(p)
                    {
                        out = out.max(p.distance(q));
                    }
                }
            }
        }
    }
    let mut open = vec![false; columns * rows];
    let mut inside = 0;
    for j in 0..rows {
        for i in 0..columns {
            let p = centre(i, j);
            if edges.contains(p) {
                inside += 1;
                let k = j * columns + i;
                open[k] = !covered[k] && !filled.contains(p);
            }
        }
    }
    let count = open.iter().filter(|o| **o).count();
    let mut largest = 0;
    for k in 0..open.len() {
        let mut todo = vec![k];
        let mut content = 0;
        while let Some(k) = todo.pop() {
            if std::mem::take(&mut open[k]) {
                content += 1;
                todo.extend([k - 1, k + 1, k - columns, k + columns]);
            }
        }
        largest = largest.max(content);
    }
    let volume: f64 = pieces.iter().map(|b| b.area() * b.stroke.length()).sum();
    let rest = laid.fill.content() * HEIGHT;
    Print {
        open: count as f64 / inside as f64,
        hole: largest as f64 * CELL * CELL,
        out,
        volume: (volume + rest) / (part.content() * HEIGHT),
    }
}

/// Collects what is wrong, to show all of it.
#[derive(Default)]
struct Faults(Vec<String>);

impl Faults {
    fn check(&mut self, right: bool, what: &str, part: &str, p: &Print) {
        if !right {
            self.0.push(format!("{what}: {part}: {p:?}"));
        }
    }

    /// A wall of thickness `t` stays inside and has the volume it should.
    fn check_strip(&mut self, t: f64, p: &Print) {
        let part = format!("{t:.2} mm");
        self.check(p.out < 0.025, "out", &part, p);
        // The round edges of the surface, h·(1 − π/4), stay open.
        let edges = 0.043 / t;
        let range = 0.97 - edges..1.12 - 0.5 * edges;
        self.check(range.contains(&p.volume), "volume", &part, p);
    }
}

impl Drop for Faults {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert!(self.0.is_empty(), "{}", self.0.join("\n"));
        }
    }
}

fn ring(points: &[(f64, f64)], turn: f64) -> Vec<DVec2> {
    let by = DVec2::from_angle(turn);
    points
        .iter()
        .map(|&(x, y)| by.rotate(DVec2::new(x, y)))
        .collect()
}

fn area(points: &[(f64, f64)], turn: f64) -> Area {
    Area::from(ring(points, turn))
}

/// Thicknesses from the narrowest bead to five walls, and an angle each.
fn thicknesses() -> impl Iterator<Item = (f64, f64)> {
    (0..44).map(|i| (0.28 + 0.04 * f64::from(i), 0.37 * f64::from(i)))
}

#[test]
fn strips_are_covered_to_their_corners() {
    let mut faults = Faults::default();
    for (t, turn) in thicknesses() {
        let strip = area(&[(0.0, 0.0), (12.0, 0.0), (12.0, t), (0.0, t)], turn);
        let p = print(&strip);
        let part = format!("{t:.2} mm");
        // Four corners of beads with a radius of up to half a wall's width.
        let corners = 4.0 * (1.0 - PI / 4.0) * 0.24_f64.powi(2);
        faults.check(p.open * 12.0 * t < corners + 0.04, "open", &part, &p);
        faults.check(p.hole < 0.03, "hole", &part, &p);
        faults.check_strip(t, &p);
    }
}

#[test]
fn wedges_are_covered_from_the_narrowest_bead_on() {
    let mut faults = Faults::default();
    for (length, turn) in [(30.0, 0.3), (15.0, 1.7), (6.0, 4.0)] {
        let wedge = area(&[(0.0, 0.0), (length, -1.0), (length, 1.0)], turn);
        let p = print(&wedge);
        let part = format!("{length}");
        let tip = 0.5 * 0.28 * 0.28 * 0.5 * length;
        let content = length;
        faults.check(p.hole < tip + 0.02, "hole", &part, &p);
        faults.check(p.open * content < tip + 0.16, "open", &part, &p);
        // Sharp wedges are fins from 0.12 mm on, with beads of 0.27 mm.
        faults.check(p.out < 0.076, "out", &part, &p);
    }
}

#[test]
fn tips_are_covered_to_where_they_are_as_thin_as_the_layer_is_high() {
    let mut faults = Faults::default();
    for (degrees, turn) in [(20.0_f64, 0.3), (25.0, 4.0), (30.0, 1.7)] {
        let half = (0.5 * degrees).to_radians().tan();
        let wedge =
            area(&[(0.0, 0.0), (4.0, -4.0 * half), (4.0, 4.0 * half)], turn);
        let p = print(&wedge);
        let part = format!("{degrees} degrees");
        // The triangle that is thinner than that, without the round end of the
        // bead before it. From 0.27 mm on it would be 1.8 times as large.
        let tip = 0.25 * HEIGHT * HEIGHT / half;
        faults.check(p.hole < tip, "hole", &part, &p);
        faults.check(p.out < 0.025, "out", &part, &p);
    }
}

#[test]
fn rings_are_covered() {
    let mut faults = Faults::default();
    for (t, _) in thicknesses() {
        let mut hole = circle(4.0 - t, 400);
        hole.reverse();
        let p = print(&Area::from_iter([circle(4.0, 400), hole]));
        faults.check(
            p.open < 0.002 + 0.003 / t,
            "open",
            &format!("{t:.2} mm"),
            &p,
        );
        faults.check_strip(t, &p);
    }
}

#[test]
fn crosses_and_junctions_are_covered() {
    let mut faults = Faults::default();
    for (t, turn) in thicknesses() {
        let h = 0.5 * t;
        let cross = area(
            &[
                (-6.0, -h),
                (-h, -h),
                (-h, -5.0),
                (h, -5.0),
                (h, -h),
                (6.0, -h),
                (6.0, h),
                (h, h),
                (h, 5.0),
                (-h, 5.0),
                (-h, h),
                (-6.0, h),
            ],
            turn,
        );
        let tee = area(
            &[
                (-6.0, -h),
                (-h, -h),
                (-h, -5.0),
                (h, -5.0),
                (h, -h),
                (6.0, -h),
                (6.0, h),
                (-6.0, h),
            ],
            turn,
        );
        for (name, part) in [("cross", cross), ("tee", tee)] {
            let p = print(&part);
            let name = format!("{name} {t:.2} mm");
            faults.check(p.open < 0.016, "open", &name, &p);
            faults.check(p.hole < 0.06, "hole", &name, &p);
            faults.check(p.out < 0.025, "out", &name, &p);
        }
    }
}

/// A pin is no node, however its outline is divided: the dot in its middle stays.
#[test]
fn pins_keep_their_core() {
    let mut faults = Faults::default();
    for corners in [24, 60, 97, 240] {
        for radius in [0.69, 0.698, 0.7, 0.703, 0.71, 0.74] {
            let ring = circle(radius, corners);
            let p = print(&Area::from(ring));
            let name = format!("{radius} mm, {corners} corners");
            faults.check(p.open < 0.06, "open", &name, &p);
        }
    }
}

/// Where two strips cross at an angle, the axes of both go on, and end nowhere.
#[test]
fn strips_that_cross_at_an_angle_leave_no_pit() {
    let mut faults = Faults::default();
    for degrees in [40.0_f64, 52.0, 66.0] {
        for t in [0.8, 0.9, 1.0, 1.1] {
            let strip = |turn: f64, t: f64| {
                let h = 0.5 * t;
                area(&[(-5.0, -h), (5.0, -h), (5.0, h), (-5.0, h)], turn)
            };
            let [a, b] =
                [strip(0.3, t), strip(0.3 + degrees.to_radians(), 0.9)];
            let p = print(&union(&a, &b));
            let name = format!("{degrees} degrees, {t} mm");
            faults.check(p.open < 0.015, "open", &name, &p);
            faults.check(p.hole < 0.06, "hole", &name, &p);
            faults.check(p.out < 0.03, "out", &name, &p);
        }
    }
}

#[test]
fn stars_are_covered_but_for_their_points() {
    let mut faults = Faults::default();
    for points in [5, 7, 12] {
        let star: Vec<(f64, f64)> = (0..2 * points)
            .map(|i| {
                let r = if i % 2 == 0 { 8.0 } else { 3.0 };
                let p =
                    DVec2::from_angle(PI * f64::from(i) / f64::from(points));
                (p.x * r, p.y * r)
            })
            .collect();
        let star = area(&star, 0.1);
        let p = print(&star);
        let part = format!("{points}");
        let content = star.content();
        // Each pointed end is left open where it is thinner than a bead.
        faults.check(p.hole < 0.15, "hole", &part, &p);
        faults.check(
            p.open * content < 0.3 * f64::from(points),
            "open",
            &part,
            &p,
        );
        faults.check(p.out < 0.025, "out", &part, &p);
    }
}

#[test]
fn no_post_vanishes() {
    let mut faults = Faults::default();
    for i in 0..40 {
        let d = 0.3 + 0.05 * f64::from(i);
        let p = print(&Area::from(circle(0.5 * d, 120)));
        let part = format!("{d:.2} mm");
        faults.check(p.open < 0.12, "open", &part, &p);
        faults.check(p.out < 0.025, "out", &part, &p);
        faults.check(
            (if d < 0.4 { 0.25 } else { 0.6 }..1.3).contains(&p.volume),
            "volume",
            &part,
            &p,
        );
    }
}

#[test]
fn round_and_pointed_tips_are_covered() {
    let mut faults = Faults::default();
    for turn in [0.0, 0.4, 1.3] {
        let ellipse = |a: f64, b: f64| {
            let points: Vec<(f64, f64)> = circle(1.0, 200)
                .into_iter()
                .map(|p| (a * p.x, b * p.y))
                .collect();
            area(&points, turn)
        };
        for (a, b) in [(0.7, 0.36), (1.2, 0.36), (0.6, 0.25)] {
            let p = print(&ellipse(a, b));
            let part = format!("ellipse {a} {b}");
            faults.check(p.open < 0.02, "open", &part, &p);
            faults.check(p.out < 0.025, "out", &part, &p);
            faults.check(p.volume < 1.02, "volume", &part, &p);
        }
        // A strip of 0.6 mm that ends in a point of 70°.
        let bolt = area(
            &[
                (0.0, -0.3),
                (6.0, -0.3),
                (6.43, 0.0),
                (6.0, 0.3),
                (0.0, 0.3),
            ],
            turn,
        );
        let p = print(&bolt);
        let part = format!("bolt {turn}");
        faults.check(p.hole < 0.02, "hole", &part, &p);
        faults.check(p.volume < 1.02, "volume", &part, &p);
    }
}

/// A square of `2·half` less four discs of radius `r` around the middles of
/// its sides, or farther out: four strips that meet, and whose sides are
/// `gap` from the middle.
fn junction(half: f64, r: f64, gap: f64) -> Area {
    let far = gap + r;
    let reach = (r * r - (far - half).powi(2)).sqrt();
    let mut points = Vec::new();
    for side in 0..4 {
        let by = DVec2::from_angle(0.5 * PI * f64::from(side));
        let first = reach.atan2(far - half);
        for k in 0..=60 {
            let angle = PI + first * (1.0 - f64::from(k) / 30.0);
            let p = DVec2::X * far + DVec2::from_angle(angle) * r;
            points.push(by.rotate(p));
        }
        points.push(by.rotate(DVec2::splat(half)));
    }
    Area::from(points)
}

#[test]
fn what_strips_share_where_they_meet_is_laid_once() {
    let mut faults = Faults::default();
    for i in 0..8 {
        let gap = 0.87 + 0.03 * f64::from(i);
        let part = junction(1.6, 1.0, gap);
        let p = print(&part);
        let name = format!("{gap:.2} mm");
        faults.check(p.volume < 1.03, "volume", &name, &p);
        faults.check(p.hole < 0.08, "hole", &name, &p);
        faults.check(p.out < 0.025, "out", &name, &p);
    }
}

#[test]
fn walls_fill_the_pockets_between_them() {
    let mut faults = Faults::default();
    // Two strips of 0.9 mm that cross at an angle.
    for angle in [0.9, 1.17, 1.4, 0.5 * PI] {
        let h = 0.45;
        let (u, v) = (DVec2::X, DVec2::from_angle(angle));
        let ends = [u, v, -u, -v];
        let mut points: Vec<DVec2> = Vec::new();
        for (k, end) in ends.into_iter().enumerate() {
            let side = end.perp() * h;
            points.extend([end * 6.0 - side, end * 6.0 + side]);
            // Where the sides of the two meet.
            points.push((end + ends[(k + 1) % 4]) * h / angle.sin());
        }
        let part = Area::from(points);
        let p = print(&part);
        let name = format!("{angle:.2}");
        // A bead of its own would be a dab, which costs two travels.
        faults.check(p.hole < 0.055, "hole", &name, &p);
        faults.check(p.volume < 1.04, "volume", &name, &p);
    }
}

#[test]
fn walls_of_two_widths_lie_a_spacing_apart() {
    const HALF: f64 = 15.0;
    let plan = plan_with(WallPlan::of, |s| {
        s.outer_wall_width = 0.45.into();
        s.inner_wall_width = 0.6.into();
        s.walls = 3;
    });
    let square = isoslice_planar::shapes::rect(-HALF, -HALF, HALF, HALF);
    let laid = walls(&square, None, HEIGHT, &plan);
    let depth = |bead: &Bead| {
        let middles = bead.stroke.segments().map(|(a, b)| a.midpoint(b));
        let depths = middles.map(|p| HALF - p.abs().max_element());
        depths.fold(f64::INFINITY, f64::min)
    };
    let mut found: Vec<f64> = beads(&laid, HEIGHT).iter().map(depth).collect();
    found.sort_by(f64::total_cmp);
    assert_eq!(found.len(), 3);
    for (found, meant) in found.iter().zip(plan.depths(HEIGHT).0) {
        assert!((found - meant).abs() < 1e-3, "{found} for {meant}");
    }
}

/// How many strokes the walls of a part are, and how many of them are closed.
fn strokes(part: &Area) -> [usize; 2] {
    let laid = walls(part, None, HEIGHT, &usual_plan(WallPlan::of));
    let all: Vec<_> = laid.lines.iter().chain(&laid.thin).flatten().collect();
    [all.len(), all.iter().filter(|s| s.closed).count()]
}

#[test]
fn walls_have_a_loop_in_each_bulge() {
    // A ring from 1 to 3 mm thick.
    let wave = |side: f64| -> Vec<DVec2> {
        let at = |k: u32| {
            let angle = PI * f64::from(k) / 720.0;
            let half = 1.0 + 0.5 * (9.0 * angle).sin();
            DVec2::from_angle(angle) * (15.0 + side * half)
        };
        (0..1440).map(at).collect()
    };
    let mut hole = wave(-1.0);
    hole.reverse();
    assert_eq!(strokes(&Area::from_iter([wave(1.0), hole])), [11, 11]);
}

#[test]
fn two_walls_go_on_into_tips_and_through_nodes() {
    // A strip that is cut aslant, by 65°.
    let strip =
        area(&[(0.0, 0.0), (12.0, 0.0), (12.5, 1.07), (0.5, 1.07)], 0.3);
    assert_eq!(strokes(&strip), [1, 1]);
    // Three arms of 1.1 mm.
    let inner = 1.1 / 3.0_f64.sqrt();
    let star: Vec<DVec2> = (0..3)
        .flat_map(|k| {
            let along = DVec2::from_angle(2.0 * PI * f64::from(k) / 3.0);
            let side = 0.55 * along.perp();
            let corner = DVec2::from_angle(PI / 3.0).rotate(along) * inner;
            [12.0 * along - side, 12.0 * along + side, corner]
        })
        .collect();
    assert_eq!(strokes(&Area::from(star)), [1, 1]);
    // A tooth that is too thin for two walls keeps its bead.
    let tooth = area(
        &[
            (0.0, 0.0),
            (6.0, 0.0),
            (6.0, 1.6),
            (3.3, 1.6),
            (3.3, 2.4),
            (2.9, 2.4),
            (2.9, 1.6),
            (0.0, 1.6),
        ],
        0.2,
    );
    let tip = DVec2::from_angle(0.2).rotate(DVec2::new(3.1, 2.3));
    let laid = walls(&tooth, None, HEIGHT, &usual_plan(WallPlan::of));
    let all = laid.lines.iter().chain(&laid.thin).flatten();
    let near = all.flat_map(|s| &s.points).map(|p| p.distance(tip));
    assert!(near.fold(f64::INFINITY, f64::min) < 0.15);
}

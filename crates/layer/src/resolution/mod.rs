//! Resolution of paths: every stroke with as few points as its role permits.
//!
//! In: strokes, as exact as the geometry made them, and their roles. Out: these
//! strokes with fewer points.
//!
//! Guarantees, of a stroke of a role whose tolerance is t ([`Resolution::tolerance`]):
//! - each point of the input is within t of the output;
//! - the output lies on both sides of the input, so that rings hardly shrink;
//! - an open stroke keeps its ends;
//! - where the width varies, it is linear between the points that stay, to
//!   [`WIDTH`] of itself, and to t/2 on each edge of a stroke that shows. Where
//!   it changes faster than a printer can follow, this holds for its mean.
//!
//! Not guaranteed: that strokes closer to each other than t do not touch.
//!
//! `runs` cuts beads of varying width into pieces of constant width.
//!
//! Fuzzy skin is rough on purpose: its points come after this stage.

mod crowded;
mod lines;
mod plan;
mod runs;
mod way;

pub use plan::Resolution;

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::arc::{self, Turn};
use isoslice_planar::bead::{Bead, Role, Stroke};
use isoslice_planar::simplify::{simplify_line, simplify_path};

/// Share of `accuracy` by which what shows is thinned. The outline has used
/// most of it, and has few points already.
const SHOWN: f64 = 0.3;

/// Greatest distance of what shows from where it was meant if its moves are
/// crowded, as a share of `accuracy`, and in mm. Together with what the outline is
/// off, 99 % of such walls are then within 8 µm of the surface, if the accuracy
/// is 5 µm. Most printers step by 12.5 µm.
const BENT: f64 = 1.5;
const BENT_MOST: Mm = 0.0075;

/// Greatest distance of the edges of a bead that shows and varies in width from
/// where they were meant. 99 % of the outer walls of thin sheets are then within
/// 15 µm of the surface, with the outline's own distance from it.
const EDGE: f64 = 2.0;
const EDGE_MOST: Mm = 0.010;

/// Share of `path_accuracy` by which what lies beside the part is thinned.
const BESIDE: f64 = 0.25;

/// Share of `path_accuracy` by which supports are thinned: with less they take
/// a quarter more moves, with more they hold a little less of what is above.
const SUPPORT: f64 = 0.5;

/// Share of `path_accuracy` by which fill that nobody sees is thinned. No wall
/// lies against a stroke of it with a distance of its own, and strokes in the
/// pockets of a lattice bend often: with 1.5 a gyroid ball's fill has an eighth
/// fewer moves than with 1, and covers as much.
const FILL: f64 = 1.5;

/// How far a width may be from the line between those that stay, as a share
/// of itself.
const WIDTH: f64 = 0.015;

/// Share of a role's tolerance by which strokes of varying width are thinned.
/// Most of the thinning is left to the pieces of constant width that are made
/// of them: a path that is thinned twice by as much as possible keeps too many
/// points.
const VARYING: f64 = 0.1;

/// Share of a role's tolerance by which the middles of pieces may be off. With 0.9
/// inner walls take 2 % fewer moves, but half of a gyroid's are 11.5 µm from
/// where they should be, not 9 µm.
const PIECES: f64 = 0.65;

/// Share of a role's tolerance that is for arcs, if the settings ask for them.
/// Arcs are laid along the curve that lines stand for, which they cross.
const ARCS: f64 = 0.7;

/// Points, and for each way between two of them the arc along it, if it is one.
pub type Arcs = (Vec<DVec2>, Vec<Option<Turn>>);

impl Resolution {
    /// Greatest distance of the path of a bead of this role from where it was
    /// meant.
    pub fn tolerance(&self, role: Role) -> Mm {
        match role {
            Role::Overhang | Role::OuterWall => SHOWN * self.accuracy,
            // Loops around the part keep a distance from it.
            Role::Skirt | Role::Brim => BESIDE * self.path_accuracy,
            Role::Support | Role::SupportInterface => {
                SUPPORT * self.path_accuracy
            }
            Role::GapFill | Role::InternalSkin | Role::SparseInfill => {
                FILL * self.path_accuracy
            }
            _ => self.path_accuracy,
        }
    }

    /// Does what [`Resolution::tolerance`] does for what shows where moves would
    /// be short.
    fn crowded(&self) -> Mm {
        (BENT * self.accuracy).min(BENT_MOST)
    }

    /// Greatest distance of the edges of what shows and varies in width from where
    /// they were meant.
    fn edge(&self) -> Mm {
        (EDGE * self.accuracy).min(EDGE_MOST)
    }

    /// Greatest distance of arcs from the curve for which the lines of a bead of
    /// this role stand; none without arcs.
    fn arc_tolerance(&self, role: Role) -> Option<Mm> {
        self.arcs.then(|| {
            if role.shows() {
                self.crowded()
            } else {
                ARCS * self.tolerance(role)
            }
        })
    }

    /// The way along the path of a bead of this role in arcs, or in lines where these
    /// are fewer; none without arcs.
    pub fn arcs(&self, path: &[DVec2], role: Role) -> Option<Arcs> {
        let arcs = arc::fit(path, self.arc_tolerance(role)?);
        let lines = self.thinned(path, false, role, ARCS);
        Some(if lines.len() < arcs.0.len() {
            let turns = vec![None; lines.len().saturating_sub(1)];
            (lines, turns)
        } else {
            arcs
        })
    }

    /// Thins a stroke of a bead of this role.
    pub fn thin(&self, stroke: &mut Stroke, role: Role) {
        let n = stroke.points.len();
        if n < 3 {
            return;
        }
        let varies = stroke.widths.len() == n;
        if !varies {
            let share = if self.arcs { 1.0 - ARCS } else { 1.0 };
            // Arcs find the curve by themselves.
            if !(role.shows() && self.arcs) {
                stroke.points =
                    self.thinned(&stroke.points, stroke.closed, role, share);
            }
            return;
        }
        let tolerance = VARYING * self.tolerance(role);
        let short = lines::shortest(role);
        let slack = |width: Mm| {
            if role.shows() {
                tolerance.min(WIDTH * width)
            } else {
                WIDTH * width
            }
        };
        let thinned = {
            let Stroke {
                points,
                closed,
                widths,
                ..
            } = &*stroke;
            simplify_path(points, *closed, tolerance, |i, j| {
                linear(points, widths, [i, j], short, slack)
            })
        };
        stroke.widths = thinned.iter().map(|t| stroke.widths[t.1]).collect();
        stroke.points = thinned.into_iter().map(|t| t.0).collect();
    }

    /// Fewer points of a path of one width. If it does not show, they are within a
    /// share of its tolerance.
    fn thinned(
        &self,
        path: &[DVec2],
        closed: bool,
        role: Role,
        share: f64,
    ) -> Vec<DVec2> {
        let tolerance = self.tolerance(role);
        if role.shows() {
            return crowded::thinned(path, closed, tolerance, self.crowded());
        }
        let points = simplify_line(path, closed, share * tolerance);
        points.into_iter().map(|(point, _)| point).collect()
    }

    /// The bead in pieces of constant width, as long as the tolerances of its role
    /// permit.
    pub fn pieces(&self, bead: Bead) -> Vec<Bead> {
        self.pieces_with(bead, None)
    }

    /// Does what [`Resolution::pieces`] does for a bead that keeps its way. If there
    /// are to be arcs, a piece may have many points, along which one arc leads.
    pub fn final_pieces(&self, bead: Bead) -> Vec<Bead> {
        let flat = bead.stroke.levels.is_empty();
        let arcs = self.arc_tolerance(bead.role).filter(|_| flat);
        self.pieces_with(bead, arcs)
    }

    fn pieces_with(&self, bead: Bead, arcs: Option<Mm>) -> Vec<Bead> {
        let off = if bead.role.shows() {
            self.edge()
        } else {
            PIECES * self.tolerance(bead.role)
        };
        runs::pieces_within(bead, off, arcs)
    }
}

/// True if the widths between two points are near to those on the straight
/// line; on a line that is too short for the printer to follow them, if their
/// mean is.
fn linear(
    points: &[DVec2],
    widths: &[Mm],
    [i, j]: [usize; 2],
    short: Mm,
    slack: impl Fn(Mm) -> Mm,
) -> bool {
    let n = points.len();
    let step = |k: usize| points[k % n].distance(points[(k + 1) % n]);
    let length: Mm = (i..j).map(step).sum();
    let (from, to) = (widths[i % n], widths[j % n]);
    let (mut done, mut sum) = (0.0, 0.0);
    let mut near = true;
    for k in i..j {
        let meant = from + done / length.max(1e-12) * (to - from);
        let (width, next) = (widths[k % n], widths[(k + 1) % n]);
        near &= (width - meant).abs() <= slack(width);
        sum += 0.5 * (width + next) * step(k);
        done += step(k);
        if !near && length > short {
            return false;
        }
    }
    let mean = 0.5 * (from + to);
    near || (sum - mean * length).abs() <= slack(mean) * length
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::grid::nearest_on;
    use isoslice_planar::shapes::circle;
    use isoslice_settings::testing::usual_plan;
    use std::f64::consts::TAU;

    fn off(from: &[DVec2], to: &Stroke) -> Mm {
        let distance = |p: &DVec2| {
            let all = to.segments().map(|(a, b)| nearest_on(*p, a, b));
            all.map(|q| q.distance(*p)).fold(f64::INFINITY, f64::min)
        };
        from.iter().map(distance).fold(0.0, f64::max)
    }

    fn arc(radius: Mm, n: usize) -> Vec<DVec2> {
        let at = |i: usize| DVec2::from_angle(2.0 * i as f64 / n as f64);
        (0..=n).map(|i| radius * at(i)).collect()
    }

    #[test]
    fn what_shows_is_thinned_less() {
        let meant = usual_plan(Resolution::of);
        let points = arc(10.0, 2000);
        let mut counts = Vec::new();
        for role in [Role::OuterWall, Role::GapFill] {
            let mut stroke = Stroke::new(points.clone(), false, 0.45);
            meant.thin(&mut stroke, role);
            let worst = off(&points, &stroke);
            let tolerance = meant.tolerance(role);
            assert!(worst <= 1.001 * tolerance, "{worst} {tolerance}");
            assert!(worst > 0.5 * tolerance);
            assert_eq!(stroke.points.first(), points.first());
            assert_eq!(stroke.points.last(), points.last());
            // On both sides: the length is that of the arc.
            assert!((stroke.length() - 20.0).abs() < 0.2 * tolerance * 20.0);
            // A chord's sagitta is twice the tolerance at most.
            let least = 20.0 / (4.0 * (10.0 * tolerance).sqrt());
            assert!((stroke.points.len() as f64) < 1.3 * least + 3.0);
            counts.push(stroke.points.len());
        }
        assert!(counts[0] > 3 * counts[1], "{counts:?}");
    }

    #[test]
    fn what_shows_is_thinned_more_where_it_bends_much() {
        let meant = usual_plan(Resolution::of);
        for (radius, tolerance) in
            [(1.5, meant.crowded()), (9.0, SHOWN * meant.accuracy)]
        {
            let ring = circle(radius, 2000);
            let mut stroke = Stroke::new(ring.clone(), true, 0.45);
            meant.thin(&mut stroke, Role::OuterWall);
            let worst = off(&ring, &stroke);
            assert!((0.5..=1.001).contains(&(worst / tolerance)), "{worst}");
            assert!(stroke.length() / stroke.points.len() as f64 > 0.3);
        }
    }

    /// A wheel of 30 mm with two smooth notches in its rim.
    #[test]
    fn what_shows_is_thinned_more_only_where_moves_would_be_short() {
        let meant = usual_plan(Resolution::of);
        let wheel = |p: &DVec2| p.length() > 29.9;
        let mut ring = circle(30.0, 20_000);
        for side in [0, ring.len() / 2] {
            // 0.3 mm deep, 2.8 mm long.
            for k in 0..300 {
                let depth = 0.5 - 0.5 * (TAU * k as f64 / 300.0).cos();
                let p = &mut ring[side + k];
                *p *= 1.0 - 0.3 * depth / p.length();
            }
        }
        let mut stroke = Stroke::new(ring.clone(), true, 0.45);
        meant.thin(&mut stroke, Role::OuterWall);
        assert!(off(&ring, &stroke) <= 1.001 * meant.crowded());
        let (round, notched): (Vec<DVec2>, Vec<DVec2>) =
            ring.iter().partition(|p| wheel(p));
        let near = |p: &&DVec2| notched.iter().all(|q| q.distance(**p) > 2.0);
        let round: Vec<DVec2> = round.iter().filter(near).copied().collect();
        let fine = meant.tolerance(Role::OuterWall);
        assert!(off(&round, &stroke) <= 1.001 * fine);
        let moves = |s: &Stroke| {
            s.segments().filter(|(a, b)| a.distance(*b) < 0.2).count()
        };
        let fine = simplify_line(&ring, true, fine).into_iter().map(|p| p.0);
        let fine = Stroke::new(fine.collect(), true, 0.45);
        assert!(stroke.points.len() < fine.points.len());
        assert!(moves(&stroke) <= moves(&fine) / 2);
    }

    /// Paths of few points, and those that begin where moves are short.
    #[test]
    fn short_paths_stay_whole() {
        let meant = usual_plan(Resolution::of);
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let whole = [p(0.0, 0.0), p(5.0, 0.0), p(5.0, 5.0), p(0.0, 5.0)];
        for n in 0..=4 {
            for closed in [false, true] {
                let out =
                    meant.thinned(&whole[..n], closed, Role::OuterWall, 1.0);
                assert_eq!(out.len(), n, "{n} {closed}");
            }
        }
        let fine = [p(0.0, 0.0), p(0.05, 0.0), p(0.05, 5.0), p(0.0, 5.0)];
        let out = meant.thinned(&fine, true, Role::OuterWall, 1.0);
        assert_eq!(out.len(), 4, "{out:?}");
    }

    #[test]
    fn arcs_are_fewer_and_longer_than_lines() {
        use isoslice_settings::testing::plan_with;
        let count = |arcs: bool, accuracy: Mm, radius: Mm, waves: f64| {
            let plan = plan_with(Resolution::of, |s| {
                s.gcode.arcs = arcs;
                s.accuracy = accuracy;
            });
            let ring = circle(radius, 2000);
            let at = |p: &DVec2| (waves * p.to_angle()).sin();
            let points = ring.iter().map(|p| *p * (1.0 + 0.1 * at(p)));
            let mut stroke = Stroke::new(points.collect(), true, 0.45);
            stroke.widths = ring.iter().map(|p| 0.45 + 0.05 * at(p)).collect();
            plan.thin(&mut stroke, Role::OuterWall);
            let bead = Bead::new(Role::OuterWall, stroke, 0.2);
            let pieces = plan.final_pieces(bead).into_iter();
            let moves = |piece: Bead| {
                let lines: Vec<DVec2> = piece.stroke.path().collect();
                let arcs = plan.arcs(&lines, Role::OuterWall);
                arcs.map_or(lines.len(), |arcs| arcs.0.len()) - 1
            };
            pieces.map(moves).sum::<usize>()
        };
        for accuracy in [0.001, 0.005] {
            for (radius, waves) in [(0.5, 2.0), (1.0, 3.0), (8.0, 12.0)] {
                let [lines, arcs] = [false, true]
                    .map(|arcs| count(arcs, accuracy, radius, waves));
                assert!(arcs <= lines, "{radius} {accuracy}: {arcs} {lines}");
            }
        }
    }

    #[test]
    fn widths_keep_points_where_they_bend() {
        let points: Vec<DVec2> =
            (0..=100).map(|i| DVec2::X * (0.1 * i as f64)).collect();
        // A ramp up to the middle, then even.
        let meant = |x: Mm| 0.4 + 0.04 * x.min(5.0);
        let mut stroke = Stroke::new(points, false, 0.5);
        stroke.widths = stroke.points.iter().map(|p| meant(p.x)).collect();
        usual_plan(Resolution::of).thin(&mut stroke, Role::GapFill);
        assert!((3..=4).contains(&stroke.points.len()), "{stroke:?}");
        assert_eq!(stroke.widths.len(), stroke.points.len());
        for (p, w) in stroke.points.iter().zip(&stroke.widths) {
            assert!((w - meant(p.x)).abs() < 1e-9);
        }
        assert!(stroke.points.iter().any(|p| (p.x - 5.0).abs() < 0.3));
    }

    #[test]
    fn a_wedge_has_two_points() {
        let points: Vec<DVec2> =
            (0..=100).map(|i| DVec2::X * (0.1 * f64::from(i))).collect();
        for role in [Role::OuterWall, Role::InnerWall, Role::GapFill] {
            let mut stroke = Stroke::new(points.clone(), false, 0.5);
            stroke.widths = points.iter().map(|p| 0.4 + 0.03 * p.x).collect();
            usual_plan(Resolution::of).thin(&mut stroke, role);
            assert_eq!(stroke.points, [DVec2::ZERO, DVec2::X * 10.0]);
            assert_eq!(stroke.widths.len(), 2);
        }
    }

    #[test]
    fn a_path_does_not_go_zigzag_where_its_width_varies_a_little() {
        let meant = usual_plan(Resolution::of);
        // The places and widths that two noisy edges give: 2 µm to either side.
        let noise = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let at = |i: usize| DVec2::new(0.07 * i as f64, 0.002 * noise(i));
        let mut stroke = Stroke::new((0..=30).map(at).collect(), false, 0.5);
        stroke.widths = (0..=30).map(|i| 0.5 + 0.004 * noise(i)).collect();
        let points = stroke.points.clone();
        let pieces = meant.pieces(Bead::new(Role::OuterWall, stroke, 0.2));
        let [piece] = pieces.as_slice() else {
            panic!("{pieces:?}");
        };
        assert!(piece.stroke.points.len() <= 6, "{:?}", piece.stroke.points);
        assert!(off(&points, &piece.stroke) <= 1.001 * meant.crowded());
    }

    #[test]
    fn closed_strokes_stay_closed_and_nothing_vanishes() {
        let meant = usual_plan(Resolution::of);
        let ring = circle(3.0, 400);
        let mut stroke = Stroke::new(ring.clone(), true, 0.45);
        meant.thin(&mut stroke, Role::InnerWall);
        assert!(stroke.closed && stroke.points.len() < 30);
        assert!(off(&ring, &stroke) <= 0.02501);
        // A stroke of varying width keeps more points: a later step thins it
        // further.
        let mut varying = Stroke::new(ring.clone(), true, 0.45);
        varying.widths = vec![0.45; 400];
        meant.thin(&mut varying, Role::InnerWall);
        assert!(varying.closed && varying.points.len() < 100);
        let most = VARYING * meant.path_accuracy;
        assert!(off(&ring, &varying) <= 1.01 * most);
        // A ring narrower than the tolerance stays as it is.
        let tiny: Vec<DVec2> = ring.iter().map(|p| 0.003 * *p).collect();
        let mut stroke = Stroke::new(tiny.clone(), true, 0.45);
        meant.thin(&mut stroke, Role::InnerWall);
        assert!(stroke.points.len() >= 3 && off(&tiny, &stroke) < 0.025);
    }
}

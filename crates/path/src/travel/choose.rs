//! Decides which way a travel takes.
//!
//! In: two points. Out: the way between them, and whether to retract on it.
//! The first of these ways that will do is taken:
//!
//! 1. straight, if it is hidden, or too short for a retraction and crosses
//!    nothing that shows;
//! 2. straight and retracted, from a support or a skirt: beside the part a string
//!    would stay in the air, and over the part a blob;
//! 3. over sparse infill, which hides the way;
//! 4. inside the island, round its holes and notches, if the straight way leads
//!    over what shows;
//! 5. from one island to another, through the air once;
//! 6. straight and retracted.

use super::comb::Comb;
use super::decide::Obstacles;
use super::{Ground, Travel, TravelPlan, gate, of_part, wipe};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Bead;
use isoslice_planar::clip::intersection;
use isoslice_planar::{Solid, path_length};
use isoslice_settings::{Combing, Hidden, HopWhen};
use std::borrow::Cow;
use std::cell::OnceCell;

/// How far ways over sparse infill keep from its border where they can, as a
/// share of a line's width. At this distance they are surely inside.
const OFF_BORDER: f64 = 0.25;

/// Greatest length of a way round that shows, as a multiple of the straight way,
/// between places nearer than `retract.min_travel`. Round holes of 1.2 mm and
/// more it is less than 3. Ways from wall to wall of a vase, or all round an
/// island of a gyroid (7 to 12), cost more than the short string or the scar
/// that they avoid.
const MOST_ROUND: f64 = 3.0;

/// Finds the travels of a layer.
pub(super) struct Planner<'a> {
    ground: Ground<'a>,
    obstacles: Obstacles<'a>,
    comb: Comb<'a>,
    /// Ways over sparse infill.
    sparse: OnceCell<Comb<'a>>,
    /// Ways over what the next layer covers, made when a way leads over top
    /// skin.
    covered: OnceCell<Comb<'a>>,
    /// How far travels keep from the outline where they can. At this distance a
    /// travel is inside all walls.
    clearance: Mm,
    plan: &'a TravelPlan,
}

impl<'a> Planner<'a> {
    /// A planner for a layer with these beads, in print order.
    pub(super) fn new(
        beads: &'a [Bead],
        ground: Ground<'a>,
        plan: &'a TravelPlan,
    ) -> Planner<'a> {
        let clearance = ground.border.max(plan.outer_width);
        Planner {
            ground,
            obstacles: Obstacles::new(beads, ground, plan),
            comb: Comb::new(Cow::Borrowed(ground.outline()), clearance),
            sparse: OnceCell::new(),
            covered: OnceCell::new(),
            clearance,
            plan,
        }
    }

    /// The travel from `a`, where the bead `before` has ended, to `b`, where
    /// the `next`th bead begins.
    pub(super) fn travel(
        &self,
        a: DVec2,
        b: DVec2,
        before: Option<&Bead>,
        next: usize,
    ) -> Travel {
        let retract = &self.plan.retract;
        let mut travel = if a.distance(b) < retract.min_travel {
            self.short(a, b, before, next)
        } else {
            self.way(a, b, before, next)
        };
        if !travel.retract {
            return travel;
        }
        let wiped = before.and_then(|bead| wipe::path(bead, retract));
        if let Some((wipe, end)) = wiped {
            // The travel begins where the wipe has ended.
            travel = self.way(end, b, before, next);
            travel.retract = true;
            travel.wipe = wipe;
        }
        let from = travel.wipe.last().copied().unwrap_or(a);
        travel.hop = self.hops(from, &travel.points, next);
        travel
    }

    /// The travel to a place that is too near for a retraction. It goes round what
    /// shows, unless the way round leads through the air as well. A way round
    /// that shows itself asks for a retraction if it is not short, and is not
    /// taken if it is much longer than the straight one.
    fn short(
        &self,
        a: DVec2,
        b: DVec2,
        before: Option<&Bead>,
        next: usize,
    ) -> Travel {
        let straight = Travel::straight(b, false);
        if !self.is_in_the_way(&[a, b], next) {
            return straight;
        }
        let round = self.way(a, b, before, next);
        let way: Vec<DVec2> = [a]
            .into_iter()
            .chain(round.points.iter().copied())
            .collect();
        if self.obstacles.air(&way) {
            return straight;
        }
        if !round.retract {
            return round;
        }
        let (length, least) =
            (path_length(&way, false), self.plan.retract.min_travel);
        if length > least.max(MOST_ROUND * a.distance(b)) {
            return straight;
        }
        Travel {
            retract: length >= least,
            ..round
        }
    }

    fn way(
        &self,
        a: DVec2,
        b: DVec2,
        before: Option<&Bead>,
        next: usize,
    ) -> Travel {
        let inside = before.is_some_and(of_part);
        if !inside && !self.ground.outline().grid().contains(a) {
            return Travel::straight(b, true);
        }
        let direct = [a, b];
        if self.hidden(&direct, next) {
            return self.finished(&direct, false);
        }
        let combing = self.plan.combing;
        let straight = || self.finished(&direct, true);
        if combing == Combing::Off {
            return straight();
        }
        let longest = a.distance(b) + self.plan.max_detour;
        let fits = |way: &Vec<DVec2>| path_length(way, false) <= longest;
        if let Some(way) = self.internal_bridges(a, b, longest).filter(fits)
            && self.hidden(&way, next)
        {
            return self.finished(&way, false);
        }
        if combing == Combing::WithinInfill {
            return straight();
        }
        // A travel that is retracted goes straight, unless the straight way
        // leads over what shows.
        let in_the_way = self.is_in_the_way(&direct, next);
        let retract = &self.plan.retract;
        let may_hide =
            retract.hidden != Hidden::SparseInfill && retract.when_crossing;
        if !in_the_way && !may_hide {
            return straight();
        }
        if let Some(way) = self.inside(a, b, longest, next).filter(fits) {
            let retract = !self.hidden(&way, next);
            return if retract && !in_the_way {
                straight()
            } else {
                self.finished(&way, retract)
            };
        }
        let through = gate::way(&self.comb, a, b, longest);
        match through.filter(fits) {
            Some(way) => self.finished(&way, true),
            None => straight(),
        }
    }

    /// A way over sparse infill between two points near it, with both points.
    fn internal_bridges(
        &self,
        a: DVec2,
        b: DVec2,
        longest: Mm,
    ) -> Option<Vec<DVec2>> {
        let sparse = self.ground.sparse;
        if sparse.area().is_empty() {
            return None;
        }
        let comb = self.sparse.get_or_init(|| {
            let clearance = OFF_BORDER * self.plan.infill_width;
            Comb::new(Cow::Borrowed(sparse), clearance)
        });
        let reach = self.plan.inner_width;
        let from = comb.entry(a, reach)?;
        let to = comb.entry(b, reach)?;
        let points = comb.way(from, to, longest)?;
        let mut way = Vec::with_capacity(points.len() + 4);
        way.extend([a, from]);
        way.extend(points);
        way.extend([to, b]);
        way.dedup();
        Some(way)
    }

    /// A way between two points inside their island, with both points.
    fn inside(
        &self,
        a: DVec2,
        b: DVec2,
        longest: Mm,
        next: usize,
    ) -> Option<Vec<DVec2>> {
        let with_ends = |points: Vec<DVec2>| {
            let mut way = Vec::with_capacity(points.len() + 2);
            way.push(a);
            way.extend(points);
            way.push(b);
            way
        };
        let way = with_ends(self.comb.way(a, b, longest)?);
        if !self.is_over_top(&way, next) {
            return Some(way);
        }
        let round = || {
            let above = self.ground.view.above.first()?.outline;
            let comb = self.covered.get_or_init(|| {
                let area =
                    intersection(self.ground.outline().area(), above.area());
                Comb::new(Cow::Owned(Solid::new(area)), self.clearance)
            });
            let round = with_ends(comb.way(a, b, longest)?);
            let good = path_length(&round, false) <= longest
                && !self.is_over_top(&round, next);
            good.then_some(round)
        };
        Some(round().unwrap_or(way))
    }

    /// The travel along a way.
    fn finished(&self, way: &[DVec2], retract: bool) -> Travel {
        let retract_if = &self.plan.retract;
        let long = path_length(way, false) > retract_if.max_unretracted;
        Travel {
            points: way[1..].to_vec(),
            retract: retract || long,
            ..Travel::default()
        }
    }

    /// True if a way leads over what shows: out of the part, over an outer wall, or
    /// over top skin, unless combing allows that.
    fn is_in_the_way(&self, way: &[DVec2], next: usize) -> bool {
        let o = &self.obstacles;
        o.air(way) || o.outer_wall(way, next) || self.is_over_top(way, next)
    }

    /// True if a way leads over top skin and combing does not allow that.
    fn is_over_top(&self, way: &[DVec2], next: usize) -> bool {
        self.plan.combing != Combing::Everywhere
            && self.obstacles.top(way, next)
    }

    /// True if the ooze on a way is hidden, and the way crosses no wall that counts.
    fn hidden(&self, way: &[DVec2], next: usize) -> bool {
        let retract = &self.plan.retract;
        let o = &self.obstacles;
        retract.when_crossing
            && match retract.hidden {
                Hidden::SparseInfill => {
                    o.within_infill(way)
                        && !(retract.check_walls && o.wall(way))
                }
                hidden => {
                    let covered = hidden == Hidden::Covered;
                    let inner = || covered && o.inner_wall(way);
                    !o.air(way)
                        && !(retract.check_walls
                            && (o.outer_wall(way, next) || inner()))
                        && !o.top(way, next)
                }
            }
    }

    /// True if a retracted travel is lifted.
    fn hops(&self, from: DVec2, points: &[DVec2], next: usize) -> bool {
        let retract = &self.plan.retract;
        if retract.z_hop <= 0.0 {
            return false;
        }
        if retract.z_hop_when == HopWhen::Always {
            return true;
        }
        let mut way = vec![from];
        way.extend(points);
        let o = &self.obstacles;
        o.air(&way) || o.wall(&way) || o.top(&way, next)
    }
}

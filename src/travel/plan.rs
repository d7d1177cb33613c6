//! Decides which way a travel takes.
//!
//! In: two points. Out: the way between them, and whether to retract on it.
//! The first of these ways that will do is taken:
//!
//! 1. straight, if the way is too short for a retraction, or hidden;
//! 2. from support to support, straight over the part where this layer will cover
//!    what oozes, or else round the part; so too from one of many supports to the
//!    part's first bead;
//! 3. over sparse infill, which hides the way;
//! 4. inside the island, round its holes and notches, if the straight way leads
//!    over what shows;
//! 5. from one island to another, through the air once;
//! 6. straight and retracted.

use super::comb::Comb;
use super::decide::Obstacles;
use super::{Ground, Travel, gate, of_part, wipe};
use crate::bead::Bead;
use crate::order::apart;
use crate::plane::clip::intersection;
use crate::plane::{Area, Solid, path_length};
use crate::settings::{Combing, Hidden, HopWhen, Settings};
use crate::units::Mm;
use glam::DVec2;
use std::borrow::Cow;
use std::cell::OnceCell;

/// How far ways over sparse infill keep from its border where they can, as a
/// share of a line's width. At this distance they are surely inside.
const OFF_BORDER: f64 = 0.25;

/// Least share of a layer's area at which its sparse infill alone hides
/// travels, unless a setting says otherwise. Solid parts have more infill,
/// lattices less: in lattices nearly all travels lead through walls.
const MUCH_INFILL: f64 = 0.25;

/// How long a travel between supports may be, as a multiple of the setting
/// `retract.max_unretracted`. What oozes there is broken off with the supports,
/// and what is missing then is missing in a support.
const BETWEEN_SUPPORTS: f64 = 2.0;

/// An underside may get what oozes on a way across it if it is no wider than so
/// many lines. It is the underside of the outermost walls then, which is rough beside
/// supports anyway.
const UNDERSIDE: f64 = 2.0;

/// What hides travels in a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cover {
    /// Sparse infill.
    Infill,
    /// The part, where no wall is crossed.
    Part,
    /// The part, where no outer wall is crossed.
    Walls,
}

impl Cover {
    fn new(ground: &Ground<'_>, settings: &Settings) -> Cover {
        let much = || {
            let infill = ground.sparse.area().content();
            infill >= MUCH_INFILL * ground.outline.area().content()
        };
        match settings.retract.hidden {
            Hidden::SparseInfill => Cover::Infill,
            Hidden::Covered => Cover::Part,
            Hidden::Auto if !settings.is_hollow() && much() => Cover::Infill,
            Hidden::Auto => Cover::Walls,
        }
    }
}

/// Finds the travels of a layer.
pub(super) struct Planner<'a> {
    ground: Ground<'a>,
    /// Number of beads that are printed before the layer's first one of the part.
    before_part: usize,
    obstacles: Obstacles<'a>,
    comb: Comb<'a>,
    /// Ways over sparse infill.
    sparse: OnceCell<Comb<'a>>,
    /// Ways over what the next layer covers, made when a way leads over top
    /// skin.
    covered: OnceCell<Comb<'a>>,
    /// Ways beside the part.
    beside: OnceCell<Comb<'a>>,
    /// How far travels keep from the outline where they can. At this distance a
    /// travel is inside all walls.
    clearance: Mm,
    cover: Cover,
    settings: &'a Settings,
}

impl<'a> Planner<'a> {
    /// A planner for a layer with these beads, in print order.
    pub(super) fn new(
        beads: &'a [Bead],
        ground: Ground<'a>,
        settings: &'a Settings,
    ) -> Planner<'a> {
        let clearance = ground.border.max(settings.outer_wall_width());
        let first = beads.iter().position(of_part);
        Planner {
            ground,
            before_part: first.unwrap_or(beads.len()),
            obstacles: Obstacles::new(beads, ground, settings),
            comb: Comb::new(Cow::Borrowed(ground.outline), clearance),
            sparse: OnceCell::new(),
            covered: OnceCell::new(),
            beside: OnceCell::new(),
            clearance,
            cover: Cover::new(&ground, settings),
            settings,
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
        let settings = self.settings;
        if a.distance(b) < settings.retract.min_travel {
            return Travel::straight(b, false);
        }
        let mut travel = self.way(a, b, before, next);
        if !travel.retract {
            return travel;
        }
        let wiped = before.and_then(|bead| wipe::path(bead, settings));
        if let Some((wipe, end)) = wiped {
            // The travel begins where the wipe has ended.
            travel = self.way(end, b, before, next);
            travel.retract = true;
            travel.prime = 0.0;
            travel.wipe = wipe;
        }
        let from = travel.wipe.last().copied().unwrap_or(a);
        travel.hop = self.hops(from, &travel.points, next);
        travel
    }

    fn way(
        &self,
        a: DVec2,
        b: DVec2,
        before: Option<&Bead>,
        next: usize,
    ) -> Travel {
        if let Some(way) = self.between_supports(a, b, before, next) {
            return Travel {
                points: way[1..].to_vec(),
                ..Travel::default()
            };
        }
        let inside = before.is_some_and(of_part);
        if !inside && !self.ground.outline.grid().contains(a) {
            let retract = !self.hidden_way_in(a, b, next);
            return Travel::straight(b, retract);
        }
        let direct = [a, b];
        if self.hidden(&direct, next) {
            return self.finished(&direct, false);
        }
        let combing = self.settings.travel.combing;
        let straight = || self.finished(&direct, true);
        if combing == Combing::Off {
            return straight();
        }
        let longest = a.distance(b) + self.settings.travel.max_detour;
        let fits = |way: &Vec<DVec2>| path_length(way, false) <= longest;
        if let Some(way) = self.over_infill(a, b, longest).filter(fits)
            && self.hidden(&way, next)
        {
            return self.finished(&way, false);
        }
        if combing == Combing::WithinInfill {
            return straight();
        }
        // A travel that is retracted goes straight, unless the straight way
        // leads over what shows.
        let in_the_way = self.shows(&direct, next);
        let may_hide =
            self.cover != Cover::Infill && self.settings.retract.when_crossing;
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
    fn over_infill(
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
            let clearance = OFF_BORDER * self.settings.infill_width();
            Comb::new(Cow::Borrowed(sparse), clearance)
        });
        let reach = self.settings.inner_wall_width();
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
        let visible = || self.obstacles.top_skin(&way, next);
        if self.settings.travel.combing == Combing::Everywhere || !visible() {
            return Some(way);
        }
        let round = || {
            let above = self.ground.above?;
            let comb = self.covered.get_or_init(|| {
                let area = intersection(self.ground.outline.area(), above);
                Comb::new(Cow::Owned(Solid::new(area)), self.clearance)
            });
            let round = with_ends(comb.way(a, b, longest)?);
            let good = path_length(&round, false) <= longest
                && !self.obstacles.top_skin(&round, next);
            good.then_some(round)
        };
        Some(round().unwrap_or(way))
    }

    /// The travel along a way.
    fn finished(&self, way: &[DVec2], retract: bool) -> Travel {
        let settings = &self.settings.retract;
        let long = path_length(way, false) > settings.max_unretracted;
        let prime = if long && !retract {
            settings.ooze_prime
        } else {
            0.0
        };
        Travel {
            points: way[1..].to_vec(),
            retract: retract || (long && prime <= 0.0),
            prime,
            ..Travel::default()
        }
    }

    /// True if a way leads out of the part or over an outer wall.
    fn shows(&self, way: &[DVec2], next: usize) -> bool {
        self.obstacles.air(way) || self.obstacles.outer_wall(way, next)
    }

    /// The way from support to support, with both points, if there is one that is
    /// not too long. A skirt is thrown away like a support.
    fn between_supports(
        &self,
        a: DVec2,
        b: DVec2,
        before: Option<&Bead>,
        next: usize,
    ) -> Option<Vec<DVec2>> {
        let retract = &self.settings.retract;
        let support = self.ground.support.filter(|_| retract.when_crossing)?;
        let support = support.grid();
        let from = support.contains(a) || before.is_some_and(|b| !of_part(b));
        let part = self.ground.outline.grid();
        if !from || !support.contains(b) || part.contains(a) {
            return None;
        }
        let longest = (BETWEEN_SUPPORTS * retract.max_unretracted)
            .min(a.distance(b) + self.settings.travel.max_detour);
        let mut way = vec![a];
        if !part.crossings(a, b).is_empty()
            && !self.is_covered_later(a, b, next)
        {
            let beside = self.beside.get_or_init(|| self.air());
            way.extend(beside.way(a, b, longest)?);
        }
        way.push(b);
        (path_length(&way, false) <= longest).then_some(way)
    }

    /// True if a way leads straight from supports to the part's first bead, hides
    /// what oozes, and belongs to a layer with many supports that the part keeps
    /// apart. Such layers retract on the way to their first support, and elsewhere
    /// if they must.
    fn hidden_way_in(&self, a: DVec2, b: DVec2, next: usize) -> bool {
        let retract = &self.settings.retract;
        let apart = || {
            let beads = self.obstacles.beads()[..next].iter();
            let supports = beads.filter(|bead| bead.role.is_support());
            apart(self.ground.outline.area(), supports)
        };
        retract.when_crossing
            && next == self.before_part
            && a.distance(b) <= retract.max_unretracted
            && self.is_covered_later(a, b, next)
            && apart()
    }

    /// True if nothing of the part is printed yet in this layer, and the way
    /// straight to the start of the `next`th bead leads over the part only where
    /// this layer lies on the bed or on the layer below. What oozes there lies
    /// between the two; on the bed it shows, as on every way inside a first layer.
    /// Elsewhere it would be seen on a top of the layer below, or on an underside of
    /// this one. Small supports that stand apart would else retract the same filament
    /// again and again, which grinds it.
    fn is_covered_later(&self, a: DVec2, b: DVec2, next: usize) -> bool {
        if next > self.before_part {
            return false;
        }
        let Some(below) = self.ground.below else {
            return true;
        };
        let (here, below) = (self.ground.outline.grid(), below.grid());
        let mut ends = here.crossings(a, b);
        ends.extend(below.crossings(a, b));
        ends.extend([0.0, 1.0]);
        ends.sort_by(f64::total_cmp);
        let way = a.distance(b);
        let (mut tops, mut widest) = (0.0, 0.0_f64);
        for ends in ends.windows(2) {
            let middle = a.lerp(b, ends[0].midpoint(ends[1]));
            let length = way * (ends[1] - ends[0]);
            match (here.contains(middle), below.contains(middle)) {
                (false, true) => tops += length,
                (true, false) => widest = widest.max(length),
                _ => {}
            }
        }
        // Tops that are narrower than a line stay free: what oozes spans them.
        let line = self.settings.outer_wall_width();
        tops <= line && widest <= UNDERSIDE * line
    }

    /// Ways beside the part: inside a frame around the layer, in which the part
    /// is a hole.
    fn air(&self) -> Comb<'a> {
        /// Room around the layer, mm.
        const MARGIN: Mm = 5.0;
        let outline = self.ground.outline.area();
        let supports = self.ground.support.map(|s| s.area().bounds());
        let all = outline.bounds();
        let all = supports.map_or(all, |s| all.union(s)).grown(MARGIN);
        let (low, high) = (all.min, all.max);
        let frame = vec![
            low,
            DVec2::new(high.x, low.y),
            high,
            DVec2::new(low.x, high.y),
        ];
        let mut rings = vec![frame];
        rings.extend(outline.rings.iter().map(|ring| {
            let mut ring = ring.clone();
            ring.reverse();
            ring
        }));
        let air = Solid::new(Area { rings });
        Comb::new(Cow::Owned(air), self.clearance)
    }

    /// True if the ooze on a way is hidden, and the way crosses no wall.
    fn hidden(&self, way: &[DVec2], next: usize) -> bool {
        let retract = &self.settings.retract;
        let o = &self.obstacles;
        retract.when_crossing
            && match self.cover {
                Cover::Infill => {
                    o.within_infill(way)
                        && !(retract.check_walls && o.wall(way))
                }
                cover => {
                    let inner = || cover == Cover::Part && o.inner_wall(way);
                    !o.air(way)
                        && !(retract.check_walls
                            && (o.outer_wall(way, next) || inner()))
                        && !o.top_skin(way, next)
                }
            }
    }

    /// True if a retracted travel is lifted.
    fn hops(&self, from: DVec2, points: &[DVec2], next: usize) -> bool {
        let retract = &self.settings.retract;
        if retract.z_hop <= 0.0 {
            return false;
        }
        if retract.z_hop_when == HopWhen::Always {
            return true;
        }
        let mut way = vec![from];
        way.extend(points);
        let o = &self.obstacles;
        o.air(&way) || o.wall(&way) || o.top_skin(&way, next)
    }
}

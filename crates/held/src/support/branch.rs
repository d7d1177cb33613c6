//! One branch of support, from layer to layer on its way down.
//!
//! ```text
//!   ▒▒▒▒▒▒▒▒▒▒▒▒      what it holds
//!    ╲░░░░░░░░╱       every point of it moves towards its middle, by
//!      ╲░░░░╱         h·tan(`support.branch_angle`) in a layer
//!        ││           until it is a post, which grows with what is above it
//!       ╱  ╲          and has a foot on the bed
//! ```
//!
//! A column is a branch that is not drawn together.
//!
//! A branch is kept as its core. A disc of radius [`Size::core`] whose middle
//! moves all over the core covers what is printed, so no neck is thinner than
//! that disc. Where the part is in the way, the core goes around it, as far as
//! a branch may lean. Each point of a layer's core lies within that reach of
//! the core below, so what is printed always rests on something.

use super::disc::disc;
use super::parts::Parts;
use super::plan::SupportPlan;
use super::room::{Room, Size, StandsOn};
use super::settle::stands;
use super::{SPECK, TOLERANCE};
use glam::DVec2;
use isoslice_base::sets::Sets;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::clip::{crop, difference, intersection, union, unite};
use isoslice_planar::grid::nearest_on;
use isoslice_planar::offset::offset;
use isoslice_planar::opening::closed;
use isoslice_planar::simplify::simplify;
use isoslice_planar::{Area, Rect, Ring, edges, signed_area};

/// A post is at most so many times as high as it is thick.
const SLENDER: f64 = 12.0;
/// A post has this share of the area that it holds, at least.
const BEARING: f64 = 1.0 / 30.0;
/// A branch that is wider than a post, but has less than so many times the area of
/// one, is a neck: it has the post in its middle.
const NECK: f64 = 2.0;
/// Height and width of a foot on the bed, mm.
const FOOT: Mm = 1.0;
/// A post's core has this radius, mm.
pub(super) const POINT: Mm = 0.1;
/// Tolerance of a core's outline, mm.
const FINE: Mm = 0.01;
/// Longer edges of a core are divided before their ends move, mm.
const EDGE: Mm = 1.0;
/// Areas that differ by less than this differ by rounding, mm².
const ROUNDED: Mm2 = 1e-6;

/// A layer that branches come down to.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    /// The layer's number.
    pub layer: usize,
    /// How far a branch may lean from the layer above.
    pub lean: Mm,
    pub parts: Parts<'a>,
    pub room: &'a Room<'a>,
    pub plan: &'a SupportPlan,
}

impl Step<'_> {
    /// How thick branches are.
    fn size(self) -> Size {
        Size::new(self.plan)
    }
}

/// A branch in one layer.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    /// The area over which the middle of a disc moves that covers what is
    /// printed.
    pub core: Area,
    /// What the branch stands on.
    pub foot: StandsOn,
    /// The cell of the plane in which its first face was; nothing for a
    /// column.
    pub cell: Option<[u32; 2]>,
    /// Height above the bed of the highest thing that the branch holds.
    pub top: Mm,
    /// Area of what the branch holds.
    pub held: Mm2,
    /// What is printed of the branch in the layer above; empty before its first
    /// layer is done.
    pub printed: Area,
}

impl Branch {
    /// True if the branch goes straight down, except around the part.
    pub(super) fn is_column(&self) -> bool {
        self.cell.is_none()
    }

    /// The middle of the branch's core.
    pub(super) fn middle(&self) -> DVec2 {
        middle(&self.core)
    }

    /// True if the branch is one post, and no wider than a post.
    pub(super) fn is_post(&self) -> bool {
        let middle = self.middle();
        let mut points = self.core.rings.iter().flatten();
        points.all(|p| p.distance(middle) < 3.0 * POINT)
    }

    /// Takes over what another branch holds, which it touches.
    pub(super) fn take(&mut self, other: Branch, step: Step<'_>) {
        let mut rings = std::mem::take(&mut self.core.rings);
        rings.extend(other.core.rings);
        self.core = unite(&Area { rings });
        if self.core.islands().len() > 1 {
            // What is between the islands is printed.
            let between = closed(&self.core, step.size().apart(), TOLERANCE);
            let near = between.bounds();
            let blocked = step.room.blocked(step.layer, self.foot, near);
            let free = difference(&between, &blocked);
            self.core = finely(union(&self.core, &free));
        }
        self.top = self.top.max(other.top);
        self.held += other.held;
    }

    /// Joins another post. The two become one in the middle between them.
    pub(super) fn meet(&mut self, other: &Branch) {
        let at = self.middle().midpoint(other.middle());
        self.core.rings = vec![disc(at, POINT)];
        self.top = self.top.max(other.top);
        self.held += other.held;
    }

    /// Splits the branch into branches that are each printed in one piece.
    pub(super) fn pieces(mut self, step: Step<'_>) -> Vec<Branch> {
        let islands = self.core.islands();
        if islands.len() < 2 {
            self.core = islands.into_iter().next().unwrap_or_default();
            return if self.core.is_empty() {
                Vec::new()
            } else {
                vec![self]
            };
        }
        let whole = self.core.content().max(1e-9);
        // What is printed of islands nearer to each other than this is one.
        let reach = 2.0 * (step.size().core - TOLERANCE);
        let pieces = groups(islands, reach);
        let piece = |core: Area| Branch {
            held: self.held * core.content() / whole,
            core,
            printed: Area::EMPTY,
            ..self
        };
        pieces.into_iter().map(piece).collect()
    }

    /// Takes the branch down to a layer from the layer above. A post leans
    /// towards `other`, if that is given.
    pub(super) fn lower(&mut self, other: Option<DVec2>, step: Step<'_>) {
        let above = self.is_post().then(|| self.middle());
        self.come_down(other, step);
        if let Some(above) = above.filter(|_| !self.is_column()) {
            self.step_aside(above, step);
        }
    }

    /// Takes the branch down to a layer, to where it has room.
    fn come_down(&mut self, other: Option<DVec2>, step: Step<'_>) {
        let middle = self.middle();
        let pulled = match self.is_post() {
            _ if self.is_column() => self.core.clone(),
            true => {
                // The two meet halfway, since the other one leans as well.
                let half = |other| 0.5 * (other - middle);
                let way = other.map_or(DVec2::ZERO, half);
                let at = middle + way.clamp_length_max(step.lean);
                Area::from(disc(at, POINT))
            }
            false => {
                let rings = self.core.rings.iter();
                let pulled = rings.map(|r| pulled_in(r, middle, step.lean));
                let pulled: Area = pulled.collect();
                // Points that move towards the middle do not overtake each
                // other if they go around it.
                if goes_around(&self.core, middle) {
                    pulled
                } else {
                    unite(&pulled)
                }
            }
        };
        let bounds = pulled.bounds().union(self.core.bounds());
        let near = bounds.grown(step.lean + 5.0 * TOLERANCE);
        let blocked = if step.room.meets(step.layer, self.foot, &pulled) {
            step.room.blocked(step.layer, self.foot, near)
        } else {
            Area::EMPTY
        };
        if blocked.is_empty() {
            // A column would drift if it were thinned in every layer.
            if !self.is_column() {
                self.core = finely(pulled);
            }
            return;
        }
        let mut core = difference(&pulled, &blocked);
        if !self.is_column() && pulled.content() - core.content() < ROUNDED {
            // The part is not in the way of this core.
            self.core = finely(pulled);
            return;
        }
        if self.is_post() && !self.is_column() && !core.is_empty() {
            // A post is so small that it can lean as a whole to the place where
            // the largest piece of its core goes down.
            self.core = largest(core);
            return;
        }
        // The piece of the core that the part blocks goes aside, or stands on
        // the part.
        let reach = step.lean + 3.0 * TOLERANCE;
        let lost = difference(&self.core, &offset(&core, reach, TOLERANCE));
        let lost = if lost.is_empty() || !self.can_land(step) {
            lost
        } else {
            difference(&lost, &self.landing(step, lost.bounds()))
        };
        if core.is_empty() || lost.content() > 0.01 * SPECK {
            let aside = offset(&lost, reach, TOLERANCE);
            let aside = difference(&aside, &blocked);
            core = match self.foot {
                _ if !self.is_post() => union(&core, &aside),
                // A way leads down to the bed from every place beside what
                // blocks it.
                StandsOn::Bed => beside(&aside, middle),
                // Beside what blocks it a branch may end in the air between two
                // walls of the part, so the largest place is taken.
                StandsOn::Part => largest(aside),
            };
        } else if self.is_column() {
            self.core = core;
            return;
        }
        self.core = finely(core);
    }

    /// Moves a post away from the part, until all of it has room. `above` is its
    /// middle in the layer above. The part would cut a post that is too near
    /// into a crescent, which is printed worse than a disc.
    fn step_aside(&mut self, above: DVec2, step: Step<'_>) {
        if !self.is_post() {
            return;
        }
        let at = self.middle();
        let most = step.lean - above.distance(at);
        let room = self.margin(self.radius(step), step);
        let Some((distance, away)) = step.room.way_out(step.layer, at, room)
        else {
            return;
        };
        let to = at + away * most.min(room - distance);
        let farther = match step.room.way_out(step.layer, to, room) {
            Some((now, _)) => now > distance,
            None => true,
        };
        if most > 0.0
            && farther
            && step.room.has_place(step.layer, self.foot, to, POINT)
            && step.room.is_clear(step.layer, self.foot, at, to)
        {
            self.core.rings = vec![disc(to, POINT)];
        }
    }

    /// True if the branch, of which the layer above is printed, can end there. A
    /// post needs enough of the part below it to stand on. A post that touches the
    /// part with its edge alone goes on down beside the part.
    fn can_land(&self, step: Step<'_>) -> bool {
        self.foot == StandsOn::Part
            && (!self.is_post()
                || stands(&self.printed, step.layer + 1, step.parts))
    }

    /// What a branch that comes down to a layer can stand on, within a box.
    fn landing(&self, step: Step<'_>, within: Rect) -> Area {
        let size = step.size();
        let within = within.grown(size.core);
        let Parts {
            heights, outlines, ..
        } = step.parts;
        // A post that ends there begins in the layer above.
        let above = heights.stands_on(step.layer + 1);
        let mut below = heights.gap_below(step.layer);
        below.end = below.end.max(above.map_or(0, |on| on + 1));
        let below = below.map(|k| crop(&outlines[k].rings, within));
        let below = below.reduce(|a, b| union(&a, &b));
        offset(&below.unwrap_or_default(), size.core, TOLERANCE)
    }

    /// The radius of a post, without its foot.
    fn radius(&self, step: Step<'_>) -> Mm {
        let bottom = step.parts.spans()[step.layer].bottom;
        let slender = 0.5 * (self.top - bottom) / SLENDER;
        let bearing = (BEARING * self.held / std::f64::consts::PI).sqrt();
        step.size().post.max(slender).max(bearing)
    }

    /// How far the middle of a post of some radius has to be from all that is
    /// too near to the part for the middle of a branch, so that the part cuts
    /// nothing off it. The part keeps a distance from the core, so that only what
    /// is farther out has to be looked at.
    fn margin(&self, radius: Mm, step: Step<'_>) -> Mm {
        radius - step.size().core + 3.0 * TOLERANCE
    }

    /// The area of the branch that is printed in a layer.
    pub(super) fn area(&self, step: Step<'_>) -> Area {
        let size = step.size();
        let mut post = self.radius(step);
        if self.foot == StandsOn::Bed {
            let bottom = step.parts.spans()[step.layer].bottom;
            post += (FOOT - bottom).max(0.0);
        }
        let middle = self.middle();
        let points = self.core.rings.iter().flatten();
        let far = points.map(|p| p.distance(middle)).fold(0.0, f64::max);
        let all = || offset(&self.core, size.core, TOLERANCE);
        // A post covers its core. What is wider needs the post in its middle only
        // where it has come down to a neck.
        let wide = (far + size.core > post).then(all);
        if let Some(wide) = &wide {
            let neck = NECK * std::f64::consts::PI * post * post;
            if self.is_column()
                || wide.content() > neck
                || !wide.contains(middle)
            {
                return wide.clone();
            }
        }
        let disc = Area::from(disc(middle, post));
        let beyond = self.margin(post, step);
        if step.room.way_out(step.layer, middle, beyond).is_none() {
            return union(&wide.unwrap_or_default(), &disc);
        }
        let near = disc.bounds().grown(TOLERANCE);
        let taken = step.room.taken(step.layer, near);
        union(&wide.unwrap_or_else(all), &difference(&disc, &taken))
    }
}

/// Islands, of which those nearer to each other than `reach`, directly or
/// through others, are put together.
fn groups(islands: Vec<Area>, reach: Mm) -> Vec<Area> {
    let bounds: Vec<Rect> =
        islands.iter().map(|i| i.bounds().grown(reach)).collect();
    // The nearest places of two islands are a corner and a side.
    let comes_near = |a: usize, b: usize| {
        let rings = || islands[b].rings.iter();
        let sides = rings().flat_map(|ring| edges(ring));
        let sides =
            sides.filter(|(p, q)| Rect::around(&[*p, *q]).meets(bounds[a]));
        let sides: Vec<_> = sides.collect();
        let corners = islands[a].rings.iter().flatten();
        corners.filter(|c| bounds[b].contains(**c)).any(|&c| {
            sides
                .iter()
                .any(|&(p, q)| nearest_on(c, p, q).distance(c) < reach)
        })
    };
    let mut sets = Sets::new(islands.len());
    for a in 0..islands.len() {
        for b in a + 1..islands.len() {
            if bounds[a].meets(bounds[b])
                && (comes_near(a, b) || comes_near(b, a))
            {
                sets.join(a, b);
            }
        }
    }
    let mut groups = vec![Area::EMPTY; islands.len()];
    for (k, island) in islands.into_iter().enumerate() {
        groups[sets.of(k)].rings.extend(island.rings);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// True if an area is one ring that goes around a point, so that every way from
/// there outwards crosses it once.
fn goes_around(area: &Area, middle: DVec2) -> bool {
    let [ring] = &area.rings[..] else {
        return false;
    };
    let mut turn = 0.0;
    edges(ring).all(|(a, b)| {
        let (a, b) = (a - middle, b - middle);
        turn += a.angle_to(b);
        a.perp_dot(b) > 0.0
    }) && turn < 1.5 * std::f64::consts::TAU
}

/// The largest island of an area.
fn largest(area: Area) -> Area {
    let islands = area.islands().into_iter();
    let largest = islands.max_by(|a, b| a.content().total_cmp(&b.content()));
    largest.unwrap_or_default()
}

/// The piece of an area around the point of its rim nearest to `to`; the piece
/// is as large as a post may be.
fn beside(area: &Area, to: DVec2) -> Area {
    let sides = area.rings.iter().flat_map(|ring| edges(ring));
    let nearest = sides.map(|(a, b)| nearest_on(to, a, b));
    let nearest = nearest.min_by(|p, q| {
        p.distance_squared(to).total_cmp(&q.distance_squared(to))
    });
    let Some(at) = nearest else {
        return Area::EMPTY;
    };
    let near = Area::from(disc(at, 2.0 * POINT));
    largest(intersection(area, &near))
}

/// The middle of an area. If the area has no content, the mean of its points.
pub(super) fn middle(area: &Area) -> DVec2 {
    let mut sum = DVec2::ZERO;
    let mut content = 0.0;
    // Coordinates count from one of its points, which keeps rounding small.
    let points = || area.rings.iter().flatten();
    let about = points().next().copied().unwrap_or_default();
    for ring in &area.rings {
        for (a, b) in edges(ring) {
            let cross = (a - about).perp_dot(b - about);
            content += cross;
            sum += cross * (a + b - 2.0 * about) / 3.0;
        }
    }
    if content > 1e-9 {
        return about + sum / content;
    }
    let count = points().count().max(1) as f64;
    points().sum::<DVec2>() / count
}

/// A ring all of whose points move towards `middle` by `by`, but not nearer
/// than [`POINT`].
fn pulled_in(ring: &[DVec2], middle: DVec2, by: Mm) -> Ring {
    let mut moved = Vec::with_capacity(ring.len());
    for (a, b) in edges(ring) {
        let pieces = (a.distance(b) / EDGE).ceil().max(1.0);
        let mut k = 0.0;
        while k < pieces {
            let from = a.lerp(b, k / pieces) - middle;
            let far = from.length();
            let near = (far - by).max(far.min(POINT));
            moved.push(middle + from * (near / far.max(1e-12)));
            k += 1.0;
        }
    }
    moved
}

/// A core with as few points as its shape needs. Thin necks stay.
fn finely(core: Area) -> Area {
    let fine = |ring: Ring| {
        let few = simplify(&ring, FINE);
        let [few_in, all_in] = [&few, &ring].map(|r| signed_area(r).abs());
        let ring = if few_in > 0.5 * all_in { few } else { ring };
        (all_in > 1e-6).then_some(ring)
    };
    core.rings.into_iter().filter_map(fine).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::{rect, shapes};

    #[test]
    fn islands_are_put_together_if_a_corner_comes_near_to_a_side() {
        let left = rect(0.0, 0.0, 4.0, 10.0);
        // A corner that points at the middle of the left rectangle's side.
        let tip = |x: f64| {
            let corners = [(x, 5.0), (x + 2.0, 4.0), (x + 2.0, 6.0)];
            Area::from(corners.map(DVec2::from).to_vec())
        };
        let count = |all: Vec<Area>| {
            let found = groups(all, 0.4);
            found.iter().map(|g| g.rings.len()).collect::<Vec<_>>()
        };
        for all in
            [vec![left.clone(), tip(4.39)], vec![tip(4.39), left.clone()]]
        {
            assert_eq!(count(all), [2]);
        }
        assert_eq!(count(vec![left.clone(), tip(4.41)]), [1, 1]);
        // Two that are far from each other are one with the one between them,
        // and one of them has a hole.
        let hole = rect(1.0, 1.0, 3.0, 3.0);
        let pierced = difference(&left, &hole);
        let far = rect(6.5, 0.0, 8.0, 10.0);
        let all = vec![pierced, rect(20.0, 0.0, 21.0, 1.0), far, tip(4.3)];
        assert_eq!(count(all), [4, 1]);
        // What stands in a hole is near to its border, or it is not.
        let frame =
            difference(&rect(-9.0, -9.0, 9.0, 9.0), &rect(0.0, 0.0, 4.0, 8.0));
        let inside = |gap: f64| rect(gap, 1.0, 3.0, 7.0);
        assert_eq!(count(vec![frame.clone(), inside(0.5)]), [2, 1]);
        assert_eq!(count(vec![frame, inside(0.3)]), [3]);
    }

    #[test]
    fn pulled_points_overtake_no_other_if_the_ring_goes_around_the_middle() {
        let oval = shapes::circle(3.0, 40).into_iter();
        let oval: Ring = oval.map(|p| p * DVec2::new(2.0, 0.5)).collect();
        let middle = DVec2::new(0.3, 0.1);
        assert!(goes_around(&Area::from(oval.clone()), middle));
        for by in [0.2, 1.0, 5.0] {
            let pulled = Area::from(pulled_in(&oval, middle, by));
            let united = unite(&pulled);
            assert_eq!(united.rings.len(), 1);
            assert!((united.content() - pulled.content()).abs() < 1e-3);
        }
        // From outside, in a bay, with a hole, and with two rings.
        assert!(!goes_around(&Area::from(oval), DVec2::new(9.0, 0.0)));
        let bay =
            difference(&rect(0.0, 0.0, 9.0, 9.0), &rect(2.0, 2.0, 7.0, 9.0));
        assert!(!goes_around(&bay, DVec2::new(4.5, 1.0)));
        let frame =
            difference(&rect(0.0, 0.0, 9.0, 9.0), &rect(2.0, 2.0, 7.0, 7.0));
        assert!(!goes_around(&frame, DVec2::new(4.5, 4.5)));
        assert!(!goes_around(&Area::EMPTY, DVec2::ZERO));
    }
}

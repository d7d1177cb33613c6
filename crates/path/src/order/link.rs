//! Short ways between strokes that nobody sees, printed instead of hopped.
//!
//! ```text
//!   ════════╗      The end of a stroke and the beginning of the next one are
//!           ║      a hop apart. Both are shortened, and a narrow way leads from
//!   ════════╝      one to the other: strokes and way lay what the strokes did.
//! ```
//!
//! In: a layer's beads in print order. Out: these beads, of which some go on in
//! the next one. The lines of tops keep their ends; only a stub goes on in the one
//! beside it, and gives what the way lays. The lines of bridges keep their ends, where
//! something holds them, and become narrower by what the way lays. An outer wall stays as
//! it is here. Where a way leads from or to an open one, the hidden stroke at the other
//! end gives half of what the way lays, and the rest fills the corner. Where a way leads
//! to the seam of a closed one, the hidden stroke gives what lies beside the wall, and the
//! wall ends earlier by the rest once it gets its end (`isoslice_layer::seam::ending`).
//! A way stays off the outer walls: it comes no nearer to the outline than a wall beside
//! them or than its ends do.

use super::{OrderPlan, jobs};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Bead, Plane, Role, Stroke, narrowest, spacing};
use isoslice_planar::grid::EdgeGrid;
use std::cell::OnceCell;

/// Longest way from a stroke to the next, in widths.
const REACH: f64 = 3.4;
/// Longest way from a line of a bridge to the next, in widths: little of it hangs beside
/// what holds the lines.
const STRANDS: f64 = 2.0;
/// Share of its width that a line of a bridge gives for a way.
const NARROWER: f64 = 0.05;
/// How far a way may lead back along a hidden stroke, in widths: it lies on what
/// has just been printed, or soon will be.
const BACK: f64 = 2.5;
/// How far a way may lead back along an outer wall, in widths.
const BESIDE: f64 = 1.5;
/// Longest gap between walls that point at each other, in widths.
const GAP: f64 = 2.0;
/// Walls point at each other where a way leads on along both of them by more
/// than this share of its length.
const FACING: f64 = 0.5;
/// Share of a stroke that may be taken from one of its ends.
const SHARE: f64 = 0.4;
/// Share of what a way between walls lays that has to be taken from the walls,
/// which fill their places.
const WALLS: f64 = 0.99;
/// Share of what a way between a skin's strokes lays that has to be taken from
/// the strokes, which leave corners open.
const SKINS: f64 = 0.5;
/// Share of what a way at the end of an open outer wall lays that is taken from the
/// hidden stroke. The rest fills the corner where the wall ends.
const CORNERS: f64 = 0.5;
/// A stroke of a top that is shorter than this goes on in the next one, mm: a way to it
/// shows less than a stroke that begins and ends there.
const STUB: Mm = 1.0;
/// Slack in distances from the outline, mm.
const OFF_OUTLINE: Mm = 0.03;
/// Number of rounds in which the lengths are found. They depend on each other.
const ROUNDS: usize = 6;

/// Lets beads go on in the next one where a short way leads there. `solid` is
/// the layer's outline.
pub fn linked(
    beads: Vec<Bead>,
    solid: &EdgeGrid,
    plan: &OrderPlan,
) -> Vec<Bead> {
    let outer = plan.outer_width;
    let mut out: Vec<Bead> = Vec::with_capacity(beads.len());
    let mut rest = beads.into_iter();
    // All lines, once a way that fills a gap asks what crosses the gap.
    let grid = OnceCell::new();
    while let Some(mut bead) = rest.next() {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let link = out
            .last()
            .filter(|before| may_go_on(before, &bead, plan))
            .and_then(|before| Link::between(before, &bead))
            .filter(|link| link.is_free(solid, outer))
            .filter(|link| {
                let all = || out.iter().chain([&bead]).chain(rest.as_slice());
                let lines = || {
                    EdgeGrid::of_lines(all().map(|b| b.stroke.path()), outer)
                };
                !link.fills || !link.crosses(grid.get_or_init(lines))
            });
        if let (Some(before), Some(link)) = (out.last_mut(), link) {
            for (bead, last, taken) in [
                (&mut *before, true, link.taken[0]),
                (&mut bead, false, link.taken[1]),
            ] {
                if taken > 0.0 && is_strand(bead.role) {
                    bead.stroke = narrowed(bead, taken);
                } else if taken > 0.0 {
                    bead.stroke = bead.stroke.opened().shortened(last, taken);
                }
            }
            let way = link.bead(before, &bead);
            out.extend(way);
        }
        out.push(bead);
    }
    out
}

/// A way from the end of one bead to the beginning of the next, once both have
/// been shortened.
struct Link {
    from: DVec2,
    to: DVec2,
    /// Width of the way between the two beads.
    width: Mm,
    /// Lengths that are taken from the end of the first bead and from the
    /// beginning of the second one; from lines of bridges, what these lengths lay.
    taken: [Mm; 2],
    /// True if the way fills a gap between two beads that point at each other.
    fills: bool,
}

impl Link {
    /// The way between two beads, if it is short, and if they are long enough
    /// to make up for what it lays.
    fn between(before: &Bead, after: &Bead) -> Option<Link> {
        let ends = [End::of(before, true)?, End::of(after, false)?];
        let [a, b] = &ends;
        let mut way = a.at.distance(b.at);
        let mean = 0.5 * (a.width() + b.width());
        // Strokes may end in a point.
        let wide = mean.max(0.5 * (before.stroke.width + after.stroke.width));
        let strands = is_strand(before.role) && is_strand(after.role);
        let reach = if strands { STRANDS } else { REACH } * wide;
        if way <= 0.0 || way > reach {
            return None;
        }
        let (back, ahead) = (a.back(b.at)?, b.back(a.at)?);
        if back > a.most_back() * wide || ahead > b.most_back() * wide {
            return None;
        }
        let own = spacing(mean, mean, after.height);
        let share = narrowest(after.height).min(own);
        let mut link = Link {
            from: a.at,
            to: b.at,
            width: mean - (own - share),
            taken: [0.0; 2],
            fills: false,
        };
        let walls = is_wall(role(before, after));
        if walls && back.max(ahead) < -FACING * way {
            link.fills = true;
            let fits = own >= narrowest(after.height);
            return (fits && way <= GAP * wide).then_some(link);
        }
        let most = [a.gives(), b.gives()];
        let corner = |b: &Bead| b.role.shows() && !b.stroke.closed;
        let part = if corner(before) || corner(after) {
            CORNERS
        } else {
            1.0
        };
        let enters = after.role.shows() && after.stroke.closed;
        let within = if enters { 0.5 * b.width() } else { 0.0 };
        let mut all = 0.0;
        for _ in 0..ROUNDS {
            // What lies within a closed wall is taken from that wall's end.
            let beside = way - within;
            all = part * beside.max(0.0) * share / own;
            let half = most[0].min(0.5 * all);
            link.taken[1] = most[1].min(all - half);
            link.taken[0] = most[0].min(all - link.taken[1]);
            link.from = a.without(link.taken[0])?;
            link.to = b.without(link.taken[1])?;
            way = link.from.distance(link.to);
        }
        let enough = if walls { WALLS } else { SKINS };
        // Where the ends give way for it, a way may grow too long.
        (way <= reach && link.taken[0] + link.taken[1] >= enough * all)
            .then_some(link)
    }

    /// True if the way comes no nearer to the outline than a wall beside the
    /// outer walls, or than the nearer one of its ends.
    fn is_free(&self, solid: &EdgeGrid, outer: Mm) -> bool {
        let inside = outer + 0.5 * self.width;
        let depth = |p: DVec2| {
            let near = solid.nearest_edge(p, inside);
            near.map_or(inside, |(_, q)| p.distance(q))
        };
        let least = (depth(self.from).min(depth(self.to)) - OFF_OUTLINE)
            .max(OFF_OUTLINE);
        let mut free = true;
        solid.visit_edges_near(self.from, self.to, least, |_| free = false);
        free
    }

    /// True if the way crosses a line. Where strips cross, one bead goes through,
    /// and those that it interrupts point at each other from its sides.
    fn crosses(&self, lines: &EdgeGrid) -> bool {
        lines.crosses_way(self.from, self.to)
    }

    /// The way as a bead between two that have been shortened. Between walls
    /// the way is no wall.
    fn bead(&self, before: &Bead, after: &Bead) -> Option<Bead> {
        let ends = vec![jobs::end(before)?, *after.stroke.points.first()?];
        let role = role(before, after);
        let role = if is_wall(role) { Role::GapFill } else { role };
        let stroke = Stroke::new(ends, false, self.width);
        Some(Bead::new(role, stroke, after.height))
    }
}

/// The end of a bead, or its beginning.
struct End<'a> {
    bead: &'a Bead,
    last: bool,
    at: DVec2,
}

impl End<'_> {
    fn of(bead: &Bead, last: bool) -> Option<End<'_>> {
        let (start, end) = bead.stroke.ends()?;
        let at = if last { end } else { start };
        Some(End { bead, last, at })
    }

    fn width(&self) -> Mm {
        let stroke = &self.bead.stroke;
        let open = self.last && !stroke.closed;
        let last = stroke.points.len() - 1;
        stroke.width_at(if open { last } else { 0 })
    }

    /// Length by which the straight way to a place leads back along the bead;
    /// negative where it leads on.
    fn back(&self, place: DVec2) -> Option<Mm> {
        let stroke = &self.bead.stroke;
        let far = stroke.width.min(SHARE * stroke.length());
        let ahead = self.at - stroke.place(self.last, far)?;
        Some((self.at - place).dot(ahead.normalize_or_zero()))
    }

    /// How far a way may lead back along the bead, in widths.
    fn most_back(&self) -> f64 {
        if self.bead.role.shows() { BESIDE } else { BACK }
    }

    /// Where the bead ends once a length of it was taken.
    fn without(&self, taken: Mm) -> Option<DVec2> {
        if is_strand(self.bead.role) {
            return Some(self.at);
        }
        self.bead.stroke.place(self.last, taken)
    }

    /// Length that may be taken from here: what shows gives nothing.
    fn gives(&self) -> Mm {
        let bead = self.bead;
        let share = match bead.role {
            role if role.shows() => 0.0,
            Role::TopSkin if !is_stub(bead) => 0.0,
            role if is_strand(role) => NARROWER,
            _ => SHARE,
        };
        share * bead.stroke.length()
    }
}

/// True if a way may lead from one bead to the next: nobody sees where they end,
/// or one of them is an outer wall that ends inside the part. An open wall ends
/// where others meet it. A closed one begins and ends at its seam; a way may lead
/// there from the wall behind it, and from there into a gap, unless the seam is a gap
/// or a scarf. To an inner wall the end of an outer one is wiped.
fn may_go_on(before: &Bead, after: &Bead, plan: &OrderPlan) -> bool {
    let hides = |bead: &Bead| hidden(bead.role, plan);
    let open =
        |bead: &Bead| bead.role == Role::OuterWall && !bead.stroke.closed;
    let closed =
        |bead: &Bead| bead.role == Role::OuterWall && bead.stroke.closed;
    let enters = closed(after) && is_wall(before.role) && plan.enters_seams;
    let leaves =
        closed(before) && after.role == Role::GapFill && plan.whole_seams;
    let may = hides(before) && (hides(after) || open(after))
        || open(before) && hides(after)
        || enters
        || leaves;
    let alike = before.role == after.role && plan.skin_meets_ring;
    let stub = || [before, after].into_iter().any(is_stub);
    let skin = alike
        && (is_strand(before.role) || before.role == Role::TopSkin && stub());
    (may || skin) && [before, after].iter().all(|b| b.plane != Plane::HalfLower)
}

/// True for lines that hang between what holds their ends.
fn is_strand(role: Role) -> bool {
    matches!(role, Role::Bridge | Role::InternalBridge)
}

/// True for a stroke that is too short to be one of its own.
fn is_stub(bead: &Bead) -> bool {
    bead.stroke.length() < STUB
}

/// Role of the first of two beads that does not show.
fn role(before: &Bead, after: &Bead) -> Role {
    if before.role.shows() {
        after.role
    } else {
        before.role
    }
}

/// True for strokes of walls that are hidden.
fn is_wall(role: Role) -> bool {
    matches!(role, Role::InnerWall | Role::GapFill)
}

/// True if nobody sees where a bead of this role ends. In a gap that is asked
/// for between skin and its ring there is no way either.
fn hidden(role: Role, plan: &OrderPlan) -> bool {
    match role {
        Role::InnerWall | Role::GapFill => true,
        Role::InternalSkin | Role::BottomSkin => plan.skin_meets_ring,
        _ => false,
    }
}

/// A bead's stroke, as long as before, without what a length of it lays.
fn narrowed(bead: &Bead, length: Mm) -> Stroke {
    let mut stroke = bead.stroke.clone();
    let share = length / stroke.length();
    let less =
        |width: &mut Mm| *width -= share * spacing(*width, *width, bead.height);
    less(&mut stroke.width);
    stroke.widths.iter_mut().for_each(less);
    stroke
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::{Area, rect};
    use isoslice_settings::Varying;
    use isoslice_settings::testing::{plan_with, usual_plan};

    const WIDTH: f64 = 0.45;
    const HEIGHT: f64 = 0.2;

    fn line(role: Role, at: &[(f64, f64)]) -> Bead {
        let points = at.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        Bead::new(role, Stroke::new(points, false, WIDTH), HEIGHT)
    }

    fn ring(half: f64) -> Bead {
        let points = rect(-half, -half, half, half).rings.remove(0);
        let role = Role::InternalSkin;
        Bead::new(role, Stroke::new(points, true, WIDTH), HEIGHT)
    }

    fn far_away() -> EdgeGrid {
        EdgeGrid::new(&rect(-50.0, -50.0, 50.0, 50.0), 1.0)
    }

    fn linked_in(solid: &EdgeGrid, beads: &[Bead]) -> Vec<Bead> {
        linked(beads.to_vec(), solid, &usual_plan(OrderPlan::of))
    }

    fn linked_inside(beads: &[Bead]) -> Vec<Bead> {
        linked_in(&far_away(), beads)
    }

    /// The plane that beads fill, mm².
    fn laid(beads: &[Bead]) -> f64 {
        let space = |w: f64| spacing(w, w, HEIGHT);
        let of = |b: &Bead| -> f64 {
            let each = b.stroke.segments().enumerate();
            each.map(|(i, (p, q))| {
                let w = 0.5 * (b.stroke.width_at(i) + b.stroke.width_at(i + 1));
                p.distance(q) * space(w)
            })
            .sum()
        };
        beads.iter().map(of).sum()
    }

    /// How many strokes there are: beads that begin where no other ends.
    fn strokes(beads: &[Bead]) -> usize {
        let meet = |pair: &&[Bead]| {
            !pair[0].stroke.closed
                && pair[0].stroke.points.last() == pair[1].stroke.points.first()
        };
        beads.len() - beads.windows(2).filter(meet).count()
    }

    fn apart() -> f64 {
        spacing(WIDTH, WIDTH, HEIGHT)
    }

    #[test]
    fn strokes_beside_each_other_become_one_and_lay_what_they_did() {
        let role = Role::InternalSkin;
        let y = apart();
        let there = line(role, &[(0.0, 0.0), (5.0, 0.0)]);
        // Even, uneven either way, at an angle, in line.
        let next: [&[(f64, f64)]; 5] = [
            &[(5.0, y), (0.0, y)],
            &[(4.6, y), (0.0, y)],
            &[(5.4, y), (0.0, y)],
            &[(5.0, y), (5.0, 4.0)],
            &[(5.5, 0.0), (9.0, 0.0)],
        ];
        for next in next {
            let both = [there.clone(), line(role, next)];
            let found = linked_inside(&both);
            assert_eq!(strokes(&found), 1, "{next:?}");
            let share = laid(&found) / laid(&both);
            assert!((share - 1.0).abs() < 2e-3, "{next:?}: {share}");
            assert_eq!(
                found[0].stroke.points.first(),
                both[0].stroke.points.first()
            );
            assert_eq!(
                found[2].stroke.points.last(),
                both[1].stroke.points.last()
            );
            // The way is as narrow as it can be: as wide as high.
            assert!((found[1].stroke.width - HEIGHT).abs() < 1e-9, "{next:?}");
            assert!(found.iter().all(|b| b.role == role));
        }
    }

    #[test]
    fn ends_do_not_give_way_to_a_way_that_grows_too_long() {
        let role = Role::InternalSkin;
        let there = line(role, &[(0.0, 0.0), (5.0, 0.0)]);
        for (gap, joined) in [(0.8, true), (1.2, false)] {
            let next = line(role, &[(5.0 + gap, 0.0), (9.0, 0.0)]);
            let both = [there.clone(), next];
            assert_eq!(linked_inside(&both).len() == 3, joined, "{gap}");
        }
    }

    #[test]
    fn rings_inside_one_another_become_a_spiral() {
        let rings = [0, 1, 2, 3].map(|k| ring(4.0 - apart() * f64::from(k)));
        let found = linked_inside(&rings);
        assert_eq!(strokes(&found), 1);
        let share = laid(&found) / laid(&rings);
        assert!((share - 1.0).abs() < 1e-3, "{share}");
    }

    #[test]
    fn what_shows_keeps_its_ends_and_long_ways_are_travels() {
        let pair = |a: Role, b: Role, gap: f64| {
            let (a, b) = (
                line(a, &[(0.0, 0.0), (5.0, 0.0)]),
                line(b, &[(5.0, gap), (0.0, gap)]),
            );
            let both = [a, b];
            let found = linked_inside(&both);
            found != both
        };
        let inner = Role::InnerWall;
        assert!(pair(inner, inner, 0.4));
        assert!(pair(Role::InternalSkin, Role::BottomSkin, 1.4));
        assert!(!pair(inner, inner, 1.6));
        let shows = [Role::Overhang, Role::TopSkin, Role::Ironing, Role::Skirt];
        for role in shows {
            assert!(!pair(role, role, 0.4), "{role:?}");
            assert!(!pair(inner, role, 0.4), "{role:?}");
            assert!(!pair(role, inner, 0.4), "{role:?}");
        }
        let outer = Role::OuterWall;
        assert!(!pair(outer, outer, 0.4));
    }

    #[test]
    fn a_stub_goes_on_in_the_stroke_beside_it() {
        let y = apart();
        let role = Role::TopSkin;
        let long = line(role, &[(0.0, 0.0), (5.0, 0.0)]);
        let stub = line(role, &[(5.0, y), (4.3, y)]);
        for both in [[&long, &stub], [&stub, &long]] {
            let mut both = both.map(Clone::clone);
            if both[0] == stub {
                both.iter_mut().for_each(|b| b.stroke.reverse());
            }
            let found = linked_inside(&both);
            assert_eq!(strokes(&found), 1);
            // The long stroke keeps both of its ends.
            let longer = both.iter().find(|b| !is_stub(b)).unwrap();
            assert!(found.contains(longer));
            let share = laid(&found) / laid(&both);
            assert!((share - 1.0).abs() < 0.01, "{share}");
        }
    }

    #[test]
    fn lines_of_bridges_are_one_stroke_with_those_beside_them() {
        let y = apart();
        for role in [Role::InternalBridge, Role::Bridge] {
            let there = line(role, &[(0.0, 0.0), (5.0, 0.0)]);
            let back = line(role, &[(5.2, y), (-0.1, y)]);
            let again = line(role, &[(0.0, 2.0 * y), (5.0, 2.0 * y)]);
            let all = [there, back, again];
            let found = linked_inside(&all);
            assert_eq!((found.len(), strokes(&found)), (5, 1), "{role:?}");
            let share = laid(&found) / laid(&all);
            assert!((share - 1.0).abs() < 2e-3, "{role:?}: {share}");
            for (k, line) in all.iter().enumerate() {
                let own = &found[2 * k].stroke;
                assert_eq!(own.points, line.stroke.points, "{role:?}");
                let less = 1.0 - own.width / line.stroke.width;
                assert!((0.005..0.1).contains(&less), "{role:?}: {less}");
            }
            assert!((found[1].stroke.width - HEIGHT).abs() < 1e-9);
            assert!(found.iter().all(|b| b.role == role));
            // Skin that is to lie apart from what is around it has no way there.
            let apart = plan_with(OrderPlan::of, |s| s.skin_ring_gap = 0.2);
            assert_eq!(linked(all.to_vec(), &far_away(), &apart), all);
            // Lines over different gaps stay apart.
            let far = line(role, &[(6.0, y), (9.0, y)]);
            let both = [all[0].clone(), far];
            assert_eq!(linked_inside(&both), both);
        }
    }

    /// Two loops side by side, both of which begin near a corner.
    #[test]
    fn an_inner_wall_goes_on_in_the_outer_one_at_its_seam() {
        let wall = |role: Role, half: f64| {
            let points = rect(-half, -half, half, half).rings.remove(0);
            Bead::new(role, Stroke::new(points, true, WIDTH), HEIGHT)
        };
        let outer = wall(Role::OuterWall, 5.0);
        let inner = wall(Role::InnerWall, 5.0 - apart());
        let outline = rect(-5.225, -5.225, 5.225, 5.225);
        let solid = EdgeGrid::new(&outline, 1.0);
        let both = [inner, outer];
        let found = linked_in(&solid, &both);
        assert_eq!(found.len(), 3);
        assert_eq!(found[2], both[1]);
        let way = &found[1].stroke.points;
        assert_eq!(way.first().copied(), jobs::end(&found[0]));
        assert_eq!(way.last(), found[2].stroke.points.first());
        // The outer wall will end earlier by what lies within it.
        let more = laid(&found) - laid(&both);
        let way = laid_by(&found[1]);
        let within = 0.5 * WIDTH / found[1].stroke.length() * way;
        assert!((more - within).abs() < 1e-3, "{more} {within}");
        // The end of the outer wall is wiped.
        let turned = [both[1].clone(), both[0].clone()];
        assert_eq!(linked_in(&solid, &turned), turned);
        for (seam_gap, seam_scarf, contour_z) in
            [(0.1, 0.0, 0.0), (0.0, 5.0, 0.0), (0.0, 0.0, 100.0)]
        {
            let apart = plan_with(OrderPlan::of, |s| {
                (s.seam_gap, s.seam_scarf) = (seam_gap, seam_scarf.into());
                s.contour_z = Varying::Constant(contour_z);
            });
            assert_eq!(linked(both.to_vec(), &solid, &apart), both);
        }
    }

    /// What a way of the narrowest width lays, mm².
    fn laid_by(way: &Bead) -> f64 {
        way.stroke.length()
            * spacing(way.stroke.width, way.stroke.width, HEIGHT)
    }

    #[test]
    fn an_outer_wall_stays_whole_where_a_way_leads_from_it() {
        let outer = line(Role::OuterWall, &[(0.0, 0.0), (5.0, 0.0)]);
        let inner = line(Role::InnerWall, &[(5.2, 0.5), (0.0, 0.5)]);
        let check = |both: [Bead; 2], whole: usize| {
            let found = linked_inside(&both);
            assert_eq!(strokes(&found), 1);
            assert_eq!(found[2 * whole], both[whole]);
            assert_eq!(found[1].role, Role::GapFill);
            // The other stroke gives a half of what the way lays.
            let more = laid(&found) - laid(&both);
            let half = 0.5 * laid_by(&found[1]);
            assert!((more - half).abs() < 1e-3, "{more} {half}");
        };
        check([outer.clone(), inner.clone()], 0);
        let turned = |bead: &Bead| {
            let mut bead = bead.clone();
            bead.stroke.reverse();
            bead
        };
        check([turned(&inner), turned(&outer)], 1);
        // A way that leads far back along the wall would lie on it.
        let far = line(Role::InnerWall, &[(4.2, 0.5), (0.0, 0.5)]);
        assert_eq!(linked_inside(&[outer.clone(), far]).len(), 2);
        let far = line(Role::InnerWall, &[(4.4, 0.5), (0.0, 0.5)]);
        assert_eq!(linked_inside(&[outer, far]).len(), 3);
    }

    #[test]
    fn a_way_leads_from_a_seam_into_the_gap_behind_it() {
        let points = rect(-5.0, -5.0, 5.0, 5.0).rings.remove(0);
        let stroke = Stroke::new(points, true, WIDTH);
        let mut wall = Bead::new(Role::OuterWall, stroke, HEIGHT);
        let corner = DVec2::splat(-5.0);
        let seam = wall.stroke.points.iter().position(|p| *p == corner);
        wall.stroke.begin_at(seam.unwrap());
        let gap = line(Role::GapFill, &[(-4.6, -4.6), (4.6, -4.6)]);
        let outline = rect(-5.225, -5.225, 5.225, 5.225);
        let solid = EdgeGrid::new(&outline, 1.0);
        let both = [wall, gap];
        let found = linked_in(&solid, &both);
        assert_eq!(found.len(), 3);
        assert_eq!(found[0], both[0]);
        assert_eq!(found[1].stroke.points[0], corner);
        assert_eq!(found[1].stroke.points[1], found[2].stroke.points[0]);
        // No way leads from a seam that is a gap or a scarf, nor to one far away.
        for (seam_gap, seam_scarf) in [(0.1, 0.0), (0.0, 5.0)] {
            let apart = plan_with(OrderPlan::of, |s| {
                (s.seam_gap, s.seam_scarf) = (seam_gap, seam_scarf.into());
            });
            assert_eq!(linked(both.to_vec(), &solid, &apart), both);
        }
        let back = [both[1].clone(), both[0].clone()];
        assert_eq!(linked_in(&solid, &back), back);
    }

    #[test]
    fn a_way_fills_the_gap_between_walls_that_point_at_each_other() {
        let role = Role::GapFill;
        let pair = |gap: f64| {
            let both = [
                line(role, &[(0.0, 0.0), (5.0, 0.0)]),
                line(role, &[(5.0 + gap, 0.0), (9.0, 0.0)]),
            ];
            (linked_inside(&both), both)
        };
        let (found, both) = pair(0.8);
        assert_eq!((found.len(), strokes(&found)), (3, 1));
        assert_eq!([&found[0], &found[2]], [&both[0], &both[1]]);
        let more = laid(&found) - laid(&both);
        assert!((more - laid_by(&found[1])).abs() < 1e-9, "{more}");
        assert!((found[1].stroke.length() - 0.8).abs() < 1e-9);
        let (found, both) = pair(1.0);
        assert_eq!(found, both);
        // A bead that goes through between them fills the gap already,
        // whether it comes before them or after.
        let (_, [a, b]) = pair(0.8);
        let through = line(role, &[(5.4, -2.0), (5.4, 2.0)]);
        for beads in [[&through, &a, &b], [&a, &b, &through]] {
            let beads = beads.map(Bead::clone);
            assert_eq!(linked_inside(&beads), beads);
        }
    }

    #[test]
    fn no_way_leads_far_back_along_a_stroke_or_takes_most_of_one() {
        let role = Role::InternalSkin;
        let there = line(role, &[(0.0, 0.0), (5.0, 0.0)]);
        let count = |next: &[(f64, f64)]| {
            strokes(&linked_inside(&[there.clone(), line(role, next)]))
        };
        assert_eq!(count(&[(4.0, 0.4), (0.0, 0.4)]), 1);
        assert_eq!(count(&[(3.7, 0.4), (0.0, 0.4)]), 2);
        assert_eq!(count(&[(5.0, 0.4), (5.1, 0.4)]), 1);
        // Two short ones have nothing to make up for the way; walls have to
        // make up for all of it.
        let crumbs = |role, length: f64| {
            let crumb = |y| line(role, &[(5.0, y), (5.0 + length, y)]);
            let mut crumbs = [crumb(0.0), crumb(0.4)];
            crumbs[0].stroke.reverse();
            strokes(&linked_inside(&crumbs))
        };
        assert_eq!(crumbs(role, 0.08), 2);
        assert_eq!(crumbs(role, 0.12), 1);
        assert_eq!(crumbs(Role::InnerWall, 0.12), 2);
        assert_eq!(crumbs(Role::InnerWall, 0.25), 1);
    }

    #[test]
    fn a_way_between_walls_is_no_wall() {
        let role = Role::InnerWall;
        let walls = [
            line(role, &[(0.0, 0.0), (5.0, 0.0)]),
            line(role, &[(5.0, 1.0), (0.0, 1.0)]),
        ];
        let found = linked_inside(&walls);
        let roles: Vec<Role> = found.iter().map(|b| b.role).collect();
        assert_eq!(roles, [role, Role::GapFill, role]);
        assert_eq!(strokes(&found), 1);
        let share = laid(&found) / laid(&walls);
        assert!((share - 1.0).abs() < 2e-3, "{share}");
    }

    #[test]
    fn ways_stay_off_the_outer_walls() {
        // Two arms of a solid, and a notch between them.
        let notched = |notch: f64| {
            let ring = [
                (0.0, -3.0),
                (9.0, -3.0),
                (9.0, -0.5 * notch),
                (4.0, -0.5 * notch),
                (4.0, 0.5 * notch),
                (9.0, 0.5 * notch),
                (9.0, 3.0),
                (0.0, 3.0),
            ];
            let ring = ring.map(|(x, y)| DVec2::new(x, y)).to_vec();
            EdgeGrid::new(&Area::from(ring), 1.0)
        };
        let role = Role::InnerWall;
        let walls = [
            line(role, &[(1.0, -0.7), (8.0, -0.7)]),
            line(role, &[(8.0, 0.7), (1.0, 0.7)]),
        ];
        assert_eq!(linked_in(&notched(0.04), &walls), walls);
        assert!(linked_inside(&walls) != walls);
        // At the arms' foot there is solid between them, but not enough.
        let foot = |x: f64| {
            let at = |y: f64| line(role, &[(1.0, y), (x, y)]);
            let mut walls = [at(-0.7), at(0.7)];
            walls[1].stroke.reverse();
            linked_in(&notched(0.04), &walls) != walls
        };
        assert!(foot(3.2));
        assert!(!foot(3.9));
    }

    #[test]
    fn beads_without_length_stay_as_they_are() {
        let role = Role::GapFill;
        let odd = [
            line(role, &[]),
            line(role, &[(1.0, 1.0)]),
            line(role, &[(1.0, 1.0), (1.0, 1.0)]),
            line(role, &[(1.0, 1.0), (1.0, 1.3)]),
        ];
        assert_eq!(linked_inside(&odd), odd);
    }
}

//! The order in which a layer's beads are printed, and where loops begin.
//!
//! In: a layer's beads by kind, where its seams may be, and where the head comes
//! from. Out: the beads in print order, closed ones rotated to their seam, open ones
//! turned so that travels are short. What is printed last does not depend on where
//! the head comes from. So an order depends on no more than the layer and the end
//! of the layer below. Islands are finished one at a time. Within an island the
//! walls come first, then gap fill and sparse infill, then skin, each on a
//! short tour (`tour`) that begins where the tour before ends. Walls along a
//! border that hang all along come last, since the skin beside them holds them, unless
//! supports hold the layer.
//!
//! | file | what it does |
//! |---|---|
//! | `islands` | which island and which outer wall a bead belongs to |
//! | `island` | the way through one island |
//! | `jobs` | what is printed in one go, and where it may begin |
//! | `supports` | the order of supports, and when they are printed |
//! | `sweep` | lines that wait for one another |
//! | `tour` | the order of any stops |
//! | `begin` | where a closed bead begins |
//! | `link` | short ways between hidden beads, printed instead of hopped |
//! | `nearest`, `near_ends` | which points are near |
//! | `plan` | what is needed of the settings |

mod begin;
mod island;
mod islands;
mod jobs;
mod link;
mod near_ends;
mod nearest;
mod plan;
mod supports;
mod sweep;
mod tour;

pub use begin::begin_near;

use begin::nearest_spot;
use glam::DVec2;
use island::Inside;
use islands::{Island, grid_of, islands};
use isoslice_base::units::Mm;
use isoslice_layer::seam::{BACK, Below, Ground, Site, follow};
use isoslice_layer::skin::Patch;
use isoslice_layer::view::LayerFace;
use isoslice_layer::walls::Support;
use isoslice_planar::bead::{Bead, Role};
pub use link::linked;
pub use plan::OrderPlan;
pub use supports::supports_last;
use tour::{Stop, tour};

/// The beads of a layer.
#[derive(Clone, Debug, Default)]
pub struct LayerBeads {
    /// Loops around the part, in order.
    pub skirt: Vec<Bead>,
    /// Supports.
    pub support: Vec<Bead>,
    /// True if supports are printed after the part.
    pub support_last: bool,
    /// Closed beads of the walls.
    pub walls: Vec<Bead>,
    /// Where the seam of each wall may be.
    pub sites: Vec<Site>,
    /// Sparse infill.
    pub infill: Vec<Bead>,
    /// Skin areas.
    pub skin: Vec<Patch>,
    /// Turns of climbing walls, printed last and as they are.
    pub turns: Vec<Bead>,
}

impl LayerBeads {
    /// The beads of walls and skin.
    pub fn shell(&self) -> impl Iterator<Item = &Bead> + Clone {
        let patches = self.skin.iter().flat_map(|patch| {
            let fills = patch.fills.iter().flat_map(|f| &f.lines);
            patch.rings.iter().chain(fills)
        });
        self.walls.iter().chain(patches)
    }
}

/// How far a seam may be from where it is expected before it counts as another
/// one, and how far from it inner walls may begin, mm.
const SEAM_REACH: Mm = 2.0;

/// What is known of a layer besides its beads.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The layer.
    pub here: LayerFace<'a>,
    /// Where the head is likely to come from; nothing if that is not planned.
    pub from: Option<DVec2>,
    /// Where the seams are expected. If several are on one loop, the first
    /// one counts.
    pub seams: &'a [DVec2],
    /// What holds the layer's walls, unless all of them are held.
    pub support: Option<&'a Support<'a>>,
    /// What holds the layer, if its outline differs from that of the layer
    /// below.
    pub ground: Option<Ground<'a>>,
    /// True if supports hold a part of the layer.
    pub supported: bool,
}

impl Context<'_> {
    /// True if an outer wall hangs somewhere, and so does what is beside it.
    fn hangs(&self, outer: &Bead) -> bool {
        self.support.is_some_and(|support| support.hangs(outer))
    }

    /// True if all walls along one border hang all along, as where a bore begins in the
    /// ceiling of a wider hole.
    fn hang_all_along(&self, walls: &[Bead]) -> bool {
        let closed = walls.first().is_some_and(|outer| outer.stroke.closed);
        let hangs = |g: Ground| walls.iter().all(|w| g.hangs(&w.stroke));
        closed && self.ground.is_some_and(hangs)
    }

    /// True if some of an island's skin lies on the layer below.
    fn holds_some(&self, skin: &[Patch]) -> bool {
        let mut beads = skin.iter().flat_map(Patch::beads);
        let holds = |g: Ground| {
            beads.any(|bead| bead.stroke.points.iter().any(|p| g.holds(*p)))
        };
        self.ground.is_some_and(holds)
    }
}

/// A layer's beads, of which the last ones are in order. They are chosen before the
/// others, and do not depend on where the layer begins, so that the layer above can
/// be told at once where this one ends.
#[derive(Default)]
pub struct Begun {
    skirt: Vec<Bead>,
    /// Supports that come before the part.
    support: Vec<Bead>,
    /// The islands but for the last one.
    islands: Vec<Island>,
    /// What comes before the last beads in their island.
    before: Inside,
    last: Vec<Bead>,
}

/// Begins to put a layer's beads in order.
pub fn order(
    mut beads: LayerBeads,
    context: Context<'_>,
    plan: &OrderPlan,
) -> Begun {
    let skirt = std::mem::take(&mut beads.skirt);
    let mut support = std::mem::take(&mut beads.support);
    let support_last = beads.support_last;
    let outline = context.here.outline.area();
    let mut islands = islands(outline, beads);
    place_seams(&mut islands, context.seams, context.ground);
    islands.retain(|island| island_start(island).is_some());
    let mut before = Inside::default();
    let mut last = Vec::new();
    if support_last && !support.is_empty() {
        let support = std::mem::take(&mut support);
        supports::print(support, outline, &mut None, &mut last);
    } else {
        let stops = stops_at(&islands);
        let visits = tour(&stops, context.from, None);
        if let [ways @ .., visit] = &*visits {
            let at = ways.last().map(|visit| stops[visit.stop].from);
            // The layer above is likely to begin where this one ends, with the
            // same island.
            let to = Some(stops[visit.stop].from);
            let island = islands.swap_remove(visit.stop);
            before = Inside::new(island, context, plan);
            last = before.print_last(at.or(context.from), to);
        }
    }
    Begun {
        skirt,
        support,
        islands,
        before,
        last,
    }
}

impl Begun {
    /// Where the layer ends; none if it has no bead.
    pub fn end(&self) -> Option<DVec2> {
        self.last.iter().rev().find_map(jobs::end)
    }

    /// The beads in print order. `from` is where the head comes from; `context` and
    /// `plan` are those with which the order was begun.
    pub fn finish(
        self,
        from: Option<DVec2>,
        context: Context<'_>,
        plan: &OrderPlan,
    ) -> Vec<Bead> {
        let mut at = from.or(context.from);
        let mut out = Vec::new();
        for mut bead in self.skirt {
            if let Some(at) = at
                && bead.stroke.closed
            {
                begin_near(&mut bead.stroke, at);
            }
            jobs::finish(bead, &mut at, &mut out);
        }
        let outline = context.here.outline.area();
        supports::print(self.support, outline, &mut at, &mut out);
        let last = self.last.first().and_then(|b| b.stroke.ends());
        let last = last.map(|ends| ends.0);
        let to = self.before.start().or(last);
        let stops = stops_at(&self.islands);
        let visits = tour(&stops, at, to);
        let mut left: Vec<Option<Island>> =
            self.islands.into_iter().map(Some).collect();
        for (k, visit) in visits.iter().enumerate() {
            let next = visits.get(k + 1).map(|next| stops[next.stop].from);
            if let Some(island) = left[visit.stop].take() {
                let inside = Inside::new(island, context, plan);
                inside.print(&mut at, next.or(to), &mut out);
            }
        }
        self.before.print(&mut at, last, &mut out);
        out.extend(self.last);
        out
    }
}

/// The islands as stops of a tour.
fn stops_at(islands: &[Island]) -> Vec<Stop> {
    islands
        .iter()
        .filter_map(island_start)
        .map(Stop::at)
        .collect()
}

/// The order in which to visit some places on a short way, which begins at the
/// one that is farthest to the back. A layer that visits them the other way round
/// begins where this way ends.
pub fn course(places: &[DVec2]) -> Vec<usize> {
    let stops: Vec<Stop> = places.iter().copied().map(Stop::at).collect();
    let back = |a: &&DVec2, b: &&DVec2| BACK.dot(**a).total_cmp(&BACK.dot(**b));
    let first = places.iter().max_by(back).copied();
    tour(&stops, first, None).iter().map(|v| v.stop).collect()
}

/// Rotates the outer walls to their seams, of which some are `expected`.
fn place_seams(
    islands: &mut [Island],
    expected: &[DVec2],
    ground: Option<Ground<'_>>,
) {
    let mut loops: Vec<&mut islands::Loop> =
        islands.iter_mut().flat_map(|i| &mut i.loops).collect();
    // For each loop the place of the first seam that is expected on it.
    let mut near: Vec<Option<DVec2>> = vec![None; loops.len()];
    if !expected.is_empty() && loops.iter().any(|l| l.site.follows) {
        let outer = loops.iter().filter_map(|l| l.walls.first());
        let grid = grid_of(outer, 0.5 * SEAM_REACH);
        for &seam in expected {
            if let Some((ring, point)) = grid.nearest_within(seam, SEAM_REACH) {
                near[ring].get_or_insert(point);
            }
        }
    }
    for (group, near) in loops.iter_mut().zip(near) {
        let Some(outer) = group.walls.first_mut() else {
            continue;
        };
        if !outer.stroke.closed || outer.role != Role::OuterWall {
            continue;
        }
        let planned = near.filter(|_| group.site.follows);
        let planned = planned.map(Below::planned);
        let seam = follow(&group.site, &outer.stroke.points, planned, ground);
        let spot = seam.and_then(|seam| nearest_spot(&outer.stroke, seam));
        if let Some(spot) = spot {
            begin::begin_at(&mut outer.stroke, spot);
        }
    }
}

/// Where an island's printing would start.
fn island_start(island: &Island) -> Option<DVec2> {
    let walls = island.loops.iter().flat_map(|l| &l.walls);
    let skin = island.skin.iter().filter_map(Patch::first);
    walls
        .chain(&island.gaps)
        .chain(&island.infill)
        .chain(skin)
        .next()
        .and_then(|b| b.stroke.points.first().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::Stroke;
    use isoslice_planar::{Area, Solid};
    use isoslice_settings::WallOrder;
    use isoslice_settings::layers::LayerSpan;
    use isoslice_settings::testing::{plan_with, usual_plan};
    use jobs::Job;

    fn ring(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    fn wall(role: Role, points: Vec<DVec2>) -> Bead {
        Bead::new(role, Stroke::new(points, true, 0.45), 0.2)
    }

    fn line(role: Role, at: &[(f64, f64)]) -> Bead {
        Bead::new(role, Stroke::new(ring(at), false, 0.45), 0.2)
    }

    fn square(x: f64, half: f64) -> Vec<DVec2> {
        ring(&[
            (x - half, -half),
            (x + half, -half),
            (x + half, half),
            (x - half, half),
        ])
    }

    fn held<'a>(outline: &'a Solid<'a>) -> Context<'a> {
        Context {
            here: LayerFace {
                span: LayerSpan {
                    index: 1,
                    bottom: 0.2,
                    top: 0.4,
                },
                outline,
                rough: outline,
                top: outline,
                risen: None,
            },
            from: None,
            seams: &[],
            support: None,
            ground: None,
            supported: false,
        }
    }

    fn two_squares() -> (LayerBeads, Solid<'static>) {
        let beads = LayerBeads {
            walls: vec![
                wall(Role::OuterWall, square(0.0, 4.0)),
                wall(Role::OuterWall, square(20.0, 4.0)),
                wall(Role::InnerWall, square(0.0, 3.0)),
                wall(Role::InnerWall, square(20.0, 3.0)),
            ],
            ..LayerBeads::default()
        };
        let outline = Area::from_iter([square(0.0, 4.2), square(20.0, 4.2)]);
        (beads, Solid::new(outline))
    }

    #[test]
    fn islands_are_finished_one_at_a_time() {
        let (beads, outline) = two_squares();
        let context = Context {
            from: Some(DVec2::new(30.0, 0.0)),
            ..held(&outline)
        };
        let plan = usual_plan(OrderPlan::of);
        let out = order(beads, context, &plan).finish(None, context, &plan);
        let side: Vec<bool> =
            out.iter().map(|b| b.stroke.points[0].x > 10.0).collect();
        assert_eq!(side, [true, true, false, false]);
        let roles: Vec<Role> = out.iter().map(|b| b.role).collect();
        use Role::{InnerWall, OuterWall};
        assert_eq!(roles, [InnerWall, OuterWall, InnerWall, OuterWall]);
    }

    #[test]
    fn seams_are_where_they_are_expected() {
        let (mut beads, outline) = two_squares();
        let corners = [DVec2::new(1.0, -4.0), DVec2::new(4.0, 4.0)];
        let site = |x: f64| Site {
            at: Some(DVec2::new(x + 4.0, 4.0)),
            follows: true,
            corners: corners.iter().map(|c| *c + DVec2::X * x).collect(),
            sharp: vec![DVec2::new(x + 4.0, 4.0)],
        };
        beads.sites = vec![site(0.0), site(20.0)];
        let context = Context {
            // Both are expected on the same loop. The second one is nearer to it,
            // and does not count.
            seams: &[DVec2::new(1.2, -4.1), DVec2::new(4.0, 4.0)],
            ..held(&outline)
        };
        let plan = usual_plan(OrderPlan::of);
        let out = order(beads, context, &plan).finish(None, context, &plan);
        let starts: Vec<DVec2> = out
            .iter()
            .filter(|b| b.role == Role::OuterWall)
            .map(|b| b.stroke.points[0])
            .collect();
        assert!(starts.contains(&DVec2::new(1.0, -4.0)), "{starts:?}");
        // The other seam starts anew, where it would be by itself.
        assert!(starts.contains(&DVec2::new(24.0, 4.0)), "{starts:?}");
        // The walls behind begin beside the seam.
        let inner = out.iter().filter(|b| b.role == Role::InnerWall);
        let begins: Vec<DVec2> = inner.map(|b| b.stroke.points[0]).collect();
        let beside = DVec2::new(1.0, -3.0);
        let near = |p: &DVec2| p.distance(beside) < 1e-9;
        assert!(begins.iter().any(near), "{begins:?}");
    }

    #[test]
    fn walls_are_printed_in_the_order_that_was_asked_for() {
        for (wall_order, first) in [
            (WallOrder::InnerFirst, Role::InnerWall),
            (WallOrder::OuterFirst, Role::OuterWall),
        ] {
            let (mut beads, outline) = two_squares();
            // A piece of a wall far from every seam, and one in a gap.
            let piece = |role, from: f64, to: f64| {
                line(role, &[(from, -3.0), (to, -3.0)])
            };
            beads.walls.push(piece(Role::InnerWall, -2.0, -1.0));
            beads.walls.push(piece(Role::GapFill, 1.0, 2.0));
            beads.sites = vec![
                Site {
                    at: Some(DVec2::new(4.0, 4.0)),
                    ..Site::default()
                };
                2
            ];
            let plan = plan_with(OrderPlan::of, |s| s.wall_order = wall_order);
            let context = held(&outline);
            let out = order(beads, context, &plan).finish(None, context, &plan);
            assert_eq!(out.len(), 6);
            let here = out.iter().filter(|b| b.stroke.points[0].x < 10.0);
            let roles: Vec<Role> = here.map(|b| b.role).collect();
            let at = |role| roles.iter().position(|r| *r == role).unwrap();
            assert_eq!(roles.len(), 4, "{roles:?}");
            let last = roles.iter().rposition(|r| *r == Role::InnerWall);
            match first {
                Role::InnerWall => {
                    assert!(last.unwrap() < at(Role::OuterWall));
                }
                _ => assert!(at(Role::OuterWall) < at(Role::InnerWall)),
            }
        }
    }

    #[test]
    fn layers_above_each_other_begin_where_the_last_one_ends() {
        let centres = [0.0, 40.0, 20.0].map(|x| DVec2::new(x, 0.0));
        let order_of = |from: usize| -> Vec<f64> {
            let walls =
                centres.map(|c| wall(Role::OuterWall, square(c.x, 4.0)));
            let outline = centres.map(|c| square(c.x, 4.2));
            let outline = Solid::new(Area::from_iter(outline));
            let beads = LayerBeads {
                walls: walls.to_vec(),
                ..LayerBeads::default()
            };
            let context = Context {
                from: Some(centres[from]),
                ..held(&outline)
            };
            let plan = usual_plan(OrderPlan::of);
            let out = order(beads, context, &plan).finish(None, context, &plan);
            out.iter().map(|b| b.stroke.points[0].x + 4.0).collect()
        };
        let course = course(&centres);
        assert_eq!(course, [1, 2, 0]);
        let (first, last) = (course[0], course[2]);
        assert_eq!(order_of(first), [40.0, 20.0, 0.0]);
        assert_eq!(order_of(last), [0.0, 20.0, 40.0]);
    }

    #[test]
    fn lines_and_rings_are_printed_on_a_short_way() {
        let jobs = [0.0, 2.0, 1.0]
            .map(|y| Job::of(line(Role::SparseInfill, &[(0.0, y), (10.0, y)])));
        let mut at = Some(DVec2::new(11.0, -1.0));
        let mut out = Vec::new();
        let jobs = jobs.into_iter().map(|j| (0, j)).collect();
        jobs::print(jobs, &mut at, None, &mut out);
        let path: Vec<(f64, f64)> = out
            .iter()
            .map(|b| (b.stroke.points[0].x, b.stroke.points[0].y))
            .collect();
        assert_eq!(path, [(10.0, 0.0), (0.0, 1.0), (10.0, 2.0)]);
        // A ring begins on the way, between its corners if need be.
        let around = Job::of(wall(Role::SparseInfill, square(20.0, 2.0)));
        let mut at = Some(DVec2::new(11.0, 0.5));
        let mut out = Vec::new();
        let end = at;
        jobs::print(vec![(0, around)], &mut at, end, &mut out);
        assert_eq!(out[0].stroke.points.len(), 5);
        assert_eq!(at, Some(DVec2::new(18.0, 0.5)));
    }
}

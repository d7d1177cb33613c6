//! The order in which a layer's beads are printed, and where loops begin.
//!
//! In: a layer's beads by kind, and where its seams may be. Out: the beads in
//! print order, closed ones rotated to their seam, open ones turned so that
//! travels are short. Islands are finished one at a time. Within an island the
//! walls come first, then gap fill and sparse infill, then skin, each on a
//! short tour (`tour`) that begins where the tour before ends.
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
use island::print_island;
use islands::{Island, grid_of, islands};
use isoslice_base::units::Mm;
use isoslice_layer::seam::{Below, Ground, Site, follow};
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
    pub fn shell(&self) -> impl Iterator<Item = &Bead> {
        let patches = self.skin.iter().flat_map(|patch| {
            let fills = patch.fills.iter().flat_map(|f| &f.lines);
            patch.rings.iter().chain(fills)
        });
        self.walls.iter().chain(patches)
    }
}

/// What one layer hands to the next.
#[derive(Clone, Debug, Default)]
pub struct Head {
    /// Where the nozzle stands; nothing if it has not printed yet.
    pub at: Option<DVec2>,
    /// The seams of the layer below.
    pub seams: Vec<DVec2>,
}

/// How far a seam may move from one layer to the next before it counts as a new
/// one, and how far from it inner walls may begin, mm.
const SEAM_REACH: Mm = 2.0;

/// What is known of a layer besides its beads.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The layer.
    pub here: LayerFace<'a>,
    /// What holds the layer's walls, unless all of them are held.
    pub support: Option<&'a Support<'a>>,
    /// What holds the layer, if its outline differs from that of the layer
    /// below.
    pub ground: Option<Ground<'a>>,
}

impl Context<'_> {
    /// True if an outer wall hangs somewhere, and so does what is beside it.
    fn hangs(&self, outer: &Bead) -> bool {
        self.support.is_some_and(|support| support.hangs(outer))
    }
}

/// Puts a layer's beads in order.
pub fn order(
    mut beads: LayerBeads,
    context: Context<'_>,
    head: &mut Head,
    plan: &OrderPlan,
) -> Vec<Bead> {
    let mut out = Vec::new();
    for mut bead in std::mem::take(&mut beads.skirt) {
        if let Some(at) = head.at
            && bead.stroke.closed
        {
            begin_near(&mut bead.stroke, at);
        }
        jobs::finish(bead, &mut head.at, &mut out);
    }
    let support = std::mem::take(&mut beads.support);
    let (first, last) = if beads.support_last {
        (Vec::new(), support)
    } else {
        (support, Vec::new())
    };
    let outline = context.here.outline.area();
    supports::print(first, outline, &mut head.at, &mut out);
    let mut islands = islands(outline, beads);
    head.seams = place_seams(&mut islands, &head.seams, context.ground);
    let mut stops = Vec::new();
    let mut left = Vec::new();
    for island in islands {
        if let Some(p) = island_start(&island) {
            stops.push(Stop {
                from: p,
                to: p,
                turns: false,
                stage: 0,
            });
            left.push(Some(island));
        }
    }
    let visits = tour(&stops, head.at, None);
    for (k, visit) in visits.iter().enumerate() {
        // The layer above is likely to begin where this one ends, with the
        // same island.
        let next = visits.get(k + 1).unwrap_or(visit);
        let to = Some(stops[next.stop].from);
        if let Some(island) = left[visit.stop].take() {
            print_island(island, &mut head.at, to, context, plan, &mut out);
        }
    }
    supports::print(last, outline, &mut head.at, &mut out);
    out
}

/// The order in which to go some ways, each from its beginning to its end, so
/// that the whole way from `at` on is short.
pub fn in_turn(ways: &[(DVec2, DVec2)], at: Option<DVec2>) -> Vec<usize> {
    let stop = |&(from, to): &(DVec2, DVec2)| Stop {
        from,
        to,
        turns: false,
        stage: 0,
    };
    let stops: Vec<Stop> = ways.iter().map(stop).collect();
    tour(&stops, at, None).iter().map(|v| v.stop).collect()
}

/// Rotates the outer walls to their seams, which are returned.
fn place_seams(
    islands: &mut [Island],
    below: &[DVec2],
    ground: Option<Ground<'_>>,
) -> Vec<DVec2> {
    let mut loops: Vec<&mut islands::Loop> =
        islands.iter_mut().flat_map(|i| &mut i.loops).collect();
    // For each loop the seam below that is nearest to it.
    let mut near: Vec<Option<(f64, DVec2)>> = vec![None; loops.len()];
    if !below.is_empty() && loops.iter().any(|l| l.site.follows) {
        let outer = loops.iter().filter_map(|l| l.walls.first());
        let grid = grid_of(outer, 0.5 * SEAM_REACH);
        for &seam in below {
            if let Some((ring, point)) = grid.nearest_within(seam, SEAM_REACH) {
                let d = seam.distance(point);
                if near[ring].is_none_or(|b| d < b.0) {
                    near[ring] = Some((d, point));
                }
            }
        }
    }
    let mut seams = Vec::new();
    for (group, near) in loops.iter_mut().zip(near) {
        let Some(outer) = group.walls.first_mut() else {
            continue;
        };
        if !outer.stroke.closed || outer.role != Role::OuterWall {
            continue;
        }
        let below = near.map(|n| n.1).filter(|_| group.site.follows);
        let below = below.map(Below::right);
        let seam = follow(&group.site, &outer.stroke.points, below, ground);
        let Some(seam) = seam else {
            continue;
        };
        seams.push(seam);
        if let Some(spot) = nearest_spot(&outer.stroke, seam) {
            begin::begin_at(&mut outer.stroke, spot);
        }
    }
    seams
}

/// Where an island's printing would start.
fn island_start(island: &Island) -> Option<DVec2> {
    let walls = island.loops.iter().flat_map(|l| &l.walls);
    let skin = island.skin.iter().flat_map(|p| &p.rings);
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
            },
            support: None,
            ground: None,
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
        let mut head = Head {
            at: Some(DVec2::new(30.0, 0.0)),
            ..Head::default()
        };
        let plan = usual_plan(OrderPlan::of);
        let out = order(beads, held(&outline), &mut head, &plan);
        let side: Vec<bool> =
            out.iter().map(|b| b.stroke.points[0].x > 10.0).collect();
        assert_eq!(side, [true, true, false, false]);
        let roles: Vec<Role> = out.iter().map(|b| b.role).collect();
        use Role::{InnerWall, OuterWall};
        assert_eq!(roles, [InnerWall, OuterWall, InnerWall, OuterWall]);
    }

    #[test]
    fn seams_follow_those_of_the_layer_below() {
        let (mut beads, outline) = two_squares();
        let corners = [DVec2::new(1.0, -4.0), DVec2::new(4.0, 4.0)];
        let site = |x: f64| Site {
            at: Some(DVec2::new(x + 4.0, 4.0)),
            follows: true,
            corners: corners.iter().map(|c| *c + DVec2::X * x).collect(),
            sharp: vec![DVec2::new(x + 4.0, 4.0)],
        };
        beads.sites = vec![site(0.0), site(20.0)];
        let mut head = Head {
            at: None,
            seams: vec![DVec2::new(1.2, -4.1)],
        };
        let plan = usual_plan(OrderPlan::of);
        let out = order(beads, held(&outline), &mut head, &plan);
        let starts: Vec<DVec2> = out
            .iter()
            .filter(|b| b.role == Role::OuterWall)
            .map(|b| b.stroke.points[0])
            .collect();
        assert!(starts.contains(&DVec2::new(1.0, -4.0)), "{starts:?}");
        // The other seam starts anew, where it would be by itself.
        assert!(starts.contains(&DVec2::new(24.0, 4.0)), "{starts:?}");
        assert_eq!(head.seams.len(), 2);
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
            let mut head = Head::default();
            let plan = plan_with(OrderPlan::of, |s| s.wall_order = wall_order);
            let out = order(beads, held(&outline), &mut head, &plan);
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

use super::*;
use decide::Obstacles;
use isoslice_layer::view::LayerFace;
use isoslice_planar::Area;
use isoslice_planar::bead::Role;
use isoslice_planar::bead::{Stroke, spacing};
use isoslice_planar::shapes::rect;
use isoslice_settings::testing::usual_plan;
use isoslice_settings::{Combing, Hidden, HopWhen};

const SPAN: LayerSpan = LayerSpan {
    index: 0,
    bottom: 0.0,
    top: 0.2,
};

fn points(at: &[(f64, f64)]) -> Vec<DVec2> {
    at.iter().map(|&p| DVec2::from(p)).collect()
}

fn bead(role: Role, at: &[(f64, f64)]) -> Bead {
    Bead::new(role, Stroke::new(points(at), false, 0.45), 0.2)
}

fn closed(role: Role, points: Vec<DVec2>) -> Bead {
    Bead::new(role, Stroke::new(points, true, 0.45), 0.2)
}

/// Depth at which so many walls end.
fn border(walls: f64) -> Mm {
    0.225 + (walls - 0.5) * spacing(0.45, 0.45, SPAN.height())
}

/// A layer: its outline, its sparse infill, and walls along the outline.
struct Part {
    outline: Area,
    sparse: Area,
    above: Option<Area>,
    walls: Vec<Bead>,
    /// Depth at which the walls end.
    border: Mm,
    plan: TravelPlan,
}

impl Part {
    fn new(outlines: &[[f64; 4]]) -> Part {
        let mut part = Part {
            outline: Area::EMPTY,
            sparse: Area::EMPTY,
            above: None,
            walls: Vec::new(),
            border: border(2.0),
            plan: usual_plan(TravelPlan::of),
        };
        for &[x0, y0, x1, y1] in outlines {
            part.outline.rings.extend(rect(x0, y0, x1, y1).rings);
            part.sparse
                .rings
                .extend(rect(x0 + 0.8, y0 + 0.8, x1 - 0.8, y1 - 0.8).rings);
            for (role, d) in [(Role::InnerWall, 0.6), (Role::OuterWall, 0.225)]
            {
                let ring = rect(x0 + d, y0 + d, x1 - d, y1 - d).rings;
                let points = ring.into_iter().flatten().collect();
                part.walls.push(closed(role, points));
            }
        }
        part
    }

    /// A square 20 mm wide.
    fn square() -> Part {
        Part::new(&[[0.0, 0.0, 20.0, 20.0]])
    }

    /// The square with a hole in the middle, and a wall around the hole.
    fn ring() -> Part {
        Part::with_hole([8.0, 2.0, 12.0, 18.0])
    }

    /// The square with a hole, and a wall around the hole.
    fn with_hole([x0, y0, x1, y1]: [f64; 4]) -> Part {
        let mut part = Part::square();
        let hole = |d: f64| {
            let mut area = rect(x0 - d, y0 - d, x1 + d, y1 + d);
            area.rings.iter_mut().for_each(|r| r.reverse());
            area.rings
        };
        part.outline.rings.extend(hole(0.0));
        part.sparse.rings.extend(hole(0.4));
        let points = hole(0.225).remove(0);
        part.walls.push(closed(Role::OuterWall, points));
        part
    }

    fn with(mut self, change: impl Fn(&mut TravelPlan)) -> Part {
        change(&mut self.plan);
        self
    }

    fn ask<T>(
        &self,
        beads: &[Bead],
        question: impl FnOnce(&Obstacles<'_>) -> T,
    ) -> T {
        self.on_ground(|ground| {
            question(&Obstacles::new(beads, ground, &self.plan))
        })
    }

    fn on_ground<T>(&self, act: impl FnOnce(Ground<'_>) -> T) -> T {
        let above = self.above.as_ref().map(|area| Solid::of(area, 1.0));
        let here = Solid::of(&self.outline, 1.0);
        fn face<'a>(outline: &'a Solid<'a>) -> LayerFace<'a> {
            LayerFace {
                span: SPAN,
                outline,
                rough: outline,
                top: outline,
                risen: None,
            }
        }
        let view = LayerView {
            here: face(&here),
            above: above.iter().map(face).collect(),
            below: Vec::new(),
        };
        act(Ground {
            view: &view,
            sparse: &Solid::of(&self.sparse, 1.0),
            border: self.border,
        })
    }

    /// The path through some beads of the part, moved by `offset`.
    fn path(&self, beads: Vec<Bead>, offset: DVec2) -> LayerPath {
        let beads = beads.into_iter().map(Ended::from).collect();
        self.on_ground(|ground| {
            connect(beads, ground, None, offset, &self.plan)
        })
    }

    /// The travels between beads of the part, in order; its walls come first.
    fn travels(&self, beads: Vec<Bead>) -> Vec<Travel> {
        let count = beads.len();
        let all: Vec<Bead> = self.walls.iter().cloned().chain(beads).collect();
        let path = self.path(all, DVec2::ZERO);
        let mut travels: Vec<Travel> = path
            .moves
            .into_iter()
            .filter_map(|m| match m {
                Move::Travel(travel) => Some(travel),
                Move::Print(_) => None,
            })
            .collect();
        travels.split_off(travels.len() + 1 - count)
    }

    /// The travel from where one bead of infill ends to another one.
    fn travel(&self, from: (f64, f64), to: (f64, f64)) -> Travel {
        let short =
            |p: (f64, f64)| bead(Role::SparseInfill, &[(p.0, p.1 + 0.1), p]);
        let mut to = short(to);
        to.stroke.reverse();
        self.travels(vec![short(from), to]).remove(0)
    }
}

#[test]
fn ways_of_no_point_and_of_one() {
    let part = Part::square();
    part.ask(&part.walls, |o| {
        assert!(o.within_infill(&[]) && !o.wall(&[]) && !o.air(&[]));
        let inside = points(&[(10.0, 10.0)]);
        assert!(o.within_infill(&inside) && !o.wall(&inside));
        assert!(!o.within_infill(&points(&[(0.3, 10.0)])));
        assert!(!o.within_infill(&points(&[(-3.0, 10.0)])));
    });
    assert!(part.travels(vec![bead(Role::SparseInfill, &[])]).is_empty());
}

/// A support beside the part, and what is printed after it: another support, or the
/// part's first bead. A way that is no longer than a retraction is worth leaves no
/// string to speak of. All others would leave one, however near to the part, and
/// also where this layer covers most of the way.
#[test]
fn from_a_support_every_way_is_retracted_that_is_long_enough() {
    let part = Part::square();
    let least = part.plan.retract.min_travel;
    let travel = |role: Role, to: (f64, f64)| {
        let support = bead(Role::Support, &[(-1.0, 4.0), (-1.0, 5.0)]);
        let next = bead(role, &[to, (to.0, to.1 + 0.5)]);
        let path = part.path(vec![support, next], DVec2::ZERO);
        let [_, _, Move::Travel(travel), _] = &path.moves[..] else {
            panic!("{path:?}");
        };
        travel.clone()
    };
    use Role::{InnerWall, Support, SupportInterface};
    for (role, x) in [
        (Support, -1.0 - least),
        (SupportInterface, -11.0),
        (Support, 21.0),
        (InnerWall, 0.6),
        (InnerWall, 12.0),
    ] {
        let to = DVec2::new(x, 5.0);
        let straight = Travel::straight(to, true);
        assert_eq!(travel(role, (x, 5.0)), straight, "{role:?} {x}");
    }
    let near = (-1.0 - 0.9 * least, 5.0);
    let straight = Travel::straight(near.into(), false);
    assert_eq!(travel(Support, near), straight);
}

/// Whatever the least travel for a retraction is, ways go round a hole. Where they
/// are too short for a retraction and no way leads round, they go straight.
#[test]
fn the_way_round_does_not_depend_on_what_is_worth_a_retraction() {
    for walls in [true, false] {
        let way = |min_travel: f64| {
            let mut part =
                Part::ring().with(|s| s.retract.min_travel = min_travel);
            if !walls {
                part.walls.clear();
                part.walls.push(bead(Role::OuterWall, &[(1.0, 1.0)]));
            }
            part.travel((7.0, 9.0), (13.0, 9.0))
        };
        let [most, least] = [1.5, 100.0].map(way);
        assert!(most.points.len() > 2, "{most:?}");
        assert_eq!(least.points, most.points);
        assert!(!least.retract);
    }
    let part = Part::new(&[[0.0, 0.0, 10.0, 8.0], [0.0, 9.0, 10.0, 17.0]])
        .with(|s| s.retract.min_travel = 100.0);
    let to = (8.0, 10.0);
    let straight = Travel::straight(DVec2::from(to), false);
    assert_eq!(part.travel((2.0, 7.0), to), straight);
}

/// A hop of 1.4 mm across a hole. The way round it that shows is retracted unless
/// it is short, and is not taken if it is long. Over infill it is hidden.
#[test]
fn no_long_way_round_shows_its_ooze() {
    let hop = |high: f64, min_travel: f64, hidden: bool| {
        let (low, top) = (10.0 - 0.5 * high, 10.0 + 0.5 * high);
        let mut part = Part::with_hole([9.6, low, 10.4, top])
            .with(|s| s.retract.min_travel = min_travel)
            .with(|s| s.retract.z_hop = 0.4)
            .with(|s| s.retract.z_hop_when = HopWhen::Always)
            .with(|s| s.retract.hidden = Hidden::SparseInfill);
        part.border = border(1.0);
        if !hidden {
            part.sparse = Area::EMPTY;
        }
        part.travel((9.3, 10.0), (10.7, 10.0))
    };
    let straight = Travel::straight(DVec2::new(10.7, 10.0), false);
    assert_eq!(hop(16.0, 1.5, false), straight);
    for (high, min_travel, hidden, retracts) in [
        (0.5, 1.5, false, true),
        (0.5, 7.0, false, false),
        (16.0, 100.0, false, false),
        (16.0, 1.5, true, false),
    ] {
        let travel = hop(high, min_travel, hidden);
        assert!(travel.points.len() > 2, "{high} {min_travel}: {travel:?}");
        assert_eq!(travel.retract, retracts, "{high} {min_travel}");
        assert_eq!(travel.hop, retracts, "{high} {min_travel}");
    }
}

/// A top skin of lines to and fro, and the way from its end back over it, or away
/// from it. Whatever nothing covers is a top, too.
#[test]
fn what_stays_in_sight_is_crossed_with_a_retraction() {
    let mut part = Part::square().with(|s| s.retract.hidden = Hidden::Covered);
    part.walls.clear();
    let lines = [(5.0, 5.0), (15.0, 5.0), (15.0, 5.4), (5.0, 5.4)];
    let travel = |part: &Part, role: Role, to: (f64, f64)| {
        let skin = bead(role, &lines);
        let next = bead(Role::InternalSkin, &[to, (to.0, to.1 + 0.5)]);
        let path = part.path(vec![skin, next], DVec2::ZERO);
        let mut travels = path.moves.iter().filter_map(|step| match step {
            Move::Travel(travel) => Some(travel.retract),
            Move::Print(_) => None,
        });
        travels.next_back().unwrap()
    };
    let (back, away) = ((13.0, 4.0), (5.0, 9.0));
    let covered = Some(part.outline.clone());
    for (above, role, retracts) in [
        (&covered, Role::TopSkin, true),
        (&covered, Role::InternalSkin, false),
        (&None, Role::InternalSkin, true),
        (&None, Role::SparseInfill, false),
    ] {
        part.above.clone_from(above);
        assert_eq!(travel(&part, role, back), retracts, "{role:?}");
        assert!(!travel(&part, role, away), "{role:?}");
    }
    let part = part.with(|s| s.combing = Combing::Off);
    assert!(travel(&part, Role::TopSkin, back));
}

#[test]
fn inside_outside_and_across_the_border() {
    let part = Part::square();
    part.ask(&part.walls, |o| {
        let within = |at: &[(f64, f64)]| o.within_infill(&points(at));
        assert!(within(&[(2.0, 2.0), (18.0, 17.0)]));
        assert!(within(&[(2.0, 2.0), (9.0, 17.0), (18.0, 2.0)]));
        assert!(!within(&[(2.0, 2.0), (30.0, 2.0)]));
        assert!(!within(&[(30.0, 2.0), (40.0, 2.0)]));
        // The way leaves the infill and comes back.
        assert!(!within(&[(2.0, 2.0), (10.0, -1.0), (18.0, 2.0)]));
        // The way leads around the infill, but its box holds the infill's box.
        assert!(!within(&[(-5.0, 10.0), (10.0, -15.0)]));
    });
}

#[test]
fn the_beads_at_the_ends_are_left_and_reached() {
    let part = Part::square();
    part.ask(&part.walls, |o| {
        // Ways from the middle of the inner wall, and from that of the outer
        // wall.
        let inner = points(&[(0.6, 10.0), (10.0, 10.0)]);
        assert!(o.within_infill(&inner) && !o.wall(&inner));
        let outer = points(&[(0.225, 10.0), (10.0, 10.0)]);
        assert!(!o.within_infill(&outer) && o.wall(&outer));
    });
}

#[test]
fn to_touch_is_to_cross() {
    let part = Part::square();
    let wall = bead(Role::InnerWall, &[(5.0, 10.0), (15.0, 10.0)]);
    part.ask(&[wall], |o| {
        let crosses = |at: &[(f64, f64)]| o.wall(&points(at));
        assert!(crosses(&[(10.0, 5.0), (10.0, 15.0)]));
        // A way's end is on the wall, then a corner, then a stretch.
        assert!(crosses(&[(5.0, 5.0), (5.0, 15.0)]));
        assert!(crosses(&[(5.0, 5.0), (10.0, 10.0), (15.0, 5.0)]));
        assert!(crosses(&[(2.0, 10.0), (8.0, 10.0)]));
        assert!(crosses(&[(2.0, 10.0), (18.0, 10.0)]));
        // This way is on the wall's line, but elsewhere.
        assert!(!crosses(&[(2.0, 10.0), (4.0, 10.0)]));
        // The first way is nearer than half a line's width, the second is not.
        assert!(crosses(&[(5.0, 9.9), (15.0, 9.9)]));
        assert!(!crosses(&[(5.0, 9.75), (15.0, 9.75)]));
        // Ways from where the wall ends, and to where it begins.
        assert!(!crosses(&[(15.0, 10.0), (15.0, 2.0)]));
        assert!(!crosses(&[(2.0, 2.0), (5.0, 10.0)]));
    });
    // Ways along the border of the infill, and through its corner.
    part.ask(&[], |o| {
        let within = |at: &[(f64, f64)]| o.within_infill(&points(at));
        assert!(!within(&[(0.8, 2.0), (0.8, 15.0)]));
        assert!(!within(&[(5.0, 5.0), (0.8, 8.0), (5.0, 11.0)]));
        assert!(within(&[(5.0, 5.0), (0.81, 8.0), (5.0, 11.0)]));
    });
}

#[test]
fn a_thin_gap_between_islands_is_air() {
    let part = Part::new(&[[0.0, 0.0, 10.0, 20.0], [10.05, 0.0, 20.0, 20.0]]);
    part.ask(&part.walls, |o| {
        let across = points(&[(5.0, 10.0), (15.0, 10.0)]);
        assert!(o.air(&across) && !o.within_infill(&across));
        for x in [5.0, 15.0] {
            assert!(o.within_infill(&points(&[(x, 2.0), (x, 18.0)])));
        }
    });
    assert!(part.travel((5.0, 10.0), (15.0, 10.0)).retract);
}

#[test]
fn layers_do_not_remember_each_other() {
    let (whole, split) = (
        Part::square(),
        Part::new(&[[0.0, 0.0, 9.0, 20.0], [11.0, 0.0, 20.0, 20.0]]),
    );
    for _ in 0..2 {
        assert!(!whole.travel((5.0, 10.0), (15.0, 10.0)).retract);
        assert!(split.travel((5.0, 10.0), (15.0, 10.0)).retract);
    }
}

#[test]
fn short_travels_are_straight_and_long_ones_retract() {
    let part = Part::square().with(|s| s.retract.when_crossing = false);
    let near = part.travel((5.0, 5.0), (6.4, 5.0));
    assert_eq!(near, Travel::straight(DVec2::new(6.4, 5.0), false));
    assert!(part.travel((5.0, 5.0), (6.6, 5.0)).retract);
    let part = part.with(|s| s.retract.min_travel = 3.0);
    assert!(!part.travel((5.0, 5.0), (6.6, 5.0)).retract);
}

#[test]
fn too_much_ooze_is_retracted() {
    let part = Part::square().with(|s| s.retract.max_unretracted = 8.0);
    let ends = |x| ((5.0, 5.0), (x, 5.0));
    let travel = |part: &Part, x| {
        let (from, to) = ends(x);
        part.travel(from, to)
    };
    assert!(!travel(&part, 12.9).retract && travel(&part, 13.1).retract);
}

#[test]
fn walls_in_the_way_are_checked_or_not() {
    let hidden = Hidden::SparseInfill;
    let part = Part::square().with(|s| s.retract.hidden = hidden);
    let lines = |wall: Role| {
        vec![
            bead(wall, &[(10.0, 0.9), (10.0, 19.1)]),
            bead(Role::SparseInfill, &[(5.0, 9.0), (5.0, 10.0)]),
            bead(Role::SparseInfill, &[(15.0, 10.0), (15.0, 9.0)]),
        ]
    };
    let last = |part: &Part, wall| part.travels(lines(wall)).remove(1);
    assert!(last(&part, Role::InnerWall).retract);
    assert!(!last(&part, Role::SparseInfill).retract);
    let part = part.with(|s| s.retract.check_walls = false);
    assert!(!last(&part, Role::InnerWall).retract);
}

#[test]
fn walls_that_hang_are_still_inner_or_outer_ones() {
    let part = Part::square();
    let hangs = |at: &[(f64, f64)]| vec![bead(Role::Overhang, at)];
    let inner = hangs(&[(10.0, 3.0), (10.0, 10.0), (10.0, 17.0)]);
    let outer = hangs(&[(0.225, 3.0), (0.225, 10.0), (0.225, 17.0)]);
    let across = points(&[(5.0, 9.0), (15.0, 9.0)]);
    let along = points(&[(1.0, 5.0), (0.1, 6.0), (1.0, 7.0)]);
    part.ask(&inner, |o| {
        assert!(o.inner_wall(&across));
        assert!(!o.outer_wall(&across, 9));
    });
    part.ask(&outer, |o| {
        assert!(!o.inner_wall(&across));
        assert!(o.outer_wall(&along, 9));
    });
}

#[test]
fn what_hides_ooze_is_a_matter_of_settings() {
    // This layer has no sparse infill at all.
    let mut part = Part::square();
    part.sparse = Area::EMPTY;
    let lines = |role: Role| {
        vec![
            bead(role, &[(3.0, 3.0), (17.0, 3.0)]),
            bead(role, &[(3.0, 10.0), (17.0, 10.0)]),
            bead(role, &[(3.0, 17.0), (17.0, 17.0)]),
        ]
    };
    let skin = lines(Role::InternalSkin);
    let part = part.with(|s| s.retract.hidden = Hidden::SparseInfill);
    assert!(part.travels(skin.clone()).iter().all(|t| t.retract));
    let part = part.with(|s| s.retract.hidden = Hidden::Covered);
    assert!(part.travels(skin).iter().all(|t| !t.retract));
    // The way leads over the first line from the second line's end.
    let mut top = lines(Role::TopSkin);
    top.swap(0, 1);
    assert!(part.travels(top).iter().any(|t| t.retract));
}

#[test]
fn travels_behind_the_outer_walls_are_hidden() {
    let retracts = |part: &Part, hidden: Hidden, to: (f64, f64)| {
        // The way to the right leads over a piece of an inner wall, the one to
        // the left over a piece of an outer one.
        let beads = vec![
            bead(Role::InnerWall, &[(12.0, 5.0), (12.0, 15.0)]),
            bead(Role::OuterWall, &[(8.0, 5.0), (8.0, 15.0)]),
            bead(Role::InternalSkin, &[(10.0, 9.0), (10.0, 10.0)]),
            bead(Role::InternalSkin, &[to, (to.0, to.1 + 1.0)]),
        ];
        let mut part = Part {
            border: part.border,
            plan: part.plan.clone(),
            outline: part.outline.clone(),
            sparse: part.sparse.clone(),
            above: Some(part.outline.clone()),
            walls: part.walls.clone(),
        };
        part.plan.retract.hidden = hidden;
        part.travels(beads).pop().unwrap().retract
    };
    let (right, left, near) = ((15.0, 10.0), (5.0, 10.0), (10.0, 13.0));
    let mut part = Part::square();
    for [x1, y1] in [[0.0, 0.0], [9.0, 12.0]] {
        part.sparse = rect(0.0, 0.0, x1, y1);
        assert!(!retracts(&part, Hidden::Auto, right));
        assert!(retracts(&part, Hidden::Covered, right));
        assert!(retracts(&part, Hidden::Auto, left));
        assert!(!retracts(&part, Hidden::Auto, near));
    }
    assert!(retracts(&part, Hidden::SparseInfill, near));
    // Infill that is not printed hides nothing.
    part.sparse = rect(0.0, 0.0, 20.0, 20.0);
    assert!(!retracts(&part, Hidden::SparseInfill, near));
    part.plan.hollow = true;
    assert!(retracts(&part, Hidden::SparseInfill, near));
    assert!(!retracts(&part, Hidden::Auto, near));
}

#[test]
fn combing_goes_round_what_is_in_the_way() {
    let at = |combing: Combing| {
        let part = Part::ring().with(|s| s.combing = combing);
        part.travel((4.0, 10.0), (16.0, 10.0))
    };
    let straight = Travel::straight(DVec2::new(16.0, 10.0), true);
    assert_eq!(at(Combing::Off), straight);
    for combing in [
        Combing::Everywhere,
        Combing::NotOverTopSkin,
        Combing::WithinInfill,
    ] {
        let travel = at(combing);
        assert!(!travel.retract && travel.points.len() > 2, "{travel:?}");
    }
    // This part is too narrow for infill: the way is inside the walls.
    let hidden_by = |combing: Combing, hidden: Hidden| {
        let mut part = Part::ring().with(|s| {
            s.combing = combing;
            s.retract.hidden = hidden;
        });
        part.sparse = Area::from_iter([
            rect(1.0, 1.0, 7.0, 19.0),
            rect(13.0, 1.0, 19.0, 19.0),
        ]);
        part.travel((4.0, 10.0), (16.0, 10.0))
    };
    for hidden in [Hidden::SparseInfill, Hidden::Auto] {
        assert_eq!(hidden_by(Combing::WithinInfill, hidden), straight);
        let around = hidden_by(Combing::Everywhere, hidden);
        assert_eq!(around.retract, hidden == Hidden::SparseInfill);
        assert!(around.points.len() > 2, "{around:?}");
    }
}

#[test]
fn detours_have_a_limit() {
    let at = |max_detour: f64| {
        let part = Part::ring().with(|s| s.max_detour = max_detour);
        part.travel((4.0, 10.0), (16.0, 10.0))
    };
    // The way round the hole's end has 2·√(4² + 8²) + 4 = 21.9 mm and the
    // clearance.
    assert!(!at(12.0).retract);
    let straight = Travel::straight(DVec2::new(16.0, 10.0), true);
    assert_eq!(at(9.0), straight);
}

#[test]
fn top_skins_are_passed_by() {
    // The layer above leaves the lower half of the ring open.
    let mut part = Part::ring();
    part.sparse = Area::EMPTY;
    part.above = Some(rect(0.0, 9.0, 20.0, 20.0));
    let top = bead(Role::TopSkin, &[(2.0, 1.0), (18.0, 1.0)]);
    let lines = vec![
        top,
        bead(Role::InternalSkin, &[(4.0, 12.0), (4.0, 9.5)]),
        bead(Role::InternalSkin, &[(16.0, 9.5), (16.0, 12.0)]),
    ];
    let lowest = |part: &Part| {
        let travel = part.travels(lines.clone()).remove(1);
        assert!(travel.points.len() > 2, "{travel:?}");
        travel.points.iter().fold(f64::MAX, |y, p| y.min(p.y))
    };
    assert!(lowest(&part) > 9.0);
    let part = part.with(|s| s.combing = Combing::Everywhere);
    assert!(lowest(&part) < 2.0);
}

#[test]
fn islands_are_left_and_entered_squarely() {
    // The way leads from the far end of one long island to the far end of
    // another one beside it.
    let part = Part::new(&[[0.0, 0.0, 40.0, 8.0], [0.0, 10.0, 40.0, 18.0]]);
    let (from, to) = (DVec2::new(20.0, 4.0), DVec2::new(38.0, 14.0));
    let travel = part.travel((20.0, 4.0), (38.0, 14.0));
    assert!(travel.retract);
    let way: Vec<DVec2> = [from].into_iter().chain(travel.points).collect();
    assert_eq!(way.last(), Some(&to));
    let outline = Solid::of(&part.outline, 1.0);
    let crossing: Vec<&[DVec2]> = way
        .windows(2)
        .filter(|p| !outline.grid().crossings(p[0], p[1]).is_empty())
        .collect();
    let [air] = crossing[..] else {
        panic!("not once: {way:?}");
    };
    let direction = (air[1] - air[0]).normalize();
    assert!(direction.y > 0.99, "{way:?}");
    // Straight across the gap, the travel goes straight.
    let travel = part.travel((20.0, 4.0), (21.0, 14.0));
    assert_eq!(travel, Travel::straight(DVec2::new(21.0, 14.0), true));
}

#[test]
fn leaving_the_skirt_is_retracted() {
    let part = Part::square();
    let travels = part.travels(vec![
        bead(Role::Skirt, &[(-5.0, -5.0), (-5.0, 5.0)]),
        bead(Role::SparseInfill, &[(1.5, 1.5), (4.0, 1.5)]),
    ]);
    assert!(travels[0].retract);
}

#[test]
fn lifted_where_something_is_crossed() {
    let hop = |part: Part, when: HopWhen| {
        let part = part.with(|s| {
            s.retract.z_hop = 0.3;
            s.retract.z_hop_when = when;
            s.retract.max_unretracted = 5.0;
        });
        let travel = part.travel((5.0, 10.0), (16.0, 10.0));
        assert!(travel.retract);
        travel.hop
    };
    let islands =
        || Part::new(&[[0.0, 0.0, 9.0, 20.0], [11.0, 0.0, 20.0, 20.0]]);
    assert!(!hop(Part::square(), HopWhen::Crossing));
    assert!(hop(Part::square(), HopWhen::Always));
    assert!(hop(islands(), HopWhen::Crossing));
    assert!(!islands().travel((5.0, 10.0), (16.0, 10.0)).hop);
}

#[test]
fn ways_begin_where_the_wipe_ends() {
    let part = Part::square().with(|s| {
        s.retract.wipe = 2.0;
        s.retract.when_crossing = false;
    });
    let lines = vec![
        bead(Role::SparseInfill, &[(5.0, 5.0), (5.0, 10.0)]),
        bead(Role::SparseInfill, &[(15.0, 10.0), (15.0, 5.0)]),
    ];
    let travel = part.travels(lines).remove(0);
    assert_eq!(travel.wipe, [DVec2::new(5.0, 8.0)]);
    assert_eq!(travel.points, [DVec2::new(15.0, 10.0)]);
    // Travels that are hidden are not wiped.
    let part = part.with(|s| s.retract.when_crossing = true);
    assert!(part.travel((5.0, 5.0), (15.0, 5.0)).wipe.is_empty());
}

#[test]
fn beads_are_moved_to_the_bed() {
    let part = Part::square();
    let line = bead(Role::SparseInfill, &[(1.0, 1.0), (4.0, 1.0)]);
    let by = DVec2::new(100.0, 50.0);
    let path = part.path(vec![line], by);
    let Some(Move::Print(b)) = path.moves.last() else {
        panic!("nothing printed");
    };
    assert_eq!(b.stroke.points[0], DVec2::new(101.0, 51.0));
}

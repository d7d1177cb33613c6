//! What speeds, steps and times a layer gets.

use super::slowing::LAYER_TIME_TOLERANCE;
use super::*;
use crate::travel::LayerPath;
use crate::travel::Move;
use isoslice_planar::bead::{Level, Role, Stroke, cross_section};
use isoslice_settings::testing::{plan_with, usual_plan};
use isoslice_settings::{Flavour, Varying};

impl<'a> Pacer<'a> {
    fn paced(&mut self, path: LayerPath) -> PacedLayer {
        self.alone(path).unwrap()
    }
}

fn span(index: usize) -> LayerSpan {
    LayerSpan {
        index,
        bottom: 0.2 * index as f64,
        top: 0.2 * (index as f64 + 1.0),
    }
}

fn square(role: Role, side: f64) -> Bead {
    Bead::new(
        role,
        Stroke::new(
            [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]
                .map(|(x, y)| DVec2::new(x + 50.0, y + 50.0))
                .to_vec(),
            true,
            0.45,
        ),
        0.2,
    )
}

/// A travel that is retracted and lifted.
fn hop(points: Vec<DVec2>) -> Move {
    Move::Travel(Travel {
        points,
        retract: true,
        hop: true,
        ..Travel::default()
    })
}

fn layer(index: usize, beads: Vec<Bead>) -> LayerPath {
    let moves = beads
        .into_iter()
        .flat_map(|b| {
            let points = vec![b.stroke.points[0]];
            [hop(points), Move::Print(b)]
        })
        .collect();
    LayerPath {
        span: span(index),
        moves,
    }
}

fn speeds(layer: &PacedLayer) -> Vec<f64> {
    layer
        .moves
        .iter()
        .filter_map(|m| match m {
            PacedMove::Print { speed, .. } => Some(*speed),
            _ => None,
        })
        .collect()
}

#[test]
fn roles_first_layer_and_flow_set_the_speed() {
    let mut s = usual_plan(PacePlan::of);
    s.cooling.min_layer_time = 0.0;
    let beads = || {
        vec![
            square(Role::OuterWall, 20.0),
            square(Role::SparseInfill, 20.0),
        ]
    };
    let mut pacer = Pacer::new(&s);
    let first = pacer.paced(layer(0, beads()));
    assert_eq!(speeds(&first), [20.0, 20.0]);
    assert_eq!(first.fan, 0.0);
    let second = pacer.paced(layer(1, beads()));
    assert_eq!(speeds(&second), [40.0, 80.0]);
    assert_eq!(second.fan, 100.0);

    s.max_flow = 4.0;
    s.flow = Varying::Constant(110.0);
    s.filament_flow = 95.0;
    let mut pacer = Pacer::new(&s);
    let slow = pacer.paced(layer(1, beads()));
    let limit = 4.0 / (cross_section(0.45, 0.2) * 1.1 * 0.95);
    assert!(limit > 40.0 && limit < 80.0);
    assert_eq!(speeds(&slow)[0], 40.0);
    assert!((speeds(&slow)[1] - limit).abs() < 1e-9);
}

#[test]
fn walls_round_small_things_are_slower() {
    let mut s = usual_plan(PacePlan::of);
    s.cooling.min_layer_time = 0.0;
    let of = |s: &PacePlan, small| {
        // A wall that is cut open is still a small wall.
        let mut bead = square(Role::OuterWall, 4.9);
        bead.stroke.closed = false;
        if small {
            bead.ring = bead.stroke.length();
        }
        speeds(&Pacer::new(s).paced(layer(1, vec![bead])))[0]
    };
    assert_eq!(of(&s, true), 25.0);
    assert_eq!(of(&s, false), 40.0);
    s.speed.outer_wall = Varying::Constant(20.0);
    assert_eq!(of(&s, true), 20.0);
}

#[test]
fn roles_have_their_accelerations() {
    let mut s = usual_plan(PacePlan::of);
    s.cooling.min_layer_time = 0.0;
    let roles = [
        Role::OuterWall,
        Role::SparseInfill,
        Role::TopSkin,
        Role::Ironing,
    ];
    let of = |s: &PacePlan, index| {
        let beads = roles.map(|r| square(r, 20.0)).to_vec();
        let layer = Pacer::new(s).paced(layer(index, beads));
        let each = layer.moves.iter().filter_map(|m| match m {
            PacedMove::Print { acceleration, .. } => Some(*acceleration),
            _ => None,
        });
        (each.collect::<Vec<f64>>(), layer.time)
    };
    let (plain, time) = of(&s, 1);
    assert_eq!(plain, [1000.0; 4]);
    s.acceleration.outer_wall = 300.0;
    s.acceleration.top_skin = 500.0;
    s.acceleration.first_layer = 400.0;
    let (by_role, slower) = of(&s, 1);
    assert_eq!(by_role, [300.0, 1000.0, 500.0, 500.0]);
    assert!(slower > time);
    assert_eq!(of(&s, 0).0, [300.0, 400.0, 400.0, 400.0]);
    // One line of 100 mm at 40 mm/s from rest to rest: d/v + v/a.
    let one = |a: f64| {
        let mut s = s.clone();
        s.acceleration.outer_wall = a;
        let mut bead = square(Role::OuterWall, 1.0);
        bead.stroke.points = vec![DVec2::splat(50.0), DVec2::new(150.0, 50.0)];
        bead.stroke.closed = false;
        let mut path = layer(1, vec![bead]);
        path.moves.remove(0);
        let mut pacer = Pacer::new(&s);
        pacer.xy = Some(DVec2::splat(50.0));
        pacer.z = Some(path.span.top);
        pacer.paced(path).time
    };
    for a in [100.0, 800.0] {
        assert!((one(a) - (100.0 / 40.0 + 40.0 / a)).abs() < 1e-9);
    }
}

#[test]
fn travels_have_theirs_and_z_its_own() {
    let travel = |of_travels: f64, of_z: f64| {
        let plan = plan_with(PacePlan::of, |s| {
            s.retract.length = 0.0;
            // The move goes from rest to rest, as RepRapFirmware does in any
            // case.
            s.gcode.flavour = Flavour::Rrf;
            s.printer.travel_acceleration = of_travels;
            s.printer.max_acceleration_z = of_z;
        });
        let mut pacer = Pacer::new(&plan);
        pacer.xy = Some(DVec2::splat(50.0));
        pacer.z = Some(0.2);
        let to = DVec2::new(110.0, 50.0);
        let moves = vec![Move::Travel(Travel::straight(to, false))];
        let span = span(1);
        pacer.paced(LayerPath { span, moves }).time
    };
    // Up 0.2 mm, too short for 10 mm/s at 100 mm/s²; then 60 mm.
    let up = |a: f64| 2.0 * (0.2 / a).sqrt();
    let along = 60.0 / 150.0 + 150.0 / 600.0;
    assert!((travel(600.0, 100.0) - along - up(100.0)).abs() < 1e-9);
    // The acceleration is no more than that of other moves.
    let quicker = 0.2 / 10.0 + 10.0 / 600.0;
    assert!((travel(600.0, 5000.0) - along - quicker).abs() < 1e-9);
    let along = 60.0 / 150.0 + 150.0 / 1500.0;
    let up = 0.2 / 10.0 + 10.0 / 1500.0;
    assert!((travel(1500.0, 5000.0) - along - up).abs() < 1e-9);
}

#[test]
fn bridges_have_their_own_speed_flow_and_fan() {
    let s = plan_with(PacePlan::of, |s| {
        s.cooling.min_layer_time = 0.0;
        s.cooling.fan_speed = Varying::Constant(40.0);
        s.bridge_flow = 80.0;
    });
    let roles = [Role::TopSkin, Role::Bridge, Role::Bridge, Role::Overhang];
    let beads = roles.map(|r| square(r, 20.0)).to_vec();
    let fed = |bead: Bead| -> f64 {
        let l = Pacer::new(&s).paced(layer(1, vec![bead]));
        let of = |m: &PacedMove| match m {
            PacedMove::Print { bead, flow, .. } => bead.area() * flow,
            _ => 0.0,
        };
        l.moves.iter().map(of).sum()
    };
    let (bridge, top) = (Role::Bridge, Role::TopSkin);
    let share = fed(square(bridge, 20.0)) / fed(square(top, 20.0));
    assert!((share - 0.8).abs() < 1e-9);
    let mut pacer = Pacer::new(&s);
    let l = pacer.paced(layer(1, beads.clone()));
    assert_eq!(speeds(&l), [40.0, 30.0, 30.0, 20.0]);
    let fans = |l: &PacedLayer| -> Vec<f64> {
        l.moves
            .iter()
            .filter_map(|m| match m {
                PacedMove::Fan(speed) => Some(*speed),
                _ => None,
            })
            .collect()
    };
    assert_eq!((l.fan, fans(&l)), (40.0, vec![100.0]));
    // The fan comes back for what follows, but never on layers without a fan.
    let mut back = beads.clone();
    back.rotate_left(1);
    assert_eq!(fans(&pacer.paced(layer(2, back))), [100.0, 40.0]);
    assert!(fans(&pacer.paced(layer(0, beads))).is_empty());
    let mut ironed = square(Role::Ironing, 20.0);
    ironed.stroke.width = 0.1;
    assert!((fed(ironed) - 0.1 * 0.1 * 0.2).abs() < 1e-12);
}

#[test]
fn a_short_layer_is_slowed_to_the_minimum_time() {
    for flavour in [
        isoslice_settings::Flavour::Marlin,
        isoslice_settings::Flavour::Klipper,
    ] {
        let mut s = plan_with(PacePlan::of, |s| s.gcode.flavour = flavour);
        s.cooling.min_speed = 1.0;
        for target in [6.0, 8.0, 20.0, 60.0] {
            s.cooling.min_layer_time = target;
            let mut pacer = Pacer::new(&s);
            let l = pacer.paced(layer(
                1,
                vec![
                    square(Role::OuterWall, 20.0),
                    square(Role::SparseInfill, 18.0),
                ],
            ));
            assert!(l.time >= target, "{} {target}", l.time);
            assert!(
                l.time <= target * (1.0 + LAYER_TIME_TOLERANCE),
                "{} {target}",
                l.time
            );
            // The infill gives way first, as far as the floor lets it.
            let v = speeds(&l);
            assert!(v[0] == 40.0 || v[1] == 1.0, "{v:?}");
        }
    }
}

/// All beads but outer walls get one greatest speed, so that the fastest give way
/// first. Outer walls keep theirs until that is as low as it may be.
#[test]
fn the_fastest_give_way_first_and_outer_walls_last() {
    let mut s = usual_plan(PacePlan::of);
    s.cooling.min_speed = 8.0;
    let beads = [
        (Role::OuterWall, 40.0),
        (Role::InnerWall, 60.0),
        (Role::SparseInfill, 80.0),
        (Role::Overhang, 20.0),
    ];
    let own = beads.map(|bead| bead.1);
    let mut caps = Vec::new();
    let mut outer = Vec::new();
    for target in 0..16 {
        s.cooling.min_layer_time = f64::from(3 * target);
        let mut all = beads.map(|(role, _)| square(role, 20.0)).to_vec();
        // The overhang is an outer wall's.
        all[3].laid_as = Role::OuterWall;
        let l = Pacer::new(&s).paced(layer(1, all));
        let v = speeds(&l);
        assert_eq!(v[0].min(own[3]), v[3], "{v:?}");
        let cap = v[2];
        assert_eq!(v[1], cap.min(own[1]), "{v:?}");
        assert!(v[0] == own[0] || cap == 8.0, "{v:?}");
        assert!(l.time >= f64::from(3 * target) || v == [8.0; 4]);
        caps.push(cap);
        outer.push(v[0]);
    }
    for speeds in [caps, outer] {
        assert!(speeds.is_sorted_by(|a, b| a >= b), "{speeds:?}");
        assert!(speeds[0] >= 40.0 && speeds[15] < 40.0, "{speeds:?}");
    }
}

/// Time that is lost counts for the cause that slows a bead most, at the speed
/// that it has in the end.
#[test]
fn lost_time_has_one_cause_at_final_speeds() {
    let crowd = || {
        let points = (0..200).map(|i| DVec2::new(0.1 * f64::from(i), 0.0));
        let stroke = Stroke::new(points.collect(), false, 0.45);
        Bead::new(Role::SparseInfill, stroke, 0.2)
    };
    let lost = |s: &PacePlan| {
        let beads = vec![crowd(), square(Role::SparseInfill, 5.0)];
        let l = Pacer::new(s).paced(layer(1, beads));
        let of = |cause| l.sums.lost.get(&cause).copied().unwrap_or(0.0);
        let all = [Cause::Cooling, Cause::Flow, Cause::Moves].map(of);
        let whole = of(Cause::Acceleration) + all.iter().sum::<f64>();
        assert!(whole < l.time, "{whole} {}", l.time);
        (all, l.sums.slowed)
    };
    let mut s = usual_plan(PacePlan::of);
    s.cooling.min_layer_time = 0.0;
    s.max_moves = 200.0;
    // 19.9 mm at 0.1 mm * 200/s, a step of a tenth of 80 mm/s down.
    let ([cooling, flow, moves], slowed) = lost(&s);
    assert_eq!((cooling, flow, slowed), (0.0, 0.0, 199));
    assert!((moves - 19.9 * (1.0 / 16.0 - 1.0 / 80.0)).abs() < 1e-6);
    // Cooling asks for less than that.
    s.cooling.min_layer_time = 60.0;
    let ([cooling, flow, moves], slowed) = lost(&s);
    assert_eq!((flow, moves, slowed), (0.0, 0.0, 0));
    let length = 19.9 + 4.0 * 5.0;
    assert!((cooling - length * (1.0 / 10.0 - 1.0 / 80.0)).abs() < 1e-6);
    // So does the hot end.
    s.cooling.min_layer_time = 0.0;
    s.max_flow = 1.0;
    let ([cooling, flow, moves], slowed) = lost(&s);
    assert_eq!((cooling, moves, slowed), (0.0, 0.0, 0));
    let speed = 1.0 / crowd().area();
    assert!((flow - length * (1.0 / speed - 1.0 / 80.0)).abs() < 1e-6);
}

#[test]
fn slowing_ends_at_the_floor() {
    let s = usual_plan(PacePlan::of);
    let mut pacer = Pacer::new(&s);
    let l = pacer.paced(layer(
        1,
        vec![
            square(Role::OuterWall, 4.0),
            square(Role::SparseInfill, 4.0),
        ],
    ));
    assert!(l.time < s.cooling.min_layer_time);
    assert_eq!(speeds(&l), [10.0, 10.0]);
}

#[test]
fn a_speed_below_the_floor_is_not_raised() {
    let mut s = usual_plan(PacePlan::of);
    s.speed.outer_wall = Varying::Constant(6.0);
    let mut pacer = Pacer::new(&s);
    let l = pacer.paced(layer(1, vec![square(Role::OuterWall, 4.0)]));
    assert_eq!(speeds(&l), [6.0]);
}

#[test]
fn travels_are_not_slowed() {
    let s = usual_plan(PacePlan::of);
    let mut pacer = Pacer::new(&s);
    let l = pacer.paced(layer(1, vec![square(Role::OuterWall, 4.0)]));
    for m in &l.moves {
        if let PacedMove::Travel { speed, .. } = m {
            assert_eq!(*speed, s.travel_speed);
        }
    }
}

/// The machine's z and retraction along the moves, checked at each step.
#[test]
fn retractions_pair_and_z_is_right() {
    let mut s = usual_plan(PacePlan::of);
    s.retract.z_hop = 0.4;
    let mut pacer = Pacer::new(&s);
    let (mut z, mut retracted) = (f64::NAN, false);
    let mut primes = 0;
    for index in 0..3 {
        let mut path = layer(
            index,
            vec![square(Role::InnerWall, 9.0), square(Role::OuterWall, 10.0)],
        );
        // Two travels in a row retract once.
        path.moves
            .insert(1, hop(vec![DVec2::new(70.0, 70.0), DVec2::splat(50.0)]));
        let top = path.span.top;
        for m in pacer.paced(path).moves {
            match m {
                PacedMove::Retract { length, .. } => {
                    assert!(!retracted);
                    assert_eq!(length, 0.8);
                    retracted = true;
                }
                PacedMove::Prime { .. } => {
                    assert!(retracted);
                    assert_eq!(z, top);
                    retracted = false;
                    primes += 1;
                }
                PacedMove::Lift { z: to, .. } => z = to,
                PacedMove::Fan(_) => panic!("the fan does not change"),
                PacedMove::Wipe { .. } => panic!("nothing is wiped"),
                PacedMove::Travel { .. } => {
                    assert!(retracted);
                    let hop = if index == 0 && primes == 0 {
                        APPROACH
                    } else {
                        0.4
                    };
                    assert!((z - top - hop).abs() < 1e-9);
                }
                PacedMove::Print { .. } => {
                    assert!(!retracted);
                    assert_eq!(z, top);
                }
            }
        }
    }
    assert_eq!(primes, 6);
}

/// The steps between two beads with a travel in between.
fn between(plan: &PacePlan, travel: Travel) -> Vec<PacedMove> {
    let mut path = layer(1, vec![square(Role::OuterWall, 10.0)]);
    path.moves.push(Move::Travel(travel));
    let mut next = square(Role::OuterWall, 10.0);
    next.stroke.points.iter_mut().for_each(|p| *p += 20.0);
    path.moves.push(Move::Print(next));
    let moves = Pacer::new(plan).paced(path).moves;
    let print = |m: &PacedMove| matches!(m, PacedMove::Print { .. });
    let mut parts = moves.split(print);
    parts.nth(1).map(<[PacedMove]>::to_vec).unwrap_or_default()
}

#[test]
fn filament_goes_back_and_forth_as_set() {
    let mut s = usual_plan(PacePlan::of);
    s.retract.length = 1.2;
    s.retract.speed = 40.0;
    s.retract.prime_speed = 25.0;
    s.retract.extra_prime = 0.1;
    let to = Travel::straight(DVec2::splat(70.0), true);
    let steps = between(&s, to);
    let [back, PacedMove::Travel { .. }, forth] = &steps[..] else {
        panic!("{steps:?}");
    };
    let (length, speed) = (1.2, 40.0);
    assert_eq!(*back, PacedMove::Retract { length, speed });
    let (extra, speed) = (0.1, 25.0);
    let prime = PacedMove::Prime {
        length,
        extra,
        speed,
    };
    assert_eq!(*forth, prime);
}

#[test]
fn a_wipe_takes_the_rest_of_the_retraction() {
    let mut s = usual_plan(PacePlan::of);
    s.retract.before_wipe = 25.0;
    let wipe = |length: f64| Travel {
        wipe: vec![DVec2::new(50.0 + length, 50.0)],
        hop: true,
        ..Travel::straight(DVec2::splat(70.0), true)
    };
    let speeds = [30.0, 0.3].map(|way| {
        let steps = between(&s, wipe(way));
        let [
            PacedMove::Retract { length: first, .. },
            PacedMove::Wipe { length, speed, .. },
            PacedMove::Travel { .. },
            PacedMove::Prime { length: back, .. },
        ] = steps[..]
        else {
            panic!("{steps:?}");
        };
        assert!((first - 0.2).abs() < 1e-12);
        assert_eq!(first + length, back);
        speed
    });
    // A short wipe is as slow as the filament needs.
    assert_eq!(speeds[0], WIPE_SPEED * s.travel_speed);
    assert!((speeds[1] - 0.3 * 35.0 / 0.6).abs() < 1e-9);
    // Nothing is pulled back if the length is 0.
    s.retract.length = 0.0;
    assert!(matches!(
        between(&s, wipe(1.0))[..],
        [PacedMove::Travel { .. }]
    ));
}

#[test]
fn z_rises_before_an_unretracted_travel() {
    let s = usual_plan(PacePlan::of);
    let mut pacer = Pacer::new(&s);
    pacer.paced(layer(0, vec![square(Role::OuterWall, 10.0)]));
    let mut path = layer(1, vec![square(Role::OuterWall, 10.0)]);
    let back = DVec2::splat(50.0);
    let mut travel = Travel::straight(back, false);
    travel.points.insert(0, DVec2::splat(60.0));
    path.moves[0] = Move::Travel(travel);
    let l = pacer.paced(path);
    assert!(matches!(l.moves[0], PacedMove::Lift { z, .. } if z == 0.4));
    assert!(matches!(l.moves[1], PacedMove::Travel { .. }));
    assert!(matches!(l.moves[2], PacedMove::Print { .. }));
}

/// A bead that begins within what the file resolves of where a rising one ends
/// goes on without a stop.
#[test]
fn beads_that_meet_but_for_rounding_are_one_way() {
    let s = usual_plan(PacePlan::of);
    let rising = |from: f64, to: f64| {
        let points = [from, to].map(|x| DVec2::new(x, 5.0)).to_vec();
        let mut stroke = Stroke::new(points, false, 0.45);
        stroke.levels =
            [-0.1, 0.0].map(|rise| Level { rise, extra: 0.0 }).to_vec();
        Bead::new(Role::OuterWall, stroke, 0.2)
    };
    for (gap, stops) in [(4e-4, false), (9e-4, false), (4e-3, true)] {
        let mut pacer = Pacer::new(&s);
        let there = DVec2::new(20.0 + gap, 5.0);
        let mut path = layer(1, vec![rising(0.0, 20.0)]);
        path.moves
            .push(Move::Travel(Travel::straight(there, false)));
        let mut next = rising(there.x, 40.0);
        next.stroke.levels[0].rise = 0.0;
        path.moves.push(Move::Print(next));
        let moves = pacer.paced(path).moves;
        let last = &moves[moves.len() - 2];
        assert_eq!(!matches!(last, PacedMove::Print { .. }), stops, "{gap}");
    }
}

#[test]
fn a_hop_stays_inside_the_machine() {
    let mut s = usual_plan(PacePlan::of);
    s.retract.z_hop = 1.0;
    s.height = 0.5;
    let mut pacer = Pacer::new(&s);
    pacer.paced(layer(0, vec![square(Role::OuterWall, 10.0)]));
    let l = pacer.paced(layer(1, vec![square(Role::OuterWall, 10.0)]));
    assert!(l.moves.iter().all(|m| match m {
        PacedMove::Lift { z, .. } => *z <= 0.5,
        _ => true,
    }));
}

#[test]
fn a_missing_travel_is_made_up_for() {
    let s = usual_plan(PacePlan::of);
    let mut pacer = Pacer::new(&s);
    let mut path = layer(0, vec![square(Role::OuterWall, 10.0)]);
    path.moves.remove(0);
    let l = pacer.paced(path);
    assert!(l.moves.iter().any(|m| matches!(
        m,
        PacedMove::Travel { points, .. } if points[0] == DVec2::splat(50.0)
    )));
}

#[test]
fn an_empty_layer_takes_no_time() {
    let s = usual_plan(PacePlan::of);
    let l = Pacer::new(&s).paced(layer(0, vec![]));
    assert_eq!((l.moves.len(), l.time), (0, 0.0));
}

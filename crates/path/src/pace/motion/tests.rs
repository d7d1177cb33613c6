use super::*;
use isoslice_settings::Flavour;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

const A: f64 = 1000.0;
/// Speed of right-angled corners.
const CORNER: f64 = 5.0;

fn motion(flavour: Flavour) -> Motion {
    let limits = Limits {
        planner: Planner::new(flavour, CORNER, A),
        acceleration: A,
        travel_acceleration: A,
        speed_z: 10.0,
        acceleration_z: 100.0,
        filament_acceleration: A,
    };
    Motion::new(limits, A)
}

fn travel(m: &mut Motion, step: DVec3) {
    m.push(step, 100.0, A, 0.0, false);
}

fn time(m: &mut Motion) -> f64 {
    m.time(|s| s.speed)
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} is not {b}");
}

/// Time of 50 mm at 100 mm/s from rest to `end` mm/s, or from `end` mm/s to
/// rest.
fn long(end: f64) -> f64 {
    let v = 100.0;
    let on_ramps = (v * v + v * v - end * end) / (2.0 * A);
    v / A + (v - end) / A + (50.0 - on_ramps) / v
}

#[test]
fn a_single_move_is_a_trapezoid() {
    for flavour in Flavour::ALL {
        let mut m = motion(flavour);
        travel(&mut m, DVec3::new(30.0, 40.0, 0.0));
        // d/v + v/a
        close(time(&mut m), 50.0 / 100.0 + 100.0 / A);
    }
}

#[test]
fn a_short_move_is_a_triangle() {
    for flavour in [Flavour::Marlin, Flavour::Prusa, Flavour::Rrf] {
        let mut m = motion(flavour);
        travel(&mut m, DVec3::X);
        close(time(&mut m), 2.0 * (1.0 / A).sqrt());
    }
}

#[test]
fn a_right_angle_is_taken_at_the_square_corner_velocity() {
    for flavour in Flavour::ALL {
        let mut m = motion(flavour);
        travel(&mut m, DVec3::X * 50.0);
        travel(&mut m, DVec3::Y * 50.0);
        // Marlin's deviation of 0.01035 mm is above its least one.
        close(time(&mut m), 2.0 * long(CORNER));
    }
}

#[test]
fn jerk_is_limited_axis_by_axis() {
    // The moves are askew: y turns round and x goes on. In Prusa's firmware the
    // speed of y counts once, in RepRapFirmware twice.
    let [a, b] = [1.0, -1.0].map(|y| DVec3::new(1.0, y, 0.0).normalize());
    for (flavour, jump) in [
        (Flavour::Prusa, FRAC_1_SQRT_2),
        (Flavour::Rrf, 2.0 * FRAC_1_SQRT_2),
    ] {
        let mut m = motion(flavour);
        travel(&mut m, a * 50.0);
        travel(&mut m, b * 50.0);
        close(time(&mut m), 2.0 * long(CORNER / jump));
    }
}

#[test]
fn straight_on_is_one_move_and_back_is_a_stop() {
    let mut one = motion(Flavour::Klipper);
    travel(&mut one, DVec3::X * 50.0);
    let whole = time(&mut one);
    let mut cut = motion(Flavour::Klipper);
    for _ in 0..500 {
        travel(&mut cut, DVec3::X * 0.1);
    }
    close(time(&mut cut), whole);
    for (flavour, end) in [
        (Flavour::Klipper, 0.0),
        (Flavour::Marlin, 0.0),
        (Flavour::Prusa, CORNER),
        (Flavour::Rrf, 0.5 * CORNER),
    ] {
        let mut back = motion(flavour);
        travel(&mut back, DVec3::X * 50.0);
        travel(&mut back, DVec3::X * -50.0);
        close(time(&mut back), 2.0 * long(end));
    }
}

#[test]
fn firmware_that_knows_few_moves_keeps_a_speed_that_it_can_brake() {
    for (flavour, ahead) in [
        (Flavour::Marlin, 14),
        (Flavour::Prusa, 14),
        (Flavour::Rrf, 38),
    ] {
        let (n, d) = (500, 0.1);
        let mut m = motion(flavour);
        for _ in 0..n {
            travel(&mut m, DVec3::X * d);
        }
        // Between the ramps each joint has the speed that `ahead` moves can
        // brake away, and each move has a peak of its own.
        let joint = 2.0 * A * d * f64::from(ahead);
        let peak = joint + A * d;
        let each = 2.0 * (peak.sqrt() - joint.sqrt()) / A;
        let ramp = joint.sqrt() / A;
        close(time(&mut m), 2.0 * ramp + f64::from(n - 2 * ahead) * each);
    }
}

#[test]
fn a_small_circle_is_limited_by_its_centripetal_acceleration() {
    // v² = a·r, whatever the arc is cut into. Between the corners of coarse
    // chords the moves are a little faster.
    for (flavour, n, within) in [
        (Flavour::Klipper, 2000, 1e-3),
        (Flavour::Marlin, 150, 1.5e-2),
    ] {
        let r = 1.0;
        let at = |i: i32| {
            let t = TAU * f64::from(i) / f64::from(n);
            DVec3::new(r * t.cos(), r * t.sin(), 0.0)
        };
        let mut m = motion(flavour);
        for turn in 0..20 * n {
            m.push(at(turn + 1) - at(turn), 500.0, A, 0.0, true);
        }
        let v = (A * r).sqrt();
        let expected = 20.0 * TAU * r / v + v / A;
        let time = time(&mut m);
        assert!((time / expected - 1.0).abs() < within, "{time} {expected}");
    }
}

#[test]
fn filament_moves_stop_the_head() {
    let mut m = motion(Flavour::Klipper);
    travel(&mut m, DVec3::X * 50.0);
    let half = time(&mut m);
    m.push_filament(-0.8, 35.0);
    travel(&mut m, DVec3::X * 50.0);
    // The move is also short for the minimum cruise ratio, by the acceleration
    // told last: its peak is v² = a/2·d.
    let v = (0.5 * A * 0.8).sqrt();
    close(time(&mut m), 2.0 * half + 0.8 / v + v / A);
    m.tell(0.1 * A);
    m.clear();
    m.push_filament(-0.8, 35.0);
    let v = (0.05 * A * 0.8).sqrt();
    close(time(&mut m), 0.8 / v + v / A);

    let mut m = motion(Flavour::Rrf);
    travel(&mut m, DVec3::X * 50.0);
    m.push_filament(-0.8, 35.0);
    // 0.8 mm is too short for 35 mm/s at 1000 mm/s²: a triangle.
    close(time(&mut m), half + 2.0 * (0.8 / A).sqrt());
}

#[test]
fn jerk_lets_the_filament_start_before_the_head_stands() {
    let mut m = motion(Flavour::Prusa);
    travel(&mut m, DVec3::X * 50.0);
    m.push_filament(-0.8, 15.0);
    // The filament may jump to 4.5 mm/s.
    let (v, jerk) = (15.0, 4.5);
    let on_ramps = (v * v + v * v - jerk * jerk) / (2.0 * A);
    let retraction = v / A + (v - jerk) / A + (0.8 - on_ramps) / v;
    close(time(&mut m), long(jerk) + retraction);
}

#[test]
fn a_wipe_is_as_slow_as_the_filament() {
    let mut m = motion(Flavour::Klipper);
    m.limits.filament_acceleration = 0.1 * A;
    m.push(DVec3::X * 50.0, 20.0, A, -0.2, false);
    close(time(&mut m), 50.0 / 20.0 + 20.0 / (0.5 * A));
}

#[test]
fn a_jump_of_the_filament_limits_a_straight_junction() {
    let mut m = motion(Flavour::Klipper);
    m.push(DVec3::X * 50.0, 100.0, A, 0.0, true);
    m.push(DVec3::X * 50.0, 100.0, A, 0.1, true);
    close(time(&mut m), 2.0 * long(10.0));
}

#[test]
fn rrf_stops_where_printing_begins() {
    let mut m = motion(Flavour::Rrf);
    travel(&mut m, DVec3::X * 50.0);
    m.push(DVec3::X * 50.0, 100.0, A, 0.03, true);
    close(time(&mut m), 2.0 * long(0.0));
}

#[test]
fn z_is_as_slow_as_it_can_be() {
    for flavour in Flavour::ALL {
        let mut m = motion(flavour);
        travel(&mut m, DVec3::Z * 20.0);
        close(time(&mut m), 20.0 / 10.0 + 10.0 / 100.0);
    }
    // A slope: z has a third of the speed.
    let mut m = motion(Flavour::Marlin);
    travel(&mut m, DVec3::new(20.0, 20.0, 10.0));
    close(time(&mut m), 30.0 / 30.0 + 30.0 / 300.0);
    // Klipper's deviation follows from the acceleration told, which is ten
    // times z's.
    let mut m = motion(Flavour::Klipper);
    travel(&mut m, DVec3::X * 50.0);
    travel(&mut m, DVec3::Z * 20.0);
    let end = CORNER * 0.1f64.sqrt();
    let on_ramps = (200.0 - end * end) / 200.0;
    let up = (20.0 - end) / 100.0 + (20.0 - on_ramps) / 10.0;
    close(time(&mut m), long(end) + up);
}

#[test]
fn the_minimum_cruise_ratio_slows_short_moves_only() {
    let mut m = motion(Flavour::Klipper);
    travel(&mut m, DVec3::X * 50.0);
    close(time(&mut m), 0.6);
    // A move of 1 mm: at half the acceleration its peak is v² = a/2·d.
    m.clear();
    travel(&mut m, DVec3::X);
    let v = (0.5 * A).sqrt();
    close(time(&mut m), 1.0 / v + v / A);
    // Cutting the move changes nothing: the run shares its peak.
    m.clear();
    for _ in 0..10 {
        travel(&mut m, DVec3::X * 0.1);
    }
    close(time(&mut m), 1.0 / v + v / A);
}

#[test]
fn nothing_takes_no_time() {
    for flavour in Flavour::ALL {
        let mut m = motion(flavour);
        assert_eq!(time(&mut m), 0.0);
        travel(&mut m, DVec3::ZERO);
        travel(&mut m, DVec3::X * f64::NAN);
        m.push_filament(0.0, 35.0);
        assert_eq!(time(&mut m), 0.0);
    }
}

#[test]
fn corners_are_numbers_whatever_meets() {
    let steps = [
        DVec3::X,
        DVec3::X * -1.0,
        DVec3::Z,
        DVec3::new(1e-3, 1.0, 1e-9),
    ];
    for flavour in Flavour::ALL {
        for corner in [0.0, CORNER] {
            let mut m = motion(flavour);
            m.limits.planner = Planner::new(flavour, corner, A);
            for step in steps.into_iter().cycle().take(9) {
                for fed in [0.0, 0.03, -0.5] {
                    m.push(step, 100.0, A, fed, fed > 0.0);
                }
                m.push_filament(-0.8, 35.0);
                m.push_filament(0.8, 35.0);
            }
            let time = time(&mut m);
            assert!(time.is_finite() && time > 0.0, "{flavour:?}: {time}");
        }
    }
}

//! Compares ways inside random areas with the shortest ones.

use super::Comb;
use glam::DVec2;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::{Area, Ring, Solid, edges, path_length, signed_area};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, RngSeed, TestRunner};
use std::borrow::Cow;
use std::f64::consts::TAU;

const CLEARANCE: f64 = 0.5;

/// How many times longer than the shortest way a way may be. The side on which
/// a way passes a hole is chosen hole by hole, which may not be best for
/// several holes.
const LONGER: f64 = 1.2;

fn config() -> Config {
    Config {
        cases: 150,
        failure_persistence: None,
        rng_algorithm: RngAlgorithm::ChaCha,
        rng_seed: RngSeed::Fixed(11),
        ..Config::default()
    }
}

/// A star around a point.
fn star(at: DVec2, radii: &[f64]) -> Ring {
    let turn = TAU / radii.len() as f64;
    let corner = |(i, r): (usize, &f64)| {
        at + *r * DVec2::from_angle(turn * (i as f64 + 0.3))
    };
    radii.iter().enumerate().map(corner).collect()
}

/// An area with notches and holes, wider than twice the clearance.
fn area() -> impl Strategy<Value = Area> {
    let outer = prop::collection::vec(9.5..20.0, 5..16);
    let hole = (
        (-1..2_i32, -1..2_i32),
        prop::collection::vec(0.3..1.6, 3..9),
    );
    let holes = prop::collection::vec(hole, 0..6);
    (outer, holes).prop_map(|(outer, holes)| {
        let mut rings = vec![star(DVec2::ZERO, &outer)];
        let mut taken = Vec::new();
        for ((i, j), radii) in holes {
            if taken.contains(&(i, j)) {
                continue;
            }
            taken.push((i, j));
            let at = 4.6 * DVec2::new(f64::from(i), f64::from(j));
            let mut ring = star(at, &radii);
            ring.reverse();
            rings.push(ring);
        }
        Area { rings }
    })
}

fn case() -> impl Strategy<Value = (Area, [DVec2; 2])> {
    let far = || (-14.0..14.0, -14.0..14.0).prop_map(DVec2::from);
    (area(), far(), far()).prop_map(|(area, a, b)| (area, [a, b]))
}

/// Length of the shortest way that keeps `room` from the area's border. It is
/// found over all pairs of points around the area's corners that see each
/// other.
fn shortest(area: &Area, grid: &EdgeGrid, ends: [DVec2; 2], room: f64) -> f64 {
    let mut nodes = ends.to_vec();
    for ring in &area.rings {
        let n = ring.len();
        for i in 0..n {
            let (p, q, r) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
            if (q - p).perp_dot(r - q) > 0.0 {
                continue;
            }
            let around = |k: u32| {
                let turn = DVec2::from_angle(TAU * f64::from(k) / 12.0);
                q + 0.9 * CLEARANCE * turn
            };
            nodes.extend(
                (0..12)
                    .map(around)
                    .filter(|p| grid.contains(*p) && grid.clear(*p, *p, room)),
            );
        }
    }
    let mut lengths = vec![f64::INFINITY; nodes.len()];
    let mut done = vec![false; nodes.len()];
    lengths[0] = 0.0;
    loop {
        let next = (0..nodes.len())
            .filter(|&i| !done[i] && lengths[i].is_finite())
            .min_by(|&i, &j| lengths[i].total_cmp(&lengths[j]));
        let Some(i) = next else { return f64::INFINITY };
        if i == 1 {
            return lengths[1];
        }
        done[i] = true;
        for j in 0..nodes.len() {
            let length = lengths[i] + nodes[i].distance(nodes[j]);
            if length < lengths[j] && grid.clear(nodes[i], nodes[j], room) {
                lengths[j] = length;
            }
        }
    }
}

/// The lengths of the way and of the shortest one, or what is wrong with the
/// way. None if the ends are not inside.
fn judge(area: &Area, ends: [DVec2; 2]) -> Option<Result<[f64; 2], String>> {
    let solid = Solid::of(area, 1.0);
    let grid = solid.grid();
    let room = 1.05 * CLEARANCE;
    let roomy = |p: DVec2| grid.contains(p) && grid.clear(p, p, room);
    if !ends.iter().all(|&p| roomy(p)) {
        return None;
    }
    let comb = Comb::new(Cow::Borrowed(&solid), CLEARANCE);
    Some((|| {
        let points = comb.way(ends[0], ends[1], 1e3).ok_or("no way")?;
        let way: Vec<DVec2> = [ends[0]]
            .into_iter()
            .chain(points)
            .chain([ends[1]])
            .collect();
        let least = 0.8 * CLEARANCE;
        for pair in way.windows(2) {
            if !grid.clear(pair[0], pair[1], least) {
                return Err(format!("too near: {pair:?} of {way:?}"));
            }
        }
        let least = shortest(area, grid, ends, least);
        Ok([path_length(&way, false), least])
    })())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn ways_are_found_and_short((area, ends) in case()) {
        for (i, ring) in area.rings.iter().enumerate() {
            prop_assert_eq!(signed_area(ring) > 0.0, i == 0);
            prop_assert!(edges(ring).all(|(a, b)| a != b));
        }
        match judge(&area, ends) {
            None => {}
            Some(Err(fault)) => prop_assert!(false, "{fault}"),
            Some(Ok([length, least])) => {
                prop_assert!(length <= LONGER * least, "{length} {least}");
            }
        }
    }
}

/// Prints how much longer than the shortest ways the ways are, for whoever
/// changes how they are found.
///
///     cargo test --release --lib comb -- --ignored --nocapture
#[test]
#[ignore = "prints figures"]
fn survey() {
    let mut runner = TestRunner::new(config());
    let mut ratios = Vec::new();
    let mut faults = 0;
    while ratios.len() + faults < 300 {
        let (area, ends) = case().new_tree(&mut runner).unwrap().current();
        match judge(&area, ends) {
            None => {}
            Some(Ok([length, least])) => ratios.push(length / least),
            Some(Err(fault)) => {
                faults += 1;
                println!("{}", fault.chars().take(160).collect::<String>());
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let at = |share: f64| ratios[(share * (ratios.len() - 1) as f64) as usize];
    println!(
        "{faults} faults; longer by a factor of {:.3} (half), {:.3} (90 %), \
         {:.3} (99 %), {:.3} (all)",
        at(0.5),
        at(0.9),
        at(0.99),
        at(1.0)
    );
}

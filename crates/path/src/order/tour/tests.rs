use super::*;

/// Points in no order, in a square of 100 mm.
fn spread(count: usize, seed: f64) -> impl Iterator<Item = DVec2> {
    (1..=count).map(move |i| {
        let t = seed + i as f64;
        let p = DVec2::new((t * 12.9898).sin(), (t * 78.233).sin());
        100.0 * (p * 43_758.545_3).rem_euclid(DVec2::ONE)
    })
}

fn lines(count: usize, seed: f64, stages: u32) -> Vec<Stop> {
    let to: Vec<DVec2> = spread(count, seed + 1000.0).collect();
    spread(count, seed)
        .zip(to)
        .enumerate()
        .map(|(i, (from, to))| Stop {
            from,
            // What cannot be turned ends about where it begins.
            to: from + if i % 3 == 0 { 0.005 } else { 0.1 } * (to - from),
            turns: i % 3 != 0,
            stage: i as u32 % stages,
        })
        .collect()
}

/// The shortest tour there is.
fn shortest(
    stops: &[Stop],
    tour: &mut Vec<Visit>,
    start: Option<DVec2>,
    end: Option<DVec2>,
    best: &mut f64,
) {
    if tour.len() == stops.len() {
        *best = best.min(length(stops, tour, start, end));
        return;
    }
    let taken = |i: usize| tour.iter().any(|v| v.stop == i);
    let left: Vec<usize> = (0..stops.len()).filter(|&i| !taken(i)).collect();
    let stage = left.iter().map(|&i| stops[i].stage).min();
    for stop in left {
        if Some(stops[stop].stage) != stage {
            continue;
        }
        for turned in [false, true] {
            if turned && !stops[stop].turns {
                continue;
            }
            tour.push(Visit { stop, turned });
            shortest(stops, tour, start, end, best);
            tour.pop();
        }
    }
}

fn valid(stops: &[Stop], tour: &[Visit]) {
    let mut seen: Vec<usize> = tour.iter().map(|v| v.stop).collect();
    seen.sort_unstable();
    assert!(seen.into_iter().eq(0..stops.len()));
    let stages = tour.iter().map(|v| stops[v.stop].stage);
    assert!(stages.is_sorted());
}

#[test]
fn short_tours_are_nearly_the_shortest() {
    let (mut sum, mut least, mut worst) = (0.0, 0.0, 1.0_f64);
    for case in 0..60 {
        let stages = 1 + case % 2;
        let stops = lines(6, 10.0 * f64::from(case), stages);
        let start = Some(DVec2::ZERO);
        let end = (case % 3 == 0).then_some(DVec2::new(100.0, 0.0));
        let tour = tour(&stops, start, end);
        valid(&stops, &tour);
        let own = length(&stops, &tour, start, end);
        let mut best = f64::INFINITY;
        shortest(&stops, &mut Vec::new(), start, end, &mut best);
        sum += own;
        least += best;
        worst = worst.max(own / best);
    }
    assert!(sum < 1.03 * least, "{}", sum / least);
    assert!(worst < 1.3, "{worst}");
}

#[test]
fn a_tour_is_never_longer_than_nearest_first_and_much_shorter_at_best() {
    let (mut first, mut own) = (0.0, 0.0);
    for case in 0..40 {
        let stops = lines(1 + 17 * case, case as f64, 1 + case as u32 % 3);
        let start = (case % 4 != 0).then_some(DVec2::new(50.0, 50.0));
        let end = (case % 5 != 0).then_some(DVec2::ZERO);
        let tour = tour(&stops, start, end);
        valid(&stops, &tour);
        let nearest = nearest_first(&stops, start);
        let (a, b) = (
            length(&stops, &nearest, start, end),
            length(&stops, &tour, start, end),
        );
        assert!(b <= a, "{case}: {b} {a}");
        first += a;
        own += b;
    }
    assert!(own < 0.88 * first, "{}", own / first);
}

#[test]
fn a_grid_of_points_is_walked_to_and_fro() {
    let stops: Vec<Stop> = (0..400)
        .map(|i| {
            // In no order.
            let i = i * 77 % 400;
            let p = DVec2::new(f64::from(i % 20), f64::from(i / 20));
            Stop {
                from: 5.0 * p,
                to: 5.0 * p,
                turns: false,
                stage: 0,
            }
        })
        .collect();
    let start = Some(DVec2::ZERO);
    let own = length(&stops, &tour(&stops, start, None), start, None);
    assert!(own < 1.1 * 399.0 * 5.0, "{own}");
}

#[test]
fn the_end_counts() {
    // Nearest first would pass by the one on the way to the end.
    let stop = |x: f64| Stop {
        from: DVec2::new(x, 0.0),
        to: DVec2::new(x, 0.0),
        turns: true,
        stage: 0,
    };
    let stops = [stop(-2.0), stop(3.0)];
    let last = |end| {
        let tour = tour(&stops, Some(DVec2::ZERO), end);
        tour[1].stop
    };
    assert_eq!(last(None), 1);
    assert_eq!(last(Some(DVec2::new(-10.0, 0.0))), 0);
}

#[test]
fn stops_in_one_place_do_no_harm() {
    assert_eq!(tour(&[], None, None), []);
    let here = Stop {
        from: DVec2::ONE,
        to: DVec2::ONE,
        turns: true,
        stage: 0,
    };
    assert_eq!(tour(&[here; 50], None, None).len(), 50);
}

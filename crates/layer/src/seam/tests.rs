use super::follow::PULL;
use super::*;
use crate::view::LayerView;
use isoslice_planar::shapes::ring;
use isoslice_planar::{Area, Solid};
use isoslice_settings::layers::LayerSpan;
use std::f64::consts::TAU;

const ACCURACY: f64 = 0.005;

/// A circle whose facets are within `ACCURACY`. They are uneven and begin
/// anywhere.
fn circle(centre: DVec2, radius: f64, begin: f64) -> Vec<DVec2> {
    let facet = (8.0 * ACCURACY / radius).sqrt();
    let mut angle = 0.0;
    let mut ring = Vec::new();
    while angle < TAU - 0.3 * facet {
        ring.push(centre + radius * DVec2::from_angle(angle + begin));
        let uneven = 0.6 + 0.4 * (37.0 * angle).sin().abs();
        angle += facet * uneven;
    }
    ring
}

#[test]
fn circles_have_no_corners_and_their_seam_is_behind() {
    for radius in [0.3, 1.0, 4.0, 60.0] {
        for k in 0..20 {
            let centre = DVec2::new(3.0, -2.0);
            let mut ring = circle(centre, radius, f64::from(k) * 0.377);
            for hole in [false, true] {
                if hole {
                    ring.reverse();
                }
                let site = aligned(&ring, ACCURACY);
                assert_eq!(site.corners, [], "{radius} {hole}");
                let at = site.at.unwrap() - centre;
                let wanted = DVec2::new(0.0, radius);
                assert!(at.distance(wanted) < 0.02, "{at}");
            }
        }
    }
}

#[test]
fn the_least_is_found_between_the_vertices() {
    for (radius, within) in [(2.0, 0.01), (20.0, 0.03), (60.0, 0.05)] {
        for k in 0..20 {
            let begin = f64::from(k) * 0.377;
            let ring = circle(DVec2::ZERO, radius, begin);
            let along = DVec2::from_angle(1.1);
            // The point is as exact as expressions are.
            let found = lowest(&ring, ACCURACY, |points, out| {
                out.extend(
                    points.iter().map(|p| f64::from(along.dot(*p) as f32)),
                );
                Ok::<(), ()>(())
            });
            let off = found.unwrap().unwrap().distance(-radius * along);
            assert!(off < within, "{radius}: {off}");
        }
    }
    // At a corner the point is the corner. On a level side it is the side's end
    // at the back.
    let ring = ring(&[(0.0, -3.0), (4.0, 0.0), (4.0, 5.0), (-4.0, 5.0)]);
    let least = |f: fn(&DVec2) -> f64| {
        let found = lowest(&ring, ACCURACY, |points, out| {
            out.extend(points.iter().map(f));
            Ok::<(), ()>(())
        });
        found.unwrap().unwrap()
    };
    assert!(least(|p| p.y).distance(ring[0]) < 0.01);
    assert!(least(|p| -p.y).distance(ring[2]) < 0.01);
    let at = least(|p| (p.x - 1.3).abs() - p.y);
    assert!(at.distance(DVec2::new(1.3, 5.0)) < 0.01, "{at}");
    assert_eq!(lowest(&[], ACCURACY, |_, _| Ok::<(), ()>(())), Ok(None));
}

#[test]
fn concave_corners_come_first_and_the_middle_of_round_ones() {
    // The inner corner of this L is an arc of 0.225 mm, as in walls.
    let mut l = ring(&[(0.0, 9.0), (0.0, 0.0), (9.0, 0.0), (9.0, 3.0)]);
    let centre = DVec2::new(3.3, 3.3);
    for k in 0..=5 {
        let angle = (270.0 - 18.0 * f64::from(k)).to_radians();
        l.push(centre + 0.3 * DVec2::from_angle(angle));
    }
    l.push(DVec2::new(3.0, 9.0));
    let site = aligned(&l, ACCURACY);
    assert_eq!(site.corners.len(), 1, "{site:?}");
    let wanted = centre - 0.3 / 2.0_f64.sqrt();
    assert!(site.corners[0].distance(wanted) < 0.02, "{site:?}");
    assert_eq!(follow(&site, &l, None, None), Some(site.corners[0]));
    // Without a concave corner there are convex ones: the rearmost is taken, to
    // the right.
    let square = ring(&[(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)]);
    let site = aligned(&square, ACCURACY);
    assert_eq!(site.corners.len(), 4);
    let at = follow(&site, &square, None, None).unwrap();
    assert!(at.distance(square[2]) < 1e-9);
}

/// The seam of a ring over a layer with its outline.
fn next(site: &Site, ring: &[DVec2], below: DVec2) -> Option<DVec2> {
    follow(site, ring, Some(Below::lower(below, 1, 0.0)), None)
}

#[test]
fn seams_follow_their_corner_or_go_back_bit_by_bit() {
    let square = ring(&[(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)]);
    let site = aligned(&square, ACCURACY);
    let near = DVec2::new(0.0, 0.7);
    assert!(next(&site, &square, near).unwrap().length() < 1e-9);
    // From the middle of a side the seam goes to a corner of its own layer.
    let far = DVec2::new(0.0, 4.0);
    assert_eq!(next(&site, &square, far), Some(square[2]));
    let ring = circle(DVec2::ZERO, 10.0, 0.3);
    let site = aligned(&ring, ACCURACY);
    let mut at = DVec2::new(10.0, 0.0);
    let mut steps = 0;
    while at.distance(site.at.unwrap()) > 1e-9 {
        let above = next(&site, &ring, at).unwrap();
        // The facets are the only error.
        assert!(above.distance(at) < PULL + 0.02 && above.y > at.y - 0.01);
        at = above;
        steps += 1;
    }
    // The steps cover a quarter of the circle.
    assert!((150..165).contains(&steps), "{steps}");
    assert_eq!(follow(&site, &ring, None, None), site.at);
    assert_eq!(next(&Site::default(), &ring, at), Some(at));
    assert_eq!(follow(&Site::default(), &ring, None, None), None);
}

#[test]
fn random_seams_depend_on_layer_and_ring_alone() {
    let ring = circle(DVec2::ZERO, 10.0, 0.3);
    let at = |layer, number| random(&ring, [layer, number]).unwrap();
    assert_eq!(at(7, 1), at(7, 1));
    assert!(at(7, 1).distance(at(8, 1)) > 1e-3);
    assert!(at(7, 1).distance(at(7, 2)) > 1e-3);
    let mean = (0..2000).map(|k| at(k, 0)).sum::<DVec2>() / 2000.0;
    assert!(mean.length() < 0.6, "{mean}");
}

#[test]
fn of_corners_alike_those_over_the_ground_are_taken() {
    let square = ring(&[(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)]);
    let site = aligned(&square, ACCURACY);
    let moved = |by: DVec2| {
        let ring: Vec<DVec2> = square.iter().map(|p| *p + by).collect();
        Solid::new(Area::from(ring))
    };
    let here = moved(DVec2::ZERO);
    let seam = |lean: DVec2, below: Option<usize>| {
        let under = moved(-0.2 * lean);
        let view = LayerView::of(1, &here, &[], &[&under]);
        let ground = Ground::of(view.here, view.below[0]);
        let below = below.map(|corner| Below::lower(square[corner], 1, 0.0));
        let at = follow(&site, &square, below, ground).unwrap();
        square.iter().position(|p| p.distance(at) < 1e-9).unwrap()
    };
    // The rearmost one is to the right, if nothing hangs there.
    assert_eq!(seam(DVec2::new(-1.0, 0.0), None), 2);
    assert_eq!(seam(DVec2::new(1.0, 0.0), None), 3);
    assert_eq!(seam(DVec2::new(1.0, 1.0), None), 0);
    assert_eq!(seam(DVec2::new(0.05, 0.0), None), 2);
    // A seam leaves its corner only for a good reason.
    assert_eq!(seam(DVec2::new(0.2, 0.0), Some(1)), 1);
    assert_eq!(seam(DVec2::new(0.5, 0.0), Some(1)), 3);
    assert_eq!(seam(DVec2::new(0.5, 0.0), Some(0)), 0);
}

/// A guide that looks at few layers expects the corners that a seam follows from
/// layer to layer.
#[test]
fn a_guide_knows_where_seams_go() {
    let corners = |layer: usize| -> Vec<DVec2> {
        let turn = |k: u32| TAU * f64::from(k) / 5.0 + 0.02 * layer as f64;
        (0..5).map(|k| 9.0 * DVec2::from_angle(turn(k))).collect()
    };
    let span = |index: usize| LayerSpan {
        index,
        bottom: 0.2 * index as f64,
        top: 0.2 * (index + 1) as f64,
    };
    let mut guide = Guide::new(ACCURACY);
    for index in [1].into_iter().chain((13..400).step_by(16)) {
        let [below, here] = [index - 1, index]
            .map(|index| Solid::new(Area::from(corners(index))));
        let below = Some((&span(index - 1), &below));
        guide.look(&span(index), &here, below, None);
    }
    let mut at = None;
    for index in 0..400 {
        let ring = corners(index);
        let site = aligned(&ring, ACCURACY);
        let below = at.map(|at| Below::lower(at, 1, 0.0));
        at = follow(&site, &ring, below, None);
        let [seam] = *guide.seams(&span(index)) else {
            panic!("one ring has one seam");
        };
        // Between two looks, the chord of an arc of 0.32 is 0.12 mm from it.
        assert!(seam.distance(at.unwrap()) < 0.2, "{index} {seam} {at:?}");
    }
}

/// A seam that begins or ends between two looks is expected in all layers
/// between them, and the others go on.
#[test]
fn a_guide_knows_seams_that_begin_and_end() {
    let square = |x: f64| -> Vec<DVec2> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(a, b)| DVec2::new(x + a, b))
            .to_vec()
    };
    let span = |index: usize| LayerSpan {
        index,
        bottom: 0.2 * index as f64,
        top: 0.2 * (index + 1) as f64,
    };
    let mut guide = Guide::new(ACCURACY);
    let mut look = |index: usize, at: &[f64]| {
        let area: Area = at.iter().map(|&x| square(x)).collect();
        let here = Solid::new(area);
        let below = index.checked_sub(1).map(span);
        let below = below.as_ref().map(|below| (below, &here));
        guide.look(&span(index), &here, below, None);
    };
    look(0, &[0.0]);
    look(13, &[20.0, 0.8]);
    look(29, &[20.0]);
    let at = |index: usize| {
        let mut x: Vec<f64> =
            guide.seams(&span(index)).iter().map(|p| p.x).collect();
        x.sort_by(f64::total_cmp);
        x
    };
    let (first, second) = (at(0)[0], at(29)[0]);
    // One that goes on from look to look comes first, one that begins last.
    for (index, beyond) in [(6, true), (20, false)] {
        let seams = guide.seams(&span(index));
        assert_eq!(seams[1].x > 10.0, beyond, "{index} {seams:?}");
    }
    let near = |index: usize, seams: &[f64]| {
        let found = at(index);
        assert_eq!(found.len(), seams.len(), "{index} {found:?}");
        for (a, b) in found.iter().zip(seams) {
            assert!((a - b).abs() < 1e-9, "{index} {found:?} {seams:?}");
        }
    };
    near(6, &[first + 0.8 * 6.0 / 13.0, second]);
    near(13, &[first + 0.8, second]);
    near(20, &[first + 0.8, second]);
    near(40, &[second]);
}

/// A corner that has jumped since the layer below does not make its seam lean.
#[test]
fn a_jump_is_no_slope() {
    let plate = |x: f64| -> Vec<DVec2> {
        [(-4.0, -3.0), (4.0, -3.0), (x, 3.0), (-x, 3.0)]
            .map(DVec2::from)
            .into()
    };
    let span = |index: usize| LayerSpan {
        index,
        bottom: 0.1 * index as f64,
        top: 0.1 * (index + 1) as f64,
    };
    // Two layers of a wall that leans by 45°, and two with a step between them.
    for (x, lower, moved) in [(4.0, 4.1, 2.0_f64), (4.0, 5.0, 0.0)] {
        let mut guide = Guide::new(ACCURACY);
        let [here, below] =
            [x, lower].map(|x| Solid::new(Area::from(plate(x))));
        guide.look(&span(13), &here, Some((&span(12), &below)), None);
        let [at, up] = [13, 33].map(|index| guide.seams(&span(index))[0]);
        let inward = DVec2::new(-moved * at.x.signum(), 0.0);
        assert!((up - at).distance(inward) < 1e-9, "{at} {up}");
    }
}

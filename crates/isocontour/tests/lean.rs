//! How level surfaces are, compared with what is known of them.

#![allow(clippy::unwrap_used, reason = "helpers of tests may unwrap, too")]

use fidget::context::Tree;
use glam::DVec3;
use isocontour::{Bounds, Cancel, Lean, LeanOptions, lean};

const BIN: f64 = 0.01;

fn look(tree: &Tree, min: DVec3, max: DVec3, enough: f64) -> Lean {
    let bounds = Bounds { min, max };
    let options = LeanOptions {
        bin: BIN,
        enough,
        most: 1.0,
        tolerance: 0.005,
        bins: (0, usize::MAX),
        max_work: 400_000_000,
    };
    lean(tree, &bounds, &options, &Cancel::default()).unwrap()
}

/// Compares the bounds with the greatest |n_z| at each height.
fn agrees(lean: &Lean, greatest: impl Fn(f64) -> f64, slack: f64) {
    for (k, found) in lean.most_level.iter().enumerate() {
        let ends = [0.0, 0.25, 0.5, 0.75, 1.0]
            .map(|t| greatest(lean.bottom + (k as f64 + t) * BIN));
        let true_one = ends.iter().copied().fold(0.0, f64::max);
        assert!(*found >= true_one - 1e-9, "bin {k}: {found} < {true_one}");
        let near = true_one.max(0.3) * slack + 0.01;
        assert!(*found <= near, "bin {k}: {found}, but {true_one}");
    }
}

fn axes() -> [Tree; 3] {
    let (x, y, z) = Tree::axes();
    [x, y, z]
}

#[test]
fn a_ball_is_as_level_as_its_height() {
    let [x, y, z] = axes();
    let ball = (x.square() + y.square() + z.square()).sqrt() - 5.0;
    let r = DVec3::splat(5.0);
    let found = look(&ball, -r, r, 0.3);
    agrees(&found, |z| (z.abs() / 5.0).min(1.0), 1.08);
    assert_eq!(found.faces, Vec::<f64>::new());
    assert_eq!(found.unproved, 0.0);
}

#[test]
fn no_distance_is_needed() {
    let [x, y, z] = axes();
    let f = x.square() / 100.0 + y.square() / 36.0 + z.square() / 16.0 - 1.0;
    let r = DVec3::new(10.0, 6.0, 4.0);
    let found = look(&f, -r, r, 0.3);
    // The most level place may be at the end of the longest axis or anywhere
    // else. On the ring at the height z the gradient in the plane is least
    // along x.
    let of = |z: f64| {
        let s = 1.0 - (z / 4.0_f64).powi(2).min(1.0);
        let up = z / 16.0;
        let along = s.sqrt() / 10.0;
        if up == 0.0 {
            0.0
        } else {
            up.abs() / along.hypot(up)
        }
    };
    agrees(&found, of, 1.12);
}

#[test]
fn level_faces_are_found_and_make_nothing_level() {
    let [x, y, z] = axes();
    let r = (x.square() + y.square()).sqrt();
    let base = (r.clone() - 5.0).max((z.clone() - 1.0).abs() - 1.0);
    let pin = (r - 2.0).max((z - 2.0).abs() - 1.2345);
    let found = look(
        &base.min(pin),
        DVec3::new(-5.0, -5.0, 0.0),
        DVec3::new(5.0, 5.0, 3.2345),
        0.3,
    );
    assert!(found.most_level.iter().all(|m| *m == 0.3), "{found:?}");
    let inner = |f: &&f64| **f > 0.01 && **f < 3.2;
    let faces: Vec<&f64> = found.faces.iter().filter(inner).collect();
    assert_eq!(faces.len(), 1, "{:?}", found.faces);
    assert!((faces[0] - 2.0).abs() < 1e-6);
    assert_eq!(found.unproved, 0.0);
}

/// A step, of which the upper body stands on the lower one, whose lower half is
/// a body of its own.
#[test]
fn level_faces_that_two_bodies_share_are_none() {
    let [x, y, z] = axes();
    let prism = |half: f32, low: f32, high: f32| {
        let side = x.abs().max(y.abs()) - half;
        side.max(low - z.clone()).max(z.clone() - high)
    };
    let body = prism(5.0, 0.0, 1.0)
        .min(prism(5.0, 1.0, 2.0))
        .min(prism(3.0, 2.0, 3.0));
    let found = look(
        &body,
        DVec3::new(-5.0, -5.0, 0.0),
        DVec3::new(5.0, 5.0, 3.0),
        0.3,
    );
    let inner = |f: &&f64| **f > 0.01 && **f < 2.99;
    let faces: Vec<&f64> = found.faces.iter().filter(inner).collect();
    assert_eq!(faces.len(), 1, "{:?}", found.faces);
    assert!((faces[0] - 2.0).abs() < 1e-6);
    assert!(found.most_level.iter().all(|m| *m == 0.3), "{found:?}");
    assert_eq!(found.unproved, 0.0);
}

/// The share of a part's work that one of its pieces gets suffices for a cut
/// all across the piece.
#[test]
fn a_cut_takes_little_work() {
    let [x, y, z] = axes();
    let side = (x.abs() - 6.0).max(y.abs() - 5.0);
    let block = side.max((z.clone() - 3.0).abs() - 3.0);
    let cut = z - 4.5;
    let halves = block.max(cut.clone()).min(block.max(-cut));
    let bounds = Bounds {
        min: DVec3::new(-6.0, -5.0, 0.0),
        max: DVec3::new(6.0, 5.0, 6.0),
    };
    let options = LeanOptions {
        bin: 0.0125,
        enough: 0.33,
        most: 1.0,
        tolerance: 0.005,
        bins: (340, 380),
        max_work: 1_900_000,
    };
    let found = lean(&halves, &bounds, &options, &Cancel::default()).unwrap();
    assert_eq!((found.unproved, found.faces), (0.0, vec![]));
}

#[test]
fn a_cone_is_alike_at_all_heights_but_its_tip() {
    let [x, y, z] = axes();
    let cone = ((x.square() + y.square()).sqrt() + z.clone() - 4.0).max(-z);
    let found = look(
        &cone,
        DVec3::new(-4.0, -4.0, 0.0),
        DVec3::new(4.0, 4.0, 4.0),
        0.3,
    );
    // Near the tip the cone is thinner than the boxes.
    let (body, tip) = found.most_level.split_at(370);
    let level = 0.5_f64.sqrt();
    assert!(body.iter().all(|m| *m >= level && *m <= 1.06 * level));
    assert!(tip.iter().all(|m| *m >= level));
}

#[test]
fn what_is_not_a_number_is_level_for_all_that_is_known() {
    let [x, y, z] = axes();
    // The root ends at z = 1, far from f = 0: a level border of the part.
    let f = ((x.square() + y.square()).sqrt() - 3.0)
        + (1.0 - z.clone()).sqrt() * 0.001
        + (z + 5.0).abs() * 0.0;
    let found = look(
        &f,
        DVec3::new(-3.0, -3.0, 0.0),
        DVec3::new(3.0, 3.0, 2.0),
        0.3,
    );
    let at = |z: f64| found.most_level[(z / BIN) as usize];
    assert_eq!(at(1.0 - 0.005), 1.0);
    assert!(at(0.5) < 0.31);
}

#[test]
fn little_work_gives_safe_bounds() {
    let [x, y, z] = axes();
    let ball = (x.square() + y.square() + z.square()).sqrt() - 5.0;
    let r = DVec3::splat(5.0);
    let options = LeanOptions {
        bin: BIN,
        enough: 0.3,
        most: 1.0,
        tolerance: 0.005,
        bins: (0, usize::MAX),
        max_work: 20_000,
    };
    let bounds = Bounds { min: -r, max: r };
    let found = lean(&ball, &bounds, &options, &Cancel::default()).unwrap();
    for (k, most) in found.most_level.iter().enumerate() {
        let z = (k as f64 * BIN - 5.0).abs();
        assert!(*most >= (z / 5.0 - 0.003).max(0.3), "{k}: {most}");
    }
    assert!(found.unproved > 1.0);
}

#[test]
fn a_level_face_where_two_looks_meet_is_found() {
    let [x, y, z] = axes();
    let sides = x.clone().abs().max(y.clone().abs()) - 20.0;
    let ball = (x.square() + y.square() + z.square()).sqrt() - 9.5;
    let bounds = Bounds {
        min: DVec3::new(-20.0, -20.0, 0.0),
        max: DVec3::new(20.0, 20.0, 9.5),
    };
    for level in [4.5, 5.0, 6.0, 6.004, 6.3_f32] {
        let face = z.clone() - Tree::constant(level);
        let f = sides.clone().max(face).max(-z.clone()).min(ball.clone());
        let piece = |bins| {
            let options = LeanOptions {
                bin: BIN,
                enough: 0.33,
                most: 1.0,
                tolerance: 0.005,
                bins,
                max_work: 10_000_000,
            };
            lean(&f, &bounds, &options, &Cancel::default()).unwrap()
        };
        let pieces = (0..32).map(|k| piece((30 * k, 30 * (k + 1))));
        let found = pieces.reduce(Lean::joined).unwrap();
        let near = |z: &f64| (z - f64::from(level)).abs() < 1e-6;
        assert!(found.faces.iter().any(near), "{level}: {:?}", found.faces);
        assert_eq!(found.unproved, 0.0, "{level}");
    }
}

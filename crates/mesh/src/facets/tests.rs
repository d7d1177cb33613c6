//! How level meshes are at each height, compared with their triangles.

use crate::mesh::Mesh;
use crate::tests::{ball, bowl, cuboid, mesh, moved, scattered};
use fidget::context::Tree;
use glam::{DAffine3, DMat3, DVec3};
use isocontour::{Bounds, Cancel, Data, Lean, LeanOptions, call, lean};
use std::sync::Arc;

const BIN: f64 = 0.02;
const ENOUGH: f64 = 0.3;

type Face = [DVec3; 3];

/// How level an expression of a mesh is.
fn look(mesh: Mesh, bounds: Bounds, of: impl Fn(Tree) -> Tree) -> Lean {
    placed(mesh, bounds, |p| p, of)
}

/// The same for a mesh that is asked at places that `at` makes.
fn placed(
    mesh: Mesh,
    bounds: Bounds,
    at: impl Fn([Tree; 3]) -> [Tree; 3],
    of: impl Fn(Tree) -> Tree,
) -> Lean {
    let data: Arc<dyn Data> = Arc::new(mesh);
    let (x, y, z) = Tree::axes();
    let tree = of(call(&data, at([x, y, z])));
    let options = LeanOptions {
        bin: BIN,
        enough: ENOUGH,
        most: 1.0,
        tolerance: 0.005,
        bins: (0, usize::MAX),
        max_work: 60_000_000,
    };
    lean(&tree, &bounds, &options, &Cancel::default()).unwrap()
}

fn around(faces: &[Face]) -> Bounds {
    Bounds::around(faces.as_flattened().iter().copied())
}

/// The greatest |n_z| of all faces that reach between two heights, but for level
/// ones.
fn greatest(faces: &[Face], low: f64, high: f64) -> f64 {
    let of = |&[a, b, c]: &Face| {
        let reaches =
            a.z.min(b.z).min(c.z) < high && a.z.max(b.z).max(c.z) > low;
        let normal = (b - a).cross(c - a).normalize();
        let counts = reaches && normal.z.abs() < 1.0 - 1e-12;
        if counts { normal.z.abs() } else { 0.0 }
    };
    faces.iter().map(of).fold(ENOUGH, f64::max)
}

/// Tests that bounds are never below those of the triangles, nor above them but for
/// what the next bin has.
fn agrees(found: &Lean, faces: &[Face]) {
    for (k, level) in found.most_level.iter().enumerate() {
        let low = found.bottom + k as f64 * BIN;
        let least = greatest(faces, low + 1e-6, low + BIN - 1e-6);
        let most = greatest(faces, low - BIN, low + 2.0 * BIN);
        assert!(*level >= least - 1e-6, "{low}: {level}, {least}");
        assert!(*level <= 1.05 * most, "{low}: {level}, {most}");
    }
    assert_eq!(found.unproved, 0.0);
}

#[test]
fn a_mesh_is_as_level_as_its_triangles() {
    let faces = ball(5.0, 5);
    let found = look(mesh(&faces), around(&faces), |f| f);
    agrees(&found, &faces);
    // The triangles of a fine ball lean as the ball does.
    let at = |z: f64| found.most_level[((z - found.bottom) / BIN) as usize];
    for z in [-4.5, -3.0, 2.0, 3.0, 4.5_f64] {
        let level = at(z);
        assert!((level - z.abs() / 5.0).abs() < 0.04, "{z}: {level}");
    }
}

#[test]
fn a_mesh_that_is_turned_and_scaled_is_as_level_as_its_triangles() {
    let axis = DVec3::new(1.0, 2.0, -0.5).normalize();
    let place = DAffine3 {
        matrix3: DMat3::from_axis_angle(axis, 0.7) * (1.0 / 1.5),
        translation: DVec3::new(1.0, -2.0, 0.5),
    };
    // Constants of expressions have 32 bits.
    let round = |p: DVec3| p.as_vec3().as_dvec3();
    let m = place.matrix3;
    let place = DAffine3::from_cols(
        round(m.x_axis),
        round(m.y_axis),
        round(m.z_axis),
        round(place.translation),
    );
    let own = [
        ball(4.0, 3),
        cuboid(DVec3::new(-3.0, -2.0, -4.0), DVec3::new(3.0, 2.0, 4.0)),
    ];
    for own in own {
        let back = place.inverse();
        let faces: Vec<Face> = own
            .iter()
            .map(|f| f.map(|p| back.transform_point3(p)))
            .collect();
        let at = |p: [Tree; 3]| {
            [0, 1, 2].map(|k| {
                let row = place.matrix3.row(k);
                let [x, y, z] = [0, 1, 2]
                    .map(|i| p[i].clone() * Tree::constant(row[i] as f32));
                x + y + z + Tree::constant(place.translation[k] as f32)
            })
        };
        // A factor keeps the surface.
        let found = placed(mesh(&own), around(&faces), at, |f| f * 1.5);
        agrees(&found, &faces);
    }
}

#[test]
fn level_faces_are_found_and_make_nothing_level() {
    let low = cuboid(DVec3::new(-6.0, -6.0, 0.0), DVec3::new(6.0, 6.0, 3.0));
    let high = cuboid(DVec3::new(-4.0, -4.0, 1.0), DVec3::new(4.0, 4.0, 5.5));
    let faces = [low, high].concat();
    let found = look(mesh(&faces), around(&faces), |f| f);
    assert!(found.most_level.iter().all(|l| *l == ENOUGH), "{found:?}");
    // The upper body begins within the lower one, where no face shows.
    assert_eq!(found.faces, [0.0, 3.0, 5.5]);
    assert_eq!(found.unproved, 0.0);
}

#[test]
fn faces_within_another_body_make_nothing_level() {
    let inner = ball(2.0, 2);
    let faces = [
        cuboid(DVec3::new(-6.0, -6.0, -4.0), DVec3::new(6.0, 6.0, 4.0)),
        moved(&inner, DVec3::new(0.5, 0.2, -0.1)),
    ]
    .concat();
    let found = look(mesh(&faces), around(&faces), |f| f);
    // Bounds have a slack of 4 %.
    let is_steep = |l: &f64| *l <= 1.04 * ENOUGH;
    assert!(found.most_level.iter().all(is_steep), "{found:?}");
    // A ball that is taken out shows.
    let cavity = |f: Tree| {
        let data: Arc<dyn Data> = Arc::new(mesh(&inner));
        let (x, y, z) = Tree::axes();
        let hole = call(&data, [x, y, z]);
        // The data lives as long as somebody keeps it.
        std::mem::forget(data);
        f.max(-hole)
    };
    let block = cuboid(DVec3::new(-6.0, -6.0, -4.0), DVec3::splat(4.0));
    let found = look(mesh(&block), around(&block), cavity);
    let all = [block, inner].concat();
    agrees(&found, &all);
}

#[test]
fn what_is_cut_off_does_not_count() {
    let faces = ball(5.0, 5);
    let half = DVec3::new(2.5, 2.5, 4.5);
    let bounds = Bounds::new(-half, half);
    let cut = |f: Tree| {
        let (x, y, z) = Tree::axes();
        f.max(x.abs() - 2.5).max(y.abs() - 2.5).max(z.abs() - 4.5)
    };
    let found = look(mesh(&faces), bounds, cut);
    for (k, level) in found.most_level.iter().enumerate() {
        // The corners of the prism reach the ball at a height of √(25 − 12.5).
        let z = (found.bottom + (k as f64 + 0.5) * BIN).abs();
        if z < 3.45 {
            assert_eq!(*level, ENOUGH, "{z}");
        } else if z > 3.6 {
            assert!((level - z / 5.0).abs() < 0.05, "{z}: {level}");
        }
    }
    assert_eq!(found.unproved, 0.0);
    assert_eq!(found.faces, [-4.5, 4.5]);
}

#[test]
fn a_cover_over_an_opening_is_a_face() {
    let faces = bowl();
    let found = look(mesh(&faces), around(&faces), |f| f);
    agrees(&found, &faces);
    assert_eq!(found.faces, [0.0]);
}

#[test]
fn what_winding_numbers_close_is_not_proved() {
    let faces = scattered(&ball(5.0, 2), 0.2);
    let mesh = mesh(&faces);
    assert!(!mesh.sign.is_whole());
    let tell = &mut |_| {};
    assert!(!mesh.facets_over(&DAffine3::IDENTITY, 0.0, &around(&faces), tell));
    let found = look(mesh, around(&faces), |f| f);
    assert!(found.unproved > 5.0, "{}", found.unproved);
}

/// The bins of a look at the surface at a distance from a block, turned about x, and
/// what is known of that surface: the walls lean by the turn, and the rounding between
/// two walls has all directions between those.
#[test]
fn a_block_that_is_larger_on_all_sides_is_round_at_its_edges() {
    let half = DVec3::new(4.0, 3.0, 2.0);
    let faces = cuboid(-half, half);
    for radius in [0.5, 1.25_f64] {
        let reach = half + radius;
        let bounds = Bounds::new(-reach, reach);
        let found = look(mesh(&faces), bounds, |f| f - radius as f32);
        for (k, level) in found.most_level.iter().enumerate() {
            let z = [0.0, 1.0].map(|e| found.bottom + (k as f64 + e) * BIN);
            let [least, most] =
                [z[0].abs().min(z[1].abs()), z[0].abs().max(z[1].abs())]
                    .map(|z| ((z - half.z) / radius).clamp(ENOUGH, 1.0));
            // Boxes that are done are two bins high, and reach into three.
            let most = (most + 2.0 * BIN / radius).min(1.0);
            assert!(*level >= least - 1e-6, "{z:?}: {level}, {least}");
            assert!(*level <= 1.05 * most, "{z:?}: {level}, {most}");
        }
        assert_eq!(found.faces, [-reach.z, reach.z]);
        assert_eq!(found.unproved, 0.0);
    }
}

#[test]
fn a_wall_on_a_ball_is_as_level_as_the_ball() {
    let faces = ball(5.0, 5);
    let bounds = Bounds::new(DVec3::splat(-5.5), DVec3::splat(5.5));
    let found = look(mesh(&faces), bounds, |f| f.abs() - 0.5);
    for (k, level) in found.most_level.iter().enumerate() {
        let z = (found.bottom + (k as f64 + 0.5) * BIN).abs();
        // The inner side is the more level one, as far as it reaches up. Its
        // triangles lean by up to 0.035 less or more than the ball.
        let true_one = if z < 4.45 { z / 4.5 } else { z / 5.5 };
        let is_between = (4.4..4.6).contains(&z);
        let near = (level - true_one.max(ENOUGH)).abs() < 0.06;
        assert!(near || is_between, "{z}: {level}, {true_one}");
    }
    assert_eq!(found.unproved, 0.0);
}

/// Compares bounds with the directions of gradients at places on the surface.
#[test]
fn bounds_hold_at_a_distance_from_any_mesh() {
    let faces = [
        ball(3.0, 1),
        cuboid(DVec3::new(-5.0, -1.0, -1.5), DVec3::new(5.0, 1.2, 0.7)),
    ]
    .concat();
    let own = mesh(&faces);
    for level in [0.7, -0.4_f64] {
        let bounds = own.bounds.grown(level.max(0.0));
        let found = look(mesh(&faces), bounds, |f| f - level as f32);
        assert_eq!(found.unproved, 0.0);
        let mut random = fastrand::Rng::with_seed(3);
        let mut looked = 0;
        while looked < 3000 {
            let share = DVec3::from_array([(); 3].map(|()| random.f64()));
            let mut p = bounds.min + share * bounds.size();
            for _ in 0..30 {
                let (value, gradient) = own.at(p);
                p -= (value - level) * gradient;
            }
            let (value, gradient) = own.at(p);
            let is_level = gradient.z.abs() > 1.0 - 1e-9;
            if (value - level).abs() > 1e-9 || is_level {
                continue;
            }
            looked += 1;
            let bin = ((p.z - found.bottom) / BIN) as usize;
            let level = found.most_level[bin];
            assert!(gradient.z.abs() <= level + 1e-6, "{p}: {level}");
        }
    }
}

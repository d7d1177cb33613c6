//! Outlines against shapes whose outline is known in closed form.

// A test that cannot go on should say so and stop.
#![allow(clippy::unwrap_used, reason = "helpers of tests may unwrap, too")]

use fidget::context::Context;
use fidget::context::Tree;
use fidget::eval::{BulkEvaluator, Function, MathFunction};
use fidget::var::Var;
use fidget::vm::VmFunction;
use glam::DVec2;
use isocontour::plane::{edges, ring_length};
use isocontour::{
    Area, Detail, Field, NODES, Outline, Rect, outlines, outlines_in_phases,
};

const ACCURACY: f64 = 0.005;
const DETAIL: Detail = Detail {
    accuracy: ACCURACY,
    smallest: 0.11,
};

fn slice_with(tree: &Tree, half: f64, z: &[f64]) -> Vec<Outline> {
    spaced(tree, half, z, 0.1)
}

fn spaced(tree: &Tree, half: f64, z: &[f64], spacing: f64) -> Vec<Outline> {
    let bounds = Rect::new(DVec2::splat(-half), DVec2::splat(half));
    let field = Field::new(tree, 0.0, bounds, spacing).unwrap();
    outlines(&field, z, DETAIL).unwrap()
}

fn slice(tree: &Tree, half: f64, z: f64) -> Area {
    let o = slice_with(tree, half, &[z]).remove(0);
    assert_eq!(o.forced_rings, 0);
    o.area
}

/// Largest and mean of a signed distance over points along the rings.
fn deviation(area: &Area, distance: impl Fn(DVec2) -> f64) -> (f64, f64) {
    let (mut worst, mut sum, mut length) = (0.0_f64, 0.0, 0.0);
    for (a, b) in area.rings.iter().flat_map(|r| edges(r)) {
        for i in 0..64 {
            let p = a.lerp(b, (f64::from(i) + 0.5) / 64.0);
            let d = distance(p);
            worst = worst.max(d.abs());
            sum += d * a.distance(b) / 64.0;
        }
        length += a.distance(b);
    }
    (worst, sum / length)
}

#[test]
fn sphere_is_a_circle_without_bias() {
    let (x, y, z) = Tree::axes();
    let f = (x.square() + y.square() + z.square()).sqrt() - 15.0;
    for h in [0.05, 3.0, 11.9, 14.9] {
        let r = (15.0_f64 * 15.0 - h * h).sqrt();
        let area = slice(&f, 15.0, h);
        assert_eq!(area.rings.len(), 1);
        let (worst, mean) = deviation(&area, |p| p.length() - r);
        assert!(worst <= ACCURACY + 5e-5, "{h}: {worst}");
        assert!(mean.abs() < 0.001, "{h}: {mean}");
    }
}

#[test]
fn ellipse_of_a_field_that_is_no_distance() {
    let (x, y, z) = Tree::axes();
    for scale in [1.0_f32, 1e-6, 1e6] {
        let f = (x.square() / 400.0 + y.square() / 144.0 + z.square() / 64.0
            - 1.0)
            * scale;
        let k = 1.0 - 9.0 / 64.0;
        let area = slice(&f, 20.0, 3.0);
        let (worst, mean) = deviation(&area, |p| {
            let (a, b) = (400.0 * k, 144.0 * k);
            let g = p.x * p.x / a + p.y * p.y / b - 1.0;
            // To first order this is the distance, with an error of g².
            g / (2.0 * DVec2::new(p.x / a, p.y / b).length())
        });
        assert!(worst <= ACCURACY + 1e-4, "{scale}: {worst}");
        assert!(mean.abs() < 0.001, "{scale}: {mean}");
    }
}

#[test]
fn corners_of_turned_boxes_are_exact() {
    let (x, y, z) = Tree::axes();
    for degrees in [0.0_f64, 7.0, 30.0, 45.0, 81.3] {
        let (s, c) = degrees.to_radians().sin_cos();
        let (s, c) = (s as f32, c as f32);
        let u = x.clone() * c + y.clone() * s;
        let v = y.clone() * c - x.clone() * s;
        let f = (u.abs() - 7.0).max(v.abs() - 4.0).max(z.abs() - 10.0);
        let area = slice(&f, 9.0, 1.0);
        assert_eq!(area.rings.len(), 1, "{degrees}");
        let ring = &area.rings[0];
        assert_eq!(ring.len(), 4, "{degrees}: {ring:?}");
        let turn = DVec2::from_angle(degrees.to_radians());
        for (a, b) in [(7.0, 4.0), (-7.0, 4.0), (7.0, -4.0), (-7.0, -4.0)] {
            let corner = DVec2::new(a, b).rotate(turn);
            let near = ring
                .iter()
                .map(|p| p.distance(corner))
                .fold(f64::INFINITY, f64::min);
            assert!(near < 1e-4, "{degrees}: {near}");
        }
    }
}

#[test]
fn torus_has_a_hole_that_runs_clockwise() {
    let (x, y, z) = Tree::axes();
    let ring = (x.square() + y.square()).sqrt() - 15.0;
    let f = (ring.square() + z.square()).sqrt() - 5.0;
    let area = slice(&f, 20.0, 3.0);
    assert_eq!(area.rings.len(), 2);
    let exact = std::f64::consts::PI * (19.0_f64.powi(2) - 11.0_f64.powi(2));
    assert!((area.content() / exact - 1.0).abs() < 1e-4);
    let (worst, _) = deviation(&area, |p| (p.length() - 15.0).abs() - 4.0);
    assert!(worst <= ACCURACY + 5e-5, "{worst}");
}

#[test]
fn cut_cylinder_keeps_its_edges() {
    let (x, y, z) = Tree::axes();
    let f = ((x.square() + y.square()).sqrt() - 8.0)
        .max(x.clone() - 3.3)
        .max(z.abs() - 5.0);
    let area = slice(&f, 8.0, 0.0);
    let corner = DVec2::new(3.3, (64.0_f64 - 3.3 * 3.3).sqrt());
    for c in [corner, DVec2::new(corner.x, -corner.y)] {
        let near = area.rings[0]
            .iter()
            .map(|p| p.distance(c))
            .fold(f64::INFINITY, f64::min);
        assert!(near < 0.002, "{near}");
    }
}

fn gyroid_ball() -> Tree {
    let (x, y, z) = Tree::axes();
    let k = std::f32::consts::TAU / 10.0;
    let [s, c] = [Tree::sin, Tree::cos]
        .map(|f| [&x, &y, &z].map(|a| f(&(a.clone() * k))));
    let g = s[0].clone() * c[1].clone()
        + s[1].clone() * c[2].clone()
        + s[2].clone() * c[0].clone();
    let ball = (x.square() + y.square() + z.square()).sqrt() - 25.0;
    (g.abs() - 0.55).max(ball)
}

/// Samples equal what fidget's own interpreter gives for the whole expression,
/// whatever was simplified or taken out of it, except for the last digits of
/// sines.
#[test]
fn samples_are_those_of_fidgets_interpreter() {
    let tree = gyroid_ball();
    let mut ctx = Context::new();
    let root = ctx.import(&tree);
    let f = VmFunction::new(&ctx, &[root]).unwrap();
    let tape = f.float_slice_tape(Default::default());
    let mut fidget = VmFunction::new_float_slice_eval();
    let bounds = Rect::new(DVec2::splat(-25.0), DVec2::splat(25.0));
    let field = Field::new(&tree, 0.0, bounds, 0.1).unwrap();
    let z: Vec<f64> = (0..8).map(|i| -3.0 + 0.2 * f64::from(i)).collect();
    let mut compared = 0;
    let lattice = field.lattice();
    field
        .slab(&z, &mut |batch| {
            for (leaf, values) in
                batch.leaves.iter().zip(batch.values.chunks(NODES * NODES))
            {
                let mut points: [Vec<f32>; 3] = Default::default();
                for j in leaf.j..leaf.j + NODES {
                    for i in leaf.i..leaf.i + NODES {
                        let p =
                            [lattice.x[i], lattice.y[j], z[leaf.layer] as f32];
                        for (all, v) in points.iter_mut().zip(p) {
                            all.push(v);
                        }
                    }
                }
                let mut inputs = [&[][..]; 3];
                for (var, points) in
                    [Var::X, Var::Y, Var::Z].iter().zip(&points)
                {
                    inputs[f.vars().get(var).unwrap()] = points;
                }
                let expected = fidget.eval(&tape, &inputs).unwrap();
                for (a, b) in values.iter().zip(&expected[0]) {
                    assert!((a - b).abs() < 5e-6, "{a} for {b}");
                    compared += 1;
                }
            }
            Ok(())
        })
        .unwrap();
    assert!(compared > 100_000, "{compared}");
}

/// The topology of the tiled walk is compared with that of the `contour` crate
/// on the whole grid: the number of rings is equal, and their length within
/// what refinement changes.
#[test]
fn rings_are_those_of_the_contour_crate() {
    let bounds = Rect::new(DVec2::splat(-25.0), DVec2::splat(25.0));
    let tree = gyroid_ball();
    let field = Field::new(&tree, 0.0, bounds, 0.1).unwrap();
    let lattice = field.lattice();
    let h = 1.3_f32;
    let k = std::f32::consts::TAU / 10.0;
    let (nx, ny) = (lattice.x.len(), lattice.y.len());
    let mut values = Vec::with_capacity(nx * ny);
    for &y in &lattice.y {
        for &x in &lattice.x {
            let [sx, sy, sz] = [x, y, h].map(|v| (v * k).sin());
            let [cx, cy, cz] = [x, y, h].map(|v| (v * k).cos());
            let g = (sx * cy + sy * cz + sz * cx).abs() - 0.55;
            let ball = (x * x + y * y + h * h).sqrt() - 25.0;
            values.push(-g.max(ball));
        }
    }
    let mut oracle = contour::contour_rings(&values, 1e-30, nx, ny).unwrap();
    // The crate cuts ambiguous cells by convention, which leaves the nodes at
    // the tips of thin wedges as separate rings. The field joins them.
    oracle.retain(|r| r.len() > 5);
    let detail = Detail {
        accuracy: 1e-4,
        smallest: 0.0,
    };
    let ours = outlines(&field, &[f64::from(h)], detail).unwrap().remove(0);
    assert_eq!(ours.area.rings.len(), oracle.len());
    let length: f64 = oracle
        .iter()
        .map(|r| {
            let ring: Vec<DVec2> = r
                .iter()
                .map(|p| DVec2::new(p.x.into(), p.y.into()) * 0.1)
                .collect();
            ring_length(&ring)
        })
        .sum();
    // Midpoints zigzag, so the crate's unsmoothed rings are a little longer.
    let ratio = length / ours.area.perimeter();
    assert!((1.0..1.12).contains(&ratio), "{ratio}");
}

#[test]
fn nan_is_outside_and_counted() {
    let (x, y, z) = Tree::axes();
    // sqrt(x) is NaN left of the plane x = 0.
    let f = (x.sqrt() * 1e-9)
        + ((x.square() + y.square() + z.square()).sqrt() - 5.0);
    let o = slice_with(&f, 5.0, &[0.0]).remove(0);
    assert!(o.nan_samples > 100);
    let half_disc = 0.5 * std::f64::consts::PI * 25.0;
    assert!((o.area.content() - half_disc).abs() < 0.05);
}

#[test]
fn jumps_are_found_by_halving() {
    let (x, y, z) = Tree::axes();
    let radius = (x.square() + y.square() + z.square()).sqrt();
    // The field is −1 inside 6.2 mm and 1 outside, with nothing between.
    let f = radius.compare(6.2);
    let area = slice(&f, 8.0, 0.0);
    let (worst, mean) = deviation(&area, |p| p.length() - 6.2);
    assert!(worst <= ACCURACY + 1e-4, "{worst}");
    assert!(mean.abs() < 0.001, "{mean}");
}

#[test]
fn small_circles_are_round_on_any_lattice() {
    let (x, y, _) = Tree::axes();
    for spacing in [0.1, 0.4, 2.0] {
        for r in [0.15_f32, 0.3, 1.0] {
            let f = (x.square() + y.square()).sqrt() - r;
            let o = spaced(&f, 4.0, &[0.0], spacing).remove(0);
            assert_eq!(o.area.rings.len(), 1, "{spacing} {r}");
            let (worst, mean) =
                deviation(&o.area, |p| p.length() - f64::from(r));
            assert!(worst <= ACCURACY + 1e-4, "{spacing} {r}: {worst}");
            assert!(mean.abs() < 0.001, "{spacing} {r}: {mean}");
        }
    }
}

/// The field says only what is inside and what is outside.
#[test]
fn corners_of_jumping_fields_are_exact() {
    let (x, y, _) = Tree::axes();
    for degrees in [0.0_f64, 17.0, 45.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let u = x.clone() * c as f32 + y.clone() * s as f32;
        let v = y.clone() * c as f32 - x.clone() * s as f32;
        let f = (u.abs() - 3.0).max(v.abs() - 2.0).compare(0.0);
        let area = slice(&f, 4.0, 0.0);
        assert_eq!(area.rings.len(), 1);
        let turn = DVec2::from_angle(degrees.to_radians());
        for (a, b) in [(3.0, 2.0), (-3.0, 2.0), (3.0, -2.0), (-3.0, -2.0)] {
            let corner = DVec2::new(a, b).rotate(turn);
            let near = area.rings[0]
                .iter()
                .map(|p| p.distance(corner))
                .fold(f64::INFINITY, f64::min);
            assert!(near < ACCURACY, "{degrees}: {near}");
        }
    }
}

/// Tips of less than 30° end between the nodes of the lattice.
#[test]
fn sharp_tips_reach_their_ends() {
    let (x, y, _) = Tree::axes();
    for degrees in [10.0_f64, 20.0, 28.0] {
        let (s, c) = (0.5 * degrees).to_radians().sin_cos();
        for turn in [0.0_f64, 0.4, 1.1] {
            let (k, l) = (turn.sin() as f32, turn.cos() as f32);
            let u = x.clone() * l + y.clone() * k;
            let v = y.clone() * l - x.clone() * k;
            let f = (v.abs() * c as f32 + (u.clone() - 3.0) * s as f32)
                .max(-u - 1.0);
            let area = slice(&f, 4.0, 0.0);
            assert_eq!(area.rings.len(), 1, "{degrees} {turn}");
            let tip = DVec2::from_angle(turn) * 3.0;
            let near = area.rings[0]
                .iter()
                .map(|p| p.distance(tip))
                .fold(f64::INFINITY, f64::min);
            assert!(near < ACCURACY, "{degrees} {turn}: {near}");
        }
    }
}

/// A wall, a slit and a pin are thinner than the lattice's spacing.
#[test]
fn what_is_thinner_than_the_lattice_is_found() {
    let (x, y, _) = Tree::axes();
    for spacing in [0.4, 1.0] {
        for turn in [0.0_f32, 0.3] {
            let u = x.clone() * turn.cos() + y.clone() * turn.sin();
            let v = y.clone() * turn.cos() - x.clone() * turn.sin();
            let wall = (u.abs() - 0.1).max(v.abs() - 6.0);
            let slit = ((u.abs() - 6.0).max(v.abs() - 6.0))
                .max(0.1 - (u.clone() - 0.3).abs());
            let pin = (u.square() + v.square()).sqrt() - 0.1;
            let slice = |f| spaced(f, 9.0, &[0.0], spacing).remove(0);
            for (f, rings, content) in [
                (&wall, 1, 2.4),
                (&slit, 2, 144.0 - 2.4),
                (&pin, 1, 0.01 * std::f64::consts::PI),
            ] {
                let o = slice(f);
                let found = o.area.content();
                assert_eq!(o.forced_rings, 0);
                assert_eq!(o.area.rings.len(), rings, "{spacing} {turn}");
                // The tolerance is the perimeter times the accuracy.
                let tolerance = ACCURACY * o.area.perimeter();
                assert!(
                    (found - content).abs() < tolerance,
                    "{spacing} {turn}: {found}"
                );
            }
        }
    }
}

/// A crack that the samples show in pieces only is not a string of holes.
#[test]
fn cracks_thinner_than_the_accuracy_are_left_out() {
    let (x, y, _) = Tree::axes();
    let block = (x.abs() - 5.0).max(y.abs() - 2.0);
    // The crack is 2 µm wide, and less than 0.01 off the rows of the lattice.
    let crack = (y.clone() + x.clone() * 0.009).abs() - 0.001;
    let o = spaced(&block.max(-crack), 6.0, &[0.0], 0.1).remove(0);
    assert_eq!(o.area.rings.len(), 1);
    assert!(o.dropped_rings > 0);
}

/// The outlines of a slab may take only so much memory.
#[test]
fn slabs_of_large_parts_have_fewer_layers() {
    let layers = |half: f64| {
        let bounds = Rect::new(DVec2::splat(-half), DVec2::splat(half));
        let field = Field::new(&Tree::x(), 0.0, bounds, 0.1).unwrap();
        field.slab_layers()
    };
    assert_eq!(layers(10.0), 32);
    // The layer has 600 × 600 cells and a border; the slab has eight of them.
    assert_eq!(layers(30.0), 8);
    assert_eq!(layers(150.0), 1);
}

/// A plate is level from its lowest layer to its highest one, and its layers are
/// the same whether they are found together or one by one. A cone is not level.
#[test]
fn layers_that_are_alike_are_known_and_found_together() {
    const HALF: f64 = 40.0;
    let (x, y, z) = Tree::axes();
    let heights: Vec<f64> = (0..15).map(|k| 0.1 + 0.2 * f64::from(k)).collect();
    let bounds = Rect::new(DVec2::splat(-HALF), DVec2::splat(HALF));
    let made = |f: Tree| Field::new(&f, 0.0, bounds, 0.1).unwrap();
    let round = (x.square() + y.square()).sqrt();
    let sides = (x.abs() - 39.0)
        .max(y.abs() - 38.5)
        .max(4.0 - round.clone());
    let plate = made(sides.max((z.clone() - 1.5).abs() - 1.5));
    assert!(plate.slab_layers() < heights.len());
    assert!(plate.is_level(&heights).unwrap());
    let all = outlines(&plate, &heights, DETAIL).unwrap();
    for (k, together) in all.iter().enumerate() {
        let alone = outlines(&plate, &heights[k..=k], DETAIL).unwrap();
        assert_eq!(together, &alone[0], "layer {k}");
        assert_eq!(together.area.rings.len(), 2);
    }
    // Above its top a plate is empty, which is no level part.
    assert!(!plate.is_level(&[2.9, 3.1]).unwrap());
    assert!(!made(round - 30.0 + z).is_level(&heights).unwrap());
    assert!(!plate.is_level(&[0.1; 33]).unwrap(), "more than a slab");
}

/// Two discs have a lens in common, once as a part and once as a slit. Its tips
/// have an angle of a few degrees. They are in the right places however coarse
/// the lattice and the lines are.
#[test]
fn tips_of_lenses_reach_their_ends_at_any_accuracy() {
    const RADIUS: f64 = 20.0;
    let (x, y, z) = Tree::axes();
    let bounds = Rect::new(DVec2::splat(-5.0), DVec2::splat(5.0));
    let check = |f: &Tree, tips: [DVec2; 2], case: &str| {
        for accuracy in [0.001, 0.002, 0.003, 0.005, 0.007, 0.01, 0.02, 0.03] {
            for spacing in [0.1, 0.2] {
                let smallest = 0.11;
                let detail = Detail { accuracy, smallest };
                let field = Field::new(f, 0.0, bounds, spacing).unwrap();
                let o = outlines(&field, &[0.0], detail).unwrap().remove(0);
                for tip in tips {
                    let points = o.area.rings.iter().flatten();
                    let near = points
                        .map(|p| p.distance(tip))
                        .fold(f64::INFINITY, f64::min);
                    let case = format!("{case}, {accuracy}, {spacing}");
                    assert!(near < 0.02, "{case}: {near}");
                }
            }
        }
    };
    for degrees in [7.0_f64, 12.0] {
        // The first number is half the distance of the discs' centres, the
        // second half the lens's length.
        let half = (degrees / 2.0).to_radians();
        let (away, reach) = (RADIUS * half.cos(), RADIUS * half.sin());
        for k in 0..12 {
            let turn = DVec2::from_angle(0.1 + 0.53 * f64::from(k));
            let shift = DVec2::new(0.013, 0.037) * f64::from(k);
            let disc = |side: f64| {
                let c = shift + turn.perp() * (side * away);
                let (u, v) = (x.clone() - c.x as f32, y.clone() - c.y as f32);
                (u.square() + v.square()).sqrt() - RADIUS as f32
            };
            let lens = disc(1.0).max(disc(-1.0));
            let block = (x.clone().abs() - 4.0).max(y.clone().abs() - 4.0);
            let slit = block.max(-lens.clone()).max(z.abs() - 5.0);
            let tips = [shift - turn * reach, shift + turn * reach];
            check(&lens.max(z.abs() - 5.0), tips, &format!("{degrees} {k}"));
            check(&slit, tips, &format!("slit of {degrees} {k}"));
        }
    }
}

/// A prism of a square with the sides 2 `half`, from one height to another.
fn prism(half: f32, low: f32, high: f32) -> Tree {
    let (x, y, z) = Tree::axes();
    let side = x.abs().max(y.abs()) - half;
    side.max(low - z.clone()).max(z - high)
}

/// Content of an outline that has no faults.
fn content(outline: &Outline) -> f64 {
    assert_eq!((outline.forced_rings, outline.nan_samples), (0, 0));
    let rings = outline.area.rings.iter();
    rings.map(|r| isocontour::plane::signed_area(r)).sum()
}

/// The layer has what is just below its plane or just above it. Multiples of
/// the fields have other roundings in the plane.
#[test]
fn planes_in_level_faces_have_what_is_above_or_below() {
    for (level, factor) in [
        (4.5, 1.0),
        (4.7, 1.0),
        (4.7, 1.1),
        (128.9, 0.3),
        (-0.1, 1e-3),
    ] {
        let part = |half: f32, low: f32, high: f32| {
            prism(half, level + low, level + high) * factor
        };
        let (wide, narrow) = (part(5.0, -3.0, 0.0), part(3.0, 0.0, 3.0));
        let whole = part(5.0, -3.0, 3.0);
        let lid = part(3.0, 0.0, 9.0);
        for (tree, expected) in [
            (wide.min(narrow.clone()), 100.0),
            (narrow.clone(), 36.0),
            (part(3.0, -3.0, 0.0), 36.0),
            // A pocket with its floor in the plane, and a cover of no
            // thickness, which is what a difference leaves.
            (whole.max(-lid), 100.0),
            (part(3.0, 0.0, 3.0).max(-narrow), 0.0),
        ] {
            let z = [level - 0.2, level, level + 0.2].map(f64::from);
            let outlines = slice_with(&tree, 6.0, &z);
            let found = content(&outlines[1]);
            assert!(
                (found - expected).abs() < 0.01,
                "{level} {factor}: {found} for {expected}"
            );
        }
    }
}

/// Two halves of a ring that is thinner than the lattice's cells are wide.
#[test]
fn a_thin_ring_cut_in_two_keeps_the_layer_of_the_cut() {
    let (x, y, z) = Tree::axes();
    let ring = ((x.square() + y.square()).sqrt() - 5.0).abs() - 0.2;
    let cut = z.clone() - 2.3;
    let halves = ring.max(cut.clone()).min(ring.max(-cut));
    let found = content(&spaced(&halves, 6.0, &[2.3], 0.5)[0]);
    let exact = std::f64::consts::TAU * 5.0 * 0.4;
    assert!((found - exact).abs() < 0.03, "{found} for {exact}");
}

/// Faces that are level only as the part is turned: what f32 makes of them is
/// noise.
#[test]
fn level_faces_of_turned_bodies_are_seen_through_noise() {
    let (x, y, z) = Tree::axes();
    let (s, c) = (30.0_f32).to_radians().sin_cos();
    let v = y.clone() * c + z.clone() * s;
    let w = z.clone() * c - y.clone() * s;
    let turned = v.clone() * s + w.clone() * c - 2.1;
    let box_ = x.abs().max((v.clone() * c - w * s).abs()) - 4.0;
    let body = box_.max(z.abs() - 5.0);
    let halves = body.max(turned.clone()).min(body.max(-turned * 0.7));
    let found = content(&slice_with(&halves, 5.0, &[2.1])[0]);
    assert!((found - 64.0).abs() < 0.01, "{found}");
}

/// The border of what is below zero is followed, not a place where the field
/// is zero.
#[test]
fn fields_that_are_zero_outside_end_where_they_are_negative() {
    let (x, y, z) = Tree::axes();
    let disc = (x.square() + y.square()).sqrt() - 3.03;
    let zero = disc.min(0.0);
    let within = prism(4.0, -2.0, 2.0);
    let pi = std::f64::consts::PI;
    let circle = pi * 3.03 * 3.03;
    let cube = (x.clone() + 1.5).abs().max((y + 1.5).abs()).max(z.abs()) - 1.0;
    for (tree, expected) in [
        (zero.max(within.clone()), circle),
        (cube.min(0.0), 4.0),
        (-cube.clone().neg().max(0.0).square(), 4.0),
        ((cube.clone() - cube.abs()) * 1e3, 4.0),
        // A hole in which the field is zero.
        (within.min(0.0).max(-(disc.max(0.0))), 64.0 - circle),
    ] {
        for height in [0.0, 0.3] {
            let outline = &slice_with(&tree, 5.0, &[height])[0];
            let found = content(outline);
            assert!(
                (found - expected).abs() < 0.02,
                "{height}: {found} for {expected}"
            );
        }
    }
}

/// Menger's sponge of two levels, by the usual loop over crosses that repeat.
fn sponge(half: f32) -> Tree {
    let axes: [Tree; 3] = Tree::axes().into();
    let p = axes.map(|a| a / half);
    let cube = |p: [Tree; 3]| p.map(|a| a.abs() - 1.0);
    let max = |[a, b, c]: [Tree; 3]| a.max(b).max(c);
    let mut sponge = max(cube(p.clone()));
    let mut scale = 1.0;
    for _ in 0..2 {
        let r = p.clone().map(|a| {
            let a = (a * scale).modulo(2.0) - 1.0;
            (1.0 - a.abs() * 3.0).abs()
        });
        scale *= 3.0;
        let [a, b, c] = r;
        let bars = [a.max(b.clone()), b.max(c.clone()), c.max(a)];
        let [a, b, c] = bars;
        sponge = sponge.max((a.min(b).min(c) - 1.0) / scale);
    }
    sponge * half
}

/// The faces of all the sponge's holes, some of which lie on the planes at
/// which the repetition jumps.
#[test]
fn layers_in_the_faces_of_a_sponge_have_what_is_above_or_below() {
    const ACROSS: usize = 9;
    let is_solid = |at: [usize; 3]| {
        [1, 3].iter().all(|unit| {
            let middle = |i: &&usize| **i / unit % 3 == 1;
            at.iter().filter(middle).count() < 2
        })
    };
    for half in [4.5_f32, 6.75, 5.0] {
        let tree = sponge(half);
        let cell = 2.0 * f64::from(half) / ACROSS as f64;
        for k in 1..ACROSS {
            let z = k as f64 * cell - f64::from(half);
            let count = (0..ACROSS * ACROSS).filter(|n| {
                let (i, j) = (n % ACROSS, n / ACROSS);
                is_solid([i, j, k - 1]) || is_solid([i, j, k])
            });
            let exact = count.count() as f64 * cell * cell;
            let outline = &slice_with(&tree, f64::from(half), &[z])[0];
            let found = content(outline);
            assert!((found - exact).abs() < 0.02, "{z}: {found} for {exact}");
        }
    }
}

/// A square prism, and beside it a cone of which no two layers are alike.
#[test]
fn layers_of_a_prism_share_samples_and_outline() {
    let (x, y, z) = Tree::axes();
    let square = x.abs().max(y.abs()) - 5.0;
    let prism = square.max(z.abs() - 6.55);
    let from_axis = ((x - 12.0).square() + y.square()).sqrt();
    let cone = from_axis - 3.0 + z * 0.3;
    let heights: Vec<f64> = (0..32).map(|k| 0.1 + 0.2 * f64::from(k)).collect();
    for (tree, most) in [(prism.clone(), 1.0 / 32.0), (prism.min(cone), 0.6)] {
        let bounds = Rect::new(DVec2::splat(-16.0), DVec2::splat(16.0));
        let field = Field::new(&tree, 0.0, bounds, 0.1).unwrap();
        let (mut sampled, mut all) = (0, 0);
        field
            .slab(&heights, &mut |batch| {
                sampled += batch.leaves.len();
                all += batch.leaves.len() * batch.span;
                Ok(())
            })
            .unwrap();
        let share = sampled as f64 / all as f64;
        assert!(share <= most, "{share}");
        let together = outlines(&field, &heights, DETAIL).unwrap();
        assert_eq!(together.len(), heights.len());
        for (outline, &z) in together.iter().zip(&heights) {
            assert_eq!(*outline, slice_with(&tree, 16.0, &[z])[0], "{z}");
        }
    }
}

/// A face lies in each of two layers, and beside the lower one there is a prism that
/// ends right above it.
#[test]
fn faces_in_two_layers_do_not_depend_on_each_other() {
    let (x, y, z) = Tree::axes();
    let to = |top: f32| (z.clone() - top).max(-z.clone());
    let waves = (x.clone() * 1.3 + y.clone() * 0.2).sin();
    let waves = waves * (y.clone() * 1.1).sin() + 0.15;
    let waves = waves.max(x.abs() - 12.0).max(y.abs() - 12.0).max(to(1.12));
    let disc = |at: f32, top: f32| {
        let from_axis = ((x.clone() - at).square() + y.square()).sqrt();
        (from_axis - 2.0).max(to(top))
    };
    let tree = waves.min(disc(15.5, 1.1)).min(disc(-15.5, 5.1));
    let bounds = Rect::new(DVec2::splat(-20.0), DVec2::splat(20.0));
    let field = Field::new(&tree, 0.0, bounds, 0.1).unwrap();
    let heights: Vec<f64> = (0..32).map(|k| 0.1 + 0.2 * f64::from(k)).collect();
    let found = |needed: std::ops::Range<usize>| {
        let begins = &mut |_| {};
        outlines_in_phases(&field, &heights, &needed, DETAIL, begins).unwrap()
    };
    let all = found(0..32);
    for k in [5, 25] {
        assert!(found(k..k + 1)[k] == all[k], "{k}");
    }
}

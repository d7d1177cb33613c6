use super::*;
use fidget::context::Tree;

fn program(tree: &Tree) -> Program {
    let mut context = Context::new();
    let root = context.import(tree);
    Program::new(&context, root).unwrap()
}

/// A field that uses every kind of operation with a slope.
fn mixture() -> Tree {
    let (x, y, z) = Tree::axes();
    let ball = (x.square() + y.square() + z.square()).sqrt() - 3.0;
    let wave = (x.clone() * 2.0).sin() * y.cos() + z.atan();
    let smooth = (ball.clone() * -2.0).exp() + (wave.clone()).exp();
    let angle = y.atan2(x.clone() + 10.0);
    let cells = (x.clone() + 0.3).modulo(1.5) + (y.clone() / 7.0).tan();
    ball.max(wave.abs() - 0.4)
        .min(smooth.ln() / (z.abs() + 1.0))
        .max(angle - cells.recip())
        .min(blended())
}

/// Soft unions in places where both parts count, one, or none.
fn blended() -> Tree {
    let (x, y, z) = Tree::axes();
    let soft = |a: Tree, b: Tree, radius: f32| {
        let near = (radius - (a.clone() - b.clone()).abs()).max(0.0);
        a.min(b) - 1.0 / (4.0 * radius) * near.square()
    };
    let a = soft(x.clone() * y.clone(), z.sin() * 2.0, 0.6);
    let b = soft(a.clone() + x, y.square() - 1.0, 1.5);
    soft(a, b, 0.25)
}

#[test]
fn enclosures_hold_samples_of_value() {
    let p = program(&mixture());
    let mut scratch = Scratch::default();
    let mut rng = fastrand::Rng::with_seed(7);
    let mut random = || rng.f64();
    for _ in 0..500 {
        let size = 4.0 * random() * random();
        let lo: [f64; 3] = std::array::from_fn(|_| 8.0 * random() - 4.0);
        let hi = lo.map(|v| v + size);
        let cell = Cell { lo, hi };
        let all = p.enclose(&cell, &mut scratch);
        let simple = p.simplify(&scratch);
        for _ in 0..20 {
            let point: [f64; 3] =
                std::array::from_fn(|i| lo[i] + random() * size);
            let v = p.value(point, &mut scratch);
            if let Some(simple) = &simple {
                let w = simple.value(point, &mut scratch);
                assert_eq!(v < 0.0, w < 0.0, "{v} became {w}");
            }
            if v.is_nan() {
                assert!(all.range.nan);
            } else {
                assert!(
                    all.range.lo - 1e-9 <= v && v <= all.range.hi + 1e-9,
                    "{v} is not in {all:?} over {cell:?}"
                );
            }
        }
    }
}

/// A field that jumps in every way there is.
fn jumps() -> Tree {
    let (x, y, z) = Tree::axes();
    let angle = y.atan2(x.clone());
    let cells = (angle.clone() + x.clone()).modulo(0.7) - 0.3;
    let steps = (x.clone() * 2.0).floor() + (y.clone() + z.clone()).ceil();
    let rounded = (z.clone() * 1.7 - y.clone()).round() * 0.4;
    let poles = (x.clone() + y.clone()).recip() + (z.clone() * 2.0).tan();
    let sides = x.compare(y.clone() * z) * 0.5 + (y - 0.2) / (x + 0.3);
    (cells + angle * 0.1)
        .max(poles)
        .min(steps + rounded + sides)
}

#[test]
fn pieces_hold_all_that_the_whole_has() {
    let p = program(&jumps());
    let mut scratch = Scratch::default();
    let mut rng = fastrand::Rng::with_seed(3);
    let mut random = || rng.f64();
    let (mut divided, mut sectors) = (0, 0);
    for k in 0..300 {
        let size = random() * random();
        let mut lo: [f64; 3] = std::array::from_fn(|_| 4.0 * random() - 2.0);
        // Every third box is on the z axis, where all angles meet.
        if k % 3 == 0 {
            lo[..2].fill_with(|| -size * random());
        }
        let cell = Cell {
            lo,
            hi: lo.map(|v| v + size),
        };
        // All choices of pieces for the steps that jump, each with what is left
        // of the box.
        let mut parts = Vec::new();
        let mut todo = vec![p.clone()];
        while let Some(part) = todo.pop() {
            let f = part.enclose(&cell, &mut scratch);
            let left = part.contracted(&cell, &scratch);
            let mut by_pieces = part.by_pieces(&scratch);
            divided += by_pieces.len();
            if by_pieces.is_empty() {
                by_pieces = part.by_sectors(&scratch);
                sectors += by_pieces.len();
            }
            let simple = part.simplify(&scratch).unwrap_or(part.clone());
            if by_pieces.is_empty() {
                parts.push((part, simple, f, left));
            }
            todo.extend(by_pieces);
        }
        for _ in 0..20 {
            let point: [f64; 3] =
                std::array::from_fn(|i| lo[i] + random() * size);
            let v = p.value(point, &mut scratch);
            let mut found = 0;
            for (part, simple, f, left) in &parts {
                let w = part.value(point, &mut scratch);
                if w.is_nan() {
                    continue;
                }
                found += 1;
                assert_eq!(v, w);
                let s = simple.value(point, &mut scratch);
                assert_eq!(v < 0.0, s < 0.0, "{v} became {s}");
                assert!(
                    f.range.lo - 1e-9 <= v && v <= f.range.hi + 1e-9,
                    "{v} is not in {f:?} over {cell:?}"
                );
                let held =
                    |i: usize| left.lo[i] <= point[i] && point[i] <= left.hi[i];
                assert!((0..3).all(held));
            }
            assert_eq!(found, 1, "{point:?} is in {found} of the pieces");
        }
    }
    assert!(divided > 1000, "{divided}");
    assert!(sectors > 1000, "{sectors}");
}

#[test]
fn a_turned_plane_is_enclosed_exactly() {
    let (x, y, _) = Tree::axes();
    let p = program(&(x * 0.5 + y * 0.25));
    let cell = Cell {
        lo: [0.0; 3],
        hi: [1.0; 3],
    };
    let all = p.enclose(&cell, &mut Scratch::default());
    assert_eq!((all.range.lo, all.range.hi), (0.0, 0.75));
    assert_eq!(all.steepness, [0.5, 0.25, 0.0]);
}

#[test]
fn the_centred_form_shrinks_with_the_square_of_the_box() {
    // x·x - 2x + 1 is (x - 1)². The error of its natural range is linear in the
    // box.
    let (x, _, _) = Tree::axes();
    let p = program(&(x.clone() * x.clone() - x * 2.0 + 1.0));
    let cell = Cell {
        lo: [0.999, 0.0, 0.0],
        hi: [1.001, 0.0, 0.0],
    };
    let all = p.enclose(&cell, &mut Scratch::default());
    assert!(all.range.lo > -1e-5, "{:?}", all.range);
}

#[test]
fn simplify_drops_the_far_body() {
    let (x, y, z) = Tree::axes();
    let r = y.square() + z.square();
    let near = ((x.clone() + 10.0).square() + r.clone()).sqrt() - 1.0;
    let far = ((x - 10.0).square() + r).sqrt() - 1.0;
    let p = program(&near.min(far));
    let mut scratch = Scratch::default();
    let cell = Cell {
        lo: [-12.0, -1.0, -1.0],
        hi: [-8.0, 1.0, 1.0],
    };
    p.enclose(&cell, &mut scratch);
    let simple = p.simplify(&scratch).unwrap();
    assert!(simple.len() < p.len());
}

#[test]
fn operands_out_of_range_are_not_shown_in_range() {
    let why = |tree: Tree| {
        let found = program(&tree).why_nan([0.0; 3], &mut Scratch::default());
        found.unwrap()
    };
    let x = Tree::x();
    assert!(why((x.clone() - 1e-5).sqrt()).contains("root of -1.000e-5"));
    assert!(why((x.clone() + 1.0001).asin()).contains("sine of 1.0001"));
    assert!(why((x - 4.0).ln()).contains("logarithm of -4 "));
}

/// Each angle of a box on the side on which they all jump doubles the programs.
#[test]
fn a_few_angles_that_jump_are_looked_at_on_both_sides_and_no_more() {
    let (x, y, _) = Tree::axes();
    let cell = Cell {
        lo: [-3.0, -0.5, 0.0],
        hi: [-2.0, 0.5, 1.0],
    };
    for (count, sides) in [(0, 1), (1, 2), (2, 4), (3, 1), (30, 1)] {
        let angle = |k: u8| y.atan2(x.clone() * (1.0 + 0.1 * f32::from(k)));
        let sum = (0..count).map(angle).fold(x.clone(), |a, b| a + b);
        let mut scratch = Scratch::default();
        let (mut todo, mut found) = (vec![program(&sum)], 0);
        while let Some(part) = todo.pop() {
            part.enclose(&cell, &mut scratch);
            let more = part.by_upright_turns(&scratch);
            found += usize::from(more.is_empty());
            todo.extend(more);
        }
        assert_eq!(found, sides, "{count}");
    }
}

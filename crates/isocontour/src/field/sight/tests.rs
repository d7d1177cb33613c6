use super::*;
use crate::Bounds;
use crate::data::{Data, call};
use glam::DVec3;
use std::sync::Arc;

/// Samples everything.
fn dense(tree: &Tree, grid: &Grid) -> Vec<Option<usize>> {
    let mut ctx = Context::new();
    let root = ctx.import(tree);
    let [width, height, depth] = grid.size;
    let inside = |i: usize, j: usize, k: usize| {
        let [x, y, z] = (grid.origin
            + grid.steps[0] * i as f64
            + grid.steps[1] * j as f64
            + grid.steps[2] * k as f64)
            .to_array()
            .map(|c| c as f32);
        ctx.eval_xyz(root, x, y, z).unwrap() < 0.0
    };
    (0..width * height)
        .map(|n| (0..depth).rev().find(|&k| inside(n % width, n / width, k)))
        .collect()
}

#[test]
fn what_is_met_is_what_all_samples_say() {
    let (x, y, z) = Tree::axes();
    let wave = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
    let ball = x.square() + y.square() + z.square() - 30.0;
    let nowhere = x.clone() * 0.0 - (x.clone() - 9.0).sqrt();
    let shapes = [
        wave.max(ball.clone()),
        ball.clone().max(nowhere.neg()),
        // The field is NaN in half of space.
        ball.clone().max(x.sqrt().neg()),
        Tree::constant(-1.0),
        Tree::constant(1.0),
    ];
    let turn = glam::DMat3::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2);
    let steps = turn.to_cols_array_2d().map(|c| DVec3::from_array(c) * 0.19);
    // The grid is neither whole tiles nor whole boxes.
    let size = [69, 75, 90];
    let half: DVec3 = (0..3).map(|a| steps[a] * (0.5 * size[a] as f64)).sum();
    let grid = Grid {
        origin: -half,
        steps,
        size,
    };
    for (n, tree) in shapes.iter().enumerate() {
        let found = Sight::new(tree).unwrap().look(&grid).unwrap();
        let expected = dense(tree, &grid);
        assert_eq!(found.len(), expected.len());
        let mut other = 0;
        for (hit, sample) in found.iter().zip(&expected) {
            let same = match (hit, sample) {
                (None, None) => true,
                (Some(h), Some(k)) => {
                    let k = *k as f32;
                    (k..=k + 1.0).contains(&h.depth)
                }
                _ => false,
            };
            other += usize::from(!same);
        }
        // Sines may differ in the last bit.
        assert!(other <= 2, "shape {n}: {other}");
    }
}

/// On a ball the surface is known, and so is its gradient.
#[test]
fn surfaces_are_found_between_the_samples() {
    let (x, y, z) = Tree::axes();
    let ball = (x.square() + y.square() + z.square()).sqrt() - 5.0;
    let step = 0.25;
    let n = 50;
    let grid = Grid {
        origin: DVec3::splat(-0.5 * step * n as f64 + 0.01),
        steps: [DVec3::X * step, DVec3::Z * step, DVec3::NEG_Y * step],
        size: [n, n, n],
    };
    let grid = Grid {
        origin: grid.origin + DVec3::Y * (step * n as f64),
        ..grid
    };
    let found = Sight::new(&ball).unwrap().look(&grid).unwrap();
    let mut count = 0;
    for (line, hit) in found.iter().enumerate() {
        let Some(hit) = hit else { continue };
        let p = grid.origin
            + grid.steps[0] * (line % n) as f64
            + grid.steps[1] * (line / n) as f64
            + grid.steps[2] * f64::from(hit.depth);
        // Only places that are not seen too flat count.
        if p.y < -2.5 {
            assert!((p.length() - 5.0).abs() < 0.01, "{p}");
            let off = hit.gradient.as_dvec3() - p / 5.0;
            assert!(off.length() < 0.06, "{off} at {p}");
            count += 1;
        }
    }
    assert!(count > 800, "{count}");
}

/// Beside an edge the nearest face may be one that nobody sees.
#[test]
fn what_is_seen_faces_the_viewer() {
    let (x, y, z) = Tree::axes();
    let [x, y, z] = [(x, 6.0), (y, 4.0), (z, 2.0)].map(|(c, h)| c.abs() - h);
    let block = x.max(y).max(z);
    let right = DVec3::new(1.0, 1.0, 0.0).normalize();
    let towards = DVec3::new(1.0, -1.0, 1.0).normalize();
    let steps = [right, right.cross(towards), towards].map(|d| 0.17 * d);
    let size = [90, 90, 90];
    let half: DVec3 = (0..3).map(|a| steps[a] * (0.5 * size[a] as f64)).sum();
    let grid = Grid {
        origin: -half,
        steps,
        size,
    };
    let hits = Sight::new(&block).unwrap().look(&grid).unwrap();
    let mut count = 0;
    for (line, hit) in hits.iter().enumerate() {
        let Some(hit) = hit else { continue };
        let p = grid.origin
            + steps[0] * (line % size[0]) as f64
            + steps[1] * (line / size[0]) as f64
            + steps[2] * f64::from(hit.depth);
        let faces = hit.gradient.as_dvec3().dot(towards);
        assert!(faces > 0.0, "{} at {p}", hit.gradient);
        count += 1;
    }
    assert!(count > 2000, "{count}");
}

/// Lines that are not wanted change nothing for the others.
#[test]
fn some_lines_meet_what_all_lines_meet() {
    let (x, y, z) = Tree::axes();
    let wave = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
    let part = wave.max(x.square() + y.square() + z.square() - 30.0);
    let step = 0.09;
    let size = [131, 140, 135];
    let grid = Grid {
        origin: DVec3::splat(-0.5 * step * 135.0),
        steps: [DVec3::X * step, DVec3::Z * step, DVec3::NEG_Y * step],
        size,
    };
    let sight = Sight::new(&part).unwrap();
    let all = sight.look(&grid).unwrap();
    for wanted in [
        |i: usize, j: usize| i / 4 % 3 == 1 && (j / 4).is_multiple_of(2),
        |i: usize, j: usize| i > 90 && j < 20,
        |_, _| false,
    ] {
        let mut some = Vec::new();
        let mut add = |row: &[Option<Hit>]| some.extend_from_slice(row);
        let mask = |i: usize, j: usize| {
            let bits = (0..64).filter(|k| wanted(i + k, j));
            bits.fold(0, |mask, k| mask | 1u64 << k)
        };
        sight.look_by_rows(&grid, &mask, &mut add).unwrap();
        assert_eq!(some.len(), all.len());
        for (k, (some, all)) in some.iter().zip(&all).enumerate() {
            let is = wanted(k % size[0], k / size[0]);
            assert_eq!(*some, all.filter(|_| is), "{k}");
        }
    }
}

#[test]
fn a_look_has_its_limit() {
    let (x, y, z) = Tree::axes();
    let ball = (x.square() + y.square() + z.square()).sqrt() - 5.0;
    let grid = Grid {
        origin: DVec3::splat(-6.0),
        steps: [DVec3::X * 0.1, DVec3::Z * 0.1, DVec3::Y * 0.1],
        size: [120; 3],
    };
    let look = |most| Sight::new(&ball).unwrap().at_most(most).look(&grid);
    assert!(look(u64::MAX).is_ok());
    for _ in 0..3 {
        let error = look(100_000).unwrap_err();
        assert!(matches!(error, FieldError::Costly { most: 100_000 }));
    }
}

/// A ball that counts how often it is asked.
#[derive(Debug, Default)]
struct Ball(AtomicU64);

impl Data for Ball {
    fn name(&self) -> &str {
        "ball"
    }

    fn at(&self, p: DVec3) -> (f64, DVec3) {
        self.0.fetch_add(1, Ordering::Relaxed);
        (p.length() - 2.0, p.normalize_or_zero())
    }

    fn range(&self, over: &Bounds) -> [f64; 2] {
        self.0.fetch_add(1, Ordering::Relaxed);
        let near = DVec3::ZERO.clamp(over.min, over.max);
        let far = over.min.abs().max(over.max.abs());
        [near.length() - 2.0, far.length() - 2.0]
    }

    fn slopes(&self, _: &Bounds) -> [[f64; 2]; 3] {
        [[-1.0, 1.0]; 3]
    }

    fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        tell(b"ball");
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}

/// How often data is asked where so many copies of it stand side by side.
fn asked(copies: usize) -> u64 {
    let ball = Arc::new(Ball::default());
    let data: Arc<dyn Data> = ball.clone();
    let (x, y, z) = Tree::axes();
    let apart = 6.0;
    let all = (0..copies).map(|k| {
        let moved = x.clone() - (apart * k as f64) as f32;
        call(&data, [moved, y.clone(), z.clone()])
    });
    let all = all.reduce(|all, one| all.min(one)).unwrap();
    let step = 0.1;
    let grid = Grid {
        origin: DVec3::splat(-3.0),
        steps: [DVec3::X * step, DVec3::Y * step, DVec3::Z * step],
        size: [(apart / step) as usize * copies, 60, 60],
    };
    let hits = Sight::new(&all).unwrap().look(&grid).unwrap();
    let met = hits.iter().filter(|hit| hit.is_some()).count();
    assert!(met > 1100 * copies, "{met}");
    ball.0.load(Ordering::Relaxed)
}

/// A plate of copies asks each of them where it may be seen, and not all of them
/// everywhere.
#[test]
fn only_data_that_may_be_seen_is_asked() {
    let (one, many) = (asked(1), asked(16));
    assert!(many < 16 * 2 * one, "{one} {many}");
}

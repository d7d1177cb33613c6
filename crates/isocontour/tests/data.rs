//! Data as a leaf of expressions: what comes out is what comes out for the same
//! function as an expression.

use fidget::context::Tree;
use fidget::var::Var;
use glam::{DVec2, DVec3};
use isocontour::{
    Bounds, Cancel, Data, Detail, ExpandError, Field, Grid, LeanOptions, Rect,
    SearchOptions, Sight, Values, call, data_of, expand, find_bounds, lean,
    outlines, shifted,
};
use std::sync::Arc;

/// A ball's distance, as data.
struct Ball(f64);

impl Data for Ball {
    fn name(&self) -> &str {
        "ball"
    }

    fn at(&self, p: DVec3) -> (f64, DVec3) {
        (p.length() - self.0, p.normalize_or_zero())
    }

    fn range(&self, over: &Bounds) -> [f64; 2] {
        let near = DVec3::ZERO.clamp(over.min, over.max);
        let far = over.min.abs().max(over.max.abs());
        [near.length() - self.0, far.length() - self.0]
    }

    fn slopes(&self, _: &Bounds) -> [[f64; 2]; 3] {
        [[-1.0, 1.0]; 3]
    }

    fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        tell(&self.0.to_le_bytes());
    }

    fn bytes(&self) -> usize {
        size_of::<f64>()
    }
}

fn axes() -> [Tree; 3] {
    let (x, y, z) = Tree::axes();
    [x, y, z]
}

fn ball(r: f32) -> Tree {
    let [x, y, z] = axes();
    (x.square() + y.square() + z.square()).sqrt() - r
}

/// Expressions made of a ball of radius 5.
fn uses(ball: &Tree) -> Vec<Tree> {
    let [x, y, z] = axes();
    let of = |x: Tree, y: Tree, z: Tree| ball.remap_xyz(x, y, z);
    let wave = x.clone().sin() * y.cos() + y.sin() * z.cos();
    vec![
        ball.clone(),
        of(x.clone() - 1.5, y.clone() * 2.0, z.clone() + 0.25),
        of(x.modulo(3.0) - 1.5, y.clone(), z.clone()).max(ball.clone()),
        of(x.clone() + 1.0, y.clone(), z.clone()).min(of(
            y.clone() - 2.0,
            z.clone(),
            x.clone(),
        )),
        (ball.clone() + wave.clone() * 0.3).max(wave - 0.8),
        // Of the distance from one ball the distance from another is made.
        of(ball.clone(), y.clone() * 0.5, z.clone() * 0.5).max(ball.clone()),
        ball.clone().abs() - 0.4,
    ]
}

fn pairs() -> (Arc<dyn Data>, Vec<(Tree, Tree)>) {
    let data: Arc<dyn Data> = Arc::new(Ball(5.0));
    let both = uses(&call(&data, axes())).into_iter();
    let both = both.zip(uses(&ball(5.0))).collect();
    (data, both)
}

#[test]
fn outlines_are_those_of_the_expression() {
    let (_data, pairs) = pairs();
    let detail = Detail {
        accuracy: 0.002,
        smallest: 0.1,
    };
    let bounds = Rect::new(DVec2::splat(-12.0), DVec2::splat(12.0));
    let heights = [-3.0, 0.1, 0.5, 2.0, 4.5];
    for (n, (data, expression)) in pairs.iter().enumerate() {
        let of = |tree: &Tree| {
            let field = Field::new(tree, 0.0, bounds, 0.25).unwrap();
            outlines(&field, &heights, detail).unwrap()
        };
        let area = |rings: &[Vec<DVec2>]| -> f64 {
            let twice = |r: &Vec<DVec2>| {
                let next = r.iter().cycle().skip(1);
                r.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
            };
            rings.iter().map(twice).sum()
        };
        for (a, b) in of(data).iter().zip(of(expression)) {
            let [a, b] = [&a.area.rings, &b.area.rings];
            assert_eq!(a.len(), b.len(), "{n}");
            let length: usize = b.iter().map(Vec::len).sum();
            let off = (area(a) - area(b)).abs();
            assert!(off <= 0.002 * (length + 1) as f64, "{n}: {off}");
        }
    }
}

#[test]
fn bounds_are_those_of_the_expression() {
    let (_data, pairs) = pairs();
    for (n, (data, expression)) in pairs.iter().enumerate() {
        let of = |tree: &Tree| {
            let options = SearchOptions::default();
            find_bounds(tree, &options, &Cancel::NEVER).unwrap().bounds
        };
        let (a, b) = (of(data), of(expression));
        let off = (a.min - b.min).abs().max((a.max - b.max).abs());
        assert!(off.max_element() < 0.01, "{n}: {a:?}, {b:?}");
    }
}

#[test]
fn a_look_and_the_lean_are_those_of_the_expression() {
    let (_data, pairs) = pairs();
    let grid = Grid {
        origin: DVec3::splat(-6.0),
        steps: [DVec3::X * 0.2, DVec3::Y * 0.2, DVec3::Z * 0.2],
        size: [60; 3],
    };
    let within = Bounds {
        min: DVec3::splat(-6.0),
        max: DVec3::splat(6.0),
    };
    let options = LeanOptions {
        bin: 0.1,
        enough: 0.2,
        most: 0.9,
        tolerance: 0.01,
        bins: (0, usize::MAX),
        max_work: 20_000_000,
    };
    for (n, (data, expression)) in pairs.iter().enumerate() {
        let look = |tree| Sight::new(tree).unwrap().look(&grid).unwrap();
        let mut other = 0;
        for (a, b) in look(data).iter().zip(look(expression)) {
            match (a, b) {
                (Some(a), Some(b)) => {
                    let same = (a.depth - b.depth).abs() < 0.01
                        && a.gradient.distance(b.gradient) < 0.01;
                    other += usize::from(!same);
                }
                (None, None) => {}
                _ => other += 1,
            }
        }
        // Most of these lines graze the part.
        assert!(other <= 36, "{n}: {other} of 3600");
    }
    // Of sums less is known than of the expression.
    for (data, expression) in &pairs[..2] {
        let lean = |tree| {
            lean(tree, &within, &options, &Cancel::NEVER)
                .unwrap()
                .most_level
        };
        for (k, (a, b)) in lean(data).iter().zip(lean(expression)).enumerate() {
            assert!(*a >= b - 0.1, "{k}: {a}, {b}");
        }
    }
}

#[test]
fn values_are_those_of_the_expression_wherever_it_is_moved() {
    let (_data, pairs) = pairs();
    let mut rng = fastrand::Rng::with_seed(3);
    let mut list =
        || -> Vec<f32> { (0..500).map(|_| 14.0 * (rng.f32() - 0.5)).collect() };
    let (x, y, z) = (list(), list(), list());
    let to = DVec3::new(0.5, -2.0, 0.25);
    for (n, (data, expression)) in pairs.iter().enumerate() {
        let of = |tree: &Tree| {
            let mut out = Vec::new();
            let values = Values::new(tree, None).unwrap();
            values.at(&[&x, &y, &z], &mut out).unwrap();
            out
        };
        let moved = shifted(data, to).unwrap();
        let by = to.as_vec3();
        let [u, v, w] = axes();
        let wanted = expression.remap_xyz(u + by.x, v + by.y, w + by.z);
        for (a, b) in [(data, expression), (&moved, &wanted)] {
            for (a, b) in of(a).iter().zip(of(b)) {
                assert!((a - b).abs() < 1e-4, "{n}: {a}, {b}");
            }
        }
    }
}

#[test]
fn a_fourth_variable_may_say_where_data_is_asked() {
    let data: Arc<dyn Data> = Arc::new(Ball(5.0));
    let d = Var::new();
    let [_, y, z] = axes();
    let tree = call(&data, [Tree::from(d), y, z]);
    let values = Values::new(&tree, Some(d)).unwrap();
    assert!(values.depend_on(3) && !values.depend_on(0));
    let mut out = Vec::new();
    values
        .at(&[&[9.0], &[0.0], &[4.0], &[3.0]], &mut out)
        .unwrap();
    assert_eq!(out, [0.0]);
}

/// Each call has the one before it in all of its coordinates: 3³⁰ ways lead to
/// the innermost one, and none is gone twice.
#[test]
fn calls_deep_in_calls_are_looked_at_once() {
    let ball: Arc<dyn Data> = Arc::new(Ball(5.0));
    let [x, y, _] = axes();
    let mut f = call(&ball, [x.clone(), y.clone(), x.clone()]);
    for _ in 0..30 {
        let at = [x.clone(), y.clone(), y.clone()];
        f = call(&ball, at.map(|axis| axis + f.clone() * 0.01));
    }
    let values = Values::new(&f, None).unwrap();
    assert!(values.depend_on(1) && !values.depend_on(2));
    let mut out = Vec::new();
    values.at(&[&[0.0], &[0.0], &[0.0]], &mut out).unwrap();
    assert!(out[0] < 0.0, "{out:?}");
}

#[test]
fn an_expression_does_not_keep_data() {
    let data: Arc<dyn Data> = Arc::new(Ball(5.0));
    let tree = call(&data, axes()) + 1.0;
    assert_eq!(data_of(&tree).len(), 1);
    assert!(expand(&tree).is_ok());
    drop(data);
    assert!(data_of(&tree).is_empty());
    assert_eq!(expand(&tree).err(), Some(ExpandError::FreeVariable));
}

#[test]
fn a_place_of_constants_is_a_place() {
    let data: Arc<dyn Data> = Arc::new(Ball(5.0));
    let number = |v: f32| Tree::constant(v);
    let tree = call(&data, [number(3.0), number(4.0), number(12.0)]);
    let tree = tree.remap_xyz(number(1.0), number(2.0), number(3.0));
    let mut out = Vec::new();
    let values = Values::new(&tree, None).unwrap();
    values.at(&[&[0.0], &[0.0], &[0.0]], &mut out).unwrap();
    assert_eq!(out, [8.0]);
}

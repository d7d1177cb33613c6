//! Outlines of random solids against the `contour` crate, an independent
//! implementation of marching squares. It samples the solids with its own
//! arithmetic.

// A test that cannot go on should say so and stop.
#![allow(clippy::unwrap_used, reason = "helpers of tests may unwrap, too")]

use contour::ContourBuilder;
use fastrand::Rng;
use fidget::context::Tree;
use glam::{DVec2, EulerRot, Mat3, Vec3};
use isocontour::plane::{ring_length, signed_area};
use isocontour::{Detail, Field, Rect, outlines};

/// Half of the side of the box around all solids, mm.
const HALF: f64 = 13.0;
/// Spacing of the field's lattice and of the oracle's coarsest, mm.
const SPACING: f64 = 0.1;
const ACCURACY: f64 = 0.001;
/// Least content of a ring that counts, mm²: two cells of the lattice. In
/// wedges that get ever thinner each lattice leaves different crumbs.
const COUNTED: f64 = 2.0 * SPACING * SPACING;

#[derive(Clone, Copy, Debug)]
enum ShapeKind {
    Ball,
    Block,
    Cylinder,
}

#[derive(Clone, Copy, Debug)]
struct Shape {
    kind: ShapeKind,
    turn: Mat3,
    centre: Vec3,
    size: Vec3,
}

#[derive(Clone, Copy, Debug)]
enum Join {
    Union,
    Intersection,
    Difference,
}

/// Shapes, each joined to those before it.
#[derive(Debug)]
struct Solid(Vec<(Join, Shape)>);

impl Shape {
    fn random(rng: &mut Rng) -> Shape {
        let mut within = |low: f32, high: f32| low + (high - low) * rng.f32();
        let size = Vec3::from_array([(); 3].map(|()| within(1.0, 5.5)));
        let centre = Vec3::from_array([(); 3].map(|()| within(-4.0, 4.0)));
        let [a, b, c] = [(); 3].map(|()| within(0.0, 6.3));
        let turn = Mat3::from_euler(EulerRot::XYZ, a, b, c);
        let kind = match rng.u8(0..3) {
            0 => ShapeKind::Ball,
            1 => ShapeKind::Block,
            _ => ShapeKind::Cylinder,
        };
        Shape {
            kind,
            turn,
            centre,
            size,
        }
    }

    /// The shape's value at a point, without fidget.
    fn at(&self, p: Vec3) -> f32 {
        let p = self.turn * (p - self.centre);
        match self.kind {
            ShapeKind::Ball => p.length() - self.size.x,
            ShapeKind::Block => (p.abs() - self.size).max_element(),
            ShapeKind::Cylinder => (p.truncate().length() - self.size.x)
                .max(p.z.abs() - self.size.y),
        }
    }

    fn tree(&self) -> Tree {
        let (x, y, z) = Tree::axes();
        let d = [x - self.centre.x, y - self.centre.y, z - self.centre.z];
        let [x, y, z] = [0, 1, 2].map(|i| {
            let row = self.turn.row(i);
            d[0].clone() * row.x + d[1].clone() * row.y + d[2].clone() * row.z
        });
        let s = self.size;
        match self.kind {
            ShapeKind::Ball => {
                (x.square() + y.square() + z.square()).sqrt() - s.x
            }
            ShapeKind::Block => {
                (x.abs() - s.x).max(y.abs() - s.y).max(z.abs() - s.z)
            }
            ShapeKind::Cylinder => {
                ((x.square() + y.square()).sqrt() - s.x).max(z.abs() - s.y)
            }
        }
    }
}

impl Solid {
    fn random(rng: &mut Rng) -> Solid {
        let count = rng.usize(2..6);
        let shapes = (0..count).map(|i| {
            let join = match rng.u8(0..4) {
                0 if i > 0 => Join::Intersection,
                1 if i > 0 => Join::Difference,
                _ => Join::Union,
            };
            (join, Shape::random(rng))
        });
        Solid(shapes.collect())
    }

    fn at(&self, p: Vec3) -> f32 {
        self.0.iter().fold(f32::INFINITY, |f, (join, shape)| {
            let g = shape.at(p);
            match join {
                Join::Union => f.min(g),
                Join::Intersection => f.max(g),
                Join::Difference => f.max(-g),
            }
        })
    }

    fn tree(&self) -> Tree {
        let joined = self.0.iter().map(|(join, s)| (join, s.tree())).reduce(
            |(first, f), (join, g)| {
                let joined = match join {
                    Join::Union => f.min(g),
                    Join::Intersection => f.max(g),
                    Join::Difference => f.max(-g),
                };
                (first, joined)
            },
        );
        joined.unwrap().1
    }
}

/// Number of rings that count, and the content and length of all rings.
#[derive(Clone, Copy, Debug)]
struct Figures {
    rings: usize,
    content: f64,
    length: f64,
}

fn figures<'a>(rings: impl IntoIterator<Item = &'a Vec<DVec2>>) -> Figures {
    let mut all = Figures {
        rings: 0,
        content: 0.0,
        length: 0.0,
    };
    for ring in rings {
        let content = signed_area(ring);
        all.rings += usize::from(content.abs() > COUNTED);
        all.content += content;
        all.length += ring_length(ring);
    }
    all
}

/// What the oracle makes of a function on its own lattice.
fn oracle(f: &dyn Fn(Vec3) -> f32, z: f64, spacing: f64) -> Figures {
    // The lattice avoids the field's nodes, and round coordinates.
    let origin = -HALF + 0.37 * spacing;
    let n = (2.0 * HALF / spacing) as usize;
    let at = |i: usize| (origin + i as f64 * spacing) as f32;
    let values: Vec<f32> = (0..n * n)
        .map(|i| -f(Vec3::new(at(i % n), at(i / n), z as f32)))
        .collect();
    let lines = ContourBuilder::new(n, n, true)
        .lines(&values, &[1e-30])
        .unwrap();
    let rings: Vec<Vec<DVec2>> = lines[0]
        .geometry()
        .iter()
        .map(|line| {
            // The first point is repeated, and the solid is on the right.
            let points = line.coords().skip(1);
            let mut ring: Vec<DVec2> = points
                .map(|p| DVec2::new(p.x.into(), p.y.into()) * spacing)
                .collect();
            ring.reverse();
            ring
        })
        .collect();
    figures(&rings)
}

/// How many rings and heights were compared.
#[derive(Debug, Default)]
struct Compared {
    heights: usize,
    rings: usize,
    /// Heights at which only the finest lattice has as many rings.
    fine: usize,
}

/// Compares the rings of a function with the oracle's on two lattices, one half
/// as wide as the other. What the oracle loses at corners at least halves from
/// one to the other, so what it still loses is no more than what it has gained.
///
/// - Rings: their number is equal. Where a neck or a slit is thinner than the
///   oracle's cells its nodes do not see it, and the field asks beside its own
///   nodes. There a lattice eight times as fine has to see it, too.
/// - Content: the difference is at most the accuracy along the rings, what the
///   oracle still loses, and one of its cells.
/// - Length: the difference is at most that sum, too. But cutting across
///   corners costs the oracle more length than content, and whole cells of
///   length at sharp tips, so our length may be greater by ten cells. It is not
///   less, except for chords across curves.
fn compare(
    name: &str,
    tree: &Tree,
    f: &dyn Fn(Vec3) -> f32,
    z: &[f64],
    compared: &mut Compared,
) {
    let bounds = Rect::new(DVec2::splat(-HALF), DVec2::splat(HALF));
    let detail = Detail {
        accuracy: ACCURACY,
        smallest: 0.0,
    };
    let field = Field::new(tree, 0.0, bounds, SPACING).unwrap();
    for (&z, ours) in z.iter().zip(&outlines(&field, z, detail).unwrap()) {
        let ours = figures(&ours.area.rings);
        let cell = 0.5 * SPACING;
        let [coarse, fine] = [SPACING, cell].map(|h| oracle(f, z, h));
        let case = || format!("{name} at {z}: {ours:?}, {coarse:?}, {fine:?}");
        if ours.rings != fine.rings {
            let finest = oracle(f, z, 0.125 * SPACING);
            assert_eq!(ours.rings, finest.rings, "{}", case());
            compared.fine += 1;
        }
        let content = (ours.content - fine.content).abs();
        let left = (coarse.content - fine.content).abs();
        let bound = ACCURACY * ours.length + left + cell * cell;
        assert!(content <= bound, "{}", case());
        let longer = ours.length - fine.length;
        let left = (coarse.length - fine.length).abs();
        assert!(longer <= left + 10.0 * cell, "{}", case());
        assert!(longer >= -1e-3 * ours.length, "{}", case());
        compared.heights += usize::from(ours.rings > 0);
        compared.rings += ours.rings;
    }
}

#[test]
fn random_solids_have_the_rings_of_the_contour_crate() {
    let mut rng = Rng::with_seed(17);
    let mut compared = Compared::default();
    for case in 0..48 {
        let solid = Solid::random(&mut rng);
        let z: Vec<f64> = (0..5)
            .map(|i| -5.0 + 2.0 * (f64::from(i) + rng.f64()))
            .collect();
        let name = format!("{case}");
        let f = |p| solid.at(p);
        compare(&name, &solid.tree(), &f, &z, &mut compared);
    }
    assert!(
        compared.heights > 120 && compared.rings > 180,
        "{compared:?}"
    );
    assert!(compared.fine < 5, "{compared:?}");
}

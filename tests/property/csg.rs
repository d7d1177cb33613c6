//! Random solids of boxes, balls and cylinders, as fidget's trees and, for
//! judging what came of those, as functions of `f64`.

use fidget::context::Tree;
use glam::{DMat3, DVec3};
use proptest::prelude::*;

/// A solid in an implicit field, negative inside.
#[derive(Clone, Debug)]
pub enum Solid {
    Cuboid(DVec3),
    Ball(f64),
    /// An upright cylinder, of a radius and half a height.
    Cylinder(f64, f64),
    Moved(Box<Solid>, DVec3),
    /// A solid turned about an axis by an angle.
    Turned(Box<Solid>, DVec3, f64),
    Union(Box<Solid>, Box<Solid>),
    Cut(Box<Solid>, Box<Solid>),
    Common(Box<Solid>, Box<Solid>),
    /// A union whose edge is rounded within a distance.
    Blend(Box<Solid>, Box<Solid>, f64),
    /// A solid in a field that jumps: −1 inside, 1 outside.
    Jump(Box<Solid>),
    /// A solid in a field that is no distance.
    Scaled(Box<Solid>, f64),
}

fn c(v: f64) -> f32 {
    v as f32
}

impl Solid {
    pub fn tree(&self) -> Tree {
        let (x, y, z) = Tree::axes();
        self.at(&x, &y, &z)
    }

    fn at(&self, x: &Tree, y: &Tree, z: &Tree) -> Tree {
        let both = |a: &Solid, b: &Solid| (a.at(x, y, z), b.at(x, y, z));
        match self {
            Solid::Cuboid(h) => (x.abs() - c(h.x))
                .max(y.abs() - c(h.y))
                .max(z.abs() - c(h.z)),
            Solid::Ball(r) => {
                (x.square() + y.square() + z.square()).sqrt() - c(*r)
            }
            Solid::Cylinder(r, h) => {
                ((x.square() + y.square()).sqrt() - c(*r)).max(z.abs() - c(*h))
            }
            Solid::Moved(s, by) => s.at(
                &(x.clone() - c(by.x)),
                &(y.clone() - c(by.y)),
                &(z.clone() - c(by.z)),
            ),
            Solid::Turned(s, axis, angle) => {
                let m = DMat3::from_axis_angle(*axis, -angle);
                let row = |k: usize| {
                    let r = m.row(k);
                    x.clone() * c(r.x) + y.clone() * c(r.y) + z.clone() * c(r.z)
                };
                s.at(&row(0), &row(1), &row(2))
            }
            Solid::Union(a, b) => {
                let (a, b) = both(a, b);
                a.min(b)
            }
            Solid::Cut(a, b) => {
                let (a, b) = both(a, b);
                a.max(-b)
            }
            Solid::Common(a, b) => {
                let (a, b) = both(a, b);
                a.max(b)
            }
            Solid::Blend(a, b, k) => {
                let (a, b) = both(a, b);
                let h = (Tree::constant(c(*k)) - (a.clone() - b.clone()).abs())
                    .max(0.0);
                a.min(b) - h.square() * c(0.25 / k)
            }
            Solid::Jump(s) => s.at(x, y, z).compare(0.0),
            Solid::Scaled(s, k) => s.at(x, y, z) * c(*k),
        }
    }

    pub fn value(&self, p: DVec3) -> f64 {
        match self {
            Solid::Cuboid(h) => (p.abs() - *h).max_element(),
            Solid::Ball(r) => p.length() - r,
            Solid::Cylinder(r, h) => {
                (p.truncate().length() - r).max(p.z.abs() - h)
            }
            Solid::Moved(s, by) => s.value(p - *by),
            Solid::Turned(s, axis, angle) => {
                s.value(DMat3::from_axis_angle(*axis, -angle) * p)
            }
            Solid::Union(a, b) => a.value(p).min(b.value(p)),
            Solid::Cut(a, b) => a.value(p).max(-b.value(p)),
            Solid::Common(a, b) => a.value(p).max(b.value(p)),
            Solid::Blend(a, b, k) => {
                let (a, b) = (a.value(p), b.value(p));
                let h = (k - (a - b).abs()).max(0.0);
                a.min(b) - h * h * 0.25 / k
            }
            Solid::Jump(s) => match s.value(p) {
                f if f < 0.0 => -1.0,
                _ => 1.0,
            },
            Solid::Scaled(s, k) => s.value(p) * k,
        }
    }
}

fn axis() -> impl Strategy<Value = DVec3> {
    // Upright in half of the cases: most parts stand.
    prop_oneof![
        Just(DVec3::Z),
        (-1.0..1.0, -1.0..1.0, 0.2..1.0)
            .prop_map(|(x, y, z)| DVec3::new(x, y, z).normalize()),
    ]
}

/// Solids of a few parts within 5 mm of the z axis along x and y.
pub fn solid() -> impl Strategy<Value = Solid> {
    let leaf = prop_oneof![
        (0.2..2.0, 0.2..2.0, 0.3..2.0)
            .prop_map(|(x, y, z)| Solid::Cuboid(DVec3::new(x, y, z))),
        (0.3..2.0).prop_map(Solid::Ball),
        (0.2..1.5, 0.3..2.0).prop_map(|(r, h)| Solid::Cylinder(r, h)),
    ];
    let placed = (leaf, axis(), 0.0..6.3, -1.5..1.5, -1.5..1.5, -0.5..0.5)
        .prop_map(|(s, axis, angle, x, y, z)| {
            let turned = Solid::Turned(Box::new(s), axis, angle);
            Solid::Moved(Box::new(turned), DVec3::new(x, y, z))
        });
    let tree = placed.prop_recursive(3, 6, 2, |inner| {
        (inner.clone(), inner, 0..5_u8, 0.1..0.8).prop_map(|(a, b, kind, k)| {
            let (a, b) = (Box::new(a), Box::new(b));
            match kind {
                0 | 1 => Solid::Union(a, b),
                2 => Solid::Cut(a, b),
                3 => Solid::Common(a, b),
                _ => Solid::Blend(a, b, k),
            }
        })
    });
    (tree, 0..5_u8, -6.0..6.0).prop_map(|(s, kind, power)| match kind {
        0 => Solid::Jump(Box::new(s)),
        1 => Solid::Scaled(Box::new(s), 10_f64.powf(power)),
        _ => s,
    })
}

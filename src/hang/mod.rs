//! What hangs: the places of a part that nothing below holds while they are
//! printed, and what would need a support.
//!
//! ```text
//!        ┌──────────────────────┐
//!        └───────┐  ┌───────────┘   the underside of a plate on a post; its
//!          reach │  │├── reach ─┤   reach is how far it gets from what holds
//!                │  │
//! ```
//!
//! In: the outline of a layer and that of the layer below. Out: what hangs, by
//! kind, with its area, its widest reach and its first place.
//!
//! | kind | what it is |
//! |---|---|
//! | begins | an island with nothing below it |
//! | leans | a face that leans by more than `support.angle` from the vertical, up to a ledge |
//! | bridges | skin held at both ends, farther apart than `bridge_max` |
//!
//! Each layer holds h·tan(`support.angle`) of the one above, h being its
//! height. What sticks out farther adds up from layer to layer: the rim of a
//! wall that leans by 60° is 0.06 mm farther from what holds it with every
//! layer of 0.2 mm, if 55° hold themselves, and comes back to it as slowly once
//! the wall is upright again ([`Tracker`]). Up to two lines' width hang
//! without harm: a bead laid beside one that is held sticks to it, and so
//! does the next. So lips, small holes and the undersides of most lattices
//! carry themselves and are not told of. Neither are the tips of a lattice that
//! begin on nothing and soon grow together with it (`tip`).
//!
//! Bridges are those that the skin's lines make: straight lines across a gap,
//! in the direction that the [`skin`](crate::skin) has for them, held at both
//! ends. They hold what is printed on them.
//!
//! Whether the whole part stands firmly is another matter: [`foot`].
//!
//! Not guaranteed: a reach that adds up over more layers than the pipeline
//! takes in one block may be counted in part, because what a run of a range
//! tells of a layer must not depend on every layer below it. Nothing is known
//! of the material, either: the settings say how far a bridge or a slope holds.

pub(crate) mod foot;
mod gap;
mod look;
mod places;
mod reach;
mod tip;
mod track;
mod words;

pub(crate) use look::Look;
pub use places::Place;
pub(crate) use track::Tracker;

use crate::units::{Mm, Mm2};
use glam::DVec3;

/// Why something hangs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It is an island that begins on nothing.
    Begins,
    /// It leans too far.
    Leans,
    /// It is a bridge that is too long.
    Bridge,
}

/// What hangs in some layers, of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    /// How many there are: islands, or gaps. Slopes have no number.
    pub count: usize,
    /// Their undersides, seen from below.
    pub area: Mm2,
    /// The largest of them, about, where they are connected.
    pub largest: Mm2,
    /// The widest: of slopes the distance from what holds them, of bridges
    /// their length; 0 of islands.
    pub reach: Mm,
    /// Where the first of them is, on the bed: the lowest one.
    pub first: Option<DVec3>,
}

impl Sum {
    /// Adds `area`, which belongs to a place of `all`.
    fn add(&mut self, area: Mm2, all: Mm2, reach: Mm, at: DVec3) {
        self.count += 1;
        self.area += area;
        self.largest = self.largest.max(all);
        self.reach = self.reach.max(reach);
        self.first.get_or_insert(at);
    }

    /// True if there is nothing of this kind.
    pub fn is_none(&self) -> bool {
        self.first.is_none()
    }
}

impl Sum {
    /// Adds what hangs in each of some equal parts.
    fn add_parts(&mut self, other: &Sum, copies: usize) {
        self.count += copies * other.count;
        self.area += copies as f64 * other.area;
        self.largest = self.largest.max(other.largest);
        self.reach = self.reach.max(other.reach);
        let lower = |p: &DVec3| self.first.is_none_or(|first| p.z < first.z);
        self.first = other.first.filter(lower).or(self.first);
    }
}

impl Hanging {
    /// Adds what hangs in each of some equal parts. Of two feet that are too
    /// small the one stays that holds less.
    pub(crate) fn add(&mut self, other: &Hanging, copies: usize) {
        self.begins.add_parts(&other.begins, copies);
        self.in_cavity.add_parts(&other.in_cavity, copies);
        self.leans.add_parts(&other.leans, copies);
        self.bridges.add_parts(&other.bridges, copies);
        let less = |foot: &foot::Foot| {
            self.foot.is_none_or(|known| foot.holds < known.holds)
        };
        self.foot = other.foot.filter(less).or(self.foot);
    }
}

/// What hangs in some layers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hanging {
    /// Islands that begin on nothing.
    pub begins: Sum,
    /// Those of them that are inside the part, in a cavity.
    pub in_cavity: Sum,
    /// Faces that lean too far.
    pub leans: Sum,
    /// Bridges that are too long.
    pub bridges: Sum,
    /// What the whole part stands on, if that is too small for its height.
    pub foot: Option<foot::Foot>,
}

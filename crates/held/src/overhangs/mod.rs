//! What hangs: the places of a part that nothing below holds while they are
//! printed, and what would need a support.
//!
//! ```text
//!        ┌──────────────────────┐
//!        └───────┐  ┌───────────┘   The underside of a plate on a post. Its
//!          reach │  │├── reach ─┤   reach is how far it gets from what holds
//!                │  │               it.
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
//! 1. [`judge`] is the one place that says what of a layer the layer below does not
//!    hold. Each layer holds h·tan(`support.angle`) of the layer above ([`held`]), where
//!    h is that layer's height, if it is printed there itself ([`printed`]). Lines
//!    [`across`] a gap need nothing if the skin lays them so, if both of their ends are
//!    held, and if they are not too long. They hold what is printed on them.
//! 2. Supports ask it about all of a layer, and leave out what is no wider than a
//!    line ([`lip`]). [`needs`] makes places of what they hold: [`piece`] by piece.
//! 3. The summary of a run tells what sags, and asks as little as it can. [`look`] asks
//!    only where places on the rims tell of something ([`ledges`]), and [`track`] adds up
//!    what sticks out too far from layer to layer. For example, if faces that lean by
//!    55° hold themselves, the rim of a wall that leans by 60° gets 0.06 mm farther from
//!    what holds it with every layer of 0.2 mm. It comes back as slowly once the wall is
//!    upright again.
//! 4. What hangs by up to two lines' width is not told: a bead laid beside one that is
//!    held sticks to it, and so does the next. So lips, small holes and the
//!    undersides of most lattices carry themselves. Nor are the tips
//!    of a lattice that begin on nothing and soon grow together with it ([`tip`]), and
//!    [`words`] warns of large places only.
//!
//! Whether the whole part stands firmly is another matter: [`foot`].
//!
//! Not guaranteed: that a run of a range of layers counts a reach in full that adds
//! up from below the range. What the range begins with counts as held. The
//! material is unknown, too: the plan says how far a bridge or a slope holds. A face
//! that sticks out by a tenth of a layer's height more is held as well (2° at 55°).

mod across;
pub mod foot;
mod held;
mod json;
mod judge;
mod ledges;
mod lip;
mod look;
mod needs;
mod piece;
mod places;
mod plan;
mod printed;
mod tip;
mod track;
mod words;

#[cfg(test)]
pub(crate) use held::held;
pub(crate) use judge::{Unheld, large, unheld};
pub(crate) use lip::without_lips;
pub use look::LayerOverhang;
pub use needs::Needs;
pub use places::Unsupported;
pub use plan::OverhangPlan;
pub(crate) use printed::Printed;
pub use track::{Far, Tracker};

use glam::DVec3;
use isoslice_base::units::{Mm, Mm2};

/// Why something hangs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OverhangKind {
    /// An island begins on nothing.
    Begins,
    /// A face leans too far.
    Leans,
    /// A bridge is too long.
    Bridge,
}

/// What hangs in some layers, of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    /// Number of islands, or of gaps. Slopes have no number.
    pub count: usize,
    /// Content of the undersides, seen from below; of islands the greatest content
    /// while nothing holds them.
    pub area: Mm2,
    /// Content of the largest connected underside, about.
    pub largest: Mm2,
    /// Greatest reach: of slopes the distance from what holds them, of bridges
    /// their length; 0 for islands.
    pub reach: Mm,
    /// Place on the bed of the first finding, which is the lowest one.
    pub first: Option<DVec3>,
}

impl Sum {
    /// Adds `area`, which belongs to a place with the content `all`.
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

    /// True if it is worth a word: a smaller area reads as 0.00 mm².
    pub fn is_told(&self) -> bool {
        const LEAST: Mm2 = 0.005;
        self.area >= LEAST
    }

    /// Adds what hangs in each of several equal parts.
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
    /// Adds what hangs in each of several equal parts. Of two feet that are too
    /// small, the one that holds less is kept.
    pub fn add(&mut self, other: &Hanging, copies: usize) {
        self.begins.add_parts(&other.begins, copies);
        self.in_cavity.add_parts(&other.in_cavity, copies);
        self.in_the_open.add_parts(&other.in_the_open, copies);
        self.leans.add_parts(&other.leans, copies);
        self.bridges.add_parts(&other.bridges, copies);
        let less = |foot: &foot::Foot| {
            self.foot.is_none_or(|known| foot.holds < known.holds)
        };
        self.foot = other.foot.filter(less).or(self.foot);
    }

    /// Counts an island that begins on nothing by where it is.
    fn add_where(&mut self, in_cavity: bool, area: Mm2, at: DVec3) {
        let sum = if in_cavity {
            &mut self.in_cavity
        } else {
            &mut self.in_the_open
        };
        sum.add(area, area, 0.0, at);
    }
}

/// What hangs in some layers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hanging {
    /// Islands that begin on nothing.
    pub begins: Sum,
    /// Islands among these that are inside the part, in a cavity.
    pub in_cavity: Sum,
    /// Islands among these that are outside of all cavities.
    pub in_the_open: Sum,
    /// Faces that lean too far.
    pub leans: Sum,
    /// Bridges that are too long.
    pub bridges: Sum,
    /// The foot of the whole part, if it is too small for the part's height.
    pub foot: Option<foot::Foot>,
}

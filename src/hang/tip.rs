//! Islands that begin on nothing, until it is known what becomes of them.
//!
//! ```text
//!      ▒▒▒▒▒▒▒▒▒▒
//!      ▒▒▒▒  ▒▒▒▒     a tip begins in the air and is soon one with what
//!      ▒▒▒    ▒▒      stands beside it: what is laid there is dragged along a
//!      ▒▒             little, and caught
//! ```
//!
//! A lattice that a slanted surface cuts has tips all over. An island is told
//! of only if it is large, or gets high before it is one with anything that
//! stands, or never is.
//!
//! In: the rims of layers, from below. Out: the islands that count.

use super::look::{Look, Place};
use crate::plane::signed_area;
use crate::units::{Mm, Mm2};
use glam::{DVec2, DVec3};

/// From here on an island is no tip, mm².
const LARGE: Mm2 = 10.0;
/// Nor is it from this height on, mm.
const HIGH: Mm = 3.0;

/// An island that began on nothing.
#[derive(Clone, Debug)]
pub(super) struct Island {
    /// Its content where it begins, and a point of it there.
    pub area: Mm2,
    pub at: DVec3,
    /// Whether it hangs inside the part.
    pub in_cavity: bool,
    /// How high it is by now.
    height: Mm,
    /// Its ring in the layer below the next one: the numbers of its edges.
    ring: (f64, f64),
}

/// The islands of which it is not known yet.
#[derive(Debug, Default)]
pub(super) struct Tips(Vec<Island>);

impl Tips {
    /// Takes the next layer; gives the islands that count from now on.
    pub fn layer(
        &mut self,
        look: &Look,
        place: impl Fn(DVec2) -> DVec3,
    ) -> Vec<Island> {
        if self.0.is_empty() && look.begins.is_empty() {
            return Vec::new();
        }
        let mut counts = Vec::new();
        let below = std::mem::take(&mut self.0);
        let rings: Vec<&[Place]> =
            look.rim.chunk_by(|a, b| a.ring == b.ring).collect();
        for mut island in below.iter().cloned() {
            let on_it = |p: &Place| p.foot.is_some_and(|on| island.carries(on));
            // Where it ends, it was never held.
            let Some(above) = rings.iter().find(|r| r.iter().any(on_it)) else {
                counts.push(island);
                continue;
            };
            // Two that meet still stand on nothing.
            let hangs = |on: f64| below.iter().any(|i| i.carries(on));
            if above.iter().filter_map(|p| p.foot).all(hangs) {
                island.ring = above[0].ring;
                island.height += look.height;
                self.keep(island, above, &mut counts);
            }
        }
        for begins in &look.begins {
            let first = begins.island.rings.first().and_then(|r| r.first());
            let own = |ring: &&&[Place]| first == Some(&ring[0].at);
            let Some(ring) = rings.iter().find(own) else {
                continue;
            };
            let island = Island {
                area: begins.island.content(),
                at: place(begins.at),
                in_cavity: begins.in_cavity,
                height: look.height,
                ring: ring[0].ring,
            };
            self.keep(island, ring, &mut counts);
        }
        counts
    }

    /// A layer of this height that is the same as the one below.
    pub fn same(&mut self, height: Mm) -> Vec<Island> {
        self.0.iter_mut().for_each(|i| i.height += height);
        self.0.extract_if(.., |i| i.height >= HIGH).collect()
    }

    /// Those of which nothing more will be known.
    pub fn rest(&mut self) -> Vec<Island> {
        std::mem::take(&mut self.0)
    }

    /// Keeps an island whose ring is now `ring`, or counts it.
    fn keep(&mut self, island: Island, ring: &[Place], to: &mut Vec<Island>) {
        let ring: Vec<DVec2> = ring.iter().map(|p| p.at).collect();
        let counts = island.height >= HIGH || signed_area(&ring) >= LARGE;
        match counts {
            true => to.push(island),
            false => self.0.push(island),
        }
    }
}

impl Island {
    /// True if a place on the rings below is one of its own.
    fn carries(&self, on: f64) -> bool {
        on >= self.ring.0 && on <= self.ring.1
    }
}

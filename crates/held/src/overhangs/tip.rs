//! Islands that begin on nothing, until it is known what becomes of them.
//!
//! ```text
//!      ▒▒▒▒▒▒▒▒▒▒
//!      ▒▒▒▒  ▒▒▒▒     A tip begins in the air and is soon one with what
//!      ▒▒▒    ▒▒      stands beside it. What is laid there is dragged along
//!      ▒▒             a little, and caught.
//! ```
//!
//! A lattice that a slanted surface cuts has tips all over, and they print well
//! enough. So an island counts only if it is large, if it gets high before it
//! meets what stands on the bed, or if it never does.
//!
//! In: the rims of layers, from below. Out: the islands that count.

use super::held::Limits;
use super::look::{LayerOverhang, Name, RimPlace, name};
use glam::{DVec2, DVec3};
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::signed_area;
use std::collections::HashMap;

/// Content from which on an island is no tip, mm².
const LARGE: Mm2 = 10.0;
/// Height from which on an island is no tip, mm.
const HIGH: Mm = 3.0;

/// An island that began on nothing.
#[derive(Clone, Debug)]
pub(super) struct Island {
    /// A point of the island where it begins.
    pub at: DVec3,
    /// True if the island hangs inside the part.
    pub in_cavity: bool,
    /// Height of the island so far.
    height: Mm,
    /// The island's greatest content so far. It may begin as a mere point.
    pub most: Mm2,
    /// The island's ring in the last layer: the numbers of its edges, and a
    /// point.
    ring: (f64, f64),
    now: DVec2,
}

/// The islands that may still be tips.
#[derive(Debug, Default)]
pub(super) struct Tips(Vec<Island>);

impl Tips {
    /// Takes the next layer, `here`. Returns the islands that count from now
    /// on.
    pub(super) fn layer(
        &mut self,
        look: &LayerOverhang,
        here: &EdgeGrid,
        place: impl Fn(DVec2) -> DVec3,
    ) -> Vec<Island> {
        if self.0.is_empty() && look.begins.is_empty() {
            return Vec::new();
        }
        let mut counts = Vec::new();
        let below = std::mem::take(&mut self.0);
        let rings: Vec<&[RimPlace]> =
            look.rim.chunk_by(|a, b| a.ring == b.ring).collect();
        let above = ringed(&below, &rings);
        for (mut island, above) in below.into_iter().zip(above) {
            match above {
                Above::Stands => {}
                Above::Hangs(k) => {
                    island.ring = rings[k][0].ring;
                    island.now = rings[k][0].at;
                    island.height += look.height;
                    self.keep(island, rings[k], look, &mut counts);
                }
                Above::Nothing => {
                    // No ring lies on the island. Solid above it or beside it
                    // has caught the island. Without such solid the island ends
                    // here, and nothing ever held it.
                    let (p, lip) = (island.now, look.limits.harmless);
                    let caught =
                        here.contains(p) || here.nearest_edge(p, lip).is_some();
                    if !caught && island.most >= speck(look.limits) {
                        counts.push(island);
                    }
                }
            }
        }
        let named: HashMap<Name, &[RimPlace]> = if look.begins.is_empty() {
            HashMap::new()
        } else {
            rings.iter().map(|r| (name(r[0].at), *r)).collect()
        };
        for begins in &look.begins {
            let first = begins.island.rings.first().and_then(|r| r.first());
            let Some(ring) = first.and_then(|p| named.get(&name(*p))) else {
                continue;
            };
            let island = Island {
                at: place(begins.at),
                in_cavity: begins.in_cavity,
                height: look.height,
                most: 0.0,
                ring: ring[0].ring,
                now: begins.at,
            };
            self.keep(island, ring, look, &mut counts);
        }
        // The islands are sorted by place, so that the next layer finds them.
        self.0.sort_by(|a, b| a.ring.0.total_cmp(&b.ring.0));
        counts
    }

    /// Takes a layer of this height whose outline equals that of the layer
    /// below.
    pub(super) fn same(&mut self, height: Mm, limits: Limits) -> Vec<Island> {
        self.0.iter_mut().for_each(|i| i.height += height);
        self.0.extract_if(.., |i| i.counts(limits)).collect()
    }

    /// Returns the islands of which nothing more will be known.
    pub(super) fn rest(&mut self, limits: Limits) -> Vec<Island> {
        let mut rest = std::mem::take(&mut self.0);
        rest.retain(|i| i.most >= speck(limits));
        rest
    }

    /// Keeps an island whose ring is now `ring`, or counts it.
    fn keep(
        &mut self,
        mut island: Island,
        ring: &[RimPlace],
        look: &LayerOverhang,
        to: &mut Vec<Island>,
    ) {
        let ring: Vec<DVec2> = ring.iter().map(|p| p.at).collect();
        island.most = island.most.max(signed_area(&ring));
        if island.counts(look.limits) {
            to.push(island)
        } else {
            self.0.push(island)
        }
    }
}

/// Least content of what becomes a bead: the square of a line's width.
fn speck(limits: Limits) -> Mm2 {
    (0.5 * limits.harmless).powi(2)
}

impl Island {
    /// True if the island is no tip.
    fn counts(&self, limits: Limits) -> bool {
        let high = self.height >= HIGH && self.most >= speck(limits);
        high || self.most >= LARGE
    }
}

/// What lies on an island in the next layer.
#[derive(Clone, Copy, Debug)]
enum Above {
    /// No ring whose places are near the island's.
    Nothing,
    /// The ring of this number, which lies on nothing else that stands.
    Hangs(usize),
    /// A ring that also lies on something that stands.
    Stands,
}

/// What lies on each of several islands, which are in the order of their rings.
fn ringed(islands: &[Island], rings: &[&[RimPlace]]) -> Vec<Above> {
    let find = |on: f64| {
        let next = islands.partition_point(|i| i.ring.0 <= on);
        let k = next.checked_sub(1)?;
        (on <= islands[k].ring.1).then_some(k)
    };
    let mut above = vec![Above::Nothing; islands.len()];
    for (r, ring) in rings.iter().enumerate() {
        let feet = ring.iter().filter_map(|p| p.foot);
        let on: Vec<Option<usize>> = feet.map(find).collect();
        // A ring on two islands still stands on nothing.
        let stands = on.contains(&None);
        for k in on.into_iter().flatten() {
            match (stands, above[k]) {
                (false, Above::Hangs(_)) => {}
                (false, _) => above[k] = Above::Hangs(r),
                (true, Above::Nothing) => above[k] = Above::Stands,
                (true, _) => {}
            }
        }
    }
    // Islands that have met share a ring, so the same thing lies on all of
    // them.
    for k in (1..islands.len()).rev() {
        if islands[k - 1].ring == islands[k].ring {
            above[k - 1] = above[k];
        }
    }
    above
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overhangs::look::Said;

    #[test]
    fn islands_that_have_met_fare_alike() {
        let island = |ring: (f64, f64)| Island {
            at: DVec3::ZERO,
            in_cavity: false,
            height: 0.2,
            most: 1.0,
            ring,
            now: DVec2::ZERO,
        };
        let place = |foot: f64| RimPlace {
            at: DVec2::ZERO,
            on: 0.0,
            ring: (0.0, 4.0),
            length: 1.0,
            foot: Some(foot),
            beyond: 0.0,
            strip: 0.0,
            said: Said::Nothing,
        };
        let below =
            [island((0.0, 4.0)), island((0.0, 4.0)), island((5.0, 9.0))];
        let above = |feet: &[f64]| -> Vec<Above> {
            let ring: Vec<RimPlace> = feet.iter().map(|f| place(*f)).collect();
            ringed(&below, &[&ring])
        };
        use Above::{Hangs, Nothing, Stands};
        let found = above(&[1.0, 3.0]);
        assert!(
            matches!(found[..], [Hangs(0), Hangs(0), Nothing]),
            "{found:?}"
        );
        let found = above(&[1.0, 20.0]);
        assert!(matches!(found[..], [Stands, Stands, Nothing]), "{found:?}");
    }
}

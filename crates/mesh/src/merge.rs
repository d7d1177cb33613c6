//! Makes one vertex of those that are at the same place.
//!
//! In: places, one after another. Out: for each the number of its vertex.
//! Vertices are numbered as they first appear, so the numbers do not depend on
//! the hash.

use glam::DVec3;
use std::hash::{BuildHasher, RandomState};

/// A slot without a vertex.
const FREE: u32 = u32::MAX;

/// Vertices at different places, found by their coordinates.
#[derive(Debug)]
pub(crate) struct Merger {
    pub vertices: Vec<DVec3>,
    /// Numbers of vertices, each at the first free slot from its hash on. A
    /// power of two of them, at least twice the number of vertices.
    slots: Vec<u32>,
    /// So that no file can be made whose vertices all have one hash.
    seed: u64,
}

impl Default for Merger {
    fn default() -> Merger {
        Merger {
            vertices: Vec::new(),
            slots: vec![FREE; 64],
            seed: RandomState::new().hash_one(0u8) | 1,
        }
    }
}

impl Merger {
    /// The number of the vertex at a place.
    pub(crate) fn vertex(&mut self, p: DVec3) -> u32 {
        // Without −0, so that equal coordinates have equal bits.
        let p = p + DVec3::ZERO;
        let slot = self.slot(p);
        if self.slots[slot] != FREE {
            return self.slots[slot];
        }
        let number = self.vertices.len() as u32;
        self.vertices.push(p);
        self.slots[slot] = number;
        if 2 * self.vertices.len() > self.slots.len() {
            self.grow();
        }
        number
    }

    /// The slot of the vertex at a place, or the free one where it belongs.
    fn slot(&self, p: DVec3) -> usize {
        let mask = self.slots.len() - 1;
        let mut slot = hash(p, self.seed) as usize & mask;
        while self.slots[slot] != FREE
            && self.vertices[self.slots[slot] as usize] != p
        {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        let count = 2 * self.slots.len();
        self.slots = Vec::new();
        self.slots.resize(count, FREE);
        for number in 0..self.vertices.len() {
            let slot = self.slot(self.vertices[number]);
            self.slots[slot] = number as u32;
        }
    }
}

/// A number that depends on all bits of a place and of a seed.
fn hash(p: DVec3, seed: u64) -> u64 {
    let mix = |a: u64, b: u64| {
        let product = u128::from(a) * u128::from(b);
        product as u64 ^ (product >> 64) as u64
    };
    let [x, y, z] = p.to_array().map(f64::to_bits);
    let hash = mix(x ^ seed, 0x9e37_79b9_7f4a_7c15 ^ y);
    mix(hash ^ z ^ seed, 0xd1b5_4a32_d192_ed03)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_are_one_vertex() {
        let mut merger = Merger::default();
        let place = |i: u32| DVec3::new(f64::from(i), 0.5, -f64::from(i));
        for _ in 0..2 {
            for i in 0..1000 {
                assert_eq!(merger.vertex(place(i)), i);
            }
        }
        assert_eq!(merger.vertices.len(), 1000);
        assert_eq!(merger.vertex(DVec3::new(-0.0, 0.5, 0.0)), 0);
    }
}

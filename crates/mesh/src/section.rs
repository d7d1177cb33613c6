//! Exact plane sections.
//!
//! In: a plane z = const of coordinates that an affine map takes to those of the
//! mesh. Out: closed rings, the inside on their left.
//!
//! Each triangle with vertices on both sides of the plane gives a segment, from
//! the edge that goes down through the plane to the one that goes up. The next
//! segment begins at the same edge of the mesh, in the next triangle. So rings
//! are chained by numbers, without a tolerance, and both triangles of an edge
//! have the same point.
//!
//! ```text
//!        above                     inside is on the left of → if the triangle
//!     ____▲_______________         is counter-clockwise as seen from outside
//!         │╲  ──→  ╱│ plane
//!         │  ╲   ╱  │
//!        below ▼
//! ```
//!
//! Vertices in the plane count as above it in one section, and as below it in
//! another one. Where the two differ there is a level face, and the result is
//! both: rings of both sections together go round what is inside just above or
//! just below.

use crate::mesh::Mesh;
use crate::shell::Shell;
use crate::tree::Node;
use glam::{DAffine3, DVec2, DVec3};
use isocontour::Ring;

/// A plane, and the coordinates in it.
struct Plane {
    /// From the mesh to the plane's coordinates, z being the height above it.
    to: DAffine3,
    /// True if the map mirrors.
    mirrors: bool,
}

/// A vertex, relative to the plane.
#[derive(Clone, Copy)]
struct Corner {
    number: u32,
    p: DVec3,
}

/// A piece of a ring: the edges of the mesh where it begins and ends, and where
/// it begins.
struct Segment {
    from: u64,
    to: u64,
    start: DVec2,
}

/// A free slot, or no segment.
const NONE: u32 = u32::MAX;

impl Mesh {
    /// The rings around what is inside, at a height of coordinates that `place`
    /// takes to the mesh's. None if the triangles there have a rim, or the map
    /// cannot be inverted.
    pub(crate) fn section_at(
        &self,
        place: &DAffine3,
        z: f64,
    ) -> Option<Vec<Ring>> {
        let to = place.inverse();
        if !to.is_finite() || !z.is_finite() {
            return None;
        }
        let plane = Plane {
            to: DAffine3::from_translation(-DVec3::Z * z) * to,
            mirrors: to.matrix3.determinant() < 0.0,
        };
        let (above, touches) = self.segments(&plane, true);
        let above = chained(&above)?;
        if !touches {
            return Some(above);
        }
        let (below, _) = self.segments(&plane, false);
        let below = chained(&below)?;
        if same(&above, &below) {
            return Some(above);
        }
        Some(above.into_iter().chain(below).collect())
    }

    /// The segments in a plane, with those of what covers openings, vertices in
    /// the plane being above it or below it. Also returned: true if there are
    /// such vertices.
    fn segments(&self, plane: &Plane, is_above: bool) -> (Vec<Segment>, bool) {
        let (mut all, mut touches) =
            self.shell.segments(plane, is_above, |v| v);
        if let Some(cover) = self.sign.cover() {
            let number = |v: u32| cover.numbers[v as usize];
            let (segments, touch) =
                cover.shell.segments(plane, is_above, number);
            all.extend(segments);
            touches |= touch;
        }
        (all, touches)
    }
}

impl Shell {
    /// The triangles whose boxes a plane may meet.
    fn near(&self, plane: &Plane) -> Vec<u32> {
        let row = plane.to.matrix3.row(2);
        let offset = plane.to.translation.z;
        let meets = |node: &Node| {
            [0, 1, 2, 3].map(|i| {
                let [low, high] = node.range(i, row, offset);
                low <= 0.0 && high >= 0.0
            })
        };
        let mut near = Vec::new();
        self.tree.visit(meets, |first, end| {
            near.extend(first as u32..end as u32);
        });
        near
    }

    /// The segments in a plane, vertices in the plane being above it or below
    /// it. Also returned: true if there are such vertices. `number` names a
    /// vertex.
    fn segments(
        &self,
        plane: &Plane,
        is_above: bool,
        number: impl Fn(u32) -> u32,
    ) -> (Vec<Segment>, bool) {
        let near = self.near(plane);
        let mut segments = Vec::with_capacity(near.len());
        let mut touches = false;
        for i in near {
            let corners = self.corners[i as usize];
            let mut corners = corners.map(|v| Corner {
                number: number(v),
                p: plane.to.transform_point3(self.vertices[v as usize]),
            });
            if plane.mirrors {
                corners.swap(1, 2);
            }
            let high = corners.map(|c| {
                touches |= c.p.z == 0.0;
                if is_above { c.p.z >= 0.0 } else { c.p.z > 0.0 }
            });
            if high[0] == high[1] && high[1] == high[2] {
                continue;
            }
            let (mut from, mut to) = ((0, DVec2::ZERO), 0);
            for k in 0..3 {
                let next = (k + 1) % 3;
                match (high[k], high[next]) {
                    (true, false) => {
                        from = (
                            key(corners[k], corners[next]),
                            through(corners[k], corners[next]),
                        );
                    }
                    (false, true) => to = key(corners[k], corners[next]),
                    _ => {}
                }
            }
            segments.push(Segment {
                from: from.0,
                to,
                start: from.1,
            });
        }
        (segments, touches)
    }
}

/// A number for an edge.
fn key(a: Corner, b: Corner) -> u64 {
    let (low, high) = (a.number.min(b.number), a.number.max(b.number));
    u64::from(low) << 32 | u64::from(high)
}

/// Where an edge goes through the plane. The same for both directions.
fn through(a: Corner, b: Corner) -> DVec2 {
    let (a, b) = if a.number < b.number { (a, b) } else { (b, a) };
    let (from, to) = (a.p.truncate(), b.p.truncate());
    if b.p.z == 0.0 {
        return to;
    }
    // One of the heights is not zero, and they have not the same sign.
    from + (to - from) * (a.p.z / (a.p.z - b.p.z))
}

/// Rings of segments. None if one begins where none ends.
fn chained(segments: &[Segment]) -> Option<Vec<Ring>> {
    let next = followers(segments)?;
    let mut is_taken = vec![false; segments.len()];
    let mut rings = Vec::new();
    for first in 0..segments.len() {
        let mut ring: Ring = Vec::new();
        let mut at = first;
        while !is_taken[at] {
            is_taken[at] = true;
            let p = segments[at].start;
            if ring.last() != Some(&p) {
                ring.push(p);
            }
            at = next[at] as usize;
        }
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        if ring.len() > 2 {
            rings.push(ring);
        }
    }
    Some(rings)
}

/// For each segment the one that begins where it ends. Where several do, the
/// first one that ends there is followed by the first that begins there.
fn followers(segments: &[Segment]) -> Option<Vec<u32>> {
    let count = (2 * segments.len()).next_power_of_two();
    let mask = count - 1;
    let slot = |key: u64| {
        let product = u128::from(key ^ 0x9e37_79b9_7f4a_7c15)
            * u128::from(0xd1b5_4a32_d192_ed03_u64);
        (product as u64 ^ (product >> 64) as u64) as usize & mask
    };
    let mut slots = vec![NONE; count];
    for (i, segment) in segments.iter().enumerate() {
        let mut at = slot(segment.from);
        while slots[at] != NONE {
            at = (at + 1) & mask;
        }
        slots[at] = i as u32;
    }
    let mut is_followed = vec![false; segments.len()];
    segments
        .iter()
        .map(|segment| {
            let mut at = slot(segment.to);
            while slots[at] != NONE {
                let i = slots[at] as usize;
                if segments[i].from == segment.to && !is_followed[i] {
                    is_followed[i] = true;
                    return Some(slots[at]);
                }
                at = (at + 1) & mask;
            }
            None
        })
        .collect()
}

/// True if two lists have the same rings.
fn same(a: &[Ring], b: &[Ring]) -> bool {
    a.len() == b.len() && sorted(a) == sorted(b)
}

/// Rings as bits, each from its least point on, in order.
fn sorted(rings: &[Ring]) -> Vec<Vec<[u64; 2]>> {
    let mut rings: Vec<Vec<[u64; 2]>> = rings
        .iter()
        .map(|ring| {
            let mut bits: Vec<[u64; 2]> = ring
                .iter()
                .map(|p| (*p + DVec2::ZERO).to_array().map(f64::to_bits))
                .collect();
            let least = (0..bits.len()).min_by_key(|i| bits[*i]);
            bits.rotate_left(least.unwrap_or(0));
            bits
        })
        .collect();
    rings.sort_unstable();
    rings
}

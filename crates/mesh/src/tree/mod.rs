//! A tree of boxes around triangles, four to a node.
//!
//! In: triangles. Out: their order, in which those that are near to one another
//! follow one another, and nodes in a flat list. The boxes are in f32, rounded
//! outwards, so that one compares four at a time.
//!
//! ```text
//!  node 0 ─┬─ box, node 1 ─┬─ box, triangles 0 … 3
//!          ├─ box, node 2  ├─ box, triangles 4 … 6
//!          ├─ …            └─ …
//! ```
//!
//! Guarantees: the same triangles give the same tree on any number of threads.
//! A node lies behind the one that names it. No path from the root meets more
//! than [`DEEPEST`] nodes.

mod build;

use glam::{DVec3, Vec4};
use isocontour::Bounds;

/// Greatest number of triangles in a leaf.
pub(crate) const LEAF: usize = 4;
/// Greatest number of nodes on a path from the root.
pub(crate) const DEEPEST: usize = 72;
/// Most entries that a stack holds that looks at one node at a time: three
/// brothers of each node on the path, and the last one's four children.
pub(crate) const STACK: usize = 3 * DEEPEST + 4;

/// A child that is not there. Its box holds nothing.
const NOTHING: u32 = u32::MAX;
/// Marks a leaf. Below it are four bits of the number of triangles, and the
/// first one.
const IS_LEAF: u32 = 1 << 31;
const FIRST_BITS: u32 = 27;

/// Four boxes, and what is in them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Node {
    /// Lower sides, by axis and child.
    pub min: [[f32; 4]; 3],
    /// Upper sides, by axis and child.
    pub max: [[f32; 4]; 3],
    children: [u32; 4],
}

/// What is in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    Nothing,
    Node(usize),
    /// The first triangle, and the one after the last.
    Leaf(usize, usize),
}

impl Node {
    const EMPTY: Node = Node {
        min: [[f32::INFINITY; 4]; 3],
        max: [[f32::NEG_INFINITY; 4]; 3],
        children: [NOTHING; 4],
    };

    /// The lower sides of the four boxes along an axis.
    #[inline]
    pub(crate) fn low(&self, axis: usize) -> Vec4 {
        Vec4::from_array(self.min[axis])
    }

    /// The upper sides of the four boxes along an axis.
    #[inline]
    pub(crate) fn high(&self, axis: usize) -> Vec4 {
        Vec4::from_array(self.max[axis])
    }

    /// Box `i`.
    pub(crate) fn bounds(&self, i: usize) -> Bounds {
        let corner = |c: [f32; 3]| DVec3::from_array(c.map(f64::from));
        Bounds::new(
            corner([0, 1, 2].map(|k| self.min[k][i])),
            corner([0, 1, 2].map(|k| self.max[k][i])),
        )
    }

    /// Two numbers between which `row` · p + `offset` is for all places p in box
    /// `i`.
    #[inline]
    pub(crate) fn range(&self, i: usize, row: DVec3, offset: f64) -> [f64; 2] {
        // More than the roundings of the sums, here and for vertices.
        const SLACK: f64 = 1e-12;
        let (mut low, mut high) = (offset, offset);
        let mut size = offset.abs();
        for k in 0..3 {
            let a = row[k] * f64::from(self.min[k][i]);
            let b = row[k] * f64::from(self.max[k][i]);
            low += a.min(b);
            high += a.max(b);
            size += a.abs().max(b.abs());
        }
        [low - SLACK * size, high + SLACK * size]
    }

    /// What is in box `i`, as a stack holds it.
    #[inline]
    pub(crate) fn link(&self, i: usize) -> u32 {
        self.children[i]
    }
}

/// What a link leads to.
#[inline]
pub(crate) fn child(link: u32) -> Child {
    if link == NOTHING {
        Child::Nothing
    } else if link & IS_LEAF == 0 {
        Child::Node(link as usize)
    } else {
        let first = (link & ((1 << FIRST_BITS) - 1)) as usize;
        let count = ((link & !IS_LEAF) >> FIRST_BITS) as usize;
        Child::Leaf(first, first + count)
    }
}

fn leaf(first: usize, count: usize) -> u32 {
    IS_LEAF | (count as u32) << FIRST_BITS | first as u32
}

/// The tree.
#[derive(Debug)]
pub(crate) struct Tree {
    pub nodes: Vec<Node>,
}

impl Tree {
    /// Sorts triangles into a tree. Also returned: their numbers, in the tree's
    /// order.
    pub(crate) fn new(
        vertices: &[DVec3],
        corners: &[[u32; 3]],
    ) -> (Tree, Vec<u32>) {
        Tree::of(corners.len(), |i| {
            Bounds::around(corners[i].map(|i| vertices[i as usize]))
        })
    }

    /// Sorts so many things, no more than 2²⁷, by the boxes around them.
    pub(crate) fn of(
        count: usize,
        around: impl Fn(usize) -> Bounds + Sync,
    ) -> (Tree, Vec<u32>) {
        build::build(count, around)
    }

    /// Calls `visit` with the first triangle and the one after the last of each
    /// leaf in whose box `is_near` finds what is looked for. `is_near` tells it
    /// for the four boxes of a node.
    #[inline]
    pub(crate) fn visit(
        &self,
        is_near: impl Fn(&Node) -> [bool; 4],
        mut visit: impl FnMut(usize, usize),
    ) {
        let mut stack = [0u32; STACK];
        let mut top = usize::from(!self.nodes.is_empty());
        while top > 0 {
            top -= 1;
            let node = &self.nodes[stack[top] as usize];
            let near = is_near(node);
            for i in (0..4).rev() {
                if !near[i] {
                    continue;
                }
                match child(node.children[i]) {
                    Child::Nothing => {}
                    Child::Leaf(first, end) => visit(first, end),
                    Child::Node(next) => {
                        stack[top] = next as u32;
                        top += 1;
                    }
                }
            }
        }
    }
}

/// The corners of a box.
pub(crate) fn corners(over: &Bounds) -> [DVec3; 8] {
    [0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
        let end = |k: usize| {
            if i >> k & 1 == 0 {
                over.min[k]
            } else {
                over.max[k]
            }
        };
        DVec3::new(end(0), end(1), end(2))
    })
}

/// The greatest number of f32 that is not above `x`.
pub(crate) fn below(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x {
        near.next_down()
    } else {
        near
    }
}

/// The least number of f32 that is not below `x`.
pub(crate) fn above(x: f64) -> f32 {
    -below(-x)
}

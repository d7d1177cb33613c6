//! Triangles in the order of their tree, and what is asked of them.

use crate::closest::{Near, closest};
use crate::four;
use crate::tree::{Child, Node, STACK, Tree, child};
use glam::{DVec3, Vec4};

/// What roundings of coordinates may add to a distance, as a share of them.
pub(crate) const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// Triangles and their tree.
#[derive(Debug)]
pub(crate) struct Shell {
    pub vertices: Vec<DVec3>,
    pub corners: Vec<[u32; 3]>,
    pub tree: Tree,
}

impl Shell {
    /// Puts triangles, and their vertices, into the order of a tree.
    pub(crate) fn new(vertices: Vec<DVec3>, corners: Vec<[u32; 3]>) -> Shell {
        Shell::sorted(vertices, corners).0
    }

    /// The same. Also returned: for each vertex the number that it had.
    pub(crate) fn sorted(
        mut vertices: Vec<DVec3>,
        mut corners: Vec<[u32; 3]>,
    ) -> (Shell, Vec<u32>) {
        let (tree, order) = Tree::new(&vertices, &corners);
        corners = order.iter().map(|i| corners[*i as usize]).collect();
        drop(order);
        // What is near in space is near in memory.
        let mut numbers = vec![u32::MAX; vertices.len()];
        let mut order = Vec::with_capacity(vertices.len());
        for corner in corners.iter_mut().flatten() {
            let number = &mut numbers[*corner as usize];
            if *number == u32::MAX {
                *number = order.len() as u32;
                order.push(*corner);
            }
            *corner = *number;
        }
        drop(numbers);
        vertices = order.iter().map(|v| vertices[*v as usize]).collect();
        let shell = Shell {
            vertices,
            corners,
            tree,
        };
        (shell, order)
    }

    #[inline]
    pub(crate) fn triangle(&self, i: usize) -> [DVec3; 3] {
        self.corners[i].map(|v| self.vertices[v as usize])
    }

    /// The normal of a triangle, as long as twice its area.
    pub(crate) fn normal(&self, i: usize) -> DVec3 {
        let [a, b, c] = self.triangle(i);
        (b - a).cross(c - a)
    }

    /// Memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<DVec3>()
            + self.corners.capacity() * size_of::<[u32; 3]>()
            + self.tree.nodes.capacity() * size_of::<Node>()
    }

    /// How near a triangle is to a place.
    #[inline]
    pub(crate) fn look(&self, triangle: usize, p: DVec3) -> Near {
        let point = closest(p, self.triangle(triangle));
        Near {
            square: p.distance_squared(point),
            triangle,
            point,
        }
    }

    /// The triangle that is closest to a place. `guess` may name one that is
    /// near. It makes the search shorter, and never changes what is found: all
    /// triangles within the least distance and some roundings are looked at, and
    /// of several at the same distance the first counts.
    pub(crate) fn nearest(&self, p: DVec3, guess: usize) -> Near {
        let mut best = self.look(guess, p);
        let reach = Reach::around(p);
        let mut limit = reach.limit(best.square);
        let mut stack = [(0.0f32, 0u32); STACK];
        let mut top = usize::from(!self.tree.nodes.is_empty());
        while top > 0 {
            top -= 1;
            let (square, link) = stack[top];
            if square > limit {
                continue;
            }
            match child(link) {
                Child::Nothing => {}
                Child::Leaf(first, end) => {
                    let end_at = end - 1;
                    let four = [0, 1, 2, 3]
                        .map(|i| self.triangle((first + i).min(end_at)));
                    let bounds = four::squares(p, four);
                    for i in first..end {
                        if bounds[i - first] > limit {
                            continue;
                        }
                        let near = self.look(i, p);
                        if near.is_closer(&best) {
                            best = near;
                        }
                    }
                    limit = reach.limit(best.square);
                }
                Child::Node(at) => {
                    let node = &self.tree.nodes[at];
                    reach.push(node, limit, &mut stack, &mut top);
                }
            }
        }
        best
    }
}

/// Distances from a place to boxes, in f32.
pub(crate) struct Reach {
    p: [f32; 3],
    /// How far distances may be off, by rounding of the place.
    slack: f64,
}

impl Reach {
    pub(crate) fn around(p: DVec3) -> Reach {
        Reach {
            p: p.to_array().map(|x| x as f32),
            // Half a unit of the last place along each axis, and as much for the
            // difference: √3 · 2 · 2⁻²⁴ of the greatest coordinate.
            slack: 2.5e-7 * p.abs().max_element(),
        }
    }

    /// A box may hold what is within the root of `square` if its own square is
    /// not above this.
    #[inline]
    pub(crate) fn limit(&self, square: f64) -> f32 {
        let d = square.sqrt() + self.slack;
        // The sum of squares has a few roundings of its own.
        ((d * d * (1.0 + 1e-6)) as f32).min(f32::MAX) + f32::MIN_POSITIVE
    }

    /// Squares of the distances to the four boxes of a node.
    #[inline]
    pub(crate) fn squares(&self, node: &Node) -> [f32; 4] {
        let mut squares = Vec4::ZERO;
        for k in 0..3 {
            let p = Vec4::splat(self.p[k]);
            let out = (node.low(k) - p).max(p - node.high(k)).max(Vec4::ZERO);
            squares += out * out;
        }
        squares.to_array()
    }

    /// Puts those boxes of a node on a stack that may hold something as near as
    /// `limit`, the nearest one on top.
    #[inline]
    pub(crate) fn push(
        &self,
        node: &Node,
        limit: f32,
        stack: &mut [(f32, u32); STACK],
        top: &mut usize,
    ) {
        let base = *top;
        for (i, square) in self.squares(node).into_iter().enumerate() {
            if square <= limit {
                let mut place = *top;
                while place > base && stack[place - 1].0 < square {
                    stack[place] = stack[place - 1];
                    place -= 1;
                }
                stack[place] = (square, node.link(i));
                *top += 1;
            }
        }
    }
}

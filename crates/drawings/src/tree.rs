//! A tree of boxes in the plane.

use glam::DVec2;
use isocontour::Rect;

/// Boxes in a leaf.
const LEAF: usize = 4;

/// A tree over boxes, which are known by their numbers.
#[derive(Debug)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    /// The numbers of the boxes, those of a leaf beside one another.
    order: Vec<u32>,
    boxes: Vec<Rect>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Rect,
    /// The first of its boxes in the order, and how many; of an inner node the
    /// number of its second child, and 0. The first child is the next node.
    first: u32,
    count: u32,
}

/// Nodes that wait: the tree is halved, so it is not deeper than this.
type Stack = [u32; 64];

impl Tree {
    pub(crate) fn new(boxes: Vec<Rect>) -> Tree {
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut nodes = Vec::new();
        if !boxes.is_empty() {
            build(&boxes, &mut order, 0, &mut nodes);
        }
        Tree {
            nodes,
            order,
            boxes,
        }
    }

    pub(crate) fn bounds(&self) -> Rect {
        self.nodes.first().map_or(Rect::EMPTY, |node| node.bounds)
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
            + size_of_val(self.order.as_slice())
            + size_of_val(self.boxes.as_slice())
    }

    /// Calls a function with each box that is `wanted`, as are all boxes that
    /// hold it.
    pub(crate) fn each(
        &self,
        wanted: impl Fn(&Rect) -> bool,
        mut f: impl FnMut(usize),
    ) {
        let mut stack: Stack = [0; 64];
        let mut left = usize::from(!self.nodes.is_empty());
        while left > 0 {
            left -= 1;
            let at = stack[left];
            let node = &self.nodes[at as usize];
            if !wanted(&node.bounds) {
                continue;
            }
            if node.count == 0 {
                stack[left] = node.first;
                stack[left + 1] = at + 1;
                left += 2;
                continue;
            }
            let first = node.first as usize;
            for &i in &self.order[first..first + node.count as usize] {
                if wanted(&self.boxes[i as usize]) {
                    f(i as usize);
                }
            }
        }
    }

    /// Calls a function with the boxes that are nearer to a point than the
    /// square of the distance that the function returned last, near ones first
    /// as a rule. It gets that square, too.
    pub(crate) fn near(
        &self,
        p: DVec2,
        within2: f64,
        mut f: impl FnMut(usize, f64) -> f64,
    ) {
        let mut best = within2;
        let mut stack = [(0, 0.0); 64];
        let mut left = usize::from(!self.nodes.is_empty());
        while left > 0 {
            left -= 1;
            let (at, far): (u32, f64) = stack[left];
            if far > best {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.count == 0 {
                let child =
                    |i: u32| (i, self.nodes[i as usize].bounds.distance2(p));
                let (a, b) = (child(at + 1), child(node.first));
                let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                stack[left] = far;
                stack[left + 1] = near;
                left += 2;
                continue;
            }
            let first = node.first as usize;
            for &i in &self.order[first..first + node.count as usize] {
                if self.boxes[i as usize].distance2(p) <= best {
                    best = f(i as usize, best);
                }
            }
        }
    }
}

/// Makes the node of some boxes and all below it. Halves are equal in number,
/// so that the depth is that of the number's logarithm.
fn build(
    boxes: &[Rect],
    order: &mut [u32],
    first: usize,
    nodes: &mut Vec<Node>,
) {
    let of = |i: &u32| boxes[*i as usize];
    let bounds = order.iter().map(of).fold(Rect::EMPTY, Rect::union);
    let here = nodes.len();
    nodes.push(Node {
        bounds,
        first: first as u32,
        count: order.len() as u32,
    });
    if order.len() <= LEAF {
        return;
    }
    let centres = order.iter().map(|i| of(i).min + of(i).max);
    let spread = centres.fold(Rect::EMPTY, Rect::with).size();
    let axis = usize::from(spread.y > spread.x);
    let half = order.len() / 2;
    let centre = |i: &u32| (of(i).min + of(i).max)[axis];
    order.select_nth_unstable_by(half, |a, b| {
        centre(a).total_cmp(&centre(b)).then(a.cmp(b))
    });
    let (left, right) = order.split_at_mut(half);
    build(boxes, left, first, nodes);
    nodes[here].first = nodes.len() as u32;
    nodes[here].count = 0;
    build(boxes, right, first + half, nodes);
}

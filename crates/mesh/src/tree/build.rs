//! Builds a tree from above.
//!
//! A list of boxes is parted in two where the boxes on both sides, weighted by
//! how many triangles they hold, have the least surface: that is how often a
//! ball or a ray meets them. Only places at the borders of [`BINS`] equal parts
//! are looked at. Both halves are parted again, which makes a node of four.

use super::{DEEPEST, LEAF, Node, Tree, above, below, leaf};
use isocontour::Bounds;
use rayon::prelude::*;

/// Parts of a list's longest side.
const BINS: usize = 16;
/// A list that is longer is parted on several threads.
const SHARED: usize = 1 << 14;
/// Parting by surface may cut off few triangles at a time. Deeper down, lists
/// are halved. 27 halvings leave nothing of 2²⁷ triangles.
const BY_SURFACE: usize = DEEPEST - 28;

/// The box of a triangle or a strut.
#[derive(Clone, Copy)]
struct Item {
    min: [f32; 3],
    number: u32,
    max: [f32; 3],
}

impl Item {
    /// Twice the middle.
    fn middle(&self, axis: usize) -> f32 {
        self.min[axis] + self.max[axis]
    }
}

#[derive(Clone, Copy)]
struct Span {
    min: [f32; 3],
    max: [f32; 3],
}

impl Span {
    const EMPTY: Span = Span {
        min: [f32::INFINITY; 3],
        max: [f32::NEG_INFINITY; 3],
    };

    fn add(&mut self, min: [f32; 3], max: [f32; 3]) {
        for k in 0..3 {
            self.min[k] = self.min[k].min(min[k]);
            self.max[k] = self.max[k].max(max[k]);
        }
    }

    /// Half the surface.
    fn surface(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|k| self.max[k] - self.min[k]);
        if x < 0.0 {
            return 0.0;
        }
        x * y + y * z + z * x
    }
}

/// A list to be parted.
struct Part<'a> {
    items: &'a mut [Item],
    /// The place of its first item in the tree's order.
    first: usize,
    depth: usize,
}

pub(super) fn build(
    count: usize,
    around: impl Fn(usize) -> Bounds + Sync,
) -> (Tree, Vec<u32>) {
    let mut items: Vec<Item> = (0..count)
        .into_par_iter()
        .map(|number| {
            let Bounds { min, max } = around(number);
            Item {
                min: min.to_array().map(below),
                number: number as u32,
                max: max.to_array().map(above),
            }
        })
        .collect();
    let all = Part {
        items: &mut items,
        first: 0,
        depth: 0,
    };
    let nodes = parted(all);
    (
        Tree { nodes },
        items.iter().map(|item| item.number).collect(),
    )
}

/// The nodes below a list. The first one is the root.
fn parted(part: Part) -> Vec<Node> {
    if part.items.len() < SHARED {
        let mut nodes = Vec::with_capacity(part.items.len() / 2);
        append(part, &mut nodes);
        return nodes;
    }
    let (mut root, parts) = node(part);
    let below: Vec<(usize, Vec<Node>)> = parts
        .into_par_iter()
        .map(|(i, part)| (i, parted(part)))
        .collect();
    let count: usize = below.iter().map(|(_, nodes)| nodes.len()).sum();
    let mut all = Vec::with_capacity(1 + count);
    all.push(Node::EMPTY);
    for (i, nodes) in below {
        let by = all.len() as u32;
        root.children[i] = by;
        all.extend(nodes.into_iter().map(|mut node| {
            for link in &mut node.children {
                if *link >> 31 == 0 {
                    *link += by;
                }
            }
            node
        }));
    }
    all[0] = root;
    all
}

/// Appends the nodes below a list, the root first.
fn append(part: Part, nodes: &mut Vec<Node>) {
    let place = nodes.len();
    nodes.push(Node::EMPTY);
    let (mut root, parts) = node(part);
    for (i, part) in parts {
        root.children[i] = nodes.len() as u32;
        append(part, nodes);
    }
    nodes[place] = root;
}

/// A node of a list: up to four parts of it. The parts that are no leaves are
/// returned, with their places in the node.
fn node(part: Part) -> (Node, Vec<(usize, Part)>) {
    let mut parts = vec![part];
    for _ in 0..2 {
        parts = parts.into_iter().flat_map(halves).collect();
    }
    let mut node = Node::EMPTY;
    let mut inner = Vec::new();
    for (i, part) in parts.into_iter().enumerate() {
        let span = around(part.items);
        for k in 0..3 {
            node.min[k][i] = span.min[k];
            node.max[k][i] = span.max[k];
        }
        if part.items.len() <= LEAF {
            node.children[i] = leaf(part.first, part.items.len());
        } else {
            inner.push((i, part));
        }
    }
    (node, inner)
}

fn around(items: &[Item]) -> Span {
    let mut span = Span::EMPTY;
    for item in items {
        span.add(item.min, item.max);
    }
    span
}

/// The two halves of a list, or the list if it is short. The halves are one
/// level deeper.
fn halves(part: Part) -> Vec<Part> {
    let Part {
        items,
        first,
        depth,
    } = part;
    if items.len() <= LEAF {
        return vec![Part {
            items,
            first,
            depth,
        }];
    }
    let mut span = Span::EMPTY;
    for item in &*items {
        let middle = [0, 1, 2].map(|k| item.middle(k));
        span.add(middle, middle);
    }
    let size = [0, 1, 2].map(|k| span.max[k] - span.min[k]);
    let axis = (1..3).fold(0, |a, b| if size[b] > size[a] { b } else { a });
    let by_surface = if depth < BY_SURFACE && size[axis] > 0.0 {
        least_surface(items, axis, span.min[axis], size[axis])
    } else {
        None
    };
    let at = by_surface.unwrap_or_else(|| {
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| {
            let by_middle = a.middle(axis).total_cmp(&b.middle(axis));
            by_middle.then(a.number.cmp(&b.number))
        });
        half
    });
    let (left, right) = items.split_at_mut(at);
    let depth = depth + 1;
    vec![
        Part {
            items: left,
            first,
            depth,
        },
        Part {
            items: right,
            first: first + at,
            depth,
        },
    ]
}

/// Parts a list where the surfaces are least. Returned: the length of the first
/// part. None if all would be in one part.
fn least_surface(
    items: &mut [Item],
    axis: usize,
    from: f32,
    size: f32,
) -> Option<usize> {
    let scale = BINS as f32 / size;
    if !scale.is_finite() {
        return None;
    }
    let bin = |item: &Item| {
        (((item.middle(axis) - from) * scale) as usize).min(BINS - 1)
    };
    let mut bins = [(0usize, Span::EMPTY); BINS];
    for item in &*items {
        let (count, span) = &mut bins[bin(item)];
        *count += 1;
        span.add(item.min, item.max);
    }
    let mut costs = [0.0f32; BINS];
    let (mut count, mut span) = (0, Span::EMPTY);
    for i in (1..BINS).rev() {
        count += bins[i].0;
        span.add(bins[i].1.min, bins[i].1.max);
        costs[i] = count as f32 * span.surface();
    }
    let (mut count, mut span) = (0, Span::EMPTY);
    let mut best = (f32::INFINITY, 0);
    for i in 1..BINS {
        count += bins[i - 1].0;
        span.add(bins[i - 1].1.min, bins[i - 1].1.max);
        let cost = count as f32 * span.surface() + costs[i];
        if count > 0 && count < items.len() && cost < best.0 {
            best = (cost, i);
        }
    }
    let (_, cut) = best;
    (cut > 0).then(|| partition(items, |item| bin(item) < cut))
}

/// Moves the items that are `first` before the others, and counts them.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let (mut from, mut to) = (0, items.len());
    loop {
        while from < to && first(&items[from]) {
            from += 1;
        }
        while from < to && !first(&items[to - 1]) {
            to -= 1;
        }
        if from >= to {
            return from;
        }
        items.swap(from, to - 1);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Child, child};
    use super::*;
    use glam::DVec3;

    fn check(vertices: &[DVec3], corners: &[[u32; 3]]) {
        let (tree, order) = Tree::new(vertices, corners);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..corners.len() as u32));
        let mut depths = vec![1; tree.nodes.len()];
        let mut seen = vec![false; corners.len()];
        for (at, node) in tree.nodes.iter().enumerate() {
            for i in 0..4 {
                match child(node.link(i)) {
                    Child::Nothing => {}
                    Child::Node(next) => {
                        assert!(next > at);
                        depths[next] = depths[at] + 1;
                        assert!(depths[next] <= DEEPEST);
                    }
                    Child::Leaf(first, end) => {
                        for t in first..end {
                            assert!(!std::mem::replace(&mut seen[t], true));
                            for v in corners[order[t] as usize] {
                                let v = vertices[v as usize];
                                for k in 0..3 {
                                    let (min, max) =
                                        (node.min[k][i], node.max[k][i]);
                                    assert!(f64::from(min) <= v[k]);
                                    assert!(f64::from(max) >= v[k]);
                                }
                            }
                        }
                    }
                }
            }
        }
        assert!(seen.iter().all(|s| *s));
    }

    #[test]
    fn all_triangles_are_in_boxes_around_them() {
        let mut rng = fastrand::Rng::with_seed(1);
        let vertices: Vec<DVec3> = (0..60_000)
            .map(|_| DVec3::from_array([0; 3].map(|_| rng.f64() - 0.3)))
            .collect();
        let corners: Vec<[u32; 3]> =
            (0..20_000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        check(&vertices, &corners);
        check(&vertices, &corners[..1]);
        check(&vertices, &corners[..9]);
    }

    #[test]
    fn hostile_triangles_make_no_deep_tree() {
        // All at one place, and each twice as far as the one before.
        let same = vec![[0, 1, 2]; 5000];
        check(&[DVec3::ZERO, DVec3::X, DVec3::Y], &same);
        let far: Vec<DVec3> = (0..3000)
            .flat_map(|i| {
                let x = f64::from(i % 250 - 120).exp2();
                [DVec3::X, DVec3::Y, DVec3::Z].map(|v| v * x)
            })
            .collect();
        let corners: Vec<[u32; 3]> =
            (0..3000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        check(&far, &corners);
    }

    #[test]
    fn rounding_is_outwards() {
        for x in [0.1, -0.1, 1.0, 1e9 + 0.3, -1e-30, 0.0] {
            assert!(f64::from(below(x)) <= x && x <= f64::from(above(x)));
        }
    }
}

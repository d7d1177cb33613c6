//! A tree of points in space, with the ranges of what is known of them.

use glam::DVec3;
use isocontour::Bounds;

/// Distances are rounded, so that what is hardly too far away is looked at too.
pub(super) const SLACK: f64 = 1e-9;

/// Points in a leaf.
const LEAF: usize = 8;

/// A tree over points, which are in its order: each node's are beside one
/// another.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    first: u32,
    count: u32,
    /// The number of the second child; 0 in a leaf. The first is the next.
    second: u32,
}

/// The nearest points of a place, near ones first.
#[derive(Debug)]
pub(super) struct Near {
    /// Squares of distances, and numbers of points.
    pub(super) points: Vec<(f64, usize)>,
    most: usize,
}

impl Near {
    /// At most `most` points.
    pub(super) fn new(most: usize) -> Near {
        Near {
            points: Vec::with_capacity(most + 1),
            most,
        }
    }

    /// The square of the distance beyond which points do not count.
    pub(super) fn within2(&self) -> f64 {
        match self.points.last() {
            Some((far2, _)) if self.points.len() == self.most => *far2,
            _ => f64::INFINITY,
        }
    }

    pub(super) fn add(&mut self, far2: f64, point: usize) {
        let new = (far2, point);
        if self.points.len() < self.most {
            self.points.push(new);
        } else {
            match self.points.last_mut() {
                Some(last) if new < *last => *last = new,
                _ => return,
            }
        }
        // The list is short, and most points belong near its end.
        let mut at = self.points.len() - 1;
        while at > 0 && new < self.points[at - 1] {
            self.points.swap(at, at - 1);
            at -= 1;
        }
    }
}

impl Tree {
    /// Of points, and the order into which they have to be brought.
    pub(super) fn new(points: &[DVec3]) -> (Tree, Vec<u32>) {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut nodes = Vec::new();
        if !order.is_empty() {
            build(points, &mut order, 0, &mut nodes);
        }
        (Tree { nodes }, order)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// The box around all points.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        self.nodes.first().map(|node| node.bounds)
    }

    /// What all points of each node have in common, by what each point is and
    /// what two sets of them have in common.
    pub(super) fn summed<T: Copy>(
        &self,
        of: impl Fn(usize) -> T,
        both: impl Fn(T, T) -> T,
    ) -> Vec<T> {
        // Children come after their parents.
        let mut sums: Vec<T> = Vec::with_capacity(self.nodes.len());
        let last = self.nodes.len().wrapping_sub(1);
        for (at, node) in self.nodes.iter().enumerate().rev() {
            let sum = if node.second == 0 {
                let first = node.first as usize;
                let rest = first + 1..first + node.count as usize;
                rest.fold(of(first), |sum, i| both(sum, of(i)))
            } else {
                let [a, b] = [at + 1, node.second as usize];
                both(sums[last - a], sums[last - b])
            };
            sums.push(sum);
        }
        sums.reverse();
        sums
    }

    /// Calls a function with nodes, by their numbers and boxes, and whether
    /// they are leaves. It returns whether those in a node are wanted.
    pub(super) fn each(&self, mut f: impl FnMut(usize, &Bounds, bool) -> bool) {
        let mut todo = vec![0];
        while let Some(at) = todo.pop() {
            let Some(node) = self.nodes.get(at) else {
                continue;
            };
            let leaf = node.second == 0;
            if f(at, &node.bounds, leaf) && !leaf {
                todo.extend([at + 1, node.second as usize]);
            }
        }
    }

    /// The points that are nearest to a place.
    pub(super) fn near(&self, points: &[DVec3], p: DVec3, near: &mut Near) {
        let mut todo = vec![(0.0, 0)];
        while let Some((far2, at)) = todo.pop() {
            let Some(node) = self.nodes.get(at) else {
                continue;
            };
            if far2 > near.within2() {
                continue;
            }
            if node.second == 0 {
                let first = node.first as usize;
                let all = points.iter().enumerate();
                for (i, q) in all.skip(first).take(node.count as usize) {
                    near.add((p - *q).length_squared(), i);
                }
                continue;
            }
            let mut children = [at + 1, node.second as usize].map(|i| {
                let bounds = self.nodes.get(i).map(|n| n.bounds);
                (bounds.map_or(f64::INFINITY, |b| b.distance2(p)), i)
            });
            // The near one is taken first.
            if children[0].0 < children[1].0 {
                children.swap(0, 1);
            }
            todo.extend(children);
        }
    }

    /// How far from the middle of a ball those points are at most that are among the
    /// `most` nearest of any place in the ball: no farther from the place than those of
    /// the middle.
    pub(super) fn reach(
        &self,
        points: &[DVec3],
        middle: DVec3,
        radius: f64,
        most: usize,
    ) -> f64 {
        let mut near = Near::new(most);
        self.near(points, middle, &mut near);
        let last = near.points.last().map_or(0.0, |p| p.0.sqrt());
        (last + 2.0 * radius) * (1.0 + SLACK) + SLACK
    }

    /// Adds all points within a distance of a place, each with its distance.
    pub(super) fn within(
        &self,
        points: &[DVec3],
        p: DVec3,
        far: f64,
        found: &mut Vec<(f64, usize)>,
    ) {
        let far2 = far * far;
        self.each(|at, bounds, leaf| {
            let wanted = bounds.distance2(p) <= far2;
            if let (true, true, Some(node)) = (wanted, leaf, self.nodes.get(at))
            {
                let first = node.first as usize;
                let all = points.iter().enumerate();
                let all = all.skip(first).take(node.count as usize);
                let all = all.map(|(i, q)| ((p - *q).length(), i));
                found.extend(all.filter(|(away, _)| *away <= far));
            }
            wanted
        });
    }
}

/// Makes the node of some points and all below it, by halves.
fn build(
    points: &[DVec3],
    order: &mut [u32],
    first: usize,
    nodes: &mut Vec<Node>,
) {
    let of = |i: &u32| points[*i as usize];
    let bounds = Bounds::around(order.iter().map(of));
    let here = nodes.len();
    nodes.push(Node {
        bounds,
        first: first as u32,
        count: order.len() as u32,
        second: 0,
    });
    if order.len() <= LEAF {
        return;
    }
    let size = bounds.size();
    let axis = size.max_position();
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |a, b| {
        of(a)[axis].total_cmp(&of(b)[axis]).then(a.cmp(b))
    });
    let (left, right) = order.split_at_mut(half);
    build(points, left, first, nodes);
    nodes[here].second = nodes.len() as u32;
    build(points, right, first + half, nodes);
}

//! Joins the leaves' pieces of outline into closed rings.
//!
//! Within a batch of leaves the pieces are connected as they are found. A
//! vertex on the border of two batches exists once in each, at one place (both
//! brought it onto f = 0 on the same lattice edge): where one batch's chain
//! ends, the other's goes on. Chains also go on in this way from a divided cell
//! (`divide`) to the next cell. A crossing has the number of its lattice edge.
//! A crossing that only a divided cell knows also has the number of the edge's
//! part.

use crate::field::{LEAF, Lattice, Leaf};
use crate::plane::Ring;
use glam::DVec2;
use std::collections::BTreeSet;

/// Stands for no vertex.
pub(super) const NONE: u32 = u32::MAX;

/// A crossing of a lattice edge: the edge's number and the part of it, or
/// [`Crossing::WHOLE`] if the edge has one crossing that its ends show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Crossing {
    pub edge: u32,
    pub part: u32,
}

impl Crossing {
    /// Stands for the edge as a whole in place of a part's number.
    pub(super) const WHOLE: u32 = u32::MAX;
    /// The key of a vertex that lies within a cell.
    pub(super) const NONE: Crossing = Crossing {
        edge: u32::MAX,
        part: 0,
    };

    pub(super) fn whole(edge: u32) -> Crossing {
        let part = Self::WHOLE;
        Crossing { edge, part }
    }
}

/// A crossing, and the vertex there at which a chain ends or begins.
type Loose = (Crossing, u32);

/// The samples that are missing from a layer whose chains do not close.
#[derive(Default)]
pub(super) struct Missing {
    /// Leaves beside loose ends that were not sampled, by column and row.
    pub leaves: Vec<[usize; 2]>,
    /// Cells beside crossings that only the next cell knows, by column and row.
    pub cells: Vec<[usize; 2]>,
}

/// A closed ring.
#[derive(Clone, Default)]
pub(super) struct Joined {
    pub points: Ring,
    /// True for each point that lies on an edge of the lattice or of a divided
    /// cell.
    pub fixed: Vec<bool>,
}

impl Joined {
    /// Adds a point, unless it equals the last one.
    pub(super) fn push(&mut self, point: DVec2, fixed: bool) {
        if self.points.last() != Some(&point) {
            self.points.push(point);
            self.fixed.push(fixed);
        }
    }
}

/// A vertex and what follows it.
#[derive(Clone)]
struct Link {
    point: DVec2,
    crossing: Crossing,
    next: u32,
    /// The points on the way to the next vertex, as numbers. Most points of a
    /// finely curved outline are such points. They are kept apart from
    /// vertices, which need more memory.
    between: [u32; 2],
    has_previous: bool,
}

/// One layer's vertices, and how they follow each other.
///
/// Missing samples are asked for many times, each time after a little was
/// added. So results about earlier vertices are kept.
#[derive(Clone, Default)]
pub(super) struct Chains {
    links: Vec<Link>,
    /// The points between vertices.
    between: Vec<DVec2>,
    leaves: Vec<(u32, u32)>,
    /// Cells that were divided, by column and row.
    divided: Vec<[usize; 2]>,
    /// Leaves in which no more cells are divided.
    left: BTreeSet<[usize; 2]>,
    loose: LooseEnds,
    /// Vertices on whole lattice edges, in the order of the edges, and the
    /// number of vertices among which they were looked for.
    whole: (Vec<(u32, u32)>, usize),
}

/// The vertices at which chains break off.
#[derive(Clone, Default)]
struct LooseEnds {
    /// The vertices at which a chain ends, and those at which one begins, in
    /// order.
    lists: [Vec<Loose>; 2],
    /// The number of vertices among which they were looked for.
    among: usize,
    /// Earlier vertices that have lost their next or their previous vertex
    /// since.
    cut: Vec<u32>,
    /// True if nothing was missing with these lists.
    closed: bool,
}

impl Chains {
    /// Notes that a leaf has been sampled.
    pub(super) fn visited(&mut self, leaf: &Leaf) {
        self.leaves.push((leaf.i as u32, leaf.j as u32));
    }

    /// Notes that nothing more can be found out from a leaf.
    pub(super) fn leave(&mut self, leaf: &Leaf) {
        self.left.insert([leaf.i, leaf.j]);
    }

    /// Notes that a cell has been divided.
    pub(super) fn divided(&mut self, cell: [usize; 2]) {
        self.divided.push(cell);
    }

    /// Adds a vertex on an edge of the lattice or of a divided cell, and
    /// returns its number. Straight lines between such vertices do not cross.
    pub(super) fn add(&mut self, point: DVec2, crossing: Crossing) -> u32 {
        self.links.push(Link {
            point,
            crossing,
            next: NONE,
            between: [0; 2],
            has_previous: false,
        });
        self.links.len() as u32 - 1
    }

    /// Lets `to` follow `from`. Both have been added since the loose ends were
    /// last looked for.
    pub(super) fn connect(&mut self, from: u32, to: u32) {
        self.links[from as usize].next = to;
        self.links[to as usize].has_previous = true;
    }

    /// Lets `to` follow `from`, with points between them.
    pub(super) fn connect_through(
        &mut self,
        from: u32,
        points: impl Iterator<Item = DVec2>,
        to: u32,
    ) {
        let first = self.between.len() as u32;
        self.between.extend(points);
        self.links[from as usize].between = [first, self.between.len() as u32];
        self.connect(from, to);
    }

    /// Looks for the vertices at which a chain ends, and those at which one
    /// begins, by lattice edge. False if the lists have not changed.
    fn find_loose(&mut self) -> bool {
        let loose = &mut self.loose;
        if loose.among == self.links.len() && loose.cut.is_empty() {
            return false;
        }
        let role = |link: &Link| match (link.has_previous, link.next != NONE) {
            (true, false) => Some(0),
            (false, true) => Some(1),
            _ => None,
        };
        if !loose.cut.is_empty() {
            for (n, list) in loose.lists.iter_mut().enumerate() {
                let links = &self.links;
                list.retain(|l| role(&links[l.1 as usize]) == Some(n));
            }
        }
        let new = loose.among as u32..self.links.len() as u32;
        for i in loose.cut.drain(..).chain(new) {
            let link = &self.links[i as usize];
            if let Some(n) = role(link) {
                loose.lists[n].push((link.crossing, i));
            }
        }
        for list in &mut loose.lists {
            // The stable sort is fast on lists that are already in order.
            list.sort();
            list.dedup();
        }
        loose.among = self.links.len();
        true
    }

    /// The samples that are missing for the chains to close.
    pub(super) fn missing(&mut self, lattice: &Lattice) -> Missing {
        if !self.find_loose() && self.loose.closed {
            return Missing::default();
        }
        let [ends, starts] = &self.loose.lists;
        let mut lonely = without(ends, starts);
        lonely.extend(without(starts, ends));
        self.leaves.sort();
        self.divided.sort();
        let (sampled, divided) = (&self.leaves, &self.divided);
        let mut leaves: Vec<[usize; 2]> = Vec::new();
        let mut cells: Vec<[usize; 2]> = Vec::new();
        for c in lonely {
            for [i, j] in beside(c.edge, lattice) {
                let [a, b] = [i, j].map(|k| k / LEAF * LEAF);
                let leaf = (a as u32, b as u32);
                if sampled.binary_search(&leaf).is_err() {
                    leaves.push([a, b]);
                } else if c.part != Crossing::WHOLE
                    && divided.binary_search(&[i, j]).is_err()
                    && !self.left.contains(&[a, b])
                {
                    cells.push([i, j]);
                }
            }
        }
        leaves.sort_unstable();
        leaves.dedup();
        cells.sort_unstable();
        cells.dedup();
        self.loose.closed = leaves.is_empty() && cells.is_empty();
        Missing { leaves, cells }
    }

    /// Takes the outline's pieces across cells that are to be divided out of
    /// the chains.
    pub(super) fn clear(&mut self, cells: &[[usize; 2]], lattice: &Lattice) {
        let width = lattice.width() + 1;
        let node = |i: usize, j: usize| 2 * (j * width + i) as u32;
        // The cells of each edge.
        let mut owners: Vec<(u32, usize)> = Vec::with_capacity(4 * cells.len());
        for (n, &[i, j]) in cells.iter().enumerate() {
            let [south, north] = [node(i, j), node(i, j + 1)];
            let edges = [south, north, south + 1, node(i + 1, j) + 1];
            owners.extend(edges.map(|edge| (edge, n)));
        }
        owners.sort_unstable();
        // A cell that was not divided knows whole edges only. Parts of them
        // belong to the next cell, whose outline may turn back on the same
        // edge.
        let owners_of = |c: Crossing| {
            let from = owners.partition_point(|o| o.0 < c.edge);
            let own = owners[from..].iter().take_while(move |o| o.0 == c.edge);
            own.filter(move |_| c.part == Crossing::WHOLE).map(|o| o.1)
        };
        let (whole, among) = &mut self.whole;
        for (link, i) in self.links.iter().zip(0..).skip(*among) {
            if link.crossing.part == Crossing::WHOLE {
                whole.push((link.crossing.edge, i));
            }
        }
        whole.sort();
        *among = self.links.len();
        let mut edges: Vec<u32> = owners.iter().map(|o| o.0).collect();
        edges.dedup();
        let of = |edge: u32| {
            let from = whole.partition_point(|w| w.0 < edge);
            whole[from..].iter().take_while(move |w| w.0 == edge)
        };
        for &(_, first) in edges.into_iter().flat_map(of) {
            let first = first as usize;
            let crossing = self.links[first].crossing;
            // Follows the outline from where it enters the cell to where it
            // leaves it.
            let mut path = vec![first];
            let mut at = self.links[first].next;
            while at != NONE {
                path.push(at as usize);
                if self.links[at as usize].crossing != Crossing::NONE {
                    break;
                }
                at = self.links[at as usize].next;
            }
            if at == NONE {
                continue;
            }
            let end = self.links[at as usize].crossing;
            if !owners_of(crossing).any(|n| owners_of(end).any(|m| m == n)) {
                continue;
            }
            for pair in path.windows(2) {
                let cut = &mut self.links[pair[0]];
                (cut.next, cut.between) = (NONE, [0; 2]);
                self.links[pair[1]].has_previous = false;
                self.loose.cut.extend(pair.iter().map(|&i| i as u32));
            }
        }
    }

    /// A vertex at which a chain ends or begins, with its place.
    fn lonely(
        &self,
        (Crossing { edge, .. }, vertex): Loose,
        ends: bool,
    ) -> (u32, f64, u32, bool) {
        let dir = (edge % 2) as usize;
        let along = self.links[vertex as usize].point[dir];
        (edge, along, vertex, ends)
    }

    /// Gives back the memory that was kept for more vertices. In a large layer
    /// that may be as much as the rings take.
    pub(super) fn shrink(&mut self) {
        self.links.shrink_to_fit();
        self.between.shrink_to_fit();
    }

    /// The closed rings, and the number of rings that had to be closed by
    /// force.
    pub(super) fn into_rings(mut self) -> (Vec<Joined>, usize) {
        self.find_loose();
        let [ends, starts] = std::mem::take(&mut self.loose.lists);
        // The ends on edges that remain: the edge's number, the place along it,
        // the vertex, and true if a chain ends there.
        let mut lonely: Vec<(u32, f64, u32, bool)> = Vec::new();
        let mut taken = vec![false; starts.len()];
        for (crossing, end) in ends {
            let at = starts.partition_point(|s| s.0 < crossing);
            if let Some(&(c, start)) = starts.get(at)
                && c == crossing
            {
                // A leaf that was sampled again may have a vertex twice: once
                // on a whole edge, and once among the parts.
                self.links[start as usize].point =
                    self.links[end as usize].point;
                self.connect(end, start);
                taken[at] = true;
            } else {
                lonely.push(self.lonely((crossing, end), true));
            }
        }
        let left = starts.iter().zip(taken).filter(|(_, taken)| !taken);
        lonely.extend(left.map(|(start, _)| self.lonely(*start, false)));
        // The cells on both sides of an edge disagree, and nothing more can be
        // found out. A part of the edge that only one of them takes to be
        // inside ends at the edge.
        lonely.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for edge in lonely.chunk_by(|a, b| a.0 == b.0) {
            for pair in edge.as_chunks::<2>().0 {
                match *pair {
                    [(_, _, end, true), (_, _, start, false)]
                    | [(_, _, start, false), (_, _, end, true)] => {
                        self.connect(end, start);
                    }
                    _ => {}
                }
            }
        }
        let mut seen = vec![false; self.links.len()];
        let mut rings = Vec::new();
        let mut forced = 0;
        // Open chains come first, from their beginnings, then the closed ones.
        let open = (0..seen.len()).filter(|&i| !self.links[i].has_previous);
        for first in open.chain(0..seen.len()) {
            if seen[first] || self.links[first].next == NONE {
                continue;
            }
            let mut ring = Joined::default();
            let mut i = first;
            loop {
                seen[i] = true;
                let link = &self.links[i];
                ring.push(link.point, true);
                let [from, to] = link.between.map(|k| k as usize);
                for &point in &self.between[from..to] {
                    ring.push(point, false);
                }
                match link.next {
                    NONE => {
                        forced += 1;
                        break;
                    }
                    n if seen[n as usize] => break,
                    n => i = n as usize,
                }
            }
            rings.push(ring);
        }
        (rings, forced)
    }
}

/// The crossings of the first list that are not in the second. Both lists are
/// in order.
fn without(first: &[Loose], second: &[Loose]) -> Vec<Crossing> {
    let mut rest = second.iter().map(|x| x.0).peekable();
    let mut out = Vec::new();
    for &(crossing, _) in first {
        while rest.next_if(|other| *other < crossing).is_some() {}
        if rest.peek() != Some(&crossing) {
            out.push(crossing);
        }
    }
    out
}

/// Column and row of the cells on both sides of a lattice edge.
fn beside(
    edge: u32,
    lattice: &Lattice,
) -> impl Iterator<Item = [usize; 2]> + '_ {
    let width = lattice.width() + 1;
    let (node, dir) = ((edge / 2) as usize, (edge % 2) as usize);
    let (i, j) = (node % width, node / width);
    [0, 1].into_iter().filter_map(move |back| {
        let ci = i.checked_sub(if dir == 1 { back } else { 0 })?;
        let cj = j.checked_sub(if dir == 0 { back } else { 0 })?;
        let within = ci < lattice.width() && cj < lattice.height();
        within.then_some([ci, cj])
    })
}

//! Calls that are alike at many nodes of a leaf.
//!
//! A call that does not read y, as that of a picture that is seen along y, has one
//! row of values in a leaf. It is asked there, and not at all of the nodes.

use super::NODES;

/// The nodes of a leaf at which a call may differ: the first of its columns and
/// rows.
pub(super) struct Repeat {
    columns: usize,
    rows: usize,
}

impl Repeat {
    /// Of a call that reads some of the coordinates; none if it may differ at
    /// all nodes.
    pub(super) fn of([x, y, ..]: [bool; 4]) -> Option<Repeat> {
        let [columns, rows] = [x, y].map(|read| if read { NODES } else { 1 });
        (columns * rows < NODES * NODES).then_some(Repeat { columns, rows })
    }

    /// What stands at these nodes, given what stands at all nodes of leaves.
    pub(super) fn gather(&self, all: &[f32]) -> Vec<f32> {
        let mut out = Vec::with_capacity(self.count(all.len()));
        for leaf in all.chunks_exact(NODES * NODES) {
            for row in leaf.chunks_exact(NODES).take(self.rows) {
                out.extend_from_slice(&row[..self.columns]);
            }
        }
        out
    }

    /// How many these nodes are, of a number of nodes of leaves.
    pub(super) fn count(&self, all: usize) -> usize {
        all / (NODES * NODES) * (self.columns * self.rows)
    }

    /// What stands at all nodes, given what stands at these.
    pub(super) fn spread(&self, some: &[f32]) -> Vec<f32> {
        let leaves = some.len() / (self.rows * self.columns);
        let mut out = Vec::with_capacity(leaves * NODES * NODES);
        for leaf in some.chunks_exact(self.rows * self.columns) {
            let rows = leaf.chunks_exact(self.columns).cycle();
            for row in rows.take(NODES) {
                match row {
                    [same] => out.extend([*same; NODES]),
                    row => out.extend_from_slice(row),
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_alike_comes_back_at_all_nodes() {
        for (x, y) in [(true, false), (false, true), (false, false)] {
            let value = |n: usize| {
                let (leaf, n) = (n / (NODES * NODES), n % (NODES * NODES));
                let column = if x { n % NODES } else { 0 };
                let row = if y { n / NODES } else { 0 };
                (1000 * leaf + 10 * row + column) as f32
            };
            let all: Vec<f32> = (0..3 * NODES * NODES).map(value).collect();
            let repeat = Repeat::of([x, y, true, false]).unwrap();
            let some = repeat.gather(&all);
            assert_eq!(some.len(), repeat.count(all.len()));
            assert!(some.len() <= 3 * NODES, "{}", some.len());
            assert_eq!(repeat.spread(&some), all);
        }
        assert!(Repeat::of([true, true, false, false]).is_none());
    }
}

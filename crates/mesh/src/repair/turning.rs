//! Neighbours that do not go round the same way.
//!
//! Two triangles that alone share an edge must go along it in opposite
//! directions. From neighbour to neighbour that says, for all triangles that hang
//! together, which of them are to be turned: those that have less area.

use super::Work;
use crate::edges::each_edge;

/// Turns triangles so that neighbours agree. What has one side only, as a Möbius
/// strip, keeps edges at which they do not.
pub(super) fn agree(work: &mut Work) {
    let mut sheets = Sheets::new(work.corners.len());
    each_edge(&work.corners, work.vertices.len(), |edge| {
        let mut sides = edge.sides();
        if let (2, Some(a), Some(b)) =
            (edge.count(), sides.next(), sides.next())
        {
            sheets.join(a.triangle, b.triangle, a.is_down == b.is_down);
        }
    });
    let mut areas = vec![[0.0; 2]; work.corners.len()];
    for i in 0..work.corners.len() {
        let (sheet, differs) = sheets.of(i as u32);
        areas[sheet as usize][usize::from(differs)] += work.area(i);
    }
    for i in 0..work.corners.len() {
        let (sheet, differs) = sheets.of(i as u32);
        let [same, other] = areas[sheet as usize];
        if differs == (same >= other) {
            work.turn(i);
        }
    }
}

/// Triangles that hang together, and which of them go round like the first one.
struct Sheets {
    /// For each triangle another one of its sheet, or itself.
    parents: Vec<u32>,
    /// True if it does not go round like that.
    differs: Vec<bool>,
}

impl Sheets {
    fn new(count: usize) -> Sheets {
        Sheets {
            parents: (0..count as u32).collect(),
            differs: vec![false; count],
        }
    }

    /// The first triangle of a sheet, and true if one does not go round like it.
    fn of(&mut self, mut triangle: u32) -> (u32, bool) {
        let mut differs = false;
        loop {
            let i = triangle as usize;
            let parent = self.parents[i] as usize;
            if parent == i {
                return (triangle, differs);
            }
            // The way becomes half as long.
            self.differs[i] ^= self.differs[parent];
            self.parents[i] = self.parents[parent];
            differs ^= self.differs[i];
            triangle = self.parents[i];
        }
    }

    fn join(&mut self, a: u32, b: u32, differ: bool) {
        let ((a, a_differs), (b, b_differs)) = (self.of(a), self.of(b));
        if a != b {
            let (low, high) = (a.min(b), a.max(b));
            self.parents[high as usize] = low;
            self.differs[high as usize] = differ ^ a_differs ^ b_differs;
        }
    }
}

//! The nearest samples of places that are near to one another.
//!
//! In: places one after another, in any order. Out: the same samples that the
//! [`Tree`] finds for each place alone. Places are sorted into small cells. What may
//! be nearest to any place of a cell is collected once, when the second place in it
//! is asked for.

use super::tree::{Near, SLACK, Tree};
use glam::DVec3;
use std::collections::HashMap;

/// Side of a cell, as a share of the distance of the samples that count at the first
/// place. With places at a third of the samples' distances, a value takes 9,300
/// instructions instead of 16,800; with twice the side, more.
const SIDE: f64 = 0.6;
/// From the middle of a cell to its corner, as a share of its side: √3/2 and a
/// hair.
const CORNER: f64 = 0.8661;
/// Cells with more samples are not kept: there the tree is as fast.
const MOST: usize = 600;
/// Samples in all cells, 16 bytes each, after which the cells are forgotten.
const KEPT: usize = 1 << 17;

/// A sample: its distance from the middle of the cell, its number.
type Sample = (f64, usize);

enum Cell {
    /// One place in it was asked for.
    Once,
    /// What may be nearest to a place in it, near ones first.
    Known(Vec<Sample>),
    /// It has too many.
    Crowded,
}

/// A search for the nearest samples of many places.
pub(super) struct Cells<'a> {
    tree: &'a Tree,
    points: &'a [DVec3],
    /// Samples that count at a place.
    most: usize,
    /// The side of a cell; nothing before the first place.
    side: Option<f64>,
    cells: HashMap<[i64; 3], Cell>,
    /// Samples in all cells.
    kept: usize,
}

impl<'a> Cells<'a> {
    pub(super) fn new(
        tree: &'a Tree,
        points: &'a [DVec3],
        most: usize,
    ) -> Cells<'a> {
        Cells {
            tree,
            points,
            most,
            side: None,
            cells: HashMap::new(),
            kept: 0,
        }
    }

    /// The samples that are nearest to a place.
    pub(super) fn near(&mut self, p: DVec3) -> Near {
        let Some(side) = self.side else {
            let near = self.alone(p);
            let far = near.points.last().map_or(0.0, |last| last.0.sqrt());
            self.side = Some(SIDE * far);
            return near;
        };
        let key = (p / side).floor().to_array().map(|c| c as i64);
        let middle = DVec3::from_array(key.map(|c| (c as f64 + 0.5) * side));
        let off = p.distance(middle);
        // Far from the origin numbers of cells are no longer exact.
        if off.is_nan() || off > CORNER * side {
            return self.alone(p);
        }
        match self.cells.get(&key) {
            None => {
                self.cells.insert(key, Cell::Once);
                return self.alone(p);
            }
            Some(Cell::Crowded) => return self.alone(p),
            Some(Cell::Once) => self.collect(key, middle, CORNER * side),
            Some(Cell::Known(_)) => {}
        }
        match self.cells.get(&key) {
            Some(Cell::Known(all)) => self.among(all, p, off),
            _ => self.alone(p),
        }
    }

    fn alone(&self, p: DVec3) -> Near {
        let mut near = Near::new(self.most);
        self.tree.near(self.points, p, &mut near);
        near
    }

    /// The nearest ones of a cell's samples to a place that is `off` from its middle.
    fn among(&self, all: &[Sample], p: DVec3, off: f64) -> Near {
        let mut near = Near::new(self.most);
        for &(far, i) in all {
            let least = far * (1.0 - SLACK) - off - SLACK;
            if least > 0.0 && least * least > near.within2() {
                break;
            }
            near.add((p - self.points[i]).length_squared(), i);
        }
        near
    }

    /// Collects what may be nearest to a place that is up to `corner` from the middle
    /// of a cell.
    fn collect(&mut self, key: [i64; 3], middle: DVec3, corner: f64) {
        let far = self.tree.reach(self.points, middle, corner, self.most);
        let mut found = Vec::new();
        self.tree.within(self.points, middle, far, &mut found);
        let cell = if found.len() > MOST {
            Cell::Crowded
        } else {
            found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            Cell::Known(found)
        };
        if self.kept > KEPT {
            self.cells.clear();
            self.kept = 0;
        }
        if let Cell::Known(all) = &cell {
            self.kept += all.len();
        }
        self.cells.insert(key, cell);
    }
}

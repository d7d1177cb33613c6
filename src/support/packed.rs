//! Areas that are kept for all layers, in half the memory.
//!
//! In: an area. Out: the same, with its points on a grid of [`STEP`], which is far
//! finer than supports are planned. All points are in one list, and each ring
//! has its box, so that what is near a place is found without the other rings.

use crate::plane::grid::EdgeGrid;
use crate::plane::{Area, Rect, Ring};
use crate::units::Mm;
use glam::{DVec2, IVec2};
use std::borrow::Cow;
use std::sync::OnceLock;

/// Distance of the grid's points, mm: 15 nm, so that 32 bits reach 32 m.
const STEP: Mm = 1.0 / 65536.0;

/// A packed area.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Packed {
    points: Vec<IVec2>,
    rings: Vec<Bounds>,
}

/// Where a ring ends in the list of points, and its box.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bounds {
    end: u32,
    low: IVec2,
    high: IVec2,
}

impl Packed {
    pub(super) fn new(area: &Area) -> Packed {
        let count = area.rings.iter().map(Vec::len).sum();
        let mut packed = Packed {
            points: Vec::with_capacity(count),
            rings: Vec::with_capacity(area.rings.len()),
        };
        for ring in &area.rings {
            let points = ring.iter().map(|p| (*p / STEP).round().as_ivec2());
            let Some(box_) = points
                .clone()
                .map(|p| (p, p))
                .reduce(|(low, high), (p, _)| (low.min(p), high.max(p)))
            else {
                continue;
            };
            packed.points.extend(points);
            packed.rings.push(Bounds {
                end: packed.points.len() as u32,
                low: box_.0,
                high: box_.1,
            });
        }
        packed
    }

    /// The whole area.
    pub(super) fn area(&self) -> Area {
        (0..self.rings.len()).map(|k| self.ring(k)).collect()
    }

    /// The rings whose boxes meet a box.
    pub(super) fn near(&self, within: Rect) -> Area {
        let all = self.rings.iter().enumerate();
        all.filter(|(_, ring)| {
            Rect::new(unpacked(ring.low), unpacked(ring.high)).meets(within)
        })
        .map(|(k, _)| self.ring(k))
        .collect()
    }

    /// Number of rings.
    pub(super) fn len(&self) -> usize {
        self.rings.len()
    }

    /// One of the rings.
    fn ring(&self, k: usize) -> Ring {
        let begin = k.checked_sub(1).map_or(0, |k| self.rings[k].end);
        let points = &self.points[begin as usize..self.rings[k].end as usize];
        points.iter().map(|p| unpacked(*p)).collect()
    }
}

/// Where a point of the grid is.
fn unpacked(p: IVec2) -> DVec2 {
    STEP * p.as_dvec2()
}

/// A packed area that can be asked what is where. Its grid is made when it is
/// first asked.
#[derive(Debug)]
pub(super) struct Kept<'a> {
    packed: Cow<'a, Packed>,
    /// Size of the grid's cells.
    cell: Mm,
    grid: OnceLock<EdgeGrid>,
}

impl<'a> Kept<'a> {
    /// An area, for a grid with cells of some size.
    pub(super) fn new(packed: Cow<'a, Packed>, cell: Mm) -> Kept<'a> {
        Kept {
            packed,
            cell,
            grid: OnceLock::new(),
        }
    }

    /// The area's edges, for asking what is where.
    pub(super) fn grid(&self) -> &EdgeGrid {
        let of_area = || EdgeGrid::new(&self.packed.area(), self.cell);
        self.grid.get_or_init(of_area)
    }

    /// The rings whose boxes meet a box.
    pub(super) fn near(&self, within: Rect) -> Area {
        self.packed.near(within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::rect;

    #[test]
    fn an_area_comes_back_within_a_hundredth_of_a_micrometre() {
        let mut area = rect(-30000.123456, 1.0 / 3.0, 2.0, 7.0);
        area.rings.push(vec![
            DVec2::new(50.1, 60.2),
            DVec2::new(51.3, 60.7),
            DVec2::new(50.9, 61.1),
        ]);
        let packed = Packed::new(&area);
        assert_eq!(packed.len(), 2);
        let back = packed.area();
        for (a, b) in area.rings.iter().zip(&back.rings) {
            assert_eq!(a.len(), b.len());
            let mut off = a.iter().zip(b).map(|(p, q)| p.distance(*q));
            assert!(off.all(|d| d < 1.1e-5));
        }
        // What is on the grid stays as it is.
        assert_eq!(Packed::new(&back), packed);
        let near = Rect::new(DVec2::splat(50.0), DVec2::splat(70.0));
        assert_eq!(packed.near(near).rings, back.rings[1..]);
        assert_eq!(Packed::new(&Area::EMPTY), Packed::default());
    }
}

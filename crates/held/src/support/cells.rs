//! Cuts faces that are too wide for one branch into cells.

use super::SPECK;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::clip::{crop, unite};
use isoslice_planar::{Area, Rect};

/// Width of a cell, mm, about. The branch of a wider cell needs more height to
/// become a post; narrower cells have more posts.
pub(super) const CELL: Mm = 12.0;
/// A face that is no wider than so many cells is not cut.
const UNCUT: f64 = 1.5;
/// The borders of cells lie at multiples of this, mm. Booleans round
/// coordinates to a much finer grid. Rounded in two ways, a border that crosses
/// a hole would leave a sliver there.
const BORDER_STEP: Mm = 1e-3;
/// A piece smaller than this share of a cell goes with the piece beside it.
const SLIVER: f64 = 0.04;

/// A grid over all that needs support.
pub(super) struct Cells {
    min: DVec2,
    size: DVec2,
    count: [u32; 2],
}

impl Cells {
    /// A grid over a box, in which each of the cells has the same size.
    pub(super) fn new(bounds: Rect) -> Cells {
        let min = (bounds.min / BORDER_STEP).floor() * BORDER_STEP;
        let extent = bounds.max - min;
        let count = (extent / CELL).round().max(DVec2::ONE);
        let size =
            (extent / count / BORDER_STEP).ceil().max(DVec2::ONE) * BORDER_STEP;
        Cells {
            min,
            size,
            count: [count.x as u32, count.y as u32],
        }
    }

    /// The number of a point's cell.
    fn of(&self, p: DVec2) -> [u32; 2] {
        let at = ((p - self.min) / self.size).max(DVec2::ZERO);
        let [x, y] = self.count;
        [(at.x as u32).min(x - 1), (at.y as u32).min(y - 1)]
    }

    /// The pieces of an area, and the cells in which they are.
    pub(super) fn cut(&self, area: &Area) -> Vec<([u32; 2], Area)> {
        let mut pieces = Vec::new();
        for island in area.islands() {
            let bounds = island.bounds();
            if bounds.size().max_element() <= UNCUT * CELL {
                let cell = self.of(bounds.centre());
                pieces.push((cell, island));
                continue;
            }
            pieces.extend(self.pieces(&island, bounds));
        }
        pieces
    }

    /// The pieces of a wide island.
    fn pieces(&self, island: &Area, bounds: Rect) -> Vec<([u32; 2], Area)> {
        let (low, high) = (self.of(bounds.min), self.of(bounds.max));
        let (mut large, mut slivers) = (Vec::new(), Vec::new());
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                let at = DVec2::new(f64::from(x), f64::from(y));
                let min = self.min + at * self.size;
                let cell = Rect::new(min, min + self.size);
                for piece in unite(&crop(&island.rings, cell)).islands() {
                    let content = piece.content();
                    if content > SLIVER * CELL * CELL {
                        large.push(([x, y], piece));
                    } else if content > 0.0 {
                        slivers.push(([x, y], piece));
                    }
                }
            }
        }
        for (cell, sliver) in slivers {
            let at = sliver.bounds().centre();
            let beside = large.iter_mut().min_by(|(_, a), (_, b)| {
                let middle = |area: &Area| area.bounds().centre();
                let far = |area| middle(area).distance_squared(at);
                far(a).total_cmp(&far(b))
            });
            match beside {
                Some((_, beside)) => beside.rings.extend(sliver.rings),
                None if sliver.content() > SPECK => large.push((cell, sliver)),
                None => {}
            }
        }
        large
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::clip::{difference, intersection};
    use isoslice_planar::rect;

    #[test]
    fn no_piece_of_a_frame_crosses_its_hole() {
        for k in 0..40 {
            // The borders of four cells may be halfway between coordinates
            // that booleans round to.
            let half = 23.0 + 1e-5 * f64::from(k);
            let frame = difference(
                &rect(-half, -half, half, half),
                &rect(-21.0, -21.0, 21.0, 21.0),
            );
            let cells = Cells::new(frame.bounds());
            let pieces = cells.cut(&frame);
            let hole = rect(-20.9, -20.9, 20.9, 20.9);
            let mut content = 0.0;
            for (cell, piece) in pieces {
                let across = intersection(&piece, &hole);
                assert!(across.is_empty(), "{k}: {cell:?}");
                content += piece.content();
            }
            assert!((content - frame.content()).abs() < 1e-3, "{k}");
        }
    }
}

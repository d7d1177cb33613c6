//! Follows aligned seams up a part in few of its layers.
//!
//! A run that begins in the middle of a part has to know where the seams below
//! are. It cannot make all layers below, so it looks at the outlines of a few
//! of them, and every other run looks at these, too. Between two of them a seam
//! moves on as it did before. What is found is the seams for the layer with
//! which a block begins.

use super::follow::{Below, Ground, follow, reach};
use super::{Site, aligned};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Solid;
use isoslice_settings::layers::LayerSpan;

/// Layers from one that is looked at to the next: half a slab, so that one walk
/// over the tiles serves two looks. A seam that moves by 0.2 mm a layer is found
/// within 1.5 mm, which is less than from corner to corner.
const STRIDE: usize = 16;
/// The number of the layer that is looked at among every [`STRIDE`] layers, from
/// 0. It lies in one slab with the layer below.
const PLACE: usize = 13;

/// The seams of a part, as far as the layers tell that were looked at.
#[derive(Clone, Debug)]
pub struct Guide {
    /// The part's first layer.
    first: usize,
    accuracy: Mm,
    /// The layer that was looked at last: its number and its height.
    at: (usize, Mm),
    seams: Vec<Guided>,
}

/// A seam on its way up.
#[derive(Clone, Copy, Debug)]
struct Guided {
    at: DVec2,
    /// How far it moves in 1 mm of height.
    slope: DVec2,
}

impl Guided {
    /// Where the seam is `rise` higher up.
    fn risen(&self, rise: Mm) -> DVec2 {
        self.at + rise * self.slope
    }
}

impl Guide {
    /// A guide for a part whose first layer is `first`.
    pub(super) fn new(first: usize, accuracy: Mm) -> Guide {
        Guide {
            first,
            accuracy,
            at: (first, 0.0),
            seams: Vec::new(),
        }
    }

    /// True if a layer is looked at.
    pub fn looks_at(&self, layer: usize) -> bool {
        layer >= self.first && (self.is_first(layer) || layer % STRIDE == PLACE)
    }

    /// True for the part's first layer. The one above it is looked at before
    /// it: the two tell how seams move, and where nothing hangs.
    pub fn is_first(&self, layer: usize) -> bool {
        layer == self.first
    }

    /// Looks at the next of these layers. `ground` is what holds it, if that
    /// differs from it.
    pub fn look(
        &mut self,
        span: &LayerSpan,
        outline: &Solid<'_>,
        ground: Option<Ground<'_>>,
    ) {
        let (number, below) = self.at;
        let layers = span.index.abs_diff(number);
        let rise = span.top - below;
        let rings = &outline.area().rings;
        // For each ring the seam below that is nearest to it.
        let mut near: Vec<Option<(Mm, Below, DVec2)>> = vec![None; rings.len()];
        for seam in &self.seams {
            let meant = seam.risen(rise);
            let way = rise.abs() * seam.slope.length();
            let found = outline.grid().nearest_within(meant, reach(way));
            let Some((ring, at)) = found else { continue };
            let away = at.distance(meant);
            if near[ring].is_none_or(|best| away < best.0) {
                near[ring] =
                    Some((away, Below::lower(at, layers, way), seam.at));
            }
        }
        let seam = |(ring, near): (&Vec<DVec2>, Option<(Mm, Below, DVec2)>)| {
            let site = match ring.len() {
                0..3 => Site::default(),
                _ => aligned(ring, self.accuracy),
            };
            let below = near.map(|near| near.1);
            let at = follow(&site, ring, below, ground)?;
            // A seam that has left its place goes on from there.
            let from = near
                .filter(|(_, below, _)| at.distance(below.at) <= below.reach);
            let slope = from.map_or(DVec2::ZERO, |from| (at - from.2) / rise);
            Some(Guided { at, slope })
        };
        self.seams = rings.iter().zip(near).filter_map(seam).collect();
        self.at = (span.index, span.top);
    }

    /// Where the seams are expected in a layer above.
    pub fn seams(&self, span: &LayerSpan) -> Vec<DVec2> {
        let rise = span.top - self.at.1;
        self.seams.iter().map(|seam| seam.risen(rise)).collect()
    }
}

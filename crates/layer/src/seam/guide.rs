//! The lines along which aligned seams run up a part, planned from few of its
//! layers.
//!
//! ```text
//!   ──┼───── look      A seam is found in each layer that is looked at, and
//!     ╲                followed to the next one. Between two looks it lies on
//!   ───╲──── layer     the straight line. What ends or begins there goes on as
//!       ╲              it did where it was seen.
//!   ─────┼── look
//! ```
//!
//! In: a few layers of the part, from below. Out: for any layer the places where
//! its seams are expected. So no layer has to know the layers below it, and a
//! seam that is in one line in the looks does not jump between them.

use super::follow::{Below, Ground, follow, reach};
use super::{Site, aligned};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Solid;
use isoslice_settings::layers::LayerSpan;

/// The seams of a part.
#[derive(Clone, Debug)]
pub struct Guide {
    accuracy: Mm,
    /// The layers that were looked at, from below.
    looks: Vec<Look>,
}

/// A layer that was looked at.
#[derive(Clone, Debug)]
struct Look {
    index: usize,
    top: Mm,
    seams: Vec<Guided>,
}

/// A seam on its way up.
#[derive(Clone, Copy, Debug)]
struct Guided {
    at: DVec2,
    /// How far it moves in 1 mm of height.
    slope: DVec2,
    /// The seam of the look before that this one continues, if there is one.
    from: Option<usize>,
}

impl Guided {
    /// Where the seam is `rise` higher up.
    fn risen(&self, rise: Mm) -> DVec2 {
        self.at + rise * self.slope
    }
}

impl Guide {
    /// A guide that has not looked at any layer.
    pub(super) fn new(accuracy: Mm) -> Guide {
        Guide {
            accuracy,
            looks: Vec::new(),
        }
    }

    /// Looks at the next of these layers. `ground` is what holds it, if that
    /// differs from it. A layer below the last one takes the place of that: the
    /// part's lowest layer comes after the one above it, since the two tell how
    /// seams move, and where nothing hangs.
    pub fn look(
        &mut self,
        span: &LayerSpan,
        outline: &Solid<'_>,
        ground: Option<Ground<'_>>,
    ) {
        let below = self.looks.last();
        let (number, top) = below.map_or((0, 0.0), |b| (b.index, b.top));
        let layers = span.index.abs_diff(number);
        let rise = span.top - top;
        let rings = &outline.area().rings;
        // For each ring the seam below that is nearest to it.
        let mut near: Vec<Option<(Mm, Below, usize)>> = vec![None; rings.len()];
        let seams = below.map_or(&[][..], |below| &below.seams);
        for (from, seam) in seams.iter().enumerate() {
            let meant = seam.risen(rise);
            let way = rise.abs() * seam.slope.length();
            let found = outline.grid().nearest_within(meant, reach(way));
            let Some((ring, at)) = found else { continue };
            let away = at.distance(meant);
            if near[ring].is_none_or(|best| away < best.0) {
                near[ring] = Some((away, Below::lower(at, layers, way), from));
            }
        }
        let seam = |(ring, near): (&Vec<DVec2>, Option<(Mm, Below, usize)>)| {
            let site = match ring.len() {
                0..3 => Site::default(),
                _ => aligned(ring, self.accuracy),
            };
            let below = near.map(|near| near.1);
            let at = follow(&site, ring, below, ground)?;
            // A seam that has left its place begins anew.
            let from = near
                .filter(|(_, below, _)| at.distance(below.at) <= below.reach)
                .map(|near| near.2);
            let slope = from.map_or(DVec2::ZERO, |k| (at - seams[k].at) / rise);
            Some(Guided { at, slope, from })
        };
        let mut seams: Vec<Guided> =
            rings.iter().zip(near).filter_map(seam).collect();
        if self.looks.pop_if(|last| last.index > span.index).is_some() {
            seams.iter_mut().for_each(|seam| seam.from = None);
        }
        self.looks.push(Look {
            index: span.index,
            top: span.top,
            seams,
        });
    }

    /// Where the seams of a layer are expected: first those that are in one line
    /// below and above, then those that end, and last those that begin.
    pub fn seams(&self, span: &LayerSpan) -> Vec<DVec2> {
        let next = self.looks.partition_point(|l| l.index <= span.index);
        let lower = next.checked_sub(1).and_then(|k| self.looks.get(k));
        let upper = self.looks.get(next);
        let below = lower.map_or(&[][..], |look| &look.seams);
        let above = upper.map_or(&[][..], |look| &look.seams);
        let rise = |look: Option<&Look>| look.map_or(0.0, |l| span.top - l.top);
        let (up, down) = (rise(lower), rise(upper));
        let onward = above.iter().filter_map(|seam| {
            let from = below.get(seam.from?)?;
            Some(from.at.lerp(seam.at, up / (up - down)))
        });
        let goes_on = |k: usize| above.iter().any(|s| s.from == Some(k));
        let last = below.iter().enumerate().filter(|(k, _)| !goes_on(*k));
        let last = last.map(|(_, seam)| seam.risen(up));
        let begun = above.iter().filter(|seam| seam.from.is_none());
        let begun = begun.map(|seam| seam.risen(down));
        onward.chain(last).chain(begun).collect()
    }
}

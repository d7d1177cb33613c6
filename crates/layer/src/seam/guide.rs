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

/// How far a seam may move in 1 mm of height, mm, to be on an even way: 63° from the
/// upright. What moves faster has jumped, to a corner that begins in the layer.
const STEEPEST: f64 = 2.0;

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

    /// Looks at the next layer, with what is right below it. `ground` is what holds
    /// it, if that differs from it.
    pub fn look(
        &mut self,
        span: &LayerSpan,
        outline: &Solid<'_>,
        below: Option<(&LayerSpan, &Solid<'_>)>,
        ground: Option<Ground<'_>>,
    ) {
        let last = self.looks.last();
        let (number, top) =
            last.map_or((0, 0.0), |last| (last.index, last.top));
        let layers = span.index.abs_diff(number);
        let rise = span.top - top;
        let rings = &outline.area().rings;
        // For each ring the seam of the last look that is nearest to it.
        let mut near: Vec<Option<(Mm, Below, usize)>> = vec![None; rings.len()];
        let seams = last.map_or(&[][..], |last| &last.seams);
        for (from, seam) in seams.iter().enumerate() {
            let meant = seam.risen(rise);
            let way = rise * seam.slope.length();
            let found = outline.grid().nearest_within(meant, reach(way));
            let Some((ring, at)) = found else { continue };
            let away = at.distance(meant);
            if near[ring].is_none_or(|best| away < best.0) {
                near[ring] = Some((away, Below::lower(at, layers, way), from));
            }
        }
        let seam = |(ring, near): (&Vec<DVec2>, Option<(Mm, Below, usize)>)| {
            let lower = near.map(|near| near.1);
            let at = follow(&self.site(ring), ring, lower, ground)?;
            // A seam that has left its place begins anew.
            let from = near
                .filter(|(_, lower, _)| at.distance(lower.at) <= lower.reach)
                .map(|near| near.2);
            let slope = below.and_then(|below| self.slope(at, span, below));
            let slope = slope.unwrap_or_default();
            Some(Guided { at, slope, from })
        };
        let seams = rings.iter().zip(near).filter_map(seam).collect();
        self.looks.push(Look {
            index: span.index,
            top: span.top,
            seams,
        });
    }

    fn site(&self, ring: &[DVec2]) -> Site {
        match ring.len() {
            0..3 => Site::default(),
            _ => aligned(ring, self.accuracy),
        }
    }

    /// How far the seam at a point moves in 1 mm of height, by the layer right below;
    /// none if it has not moved on evenly from there.
    fn slope(
        &self,
        at: DVec2,
        span: &LayerSpan,
        (lower, outline): (&LayerSpan, &Solid<'_>),
    ) -> Option<DVec2> {
        let rise = span.top - lower.top;
        let reach = STEEPEST * rise;
        let (ring, nearest) = outline.grid().nearest_within(at, reach)?;
        let corners = self.site(&outline.area().rings[ring]).corners;
        let away = |p: &DVec2| p.distance(at);
        let corner = |a: &DVec2, b: &DVec2| away(a).total_cmp(&away(b));
        let from = corners.into_iter().min_by(corner).unwrap_or(nearest);
        (away(&from) <= reach).then(|| (at - from) / rise)
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

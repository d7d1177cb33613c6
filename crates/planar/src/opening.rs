//! What of an area is wide, and areas with their gaps filled: two offsets, there
//! and back.

use super::Area;
use super::clip::intersection;
use super::offset::offset;
use isoslice_base::units::Mm;

/// What of an area discs of some radius in it cover. Corners are rounded.
/// Borders are within `tolerance`, and what lies within `tolerance` of such a
/// disc counts as covered, lest slivers be left beside straight borders.
pub fn opened(area: &Area, radius: Mm, tolerance: Mm) -> Area {
    reached(area, radius, radius + tolerance, tolerance)
}

/// What of an area is as wide as discs of some radius, with the corners beside
/// them.
pub fn wide_parts(area: &Area, radius: Mm, tolerance: Mm) -> Area {
    /// Radius of the disc that covers the corners, in multiples of `radius`. A
    /// right-angled corner sticks out of the disc in it by √2 − 1 of its radius.
    const CORNERS: f64 = 1.5;
    reached(area, radius, CORNERS * radius, tolerance)
}

/// What of an area lies within `reach` of the middle of a disc in it.
fn reached(area: &Area, radius: Mm, reach: Mm, tolerance: Mm) -> Area {
    let core = offset(area, -radius, tolerance);
    if core.is_empty() {
        return core;
    }
    intersection(area, &offset(&core, reach, tolerance))
}

/// True if some disc of this diameter fits into an area.
pub fn is_wider(area: &Area, width: Mm, tolerance: Mm) -> bool {
    let half = 0.5 * width;
    // An area that is all within `half` of its border has no more content than
    // this, so the cheap comparison settles most wide areas.
    area.content() > half * area.perimeter()
        || !offset(area, -half, tolerance).is_empty()
}

/// An area and all that no disc of some radius outside of it reaches: its gaps
/// and notches. Borders are within `tolerance`.
pub fn closed(area: &Area, radius: Mm, tolerance: Mm) -> Area {
    offset(&offset(area, radius, tolerance), -radius, tolerance)
}

#[cfg(test)]
mod tests {
    use super::super::clip::difference;
    use super::super::rect;
    use super::*;

    /// A plate of 10 × 10 mm with a tongue of 1 × 4 mm.
    fn tongue() -> Area {
        super::super::clip::union(
            &rect(0.0, 0.0, 10.0, 10.0),
            &rect(9.0, 4.0, 14.0, 5.0),
        )
    }

    #[test]
    fn opened_areas_lose_what_is_thin_and_their_corners() {
        let rest = opened(&tongue(), 1.0, 1e-3);
        // Each of four corners loses 1 − π/4 mm², and a disc reaches by 1 − √¾ mm
        // into the tongue.
        let rounded = 100.0 - 4.0 + std::f64::consts::PI;
        let more = rest.content() - rounded;
        assert!((0.08..0.1).contains(&more), "{more}");
        assert!(opened(&tongue(), 5.1, 1e-3).is_empty());
        // Nothing is added, and no sliver is left beside the straight sides.
        assert!(difference(&rest, &tongue()).is_empty());
        let lost = difference(&tongue(), &rest);
        assert_eq!(lost.islands().len(), 5);
    }

    #[test]
    fn wide_parts_keep_their_corners() {
        let rest = wide_parts(&tongue(), 1.0, 1e-3);
        // The larger disc reaches some 0.63 mm into the tongue.
        assert!(difference(&rect(0.0, 0.0, 10.0, 10.0), &rest).is_empty());
        let more = rest.content() - 100.0;
        assert!((0.5..0.64).contains(&more), "{more}");
        assert!(is_wider(&rest, 9.9, 1e-3));
        assert!(!is_wider(&rest, 10.6, 1e-3));
    }

    #[test]
    fn closed_areas_have_no_narrow_gaps() {
        let two = super::super::clip::union(
            &rect(0.0, 0.0, 10.0, 10.0),
            &rect(10.5, 0.0, 20.0, 10.0),
        );
        assert_eq!(closed(&two, 0.2, 1e-3).islands().len(), 2);
        let all = closed(&two, 0.3, 1e-3);
        assert_eq!(all.islands().len(), 1);
        assert!(difference(&two, &all).content() < 1e-3);
        assert!((all.content() - 200.0).abs() < 0.1, "{}", all.content());
    }
}

//! How large a drawing is and where it lies.

use crate::area::Area;
use crate::outline::Outline;
use glam::{DAffine2, DVec2};
use isoslice_base::problem::Problem;
use isoslice_base::units::human_number;

/// What lies at the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// The lower left corner of an SVG's page, or a DXF's own origin.
    #[default]
    Page,
    /// The lower left corner of the box around the area.
    Corner,
    /// The middle of the box around the area.
    Centre,
}

/// Gives all outlines a width and a height, mm, if they are known, and a place.
pub(crate) fn place_all(
    outlines: &mut [Outline],
    sized: [Option<f64>; 2],
    anchor: Anchor,
) -> Problem<()> {
    if anchor == Anchor::Page && sized == [None; 2] {
        return Ok(());
    }
    let bounds = Area::new(outlines)?.bounds();
    let size = bounds.size();
    if !(size.is_finite() && size.min_element() > 0.0) {
        return Ok(());
    }
    let scale = scale(sized, size)?;
    let to = DAffine2::from_scale(scale);
    let from = match anchor {
        Anchor::Page => DVec2::ZERO,
        Anchor::Corner => bounds.min,
        Anchor::Centre => bounds.centre(),
    };
    let by = to * DAffine2::from_translation(-from);
    for outline in outlines {
        *outline = outline.mapped(by);
    }
    Ok(())
}

/// How much larger something of a size has to be.
fn scale(sized: [Option<f64>; 2], size: DVec2) -> Problem<DVec2> {
    for mm in sized.into_iter().flatten() {
        if !(1e-3..=1e6).contains(&mm) {
            return Err(format!(
                "its size is to be {} mm; give one from 0.001 to 1000000",
                human_number(mm)
            ));
        }
    }
    Ok(match sized {
        [Some(w), Some(h)] => DVec2::new(w, h) / size,
        [Some(w), None] => DVec2::splat(w / size.x),
        [None, Some(h)] => DVec2::splat(h / size.y),
        [None, None] => DVec2::ONE,
    })
}

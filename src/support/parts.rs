//! The part's layers, and those that a gap between support and part takes.

use crate::layers::LayerSpan;
use crate::plane::{Area, Rect};
use crate::settings::Settings;
use crate::units::Mm;

/// Heights closer than this differ by rounding only, mm.
const ROUNDED: Mm = 1e-6;

/// A part's layers, from the bed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts<'a> {
    /// The layers.
    pub spans: &'a [LayerSpan],
    /// The outline of each.
    pub outlines: &'a [Area],
    /// The bed, in the model's coordinates.
    pub bed: Rect,
}

/// The highest layer whose top is at least `support.z_gap` below layer `i`.
pub(crate) fn top_below(
    spans: &[LayerSpan],
    i: usize,
    settings: &Settings,
) -> Option<usize> {
    let highest = spans[i].bottom - settings.support.z_gap + ROUNDED;
    spans[..i].iter().rposition(|span| span.top <= highest)
}

/// The layers below layer `j` of which the part keeps `support.z_gap_bottom`
/// from a support in it, and the layer on which such a support rests.
pub(super) fn gap_below(
    spans: &[LayerSpan],
    j: usize,
    settings: &Settings,
) -> std::ops::Range<usize> {
    let lowest = spans[j].bottom - settings.support.z_gap_bottom + ROUNDED;
    let on = spans[..j].iter().rposition(|span| span.top <= lowest);
    on.unwrap_or(0)..j
}

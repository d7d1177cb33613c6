//! The supports in a layer.

use crate::plane::Area;
use crate::plane::clip::union;
use crate::units::Mm;

/// The support of one layer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slice {
    /// The area with sparse lines.
    pub body: Area,
    /// The area with dense lines, because something is right above it.
    pub interface: Area,
    /// The islands that stand on the part, if their beads reach farther down
    /// than others, or less far.
    pub standing: Area,
    /// How much farther down the beads of [`Slice::standing`] reach, mm. It is less
    /// than 0 if they reach less far.
    pub deeper: Mm,
}

impl Slice {
    /// The area of all supports in the layer.
    pub(crate) fn area(&self) -> Area {
        union(&self.body, &self.interface)
    }

    /// True if the layer has no support.
    pub(super) fn is_empty(&self) -> bool {
        self.body.is_empty() && self.interface.is_empty()
    }
}

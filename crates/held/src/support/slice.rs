//! The supports in a layer.

use isoslice_base::units::Mm;
use isoslice_planar::Area;
use isoslice_planar::clip::union;

/// The support of one layer.
#[derive(Clone, Debug, Default)]
pub struct Slice {
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
    pub fn area(&self) -> Area {
        union(&self.body, &self.interface)
    }

    /// True if the layer has no support.
    pub(super) fn is_empty(&self) -> bool {
        self.body.is_empty() && self.interface.is_empty()
    }
}

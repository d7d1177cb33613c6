//! Counts over all layers, and the warnings that follow from them.

use super::layer::Layer;
use isoslice_base::units::{Mm, Mm2, Mm3};

/// Height from which on it is told that a part's top is too thin to be printed, mm.
/// The tips of cones and of balls are lower.
const HIGH: Mm = 1.0;

/// What is counted over all layers.
#[derive(Default)]
pub(super) struct Tally {
    pub gap: Mm2,
    pub solid: Mm2,
    /// Volume of the supports' beads.
    pub support: Mm3,
    nan_samples: usize,
    nan_layers: usize,
    forced_rings: usize,
    /// Islands and holes left out because they are too small.
    pub dropped_rings: usize,
    /// Number of layers seen, of empty layers since the last one that was not
    /// empty, and of empty layers that something comes after.
    layers: usize,
    empty: usize,
    bridged: usize,
    /// Where the highest layers begin and end of which nothing is printed, mm.
    bare: [Mm; 2],
    /// True if nothing is printed in the first layer.
    pub floats: bool,
}

impl Tally {
    /// A tally of no layer. `bare` is where the highest layers begin and end of which
    /// nothing is printed.
    pub(super) fn over(bare: [Mm; 2]) -> Tally {
        Tally {
            bare,
            ..Tally::default()
        }
    }

    /// Counts a layer with gaps of this area. `empty` is true if nothing of the
    /// part is printed in it.
    pub(super) fn add(&mut self, layer: &Layer, gap: Mm2, empty: bool) {
        let outline = layer.met;
        self.gap += gap;
        self.solid += layer.area().content();
        self.nan_samples += outline.nan_samples;
        self.nan_layers += usize::from(outline.nan_samples > 0);
        self.forced_rings += outline.forced_rings;
        self.dropped_rings += outline.dropped_rings;
        self.floats |= empty && self.layers == 0;
        self.layers += 1;
        if empty {
            self.empty += 1;
        } else {
            self.bridged += std::mem::take(&mut self.empty);
        }
    }

    /// Adds what the user should know. `by_field` is true if walls lie where the field
    /// has their depth as its value.
    pub(super) fn warn(&self, by_field: bool, warnings: &mut Vec<String>) {
        let (or_field, remedy) = if by_field {
            let why = ", or wall_offset = \"field\" finds no wall: near level faces \
                       the field is nowhere minus half a wall's width";
            let how = "wall_offset = \"field\" finds no wall where the field is \
                       nowhere minus half the wall's width, as in thin places and \
                       near level faces; set it to \"distance\"";
            (why, how)
        } else {
            let how = "scale it up, or lower outer_wall_width or thin_min";
            ("", how)
        };
        if self.bridged > 0 {
            warnings.push(format!(
                "{} of {} layers have nothing to print and others follow \
                 above them: the part is not in one piece, thinner than any \
                 line there, or does not stand on the bed{or_field}",
                self.bridged, self.layers
            ));
        }
        let [from, to] = self.bare;
        if to - from >= HIGH {
            warnings.push(format!(
                "the highest {:.1} mm of the part, above z = {from:.2} mm, are \
                 thinner than any line and are left out; {remedy}",
                to - from
            ));
        }
        if self.gap > 0.02 * self.solid {
            warnings.push(format!(
                "{:.0} % of the part is thinner than any line and is left \
                 out; {remedy}",
                100.0 * self.gap / self.solid
            ));
        }
        if self.nan_samples > 0 {
            warnings.push(format!(
                "the field is not a number at {} samples in {} layers; they \
                 count as outside (look for a root or logarithm of a negative \
                 number, or 0/0, in the model)",
                self.nan_samples, self.nan_layers
            ));
        }
        if self.forced_rings > 0 {
            warnings.push(format!(
                "{} outlines did not close and were closed by straight \
                 lines: please report this with the model",
                self.forced_rings
            ));
        }
    }
}

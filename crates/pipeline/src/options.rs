//! What a caller may ask of a run.

use isoslice_base::units::Mm;
use isoslice_gcode::Format;
use isoslice_settings::layers::{LayerRange, LayerSpan, PlanError, layer_at};
use std::ops::Range;
use std::path::Path;
use std::time::SystemTime;

/// How a run is made, as opposed to what is printed.
pub struct Options<'a> {
    /// Number of threads; none for as many as the machine has.
    pub threads: Option<usize>,
    /// Which of the part's layers to write.
    pub layers: LayerRange,
    /// Write only the layer at this height above the bed, to be looked at and not
    /// to be printed: the nearest one, if the part ends below. No other layer
    /// is filled for it, so its seams and ways may begin elsewhere than in a
    /// whole run, and its outline may differ in the last bits. `layers` does not
    /// count.
    pub glimpse: Option<Mm>,
    /// Folder for a picture of each layer.
    pub svg_dir: Option<&'a Path>,
    /// Measure everything, for a report, and not only a few points.
    pub report: bool,
    /// When the file is written, for its first line. Without it that line has
    /// no time.
    pub timestamp: Option<SystemTime>,
    /// Format of the file.
    pub format: Format,
    /// Check the G-code while it is written. Whatever could hurt the printer is
    /// then an error.
    pub check: bool,
    /// Called with the number of layers written, and that of all layers.
    pub on_layer: &'a (dyn Fn(usize, usize) + Sync),
}

impl Default for Options<'_> {
    /// The whole part on all of the machine's threads, and nothing else.
    fn default() -> Self {
        Options {
            threads: None,
            layers: LayerRange::ALL,
            glimpse: None,
            svg_dir: None,
            report: false,
            check: true,
            timestamp: None,
            format: Format::Text,
            on_layer: &|_, _| {},
        }
    }
}

impl Options<'_> {
    /// The layers to write of a part with these `spans`, by their indices.
    ///
    /// # Errors
    /// If all of them lie above the part.
    pub(super) fn indices(
        &self,
        spans: &[LayerSpan],
    ) -> Result<Range<usize>, PlanError> {
        match self.glimpse {
            Some(z) => Ok(layer_at(spans, z)),
            None => self.layers.indices(spans.len()),
        }
    }

    /// What a run makes to write these layers.
    pub(super) fn extent(&self, layers: Range<usize>) -> Extent {
        let glimpse = self.glimpse.is_some();
        // A layer goes on from where the layer below ends, and the order of that
        // depends on where the one below it ends.
        let below = if glimpse { 0 } else { 2 };
        Extent {
            made: layers.start.saturating_sub(below)..layers.end,
            layers,
            glimpse,
        }
    }
}

/// Which layers a run makes, by their indices.
#[derive(Clone, Debug)]
pub(super) struct Extent {
    /// The layers to be written.
    pub layers: Range<usize>,
    /// The layers to be made: those to be written, and two below them.
    pub made: Range<usize>,
    /// True if a single layer is made to be looked at.
    pub glimpse: bool,
}

impl Extent {
    /// The extent of a run of all of a part's `count` layers.
    pub(super) fn of_all(count: usize) -> Extent {
        Extent {
            layers: 0..count,
            made: 0..count,
            glimpse: false,
        }
    }
}

//! What a caller may ask of a run.

use crate::gcode::Format;
use crate::layers::LayerRange;
use std::path::Path;
use std::time::SystemTime;

/// How a run is made, as opposed to what is printed.
pub struct Options<'a> {
    /// Number of threads; none for as many as the machine has.
    pub threads: Option<usize>,
    /// Which of the part's layers to write.
    pub layers: LayerRange,
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
            svg_dir: None,
            report: false,
            check: true,
            timestamp: None,
            format: Format::Text,
            on_layer: &|_, _| {},
        }
    }
}

//! The sliced plates of Bambu Lab's printers, `.gcode.3mf`: packs G-code into
//! one, and takes it out again.
//!
//! In: G-code as text, what is known of the print, and pictures. Out: a zip
//! archive with the text, the MD5 sum by which a printer notices a damaged
//! file, the pictures that its screen shows, and small files that say what the
//! print takes. Any such file, whoever wrote it, can be turned back into text.
//!
//! The archive is an Open Packaging container, like every 3MF file. Which files
//! are in it, and which keys these have, is what Bambu Studio writes and reads
//! (github.com/bambulab/BambuStudio, `src/libslic3r/Format/bbs_3mf.cpp`, and the
//! files that it exports); no line is taken from there.
//!
//! | entry | what it is |
//! |---|---|
//! | `Metadata/plate_1.gcode` | the text |
//! | `Metadata/plate_1.gcode.md5` | its MD5 sum |
//! | `Metadata/slice_info.config` | printer, time, filament, parts |
//! | `Metadata/model_settings.config` | which entries belong to the plate |
//! | `Metadata/plate_1.json` | where the parts stand |
//! | `Metadata/plate_1.png`, `plate_1_small.png` | pictures |
//! | `3D/3dmodel.model` | a model without meshes |
//! | `[Content_Types].xml`, `_rels/.rels`, `Metadata/_rels/…` | what the container asks for |
//!
//! Guarantees: the same text gives the same bytes; opening them gives back every
//! byte of the text; memory grows neither with the length of the text nor with
//! what a damaged file says about itself, except for the directory of at most
//! 10,000 entries.
//!
//! | file | what it does |
//! |---|---|
//! | `pack` | from text to an archive |
//! | `entries` | the small files in it |
//! | `head` | the first lines of the text |
//! | `unpack` | from an archive to text |

mod entries;
mod head;
mod pack;
#[cfg(test)]
mod tests;
mod unpack;

pub use head::blank;
pub use pack::Packer;
pub(crate) use unpack::{Broken, Opened};

use glam::DVec2;
use isoslice_base::units::{Mm, Mm3, Seconds};
use isoslice_settings::PictureSize;

/// The first bytes of a zip archive.
pub const MAGIC: [u8; 4] = *b"PK\x03\x04";

/// The text in the archive, and its sum.
const GCODE: &str = "Metadata/plate_1.gcode";
const SUM: &str = "Metadata/plate_1.gcode.md5";

/// What is known of a print once it is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// Who made the file: a name and a version.
    pub maker: String,
    /// Name of the printer's model, as its maker has it; may be empty.
    pub printer: String,
    /// Diameter of the nozzle.
    pub nozzle: Mm,
    /// What the filament is made of, as in `PLA`.
    pub material: String,
    /// Diameter of the filament.
    pub filament_diameter: Mm,
    /// Density of the filament, g/cm³.
    pub density: f64,
    /// Time of the print.
    pub time: Seconds,
    /// Length of the filament that the print takes.
    pub length: Mm,
    /// Volume of that filament.
    pub volume: Mm3,
    /// Mass of that filament, grams.
    pub mass_g: f64,
    /// Number of layers.
    pub layers: usize,
    /// Top of the highest layer.
    pub height: Mm,
    /// Height of the layers above the first.
    pub layer_height: Mm,
    /// True if the print has supports.
    pub supports: bool,
    /// True if parts are printed one after the other.
    pub one_by_one: bool,
    /// True if the text has a label around each part.
    pub labelled: bool,
    /// The parts.
    pub parts: Vec<PartBox>,
    /// Pictures, as PNG files.
    pub pictures: Vec<(PictureSize, Vec<u8>)>,
}

/// A part on the plate.
#[derive(Clone, Debug, PartialEq)]
pub struct PartBox {
    /// Name of the part.
    pub name: String,
    /// Left front corner of the part's box, seen from above.
    pub min: DVec2,
    /// Right back corner of that box.
    pub max: DVec2,
}

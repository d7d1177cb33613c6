//! Projects of OrcaSlicer, Bambu Studio and PrusaSlicer (`.3mf`): archives with
//! models and one whole configuration.
//!
//! In: an archive. Out: the text of its configuration. Models are not unpacked,
//! however large they are.

use crate::{Slicer, archive};
use std::fs::File;
use std::io::BufReader;
use zip::result::ZipError;

/// The entries with the configuration, and whose they are.
const SETTINGS: [(&str, Slicer); 2] = [
    ("Metadata/project_settings.config", Slicer::Orca),
    ("Metadata/Slic3r_PE.config", Slicer::Prusa),
];

/// Greatest number of entries of an archive, and greatest size of the
/// configuration, bytes. Projects have some hundred entries, and configurations
/// some 100 kB.
const MOST_ENTRIES: usize = 10_000;
const MOST_BYTES: u64 = 4 << 20;

/// The configuration in a project, and whose it is.
///
/// # Errors
/// A sentence, if the archive has no configuration, or too large a one.
pub(crate) fn settings(file: File) -> Result<(Slicer, String), String> {
    let mut archive =
        archive::open(BufReader::new(file), MOST_ENTRIES, "a project has")?;
    for (name, slicer) in SETTINGS {
        let entry = match archive.by_name(name) {
            Ok(entry) => entry,
            Err(ZipError::FileNotFound) => continue,
            Err(error) => return Err(archive::damaged(error)),
        };
        let bytes = archive::unpacked(entry, MOST_BYTES, "its configuration")?;
        return String::from_utf8(bytes)
            .map(|text| (slicer, text))
            .map_err(|_| "its configuration is not text".to_owned());
    }
    let [(of_orca, _), (of_prusa, _)] = SETTINGS;
    Err(format!(
        "there is no configuration in it ({of_orca}, {of_prusa}), as projects of \
         OrcaSlicer, Bambu Studio and PrusaSlicer have; let the slicer export \
         its profiles as .ini or .json"
    ))
}

//! Projects of OrcaSlicer and Bambu Studio (`.3mf`): archives with models and
//! one whole configuration.
//!
//! In: an archive. Out: the text of its configuration. Models are not unpacked,
//! however large they are.

use crate::archive;
use std::fs::File;
use std::io::BufReader;
use zip::result::ZipError;

/// The entry with the configuration.
const SETTINGS: &str = "Metadata/project_settings.config";

/// Greatest number of entries of an archive, and greatest size of the
/// configuration, bytes. Projects have some hundred entries, and configurations
/// some 100 kB.
const MOST_ENTRIES: usize = 10_000;
const MOST_BYTES: u64 = 4 << 20;

/// The configuration in a project.
///
/// # Errors
/// A sentence, if the archive has no configuration, or too large a one.
pub(crate) fn settings(file: File) -> Result<String, String> {
    let mut archive =
        archive::open(BufReader::new(file), MOST_ENTRIES, "a project has")?;
    let entry = match archive.by_name(SETTINGS) {
        Ok(entry) => entry,
        Err(ZipError::FileNotFound) => {
            return Err(format!(
                "there is no configuration in it ({SETTINGS}), as projects of \
                 OrcaSlicer and Bambu Studio have; let the slicer export its \
                 profiles as .ini or .json"
            ));
        }
        Err(error) => return Err(archive::damaged(error)),
    };
    let bytes = archive::unpacked(entry, MOST_BYTES, "its configuration")?;
    String::from_utf8(bytes)
        .map_err(|_| "its configuration is not text".to_owned())
}

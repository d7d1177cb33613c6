//! The format of a file by its name.

use super::Format;
use isoslice_base::pairs;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Extensions of files that are not G-code, and what to do instead.
const OTHERS: &[(&str, &str)] = pairs! {
    "stl", "obj", "ply", "amf", "off", "step", "stp", "iges"
        => "that is a mesh or a drawing, and isoslice makes none";
    "3mf"
        => "that is a model: isoslice export MODEL -o FILE.3mf writes its \
            function";
    "png", "jpg", "jpeg", "qoi", "webp", "gif"
        => "that is a picture: isoslice render MODEL -o FILE.png draws one";
    "svg" => "that is a picture: --svg FOLDER draws every layer";
    "html", "htm"
        => "that is a page: isoslice preview MODEL -o FILE.html makes one";
    "rhai", "vm" => "that is a model, which is read and not written";
    "toml", "ini", "json" => "that is for settings or reports";
    "ufp", "x3g", "s3g", "makerbot", "gx", "g3drem", "3w", "dlp"
        => "isoslice does not write this format: write .gcode and convert it \
            with your printer's own program";
    "sl1", "sl1s", "ctb", "cbddlp", "photon", "goo", "lys", "pwmx"
        => "that is for printers with resin, which isoslice does not know";
    "gz", "zip", "xz", "bz2", "zst", "7z"
        => "isoslice does not compress: -o - writes to standard output, for a \
            program that does";
};

/// The end of the names of plates for Bambu Lab's printers.
const SLICED_PLATE: &str = "gcode.3mf";

/// A name that promises something that is not G-code.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "cannot write {}: {what}; slice writes G-code, as text (.gcode), binary \
     (.bgcode) or a plate for Bambu Lab's printers (.gcode.3mf)",
    path.display()
)]
pub struct FormatError {
    /// The name.
    pub path: PathBuf,
    /// What the name promises, and what to do instead.
    pub what: &'static str,
}

impl Format {
    /// The extension of files of this format, without its first dot.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Text => "gcode",
            Format::Binary => "bgcode",
            Format::Plate => SLICED_PLATE,
        }
    }

    /// The format of a file of this name.
    ///
    /// # Errors
    /// If the name promises something that is not G-code.
    pub fn of_name(path: &Path) -> Result<Format, FormatError> {
        let name = path.file_name().and_then(OsStr::to_str).unwrap_or("");
        let name = name.to_ascii_lowercase();
        let before = name.strip_suffix(SLICED_PLATE);
        if before.is_some_and(|before| before.ends_with('.')) {
            return Ok(Format::Plate);
        }
        let end = path.extension().and_then(OsStr::to_str).unwrap_or("");
        let end = end.to_ascii_lowercase();
        if end == "bgcode" {
            return Ok(Format::Binary);
        }
        match OTHERS.iter().find(|(other, _)| *other == end) {
            Some((_, what)) => Err(FormatError {
                path: path.to_owned(),
                what,
            }),
            None => Ok(Format::Text),
        }
    }
}

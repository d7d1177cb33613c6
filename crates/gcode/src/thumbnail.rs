//! Pictures in a file's head, in the form hosts and printers read.
//!
//! In: files of pictures. Out: a block of comments for each picture: an empty
//! comment; a line with the format, the size and the number of base64
//! characters, which readers check; those characters in short lines; and an
//! end.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use isoslice_settings::{ImageFormat, PictureSize};

/// A picture for the file's head.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thumbnail {
    /// Width, height and format of the picture.
    pub size: PictureSize,
    /// The picture, as a file of that format.
    pub file: Vec<u8>,
}

/// Base64 characters in a line: as many as readers take.
const LINE: usize = 78;

/// The block of comments of a picture.
pub(super) fn block(picture: &Thumbnail) -> String {
    let code = STANDARD.encode(&picture.file);
    let PictureSize { pixels, format } = picture.size;
    let [width, height] = pixels;
    let tag = match format {
        ImageFormat::Png => "thumbnail",
        ImageFormat::Jpg => "thumbnail_JPG",
        ImageFormat::Qoi => "thumbnail_QOI",
    };
    let mut text =
        format!("\n;\n; {tag} begin {width}x{height} {}\n", code.len());
    let mut rest = code.as_str();
    while !rest.is_empty() {
        let (line, after) = rest.split_at(rest.len().min(LINE));
        text.push_str("; ");
        text.push_str(line);
        text.push('\n');
        rest = after;
    }
    text.push_str(&format!("; {tag} end\n;\n"));
    text
}

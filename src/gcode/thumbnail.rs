//! Pictures in a file's head, in the form hosts and printers read.
//!
//! In: PNG files. Out: for each a block of comments: an empty one, a line with
//! the size and the number of base64 characters (readers refuse a block that
//! has others), those characters in short lines, and an end.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// A picture for the file's head.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thumbnail {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The picture, as a PNG file.
    pub png: Vec<u8>,
}

/// Characters of base64 in a line: what readers take.
const LINE: usize = 78;

/// The picture's block.
pub(super) fn block(picture: &Thumbnail) -> String {
    let code = STANDARD.encode(&picture.png);
    let [width, height] = picture.size;
    let mut text =
        format!("\n;\n; thumbnail begin {width}x{height} {}\n", code.len());
    let mut rest = code.as_str();
    while !rest.is_empty() {
        let (line, after) = rest.split_at(rest.len().min(LINE));
        text.push_str("; ");
        text.push_str(line);
        text.push('\n');
        rest = after;
    }
    text.push_str("; thumbnail end\n;\n");
    text
}

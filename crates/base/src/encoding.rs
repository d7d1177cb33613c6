//! Reads text from bytes.
//!
//! In: the bytes of a file. Out: the text in UTF-8, without the byte-order mark
//! that some editors write at the beginning, or the reason why the bytes are no
//! text.

/// The byte-order mark of UTF-8.
const MARK: &[u8] = "\u{feff}".as_bytes();

/// Why bytes are not text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotText {
    /// The bytes are text in UTF-16.
    #[error("it is text in UTF-16; save it as UTF-8")]
    Utf16,
    /// The bytes are not UTF-8. The first that is not is in this line.
    #[error("line {0}: not valid UTF-8; save the file as plain text")]
    Line(usize),
}

/// The bytes after the byte-order mark.
///
/// # Errors
/// If the bytes are UTF-16.
pub(crate) fn unmarked(bytes: &[u8]) -> Result<&[u8], NotText> {
    let marked =
        bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    // In UTF-16 without a mark every other byte of English text is 0.
    let every_other = |at: usize| {
        bytes.len() >= 4
            && bytes.iter().take(64).skip(at).step_by(2).all(|b| *b == 0)
            && bytes
                .iter()
                .take(64)
                .skip(1 - at)
                .step_by(2)
                .all(|b| *b != 0)
    };
    if marked || every_other(0) || every_other(1) {
        Err(NotText::Utf16)
    } else {
        Ok(bytes.strip_prefix(MARK).unwrap_or(bytes))
    }
}

/// The text of a file.
///
/// # Errors
/// If the bytes are not UTF-8.
pub fn text(bytes: &[u8]) -> Result<&str, NotText> {
    let bytes = unmarked(bytes)?;
    std::str::from_utf8(bytes).map_err(|e| {
        let before = bytes.get(..e.valid_up_to()).unwrap_or_default();
        NotText::Line(1 + before.iter().filter(|b| **b == b'\n').count())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_skipped_and_other_encodings_named() {
        assert_eq!(text("\u{feff}x - 1".as_bytes()), Ok("x - 1"));
        assert_eq!(text("é\n\u{feff}".as_bytes()), Ok("é\n\u{feff}"));
        let wide = |order: fn(u16) -> [u8; 2], mark: &str| -> Vec<u8> {
            let text = format!("{mark}let r = 5;\r\nx - r");
            text.encode_utf16().flat_map(order).collect()
        };
        for order in [u16::to_le_bytes, u16::to_be_bytes] {
            for mark in ["\u{feff}", ""] {
                assert_eq!(text(&wide(order, mark)), Err(NotText::Utf16));
            }
        }
        assert_eq!(text(b"a\nb\xff"), Err(NotText::Line(2)));
        assert_eq!(text(b"\0\0\0\0"), Ok("\0\0\0\0"));
        assert_eq!(text(b""), Ok(""));
    }
}

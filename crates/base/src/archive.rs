//! Counts the files of an archive (ZIP) before it is opened.
//!
//! An archive's directory is read as a whole when it is opened, and takes more
//! memory than it is long. So its headers are counted beforehand. A header may
//! also stand in a file by chance, once in some gigabytes.

use memchr::memmem;
use std::io::{self, Read};

/// The header of a file in an archive's directory.
const HEADER: &[u8] = b"PK\x01\x02";

/// Counts headers in bytes that come piece by piece.
#[derive(Debug, Default)]
pub struct Headers {
    count: usize,
    /// The last bytes that were seen, in which a header may begin.
    tail: Vec<u8>,
}

impl Headers {
    /// The headers so far.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Counts the headers in the bytes that follow what was seen before.
    pub fn see(&mut self, bytes: &[u8]) {
        let keep = HEADER.len() - 1;
        self.tail.extend(&bytes[..bytes.len().min(keep)]);
        let find = |bytes: &[u8]| memmem::find_iter(bytes, HEADER).count();
        self.count += find(&self.tail) + find(bytes);
        let rest = bytes.len().saturating_sub(keep).max(bytes.len().min(keep));
        self.tail.extend(&bytes[rest..]);
        self.tail.drain(..self.tail.len().saturating_sub(keep));
    }
}

/// Number of headers in what is left of a file, counted until there are more
/// than `most`.
///
/// # Errors
/// Those of reading, and if the work is stopped.
pub fn headers(source: &mut impl Read, most: usize) -> io::Result<usize> {
    let mut headers = Headers::default();
    let mut piece = vec![0; 1 << 16];
    while headers.count() <= most {
        crate::limits::io_goes_on()?;
        match source.read(&mut piece)? {
            0 => break,
            read => headers.see(&piece[..read]),
        }
    }
    Ok(headers.count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_counted_wherever_pieces_end() {
        let mut bytes = b"PPK\x01PK\x01\x02".to_vec();
        bytes.resize((1 << 16) - 2, b'P');
        bytes.extend_from_slice(b"PK\x01\x02PK\x01\x02PK\x01");
        let count = |most| headers(&mut &bytes[..], most).unwrap();
        assert_eq!(count(9), 3);
        assert!(count(1) > 1);
        for size in 1..9 {
            let mut headers = Headers::default();
            bytes.chunks(size).for_each(|piece| headers.see(piece));
            assert_eq!(headers.count(), 3, "{size}");
        }
    }
}

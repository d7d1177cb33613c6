//! Reads numbers from bytes, compressed or not, without trust in how many a
//! header says there are.

use crate::numbers::{Kind, Numbers};
use flate2::bufread::MultiGzDecoder;
use isoslice_base::problem::{Problem, go_on};
use std::io::Read;

/// The most bytes that a byte of gzip can stand for.
const MOST_RATIO: usize = 1032;

/// Bytes that are read at once; numbers of 8 bytes fit evenly.
const PART: usize = 1 << 16;

/// Numbers that are bytes as they are.
pub(crate) fn raw(
    bytes: &[u8],
    kind: Kind,
    big: bool,
    count: usize,
) -> Problem<Numbers> {
    let Some(data) = bytes.get(..count * kind.size()) else {
        return Err(too_few(kind, count, bytes.len()));
    };
    let mut numbers = kind.list(count);
    kind.append(data, big, &mut numbers);
    Ok(numbers)
}

fn too_few(kind: Kind, count: usize, bytes: usize) -> String {
    format!(
        "its header says {count} numbers of {} bytes, but {bytes} bytes follow; \
         the file is cut off: save it again",
        kind.size()
    )
}

/// What gzip has made of bytes.
pub(crate) struct Unzipped<'a> {
    from: MultiGzDecoder<&'a [u8]>,
    /// The length of the whole file, compressed.
    length: usize,
}

impl<'a> Unzipped<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Unzipped<'a> {
        Unzipped {
            from: MultiGzDecoder::new(bytes),
            length: bytes.len(),
        }
    }

    /// The next bytes.
    pub(crate) fn bytes(&mut self, into: &mut [u8]) -> Problem<()> {
        self.from.read_exact(into).map_err(broken)
    }

    /// Leaves out bytes.
    pub(crate) fn skip(&mut self, count: usize) -> Problem<()> {
        let mut part = (&mut self.from).take(count as u64);
        let skipped = std::io::copy(&mut part, &mut std::io::sink());
        if skipped.map_err(broken)? < count as u64 {
            return Err("its data begins after its end; save it again".into());
        }
        Ok(())
    }

    /// The next numbers.
    pub(crate) fn numbers(
        &mut self,
        kind: Kind,
        big: bool,
        count: usize,
    ) -> Problem<Numbers> {
        let mut left = count * kind.size();
        if left / MOST_RATIO > self.length {
            return Err(too_few(kind, count, self.length));
        }
        let mut numbers = kind.list(count);
        let mut part = vec![0; PART];
        while left > 0 {
            go_on()?;
            let next = left.min(PART);
            let into = part.get_mut(..next).unwrap_or_default();
            self.bytes(into)?;
            kind.append(into, big, &mut numbers);
            left -= next;
        }
        Ok(numbers)
    }
}

fn broken(e: std::io::Error) -> String {
    format!("its compressed data is broken or cut off ({e}); save it again")
}

//! Archives of files (ZIP), of unknown origin.

use std::io::{Read, Seek};
use zip::ZipArchive;

/// The header of an entry in an archive's directory.
const HEADER: [u8; 4] = *b"PK\x01\x02";

/// Opens an archive that may have at most `most` entries. `what` says what has so
/// few.
///
/// The directory is read as a whole when an archive is opened, and takes more
/// memory than it is long. So its headers are counted beforehand. A header may
/// also stand in an entry by chance, once in some gigabytes.
///
/// # Errors
/// A sentence, if the file is no archive, or has more entries.
pub(crate) fn open<R: Read + Seek>(
    mut source: R,
    most: usize,
    what: &str,
) -> Result<ZipArchive<R>, String> {
    if headers(&mut source, most).map_err(damaged)? > most {
        return Err(format!(
            "it holds more than {most} files, and {what} fewer"
        ));
    }
    source.rewind().map_err(damaged)?;
    ZipArchive::new(source).map_err(damaged)
}

/// What is wrong with an archive.
pub(crate) fn damaged(why: impl std::fmt::Display) -> String {
    format!("its archive: {why}")
}

/// The bytes of an entry, of which there may be `most`. `what` is the entry.
///
/// # Errors
/// A sentence, if the entry is damaged or has more.
pub(crate) fn unpacked(
    entry: impl Read,
    most: u64,
    what: &str,
) -> Result<Vec<u8>, String> {
    let bytes = up_to(entry, most).map_err(damaged)?;
    bytes.ok_or_else(|| {
        format!("{what} is larger than {} MB unpacked", most >> 20)
    })
}

/// All bytes of a source; none if there are more than `most`.
pub(crate) fn up_to(
    source: impl Read,
    most: u64,
) -> std::io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    source.take(most + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= most).then_some(bytes))
}

/// Number of headers in what is left of a file, counted until there are more
/// than `most`.
fn headers(source: &mut impl Read, most: usize) -> std::io::Result<usize> {
    let (mut count, mut matched) = (0, 0);
    let mut piece = vec![0; 1 << 16];
    while count <= most {
        let read = source.read(&mut piece)?;
        if read == 0 {
            break;
        }
        for byte in &piece[..read] {
            matched = match *byte {
                byte if byte == HEADER[matched] => matched + 1,
                byte => usize::from(byte == HEADER[0]),
            };
            if matched == HEADER.len() {
                (count, matched) = (count + 1, 0);
            }
        }
    }
    Ok(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn headers_are_counted_wherever_pieces_end() {
        let mut bytes = b"PPK\x01PK\x01\x02".to_vec();
        bytes.resize((1 << 16) - 2, b'P');
        bytes.extend_from_slice(b"PK\x01\x02PK\x01\x02PK\x01");
        let count = |most| headers(&mut &bytes[..], most).unwrap();
        assert_eq!(count(9), 3);
        assert!(count(1) > 1);
    }

    /// A directory that claims more entries than there is memory for is never
    /// read.
    #[test]
    fn an_archive_of_very_many_entries_is_not_opened() {
        let mut entry = HEADER.to_vec();
        entry.resize(46, 0);
        let refused = open(Cursor::new(entry.repeat(20)), 10, "a project has");
        let why = refused.err().unwrap();
        assert_eq!(why, "it holds more than 10 files, and a project has fewer");
        let refused = open(Cursor::new(entry.repeat(5)), 10, "a project has");
        assert!(refused.err().unwrap().starts_with("its archive: "));
    }
}

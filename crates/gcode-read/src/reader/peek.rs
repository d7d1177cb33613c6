//! Finds what a file says about itself before the file is read.
//!
//! In: a file. Out: the diameter of the filament that it was made for, which slicers
//! write at the end, or at the beginning; and where a range of layers begins.

use super::info::Info;
use isoslice_base::units::Mm;
use std::io::{Read, Seek, SeekFrom};

/// How much is read at each end, bytes. The settings take up to 60 kB, and
/// pictures may come before them.
const ENDS: u64 = 1 << 18;

/// A lower beginning is the bed, mm.
const ROUNDED: Mm = 1e-3;

/// The diameter of the filament that a text file was made for, if it says so. The
/// file is then read from its beginning. Pipes are not read.
pub fn filament_diameter(file: &mut (impl Read + Seek)) -> Option<Mm> {
    let length = file.seek(SeekFrom::End(0)).ok()?;
    let mut said = None;
    for from in [length.saturating_sub(ENDS), 0] {
        said = said.or_else(|| said_from(file, from));
    }
    file.rewind().ok()?;
    said
}

/// What comments say that begin at a byte, or soon after it.
fn said_from(file: &mut (impl Read + Seek), from: u64) -> Option<Mm> {
    file.seek(SeekFrom::Start(from)).ok()?;
    let mut text = Vec::new();
    file.take(ENDS).read_to_end(&mut text).ok()?;
    let mut info = Info::default();
    for line in text.split(|b| *b == b'\n') {
        if let Some(comment) = line.strip_prefix(b";") {
            info.comment(comment);
        }
    }
    info.filament_diameter
}

/// The height at which a text file begins to print, if isoslice has written it and it
/// is a range of a part's layers. The file is then read from its beginning. Pipes are
/// not read.
pub fn range_bottom(file: &mut (impl Read + Seek)) -> Option<Mm> {
    file.rewind().ok()?;
    let mut text = Vec::new();
    file.take(ENDS).read_to_end(&mut text).ok()?;
    file.rewind().ok()?;
    let text = String::from_utf8_lossy(&text);
    let (_, range) = text.split_once("\n; range of: isoslice ")?;
    let number = |name: &str| -> Option<Mm> {
        let (_, after) = range.split_once(name)?;
        after.lines().next()?.parse().ok()
    };
    let base = number("\n;Z:")? - number("\n;HEIGHT:")?;
    (base.is_finite() && base > ROUNDED).then_some(base)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn a_range_begins_where_its_first_layer_lies() {
        let base_of = |text: &str| {
            let mut file = Cursor::new(text.as_bytes());
            let found = range_bottom(&mut file);
            assert_eq!(file.position(), 0);
            found
        };
        let range =
            "; a\n; layers 12 to 20 of 40\n; range of: isoslice 1\nG21\n";
        let with = |z: &str| {
            base_of(&format!("{range};LAYER_CHANGE\n;Z:{z}\n;HEIGHT:0.2\nG1\n"))
        };
        assert!(with("2.4").is_some_and(|base| (base - 2.2).abs() < 1e-9));
        assert_eq!([with("0.2"), with("x"), with("inf")], [None; 3]);
        assert_eq!(base_of("; a\n;Z:2.4\n;HEIGHT:0.2\n"), None);
        assert_eq!([base_of(range), base_of("")], [None; 2]);
    }

    #[test]
    fn both_ends_are_read() {
        let moves = "G1 X1 Y1 E1\n".repeat(100_000);
        let said = "; filament_diameter = 2.85,1.75\n";
        for text in [
            format!("{said}{moves}"),
            format!("{moves}{said}"),
            format!("{moves}{}", said.trim_end()),
        ] {
            let mut file = Cursor::new(text.as_bytes());
            assert_eq!(filament_diameter(&mut file), Some(2.85));
            assert_eq!(file.position(), 0);
        }
        assert_eq!(filament_diameter(&mut Cursor::new(moves)), None);
        assert_eq!(filament_diameter(&mut Cursor::new("")), None);
    }
}

//! Pictures, of which each version of a file is decoded once.
//!
//! A script may lay out one picture in several ways, and a change of its size in
//! `watch` makes it anew: its pixels stay what they are while somebody uses them.

use super::lock;
use super::version::FileVersion;
use isoslice_base::problem::NamedProblem;
use isoslice_pictures::{Picture, PictureOptions, TransparentAs};
use std::path::Path;
use std::sync::{Arc, Mutex, Weak};

/// On what pixels depend.
#[derive(PartialEq)]
struct Source {
    file: FileVersion,
    transparent: TransparentAs,
    missing: Option<f64>,
}

/// Pictures that may be in use.
static KNOWN: Mutex<Vec<(Source, Weak<Picture>)>> = Mutex::new(Vec::new());

/// A picture of a file, whose bytes `read` returns.
///
/// # Errors
/// In words, if it cannot be read.
pub(super) fn picture(
    path: &Path,
    name: &str,
    options: &PictureOptions,
    read: impl FnOnce() -> Result<Vec<u8>, String>,
) -> Result<Arc<Picture>, String> {
    let source = FileVersion::of(path)?.map(|file| Source {
        file,
        transparent: options.transparent,
        missing: options.missing,
    });
    let in_words = |e: NamedProblem| e.problem().to_owned();
    let picture = match source.as_ref().and_then(known) {
        Some(known) => known.again(name, options).map_err(in_words)?,
        None => Picture::read(name, &read()?, options).map_err(in_words)?,
    };
    let picture = Arc::new(picture);
    if let Some(source) = source {
        let mut known = lock(&KNOWN);
        known.retain(|(_, picture)| picture.strong_count() > 0);
        known.push((source, Arc::downgrade(&picture)));
    }
    Ok(picture)
}

/// A picture with the same pixels that is in use.
fn known(source: &Source) -> Option<Arc<Picture>> {
    let known = lock(&KNOWN);
    let same = known.iter().filter(|(own, _)| own == source);
    same.filter_map(|(_, picture)| picture.upgrade()).next()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use isocontour::Data;

    #[test]
    fn pixels_are_read_once_for_all_sizes() {
        let header =
            "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2)}\n";
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        for v in [0.0_f32, 0.25, 0.5, 1.0] {
            bytes.extend(v.to_le_bytes());
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.npy");
        std::fs::write(&path, &bytes).unwrap();
        let sized = |width: f64, read: Result<Vec<u8>, String>| {
            let options = PictureOptions {
                width_mm: Some(width),
                ..PictureOptions::default()
            };
            picture(&path, "x.npy", &options, || read)
        };
        let never = || Err("it is read again".to_owned());
        let small = sized(2.0, Ok(bytes.clone())).unwrap();
        let large = sized(20.0, never()).unwrap();
        for p in [DVec3::new(0.7, 1.2, 0.0), DVec3::new(1.5, 0.1, 3.0)] {
            let scaled = DVec3::new(10.0 * p.x, 10.0 * p.y, p.z);
            assert!((small.value(p) - large.value(scaled)).abs() < 1e-12);
        }
        // Nobody uses the pixels any more.
        drop((small, large));
        assert_eq!(sized(3.0, never()).unwrap_err(), "it is read again");
        // Another version of the file.
        let kept = sized(2.0, Ok(bytes.clone())).unwrap();
        bytes.push(0);
        std::fs::write(&path, &bytes).unwrap();
        assert!(sized(2.0, never()).is_err());
        drop(kept);
    }
}

//! The archive, of unknown origin.

use isoslice_base::archive::headers;
use isoslice_mesh::MeshError;
use std::collections::BTreeSet;
use std::io::{self, Read, Seek};
use zip::ZipArchive;
use zip::result::ZipError;

/// Greatest number of files in an archive. Projects have a dozen, and a few for
/// each object.
pub(crate) const MOST_FILES: usize = 10_000;
/// Greatest length of all files that are read, unpacked, bytes. As many triangles
/// as are allowed take 5 GB.
const MOST_BYTES: u64 = 8 << 30;
/// Greatest ratio of a file's length to its packed one, beyond
/// [`ALWAYS_UNPACKED`]. Meshes reach 20; what is made to fill the memory, 1000.
const LIKELY: u64 = 200;
/// A file that is no longer than this is unpacked whatever the ratio, bytes.
const ALWAYS_UNPACKED: u64 = 1 << 24;

/// An archive.
pub(crate) struct Package<R> {
    archive: ZipArchive<R>,
    /// The bytes that may still be unpacked.
    left: u64,
    /// What its model files hold so far.
    pub held: Held,
}

/// What model files hold.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Held {
    /// Number of vertices, triangles, beams and balls.
    pub shapes: usize,
    /// Number of nodes of functions, of their inputs and of their outputs.
    pub nodes: usize,
}

impl<R: Read + Seek> Package<R> {
    /// Opens an archive, once its headers are counted.
    pub(crate) fn open(mut source: R) -> Result<Package<R>, MeshError> {
        if headers(&mut source, MOST_FILES)? > MOST_FILES {
            return Err(MeshError::File(format!(
                "it is an archive of more than {MOST_FILES} files, and projects \
                 have fewer"
            )));
        }
        source.rewind()?;
        let archive = ZipArchive::new(source).map_err(|e| {
            MeshError::File(format!(
                "its archive is damaged ({e}); copy it again, or save it again"
            ))
        })?;
        Ok(Package {
            archive,
            left: MOST_BYTES,
            held: Held::default(),
        })
    }

    /// Calls `read` with the bytes of a file. None if there is none of that name.
    pub(crate) fn with<T>(
        &mut self,
        name: &str,
        read: impl FnOnce(&mut dyn Read) -> Result<T, MeshError>,
    ) -> Result<Option<T>, MeshError> {
        let entry = match self.archive.by_name(name.trim_start_matches('/')) {
            Err(ZipError::FileNotFound) => return Ok(None),
            Err(e) => return Err(MeshError::at(name, e.to_string())),
            Ok(entry) => entry,
        };
        let most = entry
            .compressed_size()
            .saturating_mul(LIKELY)
            .saturating_add(ALWAYS_UNPACKED)
            .min(self.left);
        let mut bytes = Limited { entry, left: most };
        let result = read(&mut bytes);
        self.left = self.left.saturating_sub(most - bytes.left);
        result.map(Some)
    }

    /// The names of all files, in small letters.
    pub(crate) fn names(&self) -> BTreeSet<String> {
        self.archive.file_names().map(str::to_lowercase).collect()
    }
}

/// Bytes that end in an error if there are too many.
struct Limited<R> {
    entry: R,
    left: u64,
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = self.entry.read(out)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| {
            io::Error::other("it unpacks to far more than a mesh can be")
        })?;
        Ok(count)
    }
}

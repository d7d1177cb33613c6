//! The data that models read from files, such as meshes.
//!
//! In: the folder of the script or formula, and names in it. Out: expressions
//! that read the files' data.
//!
//! A model reads only what lies in its own folder or below it: no absolute
//! path, no `..`, and no link that leads out. A file that has not changed is
//! read once, as long as somebody uses it.

use fidget::context::Tree;
use isocontour::{Data, call};
use isoslice_base::units::human_bytes;
use isoslice_mesh::{Format, Mesh};
use std::fs::{self, File, Metadata};
use std::io::BufReader;
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant, SystemTime};

/// Greatest length of a mesh's file. Ten million triangles take 500 MB.
const MOST_BYTES: u64 = 1 << 30;

/// The files that one model may read, and what it has read.
pub(crate) struct Files {
    folder: PathBuf,
    taken: Taken,
    /// An expression does not keep its data.
    kept: Mutex<Vec<Arc<dyn Data>>>,
    read: Mutex<Vec<PathBuf>>,
}

/// What the reading of data took, which no script is blamed for.
#[derive(Clone, Default)]
pub(crate) struct Taken(Arc<[AtomicU64; 2]>);

impl Taken {
    /// The data's memory, in bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.0[0].load(Ordering::Relaxed)
    }

    /// The time that the reading took.
    pub(crate) fn time(&self) -> Duration {
        Duration::from_micros(self.0[1].load(Ordering::Relaxed))
    }

    fn add(&self, bytes: u64, time: Duration) {
        let time = u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        self.0[0].fetch_add(bytes, Ordering::Relaxed);
        self.0[1].fetch_add(time, Ordering::Relaxed);
    }
}

impl Default for Files {
    fn default() -> Files {
        Files::within(Path::new(""))
    }
}

impl Files {
    /// The files in a folder.
    pub(crate) fn within(folder: &Path) -> Files {
        let here = folder.as_os_str().is_empty();
        Files {
            folder: if here { ".".into() } else { folder.into() },
            taken: Taken::default(),
            kept: Mutex::default(),
            read: Mutex::default(),
        }
    }

    /// What the reading took so far. It goes on counting.
    pub(crate) fn taken(&self) -> Taken {
        self.taken.clone()
    }

    /// The files that were read.
    pub(crate) fn read(&self) -> Vec<PathBuf> {
        lock(&self.read).clone()
    }

    /// A file as a function, negative inside.
    ///
    /// # Errors
    /// In words, if it cannot be read, or may not be.
    pub(crate) fn mesh(&self, name: &str) -> Result<Tree, String> {
        let path = self.find(name)?;
        let call_name = format!("mesh(\"{name}\")");
        let data = self.data(&call_name, &path)?;
        let (x, y, z) = Tree::axes();
        Ok(call(&data, [x, y, z]))
    }

    /// The path of a file in the folder.
    fn find(&self, name: &str) -> Result<PathBuf, String> {
        let shown = name.escape_default();
        let is_plain = Path::new(name)
            .components()
            .all(|c| matches!(c, Component::Normal(_)));
        if name.is_empty() || !is_plain {
            return Err(format!(
                "\"{shown}\" is not the name of a file in the model's own \
                 folder; a model reads only what lies there or in folders \
                 below, as in \"part.stl\" or \"parts/part.stl\""
            ));
        }
        let path = self.folder.join(name);
        let absent =
            |e: std::io::Error| format!("cannot read {}: {e}", path.display());
        let real = fs::canonicalize(&path).map_err(absent)?;
        let folder = fs::canonicalize(&self.folder).map_err(absent)?;
        if !real.starts_with(folder) {
            return Err(format!(
                "{} is a link that leads out of the model's folder; copy the \
                 file there",
                path.display()
            ));
        }
        Ok(path)
    }

    /// The data of a mesh's file.
    fn data(&self, name: &str, path: &Path) -> Result<Arc<dyn Data>, String> {
        let begin = Instant::now();
        let data = mesh_of(name, path)?;
        self.taken.add(data.bytes() as u64, begin.elapsed());
        lock(&self.kept).push(data.clone());
        lock(&self.read).push(path.to_owned());
        Ok(data)
    }
}

/// True for the name of a mesh's file. A plate of G-code, `part.gcode.3mf`, is
/// none.
pub(crate) fn is_mesh(path: &Path) -> bool {
    let extension = |path: &Path| {
        let extension = path.extension().unwrap_or_default();
        extension.to_string_lossy().to_ascii_lowercase()
    };
    let inner = path.file_stem().map(Path::new).map(extension);
    Format::of_extension(&extension(path)).is_some()
        && inner.as_deref() != Some("gcode")
}

/// A mesh's file as data. Equal files that somebody uses are read once.
///
/// # Errors
/// In words, if the file is no such mesh.
pub(crate) fn mesh_of(
    name: &str,
    path: &Path,
) -> Result<Arc<dyn Data>, String> {
    /// Meshes in use, and the files that they are from.
    static KNOWN: Mutex<Vec<(Version, Weak<dyn Data>)>> =
        Mutex::new(Vec::new());
    let failed = |e: &dyn std::fmt::Display| {
        format!("cannot read {}: {e}", path.display())
    };
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let format = Format::of_extension(&extension).ok_or_else(|| {
        format!(
            "{} is not known as a mesh; meshes are .stl, .obj, .ply and .3mf \
             files",
            path.display()
        )
    })?;
    let facts = fs::metadata(path).map_err(|e| failed(&e))?;
    if !facts.is_file() {
        return Err(failed(&"it is not a file"));
    }
    if facts.len() > MOST_BYTES {
        return Err(failed(&format!(
            "it is larger than {}; make its mesh coarser",
            human_bytes(MOST_BYTES)
        )));
    }
    let version = Version::of(name, path, &facts);
    if let Some(known) = version.as_ref().and_then(|version| {
        let known = lock(&KNOWN);
        let same = known.iter().find(|(v, _)| v == version)?;
        same.1.upgrade()
    }) {
        return Ok(known);
    }
    let file = File::open(path).map_err(|e| failed(&e))?;
    let triangles = isoslice_mesh::read(BufReader::new(file), format);
    let triangles = triangles.map_err(|e| failed(&e))?;
    let mesh = Mesh::new(name, triangles).map_err(|e| failed(&e))?;
    let data: Arc<dyn Data> = Arc::new(mesh);
    if let Some(version) = version {
        let mut known = lock(&KNOWN);
        known.retain(|(_, data)| data.strong_count() > 0);
        known.push((version, Arc::downgrade(&data)));
    }
    Ok(data)
}

/// A file as it was at some time, and the name that messages give it.
#[derive(PartialEq)]
struct Version {
    name: String,
    path: PathBuf,
    length: u64,
    changed: SystemTime,
}

impl Version {
    fn of(name: &str, path: &Path, facts: &Metadata) -> Option<Version> {
        Some(Version {
            name: name.to_owned(),
            path: fs::canonicalize(path).ok()?,
            length: facts.len(),
            changed: facts.modified().ok()?,
        })
    }
}

fn lock<T>(of: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

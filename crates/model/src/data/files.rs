//! The files that models read, and the data made of them.
//!
//! In: the folder of the script or formula, and names in it. Out: expressions
//! that read the files' data.
//!
//! A file that has not changed is read once, as long as somebody uses it.

use super::folder::Folder;
use super::kinds::{Asked, Kind, Made, kind};
use super::lock;
use super::options::Options;
use super::taken::Taken;
use super::version::FileVersion;
use fidget::context::Tree;
use glam::DVec3;
use isocontour::Data;
use isoslice_base::units::human_bytes;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, Weak};

/// Greatest memory of a model's data, bytes: as much as a whole run may take.
const MOST_DATA_BYTES: u64 = 4 << 30;
/// Greatest number of times that a model has data made. A calendar has a text
/// for each day.
const MOST_MADE: u64 = 1000;

/// The files that one model may read, and what it has read.
pub(crate) struct Files {
    folder: Folder,
    most: Most,
    taken: Taken,
    /// An expression does not keep its data.
    kept: Mutex<Kept>,
}

/// What a model may take.
#[derive(Clone, Copy)]
struct Most {
    bytes: u64,
    times: u64,
}

/// The data of a model, each once.
#[derive(Default)]
struct Kept {
    data: Vec<Arc<dyn Data>>,
    notes: Vec<String>,
    /// What the data takes, bytes.
    bytes: u64,
    /// The addresses of what several of them share, which counts once.
    shared: BTreeSet<usize>,
    /// How often something was asked for that was not kept.
    times: u64,
    /// How far the model's own mesh was moved.
    moved: DVec3,
    /// What was made of each thing that was asked for.
    trees: HashMap<Version, Tree>,
}

impl Default for Files {
    fn default() -> Files {
        Files::within(Path::new(""))
    }
}

impl Files {
    /// The files in a folder.
    pub(crate) fn within(folder: &Path) -> Files {
        let most = Most {
            bytes: MOST_DATA_BYTES,
            times: MOST_MADE,
        };
        Files::of(Folder::new(Some(folder)), most)
    }

    /// All files, for programs that have them anyway. They may make any number of
    /// models.
    pub(crate) fn anywhere() -> Files {
        let most = Most {
            bytes: u64::MAX,
            times: u64::MAX,
        };
        Files::of(Folder::new(None), most)
    }

    fn of(folder: Folder, most: Most) -> Files {
        Files {
            folder,
            most,
            taken: Taken::default(),
            kept: Mutex::default(),
        }
    }

    /// What the making of data took so far. It goes on counting.
    pub(crate) fn taken(&self) -> Taken {
        self.taken.clone()
    }

    /// How often something new was asked for.
    #[cfg(test)]
    pub(super) fn times(&self) -> u64 {
        lock(&self.kept).times
    }

    /// The files that were read.
    pub(crate) fn read(&self) -> Vec<PathBuf> {
        self.folder.found()
    }

    /// What users should know of what was read, in sentences.
    pub(crate) fn notes(&self) -> Vec<String> {
        lock(&self.kept).notes.clone()
    }

    /// What a function makes of a file, or of a text, as a function of x, y
    /// and z.
    ///
    /// # Errors
    /// In words, if it cannot be made, or the file may not be read.
    pub(crate) fn call(
        &self,
        kind: &Kind,
        text: &str,
        options: &Options,
    ) -> Result<Tree, String> {
        let file = kind.file_of(text, options);
        let path = file.map(|name| self.folder.find(name)).transpose()?;
        self.made(
            &Asked {
                text,
                path: path.as_deref(),
                options,
                is_model: false,
            },
            kind,
        )
    }

    /// A mesh's file as a function of x, y and z. One that lies far from the origin
    /// is moved there.
    ///
    /// # Errors
    /// In words, if it cannot be read.
    pub(crate) fn mesh(&self, path: &Path) -> Result<Tree, String> {
        let kind = kind("mesh").ok_or("meshes are not known")?;
        let shown = path.file_name().unwrap_or_default().to_string_lossy();
        self.made(
            &Asked {
                text: &shown,
                path: Some(path),
                options: &Options::new(),
                is_model: true,
            },
            kind,
        )
    }

    /// How far the model's own mesh was moved to lie near the origin, mm.
    pub(crate) fn moved(&self) -> DVec3 {
        lock(&self.kept).moved
    }

    fn made(&self, asked: &Asked<'_>, kind: &Kind) -> Result<Tree, String> {
        let version = Version::of(kind, asked)?;
        let own = |version| lock(&self.kept).trees.get(version).cloned();
        if let Some(tree) = version.as_ref().and_then(own) {
            return Ok(tree);
        }
        // What other models made counts too: whether a model is refused must
        // not depend on them.
        lock(&self.kept).count(kind, self.most.times)?;
        let made = match version.as_ref().and_then(known) {
            Some(made) => made,
            None => make(kind, asked, version.clone(), &self.taken)?,
        };
        let Made {
            tree,
            data,
            notes,
            moved,
        } = made;
        let mut kept = lock(&self.kept);
        kept.moved += moved;
        kept.keep(data, notes, self.most.bytes)?;
        kept.trees
            .extend(version.map(|version| (version, tree.clone())));
        Ok(tree)
    }
}

impl Kept {
    /// Counts what is asked for, which may be impossible to make.
    fn count(&mut self, kind: &Kind, most: u64) -> Result<(), String> {
        if self.times >= most {
            return Err(format!(
                "{} makes data more than {most} times in one script; repeat \
                 it with % (modulo) of a coordinate instead of loops",
                kind.name
            ));
        }
        self.times += 1;
        Ok(())
    }

    /// Keeps what was made of a file or a text, unless it is kept already.
    fn keep(
        &mut self,
        made: Vec<Arc<dyn Data>>,
        notes: Vec<String>,
        most: u64,
    ) -> Result<(), String> {
        for data in made {
            if self.data.iter().any(|kept| Arc::ptr_eq(kept, &data)) {
                return Ok(());
            }
            let shared = data.shared();
            let again = shared.filter(|(at, _)| !self.shared.insert(*at));
            let counted = again.map_or(0, |(_, bytes)| bytes);
            let own = data.bytes().saturating_sub(counted);
            self.bytes = self.bytes.saturating_add(own as u64);
            if self.bytes > most {
                return Err(format!(
                    "with {} the model's data takes more than {}; read fewer \
                     or smaller files",
                    data.name(),
                    human_bytes(most)
                ));
            }
            self.data.push(data);
        }
        self.notes.extend(notes);
        Ok(())
    }
}

/// What was asked of a function, with the version of the file that it reads.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Version {
    asked: String,
    file: Option<FileVersion>,
}

impl Version {
    /// None if the system does not tell when the file was changed.
    fn of(kind: &Kind, asked: &Asked<'_>) -> Result<Option<Version>, String> {
        let file = match asked.path {
            None => None,
            Some(path) => match FileVersion::of(path)? {
                None => return Ok(None),
                known => known,
            },
        };
        let all = (kind.name, asked.text, asked.options, asked.is_model);
        let asked = format!("{all:?}");
        Ok(Some(Version { asked, file }))
    }
}

/// Data in use, with what was asked for it, and what users should know of it.
struct Known {
    version: Version,
    tree: Tree,
    data: Vec<Weak<dyn Data>>,
    notes: Vec<String>,
    moved: DVec3,
}

impl Known {
    /// What is known, if all of its data is still in use.
    fn made(&self) -> Option<Made> {
        Some(Made {
            tree: self.tree.clone(),
            data: self.data.iter().map(Weak::upgrade).collect::<Option<_>>()?,
            notes: self.notes.clone(),
            moved: self.moved,
        })
    }

    /// True if somebody may still use it.
    fn is_in_use(&self) -> bool {
        !self.data.is_empty()
            && self.data.iter().all(|data| data.strong_count() > 0)
    }
}

/// What somebody uses, of all models.
static KNOWN: Mutex<Vec<Known>> = Mutex::new(Vec::new());

/// What was made of a text, or of a file that has not changed, and is in use.
fn known(version: &Version) -> Option<Made> {
    let known = lock(&KNOWN);
    known.iter().find(|k| &k.version == version)?.made()
}

/// Makes what a function makes, and lets other models know.
fn make(
    kind: &Kind,
    asked: &Asked<'_>,
    version: Option<Version>,
    taken: &Taken,
) -> Result<Made, String> {
    let made = taken.making(|| kind.make(asked))?;
    if let Some(version) = version {
        let mut known = lock(&KNOWN);
        known.retain(Known::is_in_use);
        known.push(Known {
            version,
            tree: made.tree.clone(),
            data: made.data.iter().map(Arc::downgrade).collect(),
            notes: made.notes.clone(),
            moved: made.moved,
        });
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::super::options::Given;
    use super::*;

    #[test]
    fn the_pixels_of_a_picture_count_once_for_all_its_sizes() {
        let folder = tempfile::tempdir().unwrap();
        let header =
            "{'descr': '<f8', 'fortran_order': False, 'shape': (64, 64)}\n";
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend([0; 8 * 64 * 64]);
        for name in ["a.npy", "b.npy", "c.npy"] {
            std::fs::write(folder.path().join(name), &bytes).unwrap();
        }
        // Enough for two of them.
        let most = Most {
            bytes: 45_000,
            times: 100,
        };
        let files = Files::of(Folder::new(Some(folder.path())), most);
        let image = kind("image").unwrap();
        let sized = |name: &str, width: f64| {
            let width = ("width".to_owned(), Given::Number(width));
            files.call(image, name, &Options::from([width]))
        };
        for width in 1..20 {
            sized("a.npy", f64::from(width)).unwrap();
        }
        sized("b.npy", 1.0).unwrap();
        let error = sized("c.npy", 1.0).unwrap_err();
        assert!(error.contains("data takes more than"), "{error}");
    }
}

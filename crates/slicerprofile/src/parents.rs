//! Finds the file of the profile from which another one inherits, by its name.
//!
//! Guaranteed: the order in which a folder lists its files does not matter, and
//! the number of files that are looked at is bounded.

use crate::{Error, MOST_BYTES, PresetKind, bytes_of};
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};

/// Greatest number of files among which a parent is looked for.
const MOST_FILES: usize = 50_000;
/// Greatest depth of folders in which a parent is looked for.
const DEEPEST_FOLDER: usize = 4;
/// Greatest number of files, equally near, that are compared.
const MOST_ALIKE: usize = 50;

/// Where parents are looked for.
pub(crate) struct Parents<'a> {
    /// The first file that inherits, with its full path.
    first: PathBuf,
    beside: &'a [PathBuf],
    /// Files by their names without extension, sorted. The index is made when a
    /// parent is first looked for.
    index: Option<BTreeMap<String, Vec<PathBuf>>>,
}

impl<'a> Parents<'a> {
    /// The parents of a file, which is given by its full path.
    pub(crate) fn new(first: PathBuf, beside: &'a [PathBuf]) -> Self {
        let index = None;
        Parents {
            first,
            beside,
            index,
        }
    }

    /// The file of the parent `name` of the file `heir`. It is the one beside
    /// `heir`, or else the one that shares the longest path with `heir`.
    ///
    /// # Errors
    /// If files with different contents are equally near.
    pub(crate) fn find(
        &mut self,
        heir: &Path,
        name: &str,
    ) -> Result<Option<PathBuf>, Error> {
        let beside = heir.with_file_name(format!("{name}.json"));
        if !name.contains(['/', '\\']) && beside != heir && beside.is_file() {
            return Ok(Some(beside));
        }
        let (first, folders) = (&self.first, self.beside);
        let index = self.index.get_or_insert_with(|| files(first, folders));
        // A profile's name may have a slash, which is a dash in the name of its
        // file.
        let file = name.replace('/', "-");
        let Some(all) = index.get(name).or_else(|| index.get(&file)) else {
            return Ok(None);
        };
        let shared = |path: &Path| {
            let pairs = path.components().zip(heir.components());
            pairs.take_while(|(a, b)| a == b).count()
        };
        let others = all.iter().filter(|path| *path != heir);
        let most = others.clone().map(|path| shared(path)).max();
        let mut nearest = others.filter(|path| Some(shared(path)) == most);
        let Some(one) = nearest.next() else {
            return Ok(None);
        };
        let Some(second) = nearest.clone().next() else {
            return Ok(Some(one.clone()));
        };
        let ambiguous = |other: &Path| {
            Error::wrong(heir)(format!(
                "it inherits {name:?}, and there are two of that name: {} and \
                 {}; name the folder of the right one with --beside, and no \
                 folder that holds both",
                one.display(),
                other.display()
            ))
        };
        if nearest.clone().count() > MOST_ALIKE {
            return Err(ambiguous(second));
        }
        let text = bytes_of(one, MOST_BYTES)?;
        for other in nearest {
            if bytes_of(other, MOST_BYTES)? != text {
                return Err(ambiguous(other));
            }
        }
        Ok(Some(one.clone()))
    }
}

/// Files that may be parents, by their names without extension: files in the
/// heir's folder, in the folder of its kind above it, and in `beside`.
fn files(path: &Path, beside: &[PathBuf]) -> BTreeMap<String, Vec<PathBuf>> {
    let own = path.parent().unwrap_or(path);
    let is_kind = |folder: &Path| {
        let name = folder.file_name().and_then(|name| name.to_str());
        name.is_some_and(|name| PresetKind::of_word(name).is_some())
    };
    let of_kind = own.ancestors().take(DEEPEST_FOLDER).find(|f| is_kind(f));
    let mut queue: VecDeque<(PathBuf, usize)> = VecDeque::new();
    queue.push_back((of_kind.unwrap_or(own).to_owned(), 0));
    let beside = beside.iter().filter_map(|f| std::path::absolute(f).ok());
    queue.extend(beside.map(|folder| (folder, 0)));
    let mut found: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    let mut left = MOST_FILES;
    while let Some((folder, depth)) = queue.pop_front() {
        // A folder that cannot be read counts as empty.
        let entries = std::fs::read_dir(&folder).into_iter().flatten();
        let mut entries: Vec<_> = entries.flatten().take(left).collect();
        left -= entries.len();
        entries.sort_by_key(std::fs::DirEntry::path);
        for entry in entries {
            let path = entry.path();
            if entry.file_type().is_ok_and(|t| t.is_dir()) {
                if depth < DEEPEST_FOLDER {
                    queue.push_back((path, depth + 1));
                }
            } else if path.extension().is_some_and(|e| e == "json")
                && let Some(name) = path.file_stem().and_then(|n| n.to_str())
            {
                found.entry(name.to_owned()).or_default().push(path);
            }
        }
    }
    for paths in found.values_mut() {
        paths.sort();
        paths.dedup();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_nearest_of_several_files_counts_and_a_tie_is_an_error() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        for (file, text) in [
            ("user/process/mine.json", ""),
            ("sys/a/process/0.20.json", "a"),
            ("sys/b/process/0.20.json", "b"),
            ("sys/a/process/deep/base.json", "a"),
            ("sys/b/process/deep/base.json", "b"),
            ("sys/a/process/same.json", "s"),
            ("sys/b/process/same.json", "s"),
        ] {
            let path = root.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let mine = root.join("user/process/mine.json");
        let both = [root.join("sys")];
        let mut parents = Parents::new(mine.clone(), &both);
        let error = parents.find(&mine, "0.20").unwrap_err().to_string();
        for part in ["sys/a/process", "sys/b/process", "--beside"] {
            assert!(error.contains(part), "{error}");
        }
        let of_b = root.join("sys/b/process/0.20.json");
        for (heir, name, expected) in [
            (&mine, "same", Some("sys/a/process/same.json")),
            (&of_b, "base", Some("sys/b/process/deep/base.json")),
            (&of_b, "same", Some("sys/b/process/same.json")),
            (&mine, "none", None),
            (&mine, "mine", None),
        ] {
            let found = parents.find(heir, name).unwrap();
            assert_eq!(found, expected.map(|file| root.join(file)), "{name}");
        }
    }
}

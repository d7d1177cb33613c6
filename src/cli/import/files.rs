//! The files of imported profiles: all of them are written, or none.

use super::super::output::{self, is_stream};
use super::words::slug;
use super::{Import, ImportArgs, Written, ours};
use anyhow::{Context, bail};
use isoslice::files::Output;
use slicerprofile::PresetKind;
use std::fs;
use std::path::{Path, PathBuf};

impl Import {
    /// Writes everything into one file.
    pub(super) fn write_one(
        &self,
        path: &Path,
        args: &ImportArgs,
    ) -> anyhow::Result<Vec<Written>> {
        let text = self.text(&self.kinds)?;
        let exists = !is_stream(path) && fs::symlink_metadata(path).is_ok();
        if exists && !args.force {
            bail!("{} is already there; --force replaces it", path.display());
        }
        put(path, &args.file, &text)?;
        let kind = self.kinds.first().copied().unwrap_or(PresetKind::Print);
        let name = path.display().to_string();
        Ok(vec![(kind, name, path.to_owned())])
    }

    /// Writes a file for each kind into the user's folder.
    pub(super) fn write_each(
        &self,
        args: &ImportArgs,
    ) -> anyhow::Result<Vec<Written>> {
        let Some(folder) = args.source.folder() else {
            bail!(
                "there is no folder for your profiles: name one with \
                 --profiles DIR, or a file with -o FILE"
            );
        };
        let given = match &args.new_name {
            Some(name) => {
                let fine = slug(name);
                if fine.is_empty() || fine != *name {
                    bail!(
                        "--as {name:?} is no name of a profile: use small \
                         letters, digits, dots and dashes, as in {:?}",
                        if fine.is_empty() { "my-printer" } else { &fine }
                    );
                }
                Some(fine)
            }
            None => None,
        };
        let mut files = Vec::new();
        for kind in &self.kinds {
            let own = self.picked.names.iter().find(|n| n.kind == *kind);
            let own = own.map_or(self.name.clone(), |n| slug(&n.name));
            let name = match given.clone().unwrap_or(own) {
                none if none.is_empty() => "imported".to_owned(),
                name => name,
            };
            let folder = folder.join(ours(*kind).folder());
            let path = folder.join(format!("{name}.toml"));
            if fs::symlink_metadata(&path).is_ok() && !args.force {
                bail!(
                    "there is a profile {} already; choose another name with \
                     --as NAME, or replace it with --force",
                    path.display()
                );
            }
            files.push((*kind, name, folder, path));
        }
        // All files are written under other names before the first one is put
        // in its place.
        let mut outputs = Vec::new();
        for (kind, name, folder, path) in files {
            fs::create_dir_all(&folder).with_context(|| {
                format!("cannot make the folder {}", folder.display())
            })?;
            let text = self.text(&[kind])?;
            let output = begun(&path, &args.file, &text)?;
            outputs.push((output, (kind, name, path)));
        }
        let mut written: Vec<Written> = Vec::new();
        let mut fresh: Vec<PathBuf> = Vec::new();
        for (output, (kind, name, path)) in outputs {
            let is_fresh = fs::symlink_metadata(&path).is_err();
            if let Err(error) = output.finish() {
                for path in fresh {
                    // The first error is reported, so later ones are dropped.
                    let _ = fs::remove_file(path);
                }
                return Err(error.into());
            }
            if is_fresh {
                fresh.push(path.clone());
            }
            written.push((kind, name, path));
        }
        Ok(written)
    }
}

/// Writes a file, whole or not at all.
fn put(path: &Path, input: &Path, text: &str) -> anyhow::Result<()> {
    Ok(begun(path, input, text)?.finish()?)
}

/// A file with its text, which has not been put in its place yet.
fn begun(path: &Path, input: &Path, text: &str) -> anyhow::Result<Output> {
    let mut output = output::create(path, &[input])?;
    output.put(text.as_bytes())?;
    Ok(output)
}

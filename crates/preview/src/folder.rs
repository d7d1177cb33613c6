//! A folder with a picture of each layer.
//!
//! Guaranteed: once [`Pictures::new`] is done, no picture of an earlier run is
//! left that could be taken for one of this run. Each picture is there
//! completely or not at all. Other files are not touched. A run of a range of
//! layers leaves the pictures of the part's other layers, so that several runs
//! may fill one folder.

use super::layer_svg;
use isoslice_base::files::beginning_in;
use isoslice_path::travel::LayerPath;
use isoslice_planar::Rect;
use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The pictures of a run.
#[derive(Clone, Debug)]
pub struct Pictures {
    folder: PathBuf,
    frame: Rect,
}

impl Pictures {
    /// Makes the folder if it is missing, and removes pictures of earlier runs:
    /// those of `layers` (indices), which this run will draw, and those above
    /// the part's `count` layers. `frame` is the part's box on the bed.
    ///
    /// # Errors
    /// If the folder cannot be made or read, or a picture cannot be removed.
    pub fn new(
        folder: &Path,
        frame: Rect,
        layers: &Range<usize>,
        count: usize,
    ) -> io::Result<Pictures> {
        fs::create_dir_all(folder)?;
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let Some(layer) = layer_of(&entry.file_name().to_string_lossy())
            else {
                continue;
            };
            let stale = layers.contains(&layer) || layer >= count;
            if stale && !entry.file_type()?.is_dir() {
                fs::remove_file(entry.path())?;
            }
        }
        Ok(Pictures {
            folder: folder.to_owned(),
            frame,
        })
    }

    /// The folder's path.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Draws a layer.
    ///
    /// # Errors
    /// If the picture cannot be written.
    pub fn draw(&self, path: &LayerPath) -> io::Result<()> {
        // The picture is drawn first, so that the half-written file is there
        // for a moment only.
        let picture = layer_svg(path, self.frame);
        let mut file = beginning_in(&self.folder)?;
        file.write_all(picture.as_bytes())?;
        file.persist(self.folder.join(name_of(path.span.index)))?;
        Ok(())
    }
}

/// The picture's name, in which layers count from 1.
fn name_of(layer: usize) -> String {
    format!("layer-{:05}.svg", layer + 1)
}

/// Index of the layer whose picture has this name.
fn layer_of(name: &str) -> Option<usize> {
    let digits = name.strip_prefix("layer-")?.strip_suffix(".svg")?;
    // Pictures of older versions were counted from 0.
    let layer = digits.parse::<usize>().ok()?.saturating_sub(1);
    let ours = digits.len() == 5 && digits.bytes().all(|b| b.is_ascii_digit());
    ours.then_some(layer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pictures_of_our_own_are_known() {
        assert_eq!(layer_of("layer-00001.svg"), Some(0));
        assert_eq!(layer_of(&name_of(49_999)), Some(49_999));
        for other in [
            "layer-1.svg",
            "layer-000001.svg",
            "layer-00001.svg.bak",
            "my-layer-00001.svg",
            "layer-+0001.svg",
            "layer-.svg",
            "LAYER-00001.SVG",
        ] {
            assert_eq!(layer_of(other), None, "{other}");
        }
    }
}

//! The gallery: each model is on the page, and is sliced as its head says. So are
//! the examples with textures.

use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn models() -> Vec<PathBuf> {
    let folder = fs::read_dir(root().join("examples/gallery")).unwrap();
    let mut all: Vec<PathBuf> = folder.map(|f| f.unwrap().path()).collect();
    all.sort();
    all
}

#[test]
fn every_model_is_on_the_page_with_its_picture() {
    let page = fs::read_to_string(root().join("docs/gallery.md")).unwrap();
    let models = models();
    assert!(models.len() >= 20);
    for model in &models {
        let name = model.file_stem().unwrap().to_str().unwrap();
        let text = fs::read_to_string(model).unwrap();
        let caption = text.lines().next().unwrap();
        let caption = caption.strip_prefix("// ").unwrap();
        let caption = caption.strip_suffix('.').unwrap().replace('|', "\\|");
        let picture = format!("assets/gallery/{name}.png");
        let row = format!(
            "| ![{name}](../{picture}) | \
             [{name}](../examples/gallery/{name}.rhai) | {caption} |"
        );
        assert!(page.contains(&row), "run assets/make.sh for {row}");
        let size = fs::metadata(root().join(&picture)).unwrap().len();
        assert!((1_000..50_000).contains(&size), "{picture}: {size}");
    }
    assert_eq!(page.matches("| ![").count(), models.len());
}

#[test]
fn every_model_is_sliced_as_its_head_says_without_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let textured = ["knurled-knob", "data/labelled-mug"]
        .map(|name| root().join(format!("examples/{name}.rhai")));
    for model in models().into_iter().chain(textured) {
        let text = fs::read_to_string(&model).unwrap();
        let said = text.lines().find_map(|l| l.strip_prefix("//   isoslice "));
        let words = said.unwrap().split_whitespace();
        let done = Command::new(env!("CARGO_BIN_EXE_isoslice"))
            .current_dir(root())
            .args(words)
            .args(["--quiet", "-o"])
            .arg(folder.path().join("part.gcode"))
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{}: {told}", model.display());
        assert!(told.is_empty(), "{}: {told}", model.display());
    }
}

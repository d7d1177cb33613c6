//! Reading a model: which format it has, and what it describes.
//!
//! In: a file, or text with its format. Out: `Loaded`, an expression tree that
//! is known to be expandable within bounds and to depend on x, y, z only.

use super::data::{Files, is_mesh};
use super::error::LoadError;
use super::formula::parse_formula;
use super::param::{Parameter, none_wanted};
use super::script::{ScriptLimits, run_script};
use super::vm::parse_vm;
use fidget::context::Tree;
use glam::{DVec2, DVec3};
use isocontour::{Data, data_of, expand};
use isoslice_base::encoding;
use isoslice_base::files::{self, FileError};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest file that is read. A .vm file of 10⁶ lines has about 20 MB.
const MAX_BYTES: u64 = 64 << 20;

/// Largest script or formula. A parsed script of 4 MB takes several hundred.
const MAX_SCRIPT_BYTES: u64 = 2 << 20;

/// The ways to write a model down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceKind {
    /// A rhai script with fidget's shapes (`.rhai`).
    Script,
    /// fidget's list of operations (`.vm`).
    Vm,
    /// One formula of x, y, z.
    Formula,
}

/// Where a model comes from.
#[derive(Clone, Debug)]
pub enum Source {
    /// A file; its extension says the format.
    File(PathBuf),
    /// Text at hand.
    Text {
        /// Name for messages and for the model.
        name: String,
        /// The text's format.
        kind: SourceKind,
        /// The text.
        text: String,
    },
    /// An expression at hand.
    Field {
        /// Name for messages and for the model.
        name: String,
        /// The field in the model's own frame, negative inside.
        tree: Tree,
        /// Parameters of the script that the field is from.
        parameters: Vec<Parameter>,
    },
}

impl Source {
    /// A formula at hand. `name` is for messages and for the model.
    pub fn formula(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source::Text {
            name: name.into(),
            kind: SourceKind::Formula,
            text: text.into(),
        }
    }

    /// A script at hand. `name` is for messages and for the model.
    pub fn script(name: impl Into<String>, text: impl Into<String>) -> Source {
        Source::Text {
            name: name.into(),
            kind: SourceKind::Script,
            text: text.into(),
        }
    }

    /// Name of the model: the file's, without folder and extension.
    pub fn name(&self) -> String {
        match self {
            Source::File(path) => {
                let stem = path.file_stem().unwrap_or_default();
                stem.to_string_lossy().into_owned()
            }
            Source::Text { name, .. } | Source::Field { name, .. } => {
                name.clone()
            }
        }
    }
}

/// How messages name the model.
impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Source::File(path) => path.display().fmt(f),
            Source::Text { name, .. } | Source::Field { name, .. } => {
                f.write_str(name)
            }
        }
    }
}

/// Expressions are equal if they are one object. To compare what they say could
/// take a time that doubles with each level.
impl PartialEq for Source {
    fn eq(&self, other: &Source) -> bool {
        match (self, other) {
            (Source::File(a), Source::File(b)) => a == b,
            (
                Source::Text { name, kind, text },
                Source::Text {
                    name: name_b,
                    kind: kind_b,
                    text: text_b,
                },
            ) => (name, kind, text) == (name_b, kind_b, text_b),
            (
                Source::Field {
                    name,
                    tree,
                    parameters,
                },
                Source::Field {
                    name: name_b,
                    tree: tree_b,
                    parameters: parameters_b,
                },
            ) => {
                tree.ptr_eq(tree_b)
                    && (name, parameters) == (name_b, parameters_b)
            }
            (
                Source::File(_) | Source::Text { .. } | Source::Field { .. },
                _,
            ) => false,
        }
    }
}

/// A model as it was written, before it is placed on a printer.
#[derive(Clone)]
pub struct Loaded {
    /// Name: the file's, without folder and extension.
    pub name: String,
    /// The field in the model's own frame, negative inside.
    pub tree: Tree,
    /// Parameters the script declares.
    pub parameters: Vec<Parameter>,
    /// The data that the field reads. It lives as long as somebody keeps it.
    pub data: Vec<Arc<dyn Data>>,
    /// The files that the data was read from, except for the model's own.
    pub files: Vec<PathBuf>,
    /// What users should know of the data, in sentences.
    pub notes: Vec<String>,
    /// How far a mesh that is the model was moved to lie near the origin, mm.
    pub moved: DVec3,
    /// Number of distinct operations, constants and variables.
    pub expression_size: usize,
}

impl Loaded {
    /// The expression in coordinates that begin at `origin`, mm.
    pub fn seen_from(mut self, origin: DVec2) -> Self {
        if origin != DVec2::ZERO {
            let (x, y, z) = Tree::axes();
            let at = origin.as_vec2();
            self.tree = self.tree.remap_xyz(x + at.x, y + at.y, z);
        }
        self
    }
}

/// Loads a model. `defines` are the `-D name=value` of the command line.
pub fn load(
    source: &Source,
    defines: &[(String, String)],
) -> Result<Loaded, LoadError> {
    load_within(source, defines, &ScriptLimits::default())
}

/// Loads a model with other limits on scripts than the default ones.
pub fn load_within(
    source: &Source,
    defines: &[(String, String)],
    limits: &ScriptLimits,
) -> Result<Loaded, LoadError> {
    let (file, name) = (source.to_string(), source.name());
    let no_parameters = || {
        none_wanted(defines).map_err(|error| LoadError::Param {
            file: file.clone(),
            error: Box::new(error),
        })
    };
    let folder = match source {
        Source::File(path) => path.parent(),
        _ => None,
    };
    let files = Arc::new(Files::within(folder.unwrap_or(Path::new(""))));
    let (kind, bytes) = match source {
        Source::File(path) if is_mesh(path) => {
            no_parameters()?;
            let tree = files.mesh(path).map_err(LoadError::Mesh)?;
            return counted(file, name, tree, Vec::new(), &files);
        }
        Source::File(path) => {
            let kind = kind_of(path)?;
            (kind, read(path, most_bytes(kind))?)
        }
        Source::Text { name, kind, text } => {
            let bytes = text.clone().into_bytes();
            within(&bytes, most_bytes(*kind), name)?;
            (*kind, bytes)
        }
        Source::Field {
            tree, parameters, ..
        } => {
            no_parameters()?;
            return counted(
                file,
                name,
                tree.clone(),
                parameters.clone(),
                &files,
            );
        }
    };
    let (tree, parameters) =
        match kind {
            SourceKind::Vm => {
                no_parameters()?;
                let tree = parse_vm(text(&bytes, &file)?.as_bytes()).map_err(
                    |error| LoadError::Vm {
                        file: file.clone(),
                        error,
                    },
                )?;
                (tree, Vec::new())
            }
            SourceKind::Formula => {
                no_parameters()?;
                let tree = parse_formula(text(&bytes, &file)?, &files)
                    .map_err(|error| LoadError::Formula {
                        file: file.clone(),
                        data: files.read(),
                        error,
                    })?;
                (tree, Vec::new())
            }
            SourceKind::Script => {
                let script =
                    run_script(text(&bytes, &file)?, defines, limits, &files)
                        .map_err(|error| LoadError::Script {
                        file: file.clone(),
                        data: files.read(),
                        error: Box::new(error),
                    })?;
                (script.tree, script.parameters)
            }
        };
    counted(file, name, tree, parameters, &files)
}

/// A model whose operations are counted.
fn counted(
    file: String,
    name: String,
    tree: Tree,
    parameters: Vec<Parameter>,
    files: &Files,
) -> Result<Loaded, LoadError> {
    let (context, _) =
        expand(&tree).map_err(|error| LoadError::Expression {
            file,
            data: files.read(),
            error,
        })?;
    Ok(Loaded {
        name,
        data: data_of(&tree),
        files: files.read(),
        notes: files.notes(),
        moved: files.moved(),
        tree,
        parameters,
        expression_size: context.len(),
    })
}

fn kind_of(path: &Path) -> Result<SourceKind, LoadError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("rhai") => Ok(SourceKind::Script),
        Some("vm") => Ok(SourceKind::Vm),
        other => Err(no_model(path, other)),
    }
}

/// The error for a path with another extension than a model's: what the file
/// is, and what to do with it.
fn no_model(path: &Path, extension: Option<&str>) -> LoadError {
    let file = path.display().to_string();
    let script = path.with_extension("rhai");
    let looks_computed = || file.contains(['(', '*', '^', '+']);
    let found = match extension {
        _ if path.is_dir() => "is a folder".to_owned(),
        _ if !path.exists() && looks_computed() => "is no file".to_owned(),
        Some("3mf") if is_sliced(path) => "is G-code".to_owned(),
        Some("amf" | "step" | "stp") => {
            "is in a format that isoslice does not read; export it as .stl, \
             .obj, .ply or .3mf"
                .to_owned()
        }
        Some("gcode" | "gco" | "g" | "bgcode") => "is G-code".to_owned(),
        Some("svg" | "dxf") => "is a drawing".to_owned(),
        Some("png" | "jpg" | "jpeg") => "is a picture".to_owned(),
        Some(extension) => format!("has the extension .{extension}"),
        None => "has no extension".to_owned(),
    };
    let advice = match &*found {
        "is a folder" => "name a file in it".to_owned(),
        "is no file" => format!("write -e '{file}', if it is one"),
        "is G-code" => {
            "isoslice check and isoslice preview read that".to_owned()
        }
        _ if script.is_file() => format!("did you mean {}?", script.display()),
        _ if extension.is_none() => "write its whole name".to_owned(),
        "is a drawing" => {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let kind = extension.unwrap_or_default();
            format!("write -e '{kind}({name:?})' --height 2, in its folder")
        }
        "is a picture" => {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            format!(
                "write a script or a formula in its folder, where image({name:?}) \
                 is the picture's brightness"
            )
        }
        _ => "write the part as one, see isoslice new".to_owned(),
    };
    LoadError::NoModel {
        file,
        found,
        advice,
    }
}

/// True for the name of a sliced plate of Bambu Lab's, `part.gcode.3mf`.
fn is_sliced(path: &Path) -> bool {
    let stem = path.file_stem().map(Path::new);
    let inner = stem.and_then(Path::extension);
    inner.is_some_and(|e| e.eq_ignore_ascii_case("gcode"))
}

/// Largest file, or text, of a kind.
fn most_bytes(kind: SourceKind) -> u64 {
    match kind {
        SourceKind::Vm => MAX_BYTES,
        SourceKind::Script | SourceKind::Formula => MAX_SCRIPT_BYTES,
    }
}

fn read(path: &Path, most: u64) -> Result<Vec<u8>, LoadError> {
    let file = path.display().to_string();
    files::read(path, most).map_err(|error| match error {
        FileError::System(source) => LoadError::Read { file, source },
        FileError::TooLarge { most } => LoadError::TooLarge {
            file,
            limit_mb: most >> 20,
        },
        FileError::NotText(error) => LoadError::NotText { file, error },
    })
}

fn within(bytes: &[u8], most: u64, file: &str) -> Result<(), LoadError> {
    if bytes.len() as u64 > most {
        return Err(LoadError::TooLarge {
            file: file.to_owned(),
            limit_mb: most >> 20,
        });
    }
    Ok(())
}

fn text<'a>(bytes: &'a [u8], file: &str) -> Result<&'a str, LoadError> {
    encoding::text(bytes).map_err(|error| LoadError::NotText {
        file: file.to_owned(),
        error,
    })
}

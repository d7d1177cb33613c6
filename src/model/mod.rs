//! Stand-in so that the command line can be built: to be replaced by the real
//! module, whose interface this has.
#![allow(missing_docs)]
use fidget::context::Tree;
use glam::DVec3;
use std::path::PathBuf;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub min: DVec3,
    pub max: DVec3,
}
impl Bounds {
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }
}
#[derive(Clone, Debug)]
pub struct Model {
    pub name: String,
    pub tree: Tree,
    pub bounds: Bounds,
    pub offset: DVec3,
    pub parameters: Vec<Parameter>,
    pub warnings: Vec<String>,
    pub expression_size: usize,
}
impl Model {
    pub fn printed_bounds(&self) -> Bounds {
        Bounds {
            min: self.bounds.min + self.offset,
            max: self.bounds.max + self.offset,
        }
    }
}
pub enum SourceKind {
    Script,
    Vm,
    Formula,
}
pub enum Source {
    File(PathBuf),
    Text {
        name: String,
        kind: SourceKind,
        text: String,
    },
}
#[derive(Clone, Debug)]
pub struct Parameter {
    pub name: String,
    pub default: String,
    pub value: String,
    pub description: String,
}
pub struct Loaded {
    pub name: String,
    pub tree: Tree,
    pub parameters: Vec<Parameter>,
    pub expression_size: usize,
}
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    #[error("cannot read {}", .0.display())]
    Unreadable(PathBuf, #[source] std::io::Error),
    #[error("there is no parameter {0}; the model has none")]
    UnknownParameter(String),
}
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {}
#[derive(Clone, Debug, Default)]
pub struct Placement {
    pub scale: Option<f64>,
    pub size: Option<f64>,
    pub rotate: [f64; 3],
    pub at: Option<(f64, f64)>,
    pub keep_position: bool,
    pub bounds: Option<Bounds>,
}
#[derive(Clone, Copy, Debug)]
pub struct BuildVolume {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}
pub fn load(
    source: &Source,
    defines: &[(String, String)],
) -> Result<Loaded, LoadError> {
    let name = match source {
        Source::File(path) => {
            std::fs::read_to_string(path)
                .map_err(|e| LoadError::Unreadable(path.clone(), e))?;
            path.display().to_string()
        }
        Source::Text { name, .. } => name.clone(),
    };
    if let Some((name, _)) = defines.first() {
        return Err(LoadError::UnknownParameter(name.clone()));
    }
    let (x, y, z) = Tree::axes();
    Ok(Loaded {
        name,
        tree: (x.square() + y.square() + z.square()).sqrt() - 10.0,
        parameters: Vec::new(),
        expression_size: 8,
    })
}
pub fn place(
    loaded: &Loaded,
    _: &Placement,
    volume: BuildVolume,
) -> Result<Model, PlaceError> {
    let centre = DVec3::new(volume.x / 2.0, volume.y / 2.0, 10.0);
    Ok(Model {
        name: loaded.name.clone(),
        tree: loaded.tree.clone(),
        bounds: Bounds {
            min: DVec3::splat(-10.0),
            max: DVec3::splat(10.0),
        },
        offset: centre,
        parameters: loaded.parameters.clone(),
        warnings: Vec::new(),
        expression_size: loaded.expression_size,
    })
}

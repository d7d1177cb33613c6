//! The functions that make data: of files, and of a text.

use super::folder::Folder;
use super::options::{Given, Options, Reader};
use super::pictures::picture;
use fidget::context::Tree;
use glam::{DAffine3, DVec3};
use isocontour::{Bounds, Data, call};
use isoslice_base::pairs;
use isoslice_base::problem::NamedProblem;
use isoslice_drawings::{
    Align, Anchor, Drawing, DxfOptions, MOST_DRAWING_BYTES, SvgOptions,
    TextOptions, Vertical, White,
};
use isoslice_mesh::{Format, Mesh};
use isoslice_pictures::{
    Axes, Between, Border, Interpolation, PictureOptions, Samples,
    SamplesOptions, TransparentAs, Volume, VolumeOptions,
};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

/// Greatest length of a file that is held as a whole, bytes.
const MOST_BYTES: u64 = 1 << 30;
/// Greatest length of a font, bytes. Those of all Chinese letters have 20 MB.
const MOST_FONT_BYTES: u64 = 64 << 20;

/// What was made, and what its user should know.
pub(super) struct Made {
    pub tree: Tree,
    /// The data in the expression, which does not keep it.
    pub data: Vec<Arc<dyn Data>>,
    pub notes: Vec<String>,
    /// How far it was moved to lie near the origin, mm.
    pub moved: DVec3,
}

impl Made {
    fn plain(data: impl Data + 'static) -> Made {
        Made::leaf(Arc::new(data), Vec::new())
    }

    /// Data at x, y and z.
    fn leaf(data: Arc<dyn Data>, notes: Vec<String>) -> Made {
        let (x, y, z) = Tree::axes();
        let z = if data.is_flat() {
            Tree::constant(0.0)
        } else {
            z
        };
        Made {
            tree: call(&data, [x, y, z]),
            data: vec![data],
            notes,
            moved: DVec3::ZERO,
        }
    }
}

/// A function that makes data.
pub(crate) struct Kind {
    /// Its name.
    pub name: &'static str,
    /// A call, for messages.
    pub example: &'static str,
    /// True if its first value is the name of a file.
    pub of_file: bool,
    /// True if what it makes is a body, and not just any field.
    pub is_body: bool,
    make: Make,
}

type Make = fn(&Asked<'_>) -> Result<Made, String>;

/// What is asked of a function.
pub(super) struct Asked<'a> {
    /// The first value: the name of a file, or a text.
    pub text: &'a str,
    /// The file to read, if there is one.
    pub path: Option<&'a Path>,
    pub options: &'a Options,
    /// True if the file is the model itself, and may be moved to the origin.
    pub is_model: bool,
}

impl Asked<'_> {
    fn file(&self) -> Result<&Path, String> {
        self.path.ok_or_else(|| "it needs a file".to_owned())
    }

    fn bytes(&self, most: u64) -> Result<Vec<u8>, String> {
        Folder::bytes(self.file()?, most)
    }
}

/// All functions that make data.
pub(crate) const KINDS: &[Kind] = &[
    Kind::body("mesh", "mesh(\"part.stl\")", mesh),
    Kind::body("svg", "svg(\"logo.svg\")", svg),
    Kind::body("dxf", "dxf(\"plate.dxf\")", dxf),
    Kind {
        of_file: false,
        ..Kind::body("text", "text(\"Ø 12\")", text)
    },
    Kind::field("image", "image(\"photo.png\")", image),
    Kind::field("volume", "volume(\"scan.nrrd\")", volume),
    Kind::field("samples", "samples(\"stress.csv\")", samples),
];

/// The function of a name.
pub(crate) fn kind(name: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.name == name)
}

impl Kind {
    /// A field of a file.
    const fn field(
        name: &'static str,
        example: &'static str,
        make: Make,
    ) -> Kind {
        Kind {
            name,
            example,
            of_file: true,
            is_body: false,
            make,
        }
    }

    /// A body of a file.
    const fn body(
        name: &'static str,
        example: &'static str,
        make: Make,
    ) -> Kind {
        Kind {
            is_body: true,
            ..Kind::field(name, example, make)
        }
    }

    /// The name of the file that a call reads: a text may have a font.
    pub(super) fn file_of<'a>(
        &self,
        text: &'a str,
        options: &'a Options,
    ) -> Option<&'a str> {
        match options.get("font") {
            _ if self.of_file => Some(text),
            Some(Given::Text(font)) => Some(font),
            _ => None,
        }
    }

    /// Makes data. Messages name the file, or the text.
    pub(super) fn make(&self, asked: &Asked<'_>) -> Result<Made, String> {
        let made = (self.make)(asked);
        match asked.path {
            Some(path) if self.of_file => {
                made.map_err(|e| format!("{}: {e}", path.display()))
            }
            _ => made,
        }
    }
}

const INTERPOLATION: &[(&str, Interpolation)] = &[
    ("nearest", Interpolation::Nearest),
    ("linear", Interpolation::Linear),
    ("cubic", Interpolation::Cubic),
];
const BORDER: &[(&str, Border)] = &[
    ("clamp", Border::Clamp),
    ("repeat", Border::Repeat),
    ("mirror", Border::Mirror),
];

/// The ends of names of 3MF files, which may hold more than meshes.
const OF_3MF: &str = "3mf";

/// True for the name of a mesh's file. A plate of G-code, `part.gcode.3mf`, is
/// none.
pub fn is_mesh(path: &Path) -> bool {
    let inner = path.file_stem().map(Path::new).map(extension);
    let of = extension(path);
    (of == OF_3MF || Format::of_extension(&of).is_some())
        && inner.as_deref() != Some("gcode")
}

fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_ascii_lowercase()
}

fn mesh(asked: &Asked<'_>) -> Result<Made, String> {
    Reader::new("mesh", asked.options).finish()?;
    let path = asked.file()?;
    let name = format!("mesh({:?})", asked.text);
    let open = || {
        let file = File::open(path).map_err(|e| e.to_string())?;
        Ok::<_, String>(BufReader::new(file))
    };
    let noted = |what: String| format!("{}: {what}", asked.text);
    if extension(path) == OF_3MF {
        let body = isoslice_threemf::read(&name, open()?);
        let body = body.map_err(|e| e.to_string())?;
        let extents = body.data.iter();
        let extents = extents.filter_map(|d| d.extent(&DAffine3::IDENTITY));
        if let Some(away) = extents.filter_map(|e| too_far(&e)).next() {
            return Err(too_far_away(away, "save it near the origin"));
        }
        return Ok(Made {
            tree: body.tree,
            data: body.data,
            notes: body.notes.into_iter().map(noted).collect(),
            moved: DVec3::ZERO,
        });
    }
    let format = Format::of_extension(&extension(path));
    let format = format.ok_or(
        "its name is not known as a mesh's; meshes are .stl, .obj, .ply and \
         .3mf files",
    )?;
    let mut triangles =
        isoslice_mesh::read(open()?, format).map_err(|e| e.to_string())?;
    let mut moved = DVec3::ZERO;
    let mut notes = Vec::new();
    let bounds = triangles.bounds();
    if let Some(away) = too_far(&bounds) {
        if !asked.is_model {
            let advice = "move it near the origin in the program that made it, \
                          or slice the file itself, which is moved there";
            return Err(too_far_away(away, advice));
        }
        moved = -bounds.centre().round();
        triangles.transform(&DAffine3::from_translation(moved));
        notes.push(noted(format!(
            "moved to the origin, since its coordinates of {:.0} m are too far \
             from it to be exact",
            away / 1000.0
        )));
    }
    let mesh = Mesh::new(&name, triangles).map_err(|e| e.to_string())?;
    notes.extend(mesh.facts().repairs().into_iter().map(noted));
    Ok(Made {
        moved,
        ..Made::leaf(Arc::new(mesh), notes)
    })
}

/// How far from the origin a body lies, mm, if places there are not exact enough:
/// they have 24 bits.
fn too_far(bounds: &Bounds) -> Option<f64> {
    /// Here places are 2 µm apart, and farther away more.
    const FAR: f64 = 20_000.0;
    /// Bodies that are large enough for their distance are scaled down.
    const SIZES: f64 = 100.0;
    let away = bounds.centre().abs().max_element();
    let size = bounds.size().max_element();
    (away > FAR.max(SIZES * size)).then_some(away)
}

fn too_far_away(away: f64, advice: &str) -> String {
    format!(
        "its coordinates are {:.0} m from the origin, too far for a body of its \
         size to be exact; {advice}",
        away / 1000.0
    )
}

const ANCHOR: &[(&str, Anchor)] = pairs! {
    "page" => Anchor::Page;
    "corner" => Anchor::Corner;
    "centre", "center" => Anchor::Centre;
};

/// A DXF has an origin, and no page.
const ANCHOR_OF_DXF: &[(&str, Anchor)] = pairs! {
    "origin" => Anchor::Page;
    "corner" => Anchor::Corner;
    "centre", "center" => Anchor::Centre;
};

fn svg(asked: &Asked<'_>) -> Result<Made, String> {
    let mut given = Reader::new("svg", asked.options);
    let white = [("cuts", White::Cuts), ("area", White::Area)];
    let options = SvgOptions {
        width_mm: given.number("width")?,
        height_mm: given.number("height")?,
        anchor: given.word("anchor", ANCHOR)?.unwrap_or_default(),
        white: given.word("white", &white)?.unwrap_or_default(),
    };
    given.finish()?;
    let bytes = asked.bytes(MOST_DRAWING_BYTES as u64)?;
    let made = Drawing::from_svg(asked.text, &bytes, &options);
    Ok(drawn(made.map_err(|e| e.problem().to_owned())?))
}

fn dxf(asked: &Asked<'_>) -> Result<Made, String> {
    let mut given = Reader::new("dxf", asked.options);
    let options = DxfOptions {
        width_mm: given.number("width")?,
        height_mm: given.number("height")?,
        anchor: given.word("anchor", ANCHOR_OF_DXF)?.unwrap_or_default(),
        unit_mm: given.number("unit")?,
        layers: given.texts("layers")?,
        gap_mm: given.number("gap")?,
    };
    given.finish()?;
    let bytes = asked.bytes(MOST_DRAWING_BYTES as u64)?;
    let made = Drawing::from_dxf(asked.text, &bytes, &options);
    Ok(drawn(made.map_err(|e| e.problem().to_owned())?))
}

fn text(asked: &Asked<'_>) -> Result<Made, String> {
    let mut given = Reader::new("text", asked.options);
    let aligns = pairs! {
        "left" => Align::Left;
        "centre", "center" => Align::Centre;
        "right" => Align::Right;
    };
    let verticals = pairs! {
        "base" => Vertical::Base;
        "centre", "center" => Vertical::Centre;
        "top" => Vertical::Top;
        "bottom" => Vertical::Bottom;
    };
    let usual = TextOptions::default();
    let options = TextOptions {
        size_mm: given.number("size")?.unwrap_or(usual.size_mm),
        align: given.word("align", aligns)?.unwrap_or_default(),
        vertical: given.word("vertical", verticals)?.unwrap_or_default(),
        line_mm: given.number("line")?,
        spacing_mm: given.number("spacing")?.unwrap_or_default(),
    };
    given.text("font")?;
    given.finish()?;
    if asked.text.trim().is_empty() {
        return Err("text: it has no letter that can be seen".to_owned());
    }
    let read = |path: &Path| {
        let bytes = Folder::bytes(path, MOST_FONT_BYTES);
        bytes.map_err(|e| format!("text: {}: {e}", path.display()))
    };
    let font = asked.path.map(read).transpose()?;
    let made = Drawing::from_text(asked.text, font.as_deref(), &options);
    let of_font = |e: NamedProblem| match asked.path {
        Some(path) => format!("{e} (font: {})", path.display()),
        None => e.to_string(),
    };
    Ok(drawn(made.map_err(of_font)?))
}

/// A drawing, with its warnings.
fn drawn(drawing: Drawing) -> Made {
    let name = drawing.name();
    let notes = drawing.warnings().iter().map(|w| format!("{name}: {w}"));
    let notes = notes.collect();
    Made::leaf(Arc::new(drawing), notes)
}

fn image(asked: &Asked<'_>) -> Result<Made, String> {
    let mut given = Reader::new("image", asked.options);
    let paper = given.number("paper")?.map(TransparentAs::Paper);
    let seen = [("colour", false), ("color", false), ("transparency", true)];
    let mask = given.word("of", &seen)?.unwrap_or(false);
    if mask && paper.is_some() {
        return Err(
            "image: paper is what shows through the colours, which of: \
                    \"transparency\" does not read; leave one of them out"
                .to_owned(),
        );
    }
    let usual = PictureOptions::default();
    let options = PictureOptions {
        width_mm: given.number("width")?,
        height_mm: given.number("height")?,
        interpolation: given
            .word("interpolation", INTERPOLATION)?
            .unwrap_or_default(),
        border: given.words("border", BORDER)?.unwrap_or_default(),
        transparent: match paper {
            _ if mask => TransparentAs::Mask,
            paper => paper.unwrap_or(usual.transparent),
        },
        missing: given.number("missing")?,
    };
    given.finish()?;
    let bytes = || asked.bytes(MOST_BYTES);
    let made = picture(asked.file()?, asked.text, &options, bytes)?;
    Ok(Made::leaf(made, Vec::new()))
}

fn volume(asked: &Asked<'_>) -> Result<Made, String> {
    let mut given = Reader::new("volume", asked.options);
    let axes = [("xyz", Axes::Xyz), ("zyx", Axes::Zyx)];
    let options = VolumeOptions {
        spacing_mm: given.numbers("spacing")?.map(DVec3::from_array),
        origin_mm: given.numbers("origin")?.map(DVec3::from_array),
        axes: given.word("axes", &axes)?.unwrap_or_default(),
        interpolation: given
            .word("interpolation", INTERPOLATION)?
            .unwrap_or_default(),
        border: given.words("border", BORDER)?.unwrap_or_default(),
        missing: given.number("missing")?,
    };
    given.finish()?;
    let bytes = asked.bytes(MOST_BYTES)?;
    let made = Volume::read(asked.text, &bytes, &options);
    Ok(Made::plain(made.map_err(|e| e.problem().to_owned())?))
}

fn samples(asked: &Asked<'_>) -> Result<Made, String> {
    let mut given = Reader::new("samples", asked.options);
    let between = [("nearest", Between::Nearest), ("linear", Between::Linear)];
    let options = SamplesOptions {
        column: given.text("column")?,
        unit_mm: given.number("unit")?.unwrap_or(1.0),
        between: given.word("between", &between)?.unwrap_or_default(),
    };
    given.finish()?;
    let bytes = asked.bytes(MOST_BYTES)?;
    let made = Samples::read(asked.text, &bytes, &options);
    Ok(Made::plain(made.map_err(|e| e.problem().to_owned())?))
}

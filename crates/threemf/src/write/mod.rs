//! Writes a function as a 3MF file.
//!
//! In: an expression of x, y and z in millimetres, negative inside, and the box
//! around the part. Out: an archive, of which [`read`](crate::read) makes the same
//! function.
//!
//! ```text
//!  <resources>
//!    <object id="1">  <mesh> a box around the part
//!    <object id="2">  <mesh> a mesh that the function asks for, …
//!    <image3d id="3">  the sheets of a picture that it asks for
//!    <functionfromimage3d id="4">  the picture as a function, …
//!    <implicitfunction id="5">  nodes
//!    <object id="6">  <levelset functionid="5" channel="shape" meshid="1"/>
//!  <build> <item objectid="6"/>
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | `nodes` | makes nodes of operations |
//! | `mesh` | writes triangles |
//! | `picture` | writes sheets of pictures and volumes |
//! | `error` | says what cannot be written |
//!
//! Guaranteed: equal functions give equal bytes; what is written has no more
//! nodes, meshes, pictures, vertices, triangles and files than are read.

mod error;
pub(crate) mod mesh;
mod nodes;
mod picture;

pub use error::ExportError;

use crate::functions::image::MOST_FILE;
use crate::model::MOST_SHAPES;
use crate::package::MOST_FILES;
use fidget::context::Tree;
use glam::DVec3;
use isocontour::{Bounds, expand};
use isoslice_mesh::Mesh;
use mesh::{cuboid, mesh_of, triangles};
use nodes::{Nodes, Resource};
use picture::sheets_of;
use quick_xml::escape::escape;
use std::io::{self, Cursor, Write};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// How far the box lies around the part, mm. It takes no part in the surface then,
/// and the function keeps its values near it.
const MARGIN: f64 = 1.0;

/// Length of the text of a vertex or a triangle, bytes: triangles take 53 at most,
/// vertices some 80.
const LINE: u64 = 100;

const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n\
    <Default Extension=\"rels\" \
    ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n\
    <Default Extension=\"model\" \
    ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n\
    </Types>\n";

/// The kind of the sheets, for the end of the types.
const TYPE_OF_SHEETS: &str =
    "<Default Extension=\"png\" ContentType=\"image/png\"/>\n</Types>";

/// What the model and its sheets are called among relationships.
const MODEL: &str =
    "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
const SHEET: &str =
    "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture";

/// The files of an archive that are no sheets.
const OTHER_FILES: usize = 4;
/// Greatest number of samples of all pictures and volumes. Each takes two bytes
/// when it is read again, and all data has 4 GB.
const MOST_SAMPLES: usize = 1 << 30;

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <model unit=\"millimeter\" xml:lang=\"en-US\" \
    xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
    xmlns:v=\"http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01\" \
    xmlns:i=\"http://schemas.3mf.io/3dmanufacturing/implicit/2023/12\" \
    requiredextensions=\"v i\">\n";

/// A function that is to be written.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// The name of the part.
    pub name: &'a str,
    /// The function, in millimetres, negative inside.
    pub tree: &'a Tree,
    /// The box around what is inside.
    pub bounds: Bounds,
    /// The place of the function's origin in the file's coordinates, mm.
    pub origin: DVec3,
}

/// Writes a function as a 3MF file: the bytes of an archive.
///
/// # Errors
/// If there is something in the function for which files have no node, or it is
/// larger than what is read again.
pub fn write(part: &Part) -> Result<Vec<u8>, ExportError> {
    let (context, root) = expand(part.tree)?;
    let nodes = Nodes::new(&context, root, 2)?;
    let shapes = shapes(&nodes);
    if shapes > MOST_SHAPES {
        return Err(ExportError::TooManyShapes);
    }
    let is_large = LINE * shapes as u64 > u64::from(u32::MAX / 2);
    let sheets = sheets(&nodes)?;
    let mut texts = vec![
        ("[Content_Types].xml", TYPES.to_owned()),
        (
            "_rels/.rels",
            relationships(MODEL, ["3D/3dmodel.model"].into_iter()),
        ),
    ];
    if !sheets.is_empty() {
        texts[0].1 = TYPES.replace("</Types>", TYPE_OF_SHEETS);
        let paths = sheets.iter().map(|sheet| sheet.0.as_str());
        let needed = relationships(SHEET, paths);
        texts.push(("3D/_rels/3dmodel.model.rels", needed));
    }
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in texts {
        zip.start_file(name, options()).map_err(io_error)?;
        zip.write_all(text.as_bytes())?;
    }
    let large = options().large_file(is_large);
    zip.start_file("3D/3dmodel.model", large)
        .map_err(io_error)?;
    let mut out = io::BufWriter::new(&mut zip);
    model(part, &nodes, &mut out)?;
    out.into_inner().map_err(|e| e.into_error())?;
    // PNG files are packed already.
    let packed = options().compression_method(CompressionMethod::Stored);
    for (path, resource, sheet) in sheets {
        isoslice_base::limits::go_on()?;
        if let Some(sheets) = sheets_of(&*resource.data) {
            let png = picture::png(&sheets, sheet)?;
            if png.len() as u64 > MOST_FILE {
                return Err(ExportError::TooManySheets);
            }
            zip.start_file(path, packed).map_err(io_error)?;
            zip.write_all(&png)?;
        }
    }
    Ok(zip.finish().map_err(io_error)?.into_inner())
}

/// Number of vertices and triangles of a file.
fn shapes(nodes: &Nodes) -> usize {
    let meshes = nodes.resources.iter().filter_map(|r| mesh_of(&*r.data));
    let of_mesh = |mesh: &Mesh| {
        let (vertices, corners) = mesh.triangles();
        vertices.len() + corners.len()
    };
    mesh::CUBOID + meshes.map(of_mesh).sum::<usize>()
}

/// The names of all sheets, each with its picture and its number in that.
fn sheets(
    nodes: &Nodes,
) -> Result<Vec<(String, &Resource, usize)>, ExportError> {
    let mut all = Vec::new();
    let mut samples = 0;
    for resource in &nodes.resources {
        let Some(sheets) = sheets_of(&*resource.data) else {
            continue;
        };
        let [columns, rows, count] = sheets.size();
        samples += columns * rows * count;
        if all.len() + count + OTHER_FILES > MOST_FILES
            || samples > MOST_SAMPLES
        {
            return Err(ExportError::TooManySheets);
        }
        let sheet = |k| (picture::path(resource.id, k), resource, k);
        all.extend((0..count).map(sheet));
    }
    Ok(all)
}

/// Relationships to files of a kind.
fn relationships<'a>(
    kind: &str,
    paths: impl Iterator<Item = &'a str>,
) -> String {
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
        <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
        .to_owned();
    for (i, path) in paths.enumerate() {
        text += &format!(
            "<Relationship Target=\"/{path}\" Id=\"rel{i}\" Type=\"{kind}\"/>\n"
        );
    }
    text + "</Relationships>\n"
}

/// Writes the model file.
fn model(
    part: &Part,
    nodes: &Nodes,
    out: &mut dyn Write,
) -> Result<(), ExportError> {
    let name: String = part.name.chars().filter(|c| !c.is_control()).collect();
    let name = escape(&name);
    writeln!(
        out,
        "{HEAD}<metadata name=\"Title\">{name}</metadata>\n\
         <metadata name=\"Application\">isoslice {}</metadata>\n<resources>",
        env!("CARGO_PKG_VERSION")
    )?;
    object(1, out, |out| cuboid(&part.bounds.grown(MARGIN), out))?;
    for Resource { id, data } in &nodes.resources {
        if let Some(mesh) = mesh_of(&**data) {
            object(*id, out, |out| triangles(mesh, out))?;
        } else if let Some(sheets) = sheets_of(&**data) {
            picture::resources(*id, &sheets, out)?;
        }
    }
    let id = nodes.next_id;
    writeln!(
        out,
        "<i:implicitfunction id=\"{id}\" displayname=\"{name}\">\n\
         <i:in><i:vector identifier=\"pos\"/></i:in>\n{}\
         <i:out><i:scalarref identifier=\"shape\" ref=\"{}\"/></i:out>\n\
         </i:implicitfunction>\n\
         <object id=\"{}\" name=\"{name}\"><v:levelset functionid=\"{id}\" \
         channel=\"shape\" meshid=\"1\" meshbboxonly=\"true\"/></object>\n\
         </resources>",
        nodes.text,
        nodes.value,
        id + 1
    )?;
    let by = part.origin;
    let place = if by == DVec3::ZERO {
        String::new()
    } else {
        format!(
            " transform=\"1 0 0 0 1 0 0 0 1 {} {} {}\"",
            by.x, by.y, by.z
        )
    };
    writeln!(
        out,
        "<build><item objectid=\"{}\"{place}/></build>\n</model>",
        id + 1
    )?;
    Ok(())
}

fn object(
    id: usize,
    out: &mut dyn Write,
    mesh: impl FnOnce(&mut dyn Write) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    writeln!(out, "<object id=\"{id}\">")?;
    mesh(out)?;
    writeln!(out, "</object>")?;
    Ok(())
}

/// Entries have no dates, so that equal input gives equal bytes.
fn options() -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default())
}

fn io_error(error: ZipError) -> ExportError {
    ExportError::Archive(match error {
        ZipError::Io(error) => error,
        other => io::Error::other(other),
    })
}

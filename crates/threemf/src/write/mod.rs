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
//!    <implicitfunction id="3">  nodes
//!    <object id="4">  <levelset functionid="3" channel="shape" meshid="1"/>
//!  <build> <item objectid="4"/>
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | `nodes` | makes nodes of operations |
//! | `mesh` | writes triangles |
//! | `error` | says what cannot be written |
//!
//! Guaranteed: equal functions give equal bytes; what is written has no more
//! nodes, meshes, vertices and triangles than are read.

mod error;
pub(crate) mod mesh;
mod nodes;

pub use error::ExportError;

use crate::model::MOST_SHAPES;
use fidget::context::Tree;
use glam::DVec3;
use isocontour::{Bounds, expand};
use isoslice_mesh::Mesh;
use mesh::{cuboid, triangles};
use nodes::Nodes;
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

const RELATIONSHIPS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n\
    <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n\
    </Relationships>\n";

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
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in [
        ("[Content_Types].xml", TYPES),
        ("_rels/.rels", RELATIONSHIPS),
    ] {
        zip.start_file(name, options()).map_err(io_error)?;
        zip.write_all(text.as_bytes())?;
    }
    let options = options().large_file(is_large);
    zip.start_file("3D/3dmodel.model", options)
        .map_err(io_error)?;
    let mut out = io::BufWriter::new(&mut zip);
    model(part, &nodes, &mut out)?;
    out.into_inner().map_err(|e| e.into_error())?;
    Ok(zip.finish().map_err(io_error)?.into_inner())
}

/// Number of vertices and triangles of a file.
fn shapes(nodes: &Nodes) -> usize {
    let meshes = nodes.meshes.iter().filter_map(Nodes::mesh_of);
    let of_mesh = |mesh: &Mesh| {
        let (vertices, corners) = mesh.triangles();
        vertices.len() + corners.len()
    };
    mesh::CUBOID + meshes.map(of_mesh).sum::<usize>()
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
    object(1, out, |out| cuboid(&grown(&part.bounds), out))?;
    let meshes = nodes.meshes.iter().filter_map(Nodes::mesh_of);
    let mut id = 2;
    for mesh in meshes {
        object(id, out, |out| triangles(mesh, out))?;
        id += 1;
    }
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

fn grown(bounds: &Bounds) -> Bounds {
    Bounds {
        min: bounds.min - MARGIN,
        max: bounds.max + MARGIN,
    }
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

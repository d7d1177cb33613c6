//! Writes pictures and volumes: stacks of sheets, each a PNG file, and the function
//! of each stack.

use super::error::ExportError;
use crate::functions::image::MOST_PIXELS;
use glam::DAffine3;
use isocontour::Data;
use isoslice_pictures::{Border, Interpolation, Picture, Sheets, Volume};
use std::any::Any;
use std::io::{self, Write};

/// Where sheets are in the archive.
const FOLDER: &str = "3D/volumetric";

/// The sheets that data is, if it is any.
pub(super) fn sheets_of(data: &dyn Data) -> Option<Sheets<'_>> {
    let data: &dyn Any = data;
    let picture = data.downcast_ref().map(Picture::sheets);
    picture.or_else(|| data.downcast_ref().map(Volume::sheets))
}

/// Checks that a stack can hold what a picture or a volume is.
pub(super) fn check(name: &str, sheets: &Sheets) -> Result<(), ExportError> {
    let refused = |why| Err(ExportError::Picture(name.to_owned(), why));
    if sheets.interpolation() == Interpolation::Cubic {
        return refused(
            "is cubic between its samples, and those of 3MF files are linear \
             or nearest; read it with one of these",
        );
    }
    if sheets.depth().is_none() {
        return refused(
            "has numbers with fractions, and those of 3MF files are whole ones \
             of 8 or 16 bits; write it with these",
        );
    }
    if sheets.size().iter().product::<usize>() > MOST_PIXELS {
        return refused(
            "has more than 268 million samples, and no stack of a 3MF file with \
             more is read; scale it down",
        );
    }
    Ok(())
}

/// The name of a sheet's file.
pub(super) fn path(stack: usize, sheet: usize) -> String {
    format!("{FOLDER}/{stack}-{sheet}.png")
}

/// Writes the resources of a stack and, with the number after its own, of its
/// function.
pub(super) fn resources(
    id: usize,
    sheets: &Sheets,
    out: &mut dyn Write,
) -> io::Result<()> {
    let [columns, rows, count] = sheets.size();
    writeln!(
        out,
        "<v:image3d id=\"{id}\"><v:imagestack rowcount=\"{rows}\" \
         columncount=\"{columns}\" sheetcount=\"{count}\">"
    )?;
    for sheet in 0..count {
        writeln!(out, "<v:imagesheet path=\"/{}\"/>", path(id, sheet))?;
    }
    let filter = match sheets.interpolation() {
        Interpolation::Nearest => "nearest",
        _ => "linear",
    };
    let [u, v, w] = sheets.border().map(|border| match border {
        Border::Clamp => "clamp",
        Border::Repeat => "wrap",
        Border::Mirror => "mirror",
    });
    let [black, span] = sheets.black_and_span();
    writeln!(
        out,
        "</v:imagestack></v:image3d>\n<v:functionfromimage3d id=\"{}\" \
         image3did=\"{id}\" filter=\"{filter}\" tilestyleu=\"{u}\" \
         tilestylev=\"{v}\" tilestylew=\"{w}\" valueoffset=\"{black:?}\" \
         valuescale=\"{span:?}\"/>",
        id + 1
    )
}

/// A sheet as a PNG file.
pub(super) fn png(
    sheets: &Sheets,
    sheet: usize,
) -> Result<Vec<u8>, ExportError> {
    let [columns, rows, _] = sheets.size();
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(columns), side(rows));
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(match sheets.depth() {
        Some(1) => png::BitDepth::Eight,
        _ => png::BitDepth::Sixteen,
    });
    let mut writer = encoder.write_header().map_err(io::Error::from)?;
    let pixels = sheets.pixels(sheet);
    writer.write_image_data(&pixels).map_err(io::Error::from)?;
    writer.finish().map_err(io::Error::from)?;
    Ok(bytes)
}

/// The way from a place to the stack, as the rows of a matrix and what is added.
pub(super) fn rows(sheets: &Sheets) -> [[f32; 4]; 3] {
    let DAffine3 {
        matrix3: m,
        translation: t,
    } = sheets.to_stack();
    let row = |a: usize| {
        [m.x_axis[a], m.y_axis[a], m.z_axis[a], t[a]].map(|v| v as f32)
    };
    [row(0), row(1), row(2)]
}

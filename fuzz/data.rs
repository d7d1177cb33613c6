//! What is fuzzed of files of data: meshes, drawings, pictures, volumes, samples,
//! and 3MF files.

use glam::DVec3;
use isocontour::{Bounds, Data, Values};
use isoslice_drawings::{Drawing, DxfOptions, SvgOptions};
use isoslice_mesh::{Format, Mesh};
use isoslice_pictures::{
    Picture, PictureOptions, Samples, SamplesOptions, Volume, VolumeOptions,
};
use isoslice_threemf::{Body, Part};
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Places that are asked for: in the middle, beside it, and far out.
const PLACES: [DVec3; 4] = [
    DVec3::ZERO,
    DVec3::new(0.3, -0.7, 1.1),
    DVec3::new(-12.5, 30.0, 4.0),
    DVec3::new(2e4, -3e5, 1e3),
];

/// Values are numbers, and within the ranges of boxes around their places.
fn judge(data: &dyn Data) {
    for p in PLACES {
        let (value, gradient) = data.at(p);
        assert!(value.is_finite(), "{p}: {value}");
        assert!(gradient.is_finite(), "{p}: {gradient}");
        for size in [0.0, 0.1, 50.0] {
            let around = Bounds {
                min: p - size,
                max: p + size,
            };
            let [lo, hi] = data.range(&around);
            let slack = 1e-6 * (1.0 + value.abs());
            let is_in = lo - slack <= value && value <= hi + slack;
            assert!(is_in, "{p} ± {size}: {value} in {lo}..{hi}");
        }
    }
}

/// Meshes. The first byte says which format it is.
pub(super) fn mesh(bytes: &[u8]) {
    let Some((first, rest)) = bytes.split_first() else {
        return;
    };
    let format =
        [Format::Stl, Format::Obj, Format::Ply][usize::from(first % 3)];
    let Ok(triangles) = isoslice_mesh::read(Cursor::new(rest), format) else {
        return;
    };
    if let Ok(mesh) = Mesh::new("fuzz", triangles) {
        judge(&mesh);
    }
}

/// SVG and DXF drawings.
pub(super) fn drawing(bytes: &[u8]) {
    let options = SvgOptions::default();
    if let Ok(drawing) = Drawing::from_svg("fuzz", bytes, &options) {
        judge(&drawing);
    }
    let options = DxfOptions::default();
    if let Ok(drawing) = Drawing::from_dxf("fuzz", bytes, &options) {
        judge(&drawing);
    }
}

/// Pictures, volumes and samples. Most files begin in a way of their own.
pub(super) fn picture(bytes: &[u8]) {
    let options = PictureOptions::default();
    if let Ok(picture) = Picture::read("fuzz", bytes, &options) {
        judge(&picture);
    }
    let options = VolumeOptions::default();
    if let Ok(volume) = Volume::read("fuzz", bytes, &options) {
        judge(&volume);
    }
    let options = SamplesOptions::default();
    if let Ok(samples) = Samples::read("fuzz", bytes, &options) {
        judge(&samples);
    }
}

/// 3MF files, by the text of their models. What is written of them is read again.
pub(super) fn threemf(text: &[u8]) {
    let Some(body) = packed(text).and_then(read) else {
        return;
    };
    for data in &body.data {
        judge(&**data);
    }
    let Ok(values) = Values::new(&body.tree, None) else {
        return;
    };
    let at = |k: usize| PLACES.map(|p| p[k] as f32);
    let mut found = Vec::new();
    // Whether or not values are refused, the call has to return.
    let _ = values.at(&[&at(0), &at(1), &at(2)], &mut found);
    let part = Part {
        name: "fuzz",
        tree: &body.tree,
        bounds: Bounds {
            min: DVec3::splat(-50.0),
            max: DVec3::splat(50.0),
        },
        origin: DVec3::ZERO,
    };
    if let Ok(bytes) = isoslice_threemf::write(&part) {
        assert!(read(bytes).is_some(), "it is not read again");
    }
}

fn read(bytes: Vec<u8>) -> Option<Body> {
    isoslice_threemf::read("fuzz", Cursor::new(bytes)).ok()
}

/// An archive of a model.
fn packed(text: &[u8]) -> Option<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("3D/3dmodel.model", SimpleFileOptions::default())
        .ok()?;
    zip.write_all(text).ok()?;
    Some(zip.finish().ok()?.into_inner())
}

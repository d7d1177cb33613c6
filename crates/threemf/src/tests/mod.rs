//! Files, sound ones and hostile ones.

mod core;
mod export;
mod functions;
mod hostile;
mod lattice;
mod levels;
mod refused;

use crate::write::mesh::SIDES;
use crate::{Body, MeshError, read};
use glam::{DAffine3, DVec3};
use isocontour::{Bounds, Values, data_of};
use std::io::{Cursor, Write};
use zip::write::{SimpleFileOptions, ZipWriter};

fn corner(i: u32) -> [f32; 3] {
    [0, 1, 2].map(|k| (i >> k & 1) as f32)
}

/// The faces of a cube.
fn faces() -> Vec<[u32; 3]> {
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    SIDES.into_iter().flat_map(halves).collect()
}

/// What is made of an archive's bytes.
pub(super) fn of(bytes: &[u8]) -> Result<Body, MeshError> {
    read("mesh(\"a.3mf\")", Cursor::new(bytes))
}

pub(super) fn archive(files: &[(&str, &str)]) -> Vec<u8> {
    let files: Vec<(&str, &[u8])> = files
        .iter()
        .map(|(name, text)| (*name, text.as_bytes()))
        .collect();
    archive_of(&files)
}

pub(super) fn archive_of(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

pub(super) const CORE: &str = "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
     xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" \
     xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\" \
     xmlns:b2=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07\" \
     xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" \
     xmlns:v=\"http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01\" \
     xmlns:i=\"http://schemas.3mf.io/3dmanufacturing/implicit/2023/12\" \
     xmlns:x=\"http://schemas.3mf.io/3dmanufacturing/other/2030/01\"";

pub(super) fn model(unit: &str, resources: &str, items: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<model unit=\"{unit}\" {CORE}>\n\
         <resources>{resources}</resources><build>{items}</build></model>"
    )
}

pub(super) fn cube_mesh() -> String {
    let vertices: String = (0..8)
        .map(|i| {
            let [x, y, z] = corner(i);
            format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
        })
        .collect();
    let triangles: String = faces()
        .iter()
        .map(|[a, b, c]| {
            format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" />")
        })
        .collect();
    format!(
        "<mesh><vertices>{vertices}</vertices><triangles>{triangles}\
         </triangles></mesh>"
    )
}

pub(super) fn cube_object(id: u32, more: &str) -> String {
    format!("<object id=\"{id}\" {more}>{}</object>", cube_mesh())
}

pub(super) const ROOT: &str = "3D/3dmodel.model";

pub(super) fn package(model: &str) -> Vec<u8> {
    archive(&[(ROOT, model)])
}

pub(super) const ITEM: &str = "<item objectid=\"1\"/>";

/// The value of a body at a place.
pub(super) fn value(body: &Body, p: DVec3) -> f64 {
    let values = Values::new(&body.tree, None).unwrap();
    let at = p.to_array().map(|x| vec![x as f32]);
    let [x, y, z] = &at;
    let mut out = Vec::new();
    values.at(&[x, y, z], &mut out).unwrap();
    f64::from(out[0])
}

/// The box around the first data of a body.
pub(super) fn extent(body: &Body) -> Bounds {
    body.data[0].extent(&DAffine3::IDENTITY).unwrap()
}

/// The box around the cube.
pub(super) fn unit_cube() -> Bounds {
    Bounds {
        min: DVec3::ZERO,
        max: DVec3::ONE,
    }
}

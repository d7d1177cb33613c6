//! Stand-in so that the command line can be built: to be replaced by the real
//! module, whose interface this has.
#![allow(missing_docs)]
use crate::model::Model;
use crate::settings::Settings;
use crate::units::*;
use glam::DVec3;
use std::path::Path;

pub struct Options<'a> {
    pub threads: Option<usize>,
    pub svg_dir: Option<&'a Path>,
    /// Layers done, of all.
    pub on_layer: &'a (dyn Fn(usize, usize) + Sync),
}
#[derive(Clone, Debug)]
pub struct Summary {
    pub size: DVec3,
    pub layers: usize,
    pub time: Seconds,
    pub filament_length: Mm,
    pub filament_mass_g: f64,
    pub unfilled_area: Mm2,
    pub warnings: Vec<String>,
}
#[derive(Debug, thiserror::Error)]
pub enum SliceError {
    #[error(transparent)]
    Plan(#[from] crate::layers::PlanError),
    #[error("cannot write the G-code")]
    Write(#[from] std::io::Error),
}
pub fn slice(
    model: &Model,
    settings: &Settings,
    options: &Options<'_>,
    out: &mut dyn std::io::Write,
) -> Result<Summary, SliceError> {
    let size = model.bounds.size();
    let (first, rest) = (settings.first_layer_height, settings.layer_height);
    let layers = crate::layers::plan(size.z, first, rest)?.len();
    for i in 0..layers {
        writeln!(out, ";LAYER_CHANGE")?;
        (options.on_layer)(i + 1, layers);
    }
    Ok(Summary {
        size,
        layers,
        time: 60.0,
        filament_length: 1000.0,
        filament_mass_g: 3.0,
        unfilled_area: 0.0,
        warnings: Vec::new(),
    })
}

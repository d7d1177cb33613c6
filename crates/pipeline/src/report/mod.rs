//! Measures how accurate a run was, against the field itself.
//!
//! In: layers as they will be printed. Out: a [`Report`] for a file, or two of
//! its figures for a summary. Each file tells what it measures and how:
//!
//! | file | what it does |
//! |---|---|
//! | `layer` | outline and walls of a layer |
//! | `area` | areas and volumes by the field alone |
//! | `spread` | quantiles |
//!
//! The figures do not depend on the number of threads: each layer is measured
//! alone, and the results are added up in order. Not measured: skin, infill,
//! and the error of rounding the G-code to a micrometre.

mod area;
mod layer;
mod spread;

pub(crate) use layer::{Effort, LayerFigures, LayerParts, measure};
pub use spread::Figures;
pub(crate) use spread::Spread;

use glam::DVec3;
use isoslice_base::timings::Timings;
use isoslice_base::units::{Mm, Mm2, Mm3, Seconds};
use isoslice_model::heights::Steps;
use isoslice_model::{Model, Probe, ProbeError};
use serde::Serialize;
use std::collections::BTreeMap;

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// fidget cannot evaluate the expression.
    #[error(transparent)]
    Probe(#[from] ProbeError),
}

/// Number of layers that a summary measures.
const SUMMARY_LAYERS: usize = 40;
/// Number of points of the outline, and of the outer wall, on each of those
/// layers: few enough to cost next to nothing.
const SUMMARY_POINTS: usize = 50;
/// Number of layers whose area is compared with the field's.
const AREA_LAYERS: usize = 24;
/// Number of lines through each of those layers.
const AREA_LINES: usize = 400;
/// Number of lines through the part for its volume.
const VOLUME_LINES: usize = 4000;
/// Number of worst layers that are listed.
const WORST: usize = 10;

/// Measures the layers of one run.
pub(crate) struct Gauge<'a> {
    model: &'a Model,
    used: &'a Used,
    probe: Probe,
    /// Number of the run's layers.
    count: usize,
    full: bool,
}

impl<'a> Gauge<'a> {
    /// A gauge for a run of `count` layers. `full` is true if there will be a
    /// report.
    ///
    /// # Errors
    /// If fidget refuses the expression.
    pub(crate) fn new(
        model: &'a Model,
        used: &'a Used,
        count: usize,
        full: bool,
    ) -> Result<Self, ReportError> {
        Ok(Gauge {
            model,
            used,
            probe: Probe::new(&model.tree)?,
            count,
            full,
        })
    }

    /// Measures the `k`th layer of the run, if it is one of those that are
    /// measured.
    ///
    /// # Errors
    /// If the evaluator fails, which is a bug.
    pub(crate) fn layer(
        &self,
        parts: LayerParts<'_>,
        k: usize,
    ) -> Result<Option<LayerFigures>, ReportError> {
        let bounds = &self.model.bounds;
        let frame = bounds.from_above();
        let among = |chosen: usize| {
            let every = self.count.div_ceil(chosen).max(1);
            k % every == every / 2
        };
        let effort = if self.full {
            Effort::Full {
                area_lines: if among(AREA_LAYERS) { AREA_LINES } else { 0 },
            }
        } else if among(SUMMARY_LAYERS) {
            Effort::Points(SUMMARY_POINTS)
        } else {
            return Ok(None);
        };
        let mut found = measure(
            parts,
            &self.probe,
            frame,
            effort,
            self.used.sample_spacing,
        )?;
        if let Some((_, at)) = &mut found.worst {
            *at += self.model.origin.truncate();
        }
        Ok(Some(found))
    }

    /// Volume of the part between the heights `z` of its own frame, and how
    /// far it may be off.
    ///
    /// # Errors
    /// If the evaluator fails, which is a bug.
    pub(crate) fn volume(
        &self,
        z: [f64; 2],
        timings: &Timings,
    ) -> Result<(Mm3, Mm3), ReportError> {
        let (low, high) = (self.model.bounds.min, self.model.bounds.max);
        let low = DVec3::new(low.x, low.y, low.z.max(z[0]));
        let high = DVec3::new(high.x, high.y, high.z.min(z[1]).max(low.z));
        let pitch = self.used.sample_spacing;
        area::volume(&self.probe, low, high, VOLUME_LINES, pitch, timings)
    }
}

/// The figures of all layers so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct RunFigures {
    outline: Spread,
    outer_wall: Spread,
    spacing: Spread,
    varying: Spread,
    lost: u64,
    layers: Vec<Layer>,
    volume: Mm3,
    unfilled: Mm2,
    /// The areas of the layers that were compared.
    compared: Option<Area>,
    uncertainty: Mm2,
}

impl RunFigures {
    /// Takes in a layer's figures. `listed` is true if each layer is to be
    /// listed.
    pub(crate) fn add(&mut self, found: &LayerFigures, listed: bool) {
        self.outline.merge(&found.outline);
        self.outer_wall.merge(&found.outer_wall);
        self.spacing.merge(&found.spacing);
        self.varying.merge(&found.varying);
        self.lost += found.lost;
        self.volume += found.area * found.height;
        self.unfilled += found.unfilled;
        if let Some((by_field, uncertainty)) = found.area_by_field {
            let sum = self.compared.get_or_insert_default();
            sum.layers += 1;
            sum.outline_mm2 += found.area;
            sum.field_mm2 += by_field;
            // The errors of different layers are independent.
            self.uncertainty = self.uncertainty.hypot(uncertainty);
        }
        if listed {
            self.layers.push(Layer {
                layer: found.index + 1,
                z_mm: tidy(found.top, 4),
                outline_um: found.outline.figures(),
                worst_at: found.worst.map(|(um, p)| WorstPlace {
                    um: tidy(um, 3),
                    x: tidy(p.x, 3),
                    y: tidy(p.y, 3),
                }),
                area_mm2: tidy(found.area, 3),
                area_by_field_mm2: found.area_by_field.map(|a| tidy(a.0, 3)),
                uncertainty_mm2: found.area_by_field.map(|a| tidy(a.1, 3)),
                rings: found.rings,
                vertices: found.vertices,
                nan_samples: found.nan_samples,
                forced_rings: found.forced_rings,
                unfilled_mm2: tidy(found.unfilled, 3),
            });
        }
    }

    /// Deviations of the outlines, and of the outer edges of outer beads, µm,
    /// if there are any.
    pub(crate) fn accuracy(&self) -> (Option<Figures>, Option<Figures>) {
        let mut edges = self.outer_wall.clone();
        edges.merge(&self.varying);
        (self.outline.figures(), edges.figures())
    }

    /// The whole report. `volume` is the volume by the field and its
    /// uncertainty, `extruded` the printed volume with the skirt.
    pub(crate) fn report(
        self,
        gauge: &Gauge<'_>,
        layer_count: usize,
        volume: (Mm3, Mm3),
        extruded: Mm3,
    ) -> Report {
        let sum = |of: fn(&Layer) -> usize| -> usize {
            self.layers.iter().map(of).sum()
        };
        let size = |l: &Layer| l.worst_at.map_or(0.0, |w| w.um.abs());
        let mut worst: Vec<&Layer> = self
            .layers
            .iter()
            .filter(|l| l.worst_at.is_some())
            .collect();
        worst.sort_by(|a, b| size(b).total_cmp(&size(a)));
        worst.truncate(WORST);
        let worst_layers = worst.iter().map(|l| l.layer).collect();
        Report {
            format: 1,
            generator: concat!("isoslice ", env!("CARGO_PKG_VERSION")),
            model: gauge.model.name.clone(),
            size_mm: gauge.model.bounds.size().to_array().map(|v| tidy(v, 3)),
            part_layers: layer_count,
            steps: None,
            roles: BTreeMap::new(),
            settings: gauge.used.clone(),
            outline_um: self.outline.figures(),
            outline_lost: self.lost,
            outer_wall_um: self.outer_wall.figures(),
            wall_spacing_um: self.spacing.figures(),
            varying_edge_um: self.varying.figures(),
            area: self.compared.map(|a| {
                let excess = (a.outline_mm2 / a.field_mm2 - 1.0) * 100.0;
                let own = self.uncertainty / a.field_mm2 * 100.0;
                Area {
                    outline_mm2: tidy(a.outline_mm2, 3),
                    field_mm2: tidy(a.field_mm2, 3),
                    excess_percent: tidy(excess, 4),
                    uncertainty_percent: tidy(own, 4),
                    ..a
                }
            }),
            volume: Volume {
                layers_mm3: tidy(self.volume, 2),
                field_mm3: tidy(volume.0, 2),
                excess_percent: tidy((self.volume / volume.0 - 1.0) * 100.0, 4),
                uncertainty_percent: tidy(volume.1 / volume.0 * 100.0, 4),
                extruded_mm3: tidy(extruded, 2),
            },
            rings: sum(|l| l.rings),
            vertices: sum(|l| l.vertices),
            nan_samples: sum(|l| l.nan_samples),
            forced_rings: sum(|l| l.forced_rings),
            unfilled_mm2: tidy(self.unfilled, 3),
            worst_layers,
            layers: self.layers,
        }
    }
}

/// What the beads of one role amount to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RoleSum {
    /// Length of the beads, mm.
    pub length_mm: Mm,
    /// Length of filament, mm.
    pub filament_mm: Mm,
    /// How long it takes to print them, s; travels and retractions between
    /// them do not count.
    pub time_s: Seconds,
}

/// What `--report` writes. Names ending in `_um` are micrometres; a missing
/// measurement is `null`; layers count from 1.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Version of this format. Within a version keys are only added.
    pub format: u32,
    /// The program and its version.
    pub generator: &'static str,
    /// Name of the model.
    pub model: String,
    /// Sides of the part's box, mm.
    pub size_mm: [f64; 3],
    /// Layers of the whole part.
    pub part_layers: usize,
    /// What layers of different heights amount to; none for uniform layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<Steps>,
    /// What the beads of each role amount to. Roles without beads are left out.
    pub roles: BTreeMap<&'static str, RoleSum>,
    /// The settings that matter to accuracy, by their names.
    pub settings: Used,
    /// Distance of the outlines from f = 0 in the layers' planes, positive
    /// outside: at each vertex and at points between them.
    pub outline_um: Option<Figures>,
    /// Number of points of the outlines that have no border within 1 mm. No
    /// other figure counts them.
    pub outline_lost: u64,
    /// Depth of the outer wall's centre line below the outline, less half the
    /// wall's width. Beads whose width varies do not count.
    pub outer_wall_um: Option<Figures>,
    /// Distance of each inner wall's centre line from that of the wall outside
    /// it, less the spacing.
    pub wall_spacing_um: Option<Figures>,
    /// Distance of the edges of outer beads whose width varies from the
    /// outline, negative outside.
    pub varying_edge_um: Option<Figures>,
    /// Areas of some of the layers.
    pub area: Option<Area>,
    /// Volumes of all layers of the run.
    pub volume: Volume,
    /// Number of rings of all outlines.
    pub rings: usize,
    /// Number of vertices of these rings.
    pub vertices: usize,
    /// Samples at which the field was NaN.
    pub nan_samples: usize,
    /// Rings closed by a straight line because the field contradicted itself.
    pub forced_rings: usize,
    /// Area that nothing fills because it is thinner than any bead.
    pub unfilled_mm2: Mm2,
    /// The layers with the greatest deviation of the outline, worst first.
    pub worst_layers: Vec<usize>,
    /// Every layer.
    pub layers: Vec<Layer>,
}

/// The settings in a [`Report`].
#[derive(Clone, Debug, Serialize)]
#[allow(missing_docs, reason = "these are the settings of the same names")]
pub struct Used {
    pub layer_height: f64,
    pub first_layer_height: f64,
    pub accuracy: f64,
    pub sample_spacing: f64,
    pub walls: u32,
    pub wall_offset: &'static str,
    pub outer_wall_width: f64,
    pub inner_wall_width: f64,
    pub thin_min: f64,
    pub thin_max: f64,
}

/// Areas in a [`Report`].
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Area {
    /// Number of layers compared.
    pub layers: usize,
    /// Area of their outlines.
    pub outline_mm2: Mm2,
    /// Area by the field itself.
    pub field_mm2: Mm2,
    /// By how much the outlines' area is larger than the field's.
    pub excess_percent: f64,
    /// How far the field's area may be off: two standard errors.
    pub uncertainty_percent: f64,
}

/// Volumes in a [`Report`].
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Volume {
    /// Sum of the outlines' areas times their layers' heights.
    pub layers_mm3: Mm3,
    /// Volume by the field itself, within the layers' heights.
    pub field_mm3: Mm3,
    /// By how much the layers' volume is larger than the field's, stairs
    /// included.
    pub excess_percent: f64,
    /// How far the field's volume may be off: two standard errors.
    pub uncertainty_percent: f64,
    /// Volume of the filament, with the skirt.
    pub extruded_mm3: Mm3,
}

/// A layer in a [`Report`].
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Layer {
    /// The layer's number.
    pub layer: usize,
    /// Height of the layer's upper face.
    pub z_mm: f64,
    /// Distance of the layer's outline from f = 0.
    pub outline_um: Option<Figures>,
    /// The place where the distance is greatest.
    pub worst_at: Option<WorstPlace>,
    /// Area of the layer's outline.
    pub area_mm2: Mm2,
    /// Area by the field itself, if compared.
    pub area_by_field_mm2: Option<Mm2>,
    /// How far the area by the field may be off.
    pub uncertainty_mm2: Option<Mm2>,
    /// Number of rings of the layer's outline.
    pub rings: usize,
    /// Number of vertices of these rings.
    pub vertices: usize,
    /// Samples at which the field was NaN.
    pub nan_samples: usize,
    /// Rings closed by force.
    pub forced_rings: usize,
    /// Area that nothing fills.
    pub unfilled_mm2: Mm2,
}

/// A place on a layer in a [`Report`], in the model's coordinates, mm.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WorstPlace {
    /// The deviation, µm.
    pub um: f64,
    /// x of the place.
    pub x: f64,
    /// y of the place.
    pub y: f64,
}

/// Rounds for the report, but never to a negative zero.
fn tidy(value: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (value * scale).round() / scale + 0.0
}

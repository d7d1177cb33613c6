//! What a run has made, for whoever asked for it.

use super::exit::Done;
use super::job::{Job, Planned};
use super::plans::WallFieldPlan;
use super::sums::PartDone;
use crate::report::{Figures, Report, RoleSum};
use glam::{DVec2, DVec3};
use isoslice_base::timings::Stage;
use isoslice_base::units::{Mm, Mm2, Seconds, filament_area};
use isoslice_check::Verdict;
use isoslice_held::overhangs::Hanging;
use isoslice_layer::adhesion::AdhesionPlan;
use isoslice_model::heights::Steps;
use isoslice_path::pace::Amount;
use isoslice_path::spiral::Spiral;
use isoslice_planar::bead::Role;
use isoslice_plate::{Part, Plate};
use std::collections::BTreeMap;
use std::ops::Range;

/// The results of a run.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Summary {
    /// Extent of the part.
    pub size: DVec3,
    /// Indices of the layers printed.
    pub layers: Range<usize>,
    /// How many layers the part has.
    pub layer_count: usize,
    /// Number of the lowest layers that are a raft's.
    pub raft_layers: usize,
    /// What layers of different heights amount to; none for uniform layers.
    pub steps: Option<Steps>,
    /// Estimated print time, without heating and homing.
    pub time: Seconds,
    /// Filament used.
    pub filament_length: Mm,
    /// Filament used, grams.
    pub filament_mass_g: f64,
    /// Filament used for supports.
    pub support_length: Mm,
    /// What the beads of each role amount to, by the role's name. Roles without
    /// beads are left out.
    pub roles: BTreeMap<&'static str, RoleSum>,
    /// Area of gaps between walls that nothing fills, all layers together.
    pub unfilled_area: Mm2,
    /// Area of all layers' outlines together.
    pub solid_area: Mm2,
    /// Number of moves that print.
    pub printing_moves: usize,
    /// Number of moves that are slower than asked for, because the printer
    /// takes only so many in a second, and for no stronger reason.
    pub slowed_moves: usize,
    /// True if nothing of a part is printed in its first layer.
    pub(super) floats: bool,
    /// Number of layers that take much less than `cooling.min_layer_time`, though they
    /// are slowed to `cooling.min_speed`, and the time of the shortest one.
    pub short_layers: Option<(usize, Seconds)>,
    /// Time that the print takes longer than at the speeds asked for, by its
    /// cause: `cooling`, `flow` of the hot end, `moves` that the printer takes,
    /// and `acceleration`. Where several causes slow a bead, the strongest one
    /// counts.
    pub time_lost: BTreeMap<&'static str, Seconds>,
    /// Islands and holes left out because they are smaller than a quarter of
    /// the outer wall's width.
    pub dropped_rings: usize,
    /// What nothing holds while it is printed.
    pub hanging: Hanging,
    /// Distance of the outlines from f = 0, µm, if there are outlines. Without
    /// a report it is measured at a few points.
    pub outline_error: Option<Figures>,
    /// Distance of the outer beads' edges from the outline, µm.
    pub wall_error: Option<Figures>,
    /// The report, if it was asked for.
    pub report: Option<Report>,
    /// The results of each part. Equal parts count as copies of one.
    pub parts: Vec<PartSummary>,
    /// The verdict of the check of the G-code, if there was a check. It has no
    /// faults.
    pub verdict: Option<Verdict>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Where the processor time went, added up over all threads.
    pub timings: Vec<(Stage, Seconds)>,
}

/// The results of a part of a plate.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PartSummary {
    /// Name of the part's model.
    pub name: String,
    /// Number of places in which the part stands.
    pub copies: usize,
    /// Extent of the part.
    pub size: DVec3,
    /// Area of the flat side on which the part was laid, if it was.
    pub laid: Option<Mm2>,
    /// Number of the part's layers.
    pub layer_count: usize,
    /// Filament that each copy takes, with its supports and its brim.
    pub filament_length: Mm,
}

/// What the user should know of a skirt that is lower than asked for.
fn low_skirt(job: &Job<'_>) -> Option<String> {
    let AdhesionPlan { skirt, bed, .. } = AdhesionPlan::of(&job.plate.settings);
    let lowered = job.turns.is_some()
        && !bed.shield
        && skirt.loops > 0
        && skirt.layers > 1;
    lowered.then(|| {
        format!(
            "skirt.layers = {} has no effect, since the parts are printed one by \
             one (plate.sequence) and the head has to pass over the skirt: it is \
             one layer high; set skirt.layers to 1",
            skirt.layers
        )
    })
}

impl Summary {
    /// The summary of a plate whose file is written, except for the accuracy and
    /// the times. `warnings` are those so far, to which the summary adds its own.
    pub(super) fn new(
        job: &Job<'_>,
        done: Done,
        warnings: Vec<String>,
    ) -> Summary {
        let plate = job.plate;
        let settings = &plate.settings;
        let (totals, sums) = (done.totals, &done.sums);
        let role = |(role, all): (&Role, &Amount)| {
            let sum = RoleSum {
                length_mm: all.length,
                filament_mm: all.filament,
                time_s: all.time,
            };
            (role.name(), sum)
        };
        let mut summary = Summary {
            size: plate.size(),
            layers: job.extent.layers.clone(),
            layer_count: job.count,
            raft_layers: settings.raft_layers(),
            time: totals.time,
            filament_length: totals.filament_length,
            filament_mass_g: totals.filament_mass_g,
            roles: sums.amounts.iter().map(role).collect(),
            printing_moves: sums.printing,
            slowed_moves: sums.slowed,
            short_layers: sums.short,
            time_lost: sums.lost.iter().map(|(c, t)| (c.name(), *t)).collect(),
            warnings,
            ..Summary::default()
        };
        summary.warnings.extend(done.warnings);
        summary.warnings.extend(low_skirt(job));
        let per_mm = filament_area(settings.filament.diameter);
        let (mut place, mut beads) = (0, 0);
        for (planned, done_part) in job.parts.iter().zip(done.parts) {
            let Planned { part, spans, .. } = planned;
            beads += done_part.beads;
            let more = summary.add(planned, done_part, per_mm);
            let more = more.into_iter().map(|w| told(plate, part, w));
            summary.warnings.extend(more);
            summary.parts.push(PartSummary {
                name: part.model.name.clone(),
                copies: part.places.len(),
                size: part.model.bounds.size(),
                laid: part.model.laid,
                layer_count: spans.len(),
                filament_length: done.extruded[place] / per_mm,
            });
            place += part.places.len();
        }
        if beads == 0 {
            let nothing = "there is nothing to print in these layers";
            summary.warnings.push(nothing.into());
        }
        summary
    }

    /// Adds the results of a part. Returns what the user should know of it.
    fn add(
        &mut self,
        planned: &Planned<'_>,
        done: PartDone,
        per_mm: Mm2,
    ) -> Vec<String> {
        let Planned {
            part,
            stages,
            spans,
            ..
        } = planned;
        let copies = part.places.len();
        let top = spans.last().map_or(0.0, |span| span.top);
        let mut warnings = Vec::new();
        warnings.extend(stages.spiral.iter().flat_map(Spiral::warnings));
        warnings.extend(done.warnings);
        let mut hanging = done.hanging;
        if let Some(supported) = stages.support() {
            // The plan of the supports has seen to what hangs, and says what
            // it could not hold.
            hanging = Hanging::default();
            let first = part.places.first().map_or(DVec2::ZERO, |p| p.shift);
            let offset = part.model.offset.truncate() + first;
            warnings.extend(supported.warnings(offset));
        }
        hanging.foot = done.foot.filter(|foot| top > foot.holds);
        warnings.extend(hanging.warnings(top, &stages.plans.overhangs));
        let tally = done.tally;
        let by_field = !matches!(stages.plans.wall_fields, WallFieldPlan::None);
        tally.warn(by_field, &mut warnings);
        self.floats |= tally.floats;
        let times = copies as f64;
        self.hanging.add(&hanging, copies);
        self.support_length += times * tally.support / per_mm;
        self.unfilled_area += times * tally.gap;
        self.solid_area += times * tally.solid;
        self.dropped_rings += copies * tally.dropped_rings;
        warnings
    }
}

/// A warning about a part, with the part's name if there are several.
fn told(plate: &Plate, part: &Part, warning: String) -> String {
    match plate.parts.len() {
        1 => warning,
        _ => format!("{}: {warning}", part.model.name),
    }
}

//! The skirt or the draft shield round several parts.
//!
//! A single part has its own, which its stages lay.

use super::SliceError;
use super::job::{Job, Planned, outline_of};
use isoslice_layer::adhesion::{AdhesionPlan, Skirt, SkirtPlan};
use isoslice_planar::{Area, Ring, hull};

/// The skirt or the draft shield round several parts, if there is one.
pub(super) fn skirt_round(job: &Job<'_>) -> Result<Option<Skirt>, SliceError> {
    let plate = job.plate;
    let AdhesionPlan {
        skirt, shield, bed, ..
    } = AdhesionPlan::of(&plate.settings);
    let any = bed.shield || (skirt.loops > 0 && skirt.layers > 0);
    if plate.place_count() == 1 || !any {
        return Ok(None);
    }
    // A higher one would be in the way of the head.
    let layers = match job.turns {
        Some(_) => 1,
        None => skirt.layers,
    };
    let mut areas = Vec::new();
    for Planned {
        part,
        stages,
        spans,
        ..
    } in &job.parts
    {
        let beside = if bed.shield {
            stages.seen_from_above(spans, &outline_of(part)?)
        } else {
            stages.beside(spans, layers)?
        };
        // The hull of the parts' hulls is the hull of them all.
        let hulls = beside.iter().map(|area| area.rings.iter().flatten());
        let hulls: Vec<Ring> = hulls.map(|all| hull(all.copied())).collect();
        for place in &part.places {
            let by = part.model.offset.truncate() + place.shift;
            let moved = |ring: &Ring| ring.iter().map(|p| *p + by).collect();
            let rings = hulls.iter().map(moved).collect();
            areas.push(Area { rings });
        }
    }
    // The skirt goes round the widest brim.
    let plans = job.parts.iter().map(|part| part.stages.plans);
    let brims = plans.map(|plans| plans.adhesion.brim.reach);
    let brim = brims.fold(0.0, f64::max);
    let plan = if bed.shield {
        let of_parts = job.parts.iter().map(|part| shield.among(part.spans));
        of_parts.max_by_key(|plan| plan.layers).unwrap_or(skirt)
    } else {
        SkirtPlan { layers, ..skirt }
    };
    Ok(Some(Skirt::new(&areas, SkirtPlan { brim, ..plan })))
}

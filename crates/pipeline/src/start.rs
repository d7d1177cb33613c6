//! How every look at a plate starts: threads, rafts and the heights of layers.

use super::SliceError;
use isoslice_base::limits;
use isoslice_base::units::Mm;
use isoslice_model::heights::{HeightPlan, Heights, Steps, heights};
use isoslice_plate::{Part, Plate};
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;

/// Accuracy of heights, mm.
const FIT: Mm = 1e-3;

/// A pool of so many threads, or as many as the machine has, under the watch of
/// this thread.
pub(super) fn pool(
    threads: Option<usize>,
) -> Result<ThreadPool, rayon::ThreadPoolBuildError> {
    let watch = limits::Watch::current();
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or_else(limits::processors))
        .start_handler(move |_| limits::Watch::adopt(watch.as_ref()))
        .build()
}

/// The layers of each part, from the bed. Parts of uniform layers share them.
/// If heights follow the surface, they follow the surfaces of all parts.
pub(super) fn layers_of(
    plate: &Plate,
) -> Result<(Vec<Vec<LayerSpan>>, Option<Steps>), SliceError> {
    let uniform = plate.settings.is_uniform();
    if let (false, [_, _, ..]) = (uniform, plate.parts.as_slice()) {
        let Some(whole) = plate.of_each() else {
            return Err(SliceError::TooLargeTogether);
        };
        let Heights { spans, steps } =
            heights(&whole, &HeightPlan::of(&plate.settings))?;
        let of_part = |part: &Part| {
            let top = part.model.printed_bounds().max.z;
            let has = |s: &&LayerSpan| s.sample_z() < top;
            spans.iter().take_while(has).copied().collect()
        };
        return Ok((plate.parts.iter().map(of_part).collect(), steps));
    }
    let mut all = Vec::new();
    let mut steps = None;
    for part in &plate.parts {
        let found = heights(&part.model, &HeightPlan::of(&part.settings))
            .map_err(|e| SliceError::of(plate, part, e.into()))?;
        all.push(found.spans);
        steps = found.steps;
    }
    Ok((all, steps))
}

/// The plate with its parts on their rafts, if they have any.
pub(super) fn raised(plate: &Plate) -> Result<Plate, SliceError> {
    let lift = plate.settings.raft_height();
    let mut raised = plate.clone();
    if lift == 0.0 {
        return Ok(raised);
    }
    let most = plate.settings.printer.height;
    for part in &mut raised.parts {
        part.model = part.model.raised(lift);
        let top = part.model.printed_bounds().max.z;
        if top > most + FIT {
            let error = SliceError::RaftTooHigh { lift, top, most };
            return Err(SliceError::of(plate, part, error));
        }
    }
    Ok(raised)
}

//! What hangs in a part, and all that supports would hold.

use super::SliceError;
use super::plans::Plans;
use super::stages::Stages;
use super::start::pool;
use crate::report::Gauge;
use isoslice_base::limits;
use isoslice_base::units::Mm;
use isoslice_held::overhangs::{Hanging, OverhangPlan, Unsupported};
use isoslice_model::Model;
use isoslice_model::expressions::Surroundings;
use isoslice_model::heights::{HeightPlan, heights};
use isoslice_settings::{Settings, Supports};

/// What of a part would need supports.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Survey {
    /// What hangs, as the summary of a run without supports has it.
    pub hanging: Hanging,
    /// The places that would need a support, from the bed up.
    pub places: Vec<Unsupported>,
    /// Height of the part.
    pub height: Mm,
    /// The value of the setting `supports`, if supports are to be printed.
    pub supports: Option<&'static str>,
}

impl Survey {
    /// What the user should know. If supports are to be printed, nothing is said
    /// of what they hold: only their plan knows what they do not reach.
    pub fn warnings(&self, settings: &Settings) -> Vec<String> {
        let hanging = match self.supports {
            None => self.hanging,
            Some(_) => Hanging {
                foot: self.hanging.foot,
                ..Hanging::default()
            },
        };
        hanging.warnings(self.height, &OverhangPlan::of(settings))
    }
}

/// Looks at a placed model for what `supports = "auto"` would hold, whether or
/// not the settings ask for it. No bead is laid. The survey uses `threads`
/// threads, or all of the machine's.
///
/// # Errors
/// If there are no layers, if they cannot be evaluated, or if hardly any of the
/// part can be printed.
pub fn survey(
    model: &Model,
    settings: &Settings,
    threads: Option<usize>,
) -> Result<Survey, SliceError> {
    let pool = pool(threads)?;
    let model = &model.raised(settings.raft_height());
    let spans = pool
        .install(|| heights(model, &HeightPlan::of(settings)))?
        .spans;
    let around = Surroundings::new(model);
    let plans = Plans::of(settings);
    let gauge = Gauge::new(model, &plans.used, spans.len(), false)?;
    let stages = Stages::new(model, &plans, &around, gauge, &spans)?;
    // What cannot be printed has no hanging places, of which there may be
    // millions.
    let printed = stages.printed(&pool, &spans)?.layers;
    let (hanging, places) = stages.needs(&pool, &spans[..printed], &around)?;
    limits::go_on()?;
    Ok(Survey {
        hanging,
        places,
        height: spans.last().map_or(0.0, |span| span.top),
        supports: match settings.supports {
            Supports::Off => None,
            set => Some(set.name()),
        },
    })
}

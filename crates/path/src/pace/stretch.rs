//! How fast the beads of a layer may be, before it is known how they follow each
//! other, and which of their ways are arcs.
//!
//! In: the moves of a part in a layer. Out: the same moves. Each bead is in pieces
//! that have one rate, with arcs if there are to be any. No bead depends on another
//! one, so all threads work on them.

use super::PacePlan;
use super::bounds::{print_speed, speed_limit};
use super::move_rate::Rated;
use super::moves::Cause;
use super::rates::{Rater, Rates, Site};
use crate::travel::{Move, Travel};
use glam::DVec2;
use isoslice_base::parallel;
use isoslice_base::timings::{Stage, Timings};
use isoslice_model::expressions::QuantityError;
use isoslice_planar::bead::{Bead, Stroke};
use isoslice_settings::layers::LayerSpan;

/// Number of moves that a thread takes at a time.
const SOME: usize = 64;

/// Moves of a layer that belong together: those of a part, or of what stands
/// round all parts.
pub struct Stretch<'a, 'r> {
    /// Which of the plate's places the part has; none if the stretch is no
    /// part.
    pub place: Option<usize>,
    /// The moves, in print coordinates.
    pub moves: Vec<Move>,
    /// The rates of the stretch's beads. The rater's plan holds for the stretch.
    pub rater: &'r Rater<'a>,
    /// Where the part is.
    pub site: Site<'r>,
}

/// A stretch whose beads have their rates.
pub struct RatedStretch<'a> {
    pub(super) place: Option<usize>,
    pub(super) plan: &'a PacePlan,
    pub(super) steps: Vec<Step>,
}

/// A move whose rates are known.
pub(super) enum Step {
    Travel(Travel),
    /// The pieces of a bead.
    Print(Vec<Rated>),
}

impl<'a> Stretch<'a, '_> {
    /// The stretch with the rates of its beads, in the layer `span`. All threads of
    /// the pool that this is called in work on it.
    ///
    /// # Errors
    /// If a setting that is an expression has no value somewhere.
    pub fn rated(
        mut self,
        span: &LayerSpan,
        timings: &Timings,
    ) -> Result<RatedStretch<'a>, QuantityError> {
        let moves = std::mem::take(&mut self.moves);
        let step = |step: Move| match step {
            Move::Travel(travel) => Ok(Step::Travel(travel)),
            Move::Print(bead) => Ok(Step::Print(self.pieces(bead, span)?)),
        };
        let steps = |_: usize, some: Vec<Move>| {
            let steps = some.into_iter().map(step);
            timings.time(Stage::Rates, || steps.collect::<Result<Vec<_>, _>>())
        };
        let mut moves = moves.into_iter();
        let some = std::iter::from_fn(|| {
            let some: Vec<Move> = moves.by_ref().take(SOME).collect();
            (!some.is_empty()).then_some(some)
        });
        let steps = parallel::map_owned(some, steps);
        // The error is that of the first move that has one.
        let steps: Vec<Vec<Step>> =
            steps.into_iter().collect::<Result<_, _>>()?;
        let steps = steps.into_iter().flatten().collect();
        Ok(RatedStretch {
            place: self.place,
            plan: self.rater.plan,
            steps,
        })
    }

    /// The pieces of a bead.
    fn pieces(
        &self,
        bead: Bead,
        span: &LayerSpan,
    ) -> Result<Vec<Rated>, QuantityError> {
        let plan = self.rater.plan;
        let limit = speed_limit(&bead, span, plan);
        let pieces = self.rater.pieces(bead, span, self.site)?;
        let piece = |(piece, mut rates): (Bead, Rates)| {
            rates.speed = rates.speed.min(limit);
            let [wanted, speed] = print_speed(plan, &piece, &rates);
            rates.speed = wanted;
            let mut rated = with_arcs(piece, rates, plan);
            rated.slow(speed, Cause::Flow);
            rated
        };
        Ok(pieces.into_iter().map(piece).collect())
    }
}

/// A bead with arcs, if there are to be any.
fn with_arcs(bead: Bead, rates: Rates, plan: &PacePlan) -> Rated {
    let mut rated = Rated {
        bead,
        turns: Vec::new(),
        wanted: rates.speed,
        by: None,
        rates,
    };
    // An arc is flat.
    if rated.bead.stroke.levels.is_empty() {
        let bead = &mut rated.bead;
        let path: Vec<DVec2> = bead.stroke.path().collect();
        if let Some((points, turns)) = plan.resolution.arcs(&path, bead.role) {
            bead.stroke = Stroke::new(points, false, bead.stroke.width);
            rated.turns = turns;
        }
    }
    rated
}

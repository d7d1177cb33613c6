//! Finds what needs supports, slab by slab.
//!
//! In: the outlines of a slab of layers. Out: what needs a support in each
//! layer, and the outlines as coarse as supports ask for. The exact outlines of
//! the slab can be forgotten then: kept for all layers, they would take much
//! more memory.

use super::TOLERANCE;
use super::need::Need;
use super::plan::SupportPlan;
use super::wish::{Wish, Wishes};
use crate::overhangs::{OverhangPlan, Printed, Unheld, unheld};
use isoslice_base::units::Mm;
use isoslice_model::expressions::QuantityError;
use isoslice_planar::Area;
use isoslice_planar::clip::difference;
use isoslice_planar::simplify::simplify_area;
use isoslice_settings::layers::LayerSpan;

/// What asks for supports.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// What `support.where` asks for, if it is an expression.
    pub wishes: Option<&'a Wishes<'a>>,
    /// What supports follow from.
    pub plan: &'a SupportPlan,
}

impl Asked<'_> {
    /// Returns what needs a support in a layer over the layer below, and the
    /// area that would need one but is too thin to be printed.
    fn of(
        self,
        here: &Printed,
        below: &Printed,
        span: &LayerSpan,
    ) -> Result<(Found, Area), QuantityError> {
        let wish = match self.wishes {
            Some(wishes) => wishes.of(&here.area, &below.area, span)?,
            None => Wish::default(),
        };
        // Skin counts the raft's layers, too.
        let number = span.index + self.plan.overhangs.raft_layers;
        let Unheld { must, thin } =
            unheld(here, below, number, span.height(), &self.plan.overhangs);
        let needs = !must.is_empty();
        let need = Need::new(must, &wish, span.height());
        let found = Found {
            forbidden: needs && need.must.is_empty() && need.wanted.is_empty(),
            need,
            wished: !wish.is_none(),
        };
        Ok((found, thin))
    }
}

/// What is found of a layer.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    /// What needs a support.
    pub need: Need,
    /// True if something is wanted or forbidden.
    pub wished: bool,
    /// True if something needs a support, and all of it is forbidden.
    pub forbidden: bool,
}

/// Some layers that follow each other.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    /// The layers' outlines, as coarse as supports ask for, without what is too
    /// thin to be printed.
    pub(super) outlines: Vec<Area>,
    /// What of each outline is not printed, since no line fits into it.
    pub(super) unprinted: Vec<Area>,
    /// What is found of each layer. Nothing is found of the slab's first layer
    /// until [`Survey::append`] brings it together with the layer below.
    pub(super) found: Vec<Found>,
    /// The first layer with its outline, and the outline of the last one.
    ends: Option<(LayerSpan, [Printed; 2])>,
}

impl Survey {
    /// Looks at layers and their outlines.
    ///
    /// # Errors
    /// If an expression of `asked` has no value somewhere.
    pub fn new<'l>(
        layers: impl Iterator<Item = (LayerSpan, &'l Area)>,
        asked: Asked<'_>,
    ) -> Result<Survey, QuantityError> {
        let mut survey = Survey::default();
        for (span, outline) in layers {
            let (here, unprinted) =
                Printed::new(outline, span.height(), &asked.plan.overhangs);
            survey.outlines.push(thinned(here.area.clone()));
            survey.unprinted.push(unprinted);
            match &mut survey.ends {
                None => {
                    survey.found.push(Found::default());
                    survey.ends = Some((span, [here.clone(), here]));
                }
                Some((_, [_, last])) => {
                    let (found, thin) = asked.of(&here, last, &span)?;
                    survey.found.push(found);
                    *last = here;
                    let layer = survey.outlines.len() - 1;
                    survey.leave(layer, thin);
                }
            }
        }
        Ok(survey)
    }

    /// Goes on with the layers above.
    ///
    /// # Errors
    /// If an expression of `asked` has no value somewhere.
    pub fn append(
        &mut self,
        mut above: Survey,
        asked: Asked<'_>,
    ) -> Result<(), QuantityError> {
        let Some((_, [_, last])) = &mut self.ends else {
            *self = above;
            return Ok(());
        };
        let Some((span, [lowest, highest])) = above.ends.take() else {
            return Ok(());
        };
        let (found, thin) = asked.of(&lowest, last, &span)?;
        above.found[0] = found;
        above.leave(0, thin);
        *last = highest;
        self.outlines.append(&mut above.outlines);
        self.unprinted.append(&mut above.unprinted);
        self.found.append(&mut above.found);
        Ok(())
    }
}

impl Survey {
    /// Takes away from a layer what is too thin to be printed.
    fn leave(&mut self, layer: usize, thin: Area) {
        if !thin.is_empty() {
            let outline = &mut self.outlines[layer];
            *outline = difference(outline, &thin);
            self.unprinted[layer].rings.extend(thin.rings);
        }
    }
}

/// The outline of a layer of some height, as coarse as supports ask for,
/// without what is not printed.
pub fn coarse(outline: &Area, height: Mm, plan: &OverhangPlan) -> Area {
    let (printed, _) = Printed::new(outline, height, plan);
    thinned(printed.area)
}

/// An area with fewer points. Unions and offsets of thousands of layers would
/// add ever more points.
pub(super) fn thinned(area: Area) -> Area {
    let mut thinned = simplify_area(&area, TOLERANCE);
    // It is kept for long, and its rings have room for the points left out.
    thinned.rings.iter_mut().for_each(Vec::shrink_to_fit);
    thinned
}

//! How much of a part prints, before anything is planned.

use super::outlines::WallFields;
use super::{ALL_LAYERS, Stages};
use crate::SliceError;
use crate::layer::{Inside, Layer};
use crate::sound::{self, Found};
use isoslice_base::limits;
use isoslice_base::parallel;
use isoslice_base::units::Mm;
use isoslice_model::contour::field_in;
use isoslice_planar::Rect;
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;

/// What is known of a layer that was looked at without its neighbours.
struct Looked {
    /// True if there is something to print.
    prints: bool,
    found: Found,
}

/// The layers of a part that print.
#[derive(Clone, Copy, Default)]
pub(crate) struct Printed {
    /// Number of layers up to the highest one that has something to print.
    pub layers: usize,
    /// Top of the highest layer in which the part has anything at all, mm.
    pub top: Mm,
}

impl Stages<'_> {
    /// The part's layers up to the highest one that has something to print. The
    /// bounds may reach higher than the part, and what is thinner than any line
    /// is left out.
    ///
    /// # Errors
    /// If hardly any of the part can be printed: see [`sound`].
    pub(crate) fn printed(
        &self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
    ) -> Result<Printed, SliceError> {
        // Mostly the last layer is the highest that prints. If it does not
        // print, the others are looked at slab by slab.
        let (below, last) = spans.split_at(spans.len().saturating_sub(1));
        let slabs = below.rchunks(self.slab_layers());
        let mut sampled = false;
        let mut top: Mm = 0.0;
        for slab in std::iter::once(last).chain(slabs) {
            limits::go_on()?;
            let looked = pool.install(|| self.look_at(slab))?;
            let highest = looked.iter().rposition(|l| l.prints);
            let all = slab.iter().zip(&looked);
            let some = all.filter(|(_, l)| !l.found.is_blank());
            top = some.map(|(span, _)| span.top).fold(top, Mm::max);
            let thin = looked.iter().any(|l| l.found.is_suspicious());
            if thin && !sampled {
                let found_in = |window: Rect, span: &LayerSpan| {
                    self.found_in(window, span)
                };
                let line = self.plans.overhangs.thinnest;
                sound::sample(pool, self.rect, spans, line, found_in)?;
                sampled = true;
            }
            if let Some(highest) = highest {
                let layers = slab.first().map_or(0, |s| s.index) + highest + 1;
                return Ok(Printed { layers, top });
            }
        }
        Ok(Printed::default())
    }

    /// What there is to print in some layers.
    fn look_at(&self, spans: &[LayerSpan]) -> Result<Vec<Looked>, SliceError> {
        let layers = self.layers(spans, &ALL_LAYERS)?;
        let look = |_: usize, layer: Layer| {
            let inside = self.inside_below(&layer, None);
            let found = found(&layer, &inside);
            if layer.area().is_empty() {
                let prints = false;
                return Ok(Looked { prints, found });
            }
            let alone = layer.among(None, None);
            let (beads, areas) = self.beads(&alone, &inside)?;
            let prints = !(beads.walls.is_empty()
                && beads.infill.is_empty()
                && self.skin(&alone, &areas).is_empty());
            Ok(Looked { prints, found })
        };
        parallel::map_owned(layers, look).into_iter().collect()
    }

    /// What a nozzle can make of a window of a layer.
    ///
    /// # Errors
    /// Those of [`Stages::layers`].
    fn found_in(
        &self,
        window: Rect,
        span: &LayerSpan,
    ) -> Result<Found, SliceError> {
        let spacing = self.plans.sample_spacing;
        let field = field_in(&self.model.tree, window, spacing)?;
        let span = std::slice::from_ref(span);
        let none = &WallFields::None;
        let layers = self.layers_of(&field, none, span, &ALL_LAYERS)?;
        let layer = layers.first();
        Ok(layer.map_or(Found::default(), |l| {
            found(l, &self.inside_below(l, None))
        }))
    }
}

/// What a nozzle can make of a layer.
fn found(layer: &Layer, inside: &Inside) -> Found {
    let dropped = layer.met.dropped_rings;
    Found::new(layer.area().content(), dropped, &inside.walls)
}

//! What is known of a layer on its way through the stages.

use super::SliceError;
use super::ahead::Made;
use super::supported::Top;
use crate::report::LayerFigures;
use isoslice_base::units::{Mm, Mm2};
use isoslice_held::overhangs::LayerOverhang;
use isoslice_layer::exposure::FillAreas;
use isoslice_layer::seam::Ground;
use isoslice_layer::view::{LayerFace, LayerView, Risen};
use isoslice_layer::walls::Walls;
use isoslice_path::order::LayerBeads;
use isoslice_planar::{Area, Solid};
use isoslice_settings::layers::LayerSpan;
use std::collections::VecDeque;
use std::sync::Arc;

/// Heights that differ by less are equal, mm: they are rounded to twice that.
pub(super) const SAME_HEIGHT: Mm = 0.5e-9;

/// A layer whose outline is known. A layer whose outlines equal those of the
/// layer below, as in a prism, shares them all.
#[derive(Clone)]
pub(super) struct Layer {
    pub span: LayerSpan,
    /// The outline that was found, if another one is printed.
    pub unchanged: Option<Arc<Area>>,
    pub met: Met,
    /// The outline to print.
    pub outline: Arc<Solid<'static>>,
    /// The outline to print, as exact as skin needs it.
    pub rough: Arc<Solid<'static>>,
    /// The outlines of the offset fields, if walls are made of these fields.
    pub offsets: Arc<Vec<Area>>,
    /// What the layer above stands on, if that is not the outline. Where an
    /// elephant's foot was taken from the outline, the plastic spreads out
    /// again.
    pub squeezed: Option<Arc<Solid<'static>>>,
    /// Where what rises from the layer is kept.
    pub risen: Arc<Risen>,
    /// The layer's inside, as long as a layer above may have an equal one.
    pub inside: Option<Arc<Inside>>,
}

/// What was met on the way to a layer's outline.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Met {
    /// Samples that were NaN.
    pub nan_samples: usize,
    /// Rings that were closed by force.
    pub forced_rings: usize,
    /// Places that were left out.
    pub dropped_rings: usize,
}

/// What a layer's outline encloses.
pub(super) struct Inside {
    pub walls: Walls,
    /// The area that has room for sparse infill.
    pub roomy: Area,
}

impl Layer {
    /// The outline to print.
    pub(super) fn area(&self) -> &Area {
        self.outline.area()
    }

    /// Forgets what only the layer right above asks for: layers farther up look
    /// at the rough outline alone. An exact outline and its grid may take
    /// megabytes.
    pub(super) fn sink(&mut self) {
        self.outline = self.rough.clone();
        self.unchanged = None;
        self.squeezed = None;
        self.offsets = Arc::default();
    }

    /// The layer without what only a layer right above may share.
    pub(super) fn without_inside(&self) -> Layer {
        Layer {
            inside: None,
            ..self.clone()
        }
    }

    /// The layer with solids of its own, whose grids are forgotten with it.
    /// `below` is the layer below, and a copy of it that was made like this.
    pub(super) fn copied(&self, below: Option<(&Layer, &Layer)>) -> Layer {
        let below = below.filter(|(own, _)| self.same_outline(own));
        let (outline, rough) = match below {
            Some((_, copy)) => (copy.outline.clone(), copy.rough.clone()),
            None => {
                let [outline, rough] = [&self.outline, &self.rough]
                    .map(|solid| Arc::new(solid.plain()));
                (outline, rough)
            }
        };
        Layer {
            outline,
            rough,
            risen: Arc::default(),
            ..self.clone()
        }
    }

    /// The outline that was found.
    pub(super) fn found(&self) -> &Area {
        self.unchanged.as_deref().unwrap_or(self.area())
    }

    /// The layer among others, the nearest first.
    pub(super) fn among<'l>(
        &'l self,
        below: impl IntoIterator<Item = &'l Layer>,
        above: impl IntoIterator<Item = &'l Layer>,
    ) -> LayerView<'l> {
        LayerView {
            here: self.face(),
            above: above.into_iter().map(Layer::face).collect(),
            below: below.into_iter().map(Layer::face).collect(),
        }
    }

    /// The layer as others see it.
    pub(super) fn face(&self) -> LayerFace<'_> {
        LayerFace {
            span: self.span,
            outline: &self.outline,
            rough: &self.rough,
            top: self.top(),
            risen: Some(&self.risen),
        }
    }

    /// What the layer above stands on.
    pub(super) fn top(&self) -> &Arc<Solid<'static>> {
        self.squeezed.as_ref().unwrap_or(&self.outline)
    }

    /// What holds the layer above the layer `below`, as far as seams care.
    pub(super) fn ground<'l>(&'l self, below: &'l Layer) -> Option<Ground<'l>> {
        Ground::of(self.face(), below.face())
    }

    /// Shares with the layer below whatever equals it.
    pub(super) fn share(&mut self, below: &Layer) {
        if below.area() == self.area() {
            self.outline = below.outline.clone();
            self.rough = below.rough.clone();
        }
    }

    /// True if the layer below has an equal outline.
    pub(super) fn same_outline(&self, below: &Layer) -> bool {
        self.outline.is(&below.outline)
    }

    /// True if the layer below has equal walls.
    pub(super) fn same(&self, below: &Layer) -> bool {
        let dh = below.span.height() - self.span.height();
        dh.abs() < SAME_HEIGHT
            && self.same_outline(below)
            && self.offsets.is_empty()
    }
}

/// Layer `i` and the layers around it.
pub(super) fn view(layers: &VecDeque<Layer>, i: usize) -> LayerView<'_> {
    layers[i].among(layers.range(..i).rev(), layers.range(i + 1..))
}

/// A layer of a part that has been filled, and its neighbours.
pub(super) struct Filled {
    pub layer: Layer,
    pub below: Option<Layer>,
    pub above: Option<Layer>,
    pub beads: LayerBeads,
    /// True if its skin has no beads yet, since it may get internal bridges.
    pub bare: bool,
    /// Number of beads of the infill that are left out, since they stand on
    /// nothing.
    pub left_out: usize,
    /// Where there is sparse infill.
    pub sparse: Solid<'static>,
    /// Skin and sparse area, if internal bridges may change them.
    pub areas: Option<FillAreas>,
    /// The top of its supports, if it can have some.
    pub support_top: Option<Top>,
    /// Where supports stand on it, if its beads follow the surface.
    pub under_support: Option<Solid<'static>>,
    /// Where supports hold it, if that matters for its walls.
    pub held: Option<Solid<'static>>,
    /// Area of gaps that nothing fills.
    pub gap: Mm2,
    /// How the layer lies over the layer below, if their outlines differ.
    pub look: Option<LayerOverhang>,
    /// The layer's accuracy, if it was measured.
    pub figures: Option<LayerFigures>,
}

impl Filled {
    /// The layer, and what is around it.
    pub(super) fn view(&self) -> LayerView<'_> {
        self.layer.among(&self.below, &self.above)
    }
}

/// A layer of the plate between two steps: what the last step has made of each
/// part that is in it, with the part's number.
pub(super) struct OnPlate<T> {
    pub span: LayerSpan,
    pub parts: Vec<(usize, T)>,
}

impl<T> OnPlate<T> {
    /// The layer with what the next step makes of each part.
    pub(super) fn after<U>(
        self,
        mut step: impl FnMut(usize, T) -> Made<U>,
    ) -> Made<OnPlate<U>> {
        let parts = self.parts.into_iter();
        let parts = parts.map(|(k, part)| Ok((k, step(k, part)?)));
        Ok(OnPlate {
            span: self.span,
            parts: parts.collect::<Result<_, SliceError>>()?,
        })
    }

    /// What there is of a part.
    pub(super) fn part(&self, part: usize) -> Option<&T> {
        let mut parts = self.parts.iter();
        parts.find(|(k, _)| *k == part).map(|(_, of_part)| of_part)
    }
}

//! What is known of a layer on its way through the stages.

use crate::contour::Outline;
use crate::layers::LayerSpan;
use crate::order::LayerBeads;
use crate::plane::Area;
use crate::plane::grid::EdgeGrid;
use crate::region::Walls;
use crate::region::compensate::Compensation;
use crate::region::cover::{Cover, Rough};
use crate::report::LayerFigures;
use crate::settings::Settings;
use crate::units::{Mm, Mm2};
use std::sync::Arc;

/// Heights closer than this differ by rounding only, mm.
const SAME_HEIGHT: Mm = 1e-9;

/// A layer whose outline is known. Layers that are the same as the one below,
/// as those of a prism are, share all of it.
#[derive(Clone)]
pub(super) struct Shell {
    pub span: LayerSpan,
    pub outline: Arc<Outline>,
    /// The true outline, if that is not the one to print.
    pub truth: Option<Arc<Outline>>,
    /// The outline again, for asking what is where.
    pub solid: Arc<EdgeGrid>,
    /// The outline as exact as skin needs it.
    pub rough: Arc<Rough>,
    /// The outlines of the offset fields, if walls are made of these.
    pub offsets: Arc<Vec<Area>>,
    /// What is inside, as long as a layer above may be the same.
    pub inside: Option<Arc<Inside>>,
}

/// What a layer's outline encloses.
pub(super) struct Inside {
    pub walls: Walls,
    /// What sparse infill fits into.
    pub roomy: Area,
}

impl Shell {
    /// Points of the outline.
    pub fn points(&self) -> usize {
        self.outline.area.rings.iter().map(Vec::len).sum()
    }

    /// What it covers of its neighbours.
    pub fn cover(&self) -> Cover<'_> {
        Cover {
            area: &self.outline.area,
            grid: &self.solid,
        }
    }

    /// As a neighbour of skin: what it leaves open may be rough, but lines
    /// change their role right at its edge.
    pub fn face(&self) -> Cover<'_> {
        Cover {
            area: &self.rough.area,
            grid: &self.solid,
        }
    }

    /// What the layer above will stand on, if that is not the outline: the
    /// plastic goes where the elephant's foot was taken from.
    pub fn squeezed(&self, settings: &Settings) -> Option<Area> {
        let truth = self.truth.as_ref()?;
        Compensation::new(&self.span, settings).squeezed(&truth.area)
    }

    /// The true outline.
    pub fn truth(&self) -> &Outline {
        self.truth.as_ref().unwrap_or(&self.outline)
    }

    /// Shares with the layer below what is the same.
    pub fn share(&mut self, below: &Shell) {
        if below.outline == self.outline && self.offsets.is_empty() {
            self.outline = below.outline.clone();
            self.solid = below.solid.clone();
            self.rough = below.rough.clone();
        }
    }

    /// True if the layer below has the same walls.
    pub fn same(&self, below: &Shell) -> bool {
        let dh = below.span.height() - self.span.height();
        dh.abs() < SAME_HEIGHT
            && Arc::ptr_eq(&self.outline, &below.outline)
            && self.offsets.is_empty()
    }
}

/// A layer that has been filled.
pub(super) struct Filled {
    pub beads: LayerBeads,
    /// Where there is sparse infill.
    pub sparse: Area,
    /// Area of gaps that nothing fills.
    pub gap: Mm2,
    /// How far it is off, if it was measured.
    pub figures: Option<LayerFigures>,
}

/// A layer that can be written, and its neighbours.
pub(super) struct Ready {
    pub shell: Shell,
    pub below: Option<Shell>,
    pub above: Option<Shell>,
    pub filled: Filled,
}

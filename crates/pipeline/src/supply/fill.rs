//! What there is to print in layers whose outlines are known.
//!
//! In: a window of layers. Out: some of them, filled, but for what depends on how
//! the layers below are filled. Layers with equal outlines have equal walls, which
//! are made once.

use super::super::SliceError;
use super::super::layer::{Filled, Inside, Layer, view};
use super::all_or_first;
use super::lower::Window;
use isoslice_base::parallel;
use isoslice_planar::Solid;
use std::ops::Range;
use std::sync::Arc;

/// Layers of a group, and the inside that they share, if they do.
pub(super) type FilledGroup = (Vec<Filled>, Option<Arc<Inside>>);

impl Window<'_> {
    /// Some layers of the window, in groups of layers that have equal walls.
    pub(super) fn alike(&self, which: Range<usize>) -> Vec<Range<usize>> {
        let mut groups: Vec<Range<usize>> = Vec::new();
        for i in which {
            match groups.last_mut() {
                Some(group) if self.layers[i].same(&self.layers[i - 1]) => {
                    group.end = i + 1;
                }
                _ => groups.push(i..i + 1),
            }
        }
        groups
    }

    /// Fills the layers of a group. The layers `written` are measured.
    pub(super) fn fill_group(
        &self,
        group: &Range<usize>,
        written: &Range<usize>,
    ) -> Result<FilledGroup, SliceError> {
        // The highest of several equal layers may be a top.
        let highest = view(self.layers, group.end - 1);
        let alike = group.end - usize::from(self.stages.divides(&highest));
        let first = group.start;
        let inside = self
            .known_inside(first)
            .or_else(|| (first < alike).then(|| Arc::new(self.inside(first))));
        let fill = |i: usize| match &inside {
            Some(inside) if i < alike => self.fill(i, inside, written),
            _ => self.fill(i, &self.inside(i), written),
        };
        let filled = parallel::map(group.len(), |k| fill(group.start + k));
        Ok((all_or_first(filled)?, inside))
    }

    /// The inside of a layer, if the layer or an equal one below knows it.
    fn known_inside(&self, i: usize) -> Option<Arc<Inside>> {
        let layer = &self.layers[i];
        let below = i.checked_sub(1).map(|k| &self.layers[k]);
        let below = below.filter(|below| layer.same(below));
        let of_below = || below.and_then(|below| below.inside.clone());
        layer.inside.clone().or_else(of_below)
    }

    fn inside(&self, i: usize) -> Inside {
        self.stages.inside(&self.layers[i], &view(self.layers, i))
    }

    /// Layer `i` of the window with its beads.
    fn fill(
        &self,
        i: usize,
        inside: &Inside,
        written: &Range<usize>,
    ) -> Result<Filled, SliceError> {
        let (stages, layer) = (self.stages, &self.layers[i]);
        let index = layer.span.index;
        let view = view(self.layers, i);
        let figures = if written.contains(&index) {
            stages.figures(layer, &inside.walls, index - written.start)?
        } else {
            None
        };
        let (mut beads, areas) = stages.beads(&view, inside)?;
        let bridges = stages.bridge_layers() > 0;
        if !bridges {
            beads.skin = stages.skin(&view, &areas);
        }
        let beside = |k: Option<usize>| {
            k.and_then(|k| self.layers.get(k))
                .map(Layer::without_inside)
        };
        let under_support = stages.on_which_supports_stand(&layer.span);
        Ok(Filled {
            layer: layer.without_inside(),
            below: beside(i.checked_sub(1)),
            above: beside(Some(i + 1)),
            beads,
            bare: bridges,
            left_out: 0,
            areas: bridges.then(|| areas.clone()),
            sparse: Solid::new(areas.sparse),
            support_top: stages.support_top(&layer.span),
            under_support: under_support.map(Solid::new),
            held: stages.held_by_support(index).map(Solid::new),
            look: stages.look(&view),
            gap: inside.walls.gap,
            figures,
        })
    }
}

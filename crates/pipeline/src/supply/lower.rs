//! What a layer's infill and skin lie on: the layer below.
//!
//! In: filled layers of a window, in order. Out: the same layers, without the
//! infill that stands on nothing, and with internal bridges in place of some
//! infill. Bridges end on beads that are printed, so both are decided layer by
//! layer from below.
//!
//! What a layer lies on depends on the layers below it, but not on many. A layer
//! under which no skin lies over infill, for as many layers as bridges may show,
//! depends on nothing below it, and if its infill stands by itself, no layer above
//! depends on anything below it, either. A run begins with such a layer: see
//! [`root`](super::root). Slopes have skin over infill in every layer. So every
//! [`CUT`] layers, the next layer lies on what a layer would be that has no
//! bridges.

use super::super::SliceError;
use super::super::layer::{Filled, Layer, view};
use super::super::stages::Stages;
use glam::DVec2;
use isoslice_base::timings::Stage;
use isoslice_layer::exposure::FillAreas;
use isoslice_layer::infill::standing::Standing;
use isoslice_layer::skin::internal_bridges::{Below, CELL, Level, Under};
use isoslice_path::order::LayerBeads;
use isoslice_planar::clip::union;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::{Area, Solid};
use rayon::ThreadPool;
use std::collections::VecDeque;

/// Number of layers after which a layer lies on one without bridges. Lines of
/// bridges may then end where a bridge below has taken the place of the line that
/// would hold them, so there should be few such layers; but a run that begins in the
/// middle of a slope has to fill up to so many layers below its first one.
const CUT: usize = 64;

/// The layer below the next one to be decided.
pub(super) struct Lower {
    /// The check of infill that may stand on nothing.
    standing: Option<Standing>,
    /// The layer, if internal bridges may lie on it.
    under: Option<Infilled>,
    /// Where its infill was before it had bridges.
    sparse: Option<Area>,
    /// Number of layers since the last one whose skin lies over infill.
    calm: usize,
}

/// Number of the lowest layer on which the bridges of layer `first` may depend.
pub(super) fn lowest(first: usize) -> usize {
    (first - first % CUT).saturating_sub(1)
}

/// True for a layer that the next one takes for one without bridges.
fn is_cut(number: usize) -> bool {
    (number + 1).is_multiple_of(CUT)
}

/// The layers that are known, and what is done with them.
pub(super) struct Window<'a> {
    pub stages: &'a Stages<'a>,
    pub pool: &'a ThreadPool,
    pub layers: &'a VecDeque<Layer>,
}

/// What beads of the next layer may lie on.
struct Infilled {
    /// Where the layer has sparse infill, and where it has nothing.
    open: Solid<'static>,
    infill: EdgeGrid,
    /// The lines of its walls and of its skin.
    shell: Vec<Vec<DVec2>>,
    levels: Vec<Below>,
}

impl Infilled {
    fn under(&self) -> Under<'_> {
        Under {
            area: &self.open,
            lines: &self.infill,
            shell: &self.shell,
        }
    }
}

impl Lower {
    /// Nothing, below the first layer of a run.
    pub(super) fn new(stages: &Stages<'_>) -> Lower {
        Lower {
            standing: stages.standing(),
            under: None,
            sparse: None,
            calm: 0,
        }
    }

    /// Where the layer has infill, as if it had no bridges.
    pub(super) fn infill(&self) -> Option<&Area> {
        self.sparse.as_ref()
    }

    /// Decides some layers, the first of which is layer `start` of the window.
    pub(super) fn settle(
        &mut self,
        window: &Window<'_>,
        start: usize,
        all: &mut [Filled],
    ) -> Result<(), SliceError> {
        for (k, filled) in all.iter_mut().enumerate() {
            let i = start + k;
            let number = window.layers[i].span.index;
            if window.stages.is_on_raft(number) {
                // All infill counts as standing on what is below it.
                self.standing.iter_mut().for_each(Standing::forget);
            }
            let beads = &mut filled.beads;
            let Some(mut areas) = filled.areas.take() else {
                let standing = self.standing.as_mut();
                filled.left_out = window.keep_standing(standing, beads);
                continue;
            };
            self.calm = if filled.bare { 0 } else { self.calm + 1 };
            let goes_on = self.calm < window.stages.bridge_layers();
            let bare = filled.bare;
            let plain = if is_cut(number) {
                let standing = self.standing.clone();
                Some(window.plain(i, bare, beads, &areas, standing)?)
            } else {
                None
            };
            self.sparse = Some(areas.sparse.clone());
            let under = self.under.as_ref().filter(|_| goes_on);
            let over = window.over(i, bare, beads, &mut areas, under)?;
            let standing = self.standing.as_mut();
            filled.left_out = window.keep_standing(standing, beads);
            let own = || over.infilled(beads, &areas.sparse);
            self.under = Some(plain.unwrap_or_else(own));
            filled.sparse = Solid::new(areas.sparse);
        }
        Ok(())
    }
}

/// What the next layer has to know of a layer's internal bridges.
#[derive(Default)]
struct Bridges {
    /// Where there is nothing, since nothing would hold a bridge.
    left: Area,
    levels: Vec<Level>,
}

impl Bridges {
    /// A layer of these beads that has these bridges.
    fn infilled(self, beads: &LayerBeads, sparse: &Area) -> Infilled {
        let infill = beads.infill.iter().map(|bead| bead.stroke.path());
        let beside = |level: Level| level.beside(&beads.infill);
        Infilled {
            open: Solid::new(union(sparse, &self.left)),
            infill: EdgeGrid::of_lines(infill, CELL),
            shell: beads
                .shell()
                .map(|bead| bead.stroke.path().collect())
                .collect(),
            levels: self.levels.into_iter().map(beside).collect(),
        }
    }
}

impl Window<'_> {
    /// Gives layer `i` of the window internal bridges over what is `under` it, in
    /// place of some of its beads, if there are any to be laid; else its skin, if
    /// that is `bare`.
    fn over(
        &self,
        i: usize,
        bare: bool,
        beads: &mut LayerBeads,
        areas: &mut FillAreas,
        under: Option<&Infilled>,
    ) -> Result<Bridges, SliceError> {
        let view = view(self.layers, i);
        let under = under.filter(|_| !areas.skin.is_empty());
        let made = self.pool.install(|| {
            let Some(below) = under else { return Ok(None) };
            let (walls, under) = (&beads.walls, below.under());
            self.stages.internal_bridges(
                &view,
                areas,
                walls,
                under,
                &below.levels,
            )
        })?;
        let Some(over) = made else {
            if bare {
                let lay = || self.stages.skin(&view, areas);
                beads.skin = self.pool.install(lay);
            }
            return Ok(Bridges::default());
        };
        beads.skin = over.skin;
        beads.infill = over.infill;
        areas.sparse = over.sparse;
        let (left, levels) = (over.left, over.levels);
        Ok(Bridges { left, levels })
    }

    /// Layer `i` of the window as if it had no bridges.
    fn plain(
        &self,
        i: usize,
        bare: bool,
        beads: &LayerBeads,
        areas: &FillAreas,
        mut standing: Option<Standing>,
    ) -> Result<Infilled, SliceError> {
        let (mut beads, mut areas) = (beads.clone(), areas.clone());
        let over = self.over(i, bare, &mut beads, &mut areas, None)?;
        self.keep_standing(standing.as_mut(), &mut beads);
        Ok(over.infilled(&beads, &areas.sparse))
    }

    /// Leaves out the infill of a layer that stands on nothing, and returns the
    /// number of its beads.
    fn keep_standing(
        &self,
        standing: Option<&mut Standing>,
        beads: &mut LayerBeads,
    ) -> usize {
        let Some(standing) = standing else {
            return 0;
        };
        let infill = std::mem::take(&mut beads.infill);
        let count = infill.len();
        beads.infill = self
            .stages
            .timings
            .time(Stage::Infill, || standing.kept(infill, beads.shell()));
        count - beads.infill.len()
    }
}

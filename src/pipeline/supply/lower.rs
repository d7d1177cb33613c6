//! What a layer's infill and skin lie on: the layer below.
//!
//! In: filled layers of a window, in order. Out: the same layers, without the
//! infill that stands on nothing, and with internal bridges in place of some
//! infill. Bridges end on beads that are printed, so both are decided layer by
//! layer from below.
//!
//! A run may begin with any block of layers. It then rehearses the few layers
//! below on which the block's bridges lie, and knows nothing of those below
//! them. So in each run, bridges at the beginning of a block lie on what a
//! rehearsal finds, and the layers that are rehearsed keep the infill that they
//! keep there.

use super::super::layer::{Filled, Layer, view};
use super::super::stages::Stages;
use super::super::{BLOCK, SliceError};
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

/// What the next layer lies on.
pub(super) struct Lower {
    /// True if a block of layers knows nothing of those below it.
    blocks: bool,
    /// The check of infill that may stand on nothing.
    standing: Option<Standing>,
    /// The layer that was filled last, if internal bridges may lie on it.
    under: Option<Infilled>,
    early: Option<Early>,
}

/// The layer that was filled last as a run finds it that begins with the next
/// block: the block's lowest layers lie on its infill in each run.
struct Early {
    standing: Option<Standing>,
    infilled: Infilled,
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
    /// Nothing, below the first layer of a run. `blocks` is true if the run may
    /// begin with any block.
    pub(super) fn new(stages: &Stages<'_>, blocks: bool) -> Lower {
        Lower {
            blocks,
            standing: stages.standing(),
            under: None,
            early: None,
        }
    }

    /// Where the layer that was decided last has nothing that is solid.
    pub(super) fn open(&self) -> Option<&Area> {
        self.under.as_ref().map(|under| under.open.area())
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
            if self.is_new(window, i) {
                self.standing.iter_mut().for_each(Standing::forget);
            }
            let beads = &mut filled.beads;
            let Some(mut areas) = filled.areas.take() else {
                let standing = self.standing.as_mut();
                filled.left_out = window.keep_standing(standing, beads);
                continue;
            };
            let bare = filled.bare;
            let from_block = self.early(window, i, bare, beads, &areas)?;
            let under = self.under.as_ref();
            let over = window.over(i, bare, beads, &mut areas, under)?;
            let standing = self.standing.as_mut();
            filled.left_out = window.keep_standing(standing, beads);
            let own = || over.infilled(beads, &areas.sparse);
            self.under = Some(from_block.unwrap_or_else(own));
            filled.sparse = Solid::new(areas.sparse);
        }
        Ok(())
    }

    /// True if all infill of layer `i` of the window counts as standing on what
    /// is below it.
    fn is_new(&self, window: &Window<'_>, i: usize) -> bool {
        let number = window.layers[i].span.index;
        let away = BLOCK - number % BLOCK;
        window.stages.is_on_raft(number)
            || self.blocks && away == BLOCK
            || away == window.stages.rehearsed_bridges()
    }

    /// What the next block's lowest layer lies on, if layer `i` of the window is
    /// right below it. It follows from the layers that a run rehearses which
    /// begins there, so their infill is as if nothing lay on what is below.
    /// `beads` and `areas` are the layer's, without bridges; `bare` is true if the
    /// skin has no beads.
    fn early(
        &mut self,
        window: &Window<'_>,
        i: usize,
        bare: bool,
        beads: &LayerBeads,
        areas: &FillAreas,
    ) -> Result<Option<Infilled>, SliceError> {
        let rehearsed = window.stages.rehearsed_bridges();
        let away = BLOCK - window.layers[i].span.index % BLOCK;
        if away > rehearsed {
            return Ok(None);
        }
        let (mut standing, below) = match self.early.take() {
            Some(early) if away < rehearsed => {
                (early.standing, Some(early.infilled))
            }
            _ => (window.stages.standing(), None),
        };
        let (mut beads, mut areas) = (beads.clone(), areas.clone());
        let over =
            window.over(i, bare, &mut beads, &mut areas, below.as_ref())?;
        window.keep_standing(standing.as_mut(), &mut beads);
        let infilled = over.infilled(&beads, &areas.sparse);
        if away == 1 {
            return Ok(Some(infilled));
        }
        self.early = Some(Early { standing, infilled });
        Ok(None)
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

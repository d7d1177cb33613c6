//! What a layer's infill and skin lie on: the infill of the layer below.
//!
//! In: filled layers of a window, in order. Out: the same layers, without the
//! infill that stands on nothing, and with internal bridges in place of some
//! infill. Bridges lie on the infill that is printed, or on the bridges there,
//! so both are decided layer by layer from below.
//!
//! A run may begin with any block of layers. It then rehearses the few layers
//! below on which the block's bridges lie, and knows nothing of those below
//! them. So in each run, bridges at the beginning of a block lie on what a
//! rehearsal finds, and the layers that are rehearsed keep the infill that they
//! keep there.

use super::super::layer::{Filled, Layer};
use super::super::stages::{OverInfill, Stages};
use super::super::{BLOCK, SliceError};
use crate::bead::Bead;
use crate::infill::standing::Standing;
use crate::plane::Solid;
use crate::plane::grid::EdgeGrid;
use crate::skin::over_infill::{Below, CELL, Level, Under};
use crate::timings::Stage;
use rayon::ThreadPool;
use std::collections::VecDeque;

/// What the next layer lies on.
pub(super) struct Lower {
    /// True if a block of layers knows nothing of those below it.
    blocks: bool,
    /// The check of infill that may stand on nothing.
    standing: Option<Standing>,
    /// The infill of the layer that was filled last, if internal bridges may
    /// lie on it.
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

/// A layer's sparse infill and its internal bridges, on which beads may lie.
struct Infilled {
    sparse: Solid<'static>,
    lines: EdgeGrid,
    levels: Vec<Below>,
}

impl Infilled {
    /// The infill of a filled layer.
    fn new(filled: &Filled, infill: &[Bead], levels: Vec<Level>) -> Infilled {
        let lines = infill.iter().map(|bead| bead.path());
        let beside = |level: Level| level.beside(filled.sparse.area(), infill);
        Infilled {
            sparse: filled.sparse.clone(),
            lines: EdgeGrid::of_lines(lines, CELL),
            levels: levels.into_iter().map(beside).collect(),
        }
    }

    fn under(&self) -> Under<'_> {
        Under {
            area: &self.sparse,
            sparse: &self.sparse,
            lines: &self.lines,
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

    /// Decides some layers, the first of which is layer `start` of the window.
    pub(super) fn settle(
        &mut self,
        window: &Window<'_>,
        start: usize,
        all: &mut [Filled],
    ) -> Result<(), SliceError> {
        let bridges = window.stages.bridges_infill();
        for (k, filled) in all.iter_mut().enumerate() {
            let i = start + k;
            if self.is_new(window, i) {
                self.standing.iter_mut().for_each(Standing::forget);
            }
            if !bridges {
                window.keep_standing(self.standing.as_mut(), filled);
                continue;
            }
            let from_block = self.early(window, i, filled)?;
            let over = window.over(i, filled, self.under.as_ref())?;
            let levels = over.map_or(Vec::new(), |over| {
                filled.beads.skin = over.skin;
                filled.beads.infill = over.infill;
                filled.sparse = Solid::new(over.sparse);
                over.levels
            });
            window.keep_standing(self.standing.as_mut(), filled);
            let own = || Infilled::new(filled, &filled.beads.infill, levels);
            self.under = from_block.or_else(|| Some(own()));
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
    fn early(
        &mut self,
        window: &Window<'_>,
        i: usize,
        filled: &Filled,
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
        let over = window.over(i, filled, below.as_ref())?;
        let levels = over.map_or(Vec::new(), |over| over.levels);
        let infill = filled.beads.infill.clone();
        let infill = window.standing_infill(standing.as_mut(), filled, infill);
        let infilled = Infilled::new(filled, &infill, levels);
        if away == 1 {
            return Ok(Some(infilled));
        }
        self.early = Some(Early { standing, infilled });
        Ok(None)
    }
}

impl Window<'_> {
    /// What internal bridges make of layer `i` of the window, if there are any.
    fn over(
        &self,
        i: usize,
        filled: &Filled,
        under: Option<&Infilled>,
    ) -> Result<Option<OverInfill>, SliceError> {
        let (Some(below), Some(areas)) = (under, &filled.areas) else {
            return Ok(None);
        };
        if areas.skin.is_empty() {
            return Ok(None);
        }
        let (layers, levels) = (self.layers, &below.levels);
        self.pool.install(|| {
            self.stages
                .over_infill(layers, i, areas, below.under(), levels)
        })
    }

    /// Leaves out the infill of a layer that stands on nothing.
    fn keep_standing(
        &self,
        standing: Option<&mut Standing>,
        filled: &mut Filled,
    ) {
        let infill = std::mem::take(&mut filled.beads.infill);
        let count = infill.len();
        let kept = self.standing_infill(standing, filled, infill);
        filled.left_out = count - kept.len();
        filled.beads.infill = kept;
    }

    /// What stands of some infill of a layer.
    fn standing_infill(
        &self,
        standing: Option<&mut Standing>,
        filled: &Filled,
        infill: Vec<Bead>,
    ) -> Vec<Bead> {
        let Some(standing) = standing else {
            return infill;
        };
        self.stages.timings.time(Stage::Infill, || {
            standing.kept(infill, filled.beads.shell())
        })
    }
}

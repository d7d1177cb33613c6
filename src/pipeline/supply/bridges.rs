//! Internal bridges, which lie on the sparse infill of the layer below or on
//! the bridges there: layer by layer from below.
//!
//! In: filled layers of a window, in order. Out: the same layers, with bridges
//! in place of some infill.

use super::super::layer::{Filled, Layer};
use super::super::stages::{OverInfill, Stages};
use super::super::{BLOCK, SliceError};
use crate::plane::Solid;
use crate::plane::grid::EdgeGrid;
use crate::skin::over_infill::{Below, CELL, Level, Under};
use rayon::ThreadPool;
use std::collections::VecDeque;

/// What internal bridges of the next layer lie on.
#[derive(Default)]
pub(super) struct Bridges {
    /// The infill of the layer that was filled last, if internal bridges may
    /// lie on it.
    under: Option<Infilled>,
    /// The infill of that layer as a run finds it that begins with the next
    /// block: the block's lowest layers lie on this infill in each run.
    early: Option<Infilled>,
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
    fn new(filled: &Filled, levels: Vec<Level>) -> Infilled {
        let infill = &filled.beads.infill;
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

impl Bridges {
    /// Lays internal bridges in some layers, the first of which is layer
    /// `start` of the window. They come one after the other: where bridges
    /// replace a layer's infill, the next layer lies on the bridges.
    pub(super) fn lay(
        &mut self,
        window: &Window<'_>,
        start: usize,
        all: &mut [Filled],
    ) -> Result<(), SliceError> {
        for (k, filled) in all.iter_mut().enumerate() {
            let i = start + k;
            let from_block = self.early(window, i, filled)?;
            let over = window.over(i, filled, self.under.as_ref())?;
            let levels = over.map_or(Vec::new(), |over| {
                filled.beads.skin = over.skin;
                filled.beads.infill = over.infill;
                filled.sparse = Solid::new(over.sparse);
                over.levels
            });
            let own = || Infilled::new(filled, levels);
            self.under = from_block.or_else(|| Some(own()));
        }
        Ok(())
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
        let below = if away == rehearsed {
            None
        } else {
            self.early.take()
        };
        let over = window.over(i, filled, below.as_ref())?;
        let levels = over.map_or(Vec::new(), |over| over.levels);
        self.early = Some(Infilled::new(filled, levels));
        Ok(if away == 1 { self.early.take() } else { None })
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
}

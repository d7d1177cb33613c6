//! Filled layers from below, made ahead of whoever writes them.
//!
//! In: the slabs of a part. Out: its layers in order, a few at a time, each
//! with the neighbours on which it depends. Only the window of layers on which
//! later layers depend is kept. So memory grows with the part's height only if it
//! has supports, whose plan is kept elsewhere.

use super::layer::{Filled, Inside, Layer, Ready};
use super::stages::{OverInfill, Stages};
use super::{BLOCK, SliceError};
use crate::layers::LayerSpan;
use crate::limits;
use crate::plane::Solid;
use crate::plane::grid::EdgeGrid;
use crate::skin::over_infill::{Below, CELL, Level, Under};
use rayon::ThreadPool;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::mpsc::sync_channel;
use std::thread;

/// Number of points of the outlines of layers that are filled together. Then
/// the layers are handed over, since their beads take several times the memory
/// of their outlines.
const BATCH_POINTS: usize = 50_000;

/// The layers of a run, in order.
pub(super) struct Supply<'a> {
    stages: &'a Stages<'a>,
    pool: &'a ThreadPool,
    /// The slabs that have not been sampled yet.
    slabs: VecDeque<&'a [LayerSpan]>,
    /// Layers whose outlines are needed.
    needed: Range<usize>,
    /// The layers to be written.
    layers: Range<usize>,
    /// Layers on which later layers depend.
    window: VecDeque<Layer>,
    /// Index of the layer that is filled next.
    next: usize,
    /// Index of the first layer that is handed over.
    first: usize,
    /// The infill of the layer that was filled last, if internal bridges may
    /// lie on it.
    under: Option<Infilled>,
    /// The infill of that layer as a run finds it that begins with the next
    /// block: the block's lowest layers lie on this infill in each run.
    early: Option<Infilled>,
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

impl<'a> Supply<'a> {
    /// A supply of `layers` of the part's `spans`, and of the layers of the
    /// same block before them.
    pub(super) fn new(
        stages: &'a Stages<'a>,
        pool: &'a ThreadPool,
        spans: &'a [LayerSpan],
        layers: Range<usize>,
    ) -> Self {
        // A slab is the unit in which the field is walked, so the division
        // must depend neither on the threads nor on the range.
        let needed = stages.needed(&layers, spans.len());
        let slab = stages.slab_layers();
        let slabs: Vec<&[LayerSpan]> = spans.chunks(slab).collect();
        let slabs = &slabs[needed.start / slab..needed.end.div_ceil(slab)];
        let first = layers.start - layers.start % BLOCK;
        // Internal bridges of the first layer lie on those below.
        let below = stages.rehearsed_bridges();
        Supply {
            stages,
            pool,
            slabs: slabs.iter().copied().collect(),
            needed,
            window: VecDeque::new(),
            next: first.saturating_sub(below),
            first,
            under: None,
            early: None,
            layers,
        }
    }

    /// The window's layers that can be filled: as few at a time as keep all
    /// threads at work.
    fn ready(&self) -> Range<usize> {
        // Roles depend on the next layer, whatever the skin's thickness.
        let hidden = if self.slabs.is_empty() {
            0
        } else {
            self.stages.reach_above()
        };
        let Some(first) = self.window.front().map(|s| s.span.index) else {
            return 0..0;
        };
        let from = self.next - first;
        let end = self.window.len().saturating_sub(hidden);
        let end = end.min(self.layers.end.saturating_sub(first));
        let mut points = 0;
        let fits = |&i: &usize| {
            let before = points;
            points += self.window[i]
                .area()
                .rings
                .iter()
                .map(Vec::len)
                .sum::<usize>();
            i < from + self.pool.current_num_threads() || before < BATCH_POINTS
        };
        from..from + (from..end).take_while(fits).count()
    }

    /// Finds the outlines of the next slabs, one for each thread.
    fn sample(&mut self) -> Result<(), SliceError> {
        let count = self.pool.current_num_threads().min(self.slabs.len());
        let slabs: Vec<&[LayerSpan]> = self.slabs.drain(..count).collect();
        let (stages, needed) = (self.stages, &self.needed);
        let made = self.pool.install(|| {
            let slabs = slabs.par_iter();
            slabs.map(|s| stages.layers(s, needed)).collect()
        });
        for mut layer in all_or_first(made)?.into_iter().flatten() {
            // Layers also share where one slab ends and the next begins.
            if let Some(below) = self.window.back() {
                layer.share(below);
            }
            self.window.push_back(layer);
        }
        Ok(())
    }

    /// Fills some layers of the window, and drops layers on which no later
    /// layer depends.
    fn fill(&mut self, which: Range<usize>) -> Batch {
        let mut batch = Vec::with_capacity(which.len());
        let filled = self.filled(which.clone())?;
        let near = |i: usize| {
            let layer = self.window.get(i)?;
            let inside = None;
            Some(Layer {
                inside,
                ..layer.clone()
            })
        };
        let count = which.len();
        for (i, filled) in which.zip(filled) {
            let Some(layer) = near(i) else { break };
            if layer.span.index < self.first {
                continue;
            }
            batch.push(Ready {
                layer,
                below: i.checked_sub(1).and_then(near),
                above: near(i + 1),
                filled,
            });
        }
        self.next += count;
        let keep = self.next.saturating_sub(self.stages.reach_below());
        while self.window.front().is_some_and(|s| s.span.index < keep) {
            self.window.pop_front();
        }
        Ok(batch)
    }

    /// What there is to print in some layers of the window.
    fn filled(
        &mut self,
        which: Range<usize>,
    ) -> Result<Vec<Filled>, SliceError> {
        let (stages, layers) = (self.stages, &self.window);
        // Layers with equal outlines are filled together.
        let mut groups: Vec<Range<usize>> = Vec::new();
        for i in which.clone() {
            match groups.last_mut() {
                Some(group) if layers[i].same(&layers[i - 1]) => {
                    group.end = i + 1;
                }
                _ => groups.push(i..i + 1),
            }
        }
        let fill = |i: usize, inside: &Inside| {
            let index = layers[i].span.index;
            let figures = if self.layers.contains(&index) {
                let k = index - self.layers.start;
                stages.figures(&layers[i], &inside.walls, k)?
            } else {
                None
            };
            let (beads, areas) = stages.beads(layers, i, inside)?;
            let bridges = stages.bridges_infill();
            Ok(Filled {
                beads,
                areas: bridges.then(|| areas.clone()),
                sparse: Solid::new(areas.sparse),
                support: stages.support_area(index).map(Solid::new),
                support_rise: stages.support_rise(&layers[i].span),
                under_support: stages
                    .on_which_supports_stand(&layers[i].span)
                    .map(Solid::new),
                held: stages.held_by_support(index).map(Solid::new),
                look: stages.look(layers, i),
                gap: inside.walls.gap,
                figures,
            })
        };
        let fill_group = |group: &Range<usize>| {
            let first = group.start;
            let below = first
                .checked_sub(1)
                .map(|k| &layers[k])
                .filter(|below| layers[first].same(below))
                .and_then(|below| below.inside.clone());
            // The highest of several equal layers may be a top.
            let alike =
                group.end - usize::from(stages.divides(layers, group.end - 1));
            let inside = below.or_else(|| {
                let alike = first < alike;
                alike.then(|| Arc::new(stages.inside(layers, first)))
            });
            let filled = group.clone().into_par_iter();
            let filled = filled.map(|i| match &inside {
                Some(inside) if i < alike => fill(i, inside),
                _ => fill(i, &stages.inside(layers, i)),
            });
            Ok((all_or_first(filled.collect())?, inside))
        };
        let done = self
            .pool
            .install(|| groups.par_iter().map(fill_group).collect());
        let mut all = Vec::new();
        for (group, (filled, inside)) in groups.iter().zip(all_or_first(done)?)
        {
            all.extend(filled);
            let last = &self.window[group.end - 1];
            let again = |above: &Layer| above.same(last);
            if self.window.get(group.end).is_none_or(again) {
                self.window[group.end - 1].inside = inside;
            }
        }
        if stages.bridges_infill() {
            self.bridge(which.start, &mut all)?;
        }
        Ok(all)
    }

    /// Lays internal bridges in some layers, the first of which is layer
    /// `start` of the window. They come one after the other: where bridges
    /// replace a layer's infill, the next layer lies on the bridges.
    fn bridge(
        &mut self,
        start: usize,
        all: &mut [Filled],
    ) -> Result<(), SliceError> {
        for (k, filled) in all.iter_mut().enumerate() {
            let i = start + k;
            let from_block = self.early(i, filled)?;
            let over = self.over(i, filled, self.under.as_ref())?;
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
}

impl Supply<'_> {
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
        let (layers, levels) = (&self.window, &below.levels);
        self.pool.install(|| {
            self.stages
                .over_infill(layers, i, areas, below.under(), levels)
        })
    }

    /// What the next block's lowest layer lies on, if layer `i` of the window is
    /// right below it. It follows from the layers that a run rehearses which
    /// begins there, so their infill is as if nothing lay on what is below.
    fn early(
        &mut self,
        i: usize,
        filled: &Filled,
    ) -> Result<Option<Infilled>, SliceError> {
        let rehearsed = self.stages.rehearsed_bridges();
        let away = BLOCK - self.window[i].span.index % BLOCK;
        if away > rehearsed {
            return Ok(None);
        }
        let below = if away == rehearsed {
            None
        } else {
            self.early.take()
        };
        let over = self.over(i, filled, below.as_ref())?;
        let levels = over.map_or(Vec::new(), |over| over.levels);
        self.early = Some(Infilled::new(filled, levels));
        Ok(if away == 1 { self.early.take() } else { None })
    }
}

/// All results, or the lowest layer's error: not that of the fastest thread.
fn all_or_first<T>(
    results: Vec<Result<T, SliceError>>,
) -> Result<Vec<T>, SliceError> {
    results.into_iter().collect()
}

/// Layers that are written together.
type Batch = Result<Vec<Ready>, SliceError>;

/// The layers of all parts of a plate, in order.
pub(super) struct Supplies<'a> {
    parts: Vec<OfPart<'a>>,
    /// Index of the layer that is handed over next.
    next: usize,
}

/// The layers of one part.
struct OfPart<'a> {
    supply: Supply<'a>,
    /// The layers that wait for other parts.
    waiting: VecDeque<Ready>,
    /// Index after the part's last layer.
    end: usize,
}

/// One layer of several of the plate's parts, each with the part's number.
pub(super) type OnPlate = Vec<(usize, Ready)>;

impl<'a> Supplies<'a> {
    /// The supplies of parts that each have their `spans`: `layers` of all of
    /// them, and the layers of the same block before these.
    pub(super) fn new(
        parts: impl IntoIterator<Item = (&'a Stages<'a>, &'a [LayerSpan])>,
        pool: &'a ThreadPool,
        layers: &Range<usize>,
    ) -> Self {
        let of_part = |(stages, spans): (&'a Stages<'a>, &'a [LayerSpan])| {
            let end = layers.end.min(spans.len());
            let supply = Supply::new(stages, pool, spans, layers.start..end);
            let waiting = VecDeque::new();
            OfPart {
                supply,
                waiting,
                end,
            }
        };
        Supplies {
            parts: parts.into_iter().map(of_part).collect(),
            next: layers.start - layers.start % BLOCK,
        }
    }

    /// Passes the layers to `write`. While it works on some layers the next
    /// ones are made, unless one thread has to do everything.
    ///
    /// # Errors
    /// The first error of the supplies or of `write`.
    pub(super) fn each(
        self,
        pool: &ThreadPool,
        mut write: impl FnMut(OnPlate) -> Result<(), SliceError>,
    ) -> Result<(), SliceError> {
        let mut write_all = |batches: &mut dyn Iterator<Item = PlateBatch>| {
            for batch in batches {
                batch?.into_iter().try_for_each(&mut write)?;
            }
            Ok(())
        };
        if pool.current_num_threads() == 1 {
            let mut batches = self;
            return write_all(&mut batches);
        }
        let watch = limits::Watch::current();
        thread::scope(|scope| {
            // Only as many layers wait as are being written.
            let (hand, batches) = sync_channel(0);
            let supply = thread::Builder::new().name("layers".into());
            let supply = supply
                .spawn_scoped(scope, move || {
                    limits::Watch::adopt(watch.as_ref());
                    for batch in self {
                        let failed = batch.is_err();
                        // Nobody takes the batch if writing has failed.
                        if hand.send(batch).is_err() || failed {
                            break;
                        }
                    }
                })
                .map_err(SliceError::LayersThread)?;
            let written = write_all(&mut batches.into_iter());
            match supply.join() {
                Ok(()) => written,
                Err(panic) => resume_unwind(panic),
            }
        })
    }

    /// Makes sure that every part that goes on has a layer waiting.
    fn fetch(&mut self) -> Result<(), SliceError> {
        for part in &mut self.parts {
            while part.end > self.next && part.waiting.is_empty() {
                match part.supply.next() {
                    Some(batch) => part.waiting.extend(batch?),
                    None => part.end = self.next,
                }
            }
        }
        Ok(())
    }

    /// The next layer, if every part that goes on has it waiting.
    fn take(&mut self) -> Option<OnPlate> {
        let next = self.next;
        let on = self.parts.iter().filter(|part| part.end > next);
        let (mut any, mut all) = (false, true);
        for part in on {
            any = true;
            all &= !part.waiting.is_empty();
        }
        if !any || !all {
            return None;
        }
        self.next += 1;
        let parts = self.parts.iter_mut().enumerate();
        let on = parts.filter(|(_, part)| part.end > next);
        let taken = on.filter_map(|(k, p)| Some((k, p.waiting.pop_front()?)));
        Some(taken.collect())
    }
}

/// Layers of a plate that are written together.
type PlateBatch = Result<Vec<OnPlate>, SliceError>;

impl Iterator for Supplies<'_> {
    type Item = PlateBatch;

    fn next(&mut self) -> Option<PlateBatch> {
        if let Err(error) = self.fetch() {
            return Some(Err(error));
        }
        let batch: Vec<OnPlate> = std::iter::from_fn(|| self.take()).collect();
        (!batch.is_empty()).then_some(Ok(batch))
    }
}

impl Iterator for Supply<'_> {
    type Item = Batch;

    fn next(&mut self) -> Option<Batch> {
        loop {
            let ready = self.ready();
            if !ready.is_empty() {
                return Some(self.fill(ready));
            }
            if self.slabs.is_empty() {
                return None;
            }
            if let Err(error) = self.sample() {
                return Some(Err(error));
            }
        }
    }
}

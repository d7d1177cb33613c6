//! The paths of one part's layers, from below. [`plate`] hands over those of several
//! parts, ahead of whoever writes them. `fill` lays beads. `lower` decides what depends
//! on the layer below: infill that stands on nothing, and internal bridges. `root`
//! finds how far below a run has to begin for that.
//!
//! In: the slabs of a part. Out: its layers in order, a few at a time. Only the
//! window of layers on which later layers depend is kept. So memory grows with the
//! part's height only if it has supports, whose plan is kept elsewhere.

mod fill;
mod glimpse;
mod lower;
pub(super) mod plate;
mod root;

use super::SliceError;
use super::job::Planned;
use super::layer::{Filled, Layer, view};
use super::options::Extent;
use super::part::{Counted, LayerEnd, PartPaths, Passed};
use super::stages::Stages;
use isoslice_base::limits;
use isoslice_base::parallel;
use isoslice_settings::layers::LayerSpan;
use lower::{Lower, Window};
use rayon::ThreadPool;
use std::collections::VecDeque;
use std::ops::Range;

/// Number of points of the outlines of layers that are filled together. Then
/// the layers are handed over, since their beads take several times the memory
/// of their outlines.
const BATCH_POINTS: usize = 50_000;

/// The layers of a run, in order.
pub(super) struct Supply<'a> {
    stages: &'a Stages<'a>,
    pool: &'a ThreadPool,
    /// The slabs that have not been sampled yet; for a glimpse these are single
    /// layers.
    slabs: VecDeque<&'a [LayerSpan]>,
    /// True if a single layer is made to be looked at.
    glimpse: bool,
    /// Layers whose outlines are needed.
    needed: Range<usize>,
    /// The layers to be written.
    layers: Range<usize>,
    /// Layers on which later layers depend.
    outlines: VecDeque<Layer>,
    /// Index of the layer that is filled next.
    next: usize,
    /// Index of the first layer that is handed over.
    first: usize,
    lower: Lower,
    /// What makes the layers' paths.
    paths: &'a PartPaths<'a>,
    /// Where the layer that was handed over last ends.
    end: LayerEnd,
}

impl<'a> Supply<'a> {
    /// A supply of a run's layers of a part.
    ///
    /// # Errors
    /// If the layers cannot be found on which the run's lowest one depends.
    pub(super) fn new(
        paths: &'a PartPaths<'a>,
        pool: &'a ThreadPool,
        extent: Extent,
    ) -> Result<Self, SliceError> {
        let Extent { made, glimpse, .. } = &extent;
        let stages = &paths.planned.stages;
        let root = if *glimpse {
            // These layers are made as if no bridges were below them. That is
            // near enough for a look at one layer.
            made.start.saturating_sub(stages.bridge_layers())
        } else {
            root::root(paths, pool, made.start)?
        };
        Supply::from(paths, pool, extent, root)
    }

    /// A supply that begins with the layer `root`, as if that had nothing below it
    /// on which internal bridges could lie.
    fn from(
        paths: &'a PartPaths<'a>,
        pool: &'a ThreadPool,
        extent: Extent,
        root: usize,
    ) -> Result<Self, SliceError> {
        let Extent {
            layers,
            made,
            glimpse,
        } = extent;
        let Planned { stages, spans, .. } = paths.planned;
        let needed = stages.needed(&(root..made.end), spans.len());
        let slabs = if glimpse {
            spans[needed.clone()].chunks(1).collect()
        } else {
            stages.slabs(spans, &needed)?
        };
        Ok(Supply {
            stages,
            pool,
            slabs: slabs.into(),
            glimpse,
            needed,
            outlines: VecDeque::new(),
            next: root,
            first: made.start,
            lower: Lower::new(stages),
            layers,
            paths,
            end: LayerEnd::default(),
        })
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
        let Some(first) = self.outlines.front().map(|s| s.span.index) else {
            return 0..0;
        };
        let from = self.next - first;
        let end = self.outlines.len().saturating_sub(hidden);
        let end = end.min(self.layers.end.saturating_sub(first));
        let mut points = 0;
        let fits = |&i: &usize| {
            let before = points;
            points += self.outlines[i]
                .area()
                .rings
                .iter()
                .map(Vec::len)
                .sum::<usize>();
            i < from + self.pool.current_num_threads() || before < BATCH_POINTS
        };
        from..from + (from..end).take_while(fits).count()
    }

    /// The window's layers that are to be filled next, once their outlines and those
    /// around them are known; none after the last one.
    fn found(&mut self) -> Result<Option<Range<usize>>, SliceError> {
        loop {
            let ready = self.ready();
            if !ready.is_empty() {
                return Ok(Some(ready));
            }
            if self.slabs.is_empty() {
                return Ok(None);
            }
            if self.glimpse {
                self.glimpse()?;
            } else {
                self.sample()?;
            }
        }
    }

    /// Finds the outlines of the next slabs, one for each thread.
    fn sample(&mut self) -> Result<(), SliceError> {
        let count = self.pool.current_num_threads().min(self.slabs.len());
        let slabs: Vec<&[LayerSpan]> = self.slabs.drain(..count).collect();
        let (stages, needed) = (self.stages, &self.needed);
        let made = parallel::map_in(self.pool, count, |i| {
            stages.layers(slabs[i], needed)
        });
        self.append(all_or_first(made)?.into_iter().flatten());
        Ok(())
    }

    /// Adds layers on top of the window.
    fn append(&mut self, layers: impl IntoIterator<Item = Layer>) {
        for mut layer in layers {
            // Layers also share where one slab ends and the next begins.
            if let Some(below) = self.outlines.back() {
                layer.share(below);
            }
            self.outlines.push_back(layer);
        }
    }

    /// Fills some layers of the window, and drops layers on which no later
    /// layer depends.
    fn fill(&mut self, which: Range<usize>) -> Batch {
        let (start, count) = (which.start, which.len());
        let mut batch = self.filled(which)?;
        self.settle(start, &mut batch)?;
        limits::go_on()?;
        batch.retain(|filled| filled.layer.span.index >= self.first);
        self.next += count;
        let keep = self.next.saturating_sub(self.stages.reach_below());
        while self.outlines.front().is_some_and(|s| s.span.index < keep) {
            self.outlines.pop_front();
        }
        let below = |layer: &&mut Layer| layer.span.index + 1 < self.next;
        self.outlines
            .iter_mut()
            .take_while(below)
            .for_each(Layer::sink);
        let (paths, end) = (self.paths, &mut self.end);
        all_or_first(self.pool.install(|| paths.layers(batch, end)))
    }

    /// What there is to print in some layers of the window, but for what `settle`
    /// decides.
    fn filled(
        &mut self,
        which: Range<usize>,
    ) -> Result<Vec<Filled>, SliceError> {
        let window = self.window();
        let groups = window.alike(which);
        let fill = |i: usize| window.fill_group(&groups[i], &self.layers);
        let done = parallel::map_in(self.pool, groups.len(), fill);
        let mut all = Vec::new();
        for (group, (filled, inside)) in groups.iter().zip(all_or_first(done)?)
        {
            all.extend(filled);
            let last = &self.outlines[group.end - 1];
            let again = |above: &Layer| above.same(last);
            if self.outlines.get(group.end).is_none_or(again) {
                self.outlines[group.end - 1].inside = inside;
            }
        }
        Ok(all)
    }

    fn window(&self) -> Window<'_> {
        Window {
            stages: self.stages,
            pool: self.pool,
            layers: &self.outlines,
        }
    }

    /// Decides what depends on the layers below, in some filled layers of which the
    /// first one is layer `start` of the window.
    fn settle(
        &mut self,
        start: usize,
        all: &mut [Filled],
    ) -> Result<(), SliceError> {
        self.lay_skin(start, all);
        let window = Window {
            stages: self.stages,
            pool: self.pool,
            layers: &self.outlines,
        };
        self.lower.settle(&window, start, all)
    }

    /// Lays the skin of those layers that do not lie over infill, on all threads.
    /// The first one is layer `start` of the window.
    fn lay_skin(&self, start: usize, all: &mut [Filled]) {
        let infill = |k: usize| match k.checked_sub(1) {
            Some(below) => all[below].areas.as_ref().map(|a| &a.sparse),
            None => self.lower.infill(),
        };
        let lay = |k: usize| {
            let areas = all[k].areas.as_ref()?;
            let bridges = |below| self.stages.may_bridge(areas, below);
            (!infill(k).is_some_and(bridges)).then(|| {
                self.stages.skin(&view(&self.outlines, start + k), areas)
            })
        };
        let laid = parallel::map_in(self.pool, all.len(), lay);
        for (filled, laid) in all.iter_mut().zip(laid) {
            if let Some(skin) = laid {
                filled.beads.skin = skin;
                filled.bare = false;
            }
        }
    }
}

/// All results, or the lowest layer's error: not that of the fastest thread.
fn all_or_first<T>(
    results: Vec<Result<T, SliceError>>,
) -> Result<Vec<T>, SliceError> {
    results.into_iter().collect()
}

/// Layers that are handed over together.
type Batch = Result<Vec<(Passed, Counted)>, SliceError>;

impl Iterator for Supply<'_> {
    type Item = Batch;

    fn next(&mut self) -> Option<Batch> {
        match self.found() {
            Ok(ready) => ready.map(|which| self.fill(which)),
            Err(error) => Some(Err(error)),
        }
    }
}

//! The layers of all parts of a plate, made ahead of whoever writes them.
//!
//! In: the supplies of the parts. Out: for each height the layers of all parts
//! that have one there, in order. While some are written, the next ones are
//! made on another thread.

use super::super::SliceError;
use super::super::layer::Ready;
use super::super::options::Extent;
use super::super::stages::Stages;
use super::Supply;
use crate::layers::LayerSpan;
use crate::limits;
use rayon::ThreadPool;
use std::collections::VecDeque;
use std::panic::resume_unwind;
use std::sync::mpsc::sync_channel;
use std::thread;

/// The layers of all parts of a plate, in order.
pub(in crate::pipeline) struct Supplies<'a> {
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
pub(in crate::pipeline) type OnPlate = Vec<(usize, Ready)>;

impl<'a> Supplies<'a> {
    /// The supplies of parts that each have their `spans`: the layers of a run of
    /// this extent.
    pub(in crate::pipeline) fn new(
        parts: impl IntoIterator<Item = (&'a Stages<'a>, &'a [LayerSpan])>,
        pool: &'a ThreadPool,
        extent: &Extent,
    ) -> Self {
        let of_part = |(stages, spans): (&'a Stages<'a>, &'a [LayerSpan])| {
            let end = extent.layers.end.min(spans.len());
            let extent = Extent {
                layers: extent.layers.start..end,
                made: extent.made.start..end,
                ..*extent
            };
            let supply = Supply::new(stages, pool, spans, extent);
            let waiting = VecDeque::new();
            OfPart {
                supply,
                waiting,
                end,
            }
        };
        Supplies {
            parts: parts.into_iter().map(of_part).collect(),
            next: extent.made.start,
        }
    }

    /// Passes the layers to `write`. While it works on some layers the next
    /// ones are made, unless one thread has to do everything.
    ///
    /// # Errors
    /// The first error of the supplies or of `write`.
    pub(in crate::pipeline) fn each(
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

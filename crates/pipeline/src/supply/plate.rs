//! The paths of all parts of a plate, made ahead of whoever writes them.
//!
//! In: the supplies of the parts. Out: for each height the layers of all parts
//! that have one there, in order. While some are written, the next ones are
//! made on another thread.

use super::super::SliceError;
use super::super::ahead::{Made, Threads};
use super::super::layer::OnPlate;
use super::super::options::Extent;
use super::super::part::{Counted, PartPaths, Passed};
use super::Supply;
use rayon::ThreadPool;
use std::collections::VecDeque;

/// The layers of all parts of a plate, in order.
pub(crate) struct Supplies<'a> {
    parts: Vec<OfPart<'a>>,
    /// Index of the layer that is handed over next.
    next: usize,
}

/// A layer's path, and what is counted of it.
pub(crate) type Laid = (Passed, Counted);

/// The layers of one part.
struct OfPart<'a> {
    supply: Supply<'a>,
    /// The layers that wait for other parts.
    waiting: VecDeque<Laid>,
    /// Index after the part's last layer.
    end: usize,
}

impl<'a> Supplies<'a> {
    /// The supplies of parts: the layers of a run of this extent.
    ///
    /// # Errors
    /// If the layers cannot be found on which a run's lowest one depends.
    pub(crate) fn new(
        parts: &'a [PartPaths<'a>],
        pool: &'a ThreadPool,
        extent: &Extent,
    ) -> Result<Self, SliceError> {
        let of_part = |paths: &'a PartPaths<'a>| {
            let count = paths.planned.spans.len();
            let end = extent.layers.end.min(count);
            let extent = Extent {
                layers: extent.layers.start..end,
                made: extent.made.start..end,
                ..*extent
            };
            Ok(OfPart {
                supply: Supply::new(paths, pool, extent)?,
                waiting: VecDeque::new(),
                end,
            })
        };
        Ok(Supplies {
            parts: parts
                .iter()
                .map(of_part)
                .collect::<Result<_, SliceError>>()?,
            next: extent.made.start,
        })
    }

    /// The layers, one by one. While some are used the next ones are made,
    /// unless one thread has to do everything.
    ///
    /// # Errors
    /// If the system has no thread to spare.
    pub(crate) fn ahead<'s>(
        self,
        pool: &ThreadPool,
        threads: &Threads<'s, '_>,
    ) -> Result<
        impl Iterator<Item = Made<OnPlate<Laid>>> + Send + use<'s>,
        SliceError,
    >
    where
        'a: 's,
    {
        let several = pool.current_num_threads() > 1;
        let batches = threads.ahead(several, "layers", self)?;
        Ok(batches.flat_map(|batch| match batch {
            Ok(layers) => layers.into_iter().map(Ok).collect(),
            Err(error) => vec![Err(error)],
        }))
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
    fn take(&mut self) -> Option<OnPlate<Laid>> {
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
        let parts: Vec<(usize, Laid)> = taken.collect();
        let span = parts.first()?.1.0.path.span;
        Some(OnPlate { span, parts })
    }
}

/// Layers of a plate that are handed over together.
type PlateBatch = Made<Vec<OnPlate<Laid>>>;

impl Iterator for Supplies<'_> {
    type Item = PlateBatch;

    fn next(&mut self) -> Option<PlateBatch> {
        if let Err(error) = self.fetch() {
            return Some(Err(error));
        }
        let batch: Vec<_> = std::iter::from_fn(|| self.take()).collect();
        (!batch.is_empty()).then_some(Ok(batch))
    }
}

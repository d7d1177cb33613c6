//! Notices a part of which hardly anything can be printed.
//!
//! In: a part in whose highest layer more than half is thinner than any line.
//! Out: an error if nearly all of a sample of the part is thinner than any
//! line. Finding all outlines of such sheets can take many minutes, and in the
//! end only scraps would be printed where the sheets lie flat.
//!
//! ```text
//!   ┌─────────┐   The sample consists of windows, each a piece of one layer,
//!   │ □     □ │   from the bottom to the top and all over the part's box. The
//!   │    □    │   window in the middle comes first: no other is needed for a
//!   │  □    □ │   part with a pointed top that is thick in the middle.
//!   └─────────┘
//! ```
//!
//! Guaranteed: the verdict depends on the part and on the settings only. A part
//! is not refused if most of its sample can be printed, or if its sample is
//! nearly empty.

use super::SliceError;
use glam::DVec2;
use isoslice_base::limits;
use isoslice_base::parallel;
use isoslice_base::units::{Mm, Mm2};
use isoslice_layer::walls::Walls;
use isoslice_planar::Rect;
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;
use std::ops::AddAssign;

/// Share of a layer's area that has to be thinner than any line for the sample
/// to be looked at.
const SUSPICIOUS: f64 = 0.5;
/// Share of the sample's area that has to be thinner than any line.
const THIN_SHARE: f64 = 0.9;
/// Number of windows that are tried, and number of windows that must have
/// something in them.
const WINDOWS: usize = 16;
const ENOUGH: usize = 4;
/// Greatest side of a window.
const SIDE: Mm = 25.0;
/// Shares by which a window's place differs from the last one's, along x, y and
/// z: powers of the plastic number's inverse, and of the golden section. They
/// spread any number of windows evenly.
const STEPS: [f64; 3] = [0.754_877_666, 0.569_840_291, 0.618_033_989];

/// What a nozzle can make of some of a part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Found {
    /// Area of the piece, and how much of it is thinner than any line.
    solid: Mm2,
    gap: Mm2,
    /// Islands and holes that are smaller than anything that can be printed.
    dropped: usize,
}

impl Found {
    /// What was found in a layer of that area, of which `dropped` rings were
    /// left out.
    pub(super) fn new(solid: Mm2, dropped: usize, walls: &Walls) -> Found {
        Found {
            solid,
            gap: walls.gap,
            dropped,
        }
    }

    pub(super) fn is_blank(&self) -> bool {
        self.solid <= 0.0 && self.dropped == 0
    }

    /// True if more than a share of the area is thinner than any line.
    fn is_thinner(&self, share: f64) -> bool {
        !self.is_blank() && self.gap >= share * self.solid
    }

    /// True if the rest of the part is worth a look.
    pub(super) fn is_suspicious(&self) -> bool {
        self.is_thinner(SUSPICIOUS)
    }
}

impl AddAssign for Found {
    fn add_assign(&mut self, other: Found) {
        self.solid += other.solid;
        self.gap += other.gap;
        self.dropped += other.dropped;
    }
}

/// The `k`th window: a share of the height, and a box.
fn window(k: usize, part: Rect) -> (f64, Rect) {
    let share = |axis: usize| (0.5 + k as f64 * STEPS[axis]).fract();
    let size = part.size().min(DVec2::splat(SIDE));
    let room = part.size() - size;
    let min = part.min + room * DVec2::new(share(0), share(1));
    let max = min + size;
    (share(2), Rect::new(min, max))
}

/// Looks at a sample of a part with the layers `spans` in the box `part`.
/// `found_in` tells what is in a window of a layer, and `line` is the thickness of
/// the thinnest place that gets a line.
///
/// # Errors
/// If hardly any of the sample can be printed, and the errors of `found_in`.
pub(super) fn sample(
    pool: &ThreadPool,
    part: Rect,
    spans: &[LayerSpan],
    line: Mm,
    found_in: impl Fn(Rect, &LayerSpan) -> Result<Found, SliceError> + Sync,
) -> Result<(), SliceError> {
    let look = |k: usize| -> Result<Found, SliceError> {
        limits::go_on()?;
        let (height, window) = window(k, part);
        let i = (height * spans.len() as f64) as usize;
        match spans.get(i) {
            Some(span) => Ok(found_in(window, span)?),
            None => Ok(Found::default()),
        }
    };
    let middle = pool.install(|| look(0))?;
    if !middle.is_blank() && !middle.is_suspicious() {
        return Ok(());
    }
    let rest = parallel::map_in(pool, WINDOWS - 1, |k| look(k + 1));
    let (mut all, mut looked) = (middle, usize::from(!middle.is_blank()));
    for found in rest {
        let found = found?;
        all += found;
        looked += usize::from(!found.is_blank());
    }
    if looked < ENOUGH || !all.is_thinner(THIN_SHARE) {
        return Ok(());
    }
    Err(SliceError::TooThin {
        looked,
        share: if all.solid > 0.0 {
            100.0 * all.gap / all.solid
        } else {
            100.0
        },
        line,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_all_over_the_part_and_inside() {
        let part = Rect::new(DVec2::new(-10.0, 5.0), DVec2::new(190.0, 15.0));
        let (height, middle) = window(0, part);
        assert_eq!(height, 0.5);
        assert!(
            (middle.min + middle.max - DVec2::new(180.0, 20.0)).length() < 1e-9
        );
        let mut seen = [[0; 4]; 2];
        for k in 0..WINDOWS {
            let (height, Rect { min, max }) = window(k, part);
            assert!(min.cmpge(part.min - 1e-9).all());
            assert!(max.cmple(part.max + 1e-9).all());
            assert!((max - min - DVec2::new(25.0, 10.0)).length() < 1e-9);
            seen[0][(height * 4.0) as usize] += 1;
            seen[1][((min.x + 10.0) / 175.0 * 4.0) as usize] += 1;
        }
        assert!(seen.iter().flatten().all(|n| *n >= 2), "{seen:?}");
    }
}

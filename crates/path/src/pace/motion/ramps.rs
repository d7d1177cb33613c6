//! Speeds along a chain of moves, and the time they take.
//!
//! In: segments, and the speeds that their corners allow. Out: the squares of
//! the speeds at which each starts, cruises and ends. This file has squares of
//! speeds only, since v² changes by 2·a·d along a move.

use super::{Planner, Segment};
use isoslice_base::units::{Mm, MmPerSec, MmPerSec2, Seconds};

/// Buffers for speeds, kept to save allocations.
#[derive(Clone, Debug, Default)]
pub(super) struct Ramps {
    /// Squares of the speeds at the segments' starts and at the last one's
    /// end.
    joints: Vec<f64>,
    /// Squares of the speeds at the joints with the gentler accelerations.
    gentle: Vec<f64>,
    /// Squares of the segments' cruising speeds.
    peaks: Vec<f64>,
}

impl Ramps {
    pub(super) fn plan(
        &mut self,
        segments: &[Segment],
        corner: &[f64],
        planner: &Planner,
        speed: impl Fn(&Segment) -> MmPerSec,
    ) {
        let Self {
            joints,
            gentle,
            peaks,
        } = self;
        peaks.clear();
        peaks.extend(segments.iter().map(|s| speed(s).powi(2)));
        let gain = |s: &Segment| 2.0 * s.length * s.acceleration;
        look_ahead(segments, corner, peaks, gain, planner.ahead(), joints);
        if planner.is_gentle() {
            look_ahead(segments, corner, peaks, gentle_gain, None, gentle);
            calm(segments, joints, gentle, peaks);
            for i in 1..segments.len() {
                joints[i] = joints[i].min(peaks[i - 1]).min(peaks[i]);
            }
        }
    }

    pub(super) fn times<'a>(
        &'a self,
        segments: &'a [Segment],
    ) -> impl Iterator<Item = Seconds> + 'a {
        segments
            .iter()
            .zip(&self.peaks)
            .zip(self.joints.windows(2))
            .map(|((s, &peak), ends)| {
                trapezoid(s.length, s.acceleration, ends[0], peak, ends[1])
            })
    }
}

fn gentle_gain(s: &Segment) -> f64 {
    2.0 * s.length * s.gentle
}

/// Squares of the speeds at the joints of the chain, `joints[i]` at the start
/// of segment i: as fast as corners and cruising speeds allow, and reachable
/// from rest at both ends of the chain. Firmware that knows only `ahead`
/// segments plans to be at rest after them.
fn look_ahead(
    segments: &[Segment],
    corner: &[f64],
    peaks: &[f64],
    gain: impl Fn(&Segment) -> f64,
    ahead: Option<usize>,
    joints: &mut Vec<f64>,
) {
    let n = segments.len();
    joints.clear();
    joints.resize(n + 1, 0.0);
    for i in (1..n).rev() {
        let limit = corner[i].min(peaks[i - 1]).min(peaks[i]);
        joints[i] = limit.min(joints[i + 1] + gain(&segments[i]));
    }
    // The speed that can be braked away on the known segments limits the
    // joints. Corners beyond them never allow less.
    let known = ahead.map_or(n, |ahead| ahead.min(n));
    let mut brake: f64 = segments.iter().take(known).map(&gain).sum();
    for i in 1..n {
        if ahead.is_some() {
            let next = segments.get(i - 1 + known).map_or(0.0, &gain);
            brake += next - gain(&segments[i - 1]);
            if i + known <= n {
                joints[i] = joints[i].min(brake.max(0.0));
            }
        }
        joints[i] = joints[i].min(joints[i - 1] + gain(&segments[i - 1]));
    }
}

/// Lowers the cruising speeds to what the gentler acceleration reaches. A run
/// of moves that only speed up and the run after it that only slow down share
/// the speed between them, as in Klipper's `LookAheadQueue.flush`.
fn calm(
    segments: &[Segment],
    joints: &[f64],
    gentle: &[f64],
    peaks: &mut [f64],
) {
    let mut peak = 0.0;
    // Number of moves after `i` that only slow down and wait for their peak.
    let mut slowing = 0;
    for i in (0..segments.len()).rev() {
        let (start, end) = (gentle[i], gentle[i + 1]);
        let gain = gentle_gain(&segments[i]);
        let reach = end + gain;
        // Sums of equal numbers may differ by rounding.
        let slack = 1e-9 * (start + reach);
        if start >= reach - slack {
            slowing += 1;
            continue;
        }
        if start + gain > end + slack || slowing > 0 {
            peak = 0.5 * (start + reach);
        }
        let full = 2.0 * segments[i].length * segments[i].acceleration;
        let top = 0.5 * (joints[i] + joints[i + 1] + full);
        let own = peaks[i].min(top).min(peak);
        peaks[i] = own;
        // Each of these moves cruises no faster than the one before it.
        let mut before = own;
        for j in i + 1..=i + slowing {
            before = before.min(joints[j]).min(peaks[j]);
            peaks[j] = before;
        }
        slowing = 0;
    }
    // After rest a move always speeds up first.
    debug_assert_eq!(slowing, 0);
}

/// Time of a move of `length` whose speeds at start, cruise and end have the
/// squares `start`, `cruise` and `end`. If the cruising speed cannot be
/// reached, the move has a peak instead.
fn trapezoid(
    length: Mm,
    acceleration: MmPerSec2,
    start: f64,
    cruise: f64,
    end: f64,
) -> Seconds {
    let top = 0.5 * (start + end) + acceleration * length;
    let peak = cruise.min(top).max(start).max(end);
    let v = peak.sqrt();
    let ramps = (2.0 * v - start.sqrt() - end.sqrt()) / acceleration;
    let cruised = length - (2.0 * peak - start - end) / (2.0 * acceleration);
    ramps + cruised.max(0.0) / v
}

//! Layers between borders that have to be hit.
//!
//! Between two borders, layers are stacked from the lower one on, each as high
//! as a share of the limit allows. The share is the one with which the last
//! layer ends at the upper border. The end of the stack grows steadily with the
//! share, as the limit has no steps, so bisection finds it. Then the tops are
//! rounded to whole digits of the G-code, and no layer is rounded beyond the
//! limit.

use super::DIGITS;
use super::limit::Limit;
use isoslice_base::units::Mm;
use isoslice_settings::layers::{MAX_LAYERS, PlanError};

/// Greatest ratio of neighbouring layers above the first. Layers that differ by
/// more are made more alike.
const RATIO: f64 = 1.5;
/// Greatest number of rounds in which layers are made more alike.
const ROUNDS: usize = 12;
/// A gap to a border that is smaller than this needs no further layer, mm.
const ARRIVED: Mm = 1e-6;

/// The tops of the layers above the first border, in whole digits. Each layer is
/// within the limit, and there is a top at each border, to half a digit.
///
/// # Errors
/// If the layers are too many.
pub(super) fn stack(
    borders: &[Mm],
    mut limit: Limit,
) -> Result<Vec<Mm>, PlanError> {
    let mut best: Option<(f64, Vec<Mm>)> = None;
    for _ in 0..ROUNDS {
        let mut tops = Vec::new();
        let mut lowered = Vec::new();
        for pair in borders.windows(2) {
            let share = fill(pair[0], pair[1], &limit, &mut tops)?;
            lowered.push((pair[0], pair[1], share));
        }
        let first = borders.first().copied().unwrap_or(0.0);
        let ratio = roughness(first, &tops);
        if best.as_ref().is_none_or(|(least, _)| ratio < *least) {
            best = Some((ratio, tops));
        }
        if ratio <= RATIO {
            break;
        }
        limit.lower(&lowered);
    }
    Ok(best.map(|(_, tops)| tops).unwrap_or_default())
}

/// The greatest ratio of neighbouring layers.
fn roughness(first: Mm, tops: &[Mm]) -> f64 {
    let bottoms = std::iter::once(first).chain(tops.iter().copied());
    let heights: Vec<Mm> = tops
        .iter()
        .zip(bottoms)
        .map(|(top, bottom)| top - bottom)
        .collect();
    let ratio = |w: &[Mm]| w[0].max(w[1]) / w[0].min(w[1]);
    heights.windows(2).map(ratio).fold(1.0, f64::max)
}

/// Stacks layers from one border to the next one; returns the share of the
/// limit that they take.
///
/// All tops have whole digits. With `n` layers, the top of layer k may be
/// anywhere from `least[k]`, from which on the border can still be reached, up
/// to where the limit ends a layer on the one below. Within that, it is as near
/// as may be to where the share would have it.
fn fill(
    from: Mm,
    to: Mm,
    limit: &Limit,
    tops: &mut Vec<Mm>,
) -> Result<f64, PlanError> {
    let to = (to * DIGITS).round() / DIGITS;
    let mut count = 0;
    let mut z = from;
    while z < to - ARRIVED {
        let next = end(limit, z);
        count += 1;
        if tops.len() + count > MAX_LAYERS || next <= z {
            return Err(PlanError::TooMany {
                count: (tops.len() + count) as f64,
                layer: next - z,
            });
        }
        z = next;
    }
    let after = |share: f64| (0..count).fold(from, |z, _| limit.end(z, share));
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if after(middle) < to {
            low = middle
        } else {
            high = middle
        }
    }
    let mut least = vec![to; count + 1];
    for k in (1..count).rev() {
        least[k] = begin(limit, least[k + 1]);
    }
    let (mut wished, mut z) = (from, from);
    for &least in &least[1..] {
        wished = limit.end(wished, high);
        let nearest = (wished * DIGITS).round() / DIGITS;
        z = nearest.min(end(limit, z)).min(to).max(least);
        tops.push(z);
    }
    Ok(high)
}

/// Where the highest layer that begins at `z` ends, in whole digits.
fn end(limit: &Limit, z: Mm) -> Mm {
    /// Share of a digit that is the rounding of a float.
    const ROUNDING: f64 = 1e-6;
    (limit.end(z, 1.0) * DIGITS + ROUNDING).floor() / DIGITS
}

/// The lowest height, in whole digits, at which a layer may begin that reaches
/// up to `top`. The limit's layers end the higher the higher they begin.
fn begin(limit: &Limit, top: Mm) -> Mm {
    let digits = (top * DIGITS).round();
    let (mut short, mut reaches) = (1.0, 0.0);
    while end(limit, (digits - short) / DIGITS) >= top - ARRIVED {
        (reaches, short) = (short, 2.0 * short);
    }
    while short - reaches > 1.0 {
        let middle = (0.5 * (short + reaches)).floor();
        if end(limit, (digits - middle) / DIGITS) >= top - ARRIVED {
            reaches = middle
        } else {
            short = middle
        }
    }
    (digits - reaches) / DIGITS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(of: impl Fn(Mm) -> Mm, top: Mm) -> Limit {
        let bins: Vec<Mm> = (0..(top / 0.01).ceil() as usize)
            .map(|i| of(0.01 * (i as f64 + 0.5)))
            .collect();
        Limit::new(0.0, 0.01, &bins)
    }

    #[test]
    fn every_border_is_hit_and_neighbours_are_alike() {
        let borders = [0.2, 1.03, 1.21, 4.0, 4.9, 11.777];
        let of = |z: Mm| if z > 3.0 && z < 6.0 { 0.1 } else { 0.3 };
        let tops = stack(&borders, limit(of, 12.0)).unwrap();
        for border in &borders[1..] {
            assert!(tops.contains(border), "{border}");
        }
        assert!(roughness(0.2, &tops) <= RATIO, "{tops:?}");
        let mut bottom = 0.2;
        for top in tops {
            let most = of(bottom + 1e-9).min(of(top - 1e-9));
            assert!(top - bottom <= most + 1e-9, "{bottom} {top}");
            bottom = top;
        }
    }

    #[test]
    fn a_layer_too_many_is_an_error() {
        let tops = stack(&[0.2, 2000.0], limit(|_| 0.02, 1.0));
        assert!(matches!(tops, Err(PlanError::TooMany { .. })));
    }
}

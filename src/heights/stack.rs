//! Layers between borders that have to be hit.
//!
//! Between two borders, layers are stacked from the lower one on, each as high
//! as a share of the limit allows. The share is the one with which the last
//! layer ends at the upper border. The end of the stack grows steadily with the
//! share, as the limit has no steps, so bisection finds it.

use super::limit::Limit;
use crate::layers::{MAX_LAYERS, PlanError};
use crate::units::Mm;

/// Greatest ratio of neighbouring layers above the first. Layers that differ by
/// more are made more alike.
const RATIO: f64 = 1.5;
/// Greatest number of rounds in which layers are made more alike.
const ROUNDS: usize = 12;
/// A gap to a border that is smaller than this needs no further layer, mm.
const ARRIVED: Mm = 1e-6;

/// The tops of the layers above the first border. Each layer is within the
/// limit, and there is a top at each border.
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
fn fill(
    from: Mm,
    to: Mm,
    limit: &Limit,
    tops: &mut Vec<Mm>,
) -> Result<f64, PlanError> {
    let mut count = 0;
    let mut z = from;
    while z < to - ARRIVED {
        let next = limit.end(z, 1.0);
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
    let mut z = from;
    for k in 1..=count {
        z = if k == count { to } else { limit.end(z, low) };
        tops.push(z);
    }
    Ok(high)
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

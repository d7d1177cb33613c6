//! Patterns of straight lines: families of parallels, each in its direction.
//!
//! Where the density varies, the lines of a family keep the places that they
//! have in solid fill. Line i is there where the share to be filled is more
//! than the line's threshold, 0.b₀b₁b₂… in binary where …b₂b₁b₀ are the digits
//! of i (van der Corput 1935). Any share p then takes the share p of the lines,
//! and the widest gap between them is twice the narrowest. As the share grows,
//! each line begins where its threshold is passed. No line moves, so there are
//! no steps.
//!
//! ```text
//!   0 ────────────────────────     share   ▁▁▂▂▃▃▄▄▅▅▆▆▇▇██
//!   4            ─────────────
//!   2      ───────────────────
//!   6               ──────────
//!   1   ──────────────────────     (a line's number, and its threshold
//!                                   from left to right)
//! ```

use super::grading::Grading;
use super::{Density, Layer};
use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::border::LinePiece;
use isoslice_planar::hatch::{Lines, hatch_border};

/// Parallel lines, all over the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Family {
    /// Direction of the lines, from the pattern's direction.
    pub turn: Degrees,
    /// How far the lines are moved across their direction, to the left.
    pub shift: Mm,
}

/// The pieces of a layer's families of lines, for any density. The families
/// share the density evenly: at an even density the lines of each are
/// `families.len()` times as far apart as those of one family alone would be.
pub(super) fn lines(layer: &Layer<'_>, families: &[Family]) -> Vec<LinePiece> {
    let densest = families.len() as f64 * layer.solid;
    let mut pieces = Vec::new();
    for family in families {
        let angle = layer.angle + family.turn;
        let across = DVec2::from_angle(angle.to_radians()).perp();
        let shift = across.dot(layer.origin) + family.shift;
        let lines = |spacing: Mm| Lines {
            angle,
            spacing,
            phase: shift,
        };
        match layer.density {
            Density::Even(share) => {
                let lines = lines(densest / share);
                let all = hatch_border(layer.border, lines, layer.shortest);
                pieces.extend(all.into_iter().map(|p| p.1));
            }
            Density::Graded(grading) => {
                let lines = lines(densest);
                let all = hatch_border(layer.border, lines, layer.shortest);
                for (row, piece) in all {
                    thresholded(row, piece, layer, grading, &mut pieces);
                }
            }
        }
    }
    pieces
}

/// A line's threshold. The line is there if the share to be filled is more than
/// this.
pub(super) fn threshold(row: i64) -> f64 {
    /// Digits that count: as many as are exact. A line whose digits are all 1, such as
    /// the one of number −1, would have 1 or a half as its threshold if these were
    /// rounded, and solid fill would lack it.
    const DIGITS: u32 = f64::MANTISSA_DIGITS;
    // The digits of negative numbers go on to the left: two's complement.
    let digits = (row as u64).reverse_bits() >> (u64::BITS - DIGITS);
    digits as f64 / 2.0_f64.powi(DIGITS as i32)
}

/// The parts of a line's piece where the share passes the line's threshold.
fn thresholded(
    row: i64,
    piece: LinePiece,
    layer: &Layer<'_>,
    grading: &Grading,
    pieces: &mut Vec<LinePiece>,
) {
    let limit = threshold(row);
    let [a, b] = piece.points[..] else { return };
    let count = (a.distance(b) / (0.5 * grading.step())).ceil().max(1.0);
    let at = |k: usize| a.lerp(b, k as f64 / count);
    let above = |p: DVec2| grading.share(p) - limit;
    let mut start = (above(a) > 0.0).then_some((a, piece.from));
    let mut push = |from: (DVec2, _), to: (DVec2, _)| {
        if from.0.distance(to.0) >= layer.shortest {
            pieces.push(LinePiece {
                points: vec![from.0, to.0],
                closed: false,
                from: from.1,
                to: to.1,
            });
        }
    };
    let (mut p, mut f) = (a, above(a));
    for k in 1..=count as usize {
        let q = if k == count as usize { b } else { at(k) };
        let g = above(q);
        if (f > 0.0) != (g > 0.0) {
            let place = (p.lerp(q, f / (f - g)), None);
            match start.take() {
                Some(from) => push(from, place),
                None => start = Some(place),
            }
        }
        (p, f) = (q, g);
    }
    if let Some(from) = start {
        push(from, (b, piece.to));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solid_fill_has_all_lines_and_half_of_it_each_other_one() {
        for row in -5000..5000 {
            assert!(threshold(row) < 1.0, "{row}");
            assert_eq!(threshold(row) < 0.5, row % 2 == 0, "{row}");
            assert_eq!(threshold(row) < 0.25, row % 4 == 0, "{row}");
        }
    }

    #[test]
    fn a_share_takes_that_share_of_the_lines() {
        for share in [0.1, 0.25, 0.37, 0.5, 0.8] {
            for first in [-4096, -1000, 0, 777] {
                let rows: Vec<i64> = (first..first + 4096)
                    .filter(|&i| threshold(i) < share)
                    .collect();
                let part = rows.len() as f64 / 4096.0;
                assert!((part - share).abs() < 0.004, "{part}");
                let gaps = rows.windows(2).map(|r| r[1] - r[0]);
                let (least, most) =
                    gaps.fold((i64::MAX, 0), |(a, b), g| (a.min(g), b.max(g)));
                assert!(most <= 2 * least, "{share}: {least} to {most}");
            }
        }
    }
}

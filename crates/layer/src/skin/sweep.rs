//! The rules of a monotonic order: a line is printed after the lines beside it
//! in the row before.
//!
//! ```text
//!    4 ─────────   5 ──────   a row may be in pieces, and each piece only
//!    2 ────   3 ───────────   waits for what it lies beside: no line is
//!    1 ────────────────────   printed between two older ones
//! ```

use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::bead::Stroke;

/// For each line the lines that it has to wait for. The lines come in the order
/// of their rows. Two lines whose ends are nearer than `width` count as beside
/// each other.
pub(super) fn after(
    lines: &[(i64, Stroke)],
    angle: Degrees,
    width: Mm,
) -> Vec<Vec<u32>> {
    let along = DVec2::from_angle(angle.to_radians());
    let spans: Vec<(f64, f64)> = lines
        .iter()
        .map(|(_, line)| {
            let at = line.points.iter().map(|p| along.dot(*p));
            at.fold((f64::INFINITY, f64::NEG_INFINITY), |s, u| {
                (s.0.min(u), s.1.max(u))
            })
        })
        .collect();
    let mut after = Vec::with_capacity(lines.len());
    // The row before: its first line, and the first line behind the row.
    let (mut before, mut start) = (0..0, 0);
    for (i, (row, _)) in lines.iter().enumerate() {
        if i > 0 && *row != lines[i - 1].0 {
            before = if lines[i - 1].0 + 1 == *row {
                start..i
            } else {
                0..0
            };
            start = i;
        }
        let (a, b) = spans[i];
        let beside = before
            .clone()
            .filter(|&k| spans[k].0 < b + width && spans[k].1 > a - width);
        after.push(beside.map(|k| k as u32).collect());
    }
    after
}

/// For each line those beside it that it has to wait for if lines are laid from those
/// that are `held` outwards: the ones with fewer lines between them and a held one.
/// `beside` is what [`after`] found.
pub(super) fn outwards(beside: &[Vec<u32>], held: &[bool]) -> Vec<Vec<u32>> {
    let n = held.len();
    let mut near: Vec<Vec<u32>> = vec![Vec::new(); n];
    for (i, before) in beside.iter().enumerate() {
        for &k in before {
            near[i].push(k);
            near[k as usize].push(i as u32);
        }
    }
    let mut far: Vec<Option<u32>> =
        held.iter().map(|h| h.then_some(0)).collect();
    let mut next: Vec<usize> = (0..n).filter(|&i| held[i]).collect();
    let mut done = 0;
    while let Some(&i) = next.get(done) {
        done += 1;
        for &k in &near[i] {
            let k = k as usize;
            if far[k].is_none() {
                far[k] = far[i].map(|far| far + 1);
                next.push(k);
            }
        }
    }
    let waits = |i: usize| {
        let mut all = near[i].clone();
        all.retain(|&k| {
            far[k as usize].zip(far[i]).is_some_and(|(k, i)| k < i)
        });
        all
    };
    (0..n).map(waits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_wait_for_what_is_beside_them() {
        let line = |row: i64, from: f64, to: f64| {
            let points = [from, to].map(|x| DVec2::new(x, row as f64));
            let line = Stroke::new(points.to_vec(), false, 0.4);
            (row, line)
        };
        // A hole in rows 1 and 2; row 4 is not beside any other.
        let lines = [
            line(0, 0.0, 10.0),
            line(1, 0.0, 4.0),
            line(1, 6.0, 10.0),
            line(2, 0.0, 4.0),
            line(2, 6.0, 10.0),
            line(4, 0.0, 10.0),
        ];
        let none: Vec<u32> = Vec::new();
        assert_eq!(
            after(&lines, 0.0, 0.4),
            [none.clone(), vec![0], vec![0], vec![1], vec![2], none]
        );
    }
}

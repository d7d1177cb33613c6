//! Orders lines that wait for others. Each comes after those that it waits for.
//! Otherwise the nearest end comes first.

use super::jobs::finish;
use super::nearest::Nearest;
use glam::DVec2;
use isoslice_layer::skin::Fill;
use isoslice_planar::bead::Bead;

/// Prints a fill whose lines wait for one another.
pub(super) fn print(fill: Fill, at: &mut Option<DVec2>, out: &mut Vec<Bead>) {
    let Fill {
        lines,
        after,
        one_way,
    } = fill;
    let mut waits: Vec<usize> = after.iter().map(Vec::len).collect();
    let mut next: Vec<Vec<usize>> = vec![Vec::new(); lines.len()];
    for (i, before) in after.iter().enumerate() {
        for &k in before {
            next[k as usize].push(i);
        }
    }
    let ends = |b: &Bead| {
        let points = &b.stroke.points;
        (points.first().copied(), points.last().copied())
    };
    let mut lines: Vec<Option<Bead>> = lines.into_iter().map(Some).collect();
    let mut free = Nearest::new(std::iter::empty());
    let add = |free: &mut Nearest, line: &Option<Bead>, i: usize| {
        if let Some((Some(a), Some(b))) = line.as_ref().map(ends) {
            free.push(a, 2 * i);
            if one_way.get(i) != Some(&true) {
                free.push(b, 2 * i + 1);
            }
        }
    };
    for (i, line) in lines.iter().enumerate() {
        if waits[i] == 0 {
            add(&mut free, line, i);
        }
    }
    while let Some(end) = free.pop(*at) {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let Some(mut bead) = lines[end / 2].take() else {
            continue;
        };
        if end % 2 == 1 {
            bead.stroke.reverse();
        }
        finish(bead, at, out);
        for &i in &next[end / 2] {
            waits[i] -= 1;
            if waits[i] == 0 {
                add(&mut free, &lines[i], i);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::{Role, Stroke};

    #[test]
    fn no_line_is_printed_between_two_older_ones() {
        // Rows 0 to 9 around a hole in rows 3 to 6: 14 lines.
        let line = |y: f64, from: f64, to: f64| {
            Bead::new(
                Role::TopSkin,
                Stroke::new(
                    vec![DVec2::new(from, y), DVec2::new(to, y)],
                    false,
                    0.45,
                ),
                0.2,
            )
        };
        let mut lines: Vec<Bead> = Vec::new();
        let mut after: Vec<Vec<u32>> = Vec::new();
        let mut before: Vec<u32> = Vec::new();
        for row in 0..10 {
            let spans: &[(f64, f64)] = match row {
                3..=6 => &[(0.0, 4.0), (6.0, 10.0)],
                _ => &[(0.0, 10.0)],
            };
            let mut here = Vec::new();
            for (k, &(from, to)) in spans.iter().enumerate() {
                here.push(lines.len() as u32);
                lines.push(line(f64::from(row), from, to));
                after.push(match (before.len(), spans.len()) {
                    (2, 2) => vec![before[k]],
                    _ => before.clone(),
                });
            }
            before = here;
        }
        let mut at = Some(DVec2::new(5.0, 9.5));
        let mut out = Vec::new();
        let fill = Fill {
            lines,
            after,
            one_way: Vec::new(),
        };
        print(fill, &mut at, &mut out);
        assert_eq!(out.len(), 14);
        for (i, b) in out.iter().enumerate() {
            for older in &out[..i] {
                let x = |b: &Bead| {
                    let (p, q) = (b.stroke.points[0].x, b.stroke.points[1].x);
                    (p.min(q), p.max(q))
                };
                let beside = x(b).0 < x(older).1 && x(older).0 < x(b).1;
                assert!(
                    !beside || older.stroke.points[0].y <= b.stroke.points[0].y
                );
            }
        }
        // Row by row to and fro: the way between them is short.
        let way: f64 = out
            .windows(2)
            .map(|w| w[0].stroke.points[1].distance(w[1].stroke.points[0]))
            .sum();
        assert!(way < 25.0, "{way}");
    }
}

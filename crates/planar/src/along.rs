//! Lengths along a line.

use glam::DVec2;
use isoslice_base::units::Mm;

/// The point at a length along a line; none if the line is shorter.
pub fn point_at(
    line: impl IntoIterator<Item = DVec2>,
    length: Mm,
) -> Option<DVec2> {
    let mut left = length;
    let mut before: Option<DVec2> = None;
    for p in line {
        if let Some(from) = before {
            let step = from.distance(p);
            if left <= step {
                let share = left / step.max(f64::MIN_POSITIVE);
                return Some(from.lerp(p, share));
            }
            left -= step;
        }
        before = Some(p);
    }
    None
}

/// The part of a line up to a length along it, and the rest. The rest is empty
/// if the line is not longer.
pub fn parted(
    line: impl IntoIterator<Item = DVec2>,
    length: Mm,
) -> [Vec<DVec2>; 2] {
    let mut left = length;
    let (mut part, mut rest) = (Vec::<DVec2>::new(), Vec::new());
    for p in line {
        if !rest.is_empty() {
            rest.push(p);
            continue;
        }
        if let Some(&from) = part.last() {
            let step = from.distance(p);
            if step > left {
                let cut = from.lerp(p, left / step);
                part.push(cut);
                rest.extend([cut, p]);
                continue;
            }
            left -= step;
        }
        part.push(p);
    }
    [part, rest]
}

/// Two places on the way from one place to another, no farther apart than
/// `exact`, between which an answer changes. `same` is true where the answer is
/// that at the beginning; it is false at the end.
pub fn change(
    mut from: DVec2,
    mut to: DVec2,
    exact: Mm,
    same: impl Fn(DVec2) -> bool,
) -> [DVec2; 2] {
    while from.distance(to) > exact {
        let middle = from.midpoint(to);
        if same(middle) {
            from = middle
        } else {
            to = middle
        }
    }
    [from, to]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path_length;

    #[test]
    fn a_change_is_found_where_it_is() {
        let [p, q] = change(DVec2::ZERO, DVec2::X, 0.01, |p| p.x < 0.3);
        assert!(p.x < 0.3 && q.x >= 0.3 && q.x - p.x <= 0.01, "{p} {q}");
    }

    #[test]
    fn the_parts_of_a_line_meet_at_the_length() {
        let line = [(0.0, 0.0), (0.0, 0.0), (4.0, 0.0), (4.0, 3.0)];
        let line = line.map(DVec2::from);
        for k in 0..28 {
            let length = 0.25 * f64::from(k);
            let [part, rest] = parted(line, length);
            let at = point_at(line, length).unwrap();
            assert_eq!([part.last(), rest.first()], [Some(&at); 2]);
            assert_eq!(path_length(&part, false), length);
            assert_eq!(path_length(&rest, false), 7.0 - length);
        }
        assert_eq!(point_at(line, 7.0), Some(line[3]));
        assert_eq!(parted(line, 7.0), [line.to_vec(), Vec::new()]);
        assert_eq!(point_at(line, 7.1), None);
        // A line without length has a point at 0, one without edges has none.
        assert_eq!(point_at([line[0]; 2], 0.0), Some(line[0]));
        assert_eq!(point_at([line[0]], 0.0), None);
    }
}

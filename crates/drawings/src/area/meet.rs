//! Where pieces of outlines meet.

use crate::curve::Curve;
use crate::tree::Tree;
use glam::DVec2;
use isocontour::Rect;
use isoslice_base::problem::{Problem, go_on};

/// The most pairs of pieces that are looked at.
const MOST_PAIRS: usize = 4_000_000;

/// The most pairs of parts of two pieces. Two pieces that cross take some
/// hundred; those that lie on one another take any number, and are cut where
/// the ends of either are.
const MOST_PARTS: usize = 1500;

/// The most pairs of parts of all pieces. They take half a minute.
const MOST_ALL_PARTS: usize = 500_000_000;

/// The most places where pieces meet.
const MOST_MEETINGS: usize = 1 << 21;

/// Parameters of each piece at which it meets another, rising.
///
/// # Errors
/// If there are too many, or work was stopped.
pub(super) fn meetings(
    pieces: &[Curve],
    tree: &Tree,
    flat: f64,
) -> Problem<Vec<Vec<f64>>> {
    let mut at: Vec<Vec<f64>> = vec![Vec::new(); pieces.len()];
    let (mut pairs, mut found, mut parts) = (0, 0, 0);
    for (i, a) in pieces.iter().enumerate() {
        go_on()?;
        let bounds = a.bounds().grown(flat);
        let mut near = Vec::new();
        let meets = |b: &Rect| pairs < MOST_PAIRS && b.meets(bounds);
        tree.each(meets, |j| {
            if j > i {
                near.push(j);
            }
        });
        pairs += near.len() + 1;
        for j in near {
            let b = &pieces[j];
            let before = found;
            parts += cross(a, b, flat, |s, t| {
                at[i].push(s);
                at[j].push(t);
                found += 1;
            });
            if found - before > 64 {
                // They lie on one another.
                let extra = found - before;
                let keep = at[i].len() - extra;
                at[i].truncate(keep);
                let keep = at[j].len() - extra;
                at[j].truncate(keep);
                found = before;
            }
            for p in [b.start(), b.end()] {
                at[i].extend(touches(a, p, flat));
            }
            for p in [a.start(), a.end()] {
                at[j].extend(touches(b, p, flat));
            }
        }
        if pairs >= MOST_PAIRS
            || found > MOST_MEETINGS
            || parts > MOST_ALL_PARTS
        {
            return Err(
                "its outlines cross one another too often; unite them \
                        (Inkscape: Path > Union)"
                    .into(),
            );
        }
    }
    for (piece, at) in pieces.iter().zip(&mut at) {
        tidy(piece, at, flat);
    }
    Ok(at)
}

/// Sorts parameters, and leaves out those that are at an end or double.
fn tidy(piece: &Curve, at: &mut Vec<f64>, flat: f64) {
    at.sort_by(f64::total_cmp);
    let (start, end) = (piece.start(), piece.end());
    let far = 4.0 * flat;
    let mut last = start;
    at.retain(|t| {
        let p = piece.at(*t);
        let keep = (0.0..1.0).contains(t)
            && (p - last).length() > far
            && (p - end).length() > far;
        if keep {
            last = p;
        }
        keep
    });
}

/// The parameter at which a point lies on a piece, if it does within `flat`,
/// and not at its ends.
fn touches(piece: &Curve, p: DVec2, flat: f64) -> Option<f64> {
    if p == piece.start()
        || p == piece.end()
        || piece.bounds().distance2(p) > flat * flat
    {
        return None;
    }
    let t = if piece.degree() == 1 {
        let way = piece.end() - piece.start();
        (p - piece.start()).dot(way) / way.length_squared()
    } else {
        super::nearest::Piece::new(*piece).nearest(p).1
    };
    let near = (piece.at(t) - p).length() <= flat;
    near.then_some(t)
}

/// A part of a piece, with its parameters.
#[derive(Clone, Copy)]
struct Part {
    curve: Curve,
    from: f64,
    size: f64,
}

impl Part {
    fn halves(&self) -> [Part; 2] {
        let [a, b] = self.curve.split(0.5);
        let size = 0.5 * self.size;
        [
            Part {
                curve: a,
                from: self.from,
                size,
            },
            Part {
                curve: b,
                from: self.from + size,
                size,
            },
        ]
    }
}

/// Calls a function with the parameters at which two pieces cross. Returns how
/// many pairs of parts were looked at.
fn cross(
    a: &Curve,
    b: &Curve,
    flat: f64,
    mut f: impl FnMut(f64, f64),
) -> usize {
    let part = |curve: &Curve| Part {
        curve: *curve,
        from: 0.0,
        size: 1.0,
    };
    let mut todo = vec![(part(a), part(b))];
    let mut parts = 0;
    while let Some((a, b)) = todo.pop() {
        if !a.curve.bounds().meets(b.curve.bounds()) {
            continue;
        }
        parts += 1;
        if lies_beside(&a.curve, &b.curve, flat)
            || lies_beside(&b.curve, &a.curve, flat)
        {
            continue;
        }
        if parts > MOST_PARTS {
            // They nearly lie on one another. What is wrong of a part's side
            // is wrong of a thirty-second of the piece at most.
            (1..32).map(|i| f64::from(i) / 32.0).for_each(|t| f(t, t));
            break;
        }
        if a.curve.bow() <= flat && b.curve.bow() <= flat {
            if let Some((s, t)) = of_lines(&a.curve, &b.curve) {
                f(a.from + s * a.size, b.from + t * b.size);
            }
            continue;
        }
        // The longer one, also if it is straight: many parts of a curve are
        // in the box around a long line.
        let length = |c: &Curve| c.bounds().size().length_squared();
        if length(&a.curve) >= length(&b.curve) {
            todo.extend(a.halves().map(|half| (half, b)));
        } else {
            todo.extend(b.halves().map(|half| (a, half)));
        }
    }
    parts
}

/// True if a curve is to one side of another one's chord, and farther from it than
/// that one's bow. The boxes around two curves that are both slant meet long
/// after that.
fn lies_beside(curve: &Curve, other: &Curve, flat: f64) -> bool {
    let (from, way) = (other.start(), other.end() - other.start());
    let off = |curve: &Curve| {
        let off = curve.control().iter().map(|p| way.perp_dot(*p - from));
        off.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], off| {
            [a.min(off), b.max(off)]
        })
    };
    let ([least, most], [right, left]) = (off(other), off(curve));
    let gap = flat * way.length();
    right > most + gap || left < least - gap
}

/// Where two chords cross.
fn of_lines(a: &Curve, b: &Curve) -> Option<(f64, f64)> {
    let (u, v) = (a.end() - a.start(), b.end() - b.start());
    let across = u.perp_dot(v);
    let between = b.start() - a.start();
    let s = between.perp_dot(v) / across;
    let t = between.perp_dot(u) / across;
    let on = |t: f64| (-1e-9..=1.0 + 1e-9).contains(&t);
    (on(s) && on(t)).then(|| (s.clamp(0.0, 1.0), t.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A long line that crosses a curve at a small angle.
    #[test]
    fn slant_crossings_are_found() {
        let mut random = fastrand::Rng::with_seed(2);
        let mut point = || DVec2::new(random.f64(), random.f64()) * 100.0;
        for k in 0..1000 {
            let a = Curve::new(&[point(), point(), point(), point()]);
            let t = f64::from(k) / 1000.0;
            let (p, along) = (a.at(t), a.way(t).rotate(DVec2::new(1.0, 0.02)));
            let b = Curve::new(&[p - 50.0 * along, p + 37.0 * along]);
            let mut near = false;
            let parts = cross(&a, &b, 1e-8, |s, _| {
                near |= (a.at(s) - p).length() < 1e-5;
            });
            assert!(near && parts < 500, "{k} {parts}");
        }
    }
}

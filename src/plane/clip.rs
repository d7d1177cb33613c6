//! Booleans of areas, by the clipper2 library.
//!
//! Coordinates go through a grid of 10 nm (clipper works in integers, which
//! is what makes it robust); results are exact to that grid. Overlapping rings of an operand are merged
//! (non-zero winding).

use super::{Area, Ring};
use clipper2_rust::core::{FillRule, Path64, Paths64, Point64};
use clipper2_rust::engine::ClipType;
use clipper2_rust::engine_public::Clipper64;
use glam::DVec2;

/// Grid steps per millimetre. A metre is then 10⁸ steps, whose products stay
/// well inside what clipper multiplies without losing digits that matter.
const GRID: f64 = 1e5;

/// What is in either area.
pub fn union(a: &Area, b: &Area) -> Area {
    if a.is_empty() {
        return b.clone();
    }
    if b.is_empty() {
        return a.clone();
    }
    run(ClipType::Union, &[a], &[b])
}

/// What is in the first but not in the second area.
pub fn difference(a: &Area, b: &Area) -> Area {
    if a.is_empty() || b.is_empty() {
        return a.clone();
    }
    run(ClipType::Difference, &[a], &[b])
}

/// What is in both areas.
pub fn intersection(a: &Area, b: &Area) -> Area {
    if a.is_empty() || b.is_empty() {
        return Area::EMPTY;
    }
    run(ClipType::Intersection, &[a], &[b])
}

/// What is in `a` but not in all of `covers`: the part of `a` that at least
/// one of them leaves open. One sweep for any number of covers.
pub fn not_covered_by_all(a: &Area, covers: &[&Area]) -> Area {
    if a.is_empty() || covers.is_empty() {
        return Area::EMPTY;
    }
    if covers.iter().any(|c| c.is_empty()) {
        return a.clone();
    }
    // Reversing a cover's rings and drawing a box around everything makes
    // its complement; overlapping complements are united by the winding
    // rule, so that the intersection of the covers is never built.
    let frame = covers.iter().fold(a.bounds(), |r, c| r.union(c.bounds()));
    let (lo, hi) = (frame.min - 1.0, frame.max + 1.0);
    let border = vec![
        DVec2::new(lo.x, lo.y),
        DVec2::new(hi.x, lo.y),
        DVec2::new(hi.x, hi.y),
        DVec2::new(lo.x, hi.y),
    ];
    let mut open = Vec::new();
    for cover in covers {
        open.push(to_path(&border));
        open.extend(cover.rings.iter().map(|r| {
            let mut p = to_path(r);
            p.reverse();
            p
        }));
    }
    let mut clipper = Clipper64::new();
    clipper.add_subject(&to_paths(a));
    clipper.add_clip(&open);
    let (mut closed, mut lines) = (Paths64::new(), Paths64::new());
    clipper.execute(
        ClipType::Intersection,
        FillRule::NonZero,
        &mut closed,
        Some(&mut lines),
    );
    from_paths(closed)
}

/// The rings' union, whatever their winding.
pub fn unite(area: &Area) -> Area {
    sweep(area, FillRule::NonZero)
}

/// What rings that overlap wind around more often to the left than to the
/// right: how the loops of an offset border cancel.
pub(super) fn positive(area: &Area) -> Area {
    sweep(area, FillRule::Positive)
}

fn sweep(area: &Area, rule: FillRule) -> Area {
    let mut clipper = Clipper64::new();
    clipper.add_subject(&to_paths(area));
    let (mut closed, mut lines) = (Paths64::new(), Paths64::new());
    clipper.execute(ClipType::Union, rule, &mut closed, Some(&mut lines));
    from_paths(closed)
}

fn run(kind: ClipType, subjects: &[&Area], clips: &[&Area]) -> Area {
    let mut clipper = Clipper64::new();
    for a in subjects {
        clipper.add_subject(&to_paths(a));
    }
    for a in clips {
        clipper.add_clip(&to_paths(a));
    }
    let (mut closed, mut lines) = (Paths64::new(), Paths64::new());
    clipper.execute(kind, FillRule::NonZero, &mut closed, Some(&mut lines));
    from_paths(closed)
}

fn to_paths(area: &Area) -> Paths64 {
    area.rings.iter().map(|r| to_path(r)).collect()
}

fn to_path(ring: &[DVec2]) -> Path64 {
    ring.iter()
        .map(|p| {
            Point64::new(
                (p.x * GRID).round() as i64,
                (p.y * GRID).round() as i64,
            )
        })
        .collect()
}

fn from_paths(paths: Paths64) -> Area {
    let ring = |p: Path64| -> Ring {
        p.iter()
            .map(|q| DVec2::new(q.x as f64, q.y as f64) / GRID)
            .collect()
    };
    Area {
        rings: paths.into_iter().map(ring).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Area {
        let r = vec![
            DVec2::new(x0, y0),
            DVec2::new(x1, y0),
            DVec2::new(x1, y1),
            DVec2::new(x0, y1),
        ];
        Area { rings: vec![r] }
    }

    #[test]
    fn booleans_of_rectangles() {
        let (a, b) = (rect(0.0, 0.0, 4.0, 4.0), rect(2.0, 0.0, 6.0, 4.0));
        assert_eq!(union(&a, &b).content(), 24.0);
        assert_eq!(difference(&a, &b).content(), 8.0);
        assert_eq!(intersection(&a, &b).content(), 8.0);
        let hole = difference(&a, &rect(1.0, 1.0, 2.0, 2.0));
        assert_eq!(hole.rings.len(), 2);
        assert_eq!(hole.content(), 15.0);
    }

    #[test]
    fn uncovered_is_the_union_over_the_covers() {
        let a = rect(0.0, 0.0, 10.0, 10.0);
        let left = rect(-1.0, -1.0, 7.0, 11.0);
        let right = rect(2.0, -1.0, 11.0, 11.0);
        let open = not_covered_by_all(&a, &[&left, &right]);
        assert!((open.content() - 50.0).abs() < 1e-6);
        assert!(not_covered_by_all(&a, &[&a, &a]).content() < 1e-6);
        assert_eq!(not_covered_by_all(&a, &[&left, &Area::EMPTY]), a);
    }
}

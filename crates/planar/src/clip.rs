//! Booleans of areas, by the i_overlay library.
//!
//! Coordinates are rounded to a grid of 10 nm: the library works in integers,
//! which makes it robust. Results are exact to that grid. Overlapping rings of
//! an operand are merged (non-zero winding).
//!
//! Why not clipper2: its sweep touches every edge in a row at every vertex,
//! which on a lattice with many covers takes several times as long.

use super::joined::{Cut, joined};
use super::{Area, Rect, Ring, edges};
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;

/// Grid steps per millimetre: the library's 30 bits hold ten metres.
const GRID: f64 = 1e5;

type Contour = Vec<IntPoint<i32>>;

/// What is in either area.
pub fn union(a: &Area, b: &Area) -> Area {
    if a.is_empty() {
        return b.clone();
    }
    if b.is_empty() {
        return a.clone();
    }
    run(OverlayRule::Union, a, b)
}

/// What is in the first but not in the second area.
pub fn difference(a: &Area, b: &Area) -> Area {
    if a.is_empty() || b.is_empty() {
        return a.clone();
    }
    run(OverlayRule::Difference, a, b)
}

/// What is in both areas.
pub fn intersection(a: &Area, b: &Area) -> Area {
    if a.is_empty() || b.is_empty() {
        return Area::EMPTY;
    }
    run(OverlayRule::Intersect, a, b)
}

/// What is in `a` but not in all of `covers`: the part of `a` that at least
/// one of them leaves open. One sweep for any number of covers, unless they
/// have so many edges that it is cut into parts. Then islands of the result may
/// touch each other along the cuts.
pub fn not_covered_by_all(a: &Area, covers: &[&Area]) -> Area {
    if a.is_empty() || covers.is_empty() {
        return Area::EMPTY;
    }
    if covers.iter().any(|c| c.is_empty()) {
        return a.clone();
    }
    let count =
        edge_count(a) + covers.iter().map(|c| edge_count(c)).sum::<usize>();
    let bounds = a.bounds();
    if count <= SWEEP_EDGES || bounds.size().max_element() < 1.0 {
        return open(a, covers);
    }
    let mut rings = Vec::new();
    for half in halves(bounds).0 {
        let mut a = crop(&a.rings, half);
        // Along the cut a cropped ring runs to and fro.
        a = sweep(&a, FillRule::NonZero);
        let covers: Vec<Area> =
            covers.iter().map(|c| crop(&c.rings, half)).collect();
        let covers: Vec<&Area> = covers.iter().collect();
        rings.extend(not_covered_by_all(&a, &covers).rings);
    }
    Area { rings }
}

/// Edges beyond which a sweep is cut into two. The library takes some 300 bytes
/// for each edge.
const SWEEP_EDGES: usize = 80_000;

/// The lower and the upper half of a box, and the cut across its longer side.
fn halves(all: Rect) -> ([Rect; 2], Cut) {
    let (mut low, mut high) = (all, all);
    let (size, middle) = (all.size(), all.centre());
    // The middle is put on the grid, so that both sides round the cut alike.
    // Adding zero makes −0 a plain 0.
    let middle = (middle * GRID).round() / GRID + 0.0;
    let axis = usize::from(size.x <= size.y);
    let at = middle[axis];
    (low.max[axis], high.min[axis]) = (at, at);
    ([low, high], Cut { axis, at })
}

/// What at least one of the covers leaves open, in one sweep.
fn open(a: &Area, covers: &[&Area]) -> Area {
    // Reversing a cover's rings and drawing a box around everything makes its
    // complement. The winding rule unites overlapping complements, so that the
    // intersection of the covers is never built.
    let frame = covers.iter().fold(a.bounds(), |r, c| r.union(c.bounds()));
    let border = frame.grown(1.0).corners();
    let mut overlay = Overlay::new(edge_count(a) + 4 * covers.len());
    add(&mut overlay, a, ShapeType::Subject);
    for cover in covers {
        overlay.add_contour(&to_contour(&border), ShapeType::Clip);
        for ring in &cover.rings {
            let mut contour = to_contour(ring);
            contour.reverse();
            overlay.add_contour(&contour, ShapeType::Clip);
        }
    }
    from_shapes(overlay.overlay(OverlayRule::Intersect, FillRule::NonZero))
}

/// What some rings have within a box, up to its border. Rings that leave the
/// box run along its sides, perhaps to and fro, with the same winding inside.
/// This is much cheaper than an intersection (Sutherland and Hodgman 1974).
pub fn crop<'a>(all: impl IntoIterator<Item = &'a Ring>, to: Rect) -> Area {
    let mut rings = Vec::new();
    for ring in all {
        let bounds = Rect::around(ring);
        if bounds.max.cmplt(to.min).any() || bounds.min.cmpgt(to.max).any() {
            continue;
        }
        if to.contains(bounds.min) && to.contains(bounds.max) {
            rings.push(ring.clone());
            continue;
        }
        let sides = [
            (DVec2::X, to.max.x),
            (DVec2::Y, to.max.y),
            (DVec2::NEG_X, -to.min.x),
            (DVec2::NEG_Y, -to.min.y),
        ];
        let mut ring = ring.clone();
        for (normal, limit) in sides {
            ring = cut(&ring, normal, limit);
        }
        if ring.len() >= 3 {
            rings.push(ring);
        }
    }
    Area { rings }
}

/// The ring without what lies beyond `limit` in the direction of `normal`.
fn cut(ring: &[DVec2], normal: DVec2, limit: f64) -> Ring {
    let mut kept = Ring::with_capacity(ring.len() + 4);
    for (a, b) in edges(ring) {
        let (da, db) = (limit - normal.dot(a), limit - normal.dot(b));
        if da >= 0.0 {
            kept.push(a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            kept.push(a.lerp(b, da / (da - db)));
        }
    }
    kept
}

/// The rings' union, whatever their winding.
pub fn unite(area: &Area) -> Area {
    sweep(area, FillRule::NonZero)
}

/// The places around which overlapping rings wind more often to the left than
/// to the right. So the loops of an offset border cancel. One sweep, unless there
/// are so many edges that it is cut into parts.
pub(super) fn positive(area: &Area) -> Area {
    positive_in_parts(area, SWEEP_EDGES)
}

fn positive_in_parts(area: &Area, most: usize) -> Area {
    let bounds = area.bounds();
    if edge_count(area) <= most || bounds.size().max_element() < 1.0 {
        return sweep(area, FillRule::Positive);
    }
    let (boxes, cut) = halves(bounds);
    let part = |half| positive_in_parts(&crop(&area.rings, half), most);
    joined(boxes.map(part), cut)
}

fn sweep(area: &Area, rule: FillRule) -> Area {
    if isoslice_base::limits::is_stopped() {
        return Area::EMPTY;
    }
    let mut overlay = Overlay::new(edge_count(area));
    add(&mut overlay, area, ShapeType::Subject);
    from_shapes(overlay.overlay(OverlayRule::Subject, rule))
}

fn run(rule: OverlayRule, a: &Area, b: &Area) -> Area {
    if isoslice_base::limits::is_stopped() {
        return Area::EMPTY;
    }
    let bounds = a.bounds();
    // Nothing of the second area counts that is away from the first one.
    let counts = |ring: &&Ring| {
        rule == OverlayRule::Union || Rect::around(*ring).meets(bounds)
    };
    let beside: Vec<&Ring> = b.rings.iter().filter(counts).collect();
    let edges = beside.iter().map(|ring| ring.len()).sum::<usize>();
    let mut overlay = Overlay::new(edge_count(a) + edges);
    add(&mut overlay, a, ShapeType::Subject);
    for ring in beside {
        overlay.add_contour(&to_contour(ring), ShapeType::Clip);
    }
    from_shapes(overlay.overlay(rule, FillRule::NonZero))
}

fn edge_count(area: &Area) -> usize {
    area.rings.iter().map(Vec::len).sum()
}

fn add(overlay: &mut Overlay<i32>, area: &Area, kind: ShapeType) {
    for ring in &area.rings {
        overlay.add_contour(&to_contour(ring), kind);
    }
}

fn to_contour(ring: &[DVec2]) -> Contour {
    // Beyond the grid a coordinate sticks to the grid's end. Parts that large
    // are refused long before.
    ring.iter()
        .map(|p| {
            let q = (*p * GRID).round();
            IntPoint::new(q.x as i32, q.y as i32)
        })
        .collect()
}

fn from_shapes(shapes: Vec<Vec<Contour>>) -> Area {
    let ring = |contour: Contour| -> Ring {
        contour
            .iter()
            .map(|q| DVec2::new(f64::from(q.x), f64::from(q.y)) / GRID)
            .collect()
    };
    shapes.into_iter().flatten().map(ring).collect()
}

#[cfg(test)]
mod tests {
    use super::super::shapes::rect;
    use super::*;

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
    fn cropping_keeps_the_inside() {
        let frame =
            difference(&rect(0.0, 0.0, 9.0, 9.0), &rect(2.0, 2.0, 7.0, 7.0));
        let to = Rect::new(DVec2::new(-1.0, 1.0), DVec2::new(3.0, 20.0));
        let cropped = unite(&crop(&frame.rings, to));
        assert!((cropped.content() - (3.0 * 8.0 - 5.0)).abs() < 1e-6);
        let away = Rect::new(DVec2::splat(20.0), DVec2::splat(21.0));
        assert!(crop(&frame.rings, away).is_empty());
    }

    #[test]
    fn sweeps_too_large_for_one_are_cut() {
        const N: u32 = 161;
        let squares = |x0: f64| {
            (0..N * N)
                .map(|i| (x0 + f64::from(i % N), f64::from(i / N)))
                .flat_map(|(x, y)| rect(x, y, x + 0.6, y + 0.6).rings)
                .collect()
        };
        let (a, cover) = (squares(0.0), squares(0.2));
        assert!(edge_count(&a) + edge_count(&cover) > 2 * SWEEP_EDGES);
        let open = not_covered_by_all(&a, &[&cover, &a]);
        let exact = f64::from(N * N) * 0.2 * 0.6;
        assert!((open.content() - exact).abs() < 1e-3, "{}", open.content());
        // What the cut divides is in two islands, and all else in one.
        let islands = open.islands();
        assert!(islands.len() >= (N * N) as usize);
        assert!(islands.iter().all(|i| i.content() < 0.2 * 0.6 + 1e-6));
        // Where a cover is far away, all is open.
        let far = squares(120.3);
        let open = not_covered_by_all(&a, &[&far, &a]).content();
        let both = intersection(&a, &far).content();
        assert!((open - (a.content() - both)).abs() < 1e-3, "{open}");
    }

    /// Stars that overlap one another, and run round some places twice.
    fn stars(seed: u64) -> Area {
        let mut rng = fastrand::Rng::with_seed(seed);
        let star = |_| {
            let (n, turns) = (rng.u32(5..30), rng.u32(1..4));
            let centre = DVec2::new(rng.f64(), rng.f64()) * 12.0;
            let corner = |k| {
                let angle = f64::from(k * turns) / f64::from(n);
                let size = 0.5 + 3.0 * rng.f64();
                let way = DVec2::from_angle(std::f64::consts::TAU * angle);
                // Some corners are on a coarse grid, so that edges lie on cuts.
                let p = centre + way * size;
                if k % 4 == 0 { p.round() } else { p }
            };
            let mut ring: Ring = (0..n).map(corner).collect();
            if rng.u32(0..3) == 0 {
                ring.reverse();
            }
            ring
        };
        (0..40).map(star).collect()
    }

    #[test]
    fn sweeps_in_parts_are_like_one() {
        for seed in 0..40 {
            let all = stars(seed);
            let whole = sweep(&all, FillRule::Positive);
            let parts = positive_in_parts(&all, 50);
            let off = difference(&whole, &parts).content()
                + difference(&parts, &whole).content();
            assert!(off < 1e-3, "{seed}: {off}");
            assert!((whole.content() - parts.content()).abs() < 1e-3);
            // Nothing stays cut. Islands that meet in a corner may be one.
            let [a, b] = [&whole, &parts].map(|area| area.islands().len());
            assert!(a.abs_diff(b) <= 3, "{seed}: {a} {b}");
            let (a, b) = (whole.perimeter(), parts.perimeter());
            assert!((a - b).abs() < 1e-3, "{seed}: {a} {b}");
        }
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

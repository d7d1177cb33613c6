//! Finds a place on the bed for the parts that have none.
//!
//! In: the boxes of parts, seen from above, and where some of them stand. Out:
//! the middle of each box. The largest parts come first, each as near to the
//! front left corner of a region as it fits; the region is the smallest of some
//! around the bed's middle that holds all.
//!
//! ```text
//!   ┌───────────────┐     What is free is kept as the largest rectangles in
//!   │     ╎     ╎   │     it, which overlap ("maximal rectangles", Jylänki, "A
//!   │╌╌╌╌╌┼╌╌╌╌╌┼╌╌╌│     thousand ways to pack the bin", 2010). A part that is
//!   │█████│     ╎   │     placed cuts those that it touches into up to four.
//!   └───────────────┘
//! ```
//!
//! Guaranteed: deterministic; bounded work; boxes keep `spacing` from one
//! another. Parts with a place may be nearer to one another than that, but do
//! not overlap.

use super::PlateError;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Rect;

/// A bed, and the distance to keep on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bed {
    /// Width and depth of the bed.
    pub size: DVec2,
    /// Distance between parts.
    pub spacing: Mm,
}

/// A part as seen from above.
#[derive(Clone, Debug)]
pub(super) struct Box {
    pub name: String,
    /// Width and depth, with the brim.
    pub size: DVec2,
    /// Width and depth without the brim, for messages.
    pub body: DVec2,
    /// The middle of the part, if it has a place.
    pub at: Option<DVec2>,
    /// True if no other part may stand beside it in x.
    pub alone: bool,
}

/// How far a box may reach over an edge, or over another, before that counts,
/// mm: bounds are conservative by less.
const TOLERANCE: Mm = 1e-3;

/// Each region is larger than the one before by this factor.
const LARGER: f64 = 1.12;

/// The box of some size around a point.
fn around(middle: DVec2, size: DVec2) -> Rect {
    Rect::new(middle - 0.5 * size, middle + 0.5 * size)
}

/// How far two boxes overlap along each axis; less than 0 where they do not.
fn overlap(a: Rect, b: Rect) -> DVec2 {
    a.max.min(b.max) - a.min.max(b.min)
}

/// True if all of a box is in another one.
fn holds(outer: Rect, inner: Rect) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

/// The middles of the boxes, in their order.
///
/// # Errors
/// If a part with a place is not on the bed or overlaps with another, or if
/// there is no place for one of the others.
pub(super) fn arrange(
    boxes: &[Box],
    bed: Bed,
) -> Result<Vec<DVec2>, PlateError> {
    let fixed = standing(boxes, bed)?;
    let mut order: Vec<usize> = (0..boxes.len())
        .filter(|&i| boxes[i].at.is_none())
        .collect();
    let key = |i: usize| {
        let size = boxes[i].size;
        (size.max_element(), size.x * size.y)
    };
    order.sort_by(|&a, &b| {
        let (a, b) = (key(a), key(b));
        b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1))
    });
    let mut middles: Vec<DVec2> =
        boxes.iter().map(|b| b.at.unwrap_or_default()).collect();
    if order.is_empty() {
        return Ok(middles);
    }
    let area: f64 = order
        .iter()
        .map(|&i| (boxes[i].size + bed.spacing).element_product())
        .sum();
    let whole = (bed.size + bed.spacing).element_product();
    let mut share = (area / whole).sqrt().min(1.0);
    let placed = loop {
        match packed(boxes, &order, &fixed, bed, share) {
            Ok(placed) => break placed,
            Err(none) if share >= 1.0 => {
                let piece = &boxes[order[none]];
                let brim = piece.size.x > piece.body.x + TOLERANCE;
                return Err(PlateError::Full {
                    name: piece.name.clone(),
                    size: sizes(piece.size),
                    with: if brim { " with its brim" } else { "" },
                    placed: none + fixed.len(),
                    count: boxes.len(),
                    bed: sizes(bed.size),
                    spacing: bed.spacing,
                });
            }
            Err(_) => share = (share * LARGER).min(1.0),
        }
    };
    // The middle of all boxes together moves to the middle of the bed, unless
    // some parts have a place.
    let mut by = DVec2::ZERO;
    if fixed.is_empty() {
        let all = placed.iter().copied().reduce(Rect::union);
        let middle = all.map(|all| all.centre());
        by = middle.map_or(by, |middle| 0.5 * bed.size - middle);
    }
    for (&i, place) in order.iter().zip(&placed) {
        middles[i] = place.centre() + by;
    }
    Ok(middles)
}

/// The boxes of the parts that have a place.
fn standing(boxes: &[Box], bed: Bed) -> Result<Vec<Rect>, PlateError> {
    let mut fixed: Vec<(&Box, Rect)> = Vec::new();
    for piece in boxes {
        let Some(at) = piece.at else { continue };
        let here = around(at, piece.body);
        let over = [-here.min, here.max - bed.size];
        let excess = over.iter().zip(["-", "+"]).flat_map(|(over, side)| {
            let axes = [(over.x, "x"), (over.y, "y")];
            axes.into_iter().filter(|(over, _)| *over > TOLERANCE).map(
                move |(over, axis)| format!("{over:.2} mm at {side}{axis}"),
            )
        });
        let excess: Vec<String> = excess.collect();
        if !excess.is_empty() {
            return Err(PlateError::OffBed {
                name: piece.name.clone(),
                excess: excess.join(", "),
            });
        }
        let foot = around(at, piece.size);
        for (other, there) in &fixed {
            let overlap = overlap(foot, *there);
            if overlap.cmpgt(DVec2::splat(TOLERANCE)).all() {
                return Err(PlateError::Overlap {
                    first: other.name.clone(),
                    second: piece.name.clone(),
                    x: overlap.x,
                    y: overlap.y,
                });
            }
        }
        fixed.push((piece, foot));
    }
    Ok(fixed.into_iter().map(|(_, foot)| foot).collect())
}

/// Places for the boxes of `order` in a region whose sides are `share` of the
/// bed's. The error is the number of a box without a place.
fn packed(
    boxes: &[Box],
    order: &[usize],
    fixed: &[Rect],
    bed: Bed,
    share: f64,
) -> Result<Vec<Rect>, usize> {
    // Every box has its spacing behind it and to its right, and so has the
    // region.
    let spacing = DVec2::splat(bed.spacing);
    let region = around(0.5 * bed.size, share * bed.size);
    let mut free =
        vec![Rect::new(region.min, region.max + spacing + TOLERANCE)];
    for &Rect { min, max } in fixed {
        cut(&mut free, Rect::new(min, max + spacing));
    }
    let mut placed = Vec::with_capacity(order.len());
    for (k, &i) in order.iter().enumerate() {
        if isoslice_base::limits::is_stopped() {
            return Err(k);
        }
        let mut size = boxes[i].size + spacing;
        if boxes[i].alone {
            size.x = size.x.max(region.size().x + spacing.x);
        }
        let fits = |r: &&Rect| size.cmple(r.size()).all();
        let nearer = |a: &&Rect, b: &&Rect| {
            let (a, b) = (a.min, b.min);
            a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))
        };
        let Some(min) = free.iter().filter(fits).min_by(nearer).map(|r| r.min)
        else {
            return Err(k);
        };
        let max = min + size;
        cut(&mut free, Rect::new(min, max));
        placed.push(Rect::new(min, max - spacing));
    }
    Ok(placed)
}

/// Takes what is occupied out of the free rectangles.
fn cut(free: &mut Vec<Rect>, occupied: Rect) {
    let touches = |r: &mut Rect| overlap(*r, occupied).cmpgt(DVec2::ZERO).all();
    let touched: Vec<Rect> = free.extract_if(.., touches).collect();
    let mut pieces = Vec::new();
    for r in touched {
        let Rect { min, max } = occupied;
        let sides = [
            Rect::new(r.min, DVec2::new(min.x, r.max.y)),
            Rect::new(DVec2::new(max.x, r.min.y), r.max),
            Rect::new(r.min, DVec2::new(r.max.x, min.y)),
            Rect::new(DVec2::new(r.min.x, max.y), r.max),
        ];
        let some = |r: &Rect| r.size().cmpgt(DVec2::ZERO).all();
        pieces.extend(sides.into_iter().filter(some));
    }
    // A piece within another one is left out: the other one is free as well.
    for (i, piece) in pieces.iter().enumerate() {
        let within = |(j, other): (usize, &Rect)| {
            j != i && holds(*other, *piece) && (other != piece || j < i)
        };
        let known = free.iter().any(|r| holds(*r, *piece));
        if !known && !pieces.iter().enumerate().any(within) {
            free.push(*piece);
        }
    }
}

fn sizes(size: DVec2) -> String {
    format!("{:.2} × {:.2}", size.x, size.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(name: &str, size: (f64, f64), at: Option<(f64, f64)>) -> Box {
        Box {
            name: name.to_owned(),
            size: size.into(),
            body: size.into(),
            at: at.map(DVec2::from),
            alone: false,
        }
    }

    const BED: Bed = Bed {
        size: DVec2::new(200.0, 100.0),
        spacing: 5.0,
    };

    /// The distance between two boxes along the axis where it is greater.
    fn gap(a: &Box, at: DVec2, b: &Box, bt: DVec2) -> f64 {
        let overlap = overlap(around(at, a.size), around(bt, b.size));
        -overlap.min_element()
    }

    #[test]
    fn boxes_keep_their_distance_and_stay_on_the_bed() {
        // The boxes have many sizes.
        let mut rng = fastrand::Rng::with_seed(7);
        let mut random = || rng.f64();
        for round in 0..20 {
            let count = 1 + round;
            let mut boxes: Vec<Box> = (0..count)
                .map(|_| {
                    let size = (4.0 + 18.0 * random(), 4.0 + 18.0 * random());
                    piece("p", size, None)
                })
                .collect();
            if round % 3 == 0 {
                boxes[0].at = Some(DVec2::new(60.0, 40.0));
            }
            let middles = arrange(&boxes, BED).unwrap();
            for (i, a) in boxes.iter().enumerate() {
                let here = around(middles[i], a.size);
                assert!(here.min.cmpge(DVec2::splat(-1e-3)).all());
                assert!(here.max.cmple(BED.size + 1e-3).all());
                for (j, b) in boxes.iter().enumerate().take(i) {
                    let gap = gap(a, middles[i], b, middles[j]);
                    assert!(gap >= BED.spacing - 1e-6, "{gap}");
                }
            }
            assert_eq!(middles, arrange(&boxes, BED).unwrap());
        }
    }

    #[test]
    fn a_box_alone_is_in_the_middle_and_a_full_bed_is_full() {
        let alone = arrange(&[piece("p", (30.0, 20.0), None)], BED).unwrap();
        assert!(alone[0].distance(0.5 * BED.size) < 1e-9);
        // 8 × 4 boxes of 20 mm fill 200 × 100 mm, with 5 mm between them.
        let boxes = vec![piece("p", (20.0, 20.0), None); 32];
        assert_eq!(arrange(&boxes, BED).unwrap().len(), 32);
        let boxes = vec![piece("p", (20.0, 20.0), None); 33];
        let error = arrange(&boxes, BED).unwrap_err().to_string();
        assert!(error.contains("32 of 33 parts fit"), "{error}");
    }

    #[test]
    fn parts_with_places_may_not_overlap_or_leave_the_bed() {
        let a = piece("a", (20.0, 20.0), Some((50.0, 50.0)));
        let b = piece("b", (20.0, 20.0), Some((65.0, 50.0)));
        let error = arrange(&[a.clone(), b], BED).unwrap_err().to_string();
        assert!(
            error.starts_with("a and b overlap by 5.00 × 20.00"),
            "{error}"
        );
        let c = piece("c", (20.0, 20.0), Some((195.0, 5.0)));
        let error = arrange(&[a, c], BED).unwrap_err().to_string();
        assert!(error.contains("5.00 mm at -y, 5.00 mm at +x"), "{error}");
    }
}

//! What hangs in one layer alone, where places on the rims tell of something.
//!
//! In: boxes of a layer in which something sticks out, and the layer below.
//! Out: what of it hangs, as the judge says.

use super::across::Upper;
use super::held::Limits;
use super::piece::{Both, OverhangPiece, piece};
use super::printed::Printed;
use isoslice_base::units::Mm;
use isoslice_planar::clip::crop;
use isoslice_planar::{Area, Rect, Solid};

/// What hangs in a layer by more than what is held.
#[derive(Clone, Debug)]
pub(super) struct Ledge {
    /// Where it is, without what the layer below holds.
    pub area: Area,
    pub piece: OverhangPiece,
    /// True if it gets farther away than a lip.
    pub counts: bool,
}

/// Greatest number of boxes that are kept apart.
const BOXES: usize = 200;
/// What holds the ends of a bridge over something in a box, and the walls that run
/// there, are no farther away from the box than this, mm.
const AROUND: Mm = 3.0;

/// What hangs in some boxes of a layer. `here` is the layer without what begins on
/// nothing.
pub(super) fn ledges(
    boxes: Vec<Rect>,
    here: &Area,
    below: &Solid<'_>,
    upper: Upper<'_>,
) -> Vec<Ledge> {
    let limits = Limits::new(upper.height, upper.plan);
    let boxes = merged(boxes).into_iter();
    let found = boxes.flat_map(|rect| {
        if isoslice_base::limits::is_stopped() {
            return Vec::new();
        }
        let wide = rect.grown(AROUND + limits.held);
        let own = Printed::part(
            crop(&here.rings, rect),
            &crop(&here.rings, wide),
            upper.plan,
        );
        let under = crop(&below.area().rings, wide);
        let under = Printed::part(under.clone(), &under, upper.plan);
        let islands = upper.over(&own, &under).must.islands();
        if islands.is_empty() {
            return Vec::new();
        }
        let both = Both::new(&own.area, below);
        let of_island = |area: Area| {
            let piece = piece(&area, &both, upper);
            Ledge {
                counts: limits.harm(piece.reach),
                area,
                piece,
            }
        };
        islands.into_iter().map(of_island).collect()
    });
    found.collect()
}

/// Boxes that cover the given ones, and of which no two meet.
fn merged(mut boxes: Vec<Rect>) -> Vec<Rect> {
    if boxes.len() > BOXES {
        return vec![boxes.iter().fold(Rect::EMPTY, |r, b| r.union(*b))];
    }
    let mut done: Vec<Rect> = Vec::new();
    while let Some(mut rect) = boxes.pop() {
        // The grown box may meet boxes that it did not meet before.
        loop {
            let met: Vec<Rect> =
                done.extract_if(.., |d| d.meets(rect)).collect();
            if met.is_empty() {
                break;
            }
            rect = met.iter().fold(rect, |r, b| r.union(*b));
        }
        done.push(rect);
    }
    done
}

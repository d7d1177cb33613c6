//! Whether points are inside.
//!
//! A ray to the right from the point crosses pieces, each of which rises or
//! falls. A piece holds its lower end and not its upper, so that the ray meets
//! a ring at each passage once.
//!
//! A ray along a line of text would meet half its letters. So what is wide is
//! mirrored, x for y, and rays are as short as the area is high.

use super::Shape;
use crate::curve::Curve;
use crate::outline::Fill;
use crate::tree::Tree;
use glam::DVec2;
use isocontour::Rect;

/// The pieces of all shapes.
#[derive(Debug)]
pub(super) struct Winding {
    /// True if the pieces are mirrored, and places have to be.
    mirrored: bool,
    pieces: Vec<(Curve, u32)>,
    tree: Tree,
    shapes: Vec<Shape>,
}

/// How a shape is met by a ray: its number, and how often it is gone round.
type Met = (u32, i32);

impl Winding {
    pub(super) fn new(
        mut pieces: Vec<(Curve, u32)>,
        shapes: Vec<Shape>,
    ) -> Winding {
        let boxes = pieces.iter().map(|(c, _)| c.bounds());
        let size = boxes.fold(Rect::EMPTY, Rect::union).size();
        let mirrored = size.x > size.y;
        if mirrored {
            for (piece, _) in &mut pieces {
                *piece = piece.map(mirror);
            }
        }
        let boxes = pieces.iter().map(|(c, _)| c.bounds()).collect();
        Winding {
            mirrored,
            pieces,
            tree: Tree::new(boxes),
            shapes,
        }
    }

    pub(super) fn bounds(&self) -> Rect {
        let Rect { min, max } = self.tree.bounds();
        Rect::new(self.seen(min), self.seen(max))
    }

    /// A place as the pieces have it, and back.
    fn seen(&self, p: DVec2) -> DVec2 {
        if self.mirrored { mirror(p) } else { p }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.pieces.as_slice()) + self.tree.bytes()
    }

    pub(super) fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        tell(&[u8::from(self.mirrored)]);
        for (piece, shape) in &self.pieces {
            tell(&shape.to_le_bytes());
            tell(&[piece.degree() as u8]);
            for p in piece.control() {
                p.to_array().iter().for_each(|c| tell(&c.to_le_bytes()));
            }
        }
        for shape in &self.shapes {
            let odd = shape.fill == Fill::EvenOdd;
            let window = shape.window.map_or(u64::MAX, u64::from);
            tell(&[u8::from(odd), u8::from(shape.cuts)]);
            tell(&window.to_le_bytes());
            tell(&(shape.seen_in.len() as u64).to_le_bytes());
            shape.seen_in.iter().for_each(|w| tell(&w.to_le_bytes()));
        }
    }

    /// Whether a point is inside: what the last shape says that covers it and
    /// is seen there.
    pub(super) fn is_inside(&self, p: DVec2) -> bool {
        let p = self.seen(p);
        let mut first: Met = (0, 0);
        let mut others: Vec<Met> = Vec::new();
        let ahead =
            |b: &Rect| b.min.y <= p.y && p.y < b.max.y && p.x <= b.max.x;
        self.tree.each(ahead, |i| {
            let (piece, shape) = &self.pieces[i];
            let way = passes(piece, p);
            if way == 0 {
                return;
            }
            if first.1 == 0 && others.is_empty() {
                first = (*shape, way);
            } else if first.0 == *shape {
                first.1 += way;
            } else if let Some(met) =
                others.iter_mut().find(|met| met.0 == *shape)
            {
                met.1 += way;
            } else {
                others.push((*shape, way));
            }
        });
        others.push(first);
        let shape = |number: u32| self.shapes.get(number as usize);
        others.retain(|(number, round)| {
            shape(*number).is_some_and(|shape| match shape.fill {
                Fill::NonZero => *round != 0,
                Fill::EvenOdd => round % 2 != 0,
            })
        });
        let windows = || others.iter().filter_map(|met| shape(met.0)?.window);
        let seen = |met: &&Met| {
            shape(met.0).is_some_and(|shape| {
                let open = |window: &u32| windows().any(|w| w == *window);
                shape.window.is_none() && shape.seen_in.iter().all(open)
            })
        };
        let top = others.iter().filter(seen).max_by_key(|met| met.0);
        top.and_then(|met| shape(met.0)).is_some_and(|s| !s.cuts)
    }
}

fn mirror(p: DVec2) -> DVec2 {
    DVec2::new(p.y, p.x)
}

/// How a ray to the right from a point passes a piece: 1 where it rises, -1
/// where it falls, 0 if it misses it.
fn passes(piece: &Curve, p: DVec2) -> i32 {
    let (a, b) = (piece.start(), piece.end());
    let (low, high, way) = if a.y < b.y {
        (a.y, b.y, 1)
    } else {
        (b.y, a.y, -1)
    };
    if p.y < low || p.y >= high {
        return 0;
    }
    let right = if p.x < a.x.min(b.x) {
        true
    } else if p.x > a.x.max(b.x) {
        false
    } else {
        piece.is_right_of(p)
    };
    if right { way } else { 0 }
}

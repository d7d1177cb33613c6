//! Finds the parts of walls that hang over the layer below.
//!
//! ```text
//!   ───┄┄┄┄┄┄┄┄┄───     a wall's centre line, dotted where the layer below
//!   ▒▒▒╲       ╱▒▒▒     (▒) does not hold it; it is cut there into pieces
//!   ▒▒▒▒╲_____╱▒▒▒▒     that follow each other without a travel
//! ```
//!
//! In: a bead, and the solid of the layer below. Out: the bead, cut where it
//! begins or ceases to hang, if it is a wall. A wall that has grown wider
//! reaches another wall beside it. It does not hang if that one lies on the layer
//! below. Beads that fill gaps between walls are left as they are: walls hold
//! them on both sides. A bead may hang over by a share of its width: at half of the
//! width, it is the centre line that must not leave the solid.

use crate::walls::WallPlan;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Solid;
use isoslice_planar::bead::{Bead, Role, Stroke};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::offset::offset;

/// The solid that holds a layer's walls.
pub struct Support<'a> {
    below: &'a EdgeGrid,
    /// The solid shrunk or grown for outer and for inner walls, if not half
    /// of a wall may hang over.
    moved: Option<[EdgeGrid; 2]>,
    /// Widths beyond which outer and inner walls reach what is beside them.
    wide: [Mm; 2],
    /// The solid of the walls' own layer.
    own: &'a EdgeGrid,
}

/// A piece shorter than this, or a shorter gap between two pieces, goes with
/// what is beside it, mm.
const SHORT: Mm = 1.0;
/// How far a piece's end may move along a wall to one of its points, in widths:
/// to the end of the round end of a bead.
const SNAP: f64 = 0.5;
/// A wall that is wider than usual by this share reaches what is beside it.
const WIDER: f64 = 0.1;
/// How far from a bead's middle to look for something beside the bead, as a
/// share of its width: a little more than half.
const BESIDE: f64 = 0.6;
/// Tolerance of the moved solid, mm.
const TOLERANCE: Mm = 0.01;

impl<'a> Support<'a> {
    /// The solid of the layer below for the walls of a layer whose own solid
    /// is `own`; nothing if no wall is to be an overhang. A wall may reach beyond
    /// the layer below by the plan's share of its width.
    pub fn new(
        below: &'a Solid<'_>,
        own: &'a Solid<'_>,
        walls: &WallPlan,
    ) -> Option<Support<'a>> {
        let share = walls.overhang_share;
        if share >= 100.0 {
            return None;
        }
        let widths = [walls.outer, walls.inner];
        let share = 0.01 * share - 0.5;
        let grid = |width: Mm| {
            EdgeGrid::new(&offset(below.area(), share * width, TOLERANCE), 1.0)
        };
        Some(Support {
            below: below.grid(),
            moved: (share != 0.0).then(|| widths.map(grid)),
            wide: widths.map(|w| w * (1.0 + WIDER)),
            own: own.grid(),
        })
    }

    /// The bead, cut where it begins or ceases to hang, if it is a wall.
    pub fn cut(&self, bead: Bead) -> Vec<Bead> {
        if isoslice_base::limits::is_stopped() {
            return vec![bead];
        }
        match bead.role {
            Role::OuterWall | Role::InnerWall => {}
            _ => return vec![bead],
        }
        match self.pieces(&bead).as_slice() {
            [] => vec![bead],
            [one] => {
                let role = if one.hangs { Role::Overhang } else { bead.role };
                vec![Bead { role, ..bead }]
            }
            pieces => pieces.iter().map(|piece| part(&bead, piece)).collect(),
        }
    }

    /// The parts of a bead that hang: from which of its places to which, each the
    /// number of a segment plus a share of it.
    pub fn hanging(&self, bead: &Bead) -> Vec<[f64; 2]> {
        let pieces = self.pieces(bead).into_iter();
        pieces.filter(|p| p.hangs).map(|p| [p.from, p.to]).collect()
    }

    /// True if a wall hangs somewhere.
    pub fn hangs(&self, bead: &Bead) -> bool {
        if isoslice_base::limits::is_stopped() {
            return false;
        }
        self.pieces(bead).iter().any(|piece| piece.hangs)
    }

    /// True if there is more of the part beside this place of a bead, and the layer
    /// below holds that.
    fn leans(&self, bead: &Bead, place: f64, width: Mm) -> bool {
        // The segment that the place is on, or that begins there.
        let from = place.floor();
        let (a, b) = (at(&bead.stroke, from).0, at(&bead.stroke, from + 1.0).0);
        let side = (b - a).perp().normalize_or_zero() * BESIDE * width;
        let p = at(&bead.stroke, place).0;
        let holds = |p| self.own.contains(p) && self.below.contains(p);
        holds(p + side) || holds(p - side)
    }

    /// The parts of a bead, each of which hangs or does not. A bead without a
    /// length has no parts.
    fn pieces(&self, bead: &Bead) -> Vec<BeadPiece> {
        let stroke = &bead.stroke;
        let wall = usize::from(bead.role != Role::OuterWall);
        let grid = self.moved.as_ref().map_or(self.below, |m| &m[wall]);
        let n = stroke.points.len();
        // The places where edges are crossed, each as the segment's number plus
        // the share of it.
        let mut cuts: Vec<f64> = Vec::new();
        for (i, (a, b)) in stroke.segments().enumerate() {
            let first = cuts.len();
            cuts.extend(grid.crossings(a, b).iter().map(|t| i as f64 + t));
            cuts[first..].sort_by(f64::total_cmp);
        }
        let usual = self.wide[wall];
        if !stroke.widths.is_empty() {
            let wide = |i: usize| stroke.widths.get(i % n) > Some(&usual);
            let change = (0..n).filter(|&i| wide(i) != wide(i + 1));
            cuts.extend(change.flat_map(|i| [i as f64, (i + 1) as f64]));
            cuts.sort_by(f64::total_cmp);
        }
        cuts.dedup_by(|a, b| *a - *b < 1e-9);
        let segments = n.saturating_sub(usize::from(!stroke.closed));
        if segments == 0 {
            return Vec::new();
        }
        cuts.retain(|c| *c < segments as f64);
        let mut ends = vec![0.0];
        ends.extend(cuts);
        ends.push(segments as f64);
        let mut pieces: Vec<BeadPiece> = Vec::new();
        for pair in ends.windows(2) {
            if pair[1] - pair[0] < 1e-9 {
                continue;
            }
            let place = 0.5 * (pair[0] + pair[1]);
            let (middle, width) = at(stroke, place);
            let width = width.unwrap_or(stroke.width);
            let wide = width > usual && self.leans(bead, place, width);
            let piece = BeadPiece {
                from: pair[0],
                to: pair[1],
                hangs: !wide && !grid.contains(middle),
                wide,
            };
            add(&mut pieces, piece);
        }
        let mut pieces = join(pieces, bead);
        snap(&mut pieces, bead);
        pieces
    }
}

/// A part of a bead, from one place to another, counted in segments.
#[derive(Clone, Copy)]
struct BeadPiece {
    from: f64,
    to: f64,
    hangs: bool,
    /// True if the piece, or some of it, is so wide that it reaches what is
    /// beside it.
    wide: bool,
}

/// Adds a piece; it is joined to the last one if both hang, or neither does.
fn add(pieces: &mut Vec<BeadPiece>, piece: BeadPiece) {
    match pieces.last_mut() {
        Some(last) if last.hangs == piece.hangs => {
            last.to = piece.to;
            last.wide |= piece.wide;
        }
        _ => pieces.push(piece),
    }
}

/// The point of a bead with which a place's segment begins, and the share of
/// the segment up to the place.
fn split(stroke: &Stroke, place: f64) -> (usize, f64) {
    let n = stroke.points.len();
    let i = (place as usize).min(if stroke.closed { n - 1 } else { n - 2 });
    (i, place - i as f64)
}

/// A bead's point and width at a place along it.
fn at(stroke: &Stroke, place: f64) -> (DVec2, Option<Mm>) {
    let (i, t) = split(stroke, place);
    let next = (i + 1) % stroke.points.len();
    let widths = stroke.widths.get(i).zip(stroke.widths.get(next));
    (
        stroke.points[i].lerp(stroke.points[next], t),
        widths.map(|(a, b)| a + t * (b - a)),
    )
}

/// The bead's part, with its points between the ends.
fn part(bead: &Bead, piece: &BeadPiece) -> Bead {
    let own = &bead.stroke;
    let n = own.points.len();
    let (mut points, mut widths) = (Vec::new(), Vec::new());
    let mut levels = Vec::new();
    let mut push = |place: f64| {
        let (p, w) = at(own, place);
        points.push(p);
        widths.extend(w);
        if !own.levels.is_empty() {
            let (i, t) = split(own, place);
            levels.push(own.level(i).lerp(own.level(i + 1), t));
        }
    };
    push(piece.from);
    for i in piece.from as usize + 1..piece.to.ceil() as usize {
        if i as f64 > piece.from {
            push(i as f64);
        }
    }
    push(piece.to);
    // The point where the loop closes must be exact: the next piece begins
    // there.
    if own.closed && piece.to >= n as f64 {
        points.pop();
        points.push(own.points[0]);
    }
    Bead {
        role: if piece.hangs {
            Role::Overhang
        } else {
            bead.role
        },
        stroke: Stroke {
            points,
            widths,
            closed: false,
            width: own.width,
            levels,
        },
        ..*bead
    }
}

/// Length of the bead's part.
fn length(stroke: &Stroke, piece: &BeadPiece) -> Mm {
    let n = stroke.points.len();
    let mut last = at(stroke, piece.from).0;
    let mut sum = 0.0;
    for i in piece.from as usize + 1..piece.to.ceil() as usize {
        let p = stroke.points[i % n];
        sum += last.distance(p);
        last = p;
    }
    sum + last.distance(at(stroke, piece.to).0)
}

/// Joins short pieces to the pieces beside them. A short held piece between two
/// hanging ones hangs with them, and a short hanging piece does not count.
fn join(mut pieces: Vec<BeadPiece>, bead: &Bead) -> Vec<BeadPiece> {
    let length = |p: &BeadPiece| length(&bead.stroke, p);
    // Gaps between hanging pieces come first, so that a row of short hanging
    // pieces counts.
    for hangs in [false, true] {
        let last = pieces.len().saturating_sub(1);
        for (i, piece) in pieces.iter_mut().enumerate() {
            // A piece at the end of a bead has only one neighbour.
            let inside = i > 0 && i < last;
            let short = piece.hangs == hangs && length(piece) < SHORT;
            if short && (hangs || inside) && !piece.wide {
                piece.hangs = !hangs;
            }
        }
        let mut joined: Vec<BeadPiece> = Vec::new();
        for piece in pieces {
            add(&mut joined, piece);
        }
        pieces = joined;
    }
    pieces
}

/// Lets pieces end at the bead's points that are near: a cut just beside such a
/// point would cost a move of its own.
fn snap(pieces: &mut [BeadPiece], bead: &Bead) {
    let near = SNAP * bead.stroke.width;
    for i in 1..pieces.len() {
        let (before, after) = (pieces[i - 1].from, pieces[i].to);
        let place = pieces[i].from;
        let point = place.round();
        let apart = at(&bead.stroke, place)
            .0
            .distance(at(&bead.stroke, point).0);
        if point > before && point < after && apart <= near {
            pieces[i - 1].to = point;
            pieces[i].from = point;
        }
    }
}

/// Pieces along a stroke, no longer than it is wide: each piece's length, and how far it
/// lies beyond what is `below`, if it hangs. A place that lies no farther beyond it than a
/// quarter of the stroke's width does not hang: a quarter of the bead, or more, lies on
/// it.
pub fn hanging<'a>(
    stroke: &'a Stroke,
    below: &'a EdgeGrid,
) -> impl Iterator<Item = (Mm, Option<Mm>)> + 'a {
    const BEYOND: f64 = 0.25;
    let width = stroke.width;
    let far = move |p: DVec2| {
        let hangs = !below.contains(p)
            && below.nearest_edge(p, BEYOND * width).is_none();
        // Beyond a layer without any edge nothing is near.
        let far = || below.foot(p).map_or(f64::MAX, |(_, q)| p.distance(q));
        hangs.then(far)
    };
    stroke.segments().flat_map(move |(a, b)| {
        let length = a.distance(b);
        let count = (length / width).ceil().clamp(1.0, 1e4);
        let at = move |k: usize| a.lerp(b, (k as f64 + 0.5) / count);
        (0..count as usize).map(move |k| (length / count, far(at(k))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::Area;
    use isoslice_planar::shapes::{self, rect_ring};
    use isoslice_settings::testing::plan_with;

    fn wall(points: Vec<DVec2>) -> Bead {
        Bead::new(Role::OuterWall, Stroke::new(points, true, 0.4), 0.2)
    }

    /// Cuts a bead in a large part over one that ends.
    fn cut(bead: Bead, below: Vec<DVec2>, share: f64) -> Vec<Bead> {
        cut_in(rect_ring(-50.0, -50.0, 50.0, 50.0), bead, below, share)
    }

    fn cut_in(
        own: Vec<DVec2>,
        bead: Bead,
        below: Vec<DVec2>,
        share: f64,
    ) -> Vec<Bead> {
        let solid = |ring| Solid::new(Area::from(ring));
        let (own, below) = (solid(own), solid(below));
        let walls = plan_with(WallPlan::of, |s| {
            s.outer_wall_width = 0.4.into();
            s.overhang_share = share;
        });
        let support = Support::new(&below, &own, &walls);
        support.map_or(vec![bead.clone()], |s| s.cut(bead))
    }

    fn lengths(beads: &[Bead]) -> Vec<(Role, f64)> {
        beads.iter().map(|b| (b.role, b.stroke.length())).collect()
    }

    #[test]
    fn a_wall_is_cut_where_it_leaves_the_layer_below() {
        // The layer below ends at x = 6; the wall goes on to 10.
        let loop_ = wall(rect_ring(0.0, 0.0, 10.0, 4.0));
        let below = rect_ring(-1.0, -1.0, 6.0, 5.0);
        let pieces = cut(loop_.clone(), below.clone(), 50.0);
        let found = lengths(&pieces);
        let expected = [
            (Role::OuterWall, 6.0),
            (Role::Overhang, 12.0),
            (Role::OuterWall, 10.0),
        ];
        assert_eq!(found.len(), 3, "{found:?}");
        for ((role, is), (own, should)) in found.iter().zip(expected) {
            assert_eq!(*role, own);
            assert!((is - should).abs() < 1e-9);
        }
        // The pieces are one path without a gap, back to where it began.
        for pair in pieces.windows(2) {
            assert_eq!(
                pair[0].stroke.points.last(),
                pair[1].stroke.points.first()
            );
        }
        assert_eq!(
            pieces[2].stroke.points.last(),
            pieces[0].stroke.points.first()
        );
        // A quarter of the width less, or more, moves the cut by 0.1 mm.
        for (share, reach) in [(25.0, 5.9), (75.0, 6.1)] {
            let found = lengths(&cut(loop_.clone(), below.clone(), share));
            assert!((found[0].1 - reach).abs() < 1e-4, "{found:?}");
        }
        let whole = vec![loop_.clone()];
        assert_eq!(cut(loop_.clone(), below, 100.0), whole);
        let wide = rect_ring(-1.0, -1.0, 11.0, 5.0);
        assert_eq!(cut(loop_.clone(), wide, 50.0), whole);
        let away = rect_ring(50.0, 0.0, 51.0, 1.0);
        let all = cut(loop_, away, 50.0);
        assert_eq!((all.len(), all[0].role), (1, Role::Overhang));
        assert!(all[0].stroke.closed);
    }

    #[test]
    fn the_bead_of_a_thin_place_has_nothing_beside_it() {
        // A fin of 0.6 mm sticks out over nothing from x = 5 on.
        let mut fin = wall(vec![DVec2::new(0.0, 0.0), DVec2::new(20.0, 0.0)]);
        fin.stroke.closed = false;
        fin.stroke.widths = vec![0.6, 0.6];
        let below = rect_ring(-1.0, -5.0, 5.0, 5.0);
        let thin = rect_ring(0.0, -0.3, 20.0, 0.3);
        let found =
            lengths(&cut_in(thin.clone(), fin.clone(), below.clone(), 50.0));
        assert_eq!(found, [(Role::OuterWall, 5.0), (Role::Overhang, 15.0)]);
        // This holds also where the middle of the hanging piece is one of its
        // points.
        let mut bent = fin.clone();
        bent.stroke.points =
            [0.0, 10.0, 20.0].map(|x| DVec2::new(x, 0.0)).to_vec();
        bent.stroke.widths = vec![0.6; 3];
        let away = rect_ring(-9.0, -5.0, -5.0, 5.0);
        let found = lengths(&cut_in(thin.clone(), bent, away, 50.0));
        assert_eq!(found, [(Role::Overhang, 20.0)]);
        // The wall of something thicker leans on the rest if that is held.
        let thick = rect_ring(0.0, -0.3, 20.0, 5.0);
        let found = lengths(&cut_in(thick.clone(), fin.clone(), below, 50.0));
        assert_eq!(found, [(Role::OuterWall, 5.0), (Role::Overhang, 15.0)]);
        let below = rect_ring(-1.0, 0.2, 20.0, 5.0);
        let found = lengths(&cut_in(thick, fin, below, 50.0));
        assert_eq!(found, [(Role::OuterWall, 20.0)]);
    }

    #[test]
    fn widths_go_with_their_pieces_and_short_ones_do_not_count() {
        let mut bead = wall(rect_ring(0.0, 0.0, 10.0, 4.0));
        bead.stroke.widths = vec![0.36, 0.4, 0.4, 0.36];
        let pieces = cut(bead.clone(), rect_ring(-1.0, -1.0, 5.0, 5.0), 50.0);
        assert!((pieces[0].stroke.widths[1] - 0.38).abs() < 1e-9);
        assert!(
            pieces
                .iter()
                .all(|p| p.stroke.widths.len() == p.stroke.points.len())
        );
        // One side is wider and leans on another wall.
        let mut wide = bead.clone();
        wide.stroke.widths = vec![0.4, 0.4, 0.6, 0.6];
        let held = shapes::ring(&[
            (-1.0, -1.0),
            (5.0, -1.0),
            (5.0, 3.5),
            (11.0, 3.5),
            (11.0, 3.9),
            (5.0, 3.9),
            (5.0, 5.0),
            (-1.0, 5.0),
        ]);
        let pieces = cut(wide, held, 50.0);
        let found = lengths(&pieces);
        assert_eq!(found.len(), 3, "{found:?}");
        assert!((found[1].1 - 7.0).abs() < 2.1 && found[1].0 == Role::Overhang);
        // A notch 0.5 mm wide in the layer below.
        let mut below = rect_ring(-1.0, -1.0, 11.0, 5.0);
        let notch = [(5.0, -1.0), (5.0, 1.0), (5.5, 1.0), (5.5, -1.0)];
        below.splice(1..1, notch.map(DVec2::from));
        assert_eq!(cut(bead.clone(), below, 50.0), [bead]);
    }
}

//! Beads in what walls leave where strips meet.
//!
//! ```text
//!     ┃ ┃ ┃ ┃        Strokes turn into one another where strips meet. Between
//!   ━━╯ ┃ ┃ ╰━━      them and the outline there may be room for another bead:
//!    ○──┼─┼──○       it goes from one end of that place to the other, as wide
//!   ━━╮ ┃ ┃ ╭━━      as the place is.
//! ```
//!
//! In: an area, the strokes laid in it, and where its ridges end or change their
//! number of beads, which they do wherever something can be left. Out: strokes
//! that lie on none of the others.
//!
//! Around each such place a small raster tells where a ball fits that touches
//! neither outline nor strokes. The widths come from the distances themselves.

use super::Lay;
use crate::bead::Stroke;
use crate::plane::grid::{EdgeGrid, nearest_on};
use crate::plane::{Area, Solid};
use crate::units::Mm;
use glam::DVec2;

/// Cells along each side of the raster around a place.
const SIDE: usize = 20;
/// Size of a cell, as a share of a bead's width: a window of 2 mm for 0.45 mm.
const CELL: f64 = 0.22;
/// Steps by which a point moves to where there is more room, as shares of a
/// cell.
const STEPS: [f64; 4] = [0.5, 0.5, 0.25, 0.125];
/// Length of a stroke in a place with room for one ball only, as a share of its
/// width.
const DOT: f64 = 0.5;

/// The strokes that fit between those laid in `solid` and outside of `fill`,
/// around `places`. `lay` says how narrow and how wide they may be.
pub(super) fn rest(
    solid: &Solid<'_>,
    laid: &[&Stroke],
    fill: &Area,
    places: &[DVec2],
    lay: &Lay,
) -> Vec<Stroke> {
    if places.is_empty() || lay.width <= 0.0 {
        return Vec::new();
    }
    let widest = laid.iter().map(|s| widest(s)).fold(0.0, f64::max);
    let mut first = Vec::with_capacity(laid.len());
    let mut number = 0;
    for stroke in laid {
        first.push(number);
        number += stroke.path().count();
    }
    let cell = CELL * lay.width;
    let lines = EdgeGrid::of_lines(laid.iter().map(|s| s.path()), 1.0);
    let fill = (!fill.is_empty()).then(|| EdgeGrid::new(fill, 1.0));
    let mut rest = Vec::new();
    let mut found = Vec::new();
    let mut seen = std::collections::HashSet::new();
    for &place in places {
        // Places in one cell of a third of a window are looked at once.
        let third = 0.3 * SIDE as f64 * cell;
        if !seen.insert((place / third).round().as_i64vec2()) {
            continue;
        }
        crate::limits::check();
        let half = DVec2::splat(0.5 * SIDE as f64 * cell);
        let (low, high) = (place - half, place + half);
        let mut edges = |grid: &EdgeGrid, reach: Mm| {
            found.clear();
            grid.visit_box(low - reach, high + reach, |e| found.push(e));
            found.sort_unstable();
            found.dedup();
            found.clone()
        };
        // Beside what is filled, the filling takes what is left.
        if fill.as_ref().is_some_and(|f| {
            !edges(f, lay.width).is_empty() || f.contains(place)
        }) {
            continue;
        }
        let mut window = Window {
            low,
            cell,
            lay,
            free: [true; SIDE * SIDE],
            outline: Vec::new(),
            strokes: Vec::new(),
        };
        let near = edges(&lines, 0.5 * widest + lay.width);
        window.strokes.extend(near.into_iter().map(|e| {
            let owner = lines.owner(e);
            let (a, b) = lines.edge(e);
            let k = e - first[owner];
            let end = laid[owner].points.len().max(1);
            let width = |k: usize| laid[owner].width_at(k % end);
            ([a, b], [width(k), width(k + 1)])
        }));
        window
            .strokes
            .extend(rest.iter().flat_map(pieces).filter(|piece| {
                let [a, b] = piece.0;
                let reach = half + lay.limit;
                (0.5 * (a + b) - place).abs().cmplt(reach).all()
            }));
        let near = edges(solid.grid(), lay.width);
        let outline = near.into_iter().map(|e| solid.grid().edge(e));
        window.outline.extend(outline);
        window.paint();
        while let Some(cells) = window.next_piece() {
            let Some(&middle) = cells.first() else {
                continue;
            };
            if solid.grid().contains(window.centre(middle)) {
                rest.extend(window.stroke(&cells));
            }
        }
    }
    rest
}

/// The straight pieces of an open stroke, and their widths at both ends.
fn pieces(stroke: &Stroke) -> impl Iterator<Item = ([DVec2; 2], [Mm; 2])> + '_ {
    let all = stroke.points.windows(2).enumerate();
    all.map(|(k, p)| {
        ([p[0], p[1]], [stroke.width_at(k), stroke.width_at(k + 1)])
    })
}

/// The width of a stroke's widest place.
fn widest(stroke: &Stroke) -> Mm {
    stroke.widths.iter().copied().fold(stroke.width, f64::max)
}

/// What surrounds a place.
struct Window<'a> {
    /// Its lower left corner.
    low: DVec2,
    cell: Mm,
    lay: &'a Lay,
    /// By cell, whether a ball with its middle there touches nothing.
    free: [bool; SIDE * SIDE],
    outline: Vec<(DVec2, DVec2)>,
    /// Straight pieces of strokes, and their widths at both ends.
    strokes: Vec<([DVec2; 2], [Mm; 2])>,
}

impl Window<'_> {
    fn centre(&self, cell: usize) -> DVec2 {
        let (i, j) = (cell % SIDE, cell / SIDE);
        self.low + self.cell * DVec2::new(i as f64 + 0.5, j as f64 + 0.5)
    }

    /// Takes the cells that are nearer to outline or strokes than a bead's
    /// middle may be.
    fn paint(&mut self) {
        // Half a cell less: no cell's middle may be where most room is.
        let ball = (0.5 * self.lay.least - 0.5 * self.cell).max(0.0);
        let beside = 0.5 * self.lay.extra;
        for k in 0..self.strokes.len() {
            let (ends, [v, w]) = self.strokes[k];
            let radius = 0.5 * v.min(w) - beside + ball;
            self.take(ends, radius);
        }
        for k in 0..self.outline.len() {
            let (a, b) = self.outline[k];
            self.take([a, b], ball + beside);
        }
    }

    fn take(&mut self, [a, b]: [DVec2; 2], radius: Mm) {
        let low = (a.min(b) - radius - self.low) / self.cell - 0.5;
        let high = (a.max(b) + radius - self.low) / self.cell - 0.5;
        let first = low.ceil().max(DVec2::ZERO);
        let last = high.floor().min(DVec2::splat(SIDE as f64 - 1.0));
        if !(first.x <= last.x && first.y <= last.y) {
            return;
        }
        for j in first.y as usize..=last.y as usize {
            for i in first.x as usize..=last.x as usize {
                let cell = j * SIDE + i;
                if self.free[cell] {
                    let p = self.centre(cell);
                    let q = nearest_on(p, a, b);
                    self.free[cell] = p.distance_squared(q) > radius * radius;
                }
            }
        }
    }

    /// A connected piece of the free cells, which are free no more.
    fn next_piece(&mut self) -> Option<Vec<usize>> {
        let first = self.free.iter().position(|f| *f)?;
        self.free[first] = false;
        let mut piece = vec![first];
        let mut next = 0;
        while let Some(&cell) = piece.get(next) {
            next += 1;
            for beside in beside(cell) {
                if std::mem::take(&mut self.free[beside]) {
                    piece.push(beside);
                }
            }
        }
        Some(piece)
    }

    /// Half the width of a bead that has its middle at `p`, less what it
    /// overlaps.
    fn room(&self, p: DVec2) -> Mm {
        let beside = 0.5 * self.lay.extra;
        let outline = self
            .outline
            .iter()
            .map(|&(a, b)| p.distance(nearest_on(p, a, b)) - beside);
        let strokes = self.strokes.iter().map(|&([a, b], [v, w])| {
            let q = nearest_on(p, a, b);
            let whole = a.distance(b).max(f64::MIN_POSITIVE);
            let width = v + (q.distance(a) / whole) * (w - v);
            p.distance(q) - 0.5 * width + beside
        });
        let most = 0.5 * self.lay.limit;
        outline.chain(strokes).fold(most, f64::min)
    }

    /// `p` moved along `way`, to either side, to where there is more room.
    fn roomier(&self, mut p: DVec2, way: DVec2) -> DVec2 {
        let mut room = self.room(p);
        for step in STEPS {
            for to in [way, -way] {
                let q = p + step * self.cell * to;
                let other = self.room(q);
                if other > room {
                    (p, room) = (q, other);
                }
            }
        }
        p
    }

    /// A stroke from one end of a piece to the other.
    fn stroke(&self, piece: &[usize]) -> Option<Stroke> {
        let from = *farthest(piece, *piece.first()?).first()?;
        let path = farthest(piece, from);
        let last = path.len().checked_sub(1)?;
        let cells = path.iter().enumerate();
        let cells = cells.filter(|(k, _)| k % 2 == 0 || *k == last);
        let points: Vec<DVec2> = cells.map(|c| self.centre(*c.1)).collect();
        let n = points.len();
        let moved = |k: usize| {
            let along =
                points[(k + 1).min(n - 1)] - points[k.saturating_sub(1)];
            let p =
                self.roomier(points[k], along.normalize_or(DVec2::X).perp());
            match n {
                1 => self.roomier(self.roomier(p, DVec2::X), DVec2::Y),
                _ => p,
            }
        };
        let points: Vec<DVec2> = (0..n).map(moved).collect();
        let fits = |p: &DVec2| 2.0 * self.room(*p) >= self.lay.least;
        // The longest part in which a bead fits.
        let longest = points
            .chunk_by(|a, b| fits(a) && fits(b))
            .filter(|part| part.iter().all(fits))
            .max_by_key(|part| part.len())?;
        let width = |p: &DVec2| 2.0 * self.room(*p) + self.lay.extra;
        if let [p] = longest {
            return self.dot(*p);
        }
        let widths = longest.iter().map(width).collect();
        Some(Stroke::varying(longest.to_vec(), widths, false))
    }

    /// A short stroke around `p`, in the direction in which there is most room.
    fn dot(&self, p: DVec2) -> Option<Stroke> {
        let width = |p: DVec2| 2.0 * self.room(p) + self.lay.extra;
        let half = 0.5 * DOT * width(p);
        let ends = |way: DVec2| [p - half * way, p + half * way];
        let narrow = |way: &DVec2| {
            let [a, b] = ends(*way);
            self.room(a).min(self.room(b))
        };
        let ways = (0..8).map(|k| {
            DVec2::from_angle(std::f64::consts::FRAC_PI_8 * f64::from(k))
        });
        let way = ways.max_by(|a, b| narrow(a).total_cmp(&narrow(b)))?;
        let even = narrow(&way).midpoint(self.room(p));
        let width = (2.0 * even).max(self.lay.least) + self.lay.extra;
        Some(Stroke::new(ends(way).to_vec(), false, width))
    }
}

/// The cells beside one.
fn beside(cell: usize) -> impl Iterator<Item = usize> {
    let (i, j) = (cell % SIDE, cell / SIDE);
    let left = (i > 0).then(|| cell - 1);
    let right = (i + 1 < SIDE).then(|| cell + 1);
    let below = (j > 0).then(|| cell - SIDE);
    let above = (j + 1 < SIDE).then(|| cell + SIDE);
    [left, right, below, above].into_iter().flatten()
}

/// The way from the cell of a piece that is farthest from `from` to it.
fn farthest(piece: &[usize], from: usize) -> Vec<usize> {
    const NONE: u16 = u16::MAX;
    // By cell of the piece, the one before it on the way.
    let mut before = [NONE; SIDE * SIDE];
    let mut is_in = [false; SIDE * SIDE];
    piece.iter().for_each(|c| is_in[*c] = true);
    let mut queue = vec![from];
    is_in[from] = false;
    let mut next = 0;
    while let Some(&cell) = queue.get(next) {
        next += 1;
        for other in beside(cell) {
            if std::mem::take(&mut is_in[other]) {
                before[other] = cell as u16;
                queue.push(other);
            }
        }
    }
    let mut way: Vec<usize> = queue.last().copied().into_iter().collect();
    while let Some(&cell) = way.last()
        && before[cell] != NONE
    {
        way.push(usize::from(before[cell]));
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    fn lay() -> Lay {
        Lay::inside(0.45, 0.2, &Settings::default())
    }

    fn rectangle(x: f64, y: f64) -> Area {
        let ring = [(0.0, 0.0), (x, 0.0), (x, y), (0.0, y)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area { rings: vec![ring] }
    }

    /// Two walls along the sides of a strip, `gap` apart where they are not.
    fn strip(gap: f64) -> (Area, Vec<Stroke>) {
        let across = 2.0 * (0.45 - lay().extra) + lay().extra + gap;
        let area = rectangle(1.2, across);
        let walls = [0.225, across - 0.225].map(|y| {
            let ends = [DVec2::new(-1.0, y), DVec2::new(3.0, y)];
            Stroke::new(ends.to_vec(), false, 0.45)
        });
        (area, walls.to_vec())
    }

    fn between(gap: f64) -> Vec<Stroke> {
        let (area, walls) = strip(gap);
        let laid: Vec<&Stroke> = walls.iter().collect();
        let middle = DVec2::new(0.63, 0.51);
        let solid = Solid::of(&area, 1.0);
        rest(&solid, &laid, &Area::default(), &[middle], &lay())
    }

    #[test]
    fn a_place_between_walls_gets_one_bead_as_wide_as_it_is() {
        for gap in [0.25, 0.3, 0.4, 0.5] {
            let beads = between(gap);
            assert_eq!(beads.len(), 1, "{gap}");
            let (bead, middle) =
                (&beads[0], 0.45 - 0.5 * lay().extra + 0.5 * gap);
            for (k, p) in bead.points.iter().enumerate() {
                assert!((p.y - middle).abs() < 0.01, "{gap}: {p}");
                let width = gap + lay().extra;
                assert!(bead.width_at(k) < width + 1e-6, "{gap}");
            }
            let widest = widest(bead);
            assert!(
                (widest - gap - lay().extra).abs() < 0.02,
                "{gap} {widest}"
            );
            // It ends a bead's half width from the short sides.
            let ends = bead.points.iter().map(|p| (p.x - 0.6).abs());
            let far = ends.fold(0.0, f64::max);
            assert!(far + 0.5 * gap < 0.6 + 0.01, "{gap}: {far}");
            assert!(
                bead.length() > 1.0 - gap - 0.1,
                "{gap}: {}",
                bead.length()
            );
        }
    }

    #[test]
    fn what_is_too_narrow_or_filled_stays_as_it_is() {
        assert!(between(0.15).is_empty());
        assert!(between(0.0).is_empty());
        let (area, walls) = strip(0.4);
        let laid: Vec<&Stroke> = walls.iter().collect();
        let solid = Solid::of(&area, 1.0);
        let middle = [DVec2::new(0.6, 0.6)];
        assert!(rest(&solid, &laid, &area, &middle, &lay()).is_empty());
        assert_eq!(rest(&solid, &laid, &Area::default(), &[], &lay()), []);
    }

    #[test]
    fn a_place_for_one_ball_gets_a_short_stroke() {
        // A hole in a ring of beads, 0.3 mm square.
        let area = rectangle(4.0, 4.0);
        let side = 0.3 + 0.45;
        let hole = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
        let ring: Vec<DVec2> =
            hole.map(|(x, y)| DVec2::new(x + 1.6, y + 1.6)).to_vec();
        let ring = Stroke::new(ring, true, 0.45);
        let middle = DVec2::splat(1.6 + 0.5 * side);
        // What is beyond the ring is none of its business.
        let solid = Solid::of(&area, 1.0);
        let all = rest(&solid, &[&ring], &Area::default(), &[middle], &lay());
        let inside: Vec<&Stroke> = all
            .iter()
            .filter(|s| s.points[0].distance(middle) < 0.3)
            .collect();
        assert_eq!(inside.len(), 1);
        let dot = inside[0];
        assert!(dot.points[0].midpoint(dot.points[1]).distance(middle) < 0.02);
        assert!((0.25..0.36).contains(&dot.width), "{}", dot.width);
        // Nothing is laid twice around one place.
        let twice = [middle, middle + 0.4];
        let again = rest(&solid, &[&ring], &Area::default(), &twice, &lay());
        let near = again.iter().filter(|s| s.points[0].distance(middle) < 0.3);
        assert_eq!(near.count(), 1);
    }
}

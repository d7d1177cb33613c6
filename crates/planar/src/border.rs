//! The border of an area: cutting lines at it, and following it from one cut
//! to the next.
//!
//! ```text
//!        ───┼────────────┼──      A line is cut where it crosses the border.
//!       ╭───●────────────●───╮    A piece knows where its ends (●) are on the
//!       │                    │    border. So the border between them and the
//!       ╰────────────────────╯    ends of its neighbours is known.
//! ```

use super::grid::EdgeGrid;
use super::places::Places;
use super::{Area, Rect};
use glam::DVec2;
use isoslice_base::units::Mm;

/// A place on an area's border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BorderPlace {
    /// Number of the ring.
    pub ring: usize,
    /// Way along the ring from its first point.
    pub at: Mm,
}

/// What an area has of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct LinePiece {
    /// The points of the piece. A closed piece does not repeat its first point.
    pub points: Vec<DVec2>,
    /// True if the piece is the whole of a line that returns to its first
    /// point.
    pub closed: bool,
    /// Where the first point is on the border, if it is there.
    pub from: Option<BorderPlace>,
    /// Where the last point is on the border, if it is there.
    pub to: Option<BorderPlace>,
}

impl LinePiece {
    /// A piece whose ends, if it has any, are not on the border.
    pub fn inner(points: Vec<DVec2>, closed: bool) -> LinePiece {
        LinePiece {
            points,
            closed,
            from: None,
            to: None,
        }
    }
}

/// An area's border.
#[derive(Clone, Debug)]
pub struct Border<'a> {
    area: &'a Area,
    grid: EdgeGrid,
    places: Places,
    bounds: Rect,
}

/// Size of the cells of a border's grid, mm. A cell has a few edges of a smooth
/// outline.
const CELL: Mm = 1.0;

/// Two crossings of a segment closer than this, as a share of it, are one
/// place: the order of rounding.
const SAME: f64 = 1e-12;

impl<'a> Border<'a> {
    /// The border of `area`.
    pub fn new(area: &'a Area) -> Border<'a> {
        Border {
            area,
            grid: EdgeGrid::new(area, CELL),
            places: Places::new(area),
            bounds: area.bounds(),
        }
    }

    /// The area inside.
    pub fn area(&self) -> &'a Area {
        self.area
    }

    /// The box around it.
    pub fn bounds(&self) -> Rect {
        self.bounds
    }

    /// True if the point is inside.
    pub fn contains(&self, p: DVec2) -> bool {
        self.grid.contains(p)
    }

    /// True if some of the box is inside, or nearly so.
    pub fn touches(&self, rect: Rect) -> bool {
        self.grid.meets(rect) || self.contains(rect.centre())
    }

    /// The place of a point on an edge, which is counted through all rings.
    pub(super) fn foot(&self, edge: usize, p: DVec2) -> BorderPlace {
        let ring = self.places.ring(edge);
        let at = self.places.begin(edge) + self.grid.edge(edge).0.distance(p);
        BorderPlace { ring, at }
    }

    /// The way along the ring from one place on it to another.
    pub fn way(&self, from: BorderPlace, to: BorderPlace) -> Mm {
        let way = to.at - from.at;
        if way < 0.0 {
            way + self.places.length(from.ring)
        } else {
            way
        }
    }

    /// The ring's points between two places on it, in its direction.
    pub fn between(&self, from: BorderPlace, to: BorderPlace) -> Vec<DVec2> {
        let ring = &self.area.rings[from.ring];
        let before = self.places.of_ring(from.ring);
        // The first points after the two places.
        let next = before.partition_point(|&w| w <= from.at);
        let end = before.partition_point(|&w| w < to.at);
        let end = if to.at < from.at {
            end + ring.len()
        } else {
            end
        };
        (next..end).map(|i| ring[i % ring.len()]).collect()
    }
}

/// Cuts lines, given point by point, at a border.
#[derive(Debug)]
pub struct Cutter<'b, 'a> {
    border: &'b Border<'a>,
    pieces: Vec<LinePiece>,
    /// The end of the line so far, if one has begun.
    at: Option<DVec2>,
    /// True if that end is inside.
    inside: bool,
    /// What has been inside since the last crossing.
    run: Vec<DVec2>,
    from: Option<BorderPlace>,
    hits: Vec<Hit>,
}

/// A crossing of a segment with the border.
#[derive(Clone, Copy, Debug)]
struct Hit {
    /// Where on the segment, from 0 to 1.
    t: f64,
    edge: usize,
    enters: bool,
}

impl<'b, 'a> Cutter<'b, 'a> {
    /// A cutter without a line.
    pub fn new(border: &'b Border<'a>) -> Self {
        Cutter {
            border,
            pieces: Vec::new(),
            at: None,
            inside: false,
            run: Vec::new(),
            from: None,
            hits: Vec::new(),
        }
    }

    /// The pieces of all lines.
    pub fn finish(mut self) -> Vec<LinePiece> {
        self.end();
        self.pieces
    }

    /// A whole line.
    pub fn line(&mut self, points: &[DVec2], closed: bool) {
        let Some(&start) = points.first() else {
            return;
        };
        self.end();
        let before = self.pieces.len();
        points.iter().for_each(|&p| self.to(p));
        if !closed {
            return self.end();
        }
        self.to(start);
        self.end();
        // A piece that begins and one that ends at the line's first point are
        // one.
        let Some(last) = self.pieces.len().checked_sub(1) else {
            return;
        };
        let open = last >= before
            && self.pieces[before].from.is_none()
            && self.pieces[last].to.is_none();
        if open && last == before {
            self.pieces[last].points.pop();
            self.pieces[last].closed = true;
        } else if open && let Some(mut piece) = self.pieces.pop() {
            let first = &mut self.pieces[before];
            piece.points.extend(first.points.drain(..).skip(1));
            first.points = piece.points;
            first.from = piece.from;
        }
    }

    /// A line that returns to its first point and lies within `bounds`.
    pub fn ring(&mut self, points: &[DVec2], bounds: Rect) {
        if self.border.grid.meets(bounds) {
            return self.line(points, true);
        }
        self.end();
        if points.first().is_some_and(|&p| self.border.contains(p)) {
            self.pieces.push(LinePiece::inner(points.to_vec(), true));
        }
    }

    /// Several points of the line at a time, which lie within `bounds`.
    pub fn run(&mut self, points: &[DVec2], bounds: Rect) {
        let mut points = points.iter();
        if self.at.is_none()
            && let Some(&p) = points.next()
        {
            self.to(p);
        }
        let Some(at) = self.at else { return };
        if self.border.grid.meets(bounds.with(at)) {
            points.for_each(|&p| self.to(p));
            return;
        }
        if self.inside {
            self.run.extend(points.clone());
        }
        self.at = points.last().copied().or(self.at);
    }

    /// The line goes on to `p`, or begins there.
    pub fn to(&mut self, p: DVec2) {
        let Some(from) = self.at.replace(p) else {
            self.inside = self.border.contains(p);
            if self.inside {
                self.run.push(p);
            }
            return;
        };
        let mut hits = std::mem::take(&mut self.hits);
        self.border.hits(from, p, &mut hits);
        for hit in &hits {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            if hit.enters == self.inside {
                continue;
            }
            let place = from.lerp(p, hit.t);
            let foot = self.border.foot(hit.edge, place);
            self.inside = hit.enters;
            self.run.push(place);
            if hit.enters {
                self.from = Some(foot)
            } else {
                self.cut(Some(foot))
            }
        }
        self.hits = hits;
        if self.inside {
            self.run.push(p);
        }
    }

    /// The line ends where it is.
    pub fn end(&mut self) {
        self.cut(None);
        self.at = None;
        self.inside = false;
    }

    fn cut(&mut self, to: Option<BorderPlace>) {
        let points = std::mem::take(&mut self.run);
        let from = self.from.take();
        if points.len() >= 2 {
            self.pieces.push(LinePiece {
                points,
                closed: false,
                from,
                to,
            });
        }
    }
}

impl Border<'_> {
    /// The crossings of a segment with the border, in order.
    fn hits(&self, a: DVec2, b: DVec2, hits: &mut Vec<Hit>) {
        hits.clear();
        // A point on a line counts as right of the line in every test. So a
        // line through a vertex crosses one of the vertex's edges, or both, or
        // none.
        let left = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) > 0.0;
        self.grid.visit_box(a.min(b), a.max(b), |edge| {
            let (c, d) = self.grid.edge(edge);
            let enters = left(c, d, b);
            if left(c, d, a) == enters || left(a, b, c) == left(a, b, d) {
                return;
            }
            let (u, v) = (b - a, d - c);
            let t = (c - a).perp_dot(v) / u.perp_dot(v);
            if t.is_finite() {
                let t = t.clamp(0.0, 1.0);
                hits.push(Hit { t, edge, enters });
            }
        });
        if hits.len() < 2 {
            return;
        }
        hits.sort_unstable_by(|p, q| {
            p.t.total_cmp(&q.t).then(p.edge.cmp(&q.edge))
        });
        hits.dedup_by_key(|h| h.edge);
        // A crossing inwards and one outwards at one place cancel.
        let mut i = 0;
        while i + 1 < hits.len() {
            let (p, q) = (hits[i], hits[i + 1]);
            if q.t - p.t < SAME && p.enters != q.enters {
                hits.drain(i..i + 2);
                i = i.saturating_sub(1);
            } else {
                i += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{frame, square_ring};

    #[test]
    fn a_line_across_a_frame_has_two_pieces() {
        let area = frame();
        let border = Border::new(&area);
        let mut cutter = Cutter::new(&border);
        let y = 0.5;
        let points: Vec<DVec2> =
            (-8..=8).map(|x| DVec2::new(f64::from(x), y)).collect();
        cutter.line(&points, false);
        let pieces = cutter.finish();
        let ends: Vec<(f64, f64)> = pieces
            .iter()
            .map(|p| (p.points[0].x, p.points[p.points.len() - 1].x))
            .collect();
        assert_eq!(ends, [(-5.0, -2.0), (2.0, 5.0)]);
        // The outer ring begins at the lower left corner.
        let foot = pieces[1].to.unwrap();
        assert_eq!((foot.ring, foot.at), (0, 15.5));
        let hole = pieces[0].to.unwrap();
        assert_eq!(hole.ring, 1);
        // Lines through the vertices and along the edges: nothing gets lost.
        for y in [-5.0, -2.0, 2.0, 5.0] {
            let mut cutter = Cutter::new(&border);
            cutter.line(&[DVec2::new(-9.0, y), DVec2::new(9.0, y)], false);
            for p in cutter.finish() {
                let x = 0.5 * (p.points[0].x + p.points[1].x);
                assert!(x.abs() < 5.0, "{p:?}");
            }
        }
    }

    #[test]
    fn closed_lines_stay_closed_or_are_cut_once_per_way_out() {
        let area = frame();
        let border = Border::new(&area);
        let circle = |r: f64, x: f64| -> Vec<DVec2> {
            (0..90)
                .map(|i| {
                    DVec2::from_angle(f64::from(i) * 0.0698) * r
                        + DVec2::new(x, 0.0)
                })
                .collect()
        };
        let cut = |points: &[DVec2]| {
            let mut cutter = Cutter::new(&border);
            cutter.line(points, true);
            cutter.finish()
        };
        let whole = cut(&circle(4.0, 0.0));
        assert!(whole.len() == 1 && whole[0].closed);
        assert_eq!(whole[0].points.len(), 90);
        assert!(cut(&circle(1.0, 0.0)).is_empty());
        // From the hole's right side round and back, begun inside the frame.
        let round = cut(&circle(1.5, 2.0));
        assert_eq!(round.len(), 1);
        assert!(!round[0].closed && round[0].from.is_some());
        let (a, b) = (round[0].points[0], *round[0].points.last().unwrap());
        assert!((a.x - 2.0).abs() < 1e-9 && (b.x - 2.0).abs() < 1e-9);
        assert!(a.y < 0.0 && b.y > 0.0);
    }

    #[test]
    fn runs_are_the_same_as_points() {
        let area = frame();
        let border = Border::new(&area);
        let points: Vec<DVec2> = (0..400)
            .map(|i| {
                let t = f64::from(i) * 0.1;
                DVec2::new(0.35 * t - 7.0, 6.0 * (0.7 * t).sin())
            })
            .collect();
        let mut one = Cutter::new(&border);
        one.line(&points, false);
        let mut many = Cutter::new(&border);
        for chunk in points.chunks(7) {
            many.run(chunk, Rect::around(chunk));
        }
        let (one, many) = (one.finish(), many.finish());
        assert!(one.len() > 5);
        assert_eq!(one, many);
    }

    #[test]
    fn the_way_along_a_ring() {
        let area = frame();
        let border = Border::new(&area);
        let foot = |at| BorderPlace { ring: 0, at };
        assert_eq!(border.way(foot(35.0), foot(5.0)), 10.0);
        assert_eq!(
            border.between(foot(35.0), foot(5.0)),
            [square_ring(5.0)[0]]
        );
        assert_eq!(
            border.between(foot(5.0), foot(35.0)),
            square_ring(5.0)[1..]
        );
        assert!(border.between(foot(1.0), foot(2.0)).is_empty());
    }
}

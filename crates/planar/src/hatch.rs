//! Parallel lines across an area.
//!
//! ```text
//!      ╱ ╱╭──╲╱ ╱     lines at `angle`, `spacing` apart, through points
//!     ╱ ╱ │  ╱ ╱      whose distance from the origin across the lines is
//!    ╱ ╱  ╰─╱ ╱       `phase` + a whole number of spacings
//! ```
//!
//! The lines' places depend on angle, spacing and phase alone, so that areas
//! of different islands and layers get lines that continue each other.

use super::border::{Border, LinePiece};
use super::grid::EdgeGrid;
use super::{Area, edges};
use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};

/// Where the lines run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lines {
    /// Direction of the lines.
    pub angle: Degrees,
    /// Distance between neighbouring lines.
    pub spacing: Mm,
    /// Distance of one of the lines from the origin.
    pub phase: Mm,
}

/// A line's piece inside an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Which line: its distance from the origin is phase + row · spacing.
    pub row: i64,
    /// The end with the smaller coordinate along the line.
    pub from: DVec2,
    /// The other end.
    pub to: DVec2,
}

/// The pieces of the lines inside the area, row by row, each row in the
/// lines' direction. Pieces shorter than `shortest` are left out.
pub fn hatch(area: &Area, lines: Lines, shortest: Mm) -> Vec<Segment> {
    let hits = hits(area, lines);
    let pieces = pairs(&hits, shortest);
    pieces.map(|(from, to)| lines.segment(from, to)).collect()
}

/// The pieces of the lines inside the area, each with the number of its row.
/// The pieces know where on the border they end.
pub fn hatch_border(
    border: &Border<'_>,
    lines: Lines,
    shortest: Mm,
) -> Vec<(i64, LinePiece)> {
    let hits = hits(border.area(), lines);
    if isoslice_base::limits::is_stopped() {
        return Vec::new();
    }
    let pieces = pairs(&hits, shortest).map(|(from, to)| {
        let segment = lines.segment(from, to);
        let piece = LinePiece {
            points: vec![segment.from, segment.to],
            closed: false,
            from: Some(border.foot(from.edge, segment.from)),
            to: Some(border.foot(to.edge, segment.to)),
        };
        (segment.row, piece)
    });
    pieces.collect()
}

/// Where a row crosses an edge.
#[derive(Clone, Copy, Debug)]
struct Hit {
    row: i64,
    /// Coordinate along the row.
    along: Mm,
    /// Number of the edge, as a grid of the rings has it.
    edge: usize,
}

impl Lines {
    fn place(&self, row: i64) -> Mm {
        self.phase + row as f64 * self.spacing
    }

    fn segment(&self, from: Hit, to: Hit) -> Segment {
        let along = DVec2::from_angle(self.angle.to_radians());
        let base = along.perp() * self.place(from.row);
        Segment {
            row: from.row,
            from: base + along * from.along,
            to: base + along * to.along,
        }
    }
}

/// Where the rings' edges cross the rows, in the order of the rows.
fn hits(area: &Area, lines: Lines) -> Vec<Hit> {
    let along = DVec2::from_angle(lines.angle.to_radians());
    let across = along.perp();
    let row_of = |v: f64| (v - lines.phase) / lines.spacing;
    // A row through a vertex counts the edge that starts there and goes up,
    // not the one that ends there: `ceil` on both ends does just that.
    let mut hits: Vec<Hit> = Vec::new();
    let mut first = 0;
    let all = area.rings.iter().flat_map(|ring| {
        let own = first;
        first += EdgeGrid::numbers(std::slice::from_ref(ring));
        edges(ring).zip(own..)
    });
    for ((a, b), edge) in all {
        let (va, vb) = (across.dot(a), across.dot(b));
        let (ra, rb) = (row_of(va).ceil() as i64, row_of(vb).ceil() as i64);
        for row in ra.min(rb)..ra.max(rb) {
            let t = (lines.place(row) - va) / (vb - va);
            let along = along.dot(a.lerp(b, t.clamp(0.0, 1.0)));
            hits.push(Hit { row, along, edge });
        }
    }
    hits.sort_unstable_by(|p, q| {
        let by_row = p.row.cmp(&q.row).then(p.along.total_cmp(&q.along));
        by_row.then(p.edge.cmp(&q.edge))
    });
    hits
}

/// The ends of the pieces: a closed ring crosses each row an even number of
/// times.
fn pairs(hits: &[Hit], shortest: Mm) -> impl Iterator<Item = (Hit, Hit)> + '_ {
    hits.chunks_exact(2)
        .map(|h| (h[0], h[1]))
        .filter(move |(from, to)| {
            from.row == to.row && to.along - from.along >= shortest
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::frame;

    #[test]
    fn pieces_know_where_on_the_border_they_end() {
        // Five squares in a row, the last of them with a hole.
        let square = |x: f64, h: f64| -> Vec<DVec2> {
            [(-h, -h), (h, -h), (h, h), (-h, h)]
                .map(|(u, v)| DVec2::new(x + u, v))
                .to_vec()
        };
        let mut rings: Vec<_> =
            (0..5).map(|i| square(10.0 * f64::from(i), 4.0)).collect();
        rings.push(square(40.0, 2.0));
        rings[5].reverse();
        let area = Area { rings };
        let border = Border::new(&area);
        let lines = Lines {
            angle: 30.0,
            spacing: 0.7,
            phase: 0.1,
        };
        let pieces = hatch_border(&border, lines, 0.1);
        assert!(pieces.len() > 60);
        for (_, piece) in pieces {
            let ends = [(piece.from, 0), (piece.to, 1)];
            for (foot, end) in ends {
                let foot = foot.unwrap();
                let ring = &area.rings[foot.ring];
                let side = ring[0].distance(ring[1]);
                let k = (foot.at / side) as usize;
                let on = ring[k % 4]
                    .lerp(ring[(k + 1) % 4], foot.at / side - k as f64);
                assert!(on.distance(piece.points[end]) < 1e-9, "{foot:?}");
            }
        }
    }

    #[test]
    fn lines_fill_the_area_and_spare_the_hole() {
        for angle in [0.0, 45.0, -45.0, 90.0, 17.0] {
            let spacing = 0.01;
            let lines = Lines {
                angle,
                spacing,
                phase: 0.003,
            };
            let segments = hatch(&frame(), lines, 0.0);
            let length: f64 =
                segments.iter().map(|s| s.from.distance(s.to)).sum();
            let content = length * spacing;
            assert!((content - 84.0).abs() < 0.1, "{angle}: {content}");
            for s in &segments {
                let middle = s.from.midpoint(s.to);
                assert!(frame().contains(middle), "{angle}: {middle}");
            }
        }
    }

    #[test]
    fn rows_through_vertices_and_along_edges_pair_up() {
        let lines = Lines {
            angle: 0.0,
            spacing: 1.0,
            phase: 0.0,
        };
        let segments = hatch(&frame(), lines, 0.0);
        let rows: Vec<i64> = segments.iter().map(|s| s.row).collect();
        assert_eq!(rows.first(), Some(&-5));
        for s in segments {
            let whole = s.from.distance(s.to);
            assert!(
                (whole - 10.0).abs() < 1e-9 || (whole - 3.0).abs() < 1e-9,
                "row {} is {whole} long",
                s.row
            );
        }
    }
}

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

use super::{Area, edges};
use crate::units::{Degrees, Mm};
use glam::DVec2;

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
    let along = DVec2::from_angle(lines.angle.to_radians());
    let across = along.perp();
    let row_of = |v: f64| (v - lines.phase) / lines.spacing;
    let place = |row: i64| lines.phase + row as f64 * lines.spacing;
    // Where the rings' edges cross the rows: (row, coordinate along it).
    // A row through a vertex counts the edge that starts there and goes up,
    // not the one that ends there: `ceil` on both ends does just that.
    let mut hits: Vec<(i64, f64)> = Vec::new();
    for (a, b) in area.rings.iter().flat_map(|r| edges(r)) {
        let (va, vb) = (across.dot(a), across.dot(b));
        let (ra, rb) = (row_of(va).ceil() as i64, row_of(vb).ceil() as i64);
        for row in ra.min(rb)..ra.max(rb) {
            let t = (place(row) - va) / (vb - va);
            hits.push((row, along.dot(a.lerp(b, t.clamp(0.0, 1.0)))));
        }
    }
    hits.sort_unstable_by(|p, q| p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)));
    // A closed ring crosses each row an even number of times.
    hits.chunks_exact(2)
        .filter(|h| h[0].0 == h[1].0 && h[1].1 - h[0].1 >= shortest)
        .map(|h| {
            let base = across * place(h[0].0);
            Segment {
                row: h[0].0,
                from: base + along * h[0].1,
                to: base + along * h[1].1,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Area {
        let ring = |h: f64| -> Vec<DVec2> {
            [(-h, -h), (h, -h), (h, h), (-h, h)]
                .map(|(x, y)| DVec2::new(x, y))
                .to_vec()
        };
        let mut hole = ring(2.0);
        hole.reverse();
        Area {
            rings: vec![ring(5.0), hole],
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

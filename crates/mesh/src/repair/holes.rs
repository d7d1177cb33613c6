//! What is missing is closed along its rim.
//!
//! A hole is small by what is around it. An opening that is not, as that of a
//! bowl or the outline of a sheet, may be meant. It stays open: to close it were
//! a guess, and would make a plate where somebody thickens the sheet. What is
//! inside of it is said by covers (see `cover.rs`).

use super::Work;
use crate::edges::each_edge;
use crate::error::MeshError;
use crate::fill::Filler;
use crate::loops::{Missing, loops};
use isoslice_base::limits::go_on;
use isoslice_base::sets::Sets;

/// A cap of no more than this share of the area of what hangs together with its
/// rim closes a hole.
const SMALL: f64 = 0.1;
/// Larger ones do if all caps together have no more than this share. A box
/// without a lid has 0.2, half a ball 0.5, a tube as long as it is wide 0.5, a
/// relief 0.9.
const LARGEST: f64 = 0.4;
/// Parts with larger openings are closed too if all of them together have no more
/// than this share of the area: crumbs of a scan.
const CRUMBS: f64 = 0.01;

/// What was found.
pub(super) struct Holes {
    pub closed: usize,
    /// Edges that are left open.
    pub open_edges: usize,
}

/// A loop, and the triangles that would fill it.
struct Cap {
    triangles: Vec<[u32; 3]>,
    edges: usize,
    /// Its area, and that of what it hangs together with.
    area: f64,
    around: f64,
    part: u32,
    is_hole: bool,
}

pub(super) fn close(work: &mut Work) -> Result<Holes, MeshError> {
    let (missing, areas) = missing(work);
    let whole: f64 = areas.iter().sum();
    let mut filler = Filler::new(&work.vertices);
    let mut caps = Vec::new();
    for (i, found) in loops(&work.vertices, &work.corners, &missing)
        .into_iter()
        .enumerate()
    {
        if i % 1024 == 0 {
            go_on()?;
        }
        let ring: Vec<u32> =
            found.iter().map(|e| missing[*e as usize].from).collect();
        let triangles = filler.fill(&ring)?;
        let area = triangles
            .iter()
            .map(|t| super::area(t.map(|v| work.vertices[v as usize])))
            .sum();
        let (around, part) = found
            .iter()
            .map(|e| missing[*e as usize].part)
            .map(|part| (areas[part as usize], part))
            .fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
        caps.push(Cap {
            triangles,
            edges: found.len(),
            area,
            around,
            part,
            is_hole: false,
        });
    }
    let mut sums = vec![0.0; areas.len()];
    for cap in &caps {
        sums[cap.part as usize] += cap.area;
    }
    for cap in &mut caps {
        let all = sums[cap.part as usize];
        cap.is_hole =
            cap.area <= SMALL * cap.around || all <= LARGEST * cap.around;
    }
    let mut open: Vec<u32> =
        caps.iter().filter(|c| !c.is_hole).map(|c| c.part).collect();
    open.sort_unstable();
    open.dedup();
    let open: f64 = open.iter().map(|part| areas[*part as usize]).sum();
    let are_crumbs = open <= CRUMBS * whole;
    let mut holes = Holes {
        closed: 0,
        open_edges: 0,
    };
    for cap in caps {
        if (cap.is_hole || are_crumbs) && work.has_room(cap.edges) {
            holes.closed += usize::from(cap.area > 0.0);
            cap.triangles.into_iter().for_each(|t| work.add(t));
        } else {
            holes.open_edges += cap.edges;
        }
    }
    Ok(holes)
}

/// The edges along which something is missing, and the areas of parts.
fn missing(work: &Work) -> (Vec<Missing>, Vec<f64>) {
    let mut parts = Sets::new(work.corners.len());
    let mut missing = Vec::new();
    each_edge(&work.corners, work.vertices.len(), |edge| {
        let mut part = 0;
        for (i, side) in edge.sides().enumerate() {
            if i == 0 {
                part = side.triangle;
            } else {
                parts.join(part as usize, side.triangle as usize);
            }
        }
        if let Some((from, to, times)) = edge.excess() {
            for _ in 0..times {
                missing.push(Missing {
                    from: to,
                    to: from,
                    part,
                });
            }
        }
    });
    let mut areas = vec![0.0; work.corners.len()];
    for i in 0..work.corners.len() {
        areas[parts.of(i)] += work.area(i);
    }
    for edge in &mut missing {
        edge.part = parts.of(edge.part as usize) as u32;
    }
    (missing, areas)
}

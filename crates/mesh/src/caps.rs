//! Triangles that close a rim.
//!
//! From each edge of a rim a triangle reaches to the middle of the edges that
//! hang together with it. With them no rim is left, so that a ray counts right.
//!
//! ```text
//!     ______               a hole, and its cap (dotted)
//!    /      \
//!   |        |
//!    \......./
//! ```
//!
//! Caps that are small beside their surface are taken for what is missing there:
//! they are part of it where the question is what is inside, and in sections.
//! They are not where it is how far a place is from the mesh. Large caps, such as
//! those of a single face of a box, say nothing of what is missing: they serve to
//! count, and what they cover is taken off again.

use crate::rim::RimEdge;
use crate::shell::Shell;
use glam::DVec3;
use isoslice_base::sets::Sets;
use std::collections::BTreeMap;

/// Caps are small if all caps of a surface have no more than this share of its
/// area.
const SMALL: f64 = 0.2;

/// Caps, and where their vertices are in the mesh.
#[derive(Debug)]
pub(crate) struct Caps {
    pub shell: Shell,
    /// For each vertex its number in the mesh. Middles have higher ones.
    pub numbers: Vec<u32>,
}

/// The caps of a rim: the small ones, and the others.
pub(crate) fn caps(
    shell: &Shell,
    rim: &[RimEdge],
) -> (Option<Caps>, Option<Caps>) {
    let middles = middles(shell, rim);
    let mut surfaces = Sets::new(shell.vertices.len());
    for &[a, b, c] in &shell.corners {
        surfaces.join(a as usize, b as usize);
        surfaces.join(b as usize, c as usize);
    }
    // Of each surface with a rim: its area, and that of its caps.
    let mut areas: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for edge in rim {
        let [top, to, from] = triangle(shell, &middles, edge);
        let area = (to - top).cross(from - top).length();
        let of = surfaces.of(edge.from as usize);
        areas.entry(of).or_default()[1] += area * f64::from(edge.times);
    }
    for (i, corners) in shell.corners.iter().enumerate() {
        if let Some(of) = areas.get_mut(&surfaces.of(corners[0] as usize)) {
            of[0] += shell.normal(i).length();
        }
    }
    let (small, large): (Vec<RimEdge>, Vec<RimEdge>) =
        rim.iter().partition(|edge| {
            let [all, caps] = areas[&surfaces.of(edge.from as usize)];
            caps <= SMALL * all
        });
    (
        closing(shell, &middles, &small),
        closing(shell, &middles, &large),
    )
}

/// For each vertex of a rim the number and the place of the middle of the edges
/// that hang together there.
fn middles(shell: &Shell, rim: &[RimEdge]) -> BTreeMap<u32, (u32, DVec3)> {
    let mut on_rim: Vec<u32> =
        rim.iter().flat_map(|e| [e.from, e.to]).collect();
    on_rim.sort_unstable();
    on_rim.dedup();
    let place = |v: u32| on_rim.binary_search(&v).unwrap_or_default();
    let mut sets = Sets::new(on_rim.len());
    for edge in rim {
        sets.join(place(edge.from), place(edge.to));
    }
    let mut sums: BTreeMap<usize, (f64, DVec3)> = BTreeMap::new();
    for (i, &v) in on_rim.iter().enumerate() {
        let (count, sum) = sums.entry(sets.of(i)).or_default();
        *count += 1.0;
        *sum += shell.vertices[v as usize];
    }
    let mut tops = BTreeMap::new();
    for (&set, (count, sum)) in &sums {
        let number = (shell.vertices.len() + tops.len()) as u32;
        tops.insert(set, (number, *sum / *count));
    }
    let top = |(i, &v): (usize, &u32)| (v, tops[&sets.of(i)]);
    on_rim.iter().enumerate().map(top).collect()
}

/// The corners of the cap at an edge: the middle, and the edge backwards.
fn triangle(
    shell: &Shell,
    middles: &BTreeMap<u32, (u32, DVec3)>,
    edge: &RimEdge,
) -> [DVec3; 3] {
    let (_, top) = middles[&edge.from];
    let [to, from] = [edge.to, edge.from].map(|v| shell.vertices[v as usize]);
    [top, to, from]
}

/// The caps of some edges.
fn closing(
    shell: &Shell,
    middles: &BTreeMap<u32, (u32, DVec3)>,
    rim: &[RimEdge],
) -> Option<Caps> {
    let mut numbers = Vec::new();
    let mut vertices = Vec::new();
    let mut known = BTreeMap::new();
    let mut corners = Vec::new();
    for edge in rim {
        let places = triangle(shell, middles, edge);
        let (top, _) = middles[&edge.from];
        let mut at = 0;
        let corner = [top, edge.to, edge.from].map(|number| {
            let place = places[at];
            at += 1;
            *known.entry(number).or_insert_with(|| {
                numbers.push(number);
                vertices.push(place);
                numbers.len() as u32 - 1
            })
        });
        corners.extend(std::iter::repeat_n(corner, edge.times as usize));
    }
    if corners.is_empty() {
        return None;
    }
    let (shell, order) = Shell::sorted(vertices, corners);
    let numbers = order.iter().map(|v| numbers[*v as usize]).collect();
    Some(Caps { shell, numbers })
}

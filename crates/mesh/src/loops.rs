//! Rims as loops.
//!
//! In: edges, of which as many start at each vertex as end there. Out: loops that
//! meet no vertex twice.
//!
//! Where several loops meet at a vertex, the edges around it say which belong
//! together: the hole is on the left of its loop. So an edge that starts there is
//! paired with the next one that ends there, counter-clockwise as seen from
//! outside, as brackets are.

use glam::DVec3;

/// No number.
const NONE: u32 = u32::MAX;

/// An edge along which something is missing, on its left as seen from outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Missing {
    pub from: u32,
    pub to: u32,
    /// A number for the triangles that hang together there.
    pub part: u32,
}

/// Loops, as numbers of edges.
pub(crate) fn loops(
    vertices: &[DVec3],
    corners: &[[u32; 3]],
    edges: &[Missing],
) -> Vec<Vec<u32>> {
    let next = followers(vertices, corners, edges);
    let mut place = vec![NONE; vertices.len()];
    let mut is_used = vec![false; edges.len()];
    let mut loops = Vec::new();
    let mut path: Vec<u32> = Vec::new();
    for first in 0..edges.len() {
        let mut at = first;
        while edges.len() > at && !is_used[at] {
            is_used[at] = true;
            place[edges[at].from as usize] = path.len() as u32;
            path.push(at as u32);
            let back = place[edges[at].to as usize];
            if back != NONE {
                let found = path.split_off(back as usize);
                for edge in &found {
                    place[edges[*edge as usize].from as usize] = NONE;
                }
                loops.push(found);
            }
            at = next[at] as usize;
        }
        for edge in path.drain(..) {
            place[edges[edge as usize].from as usize] = NONE;
        }
    }
    loops
}

/// For each edge the one that goes on where it ends.
fn followers(
    vertices: &[DVec3],
    corners: &[[u32; 3]],
    edges: &[Missing],
) -> Vec<u32> {
    let mut ends: Vec<(u32, bool, u32)> = Vec::with_capacity(2 * edges.len());
    for (i, edge) in edges.iter().enumerate() {
        ends.push((edge.from, true, i as u32));
        ends.push((edge.to, false, i as u32));
    }
    ends.sort_unstable();
    let crowded: Vec<u32> = ends
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|at| at.len() > 2)
        .map(|at| at[0].0)
        .collect();
    let normals = normals(vertices, corners, &crowded);
    let mut next = vec![NONE; edges.len()];
    for at in ends.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, false, ending), (_, true, starting)] = at {
            next[*ending as usize] = *starting;
        } else if let Ok(i) = crowded.binary_search(&at[0].0) {
            pair(vertices, edges, at, normals[i], &mut next);
        }
    }
    next
}

/// The sums of the normals of the triangles at some vertices, given in order.
fn normals(
    vertices: &[DVec3],
    corners: &[[u32; 3]],
    some: &[u32],
) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; some.len()];
    if some.is_empty() {
        return normals;
    }
    for corners in corners {
        for corner in corners {
            if let Ok(at) = some.binary_search(corner) {
                let [a, b, c] = corners.map(|v| vertices[v as usize]);
                normals[at] += (b - a).cross(c - a);
            }
        }
    }
    normals
}

/// Pairs the edges that end at a vertex with those that start there.
fn pair(
    vertices: &[DVec3],
    edges: &[Missing],
    at: &[(u32, bool, u32)],
    normal: DVec3,
    next: &mut [u32],
) {
    let middle = vertices[at[0].0 as usize];
    let across = normal.try_normalize().unwrap_or(DVec3::Z);
    let x = across.any_orthonormal_vector();
    let y = across.cross(x);
    let mut around: Vec<(f64, bool, u32)> = at
        .iter()
        .map(|&(_, starts, i)| {
            let edge = edges[i as usize];
            let other = if starts { edge.to } else { edge.from };
            let way = vertices[other as usize] - middle;
            (libm::atan2(way.dot(y), way.dot(x)), starts, i)
        })
        .collect();
    // Of two in the same direction the one that starts is first: a crack.
    around.sort_unstable_by(|a, b| {
        a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)).then(a.2.cmp(&b.2))
    });
    // From where no bracket is open.
    let (mut depth, mut least, mut start) = (0, 0, 0);
    for (k, (_, starts, _)) in around.iter().enumerate() {
        depth += if *starts { 1 } else { -1 };
        if depth < least {
            (least, start) = (depth, k + 1);
        }
    }
    around.rotate_left(start % at.len());
    let mut open = Vec::new();
    for (_, starts, i) in around {
        if starts {
            open.push(i);
        } else if let Some(starting) = open.pop() {
            next[i as usize] = starting;
        }
    }
}

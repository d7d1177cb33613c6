//! Edges at which triangles do not meet their neighbours.
//!
//! In: triangles. Out: their rim, the edges that are gone along more often one
//! way than the other. Without a rim the triangles bound a body, however they
//! cross or double one another. Then winding numbers are whole.

/// An edge of the rim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RimEdge {
    /// The vertices, in the direction of the triangle that is there.
    pub from: u32,
    pub to: u32,
    /// How often it is there.
    pub times: u32,
}

/// The rim of triangles.
pub(crate) fn rim(corners: &[[u32; 3]], vertices: usize) -> Vec<RimEdge> {
    // Edges by their lower vertex: the upper one, and the direction.
    let mut starts = vec![0u32; vertices + 1];
    for (a, b) in edges(corners) {
        starts[a.min(b) as usize + 1] += 1;
    }
    for i in 0..vertices {
        starts[i + 1] += starts[i];
    }
    let mut uppers = vec![0u32; 3 * corners.len()];
    let mut next = starts.clone();
    for (a, b) in edges(corners) {
        let (low, high) = (a.min(b), a.max(b));
        let place = &mut next[low as usize];
        uppers[*place as usize] = 2 * high + u32::from(a > b);
        *place += 1;
    }
    drop(next);
    let mut rim = Vec::new();
    for low in 0..vertices {
        let list = &mut uppers[starts[low] as usize..starts[low + 1] as usize];
        list.sort_unstable();
        for same in list.chunk_by(|a, b| a / 2 == b / 2) {
            let down = same.iter().filter(|e| **e % 2 == 1).count();
            let up = same.len() - down;
            let (low, high) = (low as u32, same[0] / 2);
            let (from, to) = if up > down { (low, high) } else { (high, low) };
            if up != down {
                rim.push(RimEdge {
                    from,
                    to,
                    times: up.abs_diff(down) as u32,
                });
            }
        }
    }
    rim
}

/// The edges of triangles, in their directions.
fn edges(corners: &[[u32; 3]]) -> impl Iterator<Item = (u32, u32)> {
    corners
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
}

//! The edges of triangles.

/// A triangle at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Side {
    pub triangle: u32,
    /// True if the triangle goes from the upper vertex to the lower one.
    pub is_down: bool,
}

/// An edge, and the triangles that share it.
#[derive(Debug)]
pub(crate) struct Edge<'a> {
    pub low: u32,
    pub high: u32,
    /// The upper vertex, the triangle and the direction, as bits.
    sides: &'a [u64],
}

impl Edge<'_> {
    /// The number of triangles.
    pub(crate) fn count(&self) -> usize {
        self.sides.len()
    }

    /// The triangles, by their numbers.
    pub(crate) fn sides(&self) -> impl Iterator<Item = Side> + Clone {
        self.sides.iter().map(|bits| Side {
            triangle: (*bits as u32) >> 1,
            is_down: bits & 1 == 1,
        })
    }

    /// The vertices in the direction in which more triangles go, and how many
    /// more. None if as many go one way as the other.
    pub(crate) fn excess(&self) -> Option<(u32, u32, u32)> {
        let down = self.sides().filter(|s| s.is_down).count();
        let up = self.count() - down;
        let more = up.abs_diff(down) as u32;
        match up.cmp(&down) {
            std::cmp::Ordering::Equal => None,
            std::cmp::Ordering::Greater => Some((self.low, self.high, more)),
            std::cmp::Ordering::Less => Some((self.high, self.low, more)),
        }
    }
}

/// Calls `see` for each edge, in the order of the lower and the upper vertex.
pub(crate) fn each_edge(
    corners: &[[u32; 3]],
    vertices: usize,
    mut see: impl FnMut(Edge<'_>),
) {
    let mut starts = vec![0u32; vertices + 1];
    for &[a, b, c] in corners {
        for low in [a.min(b), b.min(c), c.min(a)] {
            starts[low as usize + 1] += 1;
        }
    }
    for i in 0..vertices {
        starts[i + 1] += starts[i];
    }
    let mut sides = vec![0u64; 3 * corners.len()];
    for (triangle, &[a, b, c]) in corners.iter().enumerate() {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            let place = &mut starts[a.min(b) as usize];
            sides[*place as usize] = u64::from(a.max(b)) << 32
                | (triangle as u64) << 1
                | u64::from(a > b);
            *place += 1;
        }
    }
    // Each start is now where the next list starts.
    starts.pop();
    let mut start = 0;
    for (low, end) in starts.into_iter().enumerate() {
        let list = &mut sides[start..end as usize];
        start = end as usize;
        list.sort_unstable();
        for same in list.chunk_by(|a, b| a >> 32 == b >> 32) {
            see(Edge {
                low: low as u32,
                high: (same[0] >> 32) as u32,
                sides: same,
            });
        }
    }
}

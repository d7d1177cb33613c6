//! Finds the pixels at edges.
//!
//! In: pixels with one sample each. Out: those that look different from one
//! beside them. There an outline, a crease or a step passes, and one sample is
//! not the pixel's mean. Where a picture is the same on both sides of an edge,
//! nobody sees the edge.

/// Difference between two pixels beside each other that shows, as a share of
/// the whole range from black to white. Bent surfaces change less from pixel to
/// pixel, and with 0.04 no picture looks different.
const SHOWS: f32 = 0.06;

/// The pixels at edges, of some rows of a picture.
pub(super) struct Edges {
    width: usize,
    /// The first row.
    first: usize,
    /// For each pixel whether it is at an edge.
    marks: Vec<bool>,
}

impl Edges {
    /// The edges within some rows, which begin with `first`. A pixel has its
    /// linear colour, multiplied by its opacity, and its opacity.
    pub(super) fn new(
        pixels: &[[f32; 4]],
        width: usize,
        first: usize,
    ) -> Edges {
        let looks: Vec<[f32; 4]> = pixels.iter().map(look).collect();
        let mut marks = vec![false; looks.len()];
        let mut compare = |a: usize, b: usize| {
            if differ(&looks[a], &looks[b]) {
                (marks[a], marks[b]) = (true, true);
            }
        };
        for k in 0..looks.len() {
            if (k + 1) % width != 0 {
                compare(k, k + 1);
            }
            if k + width < looks.len() {
                compare(k, k + width);
            }
        }
        Edges {
            width,
            first,
            marks,
        }
    }

    /// True if the pixel in this column and row of the picture is at an edge.
    pub(super) fn has(&self, x: usize, y: usize) -> bool {
        let row = y.checked_sub(self.first);
        let pixel = row.map(|row| row * self.width + x);
        pixel.and_then(|pixel| self.marks.get(pixel)) == Some(&true)
    }
}

/// Colour and opacity, such that equal differences look about equally large.
fn look(pixel: &[f32; 4]) -> [f32; 4] {
    let [r, g, b, a] = pixel.map(|c| c.clamp(0.0, 1.0));
    // The root is close to the curve of sRGB.
    [r.sqrt(), g.sqrt(), b.sqrt(), a]
}

fn differ(a: &[f32; 4], b: &[f32; 4]) -> bool {
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > SHOWS)
}

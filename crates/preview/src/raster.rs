//! Finds the visible surface of a part and its supports: depths and normals.
//!
//! In: a placed model, the faces of its supports, a view, a size. Out: for each
//! pixel how far part and supports reach towards the viewer, and where their
//! surface faces. The part's surface comes from the field.
//!
//! Details thinner than the distance between samples may be missed. The result
//! does not depend on the number of threads.

use super::slabs::{Face, NONE, Slabs};
use super::view::View;
use fidget::context::Tree;
use glam::{DMat3, DVec2, DVec3, Vec2, Vec3};
use isocontour::{FieldError, Grid, Hit, Sight};
use isoslice_base::limits::{self, Cancelled};
use isoslice_base::parallel;
use isoslice_base::units::Mm;
use isoslice_model::{Bounds, Model};
use isoslice_planar::hull;
use std::ops::Range;
use std::sync::Arc;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The field cannot be evaluated.
    #[error("the part cannot be drawn")]
    Field(#[from] FieldError),
    /// The watch has stopped the work.
    #[error(transparent)]
    Stopped(#[from] Cancelled),
    /// The picture cannot be encoded as PNG.
    #[error("the picture cannot be written as PNG")]
    Png(#[from] png::EncodingError),
    /// The picture cannot be encoded as QOI.
    #[error("the picture cannot be written as QOI")]
    Qoi(#[from] qoi::Error),
    /// The picture cannot be encoded as JPG.
    #[error("the picture cannot be written as JPG")]
    Jpg(#[from] jpeg_encoder::EncodingError),
}

/// What is seen beside the part and its supports is infinitely far behind them.
pub(super) const BESIDE: f32 = f32::NEG_INFINITY;

/// True for the depth of a pixel that shows the part or its supports.
pub(super) fn is_part(depth: &f32) -> bool {
    *depth != BESIDE
}

/// Depths and normals of the visible surface.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Seen {
    pub width: usize,
    pub height: usize,
    /// Depths towards the viewer, in pixels; [`BESIDE`] beside the part.
    pub depths: Vec<f32>,
    /// Normals, of length 1, along right, up and towards the viewer.
    pub normals: Vec<Vec3>,
    /// For each pixel whether it shows a support; empty if there are none.
    pub supports: Vec<bool>,
    /// Position of the first pixel of the first row at depth 0, mm.
    origin: DVec3,
    /// Number of samples along each line, and their distance.
    along: (usize, Mm),
    /// Side of a pixel.
    pub pixel: Mm,
    /// The directions right, up and towards the viewer.
    pub axes: DMat3,
}

impl Seen {
    /// Pixels of a frame.
    fn of(frame: &Frame, axes: DMat3) -> Seen {
        let [width, height, depth] = frame.size;
        let back = DVec3::new(
            0.5 - 0.5 * width as f64,
            0.5 * height as f64 - 0.5,
            -0.5 * depth as f64 * frame.step / frame.pixel,
        );
        Seen {
            width,
            height,
            depths: Vec::new(),
            normals: Vec::new(),
            supports: Vec::new(),
            // A pixel is sampled at its middle.
            origin: frame.centre + axes * back * frame.pixel,
            along: (depth, frame.step),
            pixel: frame.pixel,
            axes,
        }
    }

    /// Some rows, with `finer` × `finer` pixels for each.
    fn split(&self, rows: &Range<usize>, finer: usize) -> Seen {
        // Near the outline of an edge the lines of sight are in the part for less
        // than a pixel. With thirds instead of halves, fine lattices take a sixth
        // longer and look the same.
        const DEEPER: usize = 2;
        let (count, step) = self.along;
        let side = 1.0 / finer as f64;
        let to_first = 0.5 * side - 0.5;
        let first = DVec3::new(to_first, rows.start as f64 + to_first, 0.0);
        Seen {
            width: finer * self.width,
            height: finer * rows.len(),
            depths: Vec::new(),
            normals: Vec::new(),
            supports: Vec::new(),
            origin: self.place(first),
            along: (DEEPER * count, step / DEEPER as f64),
            pixel: self.pixel * side,
            axes: self.axes,
        }
    }

    /// The samples.
    fn grid(&self) -> Grid {
        let (depth, step) = self.along;
        Grid {
            origin: self.origin,
            steps: [
                self.axes.x_axis * self.pixel,
                -self.axes.y_axis * self.pixel,
                self.axes.z_axis * step,
            ],
            size: [self.width, self.height, depth],
        }
    }

    /// Position of a column, row and depth, mm.
    pub(super) fn place(&self, at: DVec3) -> DVec3 {
        let at = at * DVec3::new(1.0, -1.0, 1.0);
        self.origin + self.axes * at * self.pixel
    }

    /// The column, row and depth of a position, mm.
    fn at(&self, place: DVec3) -> DVec3 {
        let down = DVec3::new(1.0, -1.0, 1.0);
        self.axes.transpose() * (place - self.origin) / self.pixel * down
    }

    /// The pixels of a face: those whose middles lie in it.
    fn pixels(&self, face: &Face) -> Pixels {
        let rings: Vec<Vec<DVec3>> = face
            .rings
            .iter()
            .map(|ring| ring.iter().map(|p| self.at(*p)).collect())
            .collect();
        let normal = self.axes.transpose() * face.normal;
        let mut pixels = Pixels {
            normal: normal.as_vec3(),
            range: [0.0; 2],
            spans: Vec::new(),
        };
        let all = || rings.iter().flatten();
        let Some(&base) = all().next() else {
            return pixels;
        };
        let least = all().fold(base, |a, p| a.min(*p));
        let most = all().fold(base, |a, p| a.max(*p));
        pixels.range = [least.z as f32, most.z as f32];
        let (low, high) = (least.y, most.y);
        // Of each row the columns at which the border crosses its middle line.
        let rows =
            low.ceil().max(0.0)..(high.floor() + 1.0).min(self.height as f64);
        let mut crossed =
            vec![Vec::new(); (rows.end - rows.start).max(0.0) as usize];
        for ring in &rings {
            for (k, &a) in ring.iter().enumerate() {
                let b = ring[(k + 1) % ring.len()];
                let (from, to) = if a.y < b.y { (a, b) } else { (b, a) };
                let first = (from.y.ceil() - rows.start).max(0.0) as usize;
                for (j, row) in crossed.iter_mut().enumerate().skip(first) {
                    let y = rows.start + j as f64;
                    if y >= to.y {
                        break;
                    }
                    let share = (y - from.y) / (to.y - from.y);
                    row.push(from.x + share * (to.x - from.x));
                }
            }
        }
        // The depth rises along a row and down the rows. Rows count downwards.
        let rise = DVec2::new(-normal.x, normal.y) / normal.z;
        for (j, row) in crossed.iter_mut().enumerate() {
            row.sort_by(f64::total_cmp);
            let y = rows.start + j as f64;
            for pair in row.chunks_exact(2) {
                let first = pair[0].ceil().max(0.0);
                let end = pair[1].ceil().min(self.width as f64);
                if first < end {
                    let from_base = DVec2::new(first, y) - base.truncate();
                    pixels.spans.push(Span {
                        first: y as usize * self.width + first as usize,
                        count: (end - first) as usize,
                        depth: (base.z + rise.dot(from_base)) as f32,
                        rise: rise.x as f32,
                    });
                }
            }
        }
        pixels
    }

    /// Draws supports, moved by `way`, where nothing is nearer to the viewer.
    fn draw(&mut self, supports: &Slabs, way: DVec3) {
        if !supports.is_empty() {
            self.supports.resize(self.depths.len(), false);
        }
        let towards = self.axes.z_axis;
        for slabs in supports.chunks() {
            if isoslice_base::limits::is_stopped() {
                return;
            }
            let all = parallel::map(slabs.len(), |i| -> Vec<Pixels> {
                let faces = slabs[i].faces(way, towards);
                faces.iter().map(|face| self.pixels(face)).collect()
            });
            all.iter().flatten().for_each(|face| self.cover(face));
        }
    }

    fn cover(&mut self, face: &Pixels) {
        for span in &face.spans {
            for k in 0..span.count {
                // The depth of a face that is seen nearly edge-on rises
                // steeply.
                let at = span.first + k;
                let [low, high] = face.range;
                let depth = span.depth + k as f32 * span.rise;
                let depth = depth.max(low).min(high);
                if depth > self.depths[at] {
                    self.depths[at] = depth;
                    self.normals[at] = face.normal;
                    self.supports[at] = true;
                }
            }
        }
    }

    /// The depth of the pixel that has a column and row in it; [`BESIDE`] beside
    /// the part, nothing outside the picture.
    pub(super) fn depth(&self, at: Vec2) -> Option<f32> {
        let inside = at.min_element() >= 0.0 && at.x < self.width as f32;
        let pixel = inside.then(|| at.y as usize * self.width + at.x as usize);
        self.depths.get(pixel?).copied()
    }

    /// True if a pixel shows a support.
    pub(super) fn is_support(&self, pixel: usize) -> bool {
        self.supports.get(pixel) == Some(&true)
    }

    /// The map from a place's column, row and depth to those in another view: a
    /// matrix and an offset.
    pub(super) fn to(&self, other: &Seen) -> (DMat3, DVec3) {
        // Rows count downwards.
        let down = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
        let into = down * other.axes.transpose() * (1.0 / other.pixel);
        let turn = into * self.axes * down * self.pixel;
        (turn, into * (self.origin - other.origin))
    }
}

/// The pixels of a flat face.
struct Pixels {
    /// The face's normal, along right, up and towards the viewer.
    normal: Vec3,
    /// The face's least and greatest depth, pixels.
    range: [f32; 2],
    spans: Vec<Span>,
}

/// Pixels of a face in a row.
struct Span {
    /// The first pixel's number, row by row.
    first: usize,
    count: usize,
    /// Depth of the first pixel, and its rise from each pixel to the next.
    depth: f32,
    rise: f32,
}

/// Pixels of the first, coarse view along its longer side.
const COARSE: usize = 128;
/// Free border, as a share of the picture.
const MARGIN: f64 = 0.04;
/// Greatest number of samples along the view, as a multiple of the longer side.
const DEEPEST: f64 = 4.0;
/// Greatest number of pixels of a light's view along its longer side. Shadows of
/// larger pictures are as soft, as a share of the picture, as those of smaller ones.
const LONGEST_MAP: f64 = 2048.0;

/// A part that is viewed, and its supports.
pub(super) struct Subject<'a> {
    sight: Arc<Sight>,
    supports: &'a Slabs,
    /// Way from the bed's coordinates to the model's.
    from_bed: DVec3,
    axes: DMat3,
    /// The box of part and supports.
    bounds: Bounds,
    /// Half of the box along the view's axes.
    half: DVec3,
}

/// The space that is sampled, and how finely.
#[derive(Clone, Copy, Debug)]
struct Frame {
    centre: DVec3,
    /// Number of samples to the right, down, and towards the viewer.
    size: [usize; 3],
    /// Side of a pixel.
    pixel: Mm,
    /// Distance of samples along the view.
    step: Mm,
}

impl<'a> Subject<'a> {
    /// `model`, as it will be printed, with its supports, seen from `view`.
    pub(super) fn new(
        model: &Model,
        supports: &'a Slabs,
        view: View,
    ) -> Result<Self, PictureError> {
        let mut subject = Subject::at_most(u64::MAX, model, view)?;
        if let Some(standing) = supports.bounds() {
            let standing = standing.moved(subject.from_bed);
            subject = Subject {
                supports,
                ..subject.of(view.axes(), subject.bounds.union(standing))
            };
        }
        Ok(subject)
    }

    /// `model` without supports. Sampling fails once it has taken so many
    /// `operations`.
    pub(super) fn at_most(
        operations: u64,
        model: &Model,
        view: View,
    ) -> Result<Self, PictureError> {
        let mut bounds = model.bounds;
        let mut tree = model.tree.clone();
        let bed = -model.offset.z;
        if bounds.min.z < bed {
            let (_, _, z) = Tree::axes();
            tree = tree.max(Tree::constant(bed as f32) - z);
            bounds.min.z = bed;
        }
        let sight = Sight::new(&tree)?
            .at_most(operations)
            .with_cancel(limits::Watch::hook());
        let subject = Subject {
            sight: Arc::new(sight),
            supports: &NONE,
            from_bed: -model.offset,
            axes: view.axes(),
            bounds,
            half: DVec3::ZERO,
        };
        Ok(subject.of(view.axes(), bounds))
    }

    /// The subject within a box, seen along some axes.
    fn of(&self, axes: DMat3, bounds: Bounds) -> Subject<'a> {
        let corner = |i: i32| {
            let side = |k| if i >> k & 1 == 0 { -0.5 } else { 0.5 };
            let corner = bounds.size() * DVec3::new(side(0), side(1), side(2));
            (axes.transpose() * corner).abs()
        };
        Subject {
            sight: self.sight.clone(),
            supports: self.supports,
            from_bed: self.from_bed,
            axes,
            bounds,
            half: (0..8).map(corner).fold(DVec3::ZERO, DVec3::max),
        }
    }

    /// The whole part as seen from a light, whose direction is given as right,
    /// up and towards the viewer. Pixels have about the side `pixel`.
    pub(super) fn seen_by(
        &self,
        light: DVec3,
        pixel: Mm,
    ) -> Result<Seen, PictureError> {
        let towards = (self.axes * light).normalize();
        let (right, up) = towards.any_orthonormal_pair();
        let axes = DMat3::from_cols(right, up, towards);
        let lit = self.of(axes, self.bounds);
        let widest = 2.0 * lit.half.x.max(lit.half.y).max(MIN_EXTENT);
        let longest = (widest / pixel).ceil().clamp(1.0, LONGEST_MAP);
        let seen = lit.look(lit.whole(longest as usize))?;
        // The light's view of the part needs no normals: it only tells what is
        // in shadow.
        let normals = Vec::new();
        Ok(Seen { normals, ..seen })
    }

    /// The part, as large as fits `width` × `height` pixels.
    pub(super) fn fitted(
        &self,
        width: usize,
        height: usize,
    ) -> Result<Seen, PictureError> {
        let coarse = self.whole(COARSE);
        let seen = self.look(coarse)?;
        let frame = self.around(&coarse, &seen, [width, height]);
        self.look(frame)
    }

    /// A frame around the part's whole box.
    fn whole(&self, longest: usize) -> Frame {
        let pixel =
            2.0 * self.half.x.max(self.half.y).max(MIN_EXTENT) / longest as f64;
        let count = |half: f64| (2.0 * half / pixel).ceil().max(1.0) as usize;
        let depth = (count(self.half.z) + 2).min(depth_limit(longest));
        Frame {
            centre: self.bounds.centre(),
            // One more pixel on every side makes a border.
            size: [count(self.half.x) + 2, count(self.half.y) + 2, depth],
            pixel,
            step: (2.0 * self.half.z + 2.0 * pixel) / depth as f64,
        }
    }

    /// A frame of a size around what a coarser view has seen.
    fn around(&self, coarse: &Frame, seen: &Seen, size: [usize; 2]) -> Frame {
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        for (i, depth) in seen.depths.iter().enumerate() {
            if is_part(depth) {
                let at = [i % seen.width, i / seen.width];
                for k in 0..2 {
                    low[k] = low[k].min(at[k]);
                    high[k] = high[k].max(at[k]);
                }
            }
        }
        if low[0] > high[0] {
            (low, high) = ([0; 2], [seen.width - 1, seen.height - 1]);
        }
        // Thin details may reach into the pixels beside.
        let side = |k: usize| (high[k] - low[k] + 3) as f64 * coarse.pixel;
        let middle =
            |k: usize| 0.5 * (low[k] + high[k] + 1) as f64 * coarse.pixel;
        let half = |k: usize| 0.5 * coarse.size[k] as f64 * coarse.pixel;
        let centre = coarse.centre + self.axes.x_axis * (middle(0) - half(0))
            - self.axes.y_axis * (middle(1) - half(1));
        let room = |k: usize| size[k] as f64 * (1.0 - 2.0 * MARGIN);
        let pixel = (side(0) / room(0)).max(side(1) / room(1));
        let deep = 2.0 * self.half.z + 2.0 * pixel;
        let longest = size[0].max(size[1]);
        let depth = (deep / pixel).ceil().min(depth_limit(longest) as f64);
        Frame {
            centre,
            size: [size[0], size[1], depth as usize],
            pixel,
            step: deep / depth,
        }
    }

    fn look(&self, frame: Frame) -> Result<Seen, PictureError> {
        let mut seen = Seen::of(&frame, self.axes);
        self.fill(&mut seen, &|_, _| u64::MAX)?;
        Ok(seen)
    }

    /// Some rows of what was seen, with `finer` × `finer` pixels for each, as
    /// far as a pixel, given by its column and its row in `seen`, is `wanted`.
    pub(super) fn closer(
        &self,
        seen: &Seen,
        rows: Range<usize>,
        finer: usize,
        wanted: &(dyn Fn(usize, usize) -> bool + Sync),
    ) -> Result<Seen, PictureError> {
        let mut strip = seen.split(&rows, finer);
        // A bit for each column of the strip, in words of 64, by rows of `seen`.
        let words = strip.width.div_ceil(64);
        let mut marks = vec![0u64; words * rows.len()];
        for (line, row) in marks.chunks_exact_mut(words.max(1)).zip(rows) {
            let pixels = (0..seen.width).filter(|x| wanted(*x, row));
            for i in pixels.flat_map(|x| finer * x..finer * (x + 1)) {
                line[i / 64] |= 1 << (i % 64);
            }
        }
        let wanted = |i, j| marks[j / finer * words + i / 64];
        self.fill(&mut strip, &wanted)?;
        Ok(strip)
    }

    /// Fills the pixels that are `wanted` ([`Sight::look_by_rows`]) with what is
    /// seen there.
    fn fill(
        &self,
        seen: &mut Seen,
        wanted: &(dyn Fn(usize, usize) -> u64 + Sync),
    ) -> Result<(), PictureError> {
        limits::go_on()?;
        let scale = (seen.along.1 / seen.pixel) as f32;
        let from_model = self.axes.transpose().as_mat3();
        let normal = |gradient: Vec3| {
            let n = from_model * gradient;
            // Where the normal is not known, the surface faces the viewer.
            n.try_normalize().unwrap_or(Vec3::Z)
        };
        let grid = seen.grid();
        let (mut depths, mut normals) = (Vec::new(), Vec::new());
        depths.reserve_exact(seen.width * seen.height);
        normals.reserve_exact(seen.width * seen.height);
        let looked = self.sight.look_by_rows(&grid, wanted, &mut |row| {
            let depth = |h: &Option<Hit>| h.map_or(BESIDE, |h| h.depth * scale);
            depths.extend(row.iter().map(depth));
            let normal =
                |h: &Option<Hit>| h.map_or(Vec3::ZERO, |h| normal(h.gradient));
            normals.extend(row.iter().map(normal));
        });
        looked?;
        (seen.depths, seen.normals) = (depths, normals);
        seen.draw(self.supports, self.from_bed);
        Ok(())
    }
}

/// Least thickness of a part that is drawn, mm.
const MIN_EXTENT: Mm = 1e-6;

fn depth_limit(longest: usize) -> usize {
    (DEEPEST * longest as f64) as usize
}

/// A convex ring around the part as seen from above, in the bed's coordinates,
/// counter-clockwise. It is no farther from the part than 0.01 of the part's
/// size.
///
/// # Errors
/// If fidget refuses the expression.
pub fn outline_from_above(model: &Model) -> Result<Vec<DVec2>, PictureError> {
    // The ring is half a pixel outside.
    const PIXELS: usize = 100;
    let view = View::of(-90.0, 90.0);
    let subject = Subject::new(model, &NONE, view)?;
    let frame = subject.whole(PIXELS);
    let seen = subject.look(frame)?;
    let printed = model.printed_bounds();
    let (low, high) = (printed.min.truncate(), printed.max.truncate());
    let middle = (subject.bounds.centre() + model.offset).truncate();
    let half = 0.5 * DVec2::new(seen.width as f64, seen.height as f64);
    let place = |i: usize, j: usize| {
        let p = DVec2::new(i as f64, j as f64) - half;
        middle + frame.pixel * DVec2::new(p.x, -p.y)
    };
    let corners = seen.depths.iter().enumerate().filter(|(_, d)| is_part(d));
    let corners = corners.flat_map(|(k, _)| {
        let (i, j) = (k % seen.width, k / seen.width);
        [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
    });
    let mut ring = hull(corners.map(|(i, j)| place(i, j).clamp(low, high)));
    // Labels of parts begin with this corner, in every version so far.
    if !ring.is_empty() {
        ring.rotate_right(1);
    }
    Ok(ring)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "helpers of tests may unwrap, too")]
mod tests {
    use super::*;
    use isoslice_model::{Placement, placed};

    fn seen(formula: &str, view: View, size: [usize; 2]) -> Seen {
        let subject =
            Subject::new(&placed(formula, &Placement::default()), &NONE, view);
        subject.unwrap().fitted(size[0], size[1]).unwrap()
    }

    fn hits(seen: &Seen) -> usize {
        seen.depths.iter().filter(|d| is_part(d)).count()
    }

    /// Left, right, top and bottom ends of the visible part, in pixels.
    fn extent(seen: &Seen) -> [usize; 4] {
        let at = |k: usize| (k % seen.width, k / seen.width);
        let all = seen.depths.iter().enumerate();
        let all: Vec<_> = all
            .filter(|(_, d)| is_part(d))
            .map(|(k, _)| at(k))
            .collect();
        [
            all.iter().map(|p| p.0).min().unwrap(),
            all.iter().map(|p| p.0).max().unwrap() + 1,
            all.iter().map(|p| p.1).min().unwrap(),
            all.iter().map(|p| p.1).max().unwrap() + 1,
        ]
    }

    const BALL: &str = "sqrt(x^2 + y^2 + z^2) - 10";

    #[test]
    fn a_ball_is_a_disc_with_its_normals() {
        for (name, view) in View::NAMED {
            let seen = seen(BALL, view, [200, 300]);
            let [left, right, top, bottom] = extent(&seen);
            // Centred, with a border of 4 % and a coarse pixel.
            assert!((left + right).abs_diff(200) <= 1, "{name}");
            assert!((top + bottom).abs_diff(300) <= 1, "{name}");
            let diameter = right - left;
            assert!((176..=184).contains(&diameter), "{name} {diameter}");
            let r = 0.5 * diameter as f64;
            let disc = std::f64::consts::PI * r * r;
            let share = hits(&seen) as f64 / disc;
            assert!((share - 1.0).abs() < 0.02, "{name} {share}");
            for (k, depth) in seen.depths.iter().enumerate() {
                if !is_part(depth) {
                    continue;
                }
                let p = DVec2::new((k % 200) as f64, (k / 200) as f64);
                let p = (p - DVec2::new(99.5, 149.5)) / r;
                let n = seen.normals[k];
                let off = DVec2::new(n.x.into(), -f64::from(n.y)) - p;
                assert!(off.length() < 0.15, "{name} {p} {n}");
            }
        }
    }

    /// 40 × 20 × 10, with a post at its right, front, upper corner.
    const BLOCK: &str = "min(max(max(abs(x) - 20, abs(y) - 10), abs(z) - 5), \
         max(max(abs(x - 19) - 1, abs(y + 9) - 1), abs(z - 9) - 4))";

    #[test]
    fn views_show_the_side_they_name() {
        let shape = |name: &str| {
            let view = View::NAMED.iter().find(|(n, _)| *n == name).unwrap().1;
            let seen = seen(BLOCK, view, [300, 300]);
            let [left, right, top, bottom] = extent(&seen);
            let row = |j: usize| {
                let row = &seen.depths[j * 300..(j + 1) * 300];
                row.iter().position(is_part).unwrap()
            };
            let post_right = row(top + 3) > (left + right) / 2;
            let aspect = (right - left) as f64 / (bottom - top) as f64;
            (aspect, post_right)
        };
        let about = |a: f64, b: f64| (a / b - 1.0).abs() < 0.03;
        let (aspect, post_right) = shape("front");
        assert!(about(aspect, 40.0 / 18.0) && post_right, "{aspect}");
        let (aspect, post_right) = shape("back");
        assert!(about(aspect, 40.0 / 18.0) && !post_right, "{aspect}");
        // From the right the front is on the left.
        let (aspect, post_right) = shape("right");
        assert!(about(aspect, 20.0 / 18.0) && !post_right, "{aspect}");
        assert!(shape("left").1);
        assert!(about(shape("top").0, 2.0) && about(shape("bottom").0, 2.0));
    }

    #[test]
    fn threads_do_not_show() {
        let formula = "sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x) + \
                       max(0, x^2 + y^2 + z^2 - 80) / 10";
        let part = placed(formula, &Placement::default());
        let look = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let subject = Subject::new(&part, &NONE, View::ISO).unwrap();
            let pool = pool.build().unwrap();
            pool.install(|| subject.fitted(150, 100)).unwrap()
        };
        let one = look(1);
        assert!(hits(&one) > 1000);
        assert!(one == look(3));
    }

    #[test]
    fn what_lies_below_the_bed_is_cut_off() {
        let placement = Placement {
            keep_position: true,
            ..Placement::default()
        };
        let formula = "sqrt((x - 50)^2 + (y - 50)^2 + z^2) - 10";
        let part = placed(formula, &placement);
        let front = View::of(-90.0, 0.0);
        let seen = Subject::new(&part, &NONE, front).unwrap().fitted(200, 200);
        let [left, right, top, bottom] = extent(&seen.unwrap());
        assert!((right - left).abs_diff(2 * (bottom - top)) <= 3);
    }

    #[test]
    fn an_outline_from_above_holds_the_part_tightly() {
        let ring =
            outline_from_above(&placed(BLOCK, &Placement::default())).unwrap();
        let area: f64 = ring
            .iter()
            .zip(ring.iter().cycle().skip(1))
            .map(|(a, b)| 0.5 * a.perp_dot(*b))
            .sum();
        assert!((799.0..=801.0).contains(&area), "{area}");
        for p in ring {
            let off = (p - DVec2::splat(110.0)).abs();
            assert!(off.x <= 20.001 && off.y <= 10.001, "{p}");
        }
    }
}

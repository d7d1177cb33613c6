//! Lights the visible surface.
//!
//! In: depths and normals, and depths as seen from the key light. Out: colours
//! of a warm material, or of grey-blue supports, under a bright sky, with a key
//! light from the upper left, its shadows, and less light in corners. The corners
//! (ambient occlusion) follow from the depths only, so surfaces hidden from the
//! viewer make none.
//!
//! A place that the light does not see is in shadow (Williams 1978, Casting
//! curved shadows on curved surfaces). The light's view has coarse pixels. Each
//! place compares those around it with the plane of its own surface, which
//! keeps slanted surfaces out of their own shadow. The share of these pixels
//! that is not hidden makes the shadow's edge soft.

use super::edges::Edges;
use super::image::Rows;
use super::raster::{BESIDE, PictureError, Seen, Subject, is_part};
use glam::{Mat3, Vec2, Vec3, Vec4};
use rayon::prelude::*;
use std::ops::Range;

/// Colour of the material, linear.
const MATERIAL: Vec3 = Vec3::new(0.80, 0.25, 0.045);
/// Colour of supports, linear.
const SUPPORT: Vec3 = Vec3::new(0.30, 0.42, 0.50);
/// Light from above and from below, linear.
const SKY: Vec3 = Vec3::new(0.46, 0.51, 0.60);
const GROUND: Vec3 = Vec3::new(0.20, 0.17, 0.16);
/// The key light, and a weaker light from the other side.
const KEY: Vec3 = Vec3::new(1.28, 1.21, 1.10);
const FILL: Vec3 = Vec3::new(0.12, 0.14, 0.18);
/// Directions of the two lights: right, up, towards the viewer.
pub(super) const KEY_FROM: Vec3 = Vec3::new(-0.42, 0.62, 0.66);
const FILL_FROM: Vec3 = Vec3::new(0.75, -0.1, 0.65);
/// Brightness and narrowness of highlights.
const GLOSS: f32 = 0.16;
const NARROW: i32 = 28;

/// Number of directions in which corners are looked for, and number of looks in
/// each of them.
const DIRECTIONS: usize = 8;
const LOOKS: usize = 5;
/// Greatest distance of a look, as a share of the picture's longer side.
const REACH: f32 = 0.09;
/// Share of the light that a corner takes away.
const DARKEST: f32 = 0.85;
/// Light that shadows leave.
const SHADOW: f32 = 0.35;
/// Number of the light's pixels that a place compares, along each side.
const AROUND: usize = 6;
/// Distance, in pixels of the light's view, by which a surface must be nearer
/// to the light to cast a shadow: surfaces bend, and their depths are rounded.
const NEARER: f32 = 2.0;
/// Least cosine between a surface's normal and the light. Below it next to no
/// light arrives, and the surface is too slanted to compare.
const GRAZING: f32 = 0.05;
/// Height in pixels that a surface must stand out to hide another one, since
/// surfaces bend.
const FLAT: f32 = 1.5;

/// Rows that are lit at a time.
const AT_ONCE: usize = 64;

/// Hands over the picture of a subject from its top, some rows at a time. `lit`
/// is what the key light sees. A pixel at an edge is the mean of `finer` ×
/// `finer` ones.
///
/// # Errors
/// Those of `each`, and those of a closer look at edges.
pub(super) fn shade(
    subject: &Subject<'_>,
    seen: &Seen,
    lit: Seen,
    finer: usize,
    each: &mut Rows<'_>,
) -> Result<(), PictureError> {
    let (width, height) = (seen.width, seen.height);
    let light = Light::new(seen, Shadows::new(seen, lit));
    for first in (0..height).step_by(AT_ONCE) {
        isoslice_base::limits::go_on()?;
        let rows = first..(first + AT_ONCE).min(height);
        // Edges are found with the rows beside.
        let from = first.saturating_sub(1);
        let with_next = from..(rows.end + 1).min(height);
        let mut pixels = light.rows(with_next);
        if finer > 1 {
            let edges = Edges::new(&pixels, width, from);
            let is_edge = |x, y| edges.has(x, y);
            let strip = subject.closer(seen, rows.clone(), finer, &is_edge)?;
            let own = pixels[(first - from) * width..].par_chunks_mut(width);
            let own = own.zip(rows.clone().into_par_iter());
            own.for_each(|(out, y)| {
                let closer = Closer::new(&strip, &light, finer, y - first);
                let at_edges = (0..width).filter(|x| is_edge(*x, y));
                at_edges.for_each(|x| out[x] = closer.mean(x));
            });
        }
        let from = (first - from) * width;
        each(&pixels[from..from + rows.len() * width])?;
    }
    Ok(())
}

/// A step from every pixel to another one.
struct Look {
    /// The step in columns and rows.
    at: [isize; 2],
    /// The step to the right, up, and towards the viewer.
    way: Vec3,
}

impl Look {
    fn new(way: Vec3) -> Look {
        Look {
            // Rows count downwards.
            at: [way.x, -way.y].map(|d| (d + 0.5).floor() as isize),
            way,
        }
    }

    /// The step in columns and rows.
    fn step(&self) -> Vec2 {
        // Rows count downwards.
        Vec2::new(self.way.x, -self.way.y)
    }
}

/// A row of pixels, with an array for each quantity, for vector instructions.
struct Row {
    /// Depths; minus infinity beside the part.
    z: Vec<f32>,
    /// Normals: right, up, towards the viewer.
    n: [Vec<f32>; 3],
    /// Greatest share of the sky that is hidden in one direction.
    most: Vec<f32>,
    /// Share of the sky that is hidden in all directions.
    hidden: Vec<f32>,
}

impl Row {
    fn new(width: usize) -> Row {
        let zeros = || vec![0.0; width];
        Row {
            z: zeros(),
            n: [zeros(), zeros(), zeros()],
            most: zeros(),
            hidden: zeros(),
        }
    }
}

/// The colour of the part or of supports, linear.
fn material(is_support: bool) -> Vec3 {
    if is_support { SUPPORT } else { MATERIAL }
}

/// A row of pixels as seen from closer by.
struct Closer<'a> {
    strip: &'a Seen,
    light: &'a Light<'a>,
    finer: usize,
    /// The strip's first row of these.
    first: usize,
    /// From a place in the strip to the one in the picture.
    turn: Mat3,
    shift: Vec3,
}

impl<'a> Closer<'a> {
    /// `row` is counted from the first one in the strip.
    fn new(
        strip: &'a Seen,
        light: &'a Light<'a>,
        finer: usize,
        row: usize,
    ) -> Self {
        let (turn, shift) = strip.to(light.seen);
        Closer {
            strip,
            light,
            finer,
            first: row * finer,
            turn: turn.as_mat3(),
            shift: shift.as_vec3(),
        }
    }

    /// Mean colour and opacity in column `x` of the picture.
    fn mean(&self, x: usize) -> [f32; 4] {
        let n = self.finer;
        let places = (0..n * n).map(|k| [x * n + k % n, self.first + k / n]);
        let sum: Vec4 = places.filter_map(|at| self.colour(at)).sum();
        (sum / (n * n) as f32).to_array()
    }

    fn colour(&self, [x, y]: [usize; 2]) -> Option<Vec4> {
        let pixel = y * self.strip.width + x;
        let depth = self.strip.depths[pixel];
        if !is_part(&depth) {
            return None;
        }
        let place = Vec3::new(x as f32, y as f32, depth);
        let place = self.turn * place + self.shift;
        let normal = self.strip.normals[pixel];
        let hidden = self.light.hidden(place, normal);
        let material = material(self.strip.is_support(pixel));
        let colour = self.light.colour(material, place, normal, hidden);
        Some(colour.extend(1.0))
    }
}

struct Light<'a> {
    seen: &'a Seen,
    /// The model's z axis in the view.
    up: Vec3,
    key: Vec3,
    fill: Vec3,
    half_way: Vec3,
    reach: f32,
    /// The looks for corners, by direction.
    around: Vec<[Look; LOOKS]>,
    shadows: Shadows,
}

/// What the key light sees.
struct Shadows {
    width: usize,
    height: usize,
    depths: Vec<f32>,
    /// The matrix from column, row and depth to those of the light's view.
    turn: Mat3,
    shift: Vec3,
}

impl Shadows {
    fn new(seen: &Seen, lit: Seen) -> Shadows {
        let (turn, shift) = seen.to(&lit);
        Shadows {
            width: lit.width,
            height: lit.height,
            depths: lit.depths,
            turn: turn.as_mat3(),
            shift: shift.as_vec3(),
        }
    }

    /// Share of the light that arrives at a place, given by column, row and
    /// depth, of a surface with this normal, given by right, up and towards the
    /// viewer.
    fn lit(&self, place: Vec3, normal: Vec3) -> f32 {
        let p = self.turn * place + self.shift;
        let n = self.turn * (normal * Vec3::new(1.0, -1.0, 1.0));
        let steepest = GRAZING * n.length();
        if n.z <= steepest || !n.is_finite() || !p.is_finite() {
            return 0.0;
        }
        // The surface's rise from one pixel to the next.
        let (right, down) = (-n.x / n.z, -n.y / n.z);
        let first = (p.truncate() - 0.5 * (AROUND - 2) as f32).floor();
        let beyond = p.truncate() - 0.5 * (AROUND - 2) as f32 - first;
        // All pixels count alike except the outermost ones, which fade in and
        // out.
        let share = |k: usize, beyond: f32| match k {
            0 => 1.0 - beyond,
            k if k + 1 == AROUND => beyond,
            _ => 1.0,
        };
        let mut hidden = 0.0;
        for j in 0..AROUND {
            let y = first.y + j as f32;
            let row = y as usize;
            if y < 0.0 || row >= self.height {
                continue;
            }
            let depths = &self.depths[row * self.width..(row + 1) * self.width];
            let at_row = p.z + down * (y - p.y) + NEARER;
            let weight = share(j, beyond.y);
            let around = around(depths, first.x);
            for (i, depth) in around.into_iter().enumerate() {
                let own = at_row + right * (first.x + i as f32 - p.x);
                let share = weight * share(i, beyond.x);
                hidden += if depth > own { share } else { 0.0 };
            }
        }
        1.0 - hidden / ((AROUND - 1) as f32).powi(2)
    }
}

/// The depths of a row from a column on; what lies beside the row hides nothing.
fn around(depths: &[f32], first: f32) -> [f32; AROUND] {
    let whole = (first >= 0.0)
        .then(|| depths.get(first as usize..)?.first_chunk::<AROUND>());
    whole.flatten().copied().unwrap_or_else(|| {
        std::array::from_fn(|i| {
            let x = first + i as f32;
            let depth = (x >= 0.0).then(|| depths.get(x as usize));
            depth.flatten().copied().unwrap_or(BESIDE)
        })
    })
}

impl<'a> Light<'a> {
    fn new(seen: &'a Seen, shadows: Shadows) -> Self {
        let longest = seen.width.max(seen.height) as f32;
        let key = KEY_FROM.normalize();
        let reach = (REACH * longest).max(2.0);
        let around = |d: usize| {
            // Directions keep off the axes, along which edges often run.
            let share = (d as f32 + 0.25) / DIRECTIONS as f32;
            let direction = Vec2::from_angle(std::f32::consts::TAU * share);
            std::array::from_fn(|look| {
                // The looks are denser near the pixel.
                let share = (look + 1) as f32 / LOOKS as f32;
                let step = direction * (reach * share * share).max(1.0);
                Look::new(Vec3::new(step.x, -step.y, 0.0))
            })
        };
        Light {
            seen,
            up: seen.axes.transpose().z_axis.as_vec3(),
            key,
            fill: FILL_FROM.normalize(),
            half_way: (key + Vec3::Z).normalize(),
            reach,
            around: (0..DIRECTIONS).map(around).collect(),
            shadows,
        }
    }

    /// Rows of the picture: linear colours and opacity.
    fn rows(&self, rows: Range<usize>) -> Vec<[f32; 4]> {
        let width = self.seen.width;
        let mut pixels = vec![[0.0; 4]; width * rows.len()];
        let each = pixels.par_chunks_mut(width).zip(rows.into_par_iter());
        each.for_each_init(
            || Row::new(width),
            |row, (out, y)| self.draw(y, row, out),
        );
        pixels
    }

    /// Draws row `y` of the visible surface.
    fn draw(&self, y: usize, row: &mut Row, out: &mut [[f32; 4]]) {
        let width = self.seen.width;
        let line = y * width..(y + 1) * width;
        let depths = &self.seen.depths[line.clone()];
        let (Some(first), Some(last)) = (
            depths.iter().position(is_part),
            depths.iter().rposition(is_part),
        ) else {
            return;
        };
        row.z.copy_from_slice(depths);
        let normals = &self.seen.normals[line];
        for (k, n) in normals.iter().enumerate() {
            (row.n[0][k], row.n[1][k], row.n[2][k]) = (n.x, n.y, n.z);
        }
        self.look_around(y, first..last + 1, row);
        for x in (first..=last).filter(|x| is_part(&row.z[*x])) {
            let place = Vec3::new(x as f32, y as f32, row.z[x]);
            let material = material(self.seen.is_support(y * width + x));
            let colour =
                self.colour(material, place, normals[x], row.hidden[x]);
            out[x] = colour.extend(1.0).to_array();
        }
    }

    /// The colour of a material's surface. Its `place` is given by column, row
    /// and depth, its normal by right, up and towards the viewer. `hidden` is
    /// the share of the sky that it does not see, summed up over the directions.
    fn colour(
        &self,
        material: Vec3,
        place: Vec3,
        n: Vec3,
        hidden: f32,
    ) -> Vec3 {
        let share = hidden / DIRECTIONS as f32 * 1.6;
        let open = 1.0 - DARKEST * share.min(1.0);
        let lit = SHADOW + (1.0 - SHADOW) * self.shadows.lit(place, n);
        let above = 0.5 + 0.5 * n.dot(self.up);
        let key = n.dot(self.key).max(0.0) * lit;
        let fill = n.dot(self.fill).max(0.0);
        let sky = GROUND.lerp(SKY, above) * open;
        let gloss = n.dot(self.half_way).max(0.0).powi(NARROW) * lit;
        material * (sky + KEY * key + FILL * fill) + KEY * GLOSS * gloss
    }

    /// How much of the sky the surroundings hide from a place between pixels,
    /// summed up over the directions.
    fn hidden(&self, place: Vec3, n: Vec3) -> f32 {
        let far = (1.5 * self.reach).powi(2);
        let hides = |look: &Look| {
            let at = place.truncate() + look.step() + 0.5;
            let depth = self.seen.depth(at)?;
            let to = at.as_ivec2().as_vec2().extend(depth) - place;
            let rise = n.dot(Vec3::new(to.x, -to.y, to.z)) - FLAT;
            // Most places hide nothing, and the root is what costs.
            if rise <= 0.0 {
                return None;
            }
            let square = to.length_squared();
            Some(rise / square.sqrt() * (1.0 - square / far).max(0.0))
        };
        let most = |looks: &[Look; LOOKS]| {
            looks.iter().filter_map(hides).fold(0.0, f32::max)
        };
        self.around.iter().map(most).sum()
    }

    /// The depths at a look's distance from some pixels of row `y`, and which
    /// of these pixels have one.
    fn seen_from(
        &self,
        y: usize,
        pixels: &Range<usize>,
        look: &Look,
    ) -> Option<(&[f32], Range<usize>)> {
        let [dx, dy] = look.at;
        let width = self.seen.width;
        let y = y.checked_add_signed(dy).filter(|y| *y < self.seen.height)?;
        let from = pixels.start.max(dx.min(0).unsigned_abs());
        let end = width.saturating_sub(dx.max(0).unsigned_abs());
        let own = from..pixels.end.min(end);
        let other = own.start.checked_add_signed(dx)?
            ..own.end.checked_add_signed(dx)?;
        let row = &self.seen.depths[y * width..(y + 1) * width];
        Some((row.get(other)?, own))
    }

    /// Finds how much of the sky the surroundings hide from pixels of row `y`.
    /// On a plane they hide none.
    fn look_around(&self, y: usize, pixels: Range<usize>, row: &mut Row) {
        let far = (1.5 * self.reach).powi(2);
        row.hidden[pixels.clone()].fill(0.0);
        for looks in &self.around {
            row.most[pixels.clone()].fill(0.0);
            for look in looks {
                let Some((other, own)) = self.seen_from(y, &pixels, look)
                else {
                    continue;
                };
                let flat = look.way.length_squared();
                let Vec3 { x, y, .. } = look.way;
                let [nx, ny, nz] = row.n.each_ref().map(|n| &n[own.clone()]);
                let z = &row.z[own.clone()];
                let most = &mut row.most[own];
                for k in 0..other.len().min(most.len()) {
                    let dz = other[k] - z[k];
                    let square = flat + dz * dz;
                    let rise = nx[k] * x + ny[k] * y + nz[k] * dz - FLAT;
                    let near = 1.0 - square / far;
                    let near = if near > 0.0 { near } else { 0.0 };
                    // Beside the part this is NaN, and a comparison with NaN is
                    // false.
                    let hides = rise / square.sqrt() * near;
                    most[k] = if hides > most[k] { hides } else { most[k] };
                }
            }
            for x in pixels.clone() {
                row.hidden[x] += row.most[x];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::slabs::NONE;
    use super::*;
    use crate::raster::Subject;
    use crate::view::View;
    use glam::DVec3;
    use isoslice_model::{Placement, placed};

    /// A post on a plate as an expression and as a function.
    const PARTS: &str = "min(max(sqrt(x^2+y^2) - 3, abs(z - 15) - 15), \
                         max(max(abs(x) - 30, abs(y) - 30), abs(z) - 1))";

    fn inside(p: DVec3) -> bool {
        let post = p.truncate().length() < 3.0 && (0.0..30.0).contains(&p.z);
        let plate = p.x.abs().max(p.y.abs()) < 30.0 && p.z.abs() < 1.0;
        post || plate
    }

    /// Shadows end where they should, whether the field is flat, steep, or
    /// both.
    #[test]
    fn shadows_are_those_of_the_part() {
        for scale in ["1", "1000", "0.001", "exp(z/4)", "(2 + sin(5*x))"] {
            let formula = format!("({PARTS}) * {scale}");
            let model = placed(&formula, &Placement::default());
            let subject = Subject::new(&model, &NONE, View::ISO).unwrap();
            let seen = subject.fitted(300, 240).unwrap();
            let light = KEY_FROM.normalize().as_dvec3();
            let lit = subject.seen_by(light, 1.5 * seen.pixel).unwrap();
            let shadows = Shadows::new(&seen, lit);
            let way = seen.axes * light;
            let (mut dark, mut wrong, mut all) = (0, 0, 0);
            for (k, depth) in seen.depths.iter().enumerate() {
                if !is_part(depth) {
                    continue;
                }
                let at = [k % seen.width, k / seen.width].map(|n| n as f32);
                let place = Vec3::new(at[0], at[1], *depth);
                let p = seen.place(place.as_dvec3());
                let far = p.x.abs().max(p.y.abs()) < 29.0;
                // On the plate, a little off the post.
                if (p.z - 1.0).abs() > 0.2 || !far || p.length() < 5.0 {
                    continue;
                }
                let hidden = (8..400).any(|i| {
                    inside(DVec3::new(p.x, p.y, 1.0) + way * f64::from(i) * 0.1)
                });
                let share = shadows.lit(place, seen.normals[k]);
                all += 1;
                dark += usize::from(hidden);
                wrong += usize::from((share < 0.5) != hidden);
            }
            assert!(all > 10_000 && dark > 300, "{scale}: {all} {dark}");
            // Errors are at the edge only, which is as coarse as the light's
            // pixels.
            assert!(wrong < dark / 6, "{scale}: {wrong} of {dark}");
        }
    }
}

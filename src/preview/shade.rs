//! Light on what is seen.
//!
//! In: depths and normals. Out: colours: a warm material under a bright sky,
//! a key light from the upper left with soft shadows, and less light in
//! corners (ambient occlusion), both from the depths alone: what is hidden
//! from the viewer casts no shadow.

use super::image::Picture;
use super::raster::Seen;
use glam::{DMat3, Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Colour of the material, linear.
const MATERIAL: Vec3 = Vec3::new(0.80, 0.25, 0.045);
/// Light from above and from below, linear.
const SKY: Vec3 = Vec3::new(0.46, 0.51, 0.60);
const GROUND: Vec3 = Vec3::new(0.20, 0.17, 0.16);
/// The key light, and a weaker one against it.
const KEY: Vec3 = Vec3::new(1.28, 1.21, 1.10);
const FILL: Vec3 = Vec3::new(0.12, 0.14, 0.18);
/// Where they come from: right, up, towards the viewer.
const KEY_FROM: Vec3 = Vec3::new(-0.42, 0.62, 0.66);
const FILL_FROM: Vec3 = Vec3::new(0.75, -0.1, 0.65);
/// Brightness and narrowness of highlights.
const GLOSS: f32 = 0.16;
const NARROW: i32 = 28;

/// Directions in which corners are looked for, and looks in each.
const DIRECTIONS: usize = 8;
const LOOKS: usize = 5;
/// How far they go, as a share of the picture's longer side.
const REACH: f32 = 0.09;
/// Share of the light that a corner takes away.
const DARKEST: f32 = 0.85;
/// Looks towards the key light, and how far.
const SHADOW_LOOKS: usize = 20;
const SHADOW_REACH: f32 = 0.35;
/// Light that shadows leave.
const SHADOW: f32 = 0.35;
/// Pixels that something must stand out to hide anything: surfaces bend.
const FLAT: f32 = 1.5;

/// The picture, each `block` × `block` pixels of what is seen becoming one.
/// `axes` are the view's: right, up, towards the viewer.
pub(super) fn shade(seen: &Seen, axes: DMat3, block: usize) -> Picture {
    let (width, height) = (seen.width / block, seen.height / block);
    let up = axes.transpose().z_axis.as_vec3();
    let light = Light::new(seen, up);
    let mut pixels = vec![[0.0; 4]; width * height];
    pixels.par_chunks_mut(width).enumerate().for_each_init(
        || Row::new(seen.width),
        |row, (j, out)| {
            for y in j * block..(j + 1) * block {
                light.add(y, block, row, out);
            }
            let all = (block * block) as f32;
            out.iter_mut().flatten().for_each(|c| *c /= all);
        },
    );
    Picture {
        width,
        height,
        pixels,
    }
}

/// A place to look at from every pixel.
struct Look {
    /// Columns and rows away.
    at: [isize; 2],
    /// Right, up and towards the viewer.
    way: Vec3,
}

impl Look {
    fn new(way: Vec3) -> Look {
        Look {
            // Up is against the rows.
            at: [way.x, -way.y].map(|d| (d + 0.5).floor() as isize),
            way,
        }
    }
}

/// A row of pixels, each quantity on its own, for vector instructions.
struct Row {
    /// Depths; minus infinity where nothing is.
    z: Vec<f32>,
    /// Normals: right, up, towards the viewer.
    n: [Vec<f32>; 3],
    /// Most of the sky that is hidden in one direction.
    most: Vec<f32>,
    /// The same for all directions together.
    hidden: Vec<f32>,
    /// Share of the key light that arrives.
    lit: Vec<f32>,
}

impl Row {
    fn new(width: usize) -> Row {
        let zeros = || vec![0.0; width];
        Row {
            z: zeros(),
            n: [zeros(), zeros(), zeros()],
            most: zeros(),
            hidden: zeros(),
            lit: zeros(),
        }
    }
}

struct Light<'a> {
    seen: &'a Seen,
    /// Minus infinity where nothing is.
    depths: Vec<f32>,
    /// The model's z axis in the view.
    up: Vec3,
    key: Vec3,
    fill: Vec3,
    half_way: Vec3,
    reach: f32,
    /// By direction, where corners are looked for.
    around: Vec<[Look; LOOKS]>,
    shadow_reach: f32,
    /// Towards the key light.
    ahead: Vec<Look>,
}

impl<'a> Light<'a> {
    fn new(seen: &'a Seen, up: Vec3) -> Self {
        let longest = seen.width.max(seen.height) as f32;
        let key = KEY_FROM.normalize();
        let reach = (REACH * longest).max(2.0);
        let shadow_reach = (SHADOW_REACH * longest).max(2.0);
        let around = |d: usize| {
            // Off the axes, along which edges often run.
            let share = (d as f32 + 0.25) / DIRECTIONS as f32;
            let direction = Vec2::from_angle(std::f32::consts::TAU * share);
            std::array::from_fn(|look| {
                // Nearer ones are denser.
                let share = (look + 1) as f32 / LOOKS as f32;
                let step = direction * (reach * share * share).max(1.0);
                Look::new(Vec3::new(step.x, -step.y, 0.0))
            })
        };
        let ahead = |look: usize| {
            let share = (look as f32 + 0.5) / SHADOW_LOOKS as f32;
            Look::new(key * (shadow_reach * share * share).max(2.0))
        };
        let depth = |d: &Option<f32>| d.unwrap_or(f32::NEG_INFINITY);
        Light {
            seen,
            depths: seen.depths.iter().map(depth).collect(),
            up,
            key,
            fill: FILL_FROM.normalize(),
            half_way: (key + Vec3::Z).normalize(),
            reach,
            around: (0..DIRECTIONS).map(around).collect(),
            shadow_reach,
            ahead: (0..SHADOW_LOOKS).map(ahead).collect(),
        }
    }

    /// Adds row `y` of what is seen to a row of the picture: colours, linear,
    /// and opacity, of `block` pixels to one.
    fn add(&self, y: usize, block: usize, row: &mut Row, out: &mut [[f32; 4]]) {
        let width = self.seen.width;
        let line = y * width..(y + 1) * width;
        let depths = &self.depths[line.clone()];
        let there = |z: &f32| *z != f32::NEG_INFINITY;
        let (Some(first), Some(last)) = (
            depths.iter().position(there),
            depths.iter().rposition(there),
        ) else {
            return;
        };
        row.z.copy_from_slice(depths);
        let normals = &self.seen.normals[line];
        for (k, n) in normals.iter().enumerate() {
            (row.n[0][k], row.n[1][k], row.n[2][k]) = (n.x, n.y, n.z);
        }
        self.look_around(y, first..last + 1, row);
        self.look_ahead(y, first..last + 1, row);
        for x in (first..=last).filter(|x| there(&row.z[*x])) {
            let share = row.hidden[x] / DIRECTIONS as f32 * 1.6;
            let open = 1.0 - DARKEST * share.min(1.0);
            let colour = self.colour(normals[x], open, row.lit[x]);
            if let Some(pixel) = out.get_mut(x / block) {
                pixel[0] += colour.x;
                pixel[1] += colour.y;
                pixel[2] += colour.z;
                pixel[3] += 1.0;
            }
        }
    }

    /// The colour of a surface that sees a share of the sky and has a share
    /// of the key light.
    fn colour(&self, n: Vec3, open: f32, lit: f32) -> Vec3 {
        let above = 0.5 + 0.5 * n.dot(self.up);
        let key = n.dot(self.key).max(0.0) * lit;
        let fill = n.dot(self.fill).max(0.0);
        let sky = GROUND.lerp(SKY, above) * open;
        let gloss = n.dot(self.half_way).max(0.0).powi(NARROW) * lit;
        MATERIAL * (sky + KEY * key + FILL * fill) + KEY * GLOSS * gloss
    }

    /// The depths seen at a look's distance from some pixels of row `y`, and
    /// which of the pixels have any.
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
        let row = &self.depths[y * width..(y + 1) * width];
        Some((row.get(other)?, own))
    }

    /// How much of the sky the surroundings hide from pixels of row `y`: none
    /// of it on a plane.
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
                    // Not a number where nothing is, and then not more.
                    let hides = rise / square.sqrt() * near;
                    most[k] = if hides > most[k] { hides } else { most[k] };
                }
            }
            for x in pixels.clone() {
                row.hidden[x] += row.most[x];
            }
        }
    }

    /// Which share of the key light arrives at pixels of row `y`.
    fn look_ahead(&self, y: usize, pixels: Range<usize>, row: &mut Row) {
        row.lit[pixels.clone()].fill(1.0);
        // Something far in front is not taken to reach back to here.
        let most = 0.5 * self.shadow_reach;
        for look in &self.ahead {
            let Some((other, own)) = self.seen_from(y, &pixels, look) else {
                continue;
            };
            // The light is wide: its edge is soft.
            let edge = 0.12 * look.way.length() + 1.0;
            let up = look.way.z + FLAT;
            let z = &row.z[own.clone()];
            let lit = &mut row.lit[own];
            for k in 0..other.len().min(lit.len()) {
                let over = other[k] - z[k] - up;
                let left = 1.0 - over / edge;
                let hides = (over > 0.0) & (over < most) & (left < lit[k]);
                lit[k] = if hides { left } else { lit[k] };
            }
        }
        for x in pixels {
            let [nx, ny, nz] = row.n.each_ref().map(|n| n[x]);
            let faces = Vec3::new(nx, ny, nz).dot(self.key) > 0.0;
            let lit = if faces { row.lit[x].max(0.0) } else { 0.0 };
            row.lit[x] = SHADOW + (1.0 - SHADOW) * lit;
        }
    }
}

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

/// The picture, each `block` × `block` pixels of what is seen becoming one.
/// `axes` are the view's: right, up, towards the viewer.
pub(super) fn shade(seen: &Seen, axes: DMat3, block: usize) -> Picture {
    let (width, height) = (seen.width / block, seen.height / block);
    let up = axes.transpose().z_axis.as_vec3();
    let light = Light::new(seen, up);
    let mut pixels = vec![[0.0; 4]; width * height];
    pixels
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(j, row)| {
            for (i, pixel) in row.iter_mut().enumerate() {
                *pixel = light.block(i * block, j * block, block);
            }
        });
    Picture {
        width,
        height,
        pixels,
    }
}

/// Pixels by which the depth may differ on one surface, and cosine by which
/// the normal may.
const LEVEL: f32 = 4.0;
const ALIKE: f32 = 0.95;

/// How much of the light reaches a place.
#[derive(Clone, Copy, Debug)]
struct Around {
    /// Share of the sky's.
    open: f32,
    /// Share of the key's.
    lit: f32,
}

struct Light<'a> {
    seen: &'a Seen,
    /// The model's z axis in the view.
    up: Vec3,
    key: Vec3,
    fill: Vec3,
    half_way: Vec3,
    reach: f32,
    shadow_reach: f32,
}

impl<'a> Light<'a> {
    fn new(seen: &'a Seen, up: Vec3) -> Self {
        let longest = seen.width.max(seen.height) as f32;
        let key = KEY_FROM.normalize();
        Light {
            seen,
            up,
            key,
            fill: FILL_FROM.normalize(),
            half_way: (key + Vec3::Z).normalize(),
            reach: (REACH * longest).max(2.0),
            shadow_reach: (SHADOW_REACH * longest).max(2.0),
        }
    }

    /// The mean colour of a square of pixels, linear, multiplied by its
    /// opacity.
    fn block(&self, i: usize, j: usize, side: usize) -> [f32; 4] {
        let mut sum = Vec3::ZERO;
        let mut hits = 0;
        // What is looked for around a pixel holds for those of the block that
        // lie on the same surface: most of the time goes there.
        let mut last: Option<(f32, Vec3, Around)> = None;
        for (x, y) in (0..side * side).map(|k| (i + k % side, j + k / side)) {
            let k = x + y * self.seen.width;
            let Some(z) = self.seen.depths[k] else {
                continue;
            };
            let n = self.seen.normals[k];
            let around = match last {
                Some((near, facing, around))
                    if (z - near).abs() <= LEVEL && n.dot(facing) > ALIKE =>
                {
                    around
                }
                _ => Around {
                    open: self.openness(x, y, z, n),
                    lit: self.lit(x, y, z, n),
                },
            };
            last = Some((z, n, around));
            sum += self.colour(n, around);
            hits += 1;
        }
        let all = (side * side) as f32;
        let [r, g, b] = (sum / all).to_array();
        [r, g, b, hits as f32 / all]
    }

    /// The colour of a surface.
    fn colour(&self, n: Vec3, around: Around) -> Vec3 {
        let above = 0.5 + 0.5 * n.dot(self.up);
        let key = n.dot(self.key).max(0.0) * around.lit;
        let fill = n.dot(self.fill).max(0.0);
        let sky = GROUND.lerp(SKY, above) * around.open;
        let gloss = n.dot(self.half_way).max(0.0).powi(NARROW) * around.lit;
        MATERIAL * (sky + KEY * key + FILL * fill) + KEY * GLOSS * gloss
    }

    fn depth(&self, x: f32, y: f32) -> Option<f32> {
        let inside = x >= 0.0 && y >= 0.0;
        let (x, y) = (x as usize, y as usize);
        if !inside || x >= self.seen.width || y >= self.seen.height {
            return None;
        }
        self.seen.depths[x + y * self.seen.width]
    }

    /// Share of the sky that is seen from a point: 1 on a plane.
    fn openness(&self, x: usize, y: usize, z: f32, n: Vec3) -> f32 {
        let mut hidden = 0.0;
        for d in 0..DIRECTIONS {
            // Off the axes, along which edges often run.
            let share = (d as f32 + 0.25) / DIRECTIONS as f32;
            let angle = std::f32::consts::TAU * share;
            let direction = Vec2::from_angle(angle);
            let mut most = 0.0f32;
            for look in 1..=LOOKS {
                // Nearer ones are denser.
                let share = look as f32 / LOOKS as f32;
                let step = direction * (self.reach * share * share).max(1.0);
                let (px, py) = (x as f32 + step.x, y as f32 + step.y);
                let Some(other) = self.depth(px + 0.5, py + 0.5) else {
                    continue;
                };
                // Up is against the rows.
                let way = Vec3::new(step.x, -step.y, other - z);
                let length = way.length();
                // Depths are whole voxels.
                let rise = (n.dot(way) - 1.5) / length;
                let near = 1.0 - (length / (1.5 * self.reach)).powi(2);
                most = most.max(rise * near.max(0.0));
            }
            hidden += most;
        }
        1.0 - DARKEST * (hidden / DIRECTIONS as f32 * 1.6).min(1.0)
    }

    /// Share of the key light that arrives.
    fn lit(&self, x: usize, y: usize, z: f32, n: Vec3) -> f32 {
        if n.dot(self.key) <= 0.0 {
            return SHADOW;
        }
        let mut least = 1.0f32;
        for look in 0..SHADOW_LOOKS {
            let share = (look as f32 + 0.5) / SHADOW_LOOKS as f32;
            let far = (self.shadow_reach * share * share).max(2.0);
            let p = self.key * far;
            let at = self.depth(x as f32 + p.x + 0.5, y as f32 - p.y + 0.5);
            let Some(other) = at else { continue };
            let over = other - (z + p.z) - 1.5;
            // Something far in front is not taken to reach back to here.
            if over > 0.0 && over < 0.5 * self.shadow_reach {
                // The light is wide: its edge is soft.
                least = least.min(1.0 - over / (0.12 * far + 1.0));
            }
        }
        SHADOW + (1.0 - SHADOW) * least.clamp(0.0, 1.0)
    }
}

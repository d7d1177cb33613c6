//! Points to be evaluated at once, and the results.

use glam::DVec2;

/// Coordinates and results of one bulk evaluation.
#[derive(Default)]
pub(super) struct Samples {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
    pub values: Vec<f32>,
    pub slopes: Vec<[f32; 3]>,
}

impl Samples {
    pub(super) fn clear(&mut self) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
    }

    pub(super) fn push(&mut self, p: DVec2, z: f32) {
        self.x.push(p.x as f32);
        self.y.push(p.y as f32);
        self.z.push(z);
    }
}

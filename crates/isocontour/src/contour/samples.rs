//! Points at which the field is asked, many at once.

use crate::field::{FieldError, Lattice, Sampler};
use glam::DVec2;

/// Coordinates and results of one bulk evaluation, kept for their memory.
#[derive(Default)]
pub(super) struct Samples {
    at: [Vec<f32>; 3],
    values: Vec<f32>,
    slopes: Vec<[f32; 3]>,
}

/// The means to look at points of the field.
pub(super) struct Eyes<'a> {
    /// The layers' heights.
    pub z: &'a [f32],
    pub lattice: &'a Lattice,
    pub sampler: &'a mut dyn Sampler,
    pub samples: &'a mut Samples,
}

impl Eyes<'_> {
    /// Forgets all points.
    pub(super) fn clear(&mut self) {
        self.samples.at.iter_mut().for_each(Vec::clear);
    }

    /// Adds a point.
    pub(super) fn push(&mut self, p: DVec2, z: f32) {
        let all = self.samples.at.iter_mut();
        for (list, c) in all.zip([p.x as f32, p.y as f32, z]) {
            list.push(c);
        }
    }

    /// Number of points.
    pub(super) fn count(&self) -> usize {
        self.samples.at[0].len()
    }

    /// The field at the points.
    ///
    /// # Errors
    /// If the work has to stop.
    pub(super) fn values(&mut self) -> Result<&[f32], FieldError> {
        let Samples { at, values, .. } = &mut *self.samples;
        if at[0].is_empty() {
            values.clear();
        } else {
            self.sampler.values(at.each_ref().map(|c| &c[..]), values)?;
        }
        Ok(values)
    }

    /// The field and its slopes along x and y at the points.
    pub(super) fn slopes(&mut self) -> &[[f32; 3]] {
        let Samples { at, slopes, .. } = &mut *self.samples;
        self.sampler.slopes(at.each_ref().map(|c| &c[..]), slopes);
        slopes
    }
}

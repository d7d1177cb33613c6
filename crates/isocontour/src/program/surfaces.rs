//! The surfaces of which f = 0 consists in a box.
//!
//! The zero set of max(a, b) is a part of those of a and of b, and so is that
//! of min(a, b). Where the two meet, the slope of max(a, b) is anything between
//! both, but each of them has a slope of its own. So a surface with an edge is
//! looked at face by face. Functions of one operand that keep its level sets,
//! such as a root or a sum with a constant, are replaced by the operand.

use super::inverse::{inverse, only};
use super::{Program, Scratch, Step};
use crate::data::Data;
use crate::interval::Interval;
use fidget::context::{BinaryOpcode, UnaryOpcode};
use glam::{DAffine3, DMat3, DVec3};

/// A surface on which a step of the program has a certain value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    step: u32,
    level: f64,
    /// Range of the step's partial derivatives in the box.
    pub slope: [Interval; 3],
}

/// Data that has one value all over a surface.
pub(crate) struct Placed<'a> {
    pub data: &'a dyn Data,
    /// The map to the places at which it is asked.
    pub place: DAffine3,
    /// The value.
    pub level: f64,
}

impl Program {
    /// The surfaces in the box of the last `enclose` (of this program, with
    /// this scratch) of which the border of f < 0 is a part. `None` if there
    /// are too many. A step that may be NaN has any slope, but 0 along an axis
    /// on which it does not depend.
    pub(crate) fn surfaces(&self, scratch: &Scratch) -> Option<Vec<Surface>> {
        /// Greatest number of steps that are replaced by their operands. Shared
        /// steps are met many times.
        const MOST_REPLACED: usize = 256;
        let s = &scratch.slots;
        if s.len() != self.steps.len() {
            return None;
        }
        let mut found: Vec<Surface> = Vec::new();
        let mut todo = vec![((s.len() - 1) as u32, 0.0)];
        let mut seen = 0;
        while let Some((number, level)) = todo.pop() {
            seen += 1;
            if seen > MOST_REPLACED {
                return None;
            }
            let slot = &s[number as usize];
            if !slot.range.contains(level) && !slot.range.nan {
                continue;
            }
            let range = |step: u32| s[step as usize].range;
            match self.steps[number as usize] {
                Step::Binary(
                    op @ (BinaryOpcode::Max | BinaryOpcode::Min),
                    a,
                    b,
                ) => {
                    for (one, other) in [(a, b), (b, a)] {
                        let other = range(other);
                        let passes = match op {
                            BinaryOpcode::Max => other.lo <= level,
                            _ => other.hi >= level,
                        };
                        if passes || other.nan {
                            todo.push((one, level));
                        }
                    }
                }
                _ if slot.range.nan => {
                    found.push(self.unknown(number, level));
                }
                Step::Unary(UnaryOpcode::Neg, a) => todo.push((a, -level)),
                Step::Unary(UnaryOpcode::Abs, a) => {
                    if level >= 0.0 {
                        todo.extend([(a, level), (a, -level)]);
                    }
                }
                Step::Unary(UnaryOpcode::Sqrt, a) => {
                    if level >= 0.0 {
                        todo.push((a, level * level));
                    }
                }
                Step::Unary(UnaryOpcode::Square, a) => {
                    if level >= 0.0 {
                        todo.extend([(a, level.sqrt()), (a, -level.sqrt())]);
                    }
                }
                Step::Binary(op, a, b)
                    if let Some((operand, of)) =
                        inverse(op, [a, b].map(range).map(only))
                        && of(level).is_finite() =>
                {
                    todo.push(([a, b][operand], of(level)));
                }
                _ => found.push(Surface {
                    step: number,
                    level,
                    slope: slot.slope,
                }),
            }
        }
        Some(found)
    }

    /// A surface of a step that may be NaN.
    fn unknown(&self, step: u32, level: f64) -> Surface {
        let mut depends = vec![false; step as usize + 1];
        let slope = [0, 1, 2].map(|axis| {
            for i in 0..depends.len() {
                let step = &self.steps[i];
                depends[i] = matches!(step, Step::Axis(a) if *a == axis)
                    || step.operands().any(|o| depends[o as usize]);
            }
            match depends.last() {
                Some(false) => Interval::ZERO,
                _ => Interval::ANYTHING,
            }
        });
        Surface { step, level, slope }
    }

    /// The data that has one value all over a surface in the box of the last `enclose`
    /// (of this program, with this scratch), whose centre is `centre`. `None` if there
    /// is no such data, or if it is not asked at places that an affine map makes.
    pub(crate) fn placed_data(
        &self,
        surface: &Surface,
        centre: DVec3,
        scratch: &Scratch,
    ) -> Option<Placed<'_>> {
        let step = self.steps.get(surface.step as usize)?;
        let Step::Data(number, at) = *step else {
            return None;
        };
        let mut rows = [DVec3::ZERO; 3];
        let mut to = DVec3::ZERO;
        for (k, step) in at.into_iter().enumerate() {
            let slot = scratch.slots.get(step as usize)?;
            // Whatever has one slope all over a box is affine there.
            let is_affine = slot.slope.iter().all(|g| g.lo == g.hi && !g.nan);
            if !is_affine || slot.range.nan || !slot.centre.is_finite() {
                return None;
            }
            rows[k] = DVec3::from_array(slot.slope.map(|g| g.lo));
            to[k] = slot.centre - rows[k].dot(centre);
        }
        let by = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
        let place = DAffine3::from_mat3_translation(by, to);
        Some(Placed {
            data: &*self.data[number as usize],
            place,
            level: surface.level,
        })
    }

    /// Value of f at a point, and how far a surface's step is above its level
    /// there. Either may be NaN.
    pub(crate) fn beside(
        &self,
        surface: &Surface,
        point: [f64; 3],
        scratch: &mut Scratch,
    ) -> [f64; 2] {
        let f = self.value(point, scratch);
        let of = scratch.values.get(surface.step as usize).copied();
        [f, of.unwrap_or(f64::NAN) - surface.level]
    }
}

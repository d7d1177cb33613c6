//! An expression split into calls of data, parts that depend on one coordinate,
//! and the rest, with the sources of the rest's inputs.

use super::axis::{Axis, Level};
use super::calls::{Call, Called, function};
use super::hoist::{Hoisted, hoist};
use super::source::Source;
use super::{FieldError, bug};
use crate::interval::Interval;
use fidget::eval::MathFunction;
use fidget::vm::VmFunction;

/// An expression split into parts that depend on one coordinate, and the rest.
pub(super) struct Split {
    /// The rest.
    pub f: VmFunction,
    /// The calls of data.
    pub calls: Vec<Call>,
    /// The parts, by axis.
    pub parts: [Vec<VmFunction>; 3],
    /// For each input of the rest, where its value is from.
    pub sources: Vec<Source>,
}

impl Split {
    /// Splits an expression.
    ///
    /// # Errors
    /// If fidget refuses a part, which is a bug.
    pub(super) fn new(called: Called) -> Result<Split, FieldError> {
        let Called {
            context: ctx,
            root,
            calls,
            mut sources,
        } = called;
        let Hoisted { tree, parts } = hoist(&ctx, root);
        let mut by_axis: [Vec<VmFunction>; 3] = Default::default();
        for part in parts {
            let f = VmFunction::new(&ctx, &[part.node]).map_err(bug)?;
            let of_axis = &mut by_axis[part.axis];
            sources.insert(part.var, Source::Part(part.axis, of_axis.len()));
            of_axis.push(f);
        }
        let (f, sources) = function(&tree, &sources)?;
        Ok(Split {
            f,
            calls,
            parts: by_axis,
            sources,
        })
    }
}

/// The axes of a slab: columns, rows, and its layers.
#[derive(Clone, Copy)]
pub(super) struct Axes<'a>(pub [&'a Axis; 3]);

impl<'a> Axes<'a> {
    /// The number of a source's axis, and the source's values at the nodes of
    /// that axis.
    pub(super) fn along(&self, source: Source) -> (usize, &'a [f32]) {
        match source {
            Source::Coordinate(a) => (a, self.0[a].nodes()),
            Source::Part(a, p) => (a, self.0[a].values(p)),
            // It is evaluated elsewhere.
            Source::Call(_) => (2, &[]),
        }
    }

    /// The range of a source over box number `at` of a level.
    pub(super) fn over(
        &self,
        source: Option<&Source>,
        level: Level,
        at: [usize; 3],
    ) -> Interval {
        match source {
            Some(&Source::Coordinate(a)) => self.0[a].extent(level, at[a]),
            Some(&Source::Part(a, p)) => self.0[a].range(p, level, at[a]),
            Some(Source::Call(_)) | None => Interval::ANYTHING,
        }
    }

    /// The extent of box number `at` of a level.
    pub(super) fn extent(&self, level: Level, at: [usize; 3]) -> [Interval; 3] {
        [0, 1, 2].map(|a| self.0[a].extent(level, at[a]))
    }
}

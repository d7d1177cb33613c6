//! Draws the lines of entities, of which a drawing has so many at most.

use crate::area::MOST_CURVES;
use crate::outline::{Fill, Outline};
use glam::DVec2;
use isoslice_base::problem::{Problem, go_on};

/// What is said of a drawing that has too many curves.
pub(super) fn too_many<T>() -> Problem<T> {
    Err(format!(
        "it has more than {MOST_CURVES} lines and curves; simplify it"
    ))
}

/// A line that is being drawn.
pub(super) struct Pen {
    line: Outline,
    /// How many more curves may be drawn. Those that go nowhere count too, since
    /// they take time.
    left: usize,
}

impl Pen {
    pub(super) fn new(left: usize) -> Pen {
        let line = Outline::new(Fill::EvenOdd);
        Pen { line, left }
    }

    /// Whether so many curves may be drawn still.
    pub(super) fn may_draw(&self, count: usize) -> Problem<()> {
        if count > self.left {
            return too_many();
        }
        go_on()
    }

    fn count(&mut self) -> Problem<()> {
        self.may_draw(1)?;
        self.left -= 1;
        Ok(())
    }

    pub(super) fn move_to(&mut self, p: DVec2) {
        self.line.move_to(p);
    }

    pub(super) fn line_to(&mut self, p: DVec2) -> Problem<()> {
        self.count()?;
        self.line.line_to(p);
        Ok(())
    }

    pub(super) fn cubic_to(
        &mut self,
        a: DVec2,
        b: DVec2,
        p: DVec2,
    ) -> Problem<()> {
        self.count()?;
        self.line.cubic_to(a, b, p);
        Ok(())
    }

    /// What was drawn.
    pub(super) fn line(self) -> Outline {
        self.line
    }
}

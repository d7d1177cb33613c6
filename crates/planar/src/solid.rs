//! An area that can be asked what is where.

use super::Area;
use super::grid::EdgeGrid;
use isoslice_base::units::Mm;
use std::borrow::Cow;
use std::sync::OnceLock;

/// An area and a grid of its edges. The grid is made when it is first asked
/// for: many areas are never asked.
#[derive(Clone, Debug)]
pub struct Solid<'a> {
    area: Cow<'a, Area>,
    cell: Mm,
    grid: OnceLock<EdgeGrid>,
}

/// Size of a grid's cells where the caller asks for no other, mm. A cell has a
/// few edges of a smooth outline.
const CELL: Mm = 1.0;

impl<'a> Solid<'a> {
    /// A solid that owns its area.
    pub fn new(area: Area) -> Solid<'static> {
        Solid {
            area: Cow::Owned(area),
            cell: CELL,
            grid: OnceLock::new(),
        }
    }

    /// A solid that borrows its area, for questions about the distance `reach`.
    pub fn of(area: &'a Area, reach: Mm) -> Solid<'a> {
        Solid {
            area: Cow::Borrowed(area),
            cell: reach,
            grid: OnceLock::new(),
        }
    }

    /// This solid without its grid.
    pub fn plain(&self) -> Solid<'static> {
        Solid {
            area: Cow::Owned(self.area().clone()),
            cell: self.cell,
            grid: OnceLock::new(),
        }
    }

    /// What it covers.
    pub fn area(&self) -> &Area {
        &self.area
    }

    /// What it covers, without the grid.
    pub fn into_area(self) -> Area {
        self.area.into_owned()
    }

    /// The area's edges, for asking what is where.
    pub fn grid(&self) -> &EdgeGrid {
        self.grid
            .get_or_init(|| EdgeGrid::new(&self.area, self.cell))
    }

    /// True if both are one solid. Layers with equal outlines share one solid,
    /// so this is a quick test.
    pub fn is(&self, other: &Solid<'_>) -> bool {
        std::ptr::eq(self.area(), other.area())
    }
}

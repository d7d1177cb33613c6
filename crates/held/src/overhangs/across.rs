//! Lines across a gap, and which of them are bridges.
//!
//! In: a gap under a layer, and what is below it. Out: the lines that the skin lays
//! across the gap, each with what becomes of it.
//!
//! Straight lines across a gap, held at both ends and at most `bridge_max`
//! long, need nothing, and the skin lays them where [`direction`] says so. Near
//! the layer's rim are walls, which follow it: there only lines that run along
//! it are ever laid.

use super::held::held;
use super::plan::OverhangPlan;
use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_layer::skin::bridge::{ANCHOR, direction, hung};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::hatch::{Lines, Segment};
use isoslice_planar::{Area, Solid};

/// Lines may be found longer than they are by so much, mm: outlines are thinned, and
/// offset and back.
const SLACK: Mm = 0.02;

/// About so many lines are looked at across a gap.
const LINES: f64 = 400.0;
/// Greatest angle between a rim and a line that runs along it.
const ALONG: Degrees = 30.0;
/// A line that runs along a rim comes nearer to it, and its ends are farther away
/// than its middle, by no more than this, mm. The wall beside the rim, which keeps
/// its distance, would lie elsewhere.
pub(super) const DRIFT: Mm = 0.1;

/// The layer that is judged.
#[derive(Clone, Copy)]
pub(super) struct Upper<'a> {
    /// Its outline, which its walls follow.
    pub outline: &'a Solid<'a>,
    /// The layer's number: it says how skin runs.
    pub number: usize,
    /// The layer's height.
    pub height: Mm,
    pub plan: &'a OverhangPlan,
}

/// Lines across a gap.
pub(super) struct Across {
    lines: Vec<(Segment, Fate)>,
    /// Distance between the lines.
    pub spacing: Mm,
    /// The lines' direction.
    along: DVec2,
    /// How far a line reaches onto what holds it.
    width: Mm,
}

/// What becomes of a line.
#[derive(Clone, Copy, PartialEq)]
enum Fate {
    /// It is a bridge.
    Bridge,
    /// Both of its ends are held, but it is too long.
    TooLong,
    /// It is no bridge.
    Falls,
}

impl Across {
    /// How far from its ends a line looks for something that holds it.
    pub(super) fn anchor(plan: &OverhangPlan) -> Mm {
        ANCHOR * plan.walls.skin
    }

    /// How deep below the rim a line asks whether it is a wall.
    pub(super) fn depth(plan: &OverhangPlan) -> Mm {
        plan.walls.count as f64 * plan.walls.outer
    }

    /// The lines across a gap of a layer over `below`; none if no line can hang
    /// there.
    pub(super) fn new(
        gap: &Area,
        below: &EdgeGrid,
        upper: Upper<'_>,
    ) -> Option<Across> {
        let plan = upper.plan;
        let width = plan.walls.skin;
        let angle = if plan.bridges {
            direction(gap, below, width)?
        } else if plan.by_skin {
            plan.direction(upper.number)
        } else {
            return None;
        };
        let size = gap.bounds().size().length();
        let spacing = width.max(size / LINES);
        let lines = Lines {
            angle,
            spacing,
            phase: 0.5 * spacing,
        };
        let fate = |(line, ends): (Segment, [bool; 2])| {
            let fate = if ends != [true; 2] {
                Fate::Falls
            } else if line.from.distance(line.to) > plan.bridge_max + SLACK {
                Fate::TooLong
            } else if upper.is_wall(line, below) {
                Fate::Falls
            } else {
                Fate::Bridge
            };
            (line, fate)
        };
        let lines = hung(gap, below, lines, width).into_iter();
        Some(Across {
            lines: lines.map(fate).collect(),
            spacing,
            along: DVec2::from_angle(angle.to_radians()),
            width,
        })
    }

    /// The strips that bridges span, on both sides as far as they reach onto what
    /// holds them.
    pub(super) fn spanned(&self) -> Area {
        let aside = 0.51 * self.spacing * self.along.perp();
        let onto = self.width * self.along;
        let strip = |line: &Segment| {
            let (a, b) = (line.from - onto, line.to + onto);
            vec![a - aside, b - aside, b + aside, a + aside]
        };
        let rings = self.of(Fate::Bridge).map(strip).collect();
        Area { rings }
    }

    /// The bridges.
    pub(super) fn bridges(&self) -> impl Iterator<Item = &Segment> {
        self.of(Fate::Bridge)
    }

    /// The lines that would be bridges if they were shorter.
    pub(super) fn too_long(&self) -> impl Iterator<Item = &Segment> {
        self.of(Fate::TooLong)
    }

    fn of(&self, fate: Fate) -> impl Iterator<Item = &Segment> {
        let lines = self.lines.iter();
        lines.filter(move |(_, f)| *f == fate).map(|(line, _)| line)
    }
}

impl Upper<'_> {
    /// True if a wall is printed in the middle of a line and is no bridge there.
    /// Such a wall runs across the line, or bends away from it as the rim does, or
    /// its own middle is in `below` or no farther from it than what that holds: then
    /// only its outer edge hangs in the air.
    fn is_wall(self, line: Segment, below: &EdgeGrid) -> bool {
        let width = self.plan.walls.outer;
        let middle = line.from.midpoint(line.to);
        let grid = self.outline.grid();
        let depth = Across::depth(self.plan);
        let Some((edge, at)) = grid.nearest_edge(middle, depth) else {
            return false;
        };
        let (a, b) = grid.edge(edge);
        let along = (b - a).normalize_or_zero();
        let way = line.to - line.from;
        let [on, off] = [along.dot(way), along.perp_dot(way)].map(f64::abs);
        let depth = middle.distance(at);
        let number = (depth / width).floor();
        let wall = at + (number + 0.5) * width * along.perp();
        let near = depth + DRIFT;
        let bends = |end: DVec2| grid.nearest_edge(end, near).is_none();
        let held = held(self.height, self.plan);
        on < ALONG.to_radians().cos() * way.length()
            || off > DRIFT
            || bends(line.from)
            || bends(line.to)
            || below.contains(wall)
            || below.nearest_edge(wall, held).is_some()
    }
}

//! What beads lie on, and what travels lead over, at each point's own height.
//!
//! The plane is divided into cells. Each knows how high what is printed reaches
//! there (`columns`). It tells
//!
//! - where an island begins in the air. A layer's islands are the connected
//!   groups of cells that beads run through. An island stands on something if
//!   in one of its cells, or beside it, something below reaches up to its beads:
//!   the part, or a support within a gap. Supports may stand on the part with a
//!   gap as well;
//! - where a layer reaches far into the air, though it is connected with what
//!   stands, or hangs nearly all over;
//! - where a bead that rises out of its layer has nothing below it;
//! - where a bead is laid into what lies below it;
//! - where a travel leads through what is printed.
//!
//! A bead reaches as deep as its height, and an island stands if half of that is
//! missing below it. A bead that follows a surface under the edge of the next
//! layer gets no more material than what lies open of it takes: it is lifted by
//! up to half of the next layer, which is no higher than the nozzle is wide.

use super::cells::{CELL, Cells, around, cell_of, middle_of};
use super::columns::{Columns, Reach, Seen};
use glam::{DVec2, DVec3, IVec2};
use isoslice_base::units::{Mm, Mm2};
use isoslice_gcode_read::reader::{Move, Role};
use isoslice_planar::bead::height_of;
use std::f64::consts::FRAC_PI_4;
use std::ops::RangeInclusive;

/// Greatest gap between a support and what it holds above it, and between a
/// support and what it stands on, if the settings ask for none that is wider.
pub(super) const GAP: Mm = 0.6;

/// Share of a bead's height that may be missing below it.
const MISSING: f64 = 0.5;

/// Share of its height that may be missing below a bead of the layer which does not
/// rise. If more is missing, the whole layer hangs there, and not only the bead that
/// rises.
const ALIKE: f64 = 0.25;

/// How far below a top a nozzle may move: a quarter of a usual layer. The tops of
/// beads are uneven by about as much, and a bead is lower at its sides, which share
/// their cells with the next bead. A nozzle that is lower ploughs.
pub(super) const PLOUGH: Mm = 0.05;

/// How far beads may reach into the air, mm. The longest bridges, which hold at
/// both ends, reach half as far as they are long. A print that was shifted
/// hangs on a single bead.
const REACH: Mm = 20.0;

/// Length of outer walls that may hang in one layer though their file does not
/// call them overhangs, mm. Slicers that tell overhangs apart leave a few mm at
/// their ends.
const UNCALLED: Mm = 10.0;

/// Share of a layer's cells that may hang: more is not held by the walls.
const HELD: f64 = 0.1;

/// Width of usual beads, in widths of the nozzle.
const WIDE: f64 = 1.25;

/// Heights closer than this differ by rounding only.
const ROUNDED: Mm = 1e-3;

/// The layer being printed, and those below.
pub(super) struct Ground {
    columns: Columns,
    /// Greatest gap at supports.
    gap: Mm,
    /// Greatest gap below a bead that follows a surface: half of the nozzle's
    /// width.
    lift: Mm,
    /// Height of the bed, known after the first layer.
    bed: Option<Mm>,
    /// True if layers lie below this one.
    above_others: bool,
    here: Layer,
    /// The place of the layer that was looked at last, if all is well there.
    last: Option<Spot>,
    /// Where the last bead ended. The next one mostly begins there.
    end: DVec3,
}

/// A cell of a layer, and how a bead lies in it.
#[derive(Clone, Copy, PartialEq)]
struct Spot {
    cell: IVec2,
    z: Mm,
    height: Mm,
    support: bool,
}

/// What is known of the layer being printed.
#[derive(Default)]
struct Layer {
    /// Height of the highest point of its beads.
    top: Option<Mm>,
    /// The lowest bottom of beads that do not rise, by what the file says.
    bottom: Option<Mm>,
    /// Height of the first bead of the part that does not rise, and how high
    /// the file says that it is.
    level: Option<(Mm, Mm)>,
    /// True if some of its beads rise.
    rises: bool,
    /// Cells of beads that were reported to hang in the air.
    reported: Cells,
    /// True if the file calls some of its beads bridges or overhangs.
    bridges: bool,
    /// Cells of outer walls with nothing below, which the file does not call
    /// overhangs.
    walls: Cells,
}

/// A layer that reaches into the air, or hangs there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Adrift {
    /// A place that hangs, and how far it is from what stands.
    Reaches(DVec3, Mm),
    /// A place where an outer wall hangs that the file does not call an overhang, and
    /// the length of all such walls.
    Walls(DVec3, Mm),
}

/// A bead or a travel at the wrong height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wrong {
    /// Where the nozzle is.
    pub at: DVec3,
    /// The top of what is printed there.
    pub top: Mm,
    /// How it is wrong.
    pub how: How,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum How {
    /// The nozzle is too low.
    Low,
    /// The bead hangs above what the rest of its layer lies on.
    High,
}

impl Ground {
    /// A bed without anything on it. `gap` is the greatest one at supports, and
    /// `nozzle` the nozzle's width.
    pub(super) fn new(gap: Mm, nozzle: Mm) -> Ground {
        Ground {
            columns: Columns::default(),
            gap: gap.max(GAP),
            lift: 0.5 * nozzle,
            bed: None,
            above_others: false,
            here: Layer::default(),
            last: None,
            end: DVec3::NAN,
        }
    }

    /// Forgets all that is printed.
    pub(super) fn clear(&mut self) {
        *self = Ground::new(self.gap, 2.0 * self.lift);
    }

    /// Number of tiles that take memory.
    #[cfg(test)]
    pub(super) fn tiles(&self) -> usize {
        self.columns.tiles()
    }

    /// Takes in a bead with a cross-section of `area` in the layer being
    /// printed. Returns the first place where it is too low or too high.
    pub(super) fn bead(&mut self, step: &Move, area: Mm2) -> Option<Wrong> {
        let support = step.role.is_support();
        let highest = step.from.z.max(step.to.z);
        self.here.bridges |= matches!(step.role, Role::Bridge | Role::Overhang);
        self.here.top = Some(self.here.top.map_or(highest, |t| t.max(highest)));
        let level = (step.to.z - step.from.z).abs() < ROUNDED;
        self.here.rises |= !level;
        if level {
            let bottom = step.to.z - step.height;
            let lowest = self.here.bottom.map_or(bottom, |b| b.min(bottom));
            self.here.bottom = Some(lowest);
            if !support && self.here.level.is_none() {
                self.here.level = Some((step.to.z, step.height));
            }
        }
        let mut wrong = None;
        let reach = |z: Mm, height: Mm| z - (1.0 + MISSING) * height - ROUNDED;
        let alike = |s: &Spot| s.height == step.height && s.support == support;
        let goes_on = std::mem::replace(&mut self.end, step.to) == step.from;
        let before = self.last.filter(|spot| goes_on && alike(spot));
        let stays = |spot: Spot| {
            spot.z == step.to.z && spot.cell == cell_of(step.to.truncate())
        };
        if before.is_some_and(stays) {
            return None;
        }
        let goes_on = before.is_some();
        let deepest = depth(step, area, 2.0 * self.lift);
        let height = step.height;
        for (cell, at) in places(step, 0.0).skip(usize::from(goes_on)) {
            let z = at.z;
            let spot = Some(Spot {
                cell,
                z,
                height,
                support,
            });
            if self.last == spot {
                continue;
            }
            self.last = None;
            let [low, deep] = [height, deepest].map(|high| reach(z, high));
            let bead = Reach {
                low: low as f32,
                deep: deep as f32,
                top: z as f32,
                support,
            };
            let tops = self.columns.lay(cell, bead);
            let Some([below, before]) = tops else {
                continue;
            };
            if z < below - PLOUGH {
                let (top, how) = (below, How::Low);
                wrong = wrong.or(Some(Wrong { at, top, how }));
            } else if below < low && !self.lies_on_own(cell, before, z, height)
            {
                if step.role == Role::OuterWall {
                    self.here.walls.mark(cell);
                }
                if below < deep && !support && wrong.is_none() {
                    wrong = self.hangs(cell, at, z - deepest - self.lift);
                    if wrong.is_some() {
                        self.here.reported.mark(cell);
                    }
                }
            } else {
                self.last = spot;
            }
        }
        wrong
    }

    /// True if a bead, whose top is at `z`, lies on another one of its layer, as the
    /// flat turn does that ends a climbing wall. `before` is the top that the cell had
    /// without the bead.
    fn lies_on_own(&self, cell: IVec2, before: Mm, z: Mm, height: Mm) -> bool {
        if !self.here.rises {
            return false;
        }
        let own = z - height - ROUNDED..z - ROUNDED;
        let top = |near| self.columns.at(near).map(|seen| seen.top);
        let mut near = around(cell).filter_map(top);
        own.contains(&before) || near.any(|top| own.contains(&top))
    }

    /// Tells whether a bead that reaches down to `low` hangs in the air only
    /// since it rises out of its layer.
    fn hangs(&self, cell: IVec2, at: DVec3, low: Mm) -> Option<Wrong> {
        let (level, height) = self.here.level?;
        if at.z <= level + ROUNDED {
            return None;
        }
        // The first layer lies on the bed.
        let bed = (self.bed.unwrap_or(level - height), false);
        let below = around(cell)
            .filter_map(|near| self.columns.at(near))
            .filter(|seen| seen.below <= at.z)
            .map(|seen| (seen.below, seen.on_support));
        let higher = |a: (Mm, bool), b| if b > a { b } else { a };
        let (top, on_support) = below.fold(bed, higher);
        let would_lie = level - (1.0 + ALIKE) * height <= top;
        (top < low && would_lie && !on_support).then_some(Wrong {
            at,
            top,
            how: How::High,
        })
    }

    /// The top of the layers below in a cell, and whether it is that of a support;
    /// none where they are the bed.
    pub(super) fn below(&self, cell: IVec2) -> Option<(Mm, bool)> {
        self.columns.below(cell)
    }

    /// True if something is printed in the square whose sides are so far from a
    /// place.
    pub(super) fn is_printed_near(&self, place: DVec2, distance: Mm) -> bool {
        /// Every other cell is looked at: beads are about as wide as two.
        const STEP: usize = 2;
        let [from, to] = [-distance, distance].map(|by| cell_of(place + by));
        let rows = (from.y..=to.y).step_by(STEP);
        let mut cells = rows.flat_map(|y| {
            let row = (from.x..=to.x).step_by(STEP);
            row.map(move |x| IVec2::new(x, y))
        });
        cells.any(|cell| self.columns.at(cell).is_some())
    }

    /// The place where a travel is deepest in what is printed, the first of several.
    /// A line's width at both ends is left out: beads lie side by side there, and
    /// cells do not tell one from the next.
    pub(super) fn travel(&self, step: &Move) -> Option<Wrong> {
        let low = places(step, CELL).filter_map(|(cell, at)| {
            let top = self.columns.at(cell)?.top;
            let how = How::Low;
            (at.z < top - PLOUGH).then_some(Wrong { at, top, how })
        });
        let depth = |wrong: &Wrong| wrong.top - wrong.at.z;
        low.reduce(|a, b| if depth(&b) > depth(&a) { b } else { a })
    }

    /// Ends a layer; `found` is told where islands begin in the air. Returns
    /// where the rest of the layer reaches too far into the air. `calls` is true if the
    /// file tells overhangs from other walls.
    pub(super) fn next_layer(
        &mut self,
        calls: bool,
        mut found: impl FnMut(DVec3),
    ) -> Option<Adrift> {
        let here = std::mem::take(&mut self.here);
        self.last = None;
        let top = here.top?;
        // Beads of the first layer may rise; it lies on the bed all the same.
        let bed = match (self.bed, here.bottom) {
            (Some(bed), Some(bottom)) => Some(bed.min(bottom)),
            (bed, bottom) => bed.or(bottom),
        };
        self.bed = bed;
        let at = |cell: IVec2| middle_of(cell).extend(top);
        let mut adrift = None;
        if bed.is_some() || self.above_others {
            for support in [false, true] {
                let hanging = self.hanging(support);
                let printed = self.columns.printed(support);
                let way = Way::over(&hanging, &printed);
                let alone = hanging.clone().filter(&way.reached, false);
                let islands = begin(&alone, &here.reported, |cell| {
                    found(at(cell));
                });
                if !support && islands == 0 && !here.bridges {
                    let far = way.too_far(&hanging, &printed);
                    adrift =
                        far.map(|cell| Adrift::Reaches(at(cell), way.reach()));
                }
                if !support && islands == 0 && adrift.is_none() && calls {
                    let walls = here.walls.clone().filter(&hanging, true);
                    let long = CELL * f64::from(walls.count());
                    let first = walls.first().filter(|_| long > UNCALLED);
                    adrift = first.map(|cell| Adrift::Walls(at(cell), long));
                }
            }
        }
        self.above_others = true;
        self.columns.next_layer();
        adrift
    }

    /// The cells of the layer's part, or of its supports, that stand on nothing.
    fn hanging(&self, support: bool) -> Cells {
        // Most cells stand, so few remain to be searched.
        let searched = self.columns.not_held(support);
        let Some([deep, high]) = self.columns.spread(&searched) else {
            return Cells::default();
        };
        if self.on_bed(&high, support) {
            return Cells::default();
        }
        // What holds the highest beads holds all, and what does not hold the
        // deepest holds none. Nearly all beads of a layer lie alike.
        let near = searched.grown();
        let beside = |own: &Seen| {
            let range = |on_support| self.holding(own, support, on_support);
            self.columns.within(&near, range).grown()
        };
        let searched = searched.filter(&beside(&high), false);
        let doubtful = if self.on_bed(&deep, support) {
            searched.clone()
        } else if (deep.low, deep.top) == (high.low, high.top) {
            Cells::default()
        } else {
            searched.clone().filter(&beside(&deep), true)
        };
        let stands = self.columns.which(&doubtful, |cell, own| {
            let holds = |seen: &Seen| self.holds(seen, own, support);
            self.on_bed(own, support) || self.columns.any_around(cell, holds)
        });
        searched.filter(&stands, false)
    }

    /// True if beads that lie as `own` says lie on the bed.
    fn on_bed(&self, own: &Seen, support: bool) -> bool {
        let gap = if support { self.gap } else { 0.0 };
        self.bed.is_some_and(|bed| own.low - gap <= bed)
    }

    /// True if what is below a cell holds beads there, or beside it, that lie as
    /// `own` says.
    fn holds(&self, seen: &Seen, own: &Seen, support: bool) -> bool {
        let range = self.holding(own, support, seen.on_support);
        range.contains(&seen.below)
    }

    /// Where the top of what holds beads lies that lie as `own` says.
    fn holding(
        &self,
        own: &Seen,
        support: bool,
        on_support: bool,
    ) -> RangeInclusive<Mm> {
        let gap = if support || on_support { self.gap } else { 0.0 };
        own.low - gap..=own.top + ROUNDED
    }
}

/// The way from what stands over what hangs, from cell to cell.
struct Way {
    /// The hanging cells that are connected with what stands.
    reached: Cells,
    /// One that is farthest from it, and how many cells away it is.
    farthest: Option<IVec2>,
    steps: u32,
}

impl Way {
    /// The way over the `hanging` ones of the `printed` cells.
    fn over(hanging: &Cells, printed: &Cells) -> Way {
        let stands = printed.clone().filter(hanging, false);
        let mut front = stands.grown().filter(hanging, true);
        let mut way = Way {
            reached: Cells::default(),
            farthest: None,
            steps: 0,
        };
        while let Some(first) = front.first() {
            way.farthest = Some(first);
            way.steps += 1;
            way.reached = way.reached.with(&front);
            let next = front.grown().filter(hanging, true);
            front = next.filter(&way.reached, false);
        }
        way
    }

    fn reach(&self) -> Mm {
        f64::from(self.steps) * CELL
    }

    /// The farthest cell, if it is too far away, or if too little of the layer
    /// stands.
    fn too_far(&self, hanging: &Cells, printed: &Cells) -> Option<IVec2> {
        let held =
            1.0 - f64::from(hanging.count()) / f64::from(printed.count());
        self.farthest
            .filter(|_| self.reach() > REACH || held < HELD)
    }
}

/// Tells of the first cell of each island of hanging cells, and counts them.
/// Nothing is said of islands that have a bead which was `reported` already.
fn begin(
    hanging: &Cells,
    reported: &Cells,
    mut found: impl FnMut(IVec2),
) -> usize {
    let mut islands = 0;
    let mut seen = Cells::default();
    let mut left = Vec::new();
    for first in hanging.all() {
        if !seen.mark(first) {
            continue;
        }
        let mut known = false;
        left.push(first);
        while let Some(cell) = left.pop() {
            known |= reported.has(cell);
            let near = around(cell);
            left.extend(near.filter(|c| hanging.has(*c) && seen.mark(*c)));
        }
        if !known {
            found(first);
            islands += 1;
        }
    }
    islands
}

/// How deep a bead reaches. More plastic than the file says reaches deeper, but no
/// deeper than a free strand. A bead for which the file says nothing may be less
/// wide than it seems.
pub(super) fn depth(step: &Move, area: Mm2, nozzle: Mm) -> Mm {
    let plastic = height_of(area, step.width.min(WIDE * nozzle));
    step.height.max(plastic.min(strand(area, nozzle)))
}

/// How thick what a nozzle lays may be: as it is wide, or as a free strand is.
pub(super) fn strand(area: Mm2, nozzle: Mm) -> Mm {
    (area / FRAC_PI_4).sqrt().max(nozzle)
}

/// Cells along a move, each with the nozzle's place there, except for a length
/// at both ends.
fn places(step: &Move, ends: Mm) -> impl Iterator<Item = (IVec2, DVec3)> {
    let length = step.from.truncate().distance(step.to.truncate());
    let count = (length - 2.0 * ends) / CELL;
    // A move that is all ends has no places.
    let last = if count < 0.0 { 0 } else { count as u32 + 2 };
    let share = if length > 0.0 { ends / length } else { 0.0 };
    let from = step.from.lerp(step.to, share);
    let to = step.to.lerp(step.from, share);
    let way = (to - from) / f64::from(last.max(2) - 1);
    (0..last).map(move |k| {
        let at = from + f64::from(k) * way;
        (cell_of(at.truncate()), at)
    })
}

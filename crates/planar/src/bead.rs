//! The bead: one extruded line. All stages after the regions pass on beads.
//!
//! ```text
//!        ┌───────── width ─────────┐
//!      ╭─────────────────────────────╮ ┬
//!      │   rectangle with round ends │ height
//!      ╰─────────────────────────────╯ ┴
//! ```
//!
//! A bead squeezed between nozzle and layer below has a cross-section of
//! (w − h)·h + π(h/2)². Neighbours overlap at their round ends so that they
//! fill the plane: their spacing is w − h·(1 − π/4), at which area per
//! spacing is exactly h.

use crate::along::point_at;
use crate::path_length;
use glam::DVec2;
use isoslice_base::named;
pub use isoslice_base::units::cross_section;
use isoslice_base::units::{Mm, Mm2};

named! {
    /// What a bead is for. Each dialect of G-code has its own word for it.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Role {
        /// The wall that shows.
        OuterWall = "outer_wall",
        /// Walls inside the outer wall.
        InnerWall = "inner_wall",
        /// A wall, or a part of one, that hangs over the layer below.
        Overhang = "overhang",
        /// A bead as wide as the gap between walls that it fills.
        GapFill = "gap_fill",
        /// Solid area facing upwards.
        TopSkin = "top_skin",
        /// Solid area facing downwards.
        BottomSkin = "bottom_skin",
        /// Solid area that faces air neither directly above nor directly below.
        InternalSkin = "internal_skin",
        /// Solid area over nothing, its lines held at both ends.
        Bridge = "bridge",
        /// Solid area over sparse infill, its lines held by the infill's.
        InternalBridge = "internal_bridge",
        /// A pass over a finished top that makes it smooth.
        Ironing = "ironing",
        /// Sparse fill of covered areas.
        SparseInfill = "sparse_infill",
        /// What holds parts of the part that nothing else holds.
        Support = "support",
        /// The dense top of a support.
        SupportInterface = "support_interface",
        /// Loop around the part on the lowest layers, not touching it.
        Skirt = "skirt",
        /// Loops on the bed beside the part's first layer that hold it down.
        Brim = "brim",
    }
}

impl Role {
    /// True if beads of the role belong to the part, and so lie inside it.
    pub fn is_part(self) -> bool {
        !matches!(self, Role::Skirt | Role::Brim) && !self.is_support()
    }

    /// True if beads of the role belong to a support.
    pub fn is_support(self) -> bool {
        matches!(self, Role::Support | Role::SupportInterface)
    }

    /// True if the edges of the role's beads are seen on the part.
    pub fn shows(self) -> bool {
        matches!(self, Role::OuterWall | Role::Overhang)
    }
}

/// Widths that differ by less count as equal, mm.
const SAME: Mm = 1e-3;

/// How a point of a bead lies relative to its layer. Without a level the nozzle
/// runs at the layer's top, and the bead is as high as the layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// Height of the nozzle above the layer's top, mm; negative below.
    pub rise: Mm,
    /// Height of the material in addition to the bead's, mm; negative if there
    /// is less.
    pub extra: Mm,
}

impl Level {
    /// The level at a share `t` of the way to another level.
    pub fn lerp(self, to: Level, t: f64) -> Level {
        Level {
            rise: self.rise + t * (to.rise - self.rise),
            extra: self.extra + t * (to.extra - self.extra),
        }
    }
}

/// A line in the plane that is as wide as its bead. It may leave the plane:
/// then each of its points has a level.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Centre line, mm; a closed stroke does not repeat its first point.
    pub points: Vec<DVec2>,
    /// True if the stroke returns to its first point.
    pub closed: bool,
    /// Width of the stroke; the mean if it varies.
    pub width: Mm,
    /// Width at each point where it varies; empty where it does not.
    pub widths: Vec<Mm>,
    /// Level of each point; empty if all of it lies in the layer.
    pub levels: Vec<Level>,
}

impl Stroke {
    /// A stroke of one width.
    pub fn new(points: Vec<DVec2>, closed: bool, width: Mm) -> Stroke {
        Stroke {
            points,
            closed,
            width,
            widths: Vec::new(),
            levels: Vec::new(),
        }
    }

    /// Moves the nozzle up along all of the stroke.
    pub fn rise_by(&mut self, rise: Mm) {
        if self.levels.is_empty() {
            self.levels = vec![Level::default(); self.points.len()];
        }
        self.levels.iter_mut().for_each(|level| level.rise += rise);
    }

    /// A stroke with a width for each point.
    pub fn varying(
        points: Vec<DVec2>,
        widths: Vec<Mm>,
        closed: bool,
    ) -> Stroke {
        let (mut sum, mut length) = (0.0, 0.0);
        for (p, w) in points.windows(2).zip(widths.windows(2)) {
            let step = p[0].distance(p[1]);
            sum += 0.5 * (w[0] + w[1]) * step;
            length += step;
        }
        let width = if length > 0.0 {
            sum / length
        } else {
            widths.first().copied().unwrap_or(0.0)
        };
        let same = widths.iter().all(|w| (w - width).abs() < SAME);
        Stroke {
            points,
            closed,
            width,
            widths: if same { Vec::new() } else { widths },
            levels: Vec::new(),
        }
    }

    /// Length of the centre line, with the closing segment of a closed stroke.
    pub fn length(&self) -> Mm {
        path_length(&self.points, self.closed)
    }

    /// The points in order, the first one repeated at the end of a closed
    /// stroke.
    pub fn path(&self) -> impl DoubleEndedIterator<Item = DVec2> + '_ {
        let back = self.closed.then(|| self.points.first().copied()).flatten();
        self.points.iter().copied().chain(back)
    }

    /// Where the stroke begins and ends; a closed one ends where it begins.
    pub fn ends(&self) -> Option<(DVec2, DVec2)> {
        let start = *self.points.first()?;
        let last = self.points.last().filter(|_| !self.closed);
        Some((start, last.copied().unwrap_or(start)))
    }

    /// The segments of the centre line, the closing one included.
    pub fn segments(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        self.path().zip(self.path().skip(1))
    }

    /// The width at point `i`, counted round a closed stroke.
    pub fn width_at(&self, i: usize) -> Mm {
        let varying = self.widths.get(i % self.widths.len().max(1));
        varying.copied().unwrap_or(self.width)
    }

    /// The level of point `i`, counted round a closed stroke.
    pub fn level(&self, i: usize) -> Level {
        let own = self.levels.get(i % self.levels.len().max(1));
        own.copied().unwrap_or_default()
    }

    /// Height of the nozzle above the layer's top at point `i`, if the stroke
    /// leaves the plane.
    pub fn rise(&self, i: usize) -> Option<Mm> {
        (!self.levels.is_empty()).then(|| self.level(i).rise)
    }

    /// Lets a closed stroke begin at its point `i`.
    pub fn begin_at(&mut self, i: usize) {
        if i < self.points.len() {
            self.points.rotate_left(i);
        }
        if i < self.widths.len() {
            self.widths.rotate_left(i);
        }
        if i < self.levels.len() {
            self.levels.rotate_left(i);
        }
    }

    /// Turns the stroke round.
    pub fn reverse(&mut self) {
        self.points.reverse();
        self.widths.reverse();
        self.levels.reverse();
    }

    /// The stroke as an open one, which ends at its first point if it was
    /// closed.
    pub fn opened(&self) -> Stroke {
        let mut open = self.clone();
        if self.closed {
            open.points.extend(self.points.first());
            open.widths.extend(self.widths.first());
            open.levels.extend(self.levels.first());
            open.closed = false;
        }
        open
    }

    /// Appends an open stroke that begins where this one ends.
    pub fn append(&mut self, after: &Stroke) {
        if !self.levels.is_empty() || !after.levels.is_empty() {
            self.levels.resize(self.points.len(), Level::default());
            let n = after.points.len();
            self.levels.extend((1..n).map(|i| after.level(i)));
        }
        self.points.extend(after.points.iter().skip(1));
        self.widths.extend(after.widths.iter().skip(1));
    }

    /// The place at a length from the stroke's end, if `last` is true, or else
    /// from its beginning.
    pub fn place(&self, last: bool, length: Mm) -> Option<DVec2> {
        if last {
            point_at(self.path().rev(), length)
        } else {
            point_at(self.path(), length)
        }
    }

    /// An open stroke without a length at its end, if `last` is true, or else at its
    /// beginning.
    pub fn shortened(&self, last: bool, length: Mm) -> Stroke {
        let whole = self.length();
        if length <= 0.0 || whole <= 0.0 {
            return self.clone();
        }
        let share = length / whole;
        if last {
            self.part(0.0, 1.0 - share)
        } else {
            self.part(share, 1.0)
        }
    }

    /// The part of an open stroke between two shares of its length.
    pub fn part(&self, from: f64, to: f64) -> Stroke {
        if from <= 0.0 && to >= 1.0 {
            return self.clone();
        }
        let length = self.length();
        let (from, to) = (from * length, to * length);
        let mut part = Stroke::new(Vec::new(), false, self.width);
        let mut done = 0.0;
        for i in 1..self.points.len() {
            let (a, b) = (self.points[i - 1], self.points[i]);
            let step = a.distance(b);
            let mut push = |at: Mm| {
                let t = ((at - done) / step.max(1e-12)).clamp(0.0, 1.0);
                part.points.push(a.lerp(b, t));
                if let Some(w) = self.widths.get(i - 1..=i) {
                    part.widths.push(w[0] + t * (w[1] - w[0]));
                }
                if let Some(l) = self.levels.get(i - 1..=i) {
                    part.levels.push(l[0].lerp(l[1], t));
                }
            };
            let (low, high) = (from.max(done), to.min(done + step));
            if high > low {
                if done <= from {
                    push(low);
                }
                push(high);
            }
            done += step;
        }
        part
    }
}

/// One extruded line in a layer's plane: a stroke, in print order, with a
/// height and a role.
#[derive(Clone, Debug, PartialEq)]
pub struct Bead {
    /// The bead's purpose.
    pub role: Role,
    /// The line of the bead.
    pub stroke: Stroke,
    /// Height of the bead, which is the layer's. Points with a level are higher
    /// or lower.
    pub height: Mm,
    /// The role that the bead was laid for: a wall that hangs is still that wall.
    pub laid_as: Role,
    /// Length of the closed wall of which this is all, or a piece; infinite for
    /// other beads.
    pub ring: Mm,
    /// The plane to which it belongs. Its points may be higher or lower.
    pub plane: Plane,
}

/// A plane in which beads of a layer lie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Plane {
    /// The layer's own.
    #[default]
    Layer,
    /// Half a layer lower: that of every other inner wall, if walls interlock.
    HalfLower,
    /// One of the supports', whose top is so far above the layer's, mm.
    Supports(Mm),
}

impl Plane {
    /// How far the supports to which it belongs are above the layer; 0 for other
    /// planes.
    pub fn of_supports(self) -> Mm {
        match self {
            Plane::Supports(above) => above,
            Plane::Layer | Plane::HalfLower => 0.0,
        }
    }
}

impl Bead {
    /// A bead that is no piece of a closed wall, and lies in its layer.
    pub fn new(role: Role, stroke: Stroke, height: Mm) -> Bead {
        Bead {
            role,
            stroke,
            height,
            laid_as: role,
            ring: f64::INFINITY,
            plane: Plane::Layer,
        }
    }

    /// Cross-section of the bead; the greatest if it varies with the height.
    pub fn area(&self) -> Mm2 {
        let extra = self.stroke.levels.iter().map(|l| l.extra);
        let extra = extra.reduce(f64::max).unwrap_or(0.0);
        cross_section(self.stroke.width, self.height + extra)
    }

    /// Mean cross-section along segment `i`, whose height varies evenly, per
    /// length of its way in space. Heights are measured upright, so a steep way
    /// lays no more than the level way below it.
    pub fn area_along(&self, i: usize) -> Mm2 {
        let from = self.height + self.stroke.level(i).extra;
        let to = self.height + self.stroke.level(i + 1).extra;
        // Simpson's rule is exact, since the section is quadratic in the
        // height.
        let at =
            |t: f64| cross_section(self.stroke.width, from + t * (to - from));
        let mean = (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0;
        let n = self.stroke.points.len().max(1);
        let ends = [i, i + 1].map(|k| self.stroke.points.get(k % n).copied());
        let [a, b] = ends.map(Option::unwrap_or_default);
        let (level, rise) = (
            a.distance(b),
            self.stroke.level(i + 1).rise - self.stroke.level(i).rise,
        );
        match level.hypot(rise) {
            way if way > 0.0 => mean * level / way,
            _ => mean,
        }
    }
}

/// Height at which a bead of this width has a cross-section. It inverts (w −
/// h)·h + π(h/2)², or the content of an ellipse if the bead is higher than
/// wide.
pub fn height_of(area: Mm2, width: Mm) -> Mm {
    use std::f64::consts::FRAC_PI_4;
    if area >= FRAC_PI_4 * width * width {
        return area / (FRAC_PI_4 * width);
    }
    const ENDS: f64 = 1.0 - FRAC_PI_4;
    let root = width * width - 4.0 * ENDS * area;
    (width - root.max(0.0).sqrt()) / (2.0 * ENDS)
}

/// Distance between the centre lines of two beads side by side that fill the
/// plane between them: the mean width less h·(1 − π/4).
pub fn spacing(width_a: Mm, width_b: Mm, height: Mm) -> Mm {
    0.5 * (width_a + width_b) - height * (1.0 - std::f64::consts::FRAC_PI_4)
}

/// Spacing of the narrowest bead, which is as wide as it is high.
pub fn narrowest(height: Mm) -> Mm {
    height * std::f64::consts::FRAC_PI_4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beads_at_their_spacing_fill_the_plane() {
        let (w, h) = (0.45, 0.2);
        assert!((cross_section(w, h) - spacing(w, w, h) * h).abs() < 1e-12);
    }

    #[test]
    fn heights_are_those_of_cross_sections() {
        for (width, height) in [(0.45, 0.2), (0.45, 0.01), (0.2, 0.3)] {
            let area = cross_section(width, height);
            assert!((height_of(area, width) - height).abs() < 1e-9);
        }
        assert_eq!(height_of(0.0, 0.4), 0.0);
    }

    #[test]
    fn a_closed_bead_counts_its_closing_side() {
        let mut b = Bead::new(
            Role::OuterWall,
            Stroke::new(
                vec![
                    DVec2::new(0.0, 0.0),
                    DVec2::new(3.0, 0.0),
                    DVec2::new(3.0, 4.0),
                ],
                true,
                0.4,
            ),
            0.2,
        );
        assert_eq!(b.stroke.length(), 12.0);
        assert_eq!(b.stroke.path().count(), 4);
        b.stroke.closed = false;
        assert_eq!(b.stroke.length(), 7.0);
        assert_eq!(b.stroke.path().count(), 3);
    }

    #[test]
    fn a_part_of_a_stroke_keeps_its_widths() {
        let points = vec![DVec2::ZERO, DVec2::X * 4.0, DVec2::X * 10.0];
        let mut path = Stroke::new(points, false, 0.5);
        path.widths = vec![0.4, 0.4, 0.7];
        let part = path.part(0.2, 0.6);
        let x: Vec<f64> = part.points.iter().map(|p| p.x).collect();
        assert_eq!(x, [2.0, 4.0, 6.0]);
        assert!((part.widths[2] - 0.5).abs() < 1e-9);
        assert_eq!(path.part(0.0, 1.0), path);
    }
}

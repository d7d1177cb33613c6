//! Fills the inside of one skin's rings.
//!
//! In: an island of skin, how much its neighbours cover of it, and the sparse
//! infill beside it. Out: its rings, and its fills by role, in print order:
//! fills that are seen come last.

use super::bridge::{Bridge, Hanging, bridges, held_first};
use super::direction::Way;
use super::plan::{Look, SkinPlan};
use super::roles::Sides;
use super::strokes::strokes;
use super::zigzag::{Joined, Turns, join};
use super::{Fill, Patch, dabs, hung, sweep};
use crate::cover::Covered;
use crate::cover::neighbour::Neighbour;
use crate::view::LayerFace;
use crate::walls::patch::{Patch as Around, concentric, patch};
use crate::walls::{Lay, taken};
use glam::DVec2;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::bead::{Bead, Role, Stroke, spacing};
use isoslice_planar::clip::difference;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::hatch::{Lines, hatch};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::{is_wider, opened};
use isoslice_planar::{Area, Solid, edges};
use isoslice_settings::SkinPattern;
use std::cell::OnceCell;

/// Tolerance of the offsets inside a skin; nobody sees them.
const TOLERANCE: Mm = 0.01;

/// An area that is nowhere wider than this many lines is filled with strokes
/// along it. Lines across it would be hardly longer than their turns. Where such
/// strokes meet in a wider area, they leave pits: with 14 lines, tops of a gear with
/// holes were filled below 90 % in 8.4 % of them, with 5 in 4.6 %.
const NESTED: f64 = 5.0;

/// Beads that are shorter, between the sides of a ring, are left to the lines
/// beside them, mm: lines go on in each other, such a bead is a stroke alone.
const SHORTEST: Mm = 1.0;

/// What the islands of a layer have in common.
pub(super) struct Filler<'a> {
    pub above: AdjacentLayer<'a>,
    pub below: AdjacentLayer<'a>,
    /// The sparse infill beside the skin.
    pub sparse: Solid<'a>,
    pub on_bed: bool,
    pub angle: Degrees,
    pub height: Mm,
    pub plan: &'a SkinPlan,
    /// The role of rings that hang: a bridge's, unless supports hold some of the layer, or
    /// the beads of bridges are too thin.
    pub hung: Role,
}

/// A layer next to this one, sorted by place when an island first asks.
pub(super) struct AdjacentLayer<'a> {
    face: Option<LayerFace<'a>>,
    sorted: OnceCell<Neighbour<'a>>,
}

impl<'a> AdjacentLayer<'a> {
    /// The neighbouring layer as an island's neighbour, if there is one.
    pub(super) fn new(face: Option<&LayerFace<'a>>) -> AdjacentLayer<'a> {
        AdjacentLayer {
            face: face.copied(),
            sorted: OnceCell::new(),
        }
    }

    fn get(&self) -> Option<&Neighbour<'a>> {
        let area = self.face?.rough.area();
        Some(self.sorted.get_or_init(|| Neighbour::new(area)))
    }
}

impl Filler<'_> {
    /// The beads of an island; nothing if it is too small for any.
    pub(super) fn patch(
        &self,
        island: &Area,
        sides: Sides<'_>,
    ) -> Option<Patch> {
        if isoslice_base::limits::is_stopped() {
            return None;
        }
        if let Some(nested) = self.nested(island, sides) {
            return nested.first().is_some().then_some(nested);
        }
        let ring = self.beside(self.plan.internal.width);
        let mut around = patch(island, ring, TOLERANCE);
        let inside = around.inside(self.plan.off_ring, ring, TOLERANCE);
        let outside = |s: &Stroke| {
            let middle = s.segments().next().map(|(a, b)| a.midpoint(b));
            !middle.is_some_and(|p| inside.contains(p))
        };
        around.thin.retain(|s| s.length() >= SHORTEST || outside(s));
        let mut fills = self.fills(&inside, &around, sides);
        let mut lines = fills.iter().flat_map(|f| &f.lines);
        let bridge = lines.any(|l| l.role == Role::Bridge);
        let strokes = around.rings.iter().chain(&around.thin);
        let rings = strokes.map(|l| {
            let bead = self.bead(sides.most(l), l.clone());
            if bridge && bead.role == Role::BottomSkin {
                Bead {
                    role: Role::Bridge,
                    ..bead
                }
            } else {
                bead
            }
        });
        let mut rings: Vec<Bead> = rings.collect();
        if let Some(below) = self.over_air(sides)
            && rings.iter().any(hung::faces_down)
        {
            let below = EdgeGrid::new(&below.near(island), ring.width);
            let role = self.hung;
            let last = hung::after_lines(&mut rings, &below, role);
            // Nothing is printed on what is ironed.
            let irons =
                |f: &Fill| f.lines.iter().any(|l| l.role == Role::Ironing);
            let at = fills.iter().position(irons).unwrap_or(fills.len());
            fills.splice(at..at, last);
        }
        let patch = Patch { rings, fills };
        patch.first().is_some().then_some(patch)
    }

    /// The beads of an island that is nowhere wider than some lines: rings one
    /// inside the other, those that hang last. There are none if the island is
    /// wider, if its parts are to look different, or if bridges run across.
    fn nested(&self, island: &Area, sides: Sides<'_>) -> Option<Patch> {
        let kinds = [Role::InternalSkin, Role::BottomSkin, Role::TopSkin];
        let looks = kinds.map(|role| self.plan.look(role));
        let look = match sides.only() {
            Some(role) => self.plan.look(role),
            None if looks.iter().all(|l| *l == looks[0]) => looks[0],
            None => return None,
        };
        let space = spacing(look.width, look.width, self.height);
        let across = |b: &Bridge| b.way != Way::Around;
        if is_wider(island, NESTED * space, TOLERANCE)
            || self.bridged(island, sides).0.iter().any(across)
        {
            return None;
        }
        let lay = self.beside(look.width);
        // A strip between walls, as thin as one bead, is a gap if nobody sees
        // it.
        let hidden = sides.only().is_none_or(|r| r == Role::InternalSkin);
        let gap = hidden
            && self.is_between_walls(island)
            && !is_wider(island, lay.limit, TOLERANCE);
        let role = |stroke: &Stroke| match sides.most(stroke) {
            Role::InternalSkin if gap => Role::GapFill,
            role => role,
        };
        let strokes = concentric(island, lay, TOLERANCE);
        let strokes = dabs::or_dab(strokes, island, &lay);
        let strokes = dabs::filling(strokes, island.content(), lay.extra);
        let strokes = strokes.into_iter();
        let rings = strokes.map(|l| self.bead(role(&l), l)).collect();
        let (rings, mut fills) = match self.over_air(sides) {
            Some(below) => {
                let below = below.near(island);
                let below = EdgeGrid::new(&below, look.width);
                hung::apart(rings, &below, self.hung)
            }
            None => (rings, Vec::new()),
        };
        let whole = || offset(island, -lay.inner, TOLERANCE);
        fills.extend(self.ironing(whole, sides));
        Some(Patch { rings, fills })
    }

    /// The layer below, if there may be bridges over what it leaves open.
    fn over_air(&self, sides: Sides<'_>) -> Option<&Neighbour<'_>> {
        let may_hang = self.plan.bridges
            && !self.on_bed
            && sides.below.0 != Covered::Wholly;
        self.below.get().filter(|_| may_hang)
    }

    /// True if sparse infill touches no more than the ends of a strip of skin.
    fn is_between_walls(&self, strip: &Area) -> bool {
        /// Share of a strip's border that its ends have at most.
        const ENDS: f64 = 0.25;
        let sparse = self.sparse.grid();
        let touched = |a: DVec2, b: DVec2| {
            let middle = a.midpoint(b);
            sparse.nearest_edge(middle, 2.0 * TOLERANCE).is_some()
        };
        let edges = strip.rings.iter().flat_map(|ring| edges(ring));
        let touching = edges.filter(|&(a, b)| touched(a, b));
        let length: Mm = touching.map(|(a, b)| a.distance(b)).sum();
        length <= ENDS * strip.perimeter()
    }

    /// The bridges of an area, and what they leave of it.
    fn bridged(&self, area: &Area, sides: Sides<'_>) -> (Vec<Bridge>, Area) {
        match self.over_air(sides) {
            Some(below) => {
                let width = self.plan.bottom.width;
                let space = spacing(width, width, self.height);
                let rings = (NESTED * space, space);
                let hanging = Hanging {
                    width,
                    anchor: self.plan.anchor,
                    // Supports may hold what stays skin.
                    rings: (self.hung == Role::Bridge).then_some(rings),
                };
                bridges(area, below, hanging)
            }
            None => (Vec::new(), area.clone()),
        }
    }

    /// What is inside the rings.
    fn fills(
        &self,
        inside: &Area,
        around: &Around,
        sides: Sides<'_>,
    ) -> Vec<Fill> {
        let lay = self.beside(self.plan.internal.width);
        let cores: Area =
            around.thin.iter().map(|s| taken(s, lay.extra)).collect();
        let open = if cores.is_empty() {
            inside.clone()
        } else {
            difference(inside, &cores)
        };
        let (bridged, rest) = self.bridged(&open, sides);
        // The roles go from below to above: what is seen is printed last.
        let kinds = [Role::InternalSkin, Role::BottomSkin, Role::TopSkin];
        let looks = kinds.map(|role| self.plan.look(role));
        let only = sides.only();
        let mut fills = Vec::new();
        if only.is_some() || looks.iter().all(|l| *l == looks[0]) {
            let look = self.plan.look(only.unwrap_or(Role::InternalSkin));
            let paths = self.paths(&rest, look, self.angle);
            let border = border(&rest, &paths);
            let parts = match only {
                Some(role) => vec![(role, paths)],
                None => by_role(paths, kinds, sides),
            };
            for (role, pieces) in parts {
                fills.push(self.fill(
                    role,
                    look,
                    self.angle,
                    pieces,
                    border.as_ref(),
                ));
            }
        } else {
            for (area, role) in self.areas(&rest, sides) {
                let look = self.plan.look(role);
                let paths = self.paths(&area, look, self.angle);
                let border = border(&area, &paths);
                let border = border.as_ref();
                fills.push(self.fill(role, look, self.angle, paths, border));
            }
        }
        let look = Look {
            pattern: SkinPattern::Lines,
            width: self.plan.bottom.width,
        };
        let hung = bridged.iter().flat_map(|b| self.over_gap(b, look, sides));
        let at = fills.len().saturating_sub(1);
        fills.splice(at..at, hung);
        fills.extend(self.ironing(|| inside.clone(), sides));
        fills.retain(|f| !f.lines.is_empty());
        fills
    }

    /// The lines of a bridge.
    fn over_gap(
        &self,
        bridge: &Bridge,
        look: Look,
        sides: Sides<'_>,
    ) -> Vec<Fill> {
        let Some(below) = self.over_air(sides) else {
            return Vec::new();
        };
        let below = EdgeGrid::new(&below.near(&bridge.area), look.width);
        match bridge.way {
            Way::Across(angle) => {
                let paths = self.paths(&bridge.area, look, angle);
                let after = held_first(&paths, angle, &below, look.width);
                let fill = self.fill(Role::Bridge, look, angle, paths, None);
                vec![Fill { after, ..fill }]
            }
            Way::Around => {
                let lay = self.beside(look.width);
                let rings = concentric(&bridge.area, lay, TOLERANCE);
                let bead = |s| self.bead(Role::BottomSkin, s);
                let rings = rings.into_iter().map(bead).collect();
                let (held, hung) = hung::apart(rings, &below, self.hung);
                let held = Some(hung::fill(held));
                held.into_iter().chain(hung).collect()
            }
        }
    }

    /// A bead of `width` beside other beads.
    fn beside(&self, width: Mm) -> Lay {
        Lay::inside(width, self.height, self.plan.thin)
    }

    /// Splits an area by role into parts that are wide enough for a bead. A
    /// narrower part goes with the part beside it.
    fn areas(&self, area: &Area, sides: Sides<'_>) -> Vec<(Area, Role)> {
        let half = 0.5 * self.plan.internal.width;
        let wide = |area: &Area| opened(area, half, TOLERANCE);
        let mut rest = area.clone();
        let mut parts = Vec::new();
        let faces = [
            (Role::BottomSkin, sides.below.0, &self.below),
            (Role::TopSkin, sides.above.0, &self.above),
        ];
        for (role, covers, face) in faces {
            let part = match covers {
                Covered::Wholly => continue,
                Covered::Partly if let Some(face) = face.get() => {
                    let part = wide(&face.open(&rest));
                    let other = wide(&difference(&rest, &part));
                    difference(&rest, &other)
                }
                _ => rest.clone(),
            };
            rest = difference(&rest, &part);
            parts.push((part, role));
        }
        parts.insert(0, (rest, Role::InternalSkin));
        parts
    }

    /// The centre lines that fill an area.
    fn paths(
        &self,
        area: &Area,
        look: Look,
        angle: Degrees,
    ) -> Vec<(i64, Stroke)> {
        if look.pattern == SkinPattern::Concentric {
            // Lines reach the near side of the ring's bead.
            let rings = concentric(area, self.beside(look.width), TOLERANCE);
            return rings.into_iter().map(|l| (0, l)).collect();
        }
        let lines = Lines {
            angle,
            spacing: spacing(look.width, look.width, self.height),
            phase: 0.0,
        };
        let shortest = 0.5 * look.width;
        strokes(area, lines, look.width, shortest)
    }

    /// Lines as the beads of a fill, joined within a border, if there is one
    /// and they are parallel.
    fn fill(
        &self,
        role: Role,
        look: Look,
        angle: Degrees,
        paths: Vec<(i64, Stroke)>,
        border: Option<&EdgeGrid>,
    ) -> Fill {
        let parallel = look.pattern != SkinPattern::Concentric;
        let swept = match role {
            Role::TopSkin => parallel && self.plan.swept,
            Role::Ironing => true,
            _ => false,
        };
        let after = if swept {
            sweep::after(&paths, angle, look.width)
        } else {
            Vec::new()
        };
        let joined = match border.filter(|_| parallel) {
            Some(border) => {
                let turns = Turns {
                    border,
                    spacing: spacing(look.width, look.width, self.height),
                    height: self.height,
                };
                join(paths, &after, turns)
            }
            None => Joined::apart(paths, after),
        };
        let lines = joined.strokes.into_iter().map(|l| self.bead(role, l));
        Fill {
            lines: lines.collect(),
            after: joined.after,
            one_way: joined.one_way,
        }
    }

    /// A second pass over the parts that face upwards, if it is asked for, one
    /// line's width off their border.
    fn ironing(
        &self,
        inside: impl FnOnce() -> Area,
        sides: Sides<'_>,
    ) -> Option<Fill> {
        let spacing = self.plan.ironing?;
        if sides.only().is_some_and(|role| role != Role::TopSkin) {
            return None;
        }
        let face = match sides.above.0 {
            Covered::Not => None,
            _ => self.above.get(),
        };
        let top = match face {
            Some(above) => above.open(&inside()),
            None => inside(),
        };
        let inset = 0.5 * self.plan.top.width;
        let top = offset(&top, -inset, TOLERANCE);
        let lines = Lines {
            angle: self.angle,
            spacing,
            phase: 0.0,
        };
        let segments = hatch(&top, lines, inset);
        let paths = segments.into_iter().map(|s| {
            let line = Stroke::new(vec![s.from, s.to], false, spacing);
            (s.row, line)
        });
        let look = Look {
            pattern: SkinPattern::Lines,
            width: spacing,
        };
        let paths: Vec<(i64, Stroke)> = paths.collect();
        (!paths.is_empty())
            .then(|| self.fill(Role::Ironing, look, self.angle, paths, None))
    }

    fn bead(&self, role: Role, stroke: Stroke) -> Bead {
        Bead::new(role, stroke, self.height)
    }
}

/// The border of an area, if some of the lines are beside each other.
fn border(area: &Area, lines: &[(i64, Stroke)]) -> Option<EdgeGrid> {
    /// Size of the cells, mm: turns are shorter.
    const CELL: Mm = 1.0;
    (lines.len() > 1).then(|| EdgeGrid::new(area, CELL))
}

/// Lines cut into pieces of one role each, by role.
fn by_role(
    paths: Vec<(i64, Stroke)>,
    roles: [Role; 3],
    sides: Sides<'_>,
) -> Vec<(Role, Vec<(i64, Stroke)>)> {
    let mut parts: Vec<_> = roles.map(|role| (role, Vec::new())).into();
    let mut push = |role, line| {
        if let Some(part) = parts.iter_mut().find(|p| p.0 == role) {
            part.1.push(line);
        }
    };
    for (row, line) in paths {
        let mut pieces = sides.cut(line.opened());
        if let [(role, _)] = pieces.as_slice() {
            push(*role, (row, line));
            continue;
        }
        // A ring that has one role across its beginning is not cut there.
        if line.closed
            && let Some(last) = pieces.pop()
        {
            match pieces.first_mut() {
                Some((role, first)) if *role == last.0 => {
                    let before = std::mem::replace(first, last.1);
                    first.append(&before);
                }
                _ => pieces.push(last),
            }
        }
        for (role, piece) in pieces {
            push(role, (row, piece));
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn rect(x0: f64, x1: f64, low: f64, high: f64) -> Vec<DVec2> {
        [(x0, low), (x1, low), (x1, high), (x0, high)]
            .map(DVec2::from)
            .to_vec()
    }

    #[test]
    fn rings_of_two_roles_keep_all_of_their_sides() {
        // The right half of the ring has something above.
        let above = Area::from(rect(5.0, 30.0, -20.0, 20.0));
        let grid = EdgeGrid::new(&above, 1.0);
        let sides = Sides {
            above: (Covered::Partly, Some(&grid)),
            below: (Covered::Wholly, None),
        };
        let ring = |points| Stroke {
            widths: vec![0.4, 0.5, 0.4, 0.5],
            ..Stroke::new(points, true, 0.4)
        };
        let lines = vec![
            (0, ring(rect(0.0, 10.0, 0.0, 10.0))),
            (0, ring(rect(0.0, 3.0, 12.0, 15.0))),
        ];
        let kinds = [Role::InternalSkin, Role::BottomSkin, Role::TopSkin];
        let parts = by_role(lines.clone(), kinds, sides);
        let lengths = |role: Role| -> Vec<f64> {
            let part = parts.iter().find(|p| p.0 == role);
            let lines = part.iter().flat_map(|p| &p.1);
            lines.map(|(_, l)| l.length()).collect()
        };
        assert_eq!(lengths(Role::InternalSkin), [20.0]);
        assert!(lengths(Role::BottomSkin).is_empty());
        // The part without anything above is one piece although the ring begins
        // in it; the other ring stays whole.
        assert_eq!(lengths(Role::TopSkin), [20.0, 12.0]);
        assert_eq!(parts[2].1[1], lines[1]);
        let piece = &parts[2].1[0].1;
        assert_eq!(piece.widths.len(), piece.points.len());
    }
}

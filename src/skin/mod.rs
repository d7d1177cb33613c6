//! Solid fill: a ring around each skin area, and lines at ±45° inside it.
//!
//! ```text
//!   ╭────────────╮   the ring runs half a bead's spacing inside the area's
//!   │ ╱╱╱╱╱╱╱╱╱╱ │   border, around holes as well; lines end half a nozzle
//!   │ ╱╱╱╱╱╱╱╱╱╱ │   off the ring's centre line, one spacing apart, turned
//!   ╰────────────╯   by 90° from layer to layer
//! ```
//!
//! Inside the ring the area is split by what the neighbouring layers leave
//! open: bridges where it hangs between supports, then bottom, top and
//! internal skin, each with its own width and pattern. Where these are the
//! same, lines run on from one to the other and only their roles change.

mod bridge;
mod roles;
mod strokes;
mod sweep;

use crate::bead::{Bead, Role, spacing};
use crate::plane::Area;
use crate::plane::clip::difference;
use crate::plane::hatch::Lines;
use crate::plane::offset::offset;
use crate::region::Lay;
use crate::region::cover::{Cover, Covered, covered, open};
use crate::region::line::Line;
use crate::region::patch::{Patch as Around, concentric, patch};
use crate::settings::{Settings, SkinOrder, SkinPattern};
use crate::units::{Degrees, Mm};
use bridge::bridges;
use roles::{Path, Sides};
use strokes::strokes;

/// A connected skin area's beads.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Beads around the area and its holes, and those in the middle of
    /// places too thin for lines.
    pub rings: Vec<Bead>,
    /// What is inside the rings, in print order.
    pub fills: Vec<Fill>,
}

/// Beads of one role inside a skin's rings.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// The beads.
    pub lines: Vec<Bead>,
    /// For each bead those that have to be printed before it; empty if any
    /// order will do.
    pub after: Vec<Vec<u32>>,
}

/// The layers directly above and below a layer, if there are any.
#[derive(Clone, Copy, Debug)]
pub struct Faces<'a> {
    /// The next layer.
    pub above: Option<Cover<'a>>,
    /// The layer below.
    pub below: Option<Cover<'a>>,
}

/// Tolerance of the offsets inside a skin; nobody sees them.
const TOLERANCE: Mm = 0.01;

/// How one kind of skin is filled.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Look {
    pattern: SkinPattern,
    width: Mm,
}

/// The beads of a layer's skin. Even layers get lines at `skin_angle`, odd
/// ones at right angles to it.
pub fn patches(
    skin: &Area,
    faces: Faces<'_>,
    layer: usize,
    height: Mm,
    settings: &Settings,
) -> Vec<Patch> {
    let islands = skin.islands();
    let side = |face: Option<Cover<'_>>| match face {
        Some(cover) => covered(&islands, &cover),
        None => vec![Covered::Not; islands.len()],
    };
    let (above, below) = (side(faces.above), side(faces.below));
    let filler = Filler {
        faces,
        on_bed: layer == 0,
        angle: settings.skin_angle - 90.0 * (layer % 2) as f64,
        height,
        settings,
    };
    let sides = above.into_iter().zip(below).map(|(above, below)| Sides {
        above: (above, faces.above.map(|c| c.grid)),
        below: (below, faces.below.map(|c| c.grid)),
    });
    islands
        .iter()
        .zip(sides)
        .filter_map(|(island, sides)| filler.patch(island, sides))
        .collect()
}

/// What the islands of a layer have in common.
struct Filler<'a> {
    faces: Faces<'a>,
    on_bed: bool,
    angle: Degrees,
    height: Mm,
    settings: &'a Settings,
}

impl Filler<'_> {
    /// The beads of an island; nothing if it is too small for any.
    fn patch(&self, island: &Area, sides: Sides<'_>) -> Option<Patch> {
        let settings = self.settings;
        let width = settings.skin_width;
        let plan = Lay::inside(width, self.height, settings);
        let around = patch(island, plan, TOLERANCE);
        let half_nozzle = 0.5 * settings.printer.nozzle_diameter;
        let inside = around.inside(half_nozzle, TOLERANCE);
        let fills = self.fills(&inside, &around, sides);
        let hangs = |bead: &Bead| {
            let bridge = fills
                .iter()
                .flat_map(|f| &f.lines)
                .any(|l| l.role == Role::Bridge);
            bridge && bead.role == Role::BottomSkin
        };
        let rings = around.rings.iter().map(|l| {
            let role = sides.most(&l.points, l.closed);
            let bead = self.bead(role, l.clone());
            match hangs(&bead) {
                true => Bead {
                    role: Role::Bridge,
                    ..bead
                },
                false => bead,
            }
        });
        let thin = around.thin.iter().cloned();
        let thin = thin.map(|l| self.bead(Role::GapFill, l));
        let rings: Vec<Bead> = rings.chain(thin).collect();
        (!rings.is_empty()).then_some(Patch { rings, fills })
    }

    /// What is inside the rings.
    fn fills(
        &self,
        inside: &Area,
        around: &Around,
        sides: Sides<'_>,
    ) -> Vec<Fill> {
        let mut rest = inside.clone();
        let mut bridged = Vec::new();
        if let Some(below) = self.faces.below
            && self.settings.bridges
            && !self.on_bed
            && sides.below.0 != Covered::Wholly
        {
            bridged = bridges(inside, below.area, self.settings);
            for bridge in &bridged {
                rest = difference(&rest, &bridge.area);
            }
        }
        // From below to above: what is seen is printed last.
        let kinds = [Role::InternalSkin, Role::BottomSkin, Role::TopSkin];
        let looks = kinds.map(|role| self.look(role));
        let only = sides.only();
        let mut fills = Vec::new();
        if only.is_some() || looks.iter().all(|l| *l == looks[0]) {
            let look = self.look(only.unwrap_or(Role::InternalSkin));
            let mut paths = self.paths(&rest, look, self.angle, around);
            for role in kinds {
                let pieces = match only {
                    Some(one) if one != role => continue,
                    Some(_) => std::mem::take(&mut paths),
                    None => cut_to(&paths, role, sides),
                };
                fills.push(self.fill(role, look, self.angle, pieces));
            }
        } else {
            for (area, role) in self.areas(&rest, sides) {
                let look = self.look(role);
                let paths = self.paths(&area, look, self.angle, around);
                fills.push(self.fill(role, look, self.angle, paths));
            }
        }
        let at = fills.len().saturating_sub(1);
        for bridge in bridged {
            let look = Look {
                pattern: SkinPattern::Lines,
                width: self.settings.bottom_skin_width(),
            };
            let paths = self.paths(&bridge.area, look, bridge.angle, around);
            fills.insert(
                at.min(fills.len()),
                self.fill(Role::Bridge, look, bridge.angle, paths),
            );
        }
        if self.settings.ironing && only.is_none_or(|r| r == Role::TopSkin) {
            fills.extend(self.ironing(inside, sides));
        }
        fills.retain(|f| !f.lines.is_empty());
        fills
    }

    fn look(&self, role: Role) -> Look {
        let s = self.settings;
        let (pattern, width) = match role {
            Role::TopSkin => (s.top_skin_pattern, s.top_skin_width()),
            Role::BottomSkin => (s.bottom_skin_pattern, s.bottom_skin_width()),
            _ => (s.internal_skin_pattern, s.skin_width),
        };
        Look { pattern, width }
    }

    /// An area split by role, each part wide enough for a bead: what is not
    /// goes with the part beside it.
    fn areas(&self, area: &Area, sides: Sides<'_>) -> Vec<(Area, Role)> {
        let half = 0.5 * self.settings.skin_width;
        let wide = |area: &Area| {
            let core = offset(area, -half, TOLERANCE);
            offset(&core, half + TOLERANCE, TOLERANCE)
        };
        let mut rest = area.clone();
        let mut parts = Vec::new();
        let faces = [
            (Role::BottomSkin, sides.below.0, self.faces.below),
            (Role::TopSkin, sides.above.0, self.faces.above),
        ];
        for (role, covers, face) in faces {
            let part = match (covers, face) {
                (Covered::Wholly, _) => continue,
                (Covered::Partly, Some(face)) => {
                    let part = wide(&open(&rest, face.area));
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
        around: &Around,
    ) -> Vec<(i64, Line)> {
        let line = |path: Path, width, closed| Line {
            points: path.points,
            closed,
            width,
            widths: path.widths,
        };
        if look.pattern == SkinPattern::Concentric {
            let plan = Lay::inside(look.width, self.height, self.settings);
            // Up to the ring's own side.
            let rings = concentric(area, plan, TOLERANCE);
            return rings.into_iter().map(|l| (0, l)).collect();
        }
        let lines = Lines {
            angle,
            spacing: spacing(look.width, look.width, self.height),
            phase: 0.0,
        };
        let shortest = 0.5 * look.width;
        let all = strokes(area, lines, look.width, shortest);
        let ends: Vec<_> = all
            .iter()
            .filter_map(|s| Some((*s.points.first()?, *s.points.last()?)))
            .collect();
        let free = around.free(&ends);
        all.into_iter()
            .zip(free)
            .flat_map(|(s, free)| {
                let path = Path {
                    points: s.points,
                    widths: s.widths,
                };
                free.into_iter().map(move |(a, b)| (s.row, path.part(a, b)))
            })
            .filter(|(_, p)| p.length() >= shortest)
            .map(|(row, p)| (row, line(p, look.width, false)))
            .collect()
    }

    /// Lines as the beads of a fill.
    fn fill(
        &self,
        role: Role,
        look: Look,
        angle: Degrees,
        paths: Vec<(i64, Line)>,
    ) -> Fill {
        let swept = match role {
            Role::TopSkin => {
                look.pattern == SkinPattern::Lines
                    && self.settings.top_skin_order == SkinOrder::Monotonic
            }
            Role::Ironing => true,
            _ => false,
        };
        let after = match swept {
            true => sweep::after(&paths, angle, look.width),
            false => Vec::new(),
        };
        let lines = paths.into_iter().map(|(_, l)| self.bead(role, l));
        Fill {
            lines: lines.collect(),
            after,
        }
    }

    /// A second pass over the parts that face upwards, one line's width off
    /// their border.
    fn ironing(&self, inside: &Area, sides: Sides<'_>) -> Option<Fill> {
        let spacing = self.settings.ironing_spacing;
        let top = match self.faces.above {
            Some(above) if sides.above.0 != Covered::Not => {
                open(inside, above.area)
            }
            _ => inside.clone(),
        };
        let inset = 0.5 * self.settings.top_skin_width();
        let top = offset(&top, -inset, TOLERANCE);
        let lines = Lines {
            angle: self.angle,
            spacing,
            phase: 0.0,
        };
        let segments = crate::plane::hatch::hatch(&top, lines, inset);
        let paths = segments.into_iter().map(|s| {
            let line = Line {
                points: vec![s.from, s.to],
                closed: false,
                width: spacing,
                widths: Vec::new(),
            };
            (s.row, line)
        });
        let look = Look {
            pattern: SkinPattern::Lines,
            width: spacing,
        };
        let paths: Vec<(i64, Line)> = paths.collect();
        (!paths.is_empty())
            .then(|| self.fill(Role::Ironing, look, self.angle, paths))
    }

    fn bead(&self, role: Role, line: Line) -> Bead {
        Bead {
            role,
            points: line.points,
            closed: line.closed,
            width: line.width,
            widths: line.widths,
            height: self.height,
        }
    }
}

/// The pieces of lines that have a role.
fn cut_to(
    paths: &[(i64, Line)],
    role: Role,
    sides: Sides<'_>,
) -> Vec<(i64, Line)> {
    let of = |(row, line): &(i64, Line)| {
        let path = Path {
            points: line.points.clone(),
            widths: line.widths.clone(),
        };
        let (row, width) = (*row, line.width);
        let pieces = sides.cut(path).into_iter();
        pieces
            .filter(move |(own, _)| *own == role)
            .map(move |(_, p)| {
                let line = Line {
                    points: p.points,
                    closed: false,
                    width,
                    widths: p.widths,
                };
                (row, line)
            })
    };
    paths.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::grid::EdgeGrid;
    use glam::DVec2;

    fn cover<'a>(area: &'a Area, grid: &'a EdgeGrid) -> Cover<'a> {
        Cover { area, grid }
    }

    fn square(half: f64) -> Area {
        let ring = [(-half, -half), (half, -half), (half, half), (-half, half)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area { rings: vec![ring] }
    }

    #[test]
    fn a_square_gets_a_ring_and_lines_that_turn() {
        let settings = Settings::default();
        let area = square(12.0);
        let grid = EdgeGrid::new(&area, 1.0);
        let faces = Faces {
            above: None,
            below: Some(cover(&area, &grid)),
        };
        for layer in [0, 1] {
            let patches = patches(&square(10.0), faces, layer, 0.2, &settings);
            assert_eq!(patches.len(), 1);
            let p = &patches[0];
            assert_eq!(p.rings.len(), 1);
            assert_eq!(p.rings[0].role, Role::TopSkin);
            let lines = &p.fills[0].lines;
            let length: f64 = lines.iter().map(Bead::length).sum();
            let space = spacing(0.45, 0.45, 0.2);
            let side = 20.0 - space - 0.4;
            assert!((length * space / (side * side) - 1.0).abs() < 0.01);
            let d = lines[9].points[1] - lines[9].points[0];
            let slope = d.y / d.x;
            let expected = if layer == 0 { 1.0 } else { -1.0 };
            assert!((slope - expected).abs() < 1e-9, "{slope}");
        }
    }

    /// Content by role: length times spacing of the lines.
    fn contents(patches: &[Patch], settings: &Settings) -> Vec<(Role, f64)> {
        let space = spacing(settings.skin_width, settings.skin_width, 0.2);
        let fills = patches.iter().flat_map(|p| &p.fills);
        fills
            .map(|f| {
                let length: f64 = f.lines.iter().map(Bead::length).sum();
                (f.lines[0].role, length * space)
            })
            .collect()
    }

    #[test]
    fn each_side_has_its_role_and_the_rest_is_internal() {
        let base = Settings {
            bridges: false,
            ..Settings::default()
        };
        let wider = Settings {
            top_skin_width: Some(0.5),
            bottom_skin_pattern: SkinPattern::Concentric,
            ..base.clone()
        };
        let rect = |x0: f64, x1: f64| Area {
            rings: vec![
                [(x0, -12.0), (x1, -12.0), (x1, 12.0), (x0, 12.0)]
                    .map(|(x, y)| DVec2::new(x, y))
                    .to_vec(),
            ],
        };
        let (above, below) = (rect(-12.0, 5.0), rect(-4.0, 12.0));
        let (over, under) =
            (EdgeGrid::new(&above, 1.0), EdgeGrid::new(&below, 1.0));
        let faces = Faces {
            above: Some(cover(&above, &over)),
            below: Some(cover(&below, &under)),
        };
        let inner = 20.0 - spacing(0.45, 0.45, 0.2) - 0.4;
        let half = 0.5 * inner;
        let expected = [
            (Role::InternalSkin, 9.0 * inner),
            (Role::BottomSkin, (half - 4.0) * inner),
            (Role::TopSkin, (half - 5.0) * inner),
        ];
        let found =
            contents(&patches(&square(10.0), faces, 1, 0.2, &base), &base);
        for ((role, is), (own, should)) in found.iter().zip(expected) {
            assert_eq!(*role, own);
            assert!((is / should - 1.0).abs() < 0.02, "{role:?} {is}");
        }
        // The same areas with other widths and patterns.
        let all = patches(&square(10.0), faces, 1, 0.2, &wider);
        let fills = &all[0].fills;
        assert_eq!(fills.len(), 3);
        for (fill, (role, should)) in fills.iter().zip(expected) {
            let width = if role == Role::TopSkin { 0.5 } else { 0.45 };
            let space = spacing(width, width, 0.2);
            let length: f64 = fill.lines.iter().map(Bead::length).sum();
            assert_eq!(fill.lines[0].role, role);
            assert_eq!(fill.lines[0].width, width);
            let closed = role == Role::BottomSkin;
            assert_eq!(fill.lines[0].closed, closed);
            // Rings are as wide as their places.
            let is = length * space;
            assert!((is / should - 1.0).abs() < 0.06, "{role:?} {is}");
        }
    }

    #[test]
    fn a_roof_over_a_gap_is_a_bridge_but_not_on_the_bed() {
        let settings = Settings::default();
        let wide = square(12.0);
        let frame = difference(&wide, &square(5.0));
        let grid = EdgeGrid::new(&frame, 1.0);
        let faces = Faces {
            above: None,
            below: Some(cover(&frame, &grid)),
        };
        let all = patches(&square(10.0), faces, 1, 0.2, &settings);
        let found = contents(&all, &settings);
        let reach = 10.0 + 2.0 * settings.bridge_anchor;
        let bridge = found.iter().find(|f| f.0 == Role::Bridge).unwrap();
        assert!((bridge.1 / reach.powi(2) - 1.0).abs() < 0.05, "{found:?}");
        let above_bed = Faces {
            below: None,
            ..faces
        };
        let all = patches(&square(10.0), above_bed, 0, 0.2, &settings);
        assert_eq!(contents(&all, &settings)[0].0, Role::BottomSkin);
    }

    #[test]
    fn ironing_goes_over_tops_alone() {
        let settings = Settings {
            ironing: true,
            ..Settings::default()
        };
        let wide = square(12.0);
        let half = square(4.0);
        let (under, over) =
            (EdgeGrid::new(&wide, 1.0), EdgeGrid::new(&half, 1.0));
        let faces = Faces {
            above: Some(cover(&half, &over)),
            below: Some(cover(&wide, &under)),
        };
        let all = patches(&square(10.0), faces, 1, 0.2, &settings);
        let last = all[0].fills.last().unwrap();
        assert_eq!(last.lines[0].role, Role::Ironing);
        let length: f64 = last.lines.iter().map(Bead::length).sum();
        let side = |inner: f64, off: f64| (inner + off).powi(2);
        let inner = 20.0 - spacing(0.45, 0.45, 0.2) - 0.4;
        let should = side(inner, -0.45) - side(8.0, 0.45);
        let is = length * settings.ironing_spacing;
        assert!((is / should - 1.0).abs() < 0.02, "{is} {should}");
        for line in &last.lines {
            let middle = line.points[0].midpoint(line.points[1]);
            assert!(!over.contains(middle));
        }
    }

    #[test]
    fn too_narrow_for_a_ring_is_left_out() {
        let faces = Faces {
            above: None,
            below: None,
        };
        let settings = Settings::default();
        assert!(patches(&square(0.15), faces, 0, 0.2, &settings).is_empty());
    }
}

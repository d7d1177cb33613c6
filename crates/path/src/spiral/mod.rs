//! The spiral vase: one wall that climbs without a break.
//!
//! In: the outlines of the layers, in order. Out: for each layer one turn, a bead whose points have levels, and one more for each wall inside
//! the first (`spiral`).
//!
//! A turn runs round the middle line of the layer's wall, and rises from the
//! layer's bottom to its top. It begins as the wall of the layer below, and
//! ends as that of its own layer. In between, each point is on its way from the
//! place of the wall below that it goes on from to its own: as far as the middle of
//! the material below the nozzle has come from one layer's middle to the other's. So
//! every point of the wall is as exact as the wall of a flat layer is at its middle,
//! but for how much the part's surface bends within one layer.
//!
//! The first turn lies on a flat layer, and its height grows from next to
//! nothing. The last one is followed by a flat turn whose height goes back to
//! that, so that the wall ends level.
//!
//! Walls inside climb beside the outer one, each at the distance from the
//! surface that its place among the walls gives it. A layer's turns go from the
//! inside out, so the nozzle goes down by a layer's height between two of them.
//! Nothing beside it is then higher, except for the end of the wall that it
//! comes from, right behind it. So the flat turns at the end come after all
//! turns that climb.
//!
//! Turns are cut where the flat walls of their layers would begin or cease to hang
//! over the layer below: a turn reaches as far beyond the one below as these do.

mod error;
mod feet;
mod plan;
mod ring;

pub use error::SpiralError;
pub use plan::SpiralPlan;

use feet::feet;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_layer::walls::{OFFSET_SHARE, Support};
use isoslice_model::Model;
use isoslice_planar::bead::{Bead, Level, Role, Stroke, spacing};
use isoslice_planar::offset::offset;
use isoslice_planar::simplify::simplify_path;
use isoslice_planar::{Area, Ring, signed_area};
use isoslice_settings::layers::LayerSpan;
use ring::{begin, farthest, lonely, points, rear};

/// Height from which and to which turns grow and shrink, mm. It is next to
/// nothing, but even a step of 0.03 mm feeds what the G-code resolves, so that
/// no step of a turn is without filament.
const LEAST: Mm = 0.005;

/// Tolerance of what turns lie on, mm: where a wall begins to hang is not seen.
const TOLERANCE: Mm = 0.01;

/// The wall of a part, turn by turn.
pub struct Spiral {
    plan: SpiralPlan,
    /// From the model's coordinates to the bed's.
    offset: DVec2,
    /// For each layer from the last flat one on, where the turn of each wall
    /// ends and that of the next layer begins.
    ends: Vec<Vec<DVec2>>,
    /// True if a layer has a hole, which gets no wall.
    holes: bool,
    /// The middle line of the highest layer so far.
    ring: Ring,
    /// Height from which the wall is not held by the turn below.
    flat: Option<Mm>,
    /// Index of the first layer with a turn.
    first: usize,
}

impl Spiral {
    /// A spiral without turns.
    ///
    /// # Errors
    /// If a skirt would stand beside the wall.
    pub fn new(
        model: &Model,
        plan: SpiralPlan,
        spans: &[LayerSpan],
    ) -> Result<Self, SpiralError> {
        let (skirt, flat) = (plan.skirt, plan.flat_layers(spans));
        if skirt > flat {
            return Err(SpiralError::Skirt { skirt, flat });
        }
        Ok(Spiral {
            plan,
            offset: model.offset.truncate(),
            ends: Vec::new(),
            holes: false,
            ring: Ring::new(),
            flat: None,
            first: flat,
        })
    }

    /// Index of the first layer with a turn: all below are flat, and there is at
    /// least one of these.
    pub fn first(&self) -> usize {
        self.first
    }

    /// Takes the outline of the next layer, from the last flat one on.
    ///
    /// # Errors
    /// If there is no single wall round it.
    pub fn add(
        &mut self,
        span: &LayerSpan,
        outline: &Area,
    ) -> Result<(), SpiralError> {
        let rings = self.middle_lines(span, outline)?;
        let Some((ring, inside)) = rings.split_first() else {
            return Ok(());
        };
        self.holes |= outline.rings.len() > 1;
        let end = match self.ends.last().and_then(|below| below.first()) {
            Some(&below) => begin(ring, below)[0],
            // The turn begins at the back, where few look at it.
            None => rear(ring),
        };
        // The walls inside end beside it.
        let beside = inside.iter().map(|ring| begin(ring, end)[0]);
        self.ends.push([end].into_iter().chain(beside).collect());
        let width = self.plan.widths[0];
        if self.flat.is_none() && farthest(ring, &self.ring) > width {
            self.flat = Some(span.bottom);
        }
        self.ring = ring.clone();
        Ok(())
    }

    /// What the user should know.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let holes = self.holes.then(|| {
            "spiral prints the outer wall only: holes of the part get \
             no walls"
                .to_owned()
        });
        let flat = self.flat.map(|z| {
            format!(
                "spiral: above z = {z:.2} mm the part is so flat that \
                 one turn of the wall does not lie on the other; cut it there \
                 or make it steeper"
            )
        });
        holes.into_iter().chain(flat)
    }

    /// Where the turn of a wall in a layer begins, if it goes on from one
    /// below.
    fn start_of(&self, layer: usize, wall: usize) -> Option<DVec2> {
        let number = layer.checked_sub(self.first + 1)? + 1;
        self.ends.get(number)?.get(wall).copied()
    }

    /// What a layer's turns are printed on: of an outline the band that the walls below
    /// fill, or all of it if that layer is flat.
    pub fn ground(&self, below: &LayerSpan, outline: &Area) -> Area {
        if !self.has(below.index) {
            return outline.clone();
        }
        let last = self.plan.walls.saturating_sub(1) as usize;
        let depth = self.depth(last, below.height()) + 0.5 * self.width(last);
        let mut band = outline.clone();
        for mut hollow in offset(outline, -depth, TOLERANCE).rings {
            hollow.reverse();
            band.rings.push(hollow);
        }
        band
    }

    /// True if the layer has a turn.
    pub fn has(&self, layer: usize) -> bool {
        layer >= self.first
    }

    /// The turns of the first of two layers, which lies on the other, in print order:
    /// the outer wall's comes last. `support` tells which parts of them hang; without
    /// it, none does.
    ///
    /// # Errors
    /// If there is no single wall round an outline.
    pub fn turns(
        &self,
        layers: [&LayerSpan; 2],
        outlines: [&Area; 2],
        support: Option<&Support<'_>>,
    ) -> Result<Vec<Bead>, SpiralError> {
        let span = layers[0];
        let rings = self.middle_lines(span, outlines[0])?;
        let on = self.middle_lines(layers[1], outlines[1])?;
        let alone = rings.len() == 1;
        let (mut climbing, mut flat) = (Vec::new(), Vec::new());
        let rings = rings.into_iter().zip(on).enumerate();
        for (wall, rings) in rings.rev() {
            let (mut turn, last) = self.turn(layers, rings, wall, support);
            match (&mut turn[..], last) {
                ([only], Some(last))
                    if alone && only.role != Role::Overhang =>
                {
                    only.stroke.append(&last);
                }
                (_, last) => {
                    flat.extend(last.map(|last| bead(wall, last, span)));
                }
            }
            climbing.extend(turn);
        }
        climbing.extend(flat);
        Ok(climbing)
    }

    /// A wall's turn round its middle line in a layer and on the one below, cut where
    /// it begins or ceases to hang, and the flat turn after it if it is the highest.
    fn turn(
        &self,
        [span, below]: [&LayerSpan; 2],
        (ring, on): (Ring, Ring),
        wall: usize,
        support: Option<&Support<'_>>,
    ) -> (Vec<Bead>, Option<Stroke>) {
        let first = self.first;
        let number = span.index - first;
        let end = self.ends.get(number + 1).and_then(|ends| ends.get(wall));
        let mut ring = match end {
            Some(&end) => begin(&ring, end),
            None => ring,
        };
        // Turns meet in the very points that are known of their ends.
        if let (Some(&end), Some(first)) = (end, ring.first_mut()) {
            *first = end;
        }
        // Share of the way between the two layers' middles that is still ahead where
        // the turn begins, and the material's height there.
        let rises = span.sample_z() - below.sample_z();
        let (ahead, from) = match number {
            0 => ((span.sample_z() - span.bottom) / rises, 0.0),
            _ => (1.0, below.height()),
        };
        let start = self.start_of(span.index, wall);
        let on = begin(&on, start.unwrap_or(ring[0]));
        let points = points(&ring);
        let on = feet(&points, &on).into_iter();
        let way = points.iter().zip(on);
        let mut way: Vec<DVec2> = way
            .map(|(p, on)| p.at.lerp(on, ahead * (1.0 - p.share)))
            .collect();
        if let (Some(start), Some(p)) = (start, way.first_mut()) {
            *p = start;
        }
        if let Some(p) = way.last_mut() {
            *p = ring[0];
        }
        let tolerance = OFFSET_SHARE * self.plan.accuracy;
        let width = self.width(wall);
        let height = span.height();
        let least = LEAST.min(height) - height;
        let flat: Vec<DVec2> = points.iter().map(|p| p.at).collect();
        let hanging = support.map_or_else(Vec::new, |support| {
            let flat = Stroke::new(flat.clone(), false, width);
            support.hanging(&bead(wall, flat, span))
        });
        let hanging = hanging.iter().map(|h| h.map(|p| p.round() as usize));
        let hanging: Vec<_> = hanging.filter(|[from, to]| from < to).collect();
        let is_end = |i: usize| hanging.as_flattened().contains(&i);
        let fits = |a: usize, b: usize| !(a + 1..b).any(is_end);
        let piece = |from: usize| {
            let stroke = Stroke::new(Vec::new(), false, width);
            let mut piece = bead(wall, stroke, span);
            if hanging.iter().any(|hangs| hangs[0] == from) {
                piece.role = Role::Overhang;
            }
            piece
        };
        let mut turn = vec![piece(0)];
        for (p, i) in simplify_path(&way, false, tolerance, fits) {
            let share = points[i].share;
            let level = Level {
                rise: (share - 1.0) * height,
                extra: ((1.0 - share) * (from - height)).max(least),
            };
            let add = |piece: &mut Bead| {
                piece.stroke.points.push(p);
                piece.stroke.levels.push(level);
            };
            if let Some(last) = turn.last_mut() {
                add(last);
            }
            if is_end(i) && 0 < i && i + 1 < points.len() {
                let mut next = piece(i);
                add(&mut next);
                turn.push(next);
            }
        }
        if number + 2 != self.ends.len() {
            return (turn, None);
        }
        let mut last = Stroke::new(Vec::new(), false, width);
        for (p, i) in simplify_path(&flat, false, tolerance, |_, _| true) {
            last.points.push(p);
            last.levels.push(Level {
                rise: 0.0,
                extra: (-points[i].share * height).max(least),
            });
        }
        (turn, Some(last))
    }

    /// Width of a wall, counted from the outside.
    fn width(&self, wall: usize) -> Mm {
        self.plan.widths[wall.min(1)]
    }

    /// Distance of a wall's middle from the outline, in a layer of a height.
    fn depth(&self, wall: usize, height: Mm) -> Mm {
        let pairs = (0..wall).map(|k| (self.width(k), self.width(k + 1)));
        let between = pairs.map(|(a, b)| spacing(a, b, height));
        0.5 * self.width(0) + between.sum::<Mm>()
    }

    /// The lines that the nozzle follows round an outline, from the outside.
    fn middle_lines(
        &self,
        span: &LayerSpan,
        outline: &Area,
    ) -> Result<Vec<Ring>, SpiralError> {
        let tolerance = OFFSET_SHARE * self.plan.accuracy;
        let (z, layer) = (span.sample_z(), span.index + 1);
        let walls = self.plan.walls;
        let mut lines: Vec<Ring> = Vec::new();
        for wall in 0..walls {
            let depth = self.depth(wall as usize, span.height());
            let inner = offset(outline, -depth, tolerance);
            let outer = inner.rings.into_iter();
            let mut outer: Vec<Ring> =
                outer.filter(|ring| signed_area(ring) > 0.0).collect();
            outer.sort_by(|a, b| signed_area(b).total_cmp(&signed_area(a)));
            let at = |ring: &Ring| ring[0] + self.offset;
            match (lines.last(), outer.as_slice()) {
                (_, [one]) => lines.push(one.clone()),
                (Some(outside), pieces) => {
                    let near = lonely(outside, pieces);
                    return Err(SpiralError::NoRoom {
                        walls,
                        wall: wall + 1,
                        z,
                        layer,
                        at: near + self.offset,
                    });
                }
                (None, []) => {
                    let width = self.width(0);
                    return Err(SpiralError::TooThin { z, layer, width });
                }
                (None, [a, b, ..]) => {
                    return Err(SpiralError::Pieces {
                        z,
                        layer,
                        count: outer.len(),
                        at: [at(a), at(b)],
                    });
                }
            }
        }
        Ok(lines)
    }
}

/// A wall's stroke as a bead of a layer.
fn bead(wall: usize, stroke: Stroke, span: &LayerSpan) -> Bead {
    let role = match wall {
        0 => Role::OuterWall,
        _ => Role::InnerWall,
    };
    Bead::new(role, stroke, span.height())
}

//! Interlocked walls: every other inner wall lies half a layer lower, so that
//! the joints between layers are not in one plane.
//!
//! ```text
//!    ┌──┐    ┌──┐        a section through four walls: the outer wall and the
//!    ├──┤┌──┐├──┤┌──┐    third one lie in their layers, the second and the
//!    ├──┤├──┤├──┤├──┤    fourth half a layer lower. These begin with half a
//!    └──┘└──┘└──┘└──┘    height, and end with one and a half.
//! ```
//!
//! In: a wall that is to lie lower, and the outlines of its layer and of those
//! beside it. Out: the wall, in pieces, each with its own height, and with
//! levels unless it fills its layer.
//!
//! A wall goes on in the next layer where that has a wall at the same depth: so
//! it does in upright faces and in steep ones. Elsewhere, at bottoms, below
//! tops and at ledges, it begins at its layer's bottom or ends at its layer's
//! top. Its volume goes with its height, so all layers together have as much
//! plastic as without interlocking.
//!
//! The nozzle is lower than the layer's top while these walls are printed, so
//! they have to be printed before what is beside them.

use crate::resolution::Resolution;
use crate::view::{LayerFace, LayerView};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::{Bead, Level, Plane, cross_section, height_of};

/// Greatest lean of a face at which a wall goes on in the next layer, as a
/// share of the wall's width from layer to layer.
const ASIDE: f64 = 0.25;
/// Distance of the places at which a wall looks for the next one, mm.
const LOOK_STEP: Mm = 0.5;
/// A stretch of a wall that is shorter than this goes with what is beside it,
/// mm.
const SHORT: Mm = 1.0;

/// A layer whose walls are to interlock, and what is around it.
pub struct Interlock<'a>(pub &'a LayerView<'a>);

/// True where a wall goes on in the layer below, and in the layer above.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Joined {
    below: bool,
    above: bool,
}

impl Interlock<'_> {
    /// A wall in its place; other beads stay as they are.
    pub fn placed(&self, bead: Bead, resolution: Resolution) -> Vec<Bead> {
        if bead.plane != Plane::HalfLower
            || bead.stroke.points.len() < 2
            || isoslice_base::limits::is_stopped()
        {
            return vec![bead];
        }
        let parts = resolution.pieces(bead).into_iter();
        parts.flat_map(|part| self.cut(part)).collect()
    }

    /// A wall of one width, cut where it begins or ceases to go on.
    fn cut(&self, bead: Bead) -> Vec<Bead> {
        let runs = short_joined(self.runs(&bead));
        if let [(_, joined)] = runs.as_slice() {
            return vec![self.lowered(bead, *joined)];
        }
        let open = bead.stroke.opened();
        let length: Mm = runs.iter().map(|run| run.0).sum();
        let mut from = 0.0;
        let mut out = Vec::with_capacity(runs.len());
        for (i, (own, joined)) in runs.iter().enumerate() {
            let to = if i + 1 == runs.len() {
                length
            } else {
                from + own
            };
            let stroke = open.part(from / length, to / length);
            from = to;
            if stroke.points.len() > 1 {
                out.push(self.lowered(Bead { stroke, ..bead }, *joined));
            }
        }
        out
    }

    /// The stretches of a wall, one after another, each of which goes on in one
    /// way, with their lengths.
    fn runs(&self, bead: &Bead) -> Vec<(Mm, Joined)> {
        let mut runs: Vec<(Mm, Joined)> = Vec::new();
        for (a, b) in bead.stroke.segments() {
            let edge = a.distance(b);
            let count = (edge / LOOK_STEP).ceil().max(1.0);
            for i in 0..count as usize {
                let middle = a.lerp(b, (i as f64 + 0.5) / count);
                let joined = self.joined(middle, bead.stroke.width);
                match runs.last_mut() {
                    Some(last) if last.1 == joined => last.0 += edge / count,
                    _ => runs.push((edge / count, joined)),
                }
            }
        }
        runs
    }

    /// How a wall goes on at a place.
    fn joined(&self, p: DVec2, width: Mm) -> Joined {
        let LayerView { here, above, below } = self.0;
        let [below, above] = [below, above].map(|side| side.first());
        let asked = [below, above].map(|beside| match beside {
            None => Some(false),
            Some(beside) if beside.is_like(here) => Some(true),
            Some(_) => None,
        });
        if let [Some(below), Some(above)] = asked {
            return Joined { below, above };
        }
        let near = here.outline.grid().nearest(p);
        let depth = near.map_or(0.0, |(_, q)| p.distance(q));
        let slack = ASIDE * width;
        let same = |beside: Option<&LayerFace<'_>>| {
            beside.is_some_and(|beside| {
                let grid = beside.outline.grid();
                let near = grid.nearest_within(p, depth + slack);
                grid.contains(p)
                    && near.is_some_and(|n| p.distance(n.1) >= depth - slack)
            })
        };
        Joined {
            below: asked[0].unwrap_or_else(|| same(below)),
            above: asked[1].unwrap_or_else(|| same(above)),
        }
    }

    /// A wall in its place. A wall below that is lowered, too, leaves half of
    /// its own height to this wall. A wall above takes half of this wall's
    /// height.
    fn lowered(&self, bead: Bead, joined: Joined) -> Bead {
        let own = bead.height;
        let rise = if joined.above { -0.5 * own } else { 0.0 };
        let fall = match self.0.below.first() {
            Some(below) if joined.below => 0.5 * below.span.height(),
            _ => 0.0,
        };
        let height = own + rise + fall;
        if !joined.above && !joined.below {
            return bead;
        }
        let area = cross_section(bead.stroke.width, own) * height / own;
        let extra = height_of(area, bead.stroke.width) - height;
        let mut bead = Bead { height, ..bead };
        bead.stroke.levels =
            vec![Level { rise, extra }; bead.stroke.points.len()];
        bead
    }
}

/// Joins short runs to what is beside them.
fn short_joined(runs: Vec<(Mm, Joined)>) -> Vec<(Mm, Joined)> {
    let mut out: Vec<(Mm, Joined)> = Vec::new();
    // A short piece at the beginning is joined to the next one.
    let mut before = 0.0;
    let longest = runs.iter().map(|r| r.0).fold(0.0, f64::max);
    for (length, joined) in runs {
        let short = length < SHORT.min(longest);
        match out.last_mut() {
            Some(last) if short || last.1 == joined => last.0 += length,
            None if short => before += length,
            _ => out.push((length + std::mem::take(&mut before), joined)),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::{Role, Stroke};
    use isoslice_planar::shapes::{rect_ring, square_ring};
    use isoslice_planar::{Area, Solid};
    use isoslice_settings::testing::usual_plan;

    fn wall(half: Mm) -> Bead {
        let stroke = Stroke::new(square_ring(half), true, 0.45);
        let mut bead = Bead::new(Role::InnerWall, stroke, 0.2);
        bead.plane = Plane::HalfLower;
        bead
    }

    fn solid(ring: Vec<DVec2>) -> Solid<'static> {
        Solid::new(Area::from(ring))
    }

    fn volume(beads: &[Bead]) -> f64 {
        beads.iter().map(|b| b.area() * b.stroke.length()).sum()
    }

    #[test]
    fn a_wall_is_half_a_layer_lower_where_it_goes_on() {
        let resolution = usual_plan(Resolution::of);
        let own = solid(square_ring(10.0));
        let plain = volume(&[wall(9.4)]);
        for (below, above, rise, height) in [
            (None, true, -0.1, 0.1),
            (Some(0.2), true, -0.1, 0.2),
            (Some(0.3), true, -0.1, 0.25),
            (Some(0.2), false, 0.0, 0.3),
            (None, false, 0.0, 0.2),
        ] {
            let all = LayerView::of(1, &own, &[&own], &[&own]);
            let beside = |height: Mm| {
                let mut face = all.below[0];
                face.span.bottom = face.span.top - height;
                face
            };
            let view = LayerView {
                here: all.here,
                above: all.above.iter().copied().filter(|_| above).collect(),
                below: below.map(beside).into_iter().collect(),
            };
            let interlock = Interlock(&view);
            let all = interlock.placed(wall(9.4), resolution);
            assert_eq!(all.len(), 1);
            assert!(all[0].stroke.closed);
            assert!((all[0].height - height).abs() < 1e-12);
            assert!((all[0].stroke.level(2).rise - rise).abs() < 1e-12);
            let share = volume(&all) / plain;
            assert!((share - height / 0.2).abs() < 1e-9, "{share}");
            // Others stay.
            let mut other = wall(9.4);
            other.plane = Plane::Layer;
            assert_eq!(interlock.placed(other.clone(), resolution), [other]);
        }
    }

    #[test]
    fn a_wall_ends_at_a_ledge() {
        let resolution = usual_plan(Resolution::of);
        let own = solid(square_ring(10.0));
        // The layer above ends at x = 2; its other sides are those of this one.
        let upper = solid(rect_ring(-10.0, -10.0, 2.0, 10.0));
        let view = LayerView::of(1, &own, &[&upper], &[&own]);
        let all = Interlock(&view).placed(wall(9.4), resolution);
        let ends = |b: &&Bead| b.stroke.level(0).rise == 0.0;
        let ended: Mm =
            all.iter().filter(ends).map(|b| b.stroke.length()).sum();
        // The far side, and what is left of two others: 8.6 mm of them lie
        // within 0.6 mm of the edge of the layer above, or beyond it.
        assert!((ended - (18.8 + 2.0 * 7.9)).abs() < 1.5, "{ended}");
        let length: Mm = all.iter().map(|b| b.stroke.length()).sum();
        assert!((length - 8.0 * 9.4).abs() < 1e-9);
        for pair in all.windows(2) {
            assert_eq!(
                pair[0].stroke.points.last(),
                Some(&pair[1].stroke.points[0])
            );
        }
        // A face that leans a little goes on; one that leans more does not.
        for (aside, joined) in [(0.1, true), (0.13, false)] {
            let leaning = solid(square_ring(10.0 - aside));
            let view = LayerView::of(1, &own, &[&leaning], &[]);
            let found = Interlock(&view).joined(DVec2::new(9.4, 3.0), 0.45);
            assert_eq!(found.above, joined, "{aside}");
        }
    }
}

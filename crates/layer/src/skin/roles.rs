//! Tells whether a place of the skin is top, bottom or internal.
//!
//! The next layer's outline tells where skin faces upwards, and the outline of
//! the layer below where it faces downwards. A place that both cover is skin on
//! account of a layer farther away. Lines are cut where they pass these
//! outlines.

use super::short::join_short;
use crate::cover::Covered;
use glam::DVec2;
use isoslice_planar::bead::{Role, Stroke};
use isoslice_planar::grid::EdgeGrid;

/// The neighbours of an island of skin.
#[derive(Clone, Copy)]
pub(super) struct Sides<'a> {
    /// How much of the island the layer above covers, and where.
    pub above: (Covered, Option<&'a EdgeGrid>),
    /// How much of the island the layer below covers, and where.
    pub below: (Covered, Option<&'a EdgeGrid>),
}

impl Sides<'_> {
    /// The role at a point.
    pub(super) fn role(&self, p: DVec2) -> Role {
        let open = |side: (Covered, Option<&EdgeGrid>)| match side.0 {
            Covered::Wholly => false,
            Covered::Partly => side.1.is_none_or(|grid| !grid.contains(p)),
            Covered::Not => true,
        };
        match () {
            () if open(self.below) => Role::BottomSkin,
            () if open(self.above) => Role::TopSkin,
            () => Role::InternalSkin,
        }
    }

    /// The island's role, if all of the island has one.
    pub(super) fn only(&self) -> Option<Role> {
        match (self.below.0, self.above.0) {
            (Covered::Not, _) => Some(Role::BottomSkin),
            (Covered::Wholly, Covered::Not) => Some(Role::TopSkin),
            (Covered::Wholly, Covered::Wholly) => Some(Role::InternalSkin),
            _ => None,
        }
    }

    /// The role of most of a path.
    pub(super) fn most(&self, stroke: &Stroke) -> Role {
        if let Some(role) = self.only() {
            return role;
        }
        let pieces = self.cut(stroke.opened());
        let mut lengths = [
            (Role::BottomSkin, 0.0),
            (Role::TopSkin, 0.0),
            (Role::InternalSkin, 0.0),
        ];
        for (role, piece) in &pieces {
            for (own, length) in &mut lengths {
                if own == role {
                    *length += piece.length();
                }
            }
        }
        let most = lengths.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        most.map_or(Role::InternalSkin, |m| m.0)
    }

    /// An open stroke in pieces of one role each.
    pub(super) fn cut(&self, path: Stroke) -> Vec<(Role, Stroke)> {
        if let Some(role) = self.only() {
            return vec![(role, path)];
        }
        let grids = [self.above, self.below]
            .into_iter()
            .filter(|s| s.0 == Covered::Partly)
            .filter_map(|s| s.1);
        let grids: Vec<&EdgeGrid> = grids.collect();
        let mut pieces: Vec<(Role, Stroke)> = Vec::new();
        for i in 1..path.points.len() {
            let (a, b) = (path.points[i - 1], path.points[i]);
            let widths = path.widths.get(i - 1..=i);
            let width = |t: f64| widths.map(|w| w[0] + t * (w[1] - w[0]));
            let mut cuts: Vec<f64> =
                grids.iter().flat_map(|g| g.crossings(a, b)).collect();
            cuts.sort_by(f64::total_cmp);
            let mut from = 0.0;
            for to in cuts.into_iter().chain([1.0]) {
                if to - from <= 1e-9 {
                    continue;
                }
                let role = self.role(a.lerp(b, 0.5 * (from + to)));
                let end = if to < 1.0 { a.lerp(b, to) } else { b };
                match pieces.last_mut() {
                    Some((own, piece)) if *own == role => {
                        if from > 0.0 {
                            // The role is the same on both sides of this
                            // crossing, so the crossing is no point of the
                            // piece.
                            piece.points.pop();
                            piece.widths.pop();
                        }
                        piece.points.push(end);
                        piece.widths.extend(width(to));
                    }
                    _ => pieces.push((
                        role,
                        Stroke {
                            points: vec![a.lerp(b, from), end],
                            closed: false,
                            width: path.width,
                            widths: [from, to]
                                .into_iter()
                                .filter_map(width)
                                .collect(),
                            levels: Vec::new(),
                        },
                    )),
                }
                from = to;
            }
        }
        join_short(pieces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::Area;

    fn rect(x0: f64, x1: f64) -> EdgeGrid {
        let ring = [(x0, -9.0), (x1, -9.0), (x1, 9.0), (x0, 9.0)]
            .map(DVec2::from)
            .to_vec();
        EdgeGrid::new(&Area::from(ring), 1.0)
    }

    #[test]
    fn a_line_is_cut_where_its_role_changes() {
        // The layer below ends at 3; the layer above begins at 5, and has a
        // slit near 8.
        let (below, left) = (rect(3.0, 20.0), rect(5.0, 20.0));
        let sides = Sides {
            above: (Covered::Partly, Some(&left)),
            below: (Covered::Partly, Some(&below)),
        };
        let line = Stroke::new(
            vec![DVec2::ZERO, DVec2::X * 4.0, DVec2::X * 10.0],
            false,
            0.4,
        );
        let path = Stroke {
            widths: vec![0.4, 0.4, 0.7],
            ..line.clone()
        };
        let pieces = sides.cut(path.clone());
        let roles: Vec<Role> = pieces.iter().map(|p| p.0).collect();
        use Role::{BottomSkin, InternalSkin, TopSkin};
        assert_eq!(roles, [BottomSkin, TopSkin, InternalSkin]);
        let lengths: Vec<f64> = pieces.iter().map(|p| p.1.length()).collect();
        for (l, e) in lengths.iter().zip([3.0, 2.0, 5.0]) {
            assert!((l - e).abs() < 1e-9, "{lengths:?}");
        }
        assert_eq!(pieces[1].1.widths, [0.4, 0.4, 0.45]);
        assert_eq!(sides.most(&line), InternalSkin);
        // A top of 0.5 mm is too short to be one.
        let above = rect(3.5, 20.0);
        let sides = Sides {
            above: (Covered::Partly, Some(&above)),
            ..sides
        };
        let roles: Vec<Role> = sides.cut(path).iter().map(|p| p.0).collect();
        assert_eq!(roles, [BottomSkin, InternalSkin]);
    }
}

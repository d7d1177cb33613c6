//! From bead to bead: the way there, and whether to retract on it.
//!
//! In: a layer's beads in print order. Out: its moves in print coordinates.
//! Travels are straight. One that leaves the part's solid, crosses an outer
//! wall or is long is retracted; short hops and those inside are not.

use crate::bead::{Bead, Role};
use crate::layers::LayerSpan;
use crate::plane::grid::EdgeGrid;
use crate::settings::Settings;
use glam::DVec2;

/// One step of a layer's tool path, in print order.
#[derive(Clone, Debug, PartialEq)]
pub enum Move {
    /// Go through `points` without extruding, in print coordinates; the
    /// first point is where the path goes, not where the head stands.
    Travel {
        /// Way points, the last one the destination.
        points: Vec<DVec2>,
        /// Retract before and prime after.
        retract: bool,
    },
    /// Print a bead; the head stands at its first point.
    Print(Bead),
}

/// The ordered moves of one layer, in print coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerPath {
    /// The layer.
    pub span: LayerSpan,
    /// Its moves.
    pub moves: Vec<Move>,
}

/// What the travels of one layer must not cross unretracted.
struct Obstacles<'a> {
    solid: &'a EdgeGrid,
    walls: EdgeGrid,
}

/// Connects the beads of a layer. `solid` is its outline, `from` where the
/// head stands, both in the model's coordinates; `offset` moves the result to
/// the printer's.
pub fn connect(
    span: LayerSpan,
    beads: Vec<Bead>,
    solid: &EdgeGrid,
    from: Option<DVec2>,
    offset: DVec2,
    settings: &Settings,
) -> LayerPath {
    let walls = beads
        .iter()
        .filter(|b| matches!(b.role, Role::OuterWall | Role::Overhang))
        .enumerate()
        .flat_map(|(i, b)| b.segments().map(move |s| (i, s)));
    let obstacles = Obstacles {
        solid,
        walls: EdgeGrid::of(walls, 1.0),
    };
    let mut moves = Vec::with_capacity(2 * beads.len());
    let mut at = from;
    let mut inside = false;
    for mut bead in beads {
        let Some(&start) = bead.points.first() else {
            continue;
        };
        let end = match bead.closed {
            true => start,
            false => bead.points.last().copied().unwrap_or(start),
        };
        if at != Some(start) {
            let retract = match at {
                Some(a) => obstacles.retract(a, start, inside, settings),
                None => false,
            };
            moves.push(Move::Travel {
                points: vec![start + offset],
                retract,
            });
        }
        // Beads of the part end inside it; a skirt's does not.
        inside = bead.role != Role::Skirt;
        at = Some(end);
        for p in &mut bead.points {
            *p += offset;
        }
        moves.push(Move::Print(bead));
    }
    LayerPath { span, moves }
}

impl Obstacles<'_> {
    /// Whether to retract on the way from `a` to `b`. `inside` tells that `a`
    /// is known to be inside the part.
    fn retract(
        &self,
        a: DVec2,
        b: DVec2,
        inside: bool,
        settings: &Settings,
    ) -> bool {
        let length = a.distance(b);
        let r = &settings.retract;
        if length < r.min_travel {
            return false;
        }
        if length > r.max_unretracted {
            return true;
        }
        if !inside && !self.solid.contains(a) {
            return true;
        }
        if !self.solid.crossings(a, b).is_empty() {
            return true;
        }
        // Leaving a wall's own start and reaching another's is no crossing.
        let own = 0.5 * settings.outer_wall_width / length;
        self.walls
            .crossings(a, b)
            .iter()
            .any(|&t| t > own && t < 1.0 - own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::Area;

    fn bead(role: Role, points: &[(f64, f64)]) -> Bead {
        Bead {
            role,
            points: points.iter().map(|&(x, y)| DVec2::new(x, y)).collect(),
            closed: false,
            width: 0.45,
            widths: Vec::new(),
            height: 0.2,
        }
    }

    /// A U: two legs 10 mm apart, joined at the bottom.
    fn solid() -> EdgeGrid {
        let ring = [
            (0.0, 0.0),
            (20.0, 0.0),
            (20.0, 20.0),
            (15.0, 20.0),
            (15.0, 5.0),
            (5.0, 5.0),
            (5.0, 20.0),
            (0.0, 20.0),
        ];
        let ring = ring.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        EdgeGrid::new(&Area { rings: vec![ring] }, 1.0)
    }

    fn retracts(beads: Vec<Bead>) -> Vec<bool> {
        let span = LayerSpan {
            index: 0,
            bottom: 0.0,
            top: 0.2,
        };
        let settings = Settings::default();
        connect(span, beads, &solid(), None, DVec2::ZERO, &settings)
            .moves
            .iter()
            .filter_map(|m| match m {
                Move::Travel { retract, .. } => Some(*retract),
                Move::Print(_) => None,
            })
            .collect()
    }

    #[test]
    fn only_travels_that_leave_the_part_are_retracted() {
        let r = retracts(vec![
            bead(Role::SparseInfill, &[(1.0, 1.0), (4.0, 1.0)]),
            // Along the leg: inside.
            bead(Role::SparseInfill, &[(4.0, 15.0), (1.0, 15.0)]),
            // Across the gap between the legs.
            bead(Role::SparseInfill, &[(16.0, 15.0), (17.0, 15.0)]),
            // A hop.
            bead(Role::SparseInfill, &[(17.0, 16.0), (16.0, 16.0)]),
        ]);
        assert_eq!(r, [false, false, true, false]);
    }

    #[test]
    fn leaving_the_skirt_is_retracted() {
        let r = retracts(vec![
            bead(Role::Skirt, &[(-5.0, -5.0), (-5.0, 5.0)]),
            bead(Role::SparseInfill, &[(1.0, 1.0), (4.0, 1.0)]),
        ]);
        assert_eq!(r, [false, true]);
    }

    #[test]
    fn beads_are_moved_to_the_bed() {
        let span = LayerSpan {
            index: 0,
            bottom: 0.0,
            top: 0.2,
        };
        let line = bead(Role::SparseInfill, &[(1.0, 1.0), (4.0, 1.0)]);
        let by = DVec2::new(100.0, 50.0);
        let path =
            connect(span, vec![line], &solid(), None, by, &Settings::default());
        let Some(Move::Print(b)) = path.moves.last() else {
            panic!("nothing printed");
        };
        assert_eq!(b.points[0], DVec2::new(101.0, 51.0));
    }
}

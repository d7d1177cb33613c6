//! From bead to bead: the way there, and whether to retract on it.
//!
//! In: a layer's beads in print order. Out: its moves in print coordinates.
//!
//! A travel goes straight where that is hidden inside the part; else round
//! what is in its way, if there is a way inside the same island that is not
//! much longer (`comb`); else straight. It is retracted if what it passes
//! over shows (`decide`), or if it is long.

mod comb;
mod decide;

use crate::bead::{Bead, Role};
use crate::layers::LayerSpan;
use crate::plane::grid::EdgeGrid;
use crate::plane::{Area, path_length};
use crate::region::wall_depths;
use crate::settings::{Combing, Settings};
use crate::units::Mm;
use comb::Comb;
use decide::Obstacles;
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

/// Connects the beads of a layer. `outline` is its border, `solid` the same
/// for asking what is where, `from` where the head stands, all in the model's
/// coordinates; `offset` moves the result to the printer's.
pub fn connect(
    span: LayerSpan,
    beads: Vec<Bead>,
    outline: &Area,
    solid: &EdgeGrid,
    from: Option<DVec2>,
    offset: DVec2,
    settings: &Settings,
) -> LayerPath {
    let planner = Planner {
        obstacles: Obstacles::new(&beads, solid, span.height(), settings),
        comb: Comb::new(outline, solid, comb_clearance(&span, settings)),
        solid,
        settings,
    };
    let mut travels: Vec<Option<Move>> = Vec::with_capacity(beads.len());
    let mut at = from;
    let mut inside = false;
    for (next, bead) in beads.iter().enumerate() {
        crate::limits::check();
        let Some((start, end)) = ends(bead) else {
            travels.push(None);
            continue;
        };
        travels.push((at != Some(start)).then(|| match at {
            Some(a) => planner.travel(a, start, inside, next),
            None => straight(start, false),
        }));
        // Beads of the part end inside it; a skirt's does not.
        inside = bead.role != Role::Skirt;
        at = Some(end);
    }
    let mut moves = Vec::with_capacity(2 * beads.len());
    for (mut bead, travel) in beads.into_iter().zip(travels) {
        if bead.points.is_empty() {
            continue;
        }
        moves.extend(travel.map(|travel| travel.moved(offset)));
        for p in &mut bead.points {
            *p += offset;
        }
        moves.push(Move::Print(bead));
    }
    LayerPath { span, moves }
}

/// Where a bead begins and ends.
fn ends(bead: &Bead) -> Option<(DVec2, DVec2)> {
    let start = *bead.points.first()?;
    let end = match bead.closed {
        true => start,
        false => bead.points.last().copied().unwrap_or(start),
    };
    Some((start, end))
}

fn straight(to: DVec2, retract: bool) -> Move {
    Move::Travel {
        points: vec![to],
        retract,
    }
}

/// How far travels keep from the outline where they can: inside all walls.
fn comb_clearance(span: &LayerSpan, settings: &Settings) -> Mm {
    let border = wall_depths(span.height(), settings).1;
    border.max(settings.outer_wall_width)
}

/// Finds the travels of a layer.
struct Planner<'a> {
    obstacles: Obstacles<'a>,
    comb: Comb<'a>,
    solid: &'a EdgeGrid,
    settings: &'a Settings,
}

impl Planner<'_> {
    /// The way from `a` to `b`, where the `next`th bead begins. `inside` tells
    /// that `a` is known to be inside the part.
    fn travel(&self, a: DVec2, b: DVec2, inside: bool, next: usize) -> Move {
        let settings = self.settings;
        if a.distance(b) < settings.retract.min_travel {
            return straight(b, false);
        }
        if !inside && !self.solid.contains(a) {
            return straight(b, true);
        }
        let direct = [a, b];
        if !self.retracts(&direct, next) {
            return straight(b, false);
        }
        // Retracted anyway, it goes straight unless that leads over what shows.
        let in_the_way = self.shows(&direct, next);
        if settings.travel.combing == Combing::Off {
            return straight(b, true);
        }
        let around = || {
            let longest = a.distance(b) + settings.travel.max_detour;
            let points = self.comb.way(a, b, longest)?;
            let way: Vec<DVec2> =
                std::iter::once(a).chain(points).chain([b]).collect();
            (path_length(&way, false) <= longest).then_some(way)
        };
        let Some(way) = around() else {
            return straight(b, true);
        };
        let retract = self.retracts(&way, next);
        if retract && !in_the_way {
            return straight(b, true);
        }
        Move::Travel {
            points: way[1..].to_vec(),
            retract,
        }
    }

    /// True if a way leads out of the part or over an outer wall.
    fn shows(&self, way: &[DVec2], next: usize) -> bool {
        self.obstacles.air(way) || self.obstacles.outer_wall(way, next)
    }

    /// Whether to retract on a way.
    fn retracts(&self, way: &[DVec2], next: usize) -> bool {
        let (retract, travel) = (&self.settings.retract, &self.settings.travel);
        let o = &self.obstacles;
        !retract.when_crossing
            || path_length(way, false) > retract.max_unretracted
            || o.air(way)
            || (retract.check_walls
                && (o.outer_wall(way, next) || o.inner_wall(way)))
            || (travel.combing != Combing::Everywhere && o.top_skin(way, next))
    }
}

impl Move {
    /// The same, in coordinates moved by `offset`.
    fn moved(mut self, offset: DVec2) -> Move {
        if let Move::Travel { points, .. } = &mut self {
            for p in points {
                *p += offset;
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn solid() -> Area {
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
        Area { rings: vec![ring] }
    }

    fn retracts(beads: Vec<Bead>) -> Vec<bool> {
        let span = LayerSpan {
            index: 0,
            bottom: 0.0,
            top: 0.2,
        };
        let settings = Settings::default();
        let solid = solid();
        let grid = EdgeGrid::new(&solid, 1.0);
        connect(span, beads, &solid, &grid, None, DVec2::ZERO, &settings)
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
        let settings = Settings::default();
        let solid = solid();
        let grid = EdgeGrid::new(&solid, 1.0);
        let path =
            connect(span, vec![line], &solid, &grid, None, by, &settings);
        let Some(Move::Print(b)) = path.moves.last() else {
            panic!("nothing printed");
        };
        assert_eq!(b.points[0], DVec2::new(101.0, 51.0));
    }
}

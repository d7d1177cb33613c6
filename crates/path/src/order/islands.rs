//! Sorts beads to islands.
//!
//! In: a layer's beads by kind, and its outline. Out: islands, each with its
//! loops: an outer wall and the walls that run along it.

use super::LayerBeads;
use isoslice_base::units::Mm;
use isoslice_layer::seam::Site;
use isoslice_layer::skin::Patch;
use isoslice_planar::Area;
use isoslice_planar::bead::{Bead, Role};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::nest::Nest;

/// An outer wall and the walls that run along it.
#[derive(Default)]
pub(super) struct Loop {
    /// The walls, first the outer one if there is one.
    pub walls: Vec<Bead>,
    /// Where the seam may be.
    pub site: Site,
}

/// Beads of one island.
#[derive(Default)]
pub(super) struct Island {
    pub loops: Vec<Loop>,
    /// Beads in gaps between the walls.
    pub gaps: Vec<Bead>,
    pub infill: Vec<Bead>,
    pub skin: Vec<Patch>,
}

/// Sorts the beads to the islands that they lie in. The skirt lies in none.
pub(super) fn islands(outline: &Area, beads: LayerBeads) -> Vec<Island> {
    let solids = outline.islands();
    // The first ring of an island is its outer one.
    let nest = Nest::new(solids.iter().filter_map(|s| s.rings.first()));
    // Because of fuzz or rounding, a bead's beginning may lie in no island. A
    // bead without any point in an island goes with the bead before it.
    let mut last = 0;
    let mut find = |bead: Option<&Bead>| -> usize {
        if solids.len() > 1
            && let Some(bead) = bead
        {
            let mut around = bead.stroke.points.iter().map(|&p| nest.around(p));
            last = around.find_map(|island| island).unwrap_or(last);
        }
        last
    };
    let mut islands: Vec<Island> =
        solids.iter().map(|_| Island::default()).collect();
    if islands.is_empty() {
        return islands;
    }
    let mut inner: Vec<Vec<Bead>> = vec![Vec::new(); islands.len()];
    let mut sites = beads.sites.into_iter();
    for bead in beads.walls {
        let i = find(Some(&bead));
        let site = sites.next().unwrap_or_default();
        match bead.role {
            Role::OuterWall => islands[i].loops.push(Loop {
                walls: vec![bead],
                site,
            }),
            Role::GapFill => islands[i].gaps.push(bead),
            _ => inner[i].push(bead),
        }
    }
    for (island, inner) in islands.iter_mut().zip(inner) {
        add_inner(&mut island.loops, inner);
    }
    for bead in beads.infill {
        let i = find(Some(&bead));
        islands[i].infill.push(bead);
    }
    for patch in beads.skin {
        let i = find(patch.first());
        islands[i].skin.push(patch);
    }
    islands
}

/// A grid of beads' segments, numbered by bead.
pub(super) fn grid_of<'a>(
    beads: impl Iterator<Item = &'a Bead>,
    reach: Mm,
) -> EdgeGrid {
    let segments = beads
        .enumerate()
        .flat_map(|(i, b)| b.stroke.segments().map(move |s| (i, s)));
    EdgeGrid::of(segments, reach)
}

/// Adds each inner wall to the outer wall that it runs along.
fn add_inner(loops: &mut Vec<Loop>, inner: Vec<Bead>) {
    if loops.is_empty() {
        loops.extend(inner.into_iter().map(|b| Loop {
            walls: vec![b],
            site: Site::default(),
        }));
        return;
    }
    let outer = loops.iter().filter_map(|l| l.walls.first());
    let grid =
        (loops.len() > 1 && !inner.is_empty()).then(|| grid_of(outer, 1.0));
    for bead in inner {
        let i = grid
            .as_ref()
            .zip(bead.stroke.points.first())
            .and_then(|(grid, &p)| grid.nearest(p))
            .map_or(0, |near| near.0);
        loops[i].walls.push(bead);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use isoslice_planar::bead::Stroke;

    #[test]
    fn a_wall_that_begins_outside_belongs_where_it_goes_on() {
        let square = |x: f64, w: f64| {
            [(x - w, -w), (x + w, -w), (x + w, w), (x - w, w)]
                .map(|(x, y)| DVec2::new(x, y))
                .to_vec()
        };
        let outline = Area::from_iter([square(0.0, 5.0), square(20.0, 5.0)]);
        // Fuzz has moved the first point of the right island's wall out.
        let mut right = square(20.0, 4.8);
        right[0] = DVec2::new(14.9, -5.1);
        let walls = [square(0.0, 4.8), right].map(|points| {
            Bead::new(Role::OuterWall, Stroke::new(points, true, 0.4), 0.2)
        });
        let beads = LayerBeads {
            walls: walls.to_vec(),
            ..LayerBeads::default()
        };
        let found = islands(&outline, beads);
        let loops: Vec<usize> = found.iter().map(|i| i.loops.len()).collect();
        assert_eq!(loops, [1, 1]);
    }
}

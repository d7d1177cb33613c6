//! Small islands of sparse infill, which are filled solid.
//!
//! In: a layer's skin and sparse area, and the beads of its infill. Out: the
//! areas, with such islands as skin. An island that is smaller than the infill's
//! meshes has a line or none by chance: of equal pins some would be hollow, and each of
//! them in some layers only. What is above an island without a line would rest on
//! nothing.

use super::InfillPlan;
use crate::exposure::FillAreas;
use isoslice_base::units::Mm2;
use isoslice_planar::Area;
use isoslice_planar::bead::Bead;
use isoslice_planar::clip::union;
use isoslice_planar::nest::Nest;

/// Content of a square with a side of one spacing of the infill's lines; none where the
/// density varies, or the pattern is an expression: no spacing then tells which islands
/// are small.
fn mesh(plan: &InfillPlan) -> Option<Mm2> {
    let percent = plan.density.constant().filter(|p| *p > 0.0);
    let percent = percent.filter(|_| !plan.is_own())?;
    Some((plan.width / (percent / 100.0)).powi(2))
}

/// Makes skin of the islands of sparse infill that are smaller than a mesh.
pub fn fill_small(areas: &mut FillAreas, plan: &InfillPlan) {
    /// An island of that content stays sparse, however wide the meshes are, mm².
    const MOST: Mm2 = 20.0;
    let Some(mesh) = mesh(plan) else {
        return;
    };
    let islands = areas.sparse.islands();
    make_skin(areas, islands, |_, island| {
        island.content() < mesh.min(MOST)
    });
}

/// Makes skin of the islands of sparse infill in which no line of `infill`
/// lies, if they are small.
pub fn fill_bare(areas: &mut FillAreas, infill: &[Bead], plan: &InfillPlan) {
    /// A small island is no larger than a square of so many spacings.
    const SIDE: f64 = 2.0;
    let Some(mesh) = mesh(plan) else {
        return;
    };
    let most = SIDE * SIDE * mesh;
    let islands = areas.sparse.islands();
    let is_small = |island: &Area| island.content() < most;
    if !islands.iter().any(is_small) {
        return;
    }
    let nest = Nest::new(islands.iter().filter_map(|i| i.rings.first()));
    let mut has = vec![false; islands.len()];
    for bead in infill {
        // A bead's ends lie on the walls or the skin around the island.
        for (a, b) in bead.stroke.segments() {
            if let Some(island) = nest.around(a.midpoint(b)) {
                has[island] = true;
            }
        }
    }
    make_skin(areas, islands, |i, island| !has[i] && is_small(island));
}

/// Makes skin of some of the sparse area's islands, chosen by number and shape.
fn make_skin(
    areas: &mut FillAreas,
    islands: Vec<Area>,
    is: impl Fn(usize, &Area) -> bool,
) {
    let islands = islands.into_iter().enumerate();
    let (solid, rest): (Vec<_>, Vec<_>) =
        islands.partition(|(i, island)| is(*i, island));
    if solid.is_empty() {
        return;
    }
    let [solid, rest] = [solid, rest].map(|islands| {
        islands.into_iter().flat_map(|(_, i)| i.rings).collect()
    });
    areas.skin = union(&areas.skin, &solid);
    areas.sparse = rest;
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use isoslice_planar::bead::{Role, Stroke};
    use isoslice_planar::rect;
    use isoslice_settings::testing::plan_with;

    #[test]
    fn small_islands_without_a_line_of_infill_become_skin() {
        let joined = |areas: &[Area]| {
            areas.iter().flat_map(|a| a.rings.clone()).collect()
        };
        // Lines 3 mm apart: an island of 36 mm² is small.
        let [crossed, bare] = [0.0, 10.0].map(|x| rect(x, 0.0, x + 3.0, 3.0));
        let large = rect(20.0, 0.0, 27.0, 7.0);
        let beside = rect(0.0, 20.0, 9.0, 29.0);
        let line = vec![DVec2::new(-0.2, 1.0), DVec2::new(3.2, 2.0)];
        let stroke = Stroke::new(line, false, 0.45);
        let infill = [Bead::new(Role::SparseInfill, stroke, 0.2)];
        let areas = FillAreas {
            skin: beside.clone(),
            sparse: joined(&[crossed.clone(), bare.clone(), large.clone()]),
        };
        let filled = |density: f64| {
            let plan = plan_with(InfillPlan::of, |s| {
                s.infill_density = density.into()
            });
            let mut areas = areas.clone();
            fill_bare(&mut areas, &infill, &plan);
            areas
        };
        let found = filled(15.0);
        assert_eq!(found.sparse, joined(&[crossed, large]));
        let skin = bare.content() + beside.content();
        assert!((found.skin.content() - skin).abs() < 1e-6);
        // Nobody wants lines there.
        assert_eq!(filled(0.0), areas);
    }

    #[test]
    fn islands_smaller_than_a_mesh_become_skin_wherever_lines_are() {
        // Meshes of 3 mm; of 45 mm, which are too large for it.
        for (density, solid) in [(15.0, 2.9), (1.0, 4.4)] {
            let plan = plan_with(InfillPlan::of, |s| {
                s.infill_density = density.into()
            });
            for (side, sparse) in [(solid, false), (solid + 0.2, true)] {
                let mut areas = FillAreas {
                    skin: Area::EMPTY,
                    sparse: rect(0.0, 0.0, side, side),
                };
                fill_small(&mut areas, &plan);
                assert_eq!(areas.skin.is_empty(), sparse, "{density} {side}");
                assert_eq!(areas.sparse.is_empty(), !sparse);
            }
        }
    }
}

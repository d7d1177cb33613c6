//! The beads of a layer, before they have their order.

use super::Stages;
use crate::bead::{Bead, Role};
use crate::infill::{self, InfillError};
use crate::order::LayerBeads;
use crate::pipeline::SliceError;
use crate::pipeline::layer::{Inside, Layer, faces, window};
use crate::plane::clip::union;
use crate::plane::nest::Nest;
use crate::plane::{Area, edges};
use crate::region::exposure::FillAreas;
use crate::resolution::thin;
use crate::settings::{Settings, Varying};
use crate::skin::Patch;
use crate::timings::Stage;
use crate::units::Mm2;
use crate::{skin, walls};
use std::collections::VecDeque;

impl Stages<'_> {
    /// Everything there is to print in layer `i` of the window, and where it
    /// has sparse infill.
    pub(in crate::pipeline) fn beads(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
        Inside { walls, roomy }: &Inside,
    ) -> Result<(LayerBeads, FillAreas), SliceError> {
        let Layer { span, outline, .. } = &layers[i];
        let (number, height) = (span.index, span.height());
        let solid = outline.grid();
        let skirt = self.loops(&layers[i]);
        let turns =
            self.timings.time(Stage::Walls, || self.turns(layers, i))?;
        if !turns.is_empty() {
            let beads = LayerBeads {
                skirt,
                turns,
                ..LayerBeads::default()
            };
            return Ok((beads, FillAreas::default()));
        }
        let mut areas = self.timings.time(Stage::Skin, || {
            let window = window(layers, i);
            self.exposure.split(&walls.fill, roomy, &window)
        });
        let infill = self.infill_in(&areas.sparse, &layers[i])?;
        let mut skin = self.timings.time(Stage::Skin, || {
            fill_bare(&mut areas, &infill, self.settings);
            skin::patches(
                &areas.skin,
                faces(layers, i),
                number,
                height,
                self.settings,
            )
        });
        if self.is_on_raft(number) {
            // The skin's underside lies over the air above the raft.
            let down = of_skin(&mut skin);
            for bead in down.filter(|b| b.role == Role::BottomSkin) {
                bead.role = Role::Bridge;
            }
        }
        let small = self.settings.speed.small_wall_length;
        let mut walls = if self.settings.interlocks() {
            walls::interlocked(walls, height, small)
        } else {
            walls::beads(walls, height, small)
        };
        let sites = self.timings.time(Stage::Walls, || {
            self.seams.sites(&walls, number, span.sample_z(), solid)
        })?;
        if let Some(fuzzy) = &self.fuzzy {
            self.timings.time(Stage::Walls, || {
                fuzzy.apply(&mut walls, number, span.sample_z(), solid)
            })?;
        }
        let mut beads = LayerBeads {
            support: self.support_beads(span)?,
            support_last: !number.is_multiple_of(2),
            skirt,
            turns: Vec::new(),
            walls,
            sites,
            infill,
            skin,
        };
        // The walls have been thinned already.
        self.timings.time(Stage::Infill, || {
            let all = beads.skirt.iter_mut().chain(&mut beads.support);
            self.thin(all.chain(&mut beads.infill));
            self.thin(of_skin(&mut beads.skin));
        });
        Ok((beads, areas))
    }

    /// A layer's sparse infill.
    pub(super) fn infill_in(
        &self,
        sparse: &Area,
        layer: &Layer,
    ) -> Result<Vec<Bead>, InfillError> {
        let target = infill::Target {
            number: layer.span.index,
            z: layer.span.sample_z(),
            height: layer.span.height(),
        };
        let solid = layer.outline.grid();
        self.timings.time(Stage::Infill, || {
            if self.settings.spiral {
                Ok(Vec::new())
            } else {
                self.infill.beads(sparse, target, Some(solid))
            }
        })
    }

    /// Thins beads as far as their roles permit.
    pub(super) fn thin<'b>(&self, beads: impl Iterator<Item = &'b mut Bead>) {
        for bead in beads {
            let role = bead.role;
            thin(bead, role, self.settings);
        }
    }
}

/// Makes skin of the islands of sparse infill in which no line of it lies, if
/// they are small: what is above them would rest on nothing.
fn fill_bare(areas: &mut FillAreas, infill: &[Bead], settings: &Settings) {
    /// A small island is no larger than a square of so many spacings.
    const SIDE: f64 = 2.0;
    let share = match settings.infill_density {
        Varying::Constant(percent) if settings.infill_is_pattern() => {
            percent / 100.0
        }
        _ => return,
    };
    if share <= 0.0 {
        return;
    }
    let most: Mm2 = (SIDE * settings.infill_width() / share).powi(2);
    let islands = areas.sparse.islands();
    let is_small = |island: &Area| island.content() < most;
    if !islands.iter().any(is_small) {
        return;
    }
    let nest = Nest::new(islands.iter().filter_map(|i| i.rings.first()));
    let mut has = vec![false; islands.len()];
    for bead in infill {
        // Their ends lie on what is around the island.
        for (a, b) in edges(&bead.points) {
            if let Some(island) = nest.around(a.midpoint(b)) {
                has[island] = true;
            }
        }
    }
    let (bare, rest): (Vec<_>, Vec<_>) = islands
        .into_iter()
        .zip(has)
        .partition(|(island, has)| !has && is_small(island));
    if bare.is_empty() {
        return;
    }
    let [bare, rest] = [bare, rest].map(|islands| Area {
        rings: islands.into_iter().flat_map(|(i, _)| i.rings).collect(),
    });
    areas.skin = union(&areas.skin, &bare);
    areas.sparse = rest;
}

/// The beads of some skin.
pub(super) fn of_skin(skin: &mut [Patch]) -> impl Iterator<Item = &mut Bead> {
    skin.iter_mut().flat_map(|patch| {
        let fills = patch.fills.iter_mut().flat_map(|f| &mut f.lines);
        patch.rings.iter_mut().chain(fills)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bead::Stroke;
    use crate::plane::rect;
    use glam::DVec2;

    #[test]
    fn small_islands_without_a_line_of_infill_become_skin() {
        let joined = |areas: &[Area]| Area {
            rings: areas.iter().flat_map(|a| a.rings.clone()).collect(),
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
            let settings = Settings {
                infill_density: density.into(),
                ..Settings::default()
            };
            let mut areas = areas.clone();
            fill_bare(&mut areas, &infill, &settings);
            areas
        };
        let found = filled(15.0);
        assert_eq!(found.sparse, joined(&[crossed, large]));
        let skin = bare.content() + beside.content();
        assert!((found.skin.content() - skin).abs() < 1e-6);
        // Nobody wants lines there.
        assert_eq!(filled(0.0), areas);
    }
}

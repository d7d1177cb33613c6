//! Which part of the fill is skin.
//!
//! A point is exposed upwards where any of the next N layers does not cover
//! it, downwards where any of the M layers below does not. All layers between
//! count, not only the outermost: a cavity thinner than N layers has a roof.
//!
//! ```text
//!   layer i+2   ░░░░░░░            exposed: where not all of the
//!   layer i+1   ░░░░░░░░░░         neighbours cover layer i
//!   layer i     ▒▒▒▒▒▒▒████ skin
//! ```
//!
//! Exposed areas grow a little into the sparse area, which anchors their
//! lines and makes thin ones printable; what is then too narrow or too small
//! for sparse infill becomes skin as well. Skin and sparse area together are
//! the fill.

use crate::plane::Area;
use crate::plane::clip::{crop, difference, intersection, not_covered_by_all};
use crate::plane::offset::offset;
use crate::settings::Settings;
use crate::units::Mm;

/// The fill, split.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FillAreas {
    /// To be filled solid.
    pub skin: Area,
    /// To be filled at the infill's density.
    pub sparse: Area,
}

/// Coarse enough to be cheap, finer than any bead: borders between skin and
/// sparse infill are inside the part.
const TOLERANCE: Mm = 0.02;

/// Splits a layer's fill. `above` and `below` are the outlines of the layers
/// that have to cover it, nearest first; beyond the part they are empty.
pub fn split(
    fill: &Area,
    above: &[&Area],
    below: &[&Area],
    settings: &Settings,
) -> FillAreas {
    // What sparse infill would not fit into is skin, exposed or not. In
    // lattices that is nearly everything, and need not be looked at again.
    let roomy = match settings.infill_density >= 100.0 {
        true => Area::EMPTY,
        false => printable(fill, settings),
    };
    if roomy.is_empty() {
        return FillAreas {
            skin: fill.clone(),
            sparse: Area::EMPTY,
        };
    }
    let covers: Vec<&Area> = above.iter().chain(below).copied().collect();
    let exposed = exposed(&roomy, &covers);
    let sparse = match exposed.is_empty() {
        true => roomy,
        false => {
            let grown = offset(&exposed, settings.skin_overlap, TOLERANCE);
            printable(&difference(&roomy, &grown), settings)
        }
    };
    let skin = match sparse.is_empty() {
        true => fill.clone(),
        false => difference(fill, &sparse),
    };
    FillAreas { skin, sparse }
}

/// The part of an area that not all covers cover.
fn exposed(area: &Area, covers: &[&Area]) -> Area {
    /// Up to so many islands, cropping the covers to each of them costs less
    /// than sweeping all of the covers once.
    const FEW: usize = 24;
    let islands = area.islands();
    if islands.len() > FEW {
        return not_covered_by_all(area, covers);
    }
    let rings = islands.iter().flat_map(|island| {
        let mut near = island.bounds();
        near.min -= 1.0;
        near.max += 1.0;
        let covers: Vec<Area> = covers.iter().map(|c| crop(c, near)).collect();
        let covers: Vec<&Area> = covers.iter().collect();
        not_covered_by_all(island, &covers).rings
    });
    Area {
        rings: rings.collect(),
    }
}

/// The parts of an area wide and large enough for sparse infill.
fn printable(area: &Area, settings: &Settings) -> Area {
    let half = 0.5 * settings.infill_width;
    let mut wide = Area::EMPTY;
    for island in area.islands() {
        if island.content() < settings.skin_min_area {
            continue;
        }
        let core = offset(&island, -half, TOLERANCE);
        if core.is_empty() {
            continue;
        }
        // Grown back by more than it was shrunk, and cut to what there was:
        // corners return, and necks too narrow for a bead do not.
        let back = offset(&core, 2.0 * half, TOLERANCE);
        let whole = intersection(&island, &back);
        let parts = whole.islands().into_iter();
        wide.rings.extend(
            parts
                .filter(|p| p.content() >= settings.skin_min_area)
                .flat_map(|p| p.rings),
        );
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Area {
        let ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area { rings: vec![ring] }
    }

    #[test]
    fn covered_areas_stay_sparse_and_open_ones_become_skin() {
        let settings = Settings::default();
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        let all = rect(-1.0, -1.0, 21.0, 21.0);
        let f = split(&fill, &[&all, &all], &[&all], &settings);
        assert!((f.sparse.content() - 400.0).abs() < 1e-6);
        assert!(f.skin.content() < 1e-6);
        let f = split(&fill, &[&all, &Area::EMPTY], &[&all], &settings);
        assert_eq!(f.skin, fill);
    }

    #[test]
    fn a_layer_between_counts() {
        // Only the middle one of three layers above has a hole.
        let settings = Settings::default();
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        let all = rect(-1.0, -1.0, 21.0, 21.0);
        let holed = difference(&all, &rect(5.0, 5.0, 10.0, 10.0));
        let f = split(&fill, &[&all, &holed, &all], &[&all], &settings);
        let grown = 5.0 + 2.0 * settings.skin_overlap;
        let skin = f.skin.content();
        assert!((25.0..=grown * grown).contains(&skin), "{skin}");
        let both = skin + f.sparse.content();
        assert!((both - 400.0).abs() < 1e-3);
    }

    #[test]
    fn slivers_of_sparse_area_become_skin() {
        let settings = Settings::default();
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        // Leaves a strip 0.2 mm wide once the skin has grown.
        let cover = rect(19.8 - settings.skin_overlap, -1.0, 21.0, 21.0);
        let f = split(&fill, &[&cover], &[], &settings);
        assert_eq!(f.skin, fill);
        assert!(f.sparse.is_empty());
    }
}

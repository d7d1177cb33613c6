//! What the tests of infill share: areas, layers, and how much is in them.

mod density;
mod islands;
mod place;
mod shapes;

use super::*;
use isoslice_model::{Model, Placement, placed};
use isoslice_planar::shapes::square;
use isoslice_settings::Varying;
use isoslice_settings::testing::{plan_with, usual_plan};

/// A pattern of one density.
fn even(pattern: InfillPattern, density: f64) -> InfillPlan {
    plan_with(InfillPlan::of, |s| {
        s.infill_density = density.into();
        s.infill = isoslice_settings::Infill::Pattern(pattern);
    })
}

/// A pattern whose density is an expression.
fn graded(pattern: InfillPattern, density: &str) -> InfillPlan {
    InfillPlan {
        density: Varying::Expression(density.into()),
        ..even(pattern, 15.0)
    }
}

/// A shape by its formula; `solid` if it is filled.
fn shape(text: &str, solid: bool) -> InfillPlan {
    InfillPlan {
        pattern: isoslice_settings::Infill::Expression(text.into()),
        solid,
        ..usual_plan(InfillPlan::of)
    }
}

/// A box of 100 mm on the bed.
fn block() -> Model {
    let block = "max(max(abs(x), abs(y)), abs(z)) - 50";
    placed(block, &Placement::default())
}

const HERE: Site = Site {
    part: Rect::new(DVec2::splat(-50.0), DVec2::splat(50.0)),
    height: 100.0,
    origin: DVec2::ZERO,
};

/// Beads of layers of an area.
fn lay(
    plan: &InfillPlan,
    site: Site,
    area: &Area,
    places: impl IntoIterator<Item = LayerSpan>,
) -> Vec<Vec<Bead>> {
    let block = block();
    let around = Surroundings::new(&block);
    let infill = Infill::new(plan.clone(), &around, site).unwrap();
    let layers = places.into_iter();
    layers
        .map(|p| infill.beads(area, &p, None).unwrap())
        .collect()
}

fn layer(index: usize) -> LayerSpan {
    LayerSpan {
        index,
        bottom: 0.2 * index as f64,
        top: 0.2 * (index + 1) as f64,
    }
}

/// A layer at one of the heights spread evenly, out of step with any period.
/// They span so many periods that their number need not be whole.
fn spread(index: usize) -> LayerSpan {
    let z = 3000.0 * (0.618_034 * index as f64).fract();
    LayerSpan {
        index,
        bottom: z - 0.1,
        top: z + 0.1,
    }
}

/// Length of what the beads of some layers have inside a box.
fn length_within(layers: &[Vec<Bead>], middle: DVec2, half: DVec2) -> f64 {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let window = Area::from(
        corners
            .map(|(x, y)| middle + half * DVec2::new(x, y))
            .to_vec(),
    );
    let border = Border::new(&window);
    let mut cutter = isoslice_planar::border::Cutter::new(&border);
    for bead in layers.iter().flatten() {
        cutter.line(&bead.stroke.points, bead.stroke.closed);
    }
    let pieces = cutter.finish();
    let lengths = pieces.iter();
    lengths
        .map(|p| isoslice_planar::path_length(&p.points, p.closed))
        .sum()
}

/// Percentage of the volume of some layers, within a box, that is in beads.
fn share_at(layers: &[Vec<Bead>], middle: DVec2, half: DVec2) -> f64 {
    let volume = length_within(layers, middle, half)
        * isoslice_planar::bead::cross_section(0.45, 0.2);
    let whole = 4.0 * half.x * half.y * 0.2 * layers.len() as f64;
    100.0 * volume / whole
}

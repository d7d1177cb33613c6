//! Where the part's surface is above and below points of a layer.
//!
//! In: points in the plane, and a window of heights. Out: for each point the
//! height at which the part ends upwards, or downwards, within the window, and
//! how steep the surface is there. The field is evaluated as it is: only its sign
//! matters, it need not be a distance, and NaN is outside.

use crate::model::{Probe, ProbeError};
use crate::units::Mm;
use glam::DVec2;

/// Heights of a window at which a change of sign is looked for: the bottom, the
/// top and 3 between them.
const LOOKS: usize = 5;

/// Halvings of the distance between two of these heights: of 0.1 mm they leave
/// 0.02 µm, about what the field's 32 bits tell apart.
const HALVINGS: usize = 12;

/// Points whose columns are evaluated together.
const BATCH: usize = 512;

/// Heights between which a surface is looked for, in the model's frame, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub low: Mm,
    pub high: Mm,
}

/// Which way a face looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Facing {
    /// The part ends upwards.
    Up,
    /// The part ends downwards.
    Down,
}

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    /// Height of the point in the model's frame, mm.
    pub height: Mm,
    /// Change of the surface's height with x and y.
    pub slope: DVec2,
}

/// The surface above each point, or below it; nothing where the window has no
/// surface, or where the point stands on an edge or a spike. `beside` is the
/// distance at which the slope is measured.
///
/// # Errors
/// If the evaluator fails, which is a bug.
pub(super) fn spots(
    probe: &Probe,
    points: &[DVec2],
    window: Window,
    facing: Facing,
    beside: Mm,
) -> Result<Vec<Option<Spot>>, ProbeError> {
    let mut out = Vec::with_capacity(points.len());
    for batch in points.chunks(BATCH) {
        crate::limits::check();
        let around = |p: DVec2| {
            let (x, y) = (beside * DVec2::X, beside * DVec2::Y);
            [p, p - x, p + x, p - y, p + y]
        };
        let columns: Vec<DVec2> =
            batch.iter().flat_map(|p| around(*p)).collect();
        let heights = heights(probe, &columns, window, facing)?;
        out.extend(heights.chunks_exact(5).map(|h| {
            let height = h[0]?;
            let along =
                |before: Option<Mm>, after: Option<Mm>| match (before, after) {
                    (Some(a), Some(b)) => Some((b - a) / (2.0 * beside)),
                    (Some(a), None) => Some((height - a) / beside),
                    (None, Some(b)) => Some((b - height) / beside),
                    (None, None) => None,
                };
            let slope = DVec2::new(along(h[1], h[2])?, along(h[3], h[4])?);
            Some(Spot { height, slope })
        }));
    }
    Ok(out)
}

/// The height within the window at which the part ends upwards, or downwards,
/// for each point. If there are several such heights, it is the outermost one.
fn heights(
    probe: &Probe,
    points: &[DVec2],
    window: Window,
    facing: Facing,
) -> Result<Vec<Option<Mm>>, ProbeError> {
    let (x, y): (Vec<f32>, Vec<f32>) =
        points.iter().map(|p| (p.x as f32, p.y as f32)).unzip();
    // The heights go from the part's inside outwards.
    let (first, last) = match facing {
        Facing::Up => (window.low, window.high),
        Facing::Down => (window.high, window.low),
    };
    let step = (last - first) / (LOOKS - 1) as f64;
    // The heights between which the part ends, inside and outside.
    let mut brackets: Vec<Option<(Mm, Mm)>> = vec![None; points.len()];
    let mut inside = vec![false; points.len()];
    for look in 0..LOOKS {
        let at = first + look as f64 * step;
        let z = vec![at as f32; points.len()];
        for (i, f) in probe.values(&x, &y, &z)?.into_iter().enumerate() {
            let before = std::mem::replace(&mut inside[i], f < 0.0);
            if before && !inside[i] {
                brackets[i] = Some((at - step, at));
            }
        }
    }
    // A part that goes on beyond the window does not end in it.
    for (bracket, inside) in brackets.iter_mut().zip(inside) {
        *bracket = bracket.filter(|_| !inside);
    }
    let open: Vec<usize> = (0..points.len())
        .filter(|&i| brackets[i].is_some())
        .collect();
    let pick =
        |all: &[f32]| -> Vec<f32> { open.iter().map(|&i| all[i]).collect() };
    let (x, y) = (pick(&x), pick(&y));
    for _ in 0..HALVINGS {
        let middle = |i: usize| {
            let bracket: Option<(Mm, Mm)> = brackets[i];
            bracket.map_or(0.0, |(a, b)| 0.5 * (a + b))
        };
        let z: Vec<f32> = open.iter().map(|&i| middle(i) as f32).collect();
        for (&i, f) in open.iter().zip(probe.values(&x, &y, &z)?) {
            if let Some((a, b)) = &mut brackets[i] {
                let middle = 0.5 * (*a + *b);
                if f < 0.0 { *a = middle } else { *b = middle }
            }
        }
    }
    let middle =
        |bracket: Option<(Mm, Mm)>| bracket.map(|(a, b)| 0.5 * (a + b));
    Ok(brackets.into_iter().map(middle).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Tree;

    const WINDOW: Window = Window {
        low: 2.8,
        high: 3.2,
    };

    fn spot(f: Tree, x: f64) -> Option<Spot> {
        let probe = Probe::new(&f).unwrap();
        let points = [DVec2::new(x, 0.5)];
        spots(&probe, &points, WINDOW, Facing::Up, 0.1).unwrap()[0]
    }

    #[test]
    fn a_ramp_is_found_to_a_fraction_of_a_micrometre() {
        // Three times the distance, and 10 squared: only the sign matters.
        let plane = || Tree::z() - 3.0 - 0.2 * Tree::x() + 0.05 * Tree::y();
        for f in [3.0 * plane(), plane() * (Tree::z() + 7.0)] {
            let found = spot(f, 0.25).unwrap();
            assert!((found.height - 3.025).abs() < 2e-5, "{found:?}");
            let off = found.slope - DVec2::new(0.2, -0.05);
            assert!(off.length() < 3e-4, "{found:?}");
        }
    }

    #[test]
    fn what_goes_on_upwards_or_ends_below_has_no_surface() {
        let at = |z: f32| Tree::z() - z + 0.0 * Tree::x() + 0.0 * Tree::y();
        assert!(spot(at(2.7), 0.0).is_none());
        assert!(spot(at(3.3), 0.0).is_none());
        assert!(spot(at(3.1), 0.0).is_some());
        // A slit in the window, with the part above it.
        let slit = at(2.9).min(3.1 - Tree::z());
        assert!(spot(slit, 0.0).is_none());
        // No number outside.
        let root = (3.0 - Tree::z()).sqrt() - 9.0 + 0.0 * Tree::x();
        let found = spot(root, 0.0).unwrap();
        assert!((found.height - 3.0).abs() < 2e-5);
    }

    #[test]
    fn undersides_are_found_from_above() {
        // A slab above a leaning face, with a slit in it.
        let lean = || Tree::z() - 3.0 - 0.2 * Tree::x() + 0.0 * Tree::y();
        let probe = Probe::new(&-lean()).unwrap();
        let at = [DVec2::new(0.25, 0.5)];
        let down = |probe: &Probe| {
            spots(probe, &at, WINDOW, Facing::Down, 0.1).unwrap()[0]
        };
        let found = down(&probe).unwrap();
        assert!((found.height - 3.05).abs() < 2e-5, "{found:?}");
        let off = found.slope - DVec2::new(0.2, 0.0);
        assert!(off.length() < 3e-4, "{found:?}");
        // What has no top has none upwards, and the reverse.
        assert!(
            spots(&probe, &at, WINDOW, Facing::Up, 0.1).unwrap()[0].is_none()
        );
        assert!(down(&Probe::new(&lean()).unwrap()).is_none());
    }

    #[test]
    fn beside_a_cliff_the_slope_is_that_of_the_open_side() {
        // A ledge at 3, and a wall from x = 1 on.
        let ledge = Tree::z() - 3.0 + 0.0 * Tree::y();
        let f = ledge.min(1.0 - Tree::x());
        let found = spot(f, 0.95).unwrap();
        assert!((found.height - 3.0).abs() < 2e-5);
        assert!(found.slope.length() < 3e-4);
    }
}

//! Where the part's surface is above and below points of a layer.
//!
//! In: points in the plane, and a window of heights. Out: for each point the
//! height at which the part ends upwards, or downwards, within the window, and
//! how steep the surface is there. The field is evaluated as it is: only its sign
//! matters, it need not be a distance, and NaN is outside.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_model::{Probe, ProbeError};

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
/// distance at which the slope is measured. Where the slope is more than `steep`
/// along x or y, it does not matter how much more.
///
/// # Errors
/// If the evaluator fails, which is a bug.
pub(super) fn spots(
    probe: &Probe,
    points: &[DVec2],
    window: Window,
    facing: Facing,
    beside: Mm,
    steep: f64,
) -> Result<Vec<Option<Spot>>, ProbeError> {
    let (x, y) = (beside * DVec2::X, beside * DVec2::Y);
    let mut out = vec![None; points.len()];
    for (batch, out) in points.chunks(BATCH).zip(out.chunks_mut(BATCH)) {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        // Below most points the part goes on, and most of the others are on
        // steep faces: there the sides are not looked for.
        let middle = heights(probe, batch, window, facing)?;
        let found: Vec<(usize, DVec2, Mm)> = (0..batch.len())
            .filter_map(|i| Some((i, batch[i], middle[i]?)))
            .collect();
        let slopes = steepness(probe, &found, facing, beside, steep)?;
        let flat = || found.iter().zip(&slopes).filter(|f| f.1.is_none());
        let sides: Vec<DVec2> = flat()
            .flat_map(|f| [-x, x, -y, y].map(|d| f.0.1 + d))
            .collect();
        let sides = heights(probe, &sides, window, facing)?;
        for (&(i, _, height), slope) in found.iter().zip(&slopes) {
            out[i] = slope.map(|slope| Spot { height, slope });
        }
        for (((i, _, height), _), sides) in flat().zip(sides.chunks_exact(4)) {
            if let Ok(sides) = sides.try_into() {
                out[*i] = spot_of(*height, sides, beside);
            }
        }
    }
    Ok(out)
}

/// For each of these points with their heights: a slope of the surface, if it is
/// more than `steep` along x or along y; nothing elsewhere. There the surface is
/// higher on one side of the point than such a slope would take it, and lower on the
/// other side.
fn steepness(
    probe: &Probe,
    points: &[(usize, DVec2, Mm)],
    facing: Facing,
    beside: Mm,
    steep: f64,
) -> Result<Vec<Option<DVec2>>, ProbeError> {
    const AXES: [DVec2; 4] = [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];
    if !steep.is_finite() {
        return Ok(vec![None; points.len()]);
    }
    let off = beside * steep;
    let places: Vec<(DVec2, Mm)> = points
        .iter()
        .flat_map(|&(_, p, height)| {
            AXES.into_iter().flat_map(move |axis| {
                let d = beside * axis;
                [(p + d, height + off), (p - d, height - off)]
            })
        })
        .collect();
    let of = |pick: fn(&(DVec2, Mm)) -> Mm| -> Vec<f32> {
        places.iter().map(|place| pick(place) as f32).collect()
    };
    let values = probe.values(&of(|p| p.0.x), &of(|p| p.0.y), &of(|p| p.1))?;
    // True if a place is below the surface.
    let below = |f: f32| (f < 0.0) == (facing == Facing::Up);
    let slope = |f: &[f32]| {
        let pairs = AXES.into_iter().zip(f.chunks_exact(2));
        let mut steep_ones = pairs.filter(|(_, f)| below(f[0]) && !below(f[1]));
        steep_ones.next().map(|(axis, _)| steep * axis)
    };
    Ok(values.chunks_exact(2 * AXES.len()).map(slope).collect())
}

/// The spot at a height between its sides, which are before and after it along
/// x, and then along y.
fn spot_of(
    height: Mm,
    [left, right, front, rear]: [Option<Mm>; 4],
    beside: Mm,
) -> Option<Spot> {
    let along = |before: Option<Mm>, after: Option<Mm>| match (before, after) {
        (Some(a), Some(b)) => Some((b - a) / (2.0 * beside)),
        (Some(a), None) => Some((height - a) / beside),
        (None, Some(b)) => Some((b - height) / beside),
        (None, None) => None,
    };
    let slope = DVec2::new(along(left, right)?, along(front, rear)?);
    Some(Spot { height, slope })
}

/// The height within the window at which the part ends upwards, or downwards,
/// for each point. If there are several such heights, it is the outermost one.
fn heights(
    probe: &Probe,
    points: &[DVec2],
    window: Window,
    facing: Facing,
) -> Result<Vec<Option<Mm>>, ProbeError> {
    // The heights go from the part's inside outwards.
    let (first, last) = match facing {
        Facing::Up => (window.low, window.high),
        Facing::Down => (window.high, window.low),
    };
    let step = (last - first) / (LOOKS - 1) as f64;
    let inside = |of: &[usize], at: Mm| -> Result<Vec<bool>, ProbeError> {
        let x: Vec<f32> = of.iter().map(|&i| points[i].x as f32).collect();
        let y: Vec<f32> = of.iter().map(|&i| points[i].y as f32).collect();
        let z = vec![at as f32; of.len()];
        let values = probe.values(&x, &y, &z)?;
        Ok(values.into_iter().map(|f| f < 0.0).collect())
    };
    // A part that goes on beyond the window does not end in it.
    let mut open: Vec<usize> = (0..points.len()).collect();
    let beyond = inside(&open, first + (LOOKS - 1) as f64 * step)?;
    open.retain(|&i| !beyond[i]);
    // The heights between which the part ends, inside and outside.
    let mut brackets: Vec<Option<(Mm, Mm)>> = vec![None; points.len()];
    let mut was = vec![false; open.len()];
    for look in 0..LOOKS {
        let at = first + look as f64 * step;
        let is = match look + 1 {
            LOOKS => vec![false; open.len()],
            _ => inside(&open, at)?,
        };
        for ((&i, was), is) in open.iter().zip(&was).zip(&is) {
            if *was && !is {
                brackets[i] = Some((at - step, at));
            }
        }
        was = is;
    }
    open.retain(|&i| brackets[i].is_some());
    let (x, y): (Vec<f32>, Vec<f32>) = open
        .iter()
        .map(|&i| (points[i].x as f32, points[i].y as f32))
        .unzip();
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
        spots(&probe, &points, WINDOW, Facing::Up, 0.1, 0.4).unwrap()[0]
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
            spots(probe, &at, WINDOW, Facing::Down, 0.1, 0.4).unwrap()[0]
        };
        let found = down(&probe).unwrap();
        assert!((found.height - 3.05).abs() < 2e-5, "{found:?}");
        let off = found.slope - DVec2::new(0.2, 0.0);
        assert!(off.length() < 3e-4, "{found:?}");
        // What has no top has none upwards, and the reverse.
        let up = spots(&probe, &at, WINDOW, Facing::Up, 0.1, 0.4).unwrap();
        assert!(up[0].is_none());
        assert!(down(&Probe::new(&lean()).unwrap()).is_none());
    }

    #[test]
    fn a_steep_face_is_known_as_one_on_both_sides() {
        for slope in [0.2, 0.35, 0.45, 1.0, 3.0, -0.3, -0.45, -1.5] {
            let face = Tree::z() - 3.0 - slope as f32 * Tree::y();
            let face = face + 0.0 * Tree::x();
            for (f, facing) in
                [(face.clone(), Facing::Up), (-face, Facing::Down)]
            {
                let probe = Probe::new(&f).unwrap();
                let at = [DVec2::new(3.0, 0.01)];
                let found =
                    spots(&probe, &at, WINDOW, facing, 0.1, 0.4).unwrap()[0];
                let found = found.unwrap();
                assert!((found.height - 3.0 - 0.01 * slope).abs() < 2e-5);
                let meant = slope.clamp(-0.4, 0.4);
                let off = found.slope - DVec2::new(0.0, meant);
                assert!(off.length() < 3e-4, "{slope} {found:?}");
            }
        }
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

//! Where a function is zero near an area.
//!
//! The function is sampled on a lattice whose nodes keep their places whatever
//! the area is, so that neighbouring layers have them at equal places. Only
//! nodes near the area are looked at. Features thinner than the lattice may be
//! missed.

use super::border::Border;
use super::clip::intersection;
use super::clusters::clusters;
use super::{Area, Rect, Ring};
use glam::DVec2;
use isocontour::level::{Lattice, thin, trace};
use isoslice_base::units::Mm;

/// Greatest number of a lattice's nodes. Where there would be more, they are
/// farther apart.
const MOST_NODES: f64 = 4e6;
/// Cells along the side of a block; a block is sampled whole, or not at all.
const BLOCK: usize = 8;
/// Nodes evaluated at once: their places take little memory, and the time
/// between the calls does not matter.
const AT_ONCE: usize = 1 << 14;

/// How closely a function is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    /// Distance of the lattice's nodes, mm.
    pub step: Mm,
    /// Lines may be off by this, mm.
    pub chord: Mm,
}

/// The zero lines of a function near the part of a border that lies in a box,
/// and whether each is closed. There may be more lines elsewhere in the box.
/// `whole` closes lines along the box's sides. `eval` appends the function's
/// values at some points; lines end where a value is not a number.
///
/// # Errors
/// The first error of `eval`.
pub fn zero_lines<E>(
    border: &Border<'_>,
    bounds: Rect,
    sampling: Sampling,
    whole: bool,
    mut eval: impl FnMut(
        &mut dyn Iterator<Item = DVec2>,
        &mut Vec<f64>,
    ) -> Result<(), E>,
) -> Result<Vec<(Ring, bool)>, E> {
    let extent = bounds.size();
    let step = sampling.step.max((extent.x * extent.y / MOST_NODES).sqrt());
    // Nodes lie whole steps from the origin, so that every layer has them at
    // equal places.
    let origin = ((bounds.min / step).floor() - 1.0) * step;
    let size = (bounds.max - origin) / step;
    let lattice = Lattice {
        origin,
        step,
        size: [size.x as usize + 3, size.y as usize + 3],
        periodic: false,
    };
    let [nx, ny] = lattice.size;
    let mut values = vec![f64::NAN; lattice.count()];
    let wanted = nodes_near(&lattice, border);
    let mut some = Vec::with_capacity(AT_ONCE);
    for nodes in wanted.chunks(AT_ONCE) {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        some.clear();
        let mut places = nodes.iter().map(|&k| {
            let k = k as usize;
            lattice.node(k % nx, k / nx)
        });
        eval(&mut places, &mut some)?;
        for (&k, &value) in nodes.iter().zip(&some) {
            values[k as usize] = value;
        }
    }
    if whole {
        for (k, value) in values.iter_mut().enumerate() {
            let (i, j) = (k % nx, k / nx);
            if i == 0 || j == 0 || i + 1 == nx || j + 1 == ny {
                *value = f64::INFINITY;
            }
        }
    }
    let mut failed = None;
    let curves = trace(&lattice, &values, 4, &mut |points, out| {
        let done = eval(&mut points.iter().copied(), out);
        failed = failed.take().or(done.err());
        out.resize(points.len(), f64::NAN);
    });
    if let Some(e) = failed {
        return Err(e);
    }
    let thinned = curves.into_iter().map(|c| {
        let mut points = c.points;
        if c.closed {
            points.extend(points.first().copied());
        }
        let mut points = thin(&points, sampling.chord);
        if c.closed {
            points.pop();
        }
        (points, c.closed)
    });
    Ok(thinned.collect())
}

/// The part of an area where a function is negative; the arguments are those
/// of [`zero_lines`].
///
/// # Errors
/// The first error of `eval`.
pub fn negative<E>(
    area: &Area,
    sampling: Sampling,
    mut eval: impl FnMut(
        &mut dyn Iterator<Item = DVec2>,
        &mut Vec<f64>,
    ) -> Result<(), E>,
) -> Result<Area, E> {
    let mut rings = Vec::new();
    for cluster in clusters(area) {
        let (border, bounds) = (Border::new(&cluster.area), cluster.bounds);
        let lines = zero_lines(&border, bounds, sampling, true, &mut eval)?;
        let own = lines
            .into_iter()
            .filter(|(points, closed)| *closed && points.len() > 2);
        let own: Area = own.map(|(points, _)| points).collect();
        rings.extend(intersection(&own, &cluster.area).rings);
    }
    Ok(Area { rings })
}

/// The numbers of the nodes that matter for what is within a border: the nodes
/// of those blocks of cells that come near to it.
fn nodes_near(lattice: &Lattice, border: &Border<'_>) -> Vec<u32> {
    let [nx, ny] = lattice.size;
    let mut near = vec![false; nx * ny];
    for j in (0..ny).step_by(BLOCK) {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        for i in (0..nx).step_by(BLOCK) {
            let (right, top) =
                ((i + BLOCK).min(nx - 1), (j + BLOCK).min(ny - 1));
            // One step is added, since lines end where no value is known. Such
            // an end must not come into the area when the lines are thinned.
            let block = Rect::new(
                lattice.node(i, j) - lattice.step,
                lattice.node(right, top) + lattice.step,
            );
            if border.touches(block) {
                for row in j..=top {
                    near[row * nx + i..=row * nx + right].fill(true);
                }
            }
        }
    }
    (0..near.len() as u32)
        .filter(|&k| near[k as usize])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::rect;
    use super::*;

    #[test]
    fn what_is_negative_of_an_area_is_found_island_by_island() {
        let mut area = rect(-10.0, -1.0, 10.0, 1.0);
        area.rings.extend(rect(-9.0, 5.0, -8.0, 6.0).rings);
        let sampling = Sampling {
            step: 0.25,
            chord: 0.01,
        };
        let of = |limit: f64| {
            negative(&area, sampling, |points, out| {
                out.extend(points.map(|p| p.x - limit));
                Ok::<(), ()>(())
            })
        };
        let found = of(3.1).unwrap();
        assert!((found.content() - (13.1 * 2.0 + 1.0)).abs() < 1e-3);
        assert_eq!(found.bounds().max.x, 3.1);
        assert!(of(-20.0).unwrap().is_empty());
        assert!((of(20.0).unwrap().content() - 41.0).abs() < 1e-9);
        let failed = negative(&area, sampling, |_, _| Err("no"));
        assert_eq!(failed, Err("no"));
    }
}

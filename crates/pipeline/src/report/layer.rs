//! What is measured on one layer.
//!
//! In: a layer's outline and walls, as they will be printed. Out: how far
//! the outline is from f = 0, and the walls from where they should be.
//!
//! ```text
//!   outline ┃    measured: ├─ depth of the outer wall's centre line,
//!           ┃               ├─ distance of each wall's from the one before
//!           ┃   ┊    ┊
//!             wall 1  2
//! ```
//!
//! Both are distances in the plane. For the outer wall the edge is measured, at
//! depth d − w/2, since a small ring's bead is narrower than others and lies
//! less deep. Beads whose width varies are counted apart, together with those
//! along the middle of thin parts.

use super::ReportError;
use super::area::content;
use super::spread::Spread;
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_layer::walls::Walls;
use isoslice_model::{Probe, Spot};
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::{Area, Rect, Solid};
use isoslice_settings::layers::LayerSpan;
use std::f64::consts::PI;

/// Micrometres in a millimetre.
const MICRONS: f64 = 1e3;
/// Greatest distance of points that are measured on a line, mm.
const POINT_STEP: Mm = 0.5;
/// Two walls that are farther apart than this many spacings are not neighbours.
const NEIGHBOURS: f64 = 1.5;

/// A layer as it will be printed.
#[derive(Clone, Copy)]
pub(crate) struct LayerParts<'a> {
    /// The layer.
    pub span: LayerSpan,
    /// The layer's sample plane in the model's frame.
    pub z: Mm,
    /// The layer's outline.
    pub outline: &'a Area,
    /// Samples that were NaN, and rings that were closed by force.
    pub nan_samples: usize,
    pub forced_rings: usize,
    /// The outline that is printed.
    pub printed: &'a Solid<'a>,
    /// The layer's walls.
    pub walls: &'a Walls,
}

/// How thoroughly a layer is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Effort {
    /// About this many points of the outline and of the walls, nothing else.
    Points(usize),
    /// Every vertex and points between them, and the area.
    Full {
        /// Lines through the layer, at least 2, or 0 for no area.
        area_lines: usize,
    },
}

/// What was measured on a layer.
#[derive(Clone, Debug, Default)]
pub(crate) struct LayerFigures {
    /// Number of the layer, from 0.
    pub index: usize,
    /// Height of the layer's upper face.
    pub top: Mm,
    /// The layer's height.
    pub height: Mm,
    /// Deviation of the outline, µm: positive outside.
    pub outline: Spread,
    /// The greatest deviation and its place in the model's frame.
    pub worst: Option<(f64, DVec2)>,
    /// Points of the outline that have no border within 1 mm.
    pub lost: u64,
    /// Distance of the outer wall's edge from the outline, µm: positive inside.
    pub outer_wall: Spread,
    /// Distance of each wall from the one outside it, less the spacing, µm.
    pub spacing: Spread,
    /// Distance from the outline of the edges of beads of varying width, µm.
    pub varying: Spread,
    /// Area of the outline.
    pub area: Mm2,
    /// Area by the field itself, and its own uncertainty.
    pub area_by_field: Option<(Mm2, Mm2)>,
    /// Rings of the outline.
    pub rings: usize,
    /// Vertices of the outline.
    pub vertices: usize,
    /// Samples that were NaN.
    pub nan_samples: usize,
    /// Rings closed by force.
    pub forced_rings: usize,
    /// Area that nothing fills.
    pub unfilled: Mm2,
}

/// Measures a layer. `frame` is the part's box in the plane, `pitch` the distance
/// of samples.
///
/// # Errors
/// If the field cannot be evaluated, which is a bug.
pub(crate) fn measure(
    layer: LayerParts<'_>,
    probe: &Probe,
    frame: Rect,
    effort: Effort,
    pitch: Mm,
) -> Result<LayerFigures, ReportError> {
    let area = layer.outline;
    let mut found = LayerFigures {
        index: layer.span.index,
        top: layer.span.top,
        height: layer.span.height(),
        area: area.content(),
        rings: area.rings.len(),
        vertices: area.rings.iter().map(Vec::len).sum(),
        nan_samples: layer.nan_samples,
        forced_rings: layer.forced_rings,
        unfilled: layer.walls.gap,
        ..LayerFigures::default()
    };
    outline(area, layer.z, probe, effort, &mut found)?;
    walls(&layer, effort, &mut found);
    if let Effort::Full { area_lines } = effort
        && area_lines > 0
    {
        let by_field = content(probe, frame, layer.z, area_lines, pitch)?;
        found.area_by_field = Some(by_field);
    }
    Ok(found)
}

/// Distance in the list from one measured point to the next, for a list of
/// `count` points.
fn stride(effort: Effort, count: usize) -> usize {
    match effort {
        Effort::Points(wanted) => count.div_ceil(wanted.max(1)).max(1),
        Effort::Full { .. } => 1,
    }
}

fn outline(
    area: &Area,
    z: Mm,
    probe: &Probe,
    effort: Effort,
    found: &mut LayerFigures,
) -> Result<(), ReportError> {
    // Each edge has about one point besides its end.
    let stride = stride(effort, 2 * found.vertices);
    let mut spots: Vec<Spot> = Vec::new();
    let mut count = 0;
    let mut taken = || {
        count += 1;
        (count - 1) % stride == 0
    };
    for ring in &area.rings {
        let n = ring.len();
        // The solid lies to the left.
        let out = |i: usize| {
            let edge = ring[(i + 1) % n] - ring[i % n];
            -edge.perp().normalize_or_zero()
        };
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % n];
            if taken() {
                let out = (out(i + n - 1) + out(i)).normalize_or(DVec2::X);
                spots.push(Spot { at: a, out });
            }
            let steps = (a.distance(b) / POINT_STEP).ceil().clamp(1.0, 1e4);
            for k in 0..steps as usize {
                if taken() {
                    let at = a.lerp(b, (k as f64 + 0.5) / steps);
                    spots.push(Spot { at, out: out(i) });
                }
            }
        }
    }
    for (spot, d) in spots.iter().zip(nearest(&spots, z, probe)?) {
        let Some(d) = d else {
            found.lost += 1;
            continue;
        };
        let d = d * MICRONS;
        found.outline.add(d);
        if found.worst.is_none_or(|w| d.abs() > w.0.abs()) {
            found.worst = Some((d, spot.at));
        }
    }
    Ok(())
}

/// How far the spots lie outside the part, measured along their directions.
/// Where a spot is far from the border, other directions are measured as well,
/// since the border may turn there.
fn nearest(
    spots: &[Spot],
    z: Mm,
    probe: &Probe,
) -> Result<Vec<Option<Mm>>, ReportError> {
    /// Distance from which on other directions are measured, mm.
    const FAR: Mm = 0.006;
    /// Number of other directions.
    const LINES: usize = 11;
    let mut distances = probe.distances(spots, z)?;
    let far: Vec<usize> = (0..spots.len())
        .filter(|&i| distances[i].is_none_or(|d| d.abs() > FAR))
        .collect();
    let turned: Vec<Spot> = far
        .iter()
        .flat_map(|&i| {
            let Spot { at, out } = spots[i];
            (1..=LINES).map(move |k| {
                let angle = PI * k as f64 / (LINES + 1) as f64;
                let out = DVec2::from_angle(angle).rotate(out);
                Spot { at, out }
            })
        })
        .collect();
    let others = probe.distances(&turned, z)?;
    for (&i, others) in far.iter().zip(others.chunks(LINES)) {
        let all = others.iter().flatten().copied().chain(distances[i]);
        distances[i] = all.min_by(|a, b| a.abs().total_cmp(&b.abs()));
    }
    Ok(distances)
}

/// True if a line turns back at a segment that is shorter than the line is wide there,
/// as in a tip. Its sides are the surface's, its end is not.
fn turns_back(line: &Stroke, i: usize) -> bool {
    /// Cosine of the turn from the segment before to the one after.
    const BACK: f64 = -0.5;
    let n = line.points.len();
    if !line.closed && (i == 0 || i + 2 >= n) {
        return false;
    }
    let at = |k: usize| line.points[k % n];
    let [before, here, after] = [i + n - 1, i, i + 1];
    let way = |k: usize| (at(k + 1) - at(k)).normalize_or_zero();
    at(here).distance(at(after)) < line.width_at(here)
        && way(before).dot(way(after)) < BACK
}

/// Points along a line, with the bead's width there.
fn along(line: &Stroke) -> impl Iterator<Item = (DVec2, Mm)> + '_ {
    let segments = line.segments().enumerate();
    let sides = segments.filter(|(i, _)| !turns_back(line, *i));
    sides.flat_map(move |(i, (a, b))| {
        let (from, to) = (line.width_at(i), line.width_at(i + 1));
        let steps = (a.distance(b) / POINT_STEP).ceil().clamp(1.0, 1e4);
        (0..2 * steps as usize).map(move |k| {
            let t = k as f64 / (2.0 * steps);
            (a.lerp(b, t), from + t * (to - from))
        })
    })
}

fn walls(layer: &LayerParts<'_>, effort: Effort, found: &mut LayerFigures) {
    let Walls {
        lines,
        thin,
        depths,
        ..
    } = layer.walls;
    let edges = layer.printed.grid();
    let constant = |l: &&Stroke| l.widths.is_empty();
    let depth =
        |p: DVec2| edges.nearest(p).map_or(f64::NAN, |(_, q)| p.distance(q));
    let Some(outer) = lines.first() else {
        return;
    };
    // A bead along the middle of a thin part touches the outline.
    let thin = thin.first().into_iter().flatten();
    let touching: Vec<&Stroke> = outer.iter().chain(thin).collect();
    let points = touching.iter().map(|l| 2 * l.points.len()).sum();
    // The points are taken evenly from both kinds, since a summary mixes them.
    let every = stride(effort, points);
    let spots = touching.iter().flat_map(|l| {
        let even = l.widths.is_empty();
        along(l).map(move |(p, w)| (even, p, w))
    });
    for (even, p, w) in spots.step_by(every) {
        let off = (depth(p) - 0.5 * w) * MICRONS;
        if even {
            found.outer_wall.add(off)
        } else {
            found.varying.add(off)
        }
    }
    // Walls that leave the outline for a top's border have no set distance from
    // the walls before them.
    if matches!(effort, Effort::Points(_)) || layer.walls.divided {
        return;
    }
    for k in 1..lines.len().min(depths.len()) {
        let apart = depths[k] - depths[k - 1];
        let before = &lines[k - 1];
        let edges = before
            .iter()
            .enumerate()
            .flat_map(|(i, l)| l.segments().map(move |edge| (i, edge)));
        let grid = EdgeGrid::of(edges, NEIGHBOURS * apart);
        for (p, _) in lines[k].iter().filter(constant).flat_map(along) {
            let near = grid.nearest_within(p, NEIGHBOURS * apart);
            if let Some((_, q)) = near.filter(|(i, _)| constant(&&before[*i])) {
                found.spacing.add((p.distance(q) - apart) * MICRONS);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Tree;
    use isoslice_layer::walls::{self, WallPlan};
    use isoslice_planar::shapes::{circle, moved};
    use isoslice_settings::testing::settings;

    fn disc() -> Probe {
        let (x, y) = (Tree::x(), Tree::y());
        let f = (x.clone() * x + y.clone() * y).sqrt() - 5.0;
        Probe::new(&f).unwrap()
    }

    /// A ring of 720 points, whose chords are within 0.05 µm of the circle.
    fn ring(centre: DVec2, radius: Mm) -> Area {
        Area::from(moved(circle(radius, 720), centre.x, centre.y))
    }

    fn figures(outline: &Area, walls: &Walls, effort: Effort) -> LayerFigures {
        let span = LayerSpan {
            index: 7,
            bottom: 1.4,
            top: 1.6,
        };
        let parts = LayerParts {
            span,
            z: 0.0,
            outline,
            nan_samples: 0,
            forced_rings: 0,
            printed: &Solid::of(outline, 1.0),
            walls,
        };
        let frame = Rect::new(DVec2::splat(-6.0), DVec2::splat(6.0));
        measure(parts, &disc(), frame, effort, 0.1).unwrap()
    }

    const FULL: Effort = Effort::Full { area_lines: 200 };

    #[test]
    fn a_true_outline_has_no_errors() {
        let area = ring(DVec2::ZERO, 5.0);
        let walls =
            walls::walls(&area, None, 0.2, &WallPlan::of(&settings(&[])));
        let found = figures(&area, &walls, FULL);
        // Chords of half a degree are 48 nm inside at their middle.
        let d = found.outline.figures().unwrap();
        assert_eq!((d.points, found.lost), (1440, 0));
        assert!(d.max.abs() < 0.02 && (d.min + 0.048).abs() < 0.02, "{d:?}");
        for walls in [&found.outer_wall, &found.spacing] {
            // Each wall's share of the accuracy is 1.5 µm.
            let e = walls.figures().unwrap();
            assert!(e.points > 100 && walls.worst() < 3.1, "{e:?}");
        }
        let (area, error) = found.area_by_field.unwrap();
        let truth = std::f64::consts::PI * 25.0;
        assert!((area - truth).abs() < error.max(1e-3 * truth), "{area}");
        assert!(error < 2e-3 * truth, "{error}");
    }

    #[test]
    fn a_shifted_outline_shows_in_full_and_in_samples() {
        let area = ring(DVec2::new(0.02, 0.0), 5.0);
        let none = Walls::default();
        for effort in [FULL, Effort::Points(200)] {
            let found = figures(&area, &none, effort);
            let d = found.outline.figures().unwrap();
            // The ring is 20 µm too far out on one side, and 20 µm too far in
            // on the other.
            assert!((d.max - 20.0).abs() < 0.2, "{effort:?} {d:?}");
            assert!((d.min + 20.0).abs() < 0.2, "{effort:?} {d:?}");
            assert!(d.mean.abs() < 0.2 && d.p99 > 19.0, "{effort:?} {d:?}");
            let (size, at) = found.worst.unwrap();
            assert!((size.abs() - 20.0).abs() < 0.2 && at.y.abs() < 1.0);
        }
    }

    #[test]
    fn an_outline_too_large_and_one_out_of_reach_show() {
        let none = Walls::default();
        let found = figures(&ring(DVec2::ZERO, 5.03), &none, FULL);
        let d = found.outline.figures().unwrap();
        assert!((d.mean - 30.0).abs() < 0.1, "{d:?}");
        let (by_field, error) = found.area_by_field.unwrap();
        // The outline is larger by 1.2 % than the field says.
        assert!(found.area - by_field > 0.8 + error, "{by_field} {error}");
        let far = figures(&ring(DVec2::ZERO, 9.0), &none, FULL);
        assert_eq!((far.lost, far.outline.figures()), (1440, None));
    }

    #[test]
    fn misplaced_walls_show() {
        let area = ring(DVec2::ZERO, 5.0);
        let good =
            walls::walls(&area, None, 0.2, &WallPlan::of(&settings(&[])));
        let mut walls = good.clone();
        for p in &mut walls.lines[0][0].points {
            // The outer wall is 30 µm too far in, and so nearer to the next
            // one.
            *p *= 1.0 - 0.03 / p.length();
        }
        let found = figures(&area, &walls, FULL);
        let outer = found.outer_wall.figures().unwrap();
        let next = found.spacing.figures().unwrap();
        assert!((outer.mean - 30.0).abs() < 1.0, "{outer:?}");
        assert!((next.mean + 30.0).abs() < 1.5, "{next:?}");
        assert_eq!(found.varying.figures(), None);
        // One line becomes a line of varying width, 40 µm too wide.
        let mut walls = good;
        let line = &mut walls.lines[0][0];
        line.widths = vec![line.width + 0.04; line.points.len()];
        let found = figures(&area, &walls, FULL);
        let varying = found.varying.figures().unwrap();
        assert!((varying.mean + 20.0).abs() < 1.0, "{varying:?}");
        assert_eq!(found.outer_wall.figures(), None);
    }

    #[test]
    fn a_narrower_bead_is_measured_at_its_own_edge() {
        let area = ring(DVec2::ZERO, 5.0);
        let mut walls =
            walls::walls(&area, None, 0.2, &WallPlan::of(&settings(&[])));
        let line = &mut walls.lines[0][0];
        // A post's ring is like this: thinner, and farther out by half of that.
        line.width -= 0.1;
        for p in &mut line.points {
            *p *= 1.0 + 0.05 / p.length();
        }
        for effort in [FULL, Effort::Points(200)] {
            let found = figures(&area, &walls, effort);
            assert!(found.outer_wall.worst() < 2.0, "{effort:?}");
        }
    }
}

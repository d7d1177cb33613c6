//! Draws a layer as an SVG picture, with y up: beads have their widths and the
//! colours of their roles, travels are thin lines, which are dashed if the
//! filament is retracted. Where the nozzle is not at the layer's top, a line
//! along the bead's middle is the whiter the higher it is, and the blacker the
//! lower.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_path::travel::{LayerPath, Move};
use isoslice_planar::Rect;
use isoslice_planar::bead::{Bead, Role};
use std::fmt::{Arguments, Write};

/// Margin around the part, mm, with room for the skirt.
const MARGIN: f64 = 2.0;

/// Number of shades of the lines that show heights, on both sides of the layer's
/// top.
const SHADES: f64 = 8.0;

/// Colour of a role, as in PrusaSlicer's viewer.
fn colour(role: Role) -> &'static str {
    match role {
        Role::OuterWall => "#ff7d38",
        Role::InnerWall => "#ffd94d",
        Role::Overhang => "#1f1fff",
        Role::GapFill => "#2fb6a8",
        Role::SparseInfill => "#b1302a",
        Role::InternalSkin => "#9654cc",
        Role::TopSkin => "#f04040",
        Role::BottomSkin => "#4d80ba",
        Role::Bridge => "#4da6ff",
        Role::InternalBridge => "#4d66ff",
        Role::Ironing => "#ff8c69",
        Role::Support => "#00c000",
        Role::SupportInterface => "#008000",
        Role::Skirt | Role::Brim => "#00876e",
    }
}

/// The layer as a picture, in print coordinates. `frame` is the part's box,
/// which all layers share, so that pictures can be compared.
pub(crate) fn layer_svg(path: &LayerPath, frame: Rect) -> String {
    let frame = path
        .moves
        .iter()
        .flat_map(|m| match m {
            Move::Print(b) => b.stroke.points.as_slice(),
            Move::Travel(_) => &[],
        })
        .fold(frame, |r, &p| r.with(p));
    let (lo, hi) = (frame.min - MARGIN, frame.max + MARGIN);
    let size = hi - lo;
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" \
         viewBox=\"0 0 {:.3} {:.3}\" width=\"{:.0}\" height=\"{:.0}\">\n\
         <title>layer {} at z = {:.3} mm</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <g fill=\"none\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\">",
        size.x,
        size.y,
        10.0 * size.x,
        10.0 * size.y,
        path.span.index + 1,
        path.span.top,
    );
    let line = |svg: &mut String,
                style: Arguments<'_>,
                points: &mut dyn Iterator<Item = DVec2>| {
        let _ = write!(svg, "<polyline {style} points=\"");
        for p in points {
            let _ = write!(svg, "{:.3},{:.3} ", p.x - lo.x, hi.y - p.y);
        }
        svg.push_str("\"/>\n");
    };
    let mut travels = String::new();
    let mut at: Option<DVec2> = None;
    for m in &path.moves {
        match m {
            Move::Print(bead) => {
                let style = format_args!(
                    "stroke=\"{}\" stroke-width=\"{:.3}\" \
                     stroke-opacity=\"0.8\"",
                    colour(bead.role),
                    bead.stroke.width
                );
                line(&mut svg, style, &mut bead.stroke.path());
                for (shade, run) in rises(bead, path.span.height()) {
                    let style = format_args!(
                        "stroke=\"{}\" stroke-width=\"0.15\" \
                         stroke-opacity=\"{:.3}\"",
                        if shade > 0.0 { "#fff" } else { "#000" },
                        shade.abs()
                    );
                    line(&mut svg, style, &mut run.into_iter());
                }
                at = bead.stroke.path().last();
            }
            Move::Travel(travel) => {
                let dash = if travel.retract {
                    " stroke-dasharray=\"0.4 0.3\""
                } else {
                    ""
                };
                let style =
                    format_args!("stroke=\"#16e\" stroke-width=\"0.06\"{dash}");
                let way = travel.wipe.iter().chain(&travel.points).copied();
                line(&mut travels, style, &mut at.into_iter().chain(way));
                at = travel.points.last().copied();
            }
        }
    }
    svg.push_str(&travels);
    svg.push_str("</g>\n</svg>\n");
    svg
}

/// The parts of a bead along which the nozzle is above or below the layer's top.
/// With each comes how far, from −1 to 1, which is half of the layer's height
/// and more.
fn rises(bead: &Bead, height: Mm) -> Vec<(f64, Vec<DVec2>)> {
    if bead.stroke.levels.is_empty() {
        return Vec::new();
    }
    let path: Vec<DVec2> = bead.stroke.path().collect();
    let shade = |i: usize| {
        let rise =
            0.5 * (bead.stroke.level(i).rise + bead.stroke.level(i + 1).rise);
        (SHADES * rise / (0.5 * height)).round() / SHADES
    };
    let shades: Vec<f64> = (1..path.len())
        .map(|i| shade(i - 1).clamp(-1.0, 1.0))
        .collect();
    let mut from = 0;
    let runs = shades.chunk_by(|a, b| a == b).map(|run| {
        let begin = from;
        from += run.len();
        (run[0], path[begin..=from].to_vec())
    });
    runs.filter(|run| run.0 != 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_path::travel::Travel;
    use isoslice_planar::bead::{Level, Stroke};
    use isoslice_settings::layers::LayerSpan;

    #[test]
    fn what_leaves_the_layers_top_has_a_line_of_its_own() {
        let points = (0..5).map(|i| DVec2::new(f64::from(i), 0.0)).collect();
        let stroke = Stroke::new(points, false, 0.45);
        let mut bead = Bead::new(Role::TopSkin, stroke, 0.2);
        assert_eq!(rises(&bead, 0.2), []);
        let rises_of = [0.0, 0.0, 0.1, 0.1, -0.2];
        bead.stroke.levels =
            rises_of.map(|rise| Level { rise, extra: 0.0 }).to_vec();
        let found = rises(&bead, 0.2);
        let at = |x: f64| DVec2::new(x, 0.0);
        assert_eq!(
            found,
            [
                (0.5, vec![at(1.0), at(2.0)]),
                (1.0, vec![at(2.0), at(3.0)]),
                (-0.5, vec![at(3.0), at(4.0)]),
            ]
        );
    }

    #[test]
    fn beads_and_travels_are_drawn_upright() {
        let bead = Bead::new(
            Role::OuterWall,
            Stroke::new(
                vec![DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::splat(10.0)],
                true,
                0.45,
            ),
            0.2,
        );
        let travel = Move::Travel(Travel::straight(DVec2::new(5.0, 5.0), true));
        let path = LayerPath {
            span: LayerSpan {
                index: 3,
                bottom: 0.6,
                top: 0.8,
            },
            moves: vec![Move::Print(bead), travel],
        };
        let frame = Rect::new(DVec2::ZERO, DVec2::splat(10.0));
        let svg = layer_svg(&path, frame);
        assert!(svg.contains("viewBox=\"0 0 14.000 14.000\""));
        assert!(svg.contains(
            "points=\"2.000,12.000 12.000,12.000 12.000,2.000 2.000,12.000 \""
        ));
        assert!(svg.contains("stroke-dasharray"));
    }
}

//! Basic shapes as paths.

use super::path::Path;
use super::view::{Share, attribute};
use crate::outline::{Fill, Outline};
use glam::{DAffine2, DVec2};
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::{Length, NumberListParser, PointsParser};

/// The path of an element that is a shape, and what of it cannot be read. None if it
/// is no shape.
pub(super) fn path(
    node: Node,
    port: DVec2,
) -> Option<(Path, Option<&'static str>)> {
    let mut broken = lengths(node.tag_name().name())
        .iter()
        .filter_map(|name| node.attribute(*name))
        .any(|text| Length::from_str(text.trim()).is_err())
        .then_some("a length that cannot be read");
    let get = |name: &str, share: Share| attribute(node, name, share, port);
    let number = |name: &str, share: Share| get(name, share).unwrap_or(0.0);
    let pair = |x: &str, y: &str| {
        DVec2::new(number(x, Share::Width), number(y, Share::Height))
    };
    let mut made = Path::default();
    match node.tag_name().name() {
        "path" => {
            let text = node.attribute("d").unwrap_or("");
            let (path, is_cut) = Path::parse(text);
            let what = "the rest of a path after a mistake in it";
            return Some((path, is_cut.then_some(what)));
        }
        "rect" => {
            let radii = [get("rx", Share::Width), get("ry", Share::Height)];
            let radii = match radii {
                [Some(x), Some(y)] => DVec2::new(x, y),
                [Some(one), None] | [None, Some(one)] => DVec2::splat(one),
                [None, None] => DVec2::ZERO,
            };
            let size = pair("width", "height");
            if size.min_element() > 0.0 {
                made.ring(&rectangle(pair("x", "y"), size, radii));
            }
        }
        "circle" => {
            let radius = number("r", Share::Diagonal);
            ellipse(&mut made, pair("cx", "cy"), DVec2::splat(radius));
        }
        "ellipse" => ellipse(&mut made, pair("cx", "cy"), pair("rx", "ry")),
        "line" => {
            made.move_to(pair("x1", "y1"));
            made.line_to(pair("x2", "y2"));
        }
        name @ ("polyline" | "polygon") => {
            let points = node.attribute("points").unwrap_or("");
            for (i, (x, y)) in PointsParser::from(points).enumerate() {
                if i == 0 {
                    made.move_to(DVec2::new(x, y));
                } else {
                    made.line_to(DVec2::new(x, y));
                }
            }
            if name == "polygon" {
                made.close();
            }
            let mut numbers = NumberListParser::from(points);
            let all = numbers.by_ref().take_while(Result::is_ok).count();
            let rest = points.split([' ', ',', '\n', '\t', '\r']);
            let words = rest.filter(|word| !word.is_empty()).count();
            if all % 2 == 1 || all < words {
                broken =
                    Some("the rest of a shape after a mistake in its points");
            }
        }
        _ => return None,
    }
    Some((made, broken))
}

/// The attributes of a shape that are lengths.
fn lengths(shape: &str) -> &'static [&'static str] {
    match shape {
        "rect" => &["x", "y", "width", "height"],
        "circle" => &["cx", "cy", "r"],
        "ellipse" => &["cx", "cy"],
        "line" => &["x1", "y1", "x2", "y2"],
        _ => &[],
    }
}

fn ellipse(path: &mut Path, centre: DVec2, radii: DVec2) {
    if radii.min_element() > 0.0 {
        let mut outline = Outline::new(Fill::NonZero);
        outline.ellipse(centre, radii);
        path.ring(&outline);
    }
}

/// A rectangle whose corners may be round.
fn rectangle(min: DVec2, size: DVec2, radii: DVec2) -> Outline {
    let mut outline = Outline::new(Fill::NonZero);
    let radii = radii.max(DVec2::ZERO).min(0.5 * size);
    if radii.min_element() <= 0.0 {
        outline.rectangle(min, min + size);
        return outline;
    }
    let max = min + size;
    let quarter = std::f64::consts::FRAC_PI_2;
    outline.move_to(DVec2::new(min.x + radii.x, min.y));
    for (i, corner) in [
        DVec2::new(max.x - radii.x, min.y + radii.y),
        DVec2::new(max.x - radii.x, max.y - radii.y),
        DVec2::new(min.x + radii.x, max.y - radii.y),
        DVec2::new(min.x + radii.x, min.y + radii.y),
    ]
    .into_iter()
    .enumerate()
    {
        let circle =
            DAffine2::from_cols(DVec2::X * radii.x, DVec2::Y * radii.y, corner);
        let from = quarter * (i as f64 - 1.0);
        let on = DVec2::new(libm::cos(from), libm::sin(from));
        outline.line_to(circle.transform_point2(on));
        outline.arc(circle, from, quarter);
    }
    outline.close();
    outline
}

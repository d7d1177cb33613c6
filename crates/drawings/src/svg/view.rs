//! Lengths, transforms, and how a `viewBox` lies in its place.

use glam::{DAffine2, DMat2, DVec2};
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::{
    Align, AspectRatio, Length, LengthUnit, TransformListParser,
    TransformListToken, ViewBox,
};

/// Of what a percentage is a share.
#[derive(Clone, Copy)]
pub(super) enum Share {
    Width,
    Height,
    Diagonal,
}

/// A length in user units. A pixel is one, and 96 of them are an inch.
pub(super) fn length(of: Length, share: Share, port: DVec2) -> f64 {
    let unit = match of.unit {
        LengthUnit::None | LengthUnit::Px => 1.0,
        // Fonts are of 16 pixels, unless somebody says otherwise.
        LengthUnit::Em => 16.0,
        LengthUnit::Ex => 8.0,
        LengthUnit::In => 96.0,
        LengthUnit::Cm => 96.0 / 2.54,
        LengthUnit::Mm => 96.0 / 25.4,
        LengthUnit::Pt => 96.0 / 72.0,
        LengthUnit::Pc => 16.0,
        LengthUnit::Percent => {
            let whole = match share {
                Share::Width => port.x,
                Share::Height => port.y,
                Share::Diagonal => (0.5 * port.length_squared()).sqrt(),
            };
            0.01 * whole
        }
    };
    of.number * unit
}

/// An attribute that is a length.
pub(super) fn attribute(
    node: Node,
    name: &str,
    share: Share,
    port: DVec2,
) -> Option<f64> {
    let value = Length::from_str(node.attribute(name)?.trim()).ok()?;
    Some(length(value, share, port))
}

/// What `transform` says; nothing if it is wrong.
pub(super) fn transform(node: Node) -> Option<DAffine2> {
    let mut all = DAffine2::IDENTITY;
    let Some(text) = node.attribute("transform") else {
        return Some(all);
    };
    for token in TransformListParser::from(text) {
        let next = match token.ok()? {
            TransformListToken::Matrix { a, b, c, d, e, f } => {
                DAffine2::from_cols_array(&[a, b, c, d, e, f])
            }
            TransformListToken::Translate { tx, ty } => {
                DAffine2::from_translation(DVec2::new(tx, ty))
            }
            TransformListToken::Scale { sx, sy } => {
                DAffine2::from_scale(DVec2::new(sx, sy))
            }
            TransformListToken::Rotate { angle } => {
                let angle = angle.to_radians();
                let x = DVec2::new(libm::cos(angle), libm::sin(angle));
                DAffine2::from_mat2(DMat2::from_cols(x, x.perp()))
            }
            TransformListToken::SkewX { angle } => {
                let slope = libm::tan(angle.to_radians());
                DAffine2::from_cols_array(&[1.0, 0.0, slope, 1.0, 0.0, 0.0])
            }
            TransformListToken::SkewY { angle } => {
                let slope = libm::tan(angle.to_radians());
                DAffine2::from_cols_array(&[1.0, slope, 0.0, 1.0, 0.0, 0.0])
            }
        };
        all *= next;
    }
    Some(all)
}

/// The `viewBox` of an element: its corner and its size.
pub(super) fn view_box(node: Node) -> Option<[DVec2; 2]> {
    let text = node.attribute("viewBox")?;
    let ViewBox { x, y, w, h } = ViewBox::from_str(text).ok()?;
    let sizes = w > 0.0 && h > 0.0;
    sizes.then(|| [DVec2::new(x, y), DVec2::new(w, h)])
}

/// How a `viewBox` lies in a place from the origin of some size.
pub(super) fn fit(
    node: Node,
    [corner, size]: [DVec2; 2],
    place: DVec2,
) -> DAffine2 {
    let ratio = node
        .attribute("preserveAspectRatio")
        .and_then(|text| AspectRatio::from_str(text).ok());
    let (align, slice) =
        ratio.map_or((Align::XMidYMid, false), |r| (r.align, r.slice));
    let mut scale = place / size;
    if align != Align::None {
        let one = if slice {
            scale.max_element()
        } else {
            scale.min_element()
        };
        scale = DVec2::splat(one);
    }
    let share = match align {
        Align::None | Align::XMinYMin => DVec2::ZERO,
        Align::XMidYMin => DVec2::new(0.5, 0.0),
        Align::XMaxYMin => DVec2::new(1.0, 0.0),
        Align::XMinYMid => DVec2::new(0.0, 0.5),
        Align::XMidYMid => DVec2::splat(0.5),
        Align::XMaxYMid => DVec2::new(1.0, 0.5),
        Align::XMinYMax => DVec2::new(0.0, 1.0),
        Align::XMidYMax => DVec2::new(0.5, 1.0),
        Align::XMaxYMax => DVec2::ONE,
    };
    let spare = (place - size * scale) * share;
    DAffine2::from_translation(spare)
        * DAffine2::from_scale(scale)
        * DAffine2::from_translation(-corner)
}

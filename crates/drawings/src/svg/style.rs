//! Styles of elements: attributes, `style`, and style sheets.

use super::Sheet;
use crate::outline::Fill;
use crate::stroke::{Cap, Join};
use roxmltree::Node;
use simplecss::{AttributeOperator, DeclarationTokenizer, PseudoClass};
use std::str::FromStr;
use svgtypes::{Color, FuncIRI, Length, Paint as SvgPaint};

/// What a shape is painted with. Colours do not matter but for white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Paint {
    None,
    White,
    Colour,
}

/// What elements hand on to those in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Style {
    pub(super) fill: Paint,
    pub(super) rule: Fill,
    /// The rule where it is a part of a clip path.
    pub(super) clip_rule: Fill,
    pub(super) stroke: Paint,
    pub(super) width: Length,
    pub(super) cap: Cap,
    pub(super) join: Join,
    pub(super) miter: f64,
    pub(super) dashed: bool,
    pub(super) marked: bool,
    pub(super) visible: bool,
    /// What `currentColor` is.
    colour: Paint,
    clear: [bool; 2],
}

impl Default for Style {
    fn default() -> Self {
        Style {
            fill: Paint::Colour,
            rule: Fill::NonZero,
            clip_rule: Fill::NonZero,
            stroke: Paint::None,
            width: Length::new_number(1.0),
            cap: Cap::Butt,
            join: Join::Miter,
            miter: 4.0,
            dashed: false,
            marked: false,
            visible: true,
            colour: Paint::Colour,
            clear: [false; 2],
        }
    }
}

/// What an element has for itself.
#[derive(Clone, Debug, Default)]
pub(super) struct Own {
    /// It and all in it is not drawn.
    pub(super) hidden: bool,
    /// The name of its clip path.
    pub(super) clip: Option<String>,
    /// It is masked or filtered.
    pub(super) cut: Option<&'static str>,
    /// A property that is not read, and changes what is drawn.
    pub(super) unread: Option<String>,
    /// Its transforms are about a place of their own.
    origin: bool,
    /// Its lines are as wide as they say, whatever the scale.
    keeps_width: bool,
    /// What is beyond its port is drawn.
    pub(super) overflows: bool,
}

/// Properties that move or shape an element and are not read in styles.
const GEOMETRY: [&str; 14] = [
    "transform",
    "translate",
    "x",
    "y",
    "width",
    "height",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "d",
    "rotate",
    "scale",
];

impl Own {
    /// Notes what a declaration of a style says that is not read.
    fn see(&mut self, node: Node, name: &str, value: &str) {
        let is_port = matches!(node.tag_name().name(), "svg" | "symbol");
        let counts = !matches!(value, "none" | "auto" | "initial");
        if GEOMETRY.contains(&name) && !is_port && counts {
            self.unread = Some(format!(
                "`{name}` of a style, so a shape may have another size or place"
            ));
        }
    }
}

impl Style {
    /// The style of an element in one of this style.
    pub(super) fn of(&self, node: Node, sheet: &Sheet) -> (Style, Own) {
        let mut style = *self;
        let mut own = Own::default();
        for attribute in node.attributes() {
            style.set(attribute.name(), attribute.value(), self, &mut own);
        }
        for rule in &sheet.rules.rules {
            if rule.selector.matches(&Element(node)) {
                for d in &rule.declarations {
                    own.see(node, d.name, d.value);
                    style.set(d.name, d.value, self, &mut own);
                }
            }
        }
        if let Some(text) = node.attribute("style") {
            for d in DeclarationTokenizer::from(text) {
                own.see(node, d.name, d.value);
                style.set(d.name, d.value, self, &mut own);
            }
        }
        if own.origin && node.has_attribute("transform") {
            own.unread = Some(
                "`transform-origin`, so a shape may be elsewhere".to_owned(),
            );
        }
        if own.keeps_width && style.stroke != Paint::None {
            own.unread = Some(
                "`vector-effect`, so a line may be of another width".to_owned(),
            );
        }
        (style, own)
    }

    /// The paint of the fill and of the line, where they can be seen.
    pub(super) fn paints(&self) -> [Paint; 2] {
        let seen = |paint: Paint, clear: bool| {
            if clear || !self.visible {
                Paint::None
            } else {
                paint
            }
        };
        let [fill, stroke] = self.clear;
        [seen(self.fill, fill), seen(self.stroke, stroke)]
    }

    fn set(&mut self, name: &str, value: &str, parent: &Style, own: &mut Own) {
        let value = value.trim();
        let inherit = value == "inherit";
        match name {
            "fill" => {
                self.fill = self.paint(value, self.fill, parent.fill);
            }
            "stroke" => {
                self.stroke = self.paint(value, self.stroke, parent.stroke);
            }
            "color" if !inherit => {
                self.colour = self.paint(value, self.colour, parent.colour);
            }
            "fill-rule" => self.rule = rule(value, parent.rule),
            "clip-rule" => self.clip_rule = rule(value, parent.clip_rule),
            "stroke-width" => {
                self.width = Length::from_str(value).unwrap_or(parent.width);
            }
            "stroke-linecap" => match value {
                "round" => self.cap = Cap::Round,
                "square" => self.cap = Cap::Square,
                "butt" => self.cap = Cap::Butt,
                _ => self.cap = parent.cap,
            },
            "stroke-linejoin" => match value {
                "round" => self.join = Join::Round,
                "bevel" => self.join = Join::Bevel,
                "miter" | "miter-clip" | "arcs" => self.join = Join::Miter,
                _ => self.join = parent.join,
            },
            "stroke-miterlimit" => {
                let limit = value.parse().unwrap_or(parent.miter);
                self.miter = limit.max(1.0);
            }
            "stroke-dasharray" if !inherit => self.dashed = value != "none",
            "marker" | "marker-start" | "marker-mid" | "marker-end"
                if !inherit =>
            {
                self.marked = value != "none";
            }
            "visibility" if !inherit => self.visible = value == "visible",
            "display" if value == "none" => own.hidden = true,
            "display" => own.hidden = false,
            "opacity" if is_zero(value) => own.hidden = true,
            "fill-opacity" if !inherit => self.clear[0] = is_zero(value),
            "stroke-opacity" if !inherit => self.clear[1] = is_zero(value),
            "clip-path" => {
                let link = FuncIRI::from_str(value);
                own.clip = link.ok().map(|link| link.0.to_owned());
                if own.clip.is_none() && !matches!(value, "none" | "inherit") {
                    own.cut = Some("clip path of a basic shape");
                }
            }
            "transform-origin" => {
                let starts = |word: &str| {
                    matches!(word, "left" | "top") || is_zero_length(word)
                };
                own.origin = !value.split_whitespace().all(starts);
            }
            "overflow" => own.overflows = matches!(value, "visible" | "auto"),
            "vector-effect" if value == "non-scaling-stroke" => {
                own.keeps_width = true;
            }
            "mask" if value != "none" => own.cut = Some("mask"),
            "filter" if value != "none" => own.cut = Some("filter"),
            _ => {}
        }
    }

    fn paint(&self, text: &str, old: Paint, parent: Paint) -> Paint {
        match SvgPaint::from_str(text) {
            Ok(SvgPaint::None) => Paint::None,
            Ok(SvgPaint::Inherit) => parent,
            Ok(SvgPaint::CurrentColor) => self.colour,
            Ok(SvgPaint::Color(Color { alpha: 0, .. })) => Paint::None,
            Ok(SvgPaint::Color(c)) => match [c.red, c.green, c.blue] {
                [255, 255, 255] => Paint::White,
                _ => Paint::Colour,
            },
            Ok(_) => Paint::Colour,
            Err(_) => old,
        }
    }
}

fn rule(value: &str, parent: Fill) -> Fill {
    match value {
        "evenodd" => Fill::EvenOdd,
        "nonzero" => Fill::NonZero,
        _ => parent,
    }
}

/// True for a length or a share of nothing.
fn is_zero_length(word: &str) -> bool {
    Length::from_str(word).is_ok_and(|length| length.number == 0.0)
}

fn is_zero(value: &str) -> bool {
    let number = value.trim_end_matches('%');
    number.parse::<f64>().is_ok_and(|v| v <= 0.0)
}

/// An element as style sheets see it.
struct Element<'a, 'b>(Node<'a, 'b>);

impl simplecss::Element for Element<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Element)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Element)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(
        &self,
        name: &str,
        operator: AttributeOperator<'_>,
    ) -> bool {
        self.0.attribute(name).is_some_and(|v| operator.matches(v))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild)
            && self.0.prev_sibling_element().is_none()
    }
}

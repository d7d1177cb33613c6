//! SVG files as drawings.
//!
//! `usvg`, which reads SVG for others, keeps coordinates in 32 bits and makes
//! arcs of curves that are up to 0.03 % of the radius off, and it takes three
//! times as long to compile as what is here. So the elements are gone through
//! here, with the readers of XML, CSS and path data that `usvg` stands on.

mod path;
mod shapes;
mod style;
#[cfg(test)]
mod tests;
mod view;
mod walk;

use crate::drawing::{Drawing, FILL, small_enough};
use crate::left_out::not_drawn;
use crate::place::{Anchor, place_all};
use glam::{DAffine2, DVec2};
use isoslice_base::problem::{NamedProblem, Problem, go_on};
use roxmltree::{Document, Node, NodeId, ParsingOptions};
use simplecss::StyleSheet;
use std::collections::BTreeMap;
use style::Style;
use view::{Share, attribute, fit, view_box};
use walk::{Place, Walk};

/// The most elements, texts and comments of a file.
const MOST_NODES: u32 = 1_000_000;

/// The most rules of its style sheets.
const MOST_RULES: usize = 1000;

/// The most bytes of its style sheets. Wherever a rule is not as it should be,
/// all of the sheet before it is read again, for the line's number.
const MOST_SHEET_BYTES: usize = 4 << 20;

/// The most parts of a rule's selector, such as the two of `g path`. Whether an
/// element matches takes a time that grows with the depth of the drawing for
/// each part.
const MOST_SELECTOR_PARTS: usize = 8;

/// Millimetres of a pixel: 96 pixels are an inch.
const PIXEL: f64 = 25.4 / 96.0;

/// What white shapes are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum White {
    /// They cut away what was drawn before them, as one sees it on white
    /// paper; unless all is white, which is an area then.
    #[default]
    Cuts,
    /// They are areas as all others.
    Area,
}

/// How an SVG is laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SvgOptions {
    /// The width of the box around the area, mm. Without it, it follows from
    /// the height; without either, the file's own size counts: 96 pixels are
    /// an inch, and lengths with a unit are what they say.
    pub width_mm: Option<f64>,
    /// The height of the box around the area, mm.
    pub height_mm: Option<f64>,
    /// What lies at the origin.
    pub anchor: Anchor,
    /// What white shapes are.
    pub white: White,
}

/// The rules of all style sheets.
pub(crate) struct Sheet<'a> {
    rules: StyleSheet<'a>,
}

impl Drawing {
    /// Reads an SVG file: paths, basic shapes, lines of some width, groups,
    /// transforms, `use`, and styles. y points upwards. What is no area, such
    /// as images, is left out and named in the
    /// [warnings](Drawing::warnings).
    ///
    /// # Errors
    /// If the file is no SVG, broken, without an area or too large, or an
    /// option makes no sense.
    pub fn from_svg(
        name: &str,
        bytes: &[u8],
        options: &SvgOptions,
    ) -> Result<Drawing, NamedProblem> {
        read(name, bytes, options)
            .map_err(|problem| NamedProblem::new(name, problem))
    }
}

fn read(name: &str, bytes: &[u8], options: &SvgOptions) -> Problem<Drawing> {
    small_enough(bytes)?;
    if bytes.starts_with(b"\x1f\x8b") {
        return Err("it is compressed (SVGZ); save it as plain SVG".into());
    }
    let text = isoslice_base::encoding::text(bytes)
        .map_err(|e| format!("it is no text, as SVG is ({e})"))?;
    // DTDs define short names in some editors' files. No file is ever read for
    // them.
    let parsing = ParsingOptions {
        allow_dtd: true,
        nodes_limit: MOST_NODES,
        entity_resolver: None,
    };
    let document = Document::parse_with_options(text, parsing)
        .map_err(|e| format!("it is no XML, as SVG is: {e}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(format!(
            "it is no SVG: its outermost element is `{}`",
            root.tag_name().name()
        ));
    }
    let mut walk = Walk::new(sheet(&document)?, names(&document));
    let place = page(root)?;
    let (style, own) = Style::default().of(root, &walk.sheet);
    if !own.hidden {
        walk.see(root, &own);
        walk.children(root, &style, place)?;
    }
    let mut outlines = std::mem::take(&mut walk.outlines);
    let any = outlines.iter().any(|o| !o.cuts && o.window.is_none());
    if options.white == White::Area || !any {
        outlines.iter_mut().for_each(|o| o.cuts = false);
    }
    let sized = [options.width_mm, options.height_mm];
    place_all(&mut outlines, sized, options.anchor)?;
    let mut warnings = not_drawn(walk.left_out);
    if outlines.iter().any(|o| o.cuts) {
        warnings.push("white shapes cut away what is below them".into());
    }
    Drawing::warned(format!("svg({name:?})"), &outlines, warnings, FILL)
}

/// The rules of a document's style sheets.
fn sheet<'a>(document: &'a Document<'_>) -> Problem<Sheet<'a>> {
    let is_sheet = |node: &Node| node.tag_name().name() == "style";
    let sheets = document.descendants().filter(is_sheet);
    let texts: Vec<&str> = sheets.filter_map(|node| node.text()).collect();
    let selectors: usize = texts.iter().map(|text| selectors(text)).sum();
    if selectors > MOST_RULES {
        return Err(format!(
            "its style sheets have more than {MOST_RULES} rules; save it as \
             plain SVG"
        ));
    }
    if texts.iter().map(|text| text.len()).sum::<usize>() > MOST_SHEET_BYTES {
        return Err("its style sheets have more than 4 MB; save it as plain \
                    SVG"
        .into());
    }
    let mut rules = StyleSheet::new();
    for text in texts {
        go_on()?;
        rules.parse_more(text);
    }
    let long = rules.rules.iter().map(|rule| rule.selector.to_string());
    if let Some(long) =
        long.into_iter().find(|s| parts(s) > MOST_SELECTOR_PARTS)
    {
        let shown: String = long.chars().take(40).collect();
        return Err(format!(
            "its style sheet has a rule for `{shown}…`, of more than \
             {MOST_SELECTOR_PARTS} parts; save it as plain SVG"
        ));
    }
    Ok(Sheet { rules })
}

/// About how many selectors a style sheet has, before anybody reads it: each of
/// a list before a brace makes a rule.
fn selectors(sheet: &str) -> usize {
    let lists = sheet.split('{').rev().skip(1);
    let count = |list: &str| {
        let list = list.rsplit('}').next().unwrap_or_default();
        1 + list.matches(',').count()
    };
    lists.map(count).sum()
}

/// Number of elements that a selector names.
fn parts(selector: &str) -> usize {
    let words = selector.split_whitespace();
    words.filter(|word| !matches!(*word, ">" | "+")).count()
}

/// Elements by their names, the first of each.
fn names<'a>(document: &'a Document<'_>) -> BTreeMap<&'a str, NodeId> {
    let mut names = BTreeMap::new();
    for node in document.descendants() {
        if let Some(name) = node.attribute("id") {
            names.entry(name).or_insert(node.id());
        }
    }
    names
}

/// Where the root lies: its size, and y upwards from its lower edge.
fn page(root: Node) -> Problem<Place> {
    let view = view_box(root);
    let whole = view.map_or(DVec2::ZERO, |[_, size]| size);
    // Percentages are shares of a page, and here is none but the view box.
    let get = |name: &str, share| {
        let text = root.attribute(name)?;
        if text.contains('%') {
            return None;
        }
        attribute(root, name, share, whole)
    };
    let (width, height) =
        (get("width", Share::Width), get("height", Share::Height));
    let size = match (width, height, view) {
        (Some(w), Some(h), _) => DVec2::new(w, h),
        (Some(w), None, Some([_, v])) => v * (w / v.x),
        (None, Some(h), Some([_, v])) => v * (h / v.y),
        (None, None, Some([_, v])) => v,
        // As browsers have it.
        (w, h, None) => DVec2::new(w.unwrap_or(300.0), h.unwrap_or(150.0)),
    };
    if !(size.is_finite() && size.min_element() > 0.0) {
        return Err(format!(
            "its page is of {} × {} pixels; give it a size",
            size.x, size.y
        ));
    }
    let up = DAffine2::from_scale_angle_translation(
        DVec2::new(PIXEL, -PIXEL),
        0.0,
        DVec2::new(0.0, size.y * PIXEL),
    );
    let (to_mm, port) = match view {
        Some(view) => (up * fit(root, view, size), view[1]),
        None => (up, size),
    };
    Ok(Place {
        to_mm,
        port,
        depth: 0,
        seen_in: 0,
    })
}

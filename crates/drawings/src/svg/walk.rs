//! Goes through the elements of an SVG and collects the areas that are drawn.

use super::style::{Own, Paint, Style};
use super::view::{Share, attribute, fit, length, transform, view_box};
use super::{Sheet, shapes};
use crate::area::MOST_CURVES;
use crate::outline::Outline;
use crate::stroke::{Pen, stroke};
use glam::{DAffine2, DVec2};
use isoslice_base::problem::{Problem, go_on};
use roxmltree::{Node, NodeId};
use std::collections::BTreeMap;

/// The most elements in one another, those by `use` as well.
const DEEPEST: usize = 128;

/// The most elements that are drawn, those that are used several times as
/// often.
const MOST_ELEMENTS: usize = 200_000;

/// How far outside of its port an inner drawing may be, mm.
const BESIDE: f64 = 1e-3;

/// True if an element of a `switch` is for readers of English and asks for nothing
/// else.
fn is_for_all(node: Node) -> bool {
    let english = |list: &str| {
        list.split(',')
            .any(|l| l.trim().to_lowercase().starts_with("en"))
    };
    node.attribute("requiredExtensions").is_none()
        && node.attribute("systemLanguage").is_none_or(english)
}

/// Where an element is drawn.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// From its coordinates to mm, y upwards.
    pub(super) to_mm: DAffine2,
    /// The size of the port, of which percentages are shares.
    pub(super) port: DVec2,
    pub(super) depth: usize,
    /// The number of the list of windows in which it is seen.
    pub(super) seen_in: usize,
}

pub(super) struct Walk<'a> {
    pub(super) sheet: Sheet<'a>,
    /// Elements by their names.
    pub(super) named: BTreeMap<&'a str, NodeId>,
    pub(super) outlines: Vec<Outline>,
    /// Lists of windows, which are clip paths. The first is empty.
    seen_in: Vec<Vec<u32>>,
    windows: u32,
    /// The window that is being made.
    window: Option<u32>,
    /// How many lines and curves those have.
    curves: usize,
    elements: usize,
    /// What is not drawn, and how often.
    pub(super) left_out: BTreeMap<String, usize>,
    /// The elements by `use` in which this one is.
    using: Vec<NodeId>,
    /// How far curves may be from the truth, mm.
    accuracy: f64,
}

impl<'a> Walk<'a> {
    pub(super) fn new(
        sheet: Sheet<'a>,
        named: BTreeMap<&'a str, NodeId>,
    ) -> Walk<'a> {
        Walk {
            sheet,
            named,
            outlines: Vec::new(),
            seen_in: vec![Vec::new()],
            windows: 0,
            window: None,
            curves: 0,
            elements: 0,
            left_out: BTreeMap::new(),
            using: Vec::new(),
            // 0.05 µm.
            accuracy: 5e-5,
        }
    }

    fn warn(&mut self, what: impl Into<String>) {
        *self.left_out.entry(what.into()).or_default() += 1;
    }

    /// Draws what is in an element.
    pub(super) fn children(
        &mut self,
        node: Node<'a, '_>,
        style: &Style,
        place: Place,
    ) -> Problem<()> {
        let place = Place {
            depth: place.depth + 1,
            ..place
        };
        if place.depth > DEEPEST {
            return Err(format!(
                "elements are within one another more than {DEEPEST} deep; \
                 ungroup them"
            ));
        }
        let switch = node.tag_name().name() == "switch";
        let all = node.children().filter(Node::is_element);
        let all = all.filter(|child| !switch || is_for_all(*child));
        for child in all.take(if switch { 1 } else { usize::MAX }) {
            self.element(child, style, place)?;
        }
        Ok(())
    }

    fn element(
        &mut self,
        node: Node<'a, '_>,
        style: &Style,
        place: Place,
    ) -> Problem<()> {
        go_on()?;
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err(format!(
                "more than {MOST_ELEMENTS} elements are drawn, some of them by \
                 `use`; simplify the drawing"
            ));
        }
        let (style, own) = style.of(node, &self.sheet);
        if own.hidden {
            return Ok(());
        }
        self.warn_of(&own);
        let Some(by) = transform(node) else {
            self.warn("a transform that cannot be read");
            return Ok(());
        };
        let place = Place {
            to_mm: place.to_mm * by,
            ..place
        };
        let place = match &own.clip {
            Some(name) => self.clipped(node, name, place)?,
            None => place,
        };
        match node.tag_name().name() {
            "g" | "a" | "switch" => self.children(node, &style, place),
            "svg" => self.port(node, &style, place, DVec2::ZERO),
            "use" => self.used(node, &style, place),
            name @ ("image" | "foreignObject" | "text" | "script") => {
                self.warn(match name {
                    "text" => {
                        "text; turn it into paths (Inkscape: Path > Object to \
                         Path)"
                    }
                    "image" => "an image; trace it (Inkscape: Path > Trace)",
                    "script" => "a script, which is not run",
                    _ => "a foreign object",
                });
                Ok(())
            }
            _ => match shapes::path(node, place.port) {
                Some((path, broken)) => {
                    if let Some(what) = broken {
                        self.warn(what);
                    }
                    self.draw(&path, &style, place)
                }
                None => Ok(()),
            },
        }
    }

    /// Seen only within a clip path as well.
    fn clipped(
        &mut self,
        node: Node<'a, '_>,
        name: &str,
        place: Place,
    ) -> Problem<Place> {
        let found = self.named.get(name).copied();
        let clip = found.and_then(|id| node.document().get_node(id));
        let clip = clip.filter(|c| c.tag_name().name() == "clipPath");
        let Some(clip) = clip else {
            return Ok(place);
        };
        let boxed = clip.attribute("clipPathUnits");
        let by = transform(clip);
        let (Some(by), true) = (by, boxed != Some("objectBoundingBox")) else {
            self.warn("a clip path that cannot be read; all is drawn");
            return Ok(place);
        };
        if self.using.contains(&clip.id()) || self.using.len() > DEEPEST {
            return Err(format!("the clip path `#{name}` uses itself"));
        }
        self.using.push(clip.id());
        let (style, own) = Style::default().of(clip, &self.sheet);
        let mut inner = Place {
            to_mm: place.to_mm * by,
            seen_in: 0,
            ..place
        };
        if let Some(name) = &own.clip {
            inner = self.clipped(clip, name, inner)?;
        }
        let window = self.windows;
        self.windows += 1;
        let before = self.window.replace(window);
        self.children(clip, &style, inner)?;
        self.window = before;
        self.using.pop();
        let mut all = self.seen_in[place.seen_in].clone();
        all.push(window);
        all.extend(&self.seen_in[inner.seen_in]);
        self.seen_in.push(all);
        Ok(Place {
            seen_in: self.seen_in.len() - 1,
            ..place
        })
    }

    /// Notes what of the outermost element is not read.
    pub(super) fn see(&mut self, root: Node, own: &Own) {
        self.warn_of(own);
        if root.has_attribute("transform") {
            self.warn("the transform of the outermost svg");
        }
    }

    fn warn_of(&mut self, own: &Own) {
        if let Some(cut) = own.cut {
            self.warn(format!("a {cut}, without which all is drawn"));
        }
        if let Some(unread) = &own.unread {
            self.warn(unread.clone());
        }
    }

    /// An `svg` in another, or a symbol.
    fn port(
        &mut self,
        node: Node<'a, '_>,
        style: &Style,
        place: Place,
        size: DVec2,
    ) -> Problem<()> {
        let get = |name, share| attribute(node, name, share, place.port);
        let corner = DVec2::new(
            get("x", Share::Width).unwrap_or(0.0),
            get("y", Share::Height).unwrap_or(0.0),
        );
        let or = |given: f64, name, share, whole: f64| {
            if given > 0.0 {
                given
            } else {
                get(name, share).unwrap_or(whole)
            }
        };
        let size = DVec2::new(
            or(size.x, "width", Share::Width, place.port.x),
            or(size.y, "height", Share::Height, place.port.y),
        );
        let moved = place.to_mm * DAffine2::from_translation(corner);
        let view = view_box(node);
        let (to_mm, port) = match view {
            Some(view) => (moved * fit(node, view, size), view[1]),
            None => (moved, size),
        };
        let place = Place {
            to_mm,
            port,
            ..place
        };
        let before = self.outlines.len();
        self.children(node, style, place)?;
        // Browsers draw no more than what is in the port.
        let (_, own) = Style::default().of(node, &self.sheet);
        let [low, high] =
            [DVec2::ZERO, size].map(|p| moved.transform_point2(p));
        let (low, high) = (low.min(high) - BESIDE, low.max(high) + BESIDE);
        let is_beyond = |outline: &Outline| {
            outline.curves().iter().any(|curve| {
                let own = curve.bounds();
                own.min.cmplt(low).any() || own.max.cmpgt(high).any()
            })
        };
        let is_turned = moved.x_axis.y != 0.0 || moved.y_axis.x != 0.0;
        let added = self.outlines.get(before..).unwrap_or_default();
        if !own.overflows && !is_turned && added.iter().any(is_beyond) {
            self.warn(
                "the border of an inner svg or symbol, beyond which all is drawn",
            );
        }
        Ok(())
    }

    /// What `use` refers to.
    fn used(
        &mut self,
        node: Node<'a, '_>,
        style: &Style,
        place: Place,
    ) -> Problem<()> {
        const XLINK: &str = "http://www.w3.org/1999/xlink";
        let link = node.attribute("href").or(node.attribute((XLINK, "href")));
        let Some(name) = link.and_then(|link| link.strip_prefix('#')) else {
            self.warn("what is in another file, which is not read");
            return Ok(());
        };
        let found = self.named.get(name).copied();
        let Some(target) = found.and_then(|id| node.document().get_node(id))
        else {
            self.warn(format!("`#{name}`, which there is not"));
            return Ok(());
        };
        if self.using.contains(&target.id())
            || node.ancestors().any(|a| a.id() == target.id())
        {
            return Err(format!(
                "`#{name}` uses itself, without an end; mend the drawing"
            ));
        }
        let get = |name, share| {
            attribute(node, name, share, place.port).unwrap_or(0.0)
        };
        let by = DVec2::new(get("x", Share::Width), get("y", Share::Height));
        let size = DVec2::new(
            get("width", Share::Width),
            get("height", Share::Height),
        );
        let place = Place {
            to_mm: place.to_mm * DAffine2::from_translation(by),
            depth: place.depth + 1,
            ..place
        };
        if place.depth > DEEPEST {
            return Err("`use` refers to `use` too often; mend it".into());
        }
        self.using.push(target.id());
        let done = match target.tag_name().name() {
            "symbol" => {
                let (style, own) = style.of(target, &self.sheet);
                self.warn_of(&own);
                self.port(target, &style, place, size)
            }
            _ => self.element(target, style, place),
        };
        self.using.pop();
        done
    }

    /// Adds a path as its style says.
    fn draw(
        &mut self,
        path: &super::path::Path,
        style: &Style,
        place: Place,
    ) -> Problem<()> {
        if self.window.is_some() {
            // What it is painted with does not matter.
            return self.add(vec![path.filled(style.clip_rule)], place);
        }
        let [fill, line] = style.paints();
        let mut made = Vec::new();
        if fill != Paint::None {
            let mut filled = path.filled(style.rule);
            filled.cuts = fill == Paint::White;
            made.push(filled);
        }
        let width = length(style.width, Share::Diagonal, place.port);
        let scale = place.to_mm.matrix2.determinant().abs().sqrt();
        if line != Paint::None && width > 0.0 && scale > 0.0 {
            if style.dashed {
                self.warn("dashes; the lines are drawn whole");
            }
            if style.marked {
                self.warn("markers");
            }
            let pen = Pen {
                width,
                cap: style.cap,
                join: style.join,
                miter: style.miter,
                accuracy: self.accuracy / scale,
            };
            let from = made.len();
            for strand in &path.strands {
                go_on()?;
                stroke(strand, &pen, &mut made);
                if made.len() > MOST_CURVES {
                    break;
                }
            }
            for outline in &mut made[from..] {
                outline.cuts = line == Paint::White;
            }
        }
        self.add(made, place)
    }

    /// Adds outlines at a place.
    fn add(&mut self, made: Vec<Outline>, place: Place) -> Problem<()> {
        for outline in made.iter().filter(|o| !o.is_empty()) {
            self.curves += outline.len();
            let mut outline = outline.mapped(place.to_mm);
            outline.window = self.window;
            outline.seen_in.clone_from(&self.seen_in[place.seen_in]);
            self.outlines.push(outline);
        }
        if self.curves > MOST_CURVES {
            return Err(format!(
                "it has more than {MOST_CURVES} lines and curves; simplify it \
                 (Inkscape: Path > Simplify)"
            ));
        }
        Ok(())
    }
}

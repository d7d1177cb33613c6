//! Labels of the part. Hosts show them, and leave the labelled part out if
//! asked.
//!
//! In: the part's name and its outline seen from above. Out: the lines that
//! define it in the file's head, and those around it in every layer. What is
//! not the part, a skirt, stands outside of them.

use super::Header;
use super::flavour::Board;
use super::number::text;
use crate::settings::{Emit, Flavour, Settings};
use glam::DVec2;

/// Decimals of the outline, which is clicked on, not printed.
const DECIMALS: u32 = 2;

/// The lines of a part's label.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    /// Lines for the file's head.
    pub define: Vec<String>,
    /// The line before the part in a layer.
    pub start: String,
    /// The line after the part in a layer.
    pub end: String,
}

impl Label {
    /// The label of the file's part; nothing if the settings ask for none.
    pub(super) fn new(settings: &Settings, header: &Header) -> Option<Label> {
        let flavour = settings.gcode.flavour;
        let wanted = wanted(settings);
        let name = name(&header.model_name);
        let numbered = |define: &[&str]| Label {
            define: define.iter().map(|l| (*l).to_owned()).collect(),
            start: "M486 S0".to_owned(),
            end: "M486 S-1".to_owned(),
        };
        wanted.then(|| match flavour {
            Flavour::Klipper => Label {
                define: vec![format!(
                    "EXCLUDE_OBJECT_DEFINE NAME={name} {}",
                    outline(header)
                )],
                start: format!("EXCLUDE_OBJECT_START NAME={name}"),
                end: format!("EXCLUDE_OBJECT_END NAME={name}"),
            },
            Flavour::Marlin => numbered(&["M486 T1"]),
            Flavour::Rrf => numbered(&[
                "M486 T1",
                &format!("M486 S0 A\"{name}\""),
                "M486 S-1",
            ]),
            // The name has to be alone in its line.
            Flavour::Prusa => numbered(&[
                "M486 T1",
                "M486 S0",
                &format!("M486 A{name}"),
                "M486 S-1",
            ]),
        })
    }
}

/// True if the part's label needs the part's outline, as Klipper's does.
pub(crate) fn needs_outline(settings: &Settings) -> bool {
    settings.gcode.flavour == Flavour::Klipper && wanted(settings)
}

fn wanted(settings: &Settings) -> bool {
    match settings.gcode.labels {
        Emit::On => true,
        Emit::Off => false,
        Emit::Auto => known(settings.gcode.flavour, settings),
    }
}

/// True if any firmware of the flavour understands labels. Marlin does only if
/// it was built with that option, which is off by default. Of Prusa's firmwares
/// only the newer one does.
fn known(flavour: Flavour, settings: &Settings) -> bool {
    match flavour {
        Flavour::Klipper | Flavour::Rrf => true,
        Flavour::Marlin => false,
        Flavour::Prusa => {
            matches!(Board::of(settings), Board::Buddy | Board::Mini)
        }
    }
}

/// A name of ASCII letters, digits and underscores, which every parser reads.
fn name(model: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = model.chars().map(plain).collect();
    if name.is_empty() {
        "part".to_owned()
    } else {
        name
    }
}

/// `CENTER=x,y POLYGON=[[x,y],...]`.
fn outline(header: &Header) -> String {
    let (min, max) = (header.part_min, header.part_max);
    let corners = [
        DVec2::new(min.x, min.y),
        DVec2::new(max.x, min.y),
        DVec2::new(max.x, max.y),
        DVec2::new(min.x, max.y),
    ];
    let ring = match header.outline.len() {
        0..3 => corners.as_slice(),
        _ => header.outline.as_slice(),
    };
    let point =
        |p: &DVec2| format!("{},{}", text(p.x, DECIMALS), text(p.y, DECIMALS));
    let points: Vec<_> =
        ring.iter().map(|p| format!("[{}]", point(p))).collect();
    let centre = 0.5 * (min + max).truncate();
    format!("CENTER={} POLYGON=[{}]", point(&centre), points.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain() {
        assert_eq!(name("my part \"2\".v1"), "my_part__2__v1");
        assert_eq!(name("Ü"), "_");
        assert_eq!(name(""), "part");
    }
}

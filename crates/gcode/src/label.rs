//! Labels of the parts. Hosts show them, and can leave a labelled part out.
//!
//! In: the parts' names and their outlines seen from above. Out: the lines in
//! the file's head that define the labels, and the lines around each part in
//! every layer. Beads that belong to no part, such as a skirt's, are outside of
//! these lines.

use super::number::text;
use super::{Header, Standing, WriterPlan};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;
use isoslice_planar::Rect;
use isoslice_settings::Flavour;
use std::collections::BTreeSet;
use std::iter::once;

/// Most parts that Bambu Lab's firmware tells from one another.
const MOST_BITS: usize = 64;

/// Decimals of the outline, which is clicked on, not printed.
const DECIMALS: u32 = 2;

/// The labels of the parts on a plate.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Labels {
    /// Lines for the file's head.
    pub define: Vec<String>,
    /// The label of each part; none if the settings ask for none.
    pub around: Vec<Around>,
}

/// The lines around a part in a layer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Around {
    /// The line before the part.
    pub start: String,
    /// The line after the part.
    pub end: String,
}

/// True if the firmware cannot tell so many parts from one another.
fn too_many(plan: &WriterPlan<'_>, header: &Header) -> bool {
    match plan.flavour {
        Flavour::Bambu => header.parts.len() > MOST_BITS,
        Flavour::Marlin | Flavour::Klipper | Flavour::Rrf | Flavour::Prusa => {
            false
        }
    }
}

/// What the user should know if parts have no labels because they are too many.
pub(super) fn warning(
    plan: &WriterPlan<'_>,
    header: &Header,
) -> Option<String> {
    let parts = header.parts.len();
    (plan.labels && too_many(plan, header)).then(|| {
        format!(
            "gcode.labels: no part has a label, so the printer cannot skip one \
             of them: Bambu Lab's firmware tells {MOST_BITS} parts from one \
             another, and there are {parts}; print fewer of them at once"
        )
    })
}

impl Labels {
    /// The labels of the file's parts; none if the settings ask for none.
    pub(super) fn new(plan: &WriterPlan<'_>, header: &Header) -> Labels {
        if !plan.labels || too_many(plan, header) {
            return Labels::default();
        }
        let flavour = plan.flavour;
        let names = names(&header.parts);
        let around = |(k, name): (usize, &String)| match flavour {
            Flavour::Klipper => Around {
                start: format!("EXCLUDE_OBJECT_START NAME={name}"),
                end: format!("EXCLUDE_OBJECT_END NAME={name}"),
            },
            // M624 tells which of the parts follows, as a number of 64 bits.
            Flavour::Bambu => Around {
                start: format!("M624 {}", STANDARD.encode(bit(k))),
                end: "M625".to_owned(),
            },
            Flavour::Marlin | Flavour::Rrf | Flavour::Prusa => Around {
                start: format!("M486 S{k}"),
                end: "M486 S-1".to_owned(),
            },
        };
        let count = || format!("M486 T{}", names.len());
        let none = || "M486 S-1".to_owned();
        let define = match flavour {
            Flavour::Klipper => names
                .iter()
                .zip(&header.parts)
                .map(|(name, part)| {
                    let outline = outline(part);
                    format!("EXCLUDE_OBJECT_DEFINE NAME={name} {outline}")
                })
                .collect(),
            Flavour::Bambu => vec![numbers(names.len())],
            Flavour::Marlin => vec![count()],
            Flavour::Rrf => {
                let named = names.iter().enumerate();
                let named = named.map(|(k, n)| format!("M486 S{k} A\"{n}\""));
                once(count()).chain(named).chain([none()]).collect()
            }
            Flavour::Prusa => {
                // Prusa's firmware wants the name alone in its line.
                let named = names.iter().enumerate();
                let named = named.flat_map(|(k, n)| {
                    [format!("M486 S{k}"), format!("M486 A{n}")]
                });
                once(count()).chain(named).chain([none()]).collect()
            }
        };
        let around = names.iter().enumerate().map(around).collect();
        Labels { define, around }
    }
}

/// The number in which only the bit of a part is set, as bytes from the lowest
/// one on.
fn bit(part: usize) -> [u8; MOST_BITS / 8] {
    1u64.checked_shl(part as u32).unwrap_or(0).to_le_bytes()
}

/// The line that names the parts' numbers, from 1.
fn numbers(count: usize) -> String {
    let all: Vec<String> = (1..=count).map(|k| k.to_string()).collect();
    format!("; model label id: {}", all.join(","))
}

/// A different name for each part.
fn names(parts: &[Standing]) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let unique = |part: &Standing| {
        let plain = name(&part.name);
        let more = (2..).map(|k| format!("{plain}_{k}"));
        let mut names = once(plain.clone()).chain(more);
        // Klipper does not tell capitals from small letters.
        let free = names.find(|n| !taken.contains(&n.to_ascii_lowercase()));
        let name = free.unwrap_or(plain);
        taken.insert(name.to_ascii_lowercase());
        name
    };
    parts.iter().map(unique).collect()
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

/// The part's outline as Klipper reads it: `CENTER=x,y POLYGON=[[x,y],...]`.
fn outline(part: &Standing) -> String {
    let frame = Rect::new(part.min, part.max);
    let corners = frame.corners();
    let ring = match part.outline.len() {
        0..3 => corners.as_slice(),
        _ => part.outline.as_slice(),
    };
    let point =
        |p: &DVec2| format!("{},{}", text(p.x, DECIMALS), text(p.y, DECIMALS));
    let points: Vec<_> =
        ring.iter().map(|p| format!("[{}]", point(p))).collect();
    let centre = point(&frame.centre());
    format!("CENTER={centre} POLYGON=[{}]", points.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain() {
        assert_eq!(name("my part \"2\".v1"), "my_part__2__v1");
        assert_eq!(name("Ü"), "_");
        assert_eq!(name(""), "part");
        let part = |name: &str| Standing {
            name: name.to_owned(),
            min: DVec2::ZERO,
            max: DVec2::ONE,
            outline: Vec::new(),
        };
        let parts = ["a-b", "a_b", "c", "a_b_2", "a b"].map(part);
        let names = names(&parts);
        assert_eq!(names, ["a_b", "a_b_2", "c", "a_b_2_2", "a_b_3"]);
    }
}

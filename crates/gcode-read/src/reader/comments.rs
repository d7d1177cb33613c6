//! What slicers say in comments.
//!
//! In: a comment's bytes, after the semicolon. Out: a [`Tag`], if it is a
//! comment that PrusaSlicer, OrcaSlicer, BambuStudio or Cura write for viewers.

use super::event::Heater;
use super::role::Role;
use isoslice_base::units::{Celsius, Mm};

/// A comment that means something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tag {
    /// The role of the beads that follow.
    Role(Role),
    /// A layer begins.
    Layer,
    /// The width of the beads that follow.
    Width(Mm),
    /// The height of the beads that follow.
    Height(Mm),
    /// True if the moves that follow wipe the nozzle.
    Wipe(bool),
    /// E is a volume. For some flavours only one of Cura's comments says so.
    Volumetric,
    /// The printer homes, heats and cools by itself, as Ultimaker's do.
    OwnStart {
        /// True if E is a volume.
        volumetric: bool,
    },
    /// The printer heats to this temperature before the first line (Griffin's
    /// header).
    Preheat(Heater, Celsius),
}

/// The tag that a comment is.
pub(super) fn tag(comment: &[u8]) -> Option<Tag> {
    let comment = comment.trim_ascii();
    // All tags begin with one of these characters, and most comments do not.
    match comment.first()? {
        b'T' => after(comment, "TYPE:").map(role),
        b'F' => match comment {
            b"FLAVOR:Marlin(Volumetric)" => Some(Tag::Volumetric),
            b"FLAVOR:UltiGCode" => Some(Tag::OwnStart { volumetric: true }),
            b"FLAVOR:Griffin" => Some(Tag::OwnStart { volumetric: false }),
            _ => after(comment, "FEATURE:").map(role),
        },
        b'L' => match comment {
            b"LAYER_CHANGE" => Some(Tag::Layer),
            _ => after(comment, "LAYER:")
                .filter(|number| is_integer(number))
                .map(|_| Tag::Layer)
                .or_else(|| length(comment, "LINE_WIDTH:", Tag::Width))
                .or_else(|| length(comment, "LAYER_HEIGHT:", Tag::Height)),
        },
        b'C' => (comment == b"CHANGE_LAYER").then_some(Tag::Layer),
        b'W' => match comment {
            b"WIPE_START" => Some(Tag::Wipe(true)),
            b"WIPE_END" => Some(Tag::Wipe(false)),
            _ => length(comment, "WIDTH:", Tag::Width),
        },
        b'H' => length(comment, "HEIGHT:", Tag::Height),
        b'E' => after(comment, "EXTRUDER_TRAIN.").and_then(train),
        b'B' => after(comment, "BUILD_PLATE.INITIAL_TEMPERATURE:")
            .and_then(positive_or_zero)
            .map(|to| Tag::Preheat(Heater::Bed, to)),
        _ => None,
    }
}

/// The tag of `0.INITIAL_TEMPERATURE:205`, in Griffin's header.
fn train(rest: &[u8]) -> Option<Tag> {
    let at = memchr::memchr(b'.', rest)?;
    let number = std::str::from_utf8(&rest[..at]).ok()?.parse().ok()?;
    let to = after(&rest[at + 1..], "INITIAL_TEMPERATURE:")?;
    let to = positive_or_zero(to)?;
    Some(Tag::Preheat(Heater::Nozzle(Some(number)), to))
}

fn role(name: &[u8]) -> Tag {
    Tag::Role(Role::from_name(name))
}

/// True for a whole number. Cura numbers the layers of a raft below zero.
fn is_integer(text: &[u8]) -> bool {
    let digits = text.strip_prefix(b"-").unwrap_or(text);
    !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
}

/// The text after `start`.
pub(super) fn after<'a>(text: &'a [u8], start: &str) -> Option<&'a [u8]> {
    text.strip_prefix(start.as_bytes())
}

/// A tag with a length that a bead can have.
fn length(comment: &[u8], start: &str, tag: fn(Mm) -> Tag) -> Option<Tag> {
    after(comment, start)
        .and_then(positive_or_zero)
        .filter(|&mm| mm > 0.0 && mm < 100.0)
        .map(tag)
}

/// The number that `text` is, if it is finite and not negative.
pub(super) fn positive_or_zero(text: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(text.trim_ascii()).ok()?;
    let number = text.parse::<f64>().ok()?;
    (number.is_finite() && number >= 0.0).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_of_the_dialects() {
        for (comment, expected) in [
            ("TYPE:External perimeter", Tag::Role(Role::OuterWall)),
            ("TYPE:WALL-INNER", Tag::Role(Role::InnerWall)),
            (" FEATURE: Top surface", Tag::Role(Role::TopSkin)),
            ("TYPE:No such thing", Tag::Role(Role::Unknown)),
            ("LAYER_CHANGE", Tag::Layer),
            (" CHANGE_LAYER", Tag::Layer),
            ("LAYER:12", Tag::Layer),
            ("LAYER:-2", Tag::Layer),
            ("WIDTH:0.45", Tag::Width(0.45)),
            (" LINE_WIDTH: 0.42", Tag::Width(0.42)),
            ("HEIGHT:0.2", Tag::Height(0.2)),
            (" LAYER_HEIGHT: 0.28", Tag::Height(0.28)),
            ("WIPE_START", Tag::Wipe(true)),
            (" WIPE_END", Tag::Wipe(false)),
            ("FLAVOR:Griffin", Tag::OwnStart { volumetric: false }),
            (
                "EXTRUDER_TRAIN.1.INITIAL_TEMPERATURE:205",
                Tag::Preheat(Heater::Nozzle(Some(1)), 205.0),
            ),
            (
                "BUILD_PLATE.INITIAL_TEMPERATURE:60",
                Tag::Preheat(Heater::Bed, 60.0),
            ),
        ] {
            assert_eq!(tag(comment.as_bytes()), Some(expected), "{comment}");
        }
    }

    #[test]
    fn other_comments_are_none() {
        for comment in [
            "",
            " ",
            "LAYER_COUNT:12",
            "LAYER:x",
            "LAYER:-",
            "WIDTH:nan",
            "WIDTH:inf",
            "WIDTH:0",
            "HEIGHT:1e300",
            "HEIGHT:",
            "Z:0.2",
            "layer_height = 0.2",
            "TYPES:x",
        ] {
            assert_eq!(tag(comment.as_bytes()), None, "{comment}");
        }
        assert_eq!(tag(b"\xff\xfe"), None);
    }
}

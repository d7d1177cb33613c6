//! The patterns of other slicers, each with isoslice's own or the one most
//! like it.
//!
//! A pattern is the same if its lines are: how a slicer joins them, and in which
//! order it lays them, does not count. What is only like it is told to the user.

use super::As;

/// Infill of PrusaSlicer and its kin.
pub(super) const INFILL: As = As::Patterns {
    same: pairs! {
        "rectilinear", "zig-zag", "zigzag", "line", "monotonic",
            "monotonicline", "monotoniclines" => "rectilinear";
        "rectilineargrid", "grid" => "grid";
        "triangles" => "triangles";
        "honeycomb" => "hexagons";
        "cubic" => "cubic";
        "concentric" => "concentric";
        "gyroid" => "gyroid";
        "tpmsd" => "diamond";
    },
    like: pairs! {
        // The lines of isoslice turn with every layer.
        "alignedrectilinear", "aligned-rectilinear", "crosszag", "lockedzag"
            => "rectilinear";
        // These lattices and honeycombs stand upright: a layer has lines that
        // change their places from layer to layer.
        "2dlattice", "lateral-lattice" => "grid";
        "2dhoneycomb", "lateral-honeycomb" => "hexagons";
        "stars", "tri-hexagon" => "triangles";
        "3dhoneycomb", "adaptivecubic", "supportcubic", "quartercubic",
            "quarter_cubic" => "cubic";
        "crosshatch" => "gyroid";
        // The surface of Fischer and Koch.
        "tpmsfk" => "schwarz-p";
    },
};

/// Infill of Cura.
pub(super) const INFILL_OF_CURA: As = As::Patterns {
    same: pairs! {
        "lines", "zigzag" => "rectilinear";
        "grid" => "grid";
        "triangles" => "triangles";
        "cubic" => "cubic";
        "concentric" => "concentric";
        "gyroid" => "gyroid";
    },
    like: pairs! {
        "trihexagon" => "triangles";
        "cubicsubdiv", "quarter_cubic", "tetrahedral" => "cubic";
    },
};

/// Skin of PrusaSlicer and its kin that faces one way, and the word for lines in
/// any order.
macro_rules! skin {
    ($face:literal, $unordered:literal) => {
        As::Patterns {
            same: pairs! {
                "rectilinear" => concat!($face, ": ", $unordered);
                "monotonic", "monotonicline", "monotoniclines"
                    => concat!($face, ": lines");
                "zig-zag", "line" => concat!($face, ": ", $unordered);
                "concentric" => concat!($face, ": concentric");
            },
            // The lines of isoslice turn with every layer.
            like: &[("alignedrectilinear", concat!($face, ": ", $unordered))],
        }
    };
}
pub(super) const TOP: As = skin!("top", "unordered-lines");
pub(super) const BOTTOM: As = skin!("bottom", "lines");
pub(super) const INTERNAL: As = skin!("internal", "lines");

/// Skin of Cura.
pub(super) const SKIN_OF_CURA: As = As::Patterns {
    same: pairs! {
        "lines", "zigzag" => "bottom: lines";
        "concentric" => "bottom: concentric";
    },
    like: &[],
};

/// The dense tops of supports of PrusaSlicer and its kin. Lines are isoslice's
/// default.
pub(super) const INTERFACE: As = As::Patterns {
    same: pairs! {
        "concentric" => "concentric";
        "auto", "default", "rectilinear", "rectilinear_interlaced", "monotonic"
            => "";
    },
    like: &[("grid", "lines")],
};

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn a_word_is_the_same_or_only_like_it() {
        for all in
            [INFILL, INFILL_OF_CURA, TOP, BOTTOM, SKIN_OF_CURA, INTERFACE]
        {
            let As::Patterns { same, like } = all else {
                panic!("{all:?} is no table of patterns");
            };
            let mut seen = BTreeSet::new();
            for (theirs, _) in same.iter().chain(like) {
                assert!(seen.insert(theirs), "{theirs} twice");
            }
        }
    }
}

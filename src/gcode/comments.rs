//! The comments that viewers and hosts read, in the words of several slicers.
//!
//! In: roles. Out: the words of a dialect.
//!
//! | dialect | layers | roles | sizes |
//! |---|---|---|---|
//! | `prusa`, the default | `;LAYER_CHANGE`, `;Z:` | `;TYPE:External perimeter` | `;WIDTH:`, `;HEIGHT:` |
//! | `orca` | the same | `;TYPE:Outer wall` | the same |
//! | `cura` | `;LAYER:` from 0 | `;TYPE:WALL-OUTER` | |
//! | `none` | | | |
//!
//! Never two kinds of layer marks in one file: PrusaSlicer's viewer would
//! count both. Some viewers colour by words they find anywhere in a comment,
//! so comments of our own avoid the roles' words. No dialect claims to be
//! another slicer's file: a viewer that believes it looks for that slicer's
//! configuration, and refuses the file.

use crate::bead::Role;
use crate::settings::{Comments, Flavour};

/// Stands after the last layer: from the first layer's mark to here a file
/// can be joined with those of the part's other layers.
pub(super) const END_OF_LAYERS: &str = "; end of layers";

/// The role's name in a dialect, if that names roles.
pub fn role_name(dialect: Comments, role: Role) -> Option<&'static str> {
    match dialect {
        Comments::Prusa => Some(prusa(role)),
        Comments::Orca => Some(orca(role)),
        Comments::Cura => Some(cura(role)),
        Comments::None => None,
    }
}

/// What a start or end template prints is not the part; Cura has no word for
/// that.
pub(super) fn custom(dialect: Comments) -> Option<&'static str> {
    match dialect {
        Comments::Prusa | Comments::Orca => Some("Custom"),
        Comments::Cura | Comments::None => None,
    }
}

/// True if the dialect tells widths and heights.
pub(super) fn has_sizes(dialect: Comments) -> bool {
    matches!(dialect, Comments::Prusa | Comments::Orca)
}

/// Cura's name of a firmware: its reader takes any other for Marlin's.
pub(super) fn cura_flavour(flavour: Flavour) -> &'static str {
    match flavour {
        Flavour::Rrf => "RepRap",
        Flavour::Marlin | Flavour::Klipper | Flavour::Prusa => "Marlin",
    }
}

fn prusa(role: Role) -> &'static str {
    match role {
        Role::Skirt | Role::Brim => "Skirt/Brim",
        Role::OuterWall => "External perimeter",
        Role::InnerWall => "Perimeter",
        Role::Overhang => "Overhang perimeter",
        Role::GapFill => "Gap fill",
        Role::SparseInfill => "Internal infill",
        Role::InternalSkin | Role::BottomSkin => "Solid infill",
        Role::TopSkin => "Top solid infill",
        Role::Bridge => "Bridge infill",
        Role::Ironing => "Ironing",
    }
}

fn orca(role: Role) -> &'static str {
    match role {
        Role::Skirt => "Skirt",
        Role::Brim => "Brim",
        Role::OuterWall => "Outer wall",
        Role::InnerWall => "Inner wall",
        Role::Overhang => "Overhang wall",
        Role::GapFill => "Gap infill",
        Role::SparseInfill => "Sparse infill",
        Role::InternalSkin => "Internal solid infill",
        Role::BottomSkin => "Bottom surface",
        Role::TopSkin => "Top surface",
        Role::Bridge => "Bridge",
        Role::Ironing => "Ironing",
    }
}

fn cura(role: Role) -> &'static str {
    match role {
        Role::Skirt | Role::Brim => "SKIRT",
        Role::OuterWall | Role::Overhang => "WALL-OUTER",
        Role::InnerWall | Role::GapFill => "WALL-INNER",
        Role::SparseInfill => "FILL",
        Role::InternalSkin
        | Role::BottomSkin
        | Role::TopSkin
        | Role::Bridge
        | Role::Ironing => "SKIN",
    }
}

//! The comments that viewers and hosts read, in the words of several slicers.
//!
//! In: roles. Out: the words of a dialect.
//!
//! | dialect | layers | roles | sizes |
//! |---|---|---|---|
//! | `prusa`, the default | `;LAYER_CHANGE`, `;Z:` | `;TYPE:External perimeter` | `;WIDTH:`, `;HEIGHT:` |
//! | `orca` | as `prusa` | `;TYPE:Outer wall` | as `prusa` |
//! | `bambu` | `; CHANGE_LAYER`, `; Z_HEIGHT:` | `; FEATURE: Outer wall` | `; LINE_WIDTH:`, `; LAYER_HEIGHT:` |
//! | `cura` | `;LAYER:` from 0 | `;TYPE:WALL-OUTER` | |
//! | `none` | | | |
//!
//! A file never has two kinds of layer marks: PrusaSlicer's viewer would count
//! both. Some viewers colour by words they find anywhere in a comment, so
//! comments of our own avoid the roles' words. No dialect claims to be another
//! slicer's file: a viewer that believes it looks for that slicer's
//! configuration, and refuses the file.

use isoslice_planar::bead::Role;
use isoslice_settings::Comments;

/// The comment after the last layer. The text between the first layer's mark
/// and this comment can be joined with the part's other layers from other
/// files.
pub(super) const END_OF_LAYERS: &str = "; end of layers";

/// The comments before and after a wipe; nothing if the dialect has none.
pub(super) fn wipe(dialect: Comments) -> Option<[&'static str; 2]> {
    match dialect {
        Comments::Prusa | Comments::Orca => Some([";WIPE_START", ";WIPE_END"]),
        Comments::Bambu => Some(["; WIPE_START", "; WIPE_END"]),
        Comments::Cura | Comments::None => None,
    }
}

/// The mark of a layer, and the words before heights, widths and roles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Words {
    pub layer: &'static str,
    pub z: &'static str,
    pub height: &'static str,
    pub width: &'static str,
}

/// The words of a dialect that tells widths and heights.
pub(super) fn words(dialect: Comments) -> Option<Words> {
    match dialect {
        Comments::Prusa | Comments::Orca => Some(Words {
            layer: ";LAYER_CHANGE",
            z: ";Z:",
            height: ";HEIGHT:",
            width: ";WIDTH:",
        }),
        Comments::Bambu => Some(Words {
            layer: "; CHANGE_LAYER",
            z: "; Z_HEIGHT: ",
            height: "; LAYER_HEIGHT: ",
            width: "; LINE_WIDTH: ",
        }),
        Comments::Cura | Comments::None => None,
    }
}

/// The text before a role's name.
pub(super) fn before_role(dialect: Comments) -> &'static str {
    match dialect {
        Comments::Bambu => "; FEATURE: ",
        _ => ";TYPE:",
    }
}

/// The role's name in a dialect; nothing if the dialect does not name roles.
pub(super) fn role_name(dialect: Comments, role: Role) -> Option<&'static str> {
    match dialect {
        Comments::Prusa => Some(prusa(role)),
        Comments::Orca => Some(orca(role)),
        Comments::Bambu => Some(bambu(role)),
        Comments::Cura => Some(cura(role)),
        Comments::None => None,
    }
}

/// The role of what a start or end template prints. Cura has no word for it.
pub(super) fn custom(dialect: Comments) -> Option<&'static str> {
    match dialect {
        Comments::Prusa | Comments::Orca | Comments::Bambu => Some("Custom"),
        Comments::Cura | Comments::None => None,
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
        Role::Bridge | Role::InternalBridge => "Bridge infill",
        Role::Ironing => "Ironing",
        Role::Support => "Support material",
        Role::SupportInterface => "Support material interface",
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
        Role::InternalBridge => "Internal Bridge",
        Role::Ironing => "Ironing",
        Role::Support => "Support",
        Role::SupportInterface => "Support interface",
    }
}

/// The role's name in Bambu Studio. All names but these are OrcaSlicer's.
fn bambu(role: Role) -> &'static str {
    match role {
        Role::InternalBridge => "Bridge",
        _ => orca(role),
    }
}

fn cura(role: Role) -> &'static str {
    match role {
        Role::Skirt | Role::Brim => "SKIRT",
        Role::OuterWall | Role::Overhang => "WALL-OUTER",
        Role::InnerWall | Role::GapFill => "WALL-INNER",
        Role::SparseInfill => "FILL",
        Role::Support => "SUPPORT",
        Role::SupportInterface => "SUPPORT-INTERFACE",
        Role::InternalSkin
        | Role::BottomSkin
        | Role::TopSkin
        | Role::Bridge
        | Role::InternalBridge
        | Role::Ironing => "SKIN",
    }
}

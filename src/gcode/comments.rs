//! The comments that viewers and hosts read.
//!
//! In: roles. Out: the words of PrusaSlicer's dialect, which most readers
//! know: `;TYPE:` with a role's name, `;LAYER_CHANGE`, `;Z:`, `;HEIGHT:`,
//! `;WIDTH:`, and at the end of the file `; name = value` lines.
//!
//! Some viewers colour by words they find anywhere in a comment, so comments
//! of our own avoid the roles' words.

use crate::bead::Role;

/// What a start or end template prints is not the part.
pub(super) const CUSTOM: &str = "Custom";

/// Stands after the last layer: from the first `;LAYER_CHANGE` to here a file
/// can be joined with those of the part's other layers.
pub(super) const END_OF_LAYERS: &str = "; end of layers";

/// The role's name in PrusaSlicer's dialect.
pub fn role_name(role: Role) -> &'static str {
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

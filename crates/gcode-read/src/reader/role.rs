//! What a printed line is for, by the names slicers give it.
//!
//! The set is wider than [`isoslice_planar::bead::Role`]: other slicers print supports,
//! towers and more.

use isoslice_base::{named, pairs};

named! {
    /// What a line in a file is printed for.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Role {
        /// The wall that shows.
        OuterWall = "outer wall",
        /// Walls inside the outer wall.
        InnerWall = "inner wall",
        /// Walls that hang over the layer below.
        Overhang = "overhang",
        /// Thin places and gaps between walls.
        GapFill = "gap fill",
        /// Solid area facing upwards.
        TopSkin = "top skin",
        /// Solid area facing downwards, where the slicer tells it apart.
        BottomSkin = "bottom skin",
        /// Solid area inside, or solid area that is not told apart.
        Skin = "skin",
        /// Solid area over nothing.
        Bridge = "bridge",
        /// A pass over a finished top.
        Ironing = "ironing",
        /// Sparse fill.
        SparseInfill = "sparse infill",
        /// Supports.
        Support = "support",
        /// The parts of supports that touch the model.
        SupportInterface = "support interface",
        /// Loops on the bed, beside the part or round it.
        SkirtBrim = "skirt and brim",
        /// A tower for changing filaments.
        PrimeTower = "prime tower",
        /// What start, end and other templates print.
        Custom = "start and end",
        /// The file does not say.
        #[default]
        Unknown = "not labelled",
    }
}

impl Role {
    /// The role that PrusaSlicer, SuperSlicer, OrcaSlicer, BambuStudio or Cura
    /// calls `name`; [`Role::Unknown`] if none does.
    pub fn from_name(name: &[u8]) -> Role {
        let name = name.trim_ascii();
        let found = NAMES
            .iter()
            .find(|(known, _)| name.eq_ignore_ascii_case(known.as_bytes()));
        found.map_or(Role::Unknown, |(_, role)| *role)
    }

    /// True for all parts of supports.
    pub fn is_support(self) -> bool {
        matches!(self, Role::Support | Role::SupportInterface)
    }
}

/// What slicers call the roles. Sources: PrusaSlicer `ExtrusionRole.cpp`,
/// OrcaSlicer `ExtrusionEntity.cpp`, CuraEngine `gcodeExport.cpp`.
const NAMES: &[(&str, Role)] = pairs! {
    // PrusaSlicer, and what SuperSlicer adds.
    "External perimeter" => Role::OuterWall;
    "Perimeter", "Internal perimeter" => Role::InnerWall;
    "Overhang perimeter" => Role::Overhang;
    "Internal infill" => Role::SparseInfill;
    "Solid infill" => Role::Skin;
    "Top solid infill" => Role::TopSkin;
    "Ironing" => Role::Ironing;
    "Bridge infill", "Internal bridge infill" => Role::Bridge;
    "Gap fill", "Thin wall" => Role::GapFill;
    "Skirt/Brim" => Role::SkirtBrim;
    "Support material" => Role::Support;
    "Support material interface" => Role::SupportInterface;
    "Wipe tower" => Role::PrimeTower;
    "Custom" => Role::Custom;
    // OrcaSlicer and BambuStudio.
    "Outer wall" => Role::OuterWall;
    "Inner wall" => Role::InnerWall;
    "Overhang wall" => Role::Overhang;
    "Sparse infill" => Role::SparseInfill;
    "Internal solid infill", "Floating vertical shell" => Role::Skin;
    "Top surface" => Role::TopSkin;
    "Bottom surface" => Role::BottomSkin;
    "Bridge", "Internal Bridge" => Role::Bridge;
    "Gap infill" => Role::GapFill;
    "Skirt", "Brim" => Role::SkirtBrim;
    "Support" => Role::Support;
    "Support interface" => Role::SupportInterface;
    "Support transition" => Role::Support;
    "Prime tower" => Role::PrimeTower;
    // Cura.
    "WALL-OUTER" => Role::OuterWall;
    "WALL-INNER" => Role::InnerWall;
    "SKIN" => Role::Skin;
    "FILL" => Role::SparseInfill;
    "SUPPORT-INTERFACE" => Role::SupportInterface;
    "PRIME-TOWER" => Role::PrimeTower;
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_three_slicers_mean_the_same() {
        for names in [
            ["External perimeter", "Outer wall", "WALL-OUTER"],
            ["Perimeter", "Inner wall", "WALL-INNER"],
            ["Internal infill", "Sparse infill", "FILL"],
            ["Support material", "Support", "SUPPORT"],
            ["Skirt/Brim", "Skirt", "SKIRT"],
        ] {
            let roles = names.map(|name| Role::from_name(name.as_bytes()));
            assert_ne!(roles[0], Role::Unknown, "{names:?}");
            assert!(roles.iter().all(|r| *r == roles[0]), "{names:?}");
        }
        assert_eq!(Role::from_name(b"something new"), Role::Unknown);
        assert_eq!(Role::from_name(b"\xff"), Role::Unknown);
    }

    #[test]
    fn every_role_is_listed_once() {
        for (i, role) in Role::ALL.into_iter().enumerate() {
            assert_eq!(role as usize, i);
        }
    }
}

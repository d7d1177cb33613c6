//! The profiles that are part of the program: their texts, as they are in
//! `profiles/`.

/// What a profile is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProfileKind {
    /// A machine: bed, limits, retraction, firmware, start of the print.
    Printer,
    /// A material: temperatures, fan, flow, density, cost.
    Filament,
    /// A kind of print: heights, walls, infill.
    Preset,
}

impl ProfileKind {
    /// All kinds, in the order in which their settings are taken over.
    pub const ALL: [ProfileKind; 3] = [
        ProfileKind::Printer,
        ProfileKind::Filament,
        ProfileKind::Preset,
    ];

    /// The kind's word, which is also the option's.
    pub fn word(self) -> &'static str {
        match self {
            ProfileKind::Printer => "printer",
            ProfileKind::Filament => "filament",
            ProfileKind::Preset => "preset",
        }
    }

    /// The folder of the kind's files.
    pub fn folder(self) -> &'static str {
        match self {
            ProfileKind::Printer => "printers",
            ProfileKind::Filament => "filaments",
            ProfileKind::Preset => "presets",
        }
    }
}

use ProfileKind::{Filament, Preset, Printer};

macro_rules! shipped {
    ($($kind:ident, $folder:literal: $($name:literal)+;)+) => {
        &[$($((
            $kind,
            $name,
            include_str!(concat!("profiles/", $folder, "/", $name, ".toml")),
        ),)+)+]
    };
}

/// Kind, name and text of each profile.
pub(super) const SHIPPED: &[(ProfileKind, &str, &str)] = shipped! {
    Printer, "printers":
        "ender-3-s1"
        "ender-3-v2"
        "ender-3"
        "generic-klipper"
        "generic-marlin"
        "generic-rrf"
        "prusa-mini"
        "prusa-mk3s"
        "prusa-mk4"
        "prusa-xl"
        "ratrig-v-core-3-300"
        "ratrig-v-core-3-400"
        "ratrig-v-core-3-500"
        "sovol-sv06"
        "voron-0.2"
        "voron-2.4-250"
        "voron-2.4-300"
        "voron-2.4-350";
    Filament, "filaments":
        "abs"
        "asa"
        "pa"
        "pc"
        "petg"
        "pla"
        "pva"
        "tpu";
    Preset, "presets":
        "draft"
        "fine"
        "standard"
        "strong"
        "thin-wall";
};

//! The profiles that are part of the program: their texts, as they are in
//! `profiles/`, and those of printers with other nozzles.

isoslice_base::named! {
    /// The kind of a profile, in the order in which the settings are taken over.
    /// Its name is also the option's.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum ProfileKind {
        /// The profile describes a machine: bed, limits, retraction, firmware,
        /// start of the print.
        Printer = "printer",
        /// The profile describes a material: temperatures, fan, flow, density,
        /// cost.
        Filament = "filament",
        /// The profile describes a kind of print: heights, walls, infill.
        Preset = "preset",
    }
}

impl ProfileKind {
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

/// Printers that get profiles with nozzles other than 0.4 mm, each with its
/// description. After the colon are the maker's figures of pressure advance for
/// PLA with 0.25, 0.6 and 0.8 mm, if the printer has one for 0.4 mm: the wider
/// the nozzle, the less.
macro_rules! nozzles {
    ($($name:literal $what:literal
        $(: $small:literal $wide:literal $widest:literal)?;)+) => {
        &[$(
            nozzles!(@one $name $what "0.25" $($small)?),
            nozzles!(@one $name $what "0.6" $($wide)?),
            nozzles!(@one $name $what "0.8" $($widest)?),
        )+]
    };
    (@one $name:literal $what:literal $nozzle:literal $($advance:literal)?) => {
        (
            concat!($name, "-", $nozzle, "-nozzle"),
            concat!(
                "description = \"", $what, ", ", $nozzle, " mm nozzle\"\n",
                "inherits = \"", $name, "\"\n\n",
                "[printer]\nnozzle_diameter = ", $nozzle, "\n",
                $("\n[filament]\npressure_advance = ", $advance, "\n",)?
            ),
        )
    };
}

/// Name and text of each printer's profile with another nozzle.
pub(super) const NOZZLES: &[(&str, &str)] = nozzles! {
    "anycubic-kobra-2" "Anycubic Kobra 2";
    "bambu-a1" "Bambu Lab A1";
    "bambu-a1-mini" "Bambu Lab A1 mini";
    "bambu-p1s" "Bambu Lab P1S and P1P";
    "bambu-x1c" "Bambu Lab X1 Carbon";
    "creality-k1" "Creality K1 and K1C";
    "creality-k1-max" "Creality K1 Max";
    "elegoo-centauri-carbon" "Elegoo Centauri Carbon";
    "elegoo-neptune-4" "Elegoo Neptune 4 and 4 Pro";
    "ender-3" "Creality Ender-3 and Ender-3 Pro";
    "ender-3-s1" "Creality Ender-3 S1";
    "ender-3-v2" "Creality Ender-3 V2";
    "ender-3-v3" "Creality Ender-3 V3";
    "ender-3-v3-ke" "Creality Ender-3 V3 KE";
    "ender-3-v3-se" "Creality Ender-3 V3 SE";
    "generic-klipper" "Any printer with Klipper, 220 × 220 × 250 mm";
    "generic-marlin" "Any printer with Marlin 2, 220 × 220 × 250 mm";
    "generic-rrf" "Any printer with RepRapFirmware 3, 220 × 220 × 250 mm";
    "prusa-core-one" "Prusa CORE One";
    "prusa-mini" "Prusa MINI and MINI+": 0.2 0.12 0.06;
    "prusa-mk3s" "Prusa i3 MK3S and MK3S+": 0.05 0.04 0.01;
    "prusa-mk4" "Prusa MK4": "\"auto\"" "\"auto\"" "\"auto\"";
    "prusa-mk4s" "Prusa MK4S";
    "prusa-xl" "Prusa XL with one tool": "\"auto\"" "\"auto\"" "\"auto\"";
    "qidi-q1-pro" "Qidi Q1 Pro";
    "qidi-x-plus-3" "Qidi X-Plus 3";
    "ratrig-v-core-3-300" "RatRig V-Core 3, 300 mm";
    "ratrig-v-core-3-400" "RatRig V-Core 3, 400 mm";
    "ratrig-v-core-3-500" "RatRig V-Core 3, 500 mm";
    "sovol-sv06" "Sovol SV06";
    "sovol-sv08" "Sovol SV08";
    "voron-0.2" "Voron 0.2";
    "voron-2.4-250" "Voron 2.4, 250 mm";
    "voron-2.4-300" "Voron 2.4, 300 mm";
    "voron-2.4-350" "Voron 2.4, 350 mm";
    "voron-trident-300" "Voron Trident, 300 mm";
};

/// Kind, name and text of each profile.
pub(super) const SHIPPED: &[(ProfileKind, &str, &str)] = shipped! {
    Printer, "printers":
        "anycubic-kobra-2"
        "bambu-a1"
        "bambu-a1-mini"
        "bambu-p1s"
        "bambu-x1c"
        "creality-k1"
        "creality-k1-max"
        "elegoo-centauri-carbon"
        "elegoo-neptune-4"
        "ender-3"
        "ender-3-s1"
        "ender-3-v2"
        "ender-3-v3"
        "ender-3-v3-ke"
        "ender-3-v3-se"
        "generic-klipper"
        "generic-marlin"
        "generic-rrf"
        "prusa-core-one"
        "prusa-mini"
        "prusa-mk3s"
        "prusa-mk4"
        "prusa-mk4s"
        "prusa-xl"
        "qidi-q1-pro"
        "qidi-x-plus-3"
        "ratrig-v-core-3-300"
        "ratrig-v-core-3-400"
        "ratrig-v-core-3-500"
        "sovol-sv06"
        "sovol-sv08"
        "voron-0.2"
        "voron-2.4-250"
        "voron-2.4-300"
        "voron-2.4-350"
        "voron-trident-300";
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

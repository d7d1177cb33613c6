//! What the writer needs of the settings.

use isoslice_base::units::{
    Celsius, Mm, Mm2, MmPerSec, Seconds, cross_section, filament_area,
};
use isoslice_path::pace::limits;
use isoslice_path::pace::motion::Limits;
use isoslice_settings::{
    BrimPlace, Comments, Emit, Filament, Flavour, Key, Printer, Retract,
    Settings, Supports, Varying,
};

/// What a file says to the firmware, and in whose words.
#[derive(Clone, Debug)]
pub struct WriterPlan<'a> {
    /// All settings: templates may name any, and the file keeps them.
    all: &'a Settings,
    /// The texts of the templates for the start, for the end, and for a layer.
    pub(super) templates: [&'a str; 3],
    /// What the printer is and can do.
    pub(super) printer: &'a Printer,
    /// What is printed with, and how warm.
    pub(super) filament: &'a Filament,
    /// Thickness of the layer on the bed, and of those above it, mm.
    pub(super) layer_heights: [Mm; 2],
    /// Share of the inside that is filled, %; none if it differs from place to
    /// place.
    pub(super) infill_density: Option<f64>,
    /// Width of the brim, mm, in whole millimetres; 0 for none.
    pub(super) brim_width: Mm,
    /// True if tops are ironed.
    pub(super) ironing: bool,
    /// True if there may be supports.
    pub(super) supports: bool,
    /// The firmware.
    pub(super) flavour: Flavour,
    /// The slicer whose words the comments use.
    pub(super) comments: Comments,
    /// True if positions of the filament are relative to the last one.
    pub(super) relative_e: bool,
    /// True if the start sets the printer's limits.
    pub(super) sets_limits: bool,
    /// True if beads set accelerations; false if the start sets the only one.
    pub(super) sets_acceleration: bool,
    /// True if layers tell how far the print has come.
    pub(super) tells_progress: bool,
    /// True if parts have labels.
    pub(super) labels: bool,
    /// Which of Prusa's firmwares the printer has.
    pub(super) board: Board,
    /// Speed at which a right-angled corner is passed.
    pub(super) corner: MmPerSec,
    /// What the machine can do.
    pub(super) limits: Limits,
    /// Speed of travels.
    pub(super) travel_speed: MmPerSec,
    /// Lengths and speeds of retractions.
    pub(super) retract: &'a Retract,
    /// How long the filament's push runs ahead; none as the firmware has it.
    pub(super) pressure_advance: Option<Seconds>,
    /// Cross-section of the filament.
    pub(super) filament_area: Mm2,
    /// Temperatures of the nozzle on the first layer and above it; none above it
    /// if it differs from layer to layer.
    pub(super) nozzle_temperatures: (Celsius, Option<Celsius>),
    /// Temperatures of the bed on the first layer and above it; 0 for no
    /// heating.
    pub(super) bed_temperatures: [Celsius; 2],
    /// Cross-section of the thickest beads.
    pub(super) thickest: Mm2,
}

impl<'a> WriterPlan<'a> {
    /// The plan that settings ask for.
    pub fn of(s: &'a Settings) -> WriterPlan<'a> {
        let (gcode, printer, filament) = (&s.gcode, &s.printer, &s.filament);
        let (flavour, firmware) = (gcode.flavour, gcode.flavour.firmware());
        let board = Board::of(&printer.model);
        let wanted = |emit, auto| match emit {
            Emit::On => true,
            Emit::Off => false,
            Emit::Auto => auto,
        };
        WriterPlan {
            all: s,
            templates: [&gcode.start, &gcode.end, &gcode.layer],
            printer,
            filament,
            layer_heights: [s.bed_layer_height(), s.layer_height()],
            infill_density: s.infill_density.constant(),
            brim_width: match s.brim.place {
                BrimPlace::None => 0.0,
                _ => s.brim.width.ceil(),
            },
            ironing: s.ironing.is_on(),
            supports: s.supports != Supports::Off,
            flavour,
            comments: gcode.comments,
            relative_e: gcode.relative_e,
            sets_limits: gcode.set_limits,
            sets_acceleration: gcode.set_limits
                && (firmware.one_acceleration || s.acceleration.by_role()),
            tells_progress: wanted(gcode.progress, firmware.shows_progress),
            labels: wanted(gcode.labels, knows_labels(flavour, board)),
            board,
            corner: printer.square_corner_velocity,
            limits: limits(s),
            travel_speed: s.travel_speed(),
            retract: &s.retract,
            pressure_advance: filament.pressure_advance,
            filament_area: filament_area(filament.diameter),
            nozzle_temperatures: (
                s.first_layer_nozzle_temperature(),
                filament.nozzle_temperature.constant(),
            ),
            bed_temperatures: [
                s.first_layer_bed_temperature(),
                filament.bed_temperature,
            ],
            thickest: thickest(s),
        }
    }

    /// The value of a setting, as TOML.
    pub(super) fn value(&self, key: &Key) -> String {
        key.get(self.all)
    }

    /// The number that a setting stands for if it is a share or left to isoslice: mm,
    /// or °C.
    pub(super) fn number(&self, key: &Key) -> Option<f64> {
        key.length(self.all).or(match key.name {
            "filament.first_layer_nozzle_temperature" => {
                Some(self.nozzle_temperatures.0)
            }
            "filament.first_layer_bed_temperature" => {
                Some(self.bed_temperatures[0])
            }
            _ => None,
        })
    }

    /// The settings that differ from the defaults, as TOML.
    pub(super) fn changed(&self) -> String {
        self.all.changed()
    }

    /// True if parts' labels need the parts' outlines, as Klipper's do.
    pub fn needs_outline(&self) -> bool {
        self.labels && self.flavour.firmware().outlines_parts
    }

    #[cfg(test)]
    pub(super) fn with(
        change: impl FnOnce(&mut Settings),
    ) -> WriterPlan<'static> {
        isoslice_settings::testing::plan_with(
            |s| WriterPlan::of(Box::leak(Box::new(s.clone()))),
            change,
        )
    }
}

/// Which of Prusa's two firmwares a printer has, by what it calls itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Board {
    /// The settings do not say: the file has only commands that both know.
    Unknown,
    /// The 8-bit firmware, of printers up to the MK3S+.
    Old,
    /// The firmware of the MINI, which has linear advance, M900.
    Mini,
    /// The firmware of MK3.5, MK4, XL and CORE One, which has pressure advance,
    /// M572.
    Buddy,
}

impl Board {
    /// The firmware of a printer with this name.
    pub(super) fn of(model: &str) -> Board {
        let model = model.trim().to_uppercase();
        let later = ["MK3.5", "MK3.9"].iter().any(|m| model.starts_with(m));
        if model.is_empty() {
            Board::Unknown
        } else if model.starts_with("MINI") {
            Board::Mini
        } else if !later && ["MK2", "MK3"].iter().any(|m| model.starts_with(m))
        {
            Board::Old
        } else {
            Board::Buddy
        }
    }
}

/// True if a firmware is sure to understand labels. Marlin understands them only
/// if it was built with an option that is off by default. Prusa's 8-bit firmware
/// does not understand them.
fn knows_labels(flavour: Flavour, board: Board) -> bool {
    match flavour {
        Flavour::Klipper | Flavour::Rrf | Flavour::Bambu => true,
        Flavour::Marlin => false,
        Flavour::Prusa => matches!(board, Board::Buddy | Board::Mini),
    }
}

/// Cross-section of the thickest beads. Expressions count as 100 %.
fn thickest(s: &Settings) -> Mm2 {
    let constant = |v: &Varying| v.constant().unwrap_or(100.0) / 100.0;
    let flow = constant(&s.flow) * s.filament.flow / 100.0;
    let widen = constant(&s.bead_width);
    let thin = s.thin_max / 100.0;
    let height = s.thickest_layer().max(s.bed_layer_height());
    let widths = [
        s.outer_wall_width() * thin,
        s.inner_wall_width() * thin,
        s.top_skin_width(),
        s.skin_width() * (s.bridge_flow / 100.0).max(1.0),
        s.infill_width(),
    ];
    let width = widths.into_iter().fold(0.0, f64::max) * widen;
    flow * cross_section(width, height)
}

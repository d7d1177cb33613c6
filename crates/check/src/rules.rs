//! What a printer can do, and what a file must keep to.
//!
//! In: settings, or a plate whose parts have settings of their own. Out:
//! [`Rules`], which are numbers only, for any G-code.

use super::heat::HeatLimit;
use glam::{DVec2, DVec3};
use isoslice_base::units::{Celsius, Mm, Mm2, MmPerSec};
use isoslice_gcode_read::reader::{Heater, Role};
use isoslice_settings::{Flavour, HeadRoom, PlateSequence, Settings, keys};

/// Precision of the positions in a file, mm.
pub(super) const ROUNDING: Mm = 2e-3;

/// Pulled-back filament that does not count, since numbers are rounded and some
/// slicers push forward a little less.
const NOT_PRIMED: Mm = 0.1;

/// Filament that other slicers may push forward beyond what they pulled back, to
/// make up for what oozed; it makes a drop of a millimetre.
const MORE: Mm = 0.5;

/// What a printer can do, and what a file must keep to.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// Far corner of the bed; the near corner is zero.
    pub bed: DVec2,
    /// Greatest height of the nozzle.
    pub height: Mm,
    /// Diameter of the nozzle.
    pub nozzle: Mm,
    /// Diameter of the filament.
    pub filament_diameter: Mm,
    /// Greatest cross-section of a bead.
    pub cross_section: Mm2,
    /// Greatest length of filament pushed or pulled while the head stands.
    pub feed: Option<Mm>,
    /// Greatest length pulled back at a time.
    pub retraction: Mm,
    /// Filament that may be missing when a bead begins.
    pub missing: Mm,
    /// Filament that may be pushed beyond what was pulled back.
    pub prime: Mm,
    /// The least and the greatest flow, as shares.
    pub flow: [f64; 2],
    /// The least and the greatest width of usual lines.
    pub widths: [Mm; 2],
    /// Width of the widest walls by the settings, at least that of the nozzle.
    pub(crate) walls: Mm,
    /// Speed of travels.
    pub travel: MmPerSec,
    /// Height at which the file begins to print: 0 is the bed, and more if the
    /// file continues a part.
    pub base: Mm,
    /// Greatest speed in the plane.
    pub speed: MmPerSec,
    /// Greatest speed of the z axis.
    pub speed_z: MmPerSec,
    /// Least temperature of a nozzle that filament is pushed through.
    pub least_heat: Celsius,
    /// Greatest gap between supports and the part.
    pub gap: Mm,
    /// The firmware that reads the file.
    pub(crate) flavour: Flavour,
    /// What the head needs beside finished parts, if parts are printed one by
    /// one.
    pub(crate) head_room: Option<HeadRoom>,
    /// How hot the nozzle may be.
    pub(crate) nozzle_heat: HeatLimit,
    /// How hot the bed may be.
    pub(crate) bed_heat: HeatLimit,
    /// How hot the chamber may be.
    pub(crate) chamber_heat: HeatLimit,
}

impl Rules {
    /// The rules of the printer in the settings.
    pub fn new(settings: &Settings) -> Rules {
        let printer = &settings.printer;
        let nozzle = printer.nozzle_diameter;
        // Most firmware has no limit of the cross-section, but no nozzle lays
        // more than 8 squares of itself.
        let refuses = settings.gcode.flavour.firmware().refuses;
        let section = refuses.map_or(8.0, |r| r.section);
        let walls = nozzle
            .max(settings.outer_wall_width())
            .max(settings.inner_wall_width());
        Rules {
            bed: DVec2::new(printer.bed_x, printer.bed_y),
            height: printer.height,
            nozzle,
            filament_diameter: settings.filament.diameter,
            cross_section: section * nozzle * nozzle,
            feed: refuses.map(|r| r.feed),
            retraction: (2.0 * settings.retract.length).max(20.0),
            // A negative `retract.extra_prime` pushes forward less than was
            // pulled back.
            missing: NOT_PRIMED + (-settings.retract.extra_prime).max(0.0),
            prime: MORE + settings.retract.extra_prime.max(0.0),
            flow: spread(flow(settings), settings),
            widths: spread(widths(settings), settings),
            walls: spread([walls; 2], settings)[1],
            travel: settings.travel_speed(),
            base: 0.0,
            speed: printer.max_speed,
            speed_z: printer.max_speed_z,
            least_heat: settings.min_nozzle_temperature(),
            gap: settings.support.z_gap.max(settings.support.z_gap_bottom),
            flavour: settings.gcode.flavour,
            head_room: match settings.plate.sequence {
                PlateSequence::OneByOne => printer.head_room(),
                PlateSequence::AllAtOnce => None,
            },
            // If the printer's own limits are not set, these hold: what usual
            // hot ends, beds and chambers bear, and what hardly any bears.
            nozzle_heat: HeatLimit::new(
                "printer.max_nozzle_temperature",
                printer.max_nozzle_temperature,
                300.0,
                settings.max_nozzle_temperature(),
            ),
            bed_heat: HeatLimit::new(
                "printer.max_bed_temperature",
                printer.max_bed_temperature,
                120.0,
                settings.max_bed_temperature(),
            ),
            chamber_heat: HeatLimit::new(
                "printer.max_chamber_temperature",
                printer.max_chamber_temperature,
                80.0,
                150.0,
            ),
        }
    }

    /// The rules of a plate's printer. Parts may have flows, widths and supports
    /// of their own, and each bead may be of any part.
    pub fn of_plate<'a>(
        plate: &Settings,
        parts: impl Iterator<Item = &'a Settings>,
    ) -> Rules {
        let of_any = parts.map(Rules::new).reduce(|a, b| Rules {
            flow: both(a.flow, b.flow),
            widths: both(a.widths, b.widths),
            walls: a.walls.max(b.walls),
            gap: a.gap.max(b.gap),
            ..a
        });
        let of_plate = Rules::new(plate);
        match of_any {
            Some(any) => Rules {
                flow: any.flow,
                widths: any.widths,
                walls: any.walls,
                gap: any.gap,
                ..of_plate
            },
            None => of_plate,
        }
    }

    /// Width of a usual bead of this role, at least that of the nozzle. Walls may be
    /// wider than anything else.
    pub(super) fn usual_width(&self, role: Role) -> Mm {
        match role {
            Role::OuterWall
            | Role::InnerWall
            | Role::Overhang
            | Role::Unknown => self.walls,
            _ => self.nozzle,
        }
    }

    /// How hot a heater may be, and the heater's name.
    pub(super) fn heat(&self, heater: Heater) -> (&HeatLimit, &'static str) {
        match heater {
            Heater::Nozzle(_) => (&self.nozzle_heat, "nozzle"),
            Heater::Bed => (&self.bed_heat, "bed"),
            Heater::Chamber => (&self.chamber_heat, "chamber"),
        }
    }

    /// True if the head can go to `p`, give or take `margin` in the plane.
    pub(super) fn reach(&self, p: DVec3, margin: Mm) -> bool {
        let low = DVec3::new(-margin, -margin, -ROUNDING);
        let high = self.bed.extend(self.height);
        let high = high + DVec3::new(margin, margin, ROUNDING);
        !(p.cmplt(low).any() || p.cmpgt(high).any())
    }
}

/// The range that holds two others.
fn both([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.min(c), b.max(d)]
}

/// A range of what beads have, for beads that `bead_width` makes narrower or wider
/// where they lie. An expression may ask for all that the setting takes.
fn spread([least, most]: [f64; 2], settings: &Settings) -> [f64; 2] {
    let share = settings.bead_width.constant();
    let [narrow, wide] = share.map_or_else(any_bead_width, |share| [share; 2]);
    [
        least * (narrow / 100.0).min(1.0),
        most * (wide / 100.0).max(1.0),
    ]
}

/// The least and the greatest share of a width that `bead_width` takes, per cent.
fn any_bead_width() -> [f64; 2] {
    let key = keys().iter().find(|key| key.name == "bead_width");
    let range = key.and_then(|key| key.range);
    range.map_or([0.0, f64::INFINITY], |range| [range.min, range.max])
}

/// The least and the greatest flow of beads with these settings, as shares. An
/// expression may ask for any.
fn flow(settings: &Settings) -> [f64; 2] {
    let own = settings.filament.flow / 100.0;
    match settings.flow.constant() {
        Some(flow) => [own * flow / 100.0; 2],
        None => [0.0, f64::INFINITY],
    }
}

/// The least and the greatest width of usual lines: 1 to 2.5 nozzles, or what the
/// settings ask for beyond that.
fn widths(settings: &Settings) -> [Mm; 2] {
    let nozzle = settings.printer.nozzle_diameter;
    let thin = settings.thin_max / 100.0;
    let lines = [
        settings.outer_wall_width() * thin,
        settings.inner_wall_width() * thin,
        settings.top_skin_width(),
        settings.skin_width(),
        settings.infill_width(),
    ];
    let least = lines.into_iter().fold(nozzle, f64::min);
    let most = lines.into_iter().fold(2.5 * nozzle, f64::max);
    [least, most]
}

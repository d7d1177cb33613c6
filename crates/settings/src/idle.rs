//! Why settings that were asked for have no effect. Each row of the table names
//! the reasons that may deprive its setting of it.

use super::value::round;
use super::{
    BrimPlace, ByNozzle, DraftShield, InfillMode, LayerHeights, Settings,
    SkinPattern, Supports, Varying, WallOrder,
};

/// A reason for a setting's having no effect: the rest of the sentence that
/// begins with the setting's name, if the reason is given. The text is the
/// setting's value.
pub(super) type Reason = fn(&Settings, &str) -> Option<String>;

/// Heights that differ by less than this count as equal, mm.
const ROUNDED: f64 = 1e-6;

/// Declares reasons.
macro_rules! reasons {
    (
        |$s:ident, $value:ident|
        $($name:ident if $idle:expr => $rest:literal $(, $what:expr)*;)+
    ) => {$(
        pub(super) fn $name($s: &Settings, $value: &str) -> Option<String> {
            let _ = $value;
            ($idle).then(|| format!($rest $(, $what)*))
        }
    )+};
}

reasons! {
    |s, value|

    // Heights.
    own_heights if !s.is_uniform() && !by_uniform_height(s) =>
        " has no effect, since layer_heights gives each layer a height of its \
         own, between layer_height_min and layer_height_max; set these, or \
         layer_heights to \"uniform\"";
    uniform if s.is_uniform() =>
        " has no effect, since layer_heights = uniform makes all layers as high \
         as layer_height; set layer_heights to \"adaptive\"";
    on_a_raft if s.raft.layers > 0 =>
        " has no effect, since the part stands on a raft (raft.layers = {}) and \
         not on the bed; leave one of them out", s.raft.layers;

    // Vases.
    above_flat_layers if s.is_vase() =>
        " has no effect above the flat layers, since spiral prints plain walls \
         there, as many as it says; leave one of them out";
    in_a_vase if s.is_vase() =>
        " has no effect, since spiral prints flat layers and plain walls only; \
         leave one of them out";
    order_in_a_vase if s.is_vase() && spares_overhangs(s) =>
        " has no effect on overhangs, since spiral prints flat layers and plain \
         walls only; leave one of them out";

    // Walls.
    no_fewer_walls if top_walls(s) && s.top_walls >= Some(s.walls) =>
        " = {value} has no effect, since walls = {}, which is no more", s.walls;
    interlocked if top_walls(s) && s.top_walls < Some(s.walls) && s.interlocks()
        => " = {value} has no effect, since walls_interlocked = true leads each \
            wall along those of the layers beside it; leave one of them out";
    walls_of_the_field
        if top_walls(s) && s.top_walls < Some(s.walls) && !s.interlocks() =>
        " = {value} has no effect, since wall_offset = \"field\" takes all walls \
         from the expression; set it to \"distance\"";
    nothing_to_interlock if interlocking(s) && s.walls < 2 =>
        " = true has no effect, since walls is less than 2, and the outer wall \
         stays in its layer; set walls to 3 or more";
    contoured if interlocking(s) && s.walls >= 2 && !s.contour_z.is(0.0) =>
        " = true has no effect, since contour_z leads walls along the surface; \
         leave one of them out";
    too_high_to_interlock
        if interlocking(s)
            && s.walls >= 2
            && s.contour_z.is(0.0)
            && s.highest_interlocked() > s.printer.nozzle_diameter =>
        " = true has no effect, since the highest beads of such walls, one and a \
         half layers, would be {} mm high, and the nozzle is {} mm wide; lower \
         layer_height, first_layer_height or layer_height_max",
        round(s.highest_interlocked()), s.printer.nozzle_diameter;
    no_scarf_in_a_vase if rising(s) && s.is_vase() =>
        " rises nowhere, since spiral prints walls without seams; leave one of \
         them out";
    level_scarf if rising(s) && !s.is_vase() && !s.contour_z.is(0.0) =>
        " rises nowhere, since contour_z leads walls along the surface, where a \
         scarf stays level; leave one of them out";
    no_end_of_a_scarf
        if s.seam_scarf.length > 0.0
            && s.scarf_rises()
            && s.seam_gap >= s.seam_scarf.length =>
        " = {value} mm takes away all of the scarf's end (seam_scarf = {} mm), so \
         nothing covers its beginning, which rises from below; lower seam_gap, \
         or set seam_scarf = {0}", s.seam_scarf.length;
    no_overhangs
        if s.overhang_share >= 100.0
            && (value == "true"
                || value == WallOrder::OuterFirstUnlessOverhang.name()) =>
        " = {value} has no effect, since overhang_share = 100% leaves no wall \
         that counts as an overhang; lower it";

    no_inner_walls if without_inner_walls(s) =>
        " has no effect, since walls = {} prints no inner wall; set walls to 2 or \
         more", s.walls;
    no_single_overhangs
        if s.overhang_share >= 100.0 && s.speed.overhang.same().is_some() =>
        " has no effect, since overhang_share = 100% leaves no wall that counts \
         as an overhang; lower it";

    // Skin.
    no_top_skin if s.top_layers() == 0 && !s.is_solid() =>
        " has no effect, since top_layers = 0 prints no solid tops; set it to 1 \
         or more";
    no_bridges if !s.bridges() && s.raft.layers == 0 =>
        " has no effect, since bridge_max = 0 prints no bridges; set it to the \
         longest one that your printer can print, 10 mm say";
    no_tops if s.ironing.is_on() && s.top_layers() == 0 =>
        " has no effect without solid tops; set top_layers to more than 0";
    not_ironed if !s.ironing.is_on() =>
        " has no effect, since ironing = false irons nothing; set it to true";
    swept_above_only if unordered_below(s) =>
        " = {value} has no effect on skin that does not face upwards, whose lines \
         are never swept; write lines there";
    no_wall_beside if s.skin_wall_overlap > 0.0 && s.walls == 0 =>
        " has no effect, since walls = 0 leaves none to reach into; set walls to \
         1 or more";
    no_internal_bridges if !s.internal_bridges.is_on() =>
        " has no effect, since internal_bridges = false prints no internal \
         bridges; set it to true";
    unheld_internal_bridges if unheld(s) =>
        " has no effect, since the ends of internal bridges need walls; set \
         walls to 1 or more";
    unheld_ends if unheld(s) =>
        " has no effect, since the ends of bridges need walls; set walls to 1 or \
         more";
    steps_stay if s.contour_z.is(0.0) =>
        " has no effect, since contour_z = 0% leaves the layers' steps; set \
         contour_z to 100";
    nozzle_too_flat
        if !s.contour_z.is(0.0)
            && s.contour_z_full_angle().at(s.thickest_layer())
                < s.contour_z_angle =>
        " = {value}° has no effect beyond {}° in layers of {} mm, where the \
         nozzle's flat end ({} mm) cuts as deep into the lines beside as they \
         bear; set printer.nozzle_flat if yours is smaller",
        round(s.contour_z_full_angle().at(s.thickest_layer())),
        round(s.thickest_layer()), round(s.nozzle_flat());

    nothing_to_bridge if s.internal_bridges.is_on() && s.is_solid() =>
        " has no effect, since infill_density = 100% leaves no sparse infill to \
         bridge; leave one of them out";

    // Infill.
    no_sparse_infill if s.is_solid() || s.is_hollow() =>
        " has no effect, since infill_density = {}% prints no sparse infill; set \
         it between 0 and 100", density(s);
    nothing_runs_along
        if (s.is_solid() || s.is_hollow())
            && s.supports == Supports::Off
            && s.raft.layers == 0
            && !s.skin_follows_infill() =>
        " has no effect, since infill_density = {}% prints no sparse infill; the \
         lines of skin have skin_angle", density(s);
    infill_of_a_pattern
        if s.infill_is_pattern() && s.infill_mode != InfillMode::Surface =>
        " has no effect: it says what an expression of infill is, and infill is \
         a pattern; set infill to \"expr: ...\"";
    dense_by_expression if !s.infill_is_pattern() =>
        " has no effect: it is for patterns, and infill is an expression of its \
         own; make its lines lie closer or farther apart, or set infill to a \
         pattern";
    turned_by_expression
        if !s.infill_is_pattern() && s.infill_mode == InfillMode::Surface =>
        " has no effect: it is for patterns, and infill is an expression of its \
         own; turn x and y in it, or set infill to a pattern";

    // Fuzzy skin.
    smooth if s.fuzzy.thickness.is(0.0) =>
        " has no effect, since fuzzy.thickness = 0 leaves walls smooth; set it to \
         0.3, say";

    // Supports, rafts, and what stands beside a part.
    no_dense_layers
        if s.supports == Supports::Off || s.support.interface_layers == 0 =>
        " has no effect without dense layers of supports; set supports to \
         \"auto\" or \"plate\", and support.interface_layers to 1 or more";
    no_supports if s.supports == Supports::Off =>
        " has no effect, since supports = off prints none; set supports to \
         \"auto\" or \"plate\"";
    nothing_below if s.supports == Supports::Off && s.raft.layers == 0 =>
        " has no effect, since neither supports nor a raft are printed; set \
         supports to \"auto\" or \"plate\"";
    no_raft if s.raft.layers == 0 =>
        " has no effect, since raft.layers = 0 prints no raft; set it to 3, say";
    no_brim if s.brim.place == BrimPlace::None =>
        " has no effect, since brim.place = none prints no brim; set it to \
         \"outer\"";
    no_ears if s.brim.place != BrimPlace::Ears =>
        " has no effect, since brim.place = {} makes no ears; set it to \"ears\"",
        s.brim.place.name();
    shield_too_low
        if matches!(s.draft_shield, DraftShield::UpTo(height)
            if height < s.bed_layer_height() - ROUNDED) =>
        " = {value} mm has no effect, since it is less than the first layer's \
         height of {} mm: no layer has it; set it to that or more, or to \
         \"full\"", round(s.bed_layer_height());
    no_skirt if s.skirt.loops == 0 && s.draft_shield == DraftShield::Off =>
        " has no effect, since skirt.loops = 0 prints no skirt; set it to 1";
    shielded if s.draft_shield != DraftShield::Off =>
        " has no effect, since the draft shield takes the skirt's place; set \
         draft_shield to \"off\"";

    // Speeds, cooling, retraction.
    faster_than_all if s.speed.first_layer > fastest(s) =>
        " = {value} mm/s is more than any printing speed, so it limits nothing: \
         the first layer is printed at up to {} mm/s; lower it, or raise the \
         others", fastest(s);
    no_slowing
        if s.cooling.min_speed > fastest(s) && s.cooling.min_layer_time > 0.0 =>
        " = {value} mm/s is more than any printing speed, so no layer can be \
         slowed down to take cooling.min_layer_time; lower it";
    never_slowed if s.cooling.min_layer_time == 0.0 =>
        " has no effect, since cooling.min_layer_time = 0 slows no layer down; \
         give it a time, 8 s say";
    fan_still_off
        if (1..=s.cooling.fan_off_layers).contains(&s.cooling.full_fan_layer) =>
        " = {value} has no effect, since the fan is off on the first \
         cooling.fan_off_layers = {} layers; set it to a later one",
        s.cooling.fan_off_layers;
    no_layers_between
        if s.cooling.long_layer_time <= s.cooling.min_layer_time =>
        " = {value} s is not more than cooling.min_layer_time = {} s, so there \
         is nothing between short and long layers; raise it",
        s.cooling.min_layer_time;
    no_retraction if s.retract.length == 0.0 && value.parse() != Ok(0.0) =>
        " = {value} mm has no effect, since retract.length = 0 turns retraction \
         off; give it a length, 0.8 mm say";
    never_retracted if s.retract.length == 0.0 && value.parse() != Ok(0.0) =>
        " has no effect, since retract.length = 0 turns retraction off; give it a \
         length, 0.8 mm say";
    never_wiped
        if s.retract.length > 0.0
            && s.retract.wipe == 0.0
            && s.retract.before_wipe > 0.0 =>
        " has no effect, since retract.wipe = 0 wipes nothing; give it a length, \
         1 mm say";
    limits_of_the_printer if !s.gcode.set_limits && s.acceleration.by_role() =>
        " = false keeps the accelerations by role from the printer: they only \
         count for the estimate; set it to true, or the accelerations to 0";
}

/// True if something goes by the height of uniform layers though layers have
/// heights of their own: rafts and supports, the steps, or a bound.
fn by_uniform_height(s: &Settings) -> bool {
    let bounds = s.layer_height_min()..s.layer_height_max();
    s.raft.layers > 0
        || s.supports != Supports::Off
        || s.layer_heights == LayerHeights::Adaptive(ByNozzle::Auto)
        || s.layer_height() <= bounds.start
        || bounds.end <= s.layer_height()
}

fn spares_overhangs(s: &Settings) -> bool {
    s.wall_order == WallOrder::OuterFirstUnlessOverhang
}

/// True if tops are to have fewer walls and do not.
fn top_walls(s: &Settings) -> bool {
    s.top_walls.is_some() && !s.is_vase() && s.top_walls() == s.walls
}

fn interlocking(s: &Settings) -> bool {
    s.walls_interlocked && !s.is_vase()
}

/// True if no part has a wall behind its outer one. A vase has as many walls as
/// spiral says, and infill that is a shape has walls of its own.
fn without_inner_walls(s: &Settings) -> bool {
    s.walls < 2 && !s.is_vase() && s.infill_mode == InfillMode::Surface
}

/// The share of the inside that is printed, 0 or 100 %.
fn density(s: &Settings) -> f64 {
    s.infill_density.constant().unwrap_or_default()
}

/// True if a scarf is to rise.
fn rising(s: &Settings) -> bool {
    s.seam_scarf.length > 0.0 && s.seam_scarf.start < 100.0
}

/// True if lines that are never swept are to be unordered, but not those of tops.
fn unordered_below(s: &Settings) -> bool {
    let of = &s.skin_pattern;
    let [top, rest @ ..] = [of.top, of.bottom, of.internal]
        .map(|pattern| pattern == SkinPattern::UnorderedLines);
    !top && rest.contains(&true)
}

/// True if no wall holds the ends of internal bridges.
fn unheld(s: &Settings) -> bool {
    s.internal_bridges.is_on() && s.walls == 0 && !s.is_vase()
}

/// The greatest printing speed, mm/s.
fn fastest(s: &Settings) -> f64 {
    let speed = &s.speed;
    let all = [
        &speed.outer_wall,
        &speed.inner_wall,
        &speed.gap_fill,
        &speed.sparse_infill,
        &speed.internal_skin,
        &speed.top_skin,
        &speed.bottom_skin,
    ];
    all.into_iter()
        .map(|speed| Varying::constant(speed).unwrap_or(f64::INFINITY))
        .fold(speed.skirt, f64::max)
}

#[cfg(test)]
mod tests {
    use crate::Builder;

    /// What is warned of, of the last of some assignments.
    fn told(assignments: &[&str]) -> Vec<String> {
        let mut builder = Builder::new();
        for assignment in assignments {
            builder.set(assignment).unwrap_or_else(|e| panic!("{e}"));
        }
        let last = assignments.last().and_then(|last| last.split_once('='));
        let (key, _) = last.unwrap_or_default();
        let (_, mut warnings) = builder.finish().unwrap();
        warnings.retain(|w| w.starts_with(&format!("{key} has no effect")));
        warnings
    }

    #[test]
    fn what_another_setting_turns_off_is_told() {
        for (other, on, given) in [
            ("walls=1", "walls=2", "wall_order=outer-first"),
            ("walls=1", "walls=2", "speed.inner_wall=50"),
            ("top_layers=0", "top_layers=1", "top_skin_width=0.4"),
            ("bridge_max=0", "bridge_max=5", "bridge_flow=90"),
            ("infill_density=100", "infill_density=99", "infill=gyroid"),
            ("infill_density=0", "infill_density=1", "infill=gyroid"),
            ("infill_density=100", "infill_density=99", "infill_angle=10"),
            (
                "infill_density=0",
                "infill_density=1",
                "speed.sparse_infill=50",
            ),
            (
                "infill_density=100",
                "infill_density=99",
                "internal_bridges=true",
            ),
            (
                "overhang_share=100",
                "overhang_share=99",
                "speed.overhang=10",
            ),
            (
                "cooling.min_layer_time=0",
                "cooling.min_layer_time=5",
                "cooling.min_speed=5",
            ),
            ("retract.length=0", "retract.length=1", "retract.wipe=1"),
            ("retract.length=0", "retract.length=1", "retract.speed=30"),
            ("retract.wipe=0", "retract.wipe=1", "retract.before_wipe=50"),
        ] {
            assert_eq!(told(&[other, given]).len(), 1, "{other} {given}");
            assert_eq!(told(&[on, given]), [""; 0], "{on} {given}");
        }
        // Some have other effects.
        let supported = ["supports=auto", "infill_density=100"];
        for given in [
            &["infill_density=100", "raft.layers=2", "infill_angle=10"][..],
            &[supported[0], supported[1], "infill_angle=10"],
            &["bridge_max=0", "raft.layers=2", "bridge_flow=90"],
            &["overhang_share=100", "speed.overhang=25: 30, 100: 10"],
            &["walls=1", "spiral=3", "speed.inner_wall=50"],
        ] {
            assert_eq!(told(given), [""; 0], "{given:?}");
        }
    }

    #[test]
    fn minus_zero_asks_for_nothing() {
        let warnings = |hop: &str| {
            let mut builder = Builder::new();
            builder.set("retract.length=0").unwrap();
            builder.set(&format!("retract.z_hop={hop}")).unwrap();
            let (_, warnings) = builder.finish().unwrap();
            let of_hop = |w: &&String| w.contains("retract.z_hop");
            warnings.iter().filter(of_hop).count()
        };
        assert_eq!([warnings("0.4"), warnings("0"), warnings("-0")], [1, 0, 0]);
    }
}

//! The features: each with a small part on which it shows, in thick layers.

/// A feature, and a part that is printed with it.
pub struct Feature {
    pub name: &'static str,
    /// The part. It is sound at the places where it is cut.
    pub part: &'static str,
    pub set: &'static [&'static str],
    /// The settings for the part turned by a right angle, if they are others than
    /// those of all parts. None if the feature has a direction of its own.
    pub turned: Option<&'static [&'static str]>,
}

/// A block with a hole and a step.
const BLOCK: &str = "max(min(max(max(abs(x) - 6.5, abs(y) - 5), z - 2.7), \
                     max(max(abs(x - 2) - 4, abs(y) - 4), z - 4.5)), \
                     max(1.6 - sqrt((x - 2)^2 + y^2), -z))";
/// A prism of five sides that leans a little, without a hole.
const PRISM: &str = "max(max(max(abs(x) - 6, abs(y) - 5 - 0.2*z), x + y - 7), \
                     max(-z, z - 4.5))";
/// A block under a dome.
const DOME: &str = "max(max(max(abs(x) - 6, abs(y) - 5), -z), \
                    sqrt(x^2 + y^2 + (z + 8)^2) - 12)";
/// A table on one leg.
const TABLE: &str = "max(min(max(abs(x) - 6, max(abs(y) - 5, 3 - z)), \
                     max(abs(x) - 2.5, abs(y) - 2.5)), max(-z, z - 4.5))";
/// A doorway.
const DOORWAY: &str = "max(max(max(abs(x) - 7, abs(y) - 5), max(-z, z - 4.5)), \
                       min(4 - abs(x), 2.4 - z))";
/// A plate with many thin pins.
const PINS: &str = "max(max(max(abs(x) - 6.5, abs(y) - 4.5), max(-z, z - 4.2)), \
                    min(z - 1.2, sqrt((mod(x + 20.5, 3) - 1.5)^2 \
                    + (mod(y + 21.5, 3) - 1.5)^2) - 0.9))";
/// A tube.
const TUBE: &str = "max(max(sqrt(x^2 + y^2) - 6, 4.2 - sqrt(x^2 + y^2)), \
                    max(-z, z - 4.5))";

const fn on(
    part: &'static str,
    name: &'static str,
    set: &'static [&'static str],
) -> Feature {
    Feature {
        name,
        part,
        set,
        turned: Some(&[]),
    }
}

const fn turned(turned: &'static [&'static str], feature: Feature) -> Feature {
    Feature {
        turned: Some(turned),
        ..feature
    }
}

const fn directed(feature: Feature) -> Feature {
    Feature {
        turned: None,
        ..feature
    }
}

pub static FEATURES: &[Feature] = &[
    on(BLOCK, "the defaults", &[]),
    on(BLOCK, "grid infill", &["infill=grid", "infill_density=30"]),
    directed(on(
        BLOCK,
        "triangles",
        &["infill=triangles", "infill_density=30"],
    )),
    directed(on(
        BLOCK,
        "hexagons",
        &["infill=hexagons", "infill_density=30"],
    )),
    directed(on(
        BLOCK,
        "cubic infill",
        &["infill=cubic", "infill_density=30"],
    )),
    directed(on(BLOCK, "gyroid", &["infill=gyroid", "infill_density=30"])),
    on(
        BLOCK,
        "rings of infill",
        &["infill=concentric", "infill_density=30"],
    ),
    turned(
        &["infill_density=expr: 15 + 40*exp(-d) + y"],
        on(
            BLOCK,
            "graded infill",
            &["infill_density=expr: 15 + 40*exp(-d) + x"],
        ),
    ),
    on(
        BLOCK,
        "infill that is a solid",
        &[
            "infill=expr: abs(mod(x + y + 50, 4) - 2) - 1",
            "infill_mode=solid",
        ],
    ),
    on(PRISM, "a vase", &["spiral=true"]),
    on(PRISM, "a vase of two walls", &["spiral=2"]),
    on(DOME, "adaptive layers", &["layer_heights=adaptive"]),
    on(
        DOME,
        "layers by formula",
        &["layer_heights=expr: 0.2 + 0.02*z"],
    ),
    on(
        DOME,
        "raised beads",
        &["contour_z=100", "contour_z_angle=30"],
    ),
    on(
        DOME,
        "raised ironing",
        &["contour_z=100", "ironing=true", "contour_z_angle=30"],
    ),
    on(BLOCK, "ironing", &["ironing=true"]),
    on(BLOCK, "scarves that rise", &["seam_scarf=8 from 10%"]),
    on(
        BLOCK,
        "walls that interlock",
        &["walls_interlocked=true", "walls=3"],
    ),
    on(BLOCK, "one wall", &["walls=1"]),
    on(BLOCK, "no walls", &["walls=0"]),
    on(BLOCK, "walls around tops", &["walls=3", "top_walls=1"]),
    on(
        BLOCK,
        "rings of skin",
        &["skin_pattern=top: concentric, bottom: concentric"],
    ),
    on(TUBE, "a thin tube", &["walls=2"]),
    on(
        PINS,
        "thin pins",
        &["retract.z_hop=0.3", "travel.combing=off"],
    ),
    on(TABLE, "supports", &["supports=auto"]),
    on(
        TABLE,
        "columns of supports",
        &["supports=plate", "support.style=grid"],
    ),
    on(BLOCK, "a raft", &["raft.layers=3"]),
    on(BLOCK, "arcs", &["gcode.arcs=true"]),
    directed(on(BLOCK, "fuzzy walls", &["fuzzy.thickness=0.2"])),
    on(BLOCK, "a brim", &["brim.place=both", "brim.width=2"]),
    on(
        BLOCK,
        "ears and two skirts",
        &["brim.place=ears", "brim.width=2", "skirt.loops=2"],
    ),
    on(BLOCK, "a draft shield", &["draft_shield=full"]),
    on(
        PINS,
        "hops and wipes",
        &[
            "retract.z_hop=0.4",
            "retract.z_hop_when=always",
            "retract.wipe=2",
            "retract.when_crossing=false",
        ],
    ),
    on(BLOCK, "combing everywhere", &["travel.combing=everywhere"]),
    on(
        BLOCK,
        "combing over infill",
        &[
            "travel.combing=within-infill",
            "retract.hidden=sparse-infill",
        ],
    ),
    on(DOORWAY, "bridges", &["bridge_flow=90"]),
    on(BLOCK, "internal bridges", &["internal_bridges=2"]),
    turned(
        &["seam=expr: y - x/2"],
        on(BLOCK, "seams by formula", &["seam=expr: x + y/2"]),
    ),
    directed(on(
        BLOCK,
        "seams at random",
        &["seam=random", "seam_gap=0.2"],
    )),
    turned(
        &["flow=expr: 100 + 2*y", "speed.outer_wall=expr: 30 - 2*x"],
        on(
            BLOCK,
            "flow and speed by formula",
            &["flow=expr: 100 + 2*x", "speed.outer_wall=expr: 30 + 2*y"],
        ),
    ),
    turned(
        &["bead_width=expr: 100 + 2*y + z"],
        on(
            BLOCK,
            "widths by formula",
            &["bead_width=expr: 100 + 2*x + z"],
        ),
    ),
    on(BLOCK, "outlines moved", &["xy_compensation=0.1"]),
    on(
        BLOCK,
        "outlines moved by curvature",
        &["xy_compensation=expr: 0.05*min(curvature, 0)"],
    ),
    on(
        BLOCK,
        "a first layer drawn in",
        &["elephant_foot=0.2 over 3 layers"],
    ),
    on(BLOCK, "an even flow", &["filament.max_flow_change=50"]),
    on(BLOCK, "the outer wall first", &["wall_order=outer-first"]),
    on(BLOCK, "firmware retraction", &["retract.firmware=true"]),
    on(
        TABLE,
        "overhangs by steps",
        &[
            "speed.overhang=10: 100%, 50: 30, 100: 10",
            "wall_order=outer-first-unless-overhang",
            "overhang_reverse=true",
        ],
    ),
    on(BLOCK, "skin at the ends", &["skin_where=ends"]),
];

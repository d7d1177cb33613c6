//! Every setting: its default, its range and what it means.
//!
//! A row is
//!
//! ```text
//! /// Description.
//! name: Type = default, in least..=greatest, idle reason | reason;
//! ```
//!
//! and the unit is the type's. The reasons of `idle` are those for which the
//! setting may have no effect. The structs, the names in files and on the
//! command line, reading and writing all follow from the rows by the macro in
//! `table`.

use super::table;
use super::words::*;
use super::{
    ByNozzle, DraftShield, ElephantFoot, HeadClearance, Infill, InfillMode,
    InterfacePattern, LayerHeights, LineDensity, OverhangFan, OverhangSpeed,
    Scarf, Shell, Sizes, SkinPatterns, SwitchOr, Varying,
};
use isoslice_base::units::*;

table::settings! {
    /// Everything a print depends on besides the model.
    Settings {
        ["Layers"]
        /// Height of every layer above the first; auto is 50% of the nozzle's
        /// diameter.
        layer_height: ByNozzle = ByNozzle::Auto, in 0.02..=2.0,
            idle own_heights;
        /// Height of the first layer; auto is 50% of the nozzle's diameter.
        first_layer_height: ByNozzle = ByNozzle::Auto, in 0.02..=2.0,
            idle on_a_raft;
        /// How high the layers above the first are: uniform, as layer_height
        /// says, or adaptive, each as high as the steps on the surface allow.
        /// These are at most layer_height, measured across the surface, or the
        /// step behind the word, as in "adaptive 0.1 mm". Where layers would
        /// have to be lower than layer_height_min, steps are greater. An
        /// expression of z gives the height at each height. Unless they are
        /// uniform, layers end exactly at level faces and at the part's top.
        layer_heights: LayerHeights = LayerHeights::Uniform;
        /// Least height of layers that are not uniform. A layer that ends at a
        /// level face may be half as high. auto is 20% of the nozzle's
        /// diameter, or layer_height if that is less.
        layer_height_min: ByNozzle = ByNozzle::Auto, in 0.02..=2.0,
            idle uniform;
        /// Greatest height of layers that are not uniform; auto is 75% of the
        /// nozzle's diameter, or layer_height if that is more.
        layer_height_max: ByNozzle = ByNozzle::Auto, in 0.02..=2.0,
            idle uniform;

        ["Outlines"]
        /// Greatest distance between an outline and the true surface.
        accuracy: Mm = 0.005, in 0.0005..=0.1;
        /// Greatest distance between a path that does not show (inner walls,
        /// skin) and where it was meant. Gaps, infill and solid areas that
        /// nobody sees may be off by one and a half times as much. No print
        /// shows such differences, and longer moves are easier on the firmware.
        path_accuracy: Mm = 0.025, in 0.0005..=0.2;
        /// Spacing of the lattice on which the field is sampled to find the
        /// outlines. Details smaller than this may be missed, and curves
        /// tighter than a few times this are less accurate. It is at most half
        /// of outer_wall_width, whatever is set: a coarser lattice would overlook
        /// what can be printed.
        sample_spacing: Mm = 0.1, in 0.01..=2.0;
        /// Slits in a layer that are narrower than twice this are closed, so
        /// that bodies that almost touch are printed as one; 0 leaves them
        /// open, and auto is 5% of the nozzle's diameter.
        slit_closing: ByNozzle = ByNozzle::Auto, in 0.0..=1.0;

        ["Walls"]
        /// Number of walls around each island and hole.
        walls: u32 = 2, in 0..=1000, idle above_flat_layers;
        /// Number of walls around top skin, whose lines reach up to them. The
        /// other walls go around what the next layer covers. auto is as many
        /// as walls.
        top_walls: Option<u32> = None, in 1..=1000,
            idle above_flat_layers | no_fewer_walls | interlocked | walls_of_the_field;
        /// Whether to print the part as a vase: bottom_layers flat layers,
        /// and above them one wall that climbs without a break, without
        /// infill, top skin, seams and retractions. A number is that of walls
        /// that climb side by side; the nozzle goes from each to the next one
        /// outside of it once a turn.
        spiral: SwitchOr<u32> = SwitchOr::Off, in 1..=100;
        /// Line width of the outer wall; auto is 112.5% of the nozzle's
        /// diameter.
        outer_wall_width: ByNozzle = ByNozzle::Auto, in 0.05..=10.0;
        /// Line width of the walls behind the outer wall; auto is 112.5% of the
        /// nozzle's diameter.
        inner_wall_width: ByNozzle = ByNozzle::Auto, in 0.05..=10.0;
        /// Narrowest bead for places too thin for whole walls, as a share of
        /// the wall's width; it fills thinner places, too, down to 45% of it, but
        /// for blunt tips.
        thin_min: Percent = 60.0, in 10.0..=100.0;
        /// Widest single bead for thin places, as a share of the wall's width;
        /// wider places get two walls.
        thin_max: Percent = 180.0, in 100.0..=300.0;
        /// Whether every other inner wall lies half a layer lower than its layer,
        /// so that the walls interlock and the part does not split so easily
        /// between layers.
        walls_interlocked: bool = false,
            idle nothing_to_interlock | contoured | too_high_to_interlock | in_a_vase;
        /// Which walls of an island are printed first: inner ones, the outer one,
        /// or the outer one unless it hangs over by more than overhang_share,
        /// so that each wall is laid beside one that holds it.
        wall_order: WallOrder = WallOrder::InnerFirst,
            idle no_overhangs | order_in_a_vase | no_inner_walls;
        /// How walls are offset: by distance in the layer's plane, right for
        /// every field, or by the field's own value, right only where the
        /// field is that distance.
        wall_offset: WallOffset = WallOffset::Distance;
        /// How far outlines are moved outwards before anything else is made
        /// of them (inwards, if negative), for plastic that shrinks or
        /// spreads. An expression knows the outline's curvature beside x, y and
        /// z: 1/r around a disc, -1/r around a hole with the radius r.
        xy_compensation: Varying<Mm> = Varying::Constant(0.0), in -5.0..=5.0;
        /// How much the first layer is drawn in on all sides, to make up for
        /// being squeezed; places as thin as two walls keep their width. With a
        /// number of layers, as in "0.2 mm over 3 layers", each is drawn in less
        /// than the one below.
        elephant_foot: ElephantFoot =
            ElephantFoot { drawn: 0.0, layers: 1 }, in 0.0..=2.0,
            idle on_a_raft;
        /// Where outer walls begin and end; an expression puts each wall's seam
        /// where its value is least.
        seam: Varying<SeamRule> = Varying::Constant(SeamRule::Aligned);
        /// How far before its beginning an outer wall ends.
        seam_gap: Mm = 0.0, in 0.0..=5.0, idle no_end_of_a_scarf;
        /// Length over which the flow of an outer wall grows at its beginning,
        /// and over which its end overlaps the beginning with shrinking flow; 0
        /// for a plain seam. No bead of a wall at least 1.8 times as wide as
        /// high becomes narrower than high. With a share of the layer's height,
        /// as in "20 mm from 10%", it begins there: the nozzle rises with the
        /// flow, and the end of the wall fills what is left above. Above 90%
        /// scarfs stay level, as those of the first layer do.
        seam_scarf: Scarf =
            Scarf { length: 0.0, start: 100.0 }, in 0.0..=200.0,
            idle no_scarf_in_a_vase | level_scarf;
        /// How far the nozzle moves inwards, without printing, from the end
        /// of an outer wall before it goes elsewhere.
        seam_wipe: Mm = 0.3, in 0.0..=5.0;

        ["Skin: the solid top and bottom"]
        /// Where the part gets skin: at all of its exposed faces, or only at
        /// its ends, where skin fills the lowest and the highest layers.
        skin_where: SkinWhere = SkinWhere::Exposed;
        /// Number of solid layers below each upward face, or their least
        /// thickness, such as "0.8 mm"; auto is a thickness of 200% of the
        /// nozzle's diameter.
        top_layers: Shell = Shell::AUTO, in 0..=50_000, idle above_flat_layers;
        /// Number of solid layers above each downward face, or their least
        /// thickness, such as "0.6 mm"; auto is a thickness of 150% of the
        /// nozzle's diameter.
        bottom_layers: Shell = Shell::AUTO, in 0..=50_000;
        /// Line width of skin, of the rings around it and of bridges; auto is
        /// 112.5% of the nozzle's diameter.
        skin_width: ByNozzle = ByNozzle::Auto, in 0.05..=10.0;
        /// Width of the lines of skin that faces upwards; auto takes
        /// skin_width.
        top_skin_width: ByNozzle = ByNozzle::Auto, in 0.05..=10.0,
            idle no_top_skin;
        /// Pattern of skin, except where it is nowhere wider than 5 lines:
        /// there strokes follow its border. Lines that face upwards are swept
        /// one way, which shines evenly, unless they are unordered-lines. Skin
        /// that faces upwards (top) or downwards (bottom), or that the layers
        /// above and below cover (internal), may have patterns of their own, as
        /// in "top: concentric, bottom: lines"; those left out have lines.
        skin_pattern: SkinPatterns = SkinPatterns::default(),
            idle swept_above_only;
        /// Direction of skin lines on even layers, counter-clockwise from
        /// the x axis; odd layers are turned by a right angle. Even and odd
        /// layers change places where lines would run along those of rectilinear
        /// or solid infill below them.
        skin_angle: Degrees = 45.0, in -360.0..=360.0;
        /// Gap between the ring around skin and the lines inside it; 0 for
        /// lines that reach the ring.
        skin_ring_gap: Mm = 0.0, in 0.0..=10.0;
        /// How far skin reaches into the sparse infill beside it, so that
        /// its lines are anchored; auto is 150% of the nozzle's diameter.
        skin_overlap: ByNozzle = ByNozzle::Auto, in 0.0..=20.0;
        /// How far skin reaches into the walls around it, as a share of
        /// skin_width, at most half of the wall. 0 lays the ring beside the
        /// wall, which leaves no pit; more than 10% lays too much there.
        skin_wall_overlap: Percent = 0.0, in 0.0..=50.0, idle no_wall_beside;
        /// Pieces of sparse area smaller than this are filled solid, as
        /// skin. So are pieces that are narrower than two lines, and small ones
        /// in which no line of infill would lie.
        skin_min_area: Mm2 = 2.0, in 0.0..=1000.0;

        ["Ironing: a second pass over tops"]
        /// Whether to go over each top once more, with next to no material,
        /// to make it smooth. A number is that material's share of what would
        /// fill the layer; true is 10%.
        ironing: SwitchOr<Percent> = SwitchOr::Off, in 0.1..=100.0,
            idle no_tops | above_flat_layers;
        /// Distance between the lines of ironing; auto is 25% of the nozzle's
        /// diameter.
        ironing_spacing: ByNozzle = ByNozzle::Auto, in 0.02..=2.0, idle not_ironed;
        /// How much walls, skin and ironing that lie open follow the surface
        /// above them: 0 leaves the layers' steps, with 100 the nozzle runs on
        /// the surface itself.
        contour_z: Varying<Percent> = Varying::Constant(0.0), in 0.0..=100.0,
            idle in_a_vase;
        /// Angle from the level up to which faces get all of contour_z; it
        /// fades over the next 10°.
        contour_z_angle: Degrees = 15.0, in 0.0..=35.0,
            idle nozzle_too_flat | steps_stay;
        /// Whether undersides over supports and bridges follow the surface below
        /// them, as far as contour_z says: the nozzle stays at the layer's top,
        /// and the material goes as deep as the surface.
        contour_z_below: bool = false, idle steps_stay;

        ["Bridges and overhangs"]
        /// How far a bridge's lines reach onto what holds them.
        bridge_anchor: Mm = 1.5, in 0.0..=20.0;
        /// Longest bridge that the printer and the material can print: skin over
        /// nothing gets lines across the gap, from support to support. A longer
        /// one is supported if supports are on, and gets a warning if not. With a
        /// good fan PLA spans 20 mm or more. 0 for no bridges, except below the
        /// part's underside over a raft.
        bridge_max: Mm = 10.0, in 0.0..=1000.0;
        /// Material of bridges, as a share of what skin would get.
        bridge_flow: Percent = 100.0, in 10.0..=300.0, idle no_bridges;
        /// Whether the lowest solid layer over sparse infill gets lines across
        /// those of the infill, which end on the infill or on walls. The
        /// following layers lie on it. Parts without walls have none. A number
        /// is that of such layers, each across the one below; true is 2 where
        /// infill_density is below 10%, else 1. If the density is an expression,
        /// the distance between the infill's lines decides.
        internal_bridges: SwitchOr<u32> = SwitchOr::On, in 1..=10,
            idle unheld_ends | in_a_vase | nothing_to_bridge;
        /// Material of internal bridges, as a share of what skin would get.
        internal_bridge_flow: Percent = 100.0, in 10.0..=300.0,
            idle no_internal_bridges | unheld_internal_bridges;
        /// Share of its width by which a wall may hang over the layer below
        /// before it is printed as an overhang; with 100 no wall is.
        overhang_share: Percent = 50.0, in 0.0..=100.0;
        /// Whether the walls round what hangs over by more than overhang_share
        /// are printed the other way round on every other layer, so that what
        /// the cooling plastic pulls at does not add up. Walls that interlock
        /// keep their direction.
        overhang_reverse: bool = false, idle no_overhangs | in_a_vase;

        ["Supports"]
        /// Whether to print supports under what nothing else holds: nowhere,
        /// wherever they are needed (auto), or only where they stand on the
        /// bed (plate).
        supports: Supports = Supports::Off, idle in_a_vase;

        ["Draughts"]
        /// Whether a wall, one line thick, stands around the part and its
        /// supports and keeps draughts off: off, full, or up to a height above
        /// the bed. It takes the skirt's place.
        draft_shield: DraftShield = DraftShield::Off, in 0.1..=10_000.0,
            idle shield_too_low;

        ["Sparse infill"]
        /// Share of the inside that is printed; 0 leaves it hollow. Infill
        /// that is an expression is as dense as the expression makes it.
        infill_density: Varying<Percent> = Varying::Constant(15.0),
            in 0.0..=100.0, idle above_flat_layers | dense_by_expression;
        /// Pattern of the sparse infill. An expression, or the path of a
        /// script, is a pattern of your own: beads where it is zero, or a shape
        /// that is negative inside (infill_mode).
        infill: Infill = Infill::Pattern(InfillPattern::Rectilinear),
            idle above_flat_layers | no_sparse_infill;
        /// What an expression of infill is: a surface to lay beads on, or a
        /// solid to print like a part of its own, with one wall, or with the
        /// number of walls written here.
        infill_mode: InfillMode = InfillMode::Surface, in 0..=1000,
            idle infill_of_a_pattern;
        /// Line width of sparse infill; auto is 112.5% of the nozzle's
        /// diameter.
        infill_width: ByNozzle = ByNozzle::Auto, in 0.05..=10.0;
        /// Direction of infill lines, counter-clockwise from the x axis.
        infill_angle: Degrees = 45.0, in -360.0..=360.0,
            idle turned_by_expression | nothing_runs_along;
        /// How far sparse infill reaches into the wall or skin around it, as
        /// a share of its line width; skin has skin_wall_overlap.
        infill_overlap: Percent = 25.0, in 0.0..=100.0;

        ["Flow"]
        /// Material extruded, as a share of the beads' volume; multiplies
        /// filament.flow.
        flow: Varying<Percent> = Varying::Constant(100.0),
            in 10.0..=300.0;
        /// Width of the beads of the part, as a share of their line width.
        /// Their centre lines stay where they are.
        bead_width: Varying<Percent> = Varying::Constant(100.0),
            in 50.0..=180.0;
    }
    /// Fuzzy skin: a rough texture on the walls one sees.
    fuzzy: FuzzySkin {
        /// Greatest distance by which an outer wall is moved outwards or
        /// inwards; 0 leaves it smooth.
        thickness: Varying<Mm> = Varying::Constant(0.0), in 0.0..=5.0,
            idle above_flat_layers;
        /// Size of the bumps.
        grain: Mm = 0.8, in 0.1..=100.0, idle smooth;
        /// Whether the walls of holes are fuzzy, too.
        holes: bool = false, idle smooth;
    }
    /// What holds a part while it is printed.
    support: Support {
        /// How far a face may lean from the vertical and still hold itself; a
        /// face that leans farther gets a warning.
        angle: Degrees = 55.0, in 0.0..=89.0;
        /// Where supports are wanted, if that is an expression: where it is
        /// positive, under every face, whatever its angle; where it is
        /// negative, under none; where it is 0, by the angle. z is the height
        /// of the underside above the bed. A number holds everywhere.
        where_: Varying = Varying::Constant(0.0), in -10.0..=10.0,
            idle no_supports;
        /// What supports look like below their dense tops.
        style: SupportStyle = SupportStyle::Auto, idle no_supports;
        /// Distance between supports and the part beside them; below a slope no
        /// more than there is room.
        xy_gap: Mm = 0.35, in 0.0..=10.0, idle no_supports;
        /// Gap between a support and the underside above it, whatever the
        /// layer height: supports have heights of their own.
        z_gap: Mm = 0.2, in 0.0..=10.0, idle no_supports;
        /// Gap between the part and a support that stands on it.
        z_gap_bottom: Mm = 0.2, in 0.0..=10.0, idle no_supports;
        /// How far branches of supports may lean from the vertical; 0 for
        /// straight columns.
        branch_angle: Degrees = 45.0, in 0.0..=70.0, idle no_supports;
        /// Share of a support's inside that is printed.
        density: Percent = 12.0, in 1.0..=100.0, idle nothing_below;
        /// Number of dense layers at the top of a support.
        interface_layers: u32 = 2, in 0..=1000, idle no_supports;
        /// Share of the dense layers at the top of a support that is printed, or
        /// the distance between their lines, from middle to middle, such as
        /// "0.8 mm".
        interface_density: LineDensity = LineDensity::Share(95.0),
            in 10.0..=100.0, idle no_dense_layers;
        /// Pattern of the dense layers at the top of a support: concentric
        /// rings, or lines, towards infill_angle or the angle written here on
        /// even layers, counter-clockwise from the x axis, and turned by a right
        /// angle on odd ones.
        interface_pattern: InterfacePattern = InterfacePattern::Lines,
            in -360.0..=360.0, idle no_dense_layers;
        /// Whether the top of a support is level in each layer, or follows the
        /// underside above it; contour_z_below gives that underside no steps.
        interface_shape: InterfaceShape = InterfaceShape::Flat,
            idle no_supports;
        /// Material extruded for supports, and for the first layer of a raft, as
        /// a share of their beads' volume; multiplies flow.
        flow: Percent = 100.0, in 10.0..=300.0, idle nothing_below;
        /// Material extruded for the dense layers at the top of a support, and
        /// for the solid layers of a raft, as a share of their beads' volume;
        /// multiplies flow.
        interface_flow: Percent = 100.0, in 10.0..=300.0, idle nothing_below;
    }
    /// Layers between the bed and the part, which come off after the print.
    raft: Raft {
        /// Number of the raft's layers; 0 for no raft. The first is thick and
        /// sparse, those above it are solid.
        layers: u32 = 0, in 0..=100;
        /// Air between the raft and the part. auto is 0.2 mm, or the nozzle's
        /// diameter less layer_height if that is less.
        gap: Option<Mm> = None, in 0.0..=2.0, idle no_raft;
        /// How far the raft reaches beyond the first layer of the part and of
        /// its supports.
        expansion: Mm = 3.0, in 0.0..=100.0, idle no_raft;
    }
    /// Speeds of the nozzle.
    speed: Speed {
        /// Speed of outer walls.
        outer_wall: Varying<MmPerSec> = Varying::Constant(40.0),
            in 0.1..=2000.0;
        /// Speed of the walls behind the outer wall.
        inner_wall: Varying<MmPerSec> = Varying::Constant(60.0),
            in 0.1..=2000.0, idle no_inner_walls;
        /// Speed of the beads that fill gaps between walls.
        gap_fill: Varying<MmPerSec> = Varying::Constant(60.0),
            in 0.1..=2000.0;
        /// Speed of sparse infill.
        sparse_infill: Varying<MmPerSec> = Varying::Constant(80.0),
            in 0.1..=2000.0, idle no_sparse_infill;
        /// Speed of solid layers that are covered from both sides.
        internal_skin: Varying<MmPerSec> = Varying::Constant(60.0),
            in 0.1..=2000.0;
        /// Greatest speed of closed walls shorter than small_wall_length:
        /// around thin pins and small holes.
        small_wall: MmPerSec = 25.0, in 0.1..=2000.0;
        /// Closed walls shorter than this are printed at small_wall at most;
        /// 0 for none.
        small_wall_length: Mm = 20.0, in 0.0..=1000.0;
        /// Speed of skin that faces upwards.
        top_skin: Varying<MmPerSec> = Varying::Constant(40.0),
            in 0.1..=2000.0;
        /// Speed of skin that faces downwards.
        bottom_skin: Varying<MmPerSec> = Varying::Constant(40.0),
            in 0.1..=2000.0;
        /// Speed of bridges.
        bridge: Varying<MmPerSec> = Varying::Constant(30.0),
            in 0.1..=2000.0;
        /// Speed of internal bridges.
        internal_bridge: Varying<MmPerSec> = Varying::Constant(40.0),
            in 0.1..=2000.0, idle no_internal_bridges | unheld_internal_bridges;
        /// Speed of walls that hang over the layer below by more than
        /// overhang_share, or speeds by the share of a wall's width that reaches
        /// beyond that layer. Between steps the speed changes evenly, from the
        /// wall's own at 0% on, and is never more than that. What lies over a
        /// support counts half.
        overhang: OverhangSpeed = OverhangSpeed::Same(Varying::Constant(20.0)),
            in 0.1..=2000.0, idle no_single_overhangs;
        /// Speed of ironing.
        ironing: Varying<MmPerSec> = Varying::Constant(20.0),
            in 0.1..=2000.0, idle not_ironed;
        /// Speed of supports.
        support: MmPerSec = 80.0, in 0.1..=2000.0, idle nothing_below;
        /// Speed of the dense layers at the top of supports.
        support_interface: MmPerSec = 60.0, in 0.1..=2000.0, idle nothing_below;
        /// Speed of the skirt and the brim.
        skirt: MmPerSec = 30.0, in 0.1..=2000.0;
        /// Greatest printing speed on the first layer.
        first_layer: MmPerSec = 20.0, in 0.1..=2000.0, idle faster_than_all;
        /// Speed of moves that do not print.
        travel: MmPerSec = 150.0, in 0.1..=2000.0;
    }
    /// Accelerations of the nozzle by what is printed; 0 takes the printer's
    /// own, printer.acceleration.
    acceleration: Acceleration {
        /// Acceleration of outer walls.
        outer_wall: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
        /// Acceleration of the walls behind the outer wall, and of the beads
        /// that fill gaps between walls.
        inner_wall: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
        /// Acceleration of sparse infill.
        sparse_infill: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
        /// Acceleration of solid layers that are covered from both sides.
        internal_skin: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
        /// Acceleration of skin that faces upwards, and of ironing.
        top_skin: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
        /// Acceleration of skin that faces downwards.
        bottom_skin: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
        /// Acceleration of bridges, internal ones as well.
        bridge: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
        /// Acceleration of walls that hang over the layer below.
        overhang: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
        /// Greatest acceleration of everything printed on the first layer; 0
        /// for no limit.
        first_layer: MmPerSec2 = 0.0, in 1.0..=100_000.0 or_zero;
    }
    /// Travels: the way between beads.
    travel: Travel {
        /// Where travels may lead to avoid what is in their way: straight only,
        /// anywhere inside the part, not over top skin, or over sparse infill
        /// only. From one island to another they leave and enter square to the
        /// border.
        combing: Combing = Combing::NotOverTopSkin;
        /// Travels that would become longer by more than this go straight,
        /// retracted.
        max_detour: Mm = 30.0, in 0.0..=10_000.0;
    }
    /// Pulling back the filament before a travel.
    retract: Retract {
        /// Whether only travels that cross something retract: those that leave
        /// what hides their ooze (hidden), or cross a wall. If false, all
        /// travels of at least min_travel retract.
        when_crossing: bool = true;
        /// Whether crossing a wall counts. A travel also crosses a wall if it
        /// comes nearer to it than half a line's width.
        check_walls: bool = true;
        /// What hides the ooze of travels: sparse infill alone, or whatever is
        /// inside the part and no top skin (covered). auto is covered, and
        /// travels may also cross inner walls.
        hidden: Hidden = Hidden::Auto;
        /// Length of filament pulled back; 0 turns retraction off.
        length: Mm = 0.8, in 0.0..=50.0;
        /// Speed of pulling back.
        speed: MmPerSec = 35.0, in 0.1..=500.0, idle never_retracted;
        /// Speed of pushing forward again.
        prime_speed: MmPerSec = 35.0, in 0.1..=500.0, idle never_retracted;
        /// Straight travels shorter than this never retract. Where one would
        /// show, the nozzle goes round if it can. If the way round shows, too,
        /// and is at least this long, it retracts; if it is also more than 3
        /// times the straight way, the travel goes straight.
        min_travel: Mm = 1.5, in 0.0..=1000.0;
        /// Travels longer than this ooze too much: they retract even if the
        /// ooze is hidden.
        max_unretracted: Mm = 30.0, in 0.0..=10_000.0;
        /// Length of filament pushed forward beyond what was pulled back, to
        /// make up for what oozed; negative for less.
        extra_prime: Mm = 0.0, in -5.0..=5.0, idle no_retraction;
        /// How far the nozzle goes on along the bead just printed while it
        /// retracts: round a closed one, back along an open one; 0 for no
        /// wiping.
        wipe: Mm = 0.0, in 0.0..=100.0, idle never_retracted;
        /// Share of the retraction that is done before the wipe; the rest is
        /// done during the wipe.
        before_wipe: Percent = 0.0, in 0.0..=100.0,
            idle never_retracted | never_wiped;
        /// How far the nozzle is lifted during a retracted travel.
        z_hop: Mm = 0.0, in 0.0..=10.0, idle no_retraction;
        /// Which retracted travels are lifted.
        z_hop_when: HopWhen = HopWhen::Crossing;
        /// Whether the firmware retracts (G10 and G11). The start of the file
        /// tells it the lengths and speeds set here.
        firmware: bool = false;
    }
    /// Loops around the part that start the flow before the part does.
    skirt: Skirt {
        /// Number of loops; 0 for no skirt.
        loops: u32 = 1, in 0..=1000, idle shielded;
        /// Gap between the part, or its brim, and the innermost loop or the
        /// draft shield; auto is 6 mm, and 10 mm for a draft shield.
        distance: Option<Mm> = None, in 0.0..=1000.0, idle no_skirt;
        /// Number of layers, from the bed, that have a skirt.
        layers: u32 = 1, in 0..=50_000, idle shielded | no_skirt;
    }
    /// Several parts on one plate.
    plate: PlateSettings {
        /// Distance between parts, with their brims, where they are arranged.
        spacing: Mm = 5.0, in 0.0..=1000.0;
        /// Whether all parts grow together, or one part is printed after the
        /// other. Then the head must have room beside those that are finished
        /// (printer.head_clearance_radius, printer.gantry_height).
        sequence: PlateSequence = PlateSequence::AllAtOnce;
    }
    /// Loops beside the first layer that hold the part down.
    brim: Brim {
        /// Where the brim is: around the part, in its holes, both, or as ears,
        /// discs at its sharp corners.
        place: BrimPlace = BrimPlace::None;
        /// Width of all loops together, or radius of ears.
        width: Mm = 5.0, in 0.1..=200.0, idle no_brim;
        /// Gap between the part and the first loop; the wider the gap, the
        /// easier the brim comes off.
        gap: Mm = 0.1, in 0.0..=20.0, idle no_brim;
        /// Corners of the first layer that are sharper than this get ears.
        ear_angle: Degrees = 125.0, in 0.0..=180.0, idle no_ears;
    }
    /// Fan, and slowing down for small layers.
    cooling: Cooling {
        /// Speed of the part's fan.
        fan_speed: Varying<Percent> = Varying::Constant(100.0),
            in 0.0..=100.0;
        /// Speed of the part's fan while bridges are printed.
        bridge_fan_speed: Percent = 100.0, in 0.0..=100.0;
        /// Speed of the part's fan while internal bridges are printed; auto is
        /// bridge_fan_speed.
        internal_bridge_fan_speed: Option<Percent> = None, in 0.0..=100.0,
            idle no_internal_bridges | unheld_internal_bridges;
        /// Speed of the part's fan while the dense layers at the top of
        /// supports, and the solid layers of a raft, are printed: the faster
        /// the fan, the less they stick to the part. auto is fan_speed.
        support_interface_fan_speed: Option<Percent> = None, in 0.0..=100.0,
            idle nothing_below;
        /// Speed of the part's fan while overhanging walls are printed, or
        /// speeds by the share of a wall's width that reaches beyond the layer
        /// below. Between steps the speed changes evenly, from fan_speed at 0%
        /// on. What lies over a support counts half.
        overhang_fan_speed: OverhangFan = OverhangFan::Same(100.0),
            in 0.0..=100.0;
        /// Number of layers, from the bed, printed without the fan.
        fan_off_layers: u32 = 1, in 0..=50_000;
        /// Number of the first layer, from the bed, whose fan runs at full
        /// speed; from fan_off_layers up to it the fan comes up in even steps.
        /// 0 for no steps.
        full_fan_layer: u32 = 0, in 0..=50_000, idle fan_still_off;
        /// Speed of the part's fan on layers that take only min_layer_time, if
        /// it is more than fan_speed; layers that take less than
        /// long_layer_time get a speed in between. auto is fan_speed.
        short_layer_fan_speed: Option<Percent> = None, in 0.0..=100.0;
        /// A layer that takes this long or longer has fan_speed.
        long_layer_time: Seconds = 30.0, in 0.0..=3600.0,
            idle no_layers_between;
        /// Least time of a layer; a layer that would take less is printed
        /// slower.
        min_layer_time: Seconds = 8.0, in 0.0..=3600.0;
        /// Least speed to which min_layer_time slows beads down.
        min_speed: MmPerSec = 10.0, in 0.1..=2000.0,
            idle no_slowing | never_slowed;
    }
    /// The material.
    filament: Filament {
        /// Diameter of the filament.
        diameter: Mm = 1.75, in 0.5..=10.0;
        /// Name of the material: PLA, PETG, ABS. Hosts show it, and warn if
        /// another one is loaded.
        material: String = String::from("PLA");
        /// Density of the material, for the mass in the summary.
        density: GramsPerCm3 = 1.24, in 0.1..=25.0;
        /// Price of a kilogram, in any currency, for the summary; 0 to leave it
        /// out.
        cost: PricePerKg = 25.0, in 0.0..=100_000.0;
        /// Material extruded, as a share of the beads' volume; multiplies
        /// flow.
        flow: Percent = 100.0, in 10.0..=300.0;
        /// Greatest volume of plastic the hot end melts per second; faster
        /// moves are slowed down to it.
        max_flow: Mm3PerSec = 12.0, in 0.1..=500.0;
        /// How fast the flow of plastic may change along a stroke: where it
        /// would change faster, the faster side begins or ends in steps, for
        /// hot ends whose pressure follows the filament late. 0 for no limit.
        max_flow_change: Mm3PerSec2 = 0.0, in 0.0..=100_000.0;
        /// Pressure advance (linear advance): how long the filament's push
        /// runs ahead of the nozzle; auto leaves it as the firmware has it.
        pressure_advance: Option<Seconds> = None, in 0.0..=5.0;
        /// Temperature of the nozzle above the first layer; an expression of
        /// it may depend on z only, and holds for whole layers.
        nozzle_temperature: Varying<Celsius> = Varying::Constant(210.0),
            in 1.0..=600.0;
        /// Least temperature of the nozzle at which plastic is pushed; auto
        /// is 170, below which most firmware refuses to.
        min_nozzle_temperature: Option<Celsius> = None, in 0.0..=600.0;
        /// Temperature of the nozzle on the first layer; auto is 5 °C more than
        /// nozzle_temperature, as far as printer.max_nozzle_temperature allows, or
        /// 215 °C if that is an expression.
        first_layer_nozzle_temperature: Option<Celsius> = None,
            in 1.0..=600.0;
        /// Temperature of the bed above the first layer; 0 for no heating.
        bed_temperature: Celsius = 60.0, in 0.0..=250.0;
        /// Temperature of the bed on the first layer; 0 for no heating, auto for
        /// that of bed_temperature.
        first_layer_bed_temperature: Option<Celsius> = None, in 0.0..=250.0;
    }
    /// The machine.
    printer: Printer {
        /// Name by which a Prusa printer knows its model (MK3S, MINI, MK4, XL),
        /// or under which a printer of Bambu Lab's is sold (Bambu Lab A1); its
        /// firmware checks that the file is for it. Empty for no check.
        model: String = String::new();
        /// Width of the bed; x runs from 0 to this.
        bed_x: Mm = 220.0, in 1.0..=10_000.0;
        /// Depth of the bed; y runs from 0 to this.
        bed_y: Mm = 220.0, in 1.0..=10_000.0;
        /// Greatest height of a print.
        height: Mm = 250.0, in 1.0..=10_000.0;
        /// Diameter of the nozzle's hole. Line widths, layer heights and other
        /// lengths that are auto, or a share such as 75%, follow it.
        nozzle_diameter: Mm = 0.4, in 0.05..=5.0;
        /// Diameter of the nozzle's flat end, which contour_z has to allow for;
        /// auto is 250% of the nozzle's diameter.
        nozzle_flat: Option<Mm> = None, in 0.0..=20.0;
        /// Greatest temperature that the hot end bears; settings beyond it
        /// are refused. auto if it is not known: 450.
        max_nozzle_temperature: Option<Celsius> = None, in 1.0..=600.0;
        /// Greatest temperature that the bed reaches; settings beyond it are
        /// refused. auto if it is not known: 200.
        max_bed_temperature: Option<Celsius> = None, in 1.0..=250.0;
        /// Greatest temperature that a heated chamber reaches, for the check
        /// of start templates and of files. auto if it is not known.
        max_chamber_temperature: Option<Celsius> = None, in 1.0..=250.0;
        /// Acceleration of printing moves if the group acceleration has no
        /// other.
        acceleration: MmPerSec2 = 1000.0, in 1.0..=100_000.0;
        /// Acceleration of moves that do not print.
        travel_acceleration: MmPerSec2 = 1500.0, in 1.0..=100_000.0;
        /// Speed at which a right-angled corner is passed.
        square_corner_velocity: MmPerSec = 5.0, in 0.0..=200.0;
        /// Greatest speed in the plane; no move is faster.
        max_speed: MmPerSec = 500.0, in 1.0..=5000.0;
        /// How far from the nozzle the head reaches, seen from above: the
        /// radius of a circle around the nozzle that holds all of it. Parts
        /// that are printed one by one keep that distance. If nothing but the
        /// nozzle is there up to some height above the nozzle's tip, as in
        /// "45 mm above 7 mm", parts no higher than that may stand nearer to
        /// those printed after them. auto if it is not known.
        head_clearance_radius: Option<HeadClearance> = None, in 1.0..=500.0;
        /// Height above the nozzle's tip of whatever moves across the whole bed
        /// with the head, such as the beam that carries it. Of parts that are
        /// printed one by one only the last may be higher. auto if it is not
        /// known.
        gantry_height: Option<Mm> = None, in 1.0..=1000.0;
        /// How far the head reaches from the nozzle to the front (towards y =
        /// 0), where the beam that carries the head, and its cables, are behind
        /// the nozzle, as on printers whose bed moves in y. Parts that are
        /// printed one by one may be higher than gantry_height if they stand
        /// that far behind one another; the front one is printed first. auto
        /// if it is not known: then only the last may be higher.
        front_clearance: Option<Mm> = None, in 1.0..=1000.0;
        /// How many moves a second the firmware takes: where beads bend more
        /// often, they are slowed. auto for what is usual: 200 for Marlin, 400
        /// for Prusa's, 500 for RepRapFirmware and Bambu Lab's, 1000 for
        /// Klipper.
        max_moves_per_second: Option<PerSec> = None, in 10.0..=100_000.0;
        /// Greatest speed of the z axis.
        max_speed_z: MmPerSec = 10.0, in 0.1..=1000.0;
        /// Greatest acceleration of the z axis, for the estimate of the time
        /// only: the printer keeps its own.
        max_acceleration_z: MmPerSec2 = 100.0, in 1.0..=100_000.0;
        /// Acceleration of the filament while nothing is printed, for the
        /// estimate of the time only: Marlin's M204 R, RepRapFirmware's M201 E,
        /// Klipper's max_extrude_only_accel.
        retract_acceleration: MmPerSec2 = 5000.0, in 1.0..=100_000.0;
    }
    /// The G-code. Templates are text with placeholders such as {{
    /// nozzle_temperature }}; docs/gcode.md lists them.
    gcode: Gcode {
        /// Firmware that will read the G-code.
        flavour: Flavour = Flavour::Marlin;
        /// The slicer whose words the comments use, for viewers and hosts.
        comments: Comments = Comments::Prusa;
        /// Whether extruder positions are relative to the last one instead of
        /// absolute.
        relative_e: bool = false;
        /// Whether curved paths of constant width are written as arcs (G2 and
        /// G3), for firmware that follows them as closely as many short moves.
        arcs: bool = false;
        /// Template for the start of the print; empty for homing only.
        /// Temperatures that it does not set are set before it, and waited for
        /// after it.
        start: String = String::new();
        /// Template for the end of the print, where the fan is already off.
        /// Empty to turn the heaters off, move the head up and aside, and turn
        /// the motors off.
        end: String = String::new();
        /// Template for the beginning of every layer; it must leave the
        /// filament as it was, but may move the head.
        layer: String = String::new();
        /// Whether the start sets the printer's accelerations and its speed
        /// through corners. If false, these only count for the estimate of the
        /// time.
        set_limits: bool = true, idle limits_of_the_printer;
        /// Whether layers tell how far the print has come, and the minutes left
        /// (M73); auto does so for Marlin, Prusa's and Bambu Lab's firmware. Only
        /// files of a whole part can tell.
        progress: Emit = Emit::Auto;
        /// Whether the part has a label, by which hosts show and exclude it;
        /// auto labels it for firmware that always understands labels.
        labels: Emit = Emit::Auto;
        /// Sizes of the pictures in the file's head that hosts and printers
        /// show, such as "32x32, 300x300"; empty for none. Each is a PNG
        /// unless the size says /QOI or /JPG.
        thumbnails: Sizes = Sizes::thumbnails();
    }
}

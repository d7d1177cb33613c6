//! Settings that are one of a few words.

use super::value;

value::words! {
    /// Firmware that reads the G-code.
    Flavour {
        /// Marlin 2.
        Marlin = "marlin",
        /// Klipper.
        Klipper = "klipper",
        /// RepRapFirmware 3, of Duet boards.
        Rrf = "rrf",
        /// Prusa's firmware.
        Prusa = "prusa",
        /// Bambu Lab's firmware.
        Bambu = "bambu",
    }

    /// The order in which the parts of a plate are printed.
    PlateSequence {
        /// All grow together, layer by layer.
        AllAtOnce = "all-at-once",
        /// Each is finished before the next one begins.
        OneByOne = "one-by-one",
    }

    /// The slicer whose words comments use.
    Comments {
        /// PrusaSlicer's, which most viewers and hosts know.
        Prusa = "prusa",
        /// OrcaSlicer's.
        Orca = "orca",
        /// Bambu Studio's.
        Bambu = "bambu",
        /// Cura's.
        Cura = "cura",
        /// No comments but the file's first line and its pictures.
        None = "none",
    }

    /// Whether some lines are written.
    Emit {
        /// If it suits the firmware.
        Auto = "auto",
        /// Always.
        On = "on",
        /// Never.
        Off = "off",
    }

    /// Order in which the walls of an island are printed.
    WallOrder {
        /// Inner walls first: the outer one has something to lean on.
        InnerFirst = "inner-first",
        /// Outer wall first: its place does not depend on the others.
        OuterFirst = "outer-first",
        /// Outer wall first, unless it hangs over the layer below.
        OuterFirstUnlessOverhang = "outer-first-unless-overhang",
    }

    /// Where a brim is.
    BrimPlace {
        /// Nowhere.
        None = "none",
        /// Around the part.
        Outer = "outer",
        /// In the part's holes.
        Inner = "inner",
        /// Around the part and in its holes.
        Both = "both",
        /// At the part's sharp corners only.
        Ears = "ears",
    }

    /// How walls are offset.
    WallOffset {
        /// By distance in the layer's plane.
        Distance = "distance",
        /// By the field's own value.
        Field = "field",
    }

    /// Where closed walls begin and end.
    SeamRule {
        /// In one line up the part, in a corner where there is one.
        Aligned = "aligned",
        /// At the back, greatest y.
        Rear = "rear",
        /// Nearest to where the nozzle comes from, as far as that is known.
        Nearest = "nearest",
        /// At a random place, which differs from layer to layer.
        Random = "random",
    }

    /// Where travels go round what is in their way.
    Combing {
        /// Nowhere: travels are straight.
        Off = "off",
        /// Everywhere inside an island.
        Everywhere = "everywhere",
        /// Everywhere inside an island, but round top skin if there is a way.
        NotOverTopSkin = "not-over-top-skin",
        /// Only where all of the way is over sparse infill.
        WithinInfill = "within-infill",
    }

    /// What hides the ooze of travels.
    Hidden {
        /// Whatever is inside the part and not a top skin; travels may cross
        /// inner walls.
        Auto = "auto",
        /// Sparse infill.
        SparseInfill = "sparse-infill",
        /// Whatever is inside the part and not a top skin.
        Covered = "covered",
    }

    /// Which retracted travels are lifted.
    HopWhen {
        /// All retracted travels.
        Always = "always",
        /// Travels out of the part, over walls or over top skins.
        Crossing = "crossing",
    }

    /// Pattern of skin.
    SkinPattern {
        /// Parallel lines, turned by a right angle every layer. Those that face
        /// upwards are swept one way: no line is printed between two older ones,
        /// so that a surface shines evenly.
        Lines = "lines",
        /// Parallel lines, the nearest first.
        UnorderedLines = "unordered-lines",
        /// Rings inside one another, from the border inwards.
        Concentric = "concentric",
    }

    /// Where a part is solid.
    SkinWhere {
        /// At every face that a layer above or below does not cover.
        Exposed = "exposed",
        /// In its lowest and highest layers.
        Ends = "ends",
    }

    /// Whether supports are printed.
    Supports {
        /// None.
        Off = "off",
        /// Wherever something needs them, also on the part.
        Auto = "auto",
        /// Only those that stand on the bed.
        Plate = "plate",
    }

    /// What supports look like below their tops.
    SupportStyle {
        /// Columns under flat faces that are wide and too low for branches to
        /// be drawn together, branches elsewhere.
        Auto = "auto",
        /// Branches that are drawn together until they are posts.
        Tree = "tree",
        /// Straight columns of squares, which are wide and sturdy.
        Grid = "grid",
        /// Straight columns, no wider than what they hold.
        Snug = "snug",
    }

    /// Shape of the dense top of a support.
    InterfaceShape {
        /// Level in each layer, a gap below the layer of the part above it.
        Flat = "flat",
        /// Along the underside above it, a gap below f = 0 at each point.
        Follow = "follow",
    }

    /// Pattern of the sparse infill.
    InfillPattern {
        /// Parallel lines, turned by a right angle every layer.
        Rectilinear = "rectilinear",
        /// Both directions in every layer.
        Grid = "grid",
        /// Three directions in every layer.
        Triangles = "triangles",
        /// A honeycomb, without crossings.
        Hexagons = "hexagons",
        /// Cubes that stand on a corner.
        Cubic = "cubic",
        /// Rings along the walls.
        Concentric = "concentric",
        /// The gyroid: waves in all directions, without crossings.
        Gyroid = "gyroid",
        /// Schwarz' P surface.
        SchwarzP = "schwarz-p",
        /// Schwarz' D surface.
        Diamond = "diamond",
        /// Neovius' surface.
        Neovius = "neovius",
        /// The lidinoid.
        Lidinoid = "lidinoid",
    }
}

//! Finds the ways from bead to bead, and decides where to retract.
//!
//! In: a layer's beads in print order, and what the layer is made of. Out: its
//! moves in print coordinates.
//!
//! | file | what it decides |
//! |---|---|
//! | `choose` | which of the possible ways is taken |
//! | `comb` | ways inside an area, round its holes and notches |
//! | `gate` | ways from one island to another |
//! | `decide` | whether a way shows, and has to be retracted |
//! | `cross` | whether segments meet, exactly |
//! | `plan` | what is needed of the settings |
//! | `wipe` | where the nozzle goes while it retracts |
//!
//! Nothing is kept from one layer to the next. Grids and islands are made when
//! the first travel of a layer asks for them, and dropped with the layer.

mod choose;
mod comb;
mod cross;
mod decide;
mod gate;
mod plan;
mod wipe;

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_layer::seam::ending::Ended;
use isoslice_layer::view::LayerView;
use isoslice_planar::Solid;
use isoslice_planar::bead::Bead;
use isoslice_settings::layers::LayerSpan;
pub use plan::TravelPlan;

use choose::Planner;

/// One step of a layer's tool path, in print order.
#[derive(Clone, Debug, PartialEq)]
pub enum Move {
    /// Go somewhere without printing.
    Travel(Travel),
    /// Print a bead of one width; the head stands at its first point.
    Print(Bead),
}

/// A way from bead to bead, in print coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Travel {
    /// Way points of the wipe, before the travel; empty for no wipe.
    pub wipe: Vec<DVec2>,
    /// Way points. The last one is the destination, and the first one is not
    /// where the head stands.
    pub points: Vec<DVec2>,
    /// True if the filament is retracted before the travel and primed after it.
    pub retract: bool,
    /// True if the nozzle is lifted, provided that the travel retracts.
    pub hop: bool,
    /// Least height of the nozzle on the way, mm, if something stands there.
    pub clear: Option<Mm>,
}

/// The ordered moves of one layer, in print coordinates. Beads that vary in
/// width are in pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerPath {
    /// The layer.
    pub span: LayerSpan,
    /// The layer's moves.
    pub moves: Vec<Move>,
}

impl LayerPath {
    /// The moves in coordinates moved by `by`.
    pub fn moved(&self, by: DVec2) -> Vec<Move> {
        let moved = |step: &Move| match step {
            Move::Travel(travel) => Move::Travel(travel.clone().moved(by)),
            Move::Print(bead) => {
                let mut bead = bead.clone();
                for p in &mut bead.stroke.points {
                    *p += by;
                }
                Move::Print(bead)
            }
        };
        self.moves.iter().map(moved).collect()
    }

    /// Where the first bead begins, and where the head is in the end; none if
    /// no bead is printed.
    pub fn ends(&self) -> Option<(DVec2, DVec2)> {
        let begins = |step: &Move| match step {
            Move::Print(bead) => bead.stroke.points.first().copied(),
            Move::Travel(_) => None,
        };
        let ended = match self.moves.last()? {
            Move::Print(bead) => bead.stroke.ends()?.1,
            Move::Travel(travel) => *travel.points.last()?,
        };
        Some((self.moves.iter().find_map(begins)?, ended))
    }
}

/// The travel from one part to another, lifted if `hop` is true. There is no wipe:
/// if the host leaves out the part, the nozzle must not go over the place where it
/// was.
pub fn between_parts(to: DVec2, hop: bool) -> Travel {
    Travel {
        hop,
        ..Travel::straight(to, true)
    }
}

/// The travel to a part from one that is finished, above all that stands on
/// the bed.
pub fn over_parts(to: DVec2, clear: Mm) -> Travel {
    Travel {
        clear: Some(clear),
        ..Travel::straight(to, true)
    }
}

/// What a layer is made of, in the model's coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// The layer, and those around it.
    pub view: &'a LayerView<'a>,
    /// Where the layer has sparse infill.
    pub sparse: &'a Solid<'a>,
    /// Depth below the outline at which the walls end.
    pub border: Mm,
}

impl<'a> Ground<'a> {
    /// The layer's outline.
    fn outline(&self) -> &'a Solid<'a> {
        self.view.here.outline
    }
}

/// Connects the beads of a layer. `from` is where the head stands, in the
/// model's coordinates. `offset` leads from the model's coordinates to the
/// printer's.
pub fn connect(
    beads: Vec<Ended>,
    ground: Ground<'_>,
    from: Option<DVec2>,
    offset: DVec2,
    plan: &TravelPlan,
) -> LayerPath {
    let (beads, wipes): (Vec<Bead>, Vec<Option<DVec2>>) =
        beads.into_iter().map(|e| (e.bead, e.wipe)).unzip();
    let planner = Planner::new(&beads, ground, plan);
    let mut travels: Vec<Option<Travel>> = Vec::with_capacity(beads.len());
    let mut at = from;
    let mut before: Option<&Bead> = None;
    for (next, bead) in beads.iter().enumerate() {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let Some((start, end)) = bead.stroke.ends() else {
            travels.push(None);
            continue;
        };
        travels.push((at != Some(start)).then(|| match at {
            Some(a) => planner.travel(a, start, before, next),
            None => Travel::straight(start, false),
        }));
        before = Some(bead);
        at = wipes[next].or(Some(end));
    }
    let mut moves = Vec::with_capacity(2 * beads.len());
    for (i, (bead, travel)) in beads.into_iter().zip(travels).enumerate() {
        if bead.stroke.points.is_empty() {
            continue;
        }
        moves.extend(travel.map(|travel| Move::Travel(travel.moved(offset))));
        // The pieces must not depend on where the part stands, so they are cut
        // before rounding does.
        for mut piece in plan.resolution.final_pieces(bead) {
            for p in &mut piece.stroke.points {
                *p += offset;
            }
            moves.push(Move::Print(piece));
        }
        let there = |p| Travel::straight(p, false).moved(offset);
        moves.extend(wipes[i].map(|p| Move::Travel(there(p))));
    }
    let span = ground.view.here.span;
    LayerPath { span, moves }
}

/// True if a bead belongs to the part, and so lies inside it.
fn of_part(bead: &Bead) -> bool {
    bead.role.is_part()
}

impl Travel {
    /// A travel straight to a point.
    pub fn straight(to: DVec2, retract: bool) -> Travel {
        Travel {
            points: vec![to],
            retract,
            ..Travel::default()
        }
    }

    /// The travel in coordinates moved by `offset`.
    fn moved(mut self, offset: DVec2) -> Travel {
        for p in self.points.iter_mut().chain(&mut self.wipe) {
            *p += offset;
        }
        self
    }
}

#[cfg(test)]
mod tests;

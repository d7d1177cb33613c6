//! Whether layers get about as much plastic as fits into them.
//!
//! In: beads, in order. Out: for each layer, the plastic as a share of what its
//! beads should have.
//!
//! Three things tell what beads should have. If the file says how wide and high
//! they are, that is their volume; a bead that rises out of its layer has more room
//! than the file says, down to what lies below it. Where beads lie side by side,
//! without sparse places between them, they share the room of the layer: this is
//! looked at in [`Window`]s that are covered all over. And the beads of a layer are
//! about as wide as the nozzle.
//!
//! Beads of walls, skin and infill count. Bridges, overhangs, ironing, supports
//! and towers have flows of their own.

use super::cells::{CELL, Place, Tiles, cell_of};
use super::ground::Ground;
use super::rise::{self, Rise};
use super::rules::ROUNDING;
use glam::{DVec3, IVec2};
use isoslice_base::units::{Mm, Mm2, cross_section};
use isoslice_gcode_read::reader::{Move, Role};

/// Cells along one side of a window: 4 mm. Lines of 0.4 mm fill it to within
/// 10 %, wherever the first one lies, and lines of 1 mm to within 25 %.
const SIDE: i32 = 8;

/// Area of a window.
const WINDOW: Mm2 = (SIDE * SIDE) as f64 * CELL * CELL;

/// Area of beads, seen from the side, that says too little: that of 25 mm of usual
/// lines.
const LITTLE: Mm2 = 5.0;

/// Number of windows that a layer may have; a bed of 4 m² has as many.
const MOST_WINDOWS: usize = 1 << 18;

/// Shares of what a layer should get which no print is made with. Lines swell
/// and merge from 1.25 on. Foams print with as little as 0.4.
const TOO_MUCH: f64 = 1.5;
const TOO_LITTLE: f64 = 0.3;

/// Share of the least width by the settings, and of the greatest one, that a
/// layer's beads have on average. Thin places get a bead of a third of the usual
/// width, less its round sides.
const TOO_WIDE: f64 = 1.4;
const TOO_NARROW: f64 = 0.15;

/// A square of cells: a bit for each that beads run through, the volume of
/// these beads, and that volume times their height.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    cells: u64,
    volume: f64,
    weighed: f64,
}

/// The plastic in the layer being printed, and how the file's layers rise.
#[derive(Debug)]
pub(super) struct Flow {
    /// Width of the nozzle.
    nozzle: Mm,
    /// Height of the bed, unless the file continues what others have printed.
    bed: Option<Mm>,
    layer: Layer,
    rise: Rise,
}

/// How far the nozzle is above what lies below it, and what that is, if this is
/// known: what other files have printed is not.
type Lies = Option<(Mm, Below)>;

/// What lies below a bead.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Below {
    Bed,
    Part,
    Support,
}

/// Places of a bead one after the other that lie on the same, and in one window.
#[derive(Clone, Copy, Debug, Default)]
struct Run {
    window: Place,
    on: Lies,
    /// A bit for each of the window's cells that has a place.
    cells: u64,
    /// Number of places.
    count: f64,
}

impl Run {
    /// A run without places yet, in the window of a cell.
    fn new(cell: IVec2, on: Lies) -> Run {
        Run {
            window: window_of(cell),
            on,
            ..Run::default()
        }
    }

    /// True if a cell is in the run's window.
    fn has(&self, cell: IVec2) -> bool {
        self.window == window_of(cell)
    }

    fn take(&mut self, cell: IVec2) {
        let within = cell & (SIDE - 1);
        self.cells |= 1 << (within.y * SIDE + within.x);
        self.count += 1.0;
    }
}

/// The window of a cell.
fn window_of(cell: IVec2) -> Place {
    let window = cell >> SIDE.trailing_zeros();
    (window.x, window.y)
}

/// What is known of the layer being printed.
#[derive(Debug, Default)]
struct Layer {
    /// Volume that the beads have, and that they should have by what the file
    /// says.
    volume: f64,
    said: f64,
    /// True if the file says how wide some of the beads are.
    says_width: bool,
    /// Volume that fits between the nozzle and what lies below the beads, as wide
    /// as the file says.
    room: f64,
    /// Area of the beads, seen from the side, by what the reader takes for their
    /// height.
    seen: Mm2,
    /// Volume of the beads above what is known, and their area, seen from the side,
    /// by how far they rise.
    standing: f64,
    upright: Mm2,
    /// The same area where the reader takes beads for higher than they rise: by how far
    /// they rise.
    risen: Mm2,
    windows: Vec<Window>,
    /// The number of each window.
    places: Tiles<usize>,
    /// The window that beads run through now.
    here: Option<(Place, usize)>,
    /// The first line of the layer.
    line: Option<u64>,
}

/// A layer with too much plastic, or too little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wrong {
    /// The layer's first bead.
    pub line: u64,
    /// Share of what it should have.
    pub share: f64,
}

impl Flow {
    /// No layer, printed from `base` on with a nozzle of this width.
    pub(super) fn new(base: Mm, nozzle: Mm) -> Self {
        Self {
            nozzle,
            bed: (base == 0.0).then_some(base),
            layer: Layer::default(),
            rise: Rise::default(),
        }
    }

    /// Takes a bead with a cross-section of `area` that lies on `ground`.
    pub(super) fn bead(&mut self, step: &Move, area: Mm2, ground: &Ground) {
        if !counts(step.role) {
            return;
        }
        self.layer.bead(step, area);
        let (from, to) = (step.from.truncate(), step.to.truncate());
        // Places in the middle of steps of a cell's size, or less.
        let count = (from.distance(to) / CELL).ceil().max(1.0);
        let way = (step.to - step.from) / count;
        let length = step.length() / count;
        let mut run = Run::default();
        let mut pieces = 0.0;
        for k in 0..count as u32 {
            let at = step.from + (f64::from(k) + 0.5) * way;
            let cell = cell_of(at.truncate());
            let lies = self.rise_at(at.z, cell, ground);
            // Most of a bead lies on one thing, and stays in a window for some
            // cells: pieces that do are taken together.
            if lies != run.on || !run.has(cell) {
                self.cover(&run, area * length, step.height);
                if lies != run.on {
                    self.lies(run.on, pieces * length, step, area);
                    pieces = 0.0;
                }
                run = Run::new(cell, lies);
            }
            run.take(cell);
            pieces += 1.0;
        }
        self.cover(&run, area * length, step.height);
        self.lies(run.on, pieces * length, step, area);
    }

    /// Adds the places of a run to their window, each with a volume.
    fn cover(&mut self, run: &Run, volume: f64, height: Mm) {
        let Some((rise, _)) = run.on else { return };
        let Some(window) = self.layer.window(run.window) else {
            return;
        };
        let volume = run.count * volume;
        window.cells |= run.cells;
        window.volume += volume;
        window.weighed += volume * height.max(rise);
    }

    /// Takes a length of a bead that lies on the same all along.
    fn lies(&mut self, on: Lies, length: Mm, step: &Move, area: Mm2) {
        let height = self.high(on, step.height);
        self.layer.room += cross_section(step.width, height) * length;
        let Some((rise, below)) = on.filter(|_| length > 0.0) else {
            return;
        };
        self.layer.standing += area * length;
        self.layer.upright += height * length;
        self.layer.risen += rise.min(height) * length;
        let tells = match below {
            Below::Part => true,
            Below::Support => false,
            // What hangs above the bed beside what has been printed on it does not
            // lie on it.
            Below::Bed => !self.rise.has_begun(),
        };
        if tells {
            let told = cross_section(step.width, step.height);
            let said = (step.height, told);
            self.rise.bead(rise, length, area, said, step.role);
        }
    }

    /// What a nozzle at this height lays its bead on in a cell.
    fn rise_at(&self, z: Mm, cell: IVec2, ground: &Ground) -> Lies {
        let printed = ground.below(cell).map(|(top, is_support)| {
            let below = if is_support {
                Below::Support
            } else {
                Below::Part
            };
            (top, below)
        });
        let bed = || Some((self.bed?, Below::Bed));
        let (top, below) = printed.or_else(bed)?;
        Some((z - top, below))
    }

    /// How high a bead is at a place, if the file says `said`.
    pub(super) fn height(&self, at: DVec3, said: Mm, ground: &Ground) -> Mm {
        self.high(self.rise_at(at.z, cell_of(at.truncate()), ground), said)
    }

    /// How high a bead is that rises this far above what lies below it: it reaches
    /// down to that. Files that say no heights may have supports between layers,
    /// whose distance then is not the height of either. A bead that rises by more
    /// than the nozzle's width lies on nothing.
    fn high(&self, lies: Lies, said: Mm) -> Mm {
        let lies = lies.filter(|lies| lies.0 < self.nozzle + ROUNDING);
        lies.map_or(said, |(rise, _)| rise.max(said))
    }

    /// What is wrong with the rise of the layer with this number, which ends. `flow`
    /// are the least and the greatest one by the settings: a formula may ask for any,
    /// and then no step from layer to layer is too much.
    pub(super) fn rise(
        &mut self,
        number: u32,
        [least, most]: [f64; 2],
    ) -> Option<rise::Wrong> {
        let steps = most / least;
        self.rise.next_layer(number, steps)
    }

    /// Ends a layer. `flow` and `widths` are the least and the greatest ones by
    /// the settings.
    pub(super) fn next_layer(
        &mut self,
        flow: [f64; 2],
        widths: [Mm; 2],
    ) -> Option<Wrong> {
        std::mem::take(&mut self.layer).wrong(flow, widths)
    }
}

impl Layer {
    /// Takes in a bead with this cross-section.
    fn bead(&mut self, step: &Move, area: Mm2) {
        let length = step.length();
        self.line.get_or_insert(step.line);
        self.volume += area * length;
        self.says_width |= step.says_width;
        self.said += cross_section(step.width, step.height) * length;
        self.seen += step.height * length;
    }

    /// The window at a place, if there is room for it.
    fn window(&mut self, place: Place) -> Option<&mut Window> {
        if self.here.is_none_or(|here| here.0 != place) {
            let count = self.windows.len();
            let index = match self.places.get(&place) {
                Some(index) => *index,
                None if count == MOST_WINDOWS => return None,
                None => count,
            };
            if index == count {
                self.places.insert(place, index);
                self.windows.push(Window::default());
            }
            self.here = Some((place, index));
        }
        self.windows.get_mut(self.here?.1)
    }

    /// What is wrong with it, if its flow and its widths should be about these.
    fn wrong(self, flow: [f64; 2], widths: [Mm; 2]) -> Option<Wrong> {
        let line = self.line?;
        if self.seen < LITTLE {
            return None;
        }
        let [least, most] = flow;
        let beyond = |share: f64, little: f64, much: f64| {
            let usual = little * least..=much * most;
            (!usual.contains(&share)).then_some(share)
        };
        // If the file does not say how wide beads are, that follows from their
        // plastic, and the share is 1 whatever the flow is.
        let own = |share: f64, little: f64, much: f64| {
            let share = if self.says_width { share } else { share * most };
            beyond(share, little, much)
        };
        let little = own(self.volume / self.said, TOO_LITTLE, f64::INFINITY);
        let much = || own(self.volume / self.room, 0.0, TOO_MUCH);
        // Sparse infill may leave no cell uncovered, so that only too much is
        // wrong there.
        let filled = || beyond(self.filled()?, 0.0, TOO_MUCH);
        let [narrow, wide] = [TOO_NARROW * widths[0], TOO_WIDE * widths[1]];
        let enough = self.upright >= LITTLE;
        let width = self.standing / self.upright;
        let is_wide = || {
            let share = beyond(width, 0.0, wide)? / widths[0];
            enough.then_some(share)
        };
        // The first turn of a climbing wall begins at the height where the layer below
        // ends. How high it gets, no reader can tell before it has been printed.
        let is_narrow = || {
            beyond(self.standing / self.risen, narrow, f64::INFINITY)?;
            let share = beyond(width, narrow, f64::INFINITY)? / widths[0];
            enough.then_some(share)
        };
        let share = little.or_else(much).or_else(filled).or_else(is_wide);
        let share = share.or_else(is_narrow)?;
        Some(Wrong { line, share })
    }

    /// Share of the room in the windows that beads cover all over.
    fn filled(&self) -> Option<f64> {
        let all = self.windows.iter().filter(|window| window.is_covered());
        let (volume, room) = all.fold((0.0, 0.0), |(v, r), window| {
            let height = window.weighed / window.volume;
            (v + window.volume, r + WINDOW * height)
        });
        (room > 0.0).then(|| volume / room)
    }
}

impl Window {
    /// True if beads run through each cell, or beside it: wide beads leave cells
    /// between their centre lines.
    fn is_covered(&self) -> bool {
        // Bits of all cells but those of the first, or the last, column.
        const NOT_FIRST: u64 = 0xfefe_fefe_fefe_fefe;
        const NOT_LAST: u64 = NOT_FIRST >> 1;
        let row = self.cells
            | (self.cells & NOT_LAST) << 1
            | (self.cells & NOT_FIRST) >> 1;
        (row | row << SIDE | row >> SIDE) == u64::MAX
    }
}

/// True if beads of a role have the usual flow.
fn counts(role: Role) -> bool {
    matches!(
        role,
        Role::OuterWall
            | Role::InnerWall
            | Role::GapFill
            | Role::TopSkin
            | Role::BottomSkin
            | Role::Skin
            | Role::SparseInfill
            | Role::Unknown
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_base::units::filament_area;
    use isoslice_gcode_read::reader::{Event, Reader};

    /// What is found in a layer of lines `apart` from one another, each 12 mm
    /// long, with a share of the plastic that a line of that width needs.
    fn found(head: &str, apart: f64, share: f64) -> Option<Wrong> {
        let fed = share * 12.0 * apart * 0.2 / filament_area(1.75);
        let mut text = format!("M83\n{head}G1 Z0.2\n");
        let mut y = 50.0;
        while y < 62.0 {
            text += &format!("G1 X50 Y{y:.3}\nG1 X62 E{fed:.5}\n");
            y += apart;
        }
        let mut flow = Flow::new(0.0, 0.4);
        let ground = Ground::new(0.0, 0.4);
        for event in Reader::new(text.as_bytes()) {
            if let Event::Move(step) = event.unwrap()
                && step.prints()
            {
                flow.bead(&step, step.area(1.75), &ground);
            }
        }
        flow.next_layer([1.0, 1.0], [0.4, 1.0])
    }

    #[test]
    fn lines_side_by_side_share_the_room_of_the_layer() {
        for apart in [0.3, 0.41, 0.55, 0.8, 1.0] {
            for share in [0.9, 1.0, 1.15] {
                assert_eq!(found("", apart, share), None, "{apart} {share}");
            }
            for share in [2.0, 14.0] {
                let wrong = found("", apart, share).unwrap();
                assert_eq!(wrong.line, 4);
                assert!(wrong.share > TOO_MUCH, "{wrong:?}");
            }
        }
        // Sparse lines leave windows uncovered, and may be of any usual width.
        for share in [0.15, 0.25, 0.45] {
            assert_eq!(found("", 2.0, share), None, "{share}");
        }
        for share in [0.02, 0.8] {
            assert!(found("", 2.0, share).is_some(), "{share}");
        }
    }

    #[test]
    fn a_first_turn_that_climbs_has_room_by_how_far_it_rises() {
        /// What is found in walls of 4 × 25 mm: one on the bed, and one that climbs
        /// from its top by this much, with a share of the plastic that has room.
        fn found(rise: f64, share: f64) -> Option<Wrong> {
            let corners = [(75, 50), (75, 75), (50, 75), (50, 50)];
            let full = 25.0 * 0.4 / filament_area(1.75);
            let mut text = "M83\n;LAYER:0\nG1 X50 Y50 Z0.2\n".to_owned();
            for (x, y) in corners {
                text += &format!("G1 X{x} Y{y} E{:.5}\n", 0.2 * full);
            }
            text += ";LAYER:1\n";
            // The wall begins level, as one does that climbs less than is rounded.
            for k in 0..40 {
                let [a, b] = [corners[(k / 10 + 3) % 4], corners[k / 10]];
                let part = |a, b| {
                    f64::from(a) + f64::from(b - a) * 0.1 * (k % 10 + 1) as f64
                };
                let (x, y) = (part(a.0, b.0), part(a.1, b.1));
                let high = rise * k as f64 / 40.0;
                let fed = share * 0.1 * high * full;
                text += &format!("G1 X{x} Y{y} Z{:.3} E{fed:.5}\n", 0.2 + high);
            }
            let mut flow = Flow::new(0.0, 0.4);
            let mut ground = Ground::new(0.0, 0.4);
            let mut wrong = None;
            for event in Reader::new(text.as_bytes()) {
                match event.unwrap() {
                    Event::Move(step) if step.prints() => {
                        let area = step.area(1.75);
                        flow.bead(&step, area, &ground);
                        ground.bead(&step, area);
                    }
                    Event::Layer { .. } => {
                        wrong = wrong.or(flow.next_layer([1.0; 2], [0.4, 1.0]));
                        ground.next_layer(false, |_| {});
                    }
                    _ => {}
                }
            }
            wrong.or(flow.next_layer([1.0; 2], [0.4, 1.0]))
        }
        for rise in [0.03, 0.05, 0.1, 0.2] {
            assert_eq!(found(rise, 1.0), None, "{rise}");
            assert!(found(rise, 0.05).is_some(), "{rise}");
        }
    }

    #[test]
    fn what_the_file_says_of_beads_is_what_they_should_have() {
        let said = ";WIDTH:0.45\n;HEIGHT:0.2\n;TYPE:Perimeter\n";
        // Sparse lines of 2 mm² do not fit the width said.
        for (share, wrong) in
            [(0.05, true), (0.1, false), (0.2, false), (0.4, true)]
        {
            let is = found(said, 2.0, share).is_some();
            assert_eq!(is, wrong, "{share}");
        }
        let support = said.replace("Perimeter", "Support material");
        assert_eq!(found(&support, 2.0, 0.4), None);
    }
}

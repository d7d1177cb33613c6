//! Gathers the moves of a file, ready to be drawn, and their statistics.
//!
//! In: a [`Reader`]. Out: a [`Toolpath`]: flat arrays, one entry for each
//! move of the head, in the units in which the page keeps them, and the
//! statistics that it shows.

use glam::DVec3;
use isocontour::Bounds;
use isoslice_base::units::{Celsius, Mm, Mm3, Seconds, filament_area};
use isoslice_gcode_read::reader::{
    Event, Heater, Info, MachineState, Move, ReadError, Reader, Role,
};
use isoslice_gcode_read::reader::{Problems, USUAL_FILAMENT};
use isoslice_path::pace::clock::Clock;
use isoslice_path::pace::motion::Limits;
use isoslice_settings::Settings;
use serde::Serialize;
use std::io::Read;

/// Stands for a role in a move that does not print.
pub(super) const TRAVEL: u8 = Role::ALL.len() as u8;
/// Stands for a role in a jump, which is never drawn: homing.
pub(super) const JUMP: u8 = TRAVEL + 1;

/// Units of the arrays: lengths 1 µm, cross-sections 1e-4 mm², speeds 0.02
/// mm/s. Values beyond 16 bits (65 mm, 6.5 mm², 1300 mm/s) are cut to them.
pub(super) const LENGTH_UNIT: f64 = 1e-3;
pub(super) const AREA_UNIT: f64 = 1e-4;
pub(super) const SPEED_UNIT: f64 = 0.02;
/// Unit of temperatures, °C.
pub(super) const HEAT_UNIT: Celsius = 0.1;

/// Most moves of a page: what a browser can show, and half a gigabyte in this
/// program.
const MOST_MOVES: usize = 12_000_000;

/// Why there is no toolpath.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ToolpathError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file has too many moves.
    #[error(
        "line {line} brings it to more than {} million moves, more than a page \
         can show: show some layers at a time, of a model with --layers",
        .most / 1_000_000
    )]
    TooLong {
        /// The line of the first move beyond that number.
        line: u64,
        /// How many moves a toolpath may have.
        most: usize,
    },
}

/// Everything that a file prints, in order.
#[derive(Debug, Default)]
pub struct Toolpath {
    /// Where the head is before the first move and after each, mm.
    pub(super) points: Vec<[f32; 3]>,
    pub(super) widths: Vec<u16>,
    pub(super) heights: Vec<u16>,
    pub(super) areas: Vec<u16>,
    pub(super) speeds: Vec<u16>,
    /// Temperature of the nozzle, in units of [`HEAT_UNIT`]; 0 if none is set.
    pub(super) heats: Vec<u16>,
    /// Speed of the part's fan, in whole percent.
    pub(super) fans: Vec<u8>,
    /// [`Role`]s by their index in [`Role::ALL`], [`TRAVEL`] or [`JUMP`].
    pub(super) roles: Vec<u8>,
    pub(super) lines: Vec<u32>,
    pub(super) layers: Vec<Layer>,
    /// How many moves there were before each retraction.
    pub(super) retracted: Vec<u32>,
    pub(super) statistics: Statistics,
    problems: Problems,
}

/// A layer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Layer {
    /// Index of the layer's first move.
    pub first: u32,
    /// Height at which the layer is first printed.
    pub z: Mm,
    pub time: Seconds,
}

/// The share of a role, or of travels, in a print.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Share {
    /// Length of the moves.
    pub length: Mm,
    /// Estimated time of the moves.
    pub time: Seconds,
    /// Volume of the beads.
    pub volume: Mm3,
    /// Number of moves.
    pub moves: u64,
}

/// What a print takes and consists of.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Statistics {
    /// The program that made the file.
    pub generator: Option<String>,
    /// The print's time, as the file says.
    pub said_time: Option<Seconds>,
    /// The print's time as estimated from the moves, without heating.
    pub time: Seconds,
    /// Length of filament.
    pub filament: Mm,
    /// Mass of filament, grams, if the file tells it or the density.
    pub mass: Option<f64>,
    /// Price of the filament, in the user's currency.
    pub cost: Option<f64>,
    /// Corners of the printer's bed, in order.
    pub plate: Option<Vec<[Mm; 2]>>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Temperature of the nozzle that was set last.
    pub nozzle: Option<Celsius>,
    /// Temperature of the bed that was set last.
    pub bed: Option<Celsius>,
    /// Number of retractions.
    pub retractions: u64,
    /// Shares of the roles, by their index in [`Role::ALL`].
    pub roles: [Share; Role::ALL.len()],
    /// Share of travels.
    pub travel: Share,
    /// Lower and upper corner of the part, with the width of its beads, without
    /// supports, skirts and what templates print.
    pub part: Option<[[Mm; 3]; 2]>,
    /// Lower and upper corner of everything that is printed in layers.
    pub printed: Option<[[Mm; 3]; 2]>,
    /// Number of lines of the file.
    pub lines: u64,
}

impl Toolpath {
    /// Reads a file to its end.
    ///
    /// # Errors
    /// If it cannot be read, or has more moves than a page can show.
    pub fn read<R: Read>(reader: Reader<R>) -> Result<Self, ToolpathError> {
        Self::of_at_most(MOST_MOVES, reader)
    }

    fn of_at_most<R: Read>(
        most: usize,
        mut reader: Reader<R>,
    ) -> Result<Self, ToolpathError> {
        let mut collector = Collector::default();
        while let Some(event) = reader.next() {
            collector.take(event?, &reader);
            if collector.path.len() > most {
                let line = reader.lines();
                return Err(ToolpathError::TooLong { line, most });
            }
        }
        Ok(collector.finish(&reader))
    }

    /// True if nothing is printed.
    pub fn is_empty(&self) -> bool {
        self.statistics.printed.is_none()
    }

    /// Number of moves of the head.
    pub fn len(&self) -> usize {
        self.roles.len()
    }

    /// Number of layers.
    pub fn layer_count(&self) -> usize {
        self.layers.len()
    }

    /// What the print takes and consists of.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// The toolpath with what the settings know and files may not say: the bed,
    /// and what the filament costs.
    pub fn with_settings(mut self, settings: &Settings) -> Self {
        let [x, y] = [settings.printer.bed_x, settings.printer.bed_y];
        let statistics = &mut self.statistics;
        statistics.plate = Some(vec![[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]]);
        let cost = |mass| 1e-3 * mass * settings.filament.cost;
        statistics.cost = statistics.mass.map(cost).filter(|cost| *cost > 0.0);
        self
    }

    /// The toolpath with more warnings, which the page lists.
    pub fn with_warnings(mut self, warnings: &[String]) -> Self {
        self.statistics.warnings.extend_from_slice(warnings);
        self
    }

    /// The problems of the file.
    pub fn problems(&self) -> &Problems {
        &self.problems
    }
}

/// Puts a toolpath together.
#[derive(Debug)]
struct Collector {
    path: Toolpath,
    clock: Clock<u8>,
    /// Boxes of the part and of all that is printed.
    part: Bounds,
    printed: Bounds,
    /// Length of filament for each role.
    volume: [Mm; Role::ALL.len()],
    /// True while filament is pulled back.
    back: bool,
    /// True once the layer has a bead.
    begun: bool,
}

/// The box around a bead.
fn around(step: &Move) -> Bounds {
    let side = DVec3::new(0.5, 0.5, 0.0) * step.width;
    let below = DVec3::Z * step.height;
    Bounds::new(
        step.from.min(step.to) - side - below,
        step.from.max(step.to) + side,
    )
}

/// The lower and the upper corner of a box, unless it is empty.
fn corners(of: Bounds) -> Option<[[Mm; 3]; 2]> {
    let Bounds { min, max } = of;
    (min.x <= max.x).then(|| [min.to_array(), max.to_array()])
}

impl Default for Collector {
    fn default() -> Self {
        Self {
            path: Toolpath::default(),
            clock: Clock::new(Limits::default()),
            part: Bounds::EMPTY,
            printed: Bounds::EMPTY,
            volume: [0.0; Role::ALL.len()],
            back: false,
            begun: false,
        }
    }
}

impl Collector {
    fn take<R: Read>(&mut self, event: Event, reader: &Reader<R>) {
        match event {
            Event::Move(step) => self.step(&step, reader),
            Event::Layer { number, .. } => {
                self.rest(reader);
                if number == 1 {
                    self.path.layers.clear();
                    self.nothing_yet();
                    self.part = Bounds::EMPTY;
                    self.printed = Bounds::EMPTY;
                }
                let first = self.path.roles.len() as u32;
                self.path.layers.push(Layer {
                    first,
                    ..Layer::default()
                });
                self.begun = false;
            }
            Event::FirmwareRetract { back, .. } => {
                self.pull(if back { -1.0 } else { 1.0 });
            }
            Event::Heat { heater, to, .. } if to > 0.0 => {
                let statistics = &mut self.path.statistics;
                match heater {
                    Heater::Nozzle(_) => statistics.nozzle = Some(to),
                    Heater::Bed => statistics.bed = Some(to),
                    Heater::Chamber => {}
                }
            }
            Event::Dwell { time, .. } => self.add_time(time),
            _ => {}
        }
    }

    fn step<R: Read>(&mut self, step: &Move, reader: &Reader<R>) {
        self.path.statistics.filament += step.filament;
        self.pull(step.filament);
        let what = if step.prints() {
            step.role as u8
        } else {
            TRAVEL
        };
        self.clock.push(step, reader.state(), what);
        if self.clock.is_full() {
            self.rest(reader);
        }
        if !step.travels() {
            return;
        }
        let path = &mut self.path;
        let start = step.from.as_vec3().to_array();
        match path.points.last() {
            // The first position of the head is not known.
            None if what == TRAVEL => {
                path.points.push(step.to.as_vec3().to_array());
                return;
            }
            None => path.points.push(start),
            Some(last) if *last != start => {
                path.points.push(start);
                path.push(JUMP, Bead::default(), step, reader.state());
            }
            Some(_) => {}
        }
        path.points.push(step.to.as_vec3().to_array());
        // Some files tell the filament's diameter at their end only.
        let area = step.filament.max(0.0) / step.length();
        let bead = Bead {
            width: step.width,
            height: step.height,
            area: area * filament_area(USUAL_FILAMENT),
            speed: step.speed,
        };
        path.push(what, bead, step, reader.state());
        let share = match path.statistics.roles.get_mut(usize::from(what)) {
            Some(share) => share,
            None => &mut path.statistics.travel,
        };
        share.length += step.length();
        share.moves += 1;
        if what == TRAVEL {
            return;
        }
        self.volume[usize::from(what)] += step.filament;
        self.printed = self.printed.union(around(step));
        if is_part(step.role) {
            self.part = self.part.union(around(step));
        }
        if let Some(layer) = path.layers.last_mut()
            && !std::mem::replace(&mut self.begun, true)
        {
            layer.z = step.to.z;
        }
    }

    /// Forgets the boxes when the first layer begins. Beads before it that have
    /// no label are not the part: they start the flow.
    fn nothing_yet(&mut self) {
        let [from, to] = [Role::Unknown, Role::Custom].map(|r| r as usize);
        for role in &mut self.path.roles {
            if *role == from as u8 {
                *role = to as u8;
            }
        }
        let roles = &mut self.path.statistics.roles;
        let purged = std::mem::take(&mut roles[from]);
        roles[to].length += purged.length;
        roles[to].time += purged.time;
        roles[to].moves += purged.moves;
        self.volume[to] += std::mem::take(&mut self.volume[from]);
    }

    /// Takes in filament that goes forward or back.
    fn pull(&mut self, by: Mm) {
        if by < 0.0 && !self.back {
            self.path.statistics.retractions += 1;
            self.path.retracted.push(self.path.roles.len() as u32);
        }
        self.back = by < 0.0 || (self.back && by == 0.0);
    }

    fn rest<R: Read>(&mut self, reader: &Reader<R>) {
        let Self { path, clock, .. } = self;
        let statistics = &mut path.statistics;
        let mut sum = 0.0;
        clock.rest(reader.state(), |what, time| {
            sum += time;
            match statistics.roles.get_mut(usize::from(what)) {
                Some(share) => share.time += time,
                None => statistics.travel.time += time,
            }
        });
        self.add_time(sum);
    }

    fn add_time(&mut self, time: Seconds) {
        self.path.statistics.time += time;
        if let Some(layer) = self.path.layers.last_mut() {
            layer.time += time;
        }
    }

    fn finish<R: Read>(mut self, reader: &Reader<R>) -> Toolpath {
        self.rest(reader);
        let mut path = self.path;
        let info: &Info = reader.info();
        let diameter = info.filament_diameter.unwrap_or(USUAL_FILAMENT);
        let section = filament_area(diameter);
        let factor = section / filament_area(USUAL_FILAMENT);
        if factor != 1.0 {
            for area in &mut path.areas {
                *area = (f64::from(*area) * factor).round() as u16;
            }
        }
        let statistics = &mut path.statistics;
        for (share, fed) in statistics.roles.iter_mut().zip(self.volume) {
            share.volume = fed * section;
        }
        statistics.generator.clone_from(&info.generator);
        statistics.said_time = info.time;
        statistics.mass = info.filament_mass.or_else(|| {
            let density = info.filament_density?;
            Some(statistics.filament * section * 1e-3 * density)
        });
        statistics.cost = info.filament_cost;
        statistics.plate.clone_from(&info.bed);
        statistics.lines = reader.lines();
        statistics.printed = corners(self.printed);
        statistics.part = corners(self.part).or(statistics.printed);
        // Moves before the first layer are shown with it.
        if let Some(layer) = path.layers.first_mut() {
            layer.first = 0;
        }
        path.problems = reader.problems().clone();
        path
    }
}

/// The sizes of a bead, and how fast it is laid.
#[derive(Clone, Copy, Debug, Default)]
struct Bead {
    width: Mm,
    height: Mm,
    /// Cross-section, mm².
    area: f64,
    speed: f64,
}

impl Toolpath {
    fn push(
        &mut self,
        role: u8,
        bead: Bead,
        step: &Move,
        state: &MachineState,
    ) {
        // The casts stay within their range.
        self.widths.push((bead.width / LENGTH_UNIT).round() as u16);
        self.heights
            .push((bead.height / LENGTH_UNIT).round() as u16);
        self.areas.push((bead.area / AREA_UNIT).round() as u16);
        self.speeds.push((bead.speed / SPEED_UNIT).round() as u16);
        let heat = state.nozzle.unwrap_or(0.0);
        self.heats.push((heat / HEAT_UNIT).round() as u16);
        self.fans.push(state.fan.round() as u8);
        self.roles.push(role);
        self.lines
            .push(u32::try_from(step.line).unwrap_or(u32::MAX));
    }
}

/// True if beads of a role belong to the part.
fn is_part(role: Role) -> bool {
    !matches!(
        role,
        Role::Support
            | Role::SupportInterface
            | Role::SkirtBrim
            | Role::PrimeTower
            | Role::Custom
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_settings::testing::settings;

    fn read(text: &str) -> Toolpath {
        Toolpath::read(Reader::new(text.as_bytes())).unwrap()
    }

    const SQUARE: &str = "G28\nM109 S200\nG1 X5 Y5 Z0.3 F6000\nM83\n\
        ;TYPE:Custom\nG1 X50 E2 F1200\n;LAYER_CHANGE\n;HEIGHT:0.2\n\
        ;WIDTH:0.4\nG1 E-1 F1800\nG1 X10 Y10 Z0.2 F6000\nG1 E1 F1800\n\
        ;TYPE:Perimeter\nG1 X20 E0.4 F1200\nG1 Y20 E0.4\nG1 X10 E0.4\n\
        G1 Y10 E0.4\n; filament_density = 1.24\n";

    #[test]
    fn a_square_has_its_size_and_lengths() {
        let path = read(SQUARE);
        let s = &path.statistics;
        let wall = s.roles[Role::InnerWall as usize];
        assert_eq!((wall.length, wall.moves), (40.0, 4));
        let volume = 1.6 * filament_area(1.75);
        assert!((wall.volume - volume).abs() < 1e-9);
        assert_eq!(s.roles[Role::Custom as usize].length, 45.0);
        assert_eq!(s.retractions, 1);
        // One move of the start, the first known place being its beginning.
        assert_eq!(path.retracted, [1]);
        assert_eq!(path.heats, [2000; 6]);
        assert!((s.filament - 3.6).abs() < 1e-9);
        assert!(
            (s.mass.unwrap() - 3.6e-3 * 1.24 * filament_area(1.75)).abs()
                < 1e-9
        );
        assert_eq!(s.nozzle, Some(200.0));
        // Centre lines of 10 mm and half a width on either side.
        let [min, max] = s.part.unwrap();
        let expected = [10.4, 10.4, 0.2];
        for i in 0..3 {
            assert!((max[i] - min[i] - expected[i]).abs() < 1e-9, "{i}");
        }
        assert_eq!(path.layer_count(), 1);
        assert_eq!((path.layers[0].first, path.layers[0].z), (0, 0.2));
    }

    #[test]
    fn times_add_up() {
        let path = read(SQUARE);
        let s = &path.statistics;
        let roles: f64 = s.roles.iter().map(|r| r.time).sum();
        assert!((roles + s.travel.time - s.time).abs() < 1e-9);
        // 40 mm at 20 mm/s, and a little for four corners.
        let wall = s.roles[Role::InnerWall as usize].time;
        assert!(wall > 2.0 && wall < 2.2, "{wall}");
    }

    #[test]
    fn fans_and_heat_are_those_of_each_move() {
        let path = read(
            "M104 S215.5\nG1 X1 E1\nM106 S128\nG1 X2 E2\nM109 S200\nM107\n\
             G1 X3\n",
        );
        assert_eq!(path.fans, [0, 50, 0]);
        assert_eq!(path.heats, [2155, 2155, 2000]);
    }

    #[test]
    fn the_settings_know_the_bed_and_the_price() {
        let path = read(SQUARE).with_settings(&settings(&[]));
        let s = path.statistics();
        let mass = s.mass.unwrap();
        assert!((s.cost.unwrap() - 25e-3 * mass).abs() < 1e-9);
        assert_eq!(s.plate.as_ref().unwrap()[2], [220.0; 2]);
        let path = path.with_warnings(&["it sags".to_owned()]);
        assert_eq!(path.statistics.warnings, ["it sags"]);
    }

    #[test]
    fn homing_leaves_a_gap_and_no_line() {
        let text = "G1 X10 E1\nG1 X20 E2\nG28\nG1 Y5 E3\n";
        let path = read(text);
        let role = Role::Unknown as u8;
        assert_eq!(path.roles, [role, role, JUMP, role]);
        assert_eq!(path.points.len(), path.len() + 1);
        assert_eq!(path.points[3], [0.0; 3]);
    }

    #[test]
    fn a_file_with_too_many_moves_is_an_error() {
        let text = "G1 X10 Y10 E1 F600\nG2 I5 J0 E2\nG1 X0 E3\n";
        let read =
            |most| Toolpath::of_at_most(most, Reader::new(text.as_bytes()));
        let moves = read(1000).unwrap().len();
        assert!(moves > 50, "{moves}");
        assert!(read(moves).is_ok());
        // An arc is not kept as a whole either.
        let error = read(20).unwrap_err();
        assert!(matches!(
            error,
            ToolpathError::TooLong { line: 2, most: 20 }
        ));
    }

    #[test]
    fn nothing_printed_is_empty() {
        assert!(read("").is_empty());
        assert!(read("G1 X5\nG1 E5\n").is_empty());
        assert!(!read("G1 X5 E5\n").is_empty());
    }
}

//! What a file says about itself: who made it, and what the print takes.
//!
//! In: comments. Out: [`Info`]. Nothing here is checked against the moves.

use super::comments::{after, positive_or_zero};
use isoslice_base::units::{Mm, Seconds};

/// Longest name that is kept, bytes.
const LONGEST_NAME: usize = 120;

/// Longest outline of a bed that is read, bytes: round ones have 72 corners.
const LONGEST_OUTLINE: usize = 1 << 14;
/// Greatest coordinate of a bed.
const FARTHEST: Mm = 1e4;

/// What a file's comments say about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Info {
    /// The program that made the file, and its version.
    pub generator: Option<String>,
    /// How long the print takes.
    pub time: Option<Seconds>,
    /// Length of filament.
    pub filament_length: Option<Mm>,
    /// Mass of filament, grams.
    pub filament_mass: Option<f64>,
    /// Diameter of the filament.
    pub filament_diameter: Option<Mm>,
    /// Number of filaments; 0 if the file does not say.
    pub filaments: usize,
    /// Density of the filament, g/cm³.
    pub filament_density: Option<f64>,
    /// Price of the filament, in the user's currency.
    pub filament_cost: Option<f64>,
    /// Corners of the bed, in order.
    pub bed: Option<Vec<[Mm; 2]>>,
    /// True once the program's mark after the last layer has come; none if the
    /// program is not known to set one.
    pub ended: Option<bool>,
    /// True if the file's names of walls are those of slicers that tell
    /// overhangs apart. Cura does not.
    pub calls_overhangs: bool,
}

impl Info {
    /// Takes in a comment, without its semicolon.
    pub(super) fn comment(&mut self, comment: &[u8]) {
        let comment = comment.trim_ascii();
        // There may be 100,000 comments; those that matter begin with a word.
        if comment.len() < 6 || !comment[0].is_ascii_alphabetic() {
            return;
        }
        if self.generator.is_none()
            && let Some(name) = generator(comment)
        {
            // isoslice's files have an end mark only if layers have marks: see
            // `layer_mark`.
            let marks = ["PrusaSlicer", "SuperSlicer", "OrcaSlicer", "Cura"];
            if marks.iter().any(|m| name.starts_with(m)) {
                self.ended.get_or_insert(false);
            }
            self.generator = Some(name);
            return;
        }
        self.ending(comment);
        let Some(at) = memchr::memchr2(b'=', b':', comment) else {
            return;
        };
        let (key, value) = (comment[..at].trim_ascii(), &comment[at + 1..]);
        // Orca: `model printing time: 1h 2m; total estimated time: 1h 5m`
        let total = b"total estimated time: ";
        if key == b"model printing time"
            && let Some(at) = memchr::memmem::find(comment, total)
        {
            self.time = time(&comment[at + total.len()..]).or(self.time);
            return;
        }
        match key {
            b"estimated printing time (normal mode)" => {
                self.time = time(value).or(self.time);
            }
            // Cura writes several such comments. The last one counts, which is
            // the time of the whole print.
            b"TIME" => self.time = positive(value).or(self.time),
            b"filament used [mm]" | b"total filament length [mm]" => {
                self.filament_length = sum(value).or(self.filament_length);
            }
            b"Filament used" => {
                let metres = value.split(|b| *b == b',').filter_map(|m| {
                    m.trim_ascii().strip_suffix(b"m").and_then(positive)
                });
                let length = metres.reduce(|a, b| a + b).map(|m| 1e3 * m);
                self.filament_length = length.or(self.filament_length);
            }
            b"filament used [g]" | b"total filament weight [g]" => {
                self.filament_mass = sum(value).or(self.filament_mass);
            }
            b"filament cost" | b"total filament cost" => {
                self.filament_cost = sum(value).or(self.filament_cost);
            }
            // PrusaSlicer, and Orca.
            b"bed_shape" | b"printable_area" => {
                self.bed = outline(value).or_else(|| self.bed.take());
            }
            b"filament_diameter" => {
                let likely = |d: &f64| (0.5..10.0).contains(d);
                self.filaments = numbers(value).filter(likely).count();
                let given = first(value).filter(likely);
                self.filament_diameter = given.or(self.filament_diameter);
            }
            b"filament_density" => {
                let given = first(value).filter(|d| (0.1..30.0).contains(d));
                self.filament_density = given.or(self.filament_density);
            }
            _ => {}
        }
    }
}

impl Info {
    /// Takes in a comment that says what follows is an outer wall.
    pub(super) fn outer_wall(&mut self, comment: &[u8]) {
        self.calls_overhangs = !comment.ends_with(b"WALL-OUTER");
    }

    /// Takes in the mark of a layer.
    pub(super) fn layer_mark(&mut self) {
        if self.ended.is_none() && self.is_ours() {
            self.ended = Some(false);
        }
    }

    fn is_ours(&self) -> bool {
        let ours = |name: &String| name.starts_with("isoslice");
        self.generator.as_ref().is_some_and(ours)
    }

    /// Takes in a comment, which may be a mark after the last layer.
    /// PrusaSlicer writes figures and settings there, Orca and Bambu Studio a
    /// block.
    fn ending(&mut self, comment: &[u8]) {
        let ends = match comment {
            b"end of layers" => self.is_ours(),
            b"EXECUTABLE_BLOCK_START" => {
                self.ended = Some(false);
                false
            }
            b"EXECUTABLE_BLOCK_END" | b"End of Gcode" => true,
            _ => {
                self.ended.is_some()
                    && !self.is_ours()
                    && (comment.starts_with(b"filament used [mm]")
                        || comment.ends_with(b"slicer_config = end"))
            }
        };
        if ends {
            self.ended = Some(true);
        }
    }
}

/// The program's name in `generated by NAME VERSION on DATE`.
fn generator(comment: &[u8]) -> Option<String> {
    let start = comment.get(..15)?;
    if !start[..10].eq_ignore_ascii_case(b"generated ") {
        return None;
    }
    let name = after(&comment[10..], "by ")
        .or_else(|| after(&comment[10..], "with "))?;
    let end = memchr::memmem::find(name, b" on ").unwrap_or(name.len());
    let name = &name[..end.min(LONGEST_NAME)];
    // Terminals show the name and obey control characters.
    let name = String::from_utf8_lossy(name)
        .replace(|c: char| c == '_' || c.is_control(), " ");
    let name = name.trim().to_owned();
    (!name.is_empty()).then_some(name)
}

/// The time `1d 2h 3m 4s`, in which any part may be missing.
fn time(text: &[u8]) -> Option<Seconds> {
    let mut total = None;
    for word in text.trim_ascii().split(|b| *b == b' ') {
        let (unit, digits) = word.split_last()?;
        let seconds = match unit {
            b'd' => 86_400.0,
            b'h' => 3600.0,
            b'm' => 60.0,
            b's' => 1.0,
            _ => return total,
        };
        let number = positive_or_zero(digits)?;
        total = Some(total.unwrap_or(0.0) + seconds * number);
    }
    total
}

fn positive(text: &[u8]) -> Option<f64> {
    positive_or_zero(text).filter(|n| *n > 0.0)
}

/// The corners `0x0,250x0,250x210,0x210`.
fn outline(text: &[u8]) -> Option<Vec<[Mm; 2]>> {
    let corner = |text: &[u8]| {
        let (x, y) = std::str::from_utf8(text).ok()?.split_once('x')?;
        let [x, y] = [x, y].map(|n| n.trim().parse::<Mm>().ok());
        let corner = [x?, y?];
        corner.iter().all(|n| n.abs() <= FARTHEST).then_some(corner)
    };
    if text.len() > LONGEST_OUTLINE {
        return None;
    }
    let corners: Option<Vec<_>> =
        text.split(|b| *b == b',').map(corner).collect();
    corners.filter(|corners| corners.len() > 2)
}

/// The numbers of a list that has one for each filament.
fn numbers(text: &[u8]) -> impl Iterator<Item = f64> {
    text.split(|b| matches!(b, b',' | b';'))
        .filter_map(positive)
}

/// The first number of a list that has one for each filament.
fn first(text: &[u8]) -> Option<f64> {
    numbers(text).next()
}

/// The sum of a list that has a number for each filament.
fn sum(text: &[u8]) -> Option<f64> {
    numbers(text).reduce(|a, b| a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(comments: &[&str]) -> Info {
        let mut info = Info::default();
        for comment in comments {
            info.comment(comment.as_bytes());
        }
        info
    }

    #[test]
    fn prusa_orca_and_cura_say_it_in_their_ways() {
        let prusa = info(&[
            " generated by PrusaSlicer 2.9.0 on 2026-01-01 at 12:00:00 UTC",
            " filament used [mm] = 1200.50, 99.50",
            " filament used [g] = 3.5",
            " filament_diameter = 1.75,2.85",
            " estimated printing time (normal mode) = 1d 2h 3m 4s",
        ]);
        assert_eq!(prusa.generator.as_deref(), Some("PrusaSlicer 2.9.0"));
        assert_eq!(prusa.filament_length, Some(1300.0));
        assert_eq!(prusa.filament_mass, Some(3.5));
        assert_eq!(prusa.filament_diameter, Some(1.75));
        assert_eq!(prusa.filaments, 2);
        assert_eq!(prusa.time, Some(93_784.0));
        let square = info(&[
            " total filament cost = 0.42",
            " bed_shape = 0x0,250x0,250x-210.5,0x-210.5",
        ]);
        assert_eq!(square.filament_cost, Some(0.42));
        let [x, y] = [250.0, -210.5];
        let corners = vec![[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]];
        assert_eq!(square.bed, Some(corners));

        let orca = info(&[
            " generated by OrcaSlicer 2.3.0 on 2026-01-01 at 12:00:00",
            " model printing time: 20m 1s; total estimated time: 26m 2s",
            " total filament length [mm] : 1000.25",
        ]);
        assert_eq!(orca.generator.as_deref(), Some("OrcaSlicer 2.3.0"));
        assert_eq!(orca.time, Some(1562.0));
        assert_eq!(orca.filament_length, Some(1000.25));

        let cura = info(&[
            "Generated with Cura_SteamEngine 5.9.0",
            "TIME:6666",
            "Filament used: 1.5m, 0m",
        ]);
        let name = cura.generator.as_deref();
        assert_eq!(name, Some("Cura SteamEngine 5.9.0"));
        assert_eq!(cura.time, Some(6666.0));
        assert_eq!(cura.filament_length, Some(1500.0));
    }

    #[test]
    fn no_name_commands_a_terminal() {
        let evil = info(&["generated by \x1b]0;x\x07\u{9b}Evil on 2026"]);
        assert_eq!(evil.generator.as_deref(), Some("]0;x  Evil"));
    }

    #[test]
    fn nonsense_says_nothing() {
        let nothing = info(&[
            "",
            "generated by ",
            "TIME:nan",
            "TIME:-5",
            "Filament used: xm",
            "filament_diameter = 1e300",
            "filament used [mm] =",
            "estimated printing time (normal mode) = soon",
            "a = b",
            "bed_shape = 0x0,1x0,nanx1",
            "bed_shape = 0x0,1x0",
            "printable_area = 0x0,1x0,1x1e9",
            "filament cost = -1",
        ]);
        assert_eq!(nothing, Info::default());
    }
}

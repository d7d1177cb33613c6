//! A file of profiles, of whichever slicer.

use crate::values::Values;
use crate::{
    Error, PresetKind, archive, cura, formula, gcode, ini, orca, project,
};
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Greatest length of a file that is read whole, bytes. The longest of the
/// slicers' own files has 2 MB.
pub(crate) const MOST_BYTES: u64 = 16 << 20;

/// Greatest number of names in a message.
const MOST_NAMES: usize = 5;

/// The slicer to whose words a file's keys belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Slicer {
    /// PrusaSlicer and SuperSlicer.
    Prusa,
    /// OrcaSlicer, Bambu Studio and their descendants.
    Orca,
    /// Cura.
    Cura,
}

impl Slicer {
    /// The slicer's name.
    pub fn name(self) -> &'static str {
        match self {
            Slicer::Prusa => "PrusaSlicer",
            Slicer::Orca => "OrcaSlicer",
            Slicer::Cura => "Cura",
        }
    }
}

/// A profile in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// The kind of the profile.
    pub kind: PresetKind,
    /// The profile's name.
    pub name: String,
}

/// What a file holds.
#[derive(Debug)]
enum Held {
    /// A bundle of PrusaSlicer's.
    Bundle(ini::Ini),
    /// One configuration, with its name and kind if the file says so.
    One {
        values: Values,
        name: Option<String>,
        kind: Option<PresetKind>,
    },
}

/// A file of profiles.
#[derive(Debug)]
pub struct Source {
    path: PathBuf,
    /// The slicer to whose words the file's keys belong.
    pub slicer: Slicer,
    /// Keys that an .ini file gives more than once in a section. The last one
    /// counts.
    pub repeated: BTreeSet<String>,
    held: Held,
}

/// The profiles that were chosen from a file.
#[derive(Clone, Debug)]
pub struct Picked {
    /// The slicer to whose words the keys belong.
    pub slicer: Slicer,
    /// The profiles' names; empty if the file has no names.
    pub names: Vec<Named>,
    /// The profiles' kinds; empty if the file holds a whole configuration.
    pub kinds: Vec<PresetKind>,
    /// All values.
    pub values: Values,
}

impl Source {
    /// Reads a file. Parents of OrcaSlicer's profiles are looked for beside it
    /// and in the folders `beside`.
    ///
    /// # Errors
    /// If the file cannot be read, is too large, or is not a profile.
    pub fn open(path: &Path, beside: &[PathBuf]) -> Result<Source, Error> {
        let wrong = Error::wrong(path);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.to_ascii_lowercase();
        let ends = |of: &[&str]| of.iter().any(|end| name.ends_with(end));
        if ends(&[".gcode", ".gco", ".g"]) {
            let text = both_ends(path)?;
            let values = gcode::read(&text).ok_or_else(|| {
                wrong(
                    "there is no configuration in its first or last 4 MB; \
                     PrusaSlicer, OrcaSlicer and Bambu Studio write one, as \
                     lines `; key = value`"
                        .to_owned(),
                )
            })?;
            let slicer = of_words(&values);
            return Ok(Source::one(path, slicer, values, None, None));
        }
        if ends(&[".3mf"]) {
            let found = project::settings(regular(path)?);
            let (slicer, text) = found.map_err(wrong)?;
            let values = if slicer == Slicer::Prusa {
                // It has the form of what G-code ends with.
                gcode::read(&text).ok_or_else(|| {
                    let few = "its configuration has hardly any keys; let \
                               PrusaSlicer export it as .ini";
                    wrong(few.to_owned())
                })?
            } else {
                orca::read(&text).map_err(wrong)?.values
            };
            return Ok(Source::one(path, slicer, values, None, None));
        }
        if ends(&[".bgcode", ".stl", ".orca_printer", ".bbscfg"]) {
            return Err(wrong(
                "isoslice reads no profiles from such files; let the slicer \
                 export them as .ini or .json, or give its G-code as text"
                    .to_owned(),
            ));
        }
        let bytes = bytes_of(path, MOST_BYTES)?;
        if ends(&[".curaprofile"]) {
            let values = cura::zipped(bytes).map_err(wrong)?;
            return Ok(Source::one(path, Slicer::Cura, values, None, None));
        }
        let text = String::from_utf8_lossy(&bytes);
        let text = text.trim_start_matches('\u{feff}');
        if ends(&[".def.json"]) {
            let json = serde_json::from_str(text)
                .map_err(|e| wrong(format!("it is not JSON: {e}")))?;
            let (values, name) = cura::definition(path, &json)?;
            let kind = Some(PresetKind::Printer);
            return Ok(Source::one(path, Slicer::Cura, values, name, kind));
        }
        if text.trim_start().starts_with('{') {
            let own = orca::read(text).map_err(wrong)?;
            if own.values.keys().any(|key| key.ends_with("_list")) {
                return Err(wrong(
                    "it only lists a maker's profiles; give one of the files \
                     in its folder, such as machine/NAME.json"
                        .to_owned(),
                ));
            }
            let all = orca::resolve(path, own, beside)?;
            let (values, name, kind) = (all.values, all.name, all.kind);
            return Ok(Source::one(path, Slicer::Orca, values, name, kind));
        }
        if text.lines().any(|line| line.trim() == "[values]") {
            let (_, values) = cura::instance(text);
            return Ok(Source::one(path, Slicer::Cura, values, None, None));
        }
        let mut ini = ini::read(text);
        let repeated = std::mem::take(&mut ini.repeated);
        let entries = ini.plain.len();
        if ini.is_bundle() {
            return Ok(Source {
                path: path.to_owned(),
                slicer: Slicer::Prusa,
                repeated,
                held: Held::Bundle(ini),
            });
        }
        if entries == 0 || ini.odd > entries {
            return Err(wrong(
                "it is no profile that isoslice knows: those of PrusaSlicer \
                 (.ini), OrcaSlicer and Bambu Studio (.json), Cura \
                 (.curaprofile, .def.json), and their G-code (.gcode)"
                    .to_owned(),
            ));
        }
        let slicer = of_words(&ini.plain);
        Ok(Source {
            repeated,
            ..Source::one(path, slicer, ini.plain, None, None)
        })
    }

    fn one(
        path: &Path,
        slicer: Slicer,
        values: Values,
        name: Option<String>,
        kind: Option<PresetKind>,
    ) -> Source {
        let mut values = values;
        if slicer == Slicer::Cura {
            formula::solve(&mut values);
        }
        Source {
            path: path.to_owned(),
            slicer,
            repeated: BTreeSet::new(),
            held: Held::One { values, name, kind },
        }
    }

    /// The profiles in a bundle, sorted; empty if the file is not a bundle.
    pub fn list(&self) -> Vec<Named> {
        match &self.held {
            Held::Bundle(ini) => ini.list(),
            Held::One { .. } => Vec::new(),
        }
    }

    /// The profiles of these names, at most one of each kind. A file that is
    /// not a bundle needs no names.
    ///
    /// # Errors
    /// If there is no such profile, or names are missing.
    pub fn pick(&self, names: &[String]) -> Result<Picked, Error> {
        let ini = match &self.held {
            Held::Bundle(ini) => ini,
            Held::One { values, name, kind } => {
                if let Some(given) = names.first() {
                    return Err(self.choose(format!(
                        "it holds one profile, so there is nothing to choose \
                         with --name {given:?}"
                    )));
                }
                let named = kind.zip(name.clone());
                let named = named.map(|(kind, name)| Named { kind, name });
                return Ok(Picked {
                    slicer: self.slicer,
                    names: named.into_iter().collect(),
                    kinds: kind.iter().copied().collect(),
                    values: values.clone(),
                });
            }
        };
        let all = ini.list();
        let names = if let ([], [only]) = (names, all.as_slice()) {
            std::slice::from_ref(&only.name)
        } else {
            names
        };
        if names.is_empty() {
            let count = |kind| all.iter().filter(|n| n.kind == kind).count();
            return Err(self.choose(format!(
                "it holds {} printers, {} filaments and {} kinds of print; \
                 --list names them, and --name NAME chooses, once for each \
                 kind",
                count(PresetKind::Printer),
                count(PresetKind::Filament),
                count(PresetKind::Print)
            )));
        }
        let mut picked = Picked {
            slicer: self.slicer,
            names: Vec::new(),
            kinds: Vec::new(),
            values: Values::default(),
        };
        for name in names {
            let found = self.find(&all, name)?;
            if picked.kinds.contains(&found.kind) {
                return Err(self.choose(format!(
                    "two names of the kind {} are given; one is allowed",
                    found.kind.word()
                )));
            }
            let values = ini
                .resolve(found.kind, &found.name)
                .map_err(Error::wrong(&self.path))?;
            picked.values.inherit(&values);
            picked.kinds.push(found.kind);
            picked.names.push(found.clone());
        }
        Ok(picked)
    }

    /// The profile of a name, which may have its kind before it:
    /// `printer:NAME`.
    fn find<'a>(
        &self,
        all: &'a [Named],
        given: &str,
    ) -> Result<&'a Named, Error> {
        let (kind, name) = match given.split_once(':') {
            Some((word, rest)) if PresetKind::of_word(word).is_some() => {
                (PresetKind::of_word(word), rest.trim())
            }
            _ => (None, given.trim()),
        };
        let of_kind = |n: &&Named| kind.is_none_or(|kind| n.kind == kind);
        let mut exact = all.iter().filter(of_kind).filter(|n| n.name == name);
        match (exact.next(), exact.next()) {
            (Some(found), None) => return Ok(found),
            (Some(_), Some(_)) => {
                return Err(self.choose(format!(
                    "it holds profiles of several kinds with the name \
                     {name:?}; say printer:NAME, filament:NAME or print:NAME"
                )));
            }
            (None, _) => {}
        }
        let lower = name.to_lowercase();
        let like = |n: &&Named| n.name.to_lowercase().contains(&lower);
        let near: Vec<_> = all
            .iter()
            .filter(of_kind)
            .filter(like)
            .map(|n| format!("{:?}", n.name))
            .collect();
        let more = if near.len() > MOST_NAMES { ", …" } else { "" };
        let near = &near[..near.len().min(MOST_NAMES)];
        Err(self.choose(match near {
            [] => format!("there is no {name:?} in it; --list names all"),
            some => format!(
                "there is no {name:?} in it; there are {}{more}",
                some.join(", ")
            ),
        }))
    }

    fn choose(&self, message: String) -> Error {
        Error::Choose {
            path: self.path.clone(),
            message,
        }
    }
}

/// The slicer to whose words the keys of a configuration belong.
fn of_words(values: &Values) -> Slicer {
    const OF_ORCA: [&str; 4] = [
        "wall_loops",
        "outer_wall_speed",
        "nozzle_temperature",
        "printable_area",
    ];
    if OF_ORCA.iter().any(|key| values.has(key)) {
        Slicer::Orca
    } else {
        Slicer::Prusa
    }
}

/// The bytes of a file, if there are no more than `most`.
pub(crate) fn bytes_of(path: &Path, most: u64) -> Result<Vec<u8>, Error> {
    let bytes = archive::up_to(regular(path)?, most);
    bytes.map_err(Error::unreadable(path))?.ok_or_else(|| {
        let most = most >> 20;
        Error::wrong(path)(format!(
            "it is larger than {most} MB, which no profile is"
        ))
    })
}

/// Opens a file. Folders, pipes and devices are refused, since they may have no
/// end.
fn regular(path: &Path) -> Result<File, Error> {
    let unreadable = Error::unreadable(path);
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        let cause = std::io::Error::other("it is no regular file");
        return Err(unreadable(cause));
    }
    File::open(path).map_err(unreadable)
}

/// The text at the beginning and at the end of a file, 4 MB of each.
///
/// # Errors
/// If the file cannot be read.
pub fn both_ends(path: &Path) -> Result<String, Error> {
    let unreadable = Error::unreadable(path);
    let mut file = regular(path)?;
    let length = file.metadata().map_err(unreadable)?.len();
    let mut bytes = Vec::new();
    (&mut file)
        .take(gcode::EACH_END)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if length > gcode::EACH_END {
        let from = length.saturating_sub(gcode::EACH_END).max(gcode::EACH_END);
        file.seek(SeekFrom::Start(from)).map_err(unreadable)?;
        bytes.push(b'\n');
        file.take(gcode::EACH_END)
            .read_to_end(&mut bytes)
            .map_err(unreadable)?;
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

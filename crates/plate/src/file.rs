//! Reads a plate from a file.
//!
//! ```toml
//! settings = { layer_height = 0.15 }   # of all parts
//!
//! [[part]]
//! model = "bracket.rhai"
//! copies = 4
//! params = { hole = 5 }
//! rotate = 90
//! settings = { walls = 3, infill_density = 40 }
//!
//! [[part]]
//! model = "plug.vm"
//! at = [30, 30]
//! ```
//!
//! In: the file, and the settings before it. Out: what is wanted, and the
//! plate's settings. Paths start from the file's folder. Guaranteed: no key is
//! ignored.

use super::{Plate, PlateError, Wanted};
use isoslice_base::files::{self, MAX_SETTINGS_BYTES};
use isoslice_model::{Placement, Source};
use isoslice_settings::Builder;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A plate file that has been read.
#[derive(Clone, Debug)]
pub struct PlateFile {
    /// The parts that are wanted.
    pub parts: Vec<Wanted>,
    /// What holds for the whole plate, and where it is from.
    pub builder: Builder,
    /// What the user should know of the settings.
    pub warnings: Vec<String>,
    /// The models' files.
    pub models: Vec<PathBuf>,
}

/// Width of the largest bed, mm: the limit of `printer.bed_x` and
/// `printer.bed_y`.
const LARGEST_BED: f64 = 10_000.0;

/// Keys of the file, and of a part.
const KEYS: [&str; 2] = ["settings", "part"];
const PART: [&str; 9] = [
    "model", "copies", "params", "at", "lay", "rotate", "scale", "size",
    "settings",
];

impl PlateFile {
    /// Reads a plate file. `builder` has the settings before it; `sets` are
    /// assignments that win over the settings of the whole plate.
    ///
    /// # Errors
    /// If the file cannot be read, has an unknown key, or a value is wrong.
    pub fn read(
        path: &Path,
        mut builder: Builder,
        sets: &[String],
    ) -> Result<PlateFile, PlateError> {
        let name = path.display().to_string();
        let text = files::read_text(path, MAX_SETTINGS_BYTES).map_err(|e| {
            PlateError::Unreadable {
                file: name.clone(),
                cause: e.to_string(),
            }
        })?;
        let text = text.replace("\r\n", "\n");
        let file = File {
            name: &name,
            text: &text,
            folder: path.parent().unwrap_or(Path::new("")),
        };
        let table = DeTable::parse(&text).map_err(|e| {
            let at = e.span().map_or(0, |span| span.start);
            let what = e.message().replace('\n', ", ");
            file.wrong(at, format!("{what}; a plate file is TOML"))
        })?;
        let table = table.get_ref();
        file.only(table, &KEYS, "a plate file")?;
        if let Some(of_all) = table.get("settings") {
            let of_all = file.table(of_all, "settings")?;
            builder.table(of_all, &text, &name)?;
            for set in sets {
                builder.set(set)?;
            }
        }
        let (_, mut warnings) = builder.clone().finish()?;
        let parts = match table.get("part").map(|p| (p, p.get_ref())) {
            Some((_, DeValue::Array(parts))) => parts,
            Some((part, _)) => {
                let at = part.span().start;
                let how = "write each part below a line of its own, [[part]]";
                return Err(file.wrong(at, how.to_owned()));
            }
            None => {
                let how = "there is no part; write each below a line [[part]], \
                           with model = \"part.rhai\"";
                return Err(file.wrong(0, how.to_owned()));
            }
        };
        if parts.len() as u64 > Plate::MOST_PARTS {
            let count = parts.len() as u64;
            let at = parts.get(Plate::MOST_PARTS as usize);
            let at = at.map_or(0, |part| part.span().start);
            let error = PlateError::TooMany { count };
            return Err(file.wrong(at, error.to_string()));
        }
        let mut wanted = Vec::new();
        let mut models = Vec::new();
        for part in parts {
            let table = file.table(part, "part")?;
            let (one, told) = file.part(table, part.span().start, &builder)?;
            for warning in told {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
            if let Source::File(path) = &one.source
                && !models.contains(path)
            {
                models.push(path.clone());
            }
            wanted.push(one);
        }
        Ok(PlateFile {
            parts: wanted,
            builder,
            warnings,
            models,
        })
    }
}

/// A file that is being read.
struct File<'a> {
    name: &'a str,
    text: &'a str,
    /// The folder that paths in the file start from.
    folder: &'a Path,
}

impl File<'_> {
    /// The file's name, and the line of a byte of the file.
    fn place(&self, byte: usize) -> String {
        let before = self.text.bytes().take(byte);
        let line = 1 + before.filter(|b| *b == b'\n').count();
        format!("{}:{line}", self.name)
    }

    fn wrong(&self, byte: usize, message: String) -> PlateError {
        let place = self.place(byte);
        PlateError::File { place, message }
    }

    /// Refuses keys other than the `known` ones.
    fn only(
        &self,
        table: &DeTable<'_>,
        known: &[&str],
        what: &str,
    ) -> Result<(), PlateError> {
        let mut unknown: Vec<_> = table
            .keys()
            .filter(|key| !known.contains(&key.get_ref().as_ref()))
            .collect();
        unknown.sort_by_key(|key| key.span().start);
        let Some(key) = unknown.first() else {
            return Ok(());
        };
        let name = key.get_ref();
        let is_setting = isoslice_settings::keys()
            .iter()
            .any(|k| k.name.split('.').next() == Some(name));
        let alike = |a: &str| strsim::jaro_winkler(a, name);
        let nearest = known
            .iter()
            .max_by(|a, b| alike(a).total_cmp(&alike(b)))
            .filter(|known| alike(known) > 0.75);
        let hint = match nearest {
            _ if is_setting => {
                format!("settings stand in settings = {{ {name} = … }}")
            }
            Some(near) => format!("did you mean {near}?"),
            None => format!("it has {}", known.join(", ")),
        };
        let message = format!("{what} has no key {name:?}; {hint}");
        Err(self.wrong(key.span().start, message))
    }

    fn table<'t, 'v>(
        &self,
        value: &'t Spanned<DeValue<'v>>,
        key: &str,
    ) -> Result<&'t DeTable<'v>, PlateError> {
        match value.get_ref() {
            DeValue::Table(table) => Ok(table),
            _ => Err(self.wrong(
                value.span().start,
                format!("{key} is a table; write {key} = {{ name = value }}"),
            )),
        }
    }

    fn number(
        &self,
        value: &Spanned<DeValue<'_>>,
        how: &str,
    ) -> Result<f64, PlateError> {
        let number = match value.get_ref() {
            DeValue::Integer(i) => whole(i).map(|i| i as f64),
            DeValue::Float(x) => x.as_str().parse().ok(),
            _ => None,
        };
        number
            .filter(|x: &f64| x.is_finite())
            .ok_or_else(|| self.wrong(value.span().start, how.to_owned()))
    }

    fn numbers<const N: usize>(
        &self,
        value: &Spanned<DeValue<'_>>,
        how: &str,
    ) -> Result<[f64; N], PlateError> {
        let wrong = || self.wrong(value.span().start, how.to_owned());
        let DeValue::Array(all) = value.get_ref() else {
            return Err(wrong());
        };
        if all.len() != N {
            return Err(wrong());
        }
        let numbers = all.iter().map(|x| self.number(x, how));
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
        <[f64; N]>::try_from(numbers).map_err(|_| wrong())
    }

    /// Reads a part, and warnings about its settings.
    fn part(
        &self,
        table: &DeTable<'_>,
        start: usize,
        builder: &Builder,
    ) -> Result<(Wanted, Vec<String>), PlateError> {
        self.only(table, &PART, "a part")?;
        let model = match table.get("model").map(|m| (m, m.get_ref())) {
            Some((_, DeValue::String(path))) if !path.is_empty() => {
                self.folder.join(path.as_ref())
            }
            Some((model, _)) => {
                let how = "model is a file; write model = \"part.rhai\"";
                return Err(self.wrong(model.span().start, how.to_owned()));
            }
            None => {
                let how = "the part has no model; add model = \"part.rhai\"";
                return Err(self.wrong(start, how.to_owned()));
            }
        };
        let asked = format!("{} ({})", self.place(start), model.display());
        let copies = match table.get("copies").map(|c| (c, c.get_ref())) {
            None => 1,
            Some((value, DeValue::Integer(i))) => {
                let count = u64::from_str_radix(i.as_str(), i.radix()).ok();
                let some =
                    count.filter(|n| (1..=Plate::MOST_PARTS).contains(n));
                some.ok_or_else(|| {
                    let how = format!(
                        "copies = {} is out of range; use 1 to {}",
                        i.as_str(),
                        Plate::MOST_PARTS
                    );
                    self.wrong(value.span().start, how)
                })?
            }
            Some((value, _)) => {
                let how = "copies is a whole number, 1 or more";
                return Err(self.wrong(value.span().start, how.to_owned()));
            }
        };
        let at = table.get("at").map(|at| {
            let how = "at is where the middle of the part stands on the bed, \
                       in mm; write at = [110, 110]";
            let [x, y] = self.numbers(at, how)?;
            let inside = |v: f64| v.abs() <= LARGEST_BED;
            if inside(x) && inside(y) {
                Ok((x, y))
            } else {
                let how = format!(
                    "at = [{x:e}, {y:e}] is on no bed, which is {LARGEST_BED} \
                     mm wide at most; write at = [110, 110]"
                );
                Err(self.wrong(at.span().start, how))
            }
        });
        let lay = table.get("lay").map(|lay| match lay.get_ref() {
            DeValue::Boolean(lay) => Ok(*lay),
            _ => {
                let how = "lay says whether the part is laid on its largest \
                           flat side; write lay = true";
                Err(self.wrong(lay.span().start, how.to_owned()))
            }
        });
        let rotate = table.get("rotate").map(|rotate| {
            let how = "rotate is an angle about the z axis in degrees, or \
                       three, about x, y and z; write rotate = 90 or rotate = \
                       [90, 0, 0]";
            match rotate.get_ref() {
                DeValue::Array(_) => self.numbers(rotate, how),
                _ => self.number(rotate, how).map(|z| [0.0, 0.0, z]),
            }
        });
        let positive = |key: &str| {
            let value = table.get(key)?;
            let how = format!("{key} is a number above 0; write {key} = 1.5");
            let number = self.number(value, &how);
            Some(number.and_then(|x| {
                if x > 0.0 {
                    Ok(x)
                } else {
                    Err(self.wrong(value.span().start, how))
                }
            }))
        };
        let (scale, size) = (positive("scale"), positive("size"));
        if let (Some(size), Some(_)) = (table.get("size"), &scale) {
            let how = "scale and size cannot be given together; drop one";
            return Err(self.wrong(size.span().start, how.to_owned()));
        }
        let mut builder = builder.clone();
        if let Some(settings) = table.get("settings") {
            let settings = self.table(settings, "settings")?;
            builder.table(settings, self.text, self.name)?;
        }
        let (settings, warnings) = builder.finish()?;
        let wanted = Wanted {
            source: Source::File(model),
            defines: self.params(table)?,
            placement: Placement {
                scale: scale.transpose()?,
                size: size.transpose()?,
                lay: lay.transpose()?.unwrap_or_default(),
                rotate: rotate.transpose()?.unwrap_or_default(),
                ..Placement::default()
            },
            settings,
            at: at.transpose()?,
            copies,
            asked,
        };
        Ok((wanted, warnings))
    }

    /// The parameters of a part's script.
    fn params(
        &self,
        table: &DeTable<'_>,
    ) -> Result<Vec<(String, String)>, PlateError> {
        let Some(params) = table.get("params") else {
            return Ok(Vec::new());
        };
        let mut all = Vec::new();
        for (key, value) in self.table(params, "params")? {
            let text = match value.get_ref() {
                DeValue::String(text) => text.to_string(),
                DeValue::Integer(i) => whole(i)
                    .map_or_else(|| i.as_str().to_owned(), |i| i.to_string()),
                DeValue::Float(x) => x.as_str().to_owned(),
                DeValue::Boolean(b) => b.to_string(),
                _ => {
                    let name = key.get_ref();
                    let how = format!(
                        "params: {name} is a number, true, false or text in \
                         quotes"
                    );
                    return Err(self.wrong(value.span().start, how));
                }
            };
            all.push((key.get_ref().to_string(), text));
        }
        Ok(all)
    }
}

/// The value of a whole number, in whichever base it is written.
fn whole(number: &toml::de::DeInteger<'_>) -> Option<i64> {
    i64::from_str_radix(number.as_str(), number.radix()).ok()
}

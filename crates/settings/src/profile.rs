//! Profiles: settings under a name, for a printer, a filament or a kind of
//! print.
//!
//! In: the name of a profile. Out: the texts to take over, the profile's own
//! after those that it inherits from.
//!
//! A profile is a settings file with two more keys at its beginning,
//! `description` and `inherits`. Many profiles are part of the program. The
//! user's folder may hold more. A profile there replaces the program's profile
//! of that name, and may inherit from it by that name.
//!
//! Guaranteed: the result depends on the profiles' texts only. An unknown name,
//! or profiles that inherit in a circle, are an error with its place.

use super::error::{GivenIn, SettingsError};
use super::shipped::{NOZZLES, ProfileKind, SHIPPED};
use super::text;
use etcetera::BaseStrategy;
use isoslice_base::units::human_list;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Greatest number of profiles that inherit from one another in a row.
const MOST_INHERITED: usize = 32;

/// The origin of a profile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The profile is part of the program.
    Shipped,
    /// The profile is a file of the user's.
    File(PathBuf),
}

/// A profile.
#[derive(Clone, Debug)]
pub struct Profile {
    /// The profile's kind.
    pub kind: ProfileKind,
    /// The profile's name, which is its file's without extension.
    pub name: String,
    /// The description in the profile; empty if there is none.
    pub description: String,
    /// The profile of its kind that the profile starts from.
    pub inherits: Option<String>,
    /// Where the profile comes from.
    pub origin: Origin,
    /// The profile's text.
    pub text: String,
    /// The place of `inherits` in the profile.
    inherits_at: GivenIn,
}

impl Profile {
    fn new(
        kind: ProfileKind,
        name: &str,
        origin: Origin,
        text: &str,
    ) -> Result<Self, SettingsError> {
        let file = file_name(kind, name, &origin);
        let head = text::head(&file, text)?;
        Ok(Profile {
            kind,
            name: name.to_owned(),
            description: head.description.unwrap_or_default(),
            inherits_at: GivenIn::Profile {
                name: file,
                line: head.inherits.as_ref().map_or(1, |(_, line)| *line),
            },
            inherits: head.inherits.map(|(name, _)| name),
            origin,
            text: text.to_owned(),
        })
    }

    /// Name of the profile's file in messages.
    pub fn file(&self) -> String {
        file_name(self.kind, &self.name, &self.origin)
    }

    /// True if the profile is one of the program's printers with another
    /// nozzle.
    pub fn is_another_nozzle(&self) -> bool {
        self.origin == Origin::Shipped
            && NOZZLES.iter().any(|(name, _)| *name == self.name)
    }

    fn is(&self, other: &Profile) -> bool {
        match (&self.origin, &other.origin) {
            // One file may be named in many ways.
            (Origin::File(a), Origin::File(b)) => resolved(a) == resolved(b),
            (a, b) => a == b && self.name == other.name,
        }
    }

    /// The folder that paths in the profile start from.
    fn beside(&self) -> &Path {
        match &self.origin {
            Origin::Shipped => Path::new(""),
            Origin::File(path) => path.parent().unwrap_or(Path::new("")),
        }
    }
}

fn resolved(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn file_name(kind: ProfileKind, name: &str, origin: &Origin) -> String {
    match origin {
        Origin::Shipped => format!("shipped {}/{name}.toml", kind.folder()),
        Origin::File(path) => path.display().to_string(),
    }
}

/// The profiles of the program and those of a folder.
#[derive(Clone, Debug, Default)]
pub struct Profiles {
    folder: Option<PathBuf>,
}

impl Profiles {
    /// The profiles of the program and those in `folder`, which has a folder
    /// for each kind. `folder` need not exist.
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { folder }
    }

    /// The folder of the user's own profiles: `$ISOSLICE_PROFILES`, or
    /// `isoslice` in the folder for configuration. It need not exist.
    pub fn usual_folder() -> Option<PathBuf> {
        let given = std::env::var_os("ISOSLICE_PROFILES");
        let given = given.filter(|folder| !folder.is_empty());
        given.map(PathBuf::from).or_else(|| {
            let strategy = etcetera::choose_base_strategy().ok()?;
            Some(strategy.config_dir().join("isoslice"))
        })
    }

    /// All profiles of a kind, by name, and errors for the folder or profiles
    /// in it that cannot be read or understood. Of two profiles with one name
    /// the folder's is listed.
    pub fn list(
        &self,
        kind: ProfileKind,
    ) -> (Vec<Profile>, Vec<SettingsError>) {
        let mut found = BTreeMap::new();
        let mut wrong = Vec::new();
        let mut add = |name: &str, read: Result<Option<Profile>, _>| match read
        {
            Ok(Some(profile)) => drop(found.insert(name.to_owned(), profile)),
            Ok(None) => {}
            Err(error) => wrong.push(error),
        };
        for (name, text) in shipped(kind) {
            let profile = Profile::new(kind, name, Origin::Shipped, text);
            add(name, profile.map(Some));
        }
        match self.own(kind) {
            Ok(mut names) => {
                // The system lists files in any order.
                names.sort();
                for name in names {
                    add(&name, self.find_own(kind, &name));
                }
            }
            Err(error) => wrong.push(error),
        }
        (found.into_values().collect(), wrong)
    }

    /// The profile of a name, or in a file if the name is a path.
    ///
    /// # Errors
    /// If there is none, it cannot be read, or its beginning is not
    /// understood.
    pub fn find(
        &self,
        kind: ProfileKind,
        name: &str,
    ) -> Result<Profile, SettingsError> {
        match self.look_up(kind, name, Path::new(""), true)? {
            Some(profile) => Ok(profile),
            None => Err(self.unknown(
                kind,
                name,
                format!("--{} {name}", kind.name()),
            )),
        }
    }

    /// The profile of a name, after those that it inherits from.
    ///
    /// # Errors
    /// If one of the profiles does not exist or inherits from itself, if there
    /// are too many, and the errors of [`Profiles::find`].
    pub fn chain(
        &self,
        kind: ProfileKind,
        name: &str,
    ) -> Result<Vec<Profile>, SettingsError> {
        let mut chain = vec![self.find(kind, name)?];
        while let Some(last) = chain.last()
            && let Some(parent) = &last.inherits
        {
            // A user's profile that inherits from its own name means the
            // program's.
            let folder_too =
                *parent != last.name || last.origin == Origin::Shipped;
            let beside = last.beside();
            let found = self.look_up(kind, parent, beside, folder_too)?;
            let circle = |chain: &[Profile]| {
                let names = chain.iter().map(|p| p.name.as_str());
                let names: Vec<_> = names.chain([parent.as_str()]).collect();
                SettingsError::Circle {
                    place: last.inherits_at.clone(),
                    names: names.join(", which inherits "),
                }
            };
            let Some(found) = found else {
                if *parent == last.name {
                    return Err(circle(&chain));
                }
                let place = format!("{}: inherits", last.inherits_at);
                return Err(self.unknown(kind, parent, place));
            };
            if chain.iter().any(|earlier| earlier.is(&found)) {
                return Err(circle(&chain));
            }
            if chain.len() == MOST_INHERITED {
                let first = chain.iter().take(3).map(|p| p.name.as_str());
                return Err(SettingsError::TooDeep {
                    place: last.inherits_at.clone(),
                    most: MOST_INHERITED,
                    first: first.collect::<Vec<_>>().join(", which inherits "),
                });
            }
            chain.push(found);
        }
        chain.reverse();
        Ok(chain)
    }

    /// Does what [`Profiles::find`] does, but a missing profile is no error. A
    /// path starts from the folder `beside`.
    fn look_up(
        &self,
        kind: ProfileKind,
        name: &str,
        beside: &Path,
        folder_too: bool,
    ) -> Result<Option<Profile>, SettingsError> {
        if is_path(name) {
            let path = beside.join(name);
            let stem = path.file_stem().unwrap_or_default();
            let stem = stem.to_string_lossy().into_owned();
            let text = text::read(&path)?;
            let origin = Origin::File(path);
            return Profile::new(kind, &stem, origin, &text).map(Some);
        }
        if folder_too && let Some(profile) = self.find_own(kind, name)? {
            return Ok(Some(profile));
        }
        shipped(kind)
            .find(|(known, _)| *known == name)
            .map(|(name, text)| Profile::new(kind, name, Origin::Shipped, text))
            .transpose()
    }

    /// The folder's profile of that name, if there is one.
    fn find_own(
        &self,
        kind: ProfileKind,
        name: &str,
    ) -> Result<Option<Profile>, SettingsError> {
        let Some(folder) = &self.folder else {
            return Ok(None);
        };
        let path = folder.join(kind.folder()).join(format!("{name}.toml"));
        if !path.is_file() {
            return match path.symlink_metadata() {
                Err(_) => Ok(None),
                // The path leads to a folder or a device, or is a link to
                // nothing.
                Ok(_) => Err(SettingsError::Unreadable {
                    path,
                    cause: std::io::Error::other("it is no regular file"),
                }),
            };
        }
        let text = text::read(&path)?;
        Profile::new(kind, name, Origin::File(path), &text).map(Some)
    }

    /// Names of the folder's profiles of a kind.
    fn own(&self, kind: ProfileKind) -> Result<Vec<String>, SettingsError> {
        let Some(folder) = &self.folder else {
            return Ok(Vec::new());
        };
        let folder = folder.join(kind.folder());
        if !folder.is_dir() {
            return Ok(Vec::new());
        }
        let unreadable = |cause| SettingsError::Unreadable {
            path: folder.clone(),
            cause,
        };
        let mut names = Vec::new();
        for entry in std::fs::read_dir(&folder).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            let name = path.file_stem().and_then(|name| name.to_str());
            if path.extension().is_some_and(|e| e == "toml")
                && let Some(name) = name
            {
                names.push(name.to_owned());
            }
        }
        Ok(names)
    }

    fn unknown(
        &self,
        kind: ProfileKind,
        name: &str,
        place: String,
    ) -> SettingsError {
        SettingsError::UnknownProfile {
            place,
            kind: kind.name(),
            name: name.to_owned(),
            hint: self.suggestion(&[kind], name),
        }
    }

    /// The hint for an unknown name: the names most like it, or where to find
    /// them all.
    pub fn suggestion(&self, kinds: &[ProfileKind], name: &str) -> String {
        let mut names = Vec::new();
        for kind in kinds {
            names.extend(shipped(*kind).map(|(name, _)| name.to_owned()));
            // A folder that cannot be read gives no suggestions.
            names.extend(self.own(*kind).unwrap_or_default());
        }
        suggestion(name, names)
    }
}

/// True if a profile is named by its file.
fn is_path(name: &str) -> bool {
    name.ends_with(".toml") || Path::new(name).components().count() > 1
}

fn shipped(
    kind: ProfileKind,
) -> impl Iterator<Item = (&'static str, &'static str)> {
    let files = SHIPPED
        .iter()
        .filter(move |(of, _, _)| *of == kind)
        .map(|(_, name, text)| (*name, *text));
    let nozzles = NOZZLES.iter().copied();
    files.chain(nozzles.filter(move |_| kind == ProfileKind::Printer))
}

/// The names most like `name`, or where to find them all.
fn suggestion(name: &str, mut names: Vec<String>) -> String {
    // Likeness below which suggestions are guesses that do not help.
    const ALIKE: f64 = 0.75;
    // More names would hide where to find them all.
    const MOST_NAMES: usize = 3;
    // More than the printers of one maker.
    const MOST_PARTS_OF_NAMES: usize = 12;
    let wanted = name.to_lowercase().replace(['_', ' '], "-");
    let likeness = |known: &str| {
        // A part of a name ("mk4", "voron") is likelier than a misspelling.
        if known.contains(&wanted) && wanted.len() > 1 {
            1.0
        } else {
            strsim::jaro_winkler(&wanted, known)
        }
    };
    names.sort();
    names.dedup();
    names.retain(|known| likeness(known) >= ALIKE);
    // A printer with another nozzle is named only if a nozzle is asked for.
    let base = |name: &str| {
        let nozzle = name.strip_suffix("-nozzle");
        let base = nozzle.and_then(|name| name.rsplit_once('-'));
        base.map(|(base, _)| base.to_owned())
    };
    if !wanted.contains("nozzle") {
        let all = names.clone();
        names.retain(|name| !base(name).is_some_and(|b| all.contains(&b)));
    }
    names.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
    let parts = names.iter().filter(|name| likeness(name) == 1.0).count();
    names.truncate(if parts > 0 {
        parts.min(MOST_PARTS_OF_NAMES)
    } else {
        MOST_NAMES
    });
    if names.is_empty() {
        return "`isoslice profiles` lists them".to_owned();
    }
    let names: Vec<_> = names.iter().map(String::as_str).collect();
    format!("did you mean {}?", human_list(&names, "or"))
}

//! `isoslice profiles import`: makes profiles of those of other slicers.

mod files;
mod own;
mod summary;
mod words;

use super::folder::ProfilesSource;
use super::output::is_stream;
use super::{plain, terminal};
use anyhow::bail;
use clap::Args;
use isoslice::settings::{Builder, ProfileKind, keys};
use isoslice::{is_placeholder, try_templates};
use own::Own;
use slicerprofile::{
    Left, Picked, Place, PresetKind, Setting, Slicer, Source, Translation,
    Value, Values, fill, translate, translated, understands,
};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use words::{assignment, one_line, shortened, slug};

const EXAMPLES: &str = "\
Examples:
  isoslice profiles import my-config.ini                what PrusaSlicer exports
  isoslice profiles import printed.gcode -o same.toml   as a file was sliced
  isoslice profiles import \"My K1.json\" --beside ~/.config/OrcaSlicer/system
  isoslice profiles import PrusaResearch.ini --list
  isoslice profiles import PrusaResearch.ini --name \"Original Prusa MK4S 0.4 nozzle\"
  isoslice profiles import fine.curaprofile --as fine --all";

/// Arguments of `isoslice profiles import`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct ImportArgs {
    /// Profile of PrusaSlicer (.ini), OrcaSlicer or Bambu Studio (.json), Cura
    /// (.curaprofile, .def.json), G-code of any of them, or settings of
    /// isoslice's own (.toml) with another slicer's templates
    file: PathBuf,

    /// Name the profiles in a bundle, and stop
    #[arg(long, conflicts_with_all = ["name", "output"])]
    list: bool,

    /// Profile of a bundle to import; may be given for a printer, a filament
    /// and a print
    #[arg(long, value_name = "NAME")]
    name: Vec<String>,

    /// Folder in which to look for profiles that FILE inherits from, besides
    /// its own
    #[arg(long, value_name = "DIR")]
    beside: Vec<PathBuf>,

    /// Name of the new profiles [default: that of the old ones, or of FILE]
    #[arg(long = "as", value_name = "NAME", conflicts_with = "output")]
    new_name: Option<String>,

    /// Write one file with everything instead, - for standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Replace your own profiles of that name
    #[arg(long)]
    force: bool,

    /// Name every key, with what became of it
    #[arg(long)]
    all: bool,

    #[command(flatten)]
    source: ProfilesSource,
}

pub(super) fn run(args: &ImportArgs) -> anyhow::Result<()> {
    let own = own::read(&args.file)?;
    let has_few = matches!(own, Some(Own::Nothing));
    let mut import = if let Some(Own::Given(settings, is_profile)) = own {
        if args.list {
            return plain::print(ONE_PROFILE);
        }
        let mut import = Import::of_own(&args.file, settings);
        // What is put among the profiles becomes one.
        import.as_settings = args.output.is_some() && !is_profile;
        import
    } else {
        let source = Source::open(&args.file, &args.beside)?;
        if args.list {
            return list(&source);
        }
        let mut import = Import::new(&args.file, source.pick(&args.name)?)?;
        let repeated = source.repeated.iter();
        import.remarks.extend(repeated.map(|key| {
            format!(
                "{} is given more than once in the file, and the last one \
                 counts; leave the others out",
                plain::line(key)
            )
        }));
        import
    };
    if has_few {
        import.remarks.push(
            "isoslice made this file and left only a few of its settings in it; \
             all that differ from the defaults are in files of later versions"
                .to_owned(),
        );
    }
    import.settle()?;
    let written = match &args.output {
        Some(path) => import.write_one(path, args)?,
        None => import.write_each(args)?,
    };
    let to_stream = args.output.as_deref().is_some_and(is_stream);
    if to_stream {
        let t = &import.translation;
        let all = t.lost.iter().chain(&t.alike).chain(&t.unknown);
        let say = |left: &Left| format!("{}: {}", left.key, left.why);
        let remarks = import.remarks.iter().cloned();
        terminal::warn(&all.map(say).chain(remarks).collect::<Vec<_>>());
        return Ok(());
    }
    plain::print(&import.summary(&written, args.all))
}

/// What `--list` says of a file that is no bundle.
const ONE_PROFILE: &str = "It holds one profile, without a choice.\n";

/// Names what there is in a bundle.
fn list(source: &Source) -> anyhow::Result<()> {
    let all = source.list();
    if all.is_empty() {
        return plain::print(ONE_PROFILE);
    }
    let mut text = String::new();
    for kind in KINDS {
        for named in all.iter().filter(|n| n.kind == kind) {
            let name = plain::line(&named.name);
            writeln!(text, "{}:{name}", kind.word())?;
        }
    }
    plain::print(&text)
}

/// The kinds of keys, in the order in which they are listed.
const KINDS: [PresetKind; 3] =
    [PresetKind::Printer, PresetKind::Filament, PresetKind::Print];

/// An import on its way.
struct Import {
    /// The old name, as it was written.
    shown: String,
    /// Where the profile is from, for the head of the file.
    origin: String,
    /// The program whose profile it is.
    maker: &'static str,
    /// Name of the new profiles, unless a kind has a name of its own.
    name: String,
    kinds: Vec<PresetKind>,
    picked: Picked,
    translation: Translation,
    /// Templates that could not be translated: the setting, and the text.
    kept: Vec<(PresetKind, &'static str, String)>,
    /// Contradictions in the settings, and warnings about them.
    remarks: Vec<String>,
    /// True if a settings file is written, not a profile: it was one before.
    as_settings: bool,
}

impl Import {
    fn new(file: &Path, picked: Picked) -> anyhow::Result<Self> {
        let mut translation = translate(&picked);
        // A profile of one kind stays of that kind, whatever it sets.
        if let [kind] = picked.kinds.as_slice() {
            for setting in &mut translation.settings {
                setting.kind = *kind;
            }
        }
        if translation.settings.is_empty() {
            bail!("{}: {}", file.display(), nothing(&translation));
        }
        let maker = picked.slicer.name();
        Ok(Self::with(file, maker, picked, translation))
    }

    /// The import of a file of isoslice's own.
    fn of_own(file: &Path, translation: Translation) -> Self {
        // No key of another slicer is in it.
        let picked = Picked {
            slicer: Slicer::Prusa,
            names: Vec::new(),
            kinds: Vec::new(),
            values: Values::default(),
        };
        Self::with(file, own::MAKER, picked, translation)
    }

    fn with(
        file: &Path,
        maker: &'static str,
        picked: Picked,
        translation: Translation,
    ) -> Self {
        let has = |kind: &PresetKind| {
            translation.settings.iter().any(|s| s.kind == *kind)
        };
        let kinds = KINDS.into_iter().filter(has).collect();
        let file = file.file_name().unwrap_or_default().to_string_lossy();
        let stem = file.split('.').next().unwrap_or("");
        let names: Vec<&str> =
            picked.names.iter().map(|n| n.name.as_str()).collect();
        let name = names.first().map_or(stem, |name| name);
        let of = match names.as_slice() {
            [] => String::new(),
            all => format!(", {}", all.join(", ")),
        };
        Self {
            origin: one_line(&format!("{maker}'s {file}{of}")),
            maker,
            name: slug(name),
            shown: one_line(name),
            kinds,
            picked,
            translation,
            kept: Vec::new(),
            remarks: Vec::new(),
            as_settings: false,
        }
    }

    /// Leaves out what isoslice refuses, and notes contradictions.
    fn settle(&mut self) -> anyhow::Result<()> {
        let mut builder = Builder::new();
        let mut fine = Vec::new();
        let mut refused = Vec::new();
        for mut setting in std::mem::take(&mut self.translation.settings) {
            if let Some(place) = Place::of_setting(setting.name)
                && let Value::Text(text) = &setting.value
            {
                match self.template(setting.name, place, text) {
                    Ok(text) => setting.value = Value::Text(text),
                    Err(why) => {
                        refused.push(self.keep(setting, &why));
                        continue;
                    }
                }
            }
            let mut tried = builder.clone();
            match tried.toml("import", &assignment(&setting)) {
                Ok(()) => {
                    builder = tried;
                    fine.push(setting);
                }
                Err(error) => {
                    let message = error.to_string();
                    let message = message
                        .strip_prefix("import:1: ")
                        .or(message.strip_prefix("import, line 1: "))
                        .unwrap_or(&message)
                        .to_owned();
                    refused.push((setting, message));
                }
            }
        }
        self.translation.settings = fine;
        // A template that is not understood is kept as a comment: a start that
        // is carried out in part is worse than the one that isoslice writes for
        // the firmware.
        let wrong = try_templates(builder.settings());
        for error in wrong {
            let (taken, rest): (Vec<_>, Vec<_>) =
                std::mem::take(&mut self.translation.settings)
                    .into_iter()
                    .partition(|s| s.name == error.template);
            self.translation.settings = rest;
            builder.toml("import", &format!("{} = ''", error.template))?;
            let why = error.to_string();
            refused.extend(taken.into_iter().map(|s| self.keep(s, &why)));
        }
        for (setting, why) in &refused {
            self.lose(setting, why);
        }
        match builder.finish() {
            Ok((_, warnings)) => self.remarks.extend(warnings),
            Err(error) => self.remarks.push(format!(
                "slicing with it as it is will be refused, {error}; set it in \
                 the profile"
            )),
        }
        Ok(())
    }

    /// A template in isoslice's own language, with the profile's own values in
    /// place of names that isoslice does not know.
    ///
    /// # Errors
    /// Why it cannot be translated.
    fn template(
        &mut self,
        name: &str,
        place: Place,
        text: &str,
    ) -> Result<String, String> {
        let own = |placeholder: &str| is_placeholder(name, placeholder);
        let mut text = text.to_owned();
        // Files of isoslice's own bring no values along.
        if self.maker != own::MAKER {
            let known = |name: &str| understands(name) || own(name);
            let filled = fill(&text, &self.picked.values, &known);
            if let Some(why) = filled.refused {
                return Err(why);
            }
            for (asked, value) in filled.assumed {
                let shown = if value.is_empty() { "nothing" } else { value };
                let remark = format!(
                    "{name} asks for {asked}, which the profile does not give: \
                     {shown} is put in"
                );
                if !self.remarks.contains(&remark) {
                    self.remarks.push(remark);
                }
            }
            text = filled.text;
        }
        let ours = translated(&text, place, &own);
        ours.map_err(|wrong| format!("{name}, {wrong}"))
    }

    /// Keeps a template that is left out as a comment, with the reason.
    fn keep(&mut self, setting: Setting, why: &str) -> (Setting, String) {
        if let Value::Text(text) = &setting.value {
            self.kept.push((setting.kind, setting.name, text.clone()));
        }
        let what = format!("it stands in the profile as a comment only: {why}");
        (setting, what)
    }

    /// Counts the keys of a setting that is left out as lost, except keys from
    /// which another setting was made.
    fn lose(&mut self, setting: &Setting, why: &str) {
        let t = &mut self.translation;
        let mut is_said = false;
        for key in &setting.from {
            let kept = t.settings.iter().any(|s| s.from.contains(key));
            let lost = t.lost.iter().any(|left| left.key == *key);
            if kept || lost {
                continue;
            }
            is_said = true;
            t.mapped = t.mapped.saturating_sub(1);
            t.lost.push(Left {
                key: key.clone(),
                value: self.picked.values.shown(key),
                why: why.to_owned(),
            });
        }
        if !is_said {
            let remark = format!("{} was left out: {why}", setting.name);
            self.remarks.push(remark);
        }
    }

    /// The text of a profile with the settings of some kinds. Where two kinds
    /// differ, the last one wins.
    fn text(&self, of: &[PresetKind]) -> anyhow::Result<String> {
        let mut text = String::new();
        let t = &self.translation;
        writeln!(
            text,
            "# Imported by isoslice {} from {}:\n# {}.",
            env!("CARGO_PKG_VERSION"),
            self.origin,
            self.counts()
        )?;
        let named = self.picked.names.iter();
        let named = named.filter(|n| of.contains(&n.kind));
        let name = match named.map(|n| n.name.as_str()).collect::<Vec<_>>() {
            none if none.is_empty() => self.shown.clone(),
            names => one_line(&names.join(", ")),
        };
        if !self.as_settings {
            let description = format!("{name}, from {}", self.maker);
            let description = toml::Value::String(description);
            writeln!(text, "description = {description}")?;
        }
        let mut all: Vec<&Setting> = Vec::new();
        for setting in t.settings.iter().filter(|s| of.contains(&s.kind)) {
            all.retain(|s| s.name != setting.name);
            all.push(setting);
        }
        // Every setting has its value from the whole profile, unless another
        // kind sets it, too.
        let mut group = "";
        for key in keys() {
            let Some(setting) = all.iter().find(|s| s.name == key.name) else {
                continue;
            };
            let (of_key, leaf) =
                key.name.split_once('.').unwrap_or(("", key.name));
            if of_key != group {
                group = of_key;
                writeln!(text, "\n[{group}]")?;
            }
            let mut own = Builder::new();
            own.toml("import", &assignment(setting))?;
            let value = key.get(own.settings());
            let from = one_line(&setting.from.join(", "));
            if from.is_empty() {
                writeln!(text, "{leaf} = {value}")?;
            } else if value.contains('\n') || value.len() + from.len() > 100 {
                writeln!(text, "# {from}\n{leaf} = {value}")?;
            } else {
                writeln!(text, "{leaf} = {value} # {from}")?;
            }
        }
        for (kind, name, template) in &self.kept {
            if of.contains(kind) {
                writeln!(
                    text,
                    "\n# {name}, which isoslice could not translate. Until it \
                     is mended here,\n# the print {}:",
                    without(name)
                )?;
                for line in template.lines() {
                    writeln!(text, "#   {}", one_line(line))?;
                }
            }
        }
        Ok(text)
    }
}

/// What a print does without one of its templates.
fn without(template: &str) -> &'static str {
    match template {
        "gcode.start" => "begins with homing only",
        "gcode.end" => "ends with isoslice's own lines",
        _ => "goes on without it",
    }
}

/// Why no setting follows from any key.
fn nothing(translation: &Translation) -> String {
    let known = translation.lost.iter().chain(&translation.ignored);
    let known: Vec<String> = known
        .take(3)
        .map(|left| {
            let value = shortened(&one_line(&left.value));
            format!("{} = {value}: {}", left.key, left.why)
        })
        .collect();
    if known.is_empty() {
        "isoslice knows none of its keys; it must be a profile of PrusaSlicer, \
         OrcaSlicer, Bambu Studio or Cura"
            .to_owned()
    } else {
        format!("no setting follows from it ({})", known.join("; "))
    }
}

/// A file that was written: its kind, its name on the command line, its path.
type Written = (PresetKind, String, PathBuf);

/// The kind of isoslice's profiles to which a kind of key goes.
fn ours(kind: PresetKind) -> ProfileKind {
    match kind {
        PresetKind::Printer => ProfileKind::Printer,
        PresetKind::Filament => ProfileKind::Filament,
        PresetKind::Print => ProfileKind::Preset,
    }
}

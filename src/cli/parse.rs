//! Reads the arguments, and explains unknown ones.
//!
//! A setting is no option. If someone writes one as an option, or uses another
//! slicer's word, the message says what to write.

use super::args::either;
use super::{Cli, plain};
use clap::Parser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use isoslice::settings::{self, Builder, Key};
use isoslice_base::pairs;
use slicerprofile::Counterpart;
use std::process::exit;

/// Options of other slicers, and words of this program in the wrong place, with
/// what to write instead.
const WORDS: &[(&str, &str)] = pairs! {
    "supports", "support", "support-material" => SUPPORTS;
    "raft" => "--set raft.layers=3";
    "brim", "brim-width" => "--set brim.place=outer --set brim.width=5";
    "skirt", "skirts" => "--set skirt.loops=1";
    "infill" => "--set infill_density=25% or --set infill=gyroid";
    "fill-density" => "--set infill_density=25%";
    "fill-pattern" => "--set infill=gyroid";
    "density" => "--set infill_density=25%";
    "perimeters", "shells", "wall-count" => "--set walls=3";
    "top-solid-layers" => "--set top_layers=4";
    "bottom-solid-layers" => "--set bottom_layers=3";
    "temp", "temperature" => TEMPERATURE;
    "nozzle" => "--set printer.nozzle_diameter=0.4";
    "speed" => "--set speed.outer_wall=40, and others of the group speed";
    "material" => "--filament NAME";
    "profile" => "--printer, --filament or --preset";
    "quality" => "--preset NAME";
    "load", "settings" => "--config FILE";
    "center", "centre", "position" => "--at X,Y";
    "rotate" => "--rotate-x, --rotate-y or --rotate-z";
    "scale-to-fit" => "--size S";
    "export-gcode", "out" => "-o FILE";
    "param" => "-D name=value";
    "duplicate", "count" => "--copies N";
    "jobs" => "--threads N";
    "verbose-level" => "-v";
    "gcode-flavor", "flavor" => "--set gcode.flavour=klipper";
};

const TEMPERATURE: &str = "--set filament.nozzle_temperature=210";
const SUPPORTS: &str = "--set supports=auto";

/// Reads the command line, or ends the program.
pub(crate) fn parse() -> Cli {
    let mut error = match Cli::try_parse() {
        Ok(cli) => return cli,
        Err(error) => error,
    };
    suggest_setting(&mut error);
    let code = error.exit_code();
    // The message repeats what was written, letter for letter.
    let obeyed = |arg: std::ffi::OsString| {
        arg.to_string_lossy().contains(plain::is_obeyed)
    };
    if error.use_stderr() && std::env::args_os().any(obeyed) {
        eprint!("{}", plain::lines(&error.render().to_string()));
    } else {
        // If even the message cannot be shown, nobody can be told.
        drop(error.print());
    }
    exit(code)
}

/// Adds what to write instead of an option that names a setting, or of a model
/// in a command's place.
fn suggest_setting(error: &mut clap::Error) {
    let kind = match error.kind() {
        ErrorKind::UnknownArgument => ContextKind::InvalidArg,
        ErrorKind::InvalidSubcommand => ContextKind::InvalidSubcommand,
        // The argument stands where a further model may stand.
        ErrorKind::ValueValidation if is_more(error) => {
            ContextKind::InvalidValue
        }
        _ => return,
    };
    let Some(ContextValue::String(given)) = error.get(kind).cloned() else {
        return;
    };
    let before = std::env::args()
        .zip(std::env::args().skip(1))
        .find(|(_, arg)| *arg == given)
        .map_or_else(String::new, |(before, _)| before);
    let tip = match kind {
        ContextKind::InvalidSubcommand => {
            is_model(&given).then(|| format!("write isoslice slice {given}"))
        }
        _ if given.starts_with('-') => {
            let value = value_of(&given, std::env::args());
            tip(&given, value.as_deref()).or_else(|| {
                let similar = error.get(ContextKind::SuggestedArg).is_some();
                (!similar).then(|| parameter(&given, value.as_deref()))?
            })
        }
        _ => stray(&given, &before),
    };
    let Some(tip) = tip else {
        return;
    };
    // clap's suggestions would resemble the argument by chance only.
    for kind in [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand] {
        error.remove(kind);
    }
    let tips = ContextValue::StyledStrs(vec![tip.into()]);
    error.insert(ContextKind::Suggested, tips);
}

/// True if the error is about a model after the first.
fn is_more(error: &clap::Error) -> bool {
    let argument = error.get(ContextKind::InvalidArg);
    matches!(argument, Some(ContextValue::String(s)) if s == "[MORE]...")
}

fn is_model(given: &str) -> bool {
    given.ends_with(".rhai") || given.ends_with(".vm")
}

/// What to write instead of an argument that is no option and stands after
/// `before`.
fn stray(given: &str, before: &str) -> Option<String> {
    let is_name = settings::keys().iter().any(|key| key.name == before);
    if is_name {
        return Some(format!("write --set {before}={given}, without a space"));
    }
    is_model(given).then(|| {
        "one model at a time; a script holds several bodies as min(f, g), and \
         slice takes several models"
            .into()
    })
}

/// The name of an option, without its value.
fn name_of(given: &str) -> &str {
    let name = given.trim_start_matches('-');
    name.split_once('=').map_or(name, |(name, _)| name)
}

/// The value that was given to an unknown option.
fn value_of(
    given: &str,
    arguments: impl Iterator<Item = String>,
) -> Option<String> {
    let name = name_of(given);
    let mut after = arguments.skip_while(|argument| {
        !argument.starts_with('-') || name_of(argument) != name
    });
    let option = after.next()?;
    if let Some((_, value)) = option.split_once('=') {
        return Some(value.to_owned());
    }
    let value = after.next()?;
    let number = value.parse::<f64>().is_ok();
    (number || !value.starts_with('-') && !is_model(&value)).then_some(value)
}

/// What to write if an option is meant for the script.
fn parameter(given: &str, value: Option<&str>) -> Option<String> {
    let name = name_of(given).replace('-', "_");
    let value = value?;
    given.starts_with("--").then(|| {
        format!("if the script has such a parameter, write -D {name}={value}")
    })
}

/// What to write instead of an option.
fn tip(given: &str, value: Option<&str>) -> Option<String> {
    let name = name_of(given).to_lowercase().replace('_', "-");
    if let Some((_, instead)) = WORDS.iter().find(|(word, _)| *word == name) {
        return Some(if instead.starts_with('-') {
            format!("write {}", with_value(instead, value))
        } else {
            (*instead).to_owned()
        });
    }
    let setting = name.replace('-', "_");
    let named: Vec<_> = settings::keys()
        .iter()
        .filter(|key| {
            let leaf = key.name.rsplit('.').next();
            key.name == setting
                || leaf == Some(&setting)
                || key.name.replace('.', "_") == setting
        })
        .take(3)
        .map(|key| format!("--set {}", assignment(key, value)))
        .collect();
    if named.is_empty() {
        if let Some(instead) = isoslice_settings::instead(&setting) {
            return Some(format!("it was a setting: {instead}"));
        }
        return of_others(&setting, value);
    }
    Some(format!("it is a setting: write {}", named.join(" or ")))
}

/// What to write instead of another slicer's setting.
fn of_others(setting: &str, value: Option<&str>) -> Option<String> {
    let key_of = |name: &str| settings::keys().iter().find(|k| k.name == name);
    if let Some(now) = isoslice_settings::foreign_name(setting) {
        return Some(match key_of(now) {
            Some(key) => format!("write --set {}", assignment(key, value)),
            None => in_words(now, value),
        });
    }
    match slicerprofile::counterpart(setting)? {
        Counterpart::Keys(names) => Some(match &*names {
            [name] => {
                format!("write --set {}", assignment(key_of(name)?, value))
            }
            _ => format!("write --set with {}", either(&names)),
        }),
        Counterpart::None(why) => {
            Some(format!("it is another slicer's: {why}"))
        }
    }
}

/// What another slicer's setting is here, where that is no name alone: options, one
/// assignment, or several ways in words.
fn in_words(now: &str, value: Option<&str>) -> String {
    if now.starts_with('-') {
        return format!("write {}", with_value(now, value));
    }
    // NAME = VALUE, and no more words.
    let is_one = now.split_whitespace().count() == 3 && now.contains(" = ");
    if is_one {
        let mut one = now.replace(" = ", "=");
        one.retain(|c| c != '"');
        return format!("write --set {one}");
    }
    format!("isoslice has {now}; write --set NAME=VALUE")
}

/// The assignment of a value to a setting, or of a likely one.
fn assignment(key: &Key, value: Option<&str>) -> String {
    if let Some(value) = value.filter(|v| !v.contains([' ', '"'])) {
        return format!("{}={value}", key.name);
    }
    let length = key.length(Builder::new().settings());
    let default = length.map_or_else(|| key.default(), |mm| mm.to_string());
    let likely = match &*default {
        // Who writes the option wants it.
        "false" => "true",
        text if text.contains(['\n', '"']) => "VALUE",
        text => text,
    };
    format!("{}={likely}", key.name)
}

/// The words for an option, with the value that was given in place of NAME, or of the
/// value in the words: a number takes a number's place, and a word a word's.
fn with_value(instead: &str, value: Option<&str>) -> String {
    let Some(value) = value.filter(|v| !v.contains([' ', '"', ','])) else {
        return instead.to_owned();
    };
    if instead.contains("NAME") {
        return instead.replace("NAME", &value.to_lowercase());
    }
    let is_number =
        |text: &str| text.trim_end_matches('%').parse::<f64>().is_ok();
    for way in instead.split(" or ") {
        let Some((before, now)) = way.rsplit_once('=') else {
            continue;
        };
        if now.contains([' ', ',']) || is_number(now) != is_number(value) {
            continue;
        }
        let share = now.ends_with('%') && !value.ends_with('%');
        let unit = if share { "%" } else { "" };
        return format!("{before}={value}{unit}");
    }
    instead.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_as_options_are_told_from_misspelt_options() {
        let tip = |given: &str| tip(given, None).unwrap_or_default();
        assert!(tip("--layer-height").contains("--set layer_height=0.2"));
        assert!(tip("--walls=3").contains("--set walls=2"));
        assert!(tip("--supports").contains("supports=auto"));
        assert!(tip("--bed-temperature").contains("filament.bed_temperature"));
        assert!(tip("--retract-length").contains("retract.length=0.8"));
        assert!(tip("--temperature").contains("nozzle_temperature"));
        assert!(tip("--step-error").contains("layer_heights, such as"));
        assert!(tip("--head-clearance-height=7").contains("45 mm above"));
        assert!(tip("--repotr").is_empty());
        assert!(tip("--spiral-vase").contains("--set spiral=true"));
        assert!(tip("--sparse-infill-density").contains("infill_density"));
        let given = |option: &str, value| super::tip(option, Some(value));
        for (option, value, told) in [
            ("--nozzle", "0.6", "write --set printer.nozzle_diameter=0.6"),
            ("--infill", "20", "write --set infill_density=20%"),
            ("--infill", "grid", "write --set infill=grid"),
            (
                "--temperature",
                "200",
                "write --set filament.nozzle_temperature=200",
            ),
            (
                "--brim",
                "8",
                "write --set brim.place=outer --set brim.width=8",
            ),
            ("--perimeters", "2", "write --set walls=2"),
            ("--filament-type", "PLA", "write --filament pla"),
            ("--quality", "fine", "write --preset fine"),
            ("--enable-support", "1", "write --set supports=auto"),
            (
                "--wall-thickness",
                "1.2",
                "isoslice has walls, a number of lines; write --set NAME=VALUE",
            ),
            (
                "--bed-size",
                "220",
                "isoslice has printer.bed_x and printer.bed_y; write --set NAME=VALUE",
            ),
            ("--seam-position", "rear", "write --set seam=rear"),
            (
                "--fill-angle",
                "30",
                "write --set with infill_angle or skin_angle",
            ),
        ] {
            assert_eq!(given(option, value).as_deref(), Some(told), "{option}");
        }
        let told = |words: &str| {
            let all = words.split(' ').map(str::to_owned);
            let given = words.split(' ').find(|word| word.starts_with("--"));
            let given = given.unwrap();
            let value = value_of(given, all);
            super::tip(given, value.as_deref())
                .or_else(|| parameter(given, value.as_deref()))
                .unwrap_or_default()
        };
        let height = "it is a setting: write --set layer_height=0.1";
        assert_eq!(told("slice a.rhai --layer-height 0.1"), height);
        assert_eq!(told("slice a.rhai --layer-height=0.1"), height);
        assert_eq!(told("slice --layer_height 0.1 a.rhai"), height);
        let walls = "it is a setting: write --set walls=2";
        assert_eq!(told("slice --walls a.rhai"), walls);
        assert!(told("slice a.rhai --radius 12").contains("-D radius=12"));
        assert!(told("slice a.rhai --top-x -3").contains("-D top_x=-3"));
        assert!(told("slice a.rhai --radius").is_empty());
        let stray = |given, before| stray(given, before).unwrap_or_default();
        let told = stray("0.2", "layer_height");
        assert!(told.contains("--set layer_height=0.2,"), "{told}");
        assert!(stray("b.rhai", "a.rhai").starts_with("one model"));
        assert!(stray("b", "a").is_empty());
    }
}

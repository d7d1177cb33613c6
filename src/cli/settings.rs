//! `isoslice settings`: prints all settings as TOML that can be read again.

use super::args::{Gathered, SettingsSource};
use super::{plain, print_json};
use clap::{Args, ValueEnum};
use isoslice::plate::PlateFile;
use isoslice::settings::{Key, Settings, keys};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

const EXAMPLES: &str = "\
Examples:
  isoslice settings > my.toml           all defaults, to edit
  isoslice settings --config my.toml --set walls=3 > mine.toml
  isoslice settings --effective --printer ender-3 --filament petg
  isoslice settings --schema > isoslice.schema.json
  isoslice settings --schema=plate > plate.schema.json";

/// Arguments of `isoslice settings`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct SettingsArgs {
    #[command(flatten)]
    source: SettingsSource,

    /// Instead of what each setting means, say where its value is from: the
    /// default, a profile or file with the line, or --set
    #[arg(long)]
    effective: bool,

    /// Print JSON: value, unit, default and origin of each
    #[arg(long, conflicts_with = "effective")]
    json: bool,

    /// Print a JSON Schema of settings files, or with =plate of plate files,
    /// for editors that complete and check them; no other option changes it
    #[arg(
        long,
        value_name = "OF",
        value_enum,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "settings",
        conflicts_with_all = ["effective", "json"]
    )]
    schema: Option<SchemaOf>,
}

/// The files that a schema describes.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SchemaOf {
    // The option describes these values; descriptions here would make clap
    // print a list.
    Settings,
    Plate,
}

pub(super) fn run(args: &SettingsArgs) -> anyhow::Result<()> {
    match args.schema {
        Some(SchemaOf::Settings) => return print_json(&Settings::schema()),
        Some(SchemaOf::Plate) => return print_json(&PlateFile::schema()),
        None => {}
    }
    let gathered = args.source.gather()?;
    if args.json {
        return print_json(&All(&gathered));
    }
    let settings = &gathered.settings;
    let text = if args.effective {
        settings.to_toml_with_origins(|key| {
            let from = origin(&gathered, key);
            match key.length(settings) {
                Some(length) if key.get(settings).starts_with('"') => {
                    format!("{from}: {length:.3} mm")
                }
                _ => from,
            }
        })
    } else {
        settings.to_toml()
    };
    plain::print_file(&text)
}

/// Where a setting's value is from.
pub(super) fn origin(gathered: &Gathered, key: &Key) -> String {
    let place = gathered.builder.place(key);
    place.map_or_else(|| "default".to_owned(), ToString::to_string)
}

/// All settings by name, in the table's order.
struct All<'a>(&'a Gathered);

#[derive(Serialize)]
struct One {
    value: toml::Value,
    unit: &'static str,
    default: toml::Value,
    /// The length with this nozzle, mm, if the value may be a share of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    length: Option<f64>,
    from: String,
}

impl Serialize for All<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(Some(keys().len()))?;
        for key in keys() {
            let one = One {
                value: value(&key.get(&self.0.settings)),
                unit: key.unit,
                default: value(&key.default()),
                length: key.length(&self.0.settings),
                from: origin(self.0, key),
            };
            map.serialize_entry(key.name, &one)?;
        }
        map.end()
    }
}

/// A value of TOML, to be written as JSON.
fn value(text: &str) -> toml::Value {
    let parsed = text.parse::<toml::Value>();
    // A setting's value is always written as TOML.
    parsed.unwrap_or_else(|_| toml::Value::String(text.to_owned()))
}

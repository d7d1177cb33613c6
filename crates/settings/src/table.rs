//! The table of settings: the macro that declares it and the rows it makes.
//!
//! In: the rows in `rows`. Out: the structs with their defaults,
//! and [`keys`], one [`Key`] per setting with everything that can be said
//! about it. A setting cannot exist without a row, nor a row without a
//! setting.

use super::Settings;
use super::idle::Reason;
use super::rows::{GROUPS, KEYS};
use super::value::{Form, Measure, Range, Raw, Refused, Value, ValueKind};
use isoslice_base::units::human_list;

/// One row of the table: a setting's name and all that is known about it.
#[derive(Debug)]
pub struct Key {
    /// Name of the setting in files and on the command line: `layer_height`,
    /// `speed.outer_wall`.
    pub name: &'static str,
    pub(super) section: &'static str,
    /// Unit of the setting's value; empty if it has none.
    pub unit: &'static str,
    /// Allowed values, if the setting is a number.
    pub range: Option<Range>,
    pub(super) doc: &'static str,
    pub(super) field: fn(&Settings) -> &dyn Value,
    pub(super) assign:
        fn(&mut Settings, Raw<'_>, Measure) -> Result<(), Refused>,
    /// What may deprive the setting of its effect.
    pub(super) idle: &'static [Reason],
}

impl Key {
    /// What the setting means, in a sentence or two.
    pub fn description(&self) -> String {
        tidy(self.doc)
    }

    /// Heading under which the setting is listed.
    pub fn section(&self) -> String {
        GROUPS
            .iter()
            .find(|(group, _)| *group == self.group())
            .map_or_else(|| self.section.to_owned(), |(_, doc)| tidy(doc))
    }

    /// What may be assigned: `0.02 to 2 mm`, `marlin or klipper`.
    pub fn allowed(&self) -> String {
        let range = self.range_with(&self.spaced_unit());
        match self.kind() {
            ValueKind::Number | ValueKind::Whole => range,
            ValueKind::Varying => format!("{range}, or \"expr: ...\""),
            ValueKind::WholeOrAuto | ValueKind::NumberOrAuto => {
                format!("auto, or {range}")
            }
            ValueKind::ByNozzle => {
                format!("auto, {range}, or a share of the nozzle such as 75%")
            }
            ValueKind::Switch => "true or false".to_owned(),
            ValueKind::Text => "any text".to_owned(),
            ValueKind::Sizes => {
                "32x32, 300x300 or other sizes, or nothing".to_owned()
            }
            ValueKind::SwitchOrWhole | ValueKind::SwitchOrNumber => {
                format!("true, false, or {range}")
            }
            ValueKind::NumberOrText(allowed, _)
            | ValueKind::WholeOrText(allowed, _) => allowed.to_owned(),
            ValueKind::Word(words) => human_list(words, "or"),
            ValueKind::WordOrText(words, forms) => {
                let forms = forms.iter().map(|form| form.shown().to_owned());
                let words = words.iter().map(|word| (*word).to_owned());
                human_list(&words.chain(forms).collect::<Vec<_>>(), "or")
            }
            ValueKind::WordOrNumber(words) | ValueKind::WordOrWhole(words) => {
                format!("{} or {range}", words.join(", "))
            }
        }
    }

    /// What may be assigned and how it is written, for a message about a wrong
    /// type.
    pub(super) fn expected(&self) -> String {
        let range = self.range_with("");
        match (self.kind(), self.unit) {
            (ValueKind::Number, "") => format!("a number from {range}"),
            (ValueKind::Number, "%") => format!(
                "a percentage, {}, such as 25 or \"25%\"",
                self.range_with("%")
            ),
            (ValueKind::Number, unit) => {
                let from = match self.range {
                    Some(Range { or_zero: true, .. }) => "",
                    _ => "a number from ",
                };
                format!("{from}{range} (in {unit}, without quotes or unit)")
            }
            (ValueKind::Varying, unit) => format!(
                "{range}{}{unit} or \"expr: ...\", a formula of x, y, z and {}",
                if unit.is_empty() { "" } else { " " },
                // `Quantity::of_outline` knows the curvature in place of the
                // depth.
                match self.name {
                    "xy_compensation" => "curvature",
                    _ => "d",
                }
            ),
            (ValueKind::Whole, _) => format!("a whole number, {range}"),
            (ValueKind::WholeOrAuto, _) => {
                format!("\"auto\" or a whole number, {range}")
            }
            (ValueKind::NumberOrAuto, unit) => {
                format!(
                    "\"auto\" or a number from {range} (in {unit}, without \
                     unit)"
                )
            }
            (ValueKind::ByNozzle, unit) => format!(
                "\"auto\", a number from {range} (in {unit}, without unit), \
                 or a share of the nozzle's diameter, such as \"75%\""
            ),
            (ValueKind::Text, _) => "text in quotes".to_owned(),
            (ValueKind::Sizes, _) => super::sizes::EXPECTED.to_owned(),
            (
                ValueKind::Switch
                | ValueKind::NumberOrText(..)
                | ValueKind::WholeOrText(..)
                | ValueKind::SwitchOrWhole
                | ValueKind::SwitchOrNumber
                | ValueKind::Word(_)
                | ValueKind::WordOrText(..)
                | ValueKind::WordOrNumber(_)
                | ValueKind::WordOrWhole(_),
                _,
            ) => self.allowed(),
        }
    }

    fn range_with(&self, unit: &str) -> String {
        self.range
            .map_or_else(String::new, |range| format!("{range}{unit}"))
    }

    /// The words that may be assigned, if nothing else may.
    pub fn words(&self) -> &'static [&'static str] {
        match self.kind() {
            ValueKind::Word(words) => words,
            ValueKind::Switch => &["true", "false"],
            _ => &[],
        }
    }

    /// The words that may be assigned, whether or not numbers or formulas may be
    /// assigned as well.
    pub fn some_words(&self) -> &'static [&'static str] {
        match self.kind() {
            ValueKind::NumberOrText(_, forms)
            | ValueKind::WholeOrText(_, forms)
                if forms.contains(&Form::Auto) =>
            {
                &["auto"]
            }
            ValueKind::WordOrText(words, _)
            | ValueKind::WordOrNumber(words)
            | ValueKind::WordOrWhole(words) => words,
            ValueKind::WholeOrAuto
            | ValueKind::NumberOrAuto
            | ValueKind::ByNozzle => &["auto"],
            _ => self.words(),
        }
    }

    /// The setting's value in `settings`, as TOML.
    pub fn get(&self, settings: &Settings) -> String {
        (self.field)(settings).to_toml()
    }

    /// The length that the setting's value is with the nozzle of `settings`,
    /// mm, if lengths of this setting may follow the nozzle.
    pub fn length(&self, settings: &Settings) -> Option<f64> {
        let all = settings.by_nozzle().into_iter();
        let mut of_this = all.filter(|(name, _, _)| *name == self.name);
        of_this.next().map(|(_, _, length)| length)
    }

    /// The setting's default, as TOML.
    pub fn default(&self) -> String {
        self.get(&Settings::default())
    }

    /// The group's name, empty for a setting outside the groups.
    pub(super) fn group(&self) -> &'static str {
        self.name.split_once('.').map_or("", |(group, _)| group)
    }

    /// True if the value is a template of G-code.
    pub(super) fn is_template(&self) -> bool {
        self.group() == "gcode" && self.kind() == ValueKind::Text
    }

    /// The name within the group.
    pub(super) fn leaf(&self) -> &'static str {
        self.name
            .split_once('.')
            .map_or(self.name, |(_, leaf)| leaf)
    }

    /// The unit as text behind a number.
    pub(super) fn spaced_unit(&self) -> String {
        match self.unit {
            "" => String::new(),
            "%" | "°" => self.unit.to_owned(),
            unit => format!(" {unit}"),
        }
    }

    /// What a number for the setting is measured by.
    pub(super) fn measure(&self) -> Measure {
        Measure {
            unit: self.unit,
            range: self.range,
        }
    }

    /// True if the setting takes a text.
    pub(super) fn takes(&self, text: &str) -> bool {
        let mut settings = Settings::default();
        (self.assign)(&mut settings, Raw::Text(text), self.measure()).is_ok()
    }

    pub(super) fn kind(&self) -> ValueKind {
        (self.field)(&Settings::default()).kind()
    }
}

/// Every setting, in the order in which they are listed.
pub fn keys() -> &'static [Key] {
    KEYS
}

/// Names that settings once had, and those they have now.
const RENAMED: [(&str, &str); 2] = [
    ("speed.small_perimeter", "speed.small_wall"),
    ("speed.small_perimeter_length", "speed.small_wall_length"),
];

/// The name that a setting has now, by that or by one that it once had.
pub fn name_now(name: &str) -> &str {
    let renamed = RENAMED.iter().find(|(old, _)| *old == name);
    renamed.map_or(name, |(_, new)| new)
}

/// The key of a name, which may be one that the setting once had.
pub(super) fn find(name: &str) -> Option<&'static Key> {
    let name = name_now(name);
    keys().iter().find(|key| key.name == name)
}

/// True if there are settings named `name.…`.
pub(super) fn is_group(name: &str) -> bool {
    keys().iter().any(|key| key.group() == name)
}

/// The known name most like `name`, or nothing if all are very different.
pub(super) fn nearest(name: &str) -> Option<&'static str> {
    // Likeness below which suggestions are guesses that do not help.
    const ALIKE: f64 = 0.6;
    let name = name.to_lowercase().replace('-', "_");
    let leaf = name.rsplit('.').next().unwrap_or(&name);
    keys()
        .iter()
        .map(|key| {
            let whole = strsim::normalized_damerau_levenshtein(&name, key.name);
            // The right name in the wrong group, and a part of a name, are
            // likelier than a misspelling. Between several the whole name
            // decides.
            let part = strsim::normalized_damerau_levenshtein(leaf, key.leaf());
            let part = if leaf.len() > 2 && key.leaf().contains(leaf) {
                part.max(0.9)
            } else {
                part
            };
            (whole.max(0.9 * part) + 0.01 * whole, key.name)
        })
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// The names that have `name` as a part, in whole words, and as few other words
/// as possible. They are in the table's order, and of the group that `name`
/// has, if it has one.
pub(super) fn ambiguous(name: &str) -> Vec<&'static str> {
    // A message has these names in one sentence.
    const MOST_NAMES: usize = 4;
    let name = name.to_lowercase().replace('-', "_");
    let (group, name) = name.split_once('.').unwrap_or(("", &name));
    let of_group = |key: &&Key| group.is_empty() || key.group() == group;
    let besides = |key: &Key| {
        let (whole, part) = (format!("_{}_", key.leaf()), format!("_{name}_"));
        whole
            .contains(&part)
            .then(|| key.leaf().matches('_').count())
    };
    let all = keys().iter().filter(of_group);
    let Some(least) = all.clone().filter_map(besides).min() else {
        return Vec::new();
    };
    let all = all.filter(|key| besides(key) == Some(least));
    all.map(|key| key.name).take(MOST_NAMES).collect()
}

/// A doc comment as one line: doc comments keep the spaces and line breaks of
/// the source.
pub(super) fn tidy(doc: &str) -> String {
    doc.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Name of a field in files: its own, unless Rust keeps that for itself.
macro_rules! name {
    (where_) => {
        "where"
    };
    ($field:ident) => {
        stringify!($field)
    };
}

/// Unit of a type in the table.
#[rustfmt::skip]
macro_rules! unit {
    (Varying<$inner:ident>) => { $crate::table::unit!($inner) };
    (SwitchOr<$inner:ident>) => { $crate::table::unit!($inner) };
    (Mm) => { "mm" };
    (Option<$inner:ident>) => { $crate::table::unit!($inner) };
    (ByNozzle) => { "mm" };
    (DraftShield) => { "mm" };
    (ElephantFoot) => { "mm" };
    (Scarf) => { "mm" };
    (HeadClearance) => { "mm" };
    (InterfacePattern) => { "°" };
    (LineDensity) => { "%" };
    (OverhangSpeed) => { "mm/s" };
    (OverhangFan) => { "%" };
    (Mm2) => { "mm²" };
    (MmPerSec) => { "mm/s" };
    (PerSec) => { "1/s" };
    (MmPerSec2) => { "mm/s²" };
    (Mm3PerSec) => { "mm³/s" };
    (Mm3PerSec2) => { "mm³/s²" };
    (Seconds) => { "s" };
    (Degrees) => { "°" };
    (Celsius) => { "°C" };
    (Percent) => { "%" };
    (GramsPerCm3) => { "g/cm³" };
    (PricePerKg) => { "per kg" };
    ($($other:tt)*) => { "" };
}

/// Range of a row, if it has one.
macro_rules! range {
    () => {
        None
    };
    ($min:literal $max:literal) => {
        Some($crate::Range::between($min as f64, $max as f64))
    };
    ($min:literal $max:literal or_zero) => {
        Some($crate::Range {
            or_zero: true,
            ..$crate::Range::between($min as f64, $max as f64)
        })
    };
}

/// Declares the structs, their defaults and the table of keys.
macro_rules! settings {
    (
        $(#[doc = $root_doc:literal])+
        $root:ident {
            $(
                [$section:literal]
                $(
                    $(#[doc = $doc:literal])+
                    $field:ident : $ty:ident $(<$inner:ident>)? = $default:expr
                        $(, in $min:literal ..= $max:literal)?
                        $(, idle $($idle:ident)|+)?;
                )+
            )+
        }
        $(
            $(#[doc = $group_doc:literal])+
            $group:ident : $group_ty:ident {
                $(
                    $(#[doc = $gdoc:literal])+
                    $gfield:ident : $gty:ident $(<$ginner:ident>)?
                        = $gdefault:expr
                        $(, in $gmin:literal ..= $gmax:literal
                            $($gzero:ident)?)?
                        $(, idle $($gidle:ident)|+)?;
                )+
            }
        )+
    ) => {
        $(#[doc = $root_doc])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $root {
            $($(
                $(#[doc = $doc])+
                #[doc = concat!("\n\nDefault: `", stringify!($default), "`.")]
                pub $field: $ty $(<$inner>)?,
            )+)+
            $(
                $(#[doc = $group_doc])+
                pub $group: $group_ty,
            )+
        }
        impl Default for $root {
            fn default() -> Self {
                Self {
                    $($($field: $default,)+)+
                    $($group: $group_ty::default(),)+
                }
            }
        }
        $(
            $(#[doc = $group_doc])+
            #[derive(Clone, Debug, PartialEq)]
            pub struct $group_ty {
                $(
                    $(#[doc = $gdoc])+
                    #[doc = concat!(
                        "\n\nDefault: `", stringify!($gdefault), "`."
                    )]
                    pub $gfield: $gty $(<$ginner>)?,
                )+
            }
            impl Default for $group_ty {
                fn default() -> Self {
                    Self { $($gfield: $gdefault,)+ }
                }
            }
        )+

        /// Descriptions of the groups, by name.
        pub(super) static GROUPS: &[(&str, &str)] = &[
            $((stringify!($group), concat!($($group_doc, "\n"),+)),)+
        ];

        /// All rows, in their order.
        pub(super) static KEYS: &[$crate::Key] = &[
            $($($crate::Key {
                name: $crate::table::name!($field),
                section: $section,
                unit: $crate::table::unit!($ty $(<$inner>)?),
                range: $crate::table::range!($($min $max)?),
                doc: concat!($($doc, "\n"),+),
                field: |settings| &settings.$field,
                assign: |settings, raw, measure| {
                    settings.$field = $crate::value::Value::read(raw, measure)?;
                    Ok(())
                },
                idle: &[$($($crate::idle::$idle),+)?],
            },)+)+
            $($($crate::Key {
                name: concat!(
                    stringify!($group),
                    ".",
                    $crate::table::name!($gfield)
                ),
                section: stringify!($group),
                unit: $crate::table::unit!($gty $(<$ginner>)?),
                range: $crate::table::range!($($gmin $gmax $($gzero)?)?),
                doc: concat!($($gdoc, "\n"),+),
                field: |settings| &settings.$group.$gfield,
                assign: |settings, raw, measure| {
                    settings.$group.$gfield = $crate::value::Value::read(raw, measure)?;
                    Ok(())
                },
                idle: &[$($($crate::idle::$gidle),+)?],
            },)+)+
        ];
    };
}
pub(super) use {name, range, settings, unit};

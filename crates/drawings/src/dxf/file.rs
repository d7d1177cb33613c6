//! What of a DXF file matters: its unit, layers, blocks and entities.

use super::pairs::{Pair, Pairs, Record, shown};
use glam::DVec2;
use isoslice_base::problem::{Problem, go_on};
use std::collections::BTreeMap;

/// The most records of a file: some 60 MB of memory.
const MOST_RECORDS: usize = 1_000_000;

/// A layer of the table of layers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Layer {
    /// True if it is turned off.
    pub(super) is_off: bool,
    /// True if it is frozen, with all blocks that are inserted on it.
    pub(super) is_frozen: bool,
}

/// A drawing that is inserted by its name.
#[derive(Debug, Default)]
pub(super) struct Block<'a> {
    /// The point that comes to lie where it is inserted.
    pub(super) base: DVec2,
    pub(super) records: Vec<Record<'a>>,
}

#[derive(Debug, Default)]
pub(super) struct File<'a> {
    /// The number of its unit, 0 if it names none.
    pub(super) unit: i64,
    /// Layers and blocks by their [folded] names.
    pub(super) layers: BTreeMap<String, Layer>,
    pub(super) blocks: BTreeMap<String, Block<'a>>,
    pub(super) entities: Vec<Record<'a>>,
}

/// A name as it is compared: capitals make no difference.
pub(super) fn folded(name: &str) -> String {
    name.to_uppercase()
}

impl<'a> File<'a> {
    pub(super) fn read(text: &'a str) -> Problem<File<'a>> {
        let mut reader = Reader::default();
        let mut pairs = Pairs::new(text);
        let mut count = 0;
        while let Some(record) = pairs.record()? {
            go_on()?;
            count += 1;
            if count > MOST_RECORDS {
                return Err(format!(
                    "it has more than {MOST_RECORDS} records; simplify it"
                ));
            }
            if record.kind == "EOF" {
                break;
            }
            reader.take(record)?;
        }
        if !reader.is_whole {
            return Err(match reader.section {
                "" => "it has no section ENTITIES, so it is no drawing in DXF",
                _ => "it ends within a section; copy or save it again",
            }
            .into());
        }
        Ok(reader.file)
    }

    /// The names of all layers, in order, each once.
    pub(super) fn layer_names(&self) -> Problem<Vec<&'a str>> {
        let blocks = self.blocks.values().flat_map(|b| &b.records);
        let all = self.entities.iter().chain(blocks);
        let names: Problem<Vec<&str>> = all.map(|r| r.name(8)).collect();
        let mut names = names?;
        names.retain(|name| !name.is_empty());
        names.sort_unstable();
        names.dedup();
        Ok(names)
    }
}

#[derive(Default)]
struct Reader<'a> {
    file: File<'a>,
    /// The section that is being read.
    section: &'a str,
    /// The block that is being read, with its name.
    block: Option<(String, Block<'a>)>,
    /// True if the end of the entities was found.
    is_whole: bool,
}

impl<'a> Reader<'a> {
    fn take(&mut self, record: Record<'a>) -> Problem<()> {
        match (self.section, record.kind) {
            (_, "SECTION") => {
                self.section = record.text(2);
                if self.section == "HEADER" {
                    self.file.unit = unit(&record)?;
                }
            }
            (section, "ENDSEC") => {
                self.is_whole |= section == "ENTITIES";
                self.section = "";
            }
            ("TABLES", "LAYER") => self.layer(&record)?,
            ("BLOCKS", "BLOCK") => {
                let base = match record.number(10)? {
                    Some(_) => record.point(10)?,
                    None => DVec2::ZERO,
                };
                let records = Vec::new();
                let name = folded(record.name(2)?);
                self.block = Some((name, Block { base, records }));
            }
            ("BLOCKS", "ENDBLK") => self.file.blocks.extend(self.block.take()),
            ("BLOCKS", _) => {
                if let Some((_, block)) = &mut self.block {
                    block.records.push(record);
                }
            }
            ("ENTITIES", _) => self.file.entities.push(record),
            _ => {}
        }
        Ok(())
    }

    fn layer(&mut self, record: &Record<'a>) -> Problem<()> {
        /// The flag of layers that are frozen.
        const FROZEN: i64 = 1;
        let layer = Layer {
            // The colour of a layer that is off is negative.
            is_off: record.integer(62)?.is_some_and(|colour| colour < 0),
            is_frozen: record.has_flag(FROZEN)?,
        };
        self.file.layers.insert(folded(record.name(2)?), layer);
        Ok(())
    }
}

/// The number of the unit that a header names.
fn unit(header: &Record<'_>) -> Problem<i64> {
    let mut pairs = header.pairs();
    let named = |pair: &Pair<'_>| pair.code == 9 && pair.value == "$INSUNITS";
    match pairs.find(named).and_then(|_| pairs.next()) {
        Some(unit) => unit.integer(),
        None => Ok(0),
    }
}

/// How many mm a unit has, by its number in files; none for 0.
pub(super) fn millimetres(unit: i64) -> Problem<Option<f64>> {
    Ok(Some(match unit {
        0 => return Ok(None),
        1 => 25.4,
        2 => 304.8,
        4 => 1.0,
        5 => 10.0,
        6 => 1e3,
        7 => 1e6,
        // Microinches and thousandths of an inch.
        8 => 25.4e-6,
        9 => 25.4e-3,
        // Yards.
        10 => 914.4,
        12 => 1e-6,
        13 => 1e-3,
        14 => 100.0,
        15 => 1e4,
        16 => 1e5,
        // Feet of the survey of the United States.
        21 => 1200e3 / 3937.0,
        _ => {
            return Err(format!(
                "its unit of length has the number {}, which is not known; say \
                 how many mm the unit has with unit",
                shown(&unit.to_string())
            ));
        }
    }))
}

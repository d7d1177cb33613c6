//! How much nearer two letters are than their widths say.

use skrifa::raw::tables::gpos::{
    Gpos, PairPos, PositionLookup, PositionSubtables,
};
use skrifa::raw::tables::kern::SubtableKind;
use skrifa::raw::types::Tag;
use skrifa::raw::{FontRef, TableProvider};
use skrifa::{GlyphId, GlyphId16};

/// The pairs of letters of a font.
pub(super) struct Kerning<'a> {
    font: FontRef<'a>,
    /// Lists of pairs, in the order in which they count.
    lookups: Vec<PositionLookup<'a>>,
}

/// The most lists that are looked at; fonts have some ten.
const MOST_LOOKUPS: usize = 64;

impl<'a> Kerning<'a> {
    pub(super) fn new(font: &FontRef<'a>) -> Kerning<'a> {
        let gpos = font.gpos().ok();
        Kerning {
            font: font.clone(),
            lookups: gpos.and_then(|g| lookups(&g)).unwrap_or_default(),
        }
    }

    /// By how much the second of two letters is moved, in the font's units.
    pub(super) fn between(&self, a: GlyphId, b: GlyphId) -> f64 {
        if !self.lookups.is_empty() {
            let all = self.lookups.iter().filter_map(|l| of_lookup(l, a, b));
            return all.map(f64::from).sum();
        }
        let Ok(kern) = self.font.kern() else {
            return 0.0;
        };
        let tables = kern.subtables().take(MOST_LOOKUPS).flatten();
        let flat = tables.filter(|t| t.is_horizontal() && !t.is_cross_stream());
        let kinds = flat.filter_map(|t| t.kind().ok());
        let found = kinds.filter_map(|kind| match kind {
            SubtableKind::Format0(pairs) => pairs.kerning(a, b),
            SubtableKind::Format2(pairs) => pairs.kerning(a, b),
            SubtableKind::Format3(pairs) => pairs.kerning(a, b),
            SubtableKind::Format1(_) => None,
        });
        found.map(f64::from).sum()
    }
}

/// The lists of the feature `kern` for Latin letters, or for all.
fn lookups<'a>(gpos: &Gpos<'a>) -> Option<Vec<PositionLookup<'a>>> {
    let scripts = gpos.script_list().ok()?;
    let records = scripts.script_records();
    let named = |tag: &[u8; 4]| {
        let tag = Tag::new(tag);
        records.iter().find(|r| r.script_tag() == tag)
    };
    let record = named(b"latn").or(named(b"DFLT")).or(records.first())?;
    let script = record.script(scripts.offset_data()).ok()?;
    let system = script.default_lang_sys()?.ok()?;
    let features = gpos.feature_list().ok()?;
    let list = gpos.lookup_list().ok()?;
    let mut numbers = Vec::new();
    for index in system.feature_indices() {
        let record = features.feature_records().get(index.get() as usize);
        if let Some(record) = record
            && record.feature_tag() == Tag::new(b"kern")
            && let Ok(feature) = record.feature(features.offset_data())
        {
            let all = feature.lookup_list_indices().iter();
            numbers.extend(all.map(|n| usize::from(n.get())));
        }
    }
    numbers.sort_unstable();
    numbers.dedup();
    numbers.truncate(MOST_LOOKUPS);
    let all = numbers.into_iter();
    Some(all.filter_map(|n| list.lookups().get(n).ok()).collect())
}

/// What the first part of a list that knows a pair says of it.
fn of_lookup(lookup: &PositionLookup, a: GlyphId, b: GlyphId) -> Option<i16> {
    let Ok(PositionSubtables::Pair(parts)) = lookup.subtables() else {
        return None;
    };
    let parts = parts.iter().take(MOST_LOOKUPS).flatten();
    parts.into_iter().find_map(|part| of_pairs(&part, a, b))
}

fn of_pairs(pairs: &PairPos, a: GlyphId, b: GlyphId) -> Option<i16> {
    match pairs {
        PairPos::Format1(pairs) => {
            let set = pairs.coverage().ok()?.get(a)?;
            let set = pairs.pair_sets().get(usize::try_from(set).ok()?).ok()?;
            let second = GlyphId16::try_from(b).ok()?;
            let records = set.pair_value_records();
            let found = records
                .iter()
                .flatten()
                .find(|r| r.second_glyph() == second)?;
            Some(found.value_record1().x_advance().unwrap_or(0))
        }
        PairPos::Format2(pairs) => {
            pairs.coverage().ok()?.get(a)?;
            let class = [
                pairs.class_def1().ok()?.get(a),
                pairs.class_def2().ok()?.get(b),
            ];
            let first = pairs.class1_records().get(class[0] as usize).ok()?;
            let record = first.class2_records().get(class[1] as usize).ok()?;
            Some(record.value_record1().x_advance().unwrap_or(0))
        }
        _ => None,
    }
}

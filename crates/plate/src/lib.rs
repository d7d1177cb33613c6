//! A plate: what is printed in one go. One part, or several, each with its
//! settings and its places.
//!
//! ```text
//! Wanted, Wanted, … ──new──► Plate: Part (model, settings) ─┬─ place
//!                                                           ├─ place
//!                                   Part (model, settings) ─┴─ place
//! ```
//!
//! In: models with their parameters, how they are turned, their settings, how
//! many of each there are to be, and where those stand that have a place. Out:
//! parts, each in the middle of the bed as if it were alone, and for each of its
//! places how far it is from there. Equal parts become places of one part,
//! which is sliced once.
//!
//! | file | what it does |
//! |---|---|
//! | `file` | reads a plate from a file |
//! | `schema` | says what a plate file may hold, for editors |
//! | `shared` | which settings hold for the whole plate |
//! | `arrange` | finds a place for the parts that have none |
//! | `sequence` | the order of parts that are printed one by one, and whether the head has room |
//!
//! Guaranteed: equal input gives equal plates; boxes of parts, with their
//! brims, do not overlap and are on the bed. Not guaranteed: that everything is
//! placed that could be.

#![warn(unreachable_pub)]

mod arrange;
mod error;
mod file;
mod schema;
mod sequence;
mod shared;

pub use error::PlateError;
pub use file::PlateFile;

use arrange::{Bed, Box as PartBox, arrange};
use glam::{DVec2, DVec3};
use isoslice_base::units::Mm;
use isoslice_layer::adhesion::BrimPlan;
use isoslice_model::{
    Bounds, BuildVolume, Model, Placement, Source, load, place, together,
};
use isoslice_planar::Rect;
use isoslice_settings::{DraftShield, Settings};
use sequence::Arrangement;
use std::collections::BTreeMap;

/// What positions are multiples of, mm: a digit of the G-code, so that equal
/// parts are written alike.
const DIGIT: Mm = 1e-3;

/// Copies of a model that are asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// The model.
    pub source: Source,
    /// Parameters of the model's script, with their values.
    pub defines: Vec<(String, String)>,
    /// How the model is scaled and turned. Where it stands is `at`.
    pub placement: Placement,
    /// How the model is printed.
    pub settings: Settings,
    /// Where on the bed the middle of the model's box stands, mm; nothing if a
    /// place is to be found.
    pub at: Option<(f64, f64)>,
    /// Number of copies.
    pub copies: u64,
    /// Where the copies were asked for, for messages: a file and a line, or a
    /// model.
    pub asked: String,
}

/// Parts that are printed together.
#[derive(Clone)]
pub struct Plate {
    /// The plate's name. If there is one part only, it is the model's.
    pub name: String,
    /// The settings that hold for the whole plate.
    pub settings: Settings,
    /// The parts. Parts of one name may differ in parameters or settings.
    pub parts: Vec<Part>,
}

/// A part, and where it stands.
#[derive(Clone)]
pub struct Part {
    /// The model, placed as if it were alone.
    pub model: Model,
    /// How the part is printed.
    pub settings: Settings,
    /// The places where the part stands.
    pub places: Vec<PartPlace>,
    /// Indices of the [`Wanted`] entries that became this part.
    pub wanted: Vec<usize>,
    /// Where there may be supports when the part stands where the model was
    /// placed; nothing if they may be anywhere on the bed.
    room: Option<Rect>,
}

/// Where a part stands.
#[derive(Clone, Debug, PartialEq)]
pub struct PartPlace {
    /// Name of the part in this place.
    pub name: String,
    /// How far the place is from where the model was placed, mm.
    pub shift: DVec2,
}

impl Plate {
    /// Greatest number of parts on a plate.
    pub const MOST_PARTS: u64 = isoslice_base::limits::MOST_PARTS;

    /// A plate with one part, where the model was placed.
    pub fn of(model: &Model, settings: &Settings) -> Plate {
        let place = PartPlace {
            name: model.name.clone(),
            shift: DVec2::ZERO,
        };
        Plate {
            name: model.name.clone(),
            settings: settings.clone(),
            parts: vec![Part {
                model: model.clone(),
                settings: settings.clone(),
                places: vec![place],
                wanted: vec![0],
                room: None,
            }],
        }
    }

    /// A plate of what is wanted. `settings` are those of the whole plate; the
    /// parts' own may differ from them where parts need not agree.
    ///
    /// # Errors
    /// If there is nothing, or too much, or it does not fit on the bed; if a
    /// model cannot be loaded or placed; or if settings differ that may not.
    pub fn new(
        name: &str,
        wanted: &[Wanted],
        settings: &Settings,
    ) -> Result<Plate, PlateError> {
        let plate = Self::made(name, wanted, settings);
        plate.map_err(|error| error.located(wanted))
    }

    fn made(
        name: &str,
        wanted: &[Wanted],
        settings: &Settings,
    ) -> Result<Plate, PlateError> {
        let count = wanted
            .iter()
            .fold(0u64, |sum, w| sum.saturating_add(w.copies));
        if count == 0 {
            return Err(PlateError::Empty);
        }
        if count > Plate::MOST_PARTS {
            return Err(PlateError::TooMany { count });
        }
        let mut plate = Plate {
            name: name.to_owned(),
            settings: settings.clone(),
            parts: Vec::new(),
        };
        for one in wanted {
            one.check(&plate, count)?;
        }
        let kinds = kinds(wanted);
        let mut parts = Vec::new();
        for kind in &kinds {
            let part = load_part(wanted[kind[0]].clone(), count)?;
            let wanted = kind.clone();
            parts.push((Part { wanted, ..part }, kind));
        }
        if count > 1 && plate.is_one_by_one() {
            plate.check_alone()?;
        }
        place_all(&mut plate, parts, wanted)?;
        plate.check_sequence()?;
        Ok(plate)
    }

    /// The name of a plate of these models, made of their names if they are few.
    pub fn name_of(wanted: &[Wanted]) -> String {
        // The name is part of a file's name.
        const MOST_NAMES: usize = 3;
        let mut names: Vec<String> = Vec::new();
        for one in wanted {
            let name = one.source.name();
            if !names.contains(&name) {
                names.push(name);
            }
        }
        match names.len() {
            ..=MOST_NAMES => names.join("+"),
            _ => format!("{}+{} more", names[0], names.len() - 1),
        }
    }

    /// What the user should know of the models, with their names if there are
    /// several.
    pub fn warnings(&self) -> Vec<String> {
        let several = self.parts.len() > 1;
        let of_part = |part: &Part| {
            let name = part.model.name.clone();
            let told = part.model.warnings.clone().into_iter();
            told.map(move |warning| {
                if several {
                    format!("{name}: {warning}")
                } else {
                    warning
                }
            })
        };
        self.parts.iter().flat_map(of_part).collect()
    }

    /// Number of places in which there are parts.
    pub fn place_count(&self) -> usize {
        self.parts.iter().map(|part| part.places.len()).sum()
    }

    /// For each place its part's number, and how far it is from where the
    /// part's model was placed.
    #[doc(hidden)]
    pub fn shifts(&self) -> Vec<(usize, DVec2)> {
        let parts = self.parts.iter().enumerate();
        let places = parts.flat_map(|(k, part)| {
            part.places.iter().map(move |place| (k, place.shift))
        });
        places.collect()
    }

    /// Everything on the plate as one model, unless that would be too large.
    pub fn whole(&self) -> Option<Model> {
        if let ([part], 1) = (self.parts.as_slice(), self.place_count()) {
            return Some(part.model.clone());
        }
        let shifts = self.shifts().into_iter();
        let models = shifts.map(|(k, shift)| (&self.parts[k].model, shift));
        together(&self.name, models)
    }

    /// Each part once as one model, unless that would be too large.
    pub fn of_each(&self) -> Option<Model> {
        let first = |part: &Part| {
            part.places.first().map_or(DVec2::ZERO, |place| place.shift)
        };
        let models = self.parts.iter().map(|p| (&p.model, first(p)));
        together(&self.name, models)
    }

    /// The box of all that is printed of the parts, on the bed.
    #[doc(hidden)]
    pub fn reach(&self) -> (DVec3, DVec3) {
        let shifts = self.shifts().into_iter();
        let boxes = shifts.map(|(k, shift)| {
            let (low, high) = self.parts[k].reach();
            (low + shift.extend(0.0), high + shift.extend(0.0))
        });
        let both =
            |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        boxes.reduce(both).unwrap_or_default()
    }

    /// Extent of all parts together.
    pub fn size(&self) -> DVec3 {
        if let ([part], 1) = (self.parts.as_slice(), self.place_count()) {
            return part.model.bounds.size();
        }
        self.printed_bounds().map_or(DVec3::ZERO, |all| all.size())
    }

    /// The box of all parts on the bed; none if there are no parts.
    pub fn printed_bounds(&self) -> Option<Bounds> {
        let shifts = self.shifts().into_iter();
        let boxes = shifts.map(|(k, shift)| {
            let bounds = self.parts[k].model.printed_bounds();
            bounds.moved(shift.extend(0.0))
        });
        boxes.reduce(Bounds::union)
    }
}

impl Part {
    /// The box of all that is printed of the part, where its model was placed.
    #[doc(hidden)]
    pub fn reach(&self) -> (DVec3, DVec3) {
        let reach = self.settings.reach();
        let reach = DVec3::new(reach, reach, 0.0);
        let (bounds, offset) = (&self.model.bounds, self.model.offset);
        (bounds.min + offset - reach, bounds.max + offset + reach)
    }

    /// Where there may be supports, where the model was placed.
    #[doc(hidden)]
    pub fn room(&self) -> Rect {
        let printer = &self.settings.printer;
        self.room.unwrap_or(Rect::new(
            DVec2::ZERO,
            DVec2::new(printer.bed_x, printer.bed_y),
        ))
    }

    /// The box of what stands on the bed, the part with its brim or its raft,
    /// where the model was placed.
    fn foot(&self) -> Rect {
        let (low, high) = self.reach();
        let raft = match self.settings.raft_layers() {
            0 => 0.0,
            _ => self.settings.raft.expansion,
        };
        let brim = BrimPlan::of(&self.settings).reach.max(raft);
        Rect::new(low.truncate() - brim, high.truncate() + brim)
    }
}

impl Part {
    /// The box of what stands on the bed, for each place.
    fn feet(&self) -> impl Iterator<Item = Rect> {
        let foot = self.foot();
        self.places.iter().map(move |place| foot.moved(place.shift))
    }

    /// Distance of the nearest other part. `all` are the boxes on the bed,
    /// which do not overlap.
    fn free(&self, all: &[Rect]) -> Mm {
        let apart =
            |a: Rect, b: Rect| (a.min - b.max).max(b.min - a.max).max_element();
        let gaps = self.feet().flat_map(|own| {
            // A part's own box is among them. It is the one that equals the box
            // asked for.
            let others = all.iter().filter(move |other| **other != own);
            others.map(move |other| apart(own, *other))
        });
        gaps.fold(f64::INFINITY, f64::min).max(0.0)
    }
}

impl Wanted {
    /// Refuses what a plate of `count` parts cannot have.
    fn check(&self, plate: &Plate, count: u64) -> Result<(), PlateError> {
        let asked = || self.asked.clone();
        if let Some(differs) = shared::difference(plate, self) {
            return Err(PlateError::Differs {
                asked: asked(),
                key: differs.key,
                value: differs.value,
                of_plate: differs.of_plate,
            });
        }
        if self.at.is_some() && self.copies > 1 {
            return Err(PlateError::CopiesInOnePlace {
                asked: asked(),
                copies: self.copies,
            });
        }
        if count > 1 && self.settings.is_vase() {
            return Err(PlateError::Spiral { asked: asked() });
        }
        if self.placement.keep_position {
            return Err(PlateError::KeptPosition { asked: asked() });
        }
        Ok(())
    }

    /// The plate file and its line that ask for the copies, if one does.
    fn line(&self) -> Option<&str> {
        let model = format!(" ({})", self.source);
        self.asked.strip_suffix(&model)
    }

    /// True if `self` and `other` are copies of one part.
    fn is_like(&self, other: &Wanted) -> bool {
        self.source == other.source
            && self.defines == other.defines
            && self.placement == other.placement
            && self.settings == other.settings
    }
}

/// Indices of what is wanted, in groups of copies of one part.
fn kinds(wanted: &[Wanted]) -> Vec<Vec<usize>> {
    let mut kinds: Vec<Vec<usize>> = Vec::new();
    for (i, one) in wanted.iter().enumerate() {
        if one.copies == 0 {
            continue;
        }
        let like = |kind: &&mut Vec<usize>| wanted[kind[0]].is_like(one);
        match kinds.iter_mut().find(like) {
            Some(kind) => kind.push(i),
            None => kinds.push(vec![i]),
        }
    }
    kinds
}

/// Loads and places a part as if it were alone.
fn load_part(wanted: Wanted, count: u64) -> Result<Part, PlateError> {
    let Wanted {
        source,
        defines,
        placement,
        mut settings,
        asked,
        ..
    } = wanted;
    let loaded = load(&source, &defines).map_err(|e| PlateError::Load {
        asked: asked.clone(),
        error: Box::new(e),
    })?;
    let volume = BuildVolume::of(&settings);
    let placement = Placement {
        at: None,
        margin: settings.reach(),
        ..placement
    };
    let model = place(&loaded, &placement, volume).map_err(|error| {
        let name = loaded.name.clone();
        PlateError::Place { asked, name, error }
    })?;
    // The skirt and the draft shield go round all parts.
    if count > 1 {
        settings.skirt.loops = 0;
        settings.draft_shield = DraftShield::Off;
    }
    Ok(Part {
        model,
        settings,
        places: Vec::new(),
        wanted: Vec::new(),
        room: None,
    })
}

/// Gives all parts their places. Each part comes with the indices of its
/// entries in `wanted`.
fn place_all(
    plate: &mut Plate,
    parts: Vec<(Part, &Vec<usize>)>,
    wanted: &[Wanted],
) -> Result<(), PlateError> {
    let settings = &plate.settings;
    let printer = &settings.printer;
    let count = |kind: &[usize]| -> usize {
        kind.iter().map(|&i| wanted[i].copies as usize).sum()
    };
    let counted = parts.iter().map(|(part, kind)| (part, count(kind)));
    let how = Arrangement::of(plate, counted);
    let bed = Bed {
        size: DVec2::new(printer.bed_x, printer.bed_y),
        spacing: how.spacing,
    };
    // The boxes come in the order in which the parts are asked for.
    let mut asked: Vec<(usize, usize)> = Vec::new();
    for (k, (_, kind)) in parts.iter().enumerate() {
        for &i in *kind {
            asked.extend((0..wanted[i].copies).map(|_| (i, k)));
        }
    }
    asked.sort_by_key(|&(i, _)| i);
    let names = names(asked.iter().map(|&(_, k)| &*parts[k].0.model.name));
    let pieces = asked.iter().zip(&names).map(|(&(i, k), name)| {
        let foot = parts[k].0.foot();
        let bounds = parts[k].0.model.printed_bounds();
        PartBox {
            name: name.clone(),
            size: foot.size(),
            // The middle of the part's box is that of its foot.
            at: wanted[i].at.map(|(x, y)| DVec2::new(x, y)),
            body: bounds.size().truncate(),
            alone: parts[k].0.top() > how.alone_above,
        }
    });
    let pieces: Vec<PartBox> = pieces.collect();
    let middles = arrange(&pieces, bed)?;
    let count = asked.len();
    let mut placed: Vec<Part> = parts.iter().map(|p| p.0.clone()).collect();
    for ((&(_, k), name), middle) in asked.iter().zip(names).zip(middles) {
        let part = &mut placed[k];
        let bounds = part.model.printed_bounds();
        let alone = bounds.centre().truncate();
        let shift = ((middle - alone) / DIGIT).round() * DIGIT;
        part.places.push(PartPlace { name, shift });
    }
    let feet: Vec<Rect> = placed.iter().flat_map(Part::feet).collect();
    for mut part in placed {
        let free = part.free(&feet).min(settings.plate.spacing);
        if count == 1 {
            // Ordinarily the model itself stands there.
            for place in &mut part.places {
                part.model.offset += place.shift.extend(0.0);
                place.shift = DVec2::ZERO;
            }
        } else {
            let shifts: Vec<DVec2> =
                part.places.iter().map(|p| p.shift).collect();
            part.room = Some(room(&part, &shifts, free, bed.size));
        }
        plate.parts.push(part);
    }
    Ok(())
}

/// Where there may be supports of a part that stands in some places: on the
/// bed, and not nearer to its neighbours than they are to it. They are `free`
/// mm away.
fn room(part: &Part, shifts: &[DVec2], free: Mm, bed: DVec2) -> Rect {
    /// What remains free between the supports of neighbours, mm.
    const FREE: Mm = 0.5;
    let foot = part.foot();
    let around = (0.5 * (free - FREE)).max(0.0);
    let mut room = Rect::new(foot.min - around, foot.max + around);
    for shift in shifts {
        room.min = room.min.max(-*shift);
        room.max = room.max.min(bed - *shift);
    }
    room
}

/// Names of parts: those of several that are called alike get numbers.
fn names<'a>(models: impl Iterator<Item = &'a str> + Clone) -> Vec<String> {
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for name in models.clone() {
        counts.entry(name).or_default().0 += 1;
    }
    let named = models.map(|name| match counts.get_mut(name) {
        Some((count, number)) if *count > 1 => {
            *number += 1;
            format!("{name}_{number}")
        }
        _ => name.to_owned(),
    });
    named.collect()
}

#[cfg(test)]
mod tests;

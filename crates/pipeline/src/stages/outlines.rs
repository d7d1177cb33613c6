//! The outlines of layers, moved and grown as the settings ask.
//!
//! In: spans. Out: layers whose outline to print is known, and the areas of the
//! offset fields if walls are made of these.

use super::Stages;
use crate::SliceError;
use crate::layer::{Layer, Met, SAME_HEIGHT};
use isoslice_base::limits;
use isoslice_base::timings::Stage;
use isoslice_base::units::Mm;
use isoslice_layer::exposure::rough;
use isoslice_layer::outline::Compensation;
use isoslice_layer::walls::{OUTLINE_SHARE, WallPlan};
use isoslice_model::contour::{
    Detail, Field, FieldError, Outline, SLAB, field, outlines,
};
use isoslice_model::expressions::QuantityError;
use isoslice_planar::{Area, Solid};
use isoslice_settings::layers::LayerSpan;
use std::ops::Range;
use std::sync::Arc;

/// All layers of any part, where only some may be needed.
pub(crate) const ALL_LAYERS: Range<usize> = 0..usize::MAX;

/// Extent below which an island or a hole is left out, as a share of the outer
/// wall's width.
const PRINTABLE: f64 = 0.25;

/// The fields of the walls by their depths, if walls are offsets of the
/// expression.
pub(super) enum WallFields {
    /// They are not.
    None,
    /// All layers have the same.
    Alike(Vec<(Mm, Field)>),
    /// A wall's depth depends on its layer's height, so fields are made for each.
    ByHeight,
}

/// The fields of the walls in a layer of a height, and that of what they leave,
/// each with its depth.
pub(super) fn by_depth(
    height: Mm,
    walls: &WallPlan,
    make: impl Fn(Mm) -> Result<Field, FieldError>,
) -> Result<Vec<(Mm, Field)>, FieldError> {
    let (depths, border) = walls.depths(height);
    let depths = depths.into_iter().chain([border]);
    depths.map(|d| Ok((d, make(d)?))).collect()
}

impl Stages<'_> {
    /// Layers in slabs, as far as these have some that are `needed`. A slab is the
    /// unit in which the field is walked, so the division depends neither on the
    /// threads nor on what is needed. Layers that are surely alike are in one slab.
    pub(crate) fn slabs<'s>(
        &self,
        spans: &'s [LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<&'s [LayerSpan]>, SliceError> {
        let mut slabs = Vec::new();
        for some in spans.chunks(SLAB) {
            let is_needed = |slab: &&[LayerSpan]| {
                slab.iter().any(|s| needed.contains(&s.index))
            };
            if is_needed(&some) {
                let all = some.chunks(self.at_a_time(some)?);
                slabs.extend(all.filter(is_needed));
            }
        }
        Ok(slabs)
    }

    /// How many of some layers, at most a slab, are found at a time.
    fn at_a_time(&self, spans: &[LayerSpan]) -> Result<usize, SliceError> {
        if !matches!(self.wall_fields, WallFields::None) {
            return Ok(self.slab_layers());
        }
        let z = spans.iter().map(|s| s.sample_z() + self.bed);
        let z: Vec<Mm> = z.collect();
        let lap = self.timings.begin(Stage::Field);
        let count = self.field.at_a_time(&z)?;
        drop(lap);
        Ok(count)
    }

    /// The layers of a slab that are `needed`, with their outlines.
    pub(crate) fn layers(
        &self,
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Layer>, SliceError> {
        if !self.known.is_empty() {
            let needed = spans.iter().filter(|s| needed.contains(&s.index));
            let known = |s: &LayerSpan| {
                let by = |layer: &Layer| layer.span.index;
                let at = self.known.binary_search_by_key(&s.index, by);
                at.ok().map(|at| &self.known[at])
            };
            let known: Option<Vec<&Layer>> = needed.map(known).collect();
            let layers = known.map(|known| {
                let mut copies: Vec<Layer> = Vec::with_capacity(known.len());
                for (k, layer) in known.iter().enumerate() {
                    let below = k.checked_sub(1).map(|k| known[k]);
                    copies.push(layer.copied(below.zip(copies.last())));
                }
                copies
            });
            if let Some(layers) = layers {
                return Ok(layers);
            }
        }
        self.layers_of(&self.field, &self.wall_fields, spans, needed)
    }

    /// Does what [`Stages::layers`] does, for a field and the fields of its
    /// walls, if walls are offsets of the expression.
    pub(super) fn layers_of(
        &self,
        field: &Field,
        wall_fields: &WallFields,
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Layer>, SliceError> {
        // The part has nothing in the layers of a raft.
        let raft = spans
            .iter()
            .take_while(|s| s.index < self.plans.raft.layers);
        let raft = raft.count();
        let of_part = &spans[raft..];
        let mut found = vec![Outline::default(); raft];
        found.extend(self.found(field, of_part, needed)?);
        let mut offsets = vec![Vec::new(); raft];
        offsets.extend(self.offsets(wall_fields, of_part, needed)?);
        let mut layers: Vec<Layer> = Vec::with_capacity(spans.len());
        for (&span, (found, offsets)) in
            spans.iter().zip(found.into_iter().zip(offsets))
        {
            if needed.contains(&span.index) {
                layers.push(self.layer(span, found, offsets, layers.last())?);
            }
        }
        Ok(layers)
    }

    /// The outlines of a field in some layers. Those that are not `needed` are
    /// empty.
    fn found(
        &self,
        field: &Field,
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Outline>, FieldError> {
        let Some(first) = spans.first() else {
            return Ok(Vec::new());
        };
        let detail = Detail {
            accuracy: self.plans.accuracy * OUTLINE_SHARE,
            smallest: PRINTABLE * self.plans.walls.outer,
        };
        let z = spans.iter().map(|s| s.sample_z() + self.bed);
        let z: Vec<Mm> = z.collect();
        let asked = needed.start.saturating_sub(first.index)
            ..needed.end.saturating_sub(first.index).min(z.len());
        let made = outlines(field, &z, &asked, detail, &self.timings)?;
        let rings = made.iter().flat_map(|o| &o.area.rings);
        limits::made(rings.map(|ring| ring.len()).sum());
        Ok(made)
    }

    /// For walls that are offsets of the expression: the areas of the offset
    /// fields in each layer, with their depths.
    fn offsets(
        &self,
        wall_fields: &WallFields,
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Vec<(Mm, Area)>>, FieldError> {
        let of = |fields: &[(Mm, Field)], spans: &[LayerSpan]| {
            let mut all = vec![Vec::new(); spans.len()];
            for (depth, field) in fields {
                let made = self.found(field, spans, needed)?;
                for (of_layer, outline) in all.iter_mut().zip(made) {
                    of_layer.push((*depth, outline.area));
                }
            }
            Ok(all)
        };
        match wall_fields {
            WallFields::None => Ok(vec![Vec::new(); spans.len()]),
            WallFields::Alike(fields) => of(fields, spans),
            WallFields::ByHeight => {
                let alike = |a: &LayerSpan, b: &LayerSpan| {
                    (a.height() - b.height()).abs() < SAME_HEIGHT
                };
                let mut all = Vec::with_capacity(spans.len());
                for run in spans.chunk_by(alike) {
                    limits::go_on()?;
                    let spacing = self.plans.sample_spacing;
                    let tree = &self.model.tree;
                    let make = |d: Mm| field(tree, d, self.rect, spacing);
                    let fields =
                        by_depth(run[0].height(), &self.plans.walls, make)?;
                    all.extend(of(&fields, run)?);
                }
                Ok(all)
            }
        }
    }

    /// A layer whose outline and whose offset fields' areas were found. It
    /// shares with the layer below whatever is equal.
    fn layer(
        &self,
        span: LayerSpan,
        found: Outline,
        mut offsets: Vec<(Mm, Area)>,
        below: Option<&Layer>,
    ) -> Result<Layer, SliceError> {
        let Outline {
            area,
            nan_samples,
            forced_rings,
            dropped_rings,
        } = found;
        let met = Met {
            nan_samples,
            forced_rings,
            dropped_rings,
        };
        let growth = self.growth.as_ref();
        let plan = self.plans.outline;
        let moving = |span: &LayerSpan| Compensation::new(span, plan, growth);
        let moved = moving(&span);
        let alike = |below: &&Layer| {
            moving(&below.span).is_like(&moved)
                && below.met == met
                && *below.found() == area
        };
        if offsets.is_empty()
            && let Some(below) = below.filter(alike)
        {
            return Ok(Layer {
                span,
                risen: Arc::default(),
                ..below.clone()
            });
        }
        let found = Solid::new(area);
        let (changed, squeezed) = self.timings.time(Stage::Walls, || {
            let changed = moved.apply(&found, &mut offsets)?;
            let squeezed = moved.squeezed(found.area())?;
            Ok::<_, QuantityError>((changed, squeezed))
        })?;
        // A large outline takes megabytes, and mostly nothing is changed.
        let (outline, unchanged) = match changed {
            None => (found, None),
            Some(changed) => (Solid::new(changed), Some(found.into_area())),
        };
        let same = below.filter(|b| b.area() == outline.area());
        let (outline, rough) = if let Some(below) = same {
            (below.outline.clone(), below.rough.clone())
        } else {
            let rough = self
                .timings
                .time(Stage::Skin, || rough(outline.area(), &self.plans.walls));
            (Arc::new(outline), Arc::new(rough))
        };
        Ok(Layer {
            span,
            unchanged: unchanged.map(Arc::new),
            met,
            outline,
            rough,
            offsets: Arc::new(offsets.into_iter().map(|o| o.1).collect()),
            squeezed: squeezed.map(|area| Arc::new(Solid::new(area))),
            risen: Arc::default(),
            inside: None,
        })
    }
}

//! What stands below a part: its supports and its raft.

use super::outlines::WallFields;
use super::{ALL_LAYERS, Stages};
use crate::SliceError;
use crate::follow::Follow;
use crate::layer::Layer;
use crate::plans::RaftPlan;
use crate::raft::Raft;
use crate::supported::{Supported, Top};
use glam::DVec2;
use isoslice_base::limits;
use isoslice_base::parallel;
use isoslice_base::timings::Stage;
use isoslice_base::units::Mm;
use isoslice_held::overhangs::{Hanging, Needs, Tracker, Unsupported};
use isoslice_held::support::{
    Asked, Heights, Plan, Survey, Wishes, coarse, held,
};
use isoslice_layer::infill::InfillError;
use isoslice_layer::view::LayerFace;
use isoslice_model::expressions::Surroundings;
use isoslice_planar::bead::Bead;
use isoslice_planar::clip::{difference, intersection, union};
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Rect};
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;

/// Number of points of the outlines that are kept from planning supports to
/// printing. They take about 30 bytes each, so no more than 25 MB whatever the
/// part's height. Outlines beyond that are found a second time.
const KNOWN: usize = 800_000;

/// Number of slabs that each thread looks at before what is found of them is put
/// together.
const SLABS: usize = 2;

/// Heights closer than this differ by rounding only, mm.
const ROUNDED: Mm = 1e-6;

impl<'a> Stages<'a> {
    /// Plans the supports of the whole part, `spans`. `room` is the part of the
    /// bed that supports may use.
    ///
    /// # Errors
    /// If the part's outlines cannot be found, or `support.where` has no value
    /// somewhere.
    pub(crate) fn plan_supports(
        &mut self,
        pool: &ThreadPool,
        spans: &'a [LayerSpan],
        around: &'a Surroundings<'a>,
        room: Rect,
    ) -> Result<(), SliceError> {
        let wishes = Wishes::new(&self.plans.support, around)?;
        let asked = Asked {
            wishes: wishes.as_ref(),
            plan: &self.plans.support,
        };
        let (survey, heights, known) =
            self.surveyed(pool, spans, asked, KNOWN, None)?;
        let sections = self.sections(pool, &heights)?;
        let bed = self.in_model(room);
        let plan = || Plan::new(survey, sections, heights, bed, asked);
        let plan = self.timings.time_pool(Stage::Support, pool, plan);
        self.known = known;
        let fills = self.fills(around);
        self.support = Some(Supported::new(plan, &fills)?);
        Ok(())
    }

    /// What of the whole part, `spans`, hangs, and the places of it that supports
    /// would hold, whether or not some are to be printed.
    ///
    /// # Errors
    /// Those of [`Stages::plan_supports`].
    pub(crate) fn needs(
        &self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
        around: &Surroundings<'_>,
    ) -> Result<(Hanging, Vec<Unsupported>), SliceError> {
        let wishes = Wishes::new(&self.plans.support, around)?;
        let asked = Asked {
            wishes: wishes.as_ref(),
            plan: &self.plans.support,
        };
        let mut tracker = Tracker::of_rims();
        let follow = Some(&mut tracker);
        let (survey, heights, _) =
            self.surveyed(pool, spans, asked, 0, follow)?;
        let (offset, lift) = (self.model.offset, self.plans.raft.height);
        let place = |p: DVec2, span: &LayerSpan| {
            (p + offset.truncate()).extend(span.bottom + lift)
        };
        let far = tracker.take_far();
        let places = pool.install(|| {
            let [needs, outlines] =
                held(survey, &heights, &self.plans.support.overhangs);
            let needs = Needs {
                needs: &needs,
                outlines: &outlines,
                spans: heights.spans(),
                far: &far,
            };
            needs.places(&self.plans.support.overhangs, place)
        });
        Ok((tracker.finish(), places))
    }

    /// What is found of the whole part, `spans`, the heights of its layers, and
    /// layers of up to `known` points. `follow` follows what hangs.
    fn surveyed(
        &self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
        asked: Asked<'_>,
        known: usize,
        mut follow: Option<&mut Tracker>,
    ) -> Result<(Survey, Heights, Vec<Layer>), SliceError> {
        // The plan does not know the raft, which serves as its bed.
        let raft = &self.plans.raft;
        let above = spans.iter().skip(raft.layers);
        let above = above.map(|span| without_raft(*span, raft)).collect();
        let heights = Heights::new(above, &self.plans.support);
        let mut left = known;
        let follows = follow.is_some();
        let of_part = raft.layers..ALL_LAYERS.end;
        let of_slab = |slab: &&[LayerSpan]| {
            let layers = self.layers(slab, &of_part)?;
            let found = layers
                .iter()
                .map(|layer| (without_raft(layer.span, raft), layer.area()));
            let survey = || Survey::new(found, asked);
            let survey = self.timings.time(Stage::Support, survey)?;
            Ok::<_, SliceError>((survey, layers))
        };
        // These are the slabs of printing, since the last bits of an outline depend
        // on its slab, and layers that are not kept are found again there.
        let slabs = self.slabs(spans, &ALL_LAYERS)?;
        // Most layers are known for a while only: all of them would take much memory.
        let at_once = SLABS * pool.current_num_threads();
        let mut survey = Survey::default();
        let mut known = Vec::new();
        for slabs in slabs.chunks(at_once) {
            let made =
                parallel::map_in(pool, slabs.len(), |i| of_slab(&slabs[i]));
            for slab in made {
                let (above, layers) = slab?;
                let append = || survey.append(above, asked);
                self.timings.time(Stage::Support, append)?;
                // In the order of slabs, so that it does not depend on threads.
                if follows || keep(&layers, &mut left) {
                    known.extend(layers);
                }
            }
            if let Some(tracker) = &mut follow {
                self.follow(pool, tracker, &known, spans.len());
                known.drain(..known.len().saturating_sub(1));
            }
        }
        Ok((survey, heights, known))
    }

    /// Follows what hangs through some layers of a part of `count` layers. The first
    /// of them is known already, or is held.
    fn follow(
        &self,
        pool: &ThreadPool,
        tracker: &mut Tracker,
        layers: &[Layer],
        count: usize,
    ) {
        let looks = parallel::map_in(pool, layers.len().max(1) - 1, |i| {
            self.look_over(&layers[i + 1].face(), &layers[i].face())
        });
        self.timings.time(Stage::Hang, || {
            for (layer, look) in layers.iter().skip(1).zip(&looks) {
                let follow = Follow {
                    offset: self.model.offset.truncate(),
                    count,
                    written: true,
                    plan: &self.plans.overhangs,
                };
                follow.layer(tracker, layer, look.as_ref());
            }
        });
    }

    /// The part at half the height of each layer's supports, where that is not
    /// half the height of the layer.
    fn sections(
        &self,
        pool: &ThreadPool,
        heights: &Heights,
    ) -> Result<Option<Vec<Area>>, SliceError> {
        if heights.own().eq(heights.spans().iter().copied()) {
            return Ok(None);
        }
        let raft = &self.plans.raft;
        let own: Vec<LayerSpan> = heights
            .own()
            .map(|span| LayerSpan {
                index: span.index + raft.layers,
                bottom: span.bottom + raft.height,
                top: span.top + raft.height,
            })
            .collect();
        let of_slab = |slab: &[LayerSpan]| {
            let all = 0..usize::MAX;
            let none = &WallFields::None;
            let layers = self.layers_of(&self.field, none, slab, &all)?;
            let sections = layers.iter().map(|l| {
                coarse(l.area(), l.span.height(), &self.plans.support.overhangs)
            });
            let coarse = || sections.collect();
            Ok::<_, SliceError>(self.timings.time(Stage::Support, coarse))
        };
        let slabs: Vec<_> = own.chunks(self.slab_layers()).collect();
        let made = parallel::map_in(pool, slabs.len(), |i| of_slab(slabs[i]));
        let made: Vec<Vec<Area>> =
            made.into_iter().collect::<Result<_, _>>()?;
        Ok(Some(made.concat()))
    }

    /// Plans the raft of the whole part, `spans`, after its supports, if there
    /// is a raft. The raft carries the layers up to the lowest one in which a
    /// line of the part has room, since the layers below that are empty, or
    /// nearly so.
    ///
    /// # Errors
    /// If the outlines above the raft cannot be found.
    pub(crate) fn plan_raft(
        &mut self,
        spans: &[LayerSpan],
        around: &'a Surroundings<'a>,
        room: Rect,
    ) -> Result<(), SliceError> {
        let plans = self.plans;
        let first = plans.raft.layers;
        if first == 0 {
            return Ok(());
        }
        let half = 0.5 * plans.overhangs.thinnest;
        let mut under = Area::EMPTY;
        for span in spans.iter().skip(first) {
            limits::go_on()?;
            let of_span =
                self.layers(std::slice::from_ref(span), &ALL_LAYERS)?;
            if let Some(support) = self.support_area(span.index) {
                under = union(&under, &support);
            }
            let Some(layer) = of_span.first() else {
                continue;
            };
            under = union(&under, layer.area());
            if !offset(layer.area(), -half, plans.accuracy).is_empty() {
                break;
            }
        }
        let fills = self.fills(around);
        self.raft = Some(Raft::new(&under, self.in_model(room), &fills)?);
        Ok(())
    }

    /// The supports, once they are planned.
    pub(crate) fn support(&self) -> Option<&Supported<'a>> {
        self.support.as_ref()
    }

    /// Where a layer has supports.
    pub(crate) fn support_area(&self, layer: usize) -> Option<Area> {
        match &self.raft {
            Some(raft) if layer < self.plans.raft.layers => {
                Some(raft.area.clone())
            }
            _ => self.support()?.area(layer),
        }
    }

    /// True if supports hold some of what hangs in a layer, which lies on another one.
    pub(crate) fn is_supported(
        &self,
        here: &LayerFace<'_>,
        below: Option<&LayerFace<'_>>,
    ) -> bool {
        let under = self.support().and_then(|s| s.under(here.span.index));
        let Some(under) = under.filter(|area| !area.is_empty()) else {
            return false;
        };
        let outline = |face: &LayerFace<'_>| face.rough.area().clone();
        let on = below.map_or(Area::EMPTY, outline);
        let hangs = difference(here.rough.area(), &on);
        !intersection(&hangs, &under).is_empty()
    }

    /// The top of a layer's supports, if it can have some.
    pub(crate) fn support_top(&self, span: &LayerSpan) -> Option<Top> {
        self.support()?.top(span, self.plans.supports_follow)
    }

    /// True if a layer's supports end below its top.
    pub(super) fn has_low_supports(&self, span: &LayerSpan) -> bool {
        let top = self.support().and_then(|support| support.top(span, false));
        top.is_some_and(|top| top.span.top < span.top - ROUNDED)
    }

    /// Where supports stand on a layer, if its beads follow the surface.
    pub(crate) fn on_which_supports_stand(
        &self,
        span: &LayerSpan,
    ) -> Option<Area> {
        let support = self.support().filter(|_| self.plans.contours_z);
        support?.on_top(span)
    }

    /// Where supports hold a layer, if that matters for its walls.
    pub(crate) fn held_by_support(&self, layer: usize) -> Option<Area> {
        self.support().filter(|_| self.plans.by_reach)?.under(layer)
    }

    /// The beads of a layer's supports, or of its raft.
    pub(super) fn support_beads(
        &self,
        span: &LayerSpan,
    ) -> Result<Vec<Bead>, InfillError> {
        self.timings.time(Stage::Support, || {
            match (&self.raft, self.support()) {
                (Some(raft), _) if span.index < self.plans.raft.layers => {
                    raft.beads(span)
                }
                (_, Some(support)) => support.beads(span),
                _ => Ok(Vec::new()),
            }
        })
    }
}

/// A layer's number and heights without the raft's.
fn without_raft(span: LayerSpan, raft: &RaftPlan) -> LayerSpan {
    LayerSpan {
        index: span.index - raft.layers,
        bottom: span.bottom - raft.height,
        top: span.top - raft.height,
    }
}

/// True if layers may be kept. Then the number of their points is taken from
/// `left`.
fn keep(layers: &[Layer], left: &mut usize) -> bool {
    let mut points = 0;
    for (k, layer) in layers.iter().enumerate() {
        let below = k.checked_sub(1).map(|below| &layers[below]);
        if !below.is_some_and(|below| layer.same_outline(below)) {
            let rings = layer.area().rings.iter();
            points += rings.map(|ring| ring.len()).sum::<usize>();
        }
    }
    let rest = left.checked_sub(points);
    *left = rest.unwrap_or(*left);
    rest.is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::{Base, Planned};
    use crate::options::Options;
    use crate::start::{layers_of, pool};
    use isoslice_model::{Placement, placed};
    use isoslice_plate::Plate;
    use isoslice_settings::testing::settings;

    /// Rows of pins that hold thin plates: in slabs without a plate, the plate is left
    /// out of the expression, and the last bits of outlines are others.
    #[test]
    fn what_is_known_of_a_part_on_a_raft_is_what_printing_finds() {
        let [x, y] = ["x", "y"].map(|c| format!("({c}-2*floor({c}/2+0.5))"));
        let pins = format!(
            "max(sqrt({x}^2+{y}^2)-(0.6+0.1*sin(5*atan2({y},{x})+z)),\
             abs(x)-4,abs(y)-4)"
        );
        let star = "abs(sqrt(x*x+y*y)-(3+0.7*sin(9*atan2(y,x))))-0.8";
        let plate =
            |i: i32| format!("max({star},abs(z-{})-0.2)", 0.83 * f64::from(i));
        let plates = (1..13).map(plate).collect::<Vec<_>>().join(",");
        let text = format!("max(min({pins},{plates}),abs(z-5)-5)");
        let model = placed(&text, &Placement::default());
        let assignments = [
            "supports=auto",
            "raft.layers=3",
            "layer_height=0.1",
            "accuracy=0.001",
        ];
        let plate = Plate::of(&model, &settings(&assignments));
        let plate = crate::start::raised(&plate).unwrap();
        let pools = [1, 3].map(|threads| pool(Some(threads)).unwrap());
        let (spans, _) = pools[0].install(|| layers_of(&plate)).unwrap();
        let base = Base::new(&plate.parts[0], &spans[0]);
        let made =
            base.stages(&(0..spans[0].len()), &Options::default(), &pools[0]);
        let Planned { stages, spans, .. } = made.unwrap();
        let asked = Asked {
            wishes: None,
            plan: &stages.plans.support,
        };
        let known = |points: usize, pool: &ThreadPool| -> Vec<Layer> {
            stages.surveyed(pool, spans, asked, points, None).unwrap().2
        };
        let all = known(usize::MAX, &pools[1]);
        assert_eq!(all.len(), spans.len() - 3);
        let points = all.iter().flat_map(|l| &l.area().rings);
        let half = points.map(Vec::len).sum::<usize>() / 2;
        let mut all = all.iter();
        for slab in stages.slabs(spans, &ALL_LAYERS).unwrap() {
            let none = &WallFields::None;
            let found =
                stages.layers_of(&stages.field, none, slab, &(3..spans.len()));
            for layer in found.unwrap() {
                let known = all.next().unwrap();
                assert_eq!(known.span, layer.span);
                assert!(*known.found() == *layer.found(), "{:?}", layer.span);
            }
        }
        // What is kept does not depend on the number of threads.
        let some = pools.each_ref().map(|pool| {
            known(half, pool).iter().map(|l| l.span.index).collect()
        });
        let [some, other]: [Vec<usize>; 2] = some;
        assert_eq!(some, other);
        assert!(!some.is_empty() && some.len() < spans.len() - 3, "{some:?}");
    }
}

//! Which part of the fill is skin.
//!
//! A point is exposed upwards where any of the next N layers does not cover
//! it, downwards where any of the M layers below does not. All layers between
//! count, not only the outermost: a cavity thinner than N layers has a roof.
//!
//! ```text
//!   layer i+2   ░░░░░░░            exposed: where not all of the
//!   layer i+1   ░░░░░░░░░░         neighbours cover layer i
//!   layer i     ▒▒▒▒▒▒▒████ skin
//! ```
//!
//! Below a slope, N layers are less than their thickness along its normal, and
//! from some steepness on they recede by less than the walls are wide. So some
//! more layers count beside what the first N leave open ([`Slope`]): down to a
//! slope of 45° a shell is as thick as N layers.
//!
//! Where layers differ in height, N and M are as many as the skin's thickness
//! takes there.
//!
//! What rises from a face stands on skin as far as its walls reach: skin goes on
//! below them ([`Exposure::under_walls`]).
//!
//! Exposed areas grow a little into the sparse area, which anchors their lines
//! and makes thin ones printable. What is then too narrow or too small for
//! sparse infill becomes skin as well. Skin and sparse area together are the
//! fill.

mod plan;
mod risen;
mod rough;
mod shells;

pub use plan::{ExposurePlan, ShellPlan};
pub use rough::rough;

use crate::cover::neighbour::Neighbour;
use crate::cover::{
    Covered, Exposed, Islands, TOLERANCE, by_island, exposed, near, open,
};
use crate::view::{LayerFace, LayerView};
use isoslice_base::units::Mm;
use isoslice_planar::clip::{
    crop, difference, intersection, not_covered_by_all, union,
};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::{is_wider, opened, wide_parts};
use isoslice_planar::{Area, Rect, Solid};
use isoslice_settings::layers::LayerSpan;
use risen::under;
use rough::apart;
use shells::Shells;

/// The fill, split.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FillAreas {
    /// The area that is filled solid.
    pub skin: Area,
    /// The area that is filled at the infill's density.
    pub sparse: Area,
}

/// The layers on one side of a layer, as far as a slope's shell reaches.
struct Slope<'a> {
    /// The last layer of those that have to cover it.
    last: &'a Solid<'a>,
    /// The layers farther away that count near what `last` leaves open;
    /// `None` beyond the part.
    beyond: Vec<Option<&'a Solid<'a>>>,
    /// How far `last` recedes from the farthest one on a slope of 45°.
    reach: Mm,
    /// How far apart outlines of one shape may be.
    apart: Mm,
}

/// Number of layers that count on a slope if `layers` count on a level face.
fn slope_layers(layers: usize) -> usize {
    (layers as f64 * std::f64::consts::SQRT_2).ceil() as usize
}

/// Tells a part's skin from its sparse infill.
#[derive(Clone, Debug)]
pub struct Exposure<'a> {
    plan: ExposurePlan,
    /// Layers that have to cover a layer from above, lest it get skin.
    above: Shells,
    /// Layers that have to cover a layer from below, lest it get skin.
    below: Shells,
    /// Layers of the part.
    spans: &'a [LayerSpan],
}

impl<'a> Exposure<'a> {
    /// The exposure of a part with these layers.
    pub fn new(plan: ExposurePlan, spans: &'a [LayerSpan]) -> Exposure<'a> {
        let shells = |shell: ShellPlan, upwards| match shell.layers {
            Some(count) => Shells::Alike(count),
            None => Shells::of_thickness(spans, shell.thickness, upwards),
        };
        Exposure {
            plan,
            above: shells(plan.top, true),
            below: shells(plan.bottom, false),
            spans,
        }
    }

    /// The part of a fill that sparse infill fits into, whatever covers it. In
    /// lattices that is next to nothing: the rest is skin, exposed or not, and
    /// need not be looked at again.
    pub fn roomy(&self, fill: &Area) -> Area {
        if self.plan.solid {
            Area::EMPTY
        } else {
            printable(fill, BETWEEN_WALLS, &self.plan)
        }
    }

    /// Layers that have to cover a layer, lest it get skin, on the side of
    /// these shells.
    fn covering(&self, layers: usize) -> usize {
        if self.plan.ends_alone { 0 } else { layers }
    }

    /// Number of layers above a layer on which its fill depends: at least the
    /// next one, whose outline decides roles.
    pub fn reach_above(&self) -> usize {
        slope_layers(self.covering(self.above.most())).max(1)
    }

    /// Number of layers below a layer on which its fill depends.
    pub fn reach_below(&self) -> usize {
        slope_layers(self.covering(self.below.most())).max(1)
    }

    /// True if a layer is skin all over, whatever covers it.
    fn is_end(&self, number: usize) -> bool {
        // A raft's layers are no part of the part.
        let in_part = number.saturating_sub(self.plan.raft_layers);
        self.plan.ends_alone
            && (in_part < self.below.at(number)
                || number + self.above.at(number) >= self.spans.len())
    }

    /// Height between the last of so many layers beside a layer and the
    /// farthest one that counts on a slope.
    fn distance(
        &self,
        view: &LayerView<'_>,
        layers: usize,
        upwards: bool,
    ) -> Mm {
        let farthest = slope_layers(layers);
        if self.plan.uniform {
            return (farthest - layers) as f64 * view.here.span.height();
        }
        let z = |away: usize| {
            let number = if upwards {
                view.here.span.index + away
            } else {
                view.here.span.index.saturating_sub(away)
            };
            let span = self.spans.get(number).or(self.spans.last());
            span.map_or(0.0, LayerSpan::sample_z)
        };
        (z(farthest) - z(layers)).abs()
    }

    /// Splits a layer's fill, of which `roomy` is what [`Exposure::roomy`] found.
    pub fn split(
        &self,
        fill: &Area,
        roomy: &Area,
        view: &LayerView<'_>,
    ) -> FillAreas {
        let sparse = match self.covers(view) {
            Some(covers) if !roomy.is_empty() => {
                self.sparse(roomy, &covers, view)
            }
            _ => Vec::new(),
        };
        let skin = less(fill, &sparse);
        let rings = sparse.into_iter().flat_map(|s| s.rings);
        FillAreas {
            skin,
            sparse: rings.collect(),
        }
    }

    /// The layers that have to cover a layer, if the part goes on so far.
    fn covers<'w>(&self, view: &LayerView<'w>) -> Option<Vec<&'w Solid<'w>>> {
        if self.is_end(view.here.span.index) {
            return None;
        }
        // A neighbour is left out if it equals this layer or another neighbour:
        // it leaves nothing open that they do not.
        let mut seen = vec![view.here.rough];
        let mut new = |near: &&'w Solid<'w>| {
            let new = !seen.iter().any(|s| s.is(near));
            seen.push(near);
            new
        };
        let layers = self.covering(self.above.at(view.here.span.index));
        let above = view.above.get(..layers)?.iter().map(|near| near.rough);
        let above: Vec<_> = above.filter(&mut new).collect();
        let layers = self.covering(self.below.at(view.here.span.index));
        let below = view.below.get(..layers)?.iter().map(|near| near.rough);
        let below: Vec<_> = below.filter(&mut new).collect();
        // The farthest layers come first: they differ most from this one, and
        // so leave the least to be looked at.
        let n = above.len().max(below.len());
        let all = (0..n)
            .rev()
            .flat_map(|k| above.get(k).into_iter().chain(below.get(k)));
        Some(all.copied().collect())
    }

    /// The islands of sparse infill.
    fn sparse(
        &self,
        roomy: &Area,
        covers: &[&Solid<'_>],
        view: &LayerView<'_>,
    ) -> Vec<Area> {
        let plan = &self.plan;
        let islands = roomy.islands();
        // Most of what is covered of a lattice is thin.
        let matters = |part: &Area| {
            part.content() >= plan.least
                && is_wider(part, plan.infill, TOLERANCE)
        };
        let asked = Islands::new(&islands);
        let mut exposed = exposed(&asked, covers, matters);
        let outline = view.here.rough.area();
        let number = view.here.span.index;
        for (side, shells, upwards) in [
            (&view.above, &self.above, true),
            (&view.below, &self.below, false),
        ] {
            let layers = self.covering(shells.at(number));
            let recedes = self.distance(view, layers, upwards);
            if let Some(slope) = slope(view, side, layers, recedes, plan) {
                slope.expose(&islands, &asked, &mut exposed, outline);
            }
        }
        let support = view.below.first().map(|below| below.rough);
        let support = support.filter(|s| !s.is(view.here.rough));
        let hanging = hanging(&exposed, support, plan);
        let under = self.under_walls(&islands, &exposed, view);
        let mut sparse = Vec::new();
        let all = islands.into_iter().zip(exposed).zip(hanging).zip(under);
        for (((island, exposed), hanging), under) in all {
            let skin = match exposed {
                Exposed::Everywhere => continue,
                Exposed::Nowhere => under,
                Exposed::Part(part) => {
                    union(&grown(&part, &hanging, plan), &under)
                }
            };
            if skin.is_empty() {
                sparse.push(island);
            } else {
                let left = difference(&island, &skin);
                sparse.extend(beside(&left, &skin, plan));
            }
        }
        sparse
    }

    /// For each island, what lies under the walls of a part that rises from a
    /// face of this layer, or of one of the layers above whose skin reaches down
    /// to this one.
    fn under_walls(
        &self,
        islands: &[Area],
        exposed: &[Exposed],
        view: &LayerView<'_>,
    ) -> Vec<Area> {
        let all = islands.iter().zip(exposed);
        let asked = all.filter(|(_, e)| **e != Exposed::Everywhere);
        let asked: Vec<&Area> = asked.map(|(island, _)| island).collect();
        if asked.is_empty() {
            return vec![Area::EMPTY; islands.len()];
        }
        let near = asked.iter().map(|island| island.bounds());
        let near = near.fold(Rect::EMPTY, Rect::union);
        let layers = self.covering(self.above.at(view.here.span.index));
        let above = view.above.iter().take(layers);
        let lower = std::iter::once(&view.here).chain(above.clone());
        let mut found = Area::EMPTY;
        for (lower, upper) in lower.zip(above) {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            let rings = under(lower, upper, &self.plan.walls, |all| {
                all.bounds()
                    .meets(near)
                    .then(|| crop(&all.rings, near).rings)
            });
            found.rings.extend(rings.unwrap_or_default());
        }
        if found.is_empty() {
            return vec![Area::EMPTY; islands.len()];
        }
        let all = asked.iter().flat_map(|island| &island.rings);
        let found = intersection(&all.cloned().collect(), &found);
        // What is thinner than a bead lies beside what holds the walls.
        let found = opened(&found, 0.5 * self.plan.walls.skin, TOLERANCE);
        by_island(islands, found.islands())
    }
}

/// The layers that count on a slope besides the first `layers` on one side of a
/// layer. The last of these recedes by `reach` from the farthest layer.
fn slope<'a>(
    view: &LayerView<'a>,
    side: &[LayerFace<'a>],
    layers: usize,
    reach: Mm,
    plan: &ExposurePlan,
) -> Option<Slope<'a>> {
    let all = slope_layers(layers);
    let beyond = (layers..all).map(|k| side.get(k).map(|face| face.rough));
    let here = view.here.rough;
    Some(Slope {
        last: side.get(layers.checked_sub(1)?)?.rough,
        beyond: beyond.filter(|s| s.is_none_or(|s| !s.is(here))).collect(),
        reach,
        apart: apart(&plan.walls),
    })
}

impl Slope<'_> {
    /// Adds what lies under a slope of the outline to what is exposed.
    fn expose(
        &self,
        islands: &[Area],
        asked: &Islands<'_>,
        exposed: &mut [Exposed],
        outline: &Area,
    ) {
        let covered = |c: &Option<&Solid<'_>>| c.map(|c| asked.covered(c));
        let covered: Vec<Option<Vec<Covered>>> =
            self.beyond.iter().map(covered).collect();
        let wholly = |covered: &Option<Vec<Covered>>, i: usize| {
            covered.as_ref().is_some_and(|c| c[i] == Covered::Wholly)
        };
        let candidates: Vec<usize> = (0..islands.len())
            .filter(|&i| exposed[i] != Exposed::Everywhere)
            .filter(|&i| covered.iter().any(|c| !wholly(c, i)))
            .collect();
        if candidates.is_empty() {
            return;
        }
        // All islands at once: one at a time would be quadratic.
        let rings = candidates.iter().flat_map(|&i| &islands[i].rings);
        let all: Area = rings.cloned().collect();
        // The open area is smaller than the area under slopes, so it is looked
        // at first.
        let covers: Option<Vec<Area>> = self
            .beyond
            .iter()
            .zip(&covered)
            .filter(|(_, c)| candidates.iter().any(|&i| !wholly(c, i)))
            .map(|(cover, _)| Some(near(&all, cover.as_ref()?.area())))
            .collect();
        let open_beyond = match covers {
            Some(covers) => {
                let covers: Vec<&Area> = covers.iter().collect();
                not_covered_by_all(&all, &covers)
            }
            None => all,
        };
        if open_beyond.is_empty() {
            return;
        }
        let bounds = open_beyond.bounds().grown(self.reach + 1.0);
        let here = crop(&outline.rings, bounds);
        // Outlines of one shape differ by slivers up to `apart` wide. Skin for a
        // slope no wider than that would lie under the walls.
        let half = 0.5 * self.apart;
        let receded = open(&here, self.last.area());
        let receded = offset(&receded, -half, TOLERANCE);
        if receded.is_empty() {
            return;
        }
        let beside = offset(&receded, self.reach + half, TOLERANCE);
        let found = intersection(&open_beyond, &beside);
        let parts = by_island(islands, found.islands());
        for (exposed, more) in exposed.iter_mut().zip(parts) {
            if more.is_empty() {
                continue;
            }
            *exposed = match std::mem::replace(exposed, Exposed::Nowhere) {
                Exposed::Nowhere => Exposed::Part(more),
                Exposed::Part(part) => Exposed::Part(union(&part, &more)),
                Exposed::Everywhere => Exposed::Everywhere,
            };
        }
    }
}

/// For each island, the exposed parts that hang in the air, if bridges are to
/// be anchored beyond the overlap that skin has anyway.
fn hanging(
    exposed: &[Exposed],
    support: Option<&Solid<'_>>,
    plan: &ExposurePlan,
) -> Vec<Area> {
    let none = || vec![Area::EMPTY; exposed.len()];
    let Some(support) = support else {
        return none();
    };
    if plan.anchor.is_none_or(|anchor| anchor <= plan.overlap) {
        return none();
    }
    let mut parts: Vec<Area> = Vec::new();
    let mut owners: Vec<usize> = Vec::new();
    for (i, exposed) in exposed.iter().enumerate() {
        if let Exposed::Part(part) = exposed {
            let islands = part.islands();
            owners.extend(std::iter::repeat_n(i, islands.len()));
            parts.extend(islands);
        }
    }
    let covered = Islands::new(&parts).covered(support);
    let mut all = Area::EMPTY;
    for (part, covered) in parts.iter().zip(&covered) {
        if *covered != Covered::Wholly {
            all.rings.extend(part.rings.iter().cloned());
        }
    }
    // A gap that a bead's own width bridges needs no anchor.
    let half = 0.5 * plan.walls.skin;
    // `open` would not do: an offset would also shrink what it cuts off.
    let open = difference(&all, &near(&all, support.area()));
    let core = offset(&open, -half, TOLERANCE);
    let mut hanging = none();
    for (owner, core) in
        owners.into_iter().zip(by_island(&parts, core.islands()))
    {
        hanging[owner].rings.extend(core.rings);
    }
    hanging
}

/// An exposed part and what its lines reach onto: `skin_overlap` all around,
/// and `bridge_anchor` around what hangs in the air.
fn grown(part: &Area, hanging: &Area, plan: &ExposurePlan) -> Area {
    let all = offset(part, plan.overlap, TOLERANCE);
    match plan.anchor {
        Some(anchor) if !hanging.is_empty() => {
            let reach = 0.5 * plan.walls.skin + anchor;
            union(&all, &offset(hanging, reach, TOLERANCE))
        }
        _ => all,
    }
}

/// The islands of sparse infill in what some skin leaves of an area.
fn beside(left: &Area, skin: &Area, plan: &ExposurePlan) -> Vec<Area> {
    let all = printable(left, BETWEEN_WALLS, plan);
    let wide = printable(&all, BESIDE_SKIN, plan);
    if wide.content() >= all.content() - TOLERANCE {
        return all.islands();
    }
    // Narrow parts away from the skin stay sparse, as in layers without skin.
    let near = offset(skin, plan.infill, TOLERANCE);
    // Of a lattice there are many narrow parts, each beside little of the skin.
    let near = Neighbour::new(&near);
    let narrow = difference(&all, &wide).islands();
    let away = narrow
        .into_iter()
        .filter(|part| intersection(part, &near.near(part)).is_empty());
    let rings = away.flat_map(|part| part.rings).collect();
    union(&wide, &Area { rings }).islands()
}

/// An area without some islands of it.
fn less(area: &Area, islands: &[Area]) -> Area {
    if islands.is_empty() {
        return area.clone();
    }
    // Connected parts are looked at one by one, since most are all sparse or
    // have no sparse area in them.
    let parts = area.islands();
    let inside = by_island(&parts, islands.to_vec());
    let rings = parts.into_iter().zip(inside).flat_map(|(part, inside)| {
        if inside == part {
            Vec::new()
        } else {
            without_hairlines(difference(&part, &inside)).rings
        }
    });
    rings.collect()
}

/// An area without the strips that rounding leaves where two borders run along each
/// other. Around a sparse area such a strip would make skin of all that it encloses,
/// for whoever looks at its outer border alone.
fn without_hairlines(area: Area) -> Area {
    /// Radius of the largest disc in such a strip, mm.
    const HAIR: Mm = 1e-3;
    /// Length of the border from which on strips matter, mm: corners lose less.
    const LEAST: Mm = 0.1;
    let rest = opened(&area, HAIR, HAIR);
    if area.perimeter() - rest.perimeter() > LEAST {
        rest
    } else {
        area
    }
}

/// Least width of sparse infill between walls, in its lines.
const BETWEEN_WALLS: f64 = 1.0;
/// Least width of sparse infill beside skin, in its lines. The lines that cross
/// a narrower strip are stubs, and there are so few of them that skin above the
/// strip would hang. Skin that is wider by such a strip has one more stroke.
const BESIDE_SKIN: f64 = 2.0;

/// The parts of an area large enough for sparse infill, and as wide as so many
/// of its lines.
fn printable(area: &Area, lines: f64, plan: &ExposurePlan) -> Area {
    /// Width, mm, of the strip along the whole border that rounding may take
    /// away.
    const ROUNDING: Mm = 1e-5;
    let half = 0.5 * lines * plan.infill;
    let mut wide = Area::EMPTY;
    for island in area.islands() {
        if island.content() < plan.least {
            continue;
        }
        // Corners are kept, and necks that are too narrow for a bead are not.
        let whole = wide_parts(&island, half, TOLERANCE);
        let lost = island.content() - whole.content();
        if lost <= ROUNDING * island.perimeter() {
            wide.rings.extend(island.rings);
            continue;
        }
        let parts = whole.islands().into_iter();
        wide.rings.extend(
            parts
                .filter(|p| p.content() >= plan.least)
                .flat_map(|p| p.rings),
        );
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::rect;
    use isoslice_settings::Infill;
    use isoslice_settings::testing::{plan_with, usual_plan};

    /// Splits the fill of a layer that some more layers would have to cover
    /// from above, which are `beyond` the part.
    fn split_under(
        fill: &Area,
        above: &[&Area],
        below: &[&Area],
        beyond: usize,
        plan: ExposurePlan,
    ) -> FillAreas {
        let solids = |areas: &[&'_ Area]| -> Vec<Solid<'static>> {
            areas.iter().map(|a| Solid::new((*a).clone())).collect()
        };
        let (over, under) = (solids(above), solids(below));
        let exposure = Exposure {
            above: Shells::Alike(above.len() + beyond),
            below: Shells::Alike(below.len()),
            ..Exposure::new(plan, &[])
        };
        let here = Solid::of(fill, 1.0);
        let (over, under): (Vec<_>, Vec<_>) =
            (over.iter().collect(), under.iter().collect());
        let view = LayerView::of(50, &here, &over, &under);
        exposure.split(fill, &exposure.roomy(fill), &view)
    }

    #[test]
    fn covered_areas_stay_sparse_and_open_ones_become_skin() {
        let plan = usual_plan(ExposurePlan::of);
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        let all = rect(-1.0, -1.0, 21.0, 21.0);
        let f = split_under(&fill, &[&all, &all], &[&all], 0, plan);
        assert!((f.sparse.content() - 400.0).abs() < 1e-6);
        assert!(f.skin.content() < 1e-6);
        let f = split_under(&fill, &[&all, &Area::EMPTY], &[&all], 0, plan);
        assert_eq!(f.skin, fill);
        let beyond = split_under(&fill, &[], &[], 1, plan);
        assert_eq!(beyond.skin, fill);
    }

    #[test]
    fn hairlines_around_sparse_infill_are_no_skin() {
        let point = |(x, y)| glam::DVec2::new(x, y);
        // The end of a rib of 1.5 mm, as rounding has left it.
        let ring = [
            (10.95358, 0.76438),
            (-12.07337, 0.76659),
            (10.22058, 0.76445),
            (10.22057, -0.76431),
            (-11.77716, -0.76222),
            (10.95358, -0.76438),
        ];
        let area = Area::from(ring.map(point).to_vec());
        let rest = without_hairlines(area.clone());
        assert!(rest.bounds().min.x > 10.2, "{rest:?}");
        assert!((rest.content() - area.content()).abs() < 1e-4);
        let whole = rect(0.0, 0.0, 1.0, 2.0);
        assert_eq!(without_hairlines(whole.clone()), whole);
    }

    #[test]
    fn full_density_is_skin_but_for_a_shape_of_its_own() {
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        let roomy = |shape: bool| {
            let plan = plan_with(ExposurePlan::of, |s| {
                s.infill_density = 100.0.into();
                if shape {
                    s.infill = Infill::Expression("x".into());
                }
            });
            Exposure::new(plan, &[]).roomy(&fill)
        };
        assert!(roomy(false).is_empty());
        assert_eq!(roomy(true), fill);
    }

    #[test]
    fn a_layer_between_counts() {
        // Only the middle one of three layers above has a hole.
        let plan = usual_plan(ExposurePlan::of);
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        let all = rect(-1.0, -1.0, 21.0, 21.0);
        let holed = difference(&all, &rect(5.0, 5.0, 10.0, 10.0));
        let f = split_under(&fill, &[&all, &holed, &all], &[&all], 0, plan);
        // Walls stand around the hole.
        let (_, walls) = plan.walls.depths(0.2);
        let grown = 5.0 + 2.0 * plan.overlap.max(walls);
        let skin = f.skin.content();
        assert!((25.0..=grown * grown).contains(&skin), "{skin}");
        let both = skin + f.sparse.content();
        assert!((both - 400.0).abs() < 1e-3);
    }

    /// Content of the sparse area of a square with sides of 20 mm below layers
    /// that recede by so much on all sides.
    fn sparse_below(recede: &[f64], plan: ExposurePlan) -> f64 {
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        let inset = |by: &f64| rect(*by, *by, 20.0 - by, 20.0 - by);
        let above: Vec<Area> = recede.iter().map(inset).collect();
        let above: Vec<&Area> = above.iter().collect();
        let f = split_under(&fill, &above, &[&fill], 0, plan);
        f.sparse.content()
    }

    #[test]
    fn what_rises_stands_on_skin_as_far_as_its_walls_reach() {
        for walls in [1, 2, 5] {
            let plan = plan_with(ExposurePlan::of, |s| s.walls = walls);
            let (_, depth) = plan.walls.depths(0.2);
            let reach = depth.max(plan.overlap);
            // The step may be in any of the layers whose skin reaches down here,
            // and may be as narrow as a wall.
            for (rises, by) in [
                (vec![4.0; 4], 4.0),
                (vec![0.5; 4], 0.5),
                (vec![0.0, 0.0, 4.0, 4.0], 4.0),
                (vec![0.0, 0.0, 0.0, 1.0], 1.0),
            ] {
                let side = 20.0 - 2.0 * (by + reach);
                let is = sparse_below(&rises, plan);
                // Slopes of 45° have skin one layer farther in.
                let slope = (side - 2.0 * 0.4).powi(2);
                let most = (side * side).max(slope) + 0.3;
                assert!(is <= most, "{walls} {rises:?}: {is} {most}");
                assert!(is >= slope.min(side * side) - 0.3, "{walls}: {is}");
            }
        }
    }

    #[test]
    fn skin_below_steep_slopes_does_not_grow_for_walls() {
        let slope = [0.2, 0.4, 0.6, 0.8];
        let is = [5, 1].map(|walls| {
            sparse_below(
                &slope,
                plan_with(ExposurePlan::of, |s| s.walls = walls),
            )
        });
        assert!((is[0] - is[1]).abs() < 1e-6, "{is:?}");
    }

    #[test]
    fn outlines_of_one_shape_are_no_slope() {
        // The layers above end here, and the outline of the last one is off.
        let plan = usual_plan(ExposurePlan::of);
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        let sparse = |off: f64| {
            let outline = rect(-1.0, -1.0, 21.0, 21.0);
            let last = Solid::new(rect(-1.0 + off, -1.0, 21.0, 21.0));
            let exposure = Exposure {
                above: Shells::Alike(2),
                below: Shells::Alike(0),
                ..Exposure::new(plan, &[])
            };
            let here = Solid::new(outline);
            let view = LayerView::of(50, &here, &[&last; 2], &[]);
            let roomy = exposure.roomy(&fill);
            exposure.split(&fill, &roomy, &view).sparse.content()
        };
        let apart = apart(&plan.walls);
        assert_eq!([0.0, 0.9].map(|share| sparse(share * apart)), [400.0; 2]);
        // A slope is wider, and skin reaches in from it as far as it hides.
        assert!(sparse(1.0 - 0.05) < 400.0 - 1.0);
    }

    #[test]
    fn slivers_of_sparse_area_become_skin() {
        let plan = usual_plan(ExposurePlan::of);
        let fill = rect(0.0, 0.0, 20.0, 20.0);
        // This leaves a strip that is so wide once the skin has grown.
        let strip = |width: f64| {
            // Under a slope of 45° the layer beyond would recede by its height.
            let grows = plan.overlap + 0.2;
            let from = 20.0 - width - grows;
            let cover = rect(from, -1.0, 21.0, 21.0);
            let f = split_under(&fill, &[&cover], &[], 0, plan);
            assert!(
                (f.skin.content() + f.sparse.content() - 400.0).abs() < 1e-3
            );
            f.sparse.content()
        };
        let two = 2.0 * plan.infill;
        assert_eq!([0.2, 0.5 * two, two - 0.05].map(strip), [0.0; 3]);
        let wide = strip(two + 0.1);
        assert!((wide - 20.0 * (two + 0.1)).abs() < 0.1, "{wide}");
    }

    #[test]
    fn a_narrow_part_away_from_skin_stays_sparse() {
        let plan = usual_plan(ExposurePlan::of);
        // A square with skin in one half, and a rib of 1.5 lines beside the
        // other half.
        let rib = rect(20.0, 5.0, 30.0, 5.0 + 1.5 * plan.infill);
        let fill = union(&rect(0.0, 0.0, 20.0, 20.0), &rib);
        let cover = rect(10.0, -1.0, 31.0, 21.0);
        let f = split_under(&fill, &[&cover], &[], 0, plan);
        assert!(
            f.sparse
                .contains(rib.bounds().min.midpoint(rib.bounds().max))
        );
        assert!(f.skin.contains(glam::DVec2::new(5.0, 5.0)));
    }
}

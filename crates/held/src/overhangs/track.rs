//! What hangs, added up from layer to layer.

use super::held::Limits;
use super::look::{LayerOverhang, RimPlace, Said};
use super::plan::OverhangPlan;
use super::tip::{Island, Tips};
use super::{Hanging, OverhangKind};
use glam::{DVec2, DVec3};
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::grid::EdgeGrid;

/// Follows the rims of the layers up the part.
#[derive(Debug, Default)]
pub struct Tracker {
    /// What is known of the rim below, place by place; empty if all of it is
    /// held.
    rim: Vec<(RimPlace, State)>,
    /// Islands that have begun on nothing.
    tips: Tips,
    sums: Hanging,
    /// How far the rims get, if somebody asks.
    far: Option<Vec<Far>>,
}

/// How far a stretch of a layer's rim gets from what holds it.
#[derive(Clone, Copy, Debug)]
pub struct Far {
    /// The layer's number.
    pub layer: usize,
    /// The farthest place.
    pub at: DVec2,
    /// Its distance.
    pub reach: Mm,
}

/// What is known of a place on a rim.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// How far the place is beyond what holds itself.
    excess: Mm,
    /// Length of the underside, from the place on, that has not been counted
    /// yet.
    under: Mm,
    /// Content of the slope that the place belongs to, as far as it was
    /// counted.
    slope: Mm2,
}

/// What leans along a part of a layer's rim.
struct Slope {
    /// Content of what is new in this layer, and of the whole slope so far.
    area: Mm2,
    all: Mm2,
    /// The greatest reach, and the place that has it.
    reach: Mm,
    at: DVec2,
}

impl Tracker {
    /// A tracker that keeps how far all rims get.
    pub fn of_rims() -> Tracker {
        Tracker {
            far: Some(Vec::new()),
            ..Tracker::default()
        }
    }

    /// How far the rims of the layers so far get, from below.
    pub fn take_far(&mut self) -> Vec<Far> {
        self.far.take().unwrap_or_default()
    }

    /// Tells that no layer follows: islands that have not met anything count.
    pub fn end(&mut self, plan: &OverhangPlan) {
        let limits = Limits::new(plan.thickest_layer, plan);
        let begins = self.tips.rest(limits);
        self.count(begins);
    }

    /// Takes the next layer, `here`. With `count` it counts what hangs in the
    /// layer. `place` turns a point of the layer into a point on the bed.
    pub fn layer(
        &mut self,
        look: &LayerOverhang,
        here: &EdgeGrid,
        count: bool,
        place: impl Fn(DVec2) -> DVec3,
    ) {
        let found = self.follow(look);
        let begins = self.tips.layer(look, here, &place);
        if !count {
            return;
        }
        self.count(begins);
        for ledge in look.ledges.iter().filter(|ledge| ledge.counts) {
            let (area, reach) = (ledge.piece.area, ledge.piece.reach);
            let sum = match ledge.piece.kind {
                OverhangKind::Bridge => &mut self.sums.bridges,
                _ => &mut self.sums.leans,
            };
            sum.add(area, area, reach, place(ledge.piece.at));
        }
        for slope in found {
            let at = place(slope.at);
            let sum = &mut self.sums.leans;
            sum.add(slope.area, slope.all, slope.reach, at);
        }
    }

    /// Follows the rim. Returns what leans beyond a lip.
    fn follow(&mut self, look: &LayerOverhang) -> Vec<Slope> {
        if self.rim.is_empty() && !look.leans {
            return Vec::new();
        }
        let limits = look.limits;
        let mut areas = Vec::with_capacity(look.rim.len());
        let rim = look.rim.iter().map(|place| {
            let (state, area) = self.over(place, limits);
            areas.push(area);
            (*place, state)
        });
        let mut rim: Vec<(RimPlace, State)> = rim.collect();
        let hangs = |state: &State| state.excess > limits.harmless;
        let mut found = Vec::new();
        let mut from = 0;
        // Neighbouring places that hang belong to one slope.
        let same = |a: &(RimPlace, State), b: &(RimPlace, State)| {
            a.0.ring == b.0.ring && hangs(&a.1) == hangs(&b.1)
        };
        for run in rim.chunk_by_mut(same) {
            let areas = &areas[from..from + run.len()];
            from += run.len();
            if !hangs(&run[0].1) {
                continue;
            }
            let area: Mm2 = areas.iter().sum();
            let known = run.iter().map(|(_, state)| state.slope);
            let all = area + known.fold(0.0, f64::max);
            let excess = |(_, state): &&(RimPlace, State)| state.excess;
            let farthest = run
                .iter()
                .zip(areas)
                .filter_map(|(place, &area)| (area > 0.0).then_some(place))
                .max_by(|a, b| excess(a).total_cmp(&excess(b)));
            if let Some((place, state)) = farthest {
                found.push(Slope {
                    area,
                    all,
                    reach: state.excess + limits.slope,
                    at: place.at,
                });
            }
            run.iter_mut().for_each(|(_, state)| state.slope = all);
        }
        self.keep_far(&rim, look);
        let any = rim.iter().any(|(_, state)| state.excess > 0.0);
        self.rim = if any { rim } else { Vec::new() };
        found
    }

    /// Keeps how far each stretch of a rim gets that is not held.
    fn keep_far(&mut self, rim: &[(RimPlace, State)], look: &LayerOverhang) {
        let Some(far) = &mut self.far else { return };
        let Limits { slope, held, .. } = look.limits;
        let hangs = |(place, state): &(RimPlace, State)| {
            place.beyond > held && state.excess > 0.0
        };
        let stretches =
            rim.chunk_by(|a, b| a.0.ring == b.0.ring && hangs(a) == hangs(b));
        for stretch in stretches.filter(|stretch| hangs(&stretch[0])) {
            let farther = |a: &&(RimPlace, State), b: &&(RimPlace, State)| {
                a.1.excess.total_cmp(&b.1.excess)
            };
            let farthest = stretch.iter().max_by(farther);
            far.extend(farthest.map(|(place, state)| Far {
                layer: look.number,
                at: place.at,
                reach: state.excess + slope,
            }));
        }
    }

    /// What becomes of a place over the rim below, and the content of what
    /// leans there, if that is beyond a lip.
    fn over(&self, place: &RimPlace, limits: Limits) -> (State, Mm2) {
        let below = place.foot.map_or(State::default(), |on| self.at(on));
        let moved = if place.beyond.is_finite() {
            below.excess + limits.farther(place.beyond)
        } else {
            0.0
        };
        let mut state = State {
            excess: moved,
            ..below
        };
        if moved <= 0.0 || place.said == Said::Held {
            return (State::default(), 0.0);
        }
        if let Said::Ledge(content) = place.said {
            // The ledge is counted already.
            state.under = 0.0;
            state.slope = content;
        } else if place.beyond > limits.held && moved > limits.harmless {
            state.under = 0.0;
            return (state, place.strip + below.under * place.length);
        } else if place.beyond > limits.held {
            state.under += place.beyond;
        }
        (state, 0.0)
    }

    /// What is known of a place on the rim below, from the places on both
    /// sides.
    fn at(&self, on: f64) -> State {
        let next = self.rim.partition_point(|(place, _)| place.on <= on);
        let Some((before, state)) = next.checked_sub(1).map(|i| self.rim[i])
        else {
            return State::default();
        };
        // The last place of a ring is followed by the ring's first.
        let (from, end) = before.ring;
        let (after, end) = match self.rim.get(next) {
            Some((place, state)) if place.ring == before.ring => {
                (*state, place.on)
            }
            _ => {
                let first =
                    self.rim.partition_point(|(place, _)| place.on < from);
                (self.rim.get(first).map_or(state, |(_, s)| *s), end)
            }
        };
        let way = end - before.on;
        let t = if way > 0.0 {
            ((on - before.on) / way).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mix = |a: Mm, b: Mm| a + (b - a) * t;
        State {
            excess: mix(state.excess, after.excess),
            under: mix(state.under, after.under),
            slope: state.slope.max(after.slope),
        }
    }

    fn count(&mut self, begins: Vec<Island>) {
        for island in begins {
            let (area, at) = (island.most, island.at);
            self.sums.begins.add(area, area, 0.0, at);
            self.sums.add_where(island.in_cavity, area, at);
        }
    }

    /// Takes a layer of this height whose outline equals that of the layer
    /// below: what hung there comes nearer to being held.
    pub fn same(&mut self, height: Mm, count: bool, plan: &OverhangPlan) {
        let limits = Limits::new(height, plan);
        let begins = self.tips.same(height, limits);
        if count {
            self.count(begins);
        }
        let mut any = false;
        for (_, state) in &mut self.rim {
            state.excess = (state.excess - limits.slope).max(0.0);
            any |= state.excess > 0.0;
        }
        if !any {
            self.rim.clear();
        }
    }

    /// What hangs in the layers that were counted.
    pub fn finish(self) -> Hanging {
        self.sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::clip::{difference, union};
    use isoslice_planar::{Area, Solid, rect};
    use isoslice_settings::testing::usual_plan;

    #[test]
    fn what_begins_in_a_cavity_is_told_apart() {
        let plan = usual_plan(OverhangPlan::of);
        let plate = rect(0.0, 0.0, 60.0, 20.0);
        let below = difference(&plate, &rect(5.0, 5.0, 55.0, 14.0));
        let counts = |ball: &Area| {
            let [here, below] =
                [union(&below, ball), below.clone()].map(Solid::new);
            let look = LayerOverhang::new([&here, &below], 5, [0.2; 2], &plan);
            let mut tracker = Tracker::default();
            tracker.layer(&look, here.grid(), true, |p| p.extend(1.0));
            tracker.end(&plan);
            let sums = tracker.finish();
            [sums.begins, sums.in_cavity, sums.in_the_open].map(|s| s.count)
        };
        assert_eq!(counts(&rect(10.0, 8.0, 12.0, 10.0)), [1, 1, 0]);
        assert_eq!(counts(&rect(70.0, 8.0, 72.0, 10.0)), [1, 0, 1]);
    }
}

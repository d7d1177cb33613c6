//! The rates that beads are printed at: speed, flow, width and fan, which may
//! change along a bead.
//!
//! In: a bead. Out: the bead, or pieces of it that follow each other without a
//! break, each with its rates. A setting that is an expression is evaluated
//! along the bead every `EXPRESSION_STEP`, and the bead is cut where the value changes
//! noticeably. Walls whose speed or fan depends on how far they reach beyond
//! the layer below are cut in the same way.

use super::PacePlan;
use glam::DVec2;
use isoslice_base::units::{Celsius, Mm, MmPerSec, Percent};
use isoslice_layer::walls::Reach;
use isoslice_model::expressions::{Quantity, QuantityError, Surroundings};
use isoslice_model::{Model, Place};
use isoslice_planar::bead::{Bead, Level, Role, Stroke};
use isoslice_planar::grid::EdgeGrid;
use isoslice_settings::layers::LayerSpan;
use isoslice_settings::{Speed, Varying};

/// Distance between the points of a bead at which expressions are evaluated.
const EXPRESSION_STEP: Mm = 1.0;

/// Share of itself by which a rate has to change for the bead to be cut.
const CHANGE: f64 = 0.01;

/// Distance between the points of a wall at which its reach is measured.
const REACH_STEP: Mm = 0.25;

/// Stretches shorter than this, mm, do not count if they reach farther, or less
/// far, than what is on both sides of them: the head hardly changes its speed
/// there.
const REACH_SHORT: Mm = 1.0;

/// Changes for which a wall is cut for its reach: of its speed, as a share of
/// it, and of the fan's speed. Smaller steps do not show.
const REACH_CHANGE: (f64, Percent) = (0.05, 5.0);

/// What is known of the place of a layer's beads, in the model's coordinates. It
/// is no view of the layer, since moves get their speeds when the layers around
/// theirs have been let go.
#[derive(Clone, Copy, Default)]
pub struct Site<'a> {
    /// The layer's outline, for settings that depend on the depth below it.
    pub solid: Option<&'a EdgeGrid>,
    /// What holds the layer; none if everything is held alike.
    pub reach: Option<Reach<'a>>,
    /// How far the part is from where the model was placed.
    pub shift: DVec2,
}

/// How a bead is printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Speed that the bead's role asks for.
    pub speed: MmPerSec,
    /// Material extruded, as a factor on the bead's volume. It includes
    /// `filament.flow`.
    pub flow: f64,
    /// Speed of the part's fan.
    pub fan: Percent,
}

/// The rates of a run's beads.
pub struct Rater<'a> {
    /// The speeds, flows and temperatures by which beads are rated.
    pub plan: &'a PacePlan,
    /// What expressions know of the model; none if all settings are constant.
    around: Option<(&'a Surroundings<'a>, DVec2)>,
    /// The speeds of the roles, in the order of [`Role::ALL`].
    speeds: Vec<Quantity>,
    flow: Quantity,
    width: Quantity,
    fan: Quantity,
    temperature: Quantity,
    varies: bool,
    measures: bool,
}

/// The setting of a role's speed.
fn speed_of(role: Role, speed: &Speed) -> (&'static str, Varying) {
    let (key, value) = match role {
        Role::Skirt | Role::Brim => {
            return ("speed.skirt", Varying::Constant(speed.skirt));
        }
        Role::Support => {
            return ("speed.support", Varying::Constant(speed.support));
        }
        Role::SupportInterface => {
            let speed = Varying::Constant(speed.support_interface);
            return ("speed.support_interface", speed);
        }
        Role::OuterWall => ("speed.outer_wall", &speed.outer_wall),
        Role::InnerWall => ("speed.inner_wall", &speed.inner_wall),
        Role::GapFill => ("speed.gap_fill", &speed.gap_fill),
        Role::SparseInfill => ("speed.sparse_infill", &speed.sparse_infill),
        Role::InternalSkin => ("speed.internal_skin", &speed.internal_skin),
        Role::TopSkin => ("speed.top_skin", &speed.top_skin),
        Role::BottomSkin => ("speed.bottom_skin", &speed.bottom_skin),
        Role::Bridge => ("speed.bridge", &speed.bridge),
        Role::InternalBridge => {
            ("speed.internal_bridge", &speed.internal_bridge)
        }
        // Where speeds go by steps, the wall's own counts.
        Role::Overhang => (
            "speed.overhang",
            speed.overhang.same().unwrap_or(&speed.outer_wall),
        ),
        Role::Ironing => ("speed.ironing", &speed.ironing),
    };
    (key, value.clone())
}

impl<'a> Rater<'a> {
    /// A rater for a model, whose print coordinates are the model's plus an
    /// offset.
    ///
    /// # Errors
    /// If a setting is no valid expression.
    pub fn new(
        plan: &'a PacePlan,
        model: &Model,
        around: &'a Surroundings<'a>,
    ) -> Result<Rater<'a>, QuantityError> {
        Self::with(plan, Some((around, model.offset.truncate())))
    }

    /// A rater for settings that are all constant. An expression has no value
    /// by this rater.
    ///
    /// # Errors
    /// If a setting is no valid expression.
    pub fn constant(plan: &'a PacePlan) -> Result<Rater<'a>, QuantityError> {
        Self::with(plan, None)
    }

    fn with(
        plan: &'a PacePlan,
        around: Option<(&'a Surroundings<'a>, DVec2)>,
    ) -> Result<Rater<'a>, QuantityError> {
        let speeds: Vec<Quantity> = Role::ALL
            .iter()
            .map(|r| {
                let (key, value) = speed_of(*r, &plan.speed);
                Quantity::new(key, &value)
            })
            .collect::<Result<_, _>>()?;
        let flow = Quantity::new("flow", &plan.flow)?;
        let width = Quantity::new("bead_width", &plan.bead_width)?;
        let fan = Quantity::new("cooling.fan_speed", &plan.cooling.fan_speed)?;
        let temperature =
            Quantity::level("filament.nozzle_temperature", &plan.temperature)?;
        let all = || speeds.iter().chain([&flow, &width, &fan]);
        let varies = all().any(|q| q.constant().is_none());
        let measures = all().any(Quantity::uses_depth);
        Ok(Rater {
            plan,
            around,
            speeds,
            flow,
            width,
            fan,
            temperature,
            varies,
            measures,
        })
    }

    /// Temperature of the nozzle on a layer. The value of an expression is
    /// rounded to whole degrees.
    ///
    /// # Errors
    /// If an expression has no value there, or if plastic does not melt at the
    /// value, or the printer does not bear it.
    pub fn temperature(
        &self,
        span: &LayerSpan,
    ) -> Result<Celsius, QuantityError> {
        if span.index == 0 {
            return Ok(self.plan.first_temperature);
        }
        if let Some(value) = self.temperature.constant() {
            return Ok(value);
        }
        // A value at which plastic does not melt, or that the printer does not
        // bear, is a mistake in the expression. It is not clamped.
        let range = self.plan.temperatures;
        Ok(self.temperature.at_height(span.top, range)?.round())
    }

    /// Speed of the fan at a layer's beginning; none if the first bead sets it.
    pub fn fan(&self, span: &LayerSpan) -> Option<Percent> {
        if span.index < self.plan.cooling.fan_off_layers as usize {
            Some(0.0)
        } else {
            self.fan.constant()
        }
    }

    fn speed(&self, role: Role) -> &Quantity {
        let i = Role::ALL.iter().position(|r| *r == role).unwrap_or(0);
        &self.speeds[i]
    }

    /// The bead, which has one width and is in print coordinates, in pieces of
    /// constant rates.
    ///
    /// # Errors
    /// If a setting has no value somewhere along the bead.
    pub fn pieces(
        &self,
        bead: Bead,
        span: &LayerSpan,
        site: Site<'_>,
    ) -> Result<Vec<(Bead, Rates)>, QuantityError> {
        let by_reach = self.by_reach(&bead);
        let role = if by_reach.speed {
            bead.laid_as
        } else {
            bead.role
        };
        let quantities = [self.speed(role), &self.flow, &self.width, &self.fan];
        let constant =
            !self.varies || quantities.iter().all(|q| q.constant().is_some());
        let reach = site.reach.filter(|_| by_reach.any());
        let all = || quantities.map(|q| q.constant().unwrap_or(f64::NAN));
        if constant && reach.is_none() {
            return Ok(vec![self.rated(bead, span, all())]);
        }
        let (steps, shares) = self.reaching(&bead, reach, site.shift);
        let reaches = shares.iter().any(|share| *share > 0.0);
        if constant && !reaches {
            return Ok(vec![self.rated(bead, span, all())]);
        }
        let places = self.places(&steps, span, site)?;
        let mut values: [Vec<f64>; 4] = Default::default();
        for (quantity, values) in quantities.iter().zip(&mut values) {
            quantity.evaluate(&places, values)?;
        }
        if reaches {
            by_reach.apply(&shares, &mut values, self.plan);
        }
        let at = |i: usize| [0, 1, 2, 3].map(|k: usize| values[k][i]);
        let rated = |run: std::ops::Range<usize>| {
            let (first, last) = (at(run.start), at(run.end - 1));
            let mean = [0, 1, 2, 3].map(|k| 0.5 * (first[k] + last[k]));
            self.rated(part(&bead, &steps[run]), span, mean)
        };
        Ok(runs(steps.len(), at, reaches)
            .into_iter()
            .map(rated)
            .collect())
    }

    /// What changes along a bead with its reach.
    fn by_reach(&self, bead: &Bead) -> ByReach {
        let wall = matches!(
            bead.role,
            Role::OuterWall | Role::InnerWall | Role::Overhang
        );
        let PacePlan { speed, cooling, .. } = self.plan;
        ByReach {
            speed: wall && speed.overhang.steps().is_some(),
            fan: wall && cooling.overhang_fan_speed.steps().is_some(),
        }
    }

    /// The stretches of a piece, and how much of its width reaches beyond the
    /// layer below in each, %. There are no shares if that does not matter.
    fn reaching(
        &self,
        piece: &Bead,
        reach: Option<Reach<'_>>,
        shift: DVec2,
    ) -> (Vec<Step>, Vec<Percent>) {
        let Some(reach) = reach else {
            return (steps(&piece.stroke, EXPRESSION_STEP), Vec::new());
        };
        let steps = steps(&piece.stroke, REACH_STEP);
        let placed = self.around.map_or(DVec2::ZERO, |around| around.1);
        let offset = placed + shift;
        let share = |step: &Step| {
            let middle = 0.5 * (step.from + step.to) - offset;
            let along = (step.to - step.from).normalize_or_zero();
            let side = 0.5 * piece.stroke.width * along.perp();
            100.0 * reach.share(middle - side, middle + side)
        };
        let shares: Vec<Percent> = steps.iter().map(share).collect();
        let shares = without_short(&steps, shares);
        (steps, shares)
    }

    /// Share of a bead's volume that is printed, by the bead's role.
    fn share(&self, bead: &Bead) -> f64 {
        let mut flows = self.plan.flows.iter();
        let own = flows.find(|(role, _)| *role == bead.role);
        let share = own.map_or(1.0, |(_, flow)| 0.01 * flow);
        match bead.role {
            // The skin that is ironed is full except for this share.
            Role::Ironing => {
                share * (bead.stroke.width * bead.height) / bead.area()
            }
            _ => share,
        }
    }

    fn places(
        &self,
        steps: &[Step],
        span: &LayerSpan,
        site: Site<'_>,
    ) -> Result<Vec<Place>, QuantityError> {
        let mut places = Vec::with_capacity(steps.len());
        if let Some((around, offset)) = self.around {
            let offset = offset + site.shift;
            let middles = steps.iter().map(|s| 0.5 * (s.from + s.to) - offset);
            // The sample height is halfway up the layer, where its outline is
            // the part's.
            let z = span.sample_z();
            around.places(
                middles,
                z,
                self.measures,
                site.solid,
                &mut places,
            )?;
            for place in &mut places {
                place.at.z = span.top;
            }
        } else {
            places.extend(steps.iter().map(|_| Place {
                at: glam::DVec3::NAN,
                depth: f64::NAN,
            }));
        }
        Ok(places)
    }

    fn rated(
        &self,
        mut bead: Bead,
        span: &LayerSpan,
        [speed, flow, width, fan]: [f64; 4],
    ) -> (Bead, Rates) {
        // Neither skirt and brim nor supports belong to the part.
        if bead.role.is_part() {
            bead.stroke.width *= width / 100.0;
        }
        let cooling = &self.plan.cooling;
        let fan = match bead.role {
            _ if span.index < cooling.fan_off_layers as usize => 0.0,
            Role::Bridge => cooling.bridge_fan_speed,
            Role::InternalBridge => cooling
                .internal_bridge_fan_speed
                .unwrap_or(cooling.bridge_fan_speed),
            Role::Overhang => {
                *cooling.overhang_fan_speed.same().unwrap_or(&fan)
            }
            Role::SupportInterface => {
                cooling.support_interface_fan_speed.unwrap_or(fan)
            }
            _ => fan,
        };
        let rates = Rates {
            speed,
            flow: flow * self.plan.filament_flow * 1e-4 * self.share(&bead),
            fan,
        };
        (bead, rates)
    }
}

/// What of a bead depends on how far it reaches beyond the layer below.
struct ByReach {
    speed: bool,
    fan: bool,
}

impl ByReach {
    fn any(&self) -> bool {
        self.speed || self.fan
    }

    /// Changes values that depend on the reach.
    fn apply(
        &self,
        shares: &[Percent],
        [speeds, _, _, fans]: &mut [Vec<f64>; 4],
        plan: &PacePlan,
    ) {
        if self.speed
            && let Some(steps) = plan.speed.overhang.steps()
        {
            for (speed, share) in speeds.iter_mut().zip(shares) {
                *speed = steps.at(*share, *speed).min(*speed);
            }
        }
        if self.fan
            && let Some(steps) = plan.cooling.overhang_fan_speed.steps()
        {
            for (fan, share) in fans.iter_mut().zip(shares) {
                *fan = steps.at(*share, *fan);
            }
        }
    }
}

/// Shares of some stretches of a bead. Where a share is greater, or less, than
/// those on both sides for less than [`REACH_SHORT`], it is evened out.
fn without_short(steps: &[Step], shares: Vec<Percent>) -> Vec<Percent> {
    let mut at = 0.0;
    let places: Vec<Mm> = steps
        .iter()
        .map(|step| {
            let length = step.from.distance(step.to);
            at += length;
            at - 0.5 * length
        })
        .collect();
    // The least or the greatest share near each stretch.
    let near = |shares: &[Percent], most: bool| -> Vec<Percent> {
        let (mut from, mut to) = (0, 0);
        let half = 0.5 * REACH_SHORT;
        let of = |&place: &Mm| {
            while places[from] < place - half {
                from += 1;
            }
            while to < places.len() && places[to] <= place + half {
                to += 1;
            }
            let all = shares[from..to].iter().copied();
            if most {
                all.fold(f64::NEG_INFINITY, f64::max)
            } else {
                all.fold(f64::INFINITY, f64::min)
            }
        };
        places.iter().map(of).collect()
    };
    let opened = near(&near(&shares, false), true);
    near(&near(&opened, true), false)
}

/// A short stretch of a bead.
#[derive(Clone, Copy, Debug)]
struct Step {
    from: DVec2,
    to: DVec2,
    /// Levels of its ends.
    levels: [Level; 2],
    /// True if the stretch ends at one of the bead's own points.
    corner: bool,
}

/// The bead in stretches of at most `longest`.
fn steps(stroke: &Stroke, longest: Mm) -> Vec<Step> {
    let mut steps = Vec::new();
    for (k, (a, b)) in stroke.segments().enumerate() {
        let ends = [k, k + 1].map(|k| stroke.level(k));
        let level = |t: f64| ends[0].lerp(ends[1], t);
        let count = (a.distance(b) / longest).ceil().max(1.0);
        for i in 0..count as usize {
            let last = i + 1 == count as usize;
            steps.push(Step {
                levels: [i, i + 1].map(|i| level(i as f64 / count)),
                from: a.lerp(b, i as f64 / count),
                to: if last {
                    b
                } else {
                    a.lerp(b, (i + 1) as f64 / count)
                },
                corner: last,
            });
        }
    }
    steps
}

/// Stretches that follow each other with about equal values. `reaches` is true
/// if speed and fan depend on how far the stretches reach.
fn runs(
    count: usize,
    at: impl Fn(usize) -> [f64; 4],
    reaches: bool,
) -> Vec<std::ops::Range<usize>> {
    let (speed, fan) = if reaches { REACH_CHANGE } else { (CHANGE, 0.0) };
    let slack = [(speed, 0.0), (CHANGE, 0.0), (CHANGE, 0.0), (CHANGE, fan)];
    let mut runs = Vec::new();
    let mut start = 0;
    for i in 1..=count {
        let same = i < count && {
            let (first, here) = (at(start), at(i));
            let close =
                |((a, b), (share, fixed)): ((&f64, &f64), (f64, f64))| {
                    (a - b).abs() <= fixed.max(share * a.abs().max(b.abs()))
                };
            first.iter().zip(&here).zip(slack).all(close)
        };
        if !same {
            runs.push(start..i);
            start = i;
        }
    }
    runs
}

/// The part of a bead that these stretches make up.
fn part(bead: &Bead, steps: &[Step]) -> Bead {
    let last = steps.len() - 1;
    let ends = steps.iter().enumerate();
    let ends = ends.filter(|(i, s)| s.corner || *i == last);
    let ends = ends.map(|(_, s)| (s.to, s.levels[1]));
    let begin = steps.first().map(|s| (s.from, s.levels[0]));
    let (points, levels): (Vec<DVec2>, Vec<Level>) =
        begin.into_iter().chain(ends).unzip();
    let mut stroke = Stroke::new(points, false, bead.stroke.width);
    if !bead.stroke.levels.is_empty() {
        stroke.levels = levels;
    }
    Bead { stroke, ..*bead }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_settings::testing::plan_with;

    fn bead(points: &[(f64, f64)], closed: bool) -> Bead {
        Bead::new(
            Role::OuterWall,
            Stroke::new(
                points.iter().map(|&p| p.into()).collect(),
                closed,
                0.45,
            ),
            0.2,
        )
    }

    #[test]
    fn stretches_are_the_bead() {
        let square =
            bead(&[(0.0, 0.0), (3.5, 0.0), (3.5, 2.0), (0.0, 2.0)], true);
        let steps = steps(&square.stroke, EXPRESSION_STEP);
        assert_eq!(steps.len(), 4 + 2 + 4 + 2);
        assert!(steps.windows(2).all(|w| w[0].to == w[1].from));
        let longest = steps.iter().map(|s| s.from.distance(s.to));
        assert!(longest.fold(0.0, f64::max) <= EXPRESSION_STEP);
        // Put together again, the bead has its corners and no other points.
        let whole = part(&square, &steps);
        assert_eq!(whole.stroke.points.len(), 5);
        assert_eq!(whole.stroke.length(), square.stroke.length());
    }

    #[test]
    fn runs_end_where_values_change() {
        let values = [10.0, 10.05, 10.2, 10.2, 5.0];
        let at = |i: usize| [values[i], 1.0, 1.0, 0.0];
        assert_eq!(runs(5, at, false), vec![0..2, 2..4, 4..5]);
        assert!(runs(0, at, false).is_empty());
        // Speeds that depend on the reach change less often.
        assert_eq!(runs(5, at, true), vec![0..4, 4..5]);
    }

    #[test]
    fn constant_settings_leave_beads_whole() {
        let plan = plan_with(PacePlan::of, |s| {
            s.flow = Varying::Constant(90.0);
            s.bead_width = Varying::Constant(110.0);
        });
        let rater = Rater::constant(&plan).unwrap();
        let span = LayerSpan {
            index: 4,
            bottom: 0.8,
            top: 1.0,
        };
        let line = bead(&[(0.0, 0.0), (30.0, 0.0)], false);
        let pieces = rater.pieces(line, &span, Site::default()).unwrap();
        assert_eq!(pieces.len(), 1);
        let (bead, rates) = &pieces[0];
        assert!((bead.stroke.width - 0.495).abs() < 1e-12);
        assert!((rates.flow - 0.9).abs() < 1e-12);
        assert_eq!((rates.speed, rates.fan), (40.0, 100.0));
    }
}

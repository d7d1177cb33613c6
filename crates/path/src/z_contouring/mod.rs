//! Surfaces without steps: beads that follow the surface above them
//! (z-contouring).
//!
//! ```text
//!        ____                             ____╱
//!   ____|      layers, level,        ___╱       the same layers, whose beads
//!       |____  sampled at their     ╱    ____╱  end on f = 0 where nothing
//!   ____|      middle              ╱___╱        covers them
//! ```
//!
//! In: a layer's beads in print order, with all their ends, and the outlines of
//! the layers above and below. Out: the beads; those that lie open have levels.
//!
//! A layer is exact at its middle. So what the next layer leaves open of it
//! lies below a surface that is at most half a layer lower than the layer's top,
//! or half of the next layer higher. The nozzle is led along this surface, and
//! the material is as high as the nozzle is above the layer below. Where the
//! next layer begins, its own beads begin at the height that these have reached.
//!
//! Guarantees, where a face is no steeper than the angle of full strength: each
//! bead is, at the middle of what lies open of it across its way, on f = 0 within
//! some micrometres, unless that is higher above the layer below than the nozzle
//! is wide; all material together fills what is below f = 0. In a bend a bead has
//! one height for both of its sides: there it is within 20 µm on faces of up to
//! 25°, and may be farther off on steeper ones. The guarantee holds, too, where
//! the next layer covers a bead's own middle: the nozzle then rises under the
//! next layer's edge, but only what lies open gets more material. Steeper faces
//! get less and less of it, and those [`FADE`] steeper nothing: nowhere does it
//! begin at once. Under the next layer a bead comes back to the layer's top.
//!
//! Undersides (`contour_z_below`) are the other way round. The nozzle stays at the
//! layer's top, where the next layer is to lie, and the material goes as deep as
//! the surface below, which is at most half a layer higher than the layer's
//! bottom, or half of the layer below lower. So a bead's height ends on f = 0.
//!
//! Where supports stand above a top, no bead rises into the air below them.
//!
//! Tops of supports can follow the underside above them, a gap below it
//! (`support.interface_shape`). To them it is the top of a model of their own, which
//! is the space outside the part, moved down by the gap.
//!
//! Not guaranteed: that undersides of beads that lie open above follow the surface
//! as well, nor how smooth a face is across the beads, as each is level there.
//! A nozzle has a flat end, which cuts into higher beads beside it that are
//! printed before. How deep is bounded.
//!
//! | file | what it does |
//! |---|---|
//! | `plan` | what is needed of the settings |
//! | `surface` | where f = 0 is above a point, and how steep |
//! | `chain` | beads that follow one another, as one path |
//! | `profile` | how the nozzle's height goes on along a path |

mod chain;
mod plan;
mod profile;
mod surface;

pub use plan::ZContouringPlan;

use chain::{Chain, Stop};
use glam::DVec2;
use isoslice_base::parallel;
use isoslice_base::timings::{Stage, Timings};
use isoslice_base::units::{Degrees, Mm, Mm2};
use isoslice_layer::seam::ending::Ended;
use isoslice_layer::view::{LayerFace, LayerView};
use isoslice_model::expressions::{Quantity, QuantityError, Surroundings};
use isoslice_model::{Model, Probe, ProbeError};
use isoslice_planar::bead::{Bead, Role, cross_section, height_of};
use isoslice_planar::grid::EdgeGrid;
use isoslice_settings::Varying;
use isoslice_settings::layers::LayerSpan;
use profile::{Knot, KnotKind};
use rayon::ThreadPool;
use surface::{Facing, Spot, Window};

/// How much steeper than a face of full strength a face is that gets nothing.
const FADE: Degrees = 10.0;

/// Distance of places along a bead at which the surface is looked for, mm.
const SURFACE_STEP: Mm = 0.1;

/// Distance at which the slope of the surface is measured, mm.
const BESIDE: Mm = 0.1;

/// How much farther than its material reaches the nozzle may be above the bed, mm.
/// Beds are uneven by as much. What falls farther may not stick.
const LIFT: Mm = 0.05;

/// Rises below this count as 0, mm: it is half of what G-code resolves.
const LEVEL: Mm = 0.0005;

/// How far the nozzle may be from the heights that were found, mm.
const TOLERANCE: Mm = 0.0015;

/// Why beads cannot follow the surface.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ZContouringError {
    /// The strength has no value somewhere.
    #[error(transparent)]
    Strength(#[from] QuantityError),
    /// The field cannot be evaluated.
    #[error(transparent)]
    Probe(#[from] ProbeError),
}

/// What follows the surface of a model.
pub struct ZContouring<'a> {
    plan: ZContouringPlan,
    whose: Whose,
    probe: Probe,
    strength: Quantity,
    around: &'a Surroundings<'a>,
    /// Height of the bed in the model's coordinates.
    bed: Mm,
    /// What looks for the surface.
    pool: &'a ThreadPool,
    timings: &'a Timings,
}

/// Whose beads follow a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Whose {
    /// The part's beads follow its surface.
    Part,
    /// The beads of its supports follow the underside above them.
    Supports,
}

/// A layer, what is around it, and what stands on it.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    /// The layer and its neighbours. A neighbour with an equal outline leaves
    /// nothing open.
    pub view: &'a LayerView<'a>,
    /// Where supports stand on the layer, a gap above it.
    pub under_support: Option<&'a EdgeGrid>,
}

/// What the heights of a layer permit on one side of it.
struct Bounds {
    facing: Facing,
    /// Height of the layer, mm.
    height: Mm,
    /// Least and greatest height of the surface beyond the layer's own face, out
    /// of the layer, mm.
    low: Mm,
    high: Mm,
    /// Slope of a face up to which the strength is full.
    full: Degrees,
    /// True if the layer lies on the bed.
    on_bed: bool,
}

impl<'a> ZContouring<'a> {
    /// What follows the surface of a model, if the settings ask for it.
    ///
    /// # Errors
    /// If the strength is no expression, or the field cannot be evaluated.
    pub fn new(
        model: &Model,
        plan: ZContouringPlan,
        around: &'a Surroundings<'a>,
        pool: &'a ThreadPool,
        timings: &'a Timings,
    ) -> Result<Option<ZContouring<'a>>, ZContouringError> {
        let strength = Quantity::new("contour_z", &plan.strength)?;
        if strength.constant() == Some(0.0) || !plan.in_layers {
            return Ok(None);
        }
        Ok(Some(ZContouring {
            plan,
            whose: Whose::Part,
            probe: Probe::new(&model.tree)?,
            strength,
            around,
            bed: -model.offset.z,
            pool,
            timings,
        }))
    }

    /// What follows the undersides of a model with the tops of its supports, if
    /// the settings ask for it.
    ///
    /// # Errors
    /// If the field cannot be evaluated.
    pub fn of_supports(
        model: &Model,
        plan: ZContouringPlan,
        around: &'a Surroundings<'a>,
        pool: &'a ThreadPool,
        timings: &'a Timings,
    ) -> Result<Option<ZContouring<'a>>, ZContouringError> {
        let Some(gap) = plan.support_gap else {
            return Ok(None);
        };
        let full = Varying::Constant(100.0);
        Ok(Some(ZContouring {
            plan,
            whose: Whose::Supports,
            probe: Probe::below(&model.tree, gap)?,
            strength: Quantity::new("support.interface_shape", &full)?,
            around,
            bed: -model.offset.z,
            pool,
            timings,
        }))
    }

    /// Lets a layer's beads follow the surface.
    ///
    /// # Errors
    /// If the strength has no value somewhere, or the evaluator fails.
    pub fn apply(
        &self,
        mut beads: Vec<Ended>,
        site: Site<'_>,
    ) -> Result<Vec<Ended>, ZContouringError> {
        if !site.is_closed(Facing::Up) {
            beads = self.facing(beads, site, Facing::Up)?;
        }
        let undersides = self.whose == Whose::Part
            && self.plan.undersides
            && !site.is_closed(Facing::Down);
        if undersides {
            beads = self.facing(beads, site, Facing::Down)?;
        }
        Ok(beads)
    }

    /// True if a bead may follow the surface. Infill has its place, and what is
    /// beside the part has no surface. A bridge hangs straight, so the nozzle
    /// does, and ironing lies on what is printed.
    fn follows(&self, bead: &Bead, facing: Facing) -> bool {
        let apart = match facing {
            Facing::Up => Role::Bridge,
            Facing::Down => Role::Ironing,
        };
        let own = match self.whose {
            Whose::Part => bead.role.is_part(),
            Whose::Supports => bead.role.is_support(),
        };
        own && !matches!(bead.role, Role::InternalBridge | Role::SparseInfill)
            && bead.role != apart
            && bead.stroke.levels.is_empty()
            && bead.stroke.points.len() > 1
    }

    /// Lets beads follow the surface on one side of their layer.
    fn facing(
        &self,
        beads: Vec<Ended>,
        site: Site<'_>,
        facing: Facing,
    ) -> Result<Vec<Ended>, ZContouringError> {
        // Each path is of beads that follow the surface, or of beads that do
        // not.
        let mut paths: Vec<(Vec<Ended>, bool)> = Vec::new();
        for ended in beads {
            let own = self.follows(&ended.bead, facing);
            match paths.last_mut() {
                Some((path, true))
                    if own
                        && path.last().is_some_and(|l| goes_on(l, &ended)) =>
                {
                    path.push(ended);
                }
                _ => paths.push((vec![ended], own)),
            }
        }
        let led = |_: usize, (path, follows): (Vec<Ended>, bool)| {
            if follows {
                let _lap = self.timings.begin(Stage::ZContouring);
                self.chain(path, site, facing)
            } else {
                Ok(path)
            }
        };
        let led = self.pool.install(|| parallel::map_owned(paths, led));
        let led: Vec<Vec<Ended>> = led.into_iter().collect::<Result<_, _>>()?;
        Ok(led.into_iter().flatten().collect())
    }

    /// Beads each of which begins where the one before ends.
    fn chain(
        &self,
        beads: Vec<Ended>,
        site: Site<'_>,
        facing: Facing,
    ) -> Result<Vec<Ended>, ZContouringError> {
        if isoslice_base::limits::is_stopped() {
            return Ok(beads);
        }
        let cover = site.other(facing).map(|other| other.outline.grid());
        // Most of a part's beads lie below others, and on others.
        let height = site.span().height();
        if !chain::any_open(&beads, cover, height) {
            return Ok(beads);
        }
        let cut = |ended: &Ended| {
            // A stroke with levels has one width.
            let mut parts: Vec<Ended> = self
                .plan
                .resolution
                .pieces(ended.bead.clone())
                .into_iter()
                .map(Ended::from)
                .collect();
            if let Some(last) = parts.last_mut() {
                last.wipe = ended.wipe;
            }
            parts
        };
        let parts: Vec<Ended> = beads.iter().flat_map(cut).collect();
        let chain = Chain::new(parts);
        let stops = chain.stops(cover, SURFACE_STEP, height);
        let bounds = Bounds::new(site, facing, &self.plan);
        let Some(knots) = self.knots(&stops, site, &bounds)? else {
            return Ok(beads);
        };
        let ramp = chain.width();
        let mut knots = if chain.is_closed() {
            profile::filled_round(knots, ramp)
        } else {
            profile::filled(knots, ramp)
        };
        if facing == Facing::Down {
            // What is below the nozzle goes deeper, and the nozzle stays.
            knots.iter_mut().for_each(|knot| knot.rise = 0.0);
        }
        Ok(chain.levelled(&knots, TOLERANCE, extra))
    }

    /// What is known of the heights at some stops of a chain, or nothing if the
    /// layer is right as it is. Heights are counted out of the layer: upwards
    /// from its top, or downwards from its bottom.
    fn knots(
        &self,
        stops: &[Stop],
        site: Site<'_>,
        bounds: &Bounds,
    ) -> Result<Option<Vec<Knot>>, ZContouringError> {
        let face = self.bed
            + match bounds.facing {
                Facing::Up => site.span().top,
                Facing::Down => site.span().bottom,
            };
        let seen = |stop: &&Stop| stop.bare.share > 0.0;
        let points: Vec<DVec2> =
            stops.iter().filter(seen).map(|s| s.bare.middle).collect();
        let window = bounds.window(face);
        let spots = surface::spots(
            &self.probe,
            &points,
            window,
            bounds.facing,
            BESIDE,
            bounds.steep(),
        )?;
        let strengths = self.strengths(&points, site.span())?;
        let mut found = spots.into_iter().zip(strengths);
        let mut level = true;
        let mut knot = |stop: &Stop| {
            let mut knot = Knot {
                at: stop.at,
                kind: KnotKind::Covered,
                rise: 0.0,
                fill: 0.0,
                corner: stop.corner,
            };
            if stop.open {
                knot.kind = KnotKind::Bare;
            }
            if !seen(&stop) {
                return knot;
            }
            if let Some((Some(spot), strength)) = found.next() {
                let of_slope = 0.01 * strength * bounds.share(&spot);
                let kept = [stop.point, stop.bare.middle]
                    .into_iter()
                    .any(|p| site.is_under_support(p, bounds.facing));
                let out = bounds.facing.sign() * (spot.height - face);
                let rise = bounds.clamped(of_slope * out, stop.bare.share);
                knot.kind = KnotKind::Open;
                knot.rise = if kept { rise.min(0.0) } else { rise };
                knot.fill = stop.bare.share * knot.rise;
                level &= knot.rise.abs() < LEVEL;
            }
            knot
        };
        let knots: Vec<Knot> = stops.iter().map(&mut knot).collect();
        Ok((!level).then_some(knots))
    }

    /// The strength at points of a layer, %.
    fn strengths(
        &self,
        points: &[DVec2],
        span: &LayerSpan,
    ) -> Result<Vec<f64>, QuantityError> {
        if let Some(strength) = self.strength.constant() {
            return Ok(vec![strength; points.len()]);
        }
        let mut places = Vec::with_capacity(points.len());
        let measure = self.strength.uses_depth();
        let points = points.iter().copied();
        self.around
            .places(points, span.top, measure, None, &mut places)?;
        let mut strengths = Vec::with_capacity(places.len());
        self.strength.evaluate(&places, &mut strengths)?;
        Ok(strengths)
    }
}

impl<'a> Site<'a> {
    fn span(&self) -> &'a LayerSpan {
        &self.view.here.span
    }

    /// The layer on one side.
    fn beside(&self, facing: Facing) -> Option<&'a LayerFace<'a>> {
        match facing {
            Facing::Up => self.view.above.first(),
            Facing::Down => self.view.below.first(),
        }
    }

    /// The layer on one side, if its outline is another.
    fn other(&self, facing: Facing) -> Option<&'a LayerFace<'a>> {
        let beside = self.beside(facing);
        beside.filter(|beside| !beside.is_like(&self.view.here))
    }

    /// True if the layer on one side has an equal outline.
    fn is_closed(&self, facing: Facing) -> bool {
        self.beside(facing).is_some() && self.other(facing).is_none()
    }

    /// True if a support stands on a place of a top.
    fn is_under_support(&self, p: DVec2, facing: Facing) -> bool {
        let support = self.under_support.filter(|_| facing == Facing::Up);
        support.is_some_and(|support| support.contains(p))
    }
}

impl Facing {
    /// 1 if the way out of the part leads up, −1 if it leads down.
    fn sign(self) -> f64 {
        match self {
            Facing::Up => 1.0,
            Facing::Down => -1.0,
        }
    }
}

impl Bounds {
    fn new(site: Site<'_>, facing: Facing, plan: &ZContouringPlan) -> Bounds {
        let height = site.span().height();
        let next = site.other(facing);
        let next = next.map_or(height, |next| next.span.height());
        // A bead that is higher than the nozzle's hole is wide would not touch
        // what is below it.
        let room = (plan.nozzle - height).max(0.0);
        Bounds {
            facing,
            height,
            low: -0.5 * height,
            high: room.min(0.5 * next),
            // The nozzle's flat end cuts into nothing that is below.
            full: match facing {
                Facing::Up => plan.full_angle.at(height),
                Facing::Down => plan.full_angle.wanted,
            },
            on_bed: site.span().bottom <= 0.0,
        }
    }

    /// Where the surface is looked for beside a layer's face: wide enough for
    /// the slope at the bounds to be seen.
    fn window(&self, face: Mm) -> Window {
        let (inner, outer) = (1.5 * self.height, self.high + 0.5 * self.height);
        match self.facing {
            Facing::Up => Window {
                low: face - inner,
                high: face + outer,
            },
            Facing::Down => Window {
                low: face - outer,
                high: face + inner,
            },
        }
    }

    /// Slope from which on the strength is nothing.
    fn steep(&self) -> f64 {
        let angle = self.full + FADE;
        if angle < 90.0 {
            angle.to_radians().tan()
        } else {
            f64::INFINITY
        }
    }

    /// Share of the strength at a place: 1 where the face is level, fading to
    /// 0 where it is steep, with a slope of its own (cubic).
    fn share(&self, spot: &Spot) -> f64 {
        let angle = spot.slope.length().atan().to_degrees();
        let t = ((angle - self.full) / FADE).clamp(0.0, 1.0);
        1.0 - t * t * (3.0 - 2.0 * t)
    }

    /// The rise of a bead of which a share lies open. The rest gets no material for
    /// it, and hangs above what is below.
    fn clamped(&self, rise: Mm, open: f64) -> Mm {
        let lift = if self.on_bed {
            LIFT / (1.0 - open).max(f64::EPSILON)
        } else {
            f64::INFINITY
        };
        rise.clamp(self.low, self.high).min(lift)
    }
}

/// True if the bead `next` goes on where the bead before it ends.
fn goes_on(before: &Ended, next: &Ended) -> bool {
    let bead = &before.bead;
    before.wipe.is_none()
        && !bead.stroke.closed
        && !next.bead.stroke.closed
        && bead.stroke.points.last() == next.bead.stroke.points.first()
}

/// How much higher than its layer a bead's material has to be counted so that
/// it fills a layer that is higher by `fill`. The bead's width stays, and so
/// does its distance from the next one, which is one spacing. Beads beside each
/// other share their round ends, which are the larger the higher the beads are.
fn extra(bead: &Bead, fill: Mm) -> Mm {
    if bead.role == Role::Ironing {
        return 0.0;
    }
    let own = cross_section(bead.stroke.width, bead.height);
    let area: Mm2 = own * (1.0 + fill / bead.height);
    height_of(area, bead.stroke.width) - bead.height
}

//! Sparse infill: a pattern's lines inside the covered areas.
//!
//! Each pattern has a file and is a `Pattern`. The place of its lines depends
//! only on the settings, on the layer's height and on where the part stands, so
//! that layers stand on each other and islands continue each other's lines.
//!
//! ```text
//!   pattern ──► pieces inside the area ──join──► long paths ──► beads
//! ```
//!
//! The **density** is the pattern's: the volume of its beads over the volume of
//! the area. The joins along the area's border are not part of it: they belong
//! to the wall that they follow, and cover half of its length.
//!
//! The private trait `Pattern` says what a pattern has to do. CONTRIBUTING.md
//! lists the other files that a new pattern touches.

mod bare;
mod concentric;
mod cubic;
mod diamond;
mod families;
mod grading;
mod grid;
mod gyroid;
mod hexagons;
mod join;
mod lidinoid;
mod neovius;
mod pairing;
mod plan;
mod rectilinear;
mod schwarz_p;
mod shape;
mod sheet;
pub mod standing;
pub mod told;
mod triangles;

pub use bare::{fill_bare, fill_small};
pub use plan::InfillPlan;

use glam::DVec2;
use grading::Grading;
use isoslice_base::units::{Degrees, Mm};
use isoslice_model::contour::{FieldError, remedy};
use isoslice_model::expressions::{Quantity, QuantityError, Surroundings};
use isoslice_model::{ExpressionError, LoadError, Source, load, operations};
use isoslice_planar::bead::{Bead, Role, Stroke, spacing};
use isoslice_planar::border::{Border, LinePiece};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Rect};
use isoslice_settings::InfillPattern;
use isoslice_settings::layers::LayerSpan;
use shape::{Around, Shape};
use sheet::{Sheet, Surface};

/// How dense a layer's pattern is.
#[derive(Clone, Copy, Debug)]
enum Density<'a> {
    /// One share of the plane everywhere, 0 to 1.
    Even(f64),
    /// A share that varies.
    Graded(&'a Grading),
}

impl Density<'_> {
    /// The mean share of the area, 0.01 at least if it varies.
    fn mean(&self) -> f64 {
        match self {
            Density::Even(share) => *share,
            Density::Graded(grading) => grading.mean().max(0.01),
        }
    }
}

/// What a pattern needs to know.
#[derive(Clone, Copy, Debug)]
struct Layer<'a> {
    /// Border of the area at which the lines end.
    border: &'a Border<'a>,
    /// Distance of the border from that of the area to be filled; positive
    /// inside the area.
    margin: Mm,
    /// Number of the layer.
    number: usize,
    /// Height of the layer's sample plane above the bed.
    z: Mm,
    density: Density<'a>,
    /// Spacing of parallel lines that would fill the plane.
    solid: Mm,
    /// The point that the pattern is laid out from.
    origin: DVec2,
    /// Direction of the pattern.
    angle: Degrees,
    /// Length of the shortest piece that is worth a travel.
    shortest: Mm,
}

/// A pattern's own coordinates.
#[derive(Clone, Copy, Debug)]
struct Frame {
    origin: DVec2,
    along: DVec2,
}

impl Frame {
    /// A point of the pattern in the plane.
    fn out(&self, p: DVec2) -> DVec2 {
        self.origin + self.along.rotate(p)
    }

    /// A direction in the pattern as a direction in the plane.
    fn along(&self, way: DVec2) -> DVec2 {
        self.along.rotate(way)
    }

    /// The box in the pattern around a box in the plane.
    fn bounds(&self, rect: Rect) -> Rect {
        let back = DVec2::new(self.along.x, -self.along.y);
        let inside = |p: DVec2| back.rotate(p - self.origin);
        Rect::around(&rect.corners().map(inside))
    }
}

impl Layer<'_> {
    fn frame(&self) -> Frame {
        Frame {
            origin: self.origin,
            along: DVec2::from_angle(self.angle.to_radians()),
        }
    }
}

/// A way to fill an area with lines. Its lines have places in the plane,
/// whatever the area is; `layer.origin` and `layer.angle` move
/// them.
trait Pattern: Send + Sync {
    /// The pattern's centre lines, cut at `layer.border`. [`families::lines`]
    /// makes and cuts straight lines; a
    /// [`Cutter`](isoslice_planar::border::Cutter) cuts any lines. The volume of
    /// the beads per area has to be `layer.density`, in the mean over layers.
    fn pieces(&self, layer: &Layer<'_>) -> Vec<LinePiece>;

    /// False if the pattern must have one density everywhere.
    /// `infill_density` may then not be a formula.
    fn can_vary(&self) -> bool {
        true
    }

    /// The longest way along the border over which two pieces are joined. The
    /// default is four times the mean spacing of parallel lines.
    fn reach(&self, layer: &Layer<'_>) -> Mm {
        4.0 * layer.solid / layer.density.mean()
    }
}

/// Why infill cannot be laid.
#[derive(Debug, thiserror::Error)]
pub enum InfillError {
    /// The pattern's text is not an expression.
    #[error("infill = \"expr: {text}\": {error}")]
    Expression {
        /// The pattern's text.
        text: String,
        /// What is wrong with it.
        error: ExpressionError,
    },
    /// The shape of the pattern cannot be read or run.
    #[error("infill = {name:?}: {error}")]
    Shape {
        /// The path of its script, or its formula.
        name: String,
        /// What is wrong with it.
        error: Box<LoadError>,
    },
    /// The expression cannot be evaluated.
    #[error("infill: {}{}", .0, remedy(.0))]
    Field(#[from] FieldError),
    /// The pattern has one density only.
    #[error(
        "infill = {pattern:?} cannot have a density that differs from place \
         to place: give infill_density a number, or use one of the other \
         patterns, such as gyroid or rectilinear"
    )]
    NotGraded {
        /// The pattern's word.
        pattern: &'static str,
    },
    /// The density's text is not an expression, or the expression has no value
    /// somewhere.
    #[error(transparent)]
    Density(#[from] QuantityError),
}

/// What the infill is made of.
enum InfillKind {
    Pattern(Box<dyn Pattern>),
    Shape(Shape),
}

/// Where the part is, in the layers' coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// The box around the part.
    pub part: Rect,
    /// Height of the part.
    pub height: Mm,
    /// By how much x and y in formulas are more than the coordinates of layers.
    pub origin: DVec2,
}

/// Passes on the operations of the infill's script, if it is one.
///
/// # Errors
/// If the script cannot be read or run.
pub fn script_words(
    infill: &isoslice_settings::Infill,
    tell: &mut dyn FnMut(&str),
) -> Result<(), InfillError> {
    let isoslice_settings::Infill::Script(path) = infill else {
        return Ok(());
    };
    let failed = |error| InfillError::Shape {
        name: path.clone(),
        error: Box::new(error),
    };
    let shape = load(&Source::File(path.into()), &[]).map_err(failed)?;
    operations(&shape.tree, tell).map_err(|error| {
        failed(LoadError::Expression {
            file: path.clone(),
            data: shape.files.clone(),
            error,
        })
    })
}

/// A part's sparse infill.
pub struct Infill<'a> {
    plan: InfillPlan,
    around: &'a Surroundings<'a>,
    kind: InfillKind,
    density: Quantity,
    origin: DVec2,
}

impl<'a> Infill<'a> {
    /// The infill of a plan.
    ///
    /// # Errors
    /// If a text is not an expression, if a script cannot be run, or if the
    /// pattern cannot have the density.
    pub fn new(
        plan: InfillPlan,
        around: &'a Surroundings<'a>,
        site: Site,
    ) -> Result<Infill<'a>, InfillError> {
        let density = Quantity::new("infill_density", &plan.density)?;
        let graded = density.constant().is_none();
        let kind = match &plan.pattern {
            isoslice_settings::Infill::Pattern(word) => {
                let pattern = pattern(*word, graded);
                if graded && !pattern.can_vary() {
                    return Err(InfillError::NotGraded {
                        pattern: word.name(),
                    });
                }
                InfillKind::Pattern(pattern)
            }
            isoslice_settings::Infill::Expression(text) => {
                InfillKind::Shape(Shape::of_formula(text, &site, plan.width)?)
            }
            isoslice_settings::Infill::Script(path) => {
                let source = Source::File(path.into());
                let width = plan.width;
                InfillKind::Shape(Shape::of_source(
                    &source, path, &site, width,
                )?)
            }
        };
        Ok(Infill {
            around,
            kind,
            density,
            origin: site.part.centre(),
            plan,
        })
    }

    /// Beads of a layer's sparse infill. `solid` is the layer's solid, which
    /// makes distances from the surface exact near it.
    ///
    /// Lines reach into the walls around the area by `infill_overlap` of their
    /// width, so their round ends overlap the wall's bead.
    ///
    /// # Errors
    /// If the density has no value somewhere, or an expression cannot be
    /// evaluated.
    pub fn beads(
        &self,
        sparse: &Area,
        span: &LayerSpan,
        solid: Option<&EdgeGrid>,
    ) -> Result<Vec<Bead>, InfillError> {
        let plan = &self.plan;
        let (width, height) = (plan.width, span.height());
        if sparse.is_empty() || plan.is_hollow() {
            return Ok(Vec::new());
        }
        let margin = width * (0.5 - plan.overlap / 100.0);
        let ends = offset(sparse, -margin, TOLERANCE);
        if ends.is_empty() && matches!(self.kind, InfillKind::Pattern(_)) {
            // No line fits in, and a density has no place to be asked for.
            return Ok(Vec::new());
        }
        let border = Border::new(&ends);
        let around = Around {
            surroundings: self.around,
            solid,
        };
        // The density setting does not apply to shapes: a shape's own function
        // gives its density.
        let even = match &self.kind {
            InfillKind::Pattern(_) => self.density.constant(),
            InfillKind::Shape(_) => Some(100.0),
        };
        let grading = match even {
            None => {
                Some(self.grading(border.bounds(), span.sample_z(), around)?)
            }
            Some(_) => None,
        };
        let layer = Layer {
            border: &border,
            margin,
            number: span.index,
            z: span.sample_z(),
            density: match (&grading, even) {
                (Some(grading), _) => Density::Graded(grading),
                (None, share) => Density::Even(share.unwrap_or(100.0) / 100.0),
            },
            solid: spacing(width, width, height),
            origin: self.origin,
            angle: plan.angle,
            shortest: width,
        };
        let bead = |stroke| Bead::new(Role::SparseInfill, stroke, height);
        let (pieces, reach) = match &self.kind {
            InfillKind::Pattern(pattern) => {
                (pattern.pieces(&layer), pattern.reach(&layer))
            }
            InfillKind::Shape(shape) if plan.solid => {
                let lines = shape.solid(sparse, &layer, around, height, plan);
                return Ok(lines?.into_iter().map(bead).collect());
            }
            InfillKind::Shape(shape) => {
                let lines = shape.lines(&layer, around, width)?;
                (lines, SHAPE_REACH * width)
            }
        };
        let pieces = pieces.into_iter().filter(|p| p.points.len() > 1);
        let joined = join::join(pieces.collect(), &border, reach);
        let beads = joined
            .into_iter()
            .map(|p| bead(Stroke::new(p.points, p.closed, width)));
        Ok(beads.collect())
    }

    /// The density over a box.
    fn grading(
        &self,
        bounds: Rect,
        z: Mm,
        around: Around<'_>,
    ) -> Result<Grading, QuantityError> {
        let measure = self.density.uses_depth();
        Grading::new(bounds, |points, out| {
            let mut places = Vec::with_capacity(points.len());
            let points = points.iter().copied();
            let Around {
                surroundings,
                solid,
            } = around;
            surroundings.places(points, z, measure, solid, &mut places)?;
            self.density.evaluate(&places, out)
        })
    }
}

/// Tolerance of the offset that lines end at, mm.
const TOLERANCE: Mm = 0.02;

/// Lines of an expression are joined over ways of this many widths, since their
/// spacing is not known.
const SHAPE_REACH: f64 = 20.0;

/// The pattern of a word.
fn pattern(kind: InfillPattern, graded: bool) -> Box<dyn Pattern> {
    let sheet = |surface: Surface| Box::new(Sheet::new(surface, graded));
    match kind {
        InfillPattern::Rectilinear => Box::new(rectilinear::Rectilinear),
        InfillPattern::Grid => Box::new(grid::Grid),
        InfillPattern::Triangles => Box::new(triangles::Triangles),
        InfillPattern::Hexagons => Box::new(hexagons::Hexagons),
        InfillPattern::Cubic => Box::new(cubic::Cubic),
        InfillPattern::Concentric => Box::new(concentric::Concentric),
        InfillPattern::Gyroid => sheet(gyroid::gyroid),
        InfillPattern::SchwarzP => sheet(schwarz_p::schwarz_p),
        InfillPattern::Diamond => sheet(diamond::diamond),
        InfillPattern::Neovius => sheet(neovius::neovius),
        InfillPattern::Lidinoid => sheet(lidinoid::lidinoid),
    }
}

#[cfg(test)]
mod tests;

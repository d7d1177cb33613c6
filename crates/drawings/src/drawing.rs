//! Drawings as functions: the distance in the plane.

use crate::area::{Area, MOST_CURVES};
use crate::curve::Curve;
use crate::outline::Outline;
use glam::{DAffine2, DAffine3, DVec2, DVec3};
use isocontour::{Bounds, Data, Rect, Ring, places};
use isoslice_base::problem::{NamedProblem, Problem};

/// Greatest coordinate of a drawing, mm.
const FARTHEST: f64 = 1e6;

/// What to do if a drawing of shapes has no area.
pub(crate) const FILL: &str = "fill its shapes";

/// The most bytes of a file.
pub const MOST_DRAWING_BYTES: usize = 1 << 25;

/// Refuses a file that is too large.
pub(crate) fn small_enough(bytes: &[u8]) -> Problem<()> {
    if bytes.len() > MOST_DRAWING_BYTES {
        return Err("it is larger than 32 MB; simplify it".into());
    }
    Ok(())
}

/// An area in the plane as a function of x and y, the same at all heights: the
/// distance to its border, mm, negative inside.
#[derive(Debug)]
pub struct Drawing {
    name: String,
    area: Area,
    warnings: Vec<String>,
}

impl Drawing {
    /// What is inside outlines, in mm. Those that come later are on top.
    ///
    /// # Errors
    /// If nothing is inside, if a coordinate is no number, or if there are too
    /// many outlines or too many places where they cross.
    pub fn new(
        name: &str,
        outlines: &[Outline],
    ) -> Result<Drawing, NamedProblem> {
        Drawing::warned(name.to_owned(), outlines, Vec::new(), FILL)
            .map_err(|problem| NamedProblem::new(name, problem))
    }

    /// As [`new`](Drawing::new), with warnings, and what to do if there is no area.
    pub(crate) fn warned(
        name: String,
        outlines: &[Outline],
        warnings: Vec<String>,
        no_area: &str,
    ) -> Problem<Drawing> {
        let mut closed = outlines.to_vec();
        closed.iter_mut().for_each(Outline::close);
        let count: usize = closed.iter().map(Outline::len).sum();
        if count > MOST_CURVES {
            return Err(format!(
                "it has {count} lines and curves, and {MOST_CURVES} are the \
                 most; simplify it (Inkscape: Path > Simplify)"
            ));
        }
        let is_near = |c: &Curve| c.is_within(FARTHEST);
        if !closed.iter().flat_map(|o| o.curves()).all(is_near) {
            return Err("a coordinate is no number, or beyond 1 km".into());
        }
        let area = Area::new(&closed)?;
        if area.bounds().size().min_element() <= 0.0 {
            let mut problem = format!("nothing in it is an area; {no_area}");
            for warning in warnings {
                problem += "; ";
                problem += &warning;
            }
            return Err(problem);
        }
        Ok(Drawing {
            name,
            area,
            warnings,
        })
    }

    /// What of the file is not part of the area, and why.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The lower left and the upper right corner of the box around the area,
    /// mm.
    pub fn bounds(&self) -> [DVec2; 2] {
        let Rect { min, max } = self.area.bounds();
        [min, max]
    }
}

impl Data for Drawing {
    fn name(&self) -> &str {
        &self.name
    }

    fn at(&self, p: DVec3) -> (f64, DVec3) {
        let (value, gradient) = self.area.at(p.truncate());
        (value, gradient.extend(0.0))
    }

    fn value(&self, p: DVec3) -> f64 {
        let p = p.truncate();
        let far = self.area.nearest(p, f64::INFINITY).far2.sqrt();
        if self.area.is_inside(p) { -far } else { far }
    }

    fn values(&self, at: [&[f32]; 3], out: &mut Vec<f32>) {
        // The last point and its value: no border is nearer than that.
        let (mut last, mut value) = (DVec2::ZERO, f64::NAN);
        for p in places(at) {
            let Some(p) = p.map(DVec3::truncate) else {
                out.push(f32::NAN);
                continue;
            };
            let moved = (p - last).length();
            if value.is_nan() {
                value = self.value(p.extend(0.0));
            } else if moved > 0.0 {
                // Nor is any farther than that and the way here.
                let most = (value.abs() + moved) * (1.0 + 1e-12) + 1e-12;
                let near = self.area.nearest(p, most * most).far2.sqrt();
                let inside = if moved * (1.0 + 1e-9) < value.abs() {
                    value < 0.0
                } else {
                    self.area.is_inside(p)
                };
                value = if inside { -near } else { near };
            }
            last = p;
            out.push(value as f32);
        }
    }

    fn range(&self, over: &Bounds) -> [f64; 2] {
        self.area.range(over.from_above())
    }

    fn slopes(&self, over: &Bounds) -> [[f64; 2]; 3] {
        let [x, y] = self.area.slopes(over.from_above());
        [x, y, [0.0; 2]]
    }

    fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        self.area.contents(tell);
    }

    fn is_flat(&self) -> bool {
        true
    }

    fn bytes(&self) -> usize {
        self.area.bytes()
    }

    fn has_section(&self) -> bool {
        true
    }

    /// It has one wherever x and y of the data depend on those of the place.
    fn section(&self, place: &DAffine3, z: f64) -> Option<Vec<Ring>> {
        let [x, y] = [place.x_axis, place.y_axis].map(|a| a.truncate());
        let at = place.z_axis * z + place.translation;
        let to_data = DAffine2::from_cols(x, y, at.truncate());
        let back = to_data.inverse();
        back.is_finite().then(|| self.area.rings(back)).flatten()
    }
}

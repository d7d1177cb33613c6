//! Values that are known at scattered places, as a function.
//!
//! Linear interpolation between scattered places is that of linear Shepard
//! functions: each sample has a plane through its value, fitted to its
//! [`FITTED`] nearest neighbours by least squares. The value at a place is the
//! mean of the planes of the [`WEIGHED`] nearest samples, with the weights
//! (1/d - 1/R)² (Franke and Little), where d is a sample's distance and R that
//! of the next sample. It goes through all samples, is smooth, and linear
//! functions come back exactly.

mod cells;
mod csv;
#[cfg(test)]
mod tests;
mod tree;
mod vtu;

use cells::Cells;
use glam::{DMat3, DVec3};
use isocontour::{Bounds, Data, places};
use isoslice_base::problem::{NamedProblem, Problem, go_on};
use isoslice_base::units::human_number;
use rayon::prelude::*;
use tree::{Near, Tree};

/// How many neighbours a sample's plane is fitted to.
const FITTED: usize = 16;

/// How many samples count at a place. A place amid a cube's corners has eight.
const WEIGHED: usize = 12;

/// Size of nodes that are taken as a whole, as a share of the distance within
/// which samples count.
const SMALL: f64 = 0.25;

/// How to go between scattered samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Between {
    /// The value of the nearest sample. It jumps.
    Nearest,
    /// Through all samples; linear functions come back exactly.
    #[default]
    Linear,
}

/// How samples are read.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplesOptions {
    /// The name of the column with the values, or how it begins; of a VTU file
    /// the name of the array, with the number of the component if it has
    /// several: `stress:2`. Without it, there has to be one column beside x, y,
    /// z and numbers of nodes, or one array.
    pub column: Option<String>,
    /// How many mm the file's unit of length has.
    pub unit_mm: f64,
    /// How to go between samples.
    pub between: Between,
}

impl Default for SamplesOptions {
    fn default() -> Self {
        SamplesOptions {
            column: None,
            unit_mm: 1.0,
            between: Between::Linear,
        }
    }
}

/// Scattered samples as a function of x, y and z; of x and y alone if the file
/// has no z.
#[derive(Debug)]
pub struct Samples {
    name: String,
    points: Vec<DVec3>,
    values: Vec<f64>,
    /// The slopes of the planes; none for the nearest.
    slopes: Vec<DVec3>,
    tree: Tree,
    /// What is known of the samples in each node of the tree.
    known: Vec<Known>,
    /// All samples are in the plane.
    flat: bool,
}

/// Ranges of samples' values and of their planes' slopes.
#[derive(Clone, Copy, Debug)]
struct Known {
    values: [f64; 2],
    slopes: [DVec3; 2],
}

impl Known {
    fn both(self, other: Known) -> Known {
        Known {
            values: [
                self.values[0].min(other.values[0]),
                self.values[1].max(other.values[1]),
            ],
            slopes: [
                self.slopes[0].min(other.slopes[0]),
                self.slopes[1].max(other.slopes[1]),
            ],
        }
    }

    /// The range of the planes over a box, of samples which are in another.
    fn over(&self, over: &Bounds, at: &Bounds) -> [f64; 2] {
        let mut range = self.values;
        let ways = [over.min - at.max, over.max - at.min];
        for axis in 0..3 {
            let mut most = [f64::INFINITY, f64::NEG_INFINITY];
            for slope in self.slopes {
                for way in ways {
                    let slope = slope[axis];
                    // Nothing times the infinite is nothing.
                    let rise =
                        if slope == 0.0 { 0.0 } else { slope * way[axis] };
                    most = [most[0].min(rise), most[1].max(rise)];
                }
            }
            range[0] += most[0];
            range[1] += most[1];
        }
        range
    }
}

/// What a reader returns.
struct Read {
    points: Vec<DVec3>,
    values: Vec<f64>,
    flat: bool,
}

impl Samples {
    /// Reads a CSV file: a sample a line, columns between commas, semicolons,
    /// tabs or spaces, with or without names in the first line. Or a VTU file:
    /// values at points, or at the centres of cells. Samples whose value is
    /// empty, NaN or infinite are left out.
    ///
    /// # Errors
    /// If the file is neither, or has no sample, or an option makes no sense.
    pub fn read(
        name: &str,
        bytes: &[u8],
        options: &SamplesOptions,
    ) -> Result<Samples, NamedProblem> {
        let read = if vtu::is(bytes) {
            vtu::read(bytes, options)
        } else {
            isoslice_base::encoding::text(bytes)
                .map_err(|e| e.to_string())
                .and_then(|text| csv::read(text, options))
        };
        read.and_then(|read| Samples::new(name, read, options))
            .map_err(|problem| NamedProblem::new(name, problem))
    }

    fn new(
        name: &str,
        read: Read,
        options: &SamplesOptions,
    ) -> Problem<Samples> {
        let Read {
            points,
            values,
            flat,
        } = read;
        if points.is_empty() || points.len() != values.len() {
            return Err(format!(
                "it has {} places and {} values; give as many of both, one at \
                 least",
                points.len(),
                values.len()
            ));
        }
        let unit = options.unit_mm;
        if !(1e-9..=1e9).contains(&unit) {
            let unit = human_number(unit);
            return Err(format!("its unit is {unit} mm; 1000 is a metre"));
        }
        let points: Vec<DVec3> = points.iter().map(|p| *p * unit).collect();
        let far = points
            .iter()
            .position(|p| !p.is_finite() || p.abs().max_element() > 1e9);
        let bad = values.iter().position(|v| v.is_nan() || v.abs() > 1e30);
        if let Some(i) = far.or(bad) {
            return Err(format!(
                "sample {} is {} at {}, which is no number or far too large",
                i + 1,
                values[i],
                points[i]
            ));
        }
        go_on()?;
        let (points, values) = once(&points, &values, options.between);
        let (tree, order) = Tree::new(&points);
        go_on()?;
        let sorted = |i: &u32| *i as usize;
        let points: Vec<DVec3> =
            order.iter().map(|i| points[sorted(i)]).collect();
        let values: Vec<f64> =
            order.iter().map(|i| values[sorted(i)]).collect();
        let slopes = match options.between {
            Between::Nearest => Vec::new(),
            Between::Linear => all_slopes(&points, &values, &tree)?,
        };
        let known = |i: usize| Known {
            values: [values[i]; 2],
            slopes: [slopes.get(i).copied().unwrap_or(DVec3::ZERO); 2],
        };
        let known = tree.summed(known, Known::both);
        Ok(Samples {
            name: format!("samples({name:?})"),
            known,
            points,
            values,
            slopes,
            tree,
            flat,
        })
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are none. There is always one.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The box around all samples, mm.
    pub fn bounds(&self) -> Bounds {
        let none = Bounds::new(DVec3::ZERO, DVec3::ZERO);
        self.tree.bounds().unwrap_or(none)
    }

    fn place(&self, p: DVec3) -> DVec3 {
        if self.flat { p.with_z(0.0) } else { p }
    }

    /// The value and the gradient of a sample's plane at a place.
    fn plane(&self, i: usize, p: DVec3) -> (f64, DVec3) {
        let slope = self.slopes.get(i).copied().unwrap_or(DVec3::ZERO);
        (self.values[i] + slope.dot(p - self.points[i]), slope)
    }

    /// The mean of some samples' planes.
    fn mean(&self, p: DVec3, of: &[(f64, usize)]) -> (f64, DVec3) {
        let share = 1.0 / of.len() as f64;
        of.iter().fold((0.0, DVec3::ZERO), |(v, s), (_, i)| {
            let (value, slope) = self.plane(*i, p);
            (v + share * value, s + share * slope)
        })
    }

    /// The value and its gradient by the nearest samples, the last of which
    /// only says how far the others count.
    fn weighed(&self, p: DVec3, near: &[(f64, usize)]) -> (f64, DVec3) {
        let same = near.partition_point(|(far2, _)| *far2 == 0.0);
        if same > 0 {
            return self.mean(p, &near[..same]);
        }
        // With all samples near, 1/R is nothing.
        let (counting, reach) = if near.len() > WEIGHED {
            let last = near[WEIGHED];
            (&near[..WEIGHED], Some(last))
        } else {
            (near, None)
        };
        // The length of a way, 1 / it, and the gradient of that.
        let inverse = |(far2, i): (f64, usize)| {
            let inverse = 1.0 / far2.sqrt();
            let slope = (self.points[i] - p) * inverse / far2;
            (inverse, slope)
        };
        let end = reach.map_or((0.0, DVec3::ZERO), inverse);
        let (mut sum, mut sum_slope) = (0.0, DVec3::ZERO);
        let (mut all, mut all_slope) = (0.0, DVec3::ZERO);
        // Weights as shares of the greatest, which may be any number.
        let scale = 1.0 / (inverse(near[0]).0 - end.0).max(f64::MIN_POSITIVE);
        for sample in counting {
            let (one, turn) = inverse(*sample);
            let root = (one - end.0).max(0.0) * scale;
            let weight = root * root;
            let weight_slope = 2.0 * root * scale * (turn - end.1);
            let (value, slope) = self.plane(sample.1, p);
            sum += weight;
            sum_slope += weight_slope;
            all += weight * value;
            all_slope += weight_slope * value + weight * slope;
        }
        let value = all / sum;
        let slope = (all_slope - value * sum_slope) / sum;
        if value.is_finite() && slope.is_finite() {
            (value, slope)
        } else {
            // All are equally far away.
            self.mean(p, near)
        }
    }
}

/// Places and values, each place once. Its value is the mean of those there, or
/// the first one if values are not to be mixed. The nearest samples of a place
/// would otherwise be any of those that lie on one another, and all of them be
/// looked at.
fn once(
    points: &[DVec3],
    values: &[f64],
    between: Between,
) -> (Vec<DVec3>, Vec<f64>) {
    // Adding 0 makes no difference but for -0.
    let key = |i: &usize| (points[*i] + 0.0).to_array().map(f64::to_bits);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.par_sort_unstable_by_key(|i| (key(i), *i));
    let mut kept: Vec<(usize, f64)> = order
        .chunk_by(|a, b| key(a) == key(b))
        .map(|same| {
            let first = values[same[0]];
            let value = match between {
                Between::Nearest => first,
                Between::Linear => mean_of(same.iter().map(|i| values[*i])),
            };
            (same[0], value)
        })
        .collect();
    kept.sort_unstable_by_key(|(i, _)| *i);
    kept.into_iter().map(|(i, v)| (points[i], v)).unzip()
}

fn mean_of(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// The slopes of all samples' planes.
fn all_slopes(
    points: &[DVec3],
    values: &[f64],
    tree: &Tree,
) -> Problem<Vec<DVec3>> {
    /// Samples after which it is asked whether to stop. They take some tens of
    /// milliseconds.
    const BLOCK: usize = 4096;
    let mut slopes = Vec::with_capacity(points.len());
    for from in (0..points.len()).step_by(BLOCK) {
        go_on()?;
        let block = from..points.len().min(from + BLOCK);
        let of = |i| slope(i, points, values, tree);
        slopes.par_extend(block.into_par_iter().map(of));
    }
    Ok(slopes)
}

/// The slope of the plane through a sample that is closest to its neighbours.
fn slope(i: usize, points: &[DVec3], values: &[f64], tree: &Tree) -> DVec3 {
    let mut near = Near::new(FITTED + 1);
    tree.near(points, points[i], &mut near);
    let far2 = near.points.last().map_or(0.0, |p| p.0);
    if far2 == 0.0 {
        return DVec3::ZERO;
    }
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (near2, j) in near.points {
        if near2 == 0.0 {
            continue;
        }
        // Near ones count more.
        let weight = 1.0 / near2;
        let way = points[j] - points[i];
        matrix +=
            DMat3::from_cols(way * way.x, way * way.y, way * way.z) * weight;
        right += way * (weight * (values[j] - values[i]));
    }
    // Across planes and lines of samples the slope is nothing.
    let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    let ridge = DMat3::from_diagonal(DVec3::splat(1e-9 * trace));
    let slope = (matrix + ridge).inverse() * right;
    if slope.is_finite() {
        slope
    } else {
        DVec3::ZERO
    }
}

impl Data for Samples {
    fn name(&self) -> &str {
        &self.name
    }

    fn at(&self, p: DVec3) -> (f64, DVec3) {
        let p = self.place(p);
        if self.slopes.is_empty() {
            let mut near = Near::new(1);
            self.tree.near(&self.points, p, &mut near);
            let i = near.points.first().map_or(0, |p| p.1);
            return (self.values[i], DVec3::ZERO);
        }
        let mut near = Near::new(WEIGHED + 1);
        self.tree.near(&self.points, p, &mut near);
        let (value, slope) = self.weighed(p, &near.points);
        (value, if self.flat { slope.with_z(0.0) } else { slope })
    }

    fn values(&self, at: [&[f32]; 3], out: &mut Vec<f32>) {
        let mut cells = Cells::new(&self.tree, &self.points, WEIGHED + 1);
        let mut value = |p| {
            if self.slopes.is_empty() {
                self.value(p) as f32
            } else {
                let p = self.place(p);
                self.weighed(p, &cells.near(p).points).0 as f32
            }
        };
        out.extend(places(at).map(|p| p.map_or(f32::NAN, &mut value)));
    }

    /// Values are means of samples' planes, so they are within those of all
    /// samples that may count in the box.
    fn range(&self, over: &Bounds) -> [f64; 2] {
        let over = if self.flat {
            Bounds::new(over.min.with_z(0.0), over.max.with_z(0.0))
        } else {
            *over
        };
        let centre = over.centre();
        let half = 0.5 * over.size().length();
        let most = if self.slopes.is_empty() {
            1
        } else {
            WEIGHED + 1
        };
        let far = if centre.is_finite() && half.is_finite() {
            self.tree.reach(&self.points, centre, half, most)
        } else {
            f64::INFINITY
        };
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        self.tree.each(|node, at, leaf| {
            let apart = (at.min - centre).max(centre - at.max);
            if far.is_finite() && apart.max(DVec3::ZERO).length() > far {
                return false;
            }
            // Small nodes say enough without the nodes in them.
            if leaf || at.size().length() < SMALL * far {
                let [a, b] = self.known[node].over(&over, at);
                range = [range[0].min(a), range[1].max(b)];
                return false;
            }
            true
        });
        let size = range[0].abs().max(range[1].abs());
        let by = if size.is_finite() { 1e-12 * size } else { 0.0 };
        [range[0] - by, range[1] + by]
    }

    /// Any, unless all samples that count have one value: near samples the
    /// weights change as fast as they like.
    fn slopes(&self, over: &Bounds) -> [[f64; 2]; 3] {
        let [a, b] = self.range(over);
        let same = b - a <= 4e-12 * a.abs().max(b.abs());
        let any = if same && self.slopes.is_empty() {
            [0.0; 2]
        } else {
            [f64::NEG_INFINITY, f64::INFINITY]
        };
        [any, any, if self.flat { [0.0; 2] } else { any }]
    }

    fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        tell(&[u8::from(self.flat), u8::from(self.slopes.is_empty())]);
        for (p, v) in self.points.iter().zip(&self.values) {
            p.to_array().iter().for_each(|c| tell(&c.to_le_bytes()));
            tell(&v.to_le_bytes());
        }
    }

    fn is_flat(&self) -> bool {
        self.flat
    }

    fn bytes(&self) -> usize {
        size_of_val(self.points.as_slice())
            + size_of_val(self.values.as_slice())
            + size_of_val(self.slopes.as_slice())
            + size_of_val(self.known.as_slice())
            + self.tree.bytes()
    }
}

//! Surfaces that repeat in all three directions, cut by the layer.
//!
//! A [`Surface`] is a function of the sines and cosines of x, y and z, one
//! period to a cell, and its zero set is printed. Since it repeats, the lines
//! of one cell are found, thinned, and copied. Lines that wind around the cell
//! go on from copy to copy, and only copies near the area's border are cut.
//!
//! **Density.** The length of the lines per area is c/cell. The constant c is a
//! property of the surface, measured when the pattern is made, over heights
//! spread through a period. So the mean of a period's layers has the density,
//! and single layers have more or less.
//!
//! **Where the density varies**, so does the size of the cells, in octaves:
//! each place lies between a surface and the surface with cells twice as large,
//! and gets the zero set of a mixture of their functions. How much of each is
//! needed follows from the length of the mixtures' lines, which is measured as
//! well. A mixture that changes slowly has a zero set without ends or steps.

use super::grading::Grading;
use super::{Density, Layer, Pattern};
use glam::DVec2;
use isocontour::level::{Curve, Lattice, thin, trace};
use isoslice_base::units::Mm;
use isoslice_planar::border::{Cutter, LinePiece};
use isoslice_planar::clusters::{Cluster, clusters};
use isoslice_planar::{Rect, path_length};
use std::f64::consts::TAU;

/// Sine and cosine of an angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    pub sin: f64,
    pub cos: f64,
}

impl Turn {
    pub(super) fn new(angle: f64) -> Turn {
        let (sin, cos) = angle.sin_cos();
        Turn { sin, cos }
    }

    /// Sine and cosine of twice the angle.
    pub(super) fn double(self) -> Turn {
        Turn {
            sin: 2.0 * self.sin * self.cos,
            cos: self.cos * self.cos - self.sin * self.sin,
        }
    }
}

/// The angles of x, y and z, a full turn to a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Angles {
    pub x: Turn,
    pub y: Turn,
    pub z: Turn,
}

/// A function that repeats in all three directions, and is zero on the surface.
pub(super) type Surface = fn(Angles) -> f64;

/// The pattern of a surface.
pub(super) struct Sheet {
    surface: Surface,
    /// Length of the lines per area, times the size of the cells.
    length: f64,
    /// How much of the coarser surface gives a density, for densities from the
    /// greatest of an octave to half of it, in even steps of the logarithm.
    mixtures: Vec<f64>,
    /// The nodes' angles.
    turns: Vec<Turn>,
}

/// Nodes along a cell.
const NODES: usize = 32;
/// Heights in a period at which lengths are measured.
const HEIGHTS: usize = 96;
/// Mixtures that are measured.
const MIXTURES: usize = 16;
/// Greatest distance of chords from the line: in mm, and as a share of a cell.
const CHORD: (Mm, f64) = (0.05, 0.01);
/// Distance of the nodes of a layer whose cells vary, as a share of the mean
/// distance of its lines where they are densest.
const FINE: f64 = 0.25;
/// Greatest number of nodes of a lattice for a layer whose cells vary.
const MOST_NODES: f64 = 2e6;
/// Nodes along the side of a block. Where cells are large, the function is
/// evaluated at the corners of blocks only, and interpolated between them.
const BLOCK: usize = 4;
/// Cells are large where their share of the greatest share is less than this:
/// they have as many blocks as the smallest cells have nodes.
const MANY: f64 = 1.0 / BLOCK as f64;
/// Where the density varies, a place that is to have less than this share is
/// left empty.
const LEAST: f64 = 0.01;

impl Sheet {
    /// The pattern; `graded` if its density varies.
    pub(super) fn new(surface: Surface, graded: bool) -> Self {
        let turns = (0..NODES)
            .map(|i| Turn::new(i as f64 * TAU / NODES as f64))
            .collect();
        let mut sheet = Sheet {
            surface,
            length: 0.0,
            mixtures: Vec::new(),
            turns,
        };
        let heights = (0..HEIGHTS).map(|k| (k as f64 + 0.5) / HEIGHTS as f64);
        let total: f64 = heights
            .flat_map(|z| sheet.cell(z * TAU))
            .map(|c| path_length(&unrolled(&c), false))
            .sum();
        // The period is 2π; the lines' length per area follows from one period.
        sheet.length = total / HEIGHTS as f64 / TAU;
        if graded {
            sheet.mixtures = sheet.measure_mixtures();
        }
        sheet
    }

    /// The lines of one cell, one turn wide.
    fn cell(&self, z: f64) -> Vec<Curve> {
        let z = Turn::new(z);
        let lattice = Lattice {
            origin: DVec2::ZERO,
            step: TAU / NODES as f64,
            size: [NODES, NODES],
            periodic: true,
        };
        let mut values = Vec::with_capacity(NODES * NODES);
        for &y in &self.turns {
            let row = self.turns.iter();
            values.extend(row.map(|&x| (self.surface)(Angles { x, y, z })));
        }
        trace(&lattice, &values, 2, &mut |points, out| {
            out.extend(points.iter().map(|p| {
                let (x, y) = (Turn::new(p.x), Turn::new(p.y));
                (self.surface)(Angles { x, y, z })
            }));
        })
    }

    /// The function of a mixture with the share `coarse` of the surface with
    /// cells twice as large, whose angles are `wide`.
    fn mixture(&self, coarse: f64, wide: Angles) -> f64 {
        let fine = Angles {
            x: wide.x.double(),
            y: wide.y.double(),
            z: wide.z.double(),
        };
        (1.0 - coarse) * (self.surface)(fine) + coarse * (self.surface)(wide)
    }

    /// For each density of an octave, the share of the coarser surface that
    /// gives a mixture with lines of the density's length.
    fn measure_mixtures(&self) -> Vec<f64> {
        const SIDE: usize = 2 * NODES;
        let lattice = Lattice {
            origin: DVec2::ZERO,
            step: TAU / SIDE as f64,
            size: [SIDE, SIDE],
            periodic: true,
        };
        let length = |coarse: f64| {
            let mut total = 0.0;
            for k in 0..HEIGHTS / 2 {
                let z = (k as f64 + 0.5) / (HEIGHTS / 2) as f64 * TAU;
                let z = Turn::new(z);
                let value = |p: DVec2| {
                    let (x, y) = (Turn::new(p.x), Turn::new(p.y));
                    self.mixture(coarse, Angles { x, y, z })
                };
                let values: Vec<f64> = (0..lattice.count())
                    .map(|n| value(lattice.node(n % SIDE, n / SIDE)))
                    .collect();
                let curves = trace(&lattice, &values, 2, &mut |points, out| {
                    out.extend(points.iter().map(|&p| value(p)));
                });
                let lengths = curves.iter().map(unrolled);
                total += lengths.map(|c| path_length(&c, false)).sum::<f64>();
            }
            total
        };
        let found: Vec<f64> = (0..=MIXTURES)
            .map(|k| length(k as f64 / MIXTURES as f64))
            .collect();
        // How far the logarithm of the length has come on the way from the
        // finer surface to the coarser one, made to rise all the way.
        let (first, last) = (found[0], found[MIXTURES]);
        let mut so_far: f64 = 0.0;
        let way: Vec<f64> = found
            .iter()
            .map(|f| {
                so_far = so_far.max((f / first).ln() / (last / first).ln());
                so_far
            })
            .collect();
        let invert = |w: f64| {
            let k = way.partition_point(|&v| v <= w).clamp(1, MIXTURES);
            let (a, b) = (way[k - 1], way[k]);
            let t = if b > a {
                ((w - a) / (b - a)).clamp(0.0, 1.0)
            } else {
                1.0
            };
            ((k - 1) as f64 + t) / MIXTURES as f64
        };
        (0..=4 * MIXTURES)
            .map(|k| invert(k as f64 / (4 * MIXTURES) as f64))
            .collect()
    }

    /// How much of the coarser surface is mixed in at a share of the way to it.
    fn coarse(&self, way: f64) -> f64 {
        let last = self.mixtures.len() - 1;
        let at = way.clamp(0.0, 1.0) * last as f64;
        let k = (at as usize).min(last - 1);
        let (a, b) = (self.mixtures[k], self.mixtures[k + 1]);
        a + (at - k as f64) * (b - a)
    }

    /// Copies of one cell's lines all over the area.
    fn even(&self, layer: &Layer<'_>, share: f64) -> Vec<LinePiece> {
        let cell = self.length * layer.solid / share;
        let frame = layer.frame();
        let bounds = frame.bounds(layer.border.bounds());
        let tolerance = CHORD.0.min(CHORD.1 * cell);
        let mut cutter = Cutter::new(layer.border);
        for curve in self.cell(layer.z / cell * TAU) {
            let one: Vec<DVec2> =
                unrolled(&curve).iter().map(|p| *p * (cell / TAU)).collect();
            let one = thin(&one, tolerance);
            let extent = Rect::around(&one);
            let low = ((bounds.min - extent.max) / cell).ceil();
            let high = ((bounds.max - extent.min) / cell).floor();
            let line: Vec<DVec2> = one.iter().map(|&p| frame.out(p)).collect();
            let extent = Rect::around(&line);
            // Copies that continue each other are drawn one after the other.
            let strand = Strand::new(curve.winding);
            let mut copies: Vec<(i64, i64, DVec2)> = Vec::new();
            for j in low.y as i64..=high.y as i64 {
                if isoslice_base::limits::is_stopped() {
                    break;
                }
                for i in low.x as i64..=high.x as i64 {
                    let by = DVec2::new(i as f64, j as f64) * cell;
                    let by = frame.along(by);
                    let there = extent.moved(by);
                    if there.meets(layer.border.bounds()) {
                        let (strand, number) = strand.place(i, j);
                        copies.push((strand, number, by));
                    }
                }
            }
            copies.sort_unstable_by_key(|c| (c.0, c.1));
            let mut last = None;
            let mut points: Vec<DVec2> = Vec::with_capacity(line.len());
            for (strand, number, by) in copies {
                if isoslice_base::limits::is_stopped() {
                    break;
                }
                let goes_on = last == Some((strand, number - 1))
                    && curve.winding != [0, 0];
                let skip = usize::from(goes_on);
                if !goes_on {
                    cutter.end();
                }
                last = Some((strand, number));
                points.clear();
                points.extend(line[skip..].iter().map(|p| *p + by));
                let there = extent.moved(by);
                match curve.winding {
                    [0, 0] => {
                        points.pop();
                        cutter.ring(&points, there);
                    }
                    _ => cutter.run(&points, there),
                }
            }
            cutter.end();
        }
        cutter.finish()
    }

    /// Lines of cells whose size varies.
    fn graded(&self, layer: &Layer<'_>, grading: &Grading) -> Vec<LinePiece> {
        if grading.most() < LEAST {
            return Vec::new();
        }
        let octaves = Octaves::new(self.length * layer.solid, grading.most());
        let mut pieces = Vec::new();
        for cluster in clusters(layer.border.area()) {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            let curves = self.curves(&cluster, layer, grading, &octaves);
            let made = cut(curves, layer, grading, octaves.finest);
            // The cluster's lattice reaches into the next cluster's box.
            let own = |p: &LinePiece| {
                p.points.first().is_some_and(|&p| cluster.has(p))
            };
            pieces.extend(made.into_iter().filter(own));
        }
        pieces
    }

    /// The lines of cells whose size varies, over a lattice as wide as a part
    /// of the area.
    fn curves(
        &self,
        cluster: &Cluster,
        layer: &Layer<'_>,
        grading: &Grading,
        octaves: &Octaves,
    ) -> Vec<Curve> {
        let (frame, most) = (layer.frame(), grading.most());
        let lattice = lattice_over(
            frame.bounds(cluster.bounds),
            FINE * layer.solid / most,
        );
        let xs = octaves.along(lattice.origin.x, &lattice, lattice.size[0]);
        let ys = octaves.along(lattice.origin.y, &lattice, lattice.size[1]);
        let zs = octaves.along(layer.z, &lattice, 1);
        let value = |i: usize, j: usize| {
            let share = grading.share(frame.out(lattice.node(i, j)));
            let (k, way) = octaves.place(share);
            let (x, y, z) = (xs[k][i], ys[k][j], zs[k][0]);
            self.mixture(self.coarse(way), Angles { x, y, z })
        };
        let fine = |i: usize, j: usize| {
            let p = frame.out(lattice.node(i, j));
            let reach = DVec2::splat(1.5 * BLOCK as f64 * lattice.step);
            let near = Rect::new(p - reach, p + reach);
            near.meets(cluster.bounds)
                && grading.share(p) > MANY * most
                && layer.border.touches(near)
        };
        let values = sample(lattice.size, &value, &fine);
        trace(&lattice, &values, 1, &mut |points, out| {
            out.extend(points.iter().map(|&q| {
                let (k, way) = octaves.place(grading.share(frame.out(q)));
                let (x, y) = (octaves.turn(q.x, k), octaves.turn(q.y, k));
                self.mixture(self.coarse(way), Angles { x, y, z: zs[k][0] })
            }));
        })
    }
}

/// The parts of curves that lie in a layer's area, where the density is not too
/// low for any. The finest cells are `finest` wide.
fn cut(
    curves: Vec<Curve>,
    layer: &Layer<'_>,
    grading: &Grading,
    finest: Mm,
) -> Vec<LinePiece> {
    let frame = layer.frame();
    let mut cutter = Cutter::new(layer.border);
    let tolerance = CHORD.0.min(CHORD.1 * finest / grading.most());
    let empty = |p: &DVec2| grading.share(*p) < LEAST;
    for curve in curves {
        let mut points: Vec<DVec2> =
            curve.points.iter().map(|&q| frame.out(q)).collect();
        if curve.closed && !points.iter().any(empty) {
            points.extend(points.first().copied());
            let mut points = thin(&points, tolerance);
            points.pop();
            cutter.line(&points, true);
            continue;
        }
        for part in points.split(empty) {
            cutter.line(&thin(part, tolerance), false);
        }
    }
    cutter.finish()
}

/// The octaves of cells' sizes that an area needs, counted upwards from the
/// finest cells.
struct Octaves {
    /// Width of the cells of the density 1, mm.
    finest: Mm,
    /// The first octave that is needed.
    first: f64,
    /// Number of octaves that are needed.
    count: usize,
}

impl Octaves {
    /// The octaves of an area whose greatest share is `most`.
    fn new(finest: Mm, most: f64) -> Octaves {
        let first = octave(most).floor();
        Octaves {
            finest,
            first,
            count: octave(LEAST) as usize + 1 - first as usize,
        }
    }

    /// The octave of a share, counted from the first, and how far the share is
    /// on the way to the next octave.
    fn place(&self, share: f64) -> (usize, f64) {
        let last = self.first + (self.count - 1) as f64;
        let at = octave(share);
        let k = at.floor().clamp(self.first, last);
        ((k - self.first) as usize, at - k)
    }

    /// The angle of a coordinate in the coarser cells of an octave, counted from
    /// the first.
    fn turn(&self, at: Mm, k: usize) -> Turn {
        let wide = self.finest * 2.0_f64.powf(self.first + k as f64 + 1.0);
        Turn::new(at / wide * TAU)
    }

    /// By octave the angles of a lattice's first `count` coordinates along an
    /// axis, which begin at `from`.
    fn along(
        &self,
        from: Mm,
        lattice: &Lattice,
        count: usize,
    ) -> Vec<Vec<Turn>> {
        let at = |i: usize| from + i as f64 * lattice.step;
        let of_octave = |k| (0..count).map(|i| self.turn(at(i), k)).collect();
        (0..self.count).map(of_octave).collect()
    }
}

/// Number of octaves by which the cells of a share are coarser than the finest.
fn octave(share: f64) -> f64 {
    -share.clamp(LEAST, 1.0).log2()
}

/// A lattice of whole blocks over a box. Its nodes are `step` apart, or more if
/// there would be too many.
fn lattice_over(bounds: Rect, step: Mm) -> Lattice {
    let extent = bounds.size();
    let step = step.max((extent.x * extent.y / MOST_NODES).sqrt());
    let origin = (bounds.min / step).floor() * step;
    let size = (bounds.max - origin) / step;
    Lattice {
        origin,
        step,
        size: [size.x, size.y]
            .map(|n| (n as usize + 2).div_ceil(BLOCK) * BLOCK + 1),
        periodic: false,
    }
}

impl Pattern for Sheet {
    fn pieces(&self, layer: &Layer<'_>) -> Vec<LinePiece> {
        match layer.density {
            Density::Even(share) => self.even(layer, share),
            Density::Graded(grading) => self.graded(layer, grading),
        }
    }

    fn reach(&self, layer: &Layer<'_>) -> Mm {
        1.5 * self.length * layer.solid / layer.density.mean()
    }
}

/// A function's values at the nodes of a lattice of whole blocks. They are
/// exact at the blocks' corners, and in blocks that have a corner where `fine`
/// is true.
fn sample(
    [nx, ny]: [usize; 2],
    value: &impl Fn(usize, usize) -> f64,
    fine: &impl Fn(usize, usize) -> bool,
) -> Vec<f64> {
    let mut values = vec![f64::NAN; nx * ny];
    let (bx, by) = ((nx - 1) / BLOCK, (ny - 1) / BLOCK);
    let mut exact = vec![false; (bx + 1) * (by + 1)];
    for j in 0..=by {
        for i in 0..=bx {
            let (x, y) = (i * BLOCK, j * BLOCK);
            values[y * nx + x] = value(x, y);
            exact[j * (bx + 1) + i] = fine(x, y);
        }
    }
    let is_fine = |i: usize, j: usize| {
        let k = j * (bx + 1) + i;
        exact[k] || exact[k + 1] || exact[k + bx + 1] || exact[k + bx + 2]
    };
    // The exact blocks come first, since blocks beside them take over their
    // values.
    for pass in [true, false] {
        for j in 0..by {
            for i in (0..bx).filter(|&i| is_fine(i, j) == pass) {
                let (x, y) = (i * BLOCK, j * BLOCK);
                let at = |u: usize, v: usize| (y + v) * nx + x + u;
                let corners = [(0, 0), (BLOCK, 0), (0, BLOCK), (BLOCK, BLOCK)]
                    .map(|(u, v)| values[at(u, v)]);
                for v in 0..=BLOCK {
                    for u in 0..=BLOCK {
                        let k = at(u, v);
                        if !values[k].is_nan() {
                            continue;
                        }
                        let (s, t) =
                            (u as f64 / BLOCK as f64, v as f64 / BLOCK as f64);
                        values[k] = if pass {
                            value(x + u, y + v)
                        } else {
                            let [a, b, c, d] = corners;
                            let low = a + s * (b - a);
                            low + t * (c + s * (d - c) - low)
                        };
                    }
                }
            }
        }
    }
    values
}

/// A closed curve's points with its end: its first point, moved by as many
/// periods as the curve winds.
fn unrolled(curve: &Curve) -> Vec<DVec2> {
    let mut points = curve.points.clone();
    let [x, y] = curve.winding.map(f64::from);
    let end = points.first().map(|p| *p + DVec2::new(x, y) * TAU);
    points.extend(end);
    points
}

/// Which copies of a winding line continue each other.
struct Strand {
    winding: [i64; 2],
    /// A way to the next strand.
    aside: [i64; 2],
}

impl Strand {
    fn new(winding: [i32; 2]) -> Strand {
        let [x, y] = winding.map(i64::from);
        // x·v − y·u = ±1, by Euclid's algorithm.
        let (mut a, mut b) = ((x, 1, 0), (y, 0, 1));
        while b.0 != 0 {
            let q = a.0.div_euclid(b.0);
            (a, b) = (b, (a.0 - q * b.0, a.1 - q * b.1, a.2 - q * b.2));
        }
        Strand {
            winding: [x, y],
            aside: [-a.2, a.1],
        }
    }

    /// The number of the strand of the copy at (i, j), and the copy's number
    /// along the strand.
    fn place(&self, i: i64, j: i64) -> (i64, i64) {
        let ([x, y], [u, v]) = (self.winding, self.aside);
        let det = x * v - y * u;
        if det == 0 {
            // The line does not wind.
            return (i, j);
        }
        ((x * j - y * i) / det, (i * v - j * u) / det)
    }
}

#[cfg(test)]
mod tests {
    use super::super::gyroid::gyroid;
    use super::super::schwarz_p::schwarz_p;
    use super::*;

    /// Length of the lines per area, times the cell, by the volume of a thin
    /// layer around the surface (the coarea formula), with no line traced.
    fn length_by_volume(surface: Surface) -> f64 {
        const N: usize = 1_000_000;
        const THIN: f64 = 0.05;
        // Points spread evenly through the cell, on no lattice (Roberts).
        let at = |n: usize, step: f64| (n as f64 * step).fract() * TAU;
        let value = |x: f64, y: f64, z: f64| {
            let [x, y, z] = [x, y, z].map(Turn::new);
            surface(Angles { x, y, z })
        };
        let mut sum = 0.0;
        for n in 0..N {
            let (x, y, z) =
                (at(n, 0.819_172_5), at(n, 0.671_043_6), at(n, 0.549_700_5));
            if value(x, y, z).abs() < THIN {
                let e = 1e-5;
                let u = value(x + e, y, z) - value(x - e, y, z);
                let v = value(x, y + e, z) - value(x, y - e, z);
                sum += DVec2::new(u, v).length() / (2.0 * e);
            }
        }
        sum / N as f64 / (2.0 * THIN) * TAU
    }

    #[test]
    fn the_length_is_that_of_the_surface() {
        use super::super::{diamond, lidinoid, neovius};
        fn check(surface: Surface) {
            let found = Sheet::new(surface, false).length;
            let expected = length_by_volume(surface);
            assert!(
                (found / expected - 1.0).abs() < 0.015,
                "{found} {expected}"
            );
        }
        check(gyroid);
        check(schwarz_p);
        check(diamond::diamond);
        check(neovius::neovius);
        check(lidinoid::lidinoid);
        // The gyroid is known to have an area of 3.09 per cell. If it faced all
        // directions alike, planes would cut it in lines of π/4 of that.
        let length = Sheet::new(gyroid, false).length;
        let expected = std::f64::consts::FRAC_PI_4 * 3.09;
        assert!((length / expected - 1.0).abs() < 0.02, "{length}");
    }

    #[test]
    fn strands_continue() {
        for winding in [[1, 0], [0, 1], [-1, 0], [1, 1], [2, -1], [3, 5]] {
            let strand = Strand::new(winding);
            let [x, y] = winding.map(i64::from);
            let (k, n) = strand.place(4, -7);
            assert_eq!(strand.place(4 + x, -7 + y), (k, n + 1));
            let [u, v] = strand.aside;
            let next = strand.place(4 + u, -7 + v);
            assert_eq!((next.0 - k).abs(), 1);
        }
    }

    #[test]
    fn mixtures_lead_from_one_octave_to_the_next() {
        let sheet = Sheet::new(gyroid, true);
        assert!(sheet.coarse(0.0) < 0.2);
        assert!(sheet.coarse(1.0) > 0.9);
        let steps: Vec<f64> = sheet.mixtures.clone();
        assert!(steps.windows(2).all(|s| s[0] <= s[1]));
    }
}

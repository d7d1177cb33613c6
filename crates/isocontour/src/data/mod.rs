//! Functions that are data, as leaves of expressions: meshes, drawings,
//! pictures, volumes.
//!
//! In: an object that implements [`Data`], and three expressions, the place at
//! which it is asked. Out: an expression, [`call`], that moves, turns, blends
//! and repeats with all others.
//!
//! ```text
//!        mix                 fidget knows no operation of our own. A call is
//!       ╱   ╲                written as `mix` of a variable of its own with
//!     mix    z(x, y, z)      the three coordinates. The variable stands for
//!    ╱   ╲                   the data. Nobody can make it but `call`, since
//!  mix    y(x, y, z)         fidget draws it at random, and nothing folds
//!  ╱ ╲                       what holds a variable into a constant.
//! var  x(x, y, z)
//! ```
//!
//! An expression does not keep its data alive. Whoever keeps the expression
//! keeps what [`data_of`] returns for it, too.

mod over;

pub(crate) use over::{range_over, slopes_over};

use crate::cuboid::Bounds;
use crate::grid::Grid;
use crate::plane::Ring;
use crate::tree::operands;
use fidget::context::{BinaryOpcode, Context, Node, Op, Tree, TreeOp};
use fidget::var::Var;
use glam::{DAffine3, DVec3};
use std::any::Any;
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::sync::{Arc, PoisonError, RwLock, Weak};

/// A function of three coordinates that is data.
///
/// It has the same values on any machine and on any thread.
pub trait Data: Any + Send + Sync {
    /// How messages name it, such as `mesh("part.stl")`.
    fn name(&self) -> &str;

    /// Its value at a place, and its gradient. It is a number wherever the
    /// coordinates are finite.
    fn at(&self, p: DVec3) -> (f64, DVec3);

    /// Its value at a place.
    fn value(&self, p: DVec3) -> f64 {
        self.at(p).0
    }

    /// Appends its values at places, each given by one number of the three
    /// lists, to `out`. Places that follow one another are often near to one
    /// another. Coordinates may be NaN or infinite; there, values are NaN.
    fn values(&self, at: [&[f32]; 3], out: &mut Vec<f32>) {
        let value = |p| self.value(p) as f32;
        out.extend(places(at).map(|p| p.map_or(f32::NAN, value)));
    }

    /// Two numbers between which all of its values in a box are. The box may be
    /// a point, flat, or infinite.
    fn range(&self, over: &Bounds) -> [f64; 2];

    /// For each axis two numbers between which all derivatives along it are, of
    /// all places in a box.
    fn slopes(&self, over: &Bounds) -> [[f64; 2]; 3];

    /// Tells all bytes on which its values depend. Two with equal bytes are one
    /// function.
    fn contents(&self, tell: &mut dyn FnMut(&[u8]));

    /// True if it does not depend on z.
    fn is_flat(&self) -> bool {
        false
    }

    /// The memory that it takes, in bytes.
    fn bytes(&self) -> usize;

    /// What of [its memory](Data::bytes) other data may share: the address by
    /// which it is known, and its size in bytes.
    fn shared(&self) -> Option<(usize, usize)> {
        None
    }

    /// The box around the places p where it is below zero at `place` of p, if
    /// it is known exactly.
    fn extent(&self, place: &DAffine3) -> Option<Bounds> {
        let _ = place;
        None
    }

    /// Points whose convex hull is that of the body, if such points are known.
    fn corners(&self) -> Option<&[DVec3]> {
        None
    }

    /// True if it has a [section](Data::section), wherever it is placed but for
    /// special cases. What never has one makes none of the work in vain that
    /// sections of others would be.
    fn has_section(&self) -> bool {
        false
    }

    /// Its exact section, if it has one: the rings around the places (x, y)
    /// where it is below zero at `place` of (x, y, z). They are closed and
    /// oriented, and may cross: inside is what they go round counter-clockwise
    /// once or more. At the height of a level face it is what is inside just
    /// above or just below.
    fn section(&self, place: &DAffine3, z: f64) -> Option<Vec<Ring>> {
        let _ = (place, z);
        None
    }

    /// Tells all parts of the surface where it has the value `level` that may meet a
    /// box, if that surface is known to consist of such parts: what has lower values
    /// begins and ends on them only. The box and the parts are in coordinates from
    /// which `place` leads to where the data is asked. Parts that are no border,
    /// since one side of them is like the other, may be among those. False if the
    /// parts are not known; what was told does not count then.
    fn facets(
        &self,
        place: &DAffine3,
        level: f64,
        over: &Bounds,
        tell: &mut dyn FnMut(Facet),
    ) -> bool {
        let _ = (place, level, over, tell);
        false
    }

    /// True if it knows where lines [cross](Data::crossings) its surface.
    fn has_crossings(&self) -> bool {
        false
    }

    /// Where lines go into the body, and out of it, if that is known exactly:
    /// sorted by line, then by depth. All lines begin outside.
    fn crossings(&self, lines: &Grid) -> Option<Vec<Crossing>> {
        let _ = lines;
        None
    }
}

/// Places of which three lists have the coordinates; none where one of these is NaN
/// or infinite.
pub fn places([x, y, z]: [&[f32]; 3]) -> impl Iterator<Item = Option<DVec3>> {
    x.iter().zip(y).zip(z).map(|((&x, &y), &z)| {
        let p = DVec3::new(x.into(), y.into(), z.into());
        p.is_finite().then_some(p)
    })
}

/// A part of a surface.
#[derive(Clone, Copy, Debug)]
pub enum Facet {
    /// A triangle, by its corners.
    Flat([DVec3; 3]),
    /// What is `radius` away from the places of a line, in directions of unit
    /// length that are the surface's normals there. With a radius below 0 it is the
    /// other way.
    Round {
        /// The ends of the line, which may be one place.
        line: [DVec3; 2],
        /// The radius.
        radius: f64,
        /// Two numbers between which the vertical parts of all directions are.
        up: [f64; 2],
        /// Some of the directions.
        ways: [DVec3; 3],
    },
}

/// A place where a line crosses the surface of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The number of the line, row by row of a grid.
    pub line: u32,
    /// The distance along the line, in samples.
    pub depth: f64,
    /// The gradient there: it leads out of the body.
    pub gradient: DVec3,
}

impl fmt::Debug for dyn Data {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Data of expressions that are in use, by the variables that stand for it.
static KNOWN: RwLock<Option<HashMap<Var, Weak<dyn Data>>>> = RwLock::new(None);

/// An expression: `data` at the place that three expressions say.
pub fn call(data: &Arc<dyn Data>, at: [Tree; 3]) -> Tree {
    let var = variable(data);
    let [x, y, z] = at;
    Tree::from(var).mix(x).mix(y).mix(z)
}

/// The variable that stands for some data.
fn variable(data: &Arc<dyn Data>) -> Var {
    let mut known = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
    let known = known.get_or_insert_default();
    known.retain(|_, data| data.strong_count() > 0);
    let weak = Arc::downgrade(data);
    let same = known.iter().find(|(_, d)| d.ptr_eq(&weak));
    if let Some((var, _)) = same {
        return *var;
    }
    let var = Var::new();
    known.insert(var, weak);
    var
}

/// The data for which a variable of an expression stands.
pub fn known(var: Var) -> Option<Arc<dyn Data>> {
    let known = KNOWN.read().unwrap_or_else(PoisonError::into_inner);
    known.as_ref()?.get(&var)?.upgrade()
}

/// The data of an expression, each once.
pub fn data_of(tree: &Tree) -> Vec<Arc<dyn Data>> {
    let mut found: HashMap<Var, Arc<dyn Data>> = HashMap::new();
    let mut order = Vec::new();
    let mut seen: HashSet<*const TreeOp> = HashSet::new();
    let mut todo: Vec<&TreeOp> = vec![tree];
    while let Some(op) = todo.pop() {
        if !seen.insert(op) {
            continue;
        }
        if let TreeOp::Input(var @ Var::V(_)) = op
            && !found.contains_key(var)
            && let Some(data) = known(*var)
        {
            order.push(data.clone());
            found.insert(*var, data);
        }
        todo.extend(operands(op));
    }
    order
}

/// A call of data.
pub struct Call {
    /// The data.
    pub data: Arc<dyn Data>,
    /// The place at which it is asked.
    pub at: [Node; 3],
}

/// The call that a node is, if it is one.
pub fn call_of(context: &Context, node: Node) -> Option<Call> {
    let mut left = node;
    let mut at = [node; 3];
    for place in at.iter_mut().rev() {
        let Some(Op::Binary(BinaryOpcode::Mix, a, b)) = context.get_op(left)
        else {
            return None;
        };
        (left, *place) = (*a, *b);
    }
    match context.get_op(left) {
        Some(Op::Input(var @ Var::V(_))) => {
            known(*var).map(|data| Call { data, at })
        }
        _ => None,
    }
}

//! Makes nodes of operations.
//!
//! In: an expression. Out: the text of its nodes, each after those that it needs.
//!
//! Most operations have a node of their own. The others are made of nodes that
//! have the same values:
//!
//! | operation | nodes |
//! |---|---|
//! | −a | 0 − a |
//! | 1 / a | 1 / a |
//! | a² | a · a |
//! | compare(a, b) | sign(a − b) |
//! | a mod b, never negative | mod(a, abs(b)) |
//! | not a | 0 < abs(a) ? 0 : 1 |
//! | a and b | 0 < abs(a) ? b : 0 |
//! | a or b | 0 < abs(a) ? a : b |
//!
//! The reader makes the operations of these nodes again.

use super::error::ExportError;
use super::mesh::mesh_of;
use super::picture::{self, sheets_of};
use crate::functions::graph::MOST_NODES;
use crate::functions::op;
use crate::leaves;
use fidget::context::{BinaryOpcode, Context, Node, Op, UnaryOpcode};
use fidget::var::Var;
use isocontour::{Call, Data, call_of, nodes_of};
use std::collections::HashMap;
use std::fmt::{self, Write};
use std::sync::Arc;

/// Nodes between two questions whether to go on.
const ASK: usize = 1 << 12;

/// A scalar output of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Output {
    /// A coordinate of the place.
    Axis(usize),
    /// The number of a constant.
    Value(usize),
    /// What a node makes of its inputs.
    Result(usize),
    /// The distance to a mesh.
    Distance(usize),
    /// The value of a picture.
    Red(usize),
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Output::Axis(k) => write!(f, "axes.{}", ["x", "y", "z"][k % 3]),
            Output::Value(n) => write!(f, "n{n}.value"),
            Output::Result(n) => write!(f, "n{n}.result"),
            Output::Distance(n) => write!(f, "n{n}.distance"),
            Output::Red(n) => write!(f, "n{n}.red"),
        }
    }
}

/// A function of nodes.
pub(super) struct Nodes {
    /// The elements of the nodes.
    pub text: String,
    /// The output that is the function's value.
    pub value: Output,
    /// The data that it asks for.
    pub resources: Vec<Resource>,
    /// The number that the next resource may have.
    pub next_id: usize,
}

/// Data that a function asks for.
pub(super) struct Resource {
    /// Its number. That of the function of a picture is the next one.
    pub id: usize,
    pub data: Arc<dyn Data>,
}

impl Nodes {
    /// The nodes of an expression. Its data is numbered from `first_id` on.
    pub(super) fn new(
        context: &Context,
        root: Node,
        first_id: usize,
    ) -> Result<Nodes, ExportError> {
        let mut writing = Writing {
            context,
            next_id: first_id,
            text: String::new(),
            count: 1,
            resources: Vec::new(),
            values: HashMap::new(),
            known: HashMap::new(),
        };
        writing.axes();
        let mut made: HashMap<Node, Output> = HashMap::new();
        let mut value = Output::Axis(0);
        for (i, node) in nodes_of(context, root).into_iter().enumerate() {
            if i % ASK == 0 {
                isoslice_base::limits::go_on()?;
            }
            value = writing.operation(node, &made)?;
            made.insert(node, value);
        }
        Ok(Nodes {
            text: writing.text,
            value,
            resources: writing.resources,
            next_id: writing.next_id,
        })
    }
}

struct Writing<'a> {
    context: &'a Context,
    next_id: usize,
    text: String,
    /// Number of nodes so far.
    count: usize,
    resources: Vec<Resource>,
    /// Constants, by their bits.
    values: HashMap<u32, Output>,
    /// Nodes by their kind and inputs, so that there is one of each.
    known: HashMap<(&'static str, Vec<Output>), Output>,
}

impl Writing<'_> {
    /// The output that an operation is.
    fn operation(
        &mut self,
        node: Node,
        made: &HashMap<Node, Output>,
    ) -> Result<Output, ExportError> {
        let of = |node: &Node| made.get(node).copied();
        if let Some(Call { data, at }) = call_of(self.context, node) {
            let [Some(x), Some(y), Some(z)] = at.map(|n| of(&n)) else {
                return Err(ExportError::Random);
            };
            return self.call(&data, [x, y, z]);
        }
        match self.context.get_op(node) {
            Some(Op::Input(Var::X)) => Ok(Output::Axis(0)),
            Some(Op::Input(Var::Y)) => Ok(Output::Axis(1)),
            Some(Op::Input(Var::Z)) => Ok(Output::Axis(2)),
            Some(Op::Const(c)) => self.value(c.0),
            Some(Op::Unary(op, a)) if let Some(a) = of(a) => self.unary(*op, a),
            Some(Op::Binary(op, a, b))
                if let (Some(a), Some(b)) = (of(a), of(b)) =>
            {
                self.binary(*op, a, b)
            }
            // A mixture of bits is a call of data, or a kind of chance.
            _ => Err(ExportError::Random),
        }
    }

    fn unary(
        &mut self,
        op: UnaryOpcode,
        a: Output,
    ) -> Result<Output, ExportError> {
        let kind = match op {
            UnaryOpcode::Abs => "abs",
            UnaryOpcode::Sqrt => "sqrt",
            UnaryOpcode::Floor => "floor",
            UnaryOpcode::Ceil => "ceil",
            UnaryOpcode::Round => "round",
            UnaryOpcode::Sin => "sin",
            UnaryOpcode::Cos => "cos",
            UnaryOpcode::Tan => "tan",
            UnaryOpcode::Asin => "arcsin",
            UnaryOpcode::Acos => "arccos",
            UnaryOpcode::Atan => "arctan",
            UnaryOpcode::Exp => "exp",
            UnaryOpcode::Ln => "log",
            UnaryOpcode::Square => return self.node("multiplication", &[a, a]),
            UnaryOpcode::Neg => {
                let zero = self.value(0.0)?;
                return self.node("subtraction", &[zero, a]);
            }
            UnaryOpcode::Recip => {
                let one = self.value(1.0)?;
                return self.node("division", &[one, a]);
            }
            UnaryOpcode::Not => {
                let [zero, one] = [self.value(0.0)?, self.value(1.0)?];
                return self.unless_zero(a, zero, one);
            }
            UnaryOpcode::Rand => return Err(ExportError::Random),
        };
        self.node(kind, &[a])
    }

    fn binary(
        &mut self,
        op: BinaryOpcode,
        a: Output,
        b: Output,
    ) -> Result<Output, ExportError> {
        let kind = match op {
            BinaryOpcode::Add => "addition",
            BinaryOpcode::Sub => "subtraction",
            BinaryOpcode::Mul => "multiplication",
            BinaryOpcode::Div => "division",
            BinaryOpcode::Atan => "arctan2",
            BinaryOpcode::Min => "min",
            BinaryOpcode::Max => "max",
            BinaryOpcode::Compare => {
                let difference = if b == self.value(0.0)? {
                    a
                } else {
                    self.node("subtraction", &[a, b])?
                };
                return self.node("sign", &[difference]);
            }
            BinaryOpcode::Mod => {
                let size = self.node("abs", &[b])?;
                return self.node("mod", &[a, size]);
            }
            BinaryOpcode::And => {
                let zero = self.value(0.0)?;
                return self.unless_zero(a, b, zero);
            }
            BinaryOpcode::Or => return self.unless_zero(a, a, b),
            BinaryOpcode::Mix => return Err(ExportError::Random),
        };
        self.node(kind, &[a, b])
    }

    /// `then` where `a` is not 0, else `other`.
    fn unless_zero(
        &mut self,
        a: Output,
        then: Output,
        other: Output,
    ) -> Result<Output, ExportError> {
        let zero = self.value(0.0)?;
        let size = self.node("abs", &[a])?;
        self.node("select", &[zero, size, then, other])
    }

    /// What data is at a place.
    fn call(
        &mut self,
        data: &Arc<dyn Data>,
        at: [Output; 3],
    ) -> Result<Output, ExportError> {
        if mesh_of(&**data).is_some() {
            let resource = self.resource(data, 1)?;
            let n = self.asked("mesh", at, ("mesh", &resource), "distance")?;
            return Ok(Output::Distance(n));
        }
        let Some(sheets) = sheets_of(&**data) else {
            return Err(ExportError::Data(data.name().to_owned()));
        };
        picture::check(data.name(), &sheets)?;
        let resource = self.resource(data, 2)?;
        let [u, v, w] = picture::rows(&sheets).map(|row| self.row(row, at));
        let (at, of) = ([u?, v?, w?], ("functionID", &*resource));
        Ok(Output::Red(self.asked("functioncall", at, of, "red")?))
    }

    /// The number of a node that asks a resource, whose input has a name, for what it
    /// is at a place.
    fn asked(
        &mut self,
        kind: &str,
        at: [Output; 3],
        (input, resource): (&str, &str),
        output: &str,
    ) -> Result<usize, ExportError> {
        let place = self.place(at)?;
        let n = self.next()?;
        put(
            &mut self.text,
            format_args!(
                "<i:{kind} identifier=\"n{n}\"><i:in><i:vectorref \
                 identifier=\"pos\" ref=\"{place}\"/><i:resourceref \
                 identifier=\"{input}\" ref=\"{resource}\"/></i:in><i:out>\
                 <i:scalar identifier=\"{output}\"/></i:out></i:{kind}>\n"
            ),
        );
        Ok(n)
    }

    /// A coordinate times each of three numbers, and a fourth.
    fn row(
        &mut self,
        [a, b, c, d]: [f32; 4],
        [x, y, z]: [Output; 3],
    ) -> Result<Output, ExportError> {
        let mut sum = None;
        for (factor, by) in [(a, x), (b, y), (c, z)] {
            if factor == 0.0 {
                continue;
            }
            let factor = self.value(factor)?;
            let term = self.node("multiplication", &[by, factor])?;
            sum = Some(match sum {
                None => term,
                Some(sum) => self.node("addition", &[sum, term])?,
            });
        }
        let offset = self.value(d)?;
        match sum {
            None => Ok(offset),
            Some(sum) => self.node("addition", &[sum, offset]),
        }
    }

    /// The vector of three coordinates.
    fn place(&mut self, at: [Output; 3]) -> Result<String, ExportError> {
        if at == [0, 1, 2].map(Output::Axis) {
            return Ok("inputs.pos".to_owned());
        }
        let n = self.next()?;
        self.element(
            n,
            "composevector",
            &at,
            "<i:vector identifier=\"result\"/>",
        );
        Ok(format!("n{n}.result"))
    }

    /// The number of the last of the resources that data takes.
    fn resource(
        &mut self,
        data: &Arc<dyn Data>,
        takes: usize,
    ) -> Result<String, ExportError> {
        let is_same = |r: &&Resource| Arc::ptr_eq(&r.data, data);
        let known = self.resources.iter().find(is_same).map(|r| r.id);
        let first = known.unwrap_or(self.next_id);
        if known.is_none() {
            if self.resources.len() >= leaves::MOST {
                return Err(ExportError::TooMuchData(leaves::MOST));
            }
            self.next_id += takes;
            self.resources.push(Resource {
                id: first,
                data: data.clone(),
            });
        }
        let id = first + takes - 1;
        let n = self.next()?;
        put(
            &mut self.text,
            format_args!(
                "<i:constresourceid identifier=\"n{n}\" value=\"{id}\"><i:out>\
                 <i:resourceid identifier=\"value\"/></i:out>\
                 </i:constresourceid>\n"
            ),
        );
        Ok(format!("n{n}.value"))
    }

    /// The node that takes the place apart.
    fn axes(&mut self) {
        self.text.push_str(
            "<i:decomposevector identifier=\"axes\"><i:in><i:vectorref \
             identifier=\"A\" ref=\"inputs.pos\"/></i:in><i:out>\
             <i:scalar identifier=\"x\"/><i:scalar identifier=\"y\"/>\
             <i:scalar identifier=\"z\"/></i:out></i:decomposevector>\n",
        );
    }

    /// A constant.
    fn value(&mut self, value: f32) -> Result<Output, ExportError> {
        if !value.is_finite() {
            return Err(ExportError::NotFinite(value));
        }
        if let Some(known) = self.values.get(&value.to_bits()) {
            return Ok(*known);
        }
        let n = self.next()?;
        put(
            &mut self.text,
            format_args!(
                "<i:constant identifier=\"n{n}\" value=\"{}\"><i:out>\
                 <i:scalar identifier=\"value\"/></i:out></i:constant>\n",
                Digits(value)
            ),
        );
        self.values.insert(value.to_bits(), Output::Value(n));
        Ok(Output::Value(n))
    }

    /// A node that makes a scalar of scalars.
    fn node(
        &mut self,
        kind: &'static str,
        inputs: &[Output],
    ) -> Result<Output, ExportError> {
        let key = (kind, inputs.to_vec());
        if let Some(known) = self.known.get(&key) {
            return Ok(*known);
        }
        let n = self.next()?;
        self.element(n, kind, inputs, "<i:scalar identifier=\"result\"/>");
        self.known.insert(key, Output::Result(n));
        Ok(Output::Result(n))
    }

    fn element(&mut self, n: usize, kind: &str, inputs: &[Output], out: &str) {
        let text = &mut self.text;
        put(text, format_args!("<i:{kind} identifier=\"n{n}\"><i:in>"));
        let names = op::inputs(kind).unwrap_or_default();
        for (name, input) in names.iter().zip(inputs) {
            put(
                text,
                format_args!(
                    "<i:scalarref identifier=\"{name}\" ref=\"{input}\"/>"
                ),
            );
        }
        put(
            text,
            format_args!("</i:in><i:out>{out}</i:out></i:{kind}>\n"),
        );
    }

    /// The number of the next node.
    fn next(&mut self) -> Result<usize, ExportError> {
        self.count += 1;
        if self.count > MOST_NODES {
            return Err(ExportError::TooLarge);
        }
        Ok(self.count - 1)
    }
}

/// Appends to a text.
fn put(text: &mut String, what: fmt::Arguments) {
    // Writing to a text cannot fail.
    let _ = text.write_fmt(what);
}

/// A number as few digits that both 32 and 64 bits read as the same number.
struct Digits(f32);

impl fmt::Display for Digits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let few = format!("{:?}", self.0);
        match few.parse::<f64>() {
            Ok(wide) if wide as f32 == self.0 => f.write_str(&few),
            _ => write!(f, "{:?}", f64::from(self.0)),
        }
    }
}

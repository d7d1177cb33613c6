//! Makes expressions of functions.

use super::Function;
use super::graph::{Graph, Link, Node};
use super::image::{Channel, ImageFunction};
use super::op;
use super::value::{Type, Value, number};
use fidget::context::Tree;
use isoslice_mesh::MeshError;
use std::collections::BTreeMap;

/// Greatest number of numbers that nodes make, in all functions of a file, each
/// once for each call.
const MOST_NUMBERS: usize = 500_000;
/// Greatest number of calls inside one another.
const DEEPEST: usize = 64;

/// Values by their names.
type Named = BTreeMap<String, Value>;

/// Data that functions ask for.
pub(crate) trait Leaves {
    /// The signed distance to the mesh of an object, at a place.
    fn mesh(&mut self, id: u32, at: [Tree; 3]) -> Result<Tree, MeshError>;

    /// A channel of a stack at u, v and w, from 0 to 65535.
    fn image(
        &mut self,
        image: &ImageFunction,
        channel: Channel,
        at: [Tree; 3],
    ) -> Result<Tree, MeshError>;
}

/// What functions may still take.
pub(crate) struct Budget(usize);

impl Budget {
    pub(crate) fn new() -> Budget {
        Budget(MOST_NUMBERS)
    }
}

/// The number of a resource: that of an input, or the node's own.
fn resource(node: &Node, given: &Named, input: &str) -> Option<u32> {
    match given.get(input) {
        Some(Value::Resource(id)) => Some(*id),
        _ => node.resource,
    }
}

/// Evaluates functions of a model file.
pub(crate) struct Evaluator<'a, L> {
    /// The functions of a model file, by their numbers.
    pub functions: &'a BTreeMap<u32, Function>,
    /// The name of the file.
    pub path: &'a str,
    pub leaves: &'a mut L,
    pub budget: &'a mut Budget,
    /// The functions that wait for what they call.
    open: Vec<u32>,
}

impl<'a, L: Leaves> Evaluator<'a, L> {
    pub(crate) fn new(
        functions: &'a BTreeMap<u32, Function>,
        path: &'a str,
        leaves: &'a mut L,
        budget: &'a mut Budget,
    ) -> Self {
        Evaluator {
            functions,
            path,
            leaves,
            budget,
            open: Vec::new(),
        }
    }

    /// A scalar output of a function of a place.
    pub(crate) fn channel(
        &mut self,
        id: u32,
        channel: &str,
        at: [Tree; 3],
    ) -> Result<Tree, MeshError> {
        let given = Named::from([("pos".to_owned(), Value::vector(at))]);
        let found = self.function(id, &given, &[channel])?;
        match found.get(channel).map(|v| (v.kind(), v.parts())) {
            Some((Type::Scalar, [tree])) => Ok(tree.clone()),
            Some(_) => Err(self.wrong(
                id,
                None,
                format!("its output {channel} is no scalar"),
            )),
            None => {
                Err(self.wrong(id, None, format!("it has no output {channel}")))
            }
        }
    }

    fn wrong(
        &self,
        id: u32,
        node: Option<&str>,
        what: impl Into<String>,
    ) -> MeshError {
        let path = self.path;
        let node = node.map(|n| format!(", node {n}")).unwrap_or_default();
        MeshError::at(format_args!("{path}, function {id}{node}"), what)
    }

    /// What a function gives. `wanted` are the outputs that are asked for.
    fn function(
        &mut self,
        id: u32,
        given: &Named,
        wanted: &[&str],
    ) -> Result<Named, MeshError> {
        let functions = self.functions;
        let Some(function) = functions.get(&id) else {
            return Err(self.wrong(
                id,
                None,
                "it is not there; functions of private extensions are not read",
            ));
        };
        if self.open.contains(&id) {
            return Err(self.wrong(id, None, "it calls itself"));
        }
        if self.open.len() >= DEEPEST {
            let what = format!("more than {DEEPEST} calls inside one another");
            return Err(self.wrong(id, None, what));
        }
        self.open.push(id);
        let made = match function {
            Function::Graph(graph) => self.graph(id, graph, given),
            Function::Image(image) => self.image(id, image, given, wanted),
        };
        self.open.pop();
        made
    }

    fn graph(
        &mut self,
        id: u32,
        graph: &Graph,
        given: &Named,
    ) -> Result<Named, MeshError> {
        let mut inputs = Named::new();
        for (name, kind) in &graph.inputs {
            match given.get(name) {
                Some(value) if value.kind() == *kind => {
                    inputs.insert(name.clone(), value.clone());
                }
                _ => {
                    let kind = kind.name();
                    let what =
                        format!("its input {name} is no {kind}, or missing");
                    return Err(self.wrong(id, None, what));
                }
            }
        }
        let given = &inputs;
        let order = graph
            .order()
            .map_err(|(node, what)| self.wrong(id, Some(&node), what))?;
        let mut made: BTreeMap<&str, Named> = BTreeMap::new();
        for name in order {
            isoslice_base::limits::go_on()?;
            let Some(node) = graph.nodes.get(name) else {
                continue;
            };
            let mut inputs = Named::new();
            for link in &node.inputs {
                let value = linked(link, given, &made)
                    .map_err(|what| self.wrong(id, Some(name), what))?;
                inputs.insert(link.name.clone(), value);
            }
            let outputs = self.node(id, name, node, &inputs)?;
            let count: usize =
                outputs.values().map(|v| v.parts().len().max(1)).sum();
            self.budget.0 = self.budget.0.saturating_sub(count);
            if self.budget.0 == 0 {
                let what = format!(
                    "the functions take more than {MOST_NUMBERS} operations"
                );
                return Err(self.wrong(id, Some(name), what));
            }
            made.insert(name, outputs);
        }
        let mut outputs = Named::new();
        for link in &graph.outputs {
            let value = linked(link, given, &made)
                .map_err(|what| self.wrong(id, None, what))?;
            outputs.insert(link.name.clone(), value);
        }
        Ok(outputs)
    }

    /// What a node gives, by the names of its outputs.
    fn node(
        &mut self,
        id: u32,
        name: &str,
        node: &Node,
        given: &Named,
    ) -> Result<Named, MeshError> {
        let input = |name: &&str| given.get(*name).cloned();
        let value = match node.kind.as_str() {
            "functioncall" => return self.call(id, name, node, given),
            "mesh" | "unsignedmesh" => self.distance(id, name, node, given)?,
            "constant" | "constvec" | "constmat" => {
                let parts: Vec<Tree> =
                    node.numbers.iter().map(|x| number(*x)).collect();
                let kind = match parts.len() {
                    1 => Type::Scalar,
                    3 => Type::Vector,
                    _ => Type::Matrix,
                };
                Value::Numbers(kind, parts)
            }
            "constresourceid" | "resourceid" => {
                Value::Resource(node.resource.unwrap_or_default())
            }
            kind => {
                let Some(names) = op::inputs(kind) else {
                    let what =
                        format!("{kind} is no kind of node that is known");
                    return Err(self.wrong(id, Some(name), what));
                };
                let found: Option<Vec<Value>> =
                    names.iter().map(input).collect();
                let made = found.and_then(|found| op::make(kind, &found));
                made.ok_or_else(|| {
                    let what = format!(
                        "{kind} needs {}, all of types that it takes",
                        names.join(", ")
                    );
                    self.wrong(id, Some(name), what)
                })?
            }
        };
        Ok(self::outputs(node, &value))
    }

    fn call(
        &mut self,
        id: u32,
        name: &str,
        node: &Node,
        given: &Named,
    ) -> Result<Named, MeshError> {
        let called = resource(node, given, "functionID");
        let called = called.ok_or_else(|| {
            self.wrong(id, Some(name), "it says no functionID to call")
        })?;
        let wanted: Vec<&str> =
            node.outputs.iter().map(|(name, _)| name.as_str()).collect();
        let outputs = self.function(called, given, &wanted)?;
        if let Some(absent) = wanted.iter().find(|w| !outputs.contains_key(**w))
        {
            let what = format!("function {called} has no output {absent}");
            return Err(self.wrong(id, Some(name), what));
        }
        Ok(outputs)
    }

    /// The distance to a mesh.
    fn distance(
        &mut self,
        id: u32,
        name: &str,
        node: &Node,
        given: &Named,
    ) -> Result<Value, MeshError> {
        let mesh = resource(node, given, "mesh");
        let at = given.get("pos").and_then(place);
        let (Some(mesh), Some(at)) = (mesh, at) else {
            let what = "it needs pos, a vector, and mesh, a resource";
            return Err(self.wrong(id, Some(name), what));
        };
        let distance = self.leaves.mesh(mesh, at);
        let distance = distance.map_err(|e| {
            e.within(&format!("{}, function {id}, node {name}", self.path))
        })?;
        Ok(Value::scalar(if node.kind == "mesh" {
            distance
        } else {
            distance.abs()
        }))
    }

    fn image(
        &mut self,
        id: u32,
        image: &ImageFunction,
        given: &Named,
        wanted: &[&str],
    ) -> Result<Named, MeshError> {
        let Some(at) = given.get("pos").and_then(place) else {
            return Err(self.wrong(id, None, "it needs pos, a vector"));
        };
        let by = number(image.scale / f64::from(u16::MAX));
        let mut channel = |channel: Channel| -> Result<Tree, MeshError> {
            let read = self.leaves.image(image, channel, at.clone())?;
            Ok(read * by.clone() + number(image.offset))
        };
        let mut outputs = Named::new();
        for name in wanted {
            let value = match Channel::of(name) {
                Some(of) => Value::scalar(channel(of)?),
                None if *name == "color" => Value::vector([
                    channel(Channel::Red)?,
                    channel(Channel::Green)?,
                    channel(Channel::Blue)?,
                ]),
                None => continue,
            };
            outputs.insert((*name).to_owned(), value);
        }
        Ok(outputs)
    }
}

fn place(value: &Value) -> Option<[Tree; 3]> {
    match (value.kind(), value.parts()) {
        (Type::Vector, [x, y, z]) => Some([x.clone(), y.clone(), z.clone()]),
        _ => None,
    }
}

/// The value that a link leads to.
fn linked(
    link: &Link,
    given: &Named,
    made: &BTreeMap<&str, Named>,
) -> Result<Value, String> {
    let all = match &link.node {
        None => Some(given),
        Some(node) => made.get(node.as_str()),
    };
    let node = link.node.as_deref().unwrap_or("inputs");
    let value = all.and_then(|all| all.get(&link.output));
    let Some(value) = value else {
        return Err(format!(
            "{} is linked to {node}.{}, which is no output",
            link.name, link.output
        ));
    };
    if value.kind() != link.kind {
        return Err(format!(
            "{} is a {}, and is linked to {node}.{}, a {}",
            link.name,
            link.kind.name(),
            link.output,
            value.kind().name()
        ));
    }
    Ok(value.clone())
}

/// A node's value by the names that the node gives to its outputs.
fn outputs(node: &Node, value: &Value) -> Named {
    let part = |name: &str| ["x", "y", "z"].iter().position(|p| *p == name);
    let is_parts = node.kind == "decomposevector";
    let named = node.outputs.iter().filter_map(|(name, _)| {
        let value = if is_parts {
            Value::scalar(value.parts().get(part(name)?)?.clone())
        } else {
            value.clone()
        };
        Some((name.clone(), value))
    });
    named.collect()
}

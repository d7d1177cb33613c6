//! Nodes and their links, as files have them, and their order.

use super::value::Type;
use crate::xml::Element;
use isoslice_mesh::MeshError;
use std::collections::BTreeMap;

/// Greatest number of nodes in a function.
pub(crate) const MOST_NODES: usize = 200_000;
/// Greatest number of inputs or outputs of a function or a node.
const MOST_LINKS: usize = 1000;
/// The name that stands for the function's own inputs.
const INPUTS: &str = "inputs";

/// A link: the name of an input, and the output that it is from.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    pub name: String,
    pub kind: Type,
    /// The node. None for the function's own inputs.
    pub node: Option<String>,
    pub output: String,
}

#[derive(Debug, Default)]
pub(crate) struct Node {
    /// The name of its element.
    pub kind: String,
    pub inputs: Vec<Link>,
    pub outputs: Vec<(String, Type)>,
    /// The numbers of a constant.
    pub numbers: Vec<f64>,
    /// The function or mesh that a constant names.
    pub resource: Option<u32>,
}

/// A function of nodes.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    pub inputs: Vec<(String, Type)>,
    pub nodes: BTreeMap<String, Node>,
    pub outputs: Vec<Link>,
}

/// Where the elements of a function or a node are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    In,
    Out,
}

/// Reads a function.
#[derive(Debug, Default)]
pub(crate) struct Reading {
    graph: Graph,
    node: Option<(String, Node)>,
    side: Option<Side>,
}

impl Reading {
    /// Reads an element of the function.
    pub(crate) fn see(&mut self, element: &Element) -> Result<(), MeshError> {
        match (element.name(), self.side) {
            ("in", None) => self.side = Some(Side::In),
            ("out", None) => self.side = Some(Side::Out),
            (_, None) if self.node.is_none() => return self.begin(element),
            (name, Some(side)) => {
                let kind = Type::of(name).ok_or_else(|| {
                    element.wrong(format!("{name} is no type of values"))
                })?;
                return self.value(element, kind, side);
            }
            (name, None) => {
                return Err(element.wrong(format!("{name} inside a node")));
            }
        }
        Ok(())
    }

    /// Reads the end of an element. Returned: the function, if it ended.
    pub(crate) fn end(&mut self, name: &str) -> Option<Graph> {
        match name {
            "in" | "out" => self.side = None,
            "implicitfunction" => return Some(std::mem::take(&mut self.graph)),
            _ if self.side.is_none() => {
                self.graph.nodes.extend(self.node.take());
            }
            _ => {}
        }
        None
    }

    fn begin(&mut self, element: &Element) -> Result<(), MeshError> {
        let name = element.required("identifier")?;
        if name == INPUTS || name == "outputs" {
            return Err(element.wrong(format!("no node may be named {name}")));
        }
        if self.graph.nodes.contains_key(&name) {
            return Err(element.wrong(format!("a second node {name}")));
        }
        if self.graph.nodes.len() >= MOST_NODES {
            return Err(element
                .wrong(format!("more than {MOST_NODES} nodes in a function")));
        }
        let node = Node {
            kind: element.name().to_owned(),
            numbers: numbers(element)?,
            resource: resource(element)?,
            ..Node::default()
        };
        self.node = Some((name, node));
        Ok(())
    }

    fn value(
        &mut self,
        element: &Element,
        kind: Type,
        side: Side,
    ) -> Result<(), MeshError> {
        let name = element.required("identifier")?;
        let graph = &mut self.graph;
        let count = match (&mut self.node, side) {
            (None, Side::In) => {
                graph.inputs.push((name, kind));
                graph.inputs.len()
            }
            (None, Side::Out) => {
                graph.outputs.push(link(element, name, kind)?);
                graph.outputs.len()
            }
            (Some((_, node)), Side::In) => {
                node.inputs.push(link(element, name, kind)?);
                node.inputs.len()
            }
            (Some((_, node)), Side::Out) => {
                node.outputs.push((name, kind));
                node.outputs.len()
            }
        };
        if count > MOST_LINKS {
            return Err(element.wrong("more inputs or outputs than a node has"));
        }
        Ok(())
    }
}

fn link(
    element: &Element,
    name: String,
    kind: Type,
) -> Result<Link, MeshError> {
    let from = element.required("ref")?;
    let Some((node, output)) = from.split_once('.') else {
        return Err(element.wrong(format!(
            "{from:?} is no output; outputs are named node.output"
        )));
    };
    Ok(Link {
        name,
        kind,
        node: (node != INPUTS).then(|| node.to_owned()),
        output: output.to_owned(),
    })
}

/// The numbers of a constant.
fn numbers(element: &Element) -> Result<Vec<f64>, MeshError> {
    let names: &[&str] = match element.name() {
        "constant" => &["value"],
        "constvec" => &["x", "y", "z"],
        "constmat" => &["matrix"],
        _ => return Ok(Vec::new()),
    };
    let mut numbers = Vec::new();
    for name in names {
        for word in element.required(name)?.split_whitespace().take(17) {
            let number = word.parse().ok().filter(|x: &f64| x.is_finite());
            numbers.push(number.ok_or_else(|| {
                element.wrong(format!("the attribute {name} is no number"))
            })?);
        }
    }
    let count = if names == ["matrix"] { 16 } else { names.len() };
    if numbers.len() != count {
        return Err(element.wrong(format!(
            "it has {} numbers, and needs {count}",
            numbers.len()
        )));
    }
    Ok(numbers)
}

/// What a constant, or a node of an earlier draft, names.
fn resource(element: &Element) -> Result<Option<u32>, MeshError> {
    let is_constant =
        matches!(element.name(), "constresourceid" | "resourceid");
    for (name, counts) in [
        ("value", is_constant),
        ("resourceid", is_constant),
        ("objectid", true),
        ("functionid", true),
    ] {
        if counts && element.text(name)?.is_some() {
            return element.number(name).map(Some);
        }
    }
    if is_constant {
        return Err(element.absent("value"));
    }
    Ok(None)
}

impl Graph {
    /// The nodes that the outputs need, each after those that it needs.
    ///
    /// # Errors
    /// A node, and what is wrong with it.
    pub(crate) fn order(&self) -> Result<Vec<&str>, (String, String)> {
        let mut order = Vec::new();
        // False while what a node needs is looked at.
        let mut done: BTreeMap<&str, bool> = BTreeMap::new();
        let roots = self.outputs.iter().rev();
        let mut todo: Vec<(&str, bool)> = roots
            .filter_map(|link| Some((link.node.as_deref()?, false)))
            .collect();
        while let Some((name, is_ready)) = todo.pop() {
            if is_ready {
                done.insert(name, true);
                order.push(name);
                continue;
            }
            match done.get(name) {
                Some(true) => continue,
                Some(false) => {
                    let what = "it needs its own output";
                    return Err((name.to_owned(), what.to_owned()));
                }
                None => {}
            }
            let Some(node) = self.nodes.get(name) else {
                let what = "it is named, and is not there";
                return Err((name.to_owned(), what.to_owned()));
            };
            done.insert(name, false);
            todo.push((name, true));
            let needs = node.inputs.iter().rev();
            let needs = needs.filter_map(|link| link.node.as_deref());
            todo.extend(needs.map(|name| (name, false)));
        }
        Ok(order)
    }
}

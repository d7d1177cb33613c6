//! Functions of nodes, each kind against numbers made without them.

use super::*;
use crate::functions::evaluate::{Budget, Evaluator, Leaves};
use crate::functions::image::{Channel, ImageFunction};
use crate::model;
use crate::package::Package;
use fidget::context::Tree;
use glam::{DMat4, DVec4};

/// Functions that ask for no data.
struct Nothing;

impl Leaves for Nothing {
    fn mesh(&mut self, _: u32, _: [Tree; 3]) -> Result<Tree, MeshError> {
        Err(MeshError::Empty)
    }

    fn image(
        &mut self,
        _: &ImageFunction,
        _: Channel,
        _: [Tree; 3],
    ) -> Result<Tree, MeshError> {
        Err(MeshError::Empty)
    }
}

/// A node. Links and outputs are written `scalar:A=pos.x` and `scalar:result`.
pub(super) fn node(kind: &str, name: &str, links: &str, outs: &str) -> String {
    let ins: String = links
        .split_whitespace()
        .map(|link| {
            let (of, rest) = link.split_once(':').unwrap();
            let (input, from) = rest.split_once('=').unwrap();
            format!("<i:{of}ref identifier=\"{input}\" ref=\"{from}\"/>")
        })
        .collect();
    let outs: String = outs
        .split_whitespace()
        .map(|out| {
            let (of, name) = out.split_once(':').unwrap();
            format!("<i:{of} identifier=\"{name}\"/>")
        })
        .collect();
    let element = kind.split_whitespace().next().unwrap();
    format!(
        "<i:{kind} identifier=\"{name}\"><i:in>{ins}</i:in><i:out>{outs}\
         </i:out></i:{element}>"
    )
}

/// A function of a place with a scalar output, `shape`.
pub(super) fn function(id: u32, nodes: &str, shape: &str) -> String {
    let pos = node(
        "decomposevector",
        "p",
        "vector:A=inputs.pos",
        "scalar:x scalar:y scalar:z",
    );
    format!(
        "<i:implicitfunction id=\"{id}\"><i:in><i:vector identifier=\"pos\"/>\
         </i:in>{pos}{nodes}<i:out><i:scalarref identifier=\"shape\" \
         ref=\"{shape}\"/></i:out></i:implicitfunction>"
    )
}

fn tree_of(functions: &str) -> Result<Tree, MeshError> {
    let bytes = package(&model("millimeter", functions, ""));
    let mut package = Package::open(Cursor::new(&bytes)).unwrap();
    let model = model::read(&mut package, ROOT)?;
    let mut budget = Budget::new();
    let (x, y, z) = Tree::axes();
    Evaluator::new(&model.functions, ROOT, &mut Nothing, &mut budget).channel(
        1,
        "shape",
        [x, y, z],
    )
}

/// Compares a function with numbers at places from −size to size.
#[track_caller]
fn is(functions: &str, size: f64, of: impl Fn(DVec3) -> f64, count: usize) {
    let tree = tree_of(functions).unwrap();
    let mut rng = fastrand::Rng::with_seed(3);
    let at = [0; 3].map(|_| -> Vec<f32> {
        (0..count)
            .map(|_| (size * (2.0 * rng.f64() - 1.0)) as f32)
            .collect()
    });
    let mut found = Vec::new();
    let values = Values::new(&tree, None).unwrap();
    values.at(&[&at[0], &at[1], &at[2]], &mut found).unwrap();
    let mut compared = 0;
    for i in 0..count {
        let p = DVec3::from_array([0, 1, 2].map(|k| f64::from(at[k][i])));
        let (found, wanted) = (f64::from(found[i]), of(p));
        if wanted.is_finite() {
            compared += 1;
            let off = (found - wanted).abs();
            assert!(off <= 1e-5 * (1.0 + wanted.abs()), "{p} {found} {wanted}");
        } else {
            assert!(!found.is_finite(), "{p} {found} {wanted}");
        }
    }
    assert!(compared > count / 3, "{compared}");
}

const COUNT: usize = 100_000;

#[test]
fn nodes_of_numbers_are_right() {
    type Of = fn(DVec3) -> f64;
    let cases: &[(&str, &str, f64, Of)] = &[
        ("addition", "A B", 9.0, |p| p.x + p.y),
        ("subtraction", "A B", 9.0, |p| p.x - p.y),
        ("multiplication", "A B", 9.0, |p| p.x * p.y),
        ("division", "A B", 9.0, |p| p.x / p.y),
        ("sin", "A", 9.0, |p| p.x.sin()),
        ("cos", "A", 9.0, |p| p.x.cos()),
        ("tan", "A", 1.4, |p| p.x.tan()),
        ("arcsin", "A", 1.3, |p| p.x.asin()),
        ("arccos", "A", 1.3, |p| p.x.acos()),
        ("arctan", "A", 9.0, |p| p.x.atan()),
        ("arctan2", "A B", 9.0, |p| p.x.atan2(p.y)),
        ("min", "A B", 9.0, |p| p.x.min(p.y)),
        ("max", "A B", 9.0, |p| p.x.max(p.y)),
        ("abs", "A", 9.0, |p| p.x.abs()),
        ("fmod", "A B", 9.0, |p| p.x % p.y),
        ("mod", "A B", 9.0, |p| p.x - p.y * (p.x / p.y).floor()),
        ("pow", "A B", 3.0, |p| p.x.powf(p.y)),
        ("sqrt", "A", 9.0, |p| p.x.sqrt()),
        ("exp", "A", 9.0, |p| p.x.exp()),
        ("log", "A", 9.0, |p| p.x.ln()),
        ("log2", "A", 9.0, |p| p.x.log2()),
        ("log10", "A", 9.0, |p| p.x.log10()),
        ("cosh", "A", 5.0, |p| p.x.cosh()),
        ("sinh", "A", 5.0, |p| p.x.sinh()),
        ("tanh", "A", 60.0, |p| p.x.tanh()),
        ("round", "A", 9.0, |p| p.x.round()),
        ("ceil", "A", 9.0, |p| p.x.ceil()),
        ("floor", "A", 9.0, |p| p.x.floor()),
        ("sign", "A", 9.0, |p| p.x.signum()),
        ("fract", "A", 9.0, |p| p.x - p.x.floor()),
        ("clamp", "A min max", 9.0, |p| p.y.max(p.x.min(p.z))),
        (
            "select",
            "A B C D",
            9.0,
            |p| if p.x < p.y { p.z } else { p.y },
        ),
    ];
    for (kind, inputs, size, of) in cases {
        let from = ["p.x", "p.y", "p.z", "p.y"];
        let links: Vec<String> = inputs
            .split(' ')
            .zip(from)
            .map(|(name, from)| format!("scalar:{name}={from}"))
            .collect();
        let nodes = node(kind, "n", &links.join(" "), "scalar:result");
        is(&function(1, &nodes, "n.result"), *size, of, COUNT);
        if *kind == "pow" {
            continue;
        }
        // The same of vectors and matrices, whose parts are moved round.
        let turned = |name: &str, i: usize| {
            let link = |k: usize| from[(i + k) % 3];
            node(
                "composevector",
                name,
                &format!(
                    "scalar:x={} scalar:y={} scalar:z={}",
                    link(0),
                    link(1),
                    link(2)
                ),
                "vector:result",
            )
        };
        let names: Vec<&str> = inputs.split(' ').collect();
        let mut vectors = String::new();
        let mut links = String::new();
        for (i, name) in names.iter().enumerate() {
            vectors += &turned(&format!("v{i}"), if i == 3 { 1 } else { i });
            links += &format!("vector:{name}=v{i}.result ");
        }
        vectors += &node(kind, "n", &links, "vector:result");
        vectors += &node(
            "decomposevector",
            "d",
            "vector:A=n.result",
            "scalar:x scalar:y scalar:z",
        );
        let last = function(1, &vectors, "d.z");
        is(&last, *size, |p| of(DVec3::new(p.z, p.x, p.y)), 1000);
    }
}

#[test]
fn undefined_inputs_that_are_not_selected_do_no_harm() {
    let nodes = node("log", "l", "scalar:A=p.x", "scalar:result")
        + &node("constant value=\"0\"", "o", "", "scalar:value")
        + &node(
            "select",
            "n",
            "scalar:A=p.x scalar:B=o.value scalar:C=p.y scalar:D=l.result",
            "scalar:result",
        );
    let of = |p: DVec3| if p.x < 0.0 { p.y } else { p.x.ln() };
    is(&function(1, &nodes, "n.result"), 5.0, of, COUNT);
}

#[test]
fn powers_of_negative_numbers_are_right() {
    for (text, exponent) in [("3", 3.0), ("-2", -2.0), ("0.5", 0.5)] {
        let constant = format!("constant value=\"{text}\"");
        let nodes = node(&constant, "c", "", "scalar:value")
            + &node("pow", "n", "scalar:A=p.x scalar:B=c.value", "scalar:r");
        let of = |p: DVec3| p.x.powf(exponent);
        is(&function(1, &nodes, "n.r"), 4.0, of, COUNT);
    }
}

/// The 16 numbers of a matrix of a place.
fn elements(p: DVec3) -> [f64; 16] {
    let v = [p.x, p.y, p.z, 1.0, 2.0];
    std::array::from_fn(|i| {
        v[(i * 7 + i / 4) % 5] + f64::from(i % 5 == 0) * 9.0
    })
}

/// Nodes that make that matrix, `m`.
fn matrix() -> String {
    let mut nodes = node("constant value=\"1\"", "one", "", "scalar:value")
        + &node("constant value=\"2\"", "two", "", "scalar:value")
        + &node("constant value=\"9\"", "nine", "", "scalar:value");
    let names = ["p.x", "p.y", "p.z", "one.value", "two.value"];
    let mut links = String::new();
    for i in 0..16 {
        let from = names[(i * 7 + i / 4) % 5];
        let from = if i % 5 == 0 {
            let sum = format!("scalar:A={from} scalar:B=nine.value");
            nodes += &node("addition", &format!("e{i}"), &sum, "scalar:r");
            format!("e{i}.r")
        } else {
            from.to_owned()
        };
        links += &format!("scalar:m{}{}={from} ", i / 4, i % 4);
    }
    nodes + &node("composematrix", "m", &links, "matrix:result")
}

/// Nodes that add up what a matrix makes of the place, weighted.
fn probe(from: &str) -> String {
    node(
        "matvecmultiplication",
        "mv",
        &format!("matrix:A={from} vector:B=inputs.pos"),
        "vector:result",
    ) + &node(
        "constvec x=\"1\" y=\"-2\" z=\"0.5\"",
        "w",
        "",
        "vector:vector",
    ) + &node(
        "dot",
        "n",
        "vector:A=mv.result vector:B=w.vector",
        "scalar:r",
    )
}

fn probed(m: DMat4, p: DVec3) -> f64 {
    let v = m * DVec4::new(p.x, p.y, p.z, 1.0);
    v.x - 2.0 * v.y + 0.5 * v.z
}

#[test]
fn nodes_of_matrices_are_right() {
    let of = |p: DVec3| DMat4::from_cols_array(&elements(p)).transpose();
    let plain = matrix() + &probe("m.result");
    is(
        &function(1, &plain, "n.r"),
        2.0,
        |p| probed(of(p), p),
        COUNT,
    );
    let one = |kind: &str| {
        matrix()
            + &node(kind, "k", "matrix:A=m.result", "matrix:result")
            + &probe("k.result")
    };
    let turned = one("transpose");
    let wanted = |p: DVec3| probed(of(p).transpose(), p);
    is(&function(1, &turned, "n.r"), 2.0, wanted, COUNT);
    let inverse = one("inverse");
    let wanted = |p: DVec3| probed(of(p).inverse(), p);
    is(&function(1, &inverse, "n.r"), 2.0, wanted, COUNT);
    let sines = one("sin");
    let wanted = |p: DVec3| {
        let m = elements(p).map(f64::sin);
        probed(DMat4::from_cols_array(&m).transpose(), p)
    };
    is(&function(1, &sines, "n.r"), 2.0, wanted, COUNT);
    let constant = "constmat matrix=\"1 2 3 4 0 2 1 5 0 1 3 6 0 0 0 1\"";
    let nodes = node(constant, "c", "", "matrix:matrix")
        + &node("inverse", "k", "matrix:A=c.matrix", "matrix:result")
        + &probe("k.result");
    let m = DMat4::from_cols_array(&[
        1.0, 2.0, 3.0, 4.0, 0.0, 2.0, 1.0, 5.0, 0.0, 1.0, 3.0, 6.0, 0.0, 0.0,
        0.0, 1.0,
    ])
    .transpose();
    let wanted = |p: DVec3| probed(m.inverse(), p);
    is(&function(1, &nodes, "n.r"), 2.0, wanted, COUNT);
}

#[test]
fn nodes_of_vectors_are_right() {
    let w = "constvec x=\"1\" y=\"-2\" z=\"0.5\"";
    let w = node(w, "w", "", "vector:vector");
    let other = DVec3::new(1.0, -2.0, 0.5);
    let nodes = node("length", "n", "vector:A=inputs.pos", "scalar:result");
    is(&function(1, &nodes, "n.result"), 9.0, DVec3::length, COUNT);
    let pair = "vector:A=inputs.pos vector:B=w.vector";
    let nodes = w.clone() + &node("dot", "n", pair, "scalar:result");
    is(
        &function(1, &nodes, "n.result"),
        9.0,
        |p| p.dot(other),
        COUNT,
    );
    let parts = "scalar:x scalar:y scalar:z";
    let nodes = w.clone()
        + &node("cross", "c", pair, "vector:result")
        + &node("decomposevector", "n", "vector:A=c.result", parts);
    for k in 0..3 {
        let shape = ["n.x", "n.y", "n.z"][k];
        let wanted = |p: DVec3| p.cross(other)[k];
        is(&function(1, &nodes, shape), 9.0, wanted, COUNT);
    }
    let nodes = node("vectorfromscalar", "c", "scalar:A=p.y", "vector:result")
        + &node("decomposevector", "n", "vector:A=c.result", parts);
    is(&function(1, &nodes, "n.z"), 9.0, |p| p.y, COUNT);
    for kind in ["matrixfromcolumns", "matrixfromrows"] {
        let turn = "scalar:x=p.y scalar:y=p.z scalar:z=p.x";
        let links = "vector:A=w.vector vector:B=inputs.pos vector:C=t.result \
                     vector:D=w.vector";
        let nodes = node("composevector", "t", turn, "vector:result")
            + &node(kind, "m", links, "matrix:result")
            + &probe("m.result");
        let of = |p: DVec3| {
            let t = DVec3::new(p.y, p.z, p.x);
            let m = DMat4::from_cols(
                other.extend(0.0),
                p.extend(0.0),
                t.extend(0.0),
                other.extend(1.0),
            );
            let by_columns = kind == "matrixfromcolumns";
            probed(if by_columns { m } else { m.transpose() }, p)
        };
        is(&function(1, &nodes, "n.r"), 3.0, of, COUNT);
    }
}

#[test]
fn functions_call_functions() {
    let sphere = "<i:implicitfunction id=\"5\"><i:in><i:vector \
        identifier=\"pos\"/><i:scalar identifier=\"radius\"/></i:in>"
        .to_owned()
        + &node("length", "l", "vector:A=inputs.pos", "scalar:result")
        + &node(
            "subtraction",
            "s",
            "scalar:A=l.result scalar:B=inputs.radius",
            "scalar:result",
        )
        + "<i:out><i:scalarref identifier=\"shape\" ref=\"s.result\"/></i:out>\
           </i:implicitfunction>";
    // Nodes may stand in any order.
    let nodes = node(
        "functioncall",
        "n",
        "resource:functionID=f.value vector:pos=inputs.pos scalar:radius=c.value",
        "scalar:shape",
    ) + &node(
        "constresourceid value=\"5\"",
        "f",
        "",
        "resourceid:value",
    ) + &node("constant value=\"2.5\"", "c", "", "scalar:value");
    let both = sphere.clone() + &function(1, &nodes, "n.shape");
    is(&both, 9.0, |p| p.length() - 2.5, COUNT);
    let draft = both.replace("value=\"5\"", "resourceid=\"5\"");
    is(&draft, 9.0, |p| p.length() - 2.5, 100);
    // What is not asked for may be wrong.
    let wrong = node("sin", "w", "scalar:A=w.result", "scalar:result");
    let unused = sphere + &function(1, &(nodes + &wrong), "n.shape");
    is(&unused, 9.0, |p| p.length() - 2.5, 100);
}

#[test]
fn wrong_functions_are_refused_with_the_reason() {
    let of = |nodes: &str| function(1, nodes, "n.result");
    let one =
        |kind: &str, links: &str| of(&node(kind, "n", links, "scalar:result"));
    let call = |to: u32| {
        node(
            &format!("constresourceid value=\"{to}\""),
            "f",
            "",
            "resourceid:v",
        ) + &node(
            "functioncall",
            "n",
            "resource:functionID=f.v vector:pos=inputs.pos",
            "scalar:shape",
        )
    };
    let calling = |id: u32, to: u32| function(id, &call(to), "n.shape");
    let ball = |id: u32| {
        let nodes = node("length", "n", "vector:A=inputs.pos", "scalar:result");
        function(id, &nodes, "n.result")
    };
    // Each calls the next one twice.
    let laughs: String = (1..40)
        .map(|id| {
            let twice = call(id + 1)
                .replace("\"f\"", "\"g\"")
                .replace("identifier=\"n\"", "identifier=\"m\"");
            let twice = twice.replace("f.v", "g.v") + &call(id + 1);
            let sum = "scalar:A=n.shape scalar:B=m.shape";
            let sum = node("addition", "s", sum, "scalar:result");
            function(id, &(twice + &sum), "s.result")
        })
        .collect::<String>()
        + &ball(40);
    let deep: String =
        (1..80).map(|id| calling(id, id + 1)).collect::<String>() + &ball(80);
    let cases = [
        (
            one("sin", "scalar:A=n.result"),
            "node n: it needs its own output",
        ),
        (
            of(&(node("sin", "n", "scalar:A=m.r", "scalar:result")
                + &node("sin", "m", "scalar:A=n.result", "scalar:r"))),
            "it needs its own output",
        ),
        (
            one("sin", "scalar:A=q.r"),
            "node q: it is named, and is not",
        ),
        (
            one("sin", "scalar:A=p.w"),
            "linked to p.w, which is no output",
        ),
        (
            one("sin", "scalar:A=inputs.pos"),
            "A is a scalar, and is linked",
        ),
        (one("sin", "scalar:B=p.x"), "node n: sin needs A"),
        (one("dot", "scalar:A=p.x scalar:B=p.y"), "dot needs A, B"),
        (one("sinus", "scalar:A=p.x"), "sinus is no kind of node"),
        (one("addition", "scalar:A=p.x"), "addition needs A, B"),
        (
            one("addition", "scalar:A=p.x vector:B=inputs.pos"),
            "addition needs A, B",
        ),
        (one("sin", "scalar:A=p"), "\"p\" is no output"),
        (one("constant value=\"a\"", ""), "value is no number"),
        (one("constant value=\"inf\"", ""), "value is no number"),
        (one("constant", ""), "no attribute value"),
        (one("constmat matrix=\"1 2 3\"", ""), "it has 3 numbers"),
        (one("constresourceid", ""), "no attribute value"),
        (one("mesh", "vector:pos=inputs.pos"), "mesh, a resource"),
        (
            of(&node("sin", "inputs", "scalar:A=p.x", "scalar:r")),
            "no node may be named inputs",
        ),
        (
            of(&node("sin", "p", "scalar:A=p.x", "scalar:r")),
            "a second node p",
        ),
        (calling(1, 1), "function 1: it calls itself"),
        (
            calling(1, 2) + &calling(2, 1),
            "function 1: it calls itself",
        ),
        (calling(1, 9), "function 9: it is not there"),
        (ball(1) + &ball(1), "a second resource 1"),
        (laughs, "more than 500000 operations"),
        (deep, "more than 64 calls"),
        (ball(1).replace("\"shape\"", "\"form\""), "no output shape"),
        (
            function(1, "", "inputs.pos")
                .replace("<i:scalarref", "<i:vectorref"),
            "its output shape is no scalar",
        ),
        (
            ball(1).replace("<i:vector identifier=\"pos\"/>", ""),
            "linked to inputs.pos, which is no output",
        ),
        (
            ball(1).replace("<i:vector id", "<i:text id"),
            "text is no type",
        ),
        (
            "<i:sin identifier=\"a\"/>".to_owned(),
            "part of no function",
        ),
        (
            "<i:implicitfunction id=\"1\"><i:implicitfunction id=\"2\"/>\
             </i:implicitfunction>"
                .to_owned(),
            "a function inside a function",
        ),
    ];
    for (functions, why) in cases {
        let said = match tree_of(&functions) {
            Ok(_) => "a function".to_owned(),
            Err(e) => e.to_string(),
        };
        assert!(said.contains(why), "{why:?}: {said:?}");
    }
}

/// A chain of 100,000 nodes is no deeper than any stack.
#[test]
fn long_chains_are_functions() {
    let mut nodes = node("abs", "n0", "scalar:A=p.x", "scalar:r");
    for i in 1..100_000 {
        let kind = ["sin", "cos"][i % 2];
        let from = format!("scalar:A=n{}.r", i - 1);
        nodes += &node(kind, &format!("n{i}"), &from, "scalar:r");
    }
    let tree = tree_of(&function(1, &nodes, "n99999.r")).unwrap();
    assert_eq!(data_of(&tree).len(), 0);
}

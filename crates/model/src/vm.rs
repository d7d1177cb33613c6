//! fidget's text format: one operation per line, the last one is the field.
//!
//! ```text
//! # a comment
//! _0 const 2.5
//! _1 var-x
//! _2 sub _1 _0
//! ```
//!
//! In: the bytes of a `.vm` file. Out: an expression tree, or an error with the
//! line. The parser accepts what `fidget::Context::from_text` accepts, without
//! its panics, with three exceptions: a name may be given only once, a line may
//! have no left-over words, and a constant may not be NaN.

use fidget::context::{BinaryOpcode, Tree, UnaryOpcode};
use fidget::var::Var;
use isocontour::{BINARY, UNARY, binary, unary};
use std::collections::HashMap;

/// Why a `.vm` file cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct VmError {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong, and the remedy.
    pub message: String,
}

/// An operation of the format.
#[derive(Clone, Copy)]
enum Operation {
    Constant,
    Axis(Var),
    Unary(UnaryOpcode),
    Binary(BinaryOpcode),
}

impl Operation {
    /// The number of its operands.
    fn operands(self) -> usize {
        match self {
            Axis(_) => 0,
            Constant | Unary(_) => 1,
            Binary(_) => 2,
        }
    }
}

use Operation::{Axis, Binary, Constant, Unary};

/// Every operation of the format by its name.
fn operations() -> impl Iterator<Item = (&'static str, Operation)> {
    let others = [
        ("const", Constant),
        ("var-x", Axis(Var::X)),
        ("var-y", Axis(Var::Y)),
        ("var-z", Axis(Var::Z)),
    ];
    let unary = UNARY.map(|(name, op)| (name, Unary(op)));
    let binary = BINARY.map(|(name, op)| (name, Binary(op)));
    others.into_iter().chain(unary).chain(binary)
}

/// Reads a `.vm` file.
pub fn parse_vm(bytes: &[u8]) -> Result<Tree, VmError> {
    let mut known: HashMap<&str, Tree> = HashMap::new();
    let mut last = None;
    for (i, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let error = |message: String| VmError {
            line: i + 1,
            message,
        };
        let line = std::str::from_utf8(line).map_err(|_| {
            error(
                "not valid UTF-8; a .vm file is plain text (is this a \
                 binary file?)"
                    .to_owned(),
            )
        })?;
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let mut words = line.split_whitespace();
        let Some(name) = words.next() else { continue };
        let Some(opcode) = words.next() else {
            return Err(error(format!(
                "`{}` has no operation; expected: name operation operands",
                shown(name)
            )));
        };
        let found = operations().find(|(name, _)| *name == opcode);
        let Some((_, operation)) = found else {
            let all = || operations().map(|(name, _)| name);
            let meant = super::param::nearest(opcode, all())
                .map(|n| format!("; did you mean `{n}`?"));
            let meant = meant.unwrap_or_else(|| {
                let all: Vec<_> = all().collect();
                format!("; there are {}", all.join(", "))
            });
            return Err(error(format!(
                "unknown operation `{}`{meant}",
                shown(opcode)
            )));
        };
        let wants = operation.operands();
        // This is one word more than any operation takes, so that a wrong
        // number shows without collecting a line of a million words.
        let operands: Vec<&str> = words.by_ref().take(3).collect();
        if operands.len() != wants {
            return Err(error(format!(
                "`{opcode}` takes {wants} operand{}, found {}",
                if wants == 1 { "" } else { "s" },
                match operands.len() {
                    3 => "3 or more".to_owned(),
                    n => n.to_string(),
                },
            )));
        }
        let tree_of = |word: &str| {
            known.get(word).cloned().ok_or_else(|| {
                error(if word == name {
                    format!(
                        "`{}` refers to itself; an operand must be \
                         defined on an earlier line",
                        shown(word)
                    )
                } else {
                    format!(
                        "undefined name `{}`; an operand must be \
                         defined on an earlier line",
                        shown(word)
                    )
                })
            })
        };
        let tree = match operation {
            Constant => constant(operands[0]).map_err(error)?,
            Axis(axis) => Tree::from(axis),
            Unary(op) => unary(op, &tree_of(operands[0])?),
            Binary(op) => {
                binary(op, tree_of(operands[0])?, tree_of(operands[1])?)
            }
        };
        if known.insert(name, tree.clone()).is_some() {
            return Err(error(format!(
                "the name `{}` is defined twice; rename one of the two",
                shown(name)
            )));
        }
        last = Some(tree);
    }
    last.ok_or_else(|| VmError {
        line: 1,
        message: "the file has no operations; expected lines such as \
                  `_0 var-x`"
            .to_owned(),
    })
}

/// A word of the file, fit for a message.
fn shown(word: &str) -> String {
    const LONGEST: usize = 40;
    let mut out: String = word
        .chars()
        .take(LONGEST)
        .flat_map(char::escape_default)
        .collect();
    if word.chars().nth(LONGEST).is_some() {
        out.push('…');
    }
    out
}

fn constant(word: &str) -> Result<Tree, String> {
    match word.parse::<f32>() {
        Ok(v) if v.is_nan() => {
            Err("the constant is NaN (not a number), which would make the \
             whole field undefined; use a number"
                .to_owned())
        }
        Ok(v) => Ok(Tree::constant(v)),
        Err(_) => Err(format!("`{}` is not a number", shown(word))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Context;

    #[test]
    fn every_operation_gives_what_fidget_gives() {
        for (opcode, operation) in operations() {
            if opcode == "const" || opcode == "recip" {
                continue; // in every text below; not known to fidget
            }
            let text = format!(
                "# test\n\n_x var-x\n_c const 0.5\n_y var-y\n_s {opcode} {}\n\
                 _r add _s _c\n",
                ["", "_x", "_x _y"][operation.operands()]
            );
            let (theirs, root) = Context::from_text(text.as_bytes()).unwrap();
            let mut ours = Context::new();
            let node = ours.import(&parse_vm(text.as_bytes()).unwrap());
            for (x, y) in [(0.3, 0.8), (-0.6, 2.0), (0.9, -0.2), (0.0, 1.0)] {
                let a = ours.eval_xyz(node, x, y, 0.0).unwrap();
                let b = theirs.eval_xyz(root, x, y, 0.0).unwrap();
                assert!(
                    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan(),
                    "{opcode} of {x}, {y}: {a} is not {b}"
                );
            }
        }
    }

    #[test]
    fn malformed_lines_are_errors_with_their_number() {
        let cases: [(&[u8], usize, &str); 19] = [
            (b"", 1, "no operations"),
            (b"# only a comment\n", 1, "no operations"),
            (b"_0", 1, "no operation"),
            (b"_0 var-x\n_1", 2, "no operation"),
            (b"_0 const", 1, "takes 1 operand, found 0"),
            (b"_0 const abc", 1, "`abc` is not a number"),
            (b"_0 const nan", 1, "NaN"),
            (b"_0 const NaN", 1, "NaN"),
            (b"_0 const -nan", 1, "NaN"),
            (b"_0 const 1 2", 1, "found 2"),
            (b"_0 var-x\n_1 add _0", 2, "takes 2 operands, found 1"),
            (b"_0 var-x\n_1 neg _0 _0", 2, "found 2"),
            (b"_0 var-x 1 2 3 4 5", 1, "3 or more"),
            (b"_0 var-x\n_1 neg _2\n_2 neg _1", 2, "undefined name `_2`"),
            (b"_0 neg _0", 1, "refers to itself"),
            (b"_0 var-x\n_0 var-y", 2, "defined twice"),
            (b"_0 var-x\n_1 sqr _0", 2, "did you mean `sqrt`"),
            (b"_0 var-x\n_1 neg \xff\xfe", 2, "UTF-8"),
            (b"_0 var-x\n\0 \0", 2, "unknown operation"),
        ];
        for (text, line, words) in cases {
            let error = parse_vm(text).unwrap_err();
            let text = String::from_utf8_lossy(text);
            assert_eq!(error.line, line, "{text:?}: {error}");
            assert!(
                error.message.contains(words),
                "{text:?}: {error} does not say {words}"
            );
        }
    }

    #[test]
    fn blank_lines_and_windows_line_ends_are_fine() {
        parse_vm(b"  \t \r\n_0 var-x\r\n\r\n_1 neg _0\r\n   ").unwrap();
    }

    #[test]
    fn long_chains_are_read_without_recursion() {
        use std::fmt::Write;
        let mut text = String::from("n0 var-x\n");
        for i in 1..200_000 {
            writeln!(text, "n{i} neg n{}", i - 1).unwrap();
        }
        parse_vm(text.as_bytes()).unwrap();
    }
}

use super::*;
use fidget::context::Context;

/// Runs a script without the memory limit, since the memory of other tests
/// would count.
fn run(text: &str) -> Result<Script, ScriptError> {
    let limits = ScriptLimits {
        memory_bytes: u64::MAX,
        ..ScriptLimits::default()
    };
    run_script(text, &[], &limits, &Arc::default())
}

fn value(text: &str, x: f32, y: f32, z: f32) -> f32 {
    let mut context = Context::new();
    let node = context.import(&run(text).unwrap().tree);
    context.eval_xyz(node, x, y, z).unwrap()
}

fn error(text: &str) -> String {
    run(text).unwrap_err().to_string()
}

#[test]
fn the_model_is_the_last_value_or_what_is_drawn() {
    assert_eq!(value("sqrt(x*x + y*y) - 2", 3.0, 4.0, 0.0), 3.0);
    assert_eq!(value("draw(x); y", 3.0, 4.0, 0.0), 3.0);
    assert_eq!(value("draw(x); draw([y, z]); 7", 3.0, 4.0, 1.0), 1.0);
    assert_eq!(value("[x, [y, [z]]]", 3.0, 4.0, 1.0), 1.0);
    assert_eq!(value("sphere([0, 0, 0], 2)", 3.0, 0.0, 0.0), 1.0);
    assert_eq!(
        value("fn f(r) { sphere(r) } f(2).move([1, 0, 0])", 3.0, 0.0, 0.0),
        0.0
    );
}

#[test]
fn without_a_shape_the_error_says_how_to_make_one() {
    for (text, found) in [
        ("", "nothing"),
        ("let a = sphere(2);", "nothing"),
        ("7", "the number 7"),
        ("7.5", "the number 7.5"),
        ("[]", "array"),
        ("[x, 1]", "array"),
        ("\"x\"", "a string"),
    ] {
        let e = error(text);
        assert!(e.contains("draw("), "{e}");
        assert!(e.contains(found), "{text}: {e}");
    }
    assert!(error("draw(3)").contains("not the number 3"));
}

#[test]
fn powers() {
    assert_eq!(value("x ** 2", 3.0, 0.0, 0.0), 9.0);
    assert_eq!(value("2 * x ** 2", 3.0, 0.0, 0.0), 18.0);
    assert_eq!(value("x ** 0.5", 9.0, 0.0, 0.0), 3.0);
    assert_eq!(value("x.pow(3)", 2.0, 0.0, 0.0), 8.0);
    assert!((value("2.0 ** x", 3.0, 0.0, 0.0) - 8.0).abs() < 1e-5);
    assert_eq!(value("x + 2 ** 3", 1.0, 0.0, 0.0), 9.0);
    for (text, at_3) in [
        ("x^2", 9.0),
        ("1 + 2*x^2", 19.0),
        ("2^3^2 + 0*x", 512.0),
        ("-x ** 2", -9.0),
        ("-x^2 + 1", -8.0),
        ("(-x)^2", 9.0),
        ("- -x^2", 9.0),
        ("2 - -x^2", 11.0),
        ("-(x)^2", -9.0),
        ("-abs(x)^2 * 2", -18.0),
        ("-x.abs() ** 2", -9.0),
        ("0*x + -2^2", -4.0),
        ("0*x - 2^2", -4.0),
        ("max(-x^2, -(x^2 - 1), [-x^2][0])", -8.0),
        ("2^-x^0", 0.5),
        ("-x^2^1^1", f32::NAN),
        ("let a = 3; a ^= 2; x * a", 27.0),
    ] {
        if at_3.is_nan() {
            assert!(error(text).contains("write parentheses"), "{text}");
        } else {
            assert_eq!(value(text, 3.0, 0.0, 0.0), at_3, "{text}");
        }
    }
    // The script neither panics nor multiplies for ever.
    run("x ** -9223372036854775808").unwrap();
}

#[test]
fn errors_have_their_line() {
    let e = error("let a = 1;\nlet b = foo(a);\nx");
    assert!(e.starts_with("line 2, column 9: "), "{e}");
    assert!(!e.ends_with(')') || !e.contains("(line"), "{e}");
    let e = error("let a = 1;\nlet b = ;\nx");
    assert!(e.starts_with("line 2, column 9: "), "{e}");
    let e = error("fn f() { throw \"no\" }\nf()");
    assert!(e.contains("no"), "{e}");
    assert!(error("x < 1").contains("compare"));
}

#[test]
fn parameters_are_set_and_listed() {
    let text = "let cell = param(\"cell\", 10.0, \"cell, mm\");
                let n = param(\"n\", 3, #{ step: 1 });
                let open = param(\"open\", true);
                if open { x * cell * n } else { y }";
    let set = |d: &[(&str, &str)]| {
        let d: Vec<_> = d
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
            .collect();
        run_script(text, &d, &ScriptLimits::default(), &Arc::default())
    };
    let all = set(&[("cell", "8")]).unwrap().parameters;
    assert_eq!(all.len(), 3);
    assert_eq!(all[0].default, "10.0");
    assert_eq!(all[0].value, "8.0");
    assert_eq!(all[0].description, "cell, mm");
    assert_eq!(all[1].value, "3");
    let e = set(&[("n", "2.5")]).unwrap_err().to_string();
    assert!(e.starts_with("line 2: -D n=2.5"), "{e}");
    let e = set(&[("cel", "1")]).unwrap_err().to_string();
    assert!(e.contains("did you mean `cell`"), "{e}");
    assert!(e.contains("cell, n, open"), "{e}");
    let e = error("param(\"a\", \"text\")");
    assert!(e.contains("must be a number"), "{e}");
    let e = error("param(\"a\")");
    assert!(e.contains("needs a default"), "{e}");
    let e = error("param(\"a\", 1) + param(\"a\", 2)");
    assert!(e.contains("declared twice"), "{e}");
}

#[test]
fn scripts_reach_nothing_outside() {
    for (text, words) in [
        ("import \"a\" as a; x", "models cannot import other files"),
        ("let a = foo::bar; x", "models cannot import other files"),
        ("eval(\"x\")", "eval"),
        ("sleep(100); x", "clock"),
        ("sleep(100.0); x", "clock"),
        ("timestamp(); x", "clock"),
        ("open_file(\"/etc/passwd\")", "open_file"),
    ] {
        let e = error(text);
        assert!(e.contains(words), "{text}: {e}");
    }
    // Printing is allowed, and the text is dropped.
    run("print(\"a\"); debug(\"b\"); x").unwrap();
    // So is marking what others may import, as in scripts made for that.
    run("export let size = 3; x - size").unwrap();
}

#[test]
fn endless_scripts_are_stopped() {
    let limits = ScriptLimits {
        operations: 200_000,
        ..ScriptLimits::default()
    };
    for text in [
        "loop {}",
        "let a = 0; while true { a += 1; } x",
        "let t = x; loop { t = t + 1; }",
        "fn f(n) { for i in 0..1000000 { n += i; } n } f(1); x",
    ] {
        let e = run_script(text, &[], &limits, &Arc::default()).unwrap_err();
        assert!(matches!(e, ScriptError::Limit { .. }), "{text}: {e}");
        assert!(e.to_string().contains("200000 steps"), "{e}");
    }
    let limits = ScriptLimits {
        time: Duration::from_millis(50),
        // A fast machine may take the default number of operations within the
        // time.
        operations: u64::MAX,
        ..ScriptLimits::default()
    };
    let e = run_script("loop {}", &[], &limits, &Arc::default()).unwrap_err();
    assert!(e.to_string().contains("0.05 s"), "{e}");
}

#[test]
fn growing_scripts_are_stopped() {
    for text in [
        "let s = \"a\"; loop { s += s; }",
        "let a = [1]; loop { a += a; }",
        "let a = []; a.pad(1000000000, 0); x",
        "let s = \"\"; s.pad(1000000000, \"a\"); x",
        "fn f(n) { f(n + 1) } f(0); x",
    ] {
        let e = run(text).unwrap_err();
        assert!(matches!(e, ScriptError::Limit { .. }), "{text}: {e}");
    }
    let e = error(&format!("{}x{}", "(".repeat(5000), ")".repeat(5000)));
    assert!(e.contains("complex") || e.contains("depth"), "{e}");
}

#[test]
#[cfg(target_os = "linux")]
fn memory_is_limited() {
    let limits = ScriptLimits {
        memory_bytes: 24 << 20,
        ..ScriptLimits::default()
    };
    // The scripts have small operations, and one that makes many nodes.
    for text in [
        "let t = x; loop { t = t ** 1023; }",
        "let a = []; a.pad(20000, x); loop { draw(union(a)); }",
    ] {
        let e = run_script(text, &[], &limits, &Arc::default()).unwrap_err();
        assert!(e.to_string().contains("24 MB of memory"), "{e}");
    }
}

#[test]
fn deep_values_do_not_overflow_the_stack() {
    run("let t = x; for i in 0..100000 { t = t + sin(t * 0.001); } t").unwrap();
    run("let t = x; for i in 0..100000 { t = min(t, y + i); } t").unwrap();
    // Nested arrays are measured and freed by rhai, recursively.
    let e = run("let a = []; for i in 0..1000 { a = [a]; } a");
    assert!(matches!(e, Err(ScriptError::NoModel { .. })));
}

/// What a user is told of names that do not exist.
#[test]
fn names_that_are_none_have_suggestions() {
    for (text, words) in [
        ("spehre(5)", "did you mean sphere, as in sphere(#{center"),
        ("cyinder(5, 3)", "did you mean cylinder"),
        ("cube(5)", "write rounded_box"),
        ("translate(x, [1, 2, 3])", "write f.move"),
        ("smooth_union(x, y, 3)", "write blend(a, b, 3)"),
        ("quux(5)", "docs/shapes.md"),
        ("sphere(\"a\")", "sphere"),
        ("max(x, \"a\")", "max does not take a string; write"),
        ("mix(x, y)", "write for example mix(a, b, t)"),
        ("lerp(x, y, z)", "write mix(a, b, t)"),
        (
            "fn leg(a) { a } leg(x, y)",
            "the script's leg does not take",
        ),
        ("let radius = 5; x - raduis", "did you mean radius?"),
        ("|z| - 3", "abs(z)"),
        ("let a = [1]; sphere(a[0.5])", "write floor"),
        ("for i in 0..5/2 { } x", "2.5 is none"),
        ("for i in 5 { } x", "for i in 0..6"),
        ("difference() {\n sphere(5);\n}", "looks like OpenSCAD"),
        ("translate([1, 2, 3]) sphere(5);", "looks like OpenSCAD"),
        ("module a() { sphere(5); }", "looks like OpenSCAD"),
        ("$fn = 50; sphere(5);", "looks like OpenSCAD"),
        ("for (i=[0:5]) sphere(i);", "looks like OpenSCAD"),
        ("cube([1, 2, 3], center = true);", "looks like OpenSCAD"),
        ("linear_extrude(height = 3) a();", "looks like OpenSCAD"),
        ("let r = 5; fn f() { x - r } f()", "pass it as an argument"),
        ("sphere", "sphere is a function"),
        ("if x > 0 { y } else { z }", "line 1"),
        ("if x > 0 { y } else { z }", "max(f, g)"),
        ("if x { y } else { z }", "max, min or compare"),
        ("let a = 5\nx", "is there a ; missing"),
        ("let match = 5;\nx", "give it another name"),
    ] {
        let e = error(text);
        assert!(e.contains(words), "{text}: {e}");
    }
}

/// What is wrong with a script that looks a little like one for OpenSCAD is told as
/// for any other, and first.
#[test]
fn the_remedy_comes_before_any_word_of_openscad() {
    for text in [
        "let center = true;\nlet a = sphere(5)\na",
        "let r = [1, 2];\nfor (v, i) in r { }\nlet a = sphere(5)\na",
        "let a = move(x, [1, 0, 0])\nsphere(5)",
        "fn f(height) { height }\nlet a = f(height=3)\na",
    ] {
        let e = error(text);
        assert!(!e.contains("OpenSCAD"), "{text}: {e}");
    }
    let e = error("let center = true;\nlet a = sphere(5)\na");
    assert!(e.contains("is there a ; missing"), "{e}");
    let e = error("translate([1, 2, 3]) sphere(5);");
    let [remedy, hint] =
        ["is there a ; missing", "OpenSCAD"].map(|w| e.find(w));
    assert!(remedy.is_some() && remedy < hint, "{e}");
}

#[test]
fn many_values_stand_in_an_array() {
    let all = vec!["sphere(5)"; 17].join(", ");
    for (name, call) in [
        ("min", "min([f, g])"),
        ("length", "length([f, g])"),
        ("union", "union([a, b])"),
        ("difference", "difference(a, [b, c])"),
    ] {
        let e = error(&format!("{name}({all})"));
        let wanted = format!("{name} takes 16 values at most");
        assert!(e.contains(&wanted) && e.contains(call), "{e}");
        assert!(e.contains("17 are given"), "{e}");
        let array = match name {
            "difference" => format!("{name}(sphere(9), [{all}])"),
            _ => format!("{name}([{all}])"),
        };
        assert!(run(&array).is_ok(), "{array}");
    }
    let e = error(&format!("sphere({all})"));
    assert!(e.contains("sphere does not take"), "{e}");
}

/// Whole numbers are numbers, and count wherever they are whole.
#[test]
fn whole_numbers_divide_as_numbers() {
    for (text, wanted) in [
        ("3 / 2", 1.5),
        ("1 / 3 * 3", 1.0),
        ("let t = 7; t /= 2; t", 3.5),
        ("let t = 7; t %= 4; t", 3.0),
        ("let t = 2; t **= 3; t", 8.0),
        ("2 ** -1", 0.5),
        ("10 ** 9 * 4", 4e9),
        ("-1 % 3", 2.0),
        ("-1.5 % 1", 0.5),
        ("7 % 4", 3.0),
        ("9007199254740993 % 10", 3.0),
        ("let t = 9007199254740993; t %= 10; t", 3.0),
        ("-9007199254740993 % 10", 7.0),
        ("9007199254740993 / 9007199254740993 - 1", 0.0),
        ("9007199254740993 / 3 % 10", 1.0),
        ("[5, 6, 7][4 / 2]", 7.0),
        ("[5, 6, 7][floor(5 / 2)]", 7.0),
        ("let s = 0; for i in 0..6 / 2 { s += i; } s", 3.0),
        ("let s = 0; for i in 0..=round(2.4) { s += i; } s", 3.0),
        ("let s = 0; for i in 0..4.0 { s += i; } s", 6.0),
        ("let s = 0; for i in range(0, 6, 2) { s += i / 4; } s", 1.5),
        (
            "let n = param(\"n\", 3); let s = 0; for i in 0..n { s += 1; } s",
            3.0,
        ),
        ("switch 8 / 4 { 2 => 5, _ => 6 }", 5.0),
        ("let a = [0, 0, 0, 0]; a.len / 8", 0.5),
        ("if 3 / 2 > 1 { 1 } else { 0 }", 1.0),
        (
            "sqrt(16) + sin(0) + abs(-3) + min(4, 2) + max(1, 2.5)",
            11.5,
        ),
        ("max(3, 7).sqrt() ** 2", 7.0),
    ] {
        let text = format!("let f = || {{ {text} }}; x + f.call()");
        let found = value(&text, 0.0, 0.0, 0.0);
        assert!((found - wanted as f32).abs() < 1e-4, "{text}: {found}");
    }
    assert!(error("x * (1 / 0)").contains("division by zero"));
    assert!(error("x * (1 % 0)").contains("division by zero"));
}

/// `from` is a word of Python's, and was a name in scripts.
#[test]
fn the_ends_of_a_capsule_have_names() {
    let at = |text: &str| value(text, 0.0, 0.0, 6.5);
    for names in ["start: [0, 0, 0], end", "from: [0, 0, 0], to"] {
        let text = format!("capsule(#{{{names}: [0, 0, 5], radius: 1}})");
        assert_eq!(at(&text), 0.5);
    }
    let twice = "capsule(#{start: [0, 0, 0], from: [0, 0, 0], end: [0, 0, 5], \
                 radius: 1})";
    assert!(error(twice).contains("start is given twice"));
    assert!(error("sphere(#{from: 3})").contains("there is no \"from\""));
}

/// Bodies are put together by words; fields are added and subtracted.
#[test]
fn operators_on_bodies() {
    let at = |text: &str, x: f32| value(text, x, 0.0, 0.0);
    assert_eq!(at("sphere(2) | sphere([5, 0, 0], 1)", 5.0), -1.0);
    assert_eq!(at("sphere(2) & sphere([2, 0, 0], 2)", 0.0), 0.0);
    assert_eq!(at("!sphere(2)", 0.0), 2.0);
    for (text, words) in [
        ("sphere(2) + sphere(3)", "write union(a, b) or a | b"),
        ("sphere(2) - sphere(1)", "write difference(a, b)"),
        (
            "let p = sphere(2); p += box([0, 0, 0], [1, 1, 1]); p",
            "union",
        ),
        (
            "let p = sphere(2); p -= cylinder(1, 9); p",
            "difference(a, b)",
        ),
        ("sphere(2).move([1, 0, 0]) - sphere(1)", "difference(a, b)"),
        (
            "union(sphere(2), sphere(3)) - sphere(1)",
            "difference(a, b)",
        ),
        (
            "(sphere(2) - 0.5) - min(sphere(1), sphere(2))",
            "difference(a, b)",
        ),
        (
            "(sphere(2) | sphere(1)) - (sphere(3) & sphere(1))",
            "difference",
        ),
    ] {
        let told = error(text).to_lowercase();
        assert!(told.contains(words), "{text}: {told}");
    }
    // These are fields, or meant as such.
    assert_eq!(at("sphere(2) - x", 1.0), -2.0);
    assert_eq!(at("sphere(2) + 0.3 * sin(x)", 0.0), -2.0);
    assert_eq!(at("0.5 * sphere(2) + 0.5 * sphere(4)", 0.0), -3.0);
    assert_eq!(at("sphere(2) - 1 * sphere(4)", 0.0), 2.0);
    assert_eq!(at("max(x, y) - min(y, z)", 1.0), 1.0);
}

use super::*;
use fidget::context::Context;

/// Runs a script without the memory limit, since the memory of other tests
/// would count.
fn run(text: &str) -> Result<Script, ScriptError> {
    let limits = ScriptLimits {
        memory_bytes: u64::MAX,
        ..ScriptLimits::default()
    };
    run_script(text, &[], &limits)
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
    // rhai has this rule; the module's head warns of it.
    assert_eq!(value("-x ** 2", 3.0, 0.0, 0.0), 9.0);
    assert!(error("x^2").contains("x ** 2"));
    assert!(error("x + 2*y^2.0").contains("x ** 2"));
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
                let n = param(\"n\", 3);
                let open = param(\"open\", true);
                if open { x * cell * n } else { y }";
    let set = |d: &[(&str, &str)]| {
        let d: Vec<_> = d
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
            .collect();
        run_script(text, &d, &ScriptLimits::default())
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
        ("import \"a\" as a; x", "import"),
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
        let e = run_script(text, &[], &limits).unwrap_err();
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
    let e = run_script("loop {}", &[], &limits).unwrap_err();
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
        let e = run_script(text, &[], &limits).unwrap_err();
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
        ("max(x)", "max does not take (a shape)"),
        (
            "fn leg(a) { a } leg(x, y)",
            "the script's leg does not take",
        ),
        ("let radius = 5; x - raduis", "did you mean radius?"),
        ("x - pi", "write PI"),
        ("let r = 5; fn f() { x - r } f()", "pass it as an argument"),
        ("sphere", "sphere is a function"),
        ("if x > 0 { y } else { z }", "line 1"),
        ("if x > 0 { y } else { z }", "max(f, g)"),
        ("if x { y } else { z }", "max, min or compare"),
        ("let a = 5\nx", "is there a ; missing"),
    ] {
        let e = error(text);
        assert!(e.contains(words), "{text}: {e}");
    }
}

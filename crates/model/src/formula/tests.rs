use super::*;
use crate::data::Files;
use fidget::context::Context;

fn value(text: &str, x: f32, y: f32, z: f32) -> f32 {
    let mut context = Context::new();
    let node = context.import(&parse_formula(text, &Files::default()).unwrap());
    context.eval_xyz(node, x, y, z).unwrap()
}

#[test]
fn precedence_is_that_of_mathematics() {
    assert_eq!(value("-x^2", 3.0, 0.0, 0.0), -9.0);
    assert_eq!(value("2*x^2", 3.0, 0.0, 0.0), 18.0);
    assert_eq!(value("2*x**2", 3.0, 0.0, 0.0), 18.0);
    assert_eq!(value("x+2^3^2", 0.0, 0.0, 0.0), 512.0);
    assert_eq!(value("x^-1", 4.0, 0.0, 0.0), 0.25);
    assert_eq!(value("x^0.5", 9.0, 0.0, 0.0), 3.0);
    assert_eq!(value("(-x)^2", 3.0, 0.0, 0.0), 9.0);
    assert_eq!(value("2-x-1", 3.0, 0.0, 0.0), -2.0);
    assert_eq!(value("8/x/2", 2.0, 0.0, 0.0), 2.0);
    assert_eq!(value("1 - -x", 2.0, 0.0, 0.0), 3.0);
    assert_eq!(value("(x^2)^3", 2.0, 0.0, 0.0), 64.0);
}

/// What is written in place of a shape's name is a formula, negative inside.
#[test]
fn shapes_by_name_are_told_as_formulas() {
    for name in ["sphere 5", "cube(10)", "Cylinder(3, 4)", "torus", "box"] {
        let error = parse_formula(name, &Files::default()).unwrap_err();
        let told = error.to_string();
        let written = told.split_once("; write ").expect(&told).1;
        let (written, _) = written.split_once(", or a script").unwrap();
        let at = if name == "torus" { 15.0 } else { 0.0 };
        assert!(value(written, at, 0.0, 0.0) < 0.0, "{written}");
    }
}

#[test]
fn functions_and_constants() {
    assert_eq!(value("sqrt(x^2+y^2+z^2) - 15", 9.0, 0.0, 12.0), 0.0);
    assert_eq!(value("min(x, y, z, 7)", 5.0, 3.0, 4.0), 3.0);
    assert_eq!(value("max(x, y)", 5.0, 3.0, 4.0), 5.0);
    assert_eq!(value("mod(x, 3) + x % 2", 7.0, 0.0, 0.0), 2.0);
    assert_eq!(value("sign(x)", -7.0, 0.0, 0.0), -1.0);
    assert_eq!(value("x + 1e3 + .5", 0.0, 0.0, 0.0), 1000.5);
    assert!((value("cos(x*pi)", 1.0, 0.0, 0.0) + 1.0).abs() < 1e-6);
    assert!((value("ln(e) + 0*x", 1.0, 0.0, 0.0) - 1.0).abs() < 1e-6);
    assert_eq!(value("pow(x, 3)", 2.0, 0.0, 0.0), 8.0);
    assert!((value("2^x", 3.0, 0.0, 0.0) - 8.0).abs() < 1e-5);
    assert!(
        (value("atan2(y, x)", 0.0, 1.0, 0.0) - std::f32::consts::FRAC_PI_2)
            .abs()
            < 1e-6
    );
}

#[test]
fn errors_point_at_the_column() {
    for (text, column, words) in [
        ("", 1, "empty"),
        ("   ", 1, "empty"),
        ("x +", 4, "ends too early"),
        ("x + * y", 5, "found `*`"),
        ("2x", 2, "multiplication"),
        ("(x + 1", 7, "column 1 is not closed"),
        ("x)", 2, "unmatched"),
        ("x, y", 2, "outside"),
        ("sqr(x)", 1, "did you mean `sqrt`"),
        ("x + w", 5, "unknown name `w`"),
        ("sqrt(x, y)", 1, "takes 1 argument, not 2"),
        ("sqrt()", 1, "not 0"),
        ("atan2(x)", 1, "takes 2 arguments"),
        ("x(2)", 1, "not a function"),
        ("sqrt + 1", 1, "is a function"),
        ("x # 2", 3, "unexpected character"),
        ("x - |z|", 5, "write abs(z)"),
        ("x & z", 3, "max(f, g)"),
        ("x < 3", 3, "write a - b for a < b"),
        (
            "mix(x, y)",
            1,
            "takes 3 arguments, not 2: write mix(a, b, t)",
        ),
        ("x + 1e99", 5, "not a number in range"),
        ("1.2.3 + x", 1, "not a number"),
        ("3 + 4", 1, "constant 7"),
        ("sqrt(x 2)", 8, "expected an operator"),
    ] {
        let error = parse_formula(text, &Files::default()).unwrap_err();
        assert_eq!(error.column, column, "{text}: {error}");
        assert!(
            error.message.contains(words),
            "{text}: {error} does not say {words}"
        );
    }
}

#[test]
fn nesting_is_limited() {
    for text in [
        "(".repeat(100_000),
        "-".repeat(100_000) + "x",
        "sin(".repeat(100_000),
        "2^".repeat(100_000) + "x",
    ] {
        let error = parse_formula(&text, &Files::default()).unwrap_err();
        assert!(error.message.contains("deep"), "{error}");
    }
    // A long formula is not a deeply nested one.
    let text = "x + ".repeat(20_000) + "y";
    parse_formula(&text, &Files::default()).unwrap();
}

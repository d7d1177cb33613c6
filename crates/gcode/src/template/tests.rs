mod imported;

use super::*;
use glam::DVec3;
use isoslice_settings::testing::settings;

pub(super) fn header() -> Header {
    Header {
        model_name: "gyroid\nball".to_owned(),
        layer_count: 12,
        layers: 0..12,
        timestamp: None,
        nozzle_temperature: 210.0,
        part_min: DVec3::new(95.0, 95.0, 0.0),
        part_max: DVec3::new(125.0, 125.0, 30.0),
        parts: Vec::new(),
        thumbnails: Vec::new(),
        format: crate::Format::Text,
        fingerprint: None,
        one_by_one: false,
    }
}

fn filled(source: &str) -> Result<String, String> {
    let s = settings(&[]);
    let mut plan = WriterPlan::of(&s);
    plan.templates[0] = source;
    let start = Templates::new(&plan, &header()).and_then(|t| t.start());
    start.map_err(|e| {
        let s = e.to_string();
        s.split("; ").next().unwrap_or("").to_owned()
    })
}

#[track_caller]
fn assert_filled(source: &str, expected: &str) {
    assert_eq!(filled(source).as_deref(), Ok(expected));
}

#[test]
fn placeholders_are_filled_in() {
    assert_filled(
        "M104 S{{ nozzle_temperature }} \r\nG1 Z{{park_z}}",
        "M104 S210\nG1 Z40\n",
    );
    assert_filled("M117 {{ '{' }}{{ model_name }}}", "M117 {gyroid ball}\n");
    assert_filled("M117 {% raw %}{a}{% endraw %}", "M117 {a}\n");
    assert_filled("{{ speed.travel }} {{ printer.model }}", "150\n");
}

#[test]
fn expressions_are_computed_and_written_plainly() {
    assert_filled("{{ (layer_height * 2) | round(2) }}", "0.4\n");
    assert_filled("{{ layer_height / 3 }} {{ 1/2 }}", "0.06667 0.5\n");
    assert_filled("{{ bed_temperature / 2 }}", "30\n");
    assert_filled("{{ 1e-9 }} {{ -layer_height }}", "0 -0.2\n");
    assert_filled(
        "G28\n{% if bed_temperature > 50 %}\nM190 S{{ bed_temperature }}\n\
         {% else %}\nG4 P1\n{% endif %}\nG29",
        "G28\nM190 S60\nG29\n",
    );
    assert_filled("{{ [part_max_x + 5, bed_x] | min }}", "130\n");
}

#[test]
fn every_placeholder_has_a_value_and_its_own_name() {
    let all = crate::PLACEHOLDERS;
    for p in all {
        assert_eq!(all.iter().filter(|q| q.name == p.name).count(), 1);
        let text = format!("{{{{ {} }}}}", p.name);
        let s = settings(&[]);
        let mut plan = WriterPlan::of(&s);
        plan.templates = match p.scope {
            Scope::All => [&text, "", ""],
            Scope::End => ["", &text, ""],
            Scope::Layer => ["", "", &text],
        };
        assert!(Templates::new(&plan, &header()).is_ok(), "{}", p.name);
    }
    // All settings but the templates.
    for key in isoslice_settings::keys() {
        let template = key.name.starts_with("gcode.")
            && ["start", "end", "layer"].contains(&&key.name[6..]);
        let used = filled(&format!("{{{{ {} }}}}", key.name));
        assert_eq!(used.is_ok(), !template, "{}", key.name);
    }
}

#[track_caller]
fn assert_refused(source: &str, expected: &str) {
    assert_eq!(filled(source), Err(format!("gcode.start, {expected}")));
}

#[test]
fn errors_say_where() {
    assert_refused(
        "G28\nM104 Sé{{ nozle_temp }}",
        "line 2, column 11: there is no placeholder {{ nozle_temp }}, did \
         you mean {{ nozzle_temperature }}?",
    );
    // An unknown name is an error even in a branch that is never reached.
    assert_refused(
        "{% if false %}\n{{ 1 + bed_q }}{% endif %}",
        "line 2, column 8: there is no placeholder {{ bed_q }}, did you \
         mean {{ bed_x }}?",
    );
    assert_refused(
        "{{ filament.diametre }}",
        "line 1, column 4: there is no placeholder \
         {{ filament.diametre }}, did you mean {{ filament.diameter }}?",
    );
    assert_refused(
        "{{ layer }}",
        "line 1, column 4: layer is known in gcode.layer only",
    );
    for broken in ["G28 {{ bed_x", "G28 {{ bed_x + }}", "{% if true %}"] {
        let error = filled(broken).unwrap_err();
        assert!(error.contains("line 1, column"), "{error}");
        assert!(error.contains("syntax error"), "{error}");
    }
    for wrong in ["G28\n{{ 1 // 0 }}", "G28\n{{ 1 / 0 }}", "\n{{ x.y }}"] {
        let error = filled(wrong).unwrap_err();
        assert!(error.contains("line 2, column 4"), "{error}");
    }
}

#[test]
fn a_template_that_goes_on_for_ever_is_stopped() {
    let bomb = "{% for i in range(9999) %}{% for j in range(9999) %}G4\n\
                {% endfor %}{% endfor %}";
    assert!(filled(bomb).unwrap_err().contains("too much time"));
}

#[test]
fn a_template_that_grows_without_end_is_refused() {
    let doubled = "{% set s = 'aaaaaaaaaaaaaaaa' %}".to_owned()
        + &"{% set s = s ~ s %}".repeat(60);
    for (source, words) in [
        (doubled.as_str(), "too much"),
        ("{{ 'a' * 2000000 }}", "more than 1 MB"),
        ("{{ 'a' * 999999999 }}", "too much"),
        ("{{ '%999999999999999d' | format(3) }}", "too much"),
        ("{{ '%.999999999999999f' | format(3.5) }}", "too much"),
        ("{{ '%(\u{6c2}99' | format(5) }}", "has a %("),
        ("{{ '5 %' | format(5) }}", "format"),
        ("{{ 'a' | indent(999999999999999, true) }}", "too much"),
        ("{{ [1] | batch(999999999999999, 0) }}", "too much"),
        ("{{ [1] | slice(999999999999999, 0) }}", "too much"),
        (
            "{% macro m(n) %}{{ m(n + 1) }}{% endmacro %}{{ m(0) }}",
            "recursion",
        ),
    ] {
        let error = filled(source).unwrap_err();
        assert!(error.contains(words), "{source}: {error}");
    }
    assert_filled("{{ '%03d' | format(7) }}", "007\n");
    assert_filled("{{ '%+.1f %d%%' | format(2.25, 7) }}", "+2.2 7%\n");
}

#[test]
fn a_list_is_not_written() {
    for list in ["[0] * 9", "[1, 2]", "{'a': 1}", "range(3)"] {
        let error = filled(&format!("{{{{ {list} }}}}")).unwrap_err();
        assert!(error.contains("a list"), "{error}");
    }
    assert_filled("{{ [1, 2] | join(' ') }}", "1 2\n");
}

/// Shapes that nest something in itself `n` times.
fn nested(n: usize) -> Vec<(&'static str, String)> {
    let of = |head: &str, step: &str, tail: &str| {
        format!("{{{{ {head}{}{tail} }}}}", step.repeat(n))
    };
    vec![
        ("+", of("1", "+1", "")),
        ("+ of fractions", of("1.5", " + 1.5", "")),
        ("or", of("1", " or 1", "")),
        ("~", of("1", "~1", "")),
        ("not", of("", "not ", "1")),
        ("-", of("", "- ", "1")),
        (".a", of("speed", ".a", "")),
        (".1", of("speed", ".1", "")),
        ("[0]", of("speed", "[0]", "")),
        ("()", of("speed", "()", "")),
        ("|abs", of("1", "|abs", "")),
        ("**", of("1", "**1", "")),
        ("is", of("1", " is odd", "")),
        ("in", of("1", " in [1]", "")),
        ("if else", of("", "1 if 1 else ", "1")),
        ("if", of("1", " if 1", "")),
        ("in brackets", of("(", "(1 + ", "1")),
        ("behind }}", of("'}}' ~ 1", "+1", "")),
        ("behind a map", of("{1: {2: 3}} ~ 1", "+1", "")),
        ("behind a number", of("0x1.5", ".5", "")),
        ("behind a comma", of("[1, 2, 1", "+1", "]")),
        ("under a bracket that is too many", of("1", "+1", ")")),
        (
            "behind raw text",
            format!(
                "{{% raw %}}endraw {{# {{% endraw %}}{{{{ 1{} }}}}{{# #}}",
                "+1".repeat(n)
            ),
        ),
        (
            "elif",
            format!("{{% if 1 %}}{}{{% endif %}}", "{% elif 1 %}".repeat(n)),
        ),
        ("set", format!("{{% set a = {}1 %}}", "not ".repeat(n))),
        ("filter", {
            let filters = "|abs".repeat(n);
            format!("{{% filter abs{filters} %}}1{{% endfilter %}}")
        }),
    ]
}

/// The threads of tests have 2 MB of stack, as those of `watch` do.
#[test]
fn a_template_that_is_nested_too_deeply_is_refused() {
    for n in [300, 20_000] {
        for (shape, text) in nested(n) {
            let error = filled(&text).unwrap_err();
            let said = ["within one another", "recursion limits"]
                .iter()
                .any(|words| error.contains(words));
            assert!(said, "{shape}: {error}");
        }
    }
    // The same shapes are compiled if they are short.
    for (shape, text) in nested(120) {
        if let Err(error) = filled(&text) {
            assert!(!error.contains("one another"), "{shape}: {error}");
        }
    }
    let long = "[1.5, 2, 'a + b']".replace(']', &", 3".repeat(2000));
    assert_filled(&format!("{{{{ {long}] | first }}}}"), "1.5\n");
    let sum = format!("{{{{ 1{} }}}}", " + 1".repeat(240));
    assert_filled(&sum, "241\n");
}

/// Lists of lists are dropped, compared and written by recursion.
#[test]
fn values_that_are_nested_deeply_do_no_harm() {
    let deep = "{% set a = 1 %}".to_owned()
        + &format!("{{% set a={}a{} %}}", "[".repeat(70), "]".repeat(70))
            .repeat(500);
    assert_filled(&format!("{deep}{{{{ a | length }}}}"), "1\n");
    for use_of in ["a == [a]", "a | string", "[a, a] | sort", "a in [a]"] {
        let _ = filled(&format!("{deep}{{{{ {use_of} | length }}}}"));
    }
    let handed_on = "{% macro m(a) %}{{ m([[[[[[a]]]]]]) }}{% endmacro %}\
                     {{ m(1) }}";
    assert!(filled(handed_on).unwrap_err().contains("recursion"));
    let own = "{% set ns = namespace() %}{% set ns.a = ns %}{{ ns == ns }}";
    assert!(filled(own).unwrap_err().contains("loop.index0"));
}

//! Models from strangers: a script can do nothing but describe a shape, and
//! whatever it, a `.vm` file or a formula holds, the answer is a model or an
//! error, soon and without taking the machine's memory.

use isoslice::model::{ScriptLimits, Source, load, load_within, parse_vm};
use std::fmt::Write;
use std::time::Duration;

/// The error of a script that has so many seconds for it.
fn refusal_within(seconds: u64, text: &str) -> String {
    let limits = ScriptLimits {
        time: Duration::from_secs(seconds),
        // Other tests' memory would count.
        memory_bytes: u64::MAX,
        ..ScriptLimits::default()
    };
    let source = Source::script("stranger", text);
    match load_within(&source, &[], &limits) {
        Ok(_) => panic!("{} is a model", &text[..text.len().min(200)]),
        Err(error) => error.to_string(),
    }
}

/// The error of a script that has all the time it wants.
fn refusal(text: &str) -> String {
    refusal_within(600, text)
}

#[track_caller]
fn assert_refused(text: &str, words: &str) {
    let error = refusal(text);
    assert!(error.contains(words), "{words:?} is not in: {error}");
    assert!(!error.contains("bug"), "{error}");
    assert!(error.chars().count() < 1000, "{error}");
}

/// This many things are nested, or come one after another.
const DEEP: usize = 100_000;

#[test]
fn nesting_is_bounded_however_it_is_written() {
    let n = DEEP;
    for text in [
        format!("{}x{}", "(".repeat(n), ")".repeat(n)),
        format!("{}x{}", "{".repeat(n), "}".repeat(n)),
        format!("{}{}", "[".repeat(n), "]".repeat(n)),
        format!("{}{}", "`${".repeat(n), "}`".repeat(n)),
        format!("x{}", "+x".repeat(n)),
        format!("x{}", "**1".repeat(n)),
        format!("x{}", "??x".repeat(n)),
        format!("true{};x", "&&true".repeat(n)),
        format!("{}true;x", "!".repeat(n)),
        format!("x{}", ".abs()".repeat(n)),
        format!("let a=[];a{}", "[0]".repeat(n)),
        format!("{}x", "||".repeat(n)),
        format!(
            "if false {{x}}{} else {{x}}",
            " else if false {x}".repeat(n)
        ),
        format!("parse_json(\"{}\");x", "[".repeat(n)),
        format!("let s=\"\";s.pad({n},'[');parse_json(s);x"),
    ] {
        assert_refused(&text, "complexity");
    }
    assert_refused("fn f() { f() } f()", "deep");
    assert_refused("let f = |g| g.call(g); f.call(f)", "deep");
}

#[test]
fn what_grows_without_end_is_stopped() {
    /// A text nearly as long as may be, quickly made.
    const BIG: &str = "let s = \"aaaaaaaa\"; for i in 0..16 { s += s; }";
    for text in [
        "let s = \"a\"; loop { s += s; }",
        "{BIG} let t = s; s.replace('a', t); x",
        "{BIG} let t = s; s.replace(\"a\", t); x",
        "{BIG} let t = `${s}${s}${s}`; x",
        "{BIG} s.split(\"\"); x",
        "let a = []; loop { {BIG} a.push(s); }",
        "let a = [1]; loop { a += a; }",
        "let a = [1]; a.pad(40000, 1); let b = []; b.pad(40000, a); x",
        "blob(1000000000000); x",
    ] {
        assert_refused(&text.replace("{BIG}", BIG), "too large");
    }
}

#[test]
fn replacing_in_texts_works_as_ever() {
    let text = "let s = \"abcabc\";
        s.replace(\"b\", \"xy\");
        s.replace('c', \"z\");
        s.replace(\"a\", '-');
        s.replace('z', '+');
        if s != \"-xy+-xy+\" { throw s; }
        x - 1";
    let source = Source::script("texts", text);
    load(&source, &[]).unwrap();
}

#[test]
fn single_operations_that_take_for_ever_are_not_waited_for() {
    // The engine may look for a function by all mixtures of its arguments'
    // types. Its filter of names, whose seed is random, may or may not rule
    // that out.
    let call = format!("f({}x)", "x,".repeat(DEEP));
    let error = refusal_within(1, &call);
    let refused = error.contains("1 s") || error.contains("no function f");
    assert!(refused, "{error}");
    assert!(error.chars().count() < 1000, "{error}");
    let mut cases = String::from("switch 1 {");
    for i in 0..2 * DEEP {
        write!(cases, "{i}=>x,").unwrap();
    }
    cases.push('}');
    let error = refusal_within(1, &cases);
    assert!(error.contains("1 s"), "{error}");
    for text in [
        "let a = []; a.pad(49000, 1); loop { a.contains(2); }",
        "let a = []; a.pad(49000, 1); let b = a; loop { a == b; }",
        "let s = \"\"; s.pad(1000000, 'a'); loop { s.contains('b'); }",
        "loop { print(\"a\"); debug(x); }",
    ] {
        let error = refusal_within(1, text);
        let stopped = error.contains("1 s") || error.contains("steps");
        assert!(stopped, "{error}");
    }
}

#[test]
fn nothing_outside_can_be_reached() {
    for (text, words) in [
        ("eval(\"x\")", "eval"),
        ("Fn(\"eval\").call(\"x\")", "eval"),
        ("import \"a\" as a; x", "import"),
        ("Fn(\"import\").call(\"a\")", "import"),
        ("timestamp(); x", "clock"),
        ("sleep(1); x", "clock"),
        ("open_file(\"/etc/passwd\"); x", "open_file"),
        ("env(\"HOME\"); x", "env"),
        ("rand(); x", "rand"),
    ] {
        assert_refused(text, words);
    }
}

#[test]
fn messages_are_short_whatever_they_quote() {
    assert_refused("let s = \"\"; s.pad(1000000, 'a'); throw s", "aaa");
    assert_refused(&format!("0x{} + x", "f".repeat(DEEP)), "Invalid number");
}

/// Memory is the whole process's, so it is a process of its own that is
/// looked at.
#[cfg(target_os = "linux")]
#[test]
fn memory_is_bounded_where_no_size_is() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("let b = \"0123456789abcdef\";\n");
    text.push_str("for i in 0..15 { b += b; }\n");
    for i in 0..900 {
        writeln!(text, "let s{i} = b + \"{i}\";").unwrap();
    }
    text.push('x');
    std::fs::write(folder.path().join("grows.rhai"), text).unwrap();
    let program = assert_cmd::cargo::cargo_bin!("isoslice");
    let output = std::process::Command::new(program)
        .args(["info", "grows.rhai"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("192 MB of memory"), "{error}");
}

#[test]
fn deep_expressions_are_models() {
    let source = Source::script(
        "deep",
        format!("let s = x; for i in 0..{DEEP} {{ s = s + y; }} s"),
    );
    assert!(load(&source, &[]).unwrap().expression_size >= DEEP);
}

#[test]
fn vm_files_of_a_million_lines_are_read_and_their_faults_placed() {
    const LINES: usize = 1_000_000;
    let mut text = String::from("n0 var-x\n");
    for i in 1..LINES {
        writeln!(text, "n{i} neg n{}", i - 1).unwrap();
    }
    parse_vm(text.as_bytes()).unwrap();
    let mut bytes = text.into_bytes();
    bytes.extend(b"a neg \xff\n");
    let error = parse_vm(&bytes).unwrap_err();
    assert_eq!(error.line, LINES + 1);
    assert!(error.message.contains("UTF-8"), "{error}");
}

fn formula(text: String) -> Source {
    Source::formula("test", text)
}

#[test]
fn formulas_that_nest_without_end_are_refused() {
    let n = DEEP;
    for text in [
        format!("{}x{}", "(".repeat(n), ")".repeat(n)),
        "(".repeat(n),
        format!("{}x", "-".repeat(n)),
        format!("{}x{}", "sin(".repeat(n), ")".repeat(n)),
        format!("x{}", "^x".repeat(n)),
    ] {
        // The formula may be refused or read, but the call must come back.
        let _ = load(&formula(text), &[]);
    }
    let sum = format!("x{}", "+y".repeat(n));
    load(&formula(sum), &[]).unwrap();
}

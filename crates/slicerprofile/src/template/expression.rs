//! Expressions in the template language of PrusaSlicer and OrcaSlicer:
//! `max(bed_temperature[0] - 5, 0)`. Cura's names are understood, too.
//!
//! ```text
//! choice  = either [ "?" choice ":" choice ]
//! either  = both { ("or" | "||") both }
//! both    = same { ("and" | "&&") same }
//! same    = sum [ ("==" | "!=" | "<>" | "<" | ">" | "<=" | ">=") sum ]
//!         | sum ("=~" | "!~") "/" pattern "/"
//! sum     = product { ("+" | "-") product }
//! product = sign { ("*" | "/" | "%") sign }
//! sign    = ("-" | "+" | "not" | "!") sign | atom
//! atom    = number | text | name [ "[" choice "]" ]
//!         | name "(" choice { "," choice } ")" | "(" choice ")"
//!         | "interpolate_table" "(" choice { "," pair } ")"
//! pair    = "(" choice "," choice ")"
//! ```

use super::names::{AT_THE_END, NumberKind, Ours, ours};
use super::{Names, Place};

/// Why an expression is not understood, as a sentence.
pub(super) type Refused = String;

/// Greatest depth of nested expressions.
const DEEPEST: usize = 32;

/// Greatest length of an expression that is written several times: in a table, or
/// before a pattern of several words. Tables in tables and patterns after patterns
/// would grow without bounds.
const LONGEST_REPEATED: usize = 100;

/// Indices that name the only extruder.
pub(crate) const FIRST_TOOL: [&str; 6] = [
    "0",
    "initial_tool",
    "initial_extruder",
    "initial_no_support_extruder",
    "current_extruder",
    "current_tool",
];

/// The expression of isoslice that does what a foreign one does.
pub(super) fn translated(
    text: &str,
    names: Names<'_>,
) -> Result<String, Refused> {
    let mut parser = Parser {
        tokens: tokens(text)?,
        at: 0,
        depth: 0,
        names,
    };
    let (ours, _) = parser.choice()?;
    // Cura's `{name, extruder}`.
    if parser.take(",") && parser.next().is_none_or(|t| !t.is_name_or_zero()) {
        return Err("isoslice prints with one extruder".to_owned());
    }
    match parser.tokens.get(parser.at) {
        None => Ok(ours),
        Some(token) => Err(format!("{} is not understood", token.shown())),
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Token<'a> {
    Number(&'a str),
    Text(&'a str),
    Name(&'a str),
    Sign(&'a str),
    /// A pattern, without its slashes, and whether the text is to have it.
    Pattern(&'a str, bool),
}

impl Token<'_> {
    fn shown(&self) -> String {
        match self {
            Token::Number(text) | Token::Name(text) | Token::Sign(text) => {
                format!("`{text}`")
            }
            Token::Text(text) => format!("{text:?}"),
            Token::Pattern(text, _) => format!("`/{text}/`"),
        }
    }

    fn is_name_or_zero(&self) -> bool {
        matches!(self, Token::Name(_) | Token::Number("0"))
    }
}

fn tokens(text: &str) -> Result<Vec<Token<'_>>, Refused> {
    const SIGNS: [&str; 24] = [
        "==", "!=", "<>", "<=", ">=", "&&", "||", "=~", "!~", "<", ">", "+",
        "-", "*", "/", "%", "(", ")", "[", "]", ",", "?", ":", "!",
    ];
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let while_ =
            |of: fn(char) -> bool| rest.find(|c| !of(c)).unwrap_or(rest.len());
        let (token, length) = if first.is_ascii_digit() || first == '.' {
            let n = while_(|c| c.is_ascii_digit() || c == '.');
            (Token::Number(&rest[..n]), n)
        } else if first.is_ascii_alphabetic() || first == '_' {
            let n = while_(|c| c.is_ascii_alphanumeric() || c == '_');
            (Token::Name(&rest[..n]), n)
        } else if first == '"' {
            let Some(n) = rest[1..].find('"') else {
                return Err("a text in quotes is not closed".to_owned());
            };
            (Token::Text(&rest[1..=n]), n + 2)
        } else {
            match SIGNS.into_iter().find(|s| rest.starts_with(s)) {
                Some(sign @ ("=~" | "!~")) => {
                    let after = rest[sign.len()..].trim_start();
                    let pattern = after
                        .strip_prefix('/')
                        .and_then(|inner| inner.split_once('/'));
                    let Some((pattern, _)) = pattern else {
                        return Err(format!("{sign} needs a /pattern/"));
                    };
                    let before = rest.len() - after.len();
                    let length = before + pattern.len() + 2;
                    (Token::Pattern(pattern, sign == "=~"), length)
                }
                Some(sign) => (Token::Sign(sign), sign.len()),
                None => return Err(format!("{first:?} is not understood")),
            }
        };
        found.push(token);
        rest = rest[length..].trim_start();
    }
    Ok(found)
}

struct Parser<'a> {
    tokens: Vec<Token<'a>>,
    at: usize,
    depth: usize,
    names: Names<'a>,
}

type Parsed = Result<(String, NumberKind), Refused>;

impl<'a> Parser<'a> {
    fn next(&mut self) -> Option<Token<'a>> {
        let token = self.tokens.get(self.at).cloned();
        self.at += 1;
        token
    }

    /// Takes a sign or a word if it comes next.
    fn take(&mut self, word: &str) -> bool {
        let is = match self.tokens.get(self.at) {
            Some(Token::Sign(s) | Token::Name(s)) => *s == word,
            _ => false,
        };
        self.at += usize::from(is);
        is
    }

    fn one_of<const N: usize>(
        &mut self,
        words: [(&'static str, &'static str); N],
    ) -> Option<&'static str> {
        let found = words.into_iter().find(|(theirs, _)| self.take(theirs));
        found.map(|(_, ours)| ours)
    }

    fn expect(&mut self, sign: &str) -> Result<(), Refused> {
        if self.take(sign) {
            Ok(())
        } else {
            Err(format!("`{sign}` is missing"))
        }
    }

    fn choice(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("it is nested too deeply".to_owned());
        }
        let mut first = self.either()?;
        if self.take("?") {
            let (yes, kind) = self.choice()?;
            self.expect(":")?;
            let (no, _) = self.choice()?;
            first = (format!("({yes} if {} else {no})", first.0), kind);
        }
        self.depth -= 1;
        Ok(first)
    }

    fn either(&mut self) -> Parsed {
        let words = [("or", "or"), ("||", "or")];
        self.chain(Self::both, words, |_, _, _| NumberKind::Other)
    }

    fn both(&mut self) -> Parsed {
        let words = [("and", "and"), ("&&", "and")];
        self.chain(Self::same, words, |_, _, _| NumberKind::Other)
    }

    fn same(&mut self) -> Parsed {
        let words = [
            ("==", "=="),
            ("!=", "!="),
            ("<>", "!="),
            ("<=", "<="),
            (">=", ">="),
            ("<", "<"),
            (">", ">"),
        ];
        self.chain(Self::matched, words, |_, _, _| NumberKind::Other)
    }

    /// A sum, with a pattern behind it.
    fn matched(&mut self) -> Parsed {
        let (left, kind) = self.sum()?;
        let Some(Token::Pattern(pattern, wanted)) =
            self.tokens.get(self.at).cloned()
        else {
            return Ok((left, kind));
        };
        self.at += 1;
        let found = looks_like(&left, pattern)?;
        let found = if wanted {
            found
        } else {
            format!("(not {found})")
        };
        Ok((found, NumberKind::Other))
    }

    fn sum(&mut self) -> Parsed {
        let words = [("+", "+"), ("-", "-")];
        self.chain(Self::product, words, |_, a, b| wider(a, b))
    }

    fn product(&mut self) -> Parsed {
        let words = [("*", "*"), ("/", "/"), ("%", "%")];
        self.chain(Self::sign, words, |_, a, b| wider(a, b))
    }

    fn chain<const N: usize>(
        &mut self,
        part: fn(&mut Self) -> Parsed,
        words: [(&'static str, &'static str); N],
        kind: fn(&str, NumberKind, NumberKind) -> NumberKind,
    ) -> Parsed {
        let (mut left, mut of) = part(self)?;
        while let Some(sign) = self.one_of(words) {
            let (right, of_right) = part(self)?;
            let both = kind(sign, of, of_right);
            left = format!("({left} {sign} {right})");
            if sign == "/" && both == NumberKind::Whole {
                left = format!("({left} | int)");
            }
            of = both;
        }
        Ok((left, of))
    }

    fn sign(&mut self) -> Parsed {
        let mut signs = Vec::new();
        let words = [("-", "-"), ("+", "+"), ("not", "not "), ("!", "not ")];
        while let Some(sign) = self.one_of(words) {
            signs.push(sign);
            if signs.len() > DEEPEST {
                return Err("it has too many of - + ! in a row".to_owned());
            }
        }
        let (mut text, mut kind) = self.atom()?;
        for sign in signs.into_iter().rev() {
            match sign {
                "+" => {}
                "-" => text = format!("(-{text})"),
                not => {
                    text = format!("({not}{text})");
                    kind = NumberKind::Other;
                }
            }
        }
        Ok((text, kind))
    }

    fn atom(&mut self) -> Parsed {
        match self.next() {
            Some(Token::Number(text)) => {
                let kind = if text.contains('.') {
                    NumberKind::Number
                } else {
                    NumberKind::Whole
                };
                match text.parse::<f64>() {
                    Ok(_) => Ok((text.trim_end_matches('.').to_owned(), kind)),
                    Err(_) => Err(format!("`{text}` is not a number")),
                }
            }
            Some(Token::Text(text)) => {
                Ok((format!("{text:?}"), NumberKind::Other))
            }
            Some(Token::Sign("(")) => {
                let inner = self.choice()?;
                self.expect(")")?;
                Ok(inner)
            }
            Some(Token::Name(name @ ("true" | "false"))) => {
                Ok((name.to_owned(), NumberKind::Other))
            }
            Some(Token::Name(name)) if self.take("(") => self.call(name),
            Some(Token::Name(name)) => self.name(name),
            Some(token) => Err(format!("{} is not understood", token.shown())),
            None => Err("something is missing at its end".to_owned()),
        }
    }

    fn in_table(&mut self) -> Result<String, Refused> {
        let (text, _) = self.choice()?;
        if text.len() > LONGEST_REPEATED {
            return Err("an expression in interpolate_table is too long".into());
        }
        Ok(text)
    }

    /// A value from a table. It is interpolated between the rows; before the
    /// first row and behind the last one it is that row's.
    fn table(&mut self) -> Parsed {
        let x = self.in_table()?;
        let mut rows = Vec::new();
        while self.take(",") {
            self.expect("(")?;
            let at = self.in_table()?;
            self.expect(",")?;
            let value = self.in_table()?;
            self.expect(")")?;
            rows.push((at, value));
        }
        self.expect(")")?;
        let (Some((first, before)), Some((_, after))) =
            (rows.first(), rows.last())
        else {
            return Err("interpolate_table has no rows".to_owned());
        };
        let mut text = format!("({before} if {x} <= {first} else ");
        for ((from, low), (to, high)) in rows.iter().zip(rows.iter().skip(1)) {
            text += &format!(
                "{low} + ({high} - {low}) * ({x} - {from}) / ({to} - {from}) \
                 if {x} <= {to} else "
            );
        }
        text += &format!("{after})");
        Ok((text, NumberKind::Number))
    }

    fn call(&mut self, name: &str) -> Parsed {
        if name == "interpolate_table" {
            return self.table();
        }
        let mut all = vec![self.choice()?];
        while self.take(",") {
            all.push(self.choice()?);
        }
        self.expect(")")?;
        let kind = all
            .iter()
            .fold(NumberKind::Whole, |k, (_, of)| wider(k, *of));
        let of: Vec<_> = all.into_iter().map(|(text, _)| text).collect();
        match (name, of.as_slice()) {
            ("min" | "max", [_, _, ..]) => {
                Ok((format!("([{}] | {name})", of.join(", ")), kind))
            }
            ("int", [x]) => Ok((format!("({x} | int)"), NumberKind::Whole)),
            ("round", [x]) => {
                Ok((format!("({x} | round | int)"), NumberKind::Whole))
            }
            ("abs", [x]) => Ok((format!("({x} | abs)"), kind)),
            ("floor", [x]) => Ok((format!("({x} // 1)"), NumberKind::Whole)),
            ("ceil", [x]) => {
                Ok((format!("(-((-{x}) // 1))"), NumberKind::Whole))
            }
            _ => Err(format!(
                "the function {name} of {} values is not known; min, max, \
                 int, round, floor, ceil, abs and interpolate_table are",
                of.len()
            )),
        }
    }

    /// A name, with its index if it has one.
    fn name(&mut self, name: &str) -> Parsed {
        let index = if self.take("[") {
            let index = match self.next() {
                Some(Token::Number(text) | Token::Name(text)) => text,
                _ => return Err(format!("{name}[…] is not understood")),
            };
            self.expect("]")?;
            Some(index)
        } else {
            None
        };
        let first = index.is_none_or(|i| FIRST_TOOL.contains(&i));
        let found = match (ours(name), index) {
            (Some(Ours::Pair(x, _)), Some("0")) => {
                (x.to_owned(), NumberKind::Number)
            }
            (Some(Ours::Pair(_, y)), Some("1")) => {
                (y.to_owned(), NumberKind::Number)
            }
            (Some(Ours::Pair(..)), _) => {
                return Err(format!(
                    "write {name}[0] for x or {name}[1] for y"
                ));
            }
            // Nothing is printed with another extruder.
            (_, Some(_)) if !first && name == "is_extruder_used" => {
                ("false".to_owned(), NumberKind::Other)
            }
            (_, Some(i)) if !first => {
                return Err(format!(
                    "isoslice prints with one extruder, so there is no \
                     {name}[{i}]"
                ));
            }
            (Some(Ours::Is(kind, ours)), _) => (ours.to_owned(), kind),
            (Some(Ours::AtEnd(kind, ours)), _)
                if self.names.place == Place::End =>
            {
                (ours.to_owned(), kind)
            }
            (Some(Ours::AtEnd(..)), _) => return Err(AT_THE_END.to_owned()),
            (Some(Ours::OfLayer(kind, _, at_end)), _)
                if self.names.place == Place::End =>
            {
                (at_end.to_owned(), kind)
            }
            (Some(Ours::OfLayer(kind, of_layer, _)), _) => {
                (of_layer.to_owned(), kind)
            }
            (Some(Ours::ByScope(kind, of_layer, _)), _)
                if self.names.place == Place::Layer =>
            {
                (of_layer.to_owned(), kind)
            }
            (Some(Ours::ByScope(kind, _, other)), _) => {
                (other.to_owned(), kind)
            }
            // The name is one of this program's, but may mean something else in
            // other slicers.
            _ if (self.names.own)(name) => {
                (name.to_owned(), NumberKind::Number)
            }
            (Some(Ours::None(why)), _) => return Err(why.to_owned()),
            (None, _) => {
                return Err("isoslice does not know it; docs/gcode.md lists \
                            what there is"
                    .to_owned());
            }
        };
        Ok(found)
    }
}

/// An expression that tells whether a text matches a pattern. The pattern is
/// one word or several (`A|B`), which are the whole text or anywhere in it
/// (`.*A.*`).
fn looks_like(text: &str, pattern: &str) -> Result<String, Refused> {
    let refused = || {
        Err(format!(
            "only patterns of words are known, as in /.*PET.*/ and /A|B/, not \
             /{pattern}/"
        ))
    };
    let begins = pattern.strip_prefix(".*");
    let ends = begins.unwrap_or(pattern).strip_suffix(".*");
    let words = ends.or(begins).unwrap_or(pattern);
    if begins.is_some() != ends.is_some() {
        return refused();
    }
    let bare = words.strip_prefix('(').and_then(|w| w.strip_suffix(')'));
    let plain = |c: char| c.is_ascii_alphanumeric() || " _-".contains(c);
    let mut alternatives = Vec::new();
    let words = bare.unwrap_or(words);
    if words.contains('|') && text.len() > LONGEST_REPEATED {
        return Err(
            "what is before a pattern of several words is too long".into()
        );
    }
    for word in words.split('|') {
        if word.is_empty() || !word.chars().all(plain) {
            return refused();
        }
        alternatives.push(match begins {
            Some(_) => format!("{word:?} in {text}"),
            None => format!("{text} == {word:?}"),
        });
    }
    Ok(format!("({})", alternatives.join(" or ")))
}

fn wider(a: NumberKind, b: NumberKind) -> NumberKind {
    match (a, b) {
        (NumberKind::Whole, NumberKind::Whole) => NumberKind::Whole,
        (NumberKind::Other, _) | (_, NumberKind::Other) => NumberKind::Other,
        _ => NumberKind::Number,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_do_not_grow_without_bounds() {
        let names = Names {
            place: Place::Start,
            own: &|_| false,
        };
        let one = translated("printer_model =~ /(A|B)/", names).unwrap();
        let expected = "(printer.model == \"A\" or printer.model == \"B\")";
        assert_eq!(one, expected);
        let patterns = |count| {
            let end = "=~ /A|B/)".repeat(count);
            let begin = "(".repeat(count);
            translated(&format!("{begin}printer_model {end}"), names)
        };
        assert!(patterns(2).is_ok());
        let error = patterns(12).unwrap_err();
        assert!(error.contains("too long"), "{error}");
    }
}

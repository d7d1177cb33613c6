//! Pauses of `gcode.layer` that come in no layer.
//!
//! In: the template, then each layer's text. Out: a warning of each pause that none of
//! the layers had. A condition that no layer meets is no mistake by itself, but the
//! print goes on where somebody meant to put in a nut.

use isoslice_settings::Flavour;

/// A line of the template that pauses the print.
struct Pause {
    /// The line's number, from 1.
    number: usize,
    /// The line without the template's own code.
    text: String,
    /// The command.
    word: &'static str,
    /// True if values of placeholders stand in the line, too.
    filled_in: bool,
}

/// The pauses of a template that no layer has had so far.
pub(super) struct Pauses(Vec<Pause>);

impl Pauses {
    /// Those of a template for some firmware.
    pub(super) fn of(template: &str, flavour: Flavour) -> Pauses {
        let template = without_comments(template);
        let lines = template.lines().zip(1..);
        let pauses = lines.filter_map(|(line, number)| {
            let text = without_code(line);
            Some(Pause {
                number,
                word: pause_of(&text, flavour)?,
                text,
                filled_in: line.contains("{{"),
            })
        });
        Pauses(pauses.collect())
    }

    /// Takes those out that a layer's text has, each line one of them: two equal lines
    /// of the template have conditions of their own.
    pub(super) fn seen(&mut self, layer: &str) {
        if self.0.is_empty() {
            return;
        }
        for line in layer.lines().map(str::trim) {
            let same = |pause: &Pause| {
                if pause.filled_in {
                    begins_with(line, pause.word)
                } else {
                    line == pause.text
                }
            };
            if let Some(at) = self.0.iter().position(same) {
                self.0.remove(at);
            }
        }
    }

    /// What to tell of those that are left.
    pub(super) fn missed(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|Pause { number, text, .. }| {
            format!(
                "gcode.layer, line {number}: {text} comes in no layer, as none meets \
                 its condition; layer_bottom <= 12 and layer_z > 12 is met by one \
                 layer of any part that is higher than 12 mm"
            )
        })
    }
}

/// A template without its own comments, with as many lines.
fn without_comments(template: &str) -> String {
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{#") {
        let (comment, behind) = after.split_once("#}").unwrap_or((after, ""));
        text.push_str(before);
        text.extend(comment.chars().filter(|c| *c == '\n'));
        rest = behind;
    }
    text.push_str(rest);
    text
}

/// A line without what stands in the template's brackets.
fn without_code(line: &str) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some((before, after)) = rest.split_once('{') {
        text.push_str(before);
        rest = after.split_once('}').map_or("", |(_, behind)| behind);
        rest = rest.strip_prefix('}').unwrap_or(rest);
    }
    text.push_str(rest);
    text.trim().to_owned()
}

/// True if a line begins with a command, in letters of any size.
fn begins_with(line: &str, command: &str) -> bool {
    let Some((own, rest)) = line.split_at_checked(command.len()) else {
        return false;
    };
    own.eq_ignore_ascii_case(command)
        && (rest.is_empty() || rest.starts_with([' ', ';']))
}

/// The pause that a line is, if it is one of some firmware's, or the change of filament
/// that users of others define.
fn pause_of(line: &str, flavour: Flavour) -> Option<&'static str> {
    let known = flavour.firmware().pauses.known.iter();
    let mut known = known.map(|(word, _)| *word).chain(["M600"]);
    known.find(|word| begins_with(line, word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_that_come_in_no_layer_are_named() {
        let template = "{% if layer == 3 %}\nM0 Put the nut in\n{% endif %}\n\
                        M117 {{ layer }}\n\
                        {% if layer_z > 9 %}m600{% endif %}\n  M25 ; now\nM04\n\
                        {# no\nM0\n#}PAUSE";
        let missed = |layers: &[&str]| {
            let mut pauses = Pauses::of(template, Flavour::Marlin);
            layers.iter().for_each(|layer| pauses.seen(layer));
            pauses.missed().collect::<Vec<_>>()
        };
        let all = missed(&["M117 1\n"]);
        assert_eq!(all.len(), 3, "{all:?}");
        assert!(all[0].contains("line 2: M0 Put the nut in comes in no layer"));
        let one = missed(&["M0 Put the nut in\nM117 3\n", "  M25 ; now\n"]);
        assert!(one.len() == 1 && one[0].contains("line 5: m600"), "{one:?}");
        assert!(missed(&["M0 Put the nut in\nM25 ; now\nm600"]).is_empty());
        let of = |template: &str| Pauses::of(template, Flavour::Klipper);
        let mut filled = of("M600 ; at {{ layer_z }} mm");
        filled.seen("M6001\n");
        assert_eq!(filled.missed().count(), 1);
        filled.seen("M600 ; at 9 mm\n");
        assert_eq!(filled.missed().count(), 0);
        // Two lines, of which one comes.
        let mut twice = of("{% if layer == 2 %}PAUSE{% endif %}\nPAUSE");
        twice.seen("PAUSE\n");
        assert_eq!(twice.missed().count(), 1);
        for none in ["{% raw", "{# PAUSE", "M0", "É", "{"] {
            assert_eq!(of(none).missed().count(), 0, "{none}");
        }
    }
}

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
    /// True if values of placeholders stand in the line, too.
    filled_in: bool,
}

/// The pauses of a template that no layer has had so far.
pub(super) struct Pauses(Vec<Pause>);

impl Pauses {
    /// Those of a template.
    pub(super) fn of(template: &str) -> Pauses {
        let lines = template.lines().zip(1..);
        let pauses = lines.filter_map(|(line, number)| {
            let text = without_code(line);
            is_pause(&text).then_some(Pause {
                number,
                text,
                filled_in: line.contains("{{"),
            })
        });
        Pauses(pauses.collect())
    }

    /// Takes those out that a layer's text has.
    pub(super) fn seen(&mut self, layer: &str) {
        self.0.retain(|pause| {
            let first = pause.text.split(' ').next().unwrap_or_default();
            let same = |line: &str| {
                if pause.filled_in {
                    line.trim_start().starts_with(first)
                } else {
                    line.trim() == pause.text
                }
            };
            !layer.lines().any(same)
        });
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

/// True if a line is a pause of any firmware's.
fn is_pause(line: &str) -> bool {
    let all = Flavour::ALL.iter();
    let mut known = all.flat_map(|of| of.firmware().pauses.known);
    known.any(|(word, _)| {
        let rest = line.strip_prefix(word);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with([' ', ';']))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_that_come_in_no_layer_are_named() {
        let template = "{% if layer == 3 %}\nM0 Put the nut in\n{% endif %}\n\
                        M117 {{ layer }}\n\
                        {% if layer_z > 9 %}M600{% endif %}\n  PAUSE ; now\nM04";
        let missed = |layers: &[&str]| {
            let mut pauses = Pauses::of(template);
            layers.iter().for_each(|layer| pauses.seen(layer));
            pauses.missed().collect::<Vec<_>>()
        };
        let all = missed(&["M117 1\n"]);
        assert_eq!(all.len(), 3, "{all:?}");
        assert!(all[0].contains("line 2: M0 Put the nut in comes in no layer"));
        let one = missed(&["M0 Put the nut in\nM117 3\n", "  PAUSE ; now\n"]);
        assert!(one.len() == 1 && one[0].contains("line 5: M600"), "{one:?}");
        assert!(missed(&["M0 Put the nut in\nPAUSE ; now\nM600"]).is_empty());
        let filled = Pauses::of("M600 ; at {{ layer_z }} mm");
        assert_eq!(filled.missed().count(), 1);
        let mut filled = filled;
        filled.seen("M600 ; at 9 mm\n");
        assert_eq!(filled.missed().count(), 0);
        assert_eq!(Pauses::of("{% raw").missed().count(), 0);
    }
}

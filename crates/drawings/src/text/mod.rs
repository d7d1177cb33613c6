//! Text as a drawing.
//!
//! Each character is one letter of the font, from the left to the right.
//! Ligatures, and scripts whose letters change beside one another, are not
//! known; a warning says so where it matters.

mod font;
mod kerning;
#[cfg(test)]
mod tests;

use crate::drawing::{Drawing, FILL};
use crate::outline::{Fill, Outline};
use font::Font;
use glam::{DAffine2, DVec2};
use isocontour::Rect;
use isoslice_base::problem::{NamedProblem, Problem};
use isoslice_base::units::human_number;

/// The most characters of a text.
const MOST_CHARACTERS: usize = 10_000;

/// Where lines stand, from side to side. The origin is at their left end, in
/// their middle or at their right end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// They begin at x = 0.
    #[default]
    Left,
    /// Their middles are at x = 0.
    Centre,
    /// They end at x = 0.
    Right,
}

/// How high lines stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Vertical {
    /// The first line stands on y = 0.
    #[default]
    Base,
    /// The middle of what is drawn is at y = 0.
    Centre,
    /// The top of what is drawn is at y = 0.
    Top,
    /// The bottom of what is drawn is at y = 0.
    Bottom,
}

/// How a text is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextOptions {
    /// The font's size as in other programs, that of an em, mm. Capitals are
    /// some 0.7 of it high. 1 mm is 2.83 points.
    pub size_mm: f64,
    /// Where lines stand from side to side.
    pub align: Align,
    /// How high they stand.
    pub vertical: Vertical,
    /// From one line to the next, mm. Default: what the font says.
    pub line_mm: Option<f64>,
    /// What is added between all letters, mm.
    pub spacing_mm: f64,
}

impl Default for TextOptions {
    fn default() -> Self {
        TextOptions {
            size_mm: 10.0,
            align: Align::Left,
            vertical: Vertical::Base,
            line_mm: None,
            spacing_mm: 0.0,
        }
    }
}

impl Drawing {
    /// Draws a text, which may have several lines, in the font of a file (TTF,
    /// OTF, or the first of a TTC; without hints, and a variable one as it is
    /// by default), or in DejaVu Sans if there is none: it has Latin, Greek and
    /// Cyrillic letters.
    ///
    /// # Errors
    /// If the font cannot be read, the text has nothing that can be seen or is
    /// too long, or an option makes no sense.
    pub fn from_text(
        text: &str,
        font: Option<&[u8]>,
        options: &TextOptions,
    ) -> Result<Drawing, NamedProblem> {
        let short: String = text.chars().take(40).collect();
        let name = format!("text({short:?})");
        let made = draw(text, font, options).and_then(|(outline, warnings)| {
            Drawing::warned(name.clone(), &[outline], warnings, FILL)
        });
        made.map_err(|problem| NamedProblem::new(&name, problem))
    }
}

/// The outline of a text, and warnings.
fn draw(
    text: &str,
    font: Option<&[u8]>,
    options: &TextOptions,
) -> Problem<(Outline, Vec<String>)> {
    let TextOptions {
        size_mm,
        spacing_mm,
        ..
    } = *options;
    if !(1e-3..=1e5).contains(&size_mm) {
        return Err(format!(
            "its size is {} mm; give one from 0.001 to 100000",
            human_number(size_mm)
        ));
    }
    let far = |mm: f64| !mm.is_finite() || mm.abs() > 1e5;
    if far(spacing_mm) || far(options.line_mm.unwrap_or(0.0)) {
        return Err("the spacing is beyond 100 m; give less".into());
    }
    if text.chars().count() > MOST_CHARACTERS {
        return Err(format!(
            "it has more than {MOST_CHARACTERS} characters; draw it in parts"
        ));
    }
    let font = Font::new(font)?;
    let scale = size_mm / font.em;
    let line_mm = options.line_mm.unwrap_or(font.line * scale);
    let mut outline = Outline::new(Fill::NonZero);
    let mut missing = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let (letters, length) =
            lay_out(line, &font, scale, options, &mut missing);
        let start = match options.align {
            Align::Left => 0.0,
            Align::Centre => -0.5 * length,
            Align::Right => -length,
        };
        for (letter, x) in letters {
            let from = DVec2::new(start + x, -line_mm * i as f64);
            font.draw(letter, from, scale, &mut outline)?;
            if outline.len() > crate::area::MOST_CURVES {
                return Err("it has too many curves; draw it in parts".into());
            }
        }
    }
    let outline = raised(outline, options.vertical);
    Ok((outline, warnings(text, &missing)))
}

/// The letters of a line and where they begin, and the length of the line, mm.
fn lay_out(
    line: &str,
    font: &Font,
    scale: f64,
    options: &TextOptions,
    missing: &mut Vec<char>,
) -> (Vec<(skrifa::GlyphId, f64)>, f64) {
    let mut letters = Vec::new();
    let (mut x, mut last) = (0.0, None);
    for character in line.chars() {
        // A tab is as wide as four spaces.
        let (character, times) = match character {
            '\t' => (' ', 4.0),
            other => (other, 1.0),
        };
        let Some(letter) = font.letter(character) else {
            if !character.is_control() && !missing.contains(&character) {
                missing.push(character);
            }
            continue;
        };
        if let Some(last) = last {
            x += font.kerning(last, letter) * scale + options.spacing_mm;
        }
        letters.push((letter, x));
        x += font.width(letter) * scale * times;
        last = Some(letter);
    }
    (letters, x)
}

/// At its height.
fn raised(outline: Outline, vertical: Vertical) -> Outline {
    let curves = outline.curves().iter().flat_map(|c| c.monotone());
    let bounds = curves.map(|c| c.bounds()).fold(Rect::EMPTY, Rect::union);
    let by = match vertical {
        Vertical::Base => return outline,
        Vertical::Centre => -0.5 * (bounds.min.y + bounds.max.y),
        Vertical::Top => -bounds.max.y,
        Vertical::Bottom => -bounds.min.y,
    };
    if by.is_finite() {
        outline.mapped(DAffine2::from_translation(DVec2::new(0.0, by)))
    } else {
        outline
    }
}

fn warnings(text: &str, missing: &[char]) -> Vec<String> {
    let mut warnings = Vec::new();
    if !missing.is_empty() {
        let all: String = missing.iter().take(20).collect();
        warnings.push(format!(
            "the font has no {all:?}; give a font file that has it"
        ));
    }
    // Hebrew and Arabic; Indic; joined marks; those of the South East.
    let shaped = |c: char| {
        matches!(u32::from(c),
            0x300..=0x36f | 0x590..=0x8ff | 0x900..=0xdff | 0xe00..=0x109f
            | 0x1780..=0x18af | 0xfb1d..=0xfdff | 0xfe70..=0xfeff)
    };
    if text.chars().any(shaped) {
        warnings.push(
            "letters of this script are not joined or turned round; draw the \
             text in a drawing program, as paths"
                .into(),
        );
    }
    warnings
}

//! A font: the outlines of its letters, and how they stand beside one another.

use super::kerning::Kerning;
use crate::outline::Outline;
use glam::DVec2;
use isoslice_base::problem::Problem;
use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::raw::{FileRef, FontRef};
use skrifa::{GlyphId, MetadataProvider};

/// The font for texts without one.
const OWN: &[u8] = include_bytes!("../../fonts/DejaVuSans.ttf");

pub(super) struct Font<'a> {
    font: FontRef<'a>,
    kerning: Kerning<'a>,
    widths: GlyphMetrics<'a>,
    /// The font's units in an em.
    pub(super) em: f64,
    /// From one line's base to the next, in the font's units.
    pub(super) line: f64,
}

impl<'a> Font<'a> {
    /// The font of a file, or the one that is always there.
    pub(super) fn new(bytes: Option<&'a [u8]>) -> Problem<Font<'a>> {
        let bytes = bytes.unwrap_or(OWN);
        if bytes.starts_with(b"wOF") {
            return Err("the font is a web font (WOFF); give the TTF or OTF \
                        file"
                .into());
        }
        let broken = |e| {
            format!("the font cannot be read ({e}); give a TTF or OTF file")
        };
        let font = match FileRef::new(bytes).map_err(broken)? {
            FileRef::Font(font) => font,
            FileRef::Collection(all) => all.get(0).map_err(broken)?,
        };
        let location = LocationRef::default();
        let metrics = font.metrics(Size::unscaled(), location);
        let em = f64::from(metrics.units_per_em);
        // What the format allows.
        if !(16.0..=16384.0).contains(&em) {
            return Err(format!("the font's em has {em} units; give another"));
        }
        let line = metrics.ascent - metrics.descent + metrics.leading;
        let line = f64::from(line);
        Ok(Font {
            kerning: Kerning::new(&font),
            widths: font.glyph_metrics(Size::unscaled(), location),
            em,
            line: if line > 0.0 { line } else { 1.2 * em },
            font,
        })
    }

    /// The letter for a character, if there is one.
    pub(super) fn letter(&self, character: char) -> Option<GlyphId> {
        let letter = self.font.charmap().map(character)?;
        (letter != GlyphId::NOTDEF).then_some(letter)
    }

    /// From a letter's beginning to the next one's.
    pub(super) fn width(&self, letter: GlyphId) -> f64 {
        self.widths.advance_width(letter).unwrap_or(0.0).into()
    }

    /// How much farther away the second of two letters is.
    pub(super) fn kerning(&self, a: GlyphId, b: GlyphId) -> f64 {
        self.kerning.between(a, b)
    }

    /// Draws a letter from a place on, in mm.
    pub(super) fn draw(
        &self,
        letter: GlyphId,
        from: DVec2,
        scale: f64,
        outline: &mut Outline,
    ) -> Problem<()> {
        let glyphs = self.font.outline_glyphs();
        let Some(glyph) = glyphs.get(letter) else {
            return Ok(());
        };
        let mut pen = Pen {
            outline,
            from,
            scale,
        };
        let settings =
            DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        glyph.draw(settings, &mut pen).map_err(|e| {
            format!("letter {letter} of the font cannot be drawn: {e}")
        })?;
        outline.close();
        Ok(())
    }
}

/// Draws in mm what a font draws in its units.
struct Pen<'a> {
    outline: &'a mut Outline,
    from: DVec2,
    scale: f64,
}

impl Pen<'_> {
    fn place(&self, x: f32, y: f32) -> DVec2 {
        self.from + DVec2::new(x.into(), y.into()) * self.scale
    }
}

impl OutlinePen for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.outline.move_to(self.place(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.outline.line_to(self.place(x, y));
    }

    fn quad_to(&mut self, ax: f32, ay: f32, x: f32, y: f32) {
        self.outline.quad_to(self.place(ax, ay), self.place(x, y));
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let (a, b) = (self.place(ax, ay), self.place(bx, by));
        self.outline.cubic_to(a, b, self.place(x, y));
    }

    fn close(&mut self) {
        self.outline.close();
    }
}

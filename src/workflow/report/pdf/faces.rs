//! The two font weights: widths and glyphs of a line of text.

use harfrust::{Direction, FontRef, ShapeOptions, ShaperData, UnicodeBuffer};
use krilla::text::{Font, GlyphId, KrillaGlyph};

use super::PdfError;
use crate::fonts;

/// One weight.
pub struct Face {
    /// The font embedded in the PDF.
    pub font: Font,
    reference: FontRef<'static>,
    shaping: ShaperData,
}

/// Both weights.
pub struct Faces {
    regular: Face,
    strong: Face,
}

impl Faces {
    /// The fonts of the program.
    pub fn new() -> Result<Self, PdfError> {
        Ok(Self {
            regular: Face::new(fonts::REGULAR)?,
            strong: Face::new(fonts::STRONG)?,
        })
    }

    /// One of the weights.
    pub fn get(&self, bold: bool) -> &Face {
        if bold { &self.strong } else { &self.regular }
    }

    /// Width of a line of text (pt).
    pub fn width(&self, text: &str, size: f64, bold: bool) -> f64 {
        let glyphs = self.get(bold).glyphs(text);
        size * glyphs.iter().map(|g| f64::from(g.x_advance)).sum::<f64>()
    }
}

impl Face {
    fn new(bytes: &'static [u8]) -> Result<Self, PdfError> {
        let font = Font::new(bytes.into(), 0).ok_or(PdfError::Font)?;
        let reference = FontRef::new(bytes).map_err(|_| PdfError::Font)?;
        Ok(Self {
            font,
            shaping: ShaperData::new(&reference),
            reference,
        })
    }

    /// Glyphs from left to right, with lengths relative to the font size.
    pub fn glyphs(&self, text: &str) -> Vec<KrillaGlyph> {
        let shaper = self.shaping.shaper(&self.reference).build();
        let mut buffer = UnicodeBuffer::new();
        buffer.push_str(text);
        buffer.guess_segment_properties();
        buffer.set_direction(Direction::LeftToRight);
        let units = shaper.units_per_em() as f32;
        let shaped = shaper.shape(buffer, ShapeOptions::new());
        let infos = shaped.glyph_infos();
        let start = |k: usize| {
            infos
                .get(k)
                .map_or(text.len(), |info| info.cluster as usize)
        };
        let glyphs = infos.iter().zip(shaped.glyph_positions()).enumerate();
        glyphs
            .map(|(k, (info, position))| {
                // Glyphs of one cluster represent the same text.
                let end = (k + 1..=infos.len()).map(start).find(|end| *end > start(k));
                KrillaGlyph::new(
                    GlyphId::new(info.glyph_id),
                    position.x_advance as f32 / units,
                    position.x_offset as f32 / units,
                    position.y_offset as f32 / units,
                    position.y_advance as f32 / units,
                    start(k)..end.unwrap_or(text.len()),
                    None,
                )
            })
            .collect()
    }
}

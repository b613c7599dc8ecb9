//! Outlines of letters, from the one face inside the program.

use ttf_parser::{Face, GlyphId, OutlineBuilder};
use zeno::{Command, Point};

/// Height of a lower-case x over the size of letters: what `ex` means in a drawing.
pub(super) const EX: f32 = 0.547;

/// The face of all letters.
pub(super) struct Letters {
    face: Face<'static>,
}

impl Letters {
    /// The font face, if the embedded font is valid.
    pub(super) fn new() -> Option<Self> {
        Some(Self {
            face: Face::parse(dejavu::sans::regular(), 0).ok()?,
        })
    }

    /// Width of a text of this size.
    pub(super) fn width(&self, text: &str, size: f32) -> f32 {
        let scale = self.scale(size);
        self.glyphs(text)
            .map(|glyph| self.advance(glyph) * scale)
            .sum()
    }

    /// The outlines of a text whose base line starts there, y downwards.
    pub(super) fn outline(&self, text: &str, size: f32, (x, y): (f32, f32)) -> Vec<Command> {
        let scale = self.scale(size);
        let mut pen = Pen {
            path: Vec::new(),
            scale,
            x,
            y,
        };
        for glyph in self.glyphs(text) {
            // A blank has no outline, which is no error.
            let _ = self.face.outline_glyph(glyph, &mut pen);
            pen.x += self.advance(glyph) * scale;
        }
        pen.path
    }

    fn glyphs(&self, text: &str) -> impl Iterator<Item = GlyphId> {
        text.chars()
            .filter(|letter| *letter != '\u{200b}')
            .map(|letter| self.face.glyph_index(letter).unwrap_or_default())
    }

    fn advance(&self, glyph: GlyphId) -> f32 {
        f32::from(self.face.glyph_hor_advance(glyph).unwrap_or_default())
    }

    fn scale(&self, size: f32) -> f32 {
        size / f32::from(self.face.units_per_em())
    }
}

/// Turns the face's outlines over and puts them in their place.
struct Pen {
    path: Vec<Command>,
    scale: f32,
    x: f32,
    y: f32,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> Point {
        Point::new(self.x + x * self.scale, self.y - y * self.scale)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.push(Command::MoveTo(self.at(x, y)));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.push(Command::LineTo(self.at(x, y)));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path
            .push(Command::QuadTo(self.at(x1, y1), self.at(x, y)));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.push(Command::CurveTo(
            self.at(x1, y1),
            self.at(x2, y2),
            self.at(x, y),
        ));
    }

    fn close(&mut self) {
        self.path.push(Command::Close);
    }
}

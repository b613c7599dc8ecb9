//! White paper on which paths are laid, one over the other.

use zeno::{Cap, Command, Join, Mask, Stroke, Style, Transform};

use super::Image;

/// A colour and how much of it covers what lies below, 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ink {
    pub(super) color: [u8; 3],
    pub(super) opacity: f32,
}

/// Image that is painted on.
pub(super) struct Canvas {
    image: Image,
}

impl Canvas {
    pub(super) fn white(width: usize, height: usize) -> Self {
        Self {
            image: Image {
                width,
                height,
                pixels: vec![[255; 3]; width * height],
            },
        }
    }

    pub(super) fn into_image(self) -> Image {
        self.image
    }

    /// The inside of a path.
    pub(super) fn fill(&mut self, path: &[Command], transform: Transform, ink: Ink) {
        self.lay(path, zeno::Fill::NonZero.into(), transform, ink);
    }

    /// A line along a path; its width in units of the path.
    pub(super) fn stroke(
        &mut self,
        path: &[Command],
        transform: Transform,
        (width, cap): (f32, Cap),
        ink: Ink,
    ) {
        let mut stroke = Stroke::new(width);
        stroke.cap(cap).join(Join::Round);
        self.lay(path, stroke.into(), transform, ink);
    }

    fn lay(&mut self, path: &[Command], style: Style<'_>, transform: Transform, ink: Ink) {
        let mut mask = Mask::new(path);
        mask.style(style).transform(Some(transform));
        let (cover, placed) = mask.render();
        let across = usize::try_from(placed.width).unwrap_or(0).max(1);
        for (row, line) in cover.chunks_exact(across).enumerate() {
            let Some(y) = inside(placed.top, row, self.image.height) else {
                continue;
            };
            for (column, &covered) in line.iter().enumerate() {
                if covered == 0 {
                    continue;
                }
                let Some(x) = inside(placed.left, column, self.image.width) else {
                    continue;
                };
                if let Some(pixel) = self.image.pixels.get_mut(y * self.image.width + x) {
                    let share = ink.opacity * f32::from(covered) / 255.0;
                    for (below, above) in pixel.iter_mut().zip(ink.color) {
                        *below = mixed(*below, above, share);
                    }
                }
            }
        }
    }
}

/// Index of the n-th pixel of a mask that starts there. Returns `None` outside of the image.
fn inside(start: i32, n: usize, size: usize) -> Option<usize> {
    let place = i64::from(start) + i64::try_from(n).ok()?;
    usize::try_from(place).ok().filter(|place| *place < size)
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // between two bytes
fn mixed(below: u8, above: u8, share: f32) -> u8 {
    let (below, above) = (f32::from(below), f32::from(above));
    (below + (above - below) * share).round() as u8
}

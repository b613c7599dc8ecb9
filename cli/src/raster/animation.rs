//! Images one after the other as a looping GIF: one palette for all, and of each image only what changed.

use std::collections::HashMap;

use color_quant::NeuQuant;
use gif::{DisposalMethod, Encoder, Frame, Repeat};

use super::{Image, failed};
use crate::failure::Outcome;

/// Colours of the palette; one more place means "as before".
const COLORS: usize = 255;
/// The place that means "as before".
const AS_BEFORE: u8 = 255;
/// One in this number of the colours is sampled when the palette is made.
const SAMPLED: usize = 7;

/// A GIF of these images, all of one size; each is shown for its time, in hundredths of a second.
///
/// # Errors
/// [`crate::failure::Failure::Tried`] where images differ in size or are too large for the format.
pub(crate) fn gif(images: &[(Image, u16)]) -> Outcome<Vec<u8>> {
    let Some((first, _)) = images.first() else {
        return Err(failed(&"there is no image"));
    };
    let [width, height] = [first.width, first.height].map(u16::try_from);
    let (Ok(width), Ok(height)) = (width, height) else {
        return Err(failed(&"it is too large for a GIF"));
    };
    if images
        .iter()
        .any(|(image, _)| (image.width, image.height) != (first.width, first.height))
    {
        return Err(failed(&"its images differ in size"));
    }
    let mut palette = Palette::of(images);
    let mut file = Vec::new();
    let mut encoder =
        Encoder::new(&mut file, width, height, &palette.bytes()).map_err(|error| failed(&error))?;
    encoder
        .set_repeat(Repeat::Infinite)
        .map_err(|error| failed(&error))?;
    let mut before: Option<&Image> = None;
    for (image, delay) in images {
        let frame = change(before, image, *delay, &mut palette);
        encoder
            .write_frame(&frame)
            .map_err(|error| failed(&error))?;
        before = Some(image);
    }
    drop(encoder);
    Ok(file)
}

/// Change from one image to the next: the smallest rectangle that holds every changed pixel.
fn change(
    before: Option<&Image>,
    image: &Image,
    delay: u16,
    palette: &mut Palette,
) -> Frame<'static> {
    let same = |place: usize| {
        before.is_some_and(|before| before.pixels.get(place) == image.pixels.get(place))
    };
    let (mut left, mut right, mut top, mut bottom) = (image.width, 0, image.height, 0);
    for y in 0..image.height {
        for x in 0..image.width {
            if !same(y * image.width + x) {
                (left, right) = (left.min(x), right.max(x + 1));
                (top, bottom) = (top.min(y), bottom.max(y + 1));
            }
        }
    }
    if left >= right {
        // Nothing changed: one pixel that stays, for its time.
        (left, right, top, bottom) = (0, 1, 0, 1);
    }
    let mut places = Vec::with_capacity((right - left) * (bottom - top));
    for y in top..bottom {
        for x in left..right {
            let place = y * image.width + x;
            places.push(match image.pixels.get(place) {
                Some(color) if !same(place) => palette.place(*color),
                _ => AS_BEFORE,
            });
        }
    }
    // All are below the size of the image, which a GIF holds.
    let [left, top, width, height] =
        [left, top, right - left, bottom - top].map(|side| u16::try_from(side).unwrap_or(u16::MAX));
    Frame {
        delay,
        dispose: DisposalMethod::Keep,
        transparent: Some(AS_BEFORE),
        left,
        top,
        width,
        height,
        buffer: places.into(),
        ..Frame::default()
    }
}

/// The colours of all images, and which one stands for another.
struct Palette {
    colors: Vec<[u8; 3]>,
    known: HashMap<[u8; 3], u8>,
}

impl Palette {
    fn of(images: &[(Image, u16)]) -> Self {
        let mut all: Vec<[u8; 3]> = Vec::new();
        for (image, _) in images {
            let mut colors = image.pixels.clone();
            colors.sort_unstable();
            colors.dedup();
            all.extend(colors);
        }
        all.sort_unstable();
        let mut once = all.clone();
        once.dedup();
        let colors = if once.len() <= COLORS {
            once
        } else {
            chosen(&all)
        };
        Self {
            colors,
            known: HashMap::new(),
        }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.colors.as_flattened().to_vec();
        bytes.resize(3 * (COLORS + 1), 0);
        bytes
    }

    fn place(&mut self, color: [u8; 3]) -> u8 {
        *self.known.entry(color).or_insert_with(|| {
            let far = |other: &[u8; 3]| -> i32 {
                let steps = other.iter().zip(color);
                steps
                    .map(|(a, b)| (i32::from(*a) - i32::from(b)).pow(2))
                    .sum()
            };
            let nearest = self.colors.iter().enumerate().min_by_key(|(_, o)| far(o));
            nearest.map_or(0, |(place, _)| u8::try_from(place).unwrap_or(0))
        })
    }
}

/// Few colours for many, white among them.
fn chosen(all: &[[u8; 3]]) -> Vec<[u8; 3]> {
    let opaque: Vec<u8> = all
        .iter()
        .flat_map(|[red, green, blue]| [*red, *green, *blue, 255])
        .collect();
    let net = NeuQuant::new(i32::try_from(SAMPLED).unwrap_or(1), COLORS - 1, &opaque);
    let bytes = net.color_map_rgb();
    let mut colors = vec![[255; 3]];
    colors.extend(bytes.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]));
    colors
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(dark: usize) -> Image {
        let mut pixels = vec![[255; 3]; 12];
        pixels[dark] = [10, 20, 30];
        Image {
            width: 4,
            height: 3,
            pixels,
        }
    }

    #[test]
    fn what_is_read_back_is_what_was_drawn() {
        let drawn = [5, 6, 6, 11].map(|dark| (image(dark), 4));
        let file = gif(&drawn).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut reader = options.read_info(file.as_slice()).unwrap();
        assert_eq!((reader.width(), reader.height()), (4, 3));
        assert_eq!(reader.repeat(), Repeat::Infinite);
        let mut shown = vec![[0; 3]; 12];
        for (image, delay) in &drawn {
            let frame = reader.read_next_frame().unwrap().unwrap();
            assert_eq!(frame.delay, *delay);
            for (place, color) in frame.buffer.chunks_exact(4).enumerate() {
                let across = usize::from(frame.width);
                let (x, y) = (place % across, place / across);
                if color[3] == 255 {
                    shown[(y + usize::from(frame.top)) * 4 + x + usize::from(frame.left)] =
                        [color[0], color[1], color[2]];
                }
            }
            assert_eq!(shown, image.pixels);
        }
        assert!(reader.read_next_frame().unwrap().is_none());
    }

    #[test]
    fn many_colours_become_few_and_white_stays_white() {
        let pixels: Vec<[u8; 3]> = (0..40_u8)
            .flat_map(|red| (0..40_u8).map(move |green| [6 * red, 6 * green, 90]))
            .chain([[255; 3]])
            .collect();
        let mut palette = Palette::of(&[(
            Image {
                width: pixels.len(),
                height: 1,
                pixels,
            },
            1,
        )]);
        let white = palette.place([255; 3]);
        assert_eq!(palette.colors[usize::from(white)], [255; 3]);
        assert!(palette.colors.len() <= COLORS);
        let near = palette.place([120, 120, 90]);
        for (found, asked) in palette.colors[usize::from(near)]
            .iter()
            .zip([120, 120, 90_i32])
        {
            assert!((i32::from(*found) - asked).abs() < 25);
        }
    }

    #[test]
    fn images_of_two_sizes_are_refused() {
        let small = Image {
            width: 1,
            height: 1,
            pixels: vec![[0; 3]],
        };
        gif(&[(image(0), 1), (small, 1)]).unwrap_err();
        gif(&[]).unwrap_err();
    }
}

//! Our own drawings as pixels: the few kinds of SVG element that we write, painted on white. One drawing is the truth for
//! SVG, PNG and GIF; letters come from a face inside the program, so that a picture is the same on every machine.

mod animation;
mod canvas;
mod letters;
mod svg;

pub(crate) use animation::gif;
pub(crate) use svg::painted;

use crate::failure::{Failure, Outcome};

/// Pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Image {
    /// Pixels across.
    pub(crate) width: usize,
    /// Pixels down.
    pub(crate) height: usize,
    /// Red, green, blue of each.
    pub(crate) pixels: Vec<[u8; 3]>,
}

/// Pixels of a PNG per pixel of the page: sharp in print and on fine screens.
const PNG_SCALE: f64 = 2.0;

/// A drawing as a PNG file, twice as fine as its size on the page.
///
/// # Errors
/// [`Failure::Tried`] where the drawing is not one of ours.
pub(crate) fn png(drawing: &str) -> Outcome<Vec<u8>> {
    let image = painted(drawing, PNG_SCALE)?;
    let mut file = Vec::new();
    encoded(&image, &mut file).map_err(|error| failed(&error))?;
    Ok(file)
}

fn encoded(image: &Image, file: &mut Vec<u8>) -> Result<(), png::EncodingError> {
    let side = |pixels: usize| u32::try_from(pixels).unwrap_or(u32::MAX);
    let mut encoder = png::Encoder::new(file, side(image.width), side(image.height));
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image.pixels.as_flattened())?;
    writer.finish()
}

fn failed(reason: &dyn std::fmt::Display) -> Failure {
    Failure::Tried(format!(
        "cannot paint the picture: {reason}; write it as .svg instead"
    ))
}

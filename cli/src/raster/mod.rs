//! Figures as pixels and as PDF, from their SVG. Letters come from a typeface inside the program, so that a picture is the same on
//! every machine.

mod animation;

use std::sync::Arc;

use krilla::Document;
use krilla::geom::Size;
use krilla::page::PageSettings;
use krilla_svg::{SurfaceExt as _, SvgSettings};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree};

pub(crate) use animation::gif;

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
const PNG_SCALE: f32 = 2.0;
/// Points of a PDF per pixel of the page, 96 to the inch.
const PDF_SCALE: f32 = 0.75;

/// Returns a figure (SVG) as a PNG file, twice as fine as its size on the page; programs for print lay it out `width_mm` wide.
///
/// # Errors
/// [`Failure::Tried`] if it is no SVG or too large.
pub(crate) fn png(drawing: &str, width_mm: f64) -> Outcome<Vec<u8>> {
    let image = painted(drawing, PNG_SCALE)?;
    let mut file = Vec::new();
    encoded(&image, width_mm, &mut file).map_err(|error| failed(&error))?;
    Ok(file)
}

/// Returns a figure (SVG) as a PDF of one page of its size, with lines and text as such.
///
/// # Errors
/// [`Failure::Tried`] if it is no SVG or has no size.
pub(crate) fn pdf(drawing: &str) -> Outcome<Vec<u8>> {
    let tree = parsed(drawing)?;
    let side = |pixels: f32| pixels * PDF_SCALE;
    let size = Size::from_wh(side(tree.size().width()), side(tree.size().height()))
        .ok_or_else(|| failed(&"it has no size"))?;
    let mut document = Document::new();
    let mut page = document.start_page_with(PageSettings::new(size));
    let mut surface = page.surface();
    surface
        .draw_svg(&tree, size, SvgSettings::default())
        .ok_or_else(|| failed(&"a part of it cannot be drawn"))?;
    surface.finish();
    page.finish();
    document
        .finish()
        .map_err(|error| failed(&format_args!("{error:?}")))
}

/// Returns a figure (SVG) on white with `scale` pixels per pixel of the page.
///
/// # Errors
/// [`Failure::Tried`] if it is no SVG or too large.
pub(crate) fn painted(drawing: &str, scale: f32) -> Outcome<Image> {
    let tree = parsed(drawing)?;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a few thousand pixels
    let side = |pixels: f32| (pixels * scale).round().clamp(1.0, 20_000.0) as u32;
    let (width, height) = (side(tree.size().width()), side(tree.size().height()));
    let mut paper = Pixmap::new(width, height).ok_or_else(|| failed(&"it is too large"))?;
    paper.fill(Color::WHITE);
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut paper.as_mut(),
    );
    // On white every pixel is opaque.
    let pixels = paper.pixels().iter();
    Ok(Image {
        width: width as usize,
        height: height as usize,
        pixels: pixels
            .map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
            .collect(),
    })
}

fn parsed(drawing: &str) -> Outcome<Tree> {
    let mut options = Options::default();
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    Tree::from_str(drawing, &options).map_err(|error| failed(&error))
}

fn encoded(image: &Image, width_mm: f64, file: &mut Vec<u8>) -> Result<(), png::EncodingError> {
    let side = |pixels: usize| u32::try_from(pixels).unwrap_or(u32::MAX);
    let mut encoder = png::Encoder::new(file, side(image.width), side(image.height));
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // thousands
    let per_metre = (1e3 * image.width as f64 / width_mm).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image.pixels.as_flattened())?;
    writer.finish()
}

fn failed(reason: &dyn std::fmt::Display) -> Failure {
    Failure::Tried(format!(
        "cannot convert the figure: {reason}; write it as .svg instead"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(image: &Image, x: usize, y: usize) -> [u8; 3] {
        image.pixels[y * image.width + x]
    }

    fn drawing(inside: &str) -> String {
        format!(
            "<svg width=\"40\" height=\"20\" viewBox=\"0 0 400 200\" xmlns=\"http://www.w3.org/2000/svg\">{inside}</svg>"
        )
    }

    #[test]
    fn shapes_lie_where_they_are_drawn() {
        let image = painted(
            &drawing("<rect x=\"100\" y=\"0\" width=\"100\" height=\"200\" opacity=\"0.5\" fill=\"#FF0000\" stroke=\"none\"/>"),
            2.0,
        )
        .unwrap();
        assert_eq!((image.width, image.height), (80, 40));
        assert_eq!(pixel(&image, 5, 25), [255; 3]);
        let [red, green, blue] = pixel(&image, 30, 5);
        assert!(red == 255 && (126..=129).contains(&green) && green == blue);
    }

    /// Columns and rows of the dark pixels of a text.
    fn dark(text: &str) -> (Vec<usize>, Vec<usize>) {
        let image = painted(&drawing(text), 1.0).unwrap();
        let is_dark = |x: usize, y: usize| pixel(&image, x, y)[0] < 128;
        (
            (0..40)
                .filter(|x| (0..20).any(|y| is_dark(*x, y)))
                .collect(),
            (0..20)
                .filter(|y| (0..40).any(|x| is_dark(x, *y)))
                .collect(),
        )
    }

    #[test]
    fn text_needs_no_font_of_the_machine() {
        let (columns, rows) = dark(
            "<text x=\"200\" y=\"100\" text-anchor=\"middle\" font-family=\"sans-serif\" font-size=\"100\" fill=\"#000000\">\nMH<tspan dy=\"0.3em\" font-size=\"72%\">x</tspan>\n</text>",
        );
        assert!(
            columns[0] < 15 && columns[columns.len() - 1] > 25,
            "{columns:?}"
        );
        assert!(rows[0] < 5 && rows[rows.len() - 1] > 10, "{rows:?}");
    }

    #[test]
    fn a_pdf_has_the_size_of_the_figure_and_holds_no_pixels() {
        let file = pdf(&drawing(
            "<circle cx=\"300\" cy=\"100\" r=\"50\" fill=\"#0000FF\"/>",
        ))
        .unwrap();
        let text = String::from_utf8_lossy(&file);
        assert!(
            text.starts_with("%PDF-") && text.contains("/MediaBox[0 0 30 15]"),
            "{text}"
        );
        assert!(!text.contains("/Subtype/Image"));
    }

    #[test]
    fn what_is_no_drawing_is_refused() {
        painted("<svg", 1.0).unwrap_err();
        pdf("").unwrap_err();
    }
}

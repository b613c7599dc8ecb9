//! Reads the SVG that we write: rectangles, lines, discs, polygons and text, with colours, opacity, turned text and subscripts.
//! Anything else in it is an error, so that nothing is silently left out of a picture.

use roxmltree::{Document, Node};
use zeno::{Cap, Command, Point, Transform};

use super::canvas::{Canvas, Ink};
use super::letters::{EX, Letters};
use super::{Image, failed};
use crate::failure::Outcome;

/// A drawing painted with `scale` pixels per pixel of the page.
///
/// # Errors
/// [`Failure::Tried`] if it is not one of ours.
pub(crate) fn painted(drawing: &str, scale: f64) -> Outcome<Image> {
    let document = Document::parse(drawing).map_err(|error| failed(&error))?;
    let root = document.root_element();
    let [width, height] = ["width", "height"].map(|side| number(root, side).map(f64::from));
    let size = [width?, height?].map(|side| (side * scale).round());
    let letters = Letters::new().ok_or_else(|| failed(&"the program's letters are broken"))?;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a few thousand pixels
    let [across, down] = size.map(|side| side.clamp(1.0, 20_000.0) as usize);
    let mut painter = Painter {
        canvas: Canvas::white(across, down),
        letters,
        transform: onto(root, size)?,
    };
    for element in root.children().filter(Node::is_element) {
        painter.paint(element)?;
    }
    Ok(painter.canvas.into_image())
}

/// From the units of the drawing to pixels.
#[allow(clippy::cast_possible_truncation)] // single precision paints
fn onto(root: Node<'_, '_>, [width, height]: [f64; 2]) -> Outcome<Transform> {
    let shown = root.attribute("viewBox").unwrap_or_default();
    let shown = numbers(shown)?;
    match shown.as_slice() {
        [x, y, across, down] => Ok(Transform::translation(-x, -y).then_scale(
            width as f32 / across.max(1.0),
            height as f32 / down.max(1.0),
        )),
        [] => Ok(Transform::scale(
            width as f32 / number(root, "width")?,
            height as f32 / number(root, "height")?,
        )),
        _ => Err(failed(&"its viewBox is not four numbers")),
    }
}

struct Painter {
    canvas: Canvas,
    letters: Letters,
    transform: Transform,
}

impl Painter {
    fn paint(&mut self, element: Node<'_, '_>) -> Outcome {
        let get = |name| number(element, name);
        let path = match element.tag_name().name() {
            "rect" => {
                let (x, y) = (get("x")?, get("y")?);
                let (right, bottom) = (x + get("width")?, y + get("height")?);
                closed(&[(x, y), (right, y), (right, bottom), (x, bottom)])
            }
            "line" => open(&[(get("x1")?, get("y1")?), (get("x2")?, get("y2")?)]),
            "polyline" => open(&points(element)?),
            "polygon" => closed(&points(element)?),
            "circle" => disc((get("cx")?, get("cy")?), get("r")?),
            "text" => return self.write(element),
            other => return Err(failed(&format_args!("it holds a <{other}>"))),
        };
        if let Some(ink) = ink(element, "fill")? {
            self.canvas.fill(&path, self.transform, ink);
        }
        if let Some(ink) = ink(element, "stroke")? {
            let width = element.attribute("stroke-width").map_or(Ok(1.0), parsed)?;
            let cap = match element.attribute("stroke-linecap") {
                Some("round") => Cap::Round,
                _ => Cap::Butt,
            };
            self.canvas.stroke(&path, self.transform, (width, cap), ink);
        }
        Ok(())
    }

    fn write(&mut self, element: Node<'_, '_>) -> Outcome {
        let size = number(element, "font-size")?;
        let mut runs = Vec::new();
        let mut lift = shift(element, size)?;
        for part in element.children() {
            if part.is_text() {
                let text = part.text().unwrap_or_default().trim_matches('\n');
                runs.push((text, size, lift));
            } else {
                let small = match part.attribute("font-size") {
                    Some(share) => size * parsed(share.trim_end_matches('%'))? / 100.0,
                    None => size,
                };
                lift += shift(part, small)?;
                runs.push((part.text().unwrap_or_default(), small, lift));
            }
        }
        let width: f32 = runs
            .iter()
            .map(|(text, size, _)| self.letters.width(text, *size))
            .sum();
        let (mut x, y) = (number(element, "x")?, number(element, "y")?);
        let transform = turned(element)?.then(&self.transform);
        x -= width
            * match element.attribute("text-anchor") {
                Some("middle") => 0.5,
                Some("end") => 1.0,
                _ => 0.0,
            };
        let Some(ink) = ink(element, "fill")? else {
            return Ok(());
        };
        for (text, size, lift) in runs {
            let outline = self.letters.outline(text, size, (x, y + lift));
            self.canvas.fill(&outline, transform, ink);
            x += self.letters.width(text, size);
        }
        Ok(())
    }
}

/// `rotate(270, x, y)`, the one transform that we write.
fn turned(element: Node<'_, '_>) -> Outcome<Transform> {
    let Some(text) = element.attribute("transform") else {
        return Ok(Transform::IDENTITY);
    };
    let inside = text
        .strip_prefix("rotate(")
        .and_then(|text| text.strip_suffix(')'));
    match inside.map(numbers).transpose()?.as_deref() {
        // Written out: zeno 0.3.3 composes a turn with a shift wrongly.
        Some(&[degrees, x, y]) => {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Ok(Transform::new(
                cos,
                sin,
                -sin,
                cos,
                x - (x * cos - y * sin),
                y - (x * sin + y * cos),
            ))
        }
        _ => Err(failed(&format_args!("it asks for `{text}`"))),
    }
}

/// `dy` in pixels: `0.3em`, `0.5ex` or a number.
fn shift(element: Node<'_, '_>, size: f32) -> Outcome<f32> {
    let text = element.attribute("dy").unwrap_or("0");
    if let Some(text) = text.strip_suffix("em") {
        Ok(parsed(text)? * size)
    } else if let Some(text) = text.strip_suffix("ex") {
        Ok(parsed(text)? * size * EX)
    } else {
        parsed(text)
    }
}

/// A colour of an element, where it has one: `#RRGGBB`, with the element's opacity.
fn ink(element: Node<'_, '_>, attribute: &str) -> Outcome<Option<Ink>> {
    let text = match element.attribute(attribute) {
        None | Some("none") => return Ok(None),
        Some(text) => text,
    };
    let byte = |place: usize| {
        let digits = text.get(place..place + 2)?;
        u8::from_str_radix(digits, 16).ok()
    };
    let color = match (byte(1), byte(3), byte(5)) {
        (Some(red), Some(green), Some(blue)) if text.starts_with('#') => [red, green, blue],
        _ => return Err(failed(&format_args!("it asks for the colour `{text}`"))),
    };
    let opacity = element.attribute("opacity").map_or(Ok(1.0), parsed)?;
    Ok(Some(Ink { color, opacity }))
}

fn points(element: Node<'_, '_>) -> Outcome<Vec<(f32, f32)>> {
    let numbers = numbers(element.attribute("points").unwrap_or_default())?;
    let pairs = numbers.chunks_exact(2);
    Ok(pairs.map(|pair| (pair[0], pair[1])).collect())
}

fn numbers(text: &str) -> Outcome<Vec<f32>> {
    text.split([' ', ',', '\n'])
        .filter(|word| !word.is_empty())
        .map(parsed)
        .collect()
}

fn number(element: Node<'_, '_>, attribute: &str) -> Outcome<f32> {
    let tag = element.tag_name().name();
    let text = element
        .attribute(attribute)
        .ok_or_else(|| failed(&format_args!("a <{tag}> has no {attribute}")))?;
    parsed(text)
}

fn parsed(text: &str) -> Outcome<f32> {
    text.parse()
        .map_err(|_| failed(&format_args!("`{text}` is no number")))
}

fn open(points: &[(f32, f32)]) -> Vec<Command> {
    let mut places = points.iter().map(|&(x, y)| Point::new(x, y));
    let first = places.next().map(Command::MoveTo);
    first
        .into_iter()
        .chain(places.map(Command::LineTo))
        .collect()
}

fn closed(points: &[(f32, f32)]) -> Vec<Command> {
    let mut path = open(points);
    path.push(Command::Close);
    path
}

/// A circle of four cubics, accurate to a fraction of a pixel.
fn disc((x, y): (f32, f32), radius: f32) -> Vec<Command> {
    let handle = 0.552_284_8 * radius;
    let at = |dx: f32, dy: f32| Point::new(x + dx, y + dy);
    let (r, h) = (radius, handle);
    vec![
        Command::MoveTo(at(r, 0.0)),
        Command::CurveTo(at(r, h), at(h, r), at(0.0, r)),
        Command::CurveTo(at(-h, r), at(-r, h), at(-r, 0.0)),
        Command::CurveTo(at(-r, -h), at(-h, -r), at(0.0, -r)),
        Command::CurveTo(at(h, -r), at(r, -h), at(r, 0.0)),
        Command::Close,
    ]
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
            &drawing(
                "<rect x=\"100\" y=\"0\" width=\"100\" height=\"200\" opacity=\"0.5\" fill=\"#FF0000\" stroke=\"none\"/>\
                 <circle cx=\"300\" cy=\"100\" r=\"50\" fill=\"#0000FF\"/>\
                 <polyline fill=\"none\" stroke=\"#00FF00\" stroke-width=\"20\" points=\"0,100 90,100 \"/>",
            ),
            2.0,
        )
        .unwrap();
        assert_eq!((image.width, image.height), (80, 40));
        assert_eq!(pixel(&image, 30, 5), [255, 128, 128]);
        assert_eq!(pixel(&image, 60, 20), [0, 0, 255]);
        assert_eq!(pixel(&image, 60, 7), [255; 3]);
        assert_eq!(pixel(&image, 5, 20), [0, 255, 0]);
        assert_eq!(pixel(&image, 5, 25), [255; 3]);
    }

    #[test]
    fn text_stands_on_its_line_and_is_anchored() {
        let dark = |anchor: &str| {
            let text = format!(
                "<text x=\"200\" y=\"100\" text-anchor=\"{anchor}\" font-size=\"100\" fill=\"#000000\">\nMH<tspan dy=\"0.3em\" font-size=\"72%\">x</tspan>\n</text>"
            );
            let image = painted(&drawing(&text), 1.0).unwrap();
            let columns: Vec<usize> = (0..40)
                .filter(|x| (0..20).any(|y| pixel(&image, *x, y)[0] < 128))
                .collect();
            let below = (0..40).any(|x| pixel(&image, x, 11)[0] < 200);
            assert!(below, "the subscript hangs below the line");
            (columns[0], columns[columns.len() - 1])
        };
        let (start, middle, end) = (dark("start"), dark("middle"), dark("end"));
        assert!(start.0 >= 20 && end.1 <= 20, "{start:?} {end:?}");
        assert!(middle.0 < 20 && middle.1 > 20, "{middle:?}");
    }

    #[test]
    fn turned_text_runs_upwards_from_its_place() {
        let text = "<text x=\"200\" y=\"150\" text-anchor=\"start\" font-size=\"60\" fill=\"#000000\" transform=\"rotate(270, 200, 150)\">\nMM\n</text>";
        let image = painted(&drawing(text), 1.0).unwrap();
        let dark = |x: usize, y: usize| pixel(&image, x, y)[0] < 200;
        let (xs, ys) = (0..40, 0..20);
        let rows: Vec<usize> = ys.filter(|y| xs.clone().any(|x| dark(x, *y))).collect();
        let columns: Vec<usize> = xs.filter(|x| (0..20).any(|y| dark(*x, y))).collect();
        assert!(rows[0] < 8 && rows[rows.len() - 1] <= 15, "{rows:?}");
        assert!(
            columns[0] >= 14 && columns[columns.len() - 1] <= 20,
            "{columns:?}"
        );
    }

    #[test]
    fn what_we_do_not_write_is_refused() {
        for odd in [
            "<path d=\"M0 0\"/>",
            "<rect x=\"0\" y=\"0\" width=\"1\" height=\"one\" fill=\"#000000\"/>",
            "<rect x=\"0\" y=\"0\" width=\"1\" height=\"1\" fill=\"red\"/>",
        ] {
            painted(&drawing(odd), 1.0).unwrap_err();
        }
        painted("<svg", 1.0).unwrap_err();
    }
}

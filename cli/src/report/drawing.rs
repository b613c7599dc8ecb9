//! A drawing made of strokes in the common style, for figures without axes: a body on its way, a body in motion.

use std::fmt::Write;

use plotters::style::RGBColor;

use super::style::{Point, named, subscripted};

/// A drawing on white; places are pixels of the page, y downwards.
#[derive(Debug)]
pub(crate) struct Drawing {
    /// For readers of screens.
    name: String,
    size: (f64, f64),
    text: String,
}

/// A colour and how much of it covers what lies below, 0 to 1.
pub(crate) type Ink = (RGBColor, f64);

/// Anchor of a text: start, middle or end at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

impl Drawing {
    /// Empty paper for a drawing of this name.
    pub(crate) fn new(name: &str, width: f64, height: f64) -> Self {
        let mut drawing = Self {
            name: name.to_owned(),
            size: (width, height),
            text: String::new(),
        };
        drawing.rectangle((0.0, 0.0), (width, height), (RGBColor(255, 255, 255), 1.0));
        drawing
    }

    /// A filled rectangle from corner to corner.
    pub(crate) fn rectangle(&mut self, from: Point, to: Point, ink: Ink) {
        let (x, y) = (place(from.0), place(from.1));
        let (width, height) = (place(to.0 - from.0), place(to.1 - from.1));
        self.put(format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" {}/>",
            filled(ink)
        ));
    }

    /// A line with round ends.
    pub(crate) fn line(&mut self, points: &[Point], width: f64, (color, opacity): Ink) {
        self.put(format_args!(
            "<polyline fill=\"none\" stroke=\"{}\" opacity=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" stroke-linejoin=\"round\" points=\"{}\"/>",
            hex(color),
            place(opacity),
            place(width),
            places(points)
        ));
    }

    /// A filled disc.
    pub(crate) fn disc(&mut self, at: Point, radius: f64, ink: Ink) {
        self.put(format_args!(
            "<circle {} {}/>",
            round(at, radius),
            filled(ink)
        ));
    }

    /// A filled arrow head of this length in the middle of a curve that runs along a unit vector.
    pub(crate) fn arrow_head(&mut self, at: Point, along: Point, length: f64, ink: Ink) {
        let corner = |forwards: f64, across: f64| {
            (
                at.0 + length * (forwards * along.0 - across * along.1),
                at.1 + length * (forwards * along.1 + across * along.0),
            )
        };
        let corners = [corner(0.5, 0.0), corner(-0.5, 0.42), corner(-0.5, -0.42)];
        self.put(format_args!(
            "<polygon {} points=\"{}\"/>",
            filled(ink),
            places(&corners)
        ));
    }

    /// A circle.
    pub(crate) fn ring(&mut self, at: Point, radius: f64, width: f64, (color, opacity): Ink) {
        self.put(format_args!(
            "<circle {} fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" opacity=\"{}\"/>",
            round(at, radius),
            hex(color),
            place(width),
            place(opacity)
        ));
    }

    /// Words on a line; `H_x` shows an x below it.
    pub(crate) fn words(
        &mut self,
        at: Point,
        size: i32,
        color: RGBColor,
        anchor: Anchor,
        text: &str,
    ) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        self.put(format_args!(
            "<text x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\" font-family=\"sans-serif\" font-size=\"{size}\" fill=\"{}\">{}</text>",
            place(at.0),
            place(at.1),
            hex(color),
            subscripted(&text)
        ));
    }

    /// The drawing as SVG.
    pub(crate) fn svg(&self) -> String {
        let (width, height) = (place(self.size.0), place(self.size.1));
        format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" {} xmlns=\"http://www.w3.org/2000/svg\">\n{}</svg>\n",
            named(&self.name),
            self.text
        )
    }

    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{element}");
    }
}

fn round(at: Point, radius: f64) -> String {
    format!(
        "cx=\"{}\" cy=\"{}\" r=\"{}\"",
        place(at.0),
        place(at.1),
        place(radius)
    )
}

fn filled((color, opacity): Ink) -> String {
    format!("fill=\"{}\" opacity=\"{}\"", hex(color), place(opacity))
}

fn places(points: &[Point]) -> String {
    let points = points.iter();
    let points: Vec<String> = points
        .map(|(x, y)| format!("{},{}", place(*x), place(*y)))
        .collect();
    points.join(" ")
}

/// To a hundredth of a pixel, without a minus before zero.
fn place(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

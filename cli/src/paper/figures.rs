//! The paper's figures, drawn from what was computed, each with the table of its points.

mod efficiency;
mod experiment;

use gait_optimizer::{HeightMap, OptimalGait, Row as HeightRow, SimpleShape};
use nalgebra::Vector2;
use operations::height_map::NamedGait;
use plotters::style::RGBColor;
use swimmer_files::AnyGait;
use swimmer_model::{Gait as _, Stroke};

use crate::commands::height_map::picture;
use crate::csv_text::csv_text;
use crate::failure::Outcome;
use crate::picture_file::FigureWidth;
use crate::report::chart::{
    BOUND, Chart, INK, MEASURED, PREDICTED, Point, SINGULAR, SLENDER, Series,
};
use crate::report::style::ZERO_CURVE;
use validation::{Simple, Study, UPPER};

/// One figure.
#[derive(Debug)]
pub(crate) struct Figure {
    /// Name of its files, without ending.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// HTML.
    pub(crate) caption: &'static str,
    chart: Chart,
    /// Names of the chart's series, for the table.
    names: Vec<&'static str>,
    /// Shown instead of the chart, whose points they hold and more: for a page and for a column.
    pictures: Option<[String; 2]>,
}

const WIDE: (i32, i32) = (520, 380);
const SQUARE: (i32, i32) = (520, 510);
const LOW: (i32, i32) = (520, 220);
/// Points of a drawn gait.
const POINTS: u32 = 400;

impl Figure {
    fn new(
        name: &'static str,
        title: &'static str,
        caption: &'static str,
        labels: [&str; 2],
        size: (i32, i32),
    ) -> Self {
        Self {
            name,
            title,
            caption,
            chart: Chart {
                x_label: labels[0].into(),
                y_label: labels[1].into(),
                size,
                equal_axes: size == SQUARE,
                legend: Vec::new(),
                title: String::new(),
                series: Vec::new(),
            },
            names: Vec::new(),
            pictures: None,
        }
    }

    fn with(mut self, name: &'static str, series: Series) -> Self {
        self.chart.series.push(series);
        self.names.push(name);
        self
    }

    fn line(self, name: &'static str, color: RGBColor, points: Vec<Point>) -> Self {
        self.with(
            name,
            Series::Line {
                points,
                color,
                width: 1.7,
            },
        )
    }

    /// A closed curve with the way it runs.
    fn gait(self, name: &'static str, color: RGBColor, points: Vec<Point>) -> Self {
        let heads = Series::Arrows {
            points: points.clone(),
            color,
        };
        self.line(name, color, points).with(name, heads)
    }

    fn dashes(self, name: &'static str, color: RGBColor, points: Vec<Point>) -> Self {
        self.with(
            name,
            Series::Dashes {
                points,
                color,
                width: 1.3,
            },
        )
    }

    fn mark(self, name: &'static str, color: RGBColor, at: Point) -> Self {
        self.with(
            name,
            Series::Dots {
                points: vec![at],
                color,
                radius: 4.0,
            },
        )
        .with(
            name,
            Series::Word {
                at,
                text: name.into(),
                color: INK,
            },
        )
    }

    /// The picture.
    ///
    /// # Errors
    /// Errors of the drawing.
    pub(crate) fn svg(&self, width: FigureWidth) -> Outcome<String> {
        let Some([page, column]) = &self.pictures else {
            return self.chart.clone().wide(width).svg();
        };
        Ok(match width {
            FigureWidth::Page => page,
            FigureWidth::Column => column,
        }
        .clone())
    }

    /// Its points as a table, one line each, in the units of the axes.
    ///
    /// # Errors
    /// Errors of the writing.
    pub(crate) fn csv(&self) -> Outcome<String> {
        let named = self.names.iter().zip(&self.chart.series);
        let rows = named.flat_map(|(name, series)| {
            let points = match series {
                Series::Line { points, .. }
                | Series::Dashes { points, .. }
                | Series::Dots { points, .. } => points.as_slice(),
                Series::Bars { .. }
                | Series::Arrows { .. }
                | Series::Word { .. }
                | Series::Cells(_)
                | Series::ColourBar(_)
                | Series::Names(_) => &[],
            };
            points.iter().map(move |point| (name, point))
        });
        csv_text(["curve", &self.chart.x_label, &self.chart.y_label], rows)
    }
}

/// All figures, in the order of the paper.
///
/// # Errors
/// Errors of the drawing.
pub(crate) fn figures(study: &Study) -> Outcome<Vec<Figure>> {
    let mut figures = experiment::experiment(study);
    figures.push(simple_gaits());
    figures.extend(amplitudes(study));
    figures.push(displacement_over_amplitude(study));
    figures.push(height_map(&study.robot_map, &study.robot_simple)?);
    figures.extend(displacement_gaits(study));
    figures.push(efficiency::efficiency_over_amplitude(
        "efficiency-purcell",
        "Efficiency of Purcell's swimmer",
        &study.purcell_simple,
        &study.purcell_lighthill,
    ));
    figures.push(efficiency::efficiency_over_amplitude(
        "efficiency-robot",
        "Efficiency of the robot",
        &study.robot_simple,
        &study.robot_lighthill,
    ));
    figures.push(efficiency::lighthill(
        "lighthill-purcell",
        "Lighthill gaits of Purcell's swimmer",
        &study.purcell_lighthill,
        &study.purcell_simple,
    ));
    figures.push(efficiency::lighthill(
        "lighthill-robot",
        "Lighthill gaits of the robot",
        &study.robot_lighthill,
        &study.robot_simple,
    ));
    Ok(figures)
}

/// A circle and a square of the same amplitude.
fn simple_gaits() -> Figure {
    let of = |shape: SimpleShape| drawn(&shape.gait(1.0));
    Figure::new(
        "simple-gaits",
        "Circle and square gaits",
        "Amplitude ε = 1 rad, run counter-clockwise from φ₁ = φ₂ &gt; 0: <i style='color:#3a9d5d'></i>circle <i style='color:#1d242c'></i>square",
        ["φ₁ [rad]", "φ₂ [rad]"],
        SQUARE,
    )
    .gait("circle", SLENDER, of(SimpleShape::Circle))
    .gait("square", INK, of(SimpleShape::Square))
    .mark("start", SLENDER, (std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2))
    .mark("start", INK, (1.0, 1.0))
}

/// X, ΔY and Δθ of circles over their amplitude, both models of the robot.
fn amplitudes(study: &Study) -> [Figure; 3] {
    const CAPTION: &str =
        "<i style='color:#1d242c'></i>fitted robot <i style='color:#3a9d5d'></i>slender links";
    let drawn = |figure: Figure, value: fn(&Stroke<f64>) -> f64| {
        let curve = |simple: &Simple| -> Vec<Point> {
            let shown = simple.curves[0]
                .iter()
                .filter(|(amplitude, _)| amplitude.to_degrees() < 125.0);
            shown
                .map(|(amplitude, stroke)| (amplitude.to_degrees(), value(stroke)))
                .collect()
        };
        figure.line("fitted", INK, curve(&study.robot_simple)).line(
            "slender",
            SLENDER,
            curve(&study.slender_simple),
        )
    };
    let axes = |y| ["amplitude ε [°]", y];
    [
        drawn(
            Figure::new(
                "circles-x",
                "Displacement of circles",
                CAPTION,
                axes("X [mm per cycle]"),
                WIDE,
            ),
            |stroke| stroke.displacement.x * 1e3,
        ),
        drawn(
            Figure::new(
                "circles-delta-y",
                "Sway of circles",
                CAPTION,
                axes("ΔY [mm]"),
                LOW,
            ),
            |stroke| stroke.delta_y * 1e3,
        ),
        drawn(
            Figure::new(
                "circles-delta-theta",
                "Yaw of circles",
                CAPTION,
                axes("Δθ [°]"),
                LOW,
            ),
            |stroke| stroke.delta_theta.to_degrees(),
        ),
    ]
}

/// X/L of the robot's circles and squares, with the three optima.
fn displacement_over_amplitude(study: &Study) -> Figure {
    let [circles, squares] = &study.robot_simple.curves;
    let curve = |swum: &[(f64, Stroke<f64>)]| {
        swum.iter()
            .map(|(amplitude, stroke)| (*amplitude, stroke.displacement_over_length().x))
            .collect()
    };
    let mut figure = Figure::new(
        "displacement",
        "Displacement of the robot",
        "<i style='color:#3a9d5d'></i>circles <i style='color:#1d242c'></i>squares \
         <i class=dot style='color:#d35b1e'></i>optimal gaits (b), (c), (d) within 2.8 rad",
        ["amplitude ε [rad]", "X/L"],
        WIDE,
    )
    .line("circles", SLENDER, curve(circles))
    .line("squares", INK, curve(squares));
    for (name, gait) in ["b", "c", "d"].into_iter().zip(&study.robot_displacement) {
        figure = figure.mark(name, PREDICTED, (UPPER, gait.displacement_over_length));
    }
    figure
}

/// The robot's height function with its zero-level curves and the best squares.
fn height_map(map: &HeightMap, simple: &Simple) -> Outcome<Figure> {
    let mut figure = Figure::new(
        "height-map",
        "Height map of the robot",
        "H<sub>x</sub> in minimum-perturbation coordinates on |φᵢ| ≤ 2.8 rad, its zero-level curves, and the best square within",
        ["φ₁ [rad]", "φ₂ [rad]"],
        SQUARE,
    );
    figure = with_zero_curves(figure, map);
    let mut gaits = Vec::new();
    for (name, best) in ["first best square", "second best square"]
        .into_iter()
        .zip(&simple.displacement[1])
    {
        if best.amplitude < map.half_width() {
            let gait = AnyGait::square(best.amplitude);
            figure = figure.gait(name, MEASURED, drawn(&gait));
            gaits.push(NamedGait {
                name: name.to_owned(),
                gait,
            });
        }
    }
    let curves = map.zero_curves(HeightRow::X);
    let picture = |width| {
        picture::svg(&picture::Figure {
            title: String::new(),
            quantity: "H_x/L [rad⁻²]",
            map,
            row: HeightRow::X,
            curves: &curves,
            gaits: &gaits,
            width,
        })
    };
    figure.pictures = Some([picture(FigureWidth::Page)?, picture(FigureWidth::Column)?]);
    Ok(figure)
}

fn with_zero_curves(mut figure: Figure, map: &HeightMap) -> Figure {
    for curve in map.zero_curves(HeightRow::X) {
        let zero = Series::Line {
            points: curve.points.iter().map(pair).collect(),
            color: SINGULAR,
            width: ZERO_CURVE,
        };
        figure = figure.with("zero of the height", zero);
    }
    figure
}

/// Gaits (b), (c), (d) over the zero-level curves.
fn displacement_gaits(study: &Study) -> [Figure; 3] {
    const CAPTION: &str = "<i class=band style='color:#c3cdd6'></i>zero-level curves of H<sub>x</sub> <i style='color:#d35b1e'></i>gait \
                           <i style='color:#d8b9e6'></i>bounds";
    let [b, c, d] = &study.robot_displacement;
    let titles = [
        ("gait-b", "Gait (b): |φᵢ| ≤ 2.8", b),
        ("gait-c", "Gait (c): 1.5 ≤ |φᵢ| ≤ 2.8", c),
        (
            "gait-d",
            "Gait (d): |φᵢ| ≤ 2.8, each quarter in its sector",
            d,
        ),
    ];
    titles.map(|(name, title, gait)| {
        let figure = Figure::new(name, title, CAPTION, ["φ₁ [rad]", "φ₂ [rad]"], SQUARE);
        with_zero_curves(figure, &study.robot_map)
            .dashes("bound", BOUND, drawn(&AnyGait::square(UPPER)))
            .gait(name, PREDICTED, samples(gait))
    })
}

fn samples(gait: &OptimalGait) -> Vec<Point> {
    gait.phi().iter().map(pair).collect()
}

fn pair(shape: &Vector2<f64>) -> Point {
    (shape.x, shape.y)
}

fn drawn(gait: &AnyGait) -> Vec<Point> {
    (0..=POINTS)
        .map(|i| pair(&gait.at(f64::from(i) / f64::from(POINTS)).phi))
        .collect()
}

//! `swimmer optimize speed --front`: displacement per cycle against speed, as a figure or a table.

use std::path::PathBuf;
use std::str::FromStr;

use gait_optimizer::{Fastest, Front};
use operations::optimize::speed::{FrontOutput, Output};

use crate::csv_text::csv_text;
use crate::failure::Outcome;
use crate::new_file::may_be_written;
use crate::picture_file::{FigureWidth, Kind};
use crate::report::chart::{Chart, INK, MEASURED, PREDICTED, Point, Series};

/// Path of the front, with its form.
#[derive(Debug, Clone)]
pub(crate) struct FrontFile {
    path: PathBuf,
    kind: Kind,
}

impl FromStr for FrontFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let path = PathBuf::from(text);
        let kinds = [Kind::Svg, Kind::Png, Kind::Pdf, Kind::Csv];
        let kind = Kind::of(&path, &kinds).map_err(|failure| failure.to_string())?;
        Ok(Self { path, kind })
    }
}

impl FrontFile {
    /// Kind of the file.
    pub(crate) fn kind(&self) -> Kind {
        self.kind
    }

    /// Checks that the file may be written.
    pub(crate) fn may_be_written(&self) -> Outcome {
        may_be_written(&self.path)
    }

    /// Writes the front of an output, if it has one, and names the file in the output.
    pub(crate) fn write(&self, output: &mut Output, width: FigureWidth) -> Outcome {
        let Some(front) = &output.farthest else {
            return Ok(());
        };
        let text = match self.kind {
            Kind::Csv => table(front, output.length)?,
            _ => figure(front, &output.name, output.length)
                .wide(width)
                .svg()?,
        };
        self.kind.write(&self.path, &text, width)?;
        output.front = Some(FrontOutput::new(self.path.clone(), front));
        Ok(())
    }
}

/// A line for each period; empty without a gait.
fn table(front: &Front, length: f64) -> Outcome<String> {
    let farthest = front.periods.iter().zip(&front.farthest);
    let rows = farthest.map(|(period, gait)| {
        let numbers = gait.as_ref().map(|gait| {
            let (distance, speed) = (gait.distance_over_length, gait.speed_over_length);
            [
                distance,
                distance * length,
                speed,
                speed * length,
                gait.heading,
            ]
            .map(Some)
        });
        (period, numbers.unwrap_or_default())
    });
    csv_text(
        "period_s,displacement_over_length,displacement_m,speed_over_length_per_s,speed_m_per_s,heading_rad"
            .split(','),
        rows,
    )
}

fn figure(front: &Front, name: &str, length: f64) -> Chart {
    let point = |gait: &Fastest| -> Point {
        (
            gait.speed_over_length * length * 1e3,
            gait.distance_over_length * length * 1e3,
        )
    };
    // The line is interrupted at periods without a gait.
    let mut series: Vec<Series> = front
        .farthest
        .split(Option::is_none)
        .filter(|run| run.len() > 1)
        .map(|run| Series::Line {
            points: run.iter().flatten().map(point).collect(),
            color: MEASURED,
            width: 2.0,
        })
        .collect();
    series.push(Series::Dots {
        points: front.farthest.iter().flatten().map(point).collect(),
        color: MEASURED,
        radius: 3.0,
    });
    let known = front.periods.iter().zip(&front.farthest);
    let known: Vec<_> = known
        .filter_map(|(period, gait)| Some((period, gait.as_ref()?)))
        .collect();
    series.extend(known.iter().step_by(4).map(|(period, gait)| Series::Word {
        at: point(gait),
        text: format!("{period:.2} s"),
        color: INK,
    }));
    series.push(Series::Dots {
        points: vec![point(&front.fastest)],
        color: PREDICTED,
        radius: 5.0,
    });
    Chart {
        title: format!("{name}: the farthest gait in each period"),
        x_label: "speed [mm/s]".to_owned(),
        y_label: "displacement per cycle [mm]".to_owned(),
        size: (620, 420),
        equal_axes: false,
        series,
        legend: vec![
            ("the farthest gait in a period".to_owned(), MEASURED),
            (
                format!("the fastest, a cycle in {:.3} s", front.fastest.period),
                PREDICTED,
            ),
        ],
    }
}

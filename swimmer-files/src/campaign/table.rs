//! A table of reported results, one line per run.

use std::path::Path;

use csv::StringRecord;

use super::raw::NUMBERS;
use super::reported::{ReportedResults, reported};
use crate::file_error::read_text;
use crate::{FileError, GaitSpec};

/// The runs of a table, each with its line and its gait. `gait` is what the `[[run]]` says: `circle` or `square` where the table
/// has amplitudes, else a gait for all rows or for those without their own.
pub(super) fn table(
    path: &Path,
    gait: &str,
) -> Result<Vec<(usize, GaitSpec, ReportedResults)>, FileError> {
    let text = read_text(path)?;
    let error = |line: usize, column: usize, problem: String| {
        FileError::at(path, line, column + 1, problem)
    };
    let is_said = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.starts_with('#');
    let mut lines = (1..).zip(text.lines()).filter(is_said);
    let Some((first, head)) = lines.next() else {
        let problem =
            "an empty table: its first line names columns as amplitude_deg, x_mm, x_se_mm";
        return Err(error(1, 0, problem.to_owned()));
    };
    let separator = [b';', b'\t', b',']
        .into_iter()
        .find(|separator| head.as_bytes().contains(separator));
    let cells = |line: &str| cells(line, separator.unwrap_or(b','));
    let names = cells(head);
    columns(&names).map_err(|(column, problem)| error(first, column, problem))?;
    let mut out = Vec::new();
    for (line, row) in lines {
        let row = cells(row);
        if row.len() != names.len() {
            let problem = format!("{} cells under {} names", row.len(), names.len());
            return Err(error(line, 0, problem));
        }
        let place = |name: &str| names.iter().position(|n| n == name);
        let cell = |name: &str| {
            let text = row.get(place(name)?)?;
            (!text.is_empty()).then_some(text)
        };
        for (column, (name, text)) in names.iter().zip(&row).enumerate() {
            if name != "gait" && !text.is_empty() && text.parse::<f64>().is_err() {
                return Err(error(
                    line,
                    column,
                    format!("`{text}` under {name} is no number"),
                ));
            }
        }
        let number = |name: &str| cell(name)?.parse::<f64>().ok();
        let of_row = match (cell("gait"), cell("amplitude_deg"), cell("amplitude_rad")) {
            (Some(own), None, None) => own.to_owned(),
            (None, Some(degrees), None) => with_amplitude(gait, &format!("{degrees}deg")),
            (None, None, Some(radians)) => with_amplitude(gait, radians),
            (None, None, None) => gait.to_owned(),
            _ => {
                let problem = "one of gait, amplitude_deg and amplitude_rad must name the gait";
                return Err(error(line, 0, problem.to_owned()));
            }
        };
        let shape = of_row.strip_suffix(":cw").unwrap_or(&of_row);
        if ["circle", "square"].contains(&shape) {
            let problem = format!("`{of_row}` has no amplitude: give a column amplitude_deg");
            return Err(error(line, 0, problem));
        }
        let spec: GaitSpec = of_row
            .parse()
            .map_err(|cause| error(line, 0, format!("gait: {cause}")))?;
        let mut reported = reported(number)
            .map_err(|(key, problem)| error(line, place(&key).unwrap_or(0), problem))?;
        reported.table = Some(path.to_owned());
        out.push((line, spec, reported));
    }
    if out.is_empty() {
        return Err(error(
            first,
            0,
            "no line under the columns' names".to_owned(),
        ));
    }
    Ok(out)
}

/// `circle` and an amplitude, with `:cw` kept at the end.
fn with_amplitude(shape: &str, amplitude: &str) -> String {
    match shape.strip_suffix(":cw") {
        Some(shape) => format!("{shape}:{amplitude}:cw"),
        None => format!("{shape}:{amplitude}"),
    }
}

/// The cells of a line, quoted or not.
fn cells(line: &str, separator: u8) -> StringRecord {
    let reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .trim(csv::Trim::All)
        .has_headers(false)
        .from_reader(line.as_bytes());
    // Nothing can fail: a string is UTF-8, and one record has one length.
    reader.into_records().flatten().next().unwrap_or_default()
}

/// Checks that these are columns of a table. Returns the index of the first invalid one, and the reason.
fn columns(names: &StringRecord) -> Result<(), (usize, String)> {
    for (column, name) in names.iter().enumerate() {
        let known =
            NUMBERS.contains(&name) || ["gait", "amplitude_deg", "amplitude_rad"].contains(&name);
        if !known {
            let problem = format!(
                "no column `{name}`: there are gait or amplitude_deg or amplitude_rad, cycles, x_mm, y_mm, turn_deg, delta_y_mm, \
                 delta_theta_deg, and each of these with _sd (x_sd_mm) or _se (x_se_mm)"
            );
            return Err((column, problem));
        }
        if names.iter().take(column).any(|before| before == name) {
            return Err((column, format!("a second column `{name}`")));
        }
    }
    Ok(())
}

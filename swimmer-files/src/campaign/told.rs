//! Results that somebody wrote down instead of a track: X, ΔY, Δθ of a run in its `[[run]]`, or of many in a table.

use std::path::{Path, PathBuf};

use crate::place::read_text;
use crate::{FileError, GaitSpec};

/// A value of a run, and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToldValue {
    /// Its mean over cycles.
    pub mean: f64,
    /// `_sd`: its standard deviation from cycle to cycle.
    pub sd: Option<f64>,
    /// `_se`: the standard error of the mean.
    pub se: Option<f64>,
}

/// What is told of a run, in m and rad; `None` for what is not.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ToldRun {
    /// X.
    pub x: Option<ToldValue>,
    /// Y.
    pub y: Option<ToldValue>,
    /// Net turn.
    pub turn: Option<ToldValue>,
    /// ΔY.
    pub delta_y: Option<ToldValue>,
    /// Δθ.
    pub delta_theta: Option<ToldValue>,
    /// How many cycles the means are of.
    pub cycles: Option<usize>,
    /// The table that told it, if one did.
    pub table: Option<PathBuf>,
}

/// The numbers' names without their `_sd` and `_se`, their units, and what these are in m or rad.
const DEGREE: f64 = std::f64::consts::PI / 180.0;
const VALUES: [(&str, &str, f64); 5] = [
    ("x", "mm", 1e-3),
    ("y", "mm", 1e-3),
    ("turn", "deg", DEGREE),
    ("delta_y", "mm", 1e-3),
    ("delta_theta", "deg", DEGREE),
];
/// More cycles than any run has.
const MOST_CYCLES: f64 = 1e6;

/// Whether a key or a column is one of these numbers.
pub(super) fn is_number(name: &str) -> bool {
    let of = |(value, unit, _): &(&str, &str, f64)| {
        ["", "_sd", "_se"]
            .iter()
            .any(|kind| name == format!("{value}{kind}_{unit}"))
    };
    name == "cycles" || VALUES.iter().any(of)
}

/// What these numbers tell of a run: the name of the one that cannot be meant, and why.
pub(super) fn told(number: impl Fn(&str) -> Option<f64>) -> Result<ToldRun, (String, String)> {
    let cycles = match number("cycles") {
        None => None,
        Some(count) if (1.0..=MOST_CYCLES).contains(&count) && count.fract() == 0.0 => {
            // Checked above.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            Some(count as usize)
        }
        Some(count) => {
            let problem = format!("cycles = {count} must be how many there were: 1, 2, 3, …");
            return Err(("cycles".to_owned(), problem));
        }
    };
    let value = |(name, unit, si): (&str, &str, f64)| {
        let key = |kind: &str| format!("{name}{kind}_{unit}");
        let Some(mean) = number(&key("")) else {
            let lonely = ["_sd", "_se"]
                .map(key)
                .into_iter()
                .find(|key| number(key).is_some());
            return match lonely {
                None => Ok(None),
                Some(key) => {
                    let problem =
                        format!("{key} says how sure {name}_{unit} is, which is not there");
                    Err((key, problem))
                }
            };
        };
        if !mean.is_finite() {
            let problem = format!("{} = {mean} must be a finite number", key(""));
            return Err((key(""), problem));
        }
        if name.starts_with("delta") && mean <= 0.0 {
            let problem = format!(
                "{} = {mean} is half of a range: it must be above 0",
                key("")
            );
            return Err((key(""), problem));
        }
        let spread = |kind: &str| match number(&key(kind)) {
            Some(spread) if !(spread.is_finite() && spread > 0.0) => {
                let problem = format!("{} = {spread} must be a positive number", key(kind));
                Err((key(kind), problem))
            }
            spread => Ok(spread.map(|spread| spread * si)),
        };
        let (sd, se) = (spread("_sd")?, spread("_se")?);
        if sd.is_some() && se.is_some() {
            let problem = format!(
                "{} and {} both say how sure {} is: give the deviation from cycle to cycle with `cycles`, or the error of the mean",
                key("_sd"),
                key("_se"),
                key("")
            );
            return Err((key("_se"), problem));
        }
        if sd.is_some() && cycles.is_none_or(|cycles| cycles < 2) {
            let problem = format!(
                "{} is the deviation from cycle to cycle: say by `cycles` of how many (2 at least), or give {}, the error of the mean",
                key("_sd"),
                key("_se")
            );
            return Err((key("_sd"), problem));
        }
        Ok(Some(ToldValue {
            mean: mean * si,
            sd,
            se,
        }))
    };
    let [x, y, turn, delta_y, delta_theta] = VALUES;
    let told = ToldRun {
        x: value(x)?,
        y: value(y)?,
        turn: value(turn)?,
        delta_y: value(delta_y)?,
        delta_theta: value(delta_theta)?,
        cycles,
        table: None,
    };
    if told.x.is_none() && told.delta_y.is_none() && told.delta_theta.is_none() {
        let problem = "a run without a track tells x_mm, delta_y_mm or delta_theta_deg".to_owned();
        return Err((String::new(), problem));
    }
    Ok(told)
}

/// The runs of a table, each with its line and its gait. `gait` is what the `[[run]]` says: `circle` or `square` where the table
/// has amplitudes, else a gait for all rows or for those without their own.
pub(super) fn table(path: &Path, gait: &str) -> Result<Vec<(usize, GaitSpec, ToldRun)>, FileError> {
    let text = read_text(path)?;
    let lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let error = |line: usize, column: usize, problem: String| {
        FileError::at(path, line, column + 1, problem)
    };
    let Some((first, head)) = lines.next() else {
        return Err(error(
            1,
            0,
            "an empty table: its first line names columns as amplitude_deg, x_mm, x_se_mm"
                .to_owned(),
        ));
    };
    let separator = [';', '\t', ',']
        .into_iter()
        .find(|c| head.contains(*c))
        .unwrap_or(',');
    let cells = |line: &str| -> Vec<String> {
        let trimmed = line
            .split(separator)
            .map(|cell| cell.trim().trim_matches('"').to_owned());
        trimmed.collect()
    };
    let names = cells(head);
    for (column, name) in names.iter().enumerate() {
        let known =
            is_number(name) || ["gait", "amplitude_deg", "amplitude_rad"].contains(&name.as_str());
        if !known {
            return Err(error(
                first,
                column,
                format!(
                    "no column `{name}`: there are gait or amplitude_deg or amplitude_rad, cycles, x_mm, y_mm, turn_deg, delta_y_mm, \
                 delta_theta_deg, and each of these with _sd (x_sd_mm) or _se (x_se_mm)"
                ),
            ));
        }
        if names.iter().take(column).any(|before| before == name) {
            return Err(error(first, column, format!("a second column `{name}`")));
        }
    }
    let mut out = Vec::new();
    for (line, row) in lines {
        let row = cells(row);
        if row.len() != names.len() {
            let problem = format!("{} cells under {} names", row.len(), names.len());
            return Err(error(line, 0, problem));
        }
        let place = |name: &str| names.iter().position(|n| n == name);
        let cell = |name: &str| {
            let text = row.get(place(name)?)?.as_str();
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
                let problem = "one of gait, amplitude_deg and amplitude_rad says what was swum";
                return Err(error(line, 0, problem.to_owned()));
            }
        };
        let spec: GaitSpec = of_row
            .parse()
            .map_err(|cause| error(line, 0, format!("gait: {cause}")))?;
        if matches!(&spec, GaitSpec::File { path, .. } if ["circle", "square"].iter().any(|shape| path == Path::new(shape)))
        {
            let problem = format!("`{of_row}` has no amplitude: give a column amplitude_deg");
            return Err(error(line, 0, problem));
        }
        let mut told = told(number)
            .map_err(|(key, problem)| error(line, place(&key).unwrap_or(0), problem))?;
        told.table = Some(path.to_owned());
        out.push((line, spec, told));
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

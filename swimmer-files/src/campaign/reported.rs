//! Reported results instead of a track: X, ΔY, Δθ of a run with their errors.

use std::path::PathBuf;

/// A value of a run with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportedValue {
    /// Its mean over cycles.
    pub mean: f64,
    /// `_sd`: its standard deviation from cycle to cycle.
    pub sd: Option<f64>,
    /// `_se`: the standard error of the mean.
    pub se: Option<f64>,
}

/// Reported results of a run, in m and rad; `None` for missing ones.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReportedResults {
    /// X.
    pub x: Option<ReportedValue>,
    /// Y.
    pub y: Option<ReportedValue>,
    /// Net turn.
    pub turn: Option<ReportedValue>,
    /// ΔY.
    pub delta_y: Option<ReportedValue>,
    /// Δθ.
    pub delta_theta: Option<ReportedValue>,
    /// Number of cycles that the means are taken over.
    pub cycles: Option<usize>,
    /// The table that they are from, if any.
    pub table: Option<PathBuf>,
}

/// Names of the numbers without their `_sd` and `_se`, their units, and the factors to m or rad.
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

/// Results from the numbers of a run. Returns the key of the first invalid number, and the reason.
pub(super) fn reported(
    number: impl Fn(&str) -> Option<f64>,
) -> Result<ReportedResults, (String, String)> {
    let cycles = match number("cycles") {
        None => None,
        Some(count) if (1.0..=MOST_CYCLES).contains(&count) && count.fract() == 0.0 => {
            // Checked above.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            Some(count as usize)
        }
        Some(count) => {
            let problem = format!("cycles = {count} must be the number of cycles: 1, 2, 3, …");
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
                "{} is the deviation from cycle to cycle: give the number of `cycles` (2 at least), or {}, the error of the mean",
                key("_sd"),
                key("_se")
            );
            return Err((key("_sd"), problem));
        }
        Ok(Some(ReportedValue {
            mean: mean * si,
            sd,
            se,
        }))
    };
    let [x, y, turn, delta_y, delta_theta] = VALUES;
    let reported = ReportedResults {
        x: value(x)?,
        y: value(y)?,
        turn: value(turn)?,
        delta_y: value(delta_y)?,
        delta_theta: value(delta_theta)?,
        cycles,
        table: None,
    };
    if reported.x.is_none() && reported.delta_y.is_none() && reported.delta_theta.is_none() {
        let problem = "a run without a track needs x_mm, delta_y_mm or delta_theta_deg".to_owned();
        return Err((String::new(), problem));
    }
    Ok(reported)
}

//! What lies beyond the fit, as one JSON document.

use calibrate::evidence::{Evidence, Pair, Profile};
use calibrate::{EvidenceOptions, Intervals};
use serde_json::{Value, json};

fn pair(pair: &Pair) -> Value {
    json!({ "sphere_radius_m": pair.sphere_radius, "chi": pair.chi })
}

fn intervals(intervals: &Intervals) -> Value {
    json!({
        "sphere_radius_m": intervals.sphere_radius,
        "chi": intervals.chi,
        "level": intervals.level,
    })
}

fn profile(profile: &Profile) -> Value {
    json!({
        "points": profile.points,
        "threshold": profile.threshold,
        "interval": profile.interval,
        "open": profile.open,
        "freedom": profile.freedom,
    })
}

/// The document; `names` are the runs' files.
pub(crate) fn evidence_json(
    evidence: &Evidence,
    options: EvidenceOptions,
    names: &[String],
) -> Value {
    let name = |run: usize| names.get(run).cloned().unwrap_or_default();
    let likelihood = &evidence.likelihood;
    let run_errors: Vec<Value> = evidence
        .run_errors
        .iter()
        .enumerate()
        .map(|(run, errors)| {
            let of = |error: &calibrate::evidence::RunError| {
                json!({
                    "measured": error.measured,
                    "predicted": error.predicted,
                    "within": error.within,
                    "standard_error": error.standard_error,
                    "standardised": error.standardised,
                })
            };
            let [x, delta_y, delta_theta] = errors;
            json!({
                "file": name(run),
                "x_m": of(x),
                "delta_y_m": of(delta_y),
                "delta_theta_rad": of(delta_theta),
            })
        })
        .collect();
    let without_run: Vec<Value> = evidence
        .without_run
        .iter()
        .map(|without| {
            json!({
                "file": name(without.run),
                "paper": pair(&without.paper),
                "likelihood": without.likelihood.as_ref().map(pair),
            })
        })
        .collect();
    let outliers: Vec<Value> = evidence
        .outliers
        .iter()
        .map(|outlier| {
            json!({
                "file": name(outlier.run),
                "quantity": outlier.quantity.to_string(),
                "deviation": outlier.deviation,
                "standard_errors": outlier.standard_errors,
                "chance": outlier.chance,
            })
        })
        .collect();
    let contours: Vec<Value> = evidence
        .ridge
        .contours
        .iter()
        .map(|contour| {
            json!({
                "level": contour.level,
                "threshold": contour.threshold,
                "corners": contour.corners,
            })
        })
        .collect();
    let [sphere_radius, chi] = &evidence.profiles;
    json!({
        "likelihood": {
            "estimate": pair(&likelihood.estimate),
            "intervals": intervals(&likelihood.intervals),
            "between_runs": {
                "x_m": likelihood.between_runs[0],
                "delta_y_m": likelihood.between_runs[1],
                "delta_theta_rad": likelihood.between_runs[2],
            },
            "correlation": likelihood.correlation,
        },
        "run_errors": run_errors,
        "profiles": { "sphere_radius_m": profile(sphere_radius), "chi": profile(chi) },
        "ridge": {
            "sphere_radius_m": evidence.ridge.sphere_radius,
            "chi": evidence.ridge.chi,
            "log_ratio": evidence.ridge.log_ratio,
            "contours": contours,
        },
        "bootstrap": evidence.bootstrap.as_ref().map(|bootstrap| json!({
            "seed": options.seed,
            "draws": bootstrap.draws,
            "runs_drawn": true,
            "at_border": bootstrap.at_border,
            "intervals": intervals(&bootstrap.intervals),
        })),
        "without_run": without_run,
        "outliers": outliers,
        "surface_error": evidence.surface_error,
    })
}

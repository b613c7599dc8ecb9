//! Every intermediate of a calibration as CSV: SI units, one line each, numbers that read back exactly.

use std::fmt::Write as _;

use calibrate::evidence::{Evidence, Quantity};
use calibrate::{CampaignFit, Statistics};

/// A field of a table that may hold a comma or a quote.
pub(crate) fn field(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// The tables: file name, what it holds, its text. `names` are the runs' files as the campaign names them.
pub(crate) fn tables(
    found: &CampaignFit,
    evidence: &Evidence,
    names: &[String],
) -> Vec<(&'static str, &'static str, String)> {
    let names: Vec<String> = names.iter().map(|name| field(name)).collect();
    vec![
        (
            "poses.csv",
            "every pose: centre of the middle link, heading, how it was found (seen, tail, one-seen, filled)",
            poses(found, &names),
        ),
        (
            "cycles.csv",
            "every cycle, used or left out with the reason",
            cycles(found, &names),
        ),
        (
            "runs.csv",
            "X, Y, rotation, ΔY, Δθ of every run: mean, sd, standard error, lag-1 correlation",
            runs(found, &names),
        ),
        (
            "residuals.csv",
            "what the fit leaves of every run",
            residuals(evidence, &names),
        ),
        (
            "ridge.csv",
            "log-likelihood over r_s and χ, less its largest value",
            ridge(evidence),
        ),
        (
            "profiles.csv",
            "profile likelihoods of r_s and of χ",
            profiles(evidence),
        ),
        (
            "bootstrap.csv",
            "the fits of the bootstrap’s draws",
            bootstrap(evidence),
        ),
        (
            "without-run.csv",
            "the fits without each run",
            without_run(evidence, &names),
        ),
        (
            "circles.csv",
            "X, ΔY and Δθ of circles by the fitted model and by the starting one",
            circles(evidence),
        ),
    ]
}

fn poses(found: &CampaignFit, names: &[String]) -> String {
    let mut text = String::from("run,time_s,x_m,y_m,theta_rad,origin\n");
    for (run, name) in found.runs.iter().zip(names) {
        for sample in &run.poses.samples {
            let pose = &sample.pose;
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{name},{},{:.7},{:.7},{:.7},{}",
                sample.time_s,
                pose.x,
                pose.y,
                pose.theta,
                sample.origin.word()
            );
        }
    }
    text
}

fn cycles(found: &CampaignFit, names: &[String]) -> String {
    let mut text = String::from(
        "run,start_s,used,x_m,y_m,turn_rad,delta_y_m,delta_theta_rad,missing,residual_m,reason\n",
    );
    for (run, name) in found.runs.iter().zip(names) {
        let mut lines: Vec<(f64, String)> = Vec::new();
        for cycle in &run.cycles.cycles {
            let step = cycle.step.map_or(",,".to_owned(), |step| {
                format!("{:?},{:?},{:?}", step.x, step.y, step.theta)
            });
            lines.push((
                cycle.start_s,
                format!(
                    "yes,{step},{:?},{:?},{:?},{:?},",
                    cycle.delta_y, cycle.delta_theta, cycle.missing, cycle.residual_m
                ),
            ));
        }
        for (start_s, why) in &run.cycles.left_out {
            lines.push((*start_s, format!("no,,,,,,,,{}", field(&why.to_string()))));
        }
        lines.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (start_s, line) in lines {
            let _ = writeln!(text, "{name},{start_s:?},{line}");
        }
    }
    text
}

fn runs(found: &CampaignFit, names: &[String]) -> String {
    let mut text = String::from("run,gait,period_s,cycles,front,phase");
    for quantity in ["x_m", "y_m", "turn_rad", "delta_y_m", "delta_theta_rad"] {
        let _ = write!(
            text,
            ",{quantity},{quantity}_sd,{quantity}_se,{quantity}_lag1"
        );
    }
    text.push('\n');
    for (run, name) in found.runs.iter().zip(names) {
        let cycles = &run.cycles;
        let _ = write!(
            text,
            "{name},{},{:?},{},{},{}",
            field(&run.gait),
            cycles.period_s,
            cycles
                .count()
                .map_or_else(String::new, |count| count.to_string()),
            if run.is_told() {
                ""
            } else {
                run.poses.front.word()
            },
            cycles.phase.word()
        );
        for statistics in [
            &cycles.x,
            &cycles.y,
            &cycles.rotation,
            &cycles.delta_y,
            &cycles.delta_theta,
        ] {
            let Statistics {
                mean, sd, se, lag1, ..
            } = statistics;
            for value in [mean, sd, se, lag1] {
                text.push(',');
                // A single cycle has no deviation: an empty cell.
                if !value.is_nan() {
                    let _ = write!(text, "{value:?}");
                }
            }
        }
        text.push('\n');
    }
    text
}

fn residuals(evidence: &Evidence, names: &[String]) -> String {
    let mut text = String::from(
        "run,quantity,measured,predicted,within_run_se,standard_error,standardised,outlier\n",
    );
    for (index, (errors, name)) in evidence.run_errors.iter().zip(names).enumerate() {
        for (error, quantity) in errors.iter().zip(Quantity::ALL) {
            let is_out =
                |o: &calibrate::evidence::Outlier| o.run == index && o.quantity == quantity;
            let _ = writeln!(
                text,
                "{name},{quantity},{:?},{:?},{:?},{:?},{:?},{}",
                error.measured,
                error.predicted,
                error.within,
                error.standard_error,
                error.standardised,
                if evidence.outliers.iter().any(is_out) {
                    "yes"
                } else {
                    "no"
                }
            );
        }
    }
    text
}

fn ridge(evidence: &Evidence) -> String {
    let mut text = String::from("sphere_radius_m,chi,log_ratio\n");
    let ridge = &evidence.ridge;
    for (chi, row) in ridge.chi.iter().zip(&ridge.log_ratio) {
        for (radius, value) in ridge.sphere_radius.iter().zip(row) {
            let _ = writeln!(text, "{radius:?},{chi:?},{value:?}");
        }
    }
    text
}

fn profiles(evidence: &Evidence) -> String {
    let mut text = String::from("parameter,value,log_ratio\n");
    for (profile, name) in evidence.profiles.iter().zip(["sphere_radius_m", "chi"]) {
        for (value, log_ratio) in &profile.points {
            let _ = writeln!(text, "{name},{value:?},{log_ratio:?}");
        }
    }
    text
}

fn bootstrap(evidence: &Evidence) -> String {
    let mut text = String::from("sphere_radius_m,chi\n");
    for pair in evidence
        .bootstrap
        .iter()
        .flat_map(|bootstrap| &bootstrap.points)
    {
        let _ = writeln!(text, "{:?},{:?}", pair.sphere_radius, pair.chi);
    }
    text
}

fn without_run(evidence: &Evidence, names: &[String]) -> String {
    let mut text =
        String::from("without,sphere_radius_m,chi,likelihood_sphere_radius_m,likelihood_chi\n");
    for without in &evidence.without_run {
        let likelihood = without.likelihood.map_or(",".to_owned(), |pair| {
            format!("{:?},{:?}", pair.sphere_radius, pair.chi)
        });
        let _ = writeln!(
            text,
            "{},{:?},{:?},{likelihood}",
            names.get(without.run).map_or("", String::as_str),
            without.paper.sphere_radius,
            without.paper.chi
        );
    }
    text
}

fn circles(evidence: &Evidence) -> String {
    let mut text = String::from("model,amplitude_rad,x_m,delta_y_m,delta_theta_rad\n");
    for (model, curve) in [
        ("fitted", &evidence.fitted_curve),
        ("start", &evidence.start_curve),
    ] {
        for point in curve {
            let cycle = &point.cycle;
            let _ = writeln!(
                text,
                "{model},{:?},{:?},{:?},{:?}",
                point.amplitude_rad, cycle.x_m, cycle.delta_y_m, cycle.delta_theta_rad
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::field;

    #[test]
    fn fields_with_commas_and_quotes_stay_one_field() {
        assert_eq!(field("a.csv"), "a.csv");
        assert_eq!(field("a, \"b\".csv"), "\"a, \"\"b\"\".csv\"");
    }
}

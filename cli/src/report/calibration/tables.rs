//! Every intermediate of a calibration as CSV.

use calibrate::evidence::{Evidence, Outlier, Quantity};
use calibrate::{CampaignFit, Statistics};

use crate::csv_text::csv_text;
use crate::failure::Outcome;

/// A table: file name, what it holds, its text.
pub(crate) type Table = (&'static str, &'static str, String);

/// The tables. `names` are the runs' files as the campaign names them.
///
/// # Errors
/// Errors of the writing.
pub(crate) fn tables(
    found: &CampaignFit,
    evidence: &Evidence,
    names: &[String],
) -> Outcome<Vec<Table>> {
    Ok(vec![
        (
            "poses.csv",
            "every pose: centre of the middle link, heading, how it was found (seen, tail, one-seen, filled)",
            poses(found, names)?,
        ),
        (
            "cycles.csv",
            "every cycle, used or left out with the reason",
            cycles(found, names)?,
        ),
        (
            "runs.csv",
            "X, Y, rotation, ΔY, Δθ of every run: mean, sd, standard error, lag-1 correlation",
            runs(found, names)?,
        ),
        (
            "residuals.csv",
            "residuals of the fit for every run",
            residuals(evidence, names)?,
        ),
        (
            "ridge.csv",
            "log-likelihood over r_s and χ, less its largest value",
            ridge(evidence)?,
        ),
        (
            "profiles.csv",
            "profile likelihoods of r_s and of χ",
            profiles(evidence)?,
        ),
        (
            "bootstrap.csv",
            "the fits of the bootstrap’s draws",
            bootstrap(evidence)?,
        ),
        (
            "without-run.csv",
            "the fits without each run",
            without_run(evidence, names)?,
        ),
        (
            "circles.csv",
            "X, ΔY and Δθ of circles by the fitted model and by the starting one",
            circles(evidence)?,
        ),
    ])
}

fn poses(found: &CampaignFit, names: &[String]) -> Outcome<String> {
    let runs = found.runs.iter().zip(names);
    let rows = runs.flat_map(|(run, name)| {
        run.poses.samples.iter().map(move |sample| {
            let pose = &sample.pose;
            let pose = [pose.x, pose.y, pose.theta].map(|value| format!("{value:.7}"));
            (name, sample.time_s, pose, sample.origin.word())
        })
    });
    csv_text("run,time_s,x_m,y_m,theta_rad,origin".split(','), rows)
}

fn cycles(found: &CampaignFit, names: &[String]) -> Outcome<String> {
    let mut rows = Vec::new();
    for (run, name) in found.runs.iter().zip(names) {
        let begun = rows.len();
        rows.extend(run.cycles.cycles.iter().map(|cycle| {
            let step = cycle
                .step
                .map(|step| [step.x, step.y, step.theta].map(Some));
            let shape = [
                cycle.delta_y,
                cycle.delta_theta,
                cycle.missing,
                cycle.residual_m,
            ];
            let step = step.unwrap_or_default();
            (
                name,
                cycle.start_s,
                "yes",
                step,
                shape.map(Some),
                String::new(),
            )
        }));
        rows.extend(run.cycles.left_out.iter().map(|(start_s, why)| {
            let none = ([None; 3], [None; 4]);
            (name, *start_s, "no", none.0, none.1, why.to_string())
        }));
        rows[begun..].sort_by(|a, b| a.1.total_cmp(&b.1));
    }
    csv_text(
        "run,start_s,used,x_m,y_m,turn_rad,delta_y_m,delta_theta_rad,missing,residual_m,reason"
            .split(','),
        rows,
    )
}

fn runs(found: &CampaignFit, names: &[String]) -> Outcome<String> {
    let quantities = ["x_m", "y_m", "turn_rad", "delta_y_m", "delta_theta_rad"];
    let heading = "run,gait,period_s,cycles,front,phase".split(',');
    let heading = heading.map(str::to_owned).chain(
        quantities
            .iter()
            .flat_map(|quantity| ["", "_sd", "_se", "_lag1"].map(|of| format!("{quantity}{of}"))),
    );
    let rows = found.runs.iter().zip(names).map(|(run, name)| {
        let cycles = &run.cycles;
        let front = if run.is_reported() {
            ""
        } else {
            run.poses.front.word()
        };
        let statistics = [
            &cycles.x,
            &cycles.y,
            &cycles.rotation,
            &cycles.delta_y,
            &cycles.delta_theta,
        ];
        let statistics = statistics.map(|of| {
            let Statistics {
                mean, sd, se, lag1, ..
            } = of;
            // A single cycle has no deviation: an empty cell.
            [mean, sd, se, lag1].map(|value| (!value.is_nan()).then_some(*value))
        });
        (
            name,
            &run.gait,
            cycles.period_s,
            cycles.count(),
            front,
            cycles.phase.word(),
            statistics,
        )
    });
    csv_text(heading, rows)
}

fn residuals(evidence: &Evidence, names: &[String]) -> Outcome<String> {
    let runs = evidence.run_errors.iter().zip(names).enumerate();
    let rows = runs.flat_map(|(index, (errors, name))| {
        errors
            .iter()
            .zip(Quantity::ALL)
            .map(move |(error, quantity)| {
                let is_out = |o: &Outlier| o.run == index && o.quantity == quantity;
                let outlier = if evidence.outliers.iter().any(is_out) {
                    "yes"
                } else {
                    "no"
                };
                let numbers = [
                    error.measured,
                    error.predicted,
                    error.within,
                    error.standard_error,
                    error.standardised,
                ];
                (name, quantity.to_string(), numbers, outlier)
            })
    });
    csv_text(
        "run,quantity,measured,predicted,within_run_se,standard_error,standardised,outlier"
            .split(','),
        rows,
    )
}

fn ridge(evidence: &Evidence) -> Outcome<String> {
    let ridge = &evidence.ridge;
    let rows = ridge
        .chi
        .iter()
        .zip(&ridge.log_ratio)
        .flat_map(|(chi, row)| {
            let values = ridge.sphere_radius.iter().zip(row);
            values.map(move |(radius, value)| [radius, chi, value])
        });
    csv_text("sphere_radius_m,chi,log_ratio".split(','), rows)
}

fn profiles(evidence: &Evidence) -> Outcome<String> {
    let profiles = ["sphere_radius_m", "chi"]
        .into_iter()
        .zip(&evidence.profiles);
    let rows =
        profiles.flat_map(|(name, profile)| profile.points.iter().map(move |point| (name, point)));
    csv_text("parameter,value,log_ratio".split(','), rows)
}

fn bootstrap(evidence: &Evidence) -> Outcome<String> {
    let draws = evidence
        .bootstrap
        .iter()
        .flat_map(|bootstrap| &bootstrap.points);
    let rows = draws.map(|pair| [pair.sphere_radius, pair.chi]);
    csv_text("sphere_radius_m,chi".split(','), rows)
}

fn without_run(evidence: &Evidence, names: &[String]) -> Outcome<String> {
    let rows = evidence.without_run.iter().map(|without| {
        let name = names.get(without.run).map_or("", String::as_str);
        let likelihood = without
            .likelihood
            .map(|pair| [pair.sphere_radius, pair.chi].map(Some));
        let paper = [without.paper.sphere_radius, without.paper.chi];
        (name, paper, likelihood.unwrap_or_default())
    });
    csv_text(
        "without,sphere_radius_m,chi,likelihood_sphere_radius_m,likelihood_chi".split(','),
        rows,
    )
}

fn circles(evidence: &Evidence) -> Outcome<String> {
    let curves = [
        ("fitted", &evidence.fitted_curve),
        ("start", &evidence.start_curve),
    ];
    let rows = curves.into_iter().flat_map(|(model, curve)| {
        curve.iter().map(move |point| {
            let cycle = &point.cycle;
            (
                model,
                point.amplitude_rad,
                cycle.x_m,
                cycle.delta_y_m,
                cycle.delta_theta_rad,
            )
        })
    });
    csv_text(
        "model,amplitude_rad,x_m,delta_y_m,delta_theta_rad".split(','),
        rows,
    )
}

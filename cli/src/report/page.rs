//! The report as one self-contained HTML page.

use std::fmt::Write;

use super::swimming::snapshots;
use super::{Report, figures};
use crate::failure::Outcome;
use crate::quantity;

/// Builds the whole page; the same report gives the same bytes.
///
/// # Errors
/// As the drawing of a chart.
pub(crate) fn page(report: &Report) -> Outcome<String> {
    let mut html = head("Swimmer: once round the loop");
    heading(&mut html, report);
    cards(&mut html, report);
    html.push_str("<section>");
    figure(
        &mut html,
        &snapshots(&report.swimming),
        "The swimmer under the optimised gait",
        "As the cameras saw it, in the colours of time: the body every few cycles, the path of its centre, and the shape it \
         had then in the plane of the joint angles. The disc is the sphere of the fitted model.",
    );
    html.push_str("</section><section class=grid>");
    figure(
        &mut html,
        &figures::displacement(&report.circles, &report.fitted_curve, &report.start_curve)?,
        "Displacement of circles",
        "<i class=dot style='color:#1f6fb2'></i>tracked, mean ± sd over cycles \
         <i style='color:#1d242c'></i>fitted model <i style='color:#3a9d5d'></i>model the fit started from",
    );
    figure_pair(
        &mut html,
        [
            &figures::delta_y(&report.circles, &report.fitted_curve, &report.start_curve)?,
            &figures::delta_theta(&report.circles, &report.fitted_curve, &report.start_curve)?,
        ],
        "Sway and yaw of circles",
        "Half of maximum − minimum within a cycle; colours as on the left.",
    );
    let name = escaped(&report.track.label);
    figure(
        &mut html,
        &figures::track(&report.track)?,
        &format!("Track of {name}"),
        "Centre of the middle link, from the two reflectors; x along the heading at φ₁ = φ₂ &gt; 0.",
    );
    figure_pair(
        &mut html,
        [
            &figures::x_over_time(&report.track)?,
            &figures::heading_over_time(&report.track)?,
        ],
        &format!("{name} over time"),
        "The cycles that count: the first one, start-up, is left out.",
    );
    figure(
        &mut html,
        &figures::gait(&report.gait)?,
        "The optimised gait",
        &format!(
            "<i class=band style='color:#c3cdd6'></i>singular arcs <i class=band style='color:#d8b9e6'></i>on the bound \
             <i class=dot style='color:#1f6fb2'></i>uploaded knots (every eighth) \
             <i style='color:#d35b1e'></i>what the servos make of them. {}",
            bound(report)
        ),
    );
    figure(
        &mut html,
        &figures::prediction(report)?,
        "Prediction against track",
        "<i class=band style='color:#9dc6e8'></i>tracked <i style='color:#d35b1e'></i>predicted by the fitted model, \
         with the servos’ rate limit and dead band",
    );
    files(&mut html, report);
    html.push_str("</section>");
    runs(&mut html, report);
    html.push_str(END);
    Ok(html)
}

fn bound(report: &Report) -> String {
    let (bound, servos) = report.bounds;
    if bound < servos {
        format!(
            "The bound is {bound:.2} rad: nearer the servos’ {servos:.2} rad no optimum exists or links come too close."
        )
    } else {
        format!("The bound is the servos’ {bound:.2} rad.")
    }
}

fn heading(html: &mut String, report: &Report) {
    let _ = write!(
        html,
        "<header><h1>Once round the loop</h1><p>Circles uploaded, swum and tracked; the drag of <b>{}</b> fitted from the \
         tracks; a gait optimised with the fitted model, uploaded, swum and compared with the prediction. \
         Period {} s, seed {}.</p></header>",
        escaped(&report.swimmer),
        report.period_s,
        report.seed,
    );
    if let Some(lab) = &report.lab {
        let _ = write!(
            html,
            "<p><a href='{}'>Open the fitted swimmer and its gait in the lab page</a>: drag it, change the fluid, drive a robot.</p>",
            escaped(lab)
        );
    }
}

fn cards(html: &mut String, report: &Report) {
    html.push_str(
        "<section class=top><div class=scroll tabindex=0><table class=fit><thead><tr><th>parameter<th>start<th>fitted",
    );
    let _ = write!(
        html,
        "<th>{:.0} % interval<th>in the tank<th>deviation</tr></thead><tbody>",
        report.level * 100.0
    );
    for parameter in &report.parameters {
        let deviation = quantity::relative(parameter.fitted, parameter.truth).map_or_else(
            || {
                format!(
                    "{:+.3} {}",
                    parameter.fitted - parameter.truth,
                    parameter.unit
                )
            },
            quantity::deviation,
        );
        let _ = write!(
            html,
            "<tr><th>{}<td>{:.3}{u}<td class=main>{:.3}{u}<td>{:.3} … {:.3}{u}<td>{:.3}{u}<td>{}</tr>",
            parameter.name,
            parameter.start,
            parameter.fitted,
            parameter.interval[0],
            parameter.interval[1],
            parameter.truth,
            minus(&deviation),
            u = if parameter.unit.is_empty() {
                String::new()
            } else {
                format!(" {}", parameter.unit)
            },
        );
    }
    let _ = write!(
        html,
        "</tbody></table></div><p class=note>RMSE {} (paper’s weights) with {}.</p>",
        minus(&quantity::small(report.rmse)),
        escaped(&report.c_t_form)
    );
    let (tracked, deviation) = report.displacement_tracked_m;
    let _ = write!(
        html,
        "<dl><div><dt>predicted</dt><dd>{:.2}<small> mm per cycle</small></dd></div>\
         <div><dt>tracked</dt><dd>{:.2}<small> ± {:.2} mm</small></dd></div>\
         <div><dt>prediction − track</dt><dd>{}</dd></div>\
         <div><dt>fastest gait, both at full rate</dt><dd>{:.2} ×<small> as fast, {:.2} mm a second</small></dd></div>\
         </dl></section>",
        report.displacement_predicted_m * 1e3,
        tracked * 1e3,
        deviation * 1e3,
        minus(
            &quantity::relative(report.displacement_predicted_m, tracked).map_or_else(
                || quantity::length(report.displacement_predicted_m - tracked),
                quantity::deviation,
            )
        ),
        report.fastest.1,
        report.fastest.0 * 1e3,
    );
}

/// A figure with its title and caption.
pub(crate) fn figure(html: &mut String, svg: &str, title: &str, caption: &str) {
    let _ = write!(
        html,
        "<figure><h2>{title}</h2>{svg}<figcaption>{caption}</figcaption></figure>"
    );
}

/// Two charts in one figure.
pub(crate) fn figure_pair(html: &mut String, svgs: [&str; 2], title: &str, caption: &str) {
    figure(html, &svgs.concat(), title, caption);
}

fn files(html: &mut String, report: &Report) {
    html.push_str("<figure class=files><h2>In this folder</h2><table>");
    for (name, what) in &report.files {
        let _ = write!(
            html,
            "<tr><th><code>{}</code><td>{}</tr>",
            escaped(name),
            escaped(what)
        );
    }
    html.push_str("</table></figure>");
}

fn runs(html: &mut String, report: &Report) {
    html.push_str(
        "<section><h2>The circles</h2><div class=scroll tabindex=0><table class=circles><thead><tr><th>amplitude<th>cycles\
         <th>X [mm]<th>sd<th>ΔY [mm]<th>sd<th>Δθ [°]<th>sd</tr></thead><tbody>",
    );
    for circle in &report.circles {
        let _ = write!(
            html,
            "<tr><th>{:.0}°<td>{}<td>{}<td>{:.3}<td>{:.3}<td>{:.3}<td>{:.3}<td>{:.3}</tr>",
            circle.amplitude.to_degrees(),
            circle.cycles,
            minus(&format!("{:.3}", circle.x.0 * 1e3)),
            circle.x.1 * 1e3,
            circle.delta_y.0 * 1e3,
            circle.delta_y.1 * 1e3,
            circle.delta_theta.0.to_degrees(),
            circle.delta_theta.1.to_degrees(),
        );
    }
    html.push_str("</tbody></table></div></section>");
}

/// A true minus sign instead of a hyphen.
pub(crate) fn minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// Text that cannot break the page.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// Everything before the page's content; the page asks for nothing from outside.
pub(crate) fn head(title: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=en><head><meta charset=utf-8>\
         <meta name=viewport content='width=device-width,initial-scale=1'><title>{}</title><style>\n{}</style></head><body><main>",
        escaped(title),
        include_str!("page.css")
    )
}

/// Everything after it.
pub(crate) const END: &str = "</main></body></html>\n";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_the_page() {
        assert_eq!(
            escaped("<b>'a' & \"b\""),
            "&lt;b&gt;&#39;a&#39; &amp; &quot;b&quot;"
        );
    }
}

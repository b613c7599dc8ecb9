//! Gait to text: the format's own documentation, the header, the samples with 17 digits.

use std::fmt::Write as _;

use super::{GaitFile, Objective};

/// Documentation that heads every file; the reader skips lines that start with `##`.
const ABOUT: &str = "\
## One cycle of a three-link swimmer's gait. Lines with `##` are for people. Lines `# key: value` are the header:
##   objective      displacement | efficiency | turning | sideways | speed | joined-forward | joined-sideways |
##                  joined-turning (fastest of the gaits that begin and end at the first sample's shape) | unspecified
##   swimmer        name of the swimmer that the gait was made for
##   swimmer_hash   SHA-256 of its links, drag and sphere
##   optimal_period of a fastest gait: the period in s for which it goes farthest, or `none`: fastest of any period
##   bounds         max_angle and min_angle in rad or `none`; sector and no_overlap `true` or `false`;
##                  clearance_m the least distance of the side links in metres
##   passive        front or back: this joint has a spring, not a servo, and its samples are the response; then
##                  relaxation=SHARE, its relaxation time over the period
##   arc            kind (singular, upper, lower, diagonal, clearance, regular, extreme), then from and to in u; in order
##   corner         a u where the direction in the (phi1, phi2) plane jumps; the curve is smooth between corners
## Then, after the line `u,phi1,phi2`, the samples: u is the fraction of the period, rising from 0 to 1; the joint angles
## are in radians; the last sample is the first one again. 17 digits: a number reads back exactly. x runs along the middle
## link as it lies at the first sample. In Python: numpy.loadtxt(FILE, delimiter=',', comments=('#', 'u')).
";

pub(super) fn gait_text(file: &GaitFile) -> String {
    let mut text = String::with_capacity(2000 + 80 * file.u.len());
    // Writing to a String cannot fail.
    let _ = write_all(&mut text, file);
    text
}

fn write_all(text: &mut String, file: &GaitFile) -> std::fmt::Result {
    writeln!(text, "# swimmer gait file, version {}", GaitFile::VERSION)?;
    text.push_str(ABOUT);
    writeln!(text, "# objective: {}", file.objective)?;
    if let Some(name) = &file.swimmer_name {
        writeln!(text, "# swimmer: {}", one_line(name))?;
    }
    if let Some(hash) = &file.swimmer_hash {
        writeln!(text, "# swimmer_hash: {hash}")?;
    }
    if let Some(period) = file.optimal_period {
        writeln!(text, "# optimal_period: {period:?}")?;
    } else if file.objective == Objective::Speed {
        writeln!(text, "# optimal_period: none")?;
    }
    let bounds = &file.bounds;
    writeln!(
        text,
        "# bounds: max_angle={} min_angle={} sector={} no_overlap={} clearance_m={:?}",
        angle(bounds.max_angle),
        angle(bounds.min_angle),
        bounds.sector,
        bounds.no_overlap,
        bounds.clearance
    )?;
    if let Some(passive) = &file.passive {
        writeln!(text, "# passive: {passive}")?;
    }
    for arc in &file.arcs {
        writeln!(
            text,
            "# arc: {} {:.16e} {:.16e}",
            arc.kind, arc.from, arc.to
        )?;
    }
    for corner in &file.corners {
        writeln!(text, "# corner: {corner:.16e}")?;
    }
    writeln!(text, "u,phi1,phi2")?;
    for (u, phi) in file.u.iter().zip(&file.phi) {
        writeln!(text, "{u:.16e},{:.16e},{:.16e}", phi.x, phi.y)?;
    }
    Ok(())
}

fn angle(bound: Option<f64>) -> String {
    bound.map_or_else(|| "none".to_owned(), |value| format!("{value:?}"))
}

/// A name may hold anything; the header is one line for each key.
fn one_line(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

//! Text to gait: strict, with line and column for every complaint.

use std::path::Path;
use std::str::FromStr;

use nalgebra::Vector2;

use super::{Bounds, GaitArc, GaitFile};
use crate::{FileError, Quantity};

const FIRST_LINE: &str = "# swimmer gait file, version ";
const COLUMNS: &str = "u,phi1,phi2";

/// One line of the file with its place.
#[derive(Clone, Copy)]
struct GaitLine<'a> {
    path: &'a Path,
    number: usize,
    text: &'a str,
}

impl GaitLine<'_> {
    /// An error at a part of this line (a slice of it), or at its start.
    fn error(&self, part: &str, problem: impl Into<String>) -> FileError {
        let offset = (part.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        let before = self.text.get(..offset).unwrap_or_default();
        FileError::at(self.path, self.number, before.chars().count() + 1, problem)
    }

    fn number(&self, part: &str) -> Result<f64, FileError> {
        let trimmed = part.trim();
        match trimmed.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.error(trimmed, format!("`{trimmed}` is not a finite number"))),
        }
    }

    fn joint_angle(&self, part: &str) -> Result<f64, FileError> {
        let value = self.number(part)?;
        if Quantity::Angle.checked(value).is_ok() {
            return Ok(value);
        }
        let problem = format!(
            "a joint angle of {value} rad is more than a turn: did you mean {value}°? Write {:.6}, angles in a gait file are radians",
            value.to_radians()
        );
        Err(self.error(part.trim(), problem))
    }

    fn fraction(&self, part: &str) -> Result<f64, FileError> {
        let value = self.number(part)?;
        if (0.0..=1.0).contains(&value) {
            Ok(value)
        } else {
            Err(self.error(
                part.trim(),
                format!("u = {value} is outside the cycle, 0 to 1"),
            ))
        }
    }

    fn word<T: FromStr>(&self, part: &str) -> Result<T, FileError>
    where
        T::Err: std::fmt::Display,
    {
        part.trim()
            .parse()
            .map_err(|problem| self.error(part.trim(), format!("`{}`: {problem}", part.trim())))
    }
}

pub(super) fn gait_file(text: &str, path: &Path) -> Result<GaitFile, FileError> {
    let mut lines = text.lines().enumerate().map(|(index, text)| GaitLine {
        path,
        number: index + 1,
        text,
    });
    check_version(path, lines.next())?;
    let mut file = GaitFile::default();
    let mut corner_places = Vec::new();
    let mut last_line = 1;
    for line in lines.by_ref() {
        last_line = line.number;
        if line.text.trim() == COLUMNS {
            break;
        }
        if let Some(corner) = header_line(&mut file, line)? {
            corner_places.push((line, corner));
        }
    }
    let mut last = None;
    for line in lines {
        last_line = line.number;
        if line.text.trim().is_empty() || line.text.starts_with('#') {
            continue;
        }
        sample_line(&mut file, line)?;
        last = Some(line);
    }
    let Some(last) = last.filter(|_| file.u.len() >= GaitFile::FEWEST_SAMPLES) else {
        let problem = format!(
            "{} samples after the line `{COLUMNS}`; a gait needs at least {}",
            file.u.len(),
            GaitFile::FEWEST_SAMPLES
        );
        return Err(FileError::at(path, last_line, 1, problem));
    };
    check_closure(&file, last)?;
    for (line, corner) in corner_places {
        if !file.u.iter().any(|u| u.to_bits() == corner.to_bits()) {
            return Err(line.error("", format!("no sample has the u of the corner, {corner}")));
        }
    }
    Ok(file)
}

fn check_version(path: &Path, first: Option<GaitLine<'_>>) -> Result<(), FileError> {
    let not_a_gait = || {
        FileError::at(
            path,
            1,
            1,
            format!("not a gait file: line 1 should read `{FIRST_LINE}1`"),
        )
    };
    let line = first.ok_or_else(not_a_gait)?;
    let version = line
        .text
        .trim_end()
        .strip_prefix(FIRST_LINE)
        .ok_or_else(not_a_gait)?;
    match version.parse::<u32>() {
        Ok(version) if (1..=GaitFile::VERSION).contains(&version) => Ok(()),
        Ok(newer) => Err(line.error(
            version,
            format!(
                "version {newer}, but this program reads up to {}: use a newer one",
                GaitFile::VERSION
            ),
        )),
        Err(_) => Err(line.error(version, format!("`{version}` is not a version number"))),
    }
}

/// Takes one header line; a corner is handed back so that it can be checked against the samples.
fn header_line(file: &mut GaitFile, line: GaitLine<'_>) -> Result<Option<f64>, FileError> {
    if line.text.trim().is_empty() || line.text.starts_with("##") {
        return Ok(None);
    }
    let Some((key, value)) = line
        .text
        .strip_prefix('#')
        .and_then(|rest| rest.split_once(':'))
    else {
        let problem = format!("expected `# key: value`, a `##` comment or the line `{COLUMNS}`");
        return Err(line.error("", problem));
    };
    match key.trim() {
        "objective" => file.objective = line.word(value)?,
        "swimmer" => file.swimmer_name = Some(value.trim().to_owned()),
        "swimmer_hash" => file.swimmer_hash = Some(line.word(value)?),
        "optimal_period" => file.optimal_period = optimal_period(line, value)?,
        "bounds" => file.bounds = bounds(line, value)?,
        "passive" => file.passive = Some(line.word(value)?),
        "arc" => file.arcs.push(arc(line, value)?),
        "corner" => {
            let corner = line.fraction(value)?;
            if corner >= 1.0 {
                return Err(line.error(
                    value.trim(),
                    "a corner lies in 0 <= u < 1; the one at u = 1 is that at 0",
                ));
            }
            file.corners.push(corner);
            return Ok(Some(corner));
        }
        unknown => {
            let problem = format!(
                "unknown key `{unknown}`: the keys are objective, swimmer, swimmer_hash, optimal_period, bounds, passive, arc and corner"
            );
            return Err(line.error(key.trim(), problem));
        }
    }
    Ok(None)
}

fn optimal_period(line: GaitLine<'_>, value: &str) -> Result<Option<f64>, FileError> {
    if value.trim() == "none" {
        return Ok(None);
    }
    let period = line.number(value)?;
    if period > 0.0 {
        Ok(Some(period))
    } else {
        Err(line.error(value.trim(), "a period is above 0 s, or `none`"))
    }
}

fn bounds(line: GaitLine<'_>, value: &str) -> Result<Bounds, FileError> {
    let mut bounds = Bounds::default();
    for item in value.split_whitespace() {
        let (key, value) = item
            .split_once('=')
            .ok_or_else(|| line.error(item, format!("`{item}` is not of the form key=value")))?;
        let angle = || match value {
            "none" => Ok(None),
            _ => line.joint_angle(value).map(Some),
        };
        let flag = || {
            value
                .parse::<bool>()
                .map_err(|_| line.error(value, format!("`{value}` is neither true nor false")))
        };
        match key {
            "max_angle" => bounds.max_angle = angle()?,
            "min_angle" => bounds.min_angle = angle()?,
            "sector" => bounds.sector = flag()?,
            "no_overlap" => bounds.no_overlap = flag()?,
            "clearance_m" => {
                bounds.clearance = line.number(value)?;
                if bounds.clearance < 0.0 {
                    return Err(line.error(value, "a clearance is a length in metres, 0 or above"));
                }
            }
            _ => {
                let problem = format!(
                    "unknown bound `{key}`: max_angle, min_angle, sector, no_overlap and clearance_m are known"
                );
                return Err(line.error(item, problem));
            }
        }
    }
    Ok(bounds)
}

fn arc(line: GaitLine<'_>, value: &str) -> Result<GaitArc, FileError> {
    let mut parts = value.split_whitespace();
    let (Some(kind), Some(from), Some(to), None) =
        (parts.next(), parts.next(), parts.next(), parts.next())
    else {
        return Err(line.error(value.trim(), "an arc is its kind, then from and to in u"));
    };
    let arc = GaitArc {
        kind: line.word(kind)?,
        from: line.fraction(from)?,
        to: line.fraction(to)?,
    };
    if arc.from > arc.to {
        return Err(line.error(
            from,
            format!(
                "the arc ends at u = {} before it starts at {}",
                arc.to, arc.from
            ),
        ));
    }
    Ok(arc)
}

fn sample_line(file: &mut GaitFile, line: GaitLine<'_>) -> Result<(), FileError> {
    let mut parts = line.text.split(',');
    let (Some(u), Some(phi1), Some(phi2), None) =
        (parts.next(), parts.next(), parts.next(), parts.next())
    else {
        return Err(line.error("", "a sample has three numbers: u,phi1,phi2"));
    };
    let fraction = line.fraction(u)?;
    match file.u.last() {
        None if fraction > 0.0 => {
            return Err(line.error(
                u,
                format!("the first sample has u = {fraction}; it must be 0"),
            ));
        }
        Some(&before) if fraction <= before => {
            return Err(line.error(
                u,
                format!("u = {fraction} does not rise above the {before} before it"),
            ));
        }
        _ => {}
    }
    file.u.push(fraction);
    file.phi.push(Vector2::new(
        line.joint_angle(phi1)?,
        line.joint_angle(phi2)?,
    ));
    Ok(())
}

fn check_closure(file: &GaitFile, last_line: GaitLine<'_>) -> Result<(), FileError> {
    let (Some(&u), Some(first), Some(last)) = (file.u.last(), file.phi.first(), file.phi.last())
    else {
        return Ok(());
    };
    if u < 1.0 {
        return Err(last_line.error(
            "",
            format!("the last sample has u = {u}; it must be 1, with the first shape again"),
        ));
    }
    let gap = (last - first).norm();
    if gap > GaitFile::CLOSURE {
        let problem =
            format!("the cycle does not close: the last shape is {gap:e} rad from the first");
        return Err(last_line.error("", problem));
    }
    Ok(())
}

//! Which format is this? Decided by what the first lines say, never by the file's name.

use std::path::Path;

use super::lines::{Cell, Delimiter, Line, lines, split};
use super::number::{Number, number};
use super::{TrackError, TrackProblem};

/// A format that there is a reader for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detected {
    /// Wide Motive export.
    Wide(Delimiter),
    /// A table with named columns.
    Table(TableLayout),
}

/// Where a table's header is, and what separates its cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TableLayout {
    /// What separates the cells.
    pub(super) delimiter: Delimiter,
    /// The header's line number.
    pub(super) header_line: usize,
}

/// First words of the record lines of Tracking Tools 2.x and Motive 1.x.
const RECORD_WORDS: [&str; 7] = [
    "comment",
    "righthanded",
    "lefthanded",
    "info",
    "trackable",
    "rigidbody",
    "frame",
];

/// # Errors
/// [`TrackError::NotReadYet`] with the name of a format that is recognised, else what keeps the file from being one.
pub(super) fn detect(text: &str, file: &Path) -> Result<Detected, TrackError> {
    let mut head = lines(text).filter(|line| !line.is_blank());
    let Some(first) = head.next() else {
        return Err(TrackError::Empty {
            file: file.to_owned(),
        });
    };
    let second = head.next();
    if let Some(delimiter) = wide_delimiter(&first) {
        return Ok(Detected::Wide(delimiter));
    }
    if let Some(format) = named_format(text, &first, second.as_ref(), file) {
        return Err(TrackError::NotReadYet {
            file: file.to_owned(),
            format,
        });
    }
    table(text, &first, file)
}

fn wide_delimiter(first: &Line<'_>) -> Option<Delimiter> {
    let rest = first.text.trim_start_matches(['"', ' ']);
    let key = rest.get(.."Format Version".len())?;
    if !key.eq_ignore_ascii_case("Format Version") {
        return None;
    }
    match rest
        .get(key.len()..)?
        .trim_start_matches(['"', ' '])
        .chars()
        .next()
    {
        Some(',') => Some(Delimiter::Comma),
        Some(';') => Some(Delimiter::Semicolon),
        Some('\t') => Some(Delimiter::Tab),
        _ => None,
    }
}

/// The name of a format that is recognised and not read.
fn named_format(
    text: &str,
    first: &Line<'_>,
    second: Option<&Line<'_>>,
    file: &Path,
) -> Option<String> {
    let delimiter = Delimiter::of(first.text);
    let (mut cells, mut below) = (Vec::new(), Vec::new());
    split(first, delimiter, file, &mut cells).ok()?;
    if let Some(second) = second {
        // A broken second line is the reader's to report.
        let _ = split(second, Delimiter::of(second.text), file, &mut below);
    }
    let word = cells.first()?.raw;
    let alone = cells.iter().skip(1).all(|cell| cell.raw.is_empty());
    let fixed = match word {
        "scorer" => Some("deeplabcut"),
        "PathFileType" => Some("trc"),
        "NO_OF_FRAMES" => Some("qtm"),
        "Trajectories" | "Model Outputs" | "Segments" | "Joints" | "Devices" if alone => {
            Some("vicon")
        }
        _ if word.to_ascii_lowercase().starts_with("#multi:") => Some("tracker"),
        _ if is_tracker(&cells, &below) => Some("tracker"),
        _ if is_headerless(&cells) => Some("motive-without-header"),
        _ => None,
    };
    fixed
        .map(str::to_owned)
        .or_else(|| record_lines(text, word))
}

/// The version of the record-line family, from its `info,version` line or from its words.
fn record_lines(text: &str, word: &str) -> Option<String> {
    if !RECORD_WORDS.contains(&word) {
        return None;
    }
    // `frame` alone also heads plain tables; the family's `frame` line carries numbers.
    let head: Vec<_> = lines(text).take(400).map(|line| line.text.trim()).collect();
    if word == "frame"
        && !head.iter().any(|line| {
            line.starts_with("frame,") && line.as_bytes().get(6).is_some_and(u8::is_ascii_digit)
        })
    {
        return None;
    }
    let version = head
        .iter()
        .find_map(|line| line.strip_prefix("info,version,"));
    Some(match version {
        Some(version) => format!("motive-{}", version.trim().trim_matches(',')),
        None => "trackingtools-1.0".to_owned(),
    })
}

/// Tracker (video) text: a track's name alone over `t x y`, or blocks of them side by side.
fn is_tracker(cells: &[Cell<'_>], below: &[Cell<'_>]) -> bool {
    let times = below.iter().filter(|cell| cell.is("t")).count();
    let names = cells.iter().filter(|cell| !cell.raw.is_empty());
    let texts = names
        .clone()
        .all(|cell| number(cell.raw, false) == Number::Wrong);
    let begins = below.first().is_some_and(|cell| cell.is("t")) && below.len() >= 3;
    begins && texts && (names.count() == 1 || times >= 2) && !cells.iter().any(|cell| cell.is("t"))
}

/// Rows of frame, time and positions from the first line on: a Motive export with its header switched off.
fn is_headerless(cells: &[Cell<'_>]) -> bool {
    let numeric = |cell: &Cell<'_>| number(cell.raw, false) != Number::Wrong;
    cells.len() >= 5
        && cells.iter().all(numeric)
        && cells.iter().take(2).all(|cell| !cell.raw.is_empty())
        && cells
            .first()
            .is_some_and(|cell| cell.raw.parse::<u64>().is_ok())
}

/// A table: the first line that is no comment names the columns, and one of them is the time or the frame.
fn table(text: &str, first: &Line<'_>, file: &Path) -> Result<Detected, TrackError> {
    let unrecognised = || TrackError::Unrecognised {
        file: file.to_owned(),
        beginning: first.text.trim().chars().take(40).collect(),
    };
    let mut comment = None;
    for line in lines(text).filter(|line| !line.is_blank()).take(100) {
        let stripped = line.text.trim_start();
        if stripped.starts_with(['#', '%']) {
            comment = Some(line);
            continue;
        }
        let delimiter = Delimiter::of(line.text);
        let mut cells = Vec::new();
        split(&line, delimiter, file, &mut cells)?;
        if cells.get(1).is_some_and(|cell| cell.is("Type")) {
            return Err(line.error(
                file,
                0,
                TrackProblem::NoKey {
                    key: "Format Version",
                },
            ));
        }
        let numbers = cells
            .iter()
            .filter(|cell| number(cell.raw, delimiter.allows_decimal_comma()) != Number::Wrong);
        let is_data = cells.len() >= 2 && numbers.count() == cells.len();
        // `# t x1 y1`: the last comment line above the numbers is the header.
        let (header, delimiter) = match (is_data, comment) {
            (true, Some(comment)) => (comment, Delimiter::of(comment.text)),
            (true, None) => return Err(unrecognised()),
            (false, _) => (line, delimiter),
        };
        if header.text.contains(['t', 'T', 'f', 'F'])
            && header.text.split([',', ';', '\t', ' ']).count() >= 3
        {
            return Ok(Detected::Table(TableLayout {
                delimiter,
                header_line: header.number,
            }));
        }
        return Err(unrecognised());
    }
    Err(unrecognised())
}

//! Detection of the format from the first lines, never from the file's name.

use std::path::Path;

use super::cells::{Cell, split};
use super::lines::{Delimiter, Lines, TextLine};
use super::number::{Number, number};
use super::{TrackError, TrackProblem, pose_table, sleap};

/// A format that there is a reader for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Detected {
    /// Wide Motive export.
    Wide(Delimiter),
    /// The same without its header.
    Headerless(Delimiter),
    /// Record lines of Tracking Tools and early Motive.
    Records(Delimiter),
    /// Tracker's text.
    Tracker(Delimiter),
    /// `DeepLabCut`'s CSV.
    DeepLabCut(Delimiter),
    /// TRC.
    Trc,
    /// Qualisys' TSV.
    Qtm,
    /// Vicon's CSV.
    Vicon(Delimiter),
    /// Kinovea's text.
    Kinovea,
    /// SLEAP's analysis CSV.
    Sleap(Delimiter),
    /// Rows of a time and a pose, without a header.
    Poses(Delimiter),
    /// Any XML.
    Xml,
    /// A table with named columns.
    Table(TableLayout),
}

/// Position of a table's header, and the separator of its cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TableLayout {
    /// Delimiter of the cells.
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

/// Returns the format of a file.
///
/// # Errors
/// [`TrackError`]: a file that matches no known format.
pub(super) fn detect(lines: &Lines<'_>, file: &Path) -> Result<Detected, TrackError> {
    let mut head = lines.head().filter(|line| !line.is_blank());
    let Some(first) = head.next() else {
        return Err(TrackError::Empty {
            file: file.to_owned(),
        });
    };
    if first.text.trim_start().starts_with('<') {
        return Ok(Detected::Xml);
    }
    if first.text.starts_with("#Kinovea") {
        return Ok(Detected::Kinovea);
    }
    // Its first line may have spaces where the others have tabs, and any character in the name of the file.
    if first
        .text
        .trim_start_matches('"')
        .starts_with("PathFileType")
    {
        return Ok(Detected::Trc);
    }
    if sleap::is_header(&first, Delimiter::of(first.text), file) {
        return Ok(Detected::Sleap(Delimiter::of(first.text)));
    }
    if let Some(delimiter) = wide_delimiter(&first) {
        return Ok(Detected::Wide(delimiter));
    }
    if let Some(delimiter) = records_delimiter(lines, &first) {
        return Ok(Detected::Records(delimiter));
    }
    match by_first_lines(&first, &head.collect::<Vec<_>>(), file) {
        Some(found) => Ok(found),
        None => table(lines, &first, file),
    }
}

fn wide_delimiter(first: &TextLine<'_>) -> Option<Delimiter> {
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

/// Formats that their first two or three lines give away.
fn by_first_lines(first: &TextLine<'_>, below: &[TextLine<'_>], file: &Path) -> Option<Detected> {
    let delimiter = Delimiter::of(first.text);
    let cells = split(first, delimiter, file).ok()?;
    let word = cells.first()?.raw;
    let alone = cells.iter().skip(1).all(|cell| cell.raw.is_empty());
    Some(match word {
        "scorer" => Detected::DeepLabCut(delimiter),
        "NO_OF_FRAMES" => Detected::Qtm,
        "Trajectories" | "Objects" | "Segments" if alone => {
            Detected::Vicon(Delimiter::of(below.get(1).map_or("", |line| line.text)))
        }
        _ if word.to_ascii_lowercase().starts_with("#multi:") => {
            Detected::Tracker(Delimiter::of(below.get(1).map_or("", |line| line.text)))
        }
        _ => {
            let second = below.first()?;
            let delimiter_below = Delimiter::of(second.text);
            // A broken second line is the reader's to report.
            let titles = split(second, delimiter_below, file).unwrap_or_default();
            if is_tracker(&cells, &titles) {
                Detected::Tracker(delimiter_below)
            } else if let Some(delimiter) = pose_table::delimiter(first, below, file) {
                Detected::Poses(delimiter)
            } else if is_headerless(&cells, delimiter) {
                Detected::Headerless(delimiter)
            } else {
                return None;
            }
        }
    })
}

/// Returns the delimiter of record lines, the character after the first word; `None` for other lines.
fn records_delimiter(lines: &Lines<'_>, first: &TextLine<'_>) -> Option<Delimiter> {
    let text = first.text.trim_start_matches(['"', ' ']);
    let word = RECORD_WORDS.iter().find(|word| text.starts_with(**word))?;
    let rest = text.get(word.len()..)?.trim_start_matches('"');
    let delimiter = match rest.chars().next() {
        Some(',') => Delimiter::Comma,
        Some(';') => Delimiter::Semicolon,
        Some('\t') => Delimiter::Tab,
        None if word.ends_with("handed") => {
            let second = lines.head().filter(|line| !line.is_blank()).nth(1);
            Delimiter::of(second.map_or("", |line| line.text))
        }
        _ => return None,
    };
    // `frame` alone also heads plain tables; the family's `frame` line carries numbers.
    let numbered = rest
        .get(1..)
        .is_some_and(|rest| rest.trim_start().starts_with(|c: char| c.is_ascii_digit()));
    (*word != "frame" || numbered).then_some(delimiter)
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
fn is_headerless(cells: &[Cell<'_>], delimiter: Delimiter) -> bool {
    let comma = delimiter.allows_decimal_comma();
    let numeric = |cell: &Cell<'_>| number(cell.raw, comma) != Number::Wrong;
    cells.len() >= 5
        && cells.iter().all(numeric)
        && cells.iter().take(2).all(|cell| !cell.raw.is_empty())
        && cells
            .first()
            .is_some_and(|cell| cell.raw.parse::<u64>().is_ok())
}

/// A table: the first line that is no comment names the columns, and one of them is the time or the frame.
fn table(lines: &Lines<'_>, first: &TextLine<'_>, file: &Path) -> Result<Detected, TrackError> {
    let unrecognised = || TrackError::Unrecognised {
        file: file.to_owned(),
        beginning: first.text.trim().chars().take(40).collect(),
    };
    let mut comment = None;
    for line in lines.head().filter(|line| !line.is_blank()).take(100) {
        let stripped = line.text.trim_start();
        if stripped.starts_with(['#', '%']) {
            comment = Some(line);
            continue;
        }
        let delimiter = Delimiter::of(line.text);
        let cells = split(&line, delimiter, file)?;
        if cells.get(1).is_some_and(|cell| cell.is("Type")) {
            return Err(line.error(
                file,
                0,
                TrackProblem::NoKey {
                    key: "Format Version",
                },
            ));
        }
        let is_number =
            |cell: &&Cell<'_>| number(cell.raw, delimiter.allows_decimal_comma()) != Number::Wrong;
        let numbers = cells.iter().filter(is_number);
        // ROS names frames of reference among its numbers, under as many titles.
        let under_titles = |line: TextLine<'_>| {
            let titles = split(&line, delimiter, file).map_or(0, |titles| titles.len());
            titles == cells.len() && cells.first().is_some_and(|cell| is_number(&cell))
        };
        let is_data = cells.len() >= 2
            && (numbers.count() == cells.len() || comment.is_some_and(under_titles));
        // `# t x1 y1`: the last comment line above the numbers is the header.
        let (header, delimiter) = match (is_data, comment) {
            (true, Some(comment)) => (comment, Delimiter::of(comment.text)),
            (true, None) => return Err(unrecognised()),
            (false, _) => (line, delimiter),
        };
        let unnamed = header.text.starts_with([',', ';', '\t']);
        if (unnamed || header.text.contains(['t', 'T', 'f', 'F']))
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

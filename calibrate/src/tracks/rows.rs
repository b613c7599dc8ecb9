//! From lines to rows, the same for every format: what blank lines are, what becomes of a last line that was cut.

use std::path::Path;

use super::lines::{Lines, TextLine};
use super::{TrackError, TrackProblem, TrackWarning};

/// Takes a file's rows, one at a time.
pub(super) trait TakesRows {
    /// A line that is not blank: taken whole or not at all.
    fn take_line(&mut self, line: &TextLine<'_>) -> Result<(), TrackError>;

    /// Returns `true` after the first row.
    fn has_rows(&self) -> bool;

    /// A blank line.
    fn blank(&mut self) {}

    /// Returns `true` if a blank line ends the rows.
    fn ends_at_blank(&self) -> bool {
        false
    }
}

/// Gives `taker` the lines below the header. A last line without its end that cannot be read was cut when the file was
/// written: it is left out, with the warning that is returned.
///
/// # Errors
/// The taker's, or [`TrackProblem::NoData`] where it got no row.
pub(super) fn read_rows(
    lines: &mut Lines<'_>,
    file: &Path,
    header_line: usize,
    taker: &mut impl TakesRows,
) -> Result<Option<TrackWarning>, TrackError> {
    lines.skip_past(header_line);
    let mut last_line = header_line.max(1);
    let mut cut = None;
    while let Some(line) = lines.next()? {
        last_line = line.number;
        if line.is_blank() {
            if taker.ends_at_blank() && taker.has_rows() {
                break;
            }
            taker.blank();
            continue;
        }
        match taker.take_line(&line) {
            Ok(()) => {}
            Err(_) if !line.ended && taker.has_rows() => {
                cut = Some(TrackWarning::LastLineCut { line: line.number });
                break;
            }
            Err(error) => return Err(error),
        }
    }
    if taker.has_rows() {
        return Ok(cut);
    }
    let line = TextLine {
        number: last_line,
        text: "",
        ended: true,
    };
    Err(line.error(file, 0, TrackProblem::NoData))
}

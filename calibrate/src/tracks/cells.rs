//! The cells of a line, with their places. A line is a record: none of these formats lets a quoted cell run over a line's end,
//! so a quote that stays open is an error on the very line where it opens, and every message knows its line and column.

use std::borrow::Cow;
use std::path::Path;

use super::lines::{Delimiter, TextLine};
use super::{TrackError, TrackProblem};

/// One cell: its text without quotes, and the byte of the line where it begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cell<'a> {
    /// Trimmed; a doubled quote inside quotes is still doubled.
    pub(super) raw: &'a str,
    /// Offset of the cell in its line.
    pub(super) at: usize,
}

impl<'a> Cell<'a> {
    /// The text that was meant.
    pub(super) fn text(&self) -> Cow<'a, str> {
        if self.raw.contains("\"\"") {
            Cow::Owned(self.raw.replace("\"\"", "\""))
        } else {
            Cow::Borrowed(self.raw)
        }
    }

    pub(super) fn is(&self, word: &str) -> bool {
        self.raw.eq_ignore_ascii_case(word)
    }
}

/// The cell of a column; blank where the line ends before it.
pub(super) fn cell_at<'a>(cells: &[Cell<'a>], column: usize) -> Cell<'a> {
    cells
        .get(column)
        .copied()
        .unwrap_or(Cell { raw: "", at: 0 })
}

/// Positions of a line's cells. Kept from line to line, so that rows of data cost no allocation.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// First byte and the byte after the last, quotes left out.
    spans: Vec<(u32, u32)>,
}

impl Cells {
    pub(super) fn len(&self) -> usize {
        self.spans.len()
    }

    /// A column's cell, trimmed; blank where the line ends before it.
    pub(super) fn at<'a>(&self, line: &TextLine<'a>, column: usize) -> Cell<'a> {
        let Some(text) = self.text(line, column) else {
            return Cell {
                raw: "",
                at: line.text.len(),
            };
        };
        let raw = text.trim();
        let lead = text.len() - text.trim_start().len();
        let start = self.spans.get(column).map_or(0, |span| span.0 as usize);
        Cell {
            raw,
            at: start + if raw.is_empty() { 0 } else { lead },
        }
    }

    /// A column's text as it stands.
    pub(super) fn text<'a>(&self, line: &TextLine<'a>, column: usize) -> Option<&'a str> {
        let (start, end) = *self.spans.get(column)?;
        line.text.get(start as usize..end as usize)
    }

    /// Returns `true` if this column or a later one is not blank.
    pub(super) fn any_from(&self, line: &TextLine<'_>, column: usize) -> bool {
        (column..self.len()).any(|column| !self.at(line, column).raw.is_empty())
    }

    /// The last cell that is not blank.
    pub(super) fn last<'a>(&self, line: &TextLine<'a>) -> Option<Cell<'a>> {
        let cells = (0..self.len()).rev().map(|column| self.at(line, column));
        cells.into_iter().find(|cell| !cell.raw.is_empty())
    }

    /// Finds the cells of a line.
    ///
    /// # Errors
    /// An unclosed quote, or text right after a closing one.
    // Lines are at most 4 MiB long.
    #[allow(clippy::cast_possible_truncation)]
    pub(super) fn split(
        &mut self,
        line: &TextLine<'_>,
        delimiter: Delimiter,
        file: &Path,
    ) -> Result<(), TrackError> {
        self.spans.clear();
        let text = line.text;
        if delimiter == Delimiter::Spaces {
            let base = text.as_ptr() as usize;
            self.spans.extend(text.split_ascii_whitespace().map(|word| {
                let raw = word.trim_matches('"');
                let start = raw.as_ptr() as usize - base;
                (start as u32, (start + raw.len()) as u32)
            }));
            return Ok(());
        }
        let byte = delimiter.byte();
        if !text.as_bytes().contains(&b'"') {
            let mut start = 0;
            for (at, _) in text.bytes().enumerate().filter(|(_, b)| *b == byte) {
                self.spans.push((start, at as u32));
                start = at as u32 + 1;
            }
            self.spans.push((start, text.len() as u32));
            return Ok(());
        }
        self.split_quoted(line, byte, file)
    }

    #[allow(clippy::cast_possible_truncation)]
    fn split_quoted(
        &mut self,
        line: &TextLine<'_>,
        byte: u8,
        file: &Path,
    ) -> Result<(), TrackError> {
        let text = line.text;
        let mut at = 0;
        loop {
            let rest = text.get(at..).unwrap_or("");
            let lead = rest.len() - rest.trim_start_matches(' ').len();
            let end = if rest.as_bytes().get(lead) == Some(&b'"') {
                let close = closing_quote(line, at + lead, file)?;
                self.spans.push(((at + lead + 1) as u32, close as u32));
                let tail = text.get(close + 1..).unwrap_or("");
                let gap = tail.len() - tail.trim_start_matches(' ').len();
                match tail.as_bytes().get(gap) {
                    None => text.len(),
                    Some(next) if *next == byte => close + 1 + gap,
                    Some(_) => {
                        return Err(line.error(file, close + 1 + gap, TrackProblem::AfterQuote));
                    }
                }
            } else {
                let length = rest.bytes().position(|b| b == byte).unwrap_or(rest.len());
                self.spans.push((at as u32, (at + length) as u32));
                at + length
            };
            if end >= text.len() {
                return Ok(());
            }
            at = end + 1;
        }
    }
}

/// The cells of a line, to be kept with it.
///
/// # Errors
/// As [`Cells::split`].
pub(super) fn split<'a>(
    line: &TextLine<'a>,
    delimiter: Delimiter,
    file: &Path,
) -> Result<Vec<Cell<'a>>, TrackError> {
    let mut cells = Cells::default();
    cells.split(line, delimiter, file)?;
    Ok((0..cells.len())
        .map(|column| cells.at(line, column))
        .collect())
}

/// Offset of the quote that closes the one at `open`.
fn closing_quote(line: &TextLine<'_>, open: usize, file: &Path) -> Result<usize, TrackError> {
    let bytes = line.text.as_bytes();
    let mut at = open + 1;
    while let Some(b) = bytes.get(at) {
        if *b != b'"' {
            at += 1;
        } else if bytes.get(at + 1) == Some(&b'"') {
            at += 2;
        } else {
            return Ok(at);
        }
    }
    Err(line.error(file, open, TrackProblem::UnclosedQuote))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(text: &str, delimiter: Delimiter) -> Result<Vec<String>, TrackError> {
        let line = TextLine {
            number: 7,
            text,
            ended: true,
        };
        let out = split(&line, delimiter, Path::new("f"))?;
        Ok(out.iter().map(|cell| cell.text().into_owned()).collect())
    }

    #[test]
    fn cells_of_a_line() {
        assert_eq!(
            cells("a,,\"b,c\", d ", Delimiter::Comma).unwrap(),
            ["a", "", "b,c", "d"]
        );
        assert_eq!(cells("a,", Delimiter::Comma).unwrap(), ["a", ""]);
        assert_eq!(cells("", Delimiter::Comma).unwrap(), [""]);
        assert_eq!(
            cells("\"say \"\"x\"\"\";2,5", Delimiter::Semicolon).unwrap(),
            ["say \"x\"", "2,5"]
        );
        assert_eq!(
            cells("  1   2\t3 ", Delimiter::Spaces).unwrap(),
            ["1", "2", "3"]
        );
        assert_eq!(
            cells("5\" pipe,x", Delimiter::Comma).unwrap(),
            ["5\" pipe", "x"]
        );
    }

    #[test]
    fn quotes_that_go_wrong_name_their_place() {
        let unclosed = cells("ä,\"b,c", Delimiter::Comma).unwrap_err();
        assert_eq!(
            unclosed.to_string(),
            format!("f:7:3: {}", TrackProblem::UnclosedQuote)
        );
        let after = cells("\"a\"b,c", Delimiter::Comma).unwrap_err();
        assert_eq!(
            after.to_string(),
            format!("f:7:4: {}", TrackProblem::AfterQuote)
        );
    }
}

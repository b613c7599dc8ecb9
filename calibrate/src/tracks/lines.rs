//! Lines and cells with their places. A line is a record: none of these formats lets a quoted cell run over a line's end,
//! so a quote that stays open is an error on the very line where it opens, and every message knows its line and column.

use std::borrow::Cow;
use std::path::Path;

use super::{Place, TrackError, TrackProblem};

/// What stands between two cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Delimiter {
    /// A comma.
    Comma,
    /// A semicolon; then numbers may have a decimal comma.
    Semicolon,
    /// A tab; then numbers may have a decimal comma.
    Tab,
    /// Any run of spaces and tabs.
    Spaces,
}

impl Delimiter {
    /// The delimiter that a header line uses.
    pub(super) fn of(line: &str) -> Self {
        if line.contains('\t') {
            Self::Tab
        } else if line.contains(';') {
            Self::Semicolon
        } else if line.contains(',') {
            Self::Comma
        } else {
            Self::Spaces
        }
    }

    pub(super) fn allows_decimal_comma(self) -> bool {
        self != Self::Comma
    }

    fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Spaces => b' ',
        }
    }
}

/// One line with its number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    /// 1-based.
    pub(super) number: usize,
    /// Without its end.
    pub(super) text: &'a str,
    /// Whether the file goes on after it (a line's end was there).
    pub(super) ended: bool,
}

impl Line<'_> {
    /// Whether nothing but delimiters and spaces is on it.
    pub(super) fn is_blank(&self) -> bool {
        self.text
            .bytes()
            .all(|b| matches!(b, b',' | b';' | b' ' | b'\t' | b'"'))
    }

    /// An error at this byte of the line.
    pub(super) fn error(&self, file: &Path, byte: usize, problem: TrackProblem) -> TrackError {
        let before = self.text.get(..byte).unwrap_or(self.text);
        TrackError::Broken {
            place: Place {
                file: file.to_owned(),
                line: self.number,
                column: before.chars().count() + 1,
            },
            problem,
        }
    }
}

/// The lines of a text that end in LF, CRLF or (old Excel for Mac) CR alone.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let end = if text.contains('\n') { '\n' } else { '\r' };
    text.split_inclusive(end)
        .enumerate()
        .map(move |(index, raw)| {
            let (body, ended) = match raw.strip_suffix(end) {
                Some(body) => (body, true),
                None => (raw, false),
            };
            Line {
                number: index + 1,
                text: body.strip_suffix('\r').unwrap_or(body),
                ended,
            }
        })
}

/// One cell: its text without quotes, and the byte of the line where it begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cell<'a> {
    /// Trimmed; a doubled quote inside quotes is still doubled.
    pub(super) raw: &'a str,
    /// Where it begins in its line.
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

/// Splits a line into `cells`, which is emptied first.
///
/// # Errors
/// An unclosed quote, or text right after a closing one.
pub(super) fn split<'a>(
    line: &Line<'a>,
    delimiter: Delimiter,
    file: &Path,
    cells: &mut Vec<Cell<'a>>,
) -> Result<(), TrackError> {
    cells.clear();
    if delimiter == Delimiter::Spaces {
        let start = line.text.as_ptr() as usize;
        cells.extend(line.text.split_ascii_whitespace().map(|raw| Cell {
            raw: raw.trim_matches('"'),
            at: raw.as_ptr() as usize - start,
        }));
        return Ok(());
    }
    let (text, byte) = (line.text, delimiter.byte());
    let quoted = text.as_bytes().contains(&b'"');
    let mut at = 0;
    loop {
        let rest = text.get(at..).unwrap_or("");
        let lead = rest.len() - rest.trim_start_matches(' ').len();
        let end = if quoted && rest.as_bytes().get(lead) == Some(&b'"') {
            let (raw, after) = quoted_cell(line, at + lead, file)?;
            cells.push(Cell { raw, at: at + lead });
            let tail = text.get(after..).unwrap_or("");
            let gap = tail.len() - tail.trim_start_matches(' ').len();
            match tail.as_bytes().get(gap) {
                None => text.len(),
                Some(next) if *next == byte => after + gap,
                Some(_) => return Err(line.error(file, after + gap, TrackProblem::AfterQuote)),
            }
        } else {
            let length = rest.bytes().position(|b| b == byte).unwrap_or(rest.len());
            let raw = rest.get(..length).unwrap_or("");
            cells.push(Cell {
                raw: raw.trim(),
                at: at + lead.min(length),
            });
            at + length
        };
        if end >= text.len() {
            return Ok(());
        }
        at = end + 1;
    }
}

/// The text between the quote at `open` and the one that closes it, and the byte after that one.
fn quoted_cell<'a>(
    line: &Line<'a>,
    open: usize,
    file: &Path,
) -> Result<(&'a str, usize), TrackError> {
    let bytes = line.text.as_bytes();
    let mut at = open + 1;
    while let Some(b) = bytes.get(at) {
        if *b != b'"' {
            at += 1;
        } else if bytes.get(at + 1) == Some(&b'"') {
            at += 2;
        } else {
            let raw = line.text.get(open + 1..at).unwrap_or("");
            return Ok((raw.trim(), at + 1));
        }
    }
    Err(line.error(file, open, TrackProblem::UnclosedQuote))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(text: &str, delimiter: Delimiter) -> Result<Vec<String>, TrackError> {
        let line = Line {
            number: 7,
            text,
            ended: true,
        };
        let mut out = Vec::new();
        split(&line, delimiter, Path::new("f"), &mut out)?;
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

    #[test]
    fn every_line_has_its_number() {
        for text in ["a\n\nb\n", "a\r\n\r\nb\r\n", "a\r\rb\r"] {
            let found: Vec<_> = lines(text).map(|line| (line.number, line.text)).collect();
            assert_eq!(found, [(1, "a"), (2, ""), (3, "b")], "{text:?}");
        }
        assert!(!lines("a\nb").last().unwrap().ended);
    }
}

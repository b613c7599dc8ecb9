//! Lines and cells with their places. A line is a record: none of these formats lets a quoted cell run over a line's end,
//! so a quote that stays open is an error on the very line where it opens, and every message knows its line and column.
//!
//! The file goes by one line at a time, so that a recording larger than the memory can be read; only its beginning is kept,
//! for the headers.

use std::borrow::Cow;
use std::io::{BufRead, Read};
use std::path::Path;

use super::{Place, TrackError, TrackProblem};

/// The longest line \[bytes\]: four hundred thousand cells.
const LONGEST: usize = 4 << 20;
/// Lines that are kept: the longest header (a comment block) has 45.
const HEAD_LINES: usize = 400;
/// Where lines are long, fewer are kept: of a wide header's 41 rows all, and no more once they are this large \[bytes\].
const HEAD: (usize, usize) = (50, 4 << 20);

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

/// The lines of a file that end in LF, CRLF or (old Excel for Mac) CR alone, one at a time.
pub(super) struct Lines<'s> {
    source: Box<dyn BufRead + 's>,
    file: &'s Path,
    end: u8,
    head: Vec<(String, bool)>,
    given: usize,
    buffer: Vec<u8>,
    lossy: String,
}

impl<'s> Lines<'s> {
    /// # Errors
    /// [`TrackError::Read`], or a first line that is too long.
    pub(super) fn open(source: Box<dyn BufRead + 's>, file: &'s Path) -> Result<Self, TrackError> {
        let mut lines = Self {
            source,
            file,
            end: b'\n',
            head: Vec::new(),
            given: 0,
            buffer: Vec::new(),
            lossy: String::new(),
        };
        let beginning = match lines.source.fill_buf() {
            Ok(bytes) => bytes,
            Err(cause) => return Err(TrackError::read(file, 1, &cause)),
        };
        if !beginning.contains(&b'\n') && beginning.contains(&b'\r') {
            lines.end = b'\r';
        }
        let mut bytes = 0;
        while lines.head.len() < HEAD_LINES && (lines.head.len() < HEAD.0 || bytes < HEAD.1) {
            let Some(ended) = lines.read(lines.head.len() + 1)? else {
                break;
            };
            bytes += lines.buffer.len();
            let text = String::from_utf8_lossy(&lines.buffer).into_owned();
            lines.head.push((text, ended));
        }
        Ok(lines)
    }

    /// The beginning of the file, however far it was read.
    pub(super) fn head(&self) -> impl Iterator<Item = Line<'_>> + Clone {
        self.head
            .iter()
            .zip(1..)
            .map(|((text, ended), number)| Line {
                number,
                text,
                ended: *ended,
            })
    }

    /// Goes on behind this line of the head.
    pub(super) fn skip_past(&mut self, number: usize) {
        self.given = number.min(self.head.len());
    }

    /// The next line.
    ///
    /// # Errors
    /// [`TrackError::Read`], or a line that is too long.
    pub(super) fn next(&mut self) -> Result<Option<Line<'_>>, TrackError> {
        self.given += 1;
        let number = self.given;
        if number <= self.head.len() {
            return Ok(self.head().nth(number - 1));
        }
        let Some(ended) = self.read(number)? else {
            return Ok(None);
        };
        let text = if let Ok(text) = std::str::from_utf8(&self.buffer) {
            text
        } else {
            self.lossy = String::from_utf8_lossy(&self.buffer).into_owned();
            &self.lossy
        };
        Ok(Some(Line {
            number,
            text,
            ended,
        }))
    }

    /// Fills the buffer with a line and says whether it had an end.
    fn read(&mut self, number: usize) -> Result<Option<bool>, TrackError> {
        self.buffer.clear();
        let mut limited = self.source.by_ref().take(LONGEST as u64 + 1);
        let count = limited
            .read_until(self.end, &mut self.buffer)
            .map_err(|cause| TrackError::read(self.file, number, &cause))?;
        if count == 0 {
            return Ok(None);
        }
        let ended = self.buffer.last() == Some(&self.end);
        if ended {
            self.buffer.pop();
        } else if count > LONGEST {
            let line = Line {
                number,
                text: "",
                ended: true,
            };
            let megabytes = LONGEST >> 20;
            return Err(line.error(self.file, 0, TrackProblem::LineTooLong { megabytes }));
        }
        if self.buffer.last() == Some(&b'\r') {
            self.buffer.pop();
        }
        Ok(Some(ended))
    }
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

/// Where a line's cells are. Kept from line to line, so that rows of data cost no allocation.
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
    pub(super) fn at<'a>(&self, line: &Line<'a>, column: usize) -> Cell<'a> {
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
    pub(super) fn text<'a>(&self, line: &Line<'a>, column: usize) -> Option<&'a str> {
        let (start, end) = *self.spans.get(column)?;
        line.text.get(start as usize..end as usize)
    }

    /// Whether anything stands in or behind this column.
    pub(super) fn any_from(&self, line: &Line<'_>, column: usize) -> bool {
        (column..self.len()).any(|column| !self.at(line, column).raw.is_empty())
    }

    /// The last cell that is not blank.
    pub(super) fn last<'a>(&self, line: &Line<'a>) -> Option<Cell<'a>> {
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
        line: &Line<'_>,
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
    fn split_quoted(&mut self, line: &Line<'_>, byte: u8, file: &Path) -> Result<(), TrackError> {
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
    line: &Line<'a>,
    delimiter: Delimiter,
    file: &Path,
) -> Result<Vec<Cell<'a>>, TrackError> {
    let mut cells = Cells::default();
    cells.split(line, delimiter, file)?;
    Ok((0..cells.len())
        .map(|column| cells.at(line, column))
        .collect())
}

/// Where the quote is that closes the one at `open`.
fn closing_quote(line: &Line<'_>, open: usize, file: &Path) -> Result<usize, TrackError> {
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
        let line = Line {
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

    #[test]
    fn every_line_has_its_number() {
        for text in ["a\n\nb\n", "a\r\n\r\nb\r\n", "a\r\rb\r"] {
            let mut lines = of(text);
            let mut found = Vec::new();
            while let Some(line) = lines.next().unwrap() {
                found.push((line.number, line.text.to_owned()));
            }
            let expected = [(1, "a"), (2, ""), (3, "b")].map(|(n, t)| (n, t.to_owned()));
            assert_eq!(found, expected, "{text:?}");
        }
        assert!(!of("a\nb").head().last().unwrap().ended);
    }

    fn of(text: &str) -> Lines<'_> {
        Lines::open(Box::new(text.as_bytes()), Path::new("f")).unwrap()
    }

    #[test]
    fn lines_behind_the_head_come_as_well() {
        let text = (1..=1000)
            .map(|i| i.to_string() + "\n")
            .collect::<Vec<_>>()
            .concat();
        let mut lines = of(&text);
        lines.skip_past(7);
        let mut expected = 8;
        while let Some(line) = lines.next().unwrap() {
            assert_eq!((line.number, line.text), (expected, &*expected.to_string()));
            expected += 1;
        }
        assert_eq!(expected, 1001);
    }

    #[test]
    fn an_endless_line_is_refused() {
        let endless = std::io::BufReader::new(std::io::repeat(b'7').take(1 << 30));
        let error = Lines::open(Box::new(endless), Path::new("f"))
            .err()
            .unwrap();
        assert_eq!(
            error.to_string(),
            format!("f:1:1: {}", TrackProblem::LineTooLong { megabytes: 4 })
        );
    }
}

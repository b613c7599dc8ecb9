//! Lines with their places. The file goes by one line at a time, so that a recording larger than the memory can be read; only its beginning is kept,
//! for the headers.

use std::io::{BufRead, Read};
use std::path::Path;

use super::{FilePosition, TrackError, TrackProblem};

/// The longest line \[bytes\]: four hundred thousand cells.
const LONGEST: usize = 4 << 20;
/// Lines that are kept: the longest header (a comment block) has 45.
const HEAD_LINES: usize = 400;
/// Limits of the lines that are kept: 50 lines (a wide header has 41 rows), and no more once they have this size \[bytes\].
const HEAD: (usize, usize) = (50, 4 << 20);

/// Delimiter between two cells.
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

    pub(super) fn byte(self) -> u8 {
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
pub(super) struct TextLine<'a> {
    /// 1-based.
    pub(super) number: usize,
    /// Without its end.
    pub(super) text: &'a str,
    /// `true` if the line is terminated, so that the file continues.
    pub(super) ended: bool,
}

impl TextLine<'_> {
    /// Returns `true` if the line holds only delimiters and spaces.
    pub(super) fn is_blank(&self) -> bool {
        self.text
            .bytes()
            .all(|b| matches!(b, b',' | b';' | b' ' | b'\t' | b'"'))
    }

    /// An error at this byte of the line.
    pub(super) fn error(&self, file: &Path, byte: usize, problem: TrackProblem) -> TrackError {
        let before = self.text.get(..byte).unwrap_or(self.text);
        TrackError::Broken {
            place: FilePosition {
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
    pub(super) fn head(&self) -> impl Iterator<Item = TextLine<'_>> + Clone {
        self.head
            .iter()
            .zip(1..)
            .map(|((text, ended), number)| TextLine {
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
    pub(super) fn next(&mut self) -> Result<Option<TextLine<'_>>, TrackError> {
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
        Ok(Some(TextLine {
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
            let line = TextLine {
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

#[cfg(test)]
mod tests {
    use super::*;

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

//! Error type of every reader, with file, line and column of the mistake.

use std::path::{Path, PathBuf};

/// Error of reading or writing a file.
///
/// ```
/// use swimmer_files::{FileError, SwimmerFile};
///
/// let mistaken = SwimmerFile::parse("[links]\nmiddle = -1\n", "mine.toml".as_ref()).unwrap_err();
/// assert!(matches!(mistaken, FileError::Content { line: 1 | 2, .. }), "{mistaken}");
/// ```
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file could not be read at all.
    #[error("cannot read {}: {source}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file could not be written; what was there before is untouched.
    #[error("cannot write {}: {source}; nothing was changed there", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file was read, but what stands at this place cannot be meant.
    #[error("{}:{line}:{column}: {problem}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// Column in characters, counted from 1.
        column: usize,
        /// Reason, and the correct form.
        problem: String,
    },
}

impl FileError {
    /// An error at a line and a column (both from 1) of a file.
    pub fn at(path: &Path, line: usize, column: usize, problem: impl Into<String>) -> Self {
        Self::Content {
            path: path.to_path_buf(),
            line,
            column,
            problem: problem.into(),
        }
    }

    /// An error at a byte offset of a text: line and column are counted here.
    pub(crate) fn at_offset(
        path: &Path,
        text: &str,
        offset: usize,
        problem: impl Into<String>,
    ) -> Self {
        let (line, column) = line_and_column(text, offset);
        Self::at(path, line, column, problem)
    }

    /// Line and column, if the error has a place in a file.
    pub fn place(&self) -> Option<(usize, usize)> {
        match self {
            Self::Content { line, column, .. } => Some((*line, *column)),
            Self::Read { .. } | Self::Write { .. } => None,
        }
    }
}

/// Reads a whole text file; bytes that are not UTF-8 are an error with their place.
pub(crate) fn read_text(path: &Path) -> Result<String, FileError> {
    let bytes = std::fs::read(path).map_err(|source| FileError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let text =
            String::from_utf8_lossy(error.as_bytes().get(..good).unwrap_or_default()).into_owned();
        FileError::at_offset(path, &text, good, "the file is not UTF-8 text from here on")
    })
}

/// Line and column in characters, both from 1, of a byte offset.
pub(crate) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let mut end = offset.min(text.len());
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    let before = text.get(..end).unwrap_or_default();
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.bytes().filter(|&byte| byte == b'\n').count() + 1;
    let column = before.get(line_start..).unwrap_or_default().chars().count() + 1;
    (line, column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_lines_and_characters() {
        let text = "ab\nµd = 1\n";
        assert_eq!(line_and_column(text, 0), (1, 1));
        assert_eq!(line_and_column(text, 2), (1, 3));
        assert_eq!(line_and_column(text, 3), (2, 1));
        assert_eq!(line_and_column(text, 5), (2, 2));
        assert_eq!(line_and_column(text, 999), (3, 1));
    }

    #[test]
    fn text_that_is_not_utf8_has_a_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bad.toml");
        std::fs::write(&path, b"name = 1\nx\xff").unwrap();
        assert_eq!(read_text(&path).unwrap_err().place(), Some((2, 2)));
    }
}

//! Access to files, and the warnings of an operation.

/// Access to files by path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Files {
    /// The file system of this machine.
    Disk,
    /// None: the lab page has no file system, and gets the texts of files.
    Unavailable,
}

/// Surroundings of an operation.
#[derive(Debug)]
pub struct Context {
    /// Access to files by path.
    pub files: Files,
    /// Warnings and notes for the user, in the order in which they arose, each a sentence.
    pub warnings: Vec<String>,
}

impl Context {
    /// A context with the file system of this machine.
    pub fn on_disk() -> Self {
        Self {
            files: Files::Disk,
            warnings: Vec::new(),
        }
    }

    /// A context without a file system, as in a browser.
    pub fn without_files() -> Self {
        Self {
            files: Files::Unavailable,
            warnings: Vec::new(),
        }
    }

    /// Adds a warning.
    pub(crate) fn warn(&mut self, warning: impl Into<String>) {
        self.warnings.push(warning.into());
    }
}

//! Inputs of a fitted swimmer: the `[provenance]` table with a hash of every input, which detects a change of one.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use sha2::{Digest, Sha256};

use crate::file_error::read_text;
use crate::{FileError, SwimmerFile, write_atomically};

/// The `[provenance]` table of a swimmer file. Readers of swimmer files pass it over: it says nothing about the swimmer.
///
/// ```
/// use swimmer_files::Provenance;
///
/// let folder = std::env::temp_dir();
/// let input = folder.join(format!("provenance-{}.csv", std::process::id()));
/// std::fs::write(&input, "1,2,3")?;
/// let made = Provenance::of_files("an example", &[input.clone()], &folder)?;
/// assert!(made.changed(&folder).is_empty());
/// std::fs::write(&input, "1,2,4")?;
/// assert_eq!(made.changed(&folder).len(), 1);
/// # std::fs::remove_file(&input)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The program that made the file.
    pub made_by: String,
    /// Files that it was made from.
    #[serde(rename = "input", default)]
    pub inputs: Vec<InputHash>,
}

/// One input file.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InputHash {
    /// Its path, relative to the folder of the swimmer file; `/` between folders.
    pub file: String,
    /// SHA-256 of its bytes, 64 hexadecimal digits.
    pub sha256: String,
}

impl Provenance {
    /// Hashes files. `folder` is where the result will stand.
    ///
    /// # Errors
    /// [`FileError::Read`] for the first file that cannot be read.
    pub fn of_files(made_by: &str, files: &[PathBuf], folder: &Path) -> Result<Self, FileError> {
        let input = |path: &PathBuf| {
            Ok(InputHash {
                file: relative(path, folder),
                sha256: hash_of(path)?,
            })
        };
        Ok(Self {
            made_by: made_by.to_owned(),
            inputs: files.iter().map(input).collect::<Result<_, FileError>>()?,
        })
    }

    /// Saves a swimmer with where it came from.
    ///
    /// # Errors
    /// [`FileError`] when the file cannot be written.
    pub fn save_with(&self, swimmer: &SwimmerFile, path: &Path) -> Result<(), FileError> {
        write_atomically(path, (swimmer.to_toml() + &self.to_toml()).as_bytes())
    }

    /// Reads the table of a swimmer file; `None` where it has none.
    ///
    /// # Errors
    /// [`FileError`] when the file cannot be read, or the table is not as [`Provenance::to_toml`] writes it.
    pub fn load(path: &Path) -> Result<Option<Self>, FileError> {
        #[derive(Deserialize)]
        struct Table {
            provenance: Option<Provenance>,
        }
        let table: Table = crate::toml_text::parse(&read_text(path)?, path)?;
        Ok(table.provenance)
    }

    /// The inputs that are there and no longer what they were; paths start from `folder`.
    pub fn changed(&self, folder: &Path) -> Vec<&str> {
        let differs = |input: &&InputHash| {
            hash_of(&folder.join(&input.file)).is_ok_and(|now| now != input.sha256)
        };
        let changed = self.inputs.iter().filter(differs);
        changed.map(|input| input.file.as_str()).collect()
    }

    /// The table's text, to stand at the end of a swimmer file.
    pub fn to_toml(&self) -> String {
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let mut text = format!(
            "\n[provenance]                 # what this was made from\nmade_by = {}\n",
            quoted(&self.made_by)
        );
        for InputHash { file, sha256 } in &self.inputs {
            // Writing to a String cannot fail.
            let _ = write!(
                text,
                "\n[[provenance.input]]\nfile = {}\nsha256 = {}\n",
                quoted(file),
                quoted(sha256)
            );
        }
        text
    }
}

/// The SHA-256 of a file's bytes, as 64 hexadecimal digits; never more than a piece of it is in memory.
///
/// # Errors
/// [`FileError::Read`].
///
/// ```
/// # let file = std::env::temp_dir().join(format!("hash-of-{}", std::process::id()));
/// std::fs::write(&file, "abc")?;
/// assert!(swimmer_files::hash_of(&file)?.starts_with("ba7816bf8f01cfea"));
/// # std::fs::remove_file(&file)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hash_of(path: &Path) -> Result<String, FileError> {
    let read_error = |source| FileError::Read {
        path: path.to_path_buf(),
        source,
    };
    let mut file = std::fs::File::open(path).map_err(read_error)?;
    let mut digest = Sha256::new();
    let mut piece = vec![0; 1 << 16];
    loop {
        match std::io::Read::read(&mut file, &mut piece).map_err(read_error)? {
            0 => break,
            count => digest.update(piece.get(..count).unwrap_or_default()),
        }
    }
    let mut text = String::with_capacity(64);
    for byte in digest.finalize() {
        let _ = write!(text, "{byte:02x}");
    }
    Ok(text)
}

/// The way from a folder to a file, as far as both are known to the file system; else the file's own path.
fn relative(file: &Path, folder: &Path) -> String {
    let slashes = |path: &Path| {
        let parts = path
            .components()
            .map(|c| c.as_os_str().to_string_lossy().into_owned());
        parts.collect::<Vec<_>>().join("/")
    };
    let absolute = |path: &Path| std::path::absolute(path).ok();
    // The folder may not exist yet: its parent does.
    let real = |path: &Path| {
        let whole = absolute(path)?;
        let parent = whole.parent()?.canonicalize().ok()?;
        Some(parent.join(whole.file_name()?))
    };
    let (Some(to), Some(from)) = (real(file), real(folder)) else {
        return file.display().to_string();
    };
    let shared = to
        .components()
        .zip(from.components())
        .take_while(|(a, b)| a == b)
        .count();
    let up = from.components().count() - shared;
    let mut way: PathBuf = std::iter::repeat_n("..", up).collect();
    way.extend(to.components().skip(shared));
    slashes(&way)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SwimmerFile;

    #[test]
    fn a_changed_input_is_told() {
        let root = tempfile::tempdir().unwrap();
        let (data, out) = (root.path().join("data"), root.path().join("out"));
        std::fs::create_dir(&data).unwrap();
        let inputs = [data.join("campaign.toml"), data.join("a b.csv")];
        for input in &inputs {
            std::fs::write(input, "abc").unwrap();
        }
        // The folder is made only afterwards.
        let made = Provenance::of_files("swimmer \"1\"", &inputs, &out).unwrap();
        assert_eq!(made.inputs[1].file, "../data/a b.csv");
        // The published value for "abc" (FIPS 180-4).
        assert_eq!(
            made.inputs[0].sha256,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
        std::fs::create_dir(&out).unwrap();
        let path = out.join("fitted.toml");
        let swimmer = SwimmerFile::preset("robot").unwrap();
        std::fs::write(&path, swimmer.to_toml() + &made.to_toml()).unwrap();
        assert_eq!(SwimmerFile::load(&path).unwrap(), swimmer);
        let read = Provenance::load(&path).unwrap().unwrap();
        assert_eq!(read, made);
        assert!(read.changed(&out).is_empty());
        std::fs::write(&inputs[1], "abd").unwrap();
        assert_eq!(read.changed(&out), ["../data/a b.csv"]);
        // A missing input is not reported as changed: the swimmer may have been sent to another place.
        std::fs::remove_file(&inputs[1]).unwrap();
        assert!(read.changed(&out).is_empty());
        std::fs::write(&path, swimmer.to_toml()).unwrap();
        assert_eq!(Provenance::load(&path).unwrap(), None);
    }
}

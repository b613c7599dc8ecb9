//! `swimmer robot --key` and `swimmer robot key`: the secret that a robot may share with its hosts, kept in a file.

use std::fmt;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use host_link::LinkError;
use host_link::session::SessionConfig;
use link_protocol::Key;
use serde::Serialize;
use swimmer_files::parse_key;

use super::access::Access;
use super::port::{Pace, session_seed};
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::output::Output;

/// Remark above the key in a file of ours.
const HEAD: &str =
    "# The key of a swimmer robot: who has it can drive the robot. Keep it secret.\n";

/// Key for the robot.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct KeyFile {
    /// Sign what is sent with the key in this file, for a robot that has one; stop and estop need none
    #[arg(long, value_name = "FILE", global = true)]
    key: Option<PathBuf>,
}

/// Set or remove the key that the robot shares with its hosts
///
/// A robot with a key does only what is signed with it, but stops for anybody. The key is stored on the robot and crosses
/// the wire in the clear: set it at the bench over a cable. The present key of a robot, if it has one, is given by --key.
#[derive(Debug, clap::Args)]
#[command(subcommand_value_name = "ACTION", subcommand_help_heading = "Actions")]
pub(super) struct KeyChange {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// Write a random key into a new FILE, and give it to the robot
    Make {
        /// Keep a copy of it
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
    /// Give the robot the key in FILE
    Set {
        /// 32 hexadecimal digits
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
    /// Take the robot's key away: whoever reaches it can drive it again
    Clear,
}

#[derive(Debug, Serialize)]
struct Changed {
    key_set: bool,
    file: Option<String>,
    /// `true` if the file was just written.
    made: bool,
}

impl fmt::Display for Changed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.file {
            Some(file) => write!(
                f,
                "The robot has the key in {file}{}: give --key {file} from now on, and keep a copy. Without it only erasing \
                 the robot's flash helps.",
                if self.made {
                    ", a new one that was written there"
                } else {
                    ", as it was there"
                }
            ),
            None => write!(
                f,
                "The robot has no key: anyone who reaches its port can drive it."
            ),
        }
    }
}

impl KeyFile {
    /// Key in this file; `None` for a robot without a key.
    pub(super) fn of(key: Option<PathBuf>) -> Self {
        Self { key }
    }

    /// A new session, signed where a key was named.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the file holds no key.
    pub(super) fn session(&self) -> Outcome<SessionConfig> {
        Ok(SessionConfig {
            key: self.key.as_deref().map(read).transpose()?,
            ..SessionConfig::new(session_seed())
        })
    }

    /// `true` if a file was named.
    pub(super) fn is_named(&self) -> bool {
        self.key.is_some()
    }

    /// The same, without a key that cannot be read: nothing may stand in the way of a stop.
    pub(super) fn if_readable(&self) -> Self {
        let key = self.key.clone().filter(|file| read(file).is_ok());
        Self { key }
    }
}

/// `swimmer robot key make|set|clear`.
pub(super) fn run(access: &Access, change: &KeyChange, output: Output) -> Outcome {
    let mut line = access.connect("swimmer robot key", Pace::AsFastAsPossible)?;
    let answer = match &change.action {
        Action::Clear => {
            line.robot.set_key(None)?;
            Changed {
                key_set: false,
                file: None,
                made: false,
            }
        }
        Action::Set { file } | Action::Make { file } => {
            let made = matches!(change.action, Action::Make { .. });
            let key = if made { make(file)? } else { read(file)? };
            if let Err(error) = line.robot.set_key(Some(key)) {
                // Refused, the robot certainly does not have it. Otherwise it may, and then the file is all there is.
                if made && matches!(error, LinkError::Refused { .. }) {
                    let _ = fs::remove_file(file);
                }
                return Err(error.into());
            }
            Changed {
                key_set: true,
                file: Some(file.display().to_string()),
                made,
            }
        }
    };
    output.print(&answer);
    line.close()
}

fn read(file: &Path) -> Outcome<Key> {
    let text = fs::read_to_string(file).map_err(|error| {
        Failure::BadInput(format!(
            "reading the key in {}: {error}; `swimmer robot key make FILE` writes a new one",
            file.display()
        ))
    })?;
    parse_key(&text)
        .map_err(|problem| Failure::BadInput(format!("the key in {}{problem}", file.display())))
}

/// A random key, in a new file that nobody else may read.
fn make(file: &Path) -> Outcome<Key> {
    if file.exists() {
        return Err(Failure::BadInput(format!(
            "{0} exists, and a key that is written over is lost, with --overwrite too; name a new file, or give the robot the key \
             that is there: `swimmer robot key set {0}`",
            file.display()
        )));
    }
    may_be_written(file)?;
    let mut bytes = [0; Key::LEN];
    getrandom::fill(&mut bytes).map_err(|error| {
        Failure::Tried(format!(
            "making a key: the system gives no random numbers ({error}); write 32 hexadecimal digits into {} yourself",
            file.display()
        ))
    })?;
    let text = format!("{HEAD}{:032x}\n", u128::from_be_bytes(bytes));
    write_secret(file, &text).map_err(|error| {
        let _ = fs::remove_file(file);
        Failure::Tried(format!(
            "writing a new key into {}: {error}",
            file.display()
        ))
    })?;
    Ok(Key(bytes))
}

/// Makes a file that nobody else may read, where the system knows such.
fn write_secret(file: &Path, text: &str) -> io::Result<()> {
    let mut options = fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(file)?.write_all(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_file_holds_a_new_key_and_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let (one, two) = (folder.path().join("one"), folder.path().join("two"));
        let key = make(&one).unwrap();
        assert_eq!(read(&one).unwrap(), key);
        assert!(make(&one).is_err(), "written over");
        assert_eq!(read(&one).unwrap(), key);
        assert_ne!(make(&two).unwrap(), key);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = fs::metadata(&one).unwrap().permissions().mode();
            assert_eq!(mode & 0o777, 0o600);
        }
    }

    #[test]
    fn a_key_that_cannot_be_read_stands_in_no_stop_s_way() {
        let named = KeyFile {
            key: Some("no/such/key".into()),
        };
        assert!(named.session().is_err());
        assert_eq!(named.if_readable().session().unwrap().key, None);
    }
}

//! Detection of another program that has a port open, if the system reports it.

use std::path::Path;

/// Name and process number of a program that has the port open. Returns `None` if they are unknown.
pub(in super::super) fn program_with(port: &str) -> Option<String> {
    let wanted = Path::new(port).canonicalize().ok()?;
    let us = std::process::id();
    let processes = std::fs::read_dir("/proc").ok()?;
    processes.flatten().find_map(|process| {
        let number: u32 = process.file_name().to_str()?.parse().ok()?;
        if number == us {
            return None;
        }
        let mut open = std::fs::read_dir(process.path().join("fd")).ok()?.flatten();
        if !open.any(|file| std::fs::read_link(file.path()).is_ok_and(|target| target == wanted)) {
            return None;
        }
        let name = std::fs::read_to_string(process.path().join("comm")).ok()?;
        Some(format!("{} (process {number})", name.trim()))
    })
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::io::Read as _;
    use std::process::{Command, Stdio};

    #[test]
    fn a_program_with_the_file_open_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("port");
        std::fs::write(&path, "").unwrap();
        let port = path.to_str().unwrap();
        assert_eq!(program_with(port), None);
        // A shell that says when the file is open and waits for our end of its standard input.
        let mut other = Command::new("sh")
            .args(["-c", "exec 3<\"$0\"; echo open; read line", port])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut word = [0; 4];
        other
            .stdout
            .as_mut()
            .unwrap()
            .read_exact(&mut word)
            .unwrap();
        let told = program_with(port);
        drop(other.stdin.take());
        other.wait().unwrap();
        let number = other.id().to_string();
        assert!(
            told.as_ref().is_some_and(|told| told.contains(&number)),
            "{told:?}"
        );
    }
}

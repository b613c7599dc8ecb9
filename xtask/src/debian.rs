//! Debian packages: installs missing ones if permitted, otherwise prints the command.

use std::fs;
use std::process::Command;

use crate::failure::{Failure, Outcome};
use crate::run::{command, read, run, works};

/// Returns `true` if this machine has Debian's package tools.
pub(crate) fn is_debian() -> bool {
    let os_release = fs::read_to_string("/etc/os-release").unwrap_or_default();
    is_debian_like(&os_release)
        && works(command("apt-get").arg("--version"))
        && works(command("dpkg-deb").arg("--version"))
}

/// Returns `true` if packages may be installed: root on Debian.
pub(crate) fn may_install() -> bool {
    is_debian() && read(command("id").arg("-u"), "").is_ok_and(|id| id.trim() == "0")
}

/// Makes sure that a tool runs; installs its packages if it does not.
///
/// # Errors
/// The tool is missing and packages may not be installed, or it does not run after the installation.
pub(crate) fn ensure_tool(check: &mut Command, packages: &[&str]) -> Outcome {
    if works(check) {
        return Ok(());
    }
    let tool = check.get_program().to_string_lossy().into_owned();
    let by_hand = format!(
        "apt-get update && apt-get install --no-install-recommends {}",
        packages.join(" ")
    );
    if !may_install() {
        return Err(Failure::new(
            format!("looking for `{tool}`"),
            "it is not there, and only root on Debian may install it from here",
            format!(
                "run `{by_hand}` as root, or install `{tool}` the way your system does, then repeat the command"
            ),
        ));
    }
    update()?;
    run(
        command("apt-get")
            .args(["install", "-y", "-qq", "--no-install-recommends"])
            .args(packages)
            .env("DEBIAN_FRONTEND", "noninteractive"),
        &by_hand,
    )?;
    if works(check) {
        Ok(())
    } else {
        Err(Failure::new(
            format!("looking for `{tool}`"),
            format!(
                "{} went in, and `{tool}` still does not run",
                packages.join(", ")
            ),
            "run it by hand to see why",
        ))
    }
}

/// Fetches the package lists as root; other users continue with the existing lists.
pub(crate) fn update() -> Outcome {
    if !may_install() {
        return Ok(());
    }
    run(
        command("apt-get").args(["update", "-qq"]),
        "check the network and /etc/apt/sources.list.d",
    )
}

/// Newest version of a package in the lists. Returns `None` if they do not contain it.
pub(crate) fn candidate(package: &str) -> Option<String> {
    let madison = read(command("apt-cache").args(["madison", package]), "").ok()?;
    newest(&madison)
}

/// `apt-cache madison` lists the newest version first: `package | version | source`.
fn newest(madison: &str) -> Option<String> {
    let version = madison.lines().next()?.split('|').nth(1)?.trim();
    (!version.is_empty()).then(|| version.to_owned())
}

fn is_debian_like(os_release: &str) -> bool {
    os_release.lines().any(|line| {
        line.strip_prefix("ID=")
            .or_else(|| line.strip_prefix("ID_LIKE="))
            .is_some_and(|value| {
                value
                    .trim_matches('"')
                    .split(' ')
                    .any(|word| word == "debian")
            })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_the_newest_version() {
        let madison = " rustc-web | 1.96.0+dfsg1-1~deb12u2 | http://deb.debian.org/debian-security bookworm-security/main amd64 Packages\n \
                       rustc-web | 1.85.0+dfsg3-1~deb12u3 | http://deb.debian.org/debian bookworm/main amd64 Packages\n";
        assert_eq!(newest(madison).as_deref(), Some("1.96.0+dfsg1-1~deb12u2"));
        assert_eq!(newest(""), None);
        assert_eq!(newest("N: Unable to locate package"), None);
    }

    #[test]
    fn knows_debian_and_its_children() {
        assert!(is_debian_like("NAME=x\nID=debian\n"));
        assert!(is_debian_like("ID=ubuntu\nID_LIKE=\"debian\"\n"));
        assert!(!is_debian_like("ID=\"fedora\"\n"));
        assert!(!is_debian_like(""));
    }
}

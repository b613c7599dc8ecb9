//! Debian's Slurm for the test of job arrays, unpacked into a folder under `target`. Nothing is installed, and root is not needed.

use std::path::{Path, PathBuf};

use crate::debian;
use crate::disk::{entries, make_folder, remove_folder};
use crate::failure::{Failure, Outcome};
use crate::run::{command, read, run, target_folder};

/// Packages of the programs; their dependencies are resolved by apt.
const PACKAGES: [&str; 4] = [
    "slurmctld",
    "slurmd",
    "slurm-client",
    "slurm-wlm-basic-plugins",
];

/// Downloads and unpacks Slurm if it is missing.
///
/// # Errors
/// The system is not Debian, has no package lists, or a download fails.
pub(crate) fn unpack() -> Outcome {
    let prefix = std::path::absolute(target_folder()?.join("slurm"))
        .unwrap_or_else(|_| PathBuf::from("target/slurm"));
    if prefix.join("usr/sbin/slurmctld-wlm").exists() {
        println!("Slurm is there, under {}", prefix.display());
        return Ok(());
    }
    if !debian::is_debian() {
        return Err(Failure::new(
            "looking for Slurm",
            "this is not Debian, whose packages are unpacked here",
            "go on without: the test of job arrays then says that it is skipped",
        ));
    }
    debian::update()?;
    let unfinished = prefix.with_extension("unfinished");
    remove_folder(&unfinished)?;
    let packages = unfinished.join("packages");
    make_folder(&packages)?;
    let next = "check the network, run `apt-get update` as root, and repeat the command";
    let plan = read(
        command("apt-get")
            .args(["install", "--simulate", "--no-install-recommends"])
            .args(PACKAGES),
        next,
    )?;
    let planned = plan.lines().filter_map(|line| line.strip_prefix("Inst "));
    let planned: Vec<&str> = planned
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    run(
        command("apt-get")
            .current_dir(&packages)
            .args(["download", "-qq", "-o", "APT::Sandbox::User=root"])
            .args(if planned.is_empty() {
                &PACKAGES[..]
            } else {
                &planned
            }),
        next,
    )?;
    for package in entries(&packages, |name| {
        Path::new(name).extension().is_some_and(|end| end == "deb")
    })? {
        run(
            command("dpkg-deb").arg("-x").arg(&package).arg(&unfinished),
            "check the free space of the disk, and repeat the command",
        )?;
    }
    remove_folder(&packages)?;
    std::fs::rename(&unfinished, &prefix)
        .map_err(|why| crate::disk::failed("moving into place", &prefix, why))?;
    println!("Slurm is unpacked under {}", prefix.display());
    Ok(())
}

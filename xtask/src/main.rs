//! Chores of the developers, each as one command; `cargo xtask --help` lists them.

mod bench;
mod book;
mod check;
mod debian;
mod deny;
mod disk;
mod emulator;
mod failure;
mod firmware;
mod fuzz;
mod image;
mod lab;
mod mutants;
mod python;
mod release;
mod run;
mod slurm;
mod soak;
mod steps;
mod toolchain;
mod tools;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;

use failure::{Failure, Outcome};
use firmware::{Board, Variant};
use toolchain::{Target, Toolchain};

/// Chores of the project's developers.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Chore {
    /// Installs missing tools, builds the firmware, and runs format, clippy, documentation and every test.
    Test,
    /// Finds the compilers for the RP2040 and for the lab page, or makes them from Debian packages.
    Toolchain,
    /// Builds the firmware's ELF and UF2 files and checks their use of flash and RAM.
    Firmware {
        /// One board instead of all.
        #[arg(long)]
        board: Option<Board>,
        /// Ratio of the pack's voltage to that of the battery pin in thousandths, if a divider is soldered.
        #[arg(long, value_name = "MILLI", value_parser = clap::value_parser!(u32).range(1000..))]
        battery_divider: Option<u32>,
    },
    /// Flashes the firmware through a debug probe and shows its log (probe-rs).
    Flash {
        #[arg(long, default_value = "nano-connect")]
        board: Board,
        /// The same as for `firmware`.
        #[arg(long, value_name = "MILLI", value_parser = clap::value_parser!(u32).range(1000..))]
        battery_divider: Option<u32>,
    },
    /// Builds the book from the pages of this checkout and checks every link in it.
    Book,
    /// Builds the lab page with its WebAssembly modules: one HTML file in target/lab.
    Lab,
    /// Builds the archive of a release (command with the lab page inside, wheel, firmware, book, checksums) and tries it.
    Release,
    /// Installs the RP2040 emulator that boots the firmware in tests (npm).
    Emulator,
    /// Unpacks Debian's Slurm under target/slurm for the test of job arrays.
    Slurm,
    /// Builds the Python wheel, installs it under target/python, and tests it: pytest, mypy, stubtest, notebooks.
    Python,
    /// Runs our benches and Python packages for comparison, and prints the ratios.
    Bench {
        /// Folder of the peers' Python modules (`model.py`, `gaits.py`); it is copied, not written to.
        #[arg(default_value = "../shared/bench")]
        peers: PathBuf,
    },
    /// Runs each fuzz target for a minute (libFuzzer, by cargo-fuzz, which it installs under target/tools).
    Fuzz {
        /// One target instead of all.
        target: Option<String>,
        /// Time for each target.
        #[arg(long, default_value_t = 60)]
        seconds: u32,
    },
    /// Checks licences, sources and versions of all dependencies against deny.toml (cargo-deny).
    Deny {
        /// Installs cargo-deny under target/tools where it is not there.
        #[arg(long)]
        install: bool,
    },
    /// Mutates the safety-relevant code and lists the changes that no test detects (cargo-mutants).
    Mutants {
        /// One crate instead of all.
        package: Option<String>,
        /// Installs cargo-mutants under target/tools where it is not there.
        #[arg(long)]
        install: bool,
    },
    /// Runs the tests that are too long for every change (those marked `#[ignore]`).
    Soak {
        /// Only tests with this in their names.
        filter: Option<String>,
    },
}

fn main() -> ExitCode {
    match perform(Chore::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("\nerror: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn perform(chore: Chore) -> Outcome {
    enter_the_root()?;
    match chore {
        Chore::Test => check::all(),
        Chore::Toolchain => {
            for target in [Target::Chip, Target::Page] {
                println!("{}", Toolchain::find_or_make(target)?.describe());
            }
            Ok(())
        }
        Chore::Firmware {
            board,
            battery_divider: battery_divider_milli,
        } => {
            let toolchain = Toolchain::find_or_make(Target::Chip)?;
            let boards = board.map_or(Board::ALL.to_vec(), |board| vec![board]);
            boards
                .into_iter()
                .map(|board| Variant {
                    board,
                    battery_divider_milli,
                })
                .try_for_each(|variant| firmware::build(&toolchain, variant))
        }
        Chore::Flash {
            board,
            battery_divider: battery_divider_milli,
        } => {
            let variant = Variant {
                board,
                battery_divider_milli,
            };
            firmware::flash(&Toolchain::find_or_make(Target::Chip)?, variant)
        }
        Chore::Book => book::build(),
        Chore::Lab => lab::build().map(drop),
        Chore::Release => release::build(),
        Chore::Slurm => slurm::unpack(),
        Chore::Emulator => emulator::install(),
        Chore::Python => python::test(true),
        Chore::Bench { peers } => bench::run_all(&peers),
        Chore::Fuzz { target, seconds } => fuzz::run_targets(target.as_deref(), seconds),
        Chore::Deny { install } => deny::check(install),
        Chore::Mutants { package, install } => mutants::hunt(package.as_deref(), install),
        Chore::Soak { filter } => soak::run_ignored(filter.as_deref()),
    }
}

/// Changes to the root of the workspace: cargo reads `.cargo/config.toml` from the current folder.
fn enter_the_root() -> Outcome {
    let Some(manifest) = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from) else {
        return Ok(()); // started without cargo; the current folder is assumed to be the root
    };
    let root = manifest.parent().unwrap_or(&manifest).to_owned();
    std::env::set_current_dir(&root).map_err(|why| {
        Failure::new(
            format!("entering {}", root.display()),
            why,
            "run it from the workspace's root",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        <Chore as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn boards_are_called_by_their_features() {
        assert!(Chore::try_parse_from(["xtask", "firmware", "--board", "pico"]).is_ok());
        assert!(Chore::try_parse_from(["xtask", "flash", "--board", "nano-connect"]).is_ok());
        assert!(Chore::try_parse_from(["xtask", "flash", "--board", "uno"]).is_err());
        let divider = |milli| ["xtask", "firmware", "--battery-divider", milli];
        assert!(Chore::try_parse_from(divider("4700")).is_ok());
        assert!(Chore::try_parse_from(divider("470")).is_err());
    }
}

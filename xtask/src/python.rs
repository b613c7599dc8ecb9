//! Python wheel: built, installed into its own environment under target/, and tested there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::debian;
use crate::disk::{failed, make_folder, remove_folder};
use crate::failure::{Failure, Outcome};
use crate::run::{command, run, target_folder, works};

/// Packages with exact versions.
const REQUIREMENTS: &str = "python/requirements.txt";
/// Requirements of the tests: the version of Python and the modules that create environments.
const ABLE: &str = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))";

/// Builds, installs and tests the wheel: tests, types, stubs, notebooks. If Python 3.11 or `PyPI` is not available, this fails if
/// `required`; otherwise it prints a message and tests nothing.
///
/// # Errors
/// The first failed step.
pub(crate) fn test(required: bool) -> Outcome {
    match Environment::find_or_make() {
        Ok(environment) => {
            environment.install_the_wheel()?;
            environment.run_tests()
        }
        Err(missing) if required => Err(missing),
        Err(missing) => {
            let line = "*".repeat(100);
            println!("{line}\nThe Python wheel is NOT TESTED here: {missing}\n{line}");
            Ok(())
        }
    }
}

/// Finds Python with `venv`, or installs it. System tests make environments of their own with it.
///
/// # Errors
/// It is missing and cannot be installed.
pub(crate) fn ensure() -> Outcome {
    debian::ensure_tool(python3().args(["-c", ABLE]), &["python3", "python3-venv"])
}

/// Python environment with the pinned packages.
struct Environment {
    folder: PathBuf,
}

impl Environment {
    fn find_or_make() -> Outcome<Self> {
        ensure()?;
        let folder = target_folder()?.join("python");
        let environment = Self { folder };
        let wanted = fs::read_to_string(REQUIREMENTS)
            .map_err(|why| failed("reading", Path::new(REQUIREMENTS), why))?;
        // Written last, so that an interrupted installation is repeated.
        let stamp = environment.folder.join("installed.txt");
        let installed = fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted);
        if installed && works(environment.python().arg("--version")) {
            println!("the packages of {REQUIREMENTS} are there");
            return Ok(environment);
        }
        remove_folder(&environment.folder)?;
        make_folder(&environment.folder)?;
        run(
            python3().args(["-m", "venv"]).arg(environment.venv()),
            "install Python's venv (Debian: python3-venv)",
        )?;
        run(
            environment.python().args([
                "-m",
                "pip",
                "install",
                "--quiet",
                "--requirement",
                REQUIREMENTS,
            ]),
            "check the network and PyPI, and repeat the command",
        )?;
        fs::write(&stamp, wanted).map_err(|why| failed("writing", &stamp, why))?;
        Ok(environment)
    }

    /// Builds with the profile of the tests, so that cargo can reuse their dependencies if the features agree.
    fn install_the_wheel(&self) -> Outcome {
        let wheels = self.folder.join("wheels");
        remove_folder(&wheels)?;
        let mut maturin = self.python();
        maturin
            .args([
                "-m",
                "maturin",
                "build",
                "--quiet",
                "--locked",
                "--profile",
                "dev",
                "--features",
                "as-tested",
                "--out",
            ])
            .arg(&wheels)
            .arg("--interpreter")
            .arg(self.interpreter());
        run(&mut maturin, "fix what the compiler reports above")?;
        run(
            self.python()
                .args([
                    "-m",
                    "pip",
                    "install",
                    "--quiet",
                    "--no-index",
                    "--no-deps",
                    "--force-reinstall",
                ])
                .arg(the_wheel_in(&wheels)?),
            "see what pip says above",
        )
    }

    fn run_tests(&self) -> Outcome {
        let tests: [(&[&str], &str); 4] = [
            (&["pytest", "--quiet"], "fix what the tests report above"),
            (&["mypy"], "fix the types under python/"),
            (
                &["mypy.stubtest", "swimmer._swimmer"],
                "make python/swimmer/_swimmer.pyi say what the extension holds",
            ),
            (
                &["pytest", "--quiet", "--nbmake", "python/notebooks"],
                "fix the notebooks",
            ),
        ];
        tests.iter().try_for_each(|(words, next)| {
            run(
                self.python()
                    .arg("-m")
                    .args(*words)
                    // Nothing is written next to the sources.
                    .env("PYTHONDONTWRITEBYTECODE", "1")
                    .env("MPLBACKEND", "Agg"),
                next,
            )
        })
    }

    fn venv(&self) -> PathBuf {
        self.folder.join("venv")
    }

    fn interpreter(&self) -> PathBuf {
        self.venv().join(if cfg!(windows) {
            "Scripts/python.exe"
        } else {
            "bin/python"
        })
    }

    fn python(&self) -> Command {
        let mut python = command(self.interpreter());
        // Ignores an environment that is active in the caller's shell.
        python
            .env_remove("PYTHONPATH")
            .env("VIRTUAL_ENV", self.venv());
        python
    }
}

fn python3() -> Command {
    command(if cfg!(windows) { "python" } else { "python3" })
}

fn the_wheel_in(folder: &Path) -> Outcome<PathBuf> {
    let listed = fs::read_dir(folder).map_err(|why| failed("listing", folder, why))?;
    listed
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .find(|path| path.extension().is_some_and(|ending| ending == "whl"))
        .ok_or_else(|| {
            Failure::new(
                format!("looking for the wheel in {}", folder.display()),
                "there is none",
                "see what maturin says above",
            )
        })
}

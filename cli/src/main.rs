//! Binary of the `swimmer` command; the code is in the library of this package.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(swimmer_command::run(std::env::args_os()))
}

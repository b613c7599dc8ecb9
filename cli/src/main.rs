//! The binary of the `swimmer` command; all that it does stands in the library beside it.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(swimmer_command::run(std::env::args_os()))
}

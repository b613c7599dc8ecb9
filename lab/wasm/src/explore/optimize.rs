//! `optimize`: best gaits, as the commands of that name find them.

use operations::Context;
use operations::optimize::{self, Output, Request};
use serde::Serialize;

use crate::calls::{Lab, Outcome, json, parsed};

/// Output of the command. The page has no paths, so `gait` is the text of the gait file.
#[derive(Serialize)]
struct OptimizeOutput<'a> {
    #[serde(flatten)]
    output: &'a Output,
    gait: String,
}

/// Finds an optimum.
pub(super) fn optimize(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: Request = parsed(bytes)?;
    let output = optimize::run(&request, &mut Context::without_files())?;
    json(&OptimizeOutput {
        gait: output.gait().file.to_text(),
        output: &output,
    })
}

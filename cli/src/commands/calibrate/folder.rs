//! Folder of `-o`: the report, the fitted swimmer with the hashes of its inputs, every intermediate.

use std::path::Path;

use operations::calibrate::Fitted;
use operations::calibrate::campaign::Calibrated;
use swimmer_files::{Campaign, Provenance, write_atomically};

use crate::failure::{Failure, Outcome};
use crate::new_folder::NewFolder;
use crate::output::document;
use crate::report::calibration::{Calibration, page, tables};

const FITTED: &str = "fitted.toml";
const FITTED_FURTHER: &str = "fitted-further.toml";
const FIT: &str = "fit.json";
const EVIDENCE: &str = "evidence.json";
const REPORT: &str = "report.html";

/// Fills the folder.
///
/// # Errors
/// Errors of hashing the inputs and of writing.
pub(crate) fn write(calibrated: &Calibrated, file: &Path, folder: &NewFolder) -> Outcome {
    if let Some(reason) = &calibrated.without_evidence {
        return Err(reason.clone().into());
    }
    let (draft, place) = (folder.draft(), folder.place());
    let Fitted {
        campaign,
        result: found,
        output,
        evidence: Some(evidence),
        ..
    } = &calibrated.fitted
    else {
        return Err(Failure::Tried(
            "the report needs likelihood and profiles, which were not computed".to_owned(),
        ));
    };
    let made_by = concat!("swimmer calibrate ", env!("CARGO_PKG_VERSION"));
    let provenance = Provenance::of_files(made_by, &Campaign::files(file)?, place)?;
    let save = |name: &str, text: &str| write_atomically(&draft.join(name), text.as_bytes());
    provenance.save_with(&calibrated.recommended(), &draft.join(FITTED))?;
    save(FIT, &document(output))?;
    let names: Vec<String> = output.runs.iter().map(|run| run.file.clone()).collect();
    save(EVIDENCE, &document(&evidence.document(&names)))?;
    let mut files = vec![
        (
            FITTED,
            "the swimmer with the recommended drag, for swimmer optimize, and the hashes of its inputs",
        ),
        (
            FIT,
            "the fit, for --robust and --fit: what swimmer calibrate --json prints",
        ),
        (
            EVIDENCE,
            "likelihood, profiles, ridge, bootstrap, fits without each run",
        ),
    ];
    if let Some(further) = &output.further {
        provenance.save_with(&further.swimmer, &draft.join(FITTED_FURTHER))?;
        files.insert(
            1,
            (FITTED_FURTHER, "the same with all that was fitted also"),
        );
    }
    for (name, what, text) in tables(found, evidence, &names)? {
        save(name, &text)?;
        files.push((name, what));
    }
    let report = page(&Calibration {
        campaign,
        found,
        evidence,
        output,
        systematics: calibrated.assessment.systematics.as_ref(),
        options: calibrated.options,
        provenance: &provenance,
        files,
    })?;
    Ok(save(REPORT, &report)?)
}

//! Files that the commands draw or write, for a caller in the same process, which has the outputs from `operations`.

use std::path::{Path, PathBuf};

use operations::calibrate::campaign::Calibrated;
use operations::optimize::{speed, steer};
use operations::{Error, Subject, simulate};

use crate::commands::calibrate::write_folder;
use crate::commands::optimize::front::FrontFile;
use crate::commands::optimize::steer::write_gaits;
use crate::commands::simulate::Picture;
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::new_folder::{NewFolder, with_places};
use crate::output;
use crate::picture_file::{FigureOptions, FigureWidth};

/// Runs a part of a command whose Ctrl-C and messages stay the caller's.
fn quietly<T>(work: impl FnOnce() -> Outcome<T>) -> Result<T, Error> {
    let (outcome, _) = output::capture(work);
    outcome.map_err(|failure| {
        let message = with_places(&failure.to_string());
        match failure {
            Failure::BadInput(_) => Error::refused(message),
            Failure::Tried(_) | Failure::LinkLost(_) | Failure::AlreadyPrinted(_) => {
                Error::unsuccessful(message)
            }
        }
    })
}

/// Checks that a new file may be written there.
///
/// # Errors
/// A file exists there, or there is no folder for it.
pub fn check_new_file(path: &Path) -> Result<(), Error> {
    quietly(|| may_be_written(path))
}

/// Folder of results that appears whole or not at all. Dropped before it is complete, it is removed.
#[derive(Debug)]
pub struct ResultsFolder(NewFolder);

impl ResultsFolder {
    /// Starts a folder.
    ///
    /// # Errors
    /// The place is taken, or cannot be written to.
    pub fn start(place: &Path) -> Result<Self, Error> {
        quietly(|| NewFolder::start(place)).map(Self)
    }

    /// Writes report, fitted swimmer and tables of a campaign, and publishes the folder.
    ///
    /// # Errors
    /// The evidence of the report is missing, or the disk refuses.
    pub fn write_calibration(self, calibrated: &Calibrated, campaign: &Path) -> Result<(), Error> {
        quietly(|| {
            write_folder(calibrated, campaign, &self.0)?;
            self.0.publish()
        })
    }

    /// Writes the six gaits to steer by, names their files in the output, and publishes the folder.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn write_steering(self, output: &mut steer::Output) -> Result<(), Error> {
        quietly(|| write_gaits(output, self.0))
    }
}

/// New figure or table of the farthest gaits in shorter and longer periods.
#[derive(Debug)]
pub struct NewFront(FrontFile);

impl NewFront {
    /// A file that ends in `.svg`, `.png` or `.pdf` for the figure, or in `.csv` for the table.
    ///
    /// # Errors
    /// Another ending, or a file that exists.
    pub fn new(path: &str) -> Result<Self, Error> {
        quietly(|| {
            let file: FrontFile = path.parse().map_err(Failure::BadInput)?;
            file.may_be_written()?;
            Ok(Self(file))
        })
    }

    /// Writes the file and names it in the output.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn write(&self, output: &mut speed::Output) -> Result<(), Error> {
        quietly(|| self.0.write(output, FigureWidth::default()))
    }
}

/// New picture of a swimmer in motion.
#[derive(Debug)]
pub struct NewPicture(Picture);

impl NewPicture {
    /// A file that ends in `.svg`, `.png` or `.pdf` for snapshots, or in `.gif` for one cycle in motion.
    ///
    /// # Errors
    /// Another ending, or a file that exists.
    pub fn new(path: PathBuf) -> Result<Self, Error> {
        quietly(|| Picture::new(path, FigureOptions::default())).map(Self)
    }

    /// Draws a simulated gait, which people call `gait`, and names the file in the output.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn draw(
        &self,
        subject: &Subject,
        gait: &str,
        cycles: u32,
        output: &mut simulate::Output,
    ) -> Result<(), Error> {
        quietly(|| self.0.draw(subject, gait, cycles, output))
    }
}

//! Files that the commands draw or write, for a caller in the same process, which has the outputs from `operations`.

use std::path::{Path, PathBuf};

use operations::calibrate::campaign::Calibrated;
use operations::optimize::{speed, steer};
use operations::sweep::MapOutput;
use operations::{Error, Subject, plan, simulate};
use sweep::Shard;

use crate::captured::quietly;
use crate::commands::calibrate::write_folder;
use crate::commands::optimize::front::FrontFile;
use crate::commands::optimize::steer::write_gaits;
use crate::commands::plan::write_playlist;
use crate::commands::simulate::Picture;
use crate::commands::sweep::map::{MapFiles, MapQuantity};
use crate::commands::sweep::of_environment;
use crate::failure::Failure;
use crate::new_file::may_be_written;
use crate::new_folder::NewFolder;
use crate::picture_file::{FigureOptions, FigureWidth};

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
pub struct NewFront {
    file: FrontFile,
    width: FigureWidth,
}

impl NewFront {
    /// A file that ends in `.svg`, `.png` or `.pdf` for the figure, or in `.csv` for the table.
    ///
    /// # Errors
    /// Another ending, a file that exists, or a width of a table.
    pub fn new(path: &str, width: Option<FigureWidth>) -> Result<Self, Error> {
        quietly(|| {
            let file: FrontFile = path.parse().map_err(Failure::BadInput)?;
            let width = FigureOptions { width }.width(Some(file.kind()))?;
            file.may_be_written()?;
            Ok(Self { file, width })
        })
    }

    /// Writes the file and names it in the output.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn write(&self, output: &mut speed::Output) -> Result<(), Error> {
        quietly(|| self.file.write(output, self.width))
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
    pub fn new(path: PathBuf, width: Option<FigureWidth>) -> Result<Self, Error> {
        quietly(|| Picture::new(path, FigureOptions { width })).map(Self)
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

/// New playlist of a plan, with the gaits next to it.
#[derive(Debug)]
pub struct NewPlaylist(PathBuf);

impl NewPlaylist {
    /// A file that does not exist yet.
    ///
    /// # Errors
    /// A file exists there, or there is no folder for it.
    pub fn new(path: PathBuf) -> Result<Self, Error> {
        check_new_file(&path).map(|()| Self(path))
    }

    /// Writes playlist and gaits, and names them in the output.
    ///
    /// # Errors
    /// A gait file exists, or the disk refuses.
    pub fn write(&self, output: &mut plan::Output) -> Result<(), Error> {
        quietly(|| write_playlist(&self.0, output))
    }
}

/// New files of a sweep's map.
#[derive(Debug)]
pub struct NewMap(MapFiles);

impl NewMap {
    /// A picture of a quantity that ends in `.svg`, `.png` or `.pdf`, and a file of the numbers (JSON).
    ///
    /// # Errors
    /// Another ending, a file that exists, or a width without a picture.
    pub fn new(
        quantity: MapQuantity,
        picture: Option<PathBuf>,
        width: Option<FigureWidth>,
        export: Option<PathBuf>,
    ) -> Result<Self, Error> {
        let figure = FigureOptions { width };
        quietly(|| MapFiles::new(quantity, picture, figure, export)).map(Self)
    }

    /// Writes the files and names them in the output.
    ///
    /// # Errors
    /// No design of the map has the quantity, or the disk refuses.
    pub fn write(self, output: &mut MapOutput) -> Result<(), Error> {
        quietly(|| self.0.write(output))
    }
}

/// Shard of a sweep that Slurm's job array gives this process. Returns `None` outside of a job array.
///
/// # Errors
/// The tasks of the job array are not numbered as shards.
pub fn shard_of_job_array() -> Result<Option<Shard>, Error> {
    quietly(of_environment)
}

//! Motive's wide CSV, format 1.23, as an export of two labeled and two unlabeled markers looks.
//!
//! The header tells the number of frames, which is known only at the end: rows go to a file of their own, and the whole is
//! put together beside its place and renamed into it. Nothing half-written is ever found.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Camera, CameraConfig, Frame};

/// Why a tracking file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("writing the tracking file {}: {source}; does its folder exist and is there room?", path.display())]
pub struct TrackError {
    /// The file.
    pub path: PathBuf,
    /// The system's words.
    pub source: io::Error,
}

/// A tracking file in the making. Dropped before [`finish`](Self::finish), it leaves nothing behind.
#[derive(Debug)]
pub struct MotiveFile {
    path: PathBuf,
    rows_path: PathBuf,
    rows: BufWriter<File>,
    frames: u64,
    take: String,
    capture_start: String,
    /// Name and id of each point.
    points: [(String, String); 4],
}

impl MotiveFile {
    /// Starts a file that will stand at `path`. The ghosts' numbers and all ids come from the seed.
    ///
    /// # Errors
    /// [`TrackError`] when nothing can be written there.
    pub fn create(path: &Path, config: &CameraConfig, seed: u64) -> Result<Self, TrackError> {
        let rows_path = beside(path, "rows");
        let open = || -> io::Result<File> {
            if let Some(folder) = path
                .parent()
                .filter(|folder| !folder.as_os_str().is_empty())
            {
                fs::create_dir_all(folder)?;
            }
            if path.is_dir() {
                return Err(io::Error::new(
                    io::ErrorKind::IsADirectory,
                    "a folder of that name exists",
                ));
            }
            File::options()
                .read(true)
                .write(true)
                .create(true)
                .truncate(true)
                .open(&rows_path)
        };
        let rows = open().map_err(|source| TrackError {
            path: path.to_path_buf(),
            source,
        })?;
        // An open file needs no name: a twin that is killed leaves none.
        #[cfg(unix)]
        let _ = fs::remove_file(&rows_path);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(2);
        let ghost: u32 = rng.random_range(1000..5000);
        let ids: [u64; 4] = rng.random();
        let names = [
            "Front".to_owned(),
            "Back".to_owned(),
            format!("Unlabeled {ghost}"),
            format!("Unlabeled {}", ghost + 3),
        ];
        let mut points = names
            .into_iter()
            .zip(ids.map(|id| format!("\"{id:016X}\"")));
        let points = std::array::from_fn(|_| points.next().unwrap_or_default());
        Ok(Self {
            path: path.to_path_buf(),
            rows_path,
            rows: BufWriter::new(rows),
            frames: 0,
            take: config.take.clone(),
            capture_start: config.capture_start.clone(),
            points,
        })
    }

    /// Where the file will stand.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Frames written so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`TrackError`].
    pub fn push(&mut self, frame: &Frame) -> Result<(), TrackError> {
        let mut write = || -> io::Result<()> {
            let rate = u64::from(Camera::RATE_HZ);
            let microseconds = self.frames * 1_000_000 / rate;
            write!(
                self.rows,
                "{},{}.{:06}",
                self.frames,
                microseconds / 1_000_000,
                microseconds % 1_000_000
            )?;
            for point in frame {
                match point {
                    Some([x, y, z]) => write!(self.rows, ",{x:.6},{y:.6},{z:.6}")?,
                    None => write!(self.rows, ",,,")?,
                }
            }
            self.rows.write_all(b"\r\n")
        };
        write().map_err(|source| self.error(source))?;
        self.frames += 1;
        Ok(())
    }

    /// Puts the file in its place. Returns how many frames it holds.
    ///
    /// # Errors
    /// [`TrackError`]; what stood at the path before still stands there.
    pub fn finish(mut self) -> Result<u64, TrackError> {
        let whole = beside(&self.path, "partial");
        let assembled = self
            .assemble(&whole)
            .and_then(|()| fs::rename(&whole, &self.path));
        assembled.map_err(|source| {
            let _ = fs::remove_file(&whole);
            self.error(source)
        })?;
        Ok(self.frames)
    }

    fn assemble(&mut self, whole: &Path) -> io::Result<()> {
        self.rows.flush()?;
        let rows = self.rows.get_mut();
        rows.rewind()?;
        let mut file = BufWriter::new(File::create(whole)?);
        file.write_all(
            header(self.frames, &self.take, &self.capture_start, &self.points).as_bytes(),
        )?;
        io::copy(&mut Read::by_ref(rows), &mut file)?;
        file.flush()?;
        file.get_ref().sync_all()
    }

    fn error(&self, source: io::Error) -> TrackError {
        TrackError {
            path: self.path.clone(),
            source,
        }
    }
}

impl Drop for MotiveFile {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.rows_path);
    }
}

/// The seven rows before the data.
fn header(frames: u64, take: &str, capture_start: &str, points: &[(String, String); 4]) -> String {
    let rate = Camera::RATE_HZ;
    let thrice = |text: &dyn Fn(&(String, String)) -> String| -> String {
        points
            .iter()
            .flat_map(|point| std::iter::repeat_n(format!(",{}", text(point)), 3))
            .collect()
    };
    [
        format!(
            "Format Version,1.23,Take Name,{take},Take Notes,,Capture Frame Rate,{rate}.000000,Export Frame Rate,{rate}.000000,\
             Capture Start Time,{capture_start},Total Frames in Take,{frames},Total Exported Frames,{frames},\
             Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global"
        ),
        String::new(),
        format!(",Type{}", thrice(&|_| "Marker".to_owned())),
        format!(",Name{}", thrice(&|(name, _)| name.clone())),
        format!(",ID{}", thrice(&|(_, id)| id.clone())),
        format!(",{}", thrice(&|_| "Position".to_owned())),
        format!("Frame,Time (Seconds){}", ",X,Y,Z".repeat(points.len())),
        String::new(),
    ]
    .join("\r\n")
}

/// `name.csv` becomes `.name.csv.SUFFIX.PROCESS` in the same folder, so that the rename stays on one file system.
fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{suffix}.{}", std::process::id()));
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_whole_or_not_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/track.csv");
        let config = CameraConfig::default();
        let mut file = MotiveFile::create(&path, &config, 1).unwrap();
        file.push(&[Some([1.0, 2.0, 3.0]), None, None, Some([-0.5, 0.0, 1e-7])])
            .unwrap();
        file.push(&[None; 4]).unwrap();
        assert!(!path.exists());
        assert_eq!(file.finish().unwrap(), 2);
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert_eq!(lines.len(), 10);
        assert!(
            lines[0].starts_with("Format Version,1.23,")
                && lines[0].contains("Total Exported Frames,2,")
        );
        assert_eq!(lines[1], "");
        assert_eq!(lines[2], format!(",Type{}", ",Marker".repeat(12)));
        assert!(lines[3].starts_with(",Name,Front,Front,Front,Back,Back,Back,Unlabeled "));
        assert_eq!(lines[5], format!(",{}", ",Position".repeat(12)));
        assert_eq!(
            lines[6],
            format!("Frame,Time (Seconds){}", ",X,Y,Z".repeat(4))
        );
        assert_eq!(
            lines[7],
            "0,0.000000,1.000000,2.000000,3.000000,,,,,,,-0.500000,0.000000,0.000000"
        );
        assert_eq!(lines[8], "1,0.010000,,,,,,,,,,,,");
        assert_eq!(lines[9], "");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn dropped_or_failed_it_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("track.csv");
        let mut file = MotiveFile::create(&path, &CameraConfig::default(), 1).unwrap();
        file.push(&[None; 4]).unwrap();
        drop(file);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let error = MotiveFile::create(folder.path(), &CameraConfig::default(), 1).unwrap_err();
        assert!(
            error.to_string().contains("writing the tracking file"),
            "{error}"
        );
    }
}

//! Motive's wide CSV, format 1.23, like an export of two labeled and two unlabeled markers.
//!
//! The file grows in place by whole rows, together with the number of frames in its header. So after a crash or a full disk the
//! recorded rows remain readable.

use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{Camera, CameraConfig, Frame};

/// Error of a tracking file.
#[derive(Debug, thiserror::Error)]
#[error("writing the tracking file {}: {source}; does its folder exist and is there room?", path.display())]
pub struct TrackError {
    /// Path of the file.
    pub path: PathBuf,
    /// The system's error.
    pub source: io::Error,
}

/// Tracking file in progress. Dropped before [`finish`](Self::finish), it ends with the last written rows.
///
/// ```
/// use swimmer_model::Pose;
/// use twin::{Camera, CameraConfig, MotiveFile};
///
/// # let path = std::env::temp_dir().join(format!("motive-{}.csv", std::process::id()));
/// let mut file = MotiveFile::create(&path, &CameraConfig::perfect(), 1)?;
/// file.push(&Camera::new(CameraConfig::perfect(), 0.3, 1, 0).expose(&Pose::identity()))?;
/// assert_eq!(file.finish()?, 1);
/// assert!(std::fs::read_to_string(&path).unwrap().contains("Format Version,1.23"));
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), twin::TrackError>(())
/// ```
#[derive(Debug)]
pub struct MotiveFile {
    path: PathBuf,
    file: File,
    /// Rows to write next.
    rows: Vec<u8>,
    frames: u64,
    /// Length of the whole rows on disk, bytes, and their number.
    length: u64,
    kept: u64,
    /// Offsets of the number of frames in the header.
    counts: [u64; 2],
}

/// Rows per write: a quarter of a second.
const ROWS: u64 = 25;
/// Digits of the number of frames, which is overwritten as it grows.
const DIGITS: usize = 10;

impl MotiveFile {
    /// Creates or replaces the file at `path`. The seed determines the ghosts' numbers and all ids.
    ///
    /// # Errors
    /// [`TrackError`] if the file cannot be written.
    pub fn create(path: &Path, config: &CameraConfig, seed: u64) -> Result<Self, TrackError> {
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
        let none = count(0);
        let header = header(&none, &config.take, &config.capture_start, &points);
        let mut places = header.match_indices(&none).map(|(at, _)| at as u64);
        let counts = [(); 2].map(|()| places.next().unwrap_or_default());
        let open = || -> io::Result<File> {
            if let Some(folder) = path
                .parent()
                .filter(|folder| !folder.as_os_str().is_empty())
            {
                fs::create_dir_all(folder)?;
            }
            let mut file = File::create(path)?;
            file.write_all(header.as_bytes())?;
            Ok(file)
        };
        let file = open().map_err(|source| TrackError {
            path: path.to_path_buf(),
            source,
        })?;
        Ok(Self {
            path: path.to_path_buf(),
            file,
            rows: Vec::new(),
            frames: 0,
            length: header.len() as u64,
            kept: 0,
            counts,
        })
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of frames so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// [`TrackError`]; earlier rows remain.
    pub fn push(&mut self, frame: &Frame) -> Result<(), TrackError> {
        let rate = u64::from(Camera::RATE_HZ);
        let microseconds = self.frames * 1_000_000 / rate;
        // Writing to memory cannot fail.
        let _ = write!(
            self.rows,
            "{},{}.{:06}",
            self.frames,
            microseconds / 1_000_000,
            microseconds % 1_000_000
        );
        for point in frame {
            let _ = match point {
                Some([x, y, z]) => write!(self.rows, ",{x:.6},{y:.6},{z:.6}"),
                None => write!(self.rows, ",,,"),
            };
        }
        self.rows.extend_from_slice(b"\r\n");
        self.frames += 1;
        if self.frames.is_multiple_of(ROWS) {
            self.write()?;
        }
        Ok(())
    }

    /// Finishes the file. Returns its number of frames.
    ///
    /// # Errors
    /// [`TrackError`]; written rows remain.
    pub fn finish(mut self) -> Result<u64, TrackError> {
        self.write()?;
        let synced = self.file.sync_all();
        synced.map_err(|source| self.error(source))?;
        Ok(self.frames)
    }

    /// Writes the pending rows, then their number. Truncates an incomplete row of a full disk.
    fn write(&mut self) -> Result<(), TrackError> {
        let rows = std::mem::take(&mut self.rows);
        let written = self.file.write_all(&rows).and_then(|()| {
            self.length += rows.len() as u64;
            self.kept = self.frames;
            for place in self.counts {
                self.file.seek(SeekFrom::Start(place))?;
                self.file.write_all(count(self.frames).as_bytes())?;
            }
            self.file.seek(SeekFrom::Start(self.length)).map(|_| ())
        });
        written.map_err(|source| {
            let _ = self.file.set_len(self.length);
            self.frames = self.kept;
            self.error(source)
        })
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
        let _ = self.write();
    }
}

/// Number of frames in the header's format.
fn count(frames: u64) -> String {
    format!("{frames:0DIGITS$}")
}

/// Seven header rows before the data.
fn header(frames: &str, take: &str, capture_start: &str, points: &[(String, String); 4]) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_grows_in_whole_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/track.csv");
        let config = CameraConfig::default();
        let mut file = MotiveFile::create(&path, &config, 1).unwrap();
        file.push(&[Some([1.0, 2.0, 3.0]), None, None, Some([-0.5, 0.0, 1e-7])])
            .unwrap();
        file.push(&[None; 4]).unwrap();
        assert!(
            fs::read_to_string(&path)
                .unwrap()
                .contains("Frames,0000000000,")
        );
        assert_eq!(file.finish().unwrap(), 2);
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert_eq!(lines.len(), 10);
        assert!(
            lines[0].starts_with("Format Version,1.23,")
                && lines[0].contains("Total Exported Frames,0000000002,")
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

    /// After a simulated power cut the file has all rows written before, and is readable.
    #[test]
    fn what_was_recorded_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("track.csv");
        let mut file = MotiveFile::create(&path, &CameraConfig::default(), 1).unwrap();
        for _ in 0..60 {
            file.push(&[None; 4]).unwrap();
        }
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains("Total Exported Frames,0000000050,") && text.ends_with("\r\n"));
        assert_eq!(text.lines().count(), 7 + 50);
        drop(file);
        assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 7 + 60);
        let error = MotiveFile::create(folder.path(), &CameraConfig::default(), 1).unwrap_err();
        assert!(
            error.to_string().contains("writing the tracking file"),
            "{error}"
        );
    }

    /// A full disk gets no incomplete row.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_ends_it_with_an_error() {
        let refused = MotiveFile::create(Path::new("/dev/full"), &CameraConfig::default(), 1);
        assert!(refused.unwrap_err().to_string().contains("No space left"));
    }
}

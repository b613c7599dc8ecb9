//! Dropped files as the campaign wants them: nothing is looked for anywhere else.

use std::path::Path;

use calibrate::{CampaignData, RunData, Timing, read_tracks_with, track_options};
use serde::Deserialize;
use swimmer_files::{AnyGait, Campaign, CampaignRun, GaitFile, GaitSpec, PointName};

use crate::calls::parsed;

/// Files by name: the length of a JSON list `[{"name", "length"}]` as four bytes, little-endian, the list, the files' bytes.
pub(super) struct Dropped<'a>(Vec<(String, &'a [u8])>);

#[derive(Deserialize)]
struct Listed {
    name: String,
    length: usize,
}

impl<'a> Dropped<'a> {
    pub(super) fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let short = || "reading the dropped files: the page sent less than it said".to_owned();
        let (length, rest) = bytes.split_first_chunk().ok_or_else(short)?;
        let length = usize::try_from(u32::from_le_bytes(*length)).map_err(|_| short())?;
        let (list, mut rest) = rest.split_at_checked(length).ok_or_else(short)?;
        let list: Vec<Listed> = parsed(list)?;
        let mut files = Vec::with_capacity(list.len());
        for Listed { name, length } in list {
            let (file, after) = rest.split_at_checked(length).ok_or_else(short)?;
            files.push((name, file));
            rest = after;
        }
        Ok(Self(files))
    }

    /// The one file that was dropped.
    pub(super) fn only(&self) -> Result<(&str, &'a [u8]), String> {
        match self.0.as_slice() {
            [(name, file)] => Ok((name, file)),
            others => Err(format!(
                "reading a track: {} files came, not one",
                others.len()
            )),
        }
    }

    /// By its name; folders are not dropped, so that only the last part counts.
    fn find(&self, path: &Path) -> Result<&'a [u8], String> {
        let wanted = path.file_name();
        let found = self
            .0
            .iter()
            .find(|(name, _)| Path::new(name).file_name() == wanted);
        found.map(|(_, file)| *file).ok_or_else(|| {
            format!(
                "the campaign names {}, which was not dropped; drop it with the others",
                path.display()
            )
        })
    }

    fn text(&self, path: &Path) -> Result<String, String> {
        String::from_utf8(self.find(path)?.to_vec())
            .map_err(|why| format!("reading {}: {why}", path.display()))
    }

    /// The campaign file: the TOML file with runs.
    pub(super) fn campaign(&self) -> Result<Campaign, String> {
        let is_campaign = |file: &[u8]| file.windows(7).any(|part| part == b"[[run]]");
        let (name, _) = self
            .0
            .iter()
            .find(|(name, file)| {
                Path::new(name).extension().is_some_and(|end| end == "toml") && is_campaign(file)
            })
            .ok_or("none of the files is a campaign (a .toml file with [[run]])")?;
        let path = Path::new(name);
        Campaign::parse_with(&self.text(path)?, path, |file| self.text(file).ok())
            .map_err(|why| why.to_string())
    }

    /// What [`CampaignData::load`] reads, of these files.
    pub(super) fn data(&self, campaign: &Campaign) -> Result<CampaignData, String> {
        let common = track_options(&campaign.reflectors, &campaign.tracks);
        let mut data = CampaignData::default();
        for run in campaign.included().map(|index| &campaign.runs[index]) {
            let gait = self.gait(&run.gait)?;
            if run.told.is_some() {
                data.told.push(gait);
                continue;
            }
            let mut options = common.clone();
            if let Some(PointName::Columns(x, y)) = &run.front {
                options.pairs.push([x.clone(), y.clone()]);
            }
            data.runs.push(RunData {
                track: read_tracks_with(self.find(&run.track)?, &run.track, &options)
                    .map_err(|why| why.to_string())?,
                file: run.track.clone(),
                gait,
                gait_name: run.gait.to_string(),
                period_s: run.period_s,
                front: run.front.clone(),
                timing: timing(run)?,
            });
        }
        Ok(data)
    }

    fn gait(&self, spec: &GaitSpec) -> Result<AnyGait, String> {
        let GaitSpec::File { path, reversed } = spec else {
            return spec.load().map_err(|why| why.to_string());
        };
        let file = GaitFile::parse(&self.text(path)?, path).map_err(|why| why.to_string())?;
        let gait = AnyGait::from_file(&file).map_err(|why| format!("{}: {why}", path.display()))?;
        Ok(gait.reversed_if(*reversed))
    }
}

/// Link logs are read by the command: they come compressed.
fn timing(run: &CampaignRun) -> Result<Timing, String> {
    match &run.timing.log {
        Some(log) => Err(format!(
            "{} times its cycles by the link log {}, which the page does not read: use `swimmer calibrate`",
            run.track.display(),
            log.display()
        )),
        None => Ok(Timing {
            cycle_start_s: run.timing.cycle_start_s,
            clock_offset_s: run.timing.clock_offset_s,
            ..Timing::default()
        }),
    }
}

//! Dropped files as the source of a campaign's data; no other files are read.

use std::io;
use std::path::Path;

use calibrate::CampaignData;
use serde::Deserialize;
use swimmer_files::Campaign;

use crate::calls::parsed;

/// Files by name. Format: the length of a JSON list `[{"name", "length"}]` as four bytes, little-endian; the list; the files' bytes.
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

    /// Returns the only file; fails if there are several.
    pub(super) fn only(&self) -> Result<(&str, &'a [u8]), String> {
        match self.0.as_slice() {
            [(name, file)] => Ok((name, file)),
            others => Err(format!(
                "reading a track: {} files came, not one",
                others.len()
            )),
        }
    }

    /// Returns a file by its name. Only the last part of the path counts, because folders cannot be dropped.
    fn find(&self, path: &Path) -> Result<&'a [u8], &'static str> {
        let wanted = path.file_name();
        let mut files = self.0.iter();
        let found = files.find(|(name, _)| Path::new(name).file_name() == wanted);
        let (_, file) = found
            .ok_or("the campaign names it, and it was not dropped; drop it with the others")?;
        Ok(file)
    }

    /// Campaign file: the TOML file with runs.
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
        let text = |file: &Path| Some(String::from_utf8_lossy(self.find(file).ok()?).into_owned());
        Campaign::parse_with(&text(path).unwrap_or_default(), path, text)
            .map_err(|why| why.to_string())
    }

    /// Data of the campaign, as [`CampaignData::load`] reads them, from these files.
    pub(super) fn data(&self, campaign: &Campaign) -> Result<CampaignData, String> {
        let open = |path: &Path| self.find(path).map_err(io::Error::other);
        CampaignData::load_by(campaign, open).map_err(|why| why.to_string())
    }
}

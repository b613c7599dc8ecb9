//! Swimmer of a call, parsed once while it stays the same.

use std::cell::RefCell;
use std::path::Path;

use serde::Deserialize;
use swimmer_files::SwimmerFile;
use swimmer_model::Model;

/// Swimmer: the name of a preset, or the text of a swimmer file.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(crate) struct SwimmerText(String);

thread_local! {
    /// Last parsed swimmer, since dragging a gait passes the same one at every step.
    static READ: RefCell<Option<(SwimmerText, SwimmerFile)>> = const { RefCell::new(None) };
}

impl SwimmerText {
    /// Parses the swimmer.
    pub(crate) fn read(&self) -> Result<SwimmerFile, String> {
        let known = READ.with_borrow(|last| {
            let same = last.as_ref().filter(|(text, _)| text == self);
            same.map(|(_, file)| file.clone())
        });
        if let Some(known) = known {
            return Ok(known);
        }
        let file = self.parse()?;
        READ.set(Some((self.clone(), file.clone())));
        Ok(file)
    }

    fn parse(&self) -> Result<SwimmerFile, String> {
        match SwimmerFile::preset(&self.0) {
            Some(preset) => Ok(preset),
            None => SwimmerFile::parse(&self.0, Path::new("swimmer.toml"))
                .map_err(|why| why.to_string()),
        }
    }

    /// Parses the swimmer and creates its model.
    pub(crate) fn model(&self) -> Result<(SwimmerFile, Model<f64>), String> {
        let file = self.read()?;
        let model = operations::model(&file)?;
        Ok((file, model))
    }
}

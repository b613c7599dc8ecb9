//! File of a finished block: rows between the plan's hash and their own hash, so that a part of another plan or an incomplete part
//! is recognised.

use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};
use swimmer_files::write_atomically;

use crate::row::Row;
use crate::{Plan, SweepError};

const MAGIC: &[u8] = b"swimmer-sweep-part 1\n";
const HASH: usize = 32;
/// Number of parts per folder.
const FOLDER: u64 = 1000;

/// Path of a block's part.
pub(crate) fn path(folder: &Path, block: u64) -> PathBuf {
    folder
        .join("parts")
        .join(format!("{:06}", block / FOLDER))
        .join(format!("{block:09}.part"))
}

/// Writes a finished block.
pub(crate) fn write(
    plan: &Plan,
    folder: &Path,
    block: u64,
    rows: &[Row],
) -> Result<(), SweepError> {
    let path = path(folder, block);
    let mut bytes = head(plan, block);
    let rows = postcard::to_stdvec(rows).map_err(|error| SweepError::Table {
        path: path.clone(),
        problem: error.to_string(),
    })?;
    bytes.extend(rows);
    let hash = Sha256::digest(&bytes);
    bytes.extend_from_slice(&hash);
    Ok(write_atomically(&path, &bytes)?)
}

fn head(plan: &Plan, block: u64) -> Vec<u8> {
    [MAGIC, plan.hash_bytes(), &block.to_le_bytes()].concat()
}

/// Reads the rows of a block. Returns `None` if its part is missing or incomplete.
pub(crate) fn read(plan: &Plan, folder: &Path, block: u64) -> Option<Vec<Row>> {
    let bytes = fs::read(path(folder, block)).ok()?;
    let (content, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH)?)?;
    if Sha256::digest(content).as_slice() != hash {
        return None;
    }
    let rows: Vec<Row> =
        postcard::from_bytes(content.strip_prefix(head(plan, block).as_slice())?).ok()?;
    let keys = plan.keys(block);
    (rows.iter().map(|row| row.key).eq(keys)).then_some(rows)
}

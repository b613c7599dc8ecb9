//! A finished block on the disk: rows between the plan's hash and their own, so that a part of another plan, and one that is not
//! whole, are known as such.

use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};
use swimmer_files::write_atomically;

use crate::row::Row;
use crate::{Plan, SweepError};

const MAGIC: &[u8] = b"swimmer-sweep-part 1\n";
const HASH: usize = 32;
/// Parts of a folder.
const FOLDER: u64 = 1000;

/// Where a block's part lies.
pub(crate) fn path(folder: &Path, block: u64) -> PathBuf {
    folder
        .join("parts")
        .join(format!("{:06}", block / FOLDER))
        .join(format!("{block:09}.part"))
}

/// Puts a finished block into its place.
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

/// The rows of a block, where its part is there and whole.
pub(crate) fn read(plan: &Plan, folder: &Path, block: u64) -> Option<Vec<Row>> {
    let bytes = fs::read(path(folder, block)).ok()?;
    let (told, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH)?)?;
    if Sha256::digest(told).as_slice() != hash {
        return None;
    }
    let rows: Vec<Row> =
        postcard::from_bytes(told.strip_prefix(head(plan, block).as_slice())?).ok()?;
    let keys = plan.keys(block);
    (rows.iter().map(|row| row.key).eq(keys)).then_some(rows)
}

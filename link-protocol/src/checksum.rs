//! CRC-32C (Castagnoli), the checksum of frames and tables. It detects every error of up to five bits at the lengths of a
//! frame; postcard and COBS alone accept every tenth corrupted frame.

use crc::{CRC_32_ISCSI, Crc, Digest, Table};

static CRC_32C: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISCSI);

/// CRC-32C of `bytes`.
///
/// ```
/// assert_eq!(link_protocol::crc32c(b"123456789"), 0xE306_9283);
/// ```
pub fn crc32c(bytes: &[u8]) -> u32 {
    CRC_32C.checksum(bytes)
}

/// Incremental CRC-32C.
///
/// ```
/// use link_protocol::{Checksum, crc32c};
///
/// let mut checksum = Checksum::new();
/// checksum.update(b"1234");
/// checksum.update(b"56789");
/// assert_eq!(checksum.finish(), crc32c(b"123456789"));
/// ```
pub struct Checksum(Digest<'static, u32, Table<1>>);

impl Checksum {
    /// Checksum of an empty input.
    pub fn new() -> Self {
        Self(CRC_32C.digest())
    }

    /// Appends `bytes`.
    pub fn update(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// CRC-32C of all bytes so far.
    pub fn finish(self) -> u32 {
        self.0.finalize()
    }
}

impl Default for Checksum {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_value_of_the_catalogue() {
        assert_eq!(crc32c(b"123456789"), 0xE306_9283);
    }

    #[test]
    fn pieces_give_the_whole() {
        let mut pieces = Checksum::new();
        pieces.update(b"1234");
        pieces.update(b"56789");
        assert_eq!(pieces.finish(), crc32c(b"123456789"));
    }
}

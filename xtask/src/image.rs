//! Flash and RAM of an ELF image, checked against their limits.

use std::fmt;

use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{ElfFile, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol};

use crate::failure::{Failure, Outcome};

/// Limit of flash in bytes.
pub(crate) const FLASH_CAP: u32 = 256 * 1024;
/// Limit of RAM in bytes, stack and variables together.
pub(crate) const RAM_CAP: u32 = 96 * 1024;
/// Address range of the RP2040's flash.
const FLASH: std::ops::Range<u32> = 0x1000_0000..0x1100_0000;
/// Address range of its RAM.
const RAM: std::ops::Range<u32> = 0x2000_0000..0x2004_2000;

/// Firmware image.
pub(crate) struct Image<'a> {
    /// Segments in flash: address and bytes.
    pub(crate) flash: Vec<(u32, &'a [u8])>,
    /// Memory use.
    pub(crate) footprint: Footprint,
}

/// Memory use of an image in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Footprint {
    flash: u32,
    variables: u32,
    stack: u32,
}

impl<'a> Image<'a> {
    /// Reads a 32-bit ELF file.
    ///
    /// # Errors
    /// The file is not a 32-bit ELF file or lacks the symbols of the stack.
    pub(crate) fn from_elf(bytes: &'a [u8]) -> Outcome<Self> {
        let broken = |why: &dyn fmt::Display| {
            Failure::new(
                "reading the firmware's ELF file",
                why,
                "remove it and build again",
            )
        };
        let elf = ElfFile::<FileHeader32<Endianness>>::parse(bytes).map_err(|why| broken(&why))?;
        let endian = elf.endian();
        let mut flash = Vec::new();
        let mut variables = 0;
        for segment in elf
            .elf_program_headers()
            .iter()
            .filter(|segment| segment.p_type(endian) == PT_LOAD)
        {
            let data = segment
                .data(endian, bytes)
                .map_err(|()| broken(&"a segment lies outside the file"))?;
            if FLASH.contains(&segment.p_paddr(endian)) && !data.is_empty() {
                flash.push((segment.p_paddr(endian), data));
            }
            if RAM.contains(&segment.p_vaddr(endian)) {
                variables += segment.p_memsz(endian);
            }
        }
        let symbol = |name: &str| {
            elf.symbol_by_name(name)
                .and_then(|symbol| u32::try_from(symbol.address()).ok())
                .ok_or_else(|| {
                    broken(&format_args!(
                        "it has no symbol `{name}`; memory.x defines it"
                    ))
                })
        };
        let stack = symbol("_stack_start")?.saturating_sub(symbol("_stack_end")?);
        let flash_bytes = flash
            .iter()
            .map(|(_, data)| u32::try_from(data.len()).unwrap_or(u32::MAX))
            .sum();
        Ok(Self {
            flash,
            footprint: Footprint {
                flash: flash_bytes,
                variables,
                stack,
            },
        })
    }
}

impl Footprint {
    /// Checks the limits.
    ///
    /// # Errors
    /// Flash or RAM exceeds its limit; the message has the numbers.
    pub(crate) fn check(self) -> Outcome {
        if self.flash <= FLASH_CAP && self.ram() <= RAM_CAP {
            return Ok(());
        }
        Err(Failure::new(
            "weighing the firmware",
            format!("it takes more than it may: {self}"),
            "see what grew: `cargo bloat`, or `nm --size-sort` on the ELF file",
        ))
    }

    fn ram(self) -> u32 {
        self.variables.saturating_add(self.stack)
    }
}

impl fmt::Display for Footprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |part: u32, whole: u32| 100.0 * f64::from(part) / f64::from(whole);
        write!(
            f,
            "flash {} of {} bytes ({:.1} %), RAM {} of {} bytes ({:.1} %: {} for variables, {} for the stack)",
            self.flash,
            FLASH_CAP,
            percent(self.flash, FLASH_CAP),
            self.ram(),
            RAM_CAP,
            percent(self.ram(), RAM_CAP),
            self.variables,
            self.stack,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_caps_themselves_pass_and_a_byte_more_fails() {
        let full = Footprint {
            flash: FLASH_CAP,
            variables: RAM_CAP - 16384,
            stack: 16384,
        };
        assert!(full.check().is_ok());
        let flash = Footprint {
            flash: FLASH_CAP + 1,
            ..full
        }
        .check()
        .unwrap_err()
        .to_string();
        assert!(flash.contains("flash 262145 of 262144 bytes"), "{flash}");
        let ram = Footprint {
            variables: full.variables + 1,
            ..full
        }
        .check()
        .unwrap_err()
        .to_string();
        assert!(ram.contains("RAM 98305 of 98304 bytes"), "{ram}");
    }

    #[test]
    fn anything_but_an_elf_file_is_a_failure() {
        assert!(Image::from_elf(b"").is_err());
        assert!(Image::from_elf(b"\x7fELF and then nothing").is_err());
        assert!(Image::from_elf(&[0; 4096]).is_err());
    }
}

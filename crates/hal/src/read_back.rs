//! Memory of what the sensor driver wrote to the registers it later computes with.
//!
//! The driver reads its own timing registers back and computes without checks. On other bytes it panics, so other
//! bytes must not reach it:
//!
//! | register (page 0) | what the driver computes | panics on |
//! |---|---|---|
//! | 0x51-52, 0x71-72 timeouts | `(lo << hi) + 1`, final − pre-range | hi ≥ 16, final < pre-range |
//! | 0x50, 0x70 laser periods | `(v + 1) << 1`, then divides by it | 0xFF (overflow), 0x7F (zero) |
//! | 0x46 signal-rate timeout | `v + 1` | 0xFF |
//! | 0x01 sequence steps | which of these times count | nothing, but the timing budget comes out wrong |
//!
//! Nothing else that is read meets arithmetic that can fail: the count of reference SPADs is only compared, and any
//! distance is a valid `u16`. What the driver itself writes to these registers is safe, and so is 0x00 in all of them,
//! which is what this memory expects before the first write.

use embedded_hal::i2c::Operation;

const CHECKED: [u8; 8] = [0x01, 0x46, 0x50, 0x51, 0x52, 0x70, 0x71, 0x72];
const PAGE: u8 = 0xFF;

/// What was written to page 0, and the page that is selected now.
pub(crate) struct ReadBack {
    page: u8,
    written: [u8; 256],
}

impl Default for ReadBack {
    fn default() -> Self {
        Self { page: 0, written: [0; 256] }
    }
}

impl ReadBack {
    /// Follows a finished transaction. `Err((register, wrote, read))` when a checked register reads wrong.
    pub(crate) fn check(&mut self, operations: &[Operation<'_>]) -> Result<(), (u8, u8, u8)> {
        match operations {
            [Operation::Write([register]), Operation::Read(read)] => self.compare(*register, read),
            // The driver writes by `write_read` as well and discards the byte it gets, so that byte is not compared.
            [Operation::Write([register, bytes @ ..]), ..] => {
                self.remember(*register, bytes);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn remember(&mut self, register: u8, bytes: &[u8]) {
        for (register, &byte) in ascending(register).zip(bytes) {
            match register {
                PAGE => self.page = byte,
                _ if self.page == 0 => self.written[usize::from(register)] = byte,
                _ => {}
            }
        }
    }

    fn compare(&self, register: u8, bytes: &[u8]) -> Result<(), (u8, u8, u8)> {
        for (register, &read) in ascending(register).zip(bytes) {
            let wrote = self.written[usize::from(register)];
            if self.page == 0 && CHECKED.contains(&register) && read != wrote {
                return Err((register, wrote, read));
            }
        }
        Ok(())
    }
}

/// The registers from `first` on, as the chip's index counts them.
fn ascending(first: u8) -> impl Iterator<Item = u8> {
    (0..=u8::MAX).map(move |offset| first.wrapping_add(offset))
}

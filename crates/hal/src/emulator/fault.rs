//! What can go wrong between a bus and a chip, for tests: which fault, at which chip, during which transactions.

use std::ops::Range;

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource, Operation};

/// A fault of one chip's wires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The chip does not acknowledge its address: no power, a loose wire.
    Nack,
    /// Every byte reads 0xFF, nothing that is written arrives.
    StuckHigh,
    /// Every byte reads 0x00, nothing that is written arrives.
    StuckLow,
    /// The bus hangs for so long, then the kernel gives up.
    Timeout {
        /// How long it hangs.
        seconds: f64,
    },
    /// Every byte that is read is random; what is written arrives.
    Noise {
        /// Same seed, same bytes.
        seed: u64,
    },
    /// One byte in eight that is read has one wrong bit; what is written arrives.
    Flips {
        /// Same seed, same bits.
        seed: u64,
    },
}

impl Fault {
    /// The error that the caller sees, for faults that it sees at all.
    pub(super) fn error(self) -> Option<ErrorKind> {
        match self {
            Self::Nack => Some(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address)),
            Self::Timeout { .. } => Some(ErrorKind::Other),
            Self::StuckHigh | Self::StuckLow | Self::Noise { .. } | Self::Flips { .. } => None,
        }
    }

    /// Whether bytes still get to the chip.
    pub(super) fn delivers(self) -> bool {
        matches!(self, Self::Noise { .. } | Self::Flips { .. })
    }

    /// The change of a byte that is read. `n` counts the bytes.
    pub(super) fn distort(self, byte: u8, n: u64) -> u8 {
        match self {
            Self::StuckHigh => 0xFF,
            Self::StuckLow => 0x00,
            Self::Noise { seed } => hash(seed, n)[0],
            Self::Flips { seed } => match hash(seed, n) {
                [chance, bit, ..] if chance < 32 => byte ^ (1 << (bit % 8)),
                _ => byte,
            },
            Self::Nack | Self::Timeout { .. } => byte,
        }
    }
}

/// A fault and the transactions of the chip that it spoils.
pub(super) struct Injection {
    pub(super) fault: Fault,
    pub(super) during: Range<u64>,
    /// Only those that begin at this register; all where there is none.
    pub(super) register: Option<u8>,
}

impl Injection {
    /// Whether it spoils transaction `n`, which is these operations.
    pub(super) fn hits(&self, n: u64, operations: &[Operation<'_>]) -> bool {
        let first = match operations.first() {
            Some(Operation::Write(bytes)) => bytes.first().copied(),
            _ => None,
        };
        self.during.contains(&n) && self.register.is_none_or(|register| first == Some(register))
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014): a counter in, well-mixed bytes out.
fn hash(seed: u64, n: u64) -> [u8; 8] {
    let mut z = seed.wrapping_add(n.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)).to_le_bytes()
}

//! A million normal random numbers on standard output, eight bytes each, low first.
//!
//! A simulated flight is the same on every target only if its noise is. `scripts/build-pi` builds this program in the
//! same way as the binary, and compares its output under each emulated processor with its output here, bit for bit.

use plant::Normal;
use std::io::{self, BufWriter, Write};

fn main() -> io::Result<()> {
    let mut normal = Normal::new(7, 0);
    let mut out = BufWriter::new(io::stdout().lock());
    for _ in 0..1_000_000 {
        out.write_all(&normal.draw().to_bits().to_le_bytes())?;
    }
    out.flush()
}

//! What the library of an FMU runs on.

use std::fmt;

/// A platform whose tools can load a library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Platform {
    /// 64-bit Linux on x86.
    Linux64,
    /// 64-bit Windows on x86.
    Win64,
}

impl Platform {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Linux64, Self::Win64];

    /// The platform of a compiled library, by its head. `None`: it is no library, or one for another platform.
    #[must_use]
    pub fn of(code: &[u8]) -> Option<Self> {
        Self::ALL.into_iter().find(|platform| match platform {
            Self::Linux64 => is_elf(code),
            Self::Win64 => is_pe(code).unwrap_or(false),
        })
    }

    /// The file as Cargo names it, which lies beside the program.
    #[must_use]
    pub const fn library(self) -> &'static str {
        match self {
            Self::Linux64 => "libairball_fmu.so",
            Self::Win64 => "airball_fmu.dll",
        }
    }

    /// The folder below `binaries` by the standard (section 2.3), and the ending of the file in it.
    pub(crate) const fn place(self) -> (&'static str, &'static str) {
        match self {
            Self::Linux64 => ("linux64", "so"),
            Self::Win64 => ("win64", "dll"),
        }
    }
}

impl fmt::Display for Platform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Linux64 => "64-bit Linux",
            Self::Win64 => "64-bit Windows",
        })
    }
}

/// Whether this begins as a shared library for Linux on x86-64 does: ELF, 64 bits, little-endian, type 3, machine 62.
fn is_elf(code: &[u8]) -> bool {
    code.starts_with(b"\x7fELF\x02\x01") && code.get(16..20) == Some(&[3, 0, 62, 0])
}

/// Whether this begins as a DLL for Windows on x86-64 does: the offset of the PE header at 0x3c, machine 0x8664, and
/// the flag 0x2000 of a DLL among the characteristics. `None`: it ends before.
fn is_pe(code: &[u8]) -> Option<bool> {
    let number = |at: usize| Some(u16::from_le_bytes(code.get(at..at.checked_add(2)?)?.try_into().ok()?));
    let at = usize::from(number(0x3c)?);
    let is_signed = code.starts_with(b"MZ") && number(0x3e)? == 0 && code.get(at..at + 4)? == b"PE\0\0";
    Some(is_signed && number(at + 4)? == 0x8664 && number(at + 22)? & 0x2000 != 0)
}

#[cfg(test)]
mod tests {
    use super::Platform;

    /// A head of a PE file: machine and characteristics.
    fn pe(machine: u16, characteristics: u16) -> Vec<u8> {
        let mut code = vec![0; 0x80];
        code[..2].copy_from_slice(b"MZ");
        code[0x3c] = 0x40;
        code[0x40..0x44].copy_from_slice(b"PE\0\0");
        code[0x44..0x46].copy_from_slice(&machine.to_le_bytes());
        code[0x56..0x58].copy_from_slice(&characteristics.to_le_bytes());
        code
    }

    #[test]
    fn a_library_is_known_by_its_head_and_a_program_or_another_processor_is_refused() {
        let mut elf = b"\x7fELF\x02\x01\x01".to_vec();
        elf.resize(64, 0);
        (elf[16], elf[18]) = (3, 62);
        assert_eq!(Platform::of(&elf), Some(Platform::Linux64));
        elf[18] = 183;
        assert_eq!(Platform::of(&elf), None);
        assert_eq!(Platform::of(&pe(0x8664, 0x2022)), Some(Platform::Win64));
        assert_eq!(Platform::of(&pe(0x8664, 0x0022)), None, "a program");
        assert_eq!(Platform::of(&pe(0xaa64, 0x2022)), None, "for ARM");
    }

    #[test]
    fn a_head_that_ends_early_or_points_outside_is_no_library() {
        let whole = pe(0x8664, 0x2022);
        for end in 0..0x58 {
            assert_eq!(Platform::of(&whole[..end]), None, "{end} bytes");
        }
        let mut far = whole;
        far[0x3c..0x3e].copy_from_slice(&[0xff, 0xff]);
        assert_eq!(Platform::of(&far), None);
    }
}

//! The line of output-enable as a command-line argument, for the guard that turns the fan off.

use std::fmt;
use std::str::FromStr;

/// The line of output-enable, as one word of a command line: `CHIP:LINE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EnableLine {
    pub(super) chip: String,
    pub(super) line: u32,
}

impl EnableLine {
    /// The line of a rig's table.
    #[must_use]
    pub fn of(rig: &config::Rig) -> Option<Self> {
        rig.output_enable.map(|pin| Self { chip: rig.gpio_chip.clone(), line: pin.line })
    }
}

impl fmt::Display for EnableLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.chip, self.line)
    }
}

impl FromStr for EnableLine {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let both = word.rsplit_once(':').and_then(|(chip, line)| Some((chip.to_owned(), line.parse().ok()?)));
        let (chip, line) = both.ok_or_else(|| format!("{word} is no CHIP:LINE, for instance /dev/gpiochip0:17"))?;
        Ok(Self { chip, line })
    }
}

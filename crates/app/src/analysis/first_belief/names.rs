//! What the name of a column says: its words, its number and its unit.

use rows::SheetColumn;

/// A name in parts: `command0_rad` is command, 0, rad.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Name {
    words: Vec<String>,
    /// The number in it, of several alike.
    pub(super) number: String,
    /// The unit, in lower case.
    pub(super) unit: Option<String>,
}

/// Units that stand behind a name; `s`, `m` and the like only behind another word.
const UNITS: [&str; 38] = [
    "s", "sec", "ms", "us", "ns", "min", "m", "cm", "mm", "um", "in", "rad", "deg", "rev", "v", "mv", "a", "ma", "n",
    "nm", "mnm", "pct", "percent", "%", "norm", "rpm", "counts", "hz", "w", "kn", "kw", "pwm", "°", "°c", "c", "k",
    "pa", "bar",
];

/// Those of a length or an angle.
const LENGTHS_AND_ANGLES: [&str; 9] = ["m", "cm", "mm", "um", "in", "rad", "deg", "rev", "°"];

/// Those of what drives a rig.
const DRIVES: [&str; 14] = ["v", "mv", "a", "ma", "n", "kn", "nm", "mnm", "w", "kw", "pct", "percent", "%", "pwm"];

impl Name {
    pub(super) fn of(column: &SheetColumn) -> Self {
        let mut words = with_whole_unit(words(&column.name), &column.name);
        let number = column.name.chars().filter(char::is_ascii_digit).collect();
        let bracketed = column.name.split_once(['[', '(']).and_then(|(_, rest)| rest.split([']', ')']).next());
        let is_word = |unit: &&str| unit.contains(is_word_character);
        let of_row = column.unit.as_deref().or(bracketed.filter(is_word)).map(|unit| unit.trim().to_lowercase());
        let is_unit = |word: &String| UNITS.contains(&word.as_str());
        let behind = (words.len() > 1).then(|| words.last().filter(|word| is_unit(word)).cloned()).flatten();
        if behind.is_some() {
            words.pop();
        }
        // A speed: `omega_rad_s`.
        let per_s = behind.as_deref() == Some("s") && words.len() > 1;
        let of_speed = words.last().filter(|word| per_s && LENGTHS_AND_ANGLES.contains(&word.as_str())).cloned();
        if of_speed.is_some() {
            words.pop();
        }
        let behind = of_speed.map(|unit| unit + "/s").or(behind);
        Self { words, number, unit: of_row.or(behind) }
    }

    /// Whether its unit is one of length or angle.
    pub(super) fn is_length_or_angle(&self) -> bool {
        self.unit.as_deref().is_some_and(|unit| LENGTHS_AND_ANGLES.contains(&unit))
    }

    /// Whether its unit is one of voltage, current, force, torque, power or share: no setpoint of a position has it.
    pub(super) fn is_drive(&self) -> bool {
        self.unit.as_deref().is_some_and(|unit| DRIVES.contains(&unit))
    }

    /// Whether `other` has the same words and number, and a unit, which this name lacks: `theta` and `theta(rad)`.
    pub(super) fn is_without_unit_of(&self, other: &Self) -> bool {
        self.unit.is_none() && other.unit.is_some() && self.words == other.words && self.number == other.number
    }

    /// The words that are in both names.
    pub(super) fn shared<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = &'a str> {
        self.words.iter().filter(|word| other.words.contains(word)).map(String::as_str)
    }

    /// Whether any of its words is one of these.
    pub(super) fn says(&self, known: &[&str]) -> bool {
        self.words.iter().any(|word| known.contains(&word.as_str()))
    }
}

/// The words of a name, in which a unit at its end is one: a capital letter in `current_mA` begins no word.
fn with_whole_unit(mut words: Vec<String>, name: &str) -> Vec<String> {
    let last = name.rsplit(|c: char| !c.is_alphabetic()).next().unwrap_or_default().to_lowercase();
    let is_last = |count: &usize| words[words.len() - count..].concat() == last;
    if let Some(count) = (2..words.len()).find(is_last).filter(|_| UNITS.contains(&last.as_str())) {
        words.truncate(words.len() - count);
        words.push(last);
    }
    words
}

/// Whether words and units may contain this character.
fn is_word_character(letter: char) -> bool {
    letter.is_alphabetic() || matches!(letter, '%' | '°')
}

/// The words of a name in lower case: parted by what is no letter, and where a capital follows a small letter.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for letter in name.chars() {
        let parts = before.is_lowercase() && letter.is_uppercase();
        if parts || !is_word_character(letter) {
            words.push(String::new());
        }
        if is_word_character(letter) {
            words.last_mut().into_iter().for_each(|word| word.extend(letter.to_lowercase()));
        }
        before = letter;
    }
    // The derivative of a symbol by time: `xdot`, `thetadot`.
    let parted = |word: String| match word.strip_suffix("dot") {
        Some(symbol) => vec![symbol.to_owned(), "dot".to_owned()],
        None => vec![word],
    };
    words.into_iter().flat_map(parted).filter(|word| !word.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::Name;
    use rows::SheetColumn;

    #[test]
    fn a_name_has_words_a_number_and_a_unit() {
        for (name, words, number, unit) in [
            ("command0_rad", &["command"][..], "0", Some("rad")),
            ("hoop_speed_V", &["hoop", "speed"], "", Some("v")),
            ("current_mA", &["current"], "", Some("ma")),
            ("force_kN", &["force"], "", Some("kn")),
            ("omega_rad_s", &["omega"], "", Some("rad/s")),
            ("rest_s", &["rest"], "", Some("s")),
            ("motorVoltage", &["motor", "voltage"], "", None),
            ("Angle [deg]", &["angle"], "", Some("deg")),
            ("pos (5)", &["pos"], "5", None),
            ("y", &["y"], "", None),
            ("theta_dot", &["theta", "dot"], "", None),
            ("xdot", &["x", "dot"], "", None),
            ("s", &["s"], "", None),
            ("", &[], "", None),
        ] {
            let found = Name::of(&SheetColumn { name: name.into(), ..SheetColumn::default() });
            let expected: Vec<&str> = found.words.iter().map(String::as_str).collect();
            assert_eq!((&expected[..], found.number.as_str(), found.unit.as_deref()), (words, number, unit), "{name}");
        }
    }
}

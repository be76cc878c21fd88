//! The words and units of a rig that is no ball in a pipe, from `[rig]`, put in place of those of the ball pipe.
//!
//! ```toml
//! [rig]
//! position = "angle"
//! position_unit = "deg"
//! input = "voltage"
//! input_unit = "V"
//! ```
//!
//! The program's sentences are about a ball, its height in mm, and a duty in percent. Keys of configs, columns and
//! names of files keep theirs: only whole words are replaced, and none between backticks, beside an underscore, a dot
//! or a slash, or in a name with a dot. No number is converted: the unit is that of the position as `[import]` scales
//! it.

use diagnose::{Finding, SourceColumns};
use serde::Serialize;
use toml::{Table, Value};

/// What a rig calls its position and its input, and their units.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Words {
    /// In place of position, height and ball.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<String>,
    /// In place of mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_unit: Option<String>,
    /// In place of duty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<String>,
    /// In place of percent of duty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input_unit: Option<String>,
}

/// Elements whose text is no sentence.
const LITERAL: [&str; 3] = ["code", "style", "script"];
/// Units of a position that is an angle.
const ANGLES: [&str; 6] = ["deg", "°", "rad", "mrad", "µrad", "rev"];
/// Longest word, letters.
const LONGEST: usize = 24;

/// Takes the words out of `[rig]`: the table itself describes the hardware of a ball pipe, which other rigs lack.
///
/// # Errors
/// The dotted key, and what is wrong there.
pub(super) fn take(merged: &mut Table) -> Result<Words, (String, String)> {
    let Some(rig) = merged.get_mut("rig").and_then(Value::as_table_mut) else { return Ok(Words::default()) };
    let mut word = |key: &str| match rig.remove(key) {
        None => Ok(None),
        Some(Value::String(word)) if is_word(&word) => Ok(Some(word)),
        Some(_) => Err((format!("rig.{key}"), format!("expected a text of 1 to {LONGEST} letters, in quotes"))),
    };
    let words = Words {
        position: word("position")?,
        position_unit: word("position_unit")?,
        input: word("input")?,
        input_unit: word("input_unit")?,
    };
    if rig.is_empty() {
        merged.remove("rig");
    }
    Ok(words)
}

fn is_word(word: &str) -> bool {
    !word.trim().is_empty() && word.chars().count() <= LONGEST && !word.contains(['<', '>', '&', '"'])
}

impl Words {
    /// Whether the rig is a ball pipe: it has no words of its own.
    #[must_use]
    pub fn is_ball_pipe(&self) -> bool {
        *self == Self::default()
    }

    /// A text of the program in the words of the rig.
    #[must_use]
    pub fn of(&self, text: &str) -> String {
        if self.is_ball_pipe() {
            return text.to_owned();
        }
        let pairs = self.pairs();
        let mut said = String::with_capacity(text.len());
        let (mut rest, mut before, mut quoted) = (text, ' ', false);
        while let Some(letter) = rest.chars().next() {
            quoted ^= letter == '`';
            let found = pairs.iter().find(|(old, _)| !quoted && !joins(before) && starts(rest, old));
            let (taken, new) = found.map_or((letter.len_utf8(), None), |(old, new)| (old.len(), Some(new)));
            match new {
                Some(new) => said.push_str(new),
                None => said.push(letter),
            }
            before = rest[..taken].chars().next_back().unwrap_or(' ');
            rest = &rest[taken..];
        }
        said
    }

    /// A unit of the program in that of the rig: alone, `%` is that of the input.
    #[must_use]
    pub fn unit<'a>(&'a self, unit: &'a str) -> &'a str {
        self.input_unit.as_deref().filter(|_| unit == "%").unwrap_or(unit)
    }

    /// A finding in the words of the rig, its lines of `[import]` for a record from these columns.
    #[must_use]
    pub fn finding(&self, finding: &Finding, columns: &SourceColumns) -> String {
        self.of(&finding.in_columns(columns))
    }

    /// The same of the words between the tags of a page or a picture; what is code, style or script stays.
    #[must_use]
    pub fn of_markup(&self, markup: &str) -> String {
        if self.is_ball_pipe() {
            return markup.to_owned();
        }
        let (mut said, mut literal) = (String::with_capacity(markup.len()), 0_usize);
        for part in markup.split_inclusive('>') {
            let (text, tag) = part.split_at(part.find('<').unwrap_or(part.len()));
            if literal == 0 {
                said.push_str(&self.of(text))
            } else {
                said.push_str(text)
            }
            said.push_str(tag);
            let is = |name: &str| tag.strip_prefix(name).is_some_and(|rest| rest.starts_with(['>', ' ']));
            if LITERAL.iter().any(|name| is(&format!("<{name}"))) {
                literal += 1;
            } else if LITERAL.iter().any(|name| is(&format!("</{name}"))) {
                literal = literal.saturating_sub(1);
            }
        }
        said
    }

    /// What is replaced by what, longer words first.
    fn pairs(&self) -> Vec<(String, String)> {
        let unit = self.position_unit.as_deref().unwrap_or("mm");
        let position = self.position.as_deref();
        let input = self.input.as_deref().unwrap_or("duty");
        let of_input = self.input_unit.as_deref();
        let mut pairs: Vec<(String, String)> = Vec::new();
        let mut put = |old: &str, new: String| {
            for (a, an) in [("a ", "an "), ("A ", "An ")] {
                let article = if new.starts_with(['a', 'e', 'i', 'o', 'u']) { an } else { a };
                pairs.push((format!("{a}{old}"), format!("{article}{new}")));
            }
            pairs.push((old.to_owned(), new));
        };
        if let Some(of_input) = of_input {
            put("mm/s² per % of duty", format!("{unit}/s² per {of_input}"));
            put("mm/s² per percent", format!("{unit}/s² per {of_input}"));
            put("% of duty", of_input.to_owned());
            put("percent of duty", of_input.to_owned());
            put("duty, %", format!("{input}, {of_input}"));
            put("mm per %", format!("{unit} per {of_input}"));
        }
        for old in ["mm²/s³", "mm²/s²", "mm²", "mm/s²", "mm/s", "mm", "millimetres", "millimetre"] {
            let new = old.replace("millimetres", unit).replace("millimetre", unit).replace("mm", unit);
            put(old, new);
        }
        put("duties", format!("values of the {input}"));
        put("duty", input.to_owned());
        put("Duty", capital(input));
        if let Some(position) = position {
            put("the ball lies at an end of the pipe", format!("the {position} is at an end of its range"));
            put("takes off", "leaves it".into());
            put("lands", "is back there".into());
            for old in ["position", "height", "ball"] {
                put(old, position.to_owned());
                put(&capital(old), capital(position));
            }
            put("heights", format!("values of the {position}"));
            put("noise of the air", "random force".into());
            put("belongs to the air", "belongs to the forces on the moving part".into());
            put("belongs to the ball", "belongs to the moving part".into());
            put("pipe", "range".into());
            put("fan", "actuator".into());
            let turns = self.position_unit.as_deref().is_some_and(|unit| ANGLES.contains(&unit));
            put("acceleration of the ball", if turns { "angular acceleration" } else { "acceleration" }.into());
            put("in free flight", "between the ends".into());
            put("free flight", "motion between the ends".into());
            put("fly", "record".into());
            put("Fly", "Record".into());
            put("flight", "record".into());
        }
        pairs.sort_by_key(|(old, _)| std::cmp::Reverse(old.len()));
        pairs
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Whether a letter before a word makes it a part of a longer one.
fn joins(letter: char) -> bool {
    letter.is_alphanumeric() || "_./-\\".contains(letter)
}

/// Whether a text starts with the name of a file, or with a key with dots: `ball-and-beam.csv`.
fn starts_with_name(text: &str) -> bool {
    let end = text.find(|letter: char| letter.is_whitespace() || "<>()[]\"'`,;:".contains(letter));
    let token = &text[..end.unwrap_or(text.len())];
    let joins =
        |at: usize| token[..at].ends_with(char::is_alphanumeric) && token[at + 1..].starts_with(char::is_alphabetic);
    token.match_indices('.').any(|(at, _)| joins(at))
}

/// Whether a text starts with these words, and the last one ends there and begins no name.
fn starts(text: &str, words: &str) -> bool {
    let Some(rest) = text.strip_prefix(words) else { return false };
    let last_word = words.rfind(' ').map_or(0, |space| space + 1);
    !rest.starts_with(|letter: char| letter.is_alphanumeric() || "_/²³".contains(letter))
        && !starts_with_name(&text[last_word..])
}

#[cfg(test)]
mod tests {
    use super::{Words, take};

    fn cart() -> Words {
        let word = |word: &str| Some(word.to_owned());
        Words { position: word("angle"), position_unit: word("deg"), input: word("voltage"), input_unit: word("V") }
    }

    #[test]
    fn a_sentence_is_said_in_the_words_and_units_of_the_rig() {
        let said =
            cart().of("The ball drifts 3 mm at a duty of 2 % of duty: 5.1 mm/s² per percent; height, mm. Position");
        assert_eq!(said, "The angle drifts 3 deg at a voltage of 2 V: 5.1 deg/s² per V; angle, deg. Angle");
        assert_eq!(cart().of("98 % sure, the duty."), "98 % sure, the voltage.");
        assert_eq!(["%", "mm"].map(|unit| cart().unit(unit).to_owned()), ["V", "mm"]);
        let said = cart().of("A ball and a fan: 30 s in free flight, acceleration of the ball over duty");
        assert_eq!(said, "An angle and an actuator: 30 s between the ends, angular acceleration over voltage");
        let said = cart().of("the noise of the air is 3.0 times as strong; most of that belongs to the ball");
        assert_eq!(said, "the random force is 3.0 times as strong; most of that belongs to the moving part");
    }

    #[test]
    fn in_a_page_code_and_scripts_keep_their_words() {
        let page = "<p>The ball</p><code>ball, mm</code><script>position</script><text x=\"1\">duty, %</text>";
        let said = "<p>The angle</p><code>ball, mm</code><script>position</script><text x=\"1\">voltage, V</text>";
        assert_eq!(cart().of_markup(page), said);
    }

    #[test]
    fn words_are_taken_out_of_the_table_of_the_rig_and_a_table_of_nothing_else_is_gone() {
        let mut merged: toml::Table = toml::from_str("[rig]\nposition = \"angle\"\ninput_unit = \"V\"").unwrap();
        let words = take(&mut merged).unwrap();
        assert!(merged.is_empty() && words.position.as_deref() == Some("angle") && !words.is_ball_pipe());
        let mut merged: toml::Table = toml::from_str("[rig]\nposition = 3").unwrap();
        assert_eq!(take(&mut merged).unwrap_err().0, "rig.position");
    }

    #[test]
    fn keys_flags_and_files_keep_their_names_and_a_ball_pipe_all_of_its_words() {
        let text = "position_mm = 3, gain_mm_per_s2_per_percent, duty.csv, logs/ball, mm_x, --duty, ball-and-beam.csv: \
                    see a ball-in-pipe.mcap";
        assert_eq!(cart().of(text), text);
        assert_eq!(cart().of("the duty: `duty / 2`, the column `ball`"), "the voltage: `duty / 2`, the column `ball`");
        assert_eq!(cart().of("the ball. A duty-free ball, 3.5 mm"), "the angle. A voltage-free angle, 3.5 deg");
        assert_eq!(Words::default().of("the ball, 3 mm"), "the ball, 3 mm");
    }
}

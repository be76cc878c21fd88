//! The words of a rig that is no ball in a pipe, where names and units of its columns say them: `[rig]` of its config.
//!
//! A unit is written only where a number as it is read is one of that unit, or of a prefix of it: an angle in rad, read
//! as thousandths, is in mrad. Otherwise the number stays one of mm, or of percent.

use super::names::Name;
use super::roles::Roles;
use super::scales::{Scales, length_mm};
use config::words::Words;
use rows::Sheet;

/// Quantities of a position, by the words of a column's name; a length is none: it is read in mm.
const POSITIONS: &[(&[&str], &str)] = &[
    (&["angle", "winkel", "theta", "phi", "pitch", "roll", "yaw"], "angle"),
    (&["temperature", "temp"], "temperature"),
    (&["level"], "level"),
    (&["displacement", "weg"], "displacement"),
    (&["distance"], "distance"),
    (&["altitude"], "altitude"),
];
/// The same of a unit.
const POSITION_UNITS: &[(&[&str], &str)] =
    &[(&["deg", "°", "rad", "mrad", "rev"], "angle"), (&["°c", "c", "k"], "temperature"), (&["pa", "bar"], "pressure")];
/// Quantities of an input; a duty is none: it is read in percent.
const INPUTS: &[(&[&str], &str)] = &[
    (&["voltage", "volt", "volts", "spannung"], "voltage"),
    (&["torque", "tau", "moment"], "torque"),
    (&["current"], "current"),
    (&["force"], "force"),
    (&["thrust"], "thrust"),
    (&["power", "heater"], "power"),
    (&["valve"], "valve"),
];
/// The same of a unit.
const INPUT_UNITS: &[(&[&str], &str)] = &[
    (&["v", "mv"], "voltage"),
    (&["a", "ma"], "current"),
    (&["nm", "mnm"], "torque"),
    (&["n", "kn"], "force"),
    (&["w", "kw"], "power"),
];
/// How units are written whose small letters say something else.
const WRITTEN: &[(&str, &str)] = &[
    ("v", "V"),
    ("mv", "mV"),
    ("a", "A"),
    ("ma", "mA"),
    ("n", "N"),
    ("nm", "Nm"),
    ("mnm", "mNm"),
    ("kn", "kN"),
    ("w", "W"),
    ("kw", "kW"),
    ("°c", "°C"),
    ("c", "°C"),
    ("k", "K"),
    ("pa", "Pa"),
    ("°", "deg"),
];
/// What a larger number of a smaller unit is called.
const PREFIXES: [(f64, &str); 3] = [(1.0, ""), (1e3, "m"), (1e6, "µ")];

/// Words of a ball in a pipe, in the name of any column. A position in mm and an input in percent are not enough.
const BALL_PIPE: &[&str] =
    &["duty", "fan", "ball", "pipe", "height", "höhe", "hoehe", "altura", "altezza", "hauteur", "tof"];

/// The words that the columns of a table say. None of a ball in a pipe.
pub(super) fn rig_words(sheet: &Sheet, roles: &Roles, scales: &Scales) -> Words {
    let is_ball_pipe = sheet.columns.iter().any(|column| Name::of(column).says(BALL_PIPE));
    // Of any other rig, where its columns say nothing.
    let neutral = |word: &str| (!is_ball_pipe).then(|| word.to_owned());
    let name = |column: &str| sheet.columns.iter().find(|one| one.name == column).map(Name::of);
    let input = name(&roles.input.column).filter(|_| roles.minus.is_none());
    // Of a speed the position is an integral, of which the column says nothing.
    let position = name(&roles.position.column).filter(|_| !roles.is_speed);
    let quantity = |name: &Option<Name>, words, units| {
        let name = name.as_ref()?;
        said(words, |known| name.says(known)).or_else(|| said(units, |known| is_of(name, known)))
    };
    let unit = |name: &Option<Name>, units, scale| {
        let name = name.as_ref()?;
        said(units, |known| is_of(name, known))?;
        scaled(name.unit.as_deref()?, scale)
    };
    Words {
        position: quantity(&position, POSITIONS, POSITION_UNITS).map(str::to_owned).or_else(|| neutral("position")),
        position_unit: unit(&position, POSITION_UNITS, scales.position.scale)
            .or_else(|| length(position.as_ref()?, scales.position.scale)),
        input: quantity(&input, INPUTS, INPUT_UNITS).map(str::to_owned).or_else(|| neutral("input")),
        input_unit: unit(&input, INPUT_UNITS, scales.input.scale),
    }
}

fn said(table: &[(&[&str], &'static str)], is: impl Fn(&[&str]) -> bool) -> Option<&'static str> {
    table.iter().find(|(known, _)| is(known)).map(|(_, word)| *word)
}

fn is_of(name: &Name, units: &[&str]) -> bool {
    name.unit.as_deref().is_some_and(|unit| units.contains(&unit))
}

/// A unit in small letters as it is written.
pub(super) fn written(unit: &str) -> String {
    WRITTEN.iter().find(|(small, _)| *small == unit).map_or(unit, |(_, written)| written).to_owned()
}

/// The unit of a length that is not read in mm, because it is too long or too short for that.
fn length(name: &Name, scale: f64) -> Option<String> {
    let mm = length_mm(name.unit.as_deref()?)? / scale.abs();
    let known = [("nm", 1e-6), ("µm", 1e-3), ("m", 1e3), ("in", 25.4)];
    known.into_iter().find(|(_, own)| (mm / own - 1.0).abs() < 1e-9).map(|(unit, _)| unit.to_owned())
}

/// The unit of a number that was multiplied by `scale`.
fn scaled(unit: &str, scale: f64) -> Option<String> {
    let written = written(unit);
    let (_, prefix) = PREFIXES.iter().find(|(factor, _)| (scale.abs() / factor - 1.0).abs() < 1e-9)?;
    (prefix.is_empty() || !written.starts_with(['m', 'k', '°'])).then(|| format!("{prefix}{written}"))
}

#[cfg(test)]
mod tests {
    use super::super::asked::Asked;
    use super::super::roles::roles;
    use super::super::scales::scales;
    use super::{Words, rig_words};
    use rows::{Sheet, SheetColumn};

    /// The words of a table whose input reaches `input` and whose position spans `position`.
    fn words(names: [(&str, Option<&str>); 3], input: f64, position: f64) -> Words {
        let values = |of: fn(f64) -> f64, size: f64| (0..200).map(|k| Some(size * of(f64::from(k) / 10.0))).collect();
        let columns = [values(|t| t, 1.0), values(f64::sin, input), values(|t| 0.5 - 0.5 * t.cos(), position)];
        let columns = names.into_iter().zip(columns).map(|((name, unit), values)| SheetColumn {
            name: name.into(),
            unit: unit.map(str::to_owned),
            values,
            ..SheetColumn::default()
        });
        let sheet = Sheet { columns: columns.collect(), rows: 200 };
        let found = roles(&sheet, &Asked::default()).unwrap();
        rig_words(&sheet, &found, &scales(&sheet, &found, &Asked::default()))
    }

    #[test]
    fn columns_say_quantities_and_the_units_of_the_numbers_as_they_are_read() {
        let all = |words: Words| [words.position, words.position_unit, words.input, words.input_unit];
        let of = |words: [&str; 4]| words.map(|word| (!word.is_empty()).then(|| word.to_owned()));
        let arm = [("t", None), ("motor_voltage", Some("V")), ("angle_deg", None)];
        assert_eq!(all(words(arm, 24.0, 90.0)), of(["angle", "deg", "voltage", "V"]));
        // Of half a volt a number is in 5 mV, which is no unit; of an angle in rad it is in mrad.
        let arm = [("t", None), ("u [V]", None), ("theta [rad]", None)];
        assert_eq!(all(words(arm, 0.5, 1.5)), of(["angle", "mrad", "voltage", ""]));
        let cart = [("t", None), ("u", Some("V")), ("y", Some("m"))];
        assert_eq!(all(words(cart, 12.0, 0.4)), of(["position", "", "voltage", "V"]));
        // A length that is too long or too short for mm keeps its unit, or has one of its own.
        let drone = [("t", None), ("thrust_N", None), ("altitude_m", None)];
        assert_eq!(all(words(drone, 40.0, 200.0)), of(["altitude", "m", "thrust", "N"]));
        assert_eq!(all(words(cart, 12.0, 0.002)), of(["position", "µm", "voltage", "V"]));
        let pipe = [("time_s", None), ("duty_percent", None), ("position_mm", None)];
        assert!(words(pipe, 40.0, 400.0).is_ball_pipe());
        // A fan that lifts something else than a ball in a pipe is told by its words in `[rig]`.
        assert!(words([("t", None), ("fan_pwm", None), ("y", None)], 1.0, 1.0).is_ball_pipe());
        assert!(words([("t", None), ("Stellgröße [%]", None), ("Höhe [mm]", None)], 40.0, 400.0).is_ball_pipe());
        let nothing = words([("a", None), ("b", None), ("c", None)], 1.0, 1.0);
        assert_eq!(all(nothing), of(["position", "", "input", ""]));
    }
}

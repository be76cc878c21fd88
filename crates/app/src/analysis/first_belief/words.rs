//! Words in the names of columns, by what they say, in English, German and French; lower case.

pub(super) const TIMES: &[&str] =
    &["t", "time", "timestamp", "stamp", "zeit", "seconds", "sec", "elapsed", "clock", "temps"];
pub(super) const INPUTS: &[&str] = &[
    "u",
    "input",
    "duty",
    "pwm",
    "voltage",
    "volt",
    "volts",
    "torque",
    "force",
    "throttle",
    "current",
    "thrust",
    "power",
    "effort",
    "drive",
    "actuation",
    "control",
    "tau",
    "motor",
    "heater",
    "valve",
    "spannung",
    "moment",
    "stellgröße",
    "stellgrösse",
    "stellgroesse",
];
pub(super) const POSITIONS: &[&str] = &[
    "y",
    "x",
    "z",
    "q",
    "position",
    "pos",
    "angle",
    "theta",
    "phi",
    "height",
    "höhe",
    "hoehe",
    "alt",
    "altitude",
    "distance",
    "range",
    "level",
    "displacement",
    "encoder",
    "output",
    "weg",
    "winkel",
    "temperature",
    "temp",
    "pitch",
    "roll",
    "yaw",
];
pub(super) const SPEEDS: &[&str] =
    &["speed", "velocity", "vel", "omega", "rpm", "rate", "tacho", "tachometer", "geschwindigkeit", "drehzahl"];
pub(super) const SETPOINTS: &[&str] =
    &["r", "ref", "reference", "setpoint", "sp", "target", "desired", "goal", "soll", "sollwert"];
/// Setpoint beside another input or of a servo, and else the input.
pub(super) const COMMANDS: &[&str] = &["command", "cmd", "commanded"];

//! What a user says about the columns of a log.

/// What a user says about the columns; `None`: it is guessed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// The column of the time.
    pub time: Option<String>,
    /// Seconds between two rows, where no column holds the time.
    pub period_s: Option<f64>,
    /// Seconds per unit of the time.
    pub time_scale: Option<f64>,
    /// The column of the input.
    pub input: Option<String>,
    /// The column of the position.
    pub position: Option<String>,
    /// The column of a speed, which is integrated to the position.
    pub speed: Option<String>,
    /// The column of the setpoint.
    pub setpoint: Option<String>,
    /// Percent per unit of the input.
    pub input_scale: Option<f64>,
    /// Millimetres per unit of the position.
    pub position_scale: Option<f64>,
    /// Length of the way, mm, between ends at 0 and there.
    pub length_mm: Option<f64>,
}

//! The closed loop in words: the record, the believed model, and the mended one.

use diagnose::{ClosedLoop, Compared};

/// Why only the record has figures.
const NOT_SIMULATED: &str = "(not simulated: neither log nor config holds a controller and its [loop])";

/// A table with a line for each figure that is known for a flight; empty where none is.
#[must_use]
pub fn words(found: &ClosedLoop) -> Vec<String> {
    let mut lines = Vec::new();
    if found.steps > 0 {
        let overshoot = found.overshoot_percent;
        let band = found.settling_band_percent;
        lines.push(line("overshoot", overshoot, overshoot, 0, " %"));
        lines.push(line("first visible peak", found.peak_time_s, overshoot, 2, " s"));
        lines.push(line(&format!("settled to ±{band} %"), found.settling_s, overshoot, 2, " s"));
    }
    let critical = found.critical_gain_ratio;
    let margin = Compared { recorded: None, nominal: critical.nominal, mended: critical.mended };
    if critical.nominal.or(critical.mended).is_some() {
        lines.push(line("gain margin, simulated", margin, margin, 1, " ×"));
    }
    if !lines.is_empty() {
        let head = match found.steps {
            0 => "closed loop".into(),
            steps => format!("closed loop, {steps} steps"),
        };
        lines.insert(0, (head, ["recorded", "as believed", "mended"].map(Into::into)));
    }
    let shown = if is_simulated(found) { WIDTHS.len() } else { 1 };
    let why = (shown == 1 && !lines.is_empty()).then(|| NOT_SIMULATED.to_owned());
    lines.iter().map(|(name, cells)| row(name, &cells[..shown])).chain(why).collect()
}

/// Whether a model has figures too.
#[must_use]
pub const fn is_simulated(found: &ClosedLoop) -> bool {
    let (flown, critical) = (found.overshoot_percent, found.critical_gain_ratio);
    flown.nominal.is_some() || flown.mended.is_some() || critical.nominal.is_some() || critical.mended.is_some()
}

/// Widths of the columns behind the name.
const WIDTHS: [usize; 3] = [10, 13, 10];

/// A figure of the flights in `flew`. "none": there was a flight, and it has no such figure.
fn line(name: &str, of: Compared, flew: Compared, digits: usize, unit: &str) -> (String, [String; 3]) {
    let cell = |value: Option<f64>, flew: Option<f64>| match (value, flew) {
        (Some(value), _) => format!("{value:.digits$}{unit}"),
        (None, Some(_)) => "none".into(),
        (None, None) => "–".into(),
    };
    let cells = [cell(of.recorded, flew.recorded), cell(of.nominal, flew.nominal), cell(of.mended, flew.mended)];
    (name.to_owned(), cells)
}

fn row(name: &str, cells: &[String]) -> String {
    let cells = cells.iter().zip(WIDTHS).map(|(cell, width)| format!("{cell:>width$}"));
    format!("{name:<26}{}", cells.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::words;
    use diagnose::{ClosedLoop, Compared, Simulated};

    #[test]
    fn what_is_not_known_has_a_dash_and_what_a_flight_does_not_have_is_none() {
        let overshoot_percent = Compared { recorded: Some(12.0), ..Compared::default() };
        let found = ClosedLoop {
            steps: 3,
            overshoot_percent,
            peak_time_s: Compared::default(),
            settling_band_percent: 5.0,
            settling_s: Compared::default(),
            critical_gain_ratio: Simulated::default(),
        };
        let lines = [
            "closed loop, 3 steps        recorded",
            "overshoot                       12 %",
            "first visible peak              none",
            "settled to ±5 %                 none",
            super::NOT_SIMULATED,
        ];
        assert_eq!(words(&found), lines);
        let overshoot_percent = Compared { nominal: Some(9.0), ..overshoot_percent };
        let lines = [
            "closed loop, 3 steps        recorded  as believed    mended",
            "overshoot                       12 %          9 %         –",
            "first visible peak              none         none         –",
            "settled to ±5 %                 none         none         –",
        ];
        assert_eq!(words(&ClosedLoop { overshoot_percent, ..found }), lines);
        assert!(words(&ClosedLoop { steps: 0, ..found }).is_empty());
    }
}

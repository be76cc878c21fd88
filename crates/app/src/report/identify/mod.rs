//! An identification: as words, as a document (`airball.identify/1`), and as a config patch.

pub mod grey_box;
pub mod page;
pub mod plot;
pub mod third_pole;
pub mod transient;

use crate::report::kit::patch::rounded;
use crate::report::kit::words::digits;
use diagnose::identify::ParameterEstimate;
use plant::Model;
use std::fmt::Write;

/// The document's name and version.
const SCHEMA: &str = "airball.identify/1";
const LAG: &str = "fan_lag.time_constant_s";

/// The estimates as a patch over the config of the model `start`. A lag that the config has and the estimates do not is
/// set to 0, which means none.
#[must_use]
pub fn patch(origin: &str, estimates: &[ParameterEstimate], start: &Model) -> String {
    let mut patch = format!("# {origin}; 90 % intervals.\n[plant]\n");
    let (lags, base): (Vec<&ParameterEstimate>, Vec<&ParameterEstimate>) =
        estimates.iter().partition(|estimate| estimate.name == LAG);
    for estimate in base {
        // Writing to a string cannot fail.
        let _ = writeln!(patch, "{} = {:?}{}", estimate.name, estimate.value, between(estimate));
    }
    match lags.first() {
        Some(lag) => {
            let _ = writeln!(patch, "\n[plant.effects.fan_lag]\ntime_constant_s = {:?}{}", lag.value, between(lag));
        }
        None if start.effects.fan_lag_s().is_some() => {
            patch += "\n[plant.effects.fan_lag]\ntime_constant_s = 0.0  # two poles: the fan is not one of them\n";
        }
        None => {}
    }
    rounded(&patch)
}

fn between(estimate: &ParameterEstimate) -> String {
    match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => format!("  # {} to {}", digits(low), digits(high)),
        _ => "  # the record does not bound it".into(),
    }
}

/// The value with its interval.
pub(super) fn said(estimate: &ParameterEstimate) -> String {
    let end = |end: Option<f64>| end.map_or_else(|| "?".into(), digits);
    format!("{} ({} to {})", digits(estimate.value), end(estimate.low), end(estimate.high))
}

/// A parameter of a model in words: name with unit.
pub(super) fn name(key: &str) -> &str {
    match key {
        "gain_mm_per_s2_per_percent" => "gain, mm/s² per %",
        "gain_mm_per_s2_per_control" => "gain, mm/s² per control value",
        "drag_per_s" => "drag, 1/s",
        "hover_control" => "hover, control value",
        "hover_duty_percent" => "hover, %",
        LAG => "fan's lag, s",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::{digits, patch};
    use crate::analysis::closed_loop::tests::project;
    use config::Tables;
    use diagnose::identify::ParameterEstimate;

    fn estimate(name: &'static str, value: f64) -> ParameterEstimate {
        ParameterEstimate { name, value, low: Some(0.9 * value), high: Some(1.1 * value) }
    }

    #[test]
    fn a_patch_of_two_poles_takes_the_lag_out_and_one_of_three_sets_it() {
        let start = project().plant.unwrap();
        let two = [estimate("gain_mm_per_s2_per_percent", 254.598), estimate("drag_per_s", 1.889)];
        let three = [two[0], two[1], estimate("fan_lag.time_constant_s", 0.2)];
        let lag = |estimates: &[ParameterEstimate]| {
            let table: toml::Table = toml::from_str(&patch("a test", estimates, &start)).unwrap();
            let plant = table["plant"].as_table().unwrap();
            assert_eq!(plant["drag_per_s"].as_float(), Some(1.889));
            plant["effects"]["fan_lag"]["time_constant_s"].as_float()
        };
        assert_eq!((lag(&two), lag(&three)), (Some(0.0), Some(0.2)));
        let none =
            Tables::default().plant.unwrap_or(plant::Model { effects: plant::Effects::default(), ..start.clone() });
        assert!(!patch("a test", &two, &none).contains("fan_lag"));
    }

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!(
            [827.23, 3.8964, 0.25712, 21.40123, 0.0, 12345.6].map(digits),
            ["827.2", "3.896", "0.2571", "21.40", "0", "12346"]
        );
    }
}

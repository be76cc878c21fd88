//! The closed loop in words: the record, the believed model, and the mended one.

use diagnose::{ClosedLoop, Compared};

/// A line on the steps and one on stability, each only where it is known.
#[must_use]
pub fn words(found: &ClosedLoop) -> Vec<String> {
    let mut lines = Vec::new();
    if found.steps > 0 {
        let (band, overshoot) = (found.settling_band_percent, found.overshoot_percent);
        lines.push(format!(
            "closed loop, medians of {} steps: overshoot {}; first peak {}; settled to ±{band} %: {}",
            found.steps,
            three(overshoot, overshoot, 0, "%", ""),
            three(found.peak_time_s, overshoot, 2, "s", "none"),
            three(found.settling_s, overshoot, 2, "s", "not"),
        ));
    }
    let critical = found.critical_gain_ratio;
    if let Some(nominal) = critical.nominal {
        let mended = critical.mended.map_or(String::new(), |mended| format!(", {mended:.1} times mended"));
        lines.push(format!("the loop loses stability at {nominal:.1} times its gain as believed{mended}"));
    } else if let Some(mended) = critical.mended {
        lines.push(format!("the loop loses stability at {mended:.1} times its gain mended"));
    }
    lines
}

/// A quantity of the flights that have an overshoot; `absent` is the text for a flight without this quantity.
fn three(of: Compared, flew: Compared, digits: usize, unit: &str, absent: &str) -> String {
    let say = |value: Option<f64>, flew: Option<f64>, who: &str| {
        flew?;
        Some(value.map_or(format!("{absent} {who}"), |value| format!("{value:.digits$} {unit} {who}")))
    };
    let words = [
        say(of.recorded, flew.recorded, "recorded"),
        say(of.nominal, flew.nominal, "as believed"),
        say(of.mended, flew.mended, "mended"),
    ];
    words.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::words;
    use diagnose::{ClosedLoop, Compared, Simulated};

    #[test]
    fn what_is_not_known_is_not_said() {
        let overshoot_percent = Compared { recorded: Some(12.0), ..Compared::default() };
        let found = ClosedLoop {
            steps: 3,
            overshoot_percent,
            peak_time_s: Compared::default(),
            settling_band_percent: 5.0,
            settling_s: Compared::default(),
            critical_gain_ratio: Simulated::default(),
        };
        let line = "closed loop, medians of 3 steps: overshoot 12 % recorded; first peak none recorded; \
                    settled to ±5 %: not recorded";
        assert_eq!(words(&found), [line]);
        assert!(words(&ClosedLoop { steps: 0, ..found }).is_empty());
    }
}

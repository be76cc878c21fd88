//! The summary of a flight: a few lines of text.

use super::signals::Signals;
use crate::analysis::closed_loop::median;
use crate::analysis::step_response::{Step, steps};
use crate::flight::deadline::Punctuality;
use crate::flight::vocabulary::Cycle;
use serde::Serialize;
use std::fmt;

/// The metrics of a flight. Numbers are `null` in JSON where the flight has none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Name and version of this document.
    pub schema: &'static str,
    /// Length of the flight, seconds.
    pub duration_s: f64,
    /// Control cycles, and their lateness.
    #[serde(flatten)]
    pub punctuality: Option<Punctuality>,
    /// Rows of the log.
    pub logged_cycles: usize,
    /// Rows whose position was measured anew.
    pub fresh_percent: f64,
    /// Jumps of the setpoint.
    pub steps: usize,
    /// Median of the overshoots, percent of the jump.
    pub overshoot_percent: Option<f64>,
    /// Median of the settling times of the steps that settled, seconds.
    pub settling_s: Option<f64>,
    /// Steps that did not settle before the next.
    pub unsettled: usize,
    /// Root mean square of position minus setpoint, mm.
    pub rms_error_mm: Option<f64>,
    /// The same, only where a step had settled.
    pub rms_settled_mm: Option<f64>,
    /// The observer's test ratios, if there was an observer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub innovations: Option<Innovations>,
    /// The signals besides the position, if there were any.
    #[serde(flatten)]
    pub signals: Signals,
}

/// Readings by the observer's test ratio.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Innovations {
    /// To 0.5: as expected, percent.
    pub expected_percent: f64,
    /// To 1.0: doubtful, percent.
    pub doubtful_percent: f64,
    /// Above: refused as outliers, percent.
    pub refused_percent: f64,
}

impl Innovations {
    fn of(ratios: impl Iterator<Item = f64>) -> Option<Self> {
        let [mut expected, mut doubtful, mut refused] = [0.0_f64; 3];
        for ratio in ratios {
            let band = if ratio <= 0.5 {
                &mut expected
            } else if ratio <= 1.0 {
                &mut doubtful
            } else {
                &mut refused
            };
            *band += 1.0;
        }
        let percent = 100.0 / (expected + doubtful + refused);
        percent.is_finite().then_some(Self {
            expected_percent: percent * expected,
            doubtful_percent: percent * doubtful,
            refused_percent: percent * refused,
        })
    }
}

impl Summary {
    /// Computes the summary of the cycles of a log. `punctuality` is known only of a flight that has just ended.
    #[must_use]
    pub fn of(cycles: &[Cycle], punctuality: Option<Punctuality>) -> Self {
        let steps = steps(cycles);
        let settled: Vec<f64> = steps.iter().filter_map(|step| step.settling_s).collect();
        let (first, last) = (cycles.first(), cycles.last());
        let fresh = cycles.iter().filter(|cycle| cycle.fresh).count();
        Self {
            schema: "airball.flight/1",
            duration_s: first.zip(last).map_or(0.0, |(first, last)| last.time_s - first.time_s),
            punctuality,
            logged_cycles: cycles.len(),
            fresh_percent: 100.0 * fresh as f64 / cycles.len().max(1) as f64,
            overshoot_percent: median(steps.iter().map(|step| Some(step.overshoot_percent))),
            unsettled: steps.len() - settled.len(),
            settling_s: median(settled.into_iter().map(Some)),
            rms_error_mm: rms(cycles.iter().filter_map(error)),
            rms_settled_mm: rms(cycles.iter().filter(|cycle| is_settled(cycle, &steps)).filter_map(error)),
            innovations: Innovations::of(cycles.iter().filter_map(|cycle| cycle.innovation_test_ratio)),
            signals: Signals::of(cycles),
            steps: steps.len(),
        }
    }
}

fn error(cycle: &Cycle) -> Option<f64> {
    Some(cycle.position_mm? - cycle.setpoint_mm?)
}

/// Whether the step that `cycle` belongs to had settled by then.
fn is_settled(cycle: &Cycle, steps: &[Step]) -> bool {
    let current = steps.iter().rev().find(|step| step.time_s <= cycle.time_s);
    current.is_some_and(|step| step.settling_s.is_some_and(|settling_s| cycle.time_s >= step.time_s + settling_s))
}

fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    (count > 0.0).then(|| (sum / count).sqrt())
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "flight    {:.1} s, {} cycles", self.duration_s, self.logged_cycles)?;
        if let Some(p) = self.punctuality {
            write!(f, ", {} late (worst {:.1} ms), {} missed", p.late, 1e3 * p.worst_s, p.missed)?;
        }
        writeln!(f, "; {:.1} % with a fresh position", self.fresh_percent)?;
        if let Some(late) = self.punctuality.filter(|punctuality| punctuality.worst_s > 0.0) {
            writeln!(f, "lateness  {}", late.lateness)?;
        }
        if let (Some(overshoot), steps) = (self.overshoot_percent, self.steps) {
            write!(f, "steps     {steps}: overshoot {overshoot:.0} %")?;
            if let Some(settling_s) = self.settling_s {
                write!(f, ", settled to ±5 % in {settling_s:.2} s")?;
            }
            write!(f, "{}", if steps > 1 { " (medians)" } else { "" })?;
            let unsettled = self.unsettled;
            writeln!(f, "{}", if unsettled == 0 { String::new() } else { format!("; {unsettled} did not settle") })?;
        }
        match (self.rms_error_mm, self.rms_settled_mm) {
            (Some(all), Some(settled)) => writeln!(f, "error     rms {all:.1} mm, {settled:.1} mm once settled"),
            (Some(all), None) => writeln!(f, "error     rms {all:.1} mm"),
            _ => writeln!(f, "error     none: the controller was off"),
        }?;
        if let Some(Innovations { expected_percent, doubtful_percent, refused_percent }) = self.innovations {
            writeln!(
                f,
                "observer  {expected_percent:.1} % of the readings as expected, {doubtful_percent:.1} % doubtful, {refused_percent:.1} % refused"
            )?;
        }
        write!(f, "{}", self.signals)
    }
}

#[cfg(test)]
mod tests {
    use super::Innovations;

    #[test]
    fn readings_are_counted_by_the_bands_of_their_test_ratio() {
        let got = Innovations::of([0.0, 0.5, 0.6, 1.0, 1.1].into_iter()).unwrap();
        let Innovations { expected_percent, doubtful_percent, refused_percent } = got;
        assert_eq!([expected_percent, doubtful_percent, refused_percent], [40.0, 40.0, 20.0]);
        assert_eq!(Innovations::of(std::iter::empty()), None);
    }
}

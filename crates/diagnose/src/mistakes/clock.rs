//! Times in another unit: the record is that of the believed plant with its clock turned by a factor.
//!
//! ```text
//! t' = s·t:   gain/s²,  drag/s,  lag·s;   hover stays
//! ```
//!
//! Milliseconds and the like are found by their rows (`SlowRows`); ten times too slow or too fast a clock leaves rows
//! that could be some rig's, and then effects are named that make it sluggish or quick.

use super::SEEN;
use crate::linear::{LinearFit, linear_fit_at};
use crate::record::check::Finding;
use crate::record::recording::Recording;
use crate::record::units::OTHER_HOVER;
use plant::Model;

/// Clocks that are tried: powers of ten, and minutes for seconds or hours for minutes, either way round.
const CLOCKS: [f64; 8] = [10.0, 100.0, 1e3, 60.0, 0.1, 1e-2, 1e-3, 1.0 / 60.0];
/// Rows of a rig are so far apart, seconds: with another clock they would not be.
const ROWS_S: [f64; 2] = [1e-3, 0.3];
/// The gain must be the believed one within this factor, once the clock is right.
const GAIN: f64 = 3.0;
/// The record must be likelier by so many nats than with the clock as it is. None of the 240 records of `tests/blind` is
/// refused by these limits.
const BETTER: f64 = 20.0;

/// The finding about a clock with which the believed plant fits; `fit` is the plant with the clock as it is.
pub(super) fn other_clock(belief: &Model, fit: &LinearFit, recording: &Recording) -> Option<Finding> {
    let lag_s = belief.effects.fan_lag_s().unwrap_or_default();
    let apart_s = recording.duration_s() / recording.samples().len() as f64;
    let usual = |clock: &f64| (ROWS_S[0]..ROWS_S[1]).contains(&(apart_s / clock));
    let tried = CLOCKS.into_iter().filter(usual).filter_map(|clock| {
        let at = linear_fit_at(recording, belief.drag_per_s / clock, lag_s * clock)?;
        let gain = at.gain * clock * clock / belief.gain_mm_per_s2_per_percent;
        let hover = at.hover / belief.hover_duty_percent;
        let fits = at.gain_in_deviations > SEEN && gain.ln().abs() < GAIN.ln() && hover.ln().abs() < OTHER_HOVER.ln();
        (fits && at.log_likelihood > fit.log_likelihood + BETTER).then_some((clock, at.log_likelihood))
    });
    let (clock, _) = tried.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Finding::TimeUnit { scale: clock.recip() })
}

#[cfg(test)]
mod tests {
    use crate::mistakes::mistakes;
    use crate::tests_support::{model, record};
    use crate::{Finding, Recording};

    fn on_a_clock(clock: f64) -> Vec<Finding> {
        let mut rows = record(&model(), 6, 40).samples().to_vec();
        rows.iter_mut().for_each(|row| row.time_s *= clock);
        let found = mistakes(&model(), &[Recording::new(rows).unwrap()]);
        found.into_iter().map(|noted| noted.finding).collect()
    }

    #[test]
    fn a_clock_that_is_ten_times_too_slow_or_too_fast_is_named_with_its_scale() {
        assert_eq!(on_a_clock(1.0), []);
        for clock in [10.0, 0.1, 0.01] {
            let found = on_a_clock(clock);
            let said = |scale: f64| (scale * clock - 1.0).abs() < 1e-9;
            assert!(matches!(found[..], [Finding::TimeUnit { scale }] if said(scale)), "{clock}: {found:?}");
        }
    }
}

//! Which readings are new, where a model has a sensor that refreshes slower than the loop reads.
//!
//! ```text
//! F(e) = (e − hold + period)/period, 0 to 1     probability of a refresh by e seconds after the last new reading's row
//! h = (F(e) − F(e'))/(1 − F(e'))                and since the row before, at e', given none until then
//! p(y) = h·p_new(y) + (1 − h)/r·[y equals the last reading]      r: resolution of the file
//! ```
//!
//! The time of the last refresh within a row's period is unknown, hence the ramp; it is widened by the clocks' jitter.
//! A reading that equals the last one counts as a repeat, and updates no filter, until the refresh is overdue, F = 1.
//! The clock alone decides this, never p_new: if each model chose its own readings, models would differ at random by
//! more nats than an effect gains.

use plant::Model;

/// Jitter of the clocks: shares of the hold and of the period.
const HOLD_WANDERS: f64 = 0.05;
const PERIOD_WANDERS: f64 = 0.1;
/// Smallest and largest probability of a refresh: never 0, never 1.
const EARLIEST: f64 = 1e-5;
const LATEST: f64 = 0.98;

/// The last reading of a slow sensor, and when it was new.
#[derive(Clone, Debug)]
pub(crate) struct Refresh {
    hold_s: f64,
    period_s: f64,
    new_s: f64,
    before_s: f64,
    last_mm: f64,
}

impl Refresh {
    /// The sensor of `model`, if it is slow, after its first reading.
    pub(crate) fn of(model: &Model, period_s: f64, time_s: f64, reading_mm: f64) -> Option<Self> {
        let hold_s = model.effects.hold()?.hold_s;
        (hold_s > 0.0).then_some(Self { hold_s, period_s, new_s: time_s, before_s: time_s, last_mm: reading_mm })
    }

    /// The probability that the sensor has refreshed since the row before.
    pub(crate) fn chance(&self, time_s: f64) -> f64 {
        let (before, now) = (self.refreshed(self.before_s), self.refreshed(time_s));
        ((now - before) / (1.0 - before).max(EARLIEST)).clamp(EARLIEST, LATEST)
    }

    fn refreshed(&self, time_s: f64) -> f64 {
        let wander_s = HOLD_WANDERS * self.hold_s + PERIOD_WANDERS * self.period_s;
        let earliest_s = self.new_s + self.hold_s - self.period_s - wander_s;
        ((time_s - earliest_s) / (self.period_s + 2.0 * wander_s)).clamp(0.0, 1.0)
    }

    /// Whether a reading equals the last one.
    pub(crate) fn is_same(&self, reading_mm: f64) -> bool {
        reading_mm == self.last_mm
    }

    /// Whether the sensor must have refreshed, so that even an equal reading is a new one.
    pub(crate) fn is_overdue(&self, time_s: f64) -> bool {
        self.refreshed(time_s) >= 1.0
    }

    /// Updates the state after a row whose reading was `new`, or a repeat.
    pub(crate) fn go_on(&mut self, time_s: f64, reading_mm: f64, new: bool) {
        if new {
            // A refresh that gives the same reading again is noticed late.
            let late_s = if self.is_same(reading_mm) { (time_s - self.new_s) % self.hold_s } else { 0.0 };
            (self.new_s, self.last_mm) = (time_s - late_s, reading_mm);
        }
        self.before_s = time_s;
    }
}

#[cfg(test)]
mod tests {
    use super::Refresh;
    use crate::filter::track::{Track, innovations};
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};
    use plant::effects::{SensorQuantisation, StaleSamples};
    use plant::{Effects, Model};

    /// A flight whose readings are held for `rows` rows and rounded to a step.
    fn held(rows: usize, step_mm: f64) -> Recording {
        let good = record(&model(), 1, 20);
        let round = |mm: f64| (mm / step_mm).round() * step_mm;
        let held = good.samples().iter().enumerate();
        let held = held.map(|(k, s)| Sample { position_mm: good.samples()[k - k % rows].position_mm.map(round), ..*s });
        Recording::new(held.collect()).unwrap()
    }

    fn slow(hold_s: f64) -> Model {
        Model { effects: Effects { stale_samples: Some(StaleSamples { hold_s }), ..model().effects }, ..model() }
    }

    fn nats(model: &Model, recording: &Recording) -> f64 {
        innovations(model, recording).iter().map(|innovation| innovation.log_density).sum()
    }

    #[test]
    fn held_readings_are_repeats_in_fine_and_in_coarse_files() {
        for step_mm in [0.01, 1.0] {
            let recording = held(5, step_mm);
            let found = Track::new(&slow(0.1), &recording).readings();
            assert!(found.abs_diff(200) <= 2, "{found} of 200 in steps of {step_mm} mm");
            assert_eq!(Track::new(&model(), &recording).readings(), 1000);
        }
    }

    #[test]
    fn the_hold_that_a_record_has_is_the_likeliest() {
        let recording = held(5, 1.0);
        let [nats, shorter, longer] = [0.1, 0.085, 0.115].map(|hold_s| nats(&slow(hold_s), &recording));
        assert!(nats > shorter + 20.0 && nats > longer + 20.0);
    }

    #[test]
    fn coarse_readings_that_are_held_are_likeliest_with_the_hold_and_their_step() {
        let recording = held(5, 12.0);
        let nats_of = |hold_s: f64, step_mm: f64| {
            let mut model = slow(hold_s);
            model.effects.sensor_quantisation = (step_mm > 0.0).then_some(SensorQuantisation { step_mm });
            nats(&model, &recording)
        };
        let [neither, step, hold, both] =
            [(0.0, 0.0), (0.0, 12.0), (0.1, 0.0), (0.1, 12.0)].map(|(h, s)| nats_of(h, s));
        assert!(both > step.max(hold) + 100.0 && hold > neither + 1000.0, "{neither} {step} {hold} {both} nats");
    }

    #[test]
    fn every_model_of_a_slow_sensor_takes_the_same_readings() {
        let recording = held(5, 1.0);
        let other = Model { hover_duty_percent: 21.0, gain_mm_per_s2_per_percent: 400.0, ..slow(0.1) };
        let rows = |model: &Model| {
            let track = Track::new(model, &recording);
            (0..track.readings()).map(|k| track.reading(k).unwrap().0).collect::<Vec<_>>()
        };
        assert_eq!(rows(&slow(0.1)), rows(&other));
    }

    #[test]
    fn a_refresh_that_shows_the_same_number_again_does_not_put_off_the_next() {
        let mut refresh = Refresh::of(&slow(0.1), 0.02, 0.0, 1.0).unwrap();
        let overdue: Vec<bool> = [0.06, 0.1, 0.12].map(|time_s| refresh.is_overdue(time_s)).to_vec();
        assert_eq!(overdue, [false, false, true]);
        refresh.go_on(0.12, 1.0, true);
        assert!(refresh.chance(0.195) > 0.5, "{}", refresh.chance(0.195));
    }

    #[test]
    fn a_refresh_is_sure_to_have_come_once_the_hold_is_over_and_not_before() {
        let refresh = Refresh::of(&slow(0.1), 0.02, 0.0, 1.0).unwrap();
        assert!(refresh.chance(0.06) < 1e-4 && refresh.chance(0.12) > 0.9);
        assert!((refresh.chance(0.09) - 0.5).abs() < 1e-9);
        assert!(Refresh::of(&model(), 0.02, 0.0, 1.0).is_none());
    }
}

//! Which readings are new, where a model believes that the sensor refreshes slower than the loop reads.
//!
//! When the refreshes fall is not known, only how far apart they are: n = hold/period rows. Fewer than ⌊n⌋ rows after a new reading
//! the sensor cannot have refreshed, so that the reading must be the same; from then on it counts as new. Readings that are
//! the same by chance thus earn such a model nothing, and each one that differs too early costs it dear.

use crate::recording::Recording;
use plant::Model;

/// What a row's reading is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// There is none.
    Absent,
    /// A new measurement.
    Fresh,
    /// The last measurement once more.
    Repeat,
    /// Another number although the sensor cannot have refreshed.
    TooEarly,
}

/// What each row's reading is in the eyes of `model`.
pub(crate) fn arrivals(model: &Model, recording: &Recording) -> Vec<Arrival> {
    let samples = recording.samples();
    let hold_s = model.effects.stale_samples.map_or(0.0, |stale| stale.hold_s);
    let period_s = recording.duration_s() / samples.len() as f64;
    // A tenth of a row for the jitter of the clock; half a row, because rows are compared by their times.
    let silent_s = ((hold_s / period_s + 0.1).floor() - 0.5) * period_s;
    let mut last: Option<(f64, f64)> = None;
    let arrival = |(time_s, reading): (f64, Option<f64>)| {
        let Some(reading) = reading else { return Arrival::Absent };
        let arrival = match last {
            Some((fresh_s, before)) if time_s - fresh_s < silent_s => {
                if reading == before {
                    Arrival::Repeat
                } else {
                    Arrival::TooEarly
                }
            }
            _ => Arrival::Fresh,
        };
        if arrival != Arrival::Repeat {
            last = Some((time_s, reading));
        }
        arrival
    };
    samples.iter().map(|sample| (sample.time_s, sample.position_mm)).map(arrival).collect()
}

#[cfg(test)]
mod tests {
    use super::{Arrival, arrivals};
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};
    use plant::effects::StaleSamples;
    use plant::{Effects, Model};

    #[test]
    fn held_readings_are_repeats_and_without_the_effect_all_are_new() {
        let good = record(&model(), 1, 10);
        let held = good.samples().iter().enumerate();
        let held = held.map(|(k, s)| Sample { position_mm: good.samples()[k - k % 5].position_mm, ..*s }).collect();
        let held = Recording::new(held).unwrap();
        let stale = Effects { stale_samples: Some(StaleSamples { hold_s: 0.1 }), ..model().effects };
        let found = arrivals(&Model { effects: stale.clone(), ..model() }, &held);
        let wanted = |k: usize| if k.is_multiple_of(5) { Arrival::Fresh } else { Arrival::Repeat };
        assert!(found.iter().enumerate().all(|(k, arrival)| *arrival == wanted(k)), "{found:?}");
        assert!(arrivals(&model(), &held).iter().all(|arrival| *arrival == Arrival::Fresh));
        let early = arrivals(&Model { effects: stale, ..model() }, &good);
        assert!(early.iter().filter(|arrival| **arrival == Arrival::TooEarly).count() > 100);
    }
}

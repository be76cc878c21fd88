//! The speed of the ball in a record.

use crate::record::recording::Recording;
use crate::stats::quantile::quantile;

/// Time over which a speed is measured, seconds: long beside the noise of the readings, short beside a manoeuvre.
/// Chosen by hand.
const OVER_S: f64 = 0.3;

/// The quantile of the speeds that is the usual one: most rigs rest for a part of a record. Chosen by hand.
const USUAL: f64 = 0.75;

/// The speed that a quarter of the readings exceeds, mm/s; 0 where nothing moves.
pub(crate) fn usual_speed(recording: &Recording) -> f64 {
    *recording.known_speed().get_or_init(|| measured(recording))
}

fn measured(recording: &Recording) -> f64 {
    let samples = recording.samples();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of readings")]
    let apart = (OVER_S / recording.mean_reading_period_s()).ceil().max(1.0) as usize;
    // A time column in a wrong unit has more readings in this time than can be counted.
    let window = apart.saturating_add(1);
    let speed = |pair: &[usize]| {
        let [first, last] = [&samples[pair[0]], &samples[pair[pair.len() - 1]]];
        Some((last.position_mm? - first.position_mm?).abs() / (last.time_s - first.time_s))
    };
    let of_flight = |readings: &[usize]| readings.windows(window).filter_map(speed).collect::<Vec<_>>();
    let flights = recording.flights().iter().flat_map(|flight| of_flight(recording.readings_of(flight)));
    let mut speeds: Vec<f64> = flights.filter(|speed| speed.is_finite()).collect();
    speeds.sort_by(f64::total_cmp);
    if speeds.is_empty() { 0.0 } else { quantile(&speeds, USUAL) }
}

#[cfg(test)]
mod tests {
    use super::usual_speed;
    use crate::{Recording, Sample};

    #[test]
    fn the_usual_speed_is_that_of_the_moving_ball() {
        // At rest for half of the time, then 40 mm/s.
        let row = |k: u32| {
            let time_s = 0.02 * f64::from(k);
            let position_mm = Some(40.0 * (time_s - 10.0).max(0.0));
            Sample { time_s, position_mm, ..Sample::default() }
        };
        let recording = Recording::new((0..1000).map(row).collect()).unwrap();
        assert!((usual_speed(&recording) - 40.0).abs() < 1e-6);
        let still = Recording::new((0..100).map(|k| Sample { position_mm: Some(1.0), ..row(k) }).collect()).unwrap();
        assert_eq!(usual_speed(&still), 0.0);
        let at_once = |k| Sample { time_s: 1e-300 * f64::from(k), ..row(k) };
        assert_eq!(usual_speed(&Recording::new((0..100).map(at_once).collect()).unwrap()), 0.0);
    }
}

//! Optional parameters of an effect, such as the speed over which friction builds up: an effect that has some is fitted
//! with them and without, and the form that forecasts better is its candidate.

use crate::fit::estimate::Fit;
use crate::record::recording::Recording;
use crate::select::screening::{COST_OF_A_NUMBER, Screened, added};
use crate::select::search::Search;
use crate::stats::quantile::quantile;

/// Initial transition of friction, as a share of the speed that a quarter of the readings exceeds. Chosen, not fitted: a
/// fit may move it.
const SHARE_OF_SPEED: f64 = 0.1;
/// Time over which a speed is measured, seconds: long beside the noise of the readings, short beside a manoeuvre.
const OVER_S: f64 = 0.3;
/// Slowest initial transition, mm/s, where nothing moves.
const SLOWEST_MM_PER_S: f64 = 0.1;

/// The values of an effect in its simple form with initial values of the optional parameters.
pub(crate) fn with_optional(simple: &[f64], recording: &Recording) -> Vec<f64> {
    let transition = (SHARE_OF_SPEED * usual_speed(recording)).max(SLOWEST_MM_PER_S);
    simple.iter().copied().chain([transition]).collect()
}

/// The starts of the promising effects in the form that was not screened as the better one.
pub(crate) fn other_forms(search: &Search<'_>, promising: &[&Screened], so_far: &Fit) -> Vec<Screened> {
    promising.iter().filter_map(|one| other_form(search, one, so_far)).collect()
}

fn other_form(search: &Search<'_>, one: &Screened, so_far: &Fit) -> Option<Screened> {
    let entry = one.entry;
    let values = one.model.effects.values(entry.name).filter(|_| entry.optional > 0)?;
    let simple = entry.params.len() - entry.optional;
    let other = if values.len() > simple {
        values[..simple].to_vec()
    } else {
        with_optional(&values, search.problem.recording)
    };
    let mut base = one.model.clone();
    base.effects.remove(entry.name);
    let (model, parameters) = added(&base, &so_far.parameters, entry, &other)?;
    let cost = one.cost + COST_OF_A_NUMBER * (other.len() as f64 - values.len() as f64);
    Some(Screened { model, parameters, cost, rivals: Vec::new(), ..one.clone() })
}

/// The speed that a quarter of the readings exceeds, mm/s.
pub(crate) fn usual_speed(recording: &Recording) -> f64 {
    let samples = recording.samples();
    let of_flight = |readings: &[usize]| {
        let of = |pair: &[usize]| {
            let [first, last] = [&samples[pair[0]], &samples[pair[pair.len() - 1]]];
            Some((last.position_mm? - first.position_mm?).abs() / (last.time_s - first.time_s))
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of readings")]
        let apart = (OVER_S / recording.mean_reading_period_s()).ceil().max(1.0) as usize;
        readings.windows(apart + 1).filter_map(of).collect::<Vec<_>>()
    };
    let flights = recording.flights().iter().flat_map(|flight| of_flight(recording.readings_of(flight)));
    let mut speeds: Vec<f64> = flights.filter(|speed| speed.is_finite()).collect();
    speeds.sort_by(f64::total_cmp);
    if speeds.is_empty() { 0.0 } else { quantile(&speeds, 0.75) }
}

#[cfg(test)]
mod tests {
    use super::{usual_speed, with_optional};
    use crate::{Recording, Sample};

    #[test]
    fn a_transition_begins_at_a_tenth_of_the_speed_that_a_quarter_of_the_readings_exceeds() {
        // At rest for half of the time, then 40 mm/s.
        let row = |k: u32| {
            let time_s = 0.02 * f64::from(k);
            let position_mm = Some(40.0 * (time_s - 10.0).max(0.0));
            Sample { time_s, position_mm, ..Sample::default() }
        };
        let recording = Recording::new((0..1000).map(row).collect()).unwrap();
        assert!((usual_speed(&recording) - 40.0).abs() < 1e-6);
        assert!((with_optional(&[20.0], &recording)[1] - 4.0).abs() < 1e-6);
        let still = Recording::new((0..100).map(|k| Sample { position_mm: Some(1.0), ..row(k) }).collect()).unwrap();
        assert_eq!(with_optional(&[20.0], &still), [20.0, 0.1]);
    }
}

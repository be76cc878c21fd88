//! Initial values for a constant force that appears at one moment: the moment after which a force explains most.
//!
//! Its integrals are known in closed form: D∬f = D(max(0, t − at)²/2).

use crate::record::recording::Recording;
use crate::select::regression::{
    Difference, HORIZONS_S, Integrals, Sums, differences, integrals, second_difference, with_base,
};
use plant::{Entry, Model};

/// The number of moments that are tried over the record, and then about the best of them: every second of a minute, and
/// then every tenth of a second. Chosen by hand.
pub(crate) const MOMENTS: u32 = 60;
const NEAR: u32 = 20;
/// Of more equations some are left out, evenly, since neighbours share their readings: those of 3 minutes at 50 Hz.
const MOST_EQUATIONS: usize = 10_000;

/// See [`super::regressed`].
pub(super) fn regressed(entry: &Entry, model: &Model, belief: &Model, recording: &Recording) -> Vec<Model> {
    let flights: Vec<Vec<Integrals>> =
        recording.flights().iter().map(|flight| integrals(recording, flight, |_| Vec::new())).collect();
    // A load is seen by what it does for long.
    let horizon_s = HORIZONS_S[HORIZONS_S.len() - 1];
    let all: Vec<Difference> = flights.iter().flat_map(|rows| differences(rows, horizon_s)).collect();
    let longest_s = all.iter().map(|one| one.since_s[2]).fold(0.0, f64::max);
    let apart_s = longest_s / f64::from(MOMENTS);
    let coarse = most_explained(&all, (1..MOMENTS).map(|k| f64::from(k) * apart_s));
    let near = |at_s: f64| (0..=NEAR).map(move |k| at_s + apart_s * (2.0 * f64::from(k) / f64::from(NEAR) - 1.0));
    let Some(at_s) = coarse.and_then(|at_s| most_explained(&all, near(at_s))) else { return Vec::new() };
    let sums: Vec<Sums> = Sums::of(&equations(&all, at_s)).into_iter().collect();
    Sums::both_ways(&sums, belief).filter_map(|solved| loaded(entry, model, at_s, &solved)).collect()
}

/// The moment of these at which a force that appears explains most.
fn most_explained(all: &[Difference], moments: impl Iterator<Item = f64>) -> Option<f64> {
    let explained = |at_s: f64| Some((Sums::of_all(equations(all, at_s).iter())?.explained()?, at_s));
    moments.filter_map(explained).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at_s)| at_s)
}

/// The equations with a force from `at_s` on.
fn equations(all: &[Difference], at_s: f64) -> Vec<(f64, Vec<f64>)> {
    let equation = |one: &Difference| {
        let integral = one.since_s.map(|since_s| 0.5 * (since_s - at_s).max(0.0).powi(2));
        let mut known = one.known.clone();
        known.insert(2, second_difference(one.since_s, integral));
        (one.position, known)
    };
    all.iter().step_by(all.len().div_ceil(MOST_EQUATIONS).max(1)).map(equation).collect()
}

/// The model with these values; `None`: it is not possible.
fn loaded(entry: &Entry, model: &Model, at_s: f64, solved: &[f64]) -> Option<Model> {
    let [gain, minus_drag, force, constant] = *solved else { return None };
    let mut found = with_base(model, gain, minus_drag, constant)?;
    found.effects.set(entry.name, &[at_s, -force / gain]);
    found.check().ok().map(|()| found)
}

#[cfg(test)]
mod tests {
    use crate::select::regression::regressed;
    use crate::tests_support::{flown, model};
    use plant::{Effects, Model};

    #[test]
    fn a_load_is_found_with_its_moment_and_size_whatever_is_believed() {
        let belief = Model { effects: Effects::default(), pipe_length_mm: 1e5, ..model() };
        let mut rig = Model { gain_mm_per_s2_per_percent: 90.0, drag_per_s: 1.2, ..belief.clone() };
        rig.noise.sensor_mm = 0.1;
        rig.effects.set("load_step", &[37.3, 4.0]);
        let mut last = 0.0;
        let recording = flown(&rig, 1, 60, |t, reading| {
            let velocity = (reading - last) / 0.02;
            last = reading;
            let target = 300.0 + 80.0 * (1.7 * t).sin() + 40.0 * (4.3 * t).cos();
            21.4 + 0.1 * (target - reading) - 0.03 * velocity
        });
        let load = Effects::built_in("load_step").unwrap();
        let found = regressed(load, &Model { noise: rig.noise, ..belief.clone() }, &belief, &recording);
        let values = found[0].effects.values("load_step").unwrap();
        assert!((values[0] - 37.4).abs() < 0.2 && (values[1] / 4.0 - 1.0).abs() < 0.1, "{values:?}");
    }
}

//! Initial values for dry friction: a force against the direction of motion.
//!
//! Only readings between which the ball moved one way count: at rest, friction is whatever holds the ball.

use crate::record::recording::Recording;
use crate::select::regression::{Difference, HORIZONS_S, Integrals, Sums, differences, integrals, with_base};
use plant::{Entry, Model};

/// A motion is sure if it is longer than so many standard deviations of a difference of two readings.
const SURE: f64 = 3.0;

/// See [`super::regressed`]; none where a regression finds a force along the motion.
pub(super) fn regressed(entry: &Entry, model: &Model, belief: &Model, recording: &Recording) -> Vec<Model> {
    let flights: Vec<Vec<Integrals>> =
        recording.flights().iter().map(|flight| integrals(recording, flight, |_| Vec::new())).collect();
    let sure_mm = SURE * std::f64::consts::SQRT_2 * model.noise.sensor_mm;
    let equations = |horizon_s: f64| {
        let all = flights.iter().flat_map(move |rows| differences(rows, horizon_s));
        all.filter_map(move |one| equation(one, sure_mm)).collect::<Vec<_>>()
    };
    let sums: Vec<Sums> = HORIZONS_S.iter().filter_map(|horizon_s| Sums::of(&equations(*horizon_s))).collect();
    Sums::both_ways(&sums, belief).filter_map(|solved| rubbing(entry, model, &solved)).collect()
}

/// The equation of three readings between which the ball moved one way.
fn equation(Difference { position, mut known, moved_mm }: Difference, sure_mm: f64) -> Option<(f64, Vec<f64>)> {
    let one_way = moved_mm[0] * moved_mm[1] > 0.0 && moved_mm.iter().all(|moved| moved.abs() > sure_mm);
    let constant = *known.last().filter(|_| one_way)?;
    known.insert(2, -moved_mm[0].signum() * constant);
    Some((position, known))
}

/// The model with these values; `None`: it is not possible.
fn rubbing(entry: &Entry, model: &Model, solved: &[f64]) -> Option<Model> {
    let [gain, minus_drag, friction, constant] = *solved else { return None };
    let mut found = with_base(model, gain, minus_drag, constant).filter(|_| friction > 0.0)?;
    found.effects.set(entry.name, &[friction]);
    found.check().ok().map(|()| found)
}

#[cfg(test)]
mod tests {
    use crate::select::regression::regressed;
    use crate::tests_support::{flown, model};
    use plant::effects::WallFriction;
    use plant::{Effects, Model};

    #[test]
    fn friction_that_takes_most_of_the_force_is_found_from_the_motion_whatever_is_believed() {
        let belief = Model { effects: Effects::default(), pipe_length_mm: 1e5, ..model() };
        let mut rig =
            Model { gain_mm_per_s2_per_percent: 90.0, drag_per_s: 1.2, hover_duty_percent: 50.0, ..belief.clone() };
        rig.noise.sensor_mm = 0.1;
        rig.effects.wall_friction = Some(WallFriction { acceleration_mm_per_s2: 700.0, transition_mm_per_s: None });
        let recording = flown(&rig, 1, 60, |t, _| 50.0 + 14.0 * (1.7 * t).sin() + 9.0 * (4.3 * t).cos());
        let friction = Effects::built_in("wall_friction").unwrap();
        let found = regressed(friction, &Model { noise: rig.noise, ..belief.clone() }, &belief, &recording);
        let near = |value: f64, truth: f64| assert!((value / truth - 1.0).abs() < 0.08, "{value}, not {truth}");
        let middle = &found[1];
        near(middle.effects.values("wall_friction").unwrap()[0], 700.0);
        near(middle.gain_mm_per_s2_per_percent, 90.0);
        near(middle.hover_duty_percent, 50.0);
    }

    #[test]
    fn a_ball_at_rest_has_no_friction_to_see() {
        let friction = Effects::built_in("wall_friction").unwrap();
        let recording = flown(&model(), 1, 20, |_, _| 0.0);
        assert!(regressed(friction, &model(), &model(), &recording).is_empty());
    }
}

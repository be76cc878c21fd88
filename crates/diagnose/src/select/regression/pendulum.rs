//! Initial values for gravity on a rig whose position is an angle: A·sin(2πx/turn) + B·cos(2πx/turn).

use crate::record::recording::Recording;
use crate::select::regression::{HORIZONS_S, Integrals, Sums, differences, integrals, with_base};
use plant::{Entry, Model};
use std::f64::consts::TAU;

/// See [`super::regressed`]; none where the position is no angle.
pub(super) fn regressed(entry: &Entry, model: &Model, belief: &Model, recording: &Recording) -> Vec<Model> {
    let Some(turn_mm) = model.turn_mm else { return Vec::new() };
    let forces = |x: f64| {
        let (sin, cos) = (TAU * x / turn_mm).sin_cos();
        vec![sin, cos]
    };
    let flights: Vec<Vec<Integrals>> =
        recording.flights().iter().map(|flight| integrals(recording, flight, forces)).collect();
    let equations = |horizon_s: f64| {
        flights
            .iter()
            .flat_map(move |rows| differences(rows, horizon_s))
            .map(|one| (one.position, one.known))
            .collect::<Vec<_>>()
    };
    let sums: Vec<Sums> = HORIZONS_S.iter().filter_map(|horizon_s| Sums::of(&equations(*horizon_s))).collect();
    Sums::both_ways(&sums, belief).filter_map(|solved| pendulum(entry, model, &solved)).collect()
}

/// The model with these values; `None`: it is not possible.
fn pendulum(entry: &Entry, model: &Model, solved: &[f64]) -> Option<Model> {
    let [gain, minus_drag, sin, cos, constant] = *solved else { return None };
    let radian_mm = model.turn_mm? / TAU;
    // A·sin + B·cos = −amplitude·sin(2π·(x − centre)/turn)
    let (gradient, centre_mm) = (sin.hypot(cos) / radian_mm, cos.atan2(-sin) * radian_mm);
    // Of the turns the one nearest to the middle of the pipe.
    let turns = ((model.middle_mm() - centre_mm) / model.turn_mm?).round();
    let mut found = with_base(model, gain, minus_drag, constant)?;
    found.effects.set(entry.name, &[gradient, centre_mm + turns * model.turn_mm?, model.turn_mm?]);
    found.check().ok().map(|()| found)
}

#[cfg(test)]
mod tests {
    use crate::select::regression::regressed;
    use crate::tests_support::model;
    use crate::{Recording, Sample};
    use plant::{Effects, Input, Model, Motion};

    /// 100 mm per radian.
    const TURN_MM: f64 = 100.0 * std::f64::consts::TAU;

    /// A pendulum that hangs at 4000 mm, moved by two sines at uneven times; its readings in steps of 0.3 mm.
    fn swinging(rig: &Model) -> Recording {
        let mut motion = Motion::at_rest(4000.0, 0.0);
        let duty = |t: f64| 10.0 + 12.0 * (4.1 * t).sin() + 7.0 * (1.3 * t).cos();
        let rows = (0..2000).map(|k: i32| {
            let (now, dt) = (0.01 * f64::from(k), 0.01 + 0.002 * f64::from(k % 2));
            let time_s = now + 0.002 * f64::from(k / 2);
            let row = Sample {
                time_s,
                duty_percent: duty(time_s),
                position_mm: Some((motion.position_mm / 0.3).round() * 0.3),
                ..Sample::default()
            };
            let commanded_mm_per_s2 = rig.gain_mm_per_s2_per_percent * (duty(time_s) - rig.hover_duty_percent);
            motion = motion.step_in_endless_pipe(rig, Input { commanded_mm_per_s2, time_s, setpoint_mm: None }, dt);
            row
        });
        Recording::new(rows.collect()).unwrap()
    }

    #[test]
    fn a_pendulum_is_found_from_its_swings_whatever_is_believed() {
        let gravity = Effects::built_in("height_dependent_flow").unwrap();
        let turn_mm = Some(TURN_MM);
        let belief = Model { turn_mm, pipe_length_mm: 8000.0, effects: Effects::default(), ..model() };
        let mut rig =
            Model { gain_mm_per_s2_per_percent: 300.0, drag_per_s: 0.7, hover_duty_percent: 9.0, ..belief.clone() };
        rig.effects.set(gravity.name, &[17.0, 4000.0, TURN_MM]);
        let all = regressed(gravity, &belief, &belief, &swinging(&rig));
        assert_eq!(all.len(), 6);
        let found = &all[1];
        let values = found.effects.values(gravity.name).unwrap();
        let near =
            |value: f64, truth: f64, within: f64| assert!((value - truth).abs() < within, "{value}, not {truth}");
        near(values[0], 17.0, 0.5);
        near((values[1] - 4000.0).rem_euclid(TURN_MM).min((4000.0 - values[1]).rem_euclid(TURN_MM)), 0.0, 5.0);
        near(found.gain_mm_per_s2_per_percent, 300.0, 9.0);
        near(found.drag_per_s, 0.7, 0.1);
        near(found.hover_duty_percent, 9.0, 0.4);
        let half = Model { gain_mm_per_s2_per_percent: 150.0, drag_per_s: 0.7, ..belief.clone() };
        let given = regressed(gravity, &belief, &half, &swinging(&rig)).swap_remove(4);
        assert_eq!((given.gain_mm_per_s2_per_percent, given.drag_per_s), (150.0, 0.7));
        let truth = regressed(gravity, &belief, &rig, &swinging(&rig)).swap_remove(4);
        near(truth.effects.values(gravity.name).unwrap()[0], 17.0, 0.5);
        near(truth.hover_duty_percent, 9.0, 0.4);
    }

    #[test]
    fn a_position_that_is_no_angle_has_no_pendulum() {
        let gravity = Effects::built_in("height_dependent_flow").unwrap();
        assert!(regressed(gravity, &model(), &model(), &crate::tests_support::record(&model(), 1, 20)).is_empty());
    }
}

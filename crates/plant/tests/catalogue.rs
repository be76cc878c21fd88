//! What every effect of the catalogue, and every combination of them, promises in flight.

use plant::{Effects, Entry, Model, Motion, Noise, OWN_STATES, Simulator};
use proptest::prelude::*;

fn thesis() -> Model {
    Model {
        gain_mm_per_s2_per_percent: 827.2,
        drag_per_s: 3.896,
        hover_duty_percent: 21.4,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 583.0,
        turn_mm: None,
        noise: Noise { sensor_mm: 2.5, acceleration_psd_mm2_per_s3: 360.0 },
        effects: Effects::default(),
    }
}

/// Flies through `duties`, 20 ms each.
fn fly(model: &Model, seed: u64, duties: &[f64]) -> Vec<(Motion, f64)> {
    let mut rig = Simulator::new(model.clone(), seed);
    (1..)
        .zip(duties)
        .map(|(k, duty)| {
            rig.drive(*duty);
            rig.advance_to(0.02 * f64::from(k));
            (rig.motion(), rig.reading_mm())
        })
        .collect()
}

/// Duties that lift the ball to the top, drop it to the bottom, and wander about hover in between.
fn lively() -> Vec<f64> {
    let duty = |k: u32| match k % 300 {
        0..100 => 23.5,
        100..200 => 19.0,
        wander => 21.4 + 0.9 * libm::sin(0.3 * f64::from(wander)),
    };
    (0..600).map(duty).collect()
}

/// Flies `bare` beside itself with each of `entries` neutral.
fn neutral_changes_nothing<'a>(bare: &Model, entries: impl Iterator<Item = &'a Entry>) {
    let flight = fly(bare, 4, &lively());
    let touched = |end: f64| flight.iter().any(|(motion, _)| motion.position_mm == end);
    assert!(touched(0.0) && touched(583.0), "the flight does not reach both ends");
    for entry in entries {
        let mut model = bare.clone();
        model.effects.set(entry.name, &entry.neutral(&model));
        assert_eq!(model.check(), Ok(()), "{}", entry.name);
        // A neutral effect's own states run along; nothing else may.
        let without_own = |(motion, reading): (Motion, f64)| (Motion { own: [0.0; OWN_STATES], ..motion }, reading);
        let flown: Vec<_> = fly(&model, 4, &lively()).into_iter().map(without_own).collect();
        assert!(flown == flight, "neutral {} changes the flight", entry.name);
    }
}

#[test]
fn neutral_values_change_nothing_bit_for_bit() {
    neutral_changes_nothing(&thesis(), Effects::CATALOGUE.iter());
}

#[test]
fn neutral_values_change_nothing_behind_a_fan_with_a_lag() {
    let mut lagging = thesis();
    lagging.effects.set("fan_lag", &[0.257]);
    let others = Effects::CATALOGUE.iter().filter(|entry| !["fan_lag", "spin_asymmetry"].contains(&entry.name));
    neutral_changes_nothing(&lagging, others);
}

#[test]
fn every_effect_changes_the_flight_when_it_is_not_neutral() {
    let flight = fly(&thesis(), 4, &lively());
    for entry in Effects::CATALOGUE {
        let mut model = thesis();
        let values: Vec<f64> = entry.params.iter().map(|param| param.min + 0.3 * (param.max - param.min)).collect();
        model.effects.set(entry.name, &values);
        if entry.name == "saturation" {
            model.effects.set(entry.name, &[-800.0, 1100.0]);
        }
        assert!(fly(&model, 4, &lively()) != flight, "{} does nothing", entry.name);
    }
}

/// Values within the bounds of `entry`, at `parts` of the way from one to the other.
fn values(entry: &Entry, parts: &[f64]) -> Vec<f64> {
    entry.params.iter().zip(parts).map(|(param, part)| param.min + part * (param.max - param.min)).collect()
}

/// Ordinary values and both bounds.
fn part() -> impl Strategy<Value = f64> {
    prop_oneof![4 => 0.0..1.0, 1 => Just(0.0), 1 => Just(1.0)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_combination_stays_finite_and_within_its_ends(
        seed: u64,
        on in proptest::collection::vec(proptest::bool::weighted(0.4), Effects::CATALOGUE.len()),
        parts in proptest::collection::vec([part(), part(), part()], Effects::CATALOGUE.len()),
        duties in proptest::collection::vec(0.0..100.0, 60),
    ) {
        let mut model = thesis();
        for ((entry, on), parts) in Effects::CATALOGUE.iter().zip(on).zip(&parts) {
            if on {
                model.effects.set(entry.name, &values(entry, parts));
            }
        }
        // The only two contradictions of the catalogue.
        for (name, contradicts) in [("spin_asymmetry", "fan_lag"), ("end_stop", "end_stop")] {
            if model.check().is_err_and(|(table, _)| table.ends_with(name)) {
                model.effects.remove(contradicts);
            }
        }
        prop_assert_eq!(model.check(), Ok(()));
        let (bottom, top) = model.ends_mm();
        for (motion, reading) in fly(&model, seed, &duties) {
            prop_assert!(motion.velocity_mm_per_s.is_finite() && motion.sensed_mm.is_finite(), "{motion:?}");
            prop_assert!(motion.fan_mm_per_s2.is_finite() && reading.is_finite(), "{motion:?} read as {reading}");
            prop_assert!((bottom..=top).contains(&motion.position_mm), "{motion:?} beyond {bottom} to {top}");
        }
    }
}

//! What the catalogue promises of every effect in it.

use super::{Effects, FanLag, SpinAsymmetry};
use crate::acts::Conditions;
use crate::effect::Stage;
use crate::model::tests::thesis;
use crate::unsound::Unsound;

#[test]
fn the_catalogue_follows_the_signal_path_and_explains_every_entry() {
    let order = [Stage::Actuator, Stage::Air, Stage::Ball, Stage::Sensor];
    let place = |stage| order.iter().position(|s| *s == stage);
    assert_eq!(Effects::CATALOGUE.len(), 24);
    assert!(Effects::CATALOGUE.is_sorted_by_key(|entry| place(entry.stage)));
    for entry in Effects::CATALOGUE {
        assert!(!entry.params.is_empty() && entry.in_a_log.len() > 20 && entry.mend.len() > 20, "{}", entry.name);
        for (param, neutral) in entry.params.iter().zip(entry.neutral(&thesis())) {
            assert!((param.min..=param.max).contains(&neutral), "{}.{}", entry.name, param.name);
        }
    }
}

#[test]
fn every_effect_has_neighbours_of_the_catalogue_and_is_told_from_each() {
    for entry in Effects::CATALOGUE {
        assert!((1..=3).contains(&entry.similar.len()), "{} has {}", entry.name, entry.similar.len());
        for (k, neighbour) in entry.similar.iter().enumerate() {
            let pair = format!("{} beside {}", entry.name, neighbour.name);
            assert!(neighbour.name != entry.name && Effects::built_in(neighbour.name).is_some(), "{pair}");
            assert!(entry.similar[..k].iter().all(|other| other.name != neighbour.name), "{pair}: twice");
            assert!(neighbour.distinguished_by.len() > 40 && !neighbour.distinguished_by.ends_with('.'), "{pair}");
        }
    }
}

#[test]
fn the_stated_slopes_of_every_force_are_those_of_central_differences() {
    let mut forces = 0;
    let turns: &[f64] = &[16.0, 250.0, 360.0];
    let sizes = Effects::CATALOGUE.iter().flat_map(|entry| entry.sizes.iter().map(|values| (entry.name, *values)));
    for (name, values) in sizes.chain([("height_dependent_flow", turns)]) {
        let mut effects = Effects::default();
        effects.set(name, values);
        if !effects.has_built_in_force() {
            continue;
        }
        forces += 1;
        for (position_mm, velocity_mm_per_s, fan_mm_per_s2) in
            [(100.0, 200.0, 300.0), (420.0, -650.0, -900.0), (310.0, 2500.0, -200.0), (310.0, 40.0, -1e5)]
        {
            let now = Conditions { position_mm, velocity_mm_per_s, fan_mm_per_s2, ..thesis().conditions() };
            let stated = effects.built_in_slopes(&now);
            let differences = now.slopes_of(|there| effects.accelerated(0.0, there));
            for (stated, difference) in stated.iter().zip(differences) {
                assert!((stated - difference).abs() < 1e-6, "{name} {now:?}: {stated} for {difference}");
            }
        }
    }
    assert!(forces >= 5, "{forces}");
}

#[test]
fn every_effect_is_set_read_and_removed_by_the_name_of_its_entry() {
    for entry in Effects::CATALOGUE {
        let mut effects = Effects::default();
        assert!(!effects.remove(entry.name) && effects.values(entry.name).is_none(), "{}", entry.name);
        // Off the middle, each by another fraction, so that a swap of two fields shows.
        let values: Vec<f64> =
            (1..).zip(entry.params).map(|(k, p)| p.min + (p.max - p.min) * (0.7 + 0.05 * f64::from(k))).collect();
        assert!(effects.set(entry.name, &values));
        assert_eq!(effects.values(entry.name), Some(values.clone()));
        assert_eq!((effects.present(), Effects::built_in(entry.name)), (vec![entry], Some(entry)));
        assert!(effects.check().is_ok(), "{}", entry.name);
        let text = format!("{effects:?}");
        for (param, value) in entry.params.iter().zip(&values) {
            let said = [format!("{}: {value:?}", param.name), format!("{}: Some({value:?})", param.name)];
            assert!(said.iter().any(|said| text.contains(said)), "{} is not {value} in {text}", param.name);
        }
        assert!(effects.remove(entry.name));
        assert_eq!(effects, Effects::default());
    }
    assert!(!Effects::default().set("fan_lagg", &[0.1]) && Effects::built_in("fan_lagg").is_none());
}

#[test]
fn a_number_outside_its_bounds_is_refused_by_effect_and_key_for_every_effect() {
    for entry in Effects::CATALOGUE {
        for (k, param) in entry.params.iter().enumerate() {
            for wrong in [param.min - 1.0, param.max + 1.0, f64::NAN] {
                let mut values = entry.neutral(&thesis());
                values[k] = wrong;
                let mut effects = Effects::default();
                effects.set(entry.name, &values);
                let (effect, error) = effects.check().unwrap_err();
                assert_eq!((effect, error.key()), (entry.name, param.name));
                assert!(matches!(error, Unsound::Range(_)), "{error}");
            }
        }
        let mut effects = Effects::default();
        effects.set(entry.name, &[]);
        assert!(effects.check().is_err(), "missing values of {} are refused", entry.name);
    }
}

#[test]
fn two_lags_of_one_fan_are_refused() {
    let effects = Effects {
        fan_lag: Some(FanLag { time_constant_s: 0.2 }),
        spin_asymmetry: Some(SpinAsymmetry { up_s: 0.1, down_s: 0.3 }),
        ..Effects::default()
    };
    let (effect, error) = effects.check().unwrap_err();
    assert_eq!(effect, "spin_asymmetry");
    assert!(error.to_string().contains("delete one of the two tables"), "{error}");
}

#[test]
fn a_lag_of_two_time_constants_is_late_by_their_mean_and_at_most_by_the_longer() {
    let mut effects = Effects::default();
    for (name, values) in [("spin_asymmetry", &[0.1, 0.3][..]), ("sensor_delay", &[0.04]), ("dead_zone", &[-0.1, 0.1])]
    {
        effects.set(name, values);
    }
    assert!((effects.late_s("spin_asymmetry") - 0.2).abs() < 1e-15 && effects.late_s("dead_zone") == 0.0);
    assert!((effects.latest_s() - 0.34).abs() < 1e-15, "{}", effects.latest_s());
}

#[test]
fn the_physics_of_every_effect_is_the_head_of_its_module_with_an_equation() {
    for entry in Effects::CATALOGUE {
        let physics = Effects::default().physics(entry.name).unwrap();
        let spoken = entry.name.replace('_', " ");
        assert!(physics.to_lowercase().replace('-', " ").starts_with(&spoken), "{}: {physics}", entry.name);
        assert_eq!(physics.matches("```").count(), 2, "{}: {physics}", entry.name);
        assert!(physics.contains("Source: ") && !physics.contains("use crate"), "{}: {physics}", entry.name);
    }
    assert_eq!(Effects::default().physics("phlogiston"), None);
}

use super::diagnose;
use crate::answer::verdict::Verdict;
use crate::options::Options;
use crate::select::tests_support::{lagging, seeking};
use crate::tests_support::{model, record};
use crate::thresholds::LIKELY;
use crate::{Finding, Parameter, Recording, Sample};
use plant::{Effects, Model};

/// A flight of a rig with a dead zone that is not believed; `spoil` changes each row by its number.
fn spoilt(spoil: impl Fn(usize, &mut Sample)) -> super::Diagnosis {
    let zone = plant::effects::DeadZone { lower_percent: -0.4, upper_percent: 0.4 };
    let rig = Model { effects: Effects { dead_zone: Some(zone), ..model().effects }, ..model() };
    let mut rows = record(&rig, 6, 60).samples().to_vec();
    rows.iter_mut().enumerate().for_each(|(k, row)| spoil(k, row));
    diagnose(&model(), &Recording::new(rows).unwrap(), &Options::default())
}

#[test]
fn a_record_that_cannot_be_of_the_believed_rig_names_no_effect() {
    let scaled = |by: f64| move |_, row: &mut Sample| row.position_mm = row.position_mm.map(|mm| by * mm);
    for (what, found) in [
        ("whole", spoilt(|_, _| {})),
        ("in centimetres", spoilt(scaled(0.1))),
        ("in metres", spoilt(scaled(0.001))),
        ("in tenths of a millimetre", spoilt(scaled(10.0))),
        ("still", spoilt(|_, row| row.position_mm = Some(300.0))),
        ("without excitation", spoilt(|_, row| row.duty_percent = 21.4)),
        ("of duties as fractions", spoilt(|_, row| row.duty_percent /= 100.0)),
        ("of codes", spoilt(|_, row| row.position_mm = Some(8190.0))),
    ] {
        if what == "whole" {
            assert_eq!((found.verdict, found.effects[0].candidate.entry.name), (Verdict::Effect, "dead_zone"));
            continue;
        }
        assert_eq!(found.verdict, Verdict::InsufficientData, "{what}: {:?}", found.effects);
        assert!(found.effects.is_empty(), "{what}");
        // Metres before the search; centimetres, of which an effect could take as much gain away, after it.
        let is_unit = |noted: &crate::FlightFinding| {
            matches!(noted.finding, Finding::PositionUnit { .. } | Finding::OtherRig { .. })
        };
        let unit = found.findings.iter().any(is_unit);
        assert_eq!(unit, ["in centimetres", "in metres"].contains(&what), "{what}: {:?}", found.findings);
    }
}

#[test]
fn a_gain_of_another_unit_is_said_even_where_no_effect_is_named() {
    let weak = Model { gain_mm_per_s2_per_percent: model().gain_mm_per_s2_per_percent / 7.0, ..model() };
    let found = diagnose(&model(), &record(&weak, 5, 60), &Options::default());
    assert!(found.effects.is_empty(), "{:?}", found.effects);
    let ratio = found.findings.iter().find_map(|noted| match noted.finding {
        Finding::OtherRig { number: "gain_mm_per_s2_per_percent", ratio } => Some(ratio),
        Finding::PositionUnit { ratio, .. } => Some(ratio),
        _ => None,
    });
    assert!(ratio.is_some_and(|ratio| (6.0..8.5).contains(&(1.0 / ratio))), "{:?}", found.findings);
}

#[test]
fn a_record_that_is_too_short_says_how_short() {
    let found = diagnose(&model(), &record(&model(), 5, 3), &Options::default());
    assert_eq!(found.verdict, Verdict::InsufficientData);
    let short = |noted: &crate::FlightFinding| matches!(noted.finding, Finding::TooFew { readings, needed } if readings < needed);
    assert!(found.findings.iter().any(short), "{:?}", found.findings);
}

#[test]
fn a_short_record_of_a_right_model_has_no_gap() {
    let options = Options { without_formula: true, ..Options::default() };
    let verdicts = [5, 7, 13].map(|seed| diagnose(&model(), &record(&model(), seed, 5), &options).verdict);
    assert_eq!(verdicts, [Verdict::NoGap; 3]);
}

/// A flight of a rig with a weak supply: duty above hover loses a share of its thrust, with a time constant of 3 s.
fn with_weak_supply(share: f64, seed: u64) -> Recording {
    let mut rows = record(&model(), seed, 80).samples().to_vec();
    let (mut sag, mut before_s) = (0.0, 0.0);
    for row in &mut rows {
        // The true duty was less than the logged one.
        let logged = row.duty_percent + sag;
        let above = (logged - model().hover_duty_percent).max(0.0);
        sag += (share * above - sag) * (1.0 - (-(row.time_s - before_s) / 3.0).exp());
        (row.duty_percent, before_s) = (logged, row.time_s);
    }
    Recording::new(rows).unwrap()
}

/// The effect of the shipped library.
fn supply_sag() -> plant::DefinitionTable {
    let parameter = |value, scale, low, high| plant::ParameterTable {
        neutral: None,
        value: Some(value),
        scale: Some(scale),
        low,
        high,
        unit: String::new(),
    };
    let share = plant::ParameterTable { neutral: Some(0.0), value: None, ..parameter(0.0, 0.2, 0.0, 0.5) };
    let state = plant::StateTable { rate: "(fan - s) / tau".into(), start: "fan".into() };
    plant::DefinitionTable {
        stage: plant::Stage::Air,
        adds: "-share * s".into(),
        looks: String::new(),
        mend: String::new(),
        parameters: [("share".into(), share), ("tau".into(), parameter(2.0, 2.0, 1.0, 100.0))].into(),
        states: [("s".into(), state)].into(),
    }
}

#[test]
fn a_weak_supply_is_named_by_a_written_effect_though_it_gives_way_above_hover_alone() {
    let mut belief = model();
    belief.effects.written.define(plant::Definition::new("supply_sag", &supply_sag()).unwrap());
    let found = diagnose(&belief, &with_weak_supply(0.5, 0), &Options::default());
    let names: Vec<&str> = found.effects.iter().map(|named| named.candidate.entry.name).collect();
    assert_eq!((found.verdict, names), (Verdict::Effect, vec!["supply_sag"]));
}

#[test]
fn a_force_that_the_search_lacks_is_not_called_by_the_effect_that_half_follows_it() {
    let found = diagnose(&model(), &with_weak_supply(0.5, 0), &Options::default());
    assert_eq!(found.verdict, Verdict::Unexplained);
    assert!(
        found.misfit.rejected_effect.is_some() && found.effects.iter().all(|named| named.probability < LIKELY),
        "{:?}, {:?}",
        found.effects,
        found.misfit
    );
    // The residual depends on earlier duties.
    let first = &found.misfit.omitted_terms[0].words;
    assert!(first.contains("u") && first.contains('~'), "{first}");
}

#[test]
fn a_rig_as_believed_has_no_gap() {
    for seed in 20..23 {
        let found = diagnose(&model(), &record(&model(), seed, 60), &Options::default());
        assert_eq!(found.verdict, Verdict::NoGap, "seed {seed}: {:?}", found.places.first());
    }
}

#[test]
fn a_missing_lag_is_named_and_the_mended_model_closes_the_gap() {
    let belief = Model { effects: Effects::default(), ..model() };
    let found = diagnose(&belief, &record(&model(), 4, 80), &Options::default());
    assert_eq!(found.verdict, Verdict::Effect);
    // A lag of the sensor differs from one of the fan only in the colour of the noise.
    let named = &found.effects[0];
    assert!([&[named.candidate.entry.name], &named.indistinguishable_from[..]].concat().contains(&"fan_lag"));
    assert!(found.effects[0].probability > 0.9);
    assert!(found.closed.unwrap().value > 0.8, "{:?}", found.closed);
}

#[test]
fn the_intervals_of_two_stops_that_are_hit_alike_are_as_wide_as_each_other() {
    let stop = |bottom_mm, top_mm| {
        let stop = plant::effects::EndStop { bottom_mm, top_mm, restitution: 0.3 };
        Model { effects: Effects { end_stop: Some(stop), ..model().effects }, ..model() }
    };
    let found = diagnose(&model(), &record(&stop(260.0, 340.0), 3, 80), &Options::default());
    let intervals = found.intervals();
    let of = |wanted| {
        let mine = |parameter: &Parameter| parameter.index_in("end_stop") == Some(wanted);
        let (_, low, high) = intervals.iter().find(|(parameter, ..)| mine(parameter)).unwrap();
        (*low, *high)
    };
    let ((bottom_low, bottom_high), (top_low, top_high)) = (of(0), of(1));
    assert!(bottom_low < 260.0 && 260.0 < bottom_high, "{bottom_low} to {bottom_high}");
    assert!(top_low < 340.0 && 340.0 < top_high, "{top_low} to {top_high}");
    let ratio = (top_high - top_low) / (bottom_high - bottom_low);
    assert!((0.5..2.0).contains(&ratio), "{ratio}");
}

#[test]
fn a_gain_that_is_off_is_a_matter_of_parameters() {
    let belief = Model { gain_mm_per_s2_per_percent: 170.0, hover_duty_percent: 21.9, ..model() };
    let found = diagnose(&belief, &record(&model(), 4, 80), &Options::default());
    assert_eq!(found.verdict, Verdict::Parameters);
}

#[test]
fn a_lag_that_depends_on_the_duty_is_not_called_a_lag_for_sure() {
    let belief = Model { effects: Effects::default(), ..model() };
    let chance = |halves: f64| {
        let record = lagging(1, |u, _| 0.2 * (-halves * u).exp2());
        let found = diagnose(&belief, &record, &seeking(&["fan_lag", "sensor_lag"]));
        let lag = found.effects.first().unwrap_or_else(|| panic!("{halves}: {}", found.verdict_in_words()));
        (lag.probability, found.effect_in_words(lag))
    };
    let (constant, varying) = (chance(0.0), chance(0.5));
    let is_said = |line: &str| line.contains("its time_constant_s varies with the ");
    assert!(constant.0 > 0.9 && !is_said(&constant.1), "{constant:?}");
    assert!(varying.0 < LIKELY && is_said(&varying.1), "{varying:?}");
}

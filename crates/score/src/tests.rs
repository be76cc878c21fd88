//! Scores of synthetic cases.

use crate::answer::{Answer, AnsweredGap, AnsweredPlace, AnsweredStage, Interval, NamedEffect};
use crate::outcome::{outcome, outcome_left_out};
use crate::truth::{Bounds, CaseTruth, Kind, TrueEffect};
use crate::{Case, Outcome, Score, TrueShares, score};
use diagnose::Verdict;

fn effect(name: &str, parameters: &[(&str, f64)]) -> TrueEffect {
    TrueEffect {
        name: name.into(),
        change: "added".into(),
        parameters: parameters.iter().map(|(key, value)| ((*key).into(), *value)).collect(),
        stage: "actuator".into(),
    }
}

fn entry(name: &str, probability: f64, others: &[&str]) -> NamedEffect {
    let indistinguishable_from = others.iter().map(|name| (*name).into()).collect();
    NamedEffect { name: name.into(), change: "added".into(), probability, indistinguishable_from, ..Default::default() }
}

fn answer(verdict: Verdict, effects: Vec<NamedEffect>) -> Answer {
    let place = AnsweredPlace { stage: Vec::new() };
    Answer { verdict, effects, parameters: [].into(), gap: AnsweredGap::default(), r#where: place }
}

fn case(kind: Kind, effects: &[&str], answer: Answer) -> Case {
    let truth = CaseTruth {
        case: "made-up".into(),
        kind,
        effects: effects.iter().map(|name| effect(name, &[])).collect(),
        moved: Vec::new(),
        base: [("drag_per_s".to_owned(), 2.0)].into(),
        rig_effects: Vec::new(),
        clutter: Vec::new(),
    };
    let answer = Some(answer);
    Case { truth, bounds: None, answer, left_out: None, true_shares: None, shown: None, pipe_length_mm: 600.0 }
}

fn single(truth: &str, entries: Vec<NamedEffect>) -> Case {
    case(Kind::Single, &[truth], answer(Verdict::Effect, entries))
}

fn of(score: &Score, name: &str) -> (usize, usize) {
    let share = score.shares.iter().find(|share| share.name == name).unwrap();
    (share.proportion.count, share.proportion.n)
}

#[test]
fn a_name_is_right_if_it_is_the_true_one_or_lists_it() {
    for (entry, worth) in [
        (entry("sensor_delay", 0.9, &[]), Outcome::Right),
        (entry("transport_delay", 0.9, &["sensor_delay"]), Outcome::Right),
        (entry("transport_delay", 0.9, &[]), Outcome::Wrong),
        (entry("wall_friction", 0.9, &["dead_zone"]), Outcome::Wrong),
    ] {
        assert_eq!(outcome(&single("sensor_delay", vec![entry.clone()])), worth, "{entry:?}");
    }
    let late = vec![entry("wall_friction", 0.9, &[]), entry("sensor_delay", 0.9, &[])];
    assert_eq!(outcome(&single("sensor_delay", late)), Outcome::Partly);
}

#[test]
fn neither_a_lag_is_an_asymmetric_one_nor_the_other_way_round() {
    assert_eq!(outcome(&single("spin_asymmetry", vec![entry("fan_lag", 1.0, &["sensor_lag"])])), Outcome::Wrong);
    assert_eq!(outcome(&single("fan_lag", vec![entry("spin_asymmetry", 1.0, &[])])), Outcome::Wrong);
}

#[test]
fn saying_nothing_and_saying_unexplained_are_not_wrong_names() {
    let with = |verdict, entries| case(Kind::Single, &["dead_zone"], answer(verdict, entries));
    assert_eq!(outcome(&with(Verdict::NoGap, vec![])), Outcome::Silent);
    assert_eq!(outcome(&with(Verdict::Parameters, vec![])), Outcome::Silent);
    assert_eq!(outcome(&with(Verdict::Unexplained, vec![entry("turbulence", 0.3, &[])])), Outcome::Unexplained);
    assert_eq!(outcome(&with(Verdict::Unexplained, vec![entry("turbulence", 0.9, &[])])), Outcome::Wrong);
    assert_eq!(outcome(&with(Verdict::Unexplained, vec![entry("dead_zone", 0.9, &[])])), Outcome::Right);
    assert_eq!(outcome(&with(Verdict::InsufficientData, vec![])), Outcome::NoAnswer);
    assert_eq!(outcome(&Case { answer: None, ..with(Verdict::NoGap, vec![]) }), Outcome::NoAnswer);
}

#[test]
fn a_pair_needs_an_entry_for_each() {
    let with = |entries| case(Kind::Pair, &["dead_zone", "wall_friction"], answer(Verdict::Effect, entries));
    let both = vec![entry("wall_friction", 0.9, &[]), entry("dead_zone", 0.9, &["wall_friction"])];
    assert_eq!(outcome(&with(both)), Outcome::Right);
    // The first entry can name either, the second must then name the other: the best match counts.
    let crossed = vec![entry("dead_zone", 0.9, &["wall_friction"]), entry("dead_zone", 0.9, &[])];
    assert_eq!(outcome(&with(crossed)), Outcome::Right);
    let one = vec![entry("dead_zone", 0.9, &["wall_friction"])];
    let score = score(&[with(one), with(vec![entry("turbulence", 0.9, &[])])]);
    assert_eq!([of(&score, "pair_both"), of(&score, "pair_one"), of(&score, "wrong_pair")], [(0, 2), (1, 2), (1, 2)]);
}

#[test]
fn exact_is_all_of_them_and_no_other_and_nothing_left() {
    let right = || entry("dead_zone", 0.9, &["hysteresis"]);
    let and_more = single("dead_zone", vec![right(), entry("turbulence", 0.9, &[])]);
    let left = case(Kind::Single, &["dead_zone"], answer(Verdict::Unexplained, vec![right()]));
    let score = score(&[single("dead_zone", vec![right()]), and_more, left]);
    assert_eq!((of(&score, "top_1"), of(&score, "exact_single")), ((3, 3), (1, 3)));
}

#[test]
fn an_alarm_is_an_effect_or_unexplained_where_nothing_is_missing() {
    let with = |kind, verdict, entries| case(kind, &[], answer(verdict, entries));
    let score = score(&[
        with(Kind::None, Verdict::NoGap, vec![]),
        with(Kind::None, Verdict::Parameters, vec![]),
        with(Kind::None, Verdict::Unexplained, vec![]),
        with(Kind::Parameters, Verdict::Effect, vec![entry("dead_zone", 0.9, &[])]),
        with(Kind::Parameters, Verdict::NoGap, vec![]),
    ]);
    assert_eq!(of(&score, "false_alarm"), (2, 5));
    assert_eq!((of(&score, "none_as_parameters"), of(&score, "parameters_as_no_gap")), ((1, 3), (1, 2)));
    let worth: Vec<Outcome> = score.losses.iter().map(|loss| loss.outcome).collect();
    assert_eq!(worth, [Outcome::Unexplained, Outcome::Wrong]);
}

#[test]
fn outside_the_catalogue_only_unexplained_is_right() {
    let with = |verdict, entries| case(Kind::Outside, &["gusts"], answer(verdict, entries));
    let score = score(&[
        with(Verdict::Unexplained, vec![entry("turbulence", 0.3, &[])]),
        with(Verdict::Effect, vec![entry("turbulence", 0.9, &[])]),
        with(Verdict::NoGap, vec![]),
    ]);
    let found = ["outside_unexplained", "outside_wrong", "outside_silent"].map(|name| of(&score, name));
    assert_eq!(found, [(1, 3), (1, 3), (1, 3)]);
}

#[test]
fn an_effect_left_out_is_unexplained_or_its_twin() {
    let with = |truth: &str, left_out| Case { left_out: Some(left_out), ..single(truth, vec![]) };
    let named = |name| answer(Verdict::Effect, vec![entry(name, 0.9, &[])]);
    for (truth, left_out, worth) in [
        ("dead_zone", answer(Verdict::Unexplained, vec![]), Outcome::Right),
        ("dead_zone", named("wall_friction"), Outcome::Wrong),
        ("dead_zone", answer(Verdict::NoGap, vec![]), Outcome::Silent),
        ("sensor_delay", named("transport_delay"), Outcome::Right),
        ("fan_lag", named("spin_asymmetry"), Outcome::Right),
        ("spin_asymmetry", named("fan_lag"), Outcome::Wrong),
    ] {
        assert_eq!(outcome_left_out(&with(truth, left_out)), Some(worth), "{truth}");
    }
    assert_eq!(outcome_left_out(&single("dead_zone", vec![])), None);
}

#[test]
fn what_a_record_cannot_show_is_scored_apart() {
    let bounded = |nats| {
        let bounds = Bounds { case: "made-up".into(), nats, each: [].into(), sigma: [].into() };
        Case { bounds: Some(bounds), ..single("dead_zone", vec![entry("dead_zone", 0.9, &[])]) }
    };
    let score = score(&[bounded(Some(5.0)), bounded(Some(4.9)), bounded(None)]);
    let found = ["top_1", "top_1_detectable", "top_1_no_bound"].map(|name| of(&score, name));
    assert_eq!(found, [(3, 3), (1, 1), (1, 1)]);
}

#[test]
fn a_pair_is_scored_apart_where_each_can_be_seen_beside_the_other() {
    let pair = |each: &[(&str, f64)]| {
        let each = each.iter().map(|(name, nats)| ((*name).to_owned(), *nats)).collect();
        let bounds = Bounds { case: "made-up".into(), nats: None, each, sigma: [].into() };
        let entries = ["dead_zone", "wall_friction"].map(|name| entry(name, 0.9, &[])).to_vec();
        let case = case(Kind::Pair, &["dead_zone", "wall_friction"], answer(Verdict::Effect, entries));
        Case { bounds: Some(bounds), ..case }
    };
    let seen = pair(&[("dead_zone", 5.0), ("wall_friction", 9.0)]);
    let score = score(&[seen, pair(&[("dead_zone", 4.9), ("wall_friction", 9.0)]), pair(&[("dead_zone", 9.0)])]);
    assert_eq!((of(&score, "pair_both"), of(&score, "pair_both_detectable")), ((3, 3), (1, 1)));
}

#[test]
fn a_set_counts_twins_once() {
    let twins = single("fan_lag", vec![entry("fan_lag", 0.9, &["sensor_lag", "spin_asymmetry"])]);
    let vague = single("dead_zone", vec![entry("dead_zone", 0.9, &["hysteresis", "wall_friction"])]);
    assert!((score(&[twins, vague]).mean_set_size.unwrap() - 2.0).abs() < 1e-12);
}

#[test]
fn probabilities_are_held_against_what_came_true() {
    let right = |p| single("dead_zone", vec![entry("dead_zone", p, &[])]);
    let wrong = |p| case(Kind::None, &[], answer(Verdict::Effect, vec![entry("dead_zone", p, &[])]));
    let found = score(&[right(1.0), right(0.8), wrong(0.9), wrong(0.1)]).calibration;
    assert!((found.brier.unwrap() - (0.0 + 0.04 + 0.81 + 0.01) / 4.0).abs() < 1e-12, "{found:?}");
    let last = &found.bins[9];
    assert_eq!((found.entries, last.entries, found.bins[8].entries, found.bins[1].entries), (4, 2, 1, 1));
    assert!((last.mean_probability.unwrap() - 0.95).abs() < 1e-12 && (last.share_right.unwrap() - 0.5).abs() < 1e-12);
}

/// A rig with a dead zone of ±0.3 % and a delay, and an answer whose intervals are `half` to either side.
fn estimated(half: f64) -> Case {
    let mut case = case(Kind::Pair, &[], answer(Verdict::Effect, vec![]));
    case.truth.effects = vec![
        effect("dead_zone", &[("lower_percent", -0.3), ("upper_percent", 0.3)]),
        effect("end_stop", &[("bottom_mm", 0.0), ("top_mm", 400.0), ("restitution", 0.5)]),
    ];
    let about = |value: f64| Interval { value, low: Some(value - half), high: Some(value + half) };
    let named = |name, values: &[(&str, Interval)]| NamedEffect {
        parameters: values.iter().map(|(key, interval)| ((*key).to_owned(), *interval)).collect(),
        ..entry(name, 0.9, &[])
    };
    let free = Interval { value: 0.4, low: None, high: None };
    let answered = case.answer.as_mut().unwrap();
    answered.effects = vec![
        named("dead_zone", &[("lower_percent", about(-0.4)), ("upper_percent", about(0.23))]),
        named("end_stop", &[("bottom_mm", free), ("top_mm", about(404.0)), ("restitution", free)]),
    ];
    answered.parameters = [("drag_per_s".to_owned(), about(2.1))].into();
    let sigma = [("drag_per_s".to_owned(), 0.05), ("dead_zone.upper_percent".to_owned(), 0.01)].into();
    case.bounds = Some(Bounds { case: "made-up".into(), nats: None, each: [].into(), sigma });
    case
}

#[test]
fn intervals_are_held_against_the_truth_and_the_bound() {
    let numbers = score(&[estimated(0.08)]).numbers;
    // The upper edge is off by 0.07, the lower by 0.1, the top by 4; there is no interval of the restitution.
    let effects = &numbers.effects;
    assert_eq!((effects.covered.count, effects.covered.n, effects.without_interval), (1, 3, 1));
    assert_eq!((numbers.base.covered.count, numbers.base.covered.n), (0, 1));
    assert!((numbers.base.median_width_over_bound.unwrap() - 0.16 / (3.29 * 0.05)).abs() < 1e-9);
    let upper = &numbers.parameters["dead_zone.upper_percent"];
    assert!((upper.median_width.unwrap() - 0.16).abs() < 1e-9 && (upper.median_bound.unwrap() - 0.0329).abs() < 1e-9);
    // Errors: width of the zone 5 %, top 1 %, restitution 20 %. An end stop at the bottom of the pipe has no effect.
    assert!((effects.median_relative_error.unwrap() - 0.05).abs() < 1e-9, "{effects:?}");
    assert!(!numbers.parameters.contains_key("end_stop.bottom_mm"));
}

#[test]
fn base_parameters_beside_a_missed_effect_are_not_judged() {
    let mut missed = estimated(1.0);
    missed.answer.as_mut().unwrap().effects.pop();
    let numbers = score(&[missed]).numbers;
    assert_eq!((numbers.base.covered.n, numbers.effects.covered.n), (0, 2));
}

#[test]
fn a_claimed_share_and_a_blamed_stage_are_held_against_the_truth() {
    let with = |claimed, stage: &str| {
        let mut case = single("dead_zone", vec![entry("dead_zone", 0.9, &[])]);
        case.true_shares = Some(TrueShares { all: 0.9, ..TrueShares::default() });
        let answered = case.answer.as_mut().unwrap();
        answered.gap.closed = Some(Interval { value: claimed, low: Some(claimed - 0.07), high: Some(claimed + 0.07) });
        answered.r#where.stage =
            vec![AnsweredStage { name: "ball".into(), share: 0.4 }, AnsweredStage { name: stage.into(), share: 0.6 }];
        case
    };
    // The true model lacks clutter.
    let mut amid = with(0.94, "actuator");
    amid.truth.kind = Kind::Amid;
    let amid = score(&[amid]);
    assert_eq!((of(&amid, "closed_covered"), of(&amid, "closed_covered_amid")), ((0, 0), (1, 1)));
    let score = score(&[with(0.94, "actuator"), with(0.8, "air"), with(1.0, "actuator")]);
    assert_eq!((of(&score, "closed"), of(&score, "stage")), ((1, 3), (2, 3)));
    assert_eq!(of(&score, "closed_covered"), (1, 3));
    assert!((score.median_closed_difference.unwrap() - 0.1).abs() < 1e-12);
}

#[test]
fn of_several_effects_those_that_close_a_tenth_of_the_gap_count_as_large() {
    let entries = vec![entry("fan_lag", 0.9, &[]), entry("wall_friction", 0.4, &[]), entry("dead_zone", 0.8, &[])];
    let mut several =
        case(Kind::Several, &["fan_lag", "wall_friction", "dead_zone", "saturation"], answer(Verdict::Effect, entries));
    let shares = [("fan_lag", 0.6), ("wall_friction", 0.1), ("dead_zone", 0.09), ("saturation", 0.2)];
    let each = shares.map(|(name, share)| (name.to_owned(), share)).into();
    several.true_shares = Some(TrueShares { all: 0.99, each });
    let score = score(&[several]);
    assert_eq!((of(&score, "several_named"), of(&score, "several_likely")), ((3, 4), (2, 4)));
    assert_eq!(of(&score, "several_large"), (1, 3));
}

#[test]
fn a_name_beside_a_twin_stands_alone_and_beside_another_it_does_not() {
    let with = |others: &[&str], beside: Vec<NamedEffect>| {
        let entries = [vec![entry("transport_delay", 0.9, others)], beside].concat();
        Case { shown: Some(8.0), ..single("transport_delay", entries) }
    };
    let score = score(&[
        with(&["sensor_delay"], vec![]),
        with(&["sensor_delay", "hysteresis"], vec![]),
        with(&[], vec![entry("dead_zone", 0.9, &[])]),
        Case { shown: Some(3.0), ..with(&[], vec![]) },
    ]);
    assert_eq!((of(&score, "top_1_shown"), of(&score, "alone_shown")), ((3, 3), (1, 3)));
}

#[test]
fn every_loss_is_listed_with_what_is_so_and_what_was_answered() {
    let mut lost = single("dead_zone", vec![entry("wall_friction", 0.93, &["hysteresis"])]);
    lost.truth.effects = vec![effect("dead_zone", &[("upper_percent", 0.3)])];
    lost.left_out = Some(answer(Verdict::NoGap, vec![]));
    let losses = score(&[lost, single("dead_zone", vec![entry("dead_zone", 0.9, &[])])]).losses;
    assert_eq!(losses.len(), 2);
    assert_eq!(losses[0].truth, "dead_zone added upper_percent 0.300");
    assert_eq!(losses[0].answer, "effect wall_friction/hysteresis 0.93");
    assert_eq!((losses[1].left_out, losses[1].answer.as_str()), (true, "no_gap"));
}

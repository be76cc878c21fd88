use super::shapes::shapes;
use super::signals::Signals;
use super::{Formula, Names, formula};
use crate::fit::estimate::Problem;
use crate::fit::parameter::{BASE, Prior};
use crate::record::folds::Folds;
use crate::select::forecast::Evaluated;
use crate::select::refit::refitted;
use crate::select::search::Search;
use crate::select::tests_support::with_force;
use crate::tests_support::{model, record};
use crate::{Diagnosis, Options, Over, Recording, Step, Verdict, diagnose};
use plant::{Effects, Model, Stage};
use std::sync::LazyLock;

/// The formula beyond the refitted belief.
fn of(recording: &Recording) -> Option<Formula> {
    let (belief, folds) = (model(), Folds::new(&model(), recording));
    let search = Search::of(Problem { recording, belief: &belief, folds: &folds, prior: Prior::Belief });
    let refitted = Evaluated::of(&search, refitted(&search));
    formula(&search, &refitted, &refitted, &[])
}

/// The diagnosis of a rig with a force of 90 mm/s² that ripples over the height, 60 mm a wave.
static OF_RIPPLE: LazyLock<Diagnosis> = LazyLock::new(|| {
    let rig = with_force("size * sin(2 * pi * x / 60)", 90.0);
    diagnose(&model(), &record(&rig, 1, 80), &Options::default())
});

// The refit of the stiffer one is far from the belief, and another shape has a higher score there.
#[test]
fn a_force_in_proportion_to_the_height_is_written_down_and_leaves_the_gain_where_it_is() {
    for stiffness_per_s2 in [0.8, 5.0] {
        let rig = with_force("-size * (x - 300)", stiffness_per_s2);
        let found = of(&record(&rig, 1, 60)).unwrap();
        let names: Vec<&str> = found.shapes.iter().map(|shape| shape.entry().name).collect();
        assert_eq!(names, ["formula_height_parabola"], "{stiffness_per_s2} 1/s²");
        let fitted = &found.evaluated.fit.model;
        let gain = fitted.gain_mm_per_s2_per_percent / rig.gain_mm_per_s2_per_percent;
        assert!((0.88..1.12).contains(&gain), "{stiffness_per_s2} 1/s²: {gain} of the gain");
        let [at_250, at_350] = [250.0, 350.0].map(|height| fitted.force_at_rest(height));
        let found_per_s2 = (at_250 - at_350) / 100.0;
        assert!((found_per_s2 / stiffness_per_s2 - 1.0).abs() < 0.2, "{found_per_s2} of {stiffness_per_s2} 1/s²");
    }
}

#[test]
fn a_ripple_of_the_force_is_written_down_with_its_size_and_its_wave() {
    let found = &OF_RIPPLE;
    assert_eq!(found.verdict, Verdict::Unexplained, "{:?}", found.sentences());
    let [term] = &found.formula_terms()[..] else { panic!("{:?}", found.formula_in_words()) };
    assert_eq!(term.name, "formula_height_ripple");
    let [a, b, wave] = ["a", "b", "wave"].map(|name| term.parameters[name]);
    let size = a.value.hypot(b.value);
    assert!((wave.value / 60.0 - 1.0).abs() < 0.03, "{wave:?}");
    assert!((75.0..105.0).contains(&size), "{size}");
    assert!(wave.low.unwrap() < wave.value && wave.value < wave.high.unwrap(), "{wave:?}");
}

#[test]
fn a_formula_has_its_rung_its_sentence_and_its_place_in_the_patch() {
    let found = &OF_RIPPLE;
    let rung = found.ladder.last().unwrap();
    assert!(rung.step == Step::Formula && rung.share.unwrap().value > 0.5, "{rung:?}");
    let words = found.formula_in_words().unwrap();
    assert!(
        words.contains("a force that ripples over the height: `a * sin") && words.contains("of the gap"),
        "{words}"
    );
    let patch = found.patch_toml();
    for part in ["[effect.formula_height_ripple]", "[plant.effects.formula_height_ripple]\na = "] {
        assert!(patch.contains(part), "{patch}");
    }
}

#[test]
fn names_that_close_half_of_the_gap_are_kept_beside_a_shape_that_follows_them_and_names_that_close_none_are_not() {
    let mut rig = model();
    rig.effects.set("force_asymmetry", &[0.6]);
    let recording = record(&rig, 1, 60);
    let (belief, folds) = (model(), Folds::new(&model(), &recording));
    let search = Search::of(Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief });
    let of = |model: &Model| Evaluated::of(&search, search.problem.fit(model, &BASE));
    let (refitted, right) = (of(&belief), of(&rig));
    let [asymmetry, hover] = ["force_asymmetry", "hover_drift"].map(|name| Effects::built_in(name).unwrap());
    let right_name = Names { refitted: &refitted, with_names: &right, named: &[asymmetry] };
    assert!(right_name.close_half_of(&right) && right_name.closes_half_of(&search, asymmetry, &right));
    assert!(!right_name.closes_half_of(&search, hover, &right));
    let no_name = Names { refitted: &refitted, with_names: &refitted, named: &[] };
    assert!(!no_name.close_half_of(&right));
}

#[test]
fn a_rig_as_believed_has_no_formula() {
    for seed in 0..6 {
        let found = of(&record(&model(), seed, 60)).unwrap();
        assert!(found.shapes.is_empty(), "seed {seed}: {}", found.shapes[0].entry().name);
    }
}

#[test]
fn every_shape_is_a_definition_on_rigs_of_any_size() {
    let recording = record(&model(), 1, 20);
    let (belief, folds) = (model(), Folds::new(&model(), &recording));
    let search = Search::of(Problem { recording: &recording, belief: &belief, folds: &folds, prior: Prior::Belief });
    let signals = Signals::of(&search.problem, &refitted(&search)).unwrap();
    let all = shapes(&signals).len();
    assert!(all > 15, "{all}");
    for scale in [1e-3, 0.1, 30.0, 1e3] {
        assert_eq!(shapes(&signals.times(scale)).len(), all, "{scale} times the length");
    }
}

#[test]
fn a_formula_over_one_signal_is_drawn_with_a_band_that_holds_the_truth() {
    let ranges = [(20.0, 23.0), (240.0, 360.0), (-100.0, 100.0)];
    let [curve] = &OF_RIPPLE.formula_curves(ranges)[..] else { panic!("not one curve") };
    assert_eq!((curve.over, curve.stage), (Over::Height, Stage::Air));
    let truth = |mm: f64| 90.0 * (std::f64::consts::TAU * mm / 60.0).sin();
    let held = curve.points.iter().filter(|[at, _, low, high]| (*low..=*high).contains(&truth(*at))).count();
    // A band of 90 % at each place; the places go together.
    assert!(2 * held > curve.points.len(), "{held} of {}", curve.points.len());
    let worst = curve.points.iter().map(|[at, value, ..]| (value - truth(*at)).abs()).fold(0.0, f64::max);
    assert!(worst < 30.0, "{worst} mm/s²");
}

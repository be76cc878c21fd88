//! Tests of experiment files: their meaning, and their refusal.

use super::{Demand, Experiment, Limits, Segment};
use config::Safety;

const SAFETY: Safety = Safety {
    setpoint_min_mm: 20.0,
    setpoint_max_mm: 560.0,
    duty_min_percent: 0.0,
    duty_max_percent: 40.0,
    coast_s: 0.5,
    stall_s: 0.5,
    stuck: None,
};

fn read(text: &str) -> Result<Experiment, String> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("e.toml");
    std::fs::write(&path, text).unwrap();
    let place = format!("{}/", directory.path().display());
    Experiment::read(&path, &SAFETY).map_err(|error| error.to_string().replace(&place, ""))
}

impl Experiment {
    /// Changes one of its segments.
    pub(crate) fn change(&mut self, index: usize, change: impl FnOnce(&mut Segment)) {
        let mut segments = Vec::from(self.segments.clone());
        change(&mut segments[index]);
        self.segments = segments.into();
    }
}

const TWO: &str = "title = \"t\"\n[limits]\nposition_max_mm = 550.0\n\
    [[segment]]\nduration_s = 10.0\nsetpoint_mm.constant = { value = 300.0 }\n\
    excitation_percent.square = { low = -0.5, high = 0.5, period_s = 2.0 }\n\
    [[segment]]\nduration_s = 5.0\nduty_percent.ramp = { from = 20.0, to = 25.0, over_s = 5.0 }\n";

#[test]
fn segments_follow_each_other_on_their_own_time_and_end() {
    let experiment = read(TWO).unwrap();
    assert_eq!(experiment.duration_s(), 15.0);
    let control = |excitation_percent| Some(Demand::Control { setpoint_mm: 300.0, excitation_percent });
    assert_eq!(experiment.demand(0.5), control(0.5));
    assert_eq!(experiment.demand(9.5), control(-0.5));
    assert_eq!(experiment.demand(12.0), Some(Demand::Drive { duty_percent: 22.0 }));
    assert_eq!(experiment.demand(15.0), None);
}

#[test]
fn every_moment_of_a_long_experiment_is_in_the_segment_that_a_walk_from_its_start_finds() {
    let lengths_s = |k: usize| 0.001 + f64::from(u32::try_from(k % 97).unwrap()) * 0.01;
    let segment = |k| Segment { duration_s: lengths_s(k), until_below_mm: Some(k as f64), ..Segment::default() };
    let segments: Vec<Segment> = (0..100_000).map(segment).collect();
    let mut starts_s = vec![0.0];
    segments.iter().for_each(|segment| starts_s.push(starts_s[starts_s.len() - 1] + segment.duration_s));
    let all = Experiment { title: String::new(), limits: Limits::default(), segments: segments.into() };
    // Where each is found by a walk, this takes minutes.
    for (k, pair) in starts_s.windows(2).enumerate() {
        for t_s in [pair[0], (pair[0] + pair[1]) / 2.0, pair[1].next_down()] {
            let (found, start_s) = all.segments.at(t_s).unwrap();
            assert_eq!((found.until_below_mm, start_s), (Some(k as f64), pair[0]), "at {t_s} s");
        }
    }
    assert_eq!(all.duration_s(), starts_s[100_000]);
    assert!(all.segments.at(all.duration_s()).is_none() && all.segments.at(f64::NAN).is_none());
}

#[test]
fn an_experiment_without_a_title_is_told_that_key() {
    let message = read(&TWO.replace("title = \"t\"\n", "")).unwrap_err();
    assert_eq!(message, "e.toml: missing key `title`");
}

#[test]
fn the_band_holds_only_where_it_has_an_end() {
    let experiment = read(TWO).unwrap();
    assert!(experiment.outside_band(-100.0).is_none());
    assert!(experiment.outside_band(551.0).is_some());
}

#[test]
fn limits_that_could_not_hold_are_refused() {
    let message = read(&TWO.replace("position_max_mm = 550.0", "position_max_mm = nan")).unwrap_err();
    assert!(message.starts_with("e.toml:3: limits.position_max_mm = NaN"), "{message}");
    let crossed = "position_max_mm = 100.0\nposition_min_mm = 300.0";
    let message = read(&TWO.replace("position_max_mm = 550.0", crossed)).unwrap_err();
    assert!(message.contains("limits.position_max_mm = 100 is outside 300 to 2000"), "{message}");
}

#[test]
fn a_setpoint_outside_the_safe_band_is_refused_with_its_line() {
    let message = read(&TWO.replace("300.0", "700.0")).unwrap_err();
    assert!(message.starts_with("e.toml:6: segment[0].setpoint_mm.constant.value = 700"), "{message}");
    assert!(message.contains("20 to 560"), "{message}");
}

#[test]
fn a_duty_above_the_safe_one_is_refused() {
    let message = read(&TWO.replace("to = 25.0", "to = 55.0")).unwrap_err();
    assert!(message.starts_with("e.toml:10: segment[1].duty_percent.ramp.to = 55 is outside 0 to 40"), "{message}");
}

#[test]
fn a_segment_that_controls_and_drives_at_once_is_refused() {
    let message = read(&TWO.replace("excitation_percent.square", "duty_percent.square")).unwrap_err();
    assert!(message.contains("either setpoint_mm or duty_percent"), "{message}");
    let message = read("title = \"t\"\nsegment = []\n").unwrap_err();
    assert!(message.contains("no [[segment]]"), "{message}");
}

#[test]
fn an_unknown_waveform_is_refused_with_the_known_ones() {
    let message = read(&TWO.replace("setpoint_mm.constant", "setpoint_mm.const")).unwrap_err();
    assert!(message.contains("unknown word `const`") && message.contains("`chirp`"), "{message}");
}

#[test]
fn the_book_lists_every_key_of_an_experiment() {
    let page = include_str!("../../../../../docs/book/src/reference/experiments.md");
    let all = Experiment { title: String::new(), limits: Limits::default(), segments: vec![Segment::default()].into() };
    let all = serde_json::to_value(all).unwrap();
    for (table, keys) in [("limits", &all["limits"]), ("segment", &all["segment"][0])] {
        let keys = keys.as_object().unwrap();
        assert!(!keys.is_empty());
        for key in keys.keys() {
            assert!(page.contains(&format!("`{table}.{key}`")), "{table}.{key}");
        }
    }
}

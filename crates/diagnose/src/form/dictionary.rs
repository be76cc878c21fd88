//! The terms of a form: formulas of height, velocity, duty and of what they were before, each about 1 at a typical size,
//! so that its coefficient is a typical force in mm/s². Beyond what was flown a term keeps its last value: nothing is
//! known there.
//!
//! None depends on time: a form is a property of the rig, which another flight of it shows again.

use crate::record::recording::Recording;
use crate::stats::quantile::quantile;
use plant::Model;

/// Stands for the state in the value of a term with memory.
pub(super) const MEMORY: &str = "memory";
/// Heights that curves of height are centred at.
const CENTRES: usize = 9;
/// Waves of the height: the longest period is the range of heights, each next one shorter by this factor, the shortest
/// about a twelfth of it.
const SHORTER: f64 = 0.92;
const WAVES: i32 = 30;
/// Curves of one variable Q in its standard deviation, odd and even, none much above 4 anywhere.
const CURVES: [&str; 7] = ["tanh(Q)", "tanh(4 * Q)", "tanh(20 * Q)", "Q * exp(-Q^2)", "Q * abs(Q)", "abs(Q)", "Q^2"];
/// Waves of the velocity: radians in its standard deviation.
const TURNS: [f64; 6] = [1.2, 1.6, 2.1, 2.8, 3.7, 5.0];
/// Time constants of the memory, seconds: between the response of a fan and the length of a stretch.
const MEMORIES_S: [f64; 4] = [0.15, 0.5, 1.5, 5.0];

/// A term.
pub(super) struct FormTerm {
    /// Its formula; [`MEMORY`] stands for its state.
    pub(super) value: String,
    /// What its state follows.
    pub(super) memory: Option<Memory>,
    /// Its kind in words.
    pub(super) words: &'static str,
}

/// A state of first order.
pub(super) struct Memory {
    /// The formula that it follows.
    pub(super) of: String,
    /// The time constant, seconds.
    pub(super) time_constant_s: f64,
}

/// The ranges of a record.
pub(super) struct Scales {
    /// Mean and standard deviation of the height, mm.
    height: [f64; 2],
    /// Lowest and highest height but for 2 % each, mm.
    range: [f64; 2],
    /// Standard deviations of velocity and duty, mm/s and percent.
    velocity: f64,
    duty: f64,
}

impl Scales {
    /// Of a record. `None`: something does not move.
    pub(super) fn of(recording: &Recording, model: &Model) -> Option<Self> {
        let samples = recording.samples();
        let mut heights: Vec<f64> = samples.iter().filter_map(|sample| sample.position_mm).collect();
        heights.sort_by(f64::total_cmp);
        let (mean, deviation) = moments(heights.iter().copied());
        let duty = moments(samples.iter().map(|sample| sample.duty_percent - model.hover_duty_percent)).1;
        // The velocity over 0.2 s, in which noise is small.
        let far = |pair: &[crate::record::recording::Sample]| {
            let (first, last) = (pair.first()?, pair.last()?);
            Some((last.position_mm? - first.position_mm?) / (last.time_s - first.time_s))
        };
        let period_s = recording.duration_s() / samples.len().max(1) as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
        let apart = ((0.2 / period_s.max(1e-6)) as usize).clamp(1, 1000);
        let velocities: Vec<f64> =
            samples.windows(apart + 1).filter_map(far).filter(|velocity| velocity.is_finite()).collect();
        let velocity = moments(velocities.iter().copied()).1;
        let range = [quantile(&heights, 0.02), quantile(&heights, 0.98)];
        let moves = deviation > 0.0 && velocity > 0.0 && duty > 0.0 && range[1] > range[0];
        moves.then_some(Self { height: [mean, deviation], range, velocity, duty })
    }
}

fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    (mean, (values.map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt())
}

/// Three digits are enough for a scale.
fn short(value: f64) -> String {
    let digits = if value == 0.0 { 0.0 } else { 2.0 - value.abs().log10().floor() };
    let factor = 10_f64.powf(digits.clamp(-6.0, 9.0));
    let rounded = (value * factor).round() / factor;
    if rounded < 0.0 { format!("({rounded})") } else { format!("{rounded}") }
}

/// Every term for records of these ranges.
pub(super) fn dictionary(scales: &Scales) -> Vec<FormTerm> {
    let mut terms = Vec::new();
    let mut add = |words: &'static str, value: String| terms.push(FormTerm { value, memory: None, words });
    let x = format!("clamp((x - {}) / {}, -2, 2)", short(scales.height[0]), short(scales.height[1]));
    let v = format!("clamp(v / {}, -2, 2)", short(scales.velocity));
    let u = format!("clamp(u / {}, -2, 2)", short(scales.duty));
    for (words, q) in [("height", &x), ("velocity", &v), ("duty", &u)] {
        if words == "height" {
            add(words, q.clone());
        }
        for curve in CURVES {
            add(words, curve.replace('Q', q));
        }
    }
    for turns in TURNS {
        add("velocity", format!("sin({turns} * {v})"));
    }
    curves_of_height(scales, &mut add);
    for (words, product) in [
        ("height and velocity", "X * V"),
        ("height and duty", "X * U"),
        ("duty and velocity", "U * V"),
        ("duty and velocity", "U * abs(V)"),
        ("duty and velocity", "abs(U) * V"),
        ("height and velocity", "X^2 * V"),
        ("height and velocity", "X * abs(V)"),
        ("height and duty", "X^2 * U"),
        ("duty and velocity", "U^2 * V"),
    ] {
        add(words, product.replace('X', &x).replace('V', &v).replace('U', &u));
    }
    with_memory(&mut terms, [&x, &v, &u]);
    terms
}

/// Curves that have one place in the pipe, and waves along it.
fn curves_of_height(scales: &Scales, add: &mut impl FnMut(&'static str, String)) {
    let [low, high] = scales.range;
    let spacing = (high - low) / (CENTRES - 1) as f64;
    for place in 0..CENTRES {
        let centre = short(low + spacing * place as f64);
        for width in [spacing, 2.0 * spacing] {
            let width = short(width);
            add("height", format!("max(1 - abs(x - {centre}) / {width}, 0)"));
            add("height", format!("(x - {centre}) / {width} * exp(-((x - {centre}) / {width})^2)"));
        }
    }
    for number in 0..WAVES {
        let period = short(SHORTER.powi(number) * (high - low));
        add("height", format!("sin(2 * pi * x / {period})"));
        add("height", format!("cos(2 * pi * x / {period})"));
    }
}

/// Terms that follow duty, height and speed late.
fn with_memory(terms: &mut Vec<FormTerm>, [x, v, u]: [&String; 3]) {
    for (words, of) in [
        ("earlier duty", u.clone()),
        ("earlier duty", format!("abs({u})")),
        ("earlier duty", format!("max({u}, 0)")),
        ("earlier height", x.clone()),
        ("earlier velocity", format!("abs({v})")),
    ] {
        for time_constant_s in MEMORIES_S {
            let memory = Some(Memory { of: of.clone(), time_constant_s });
            terms.push(FormTerm { value: MEMORY.into(), memory, words });
        }
    }
}

//! The pictures of an identification: simulations beside the record, correlations of the residuals with their band,
//! frequency responses of the plants; or the pulses of a sweep of gains.

use crate::report::kit::palette::{FORCE, MENDED, NOMINAL, RECORDED, SETPOINT};
use crate::report::kit::plot::{
    Diagram, Line, PlotError, drawn, forecasts, nearest, panel, recorded, unwrapped, write,
};
use control::design::Linear;
use control::design::polynomial::magnitude;
use diagnose::Recording;
use diagnose::identify::Transient;
use diagnose::identify::{GreyBox, OfGain, Poles, ResidualTests, Sweep};
use plant::Model;
use plotters::style::RGBColor;
use std::path::Path;

/// Size of a picture, pixels, and the height of its upper part.
const SIZE: (u32, u32) = (1100, 800);
const UPPER: u32 = 420;
/// Frequencies, powers of ten of rad/s.
const DECADES: (f64, f64) = (-1.0, 2.0);
const POINTS: u32 = 300;
const BAND_POINTS: u32 = 60;

/// Name and colour of a plant with this number of poles.
pub const fn look(poles: Poles) -> (&'static str, RGBColor) {
    match poles {
        Poles::Two => ("two poles", NOMINAL),
        Poles::Three => ("three poles", MENDED),
    }
}

/// Draws the plants with each number of poles from `recording`; the residuals are those of `best`.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn grey_box(
    path: &Path,
    title: &str,
    recording: &Recording,
    found: &[GreyBox],
    best: &GreyBox,
) -> Result<(), PlotError> {
    let title = format!("{title}: simulations of what was held out, 10 s each");
    let [whiteness, input] = correlations(&best.residuals);
    let [magnitude, _] = plants(found, best, None);
    picture(path, &Diagram { title, ..simulations(recording, found) }, &[whiteness, input, magnitude])
}

/// Draws a sweep: the mean pulse of the lowest, the middle and the highest gain beside the loop of second order that
/// was computed from it, and K_g and a over the gain.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn sweep(path: &Path, title: &str, found: &Sweep) -> Result<(), PlotError> {
    let title = format!("{title}: mean pulses of the lowest, the middle and the highest gain");
    let [gain, drag] = over_gains(found);
    picture(path, &Diagram { title, ..pulses(found) }, &[gain, drag, plant(found)])
}

/// A wide diagram above three.
fn picture(path: &Path, above: &Diagram, below: &[Diagram; 3]) -> Result<(), PlotError> {
    let svg = drawn(SIZE, |area| {
        let (upper, lower) = area.split_vertically(area.dim_in_pixel().1 * UPPER / SIZE.1);
        panel(&upper, above)?;
        lower.split_evenly((1, 3)).iter().zip(below).try_for_each(|(area, diagram)| panel(area, diagram))
    })?;
    write(path, &svg)
}

/// The record, and simulations of its held-out part with each number of poles.
pub fn simulations(recording: &Recording, found: &[GreyBox]) -> Diagram {
    let simulated = |one: &GreyBox| {
        let (label, colour) = look(one.poles);
        forecasts(label, colour, recording, &one.held_out.runs)
    };
    let lines = std::iter::once(recorded(recording)).chain(found.iter().map(simulated)).collect();
    Diagram { abscissa: "time, s", ordinate: "position, mm", lines, ..Diagram::default() }
}

/// Autocorrelation of the residuals and their correlation with the duty, at lags of 1, 2, … readings, with the band of
/// white noise.
pub fn correlations(residuals: &ResidualTests) -> [Diagram; 2] {
    let of = |title: &str, values: &[f64]| {
        let (band, end) = (residuals.band, values.len() as f64 + 0.5);
        let bar = |(lag, value): (u32, &f64)| {
            let lag = f64::from(lag);
            [(lag, 0.0), (lag, *value), (f64::NAN, f64::NAN)]
        };
        let bars = (1..).zip(values).flat_map(bar).collect();
        Diagram {
            title: title.into(),
            abscissa: "lag, readings",
            ordinate: "correlation; band: 95 %",
            lines: vec![Line { label: "correlation", colour: RECORDED, points: bars }],
            band: vec![(0.5, band), (end, band), (end, -band), (0.5, -band)],
            ..Diagram::default()
        }
    };
    [
        of("residuals: autocorrelation", &residuals.autocorrelation),
        of("residuals: correlation with duty", &residuals.with_input),
    ]
}

/// Magnitude and phase of the plants with each number of poles, from duty to position: that of `best` with its 90 %
/// band, and that of the belief where there is one.
pub fn plants(found: &[GreyBox], best: &GreyBox, belief: Option<&Model>) -> [Diagram; 2] {
    [Part::Magnitude, Part::Phase].map(|part| {
        let others = found.iter().filter(|one| one.poles != best.poles);
        let of = |one: &GreyBox| bode(look(one.poles), one.fit.model.linear(), part);
        let believed = belief.map(|belief| bode(("as believed", FORCE), belief.linear(), part));
        let lines = std::iter::once(of(best)).chain(others.map(of)).chain(believed).collect();
        Diagram { band: band(best, part), ..frequencies(part, lines) }
    })
}

/// The frequency response of the plant of a sweep.
pub fn plant(found: &Sweep) -> Diagram {
    let linear = Linear::two_poles(found.gain.value, found.drag.value);
    frequencies(Part::Magnitude, vec![bode(look(Poles::Two), linear, Part::Magnitude)])
}

/// A part of a frequency response.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Magnitude,
    Phase,
}

impl Part {
    /// At a frequency, rad/s: dB, or degrees up to whole turns.
    fn of(self, plant: &Linear, omega: f64) -> f64 {
        let value = plant.continuous().response(omega);
        match self {
            Self::Magnitude => 20.0 * magnitude(value).log10(),
            Self::Phase => value.im.atan2(value.re).to_degrees(),
        }
    }

    /// At all frequencies: a phase without jumps.
    fn along(self, points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
        if self == Self::Phase { unwrapped(points) } else { points }
    }
}

fn exponents(points: u32) -> impl Iterator<Item = f64> + Clone {
    (0..=points).map(move |k| DECADES.0 + (DECADES.1 - DECADES.0) * f64::from(k) / f64::from(points))
}

fn bode((label, colour): (&'static str, RGBColor), plant: Linear, part: Part) -> Line {
    let points = exponents(POINTS).map(|at| (at, part.of(&plant, 10.0_f64.powf(at)))).collect();
    Line { label, colour, points: part.along(points) }
}

/// The outline of the 90 % band.
fn band(best: &GreyBox, part: Part) -> Vec<(f64, f64)> {
    let of = |model: &Model, at: f64| part.of(&model.linear(), 10.0_f64.powf(at));
    let centre = exponents(BAND_POINTS).map(|at| (at, of(&best.fit.model, at))).collect();
    let ends = |(at, value): (f64, f64)| {
        let reach = best.reach(|model| if part == Part::Phase { nearest(of(model, at), value) } else { of(model, at) });
        [(at, value - reach), (at, value + reach)]
    };
    let ends: Vec<_> = part.along(centre).into_iter().map(ends).collect();
    ends.iter().map(|end| end[1]).chain(ends.iter().rev().map(|end| end[0])).collect()
}

fn frequencies(part: Part, lines: Vec<Line>) -> Diagram {
    let ordinate = if part == Part::Magnitude { "mm per %, dB" } else { "phase, degrees" };
    let abscissa = "frequency, rad/s";
    Diagram { title: "plant".into(), abscissa, ordinate, lines, decades: true, ..Diagram::default() }
}

/// The mean pulses of the lowest, the middle and the highest gain, and the responses that were computed from them.
pub fn pulses(found: &Sweep) -> Diagram {
    let last = found.gains.len().saturating_sub(1);
    let mut shown = vec![0, last / 2, last];
    shown.dedup();
    let broken = |points: fn(&OfGain) -> Vec<(f64, f64)>| {
        let end = [(f64::NAN, f64::NAN)];
        let gains = shown.iter().filter_map(|at| found.gains.get(*at));
        gains.flat_map(|gain| points(gain).into_iter().chain(end)).collect()
    };
    let lines = vec![
        Line { label: "mean pulse", colour: RECORDED, points: broken(|gain| gain.mean_pulse.clone()) },
        Line { label: "second order", colour: NOMINAL, points: broken(response) },
    ];
    Diagram { abscissa: "time since the jump, s", ordinate: "share of the jump", lines, ..Diagram::default() }
}

/// The response of second order that was computed from the mean pulse.
fn response(gain: &OfGain) -> Vec<(f64, f64)> {
    let loops = Transient { damping: gain.damping, omega: gain.omega };
    gain.mean_pulse.iter().map(|(t, _)| (*t, loops.response(*t))).collect()
}

/// K_g and a over the gain, with their intervals.
pub fn over_gains(found: &Sweep) -> [Diagram; 2] {
    let over = |ordinate, of: fn(&OfGain) -> diagnose::identify::ParameterEstimate| {
        let points = found.gains.iter().map(|gain| (gain.kp_per_mm, of(gain).value)).collect();
        let interval = |gain: &OfGain| {
            let (low, high) = of(gain).low.zip(of(gain).high)?;
            Some([(gain.kp_per_mm, low), (gain.kp_per_mm, high), (f64::NAN, f64::NAN)])
        };
        let lines = vec![
            Line { label: "of each gain", colour: RECORDED, points },
            Line {
                label: "90 % interval",
                colour: SETPOINT,
                points: found.gains.iter().filter_map(interval).flatten().collect(),
            },
        ];
        Diagram { abscissa: "K_p, % per mm", ordinate, lines, ..Diagram::default() }
    };
    [over("K_g, mm/s² per %", |gain| gain.gain), over("a, 1/s", |gain| gain.drag)]
}

//! The pictures of an identification: simulations beside the record, residual correlations with their band, the plants in frequency; or a sweep
//! of gains, pulse by pulse.

use super::panel::Area;
use super::{Line, Panel, PlotError, drawn, forecasts, panel, recorded, write};
use crate::report::palette::{MENDED, NOMINAL, RECORDED, SETPOINT};
use control::design::Linear;
use control::design::polynomial::magnitude;
use diagnose::transient::Transient;
use diagnose::{GreyBox, OfGain, Poles, Recording, Sweep};
use plotters::style::RGBColor;
use std::path::Path;

/// Size of a picture, pixels, and the part of its height above.
const SIZE: (u32, u32) = (1100, 800);
const UPPER: u32 = 420;
/// Frequencies, powers of ten of rad/s.
const DECADES: (f64, f64) = (-1.0, 2.0);
const POINTS: u32 = 300;

const fn look(poles: Poles) -> (&'static str, RGBColor) {
    match poles {
        Poles::Two => ("two poles", NOMINAL),
        Poles::Three => ("three poles", MENDED),
    }
}

/// Draws what was identified with each number of poles from `recording`; the residuals are those of `best`.
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
    picture(path, |upper, lower| {
        let title = format!("{title}: simulations of what was held out, 10 s each");
        let simulated = |one: &GreyBox| {
            let (label, colour) = look(one.poles);
            forecasts(label, colour, recording, &one.held_out.runs)
        };
        let lines: Vec<Line> = std::iter::once(recorded(recording)).chain(found.iter().map(simulated)).collect();
        let axes = Panel { abscissa: "time, s", ordinate: "position, mm", ..Panel::default() };
        panel(upper, Panel { title: &title, lines: &lines, ..axes })?;
        let residuals = &best.residuals;
        correlation(&lower[0], "residuals: autocorrelation", &residuals.autocorrelation, residuals.band)?;
        correlation(&lower[1], "residuals: correlation with duty", &residuals.with_input, residuals.band)?;
        let magnitudes = found.iter().map(|one| (look(one.poles), one.fit.model.linear()));
        frequencies(&lower[2], &magnitudes.map(bode).collect::<Vec<_>>())
    })
}

/// Draws a sweep: the mean pulse of the lowest, the middle and the highest gain beside the loop of second order that was read off it, and K_g and
/// a over the gain.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn sweep(path: &Path, title: &str, found: &Sweep) -> Result<(), PlotError> {
    picture(path, |upper, lower| {
        let last = found.gains.len().saturating_sub(1);
        let mut shown = vec![0, last / 2, last];
        shown.dedup();
        let broken = |points: fn(&OfGain) -> Vec<(f64, f64)>| {
            let end = [(f64::NAN, f64::NAN)];
            shown.iter().flat_map(|at| points(&found.gains[*at]).into_iter().chain(end)).collect()
        };
        let lines = [
            Line { label: "mean pulse", colour: RECORDED, points: broken(|gain| gain.mean_pulse.clone()) },
            Line { label: "second order", colour: NOMINAL, points: broken(response) },
        ];
        let title = format!("{title}: mean pulses of the lowest, the middle and the highest gain");
        let axes = Panel { abscissa: "time since the jump, s", ordinate: "share of the jump", ..Panel::default() };
        panel(upper, Panel { title: &title, lines: &lines, ..axes })?;
        over_gains(&lower[0], "K_g, mm/s² per %", &found.gains, |gain| gain.gain)?;
        over_gains(&lower[1], "a, 1/s", &found.gains, |gain| gain.drag)?;
        let plant = Linear::two_poles(found.gain.value, found.drag.value);
        frequencies(&lower[2], &[bode((("two poles", NOMINAL), plant))])
    })
}

/// A wide diagram above three.
fn picture(path: &Path, draw: impl FnOnce(&Area<'_>, &[Area<'_>]) -> Result<(), PlotError>) -> Result<(), PlotError> {
    let svg = drawn(SIZE, |area| {
        let (upper, lower) = area.split_vertically(area.dim_in_pixel().1 * UPPER / SIZE.1);
        draw(&upper, &lower.split_evenly((1, 3)))
    })?;
    write(path, &svg)
}

/// Correlations at 1, 2, … readings within the band of white noise.
fn correlation(area: &Area<'_>, title: &str, values: &[f64], band: f64) -> Result<(), PlotError> {
    let end = values.len() as f64 + 0.5;
    let mut bars = Vec::new();
    for (lag, value) in (1..).zip(values) {
        bars.extend([(f64::from(lag), 0.0), (f64::from(lag), *value), (f64::NAN, f64::NAN)]);
    }
    let bars = Line { label: "correlation", colour: RECORDED, points: bars };
    let within = [(0.5, band), (end, band), (end, -band), (0.5, -band)];
    let axes = Panel { title, abscissa: "lag, readings", ordinate: "correlation; band: 95 %", ..Panel::default() };
    panel(area, Panel { lines: &[bars], band: &within, ..axes })
}

fn bode(((label, colour), plant): ((&'static str, RGBColor), Linear)) -> Line {
    let transfer = plant.continuous();
    let at = |k: u32| DECADES.0 + (DECADES.1 - DECADES.0) * f64::from(k) / f64::from(POINTS);
    let decibels = |k: u32| 20.0 * magnitude(transfer.response(10.0_f64.powf(at(k)))).log10();
    Line { label, colour, points: (0..=POINTS).map(|k| (at(k), decibels(k))).collect() }
}

fn frequencies(area: &Area<'_>, lines: &[Line]) -> Result<(), PlotError> {
    let axes = Panel { abscissa: "frequency, rad/s", ordinate: "mm per %, dB", decades: true, ..Panel::default() };
    panel(area, Panel { title: "plant", lines, ..axes })
}

/// The response of second order that was read off the mean pulse.
fn response(gain: &OfGain) -> Vec<(f64, f64)> {
    let loops = Transient { damping: gain.damping, omega: gain.omega };
    gain.mean_pulse.iter().map(|(t, _)| (*t, loops.response(*t))).collect()
}

fn over_gains(
    area: &Area<'_>,
    ordinate: &str,
    gains: &[OfGain],
    of: fn(&OfGain) -> diagnose::Estimate,
) -> Result<(), PlotError> {
    let points = gains.iter().map(|gain| (gain.kp_per_mm, of(gain).value)).collect();
    let mut intervals = Vec::new();
    for gain in gains {
        if let (Some(low), Some(high)) = (of(gain).low, of(gain).high) {
            intervals.extend([(gain.kp_per_mm, low), (gain.kp_per_mm, high), (f64::NAN, f64::NAN)]);
        }
    }
    let lines = [
        Line { label: "of each gain", colour: RECORDED, points },
        Line { label: "90 % interval", colour: SETPOINT, points: intervals },
    ];
    panel(area, Panel { abscissa: "K_p, % per mm", ordinate, lines: &lines, ..Panel::default() })
}

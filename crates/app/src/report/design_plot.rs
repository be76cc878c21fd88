//! The picture of a design: step, root locus and poles, Bode magnitude and phase, as SVG.

use super::palette::{NOMINAL, RECORDED, SETPOINT};
use super::plot::{Line, Panel, PlotError, drawn, panel, write};
use crate::assessment::Loop;
use control::design::law::closed;
use control::design::polynomial::magnitude;
use control::design::{Transfer, step};
use plotters::style::RGBColor;
use std::path::Path;

/// Size of the picture, pixels.
const SIZE: (u32, u32) = (1100, 800);
/// The closed loop, the sampled loop, the poles.
const CONTINUOUS: RGBColor = RECORDED;
const SAMPLED: RGBColor = NOMINAL;
/// Gains of the root locus: from a hundredth of the loop's to a hundred times.
const LOCUS_DECADES: f64 = 2.0;
const LOCUS_POINTS: u32 = 400;
/// Frequencies of the Bode plot, powers of ten of rad/s.
const BODE: (f64, f64) = (-2.0, 2.0);
const BODE_POINTS: u32 = 600;
/// The root locus shows this far to the left and up, times the fastest pole of the closed loop.
const LOCUS_REACH: f64 = 1.5;

/// Draws a loop; the sampled one beside it where `period_s` is known.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn draw(path: &Path, of: &Loop, period_s: Option<f64>) -> Result<(), PlotError> {
    let continuous = of.plant.continuous();
    let sampled = period_s.and_then(|period_s| of.plant.sampled(period_s).ok());
    let svg = drawn(SIZE, |area| {
        let panels = area.split_evenly((2, 2));
        let plants = || [("continuous", CONTINUOUS, Some(continuous)), ("sampled", SAMPLED, sampled)];
        let lines = |points: fn(&Loop, &Transfer) -> Vec<(f64, f64)>| -> Vec<Line> {
            let line = |(label, colour, plant): (&'static str, RGBColor, Option<Transfer>)| {
                Some(Line { label, colour, points: points(of, &plant?) })
            };
            plants().into_iter().filter_map(line).collect()
        };
        let (locus, poles) = root_locus(of, &continuous);
        let [steps, gains, phases] = [lines(step_points), lines(decibels), lines(degrees)];
        let of = |title, abscissa, ordinate, lines| Panel { title, abscissa, ordinate, lines, ..Panel::default() };
        let frequency = "frequency, log₁₀ of rad/s";
        panel(&panels[0], of("step of the setpoint", "time, s", "position, share of the step", &steps))?;
        let plane =
            of("root locus and poles (×)", "real part, 1/s", "imaginary part, 1/s", std::slice::from_ref(&locus));
        panel(&panels[1], Panel { marks: &poles, ..plane })?;
        panel(&panels[2], of("open loop: magnitude", frequency, "magnitude, dB", &gains))?;
        panel(&panels[3], of("open loop: phase", frequency, "phase, degrees", &phases))
    })?;
    write(path, &svg)
}

fn step_points(of: &Loop, plant: &Transfer) -> Vec<(f64, f64)> {
    let response = step::response(&closed(&of.gains, plant, of.derivative_on_error));
    let figures = step::figures(&closed(&of.gains, plant, of.derivative_on_error));
    // Beyond twice the settling there is nothing to see.
    let end_s = figures.map_or(0.0, |figures| (2.0 * figures.settling_s).max(1.0));
    // A line of one point, where the loop is not stable: the axes still stand.
    response.map_or_else(|| vec![(0.0, 0.0)], |response| response.take_while(|(time_s, _)| *time_s <= end_s).collect())
}

/// The poles of the closed loop over the gain, and where they are at the loop's own.
fn root_locus(of: &Loop, plant: &Transfer) -> (Line, Vec<(f64, f64)>) {
    let open = of.gains.feedback(plant.plane).then(plant);
    let poles: Vec<(f64, f64)> = open.closed_poles(1.0).iter().map(|pole| (pole.re, pole.im)).collect();
    let reach = LOCUS_REACH * poles.iter().map(|(re, im)| re.hypot(*im)).fold(0.0, f64::max);
    let mut points = Vec::new();
    for k in 0..=LOCUS_POINTS {
        let gain = 10.0_f64.powf(LOCUS_DECADES * (2.0 * f64::from(k) / f64::from(LOCUS_POINTS) - 1.0));
        for pole in open.closed_poles(gain).iter().filter(|pole| pole.re.hypot(pole.im) <= reach) {
            // Dots: a piece of its own for each, as the order of the roots says nothing.
            points.extend([(pole.re, pole.im), (pole.re + 2e-3 * reach, pole.im), (f64::NAN, f64::NAN)]);
        }
    }
    (Line { label: "gain from 1/100 to 100 times", colour: SETPOINT, points }, poles)
}

fn bode(of: &Loop, plant: &Transfer, value: impl Fn(control::design::Complex<f64>) -> f64) -> Vec<(f64, f64)> {
    let open = of.gains.feedback(plant.plane).then(plant);
    let highest = match plant.plane {
        control::design::Plane::Continuous => BODE.1,
        control::design::Plane::Sampled(period_s) => (std::f64::consts::PI / period_s).log10().min(BODE.1),
    };
    let at = |k: u32| BODE.0 + (highest - BODE.0) * f64::from(k) / f64::from(BODE_POINTS);
    (0..=BODE_POINTS).map(|k| (at(k), value(open.response(10.0_f64.powf(at(k)))))).collect()
}

fn decibels(of: &Loop, plant: &Transfer) -> Vec<(f64, f64)> {
    bode(of, plant, |value| 20.0 * magnitude(value).log10())
}

/// Without the jumps of a whole turn.
fn degrees(of: &Loop, plant: &Transfer) -> Vec<(f64, f64)> {
    let mut points = bode(of, plant, |value| value.im.atan2(value.re).to_degrees());
    let mut last = -180.0;
    for (_, phase) in &mut points {
        *phase -= 360.0 * ((*phase - last) / 360.0).round();
        last = *phase;
    }
    points
}

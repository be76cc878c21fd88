//! The picture of a design, as SVG: step and Bode diagram with the margins, root locus and poles in s and in z.

mod locus;

use crate::analysis::loop_margins::Loop;
use crate::report::kit::palette::{NOMINAL, RECORDED, SETPOINT};
use crate::report::kit::plot::{Diagram, Line, PlotError, drawn, failed, panel, unwrapped, write};
use control::design::law::Law;
use control::design::margins::{gain_margins, phase_margins};
use control::design::polynomial::magnitude;
use control::design::{Complex, DesignError, Plane, Transfer, step};
use locus::locus;
use plotters::style::RGBColor;
use std::f64::consts::PI;
use std::path::Path;

/// Size of the picture, pixels.
const SIZE: (u32, u32) = (1200, 1080);
/// Frequencies of the Bode diagram, powers of ten of rad/s.
const BODE: (f64, f64) = (-2.0, 2.0);
const BODE_POINTS: u32 = 600;

/// One of the two forms of a loop.
struct Form {
    label: &'static str,
    colour: RGBColor,
    plant: Transfer,
    law: Law,
}

impl Form {
    fn open(&self) -> Transfer {
        self.law.feedback.then(&self.plant)
    }

    fn line(&self, points: Vec<(f64, f64)>) -> Line {
        Line { label: self.label, colour: self.colour, points }
    }
}

/// The diagrams of a loop.
pub struct Diagrams {
    /// Step of the setpoint.
    pub step: Diagram,
    /// Magnitude and phase of the open loop, with rings at the margins.
    pub bode: [Diagram; 2],
    /// Control value at a step of the setpoint of 1 mm, and position at a step of the disturbance of 1 unit of it.
    pub effort: [Diagram; 2],
    /// Root loci: in s and, where the period is known, in z.
    pub loci: Vec<Diagram>,
}

impl Diagrams {
    /// The diagrams of a loop in continuous time and, where its period is known, sampled.
    ///
    /// # Errors
    /// [`PlotError::Draw`]: a delay that is too long, an observer that has no steady gain.
    pub fn of(of: &Loop) -> Result<Self, PlotError> {
        let forms = forms(of).map_err(failed)?;
        let (step, bode) = (of_step(&forms), [of_bode(&forms, true), of_bode(&forms, false)]);
        Ok(Self { step, bode, effort: effort(&forms), loci: forms.iter().map(locus).collect() })
    }
}

/// Draws a loop, in continuous time and, where its period is known, sampled.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn draw(path: &Path, of: &Loop) -> Result<(), PlotError> {
    let Diagrams { step, bode: [magnitude, phase], loci, .. } = Diagrams::of(of)?;
    let svg = drawn(SIZE, |area| {
        let (width, _) = area.dim_in_pixel();
        let (left, right) = area.split_horizontally(width / 2);
        let left = left.split_evenly((3, 1));
        for (area, diagram) in left.iter().zip([&step, &magnitude, &phase]) {
            panel(area, diagram)?;
        }
        right.split_evenly((2, 1)).iter().zip(&loci).try_for_each(|(area, diagram)| panel(area, diagram))
    })?;
    write(path, &svg)
}

/// Continuous and, where the period is known, sampled.
fn forms(of: &Loop) -> Result<Vec<Form>, DesignError> {
    let form = |label, colour, plant: Transfer| Ok(Form { label, colour, plant, law: of.law(plant.plane)? });
    let mut forms = vec![form("continuous", RECORDED, of.plant.continuous())?];
    if let Some(period_s) = of.period_s {
        forms.push(form("sampled", NOMINAL, of.plant.sampled(period_s)?)?);
    }
    Ok(forms)
}

fn of_step(forms: &[Form]) -> Diagram {
    let lines = step_lines(forms);
    let title = if lines.iter().any(|line| line.points.is_empty()) {
        "step of the setpoint (none where the loop is not stable)"
    } else {
        "step of the setpoint"
    };
    Diagram { title: title.into(), abscissa: "time, s", ordinate: "share of the step", lines, ..Diagram::default() }
}

/// The steps of all forms over the same time, and the setpoint.
fn step_lines(forms: &[Form]) -> Vec<Line> {
    let closed: Vec<Transfer> = forms.iter().map(|form| form.law.closed(&form.plant)).collect();
    // Beyond twice the longest settling time nothing changes.
    let settled_s = closed.iter().filter_map(step::figures).map(|figures| figures.settling_s).fold(0.5, f64::max);
    let end_s = 2.0 * settled_s;
    let points = |closed: &Transfer| -> Vec<(f64, f64)> {
        let Some(response) = step::response(closed) else { return vec![] };
        let mut points: Vec<_> = response.take_while(|(time_s, _)| *time_s < end_s).collect();
        // A response ends where its slowest pole has decayed; from there it is drawn as constant.
        points.extend(points.last().map(|(_, value)| (end_s, *value)));
        points
    };
    let mut lines: Vec<Line> = forms.iter().zip(&closed).map(|(form, closed)| form.line(points(closed))).collect();
    lines.push(Line { label: "setpoint", colour: SETPOINT, points: vec![(0.0, 1.0), (end_s, 1.0)] });
    lines
}

/// The control value that a step of the setpoint takes, and what a disturbance does to the position.
fn effort(forms: &[Form]) -> [Diagram; 2] {
    let over = |ordinate: &'static str, of: fn(&Form) -> Transfer| {
        let settled_s = forms.iter().filter_map(|form| step::figures(&form.law.closed(&form.plant)));
        let end_s = settled_s.map(|figures| 2.0 * figures.settling_s).fold(1.0, f64::max);
        let points = |form: &Form| {
            step::response(&of(form))
                .map_or_else(Vec::new, |response| response.take_while(|(time_s, _)| *time_s < end_s).collect())
        };
        let lines = forms.iter().map(|form| form.line(points(form))).collect();
        Diagram { abscissa: "time, s", ordinate, lines, base: Some(0.0), ..Diagram::default() }
    };
    [
        over("control value per mm of the step", |form| form.law.control(&form.plant)),
        over("mm per unit of the disturbance", |form| form.law.disturbed(&form.plant)),
    ]
}

/// The largest control value that a step of the setpoint of 1 mm takes; `None`: the loop is not stable.
#[must_use]
pub fn largest_control_per_mm(of: &Loop) -> Option<f64> {
    let forms = forms(of).ok()?;
    let last = forms.last()?;
    Some(step::response(&last.law.control(&last.plant))?.map(|(_, value)| value.abs()).fold(0.0, f64::max))
}

/// Magnitude or phase of the open loop, with rings at the margins.
fn of_bode(forms: &[Form], of_magnitude: bool) -> Diagram {
    let (level, ordinate) = if of_magnitude { (0.0, "magnitude, dB") } else { (-180.0, "phase, degrees") };
    let mut lines = vec![Line { label: "", colour: SETPOINT, points: vec![(BODE.0, level), (BODE.1, level)] }];
    let (mut rings, mut words) = (vec![], vec![]);
    for form in forms {
        let curve = if of_magnitude { decibels(form) } else { degrees(form) };
        let at = |omega: f64| interpolated(&curve, omega.log10());
        let open = form.open();
        if of_magnitude {
            let margins = gain_margins(&open);
            rings.extend(margins.iter().filter_map(|margin| at(margin.omega)));
            words.extend(margins.first().map(|margin| format!("{} ×{:.2}", form.label, margin.factor)));
        } else {
            let margins = phase_margins(&open);
            rings.extend(margins.iter().filter_map(|margin| at(margin.omega)));
            words.extend(margins.first().map(|margin| format!("{} {:.0}°", form.label, margin.phase_deg)));
        }
        lines.push(form.line(curve));
    }
    let what = if of_magnitude { "gain" } else { "phase" };
    let title =
        format!("open loop, ○ {what} margin: {}", if words.is_empty() { "none".into() } else { words.join(", ") });
    let abscissa = "frequency, rad/s";
    Diagram { title, abscissa, ordinate, lines, rings, decades: true, ..Diagram::default() }
}

/// The value of a curve of rising abscissae at `x`; `None` outside.
fn interpolated(curve: &[(f64, f64)], x: f64) -> Option<(f64, f64)> {
    let above = curve.partition_point(|point| point.0 <= x);
    let (a, b) = (curve.get(above.checked_sub(1)?)?, curve.get(above)?);
    Some((x, a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0)))
}

fn bode(form: &Form, value: impl Fn(Complex<f64>) -> f64) -> Vec<(f64, f64)> {
    let open = form.open();
    let highest = match form.plant.plane {
        Plane::Continuous => BODE.1,
        Plane::Sampled(period_s) => (PI / period_s).log10().min(BODE.1),
    };
    let at = |k: u32| BODE.0 + (highest - BODE.0) * f64::from(k) / f64::from(BODE_POINTS);
    (0..=BODE_POINTS).map(|k| (at(k), value(open.response(10.0_f64.powf(at(k)))))).collect()
}

fn decibels(form: &Form) -> Vec<(f64, f64)> {
    bode(form, |value| 20.0 * magnitude(value).log10())
}

fn degrees(form: &Form) -> Vec<(f64, f64)> {
    unwrapped(bode(form, |value| value.im.atan2(value.re).to_degrees()))
}

#[cfg(test)]
mod tests {
    use super::{Loop, degrees, effort, forms, interpolated, largest_control_per_mm, step_lines};
    use crate::analysis::loop_margins::Closing;
    use control::design::Linear;
    use control::design::law::{Gains, Weights};

    /// The thesis' three-pole model under a PID, every 20 ms.
    pub fn thesis(kp_per_mm: f64) -> Loop {
        let gains = Gains { kp_per_mm, ti_s: 15.0, td_s: 0.35, derivative_n: 10.0 };
        let closing = Closing::Pid(gains, Weights::MEASUREMENT);
        Loop { plant: Linear::three_poles(827.2, 3.896, 3.896), closing, period_s: Some(0.02) }
    }

    #[test]
    fn both_steps_are_drawn_over_the_same_time_and_end_at_the_setpoint() {
        let lines = step_lines(&forms(&thesis(0.018)).unwrap());
        let ends: Vec<(f64, f64)> = lines.iter().map(|line| *line.points.last().unwrap()).collect();
        assert_eq!(ends.len(), 3);
        for (time_s, value) in &ends {
            assert!(*time_s == ends[0].0 && (value - 1.0).abs() < 0.05, "{ends:?}");
        }
    }

    #[test]
    fn the_first_control_value_of_a_step_is_the_proportional_part() {
        let (of, kp) = (thesis(0.018), 0.018);
        let [control, disturbed] = effort(&forms(&of).unwrap());
        for line in &control.lines {
            assert!((line.points[0].1 - kp).abs() < 0.05 * kp, "{:?}", line.points[0]);
        }
        assert!((largest_control_per_mm(&of).unwrap() - kp).abs() < 0.05 * kp);
        // The integral takes a constant disturbance away.
        let last = disturbed.lines[1].points.last().unwrap().1;
        let most = disturbed.lines[1].points.iter().map(|point| point.1).fold(0.0, f64::max);
        assert!(most > 0.0 && last < most, "{last} of {most}");
    }

    #[test]
    fn a_loop_that_is_not_stable_has_no_step_to_draw() {
        let lines = step_lines(&forms(&thesis(0.5)).unwrap());
        assert!(lines[0].points.is_empty() && lines[1].points.is_empty());
    }

    #[test]
    fn the_ring_of_a_margin_lies_on_its_curve() {
        // K/(s(s + a)²) is at −180° where ω = a.
        let gains = Gains { kp_per_mm: 0.01, ti_s: f64::INFINITY, td_s: 0.0, derivative_n: 10.0 };
        let of = Loop { closing: Closing::Pid(gains, Weights::MEASUREMENT), ..thesis(0.01) };
        let curve = degrees(&forms(&of).unwrap()[0]);
        let (_, phase) = interpolated(&curve, 3.896_f64.log10()).unwrap();
        assert!((phase + 180.0).abs() < 0.01, "{phase}");
    }
}

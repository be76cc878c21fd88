//! A design in words and as JSON.

use super::critical_gain::{RIG, Table as CriticalTable};
use crate::analysis::loop_margins::{Assessment, Closing, Loop, Pid, Plant};
use crate::report::kit::about::About;
use crate::report::kit::table::empty;
use crate::report::kit::words::digits;
use control::design::DesignError;
use control::state_feedback::{Integral, Lqg};
use plant::Model;
use serde::Serialize;

/// Gains and drags that differ by a smaller share are the same: far less than any margin of a design notices.
const SAME: f64 = 1e-3;

/// A state feedback u = K_r·r − K·x.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Feedback {
    /// K: for position, velocity and, with three, the acceleration by the fan.
    pub gain: Vec<f64>,
    /// K_r.
    pub setpoint_gain: f64,
    /// The integral of the config's state feedback, which is kept; `None`: there is none, or the observer estimates
    /// hover.
    pub integral: Option<Integral>,
}

/// A feedback of the observer's estimate, in units of the control value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimated {
    /// As in `[controller.lqg]`.
    pub feedback: Lqg,
    /// L: gain of position, velocity, fan and hover per millimetre of innovation.
    pub observer_gain: Vec<f64>,
}

/// The document of `airball design --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Document {
    /// Name and version of this document.
    pub schema: &'static str,
    /// The linear plant that was designed for.
    pub plant: Plant,
    /// The gains; `None`: the controller is no PID.
    pub pid: Option<Pid>,
    /// The state feedback that was designed.
    pub state_feedback: Option<Feedback>,
    /// The controller where it needs an observer.
    pub lqg: Option<Estimated>,
    /// Where the model was linearised, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub about: Option<About>,
    /// In continuous time.
    pub continuous: Assessment,
    /// Period of the sampled loop, seconds.
    pub period_s: Option<f64>,
    /// Sampled as the firmware does it.
    pub sampled: Option<Assessment>,
    /// Gain and drag at the lowest duty of a flight, at hover and at the highest, where an effect moves them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub over_duties: Vec<AtDuty>,
}

/// The plant about one duty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AtDuty {
    /// The duty, percent.
    pub duty_percent: f64,
    /// Acceleration per percent of duty there, mm/s² per percent.
    pub gain_mm_per_s2_per_percent: f64,
    /// Linear drag there, 1/s.
    pub drag_per_s: f64,
}

impl AtDuty {
    /// The plant about each of these duties at this height; none if gain and drag are the same at all of them.
    #[must_use]
    pub fn over(model: &Model, height_mm: f64, duties_percent: &[f64]) -> Vec<Self> {
        let at = |duty_percent: &f64| {
            let slopes = model.slopes_at(height_mm, *duty_percent);
            let plant::Slopes { gain_mm_per_s2_per_percent, drag_per_s, .. } = slopes;
            Self { duty_percent: *duty_percent, gain_mm_per_s2_per_percent, drag_per_s }
        };
        let all: Vec<Self> = duties_percent.iter().map(at).collect();
        let same = |a: f64, b: f64| (a - b).abs() <= SAME * b.abs();
        let constant = |one: &Self| {
            same(one.gain_mm_per_s2_per_percent, model.gain_mm_per_s2_per_percent)
                && same(one.drag_per_s, model.drag_per_s)
        };
        if all.iter().all(constant) { Vec::new() } else { all }
    }
}

impl Document {
    /// The document of a loop.
    ///
    /// # Errors
    /// [`DesignError`]: a delay that is too long, an observer that has no steady gain.
    pub fn of(
        of: &Loop,
        feedback: Option<Feedback>,
        about: Option<About>,
        over_duties: Vec<AtDuty>,
    ) -> Result<Self, DesignError> {
        let (pid, lqg) = match &of.closing {
            Closing::Pid(gains, weights) => (Some(Pid::of(gains, weights)), None),
            Closing::Lqg(observed) => {
                let gain =
                    of.period_s.map_or(Ok(vec![]), |t| observed.observer.steady_gain(t).map(|l| l.as_slice().to_vec()));
                (None, Some(Estimated { feedback: observed.feedback, observer_gain: gain? }))
            }
        };
        Ok(Self {
            schema: "airball.design/1",
            plant: of.plant.into(),
            pid,
            state_feedback: feedback,
            lqg,
            about,
            continuous: of.continuous()?,
            period_s: of.period_s,
            sampled: of.sampled()?,
            over_duties,
        })
    }
}

/// The text of a figure in the table.
type Figure = fn(&Assessment) -> String;

/// The design in a few lines and a table.
#[must_use]
pub fn words(document: &Document) -> Vec<String> {
    let law = law(document).into_iter().map(|(name, words)| format!("{name:<10}{words}"));
    law.chain([table(document)]).collect()
}

/// The law line by line: name and value.
pub fn law(document: &Document) -> Vec<(&'static str, String)> {
    let mut lines = Vec::new();
    if let Some(feedback) = &document.state_feedback {
        let gain: Vec<String> = feedback.gain.iter().copied().map(digits).collect();
        lines.push(("feedback", format!("K = [{}], K_r = {}", gain.join(", "), digits(feedback.setpoint_gain))));
        lines.push(("", hover_is_found(document.lqg.is_some(), feedback.integral)));
    }
    if let Some(Pid { kp_per_mm, ti_s, td_s, derivative_n, setpoint_weight, derivative_weight }) = document.pid {
        let integral = if ti_s.is_finite() { format!("T_i = {} s", digits(ti_s)) } else { "no integral".into() };
        lines.push((
            "gains",
            format!(
                "K_p = {} per mm, {integral}, T_d = {} s, N = {}",
                digits(kp_per_mm),
                digits(td_s),
                digits(derivative_n)
            ),
        ));
        let derivative = if derivative_weight > 0.0 { "error" } else { "measurement" };
        lines.push(("weights", format!("setpoint {setpoint_weight:.3}, derivative on the {derivative}")));
    }
    if let Some(Estimated { feedback, observer_gain }) = &document.lqg {
        let Lqg { position_per_mm, velocity_s_per_mm, fan } = feedback;
        lines.push((
            "lqg",
            format!(
                "{} per mm, {} s per mm, fan {}",
                digits(*position_per_mm),
                digits(*velocity_s_per_mm),
                digits(*fan)
            ),
        ));
        let gain: Vec<String> = observer_gain.iter().copied().map(digits).collect();
        lines.push(("observer", format!("L = [{}] a reading: position, velocity, fan, hover", gain.join(", "))));
    }
    lines.extend(document.about.map(|about| ("about", about.words())));
    if !document.over_duties.is_empty() {
        let list = |value: fn(&AtDuty) -> String| document.over_duties.iter().map(value).collect::<Vec<_>>().join(", ");
        lines.push((
            "duties",
            format!(
                "at {} % the gain is {} mm/s² per percent and the drag {} 1/s",
                list(|at| format!("{:.1}", at.duty_percent)),
                list(|at| format!("{:.0}", at.gain_mm_per_s2_per_percent)),
                list(|at| format!("{:.2}", at.drag_per_s)),
            ),
        ));
    }
    lines
}

/// How a state feedback compensates an error of the believed hover.
fn hover_is_found(observed: bool, integral: Option<Integral>) -> String {
    match integral {
        _ if observed => "the observer finds hover".into(),
        Some(Integral::Added { ti_s }) => format!("the config's integral is kept: added, T_i = {ti_s} s"),
        Some(Integral::InPlace { ti_s }) => format!("the config's integral is kept: in place of K_r·r, T_i = {ti_s} s"),
        None => {
            "no integral: an error of hover stays as one of position; [controller.state_feedback] may have one".into()
        }
    }
}

fn table(document: &Document) -> String {
    let sampled = document.period_s.map_or_else(|| "sampled".into(), |period_s| format!("sampled, {period_s} s"));
    let mut table = empty(["", "continuous", &sampled]);
    for (name, [continuous, sampled]) in rows(document) {
        table.add_row([name.to_owned(), continuous, sampled]);
    }
    table.to_string()
}

/// Margins and step metrics: each figure in continuous time and sampled.
pub fn rows(document: &Document) -> Vec<(&'static str, [String; 2])> {
    let both = |say: Figure| [say(&document.continuous), document.sampled.as_ref().map_or_else(String::new, say)];
    let rows: [(&'static str, Figure); 10] = [
        ("stable", |a| if a.stable { "yes".into() } else { "no".into() }),
        ("gain margins", |a| {
            list(
                a.gain_margins
                    .iter()
                    .map(|m| format!("×{:.2} ({:.1} dB) at {:.2} rad/s", m.factor, 20.0 * m.factor.log10(), m.omega)),
            )
        }),
        ("phase margins", |a| {
            list(a.phase_margins.iter().map(|m| format!("{:.1}° at {:.2} rad/s", m.phase_deg, m.omega)))
        }),
        ("delay margin", |a| said(a.phase_margins.iter().map(|m| m.delay_s).reduce(f64::min), 3, " s", "none")),
        ("peak sensitivity M_s", |a| said(a.peak_sensitivity, 2, "", "–")),
        ("critical K_p", |a| said(a.critical_kp_per_mm, 5, " per mm", "none")),
        ("critical T_i", |a| said(a.critical_ti_s, 3, " s", "none")),
        ("overshoot", |a| said(a.step.map(|s| s.overshoot_percent), 1, " %", "–")),
        ("rise, 10 to 90 %", |a| said(a.step.map(|s| s.rise_s), 2, " s", "–")),
        ("settled to ±5 %", |a| said(a.step.map(|s| s.settling_s), 2, " s", "–")),
    ];
    // The critical gains are those of a PID.
    let is_said = |name: &str| !name.starts_with("critical") || document.pid.is_some();
    rows.into_iter().filter(|(name, _)| is_said(name)).map(|(name, say)| (name, both(say))).collect()
}

/// The critical gains of the models and the rig.
#[must_use]
pub fn critical_table(found: &CriticalTable) -> String {
    let at = format!("K_u at T_i = {} s", found.ti_s);
    let sampled = format!("sampled, {} s", found.period_s);
    let slowest = format!("T_i at K_p = {}", found.kp_per_mm);
    let mut table = empty(["model", "fan's pole", &at, &sampled, &slowest]);
    for row in &found.rows {
        table.add_row([
            row.model.clone(),
            said(row.fan_pole_per_s, 3, " 1/s", ""),
            if row.model == RIG { String::new() } else { said(row.critical_kp_per_mm, 4, "", "none") },
            said(row.sampled_critical_kp_per_mm, 4, "", "none"),
            said(row.critical_ti_s, 3, " s", "none"),
        ]);
    }
    table.to_string()
}

fn list(items: impl Iterator<Item = String>) -> String {
    let all: Vec<String> = items.collect();
    if all.is_empty() { "none".into() } else { all.join(", ") }
}

fn said(value: Option<f64>, digits: usize, unit: &str, absent: &str) -> String {
    value.map_or_else(|| absent.to_owned(), |value| format!("{value:.digits$}{unit}"))
}

#[cfg(test)]
mod tests {
    use super::AtDuty;
    use plant::effects::RelativeAirflow;
    use plant::{Effects, Model, Noise};

    fn model(effects: Effects) -> Model {
        Model {
            gain_mm_per_s2_per_percent: 200.0,
            drag_per_s: 2.0,
            hover_duty_percent: 20.0,
            pipe_bottom_mm: 0.0,
            pipe_length_mm: 600.0,
            turn_mm: None,
            noise: Noise { sensor_mm: 2.0, acceleration_psd_mm2_per_s3: 360.0 },
            effects,
        }
    }

    #[test]
    fn the_drag_at_each_duty_is_that_of_the_air_there_and_a_linear_plant_has_no_list() {
        assert_eq!(AtDuty::over(&model(Effects::default()), 300.0, &[10.0, 20.0, 30.0]), []);
        let air = RelativeAirflow { inverse_speed_s_per_mm: 1e-3 };
        let model = model(Effects { relative_airflow: Some(air), ..Effects::default() });
        // Drag a·√(1 + 2·q·A/a) with A = gain·(duty − hover): 2·√1, 2·√3.
        for (at, drag) in AtDuty::over(&model, 300.0, &[20.0, 30.0]).iter().zip([2.0, 2.0 * 3.0_f64.sqrt()]) {
            assert!((at.drag_per_s - drag).abs() < 1e-5, "{at:?}, exact {drag}");
            assert!((at.gain_mm_per_s2_per_percent - 200.0).abs() < 1e-5, "{at:?}");
        }
    }
}

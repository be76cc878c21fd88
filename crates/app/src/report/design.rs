//! A design in words, as JSON and as a config patch.

use crate::assessment::{Assessment, Loop, Pid, Plant};
use crate::commands::design::Table as CriticalTable;
use anyhow::{Result, bail};
use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{CellAlignment, Table, TableComponent};
use serde::Serialize;

/// A state feedback u = K_r·r − K·x.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Feedback {
    /// K: for position, velocity and, with three, the acceleration by the fan.
    pub gain: Vec<f64>,
    /// K_r.
    pub setpoint_gain: f64,
}

/// The document of `airball design --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Document {
    /// Name and version of this document.
    pub schema: &'static str,
    /// The linear plant that was designed for.
    pub plant: Plant,
    /// The gains.
    pub pid: Pid,
    /// The state feedback behind the gains.
    pub state_feedback: Option<Feedback>,
    /// In continuous time.
    pub continuous: Assessment,
    /// Period of the sampled loop, seconds.
    pub period_s: Option<f64>,
    /// Sampled as the firmware does it.
    pub sampled: Option<Assessment>,
}

impl Document {
    /// The document of a loop.
    #[must_use]
    pub fn of(of: &Loop, feedback: Option<Feedback>, period_s: Option<f64>, sampled: Option<Assessment>) -> Self {
        Self {
            schema: "airball.design/1",
            plant: of.plant.into(),
            pid: of.gains.into(),
            state_feedback: feedback,
            continuous: of.continuous(),
            period_s,
            sampled,
        }
    }
}

/// The gains as a config patch. A feedback of position and velocity is a PID without integral.
///
/// # Errors
/// A feedback of the fan's state needs an observer and is no PID.
pub fn patch(document: &Document) -> Result<String> {
    if document.state_feedback.as_ref().is_some_and(|feedback| feedback.gain.len() > 2) {
        bail!(
            "a gain on the fan's state needs an observer and is no PID; take it from --json, or design without the fan"
        );
    }
    let Pid { kp_per_mm, ti_s, td_s, derivative_n } = document.pid;
    Ok(format!(
        "[controller.pid]\nkp_per_mm = {kp_per_mm:?}\nti_s = {ti_s:?}\ntd_s = {td_s:?}\n\
         derivative_n = {derivative_n:?}\nderivative_on = \"measurement\"\n"
    ))
}

/// How a line of the table says its figure.
type Figure = fn(&Assessment) -> String;

/// The design in a few lines and a table.
#[must_use]
pub fn words(document: &Document) -> Vec<String> {
    let Pid { kp_per_mm, ti_s, td_s, derivative_n } = document.pid;
    let mut lines = Vec::new();
    if let Some(feedback) = &document.state_feedback {
        let gain: Vec<String> = feedback.gain.iter().map(|k| format!("{k:.6}")).collect();
        lines.push(format!("feedback  K = [{}], K_r = {:.6}", gain.join(", "), feedback.setpoint_gain));
        if feedback.gain.len() > 2 {
            lines.push("          the table is without the fan's gain, which needs an observer".into());
        }
    }
    let integral = if ti_s.is_finite() { format!("T_i = {ti_s:.4} s") } else { "no integral".into() };
    lines.push(format!("gains     K_p = {kp_per_mm:.6} per mm, {integral}, T_d = {td_s:.4} s, N = {derivative_n}"));
    lines.push(table(document));
    lines
}

fn table(document: &Document) -> String {
    let sampled = document.period_s.map_or_else(|| "sampled".into(), |period_s| format!("sampled, {period_s} s"));
    let mut table = empty(["", "continuous", &sampled]);
    let both = |say: Figure| [say(&document.continuous), document.sampled.as_ref().map_or_else(String::new, say)];
    let rows: [(&str, Figure); 9] = [
        ("stable", |a| if a.stable { "yes".into() } else { "no".into() }),
        ("gain margins", |a| list(a.gain_margins.iter().map(|m| format!("×{:.2} at {:.2} rad/s", m.factor, m.omega)))),
        ("phase margins", |a| {
            list(a.phase_margins.iter().map(|m| format!("{:.1}° at {:.2} rad/s", m.phase_deg, m.omega)))
        }),
        ("delay margin", |a| said(a.phase_margins.iter().map(|m| m.delay_s).reduce(f64::min), 3, " s", "none")),
        ("critical K_p", |a| said(a.critical_kp_per_mm, 5, " per mm", "none")),
        ("critical T_i", |a| said(a.critical_ti_s, 3, " s", "none")),
        ("overshoot", |a| said(a.step.map(|s| s.overshoot_percent), 1, " %", "–")),
        ("rise, 10 to 90 %", |a| said(a.step.map(|s| s.rise_s), 2, " s", "–")),
        ("settled to ±5 %", |a| said(a.step.map(|s| s.settling_s), 2, " s", "–")),
    ];
    for (name, say) in rows {
        let [continuous, sampled] = both(say);
        table.add_row([name.to_owned(), continuous, sampled]);
    }
    table.to_string()
}

/// The critical gains of the models beside the rig.
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
            if row.model == "the rig" { String::new() } else { said(row.critical_kp_per_mm, 4, "", "none") },
            said(row.sampled_critical_kp_per_mm, 4, "", "none"),
            said(row.critical_ti_s, 3, " s", "none"),
        ]);
    }
    table.to_string()
}

fn empty<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table.load_preset(UTF8_HORIZONTAL_ONLY);
    table.remove_style(TableComponent::HorizontalLines).remove_style(TableComponent::MiddleIntersections);
    table.set_header(header);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn list(items: impl Iterator<Item = String>) -> String {
    let all: Vec<String> = items.collect();
    if all.is_empty() { "none".into() } else { all.join(", ") }
}

fn said(value: Option<f64>, digits: usize, unit: &str, absent: &str) -> String {
    value.map_or_else(|| absent.to_owned(), |value| format!("{value:.digits$}{unit}"))
}

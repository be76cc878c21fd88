//! `airball design critical-gain`: the thesis' table of critical gains, and the third pole that explains the
//! difference.
//!
//! The two-pole models are stable at every gain, and the rig is not: its fan has a pole. That pole is chosen so that
//! the model's critical gain is the measured one. It then predicts the critical integral time, which was measured as
//! well and not used.

use super::gains::above_zero;
use super::{NAME, write};
use crate::cli::CriticalGainArgs;
use crate::commands::{announce, may_write, say, typed};
use crate::report::design::critical_gain::{RIG, Row, Table};
use crate::report::design::page::critical::{self, Report};
use crate::report::design::words::critical_table;
use crate::report::kit::page;
use crate::report::kit::patch::rounded;
use anyhow::Result;
use config::Config;
use control::design::critical::{critical_gain as of_gain, critical_integral_time, third_pole};
use control::design::law::Gains;
use control::design::{DesignError, Linear};

/// What the thesis measured on the rig: the critical T_i at K_p = 0.01, seconds.
const RIG_TI_S: f64 = 0.69;

pub(super) fn critical_gain(args: &CriticalGainArgs) -> Result<()> {
    for (flag, value) in
        [("--measured", args.measured), ("--ti-s", args.ti_s), ("--kp", args.kp), ("--period-s", args.period_s)]
    {
        above_zero(flag, value)?;
    }
    may_write(None, args.html.as_deref(), &[("patch", args.patch_out.as_ref())])?;
    let patch = args.patch_out.as_ref().map(|_| patch(args)).transpose()?;
    if let Some((path, patch)) = args.patch_out.as_ref().zip(patch.as_ref()) {
        write("patch", path, patch)?;
    }
    let table = table(args)?;
    let gaps = gap(&table);
    if let Some(path) = &args.html {
        let config = args.config.display().to_string();
        let patch = patch.as_ref().map(|patch| (config.as_str(), patch.as_str()));
        let made = typed().in_config([&args.config]);
        page::write(path, &critical::page(&Report { made: &made, found: &table, gaps: &gaps, patch }))?;
    }
    if args.json {
        say(serde_json::to_string(&table)?)?;
    } else {
        say(critical_table(&table))?;
        gaps.into_iter().try_for_each(say)?;
    }
    announce(args.json, &[("patch", args.patch_out.as_deref()), ("page", args.html.as_deref())])
}

/// The third pole of the config's model, as a patch.
fn patch(args: &CriticalGainArgs) -> Result<String> {
    let config = Config::read(&args.config, &[])?;
    let model = config.need(NAME, "plant", |tables| tables.plant.as_ref())?;
    let lag_s = 1.0 / third_pole(&model.linear(), args.ti_s, args.measured)?;
    let origin = format!("# Critical gain {} at T_i = {} s, as measured.\n", args.measured, args.ti_s);
    Ok(rounded(&format!("{origin}[plant.effects.fan_lag]\ntime_constant_s = {lag_s}\n")))
}

/// The difference between each model of the thesis and the rig, in words.
fn gap(table: &Table) -> Vec<String> {
    let rig = table.rows.iter().find(|row| row.model == RIG);
    let (Some(gain), Some(ti_s)) =
        (rig.and_then(|rig| rig.sampled_critical_kp_per_mm), rig.and_then(|rig| rig.critical_ti_s))
    else {
        return vec![];
    };
    let off = |value: f64, measured: f64| format!("{:+.0} %", 100.0 * (value / measured - 1.0));
    let models = table.rows.iter().take_while(|row| row.model != RIG);
    let words = |row: &Row| {
        let gain = row
            .critical_kp_per_mm
            .map_or_else(|| "stable at any gain".into(), |found| format!("K_u {}", off(found, gain)));
        let ti = row.critical_ti_s.map_or_else(|| "none".into(), |found| off(found, ti_s));
        format!("{} against the rig: {gain}, critical T_i {ti}", row.model)
    };
    models.map(words).collect()
}

/// G_a by the transient method, G_b and G_c by the grey box with two and three poles; the thesis, section 3.1.
fn thesis() -> [(&'static str, Linear); 3] {
    [
        ("G_a", Linear::two_poles(254.598, 1.889)),
        ("G_b", Linear::two_poles(423.4, 1.595)),
        ("G_c", Linear::three_poles(3222.8 / 3.896, 3.896, 3.896)),
    ]
}

fn table(args: &CriticalGainArgs) -> Result<Table, DesignError> {
    let mut rows = Vec::new();
    for (name, plant) in thesis() {
        rows.push(row(name.into(), &plant, args)?);
    }
    rows.push(Row {
        model: RIG.into(),
        fan_pole_per_s: None,
        critical_kp_per_mm: None,
        sampled_critical_kp_per_mm: Some(args.measured),
        critical_ti_s: Some(RIG_TI_S),
    });
    for (name, plant) in thesis() {
        let pole = third_pole(&plant, args.ti_s, args.measured)?;
        let with_pole = Linear::three_poles(plant.gain, plant.drag_per_s, pole);
        rows.push(row(format!("{name}, third pole chosen"), &with_pole, args)?);
    }
    Ok(Table { schema: "airball.critical_gain/1", ti_s: args.ti_s, kp_per_mm: args.kp, period_s: args.period_s, rows })
}

fn row(model: String, plant: &Linear, args: &CriticalGainArgs) -> Result<Row, DesignError> {
    let (continuous, sampled) = (plant.continuous(), plant.sampled(args.period_s)?);
    let gains = Gains::pi(args.kp, args.ti_s);
    Ok(Row {
        model,
        fan_pole_per_s: (plant.fan_lag_s > 0.0).then(|| 1.0 / plant.fan_lag_s),
        critical_kp_per_mm: of_gain(&gains, &continuous).value(),
        sampled_critical_kp_per_mm: of_gain(&gains, &sampled).value(),
        critical_ti_s: critical_integral_time(&gains, &continuous).value(),
    })
}

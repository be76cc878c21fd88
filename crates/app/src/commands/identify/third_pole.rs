//! `airball identify third-pole`: the fan's lag from the critical gain of the rig.

use super::{NAME, conclude, config, has_one_lag, may_write, write_patch};
use crate::analysis::loop_margins::{Closing, Loop};
use crate::cli::ThirdPoleArgs;
use crate::commands::typed;
use crate::report::design::plot;
use crate::report::identify::page::third_pole::{Report, page as html};
use crate::report::identify::third_pole::{Document, lines, patch};
use crate::report::kit::page;
use ::diagnose::identify::fan_lag_s;
use anyhow::Result;
use config::Config;
use control::design::Linear;
use control::design::critical::critical_integral_time;
use control::design::law::{Gains, Weights};

pub(super) fn third_pole(args: &ThirdPoleArgs) -> Result<()> {
    let asked = &args.identify;
    may_write(asked.plot.as_deref(), asked.html.as_deref(), &[("patch", asked.patch_out.as_ref())])?;
    let read = Config::read(&args.identify.config.config, &args.identify.config.over())?;
    let model = read.need(NAME, "plant", |tables| tables.plant.as_ref())?;
    has_one_lag(model)?;
    let period_s = match args.sampled {
        true => Some(read.need(NAME, "loop", |tables| tables.r#loop.as_ref())?.period_s),
        false => None,
    };
    let (ti_s, measured) = (args.integral_time, args.critical_gain);
    let lag_s = fan_lag_s(&model.linear(), ti_s, measured, period_s)?;
    let plant = Linear { fan_lag_s: lag_s, ..model.linear() };
    let half = Gains::pi(0.5 * measured, ti_s);
    let transfer = period_s.map_or_else(|| Ok(plant.continuous()), |period_s| plant.sampled(period_s))?;
    let document = Document {
        schema: "airball.identify/1",
        method: "third_pole",
        critical_gain_per_mm: measured,
        integral_time_s: ti_s,
        period_s,
        fan_lag_s: lag_s,
        fan_pole_per_s: 1.0 / lag_s,
        lag_before_s: model.linear().fan_lag_s,
        critical_ti_s: critical_integral_time(&half, &transfer).value(),
    };
    let patch = patch(&document);
    write_patch(&args.identify, &patch)?;
    let half = Loop { plant, closing: Closing::Pid(half, Weights::MEASUREMENT), period_s };
    if let Some(path) = &args.identify.plot {
        plot::draw(path, &half)?;
    }
    if let Some(path) = &args.identify.html {
        let config = config(&args.identify);
        let made = typed().of_model(model).in_config(args.identify.config.files());
        let report = Report { made: &made, config: &config, found: &document, half: &half, patch: &patch };
        page::write(path, &html(&report)?)?;
    }
    conclude(&args.identify, &document, lines(&document))
}

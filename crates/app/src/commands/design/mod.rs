//! `airball design`: gains for the model of a config, and the margins of the loop.

mod critical_gain;
mod gains;
mod observer;
mod patch;

use super::about::asked;
use super::{announce, may_write, note, say, typed, write};
use crate::analysis::loop_margins::{Closing, Loop};
use crate::cli::{AboutArgs, DesignArgs, DesignCommand, LqrArgs, PidArgs, PolesArgs, RelayArgs};
use crate::report::design::page::{Report, page as html};
use crate::report::design::plot;
use crate::report::design::words::{AtDuty, Document, Feedback, words};
use crate::report::kit::about::About;
use crate::report::kit::page;
use anyhow::{Result, bail};
use config::Config;
use control::design::Linear;
use control::predistortion::Predistortion;
use gains::DesignedGains;
use plant::Model;

/// The command's name for configs and errors.
const NAME: &str = "design";

/// Runs the design and prints it.
///
/// # Errors
/// A config that is not sound, a design that does not exist, a file that cannot be written.
pub fn design(command: &DesignCommand) -> Result<()> {
    match command {
        DesignCommand::Observer(args) => observer::observer(args),
        DesignCommand::CriticalGain(args) => critical_gain::critical_gain(args),
        _ => conclude(command),
    }
}

/// The flags that all designs of gains have; `None` for the others.
const fn flags_of_gains(command: &DesignCommand) -> Option<&DesignArgs> {
    match command {
        DesignCommand::Loop(args) => Some(args),
        DesignCommand::Pid(PidArgs { design, .. })
        | DesignCommand::Poles(PolesArgs { design, .. })
        | DesignCommand::Lqr(LqrArgs { design, .. })
        | DesignCommand::Relay(RelayArgs { design, .. }) => Some(design),
        DesignCommand::Observer(_) | DesignCommand::CriticalGain(_) => None,
    }
}

/// Designs gains, and prints them.
fn conclude(command: &DesignCommand) -> Result<()> {
    let Some(args) = flags_of_gains(command) else { bail!("this design has no gains") };
    let ground = Ground::read(args)?;
    let (closing, feedback) = designed_gains(command, &ground)?;
    ground.conclude(args, closing, feedback)
}

/// The gains of those designs that have gains.
fn designed_gains(command: &DesignCommand, ground: &Ground) -> Result<DesignedGains> {
    match command {
        DesignCommand::Loop(_) => gains::of_config(ground),
        DesignCommand::Pid(args) => gains::pid(ground, args),
        DesignCommand::Poles(args) => gains::poles(ground, args),
        DesignCommand::Lqr(args) => gains::lqr(ground, args),
        DesignCommand::Relay(args) => gains::relay(ground, args),
        DesignCommand::Observer(_) | DesignCommand::CriticalGain(_) => bail!("this design has no gains"),
    }
}

/// A design as its document, its words and its patch.
pub(crate) struct Designed {
    /// The document of `--json`.
    pub(crate) document: String,
    /// The result in lines; of an observer, none.
    pub(crate) words: Vec<String>,
    /// The design as a patch of the config.
    pub(crate) patch: String,
    /// What the design does not see.
    pub(crate) notes: Vec<String>,
}

/// Designs for a config that is read.
///
/// # Errors
/// A design that does not exist.
pub(crate) fn designed(command: &DesignCommand, config: Config) -> Result<Designed> {
    let about = match (command, flags_of_gains(command)) {
        (DesignCommand::Observer(args), _) => args.about,
        (_, Some(args)) => args.about,
        _ => bail!("critical-gain compares the models of the thesis, and takes no config"),
    };
    let ground = Ground::of(config, about)?;
    let notes = ground.model.not_linear().into_iter().map(|name| not_linear(name, ground.about.as_ref())).collect();
    if let DesignCommand::Observer(args) = command {
        let (document, patch) = observer::found(&ground, args)?;
        return Ok(Designed { document: serde_json::to_string(&document)?, words: Vec::new(), patch, notes });
    }
    let (closing, feedback) = designed_gains(command, &ground)?;
    let (_, document) = ground.assessed(closing, feedback)?;
    let patch = patch::of(&closing, document.state_feedback.as_ref())?;
    Ok(Designed { document: serde_json::to_string(&document)?, words: words(&document), patch, notes })
}

/// The inputs of a design.
struct Ground {
    config: Config,
    model: Model,
    /// The linear part of the model, its gain per unit of the control value.
    plant: Linear,
    /// Linearised where; `None`: about hover, and of linear effects alone.
    about: Option<About>,
}

impl Ground {
    fn read(args: &DesignArgs) -> Result<Self> {
        may_write(args.plot.as_deref(), args.html.as_deref(), &[("patch", args.patch_out.as_ref())])?;
        Self::of(Config::read(&args.config.config, &args.config.over())?, args.about)
    }

    fn of(config: Config, about: AboutArgs) -> Result<Self> {
        let model = config.need(NAME, "plant", |tables| tables.plant.as_ref())?.clone();
        let curve = config.tables.compensation.as_ref().and_then(|table| table.predistortion.as_ref());
        let percent_per_control = curve.map(Predistortion::curve).map_or(1.0, |curve| curve.percent_per_mm_per_s2());
        let about = asked(&model, about)?;
        let linear = about.as_ref().map_or_else(|| model.linear(), |about| about.linear(&model));
        let plant = Linear { gain: linear.gain * percent_per_control, ..linear };
        Ok(Self { config, model, plant, about })
    }

    /// Time between samples, seconds, where the config has it.
    fn period_s(&self) -> Option<f64> {
        self.config.tables.r#loop.map(|table| table.period_s)
    }

    /// The plant at the lowest duty that the config allows, at hover and at the highest.
    fn over_duties(&self) -> Vec<AtDuty> {
        let Some(safety) = self.config.tables.safety.as_ref() else { return Vec::new() };
        let height_mm = self.about.map_or(self.model.middle_mm(), |about| about.position_mm);
        let duties = [safety.duty_min_percent, self.model.hover_duty_percent, safety.duty_max_percent];
        AtDuty::over(&self.model, height_mm, &duties)
    }

    /// The loop of the config's own PID; `None`: it has none, or it is the designed one.
    fn before(&self, designed: &Loop) -> Result<Option<Document>> {
        let Some(pid) = self.config.tables.controller.as_ref().and_then(|table| table.pid.as_ref()) else {
            return Ok(None);
        };
        let own = Loop { closing: Closing::Pid(pid.into(), pid.into()), ..*designed };
        if own.closing == designed.closing {
            return Ok(None);
        }
        Ok(Some(Document::of(&own, None, None, Vec::new())?))
    }

    /// The smaller distance of hover from the limits of the duty, percent; `None` behind a predistortion, whose control
    /// value is no duty.
    fn room(&self) -> Option<f64> {
        let is_duty = self.config.tables.compensation.as_ref().is_none_or(|table| table.predistortion.is_none());
        let safety = self.config.tables.safety.as_ref().filter(|_| is_duty)?;
        let hover = self.model.hover_duty_percent;
        Some((safety.duty_max_percent - hover).min(hover - safety.duty_min_percent))
    }

    /// The loop with a controller, and what can be said of it.
    fn assessed(&self, closing: Closing, feedback: Option<Feedback>) -> Result<(Loop, Document)> {
        let of = Loop { plant: self.plant, closing, period_s: self.period_s() };
        let document = Document::of(&of, feedback, self.about, self.over_duties())?;
        Ok((of, document))
    }

    /// Assesses the controller, writes the requested files and prints the result.
    fn conclude(&self, args: &DesignArgs, closing: Closing, feedback: Option<Feedback>) -> Result<()> {
        let (of, document) = self.assessed(closing, feedback)?;
        let patch = || patch::of(&closing, document.state_feedback.as_ref());
        if let Some(path) = &args.patch_out {
            write("patch", path, &patch()?)?;
        }
        if let Some(path) = &args.plot {
            plot::draw(path, &of)?;
        }
        if let Some(path) = &args.html {
            let (config, not_linear) = (args.config.config.display().to_string(), self.model.not_linear());
            let before = self.before(&of)?;
            let made = typed().of_model(&self.model).in_config(args.config.files());
            let report = Report {
                made: &made,
                config: &config,
                document: &document,
                of: &of,
                patch: &patch()?,
                not_linear: &not_linear,
                before: before.as_ref(),
                room: self.room(),
                pipe_length_mm: self.model.pipe_length_mm,
            };
            page::write(path, &html(&report)?)?;
        }
        if args.json {
            say(serde_json::to_string(&document)?)?;
        } else {
            self.model.not_linear().into_iter().for_each(|name| note(not_linear(name, self.about.as_ref())));
            words(&document).into_iter().try_for_each(say)?;
        }
        let (patch, picture, page) = (args.patch_out.as_deref(), args.plot.as_deref(), args.html.as_deref());
        announce(args.json, &[("patch", patch), ("picture", picture), ("page", page)])
    }
}

/// What a design sees of an effect that is not linear, in words.
fn not_linear(name: &str, about: Option<&About>) -> String {
    let start = format!("{name} is on in the model and not linear");
    match about {
        None => format!(
            "{start}: the design does not see it; try it in `airball simulate`, or, if it bends the force, give \
             --about-duty and --about-height"
        ),
        Some(About { duty_percent, position_mm, .. }) => format!(
            "{start}: the design sees at most the slopes of its force at {duty_percent} % and {position_mm} mm; try it \
             in `airball simulate`"
        ),
    }
}

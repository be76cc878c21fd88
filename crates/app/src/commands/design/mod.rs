//! `airball design`: gains for the model of a config, and what a loop bears.

mod critical_gain;
mod gains;
mod observer;

pub use critical_gain::{Row, Table};

use super::{note, say};
use crate::assessment::{Assessment, Loop};
use crate::cli::{DesignArgs, DesignCommand};
use crate::config::Config;
use crate::report::design::{Document, Feedback, patch, words};
use crate::report::{design_plot, plot};
use anyhow::{Result, anyhow};
use control::design::law::Gains;
use plant::Model;
use std::path::Path;

/// The command that configs and errors are told.
const NAME: &str = "design";

/// Designs, and says it.
///
/// # Errors
/// A config that is not sound, a design that does not exist, a file that cannot be written.
pub fn design(command: &DesignCommand) -> Result<()> {
    match command {
        DesignCommand::Loop(args) => gains::of_config(args),
        DesignCommand::Pid(args) => gains::pid(args),
        DesignCommand::Poles(args) => gains::poles(args),
        DesignCommand::Lqr(args) => gains::lqr(args),
        DesignCommand::Relay(args) => gains::relay(args),
        DesignCommand::Observer(args) => observer::observer(args),
        DesignCommand::CriticalGain(args) => critical_gain::critical_gain(args),
    }
}

/// What a design starts from.
struct Ground {
    config: Config,
    model: Model,
}

impl Ground {
    fn read(args: &DesignArgs) -> Result<Self> {
        if let Some(picture) = &args.plot {
            plot::may_write(picture)?;
        }
        let config = Config::read(&args.config.config, &args.config.patch)?;
        let model = config.need(NAME, "plant", |tables| tables.plant.as_ref())?.clone();
        Ok(Self { config, model })
    }

    /// Time between samples, seconds, where the config says it.
    fn period_s(&self) -> Option<f64> {
        self.config.tables.r#loop.map(|table| table.period_s)
    }

    /// Assesses the gains, writes what was asked for and says the result.
    fn conclude(&self, args: &DesignArgs, gains: Gains, on_error: bool, feedback: Option<Feedback>) -> Result<()> {
        let of = Loop { plant: self.model.linear(), gains, derivative_on_error: on_error };
        let sampled: Option<Assessment> = self.period_s().map(|period_s| of.sampled(period_s)).transpose()?;
        let document = Document::of(&of, feedback, self.period_s(), sampled);
        if let Some(path) = &args.patch_out {
            write("patch", path, &patch(&document)?)?;
        }
        if let Some(path) = &args.plot {
            design_plot::draw(path, &of, self.period_s())?;
        }
        if args.json {
            return say(serde_json::to_string(&document)?);
        }
        for name in self.model.not_linear() {
            note(format_args!(
                "{name} is on in the model and not linear: the design does not see it; try it in `airball simulate`"
            ));
        }
        words(&document).into_iter().try_for_each(say)
    }
}

fn write(what: &str, path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text)
        .map_err(|error| anyhow!("cannot write the {what} {}: {error}; check the folder", path.display()))
}

//! The program `airball`: from its arguments to its exit status. The binary and the Python package start it.

use crate::cli::{Cli, Command, ConfigCommand, LogCommand};
use crate::commands::{
    Usage, compare, config, design, diagnose, emulate, export, fail, fan_off, guard, identify, init, live, log,
    measure, monitor, reader_is_gone, replay, run, simulate, with_causes,
};
use ::config::ConfigError;
use anyhow::Result;
use clap::Parser;
use clap::error::{ContextKind, ContextValue};
use std::process::ExitCode;

/// Exit status of wrong usage, as in clap; a config is part of the usage.
const WRONG_USAGE: u8 = 2;

/// Runs the program that [`crate::started`] says was started. Ends the process where clap does: after `--help`, and
/// after flags that are wrong.
#[must_use]
pub fn run() -> ExitCode {
    ExitCode::from(status())
}

/// The same, with the exit status as a number.
#[must_use]
pub fn status() -> u8 {
    let cli = Cli::try_parse_from(crate::started::arguments()).unwrap_or_else(|error| with_tip(error).exit());
    match of_command(cli.command) {
        Ok(status) => status,
        Err(error) if reader_is_gone(&error) => 0,
        Err(error) => {
            fail(with_causes(&error));
            if error.is::<ConfigError>() || error.is::<Usage>() { WRONG_USAGE } else { 1 }
        }
    }
}

/// The error of a command line; where a log stands in the place of a way to identify, with what to run.
fn with_tip(mut error: clap::Error) -> clap::Error {
    let log = match error.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(name)) if name.contains('.') => name.clone(),
        _ => return error,
    };
    let usage = error.get(ContextKind::Usage).map(ToString::to_string).unwrap_or_default();
    if usage.contains("identify") {
        let tip = format!("`airball identify grey-box {log}` finds gain, drag, hover and fan lag from any flight");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        error.remove(ContextKind::SuggestedSubcommand);
    }
    error
}

fn of_command(command: Command) -> Result<u8> {
    match command {
        Command::Diagnose(args) => return diagnose::diagnose(&args),
        Command::Log(LogCommand::Recover { log, out }) => return log::recover(&log, out.as_deref()),
        Command::Run(args) => run::run(&args),
        Command::Simulate(args) => simulate::simulate(&args),
        Command::Measure(args) => measure::measure(&args),
        Command::Init(args) => init::init(&args),
        Command::Replay(args) => replay::replay(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Design(command) => design::design(&command),
        Command::Identify(command) => identify::identify(&command),
        Command::Export(command) => export::export(&command),
        Command::FanOff(args) => fan_off::fan_off(&args),
        Command::Monitor(args) => monitor::monitor(&args),
        Command::Live(args) => live::live(&args),
        Command::Emulate(args) => emulate::emulate(&args),
        Command::Guard(args) => guard::guard(&args),
        Command::Config(ConfigCommand::Check(args)) => config::check(&args),
        Command::Config(ConfigCommand::Print(args)) => config::print(&args),
        Command::Config(ConfigCommand::Effects) => config::effects(),
        Command::Log(LogCommand::Info { log }) => log::info(&log),
        Command::Log(LogCommand::Export { log }) => log::export(&log),
    }?;
    Ok(0)
}

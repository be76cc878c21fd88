//! The binary `airball`.

use airball::ConfigError;
use airball::cli::{Cli, Command, ConfigCommand, LogCommand};
use airball::commands::{
    Usage, compare, config, design, diagnose, emulate, fail, fan_off, guard, identify, init, live, log, measure,
    monitor, reader_is_gone, replay, run, simulate, with_causes,
};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Simulate(args) => simulate::simulate(&args),
        Command::Measure(args) => measure::measure(&args),
        Command::Init(args) => init::init(&args),
        Command::Replay(args) => replay::replay(&args),
        Command::Diagnose(args) => match diagnose::diagnose(&args) {
            Ok(status) => return status,
            Err(error) => Err(error),
        },
        Command::Compare(args) => compare::compare(&args),
        Command::Design(command) => design::design(&command),
        Command::Identify(command) => identify::identify(&command),
        Command::FanOff(args) => fan_off::fan_off(&args),
        Command::Monitor(args) => monitor::monitor(&args),
        Command::Live(args) => live::live(&args),
        Command::Emulate(args) => emulate::emulate(&args),
        Command::Guard(args) => guard::guard(&args),
        Command::Config(ConfigCommand::Check(args)) => config::check(&args),
        Command::Config(ConfigCommand::Print(args)) => config::print(&args),
        Command::Log(LogCommand::Info { log }) => log::info(&log),
        Command::Log(LogCommand::Export { log }) => log::export(&log),
        Command::Log(LogCommand::Recover { log, out }) => match log::recover(&log, out.as_deref()) {
            Ok(status) => return status,
            Err(error) => Err(error),
        },
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if reader_is_gone(&error) => ExitCode::SUCCESS,
        Err(error) => {
            fail(with_causes(&error));
            // 2 is wrong usage, as in clap; a config is part of the usage.
            if error.is::<ConfigError>() || error.is::<Usage>() { ExitCode::from(2) } else { ExitCode::FAILURE }
        }
    }
}

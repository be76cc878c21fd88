//! `airball config check` and `airball config print`.

use super::{say, warn};
use crate::cli::ConfigArgs;
use crate::config::Config;
use crate::config::mqtt::MqttConfig;
use anyhow::Result;

/// Checks a config and prints the result.
///
/// # Errors
/// Where it is not.
pub fn check(args: &ConfigArgs) -> Result<()> {
    let config = Config::read(&args.config, &args.over())?;
    let effects = config.tables.plant.as_ref().map_or_else(Vec::new, |plant| plant.effects.present());
    let names: Vec<&str> = effects.iter().map(|entry| entry.name).collect();
    let names = if names.is_empty() { "none".into() } else { names.join(", ") };
    say(format_args!("{} is sound; effects of the plant that are on: {names}", args.config.display()))?;
    let exposures = config.tables.mqtt.as_ref().map_or_else(Vec::new, MqttConfig::exposures);
    exposures.iter().for_each(warn);
    Ok(())
}

/// Prints the config in force.
///
/// # Errors
/// Where it is not sound.
pub fn print(args: &ConfigArgs) -> Result<()> {
    say(Config::read(&args.config, &args.over())?.to_toml().to_string().trim_end())?;
    Ok(())
}

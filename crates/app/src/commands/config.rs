//! `airball config check`, `airball config print` and `airball config effects`.

use super::{say, warn};
use crate::cli::ConfigArgs;
use crate::flight::experiment::offers::offers;
use crate::mqtt::exposures;
use anyhow::Result;
use config::Config;
use hal::BUDGET_US;

/// Checks a config and prints the result.
///
/// # Errors
/// Where it is not.
pub fn check(args: &ConfigArgs) -> Result<()> {
    let config = Config::read(&args.config, &args.over())?;
    let effects = config.tables.plant.as_ref().map_or_else(Vec::new, |plant| plant.effects.present());
    let names: Vec<&str> = effects.iter().map(|entry| entry.name).collect();
    let names = if names.is_empty() { "none".into() } else { names.join(", ") };
    offered(&config)?;
    say(format_args!("{} is sound; effects of the plant that are on: {names}", args.config.display()))?;
    let exposures = config.tables.mqtt.as_ref().map_or_else(Vec::new, exposures);
    exposures.iter().chain(&hasty(&config)).for_each(warn);
    Ok(())
}

/// Reads the experiments on offer, as a flight does before it begins.
fn offered(config: &Config) -> Result<()> {
    let Some((mqtt, safety)) = config.tables.mqtt.as_ref().zip(config.tables.safety) else { return Ok(()) };
    offers(&mqtt.experiments, &safety)?;
    Ok(())
}

/// That the loop is faster than the sensor of a rig.
fn hasty(config: &Config) -> Option<String> {
    let _ = config.tables.rig.as_ref()?;
    let (period_s, sensor_s) = (config.tables.r#loop?.period_s, f64::from(BUDGET_US) * 1e-6);
    (period_s < sensor_s).then(|| {
        format!(
            "[loop] period_s = {period_s} is shorter than the {sensor_s} s of a reading of the sensor, so that some \
             cycles have no new position; give {sensor_s} or more"
        )
    })
}

/// Prints the config in force.
///
/// # Errors
/// Where it is not sound.
pub fn print(args: &ConfigArgs) -> Result<()> {
    let config = Config::read(&args.config, &args.over())?;
    let text = if config.words.is_ball_pipe() { config.to_toml() } else { config.to_toml_with_words() };
    say(text.trim_end())?;
    Ok(())
}

/// The file that is printed.
const MORE_EFFECTS: &str = include_str!("../../../../effects.toml");

/// Prints the effects that the catalogue does not have.
///
/// # Errors
/// Where standard output cannot be written.
pub fn effects() -> Result<()> {
    say(MORE_EFFECTS.trim_end())?;
    Ok(())
}

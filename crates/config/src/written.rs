//! Effects that a user wrote: their definitions in `[effect.NAME]`, and the values of those that are on in
//! `[plant.effects.NAME]`.

use super::tables::Tables;
use plant::{Definition, DefinitionError};
use toml::{Table, Value};

/// Takes the values of written effects out of the merged files: the tables know the built-in effects only.
pub(super) fn take(merged: &mut Table) -> Vec<(String, Value)> {
    let names: Vec<String> =
        merged.get("effect").and_then(Value::as_table).map_or_else(Vec::new, |all| all.keys().cloned().collect());
    let effects = merged.get_mut("plant").and_then(|plant| plant.get_mut("effects")).and_then(Value::as_table_mut);
    let Some(effects) = effects else { return Vec::new() };
    names.into_iter().filter_map(|name| effects.remove(&name).map(|values| (name, values))).collect()
}

/// What to try where an effect is not known: it may be defined in a file that was not named.
pub const OWN_EFFECT_ADVICE: &str = "name the file that defines an effect of your own with `--effects FILE`";

/// Makes the written effects known to the model, and switches on those with values.
///
/// # Errors
/// The dotted key, and what is wrong there.
pub(super) fn define(tables: &mut Tables, values: Vec<(String, Value)>) -> Result<(), (String, String)> {
    for (name, table) in &tables.effect {
        let definition = Definition::new(name, table).map_err(|error| within_effect(name, error))?;
        if let Some(plant) = &mut tables.plant {
            plant.effects.written.define(definition);
        }
    }
    let Some(plant) = &mut tables.plant else { return Ok(()) };
    for (name, value) in values {
        let entry = plant.effects.entry(&name).copied();
        let params = entry.map_or(&[][..], |entry| entry.params);
        let numbers = numbers(&name, &value, &params.iter().map(|param| param.name).collect::<Vec<_>>())?;
        plant.effects.set(&name, &numbers);
    }
    Ok(())
}

/// The dotted key in the config, and what is wrong there.
fn within_effect(name: &str, error: DefinitionError) -> (String, String) {
    let key = if error.key.is_empty() { format!("effect.{name}") } else { format!("effect.{name}.{}", error.key) };
    (key, error.message)
}

/// Key and message of the first written effect that depends on the setpoint, of those that are on or `is_tried` by a
/// search.
pub(super) fn setpoint_use(tables: &Tables, why: &str, is_tried: impl Fn(&str) -> bool) -> Option<(String, String)> {
    let written = &tables.plant.as_ref()?.effects.written;
    let counts = |known: &Definition| is_tried(known.entry().name) || written.present().any(|on| on == known);
    written.definitions().filter(|known| counts(known)).find_map(|known| {
        let error = known.without_setpoint(why)?;
        Some(within_effect(known.entry().name, error))
    })
}

/// The numbers of `[plant.effects.NAME]` in the order of the parameters.
fn numbers(name: &str, value: &Value, params: &[&str]) -> Result<Vec<f64>, (String, String)> {
    let here = format!("plant.effects.{name}");
    let known = params.join("`, `");
    let Some(table) = value.as_table() else { return Err((here, format!("must be a table with `{known}`"))) };
    if let Some(unknown) = table.keys().find(|key| !params.contains(&key.as_str())) {
        return Err((format!("{here}.{unknown}"), format!("unknown key `{unknown}`; expected `{known}`")));
    }
    #[expect(clippy::cast_precision_loss, reason = "a number that a person wrote")]
    let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    let each = params.iter().map(|param| match table.get(*param) {
        None => Err((here.clone(), format!("the key `{param}` is missing"))),
        Some(value) => number(value).ok_or_else(|| (format!("{here}.{param}"), format!("`{value}` is no number"))),
    });
    each.collect()
}

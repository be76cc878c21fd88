//! A config file and its patches as one table: later ones over earlier ones, key by key.
//!
//! A patch can also take away, by `remove = ["plant.effects.fan_lag", "controller.state_feedback.integral"]` at its
//! top. Where a table holds one of several variants, the variant of a later file takes the place of the earlier one.

use plant::Effects;
use toml::{Table, Value};

/// The key by which a patch takes away.
const REMOVE: &str = "remove";

/// Tables that hold exactly one of several keys.
const ONE_OF: [&[&str]; 3] = [
    &["reference", "setpoint_mm"],
    &["controller", "pid", "anti_windup"],
    &["controller", "state_feedback", "integral"],
];

/// Puts `patch` over `base`.
///
/// # Errors
/// The key of the patch that cannot be meant, and why.
pub(super) fn put_over(base: &mut Table, mut patch: Table) -> Result<(), (String, String)> {
    if let Some(names) = patch.remove(REMOVE) {
        remove_all(base, &names)?;
    }
    displace(base, &patch);
    merge(base, patch, &mut Vec::new());
    Ok(())
}

/// Takes away what a patch names.
fn remove_all(base: &mut Table, names: &Value) -> Result<(), (String, String)> {
    let wrong = |message: String| Err((REMOVE.to_owned(), message));
    let names: Option<Vec<&str>> = names.as_array().and_then(|names| names.iter().map(Value::as_str).collect());
    let Some(names) = names else {
        return wrong("it is no list of keys in quotes, like [\"plant.effects.fan_lag\"]".into());
    };
    for name in names {
        if !remove(base, name) {
            return wrong(format!(
                "`{}` is not in the config, so that it cannot be removed; name a key or a table that `airball config \
                 print` shows",
                rows::shown(name)
            ));
        }
    }
    Ok(())
}

/// Whether the dotted key was there.
fn remove(base: &mut Table, name: &str) -> bool {
    match name.split_once('.') {
        None => base.remove(name).is_some(),
        Some((table, rest)) => {
            base.get_mut(table).and_then(Value::as_table_mut).is_some_and(|table| remove(table, rest))
        }
    }
}

/// Removes from `base` the effects that exclude one of `over`: they describe the same part of the rig, and the later
/// file wins.
fn displace(base: &mut Table, over: &Table) {
    let Some(added) = effects(over) else { return };
    let Some(believed) = base.get_mut("plant").and_then(|plant| plant.get_mut("effects")) else { return };
    let Some(believed) = believed.as_table_mut() else { return };
    let displaced =
        |name: &str| !added.contains_key(name) && added.keys().any(|other| Effects::exclude_each_other(name, other));
    believed.retain(|name, _| !displaced(name));
}

fn effects(table: &Table) -> Option<&Table> {
    table.get("plant")?.get("effects")?.as_table()
}

/// Tables merge key by key; anything else is replaced. `path`: where `base` is.
fn merge(base: &mut Table, over: Table, path: &mut Vec<String>) {
    if ONE_OF.contains(&path.iter().map(String::as_str).collect::<Vec<_>>().as_slice()) {
        base.retain(|variant, _| over.contains_key(variant));
    }
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => {
                path.push(key);
                merge(below, above, path);
                path.pop();
            }
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

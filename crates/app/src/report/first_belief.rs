//! A first belief as a config with the origin of each number, and in words.

use crate::analysis::first_belief::{FirstBelief, Named, Scaled, Scales};
use crate::report::kit::page::made::version;
use config::Config;
use config::source_columns::quoted;
use diagnose::decimals;
use diagnose::identify::{NoUse, ParameterEstimate};
use plant::effects::HeightDependentFlow;
use plant::{Effect, Model};
use rows::{Column, shown};
use std::fmt::Write;

/// The meaning of a diagnosis with a belief that was fitted to a record of the rig.
const FITTED: &str = "the belief is a linear model fitted to a record of this rig, so what follows is how the rig \
     differs from a linear model of itself; wrong numbers of a belief of your own cannot show, and its noise, fitted \
     too, may hold a missing effect, so that the noise floor is too high";

/// The same where no linear plant follows the record.
const GUESSED: &str = "the belief is a first guess, because no linear plant follows the record that it was made from: \
     how the rig differs from it may be how it differs from any linear model; put in the gain, drag and hover that you \
     know, and its noise, fitted, may hold a missing effect, so that the noise floor is too high";

/// The meaning of the noise floor of a belief that was fitted to a record of the rig.
pub const FLOOR: &str = "the noise of this belief was fitted to a record of the rig and may hold a missing effect, so \
     that an error near the noise floor does not mean that there is no gap: `airball diagnose` tells";

/// How the config of a first belief begins.
const HEAD: &str = "# A first belief about ";

/// The same of one that is a guess.
const HEAD_OF_GUESS: &str = "# A first guess about ";

/// Where the comments of the config begin.
const COMMENT_COLUMN: usize = 46;

/// The meaning of a diagnosis with `model` if it is the one that was fitted to a record and written below this first
/// line of a config.
#[must_use]
pub fn meaning(first_line: &str, model: &Model) -> Option<&'static str> {
    let is_as_written = first_line.ends_with(&end(&version(model)));
    let meanings = [(HEAD, FITTED), (HEAD_OF_GUESS, GUESSED)];
    let found = meanings.into_iter().find(|(head, _)| is_as_written && first_line.starts_with(head));
    found.map(|(_, meaning)| meaning)
}

fn end(version: &str) -> String {
    format!("{version}).")
}

/// The config.
#[must_use]
pub fn config(belief: &FirstBelief, logs: &[String]) -> String {
    let tables = tables(belief);
    let written = Config::of_texts([(String::new(), tables.clone())]).ok().and_then(|config| config.tables.plant);
    let (head, from) = if belief.plant.gain_is_lost {
        (HEAD_OF_GUESS, "guesses, since no linear plant follows this record")
    } else {
        (HEAD, "those of a linear model fitted to this record")
    };
    let head = format!(
        "{head}{}, written by `airball init` ({} s, {} readings, {}\n\
         # Gain, drag and hover are {from}, so that a diagnosis\n\
         # with it says how the rig differs from a linear model of itself; the noise is fitted. Put in what you know:\n\
         # a diagnosis against it then says more.\n\n",
        logs.iter().map(|log| shown(log)).collect::<Vec<_>>().join(", "),
        number(belief.duration_s),
        belief.readings,
        end(&version(&written.unwrap_or_else(|| belief.plant.model.clone()))),
    );
    head + &tables
}

fn tables(belief: &FirstBelief) -> String {
    let mut text = String::from("[import]\n");
    let import = &belief.import;
    let mut column = |key: &str, column: &Column, why: &str| line(&mut text, key, &toml_of(column), why);
    column("time_s", &import.time_s, &time(belief));
    if let Some(setpoint) = &import.setpoint_mm {
        column("setpoint_mm", setpoint, "read as the position is");
    }
    column("duty_percent", &import.duty_percent, &input(belief));
    column("position_mm", &import.position_mm, &position(belief));
    rig(&mut text, belief);
    plant(&mut text, belief);
    text
}

/// The words of the rig, where its columns say them.
fn rig(text: &mut String, belief: &FirstBelief) {
    let words = &belief.words;
    if words.is_ball_pipe() {
        return;
    }
    text.push_str("\n[rig]\n");
    let (input, position) = (&belief.roles.input.column, &belief.roles.position.column);
    let mut word = |key: &str, word: &Option<String>, column: &str| {
        let Some(word) = word else { return };
        let why = format!("by column `{}`; what reports call it", shown(column));
        line(text, key, &quoted(word), &why);
    };
    word("position", &words.position, position);
    word("position_unit", &words.position_unit, position);
    word("input", &words.input, input);
    word("input_unit", &words.input_unit, input);
}

fn plant(text: &mut String, belief: &FirstBelief) {
    let model = &belief.plant.model;
    text.push_str("\n[plant]\n");
    let fitted = |key: &str| origin(belief, key);
    let mut set = |key: &str, value: f64, why: &str| line(text, key, &number(value), why);
    set("gain_mm_per_s2_per_percent", model.gain_mm_per_s2_per_percent, &fitted("gain_mm_per_s2_per_percent"));
    set("drag_per_s", model.drag_per_s, &fitted("drag_per_s"));
    set("hover_duty_percent", model.hover_duty_percent, &fitted("hover_duty_percent"));
    let ends = if belief.scales.has_ends {
        "as said: it stops at 0 and here"
    } else {
        "no ends: three times the range of the record"
    };
    if model.pipe_bottom_mm != 0.0 {
        set("pipe_bottom_mm", model.pipe_bottom_mm, "no ends: the record is in the middle");
    }
    set("pipe_length_mm", model.pipe_length_mm, ends);
    text.push_str("\n[plant.noise]\n");
    let mut set = |key: &str, value: f64| line(text, key, &number(value), "fitted");
    set("sensor_mm", model.noise.sensor_mm);
    set("acceleration_psd_mm2_per_s3", model.noise.acceleration_psd_mm2_per_s3);
    if let Some(lag_s) = model.effects.fan_lag_s() {
        text.push_str("\n[plant.effects.fan_lag]\n");
        line(text, "time_constant_s", &number(lag_s), &origin(belief, "fan_lag.time_constant_s"));
    }
    if let Some(values) = model.effects.values(HeightDependentFlow::ENTRY.name) {
        text.push_str("\n[plant.effects.height_dependent_flow]\n");
        let is_gravity = values.len() > 1;
        for (param, value) in HeightDependentFlow::ENTRY.params.iter().zip(values) {
            let why = match param.name {
                "centre_mm" => "fitted: where a pendulum hangs".to_owned(),
                "turn_mm" => "one turn of the angle".to_owned(),
                _ if is_gravity => "fitted: gravity, which goes with the sine of the angle".to_owned(),
                _ => format!("a force {}: without one the input shows nothing", by_stiffness(value)),
            };
            line(text, param.name, &number(value), &why);
        }
    }
}

/// What a force does that changes with the position by this.
fn by_stiffness(gradient_per_s2: f64) -> &'static str {
    if gradient_per_s2 < 0.0 {
        "drives the rig away from one place, as gravity does where a pendulum is upright, or a magnet"
    } else {
        "returns the rig to one place, as a spring does, or gravity where a pendulum hangs"
    }
}

/// A line of a config, its comment in the column of the others.
fn line(text: &mut String, key: &str, value: &str, why: &str) {
    let set = format!("{key} = {value}");
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{set:COMMENT_COLUMN$} # {why}");
}

/// A column as an inline table.
fn toml_of(column: &Column) -> String {
    let mut keys = vec![format!("column = {}", quoted(&column.column))];
    keys.extend(column.minus.iter().map(|other| format!("minus = {}", quoted(other))));
    let numbers = [("scale", column.scale, 1.0), ("offset", column.offset, 0.0)];
    keys.extend(
        numbers
            .iter()
            .filter(|(_, value, plain)| value != plain)
            .map(|(key, value, _)| format!("{key} = {}", number(*value))),
    );
    keys.extend(column.integrate.then(|| "integrate = true".into()));
    keys.extend(column.spread.then(|| "spread = true".into()));
    keys.extend(column.hold.then(|| "hold = true".into()));
    format!("{{ {} }}", keys.join(", "))
}

/// A number as a config writes it, with four significant digits.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e7).contains(&value.abs()) {
        let text = format!("{:.*}", decimals(value) + 1, value);
        let text = if text.contains('.') { text.trim_end_matches('0').to_owned() } else { text };
        return if text.ends_with('.') { text + "0" } else { text };
    }
    format!("{value:.3e}")
}

fn time(belief: &FirstBelief) -> String {
    let scales = &belief.scales;
    format!("{}; rows are {}, read as {}", belief.roles.time.why, apart(scales), scales.time.read_as)
}

/// How far apart the rows are.
fn apart(scales: &Scales) -> String {
    let coarse = if scales.has_coarse_clock { ", spread between the stamps of a coarse clock" } else { "" };
    format!("{} s apart{coarse}", number(scales.step_s))
}

fn range(scaled: &Scaled) -> String {
    of_unit(&format!("{} to {}", number(scaled.range[0]), number(scaled.range[1])), &scaled.read_as)
}

/// Numbers with their unit, where it is known.
fn of_unit(numbers: &str, unit: &str) -> String {
    if unit.is_empty() { numbers.to_owned() } else { format!("{numbers} {unit}") }
}

fn input(belief: &FirstBelief) -> String {
    let turned = if belief.plant.is_turned { ", turned: the position falls where it rises" } else { "" };
    let held = if belief.scales.is_input_held { ", held where its cell is empty" } else { "" };
    format!("{}; {}{held}{turned}", belief.roles.input.why, range(&belief.scales.input))
}

fn position(belief: &FirstBelief) -> String {
    let speed = if belief.roles.is_speed { ", integrated" } else { "" };
    format!("{}; {}{speed}", belief.roles.position.why, range(&belief.scales.position))
}

/// Where a number of the plant comes from.
fn origin(belief: &FirstBelief, key: &str) -> String {
    if belief.plant.gain_is_lost {
        return "a first guess: no linear plant follows this record".into();
    }
    if belief.plant.by_forecasts {
        return "fitted to forecasts of 1 to 3 s".into();
    }
    let poles = if belief.plant.model.effects.fan_lag_s().is_some() { "three poles" } else { "two poles" };
    match belief.plant.found.estimates.iter().find(|estimate| estimate.name == key) {
        Some(ParameterEstimate { low: Some(low), high: Some(high), .. }) => {
            format!("fitted, {poles}: {} to {} at 90 %", number(*low), number(*high))
        }
        _ => format!("fitted, {poles}; the record hardly determines it"),
    }
}

/// What was found, line by line.
#[must_use]
pub fn words(belief: &FirstBelief) -> Vec<String> {
    let (import, scales) = (&belief.import, &belief.scales);
    let row = |named: &Named, role: &str, what: String| {
        format!("{:<14} → {role}: {what}", format!("`{}`", shown(&named.column)))
    };
    let unit = &scales.input.read_as;
    let mut lines = vec![
        row(
            &belief.roles.time,
            "time",
            format!("{}; in {}, rows {}", belief.roles.time.why, scales.time.read_as, apart(scales)),
        ),
        row(
            &belief.roles.input,
            "input",
            format!("{}; {} is read as {} %", input(belief), of_unit("1", unit), number(import.duty_percent.scale)),
        ),
        row(
            &belief.roles.position,
            belief.roles.output(),
            format!(
                "{}; {} is read as {} mm",
                position(belief),
                of_unit("1", &scales.position.read_as),
                number(import.position_mm.scale)
            ),
        ),
    ];
    lines.extend(
        belief
            .roles
            .setpoint
            .iter()
            .filter(|_| !belief.roles.is_speed)
            .map(|named| row(named, "setpoint", named.why.into())),
    );
    lines.push(fitted(belief));
    lines
}

/// A place in the unit of the log.
fn place(belief: &FirstBelief, mm: f64) -> String {
    let position = &belief.import.position_mm;
    of_unit(&number((mm - position.offset) / position.scale), &belief.scales.position.read_as)
}

fn fitted(belief: &FirstBelief) -> String {
    let model = &belief.plant.model;
    let lag = model.effects.fan_lag_s().map_or_else(String::new, |lag_s| format!(", lag {} s", number(lag_s)));
    let does = |k: f64| if k < 0.0 { "drives it away from" } else { "returns it to" };
    let spring = match model.effects.values(HeightDependentFlow::ENTRY.name).as_deref() {
        Some([k, centre_mm, ..]) => format!(", gravity of {} /s² about {}", number(*k), place(belief, *centre_mm)),
        Some([k]) => format!(", a force of {} /s² that {} one place", number(k.abs()), does(*k)),
        _ => String::new(),
    };
    format!(
        "linear model of the record: gain {} mm/s² per %, drag {} /s, hover {} %{lag}{spring}; noise of a reading {} \
         mm",
        number(model.gain_mm_per_s2_per_percent),
        number(model.drag_per_s),
        number(model.hover_duty_percent),
        number(model.noise.sensor_mm),
    )
}

/// What a user should look at before he believes it.
#[must_use]
pub fn warnings(belief: &FirstBelief) -> Vec<String> {
    let plant = &belief.plant;
    let input = shown(&belief.roles.input.column);
    let turned = plant.is_turned.then(|| {
        format!(
            "the position falls where `{input}` rises, so its sign is turned (scale {}); if the position is a distance \
             from above, turn that instead: --position-scale {}",
            number(belief.import.duty_percent.scale),
            number(-belief.import.position_mm.scale),
        )
    });
    let unseen = (!plant.sign_is_seen).then(|| {
        format!(
            "the record does not show whether the position rises or falls with `{input}`: a linear plant hardly \
             follows it"
        )
    });
    let lost = plant.gain_is_lost.then(|| {
        "no linear plant follows this record, so gain, drag and hover are first guesses: put in what you know before \
         you diagnose"
            .into()
    });
    let no_use = plant.no_use.map(|NoUse { horizon_s, error_mm, stay_put_mm }| {
        format!(
            "the linear model forecasts worse than \"the position stays put\" ({horizon_s} s ahead it errs by \
             {error_mm:.1} against {stay_put_mm:.1} mm), so a diagnosis with it says little: first check columns, \
             units and row period, or put in the gain and drag that you know"
        )
    });
    let spring = plant.form.spring_per_s2;
    let spring = (spring != 0.0).then(|| format!("a force {}", by_stiffness(spring)));
    turned.into_iter().chain(unseen).chain(lost).chain(no_use).chain(spring).collect()
}

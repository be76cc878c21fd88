//! `airball init`: a first config for the log of a rig that has none.

use super::{Usage, note, say, write};
use crate::analysis::first_belief::{Asked, FirstBelief, NoBelief, Role, Roles, first_belief, roles};
use crate::cli::{ColumnArgs, InitArgs};
use crate::files;
use crate::log::reader::{Undescribed, undescribed};
use crate::report::first_belief::{config, warnings, words};
use anyhow::{Result, anyhow, bail};
use rows::{Sheet, shown};
use std::io::{BufRead, IsTerminal, Write, stderr, stdin};
use std::path::{Path, PathBuf};

/// Proposes a config and writes it.
///
/// # Errors
/// A config that exists, a log that cannot be read, a column that is not found, a record of no plant of ours.
pub fn init(args: &InitArgs) -> Result<()> {
    let asks = !args.yes && stdin().is_terminal() && stderr().is_terminal();
    let proposed = propose(&args.logs, &args.out, args.force, &args.columns, asks)?;
    proposed.lines.into_iter().try_for_each(say)?;
    proposed.warnings.into_iter().for_each(note);
    let logs: Vec<String> = args.logs.iter().map(|log| log.display().to_string()).collect();
    let (out, logs) = (args.out.display(), logs.join(" "));
    say(format!("wrote {out}; next: airball diagnose {logs} --config {out}"))
}

/// A config that was proposed and written.
pub(crate) struct Proposed {
    /// What was found.
    pub(crate) lines: Vec<String>,
    /// What to look at before it is believed.
    pub(crate) warnings: Vec<String>,
}

/// Proposes a config for logs of one rig, and writes it to `out`.
///
/// # Errors
/// As [`init`].
pub(crate) fn propose(
    logs: &[PathBuf],
    out: &Path,
    replaces: bool,
    columns: &ColumnArgs,
    asks: bool,
) -> Result<Proposed> {
    if out.exists() && !replaces {
        return Err(Usage(format!(
            "{0} exists and is kept; diagnose with it (--config {0}), or propose another one by `airball init`, with \
             --out under another name or with --force in its place",
            out.display()
        ))
        .into());
    }
    files::may_be_made(out)
        .map_err(|error| anyhow!("cannot write the config {}: {error}; check the folder", out.display()))?;
    let Some(first) = logs.first() else { bail!("no log is named; name one") };
    let mut asked = asked(columns);
    let (mut sheet, unread) = match undescribed(first)? {
        Undescribed::Table(sheet, unread) => (sheet, unread),
        Undescribed::Flight(held) => return held_by_log(logs, held, out),
    };
    if asked.period_s.is_some() {
        sheet.number_rows();
        asked.time = Some(Sheet::ROW.into());
    }
    let name = first.display();
    let beside = unread.as_ref().map(|unread| format!("; {unread}")).unwrap_or_default();
    let guess = |asked: &Asked| roles(&sheet, asked).map_err(|error| Usage(format!("{name}: {error}{beside}")));
    let mut guessed = guess(&asked)?;
    if asks {
        ask(&sheet, &guessed, &mut asked)?;
        guessed = guess(&asked)?;
    }
    let with_others = |error: NoBelief| match unused(&guessed, &sheet).filter(|_| error.is_of_columns()) {
        Some(others) => anyhow!("{error}; {others}"),
        None => error.into(),
    };
    let belief = first_belief(logs, &sheet, &guessed, &asked).map_err(with_others)?;
    let names: Vec<String> = logs.iter().map(|log| log.display().to_string()).collect();
    write("config", out, &config(&belief, &names))?;
    let warnings = warnings(&belief).into_iter().chain(unread).collect();
    Ok(Proposed { lines: lines(&belief, &sheet), warnings })
}

/// What was found, and which columns were not used.
fn lines(belief: &FirstBelief, sheet: &Sheet) -> Vec<String> {
    words(belief).into_iter().chain(unused(&belief.roles, sheet)).collect()
}

/// The columns that have no role.
fn unused(roles: &Roles, sheet: &Sheet) -> Option<String> {
    let Roles { time, input, position, setpoint, .. } = roles;
    let used = [Some(time), Some(input), Some(position), setpoint.as_ref()];
    let is_used = |name: &str| used.iter().flatten().any(|named| named.column == name);
    let others: Vec<String> = sheet
        .columns
        .iter()
        .enumerate()
        .filter(|(_, one)| !is_used(&one.name))
        .map(|(at, one)| name_of(at, &one.name))
        .take(20)
        .collect();
    let others = (!others.is_empty()).then(|| others.join(", "))?;
    Some(format!("not used: {others}; other columns are chosen with --time, --input, --position, --speed, --setpoint"))
}

/// A column by its name, or by its place where it has none.
fn name_of(at: usize, name: &str) -> String {
    if name.trim().is_empty() { format!("column {} (without a name)", at + 1) } else { format!("`{}`", shown(name)) }
}

/// The config that the first of these logs holds, a flight of our own; the others must be such flights too.
fn held_by_log(logs: &[PathBuf], held: Option<String>, out: &Path) -> Result<Proposed> {
    let log = logs.first().map(|log| log.display().to_string()).unwrap_or_default();
    for other in logs.iter().skip(1) {
        if let Undescribed::Table(..) = undescribed(other)? {
            let other = other.display();
            let why = format!("{log} holds the config of its rig, and {other} none: propose a config for each alone");
            return Err(Usage(why).into());
        }
    }
    let Some(held) = held else { bail!("{log} holds no config; name one with --config FILE") };
    write("config", out, &format!("# The config that {log} was flown with, as the log holds it.\n\n{held}"))?;
    Ok(Proposed { lines: vec![format!("{log} holds the config that it was flown with")], warnings: Vec::new() })
}

fn asked(columns: &ColumnArgs) -> Asked {
    let ColumnArgs { time, period, time_scale, input, position, speed, setpoint, .. } = columns.clone();
    let ColumnArgs { input_scale, position_scale, length: length_mm, .. } = *columns;
    let scales = Asked { time_scale, input_scale, position_scale, length_mm, ..Asked::default() };
    Asked { time, period_s: period, input, position, speed, setpoint, ..scales }
}

/// Asks on the terminal for each role; an empty line takes what is proposed.
fn ask(sheet: &Sheet, guessed: &Roles, asked: &mut Asked) -> Result<()> {
    let names: Vec<&str> = sheet.columns.iter().map(|column| column.name.as_str()).collect();
    let listed: Vec<String> = names.iter().map(|name| shown(name)).collect();
    note(format_args!("columns: {}; Enter takes what stands in brackets", listed.join(", ")));
    let of_servo = guessed.minus.is_some();
    let input = (!of_servo).then_some(guessed.input.column.as_str());
    let setpoint = guessed.setpoint.as_ref().map(|named| named.column.as_str());
    let one = |role: Role, proposed: Option<&str>| answer(role, proposed, &names);
    asked.time = one(Role::Time, Some(&guessed.time.column))?;
    let position = one(Role::Position, Some(&guessed.position.column))?;
    let is_speed = guessed.is_speed && position.as_deref() == Some(guessed.position.column.as_str());
    (asked.speed, asked.position) = if is_speed { (position, None) } else { (None, position) };
    asked.input = one(Role::Input, input)?;
    asked.setpoint = one(Role::Setpoint, setpoint)?;
    Ok(())
}

/// The column that a user names, or the one that is proposed; asked again for what is no column.
fn answer(role: Role, proposed: Option<&str>, names: &[&str]) -> Result<Option<String>> {
    loop {
        write!(stderr(), "{role} [{}]: ", shown(proposed.unwrap_or("none")))?;
        stderr().flush()?;
        let mut line = String::new();
        if stdin().lock().read_line(&mut line)? == 0 {
            bail!("the answers ended; say --yes to take what is proposed");
        }
        match line.trim() {
            "" => return Ok(proposed.map(Into::into)),
            "none" if !names.contains(&"none") => return Ok(None),
            name if names.contains(&name) => return Ok(Some(name.into())),
            other => note(format_args!("there is no column `{}`", shown(other))),
        }
    }
}

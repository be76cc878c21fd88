//! `airball compare`: what changed on a rig between two logs, or between two diagnoses.

use super::diagnosing::{Answer, Asked};
use super::{Usage, announce, may_write, note, say, typed, warn};
use crate::analysis::lateness_change::LatenessChange;
use crate::cli::CompareArgs;
use crate::report::compare::document::{Comparison, SideEntry};
use crate::report::compare::page::{Report, page as html};
use crate::report::compare::words::lines;
use crate::report::kit::page;
use ::diagnose::{Changes, Options, Verdict};
use anyhow::{Context, Result, bail};
use config::words::Words;
use std::fs;
use std::path::Path;

/// The command's name for configs and errors.
const NAME: &str = "compare";

/// Compares and prints the result.
///
/// # Errors
/// A log and a diagnosis, a config that is not sound, a log that cannot be read or cannot answer, a page that cannot be
/// written.
pub fn compare(args: &CompareArgs) -> Result<()> {
    may_write(None, args.html.as_deref(), &[])?;
    let (found, words) = match [&args.before, &args.after].map(|path| is_document(path)) {
        [false, false] => logs(args)?,
        [true, true] if args.html.is_some() => {
            return Err(
                Usage("--html draws records, which diagnoses as JSON do not hold; name the two logs".into()).into()
            );
        }
        [true, true] => (documents(args)?, Words::default()),
        _ => return Err(Usage("name two logs, or two diagnoses as JSON".into()).into()),
    };
    if args.json {
        say(serde_json::to_string(&found)?)?;
    } else {
        lines(&found, &words).into_iter().try_for_each(say)?;
    }
    announce(args.json, &[("page", args.html.as_deref())])
}

fn is_document(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "json")
}

fn documents(args: &CompareArgs) -> Result<Comparison> {
    let read = |path: &Path| -> Result<_> {
        let name = path.display().to_string();
        let text = fs::read_to_string(path).with_context(|| format!("cannot read {name}; check the name"))?;
        let (side, document) = SideEntry::of_document(&name, &text)?;
        if side.cannot_answer() {
            bail!("{name} cannot be compared: its record cannot answer; its findings say why");
        }
        Ok((side, document))
    };
    let ((a, before), (b, after)) = (read(&args.before)?, read(&args.after)?);
    Ok(Comparison::of_documents([a, b], &[before, after]))
}

fn logs(args: &CompareArgs) -> Result<(Comparison, Words)> {
    let [before, after] = [one(args, &args.before)?, one(args, &args.after)?];
    let belief = &before.0.belief;
    let [a, b] = [&before, &after].map(|(asked, _)| asked.recordings.as_slice());
    let changes = Changes::of(belief, [&before.1.found, &after.1.found], [a, b]);
    let late = |(asked, _): &(Asked, Answer)| -> Vec<f64> {
        asked.logs[0].cycles.iter().map(|cycle| cycle.lateness_s).collect()
    };
    let found = Comparison {
        schema: "airball.compare/1",
        sides: [side(&before)?, side(&after)?],
        numbers: changes.changes.clone(),
        is_together_beyond_chance: Some(changes.is_together_beyond_chance),
        of_one_model: true,
        error_mm: Some(changes.sides.each_ref().map(|side| side.gaps.each_ref().map(|gap| gap.error_mm[2]))),
        lateness: LatenessChange::of(&late(&before), &late(&after)),
    };
    if let Some(path) = &args.html {
        let made =
            [&before, &after].iter().fold(typed().in_words(&before.0.words).of_model(belief), |made, (asked, _)| {
                made.with_log(Some(&asked.names[0]), &asked.logs[0].about)
            });
        let config = args.config.config.display().to_string();
        page::write(path, &html(&Report { made: &made, config: &config, found: &found, changes: &changes }))?;
    }
    Ok((found, before.0.words))
}

/// Reads and diagnoses one log.
fn one(args: &CompareArgs, log: &Path) -> Result<(Asked, Answer)> {
    let asked = Asked::read(NAME, &[log.to_owned()], &args.config.config, &args.config.over(), &[])?;
    let name = log.display();
    if let Some(lost) = &asked.logs[0].truncated {
        warn(format_args!("{name}: {lost}"));
    }
    let answer = asked.diagnose(&Options::default(), &|_| {});
    for noted in &answer.found.findings {
        note(format_args!("{name}: {}", asked.words.finding(&noted.finding, &asked.columns)));
    }
    if answer.found.verdict == Verdict::InsufficientData {
        bail!("{name} cannot be compared: {}; `airball diagnose {name}` says more", answer.found.verdict_in_words());
    }
    Ok((asked, answer))
}

fn side((asked, answer): &(Asked, Answer)) -> Result<SideEntry> {
    Ok(SideEntry::of_document(&asked.names[0], &asked.document(answer)?)?.0)
}

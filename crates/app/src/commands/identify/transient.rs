//! `airball identify transient`: gain and drag from a sweep of proportional gains.

use super::{conclude, config, read, write_patch};
use crate::cli::TransientArgs;
use crate::report::identify::page::transient::{Report, page as html};
use crate::report::identify::patch;
use crate::report::identify::plot::sweep as draw;
use crate::report::identify::transient::{Document, lines};
use crate::report::kit::page;
use ::diagnose::Recording;
use ::diagnose::identify::Sweep;
use anyhow::{Result, bail};

pub(super) fn transient(args: &TransientArgs) -> Result<()> {
    let asked = read(&args.logs, &args.identify)?;
    let recording = Recording::together(asked.seen());
    let dead_time_s = args.dead_time.unwrap_or_else(|| 0.5 * period_s(&recording));
    if !(0.0..1.0).contains(&dead_time_s) {
        bail!("--dead-time {dead_time_s}: give a time from 0 to 1 s, for instance 0.01");
    }
    let found = Sweep::of(&recording, dead_time_s)?;
    let origin = format!("airball identify transient of {}", asked.names.join(", "));
    let patch = patch(&origin, &[found.gain, found.drag], &asked.belief);
    write_patch(&args.identify, &patch)?;
    if let Some(path) = &args.identify.plot {
        draw(path, &asked.names.join(", "), &found)?;
    }
    if let Some(path) = &args.identify.html {
        page::write(
            path,
            &html(&Report {
                made: &asked.made(),
                logs: &asked.names,
                config: &config(&args.identify),
                belief: &asked.belief,
                recording: &recording,
                found: &found,
                patch: &patch,
            }),
        )?;
    }
    conclude(&args.identify, &Document::of(&found, dead_time_s), lines(&found))
}

/// The usual time from row to row, seconds.
fn period_s(recording: &Recording) -> f64 {
    let mut steps: Vec<f64> = recording.samples().windows(2).map(|pair| pair[1].time_s - pair[0].time_s).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or_default()
}

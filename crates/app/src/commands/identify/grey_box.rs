//! `airball identify grey-box`: two and three poles from any flight.

use super::per_control::{self, by_control, is_of_duty, renamed};
use super::{conclude, config, read, said, write_patch};
use crate::cli::{GreyBoxArgs, PolesArg};
use crate::commands::about::asked as asked_about;
use crate::commands::diagnosing::Asked;
use crate::commands::note;
use crate::report::identify::grey_box::{Document, words};
use crate::report::identify::page::grey_box::{Report, page as html};
use crate::report::identify::patch;
use crate::report::identify::plot::grey_box as draw;
use crate::report::kit::page;
use crate::report::kit::patch::rounded;
use ::diagnose::identify::{GreyBox, HeldOut, OpenLoop, Poles, better};
use ::diagnose::{FlightFinding, Recording, prepared};
use anyhow::{Result, bail};
use plant::Model;
use rayon::prelude::*;

pub(super) fn grey_box(args: &GreyBoxArgs) -> Result<()> {
    let mut asked = read(&args.logs, &args.identify)?;
    let (findings, recording) = usable(args, &mut asked)?;
    let poles = match args.poles {
        Some(PolesArg::Two) => vec![Poles::Two],
        Some(PolesArg::Three) => vec![Poles::Three],
        None => vec![Poles::Two, Poles::Three],
    };
    let open = args.open_loop.then(|| OpenLoop::of(&asked.seen().collect::<Vec<_>>(), &asked.belief));
    let used = open.as_ref().map_or(&recording, |open| &open.recording);
    let one = |poles: &Poles| identify(open.as_ref(), &asked.belief, &recording, *poles);
    let mut found = poles.par_iter().map(one).collect::<Result<Vec<GreyBox>>>()?;
    if args.per_control {
        renamed(&mut found);
    }
    let Some(best) = better(&found) else { bail!("no number of poles was asked for; give --poles 2 or --poles 3") };
    let about = asked_about(&best.fit.model, args.about)?;
    let origin = format!("airball identify grey-box, {} of {}", words::poles(best.poles), asked.names.join(", "));
    let patch = if args.per_control {
        rounded(&per_control::patch(&origin, &best.estimates))
    } else {
        patch(&origin, &best.estimates, &asked.belief)
    };
    write_patch(&args.identify, &patch)?;
    if let Some(path) = &args.identify.plot {
        draw(path, &asked.names.join(", "), used, &found, best)?;
    }
    let findings = said(&asked, &findings);
    if let Some(path) = &args.identify.html {
        // A detrended record has its own origin, for which there is no belief.
        let believed = open.is_none().then(|| HeldOut::gap_of(&asked.belief, used));
        page::write(
            path,
            &html(&Report {
                made: &asked.made(),
                logs: &asked.names,
                config: &config(&args.identify),
                belief: &asked.belief,
                believed: believed.as_ref(),
                recording: used,
                findings: &findings,
                found: &found,
                best,
                patch: &patch,
                about,
            }),
        )?;
    }
    if !args.identify.json {
        findings.iter().for_each(note);
    }
    let lines =
        words::lines(used, &found, best).into_iter().chain(about.map(|about| format!("about     {}", about.words())));
    let lines = lines.map(|line| asked.words.of(&line)).collect();
    conclude(&args.identify, &Document::of(&found, best, args.open_loop, about), lines)
}

/// The rows that are used, from the control value where that is asked for, and the findings about them.
fn usable(args: &GreyBoxArgs, asked: &mut Asked) -> Result<(Vec<FlightFinding>, Recording)> {
    if args.per_control {
        by_control(asked)?;
    }
    if args.open_loop && asked.belief.linear().gradient_per_s2 != 0.0 {
        bail!(
            "a line cannot be taken from a ball whose lift changes with height, as the effects of [plant] say; \
                identify \
             without --open-loop, which needs no line"
        );
    }
    let (mut findings, recording) = prepared(&asked.recordings, &asked.belief);
    findings.retain(|noted| !(args.per_control && is_of_duty(&noted.finding)));
    match findings.iter().find(|noted| noted.finding.stops_identification()) {
        Some(stops) => bail!("{}: {}", asked.names[stops.flight], stops.finding),
        None => Ok((findings, recording)),
    }
}

fn identify(open: Option<&OpenLoop>, start: &Model, recording: &Recording, poles: Poles) -> Result<GreyBox> {
    Ok(match open {
        Some(open) => open.identify(poles)?,
        None => GreyBox::identify(start, recording, poles)?,
    })
}

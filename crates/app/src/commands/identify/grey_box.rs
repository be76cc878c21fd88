//! `airball identify grey-box`: two and three poles from any flight.

use super::per_control::{self, by_control, is_of_duty, renamed};
use super::{conclude, config, read, said, write_patch};
use crate::cli::{GreyBoxArgs, PolesArg};
use crate::commands::about::asked as asked_about;
use crate::commands::diagnosing::Asked;
use crate::commands::{note, warn};
use crate::report::identify::grey_box::{Document, words};
use crate::report::identify::page::grey_box::{Report, page as html};
use crate::report::identify::patch;
use crate::report::identify::plot::grey_box as draw;
use crate::report::kit::about::About;
use crate::report::kit::page;
use crate::report::kit::patch::rounded;
use ::diagnose::identify::{GreyBox, HeldOut, OpenLoop, Poles, better};
use ::diagnose::{FlightFinding, Recording, mistakes, prepared};
use anyhow::{Result, bail};
use plant::Model;
use rayon::prelude::*;

/// What was found.
pub(crate) struct Found {
    pub(crate) findings: Vec<String>,
    recording: Recording,
    open: Option<OpenLoop>,
    models: Vec<GreyBox>,
    best: GreyBox,
    about: Option<About>,
    /// The best model as a patch of the config.
    pub(crate) patch: String,
}

impl Found {
    /// Identifies with these flags.
    ///
    /// # Errors
    /// Logs that have too little information.
    pub(crate) fn of(args: &GreyBoxArgs, asked: &mut Asked) -> Result<Self> {
        let (findings, recording) = usable(args, asked)?;
        let open = args.open_loop.then(|| OpenLoop::of(&asked.seen().collect::<Vec<_>>(), &asked.belief));
        let one = |poles: &Poles| identify(open.as_ref(), &asked.belief, &recording, *poles);
        let mut models = number_of_poles(args).par_iter().map(one).collect::<Result<Vec<GreyBox>>>()?;
        if args.per_control {
            renamed(&mut models);
        }
        let Some(best) = better(&models).cloned() else {
            bail!("no number of poles was asked for; give --poles 2 or --poles 3")
        };
        let about = asked_about(&best.fit.model, args.about)?;
        let patch = patch_of(args, asked, &best);
        Ok(Self { findings: said(asked, &findings), recording, open, models, best, about, patch })
    }

    /// The rows that the models were fitted to.
    fn used(&self) -> &Recording {
        self.open.as_ref().map_or(&self.recording, |open| &open.recording)
    }

    /// The document of `--json`.
    pub(crate) fn document(&self) -> Document<'_> {
        Document::of(&self.models, &self.best, self.open.is_some(), self.about)
    }

    /// The result in lines, in the words of the rig.
    pub(crate) fn words(&self, asked: &Asked) -> Vec<String> {
        let rig = &asked.words;
        let about = self.about.map(|about| rig.of(&format!("about     {}", about.words())));
        words::lines(self.used(), &self.models, &self.best, rig).into_iter().chain(about).collect()
    }

    fn page(&self, args: &GreyBoxArgs, asked: &Asked) -> String {
        // A detrended record has its own origin, for which there is no belief.
        let believed = self.open.is_none().then(|| HeldOut::gap_of(&asked.belief, self.used()));
        html(&Report {
            made: &asked.made(),
            logs: &asked.names,
            config: &config(&args.identify),
            belief: &asked.belief,
            believed: believed.as_ref(),
            recording: self.used(),
            findings: &self.findings,
            found: &self.models,
            best: &self.best,
            patch: &self.patch,
            about: self.about,
        })
    }
}

fn patch_of(args: &GreyBoxArgs, asked: &Asked, best: &GreyBox) -> String {
    let origin = format!("airball identify grey-box, {} of {}", words::poles(best.poles), asked.names.join(", "));
    if args.per_control {
        rounded(&per_control::patch(&origin, &best.estimates))
    } else {
        patch(&origin, &best.estimates, &asked.belief)
    }
}

fn number_of_poles(args: &GreyBoxArgs) -> Vec<Poles> {
    match args.poles {
        Some(PolesArg::Two) => vec![Poles::Two],
        Some(PolesArg::Three) => vec![Poles::Three],
        None => vec![Poles::Two, Poles::Three],
    }
}

pub(super) fn grey_box(args: &GreyBoxArgs) -> Result<()> {
    let mut asked = read(&args.logs, &args.identify)?;
    let found = Found::of(args, &mut asked)?;
    write_patch(&args.identify, &found.patch)?;
    if let Some(path) = &args.identify.plot {
        draw(path, &asked.names.join(", "), found.used(), &found.models, &found.best)?;
    }
    if let Some(path) = &args.identify.html {
        page::write(path, &found.page(args, &asked))?;
    }
    if !args.identify.json {
        found.findings.iter().for_each(note);
    }
    conclude(&args.identify, &found.document(), found.words(&asked))
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
    if !args.per_control {
        for noted in mistakes(&asked.belief, &asked.recordings) {
            let finding = asked.words.finding(&noted.finding, &asked.columns);
            let said = format!("{}: {finding}", asked.names[noted.flight]);
            if noted.finding.stops_identification() {
                bail!(said);
            }
            // The belief, which is to be identified, may be wrong instead.
            warn(said);
        }
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

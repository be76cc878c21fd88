//! The diagnosis: checks, selection of effects, gap and location, combined into a verdict.
//!
//! ```text
//! belief → fitted belief → + best effect → + next effect …      each step must gain held-out log-likelihood
//! ```

use crate::answer::evidence::add_odds;
use crate::answer::ladder::{Rest, Rung};
use crate::answer::mending::Mending;
use crate::answer::numbers::BelievedNumbers;
use crate::answer::poles::{in_other_order, is_likelier, of_other_order};
use crate::answer::verdict::{Verdict, rest_matters, verdict};
use crate::filter::innovation::Innovation;
use crate::filter::track::innovations;
use crate::fit::bounds::{Bounds, Impossible};
use crate::fit::estimate::Fit;
use crate::fit::intervals::Reach;
use crate::gap::forecast_error::Gap;
use crate::gap::share_closed::Closed;
use crate::mistakes::mistakes;
use crate::options::Options;
use crate::record::check::{Finding, other_rig};
use crate::record::checks::Check;
use crate::record::decimate::Purpose;
use crate::record::folds::Folds;
use crate::record::prepare::{FlightFinding, Prepared};
use crate::record::recording::Recording;
use crate::residual::location::{Place, places_of, rows};
use crate::residual::misfit::{Misfit, is_quiet};
use crate::residual::spectrum::{Band, band};
use crate::select::addition::best_addition;
use crate::select::posterior::Scored;
use crate::select::refit;
use crate::select::search::Search;
use crate::select::slow_starts::noise_hides;
use crate::select::stepwise::{NamedEffect, Selection, select_effects};
use crate::spurious_duty::spurious_duties;
use crate::thresholds::{ENOUGH_READINGS, FIRST_EFFECT};
use plant::{Definition, Model};

/// The result of a diagnosis.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The verdict.
    pub verdict: Verdict,
    /// The named effects: those to add, the most important first, then the changes of believed effects.
    pub effects: Vec<NamedEffect>,
    /// The scores of all tested effects, by round of the selection.
    pub rounds: Vec<Vec<Scored>>,
    /// The shapes of the formula for what no effect explains; empty if there is none.
    pub formula: Vec<&'static Definition>,
    /// The belief with its base parameters refitted.
    pub refitted: Fit,
    /// The model that forecasts best: the belief with refitted parameters and the effects that were found. Where a
    /// residual remains, it is without them if that forecasts better.
    pub mended: Fit,
    /// Whether the mended model has another noise than the belief: that of the belief hides what it lacks.
    pub(crate) mends_noise: bool,
    /// The belief with refitted parameters and the effects that were found.
    pub(crate) with_effects: Fit,
    /// The mended models of held-out forecasts: each fitted without a fold.
    pub(crate) without_each_fold: Vec<Model>,
    /// Held-out forecast errors: nominal, refitted, mended.
    pub gaps: [Gap; 3],
    /// The held-out errors as believed, refitted, and with each effect added in turn.
    pub ladder: Vec<Rung>,
    /// What no effect explains.
    pub rest: Rest,
    /// Gain, drag and hover as believed, beside the effects of the mended model.
    pub(crate) believed_numbers: BelievedNumbers,
    /// Where the refitted belief is wrong, the most significant place first.
    pub places: Vec<Place>,
    /// The frequencies at which the refitted belief is most wrong.
    pub band: Option<Band>,
    /// The residual tests.
    pub misfit: Misfit,
    /// Share of the gap at 1 s that the mended model closes; `None` if the gap is too small.
    pub closed: Option<Closed>,
    /// Problems of the record, by flight.
    pub findings: Vec<FlightFinding>,
    /// The possible values of each parameter on this record.
    pub(crate) bounds: Bounds,
    /// The uncertainty of the parameters of the mended model.
    pub(crate) reaches: Vec<Reach>,
}

/// Compares `belief` with one or several recordings of a rig and finds what separates them.
#[must_use]
pub fn diagnose(belief: &Model, recordings: &(impl AsRef<[Recording]> + ?Sized), options: &Options) -> Diagnosis {
    let logs = recordings.as_ref();
    let other = in_other_order(belief).filter(|other| options.is_fitted && is_likelier(other, belief, logs, options));
    match other {
        Some(other) => of_other_order(diagnose_once(&other, logs, options), &other),
        None => diagnose_once(belief, logs, options),
    }
}

/// Log-likelihood of the refitted belief with the first effect that is found beside it, nats; `None`: there is no
/// answer on these records.
pub(super) fn likelihood_with_first_effect(belief: &Model, logs: &[Recording], options: &Options) -> Option<f64> {
    prepare(belief, logs, options, |Beginning { mut search, answers, .. }| {
        if !answers {
            return None;
        }
        search.noise_hides = options.is_fitted;
        let refitted = refit::refitted(&search);
        let first = best_addition(&search, &refitted, FIRST_EFFECT).0;
        Some(first.map_or(refitted, |first| first.candidate.fit).log_likelihood(|_| true))
    })
}

fn diagnose_once(belief: &Model, logs: &[Recording], options: &Options) -> Diagnosis {
    prepare(belief, logs, options, |beginning| search_on(beginning, logs, options))
}

/// A search, and what is known before it.
struct Beginning<'a> {
    search: Search<'a>,
    findings: Vec<FlightFinding>,
    /// Whether these records can have an answer.
    answers: bool,
}

/// Prepares the records and goes on with the search about them.
fn prepare<T>(belief: &Model, logs: &[Recording], options: &Options, go_on: impl FnOnce(Beginning<'_>) -> T) -> T {
    let Prepared { mut findings, recording, can_answer } = Prepared::of(logs, belief, Purpose::Diagnosis);
    let recording = recording.as_ref();
    let belief = &with_rounding(belief, recording);
    let folds = Folds::new(belief, recording);
    let obstacles =
        if can_answer { obstacles(belief, logs, recording, &folds) } else { mistakes_outside(belief, logs, &findings) };
    let answers = can_answer && obstacles.is_empty();
    findings.extend(obstacles);
    go_on(Beginning { search: Search::new(belief, recording, &folds, options), findings, answers })
}

fn search_on(
    Beginning { mut search, mut findings, mut answers }: Beginning<'_>,
    logs: &[Recording],
    options: &Options,
) -> Diagnosis {
    let (belief, recording, folds) = (search.problem.belief, search.problem.recording, search.problem.folds);
    let about_all = |finding| (0..logs.len()).map(move |flight| FlightFinding { flight, finding });
    let refitted = if answers { refit::refitted(&search) } else { search.problem.fit(belief, &[]) };
    search.noise_hides = options.is_fitted || noise_hides(recording, belief, &refitted.model);
    let asks = answers && !is_quiet(&refitted);
    let mut found = if asks { select_effects(&search, &refitted) } else { Selection::nothing(&search, &refitted) };
    let other_rig = another_rig(&search, &found).filter(|_| answers);
    findings.extend(other_rig.into_iter().flat_map(about_all));
    let bounds = search.problem.bounds();
    let impossible = impossible(&bounds, [&refitted, &found.fit]).filter(|_| answers);
    findings.extend(impossible.into_iter().flat_map(about_all));
    if (other_rig.is_some() && !found.effects.is_empty()) || impossible.is_some() {
        // An effect that needs another rig's parameters is not what this rig lacks.
        answers = false;
        found = Selection::nothing(&search, &refitted);
    }
    let incomplete = answers && found.is_incomplete();
    let mending = Mending::of(&search, &refitted, &mut found, incomplete && asks);
    let rows = rows(&refitted.model, recording, folds);
    let (places, band) = (places_of(&rows, recording), band(&rows));
    let ladder = &mending.ladder;
    add_odds(&search.problem, &mut found, &mending, &bounds);
    let verdict = if answers { verdict(&found, ladder, &mending.gaps) } else { Verdict::InsufficientData };
    let rest = Rest {
        // Effects that raise the error leave all of it.
        share: ladder.named_share.map(|share| 1.0 - share.max(0.0)),
        is_significant: asks && incomplete,
        matters: answers && rest_matters(ladder),
    };
    let Selection { effects, rounds, fit: with_effects, misfit, .. } = found;
    let ladder = mending.rungs();
    let Mending { formula, fit: mended, without_each_fold, reaches, gaps, closed, believed_numbers, .. } = mending;
    Diagnosis {
        verdict,
        effects,
        rounds,
        formula,
        refitted,
        mended,
        mends_noise: search.noise_hides,
        with_effects,
        without_each_fold,
        gaps,
        rest,
        believed_numbers,
        ladder,
        places,
        band,
        misfit,
        closed: closed.filter(|_| answers),
        findings,
        bounds,
        reaches,
    }
}

impl Diagnosis {
    /// Whether the record was put to a check. A record without a verdict is compared with no fitted model; and beside a
    /// significant residual, or a belief whose noise hides what it lacks, a gain or a drag that is far off does not
    /// show another rig.
    #[must_use]
    pub fn was_checked(&self, check: Check) -> bool {
        let answers = self.verdict != Verdict::InsufficientData;
        match check {
            Check::Model => answers && !self.mends_noise && !self.rest.is_significant,
            Check::Bounds => answers,
            _ => true,
        }
    }

    /// Whether there is no verdict because units, signs or columns are wrong.
    #[must_use]
    pub fn has_mistake(&self) -> bool {
        self.verdict == Verdict::InsufficientData && self.findings.iter().any(|noted| noted.finding.is_mistake())
    }
}

/// The finding that the record is of another rig. Numbers of a belief whose noise hides what it lacks may be far off on
/// their own rig.
fn another_rig(search: &Search<'_>, found: &Selection) -> Option<Finding> {
    let may_tell = !found.is_incomplete() && !search.noise_hides;
    other_rig(search.problem.belief, &found.fit.model).filter(|_| may_tell)
}

/// The finding for a fit that ended at an impossible model. Fits keep their parameters within bounds, so only fixed
/// values can be impossible.
fn impossible(bounds: &Bounds, fits: [&Fit; 2]) -> Option<Finding> {
    let wrong = fits.into_iter().find_map(|fit| bounds.check(&fit.model, &fit.parameters).err())?;
    let key = match wrong {
        Impossible::Unsound(unsound) => unsound.key(),
        Impossible::OutOfRecord(parameter) => parameter.key(),
    };
    Some(Finding::Impossible { key })
}

/// Whether every innovation of the belief is a number: without it nothing can be compared.
fn has_finite_errors(belief: &Model, recording: &Recording) -> bool {
    let is_number = |seen: &Innovation| seen.repeat || (seen.expected_mm + seen.variance_mm2).is_finite();
    innovations(belief, recording).iter().all(is_number)
}

/// The findings that leave logs without a verdict before any search: a wild duty; mistakes of units, signs and columns;
/// else what all rows together, `recording`, are insufficient for.
fn obstacles(belief: &Model, logs: &[Recording], recording: &Recording, folds: &Folds) -> Vec<FlightFinding> {
    let spurious = spurious_duties(belief, logs);
    let mistakes = if spurious.is_empty() { mistakes(belief, logs) } else { spurious };
    if !mistakes.is_empty() {
        return mistakes;
    }
    let insufficiency = insufficiency(belief, recording, folds).into_iter();
    insufficiency.flat_map(|finding| (0..logs.len()).map(move |flight| FlightFinding { flight, finding })).collect()
}

/// The mistakes because of which no reading lies where the belief has its pipe; `findings`: what is known already.
fn mistakes_outside(belief: &Model, logs: &[Recording], findings: &[FlightFinding]) -> Vec<FlightFinding> {
    let is_outside = |noted: &FlightFinding| matches!(noted.finding, Finding::OutsidePipe { .. });
    let is_explained = findings.iter().any(|noted| noted.finding.is_mistake());
    if findings.iter().any(is_outside) && !is_explained { mistakes(belief, logs) } else { Vec::new() }
}

/// The finding that leaves a record without a verdict, if there is one.
fn insufficiency(belief: &Model, recording: &Recording, folds: &Folds) -> Option<Finding> {
    let not_finite = || (!has_finite_errors(belief, recording)).then_some(Finding::NotFinite);
    too_few(recording, folds).or_else(not_finite)
}

/// The finding for fewer readings than a diagnosis needs.
fn too_few(recording: &Recording, folds: &Folds) -> Option<Finding> {
    let readings = folds.readings(recording);
    (readings < ENOUGH_READINGS).then_some(Finding::TooFew { readings, needed: ENOUGH_READINGS })
}

/// The belief; without any noise, with the noise of readings rounded to the resolution of the file.
fn with_rounding(belief: &Model, recording: &Recording) -> Model {
    let mut belief = belief.clone();
    if belief.noise.sensor_mm == 0.0 {
        belief.noise.sensor_mm = recording.rounding_mm();
    }
    belief
}

#[cfg(test)]
mod tests;

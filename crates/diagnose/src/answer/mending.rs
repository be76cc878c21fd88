//! The mended model: the rung of the ladder that forecasts best, with the formula where a residual remains.

use crate::answer::ladder::{Ladder, Rung};
use crate::answer::numbers::BelievedNumbers;
use crate::answer::verdict::rest_matters;
use crate::fit::estimate::Fit;
use crate::fit::intervals::{Reach, reaches};
use crate::gap::forecast_error::Gap;
use crate::gap::share_closed::Closed;
use crate::select::by_forecasts::ByForecasts;
use crate::select::forecast::{best_forecast, forecasts_better};
use crate::select::formula::{Formula, formula};
use crate::select::search::Search;
use crate::select::stepwise::Selection;
use plant::{Definition, Entry, Model};

/// The mended model, and how it was reached.
pub(super) struct Mending {
    /// The ladder of the named effects.
    pub(super) ladder: Ladder,
    /// The named effects that a shape of a formula could stand for.
    pub(super) matched: Vec<&'static Entry>,
    /// The shapes of the formula; empty if there is none.
    pub(super) formula: Vec<&'static Definition>,
    /// The rung of the formula.
    rung: Option<Rung>,
    /// The mended model.
    pub(super) fit: Fit,
    /// The models of its held-out forecasts: each fitted without a fold.
    pub(super) without_each_fold: Vec<Model>,
    /// The uncertainty of its parameters.
    pub(super) reaches: Vec<Reach>,
    /// Whether it was found and fitted by forecasts.
    pub(super) by_forecasts: bool,
    /// Held-out forecast errors: nominal, refitted, mended.
    pub(super) gaps: [Gap; 3],
    /// Share of the gap at 1 s that the mended model closes.
    pub(super) closed: Option<Closed>,
    /// Gain, drag and hover as believed, beside the effects of the mended model.
    pub(super) believed_numbers: BelievedNumbers,
}

impl Mending {
    /// Mends the refitted belief. With `incomplete`, a significant residual remains: then the search by forecasts may
    /// take the place of `found`, with fits of its own.
    pub(super) fn of(search: &Search<'_>, refitted: &Fit, found: &mut Selection, incomplete: bool) -> Self {
        let better = if incomplete { ByForecasts::where_better(search, refitted, found) } else { None };
        let Some((by_forecasts, again)) = better else { return Self::by(search, refitted, found, incomplete) };
        *found = again;
        let mut mending = Self::by(&by_forecasts.search(search), &by_forecasts.refitted, found, incomplete);
        mending.fit = by_forecasts.with_noise(search, mending.fit);
        found.fit = by_forecasts.with_noise(search, found.fit.clone());
        mending
    }

    /// Mends the refitted belief by the criterion of `search`. Where a formula is asked for, a residual that matters
    /// gets one if it has one, and the effects that it makes redundant are removed from `found`.
    fn by(search: &Search<'_>, refitted: &Fit, found: &mut Selection, incomplete: bool) -> Self {
        let mut ladder = Ladder::of(search, refitted, found);
        let tried = if incomplete && search.formula { beyond(search, &ladder, found) } else { None };
        let matched = tried.as_ref().map(|tried| tried.matched.clone()).unwrap_or_default();
        let formula = tried.filter(|tried| is_better(&ladder, tried));
        if let Some(Formula { redundant, .. }) = formula.as_ref().filter(|formula| !formula.redundant.is_empty()) {
            found.remove(search, redundant);
            ladder = Ladder::of(search, refitted, found);
        }
        let (last, below) = (ladder.models.len() - 1, best(&ladder, incomplete));
        let rung = formula.as_ref().map(|formula| ladder.rung_of(search, below, formula));
        let mended = formula.as_ref().map_or(&ladder.models[below], |formula| &formula.evaluated);
        let is_last = formula.is_none() && below == last;
        let end = if is_last { ladder.end.clone() } else { mended.gap_with_floor(search) };
        let belief = &ladder.models[0].errors;
        let floor = end.floor_mm[2].map(|floor| floor * floor);
        let closed = floor.and_then(|floor| Closed::of(belief, [belief, &mended.errors], floor));
        let gaps = [ladder.models[0].gap(), ladder.models[1].gap(), end];
        let fit = mended.fit.clone();
        let without_each_fold = mended.without_each_fold.iter().map(|model| search.forecasting(model)).collect();
        let formula = formula.map(|formula| formula.shapes).unwrap_or_default();
        let reaches = reaches(&search.problem, &fit, &formula);
        let by_forecasts = search.is_by_forecasts();
        let believed_numbers = BelievedNumbers::beside(search, &fit.model);
        Self {
            believed_numbers,
            ladder,
            matched,
            formula,
            rung,
            fit,
            without_each_fold,
            reaches,
            by_forecasts,
            gaps,
            closed,
        }
    }

    /// All rungs, the lowest first.
    pub(super) fn rungs(&self) -> Vec<Rung> {
        self.ladder.rungs.iter().chain(&self.rung).cloned().collect()
    }
}

/// The rung that forecasts best where a residual remains; otherwise the highest, unless a lower one forecasts better by
/// more than chance.
fn best(ladder: &Ladder, incomplete: bool) -> usize {
    let models = &ladder.models;
    let (last, best) = (models.len() - 1, best_forecast(models));
    if incomplete || forecasts_better(&models[best], &models[last]) { best } else { last }
}

/// What shapes explain of a residual that matters.
fn beyond(search: &Search<'_>, ladder: &Ladder, found: &Selection) -> Option<Formula> {
    if !rest_matters(ladder) {
        return None;
    }
    formula(search, &ladder.models[1], &ladder.models[ladder.models.len() - 1], &found.added())
}

/// Whether the formula has shapes, and forecasts better than every rung of the ladder.
fn is_better(ladder: &Ladder, formula: &Formula) -> bool {
    let best = &ladder.models[best(ladder, true)];
    !formula.shapes.is_empty() && forecasts_better(&formula.evaluated, best)
}

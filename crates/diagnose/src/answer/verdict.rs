//! The verdict. The first that applies: `insufficient_data`, `unexplained` (a significant residual, and the named effects
//! close less than half of what can be closed beyond the refit, or none is likelier than not), `effect`, `parameters`
//! (only base parameters moved, and that gains held-out log-likelihood and lowers the held-out errors by more than
//! chance), `no_gap`.

use crate::answer::ladder::Ladder;
use crate::gap::forecast_error::Gap;
use crate::select::forecast::forecasts_better;
use crate::select::stepwise::{NamedEffect, Selection};
use crate::thresholds::{ENOUGH_CLOSED, FIRST_EFFECT, LIKELY, PARAMETERS_MM, PARAMETERS_OF_LENGTH, PARAMETERS_SHARE};
use plant::Model;

/// The verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing beyond noise.
    NoGap,
    /// Only base parameters moved.
    Parameters,
    /// One or more effects.
    Effect,
    /// A residual remains that no effect explains.
    Unexplained,
    /// The record cannot give an answer.
    InsufficientData,
}

/// The verdict of a record that can answer, by the errors as believed, refitted and mended. Without effects the mended
/// model is the refit, or the belief where the refit forecasts no better.
pub(super) fn verdict(found: &Selection, ladder: &Ladder, [nominal, _, mended]: &[Gap; 3]) -> Verdict {
    if found.is_incomplete() && !effects_explain_enough(found, ladder) {
        Verdict::Unexplained
    } else if !found.effects.is_empty() {
        Verdict::Effect
    } else if parameters_matter(nominal, mended, mended, &ladder.models[0].fit.model) && refit_is_better(ladder) {
        Verdict::Parameters
    } else {
        Verdict::NoGap
    }
}

/// Whether the refit is better than the belief by more than chance. In a short record neighbouring stretches share a
/// disturbance, so that fitted numbers forecast both of them better; the held-out log-likelihood then gains nothing.
fn refit_is_better(ladder: &Ladder) -> bool {
    let [belief, refit] = [&ladder.models[0], &ladder.models[1]];
    refit.log_likelihood - belief.log_likelihood > FIRST_EFFECT && forecasts_better(refit, belief)
}

/// Whether the named effects explain enough beside a significant residual: one of them is likelier than not, and they
/// close enough of the gap. A residual too small to matter for a forecast needs no name.
fn effects_explain_enough(found: &Selection, ladder: &Ladder) -> bool {
    let is_likely = |named: &NamedEffect| named.probability >= LIKELY;
    let likely = found.effects.is_empty() || found.effects.iter().any(is_likely);
    let closed = ladder.named_share.filter(|_| !found.effects.is_empty());
    likely && (!rest_matters(ladder) || closed.is_some_and(|share| share >= ENOUGH_CLOSED))
}

/// Whether the errors at 1 s exceed those by noise alone by enough to matter.
pub(super) fn rest_matters(ladder: &Ladder) -> bool {
    let both = ladder.end.error_mm[2].zip(ladder.end.floor_mm[2]);
    both.is_none_or(|(error, floor)| matters(error - floor, floor, &ladder.models[0].fit.model))
}

/// Whether the fitted base parameters lower the error at 1 s by more than the two thresholds.
pub(super) fn parameters_matter(nominal: &Gap, refitted: &Gap, mended: &Gap, rig: &Model) -> bool {
    match (nominal.error_mm[2], refitted.error_mm[2], mended.floor_mm[2]) {
        (Some(nominal), Some(refitted), Some(floor)) => matters(nominal - refitted, floor, rig),
        _ => false,
    }
}

/// Whether a difference of errors at 1 s matters beside the noise floor, all in mm, on a rig of this length.
pub(super) fn matters(difference: f64, floor: f64, rig: &Model) -> bool {
    let least_mm = PARAMETERS_MM.min(PARAMETERS_OF_LENGTH * rig.pipe_length_mm);
    difference > (PARAMETERS_SHARE * floor).max(least_mm)
}

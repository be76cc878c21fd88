//! Optional parameters of an effect, such as the speed over which friction builds up: an effect that has some is fitted
//! with them and without, and the form that forecasts better is its candidate.

use crate::fit::estimate::Fit;
use crate::fit::parameter::Parameter;
use crate::record::recording::Recording;
use crate::record::usual_speed::usual_speed;
use crate::select::candidates::Candidate;
use crate::select::screening::{COST_OF_A_NUMBER, Screened, added};
use crate::select::search::Search;

/// Initial transition of friction, as a share of the usual speed. Chosen, not fitted: a fit may move it.
const SHARE_OF_SPEED: f64 = 0.1;

/// The values of an effect in its simple form with initial values of the optional parameters.
pub(crate) fn with_optional(simple: &[f64], recording: &Recording) -> Vec<f64> {
    simple.iter().copied().chain([SHARE_OF_SPEED * usual_speed(recording)]).collect()
}

/// The starts of the promising effects in the form that was not screened as the better one.
pub(crate) fn other_forms(search: &Search<'_>, promising: &[&Screened], so_far: &Fit) -> Vec<Screened> {
    promising.iter().filter_map(|one| other_form(search, one, so_far)).collect()
}

fn other_form(search: &Search<'_>, one: &Screened, so_far: &Fit) -> Option<Screened> {
    let entry = one.entry;
    let values = one.model.effects.values(entry.name).filter(|_| entry.optional > 0)?;
    let simple = entry.params.len() - entry.optional;
    let other = if values.len() > simple {
        values[..simple].to_vec()
    } else {
        with_optional(&values, search.problem.recording)
    };
    let mut base = one.model.clone();
    base.effects.remove(entry.name);
    let (model, parameters) = added(&base, &so_far.parameters, entry, &other)?;
    let cost = one.cost + COST_OF_A_NUMBER * (other.len() as f64 - values.len() as f64);
    Some(Screened { model, parameters, cost, rivals: Vec::new(), ..one.clone() })
}

/// Whether an optional parameter ended within its bounds. One at a bound is the simple form under another name: friction
/// over the slowest transition is dry, and over the fastest speed a drag.
pub(crate) fn is_within_bounds(search: &Search<'_>, candidate: &Candidate) -> bool {
    let (entry, model) = (candidate.entry, &candidate.fit.model);
    let simple = entry.params.len() - entry.optional;
    let is_optional = |one: &&Parameter| one.index_in(entry.name).is_some_and(|index| index >= simple);
    let mut optional = candidate.fit.parameters.iter().filter(is_optional);
    entry.optional == 0 || optional.all(|one| search.problem.bounds().active(*one, model).is_none())
}

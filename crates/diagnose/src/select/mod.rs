//! Which effect explains the gap: candidates, screening, stepwise selection and ranking.

pub(crate) mod addition;
pub(crate) mod believed;
pub(crate) mod by_forecasts;
pub(crate) mod candidates;
pub(crate) mod coloured_force;
pub(crate) mod duty_step_scan;
pub(crate) mod elimination;
pub(crate) mod exchange;
pub(crate) mod forecast;
pub(crate) mod formula;
pub(crate) mod initial_values;
pub(crate) mod nested;
pub(crate) mod odds;
pub(crate) mod optional;
pub(crate) mod plausibility;
pub(crate) mod posterior;
pub(crate) mod random_force;
pub(crate) mod ranking;
pub(crate) mod refit;
pub(crate) mod regression;
pub(crate) mod screening;
pub(crate) mod search;
pub(crate) mod slow_starts;
pub(crate) mod smoothing;
pub(crate) mod stepwise;
#[cfg(test)]
pub(crate) mod tests_support;
pub(crate) mod twins;
pub(crate) mod vuong;
pub(crate) mod written_scan;

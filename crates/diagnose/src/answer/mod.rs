//! The answer: verdict, location of the gap, and data for the plots of a report.

pub(crate) mod change;
pub(crate) mod closed_loop;
pub(crate) mod diagnosis;
pub(crate) mod document;
pub(crate) mod effect_curves;
pub(crate) mod evidence;
pub(crate) mod formula;
pub(crate) mod formula_curves;
pub(crate) mod headline;
pub(crate) mod intervals;
pub(crate) mod ladder;
pub(crate) mod mending;
pub(crate) mod numbers;
pub(crate) mod patch;
pub(crate) mod poles;
pub(crate) mod sentences;
pub(crate) mod series;
pub(crate) mod stages;
pub(crate) mod verdict;

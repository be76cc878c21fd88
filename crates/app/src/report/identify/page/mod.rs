//! The pages of `airball identify`: a plant from a flight, from a sweep of gains, and a fan's lag from a critical gain.

pub mod grey_box;
pub mod third_pole;
pub mod transient;

use super::digits;
use crate::report::kit::page::parts::to_copy;
use diagnose::identify::ParameterEstimate;
use maud::{Markup, html};

/// The name of the patch file on the pages.
const PATCH: &str = "plant.toml";

/// The meaning of an interval, and its condition.
const INTERVALS: (&str, &str) =
    ("intervals", "Intervals hold the value nine times in ten, if the plant is what it is taken for.");

/// The value and its interval.
fn value(estimate: &ParameterEstimate) -> (String, String) {
    let about = match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => format!("{} to {}", digits(low), digits(high)),
        _ => "the record does not bound it".into(),
    };
    (digits(estimate.value), about)
}

/// The patch and its use.
fn to_believe(patch: &str) -> Markup {
    html! {
        p { "What was identified as a patch. Later patches win over the config, and the rest of it stays as it is:" }
        (to_copy("patch", PATCH, patch))
    }
}

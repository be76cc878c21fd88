//! A grey-box identification in words and as a document.

use super::{SCHEMA, name, said};
use crate::report::kit::about::About;
use crate::report::kit::table::{empty, in_words};
use diagnose::Recording;
use diagnose::identify::{GreyBox, ParameterEstimate, Percent, Poles, ResidualTests, Test};
use serde::Serialize;

/// A test with a smaller p-value rejects the model.
const REJECTED: f64 = 0.01;

/// The document that `identify grey-box --json` writes.
#[derive(Debug, Serialize)]
pub struct Document<'a> {
    schema: &'static str,
    method: &'static str,
    open_loop: bool,
    chosen: Poles,
    models: Vec<ModelEntry<'a>>,
    /// The slopes of the kept plant about the height and duty that were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    about: Option<About>,
    version: &'static str,
}

#[derive(Debug, Serialize)]
struct ModelEntry<'a> {
    poles: Poles,
    estimates: &'a [ParameterEstimate],
    sensor_mm: f64,
    acceleration_psd_mm2_per_s3: f64,
    held_out: HeldOutEntry,
    residuals: &'a ResidualTests,
}

#[derive(Debug, Serialize)]
struct HeldOutEntry {
    horizons_s: [f64; 3],
    fit_percent: Percent,
    noise_allows_percent: Percent,
    log_likelihood: f64,
}

const HORIZONS_S: [f64; 3] = [0.1, 0.5, 1.0];

impl<'a> Document<'a> {
    /// The document of the fits with each number of poles, of which `best` is kept.
    #[must_use]
    pub fn of(found: &'a [GreyBox], best: &GreyBox, open_loop: bool, about: Option<About>) -> Self {
        let entry = |found: &'a GreyBox| ModelEntry {
            poles: found.poles,
            estimates: &found.estimates,
            sensor_mm: found.fit.model.noise.sensor_mm,
            acceleration_psd_mm2_per_s3: found.fit.model.noise.acceleration_psd_mm2_per_s3,
            held_out: HeldOutEntry {
                horizons_s: HORIZONS_S,
                fit_percent: found.held_out.percent,
                noise_allows_percent: found.held_out.allowed,
                log_likelihood: found.held_out.log_likelihood,
            },
            residuals: &found.residuals,
        };
        let models = found.iter().map(entry).collect();
        let (chosen, version) = (best.poles, env!("CARGO_PKG_VERSION"));
        Self { schema: SCHEMA, method: "grey_box", open_loop, chosen, models, about, version }
    }
}

/// The result of the residual tests of a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Residuals {
    /// White noise.
    Noise,
    /// Correlated with earlier duty.
    KnowDuty,
    /// Autocorrelated.
    Coloured,
}

impl Residuals {
    /// The result for a plant.
    #[must_use]
    pub fn of(found: &GreyBox) -> Self {
        let rejected = |test: Test| test.p_value < REJECTED;
        match (rejected(found.residuals.input), rejected(found.residuals.whiteness)) {
            (false, false) => Self::Noise,
            (true, _) => Self::KnowDuty,
            (false, true) => Self::Coloured,
        }
    }
}

/// An identification in words.
pub mod words {
    use super::{GreyBox, HORIZONS_S, Percent, Poles, Recording, Residuals, empty, in_words, name, said};
    use crate::report::kit::words::p_value;
    use comfy_table::Table;
    use config::words::Words;

    /// The number of poles, in words.
    #[must_use]
    pub const fn poles(poles: Poles) -> &'static str {
        match poles {
            Poles::Two => "two poles",
            Poles::Three => "three poles",
        }
    }

    /// The fit with each number of poles, and the one that is kept, in the words of the rig.
    #[must_use]
    pub fn lines(recording: &Recording, found: &[GreyBox], best: &GreyBox, rig: &Words) -> Vec<String> {
        let (seconds, readings) = (recording.duration_s(), recording.readings());
        let flights = recording.flights().len();
        let mut lines = vec![
            format!(
                "record    {seconds:.1} s, {readings} readings in {flights} stretch{}",
                if flights == 1 { "" } else { "es" }
            ),
            in_words(&table(found), rig),
        ];
        if found.len() > 1 {
            lines.push(rig.of(&format!("kept      {}: {}", poles(best.poles), why(found, best))));
        }
        lines.push(rig.of(verdict(Residuals::of(best))));
        lines
    }

    /// Why that number of poles was kept.
    #[must_use]
    pub fn why(found: &[GreyBox], best: &GreyBox) -> String {
        let gain = found.iter().map(|one| one.held_out.log_likelihood).fold(f64::NEG_INFINITY, f64::max)
            - found.iter().map(|one| one.held_out.log_likelihood).fold(f64::INFINITY, f64::min);
        match best.poles {
            Poles::Three => format!("the fan pole gains {gain:.1} nats on held-out data"),
            Poles::Two => "the fan pole does not improve the forecasts of held-out data".into(),
        }
    }

    /// The meaning of the residuals for the plant.
    #[must_use]
    pub const fn verdict(residuals: Residuals) -> &'static str {
        match residuals {
            Residuals::Noise => "The residuals are white: this record does not contradict the model.",
            Residuals::KnowDuty => {
                "The residuals depend on the duty: the model lacks an effect, and its intervals are too narrow. Find \
                 it with `airball diagnose`."
            }
            Residuals::Coloured => {
                "The residuals are coloured: the noise of air or sensor differs from the model, and the intervals are \
                 too narrow. See `airball diagnose`."
            }
        }
    }

    fn table(found: &[GreyBox]) -> Table {
        let header = std::iter::once(String::new()).chain(found.iter().map(|one| poles(one.poles).to_owned()));
        let mut table = empty(header.collect::<Vec<String>>());
        let mut row = |title: String, cell: &dyn Fn(&GreyBox) -> String| {
            table.add_row(std::iter::once(title).chain(found.iter().map(cell)).collect::<Vec<_>>());
        };
        let longest = found.iter().max_by_key(|one| one.estimates.len());
        for key in longest.into_iter().flat_map(|one| one.estimates.iter().map(|estimate| estimate.name)) {
            let own = |one: &GreyBox| one.estimates.iter().find(|e| e.name == key).map_or_else(String::new, said);
            row(name(key).into(), &own);
        }
        for (at, horizon) in HORIZONS_S.iter().enumerate() {
            row(format!("fit {horizon} s ahead"), &|one| fit(one, |percent| percent.ahead[at]));
        }
        row("fit of simulation, 10 s".into(), &|one| fit(one, |percent| percent.simulated_10s));
        row("whiteness".into(), &|one| p_value(one.residuals.whiteness.p_value));
        row("independence of duty".into(), &|one| p_value(one.residuals.input.p_value));
        table
    }

    /// A fit compared with the noise floor.
    pub fn fit(of: &GreyBox, which: impl Fn(&Percent) -> Option<f64>) -> String {
        match (which(&of.held_out.percent), which(&of.held_out.allowed)) {
            (Some(fit), Some(allowed)) => format!("{fit:.1} % ({allowed:.1} % by noise)"),
            _ => "too short".into(),
        }
    }
}

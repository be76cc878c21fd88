//! The gallery: each effect of the catalogue is flown on the believed rig with this effect added, and diagnosed with
//! the belief.
//!
//! Experiment, controller and seed are the same for all, so that two exhibits differ by their effects alone. An effect
//! of the config's belief is shown as the missing effect of a belief without it. A new effect of the catalogue is a new
//! exhibit.

use airball::book::{Advice, ConfigError, Desk, Experiment, Flown, advise, sample};
use control::compensation::Compensation;
use diagnose::{Diagnosis, Options, Recording, RecordingError, Series};
use plant::{Entry, Model};

/// The experiment of every exhibit: its file in the project, and the file's text.
const EXPERIMENT: (&str, &str) = ("experiments/gallery.toml", include_str!("../../experiments/gallery.toml"));

/// Why an exhibit cannot be shown.
#[derive(Debug, thiserror::Error)]
pub(crate) enum GalleryError {
    /// The config has no controller that can fly.
    #[error(
        "the config has no controller that can fly; copy [loop], [controller], [compensation] and [safety] from the config.toml of the project"
    )]
    NoController,
    /// The experiment does not suit the rig.
    #[error(transparent)]
    Experiment(#[from] ConfigError),
    /// A flight ended early.
    #[error(
        "with {effect} the flight ended after {seconds:.1} s: {why}; the gallery needs a controller that flies experiments/gallery.toml to its end"
    )]
    Ended {
        /// The effect.
        effect: &'static str,
        /// Length of the flight.
        seconds: f64,
        /// The fault.
        why: String,
    },
    /// The flight does not make a recording.
    #[error("the flight with {effect} is no record: {source}; check [loop] period_s")]
    NoRecord {
        /// The effect.
        effect: &'static str,
        /// What is wrong with it.
        source: RecordingError,
    },
}

/// An effect, flown and diagnosed.
#[derive(Clone, Debug)]
pub(crate) struct Exhibit {
    /// Its entry in the catalogue.
    pub(crate) entry: Entry,
    /// Its parameters here.
    pub(crate) values: Vec<f64>,
    /// The flight with the effect.
    pub(crate) with: Flown,
    /// The flight without it.
    pub(crate) without: Flown,
    /// The diagnosis of the first flight with the belief of the second.
    pub(crate) found: Diagnosis,
    /// The advice on the next flight or signal.
    pub(crate) advice: Advice,
    /// The data of its picture.
    pub(crate) picture: Series,
    /// The compensation between controller and fan.
    pub(crate) compensation: Compensation,
}

/// The inputs of all exhibits.
#[derive(Clone, Debug)]
pub(crate) struct Gallery {
    desk: Desk,
    model: Model,
    experiment: Experiment,
    seed: u64,
}

impl Gallery {
    /// A gallery of rigs that are `model` with one effect added, flown by `desk`.
    ///
    /// # Errors
    /// [`GalleryError`]: no controller, or one that may not fly this experiment.
    pub(crate) fn new(desk: Option<Desk>, model: &Model, seed: u64) -> Result<Self, GalleryError> {
        let desk = desk.ok_or(GalleryError::NoController)?;
        let experiment = Experiment::own(EXPERIMENT.0, EXPERIMENT.1, &desk.safety)?;
        Ok(Self { desk, model: model.clone(), experiment, seed })
    }

    /// Flies and diagnoses one effect.
    ///
    /// # Errors
    /// [`GalleryError`] names the effect.
    pub(crate) fn exhibit(&self, entry: &Entry) -> Result<Exhibit, GalleryError> {
        let values = values(entry, &self.model);
        let (belief, rig) = apart(entry, &self.model, &values);
        let [with, without] = [&rig, &belief].map(|model| self.desk.fly(model, &self.experiment, self.seed));
        for flown in [&with, &without] {
            self.lasted(entry.name, flown)?;
        }
        let recording = Recording::new(with.cycles.iter().map(sample).collect())
            .map_err(|source| GalleryError::NoRecord { effect: entry.name, source })?;
        let found = diagnose::diagnose(&belief, &recording, &Options::default());
        let advice = advise(&found, &recording, Some(self.desk.clone()), &belief);
        let picture = Series::of(&found, &belief, &recording);
        let compensation = self.desk.compensation().clone();
        Ok(Exhibit { entry: *entry, values, with, without, found, advice, picture, compensation })
    }

    fn lasted(&self, effect: &'static str, flown: &Flown) -> Result<(), GalleryError> {
        let seconds = flown.cycles.last().map_or(0.0, |cycle| cycle.time_s);
        match &flown.fault {
            Some(fault) => Err(GalleryError::Ended { effect, seconds, why: fault.to_string() }),
            None if seconds + 1.0 < self.experiment.duration_s() => {
                Err(GalleryError::Ended { effect, seconds, why: "the emulated chips do not answer".into() })
            }
            None => Ok(()),
        }
    }
}

/// The parameters of an exhibit: those of the model, or else a size whose effect is visible.
pub(crate) fn values(entry: &Entry, model: &Model) -> Vec<f64> {
    let usual = entry.shown_at.or_else(|| entry.sizes.last().copied()).unwrap_or_default();
    model.effects.values(entry.name).unwrap_or_else(|| usual.to_vec())
}

/// The belief without an effect, and the rig with it, in which it replaces the effects that exclude it.
pub(crate) fn apart(entry: &Entry, model: &Model, values: &[f64]) -> (Model, Model) {
    let mut belief = model.clone();
    belief.effects.remove(entry.name);
    let mut rig = belief.clone();
    rig.effects.set(entry.name, values);
    for other in belief.effects.present() {
        if rig.effects.check().is_err() {
            rig.effects.remove(other.name);
        }
    }
    (belief, rig)
}

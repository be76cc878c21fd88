//! `airball design observer`: the steady-state Kalman filter of a config's model, and of its noise or that of W and V.

use super::{Ground, NAME, patch, write};
use crate::cli::ObserverArgs;
use crate::commands::{Usage, announce, may_write, say, typed};
use crate::report::design::observer::Document;
use crate::report::design::page::observer::{self, Report};
use crate::report::kit::page;
use anyhow::{Result, anyhow, bail};
use config::Config;
use control::believed::Believed;
use control::design::discretise::discretise;
use control::design::riccati::{kalman, sampled_kalman};
use control::observer::{Gain, Observer};
use nalgebra::{RowSVector, SMatrix, SVector};

/// Defaults where a config has no observer yet: hover drifts by 0.03 % in a second, and readings beyond 5 sigma are
/// outliers.
const DISTURBANCE_PSD_PER_S: f64 = 1e-3;
const GATE_SIGMA: f64 = 5.0;

impl Ground {
    /// The observer of this model. Values that the model does not have are those of the config's `[observer]`.
    pub(super) fn observer(&self) -> Result<Observer> {
        let (plant, noise) = (self.plant, self.model.noise);
        let held = self.config.tables.observer;
        let fan_lag_s = (plant.fan_lag_s > 0.0).then_some(plant.fan_lag_s);
        if fan_lag_s.is_none() && held.is_some_and(|held| held.believed.fan_lag_s.is_some()) {
            bail!(
                "the model has no lag of the fan and [observer.believed] has one, which no patch can take away; \
                 delete fan_lag_s there, or add [plant.effects.fan_lag]"
            );
        }
        let observer = Observer {
            sensor_mm: noise.sensor_mm.hypot(self.model.effects.reading_sigma_mm(0.0)),
            acceleration_psd_mm2_per_s3: noise.acceleration_psd_mm2_per_s3,
            disturbance_psd_per_s: held.map_or(Some(DISTURBANCE_PSD_PER_S), |held| held.disturbance_psd_per_s),
            gate_sigma: held.map_or(GATE_SIGMA, |held| held.gate_sigma),
            second_sensor_mm: held.and_then(|held| held.second_sensor_mm),
            tachometer: held.and_then(|held| held.tachometer),
            gain: held.map_or(Gain::SteadyState, |held| held.gain),
            believed: Believed { gain_mm_per_s2_per_control: plant.gain, drag_per_s: plant.drag_per_s, fan_lag_s },
        };
        let sound = observer.check().and_then(|()| observer.believed.check());
        sound.map_err(|error| anyhow!("no observer for this model: {error}; check gain and noise of [plant]"))?;
        Ok(observer)
    }
}

/// W, the diagonal, and V of the noise, in continuous time.
struct Noise {
    w: Vec<f64>,
    v: f64,
}

impl Noise {
    /// As asked for, or of the observer: its acceleration is white, and so is its reading.
    fn of(args: &ObserverArgs, observer: &Observer, states: usize, period_s: f64) -> Result<Self> {
        let Some(v) = args.v else {
            let w = (0..states).map(|k| if k == 1 { observer.acceleration_psd_mm2_per_s3 } else { 0.0 }).collect();
            return Ok(Self { w, v: observer.sensor_mm * observer.sensor_mm * period_s });
        };
        if args.w.len() != states {
            let why = if states == 3 { "with a lag of the fan" } else { "without a lag of the fan" };
            return Err(Usage(format!("the model has {states} states, {why}, and --w {} numbers", args.w.len())).into());
        }
        let noise = Self { w: args.w.clone(), v };
        if !noise.can_fly() && (args.patch_out.is_some() || args.html.is_some()) {
            bail!(
                "an observer in flight has process noise on the velocity alone, so no patch and no page can hold this \
                    W; \
                 leave --patch-out and --html out, or give --w 0,W2"
            );
        }
        Ok(noise)
    }

    /// Whether an observer in flight has this noise.
    fn can_fly(&self) -> bool {
        self.w.iter().enumerate().all(|(k, intensity)| k == 1 || *intensity == 0.0)
    }
}

/// The observer of these flags, and its patch.
pub(super) fn found(ground: &Ground, args: &ObserverArgs) -> Result<(Document, String)> {
    let period_s = ground.config.need(NAME, "loop", |tables| tables.r#loop.as_ref())?.period_s;
    let (plant, believed) = (ground.plant, ground.observer()?);
    let with_fan = plant.fan_lag_s > 0.0;
    let noise = Noise::of(args, &believed, if with_fan { 3 } else { 2 }, period_s)?;
    let observer = if args.v.is_some() {
        let own =
            Observer { acceleration_psd_mm2_per_s3: noise.w[1], sensor_mm: (noise.v / period_s).sqrt(), ..believed };
        own.check().map_err(|error| anyhow!("no observer has this W and V: {error}"))?;
        own
    } else {
        believed
    };
    let (continuous, sampled) = if with_fan {
        let (a, b) = plant.three_states();
        design(&a, &b, &noise, period_s)?
    } else {
        let (a, b) = plant.two_states();
        design(&a, &b, &noise, period_s)?
    };
    let states = ["position, mm", "velocity, mm/s", "acceleration by the fan, mm/s²"];
    let flown = if noise.can_fly() { observer.steady_gain(period_s)?.as_slice().to_vec() } else { Vec::new() };
    let document = Document {
        schema: "airball.observer/1",
        states: states[..continuous.len()].to_vec(),
        period_s,
        process_intensities: noise.w,
        reading_intensity_mm2_s: noise.v,
        continuous,
        sampled,
        observer,
        flown,
    };
    Ok((document, patch::of_observer(observer)?))
}

pub(super) fn observer(args: &ObserverArgs) -> Result<()> {
    may_write(None, args.html.as_deref(), &[("patch", args.patch_out.as_ref())])?;
    let ground = Ground::of(Config::read(&args.config.config, &args.config.over())?, args.about)?;
    let (document, patch) = found(&ground, args)?;
    if let Some(path) = &args.patch_out {
        write("patch", path, &patch)?;
    }
    if let Some(path) = &args.html {
        let config = args.config.config.display().to_string();
        let made = typed().in_config(args.config.files());
        let report = Report { made: &made, config: &config, document: &document, patch: &patch };
        page::write(path, &observer::page(&report))?;
    }
    if args.json {
        say(serde_json::to_string(&document)?)?
    } else {
        tell(&document)?
    }
    announce(args.json, &[("patch", args.patch_out.as_deref()), ("page", args.html.as_deref())])
}

fn tell(document: &Document) -> Result<()> {
    for (k, state) in document.states.iter().enumerate() {
        say(format_args!(
            "{state:<32} L = {:.5} 1/s continuous, {:.6} sampled",
            document.continuous[k], document.sampled[k]
        ))?;
    }
    if document.flown.is_empty() {
        return say("in flight this observer cannot be had: there, process noise acts on the velocity alone");
    }
    let flown: Vec<String> = document.flown.iter().map(|l| format!("{l:.6}")).collect();
    say(format_args!("in flight, with hover as a state: L = [{}] sampled", flown.join(", ")))
}

/// Continuous and sampled gain under white noise; the position is read.
fn design<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    noise: &Noise,
    period_s: f64,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let w = SMatrix::<f64, N, N>::from_fn(|i, j| if i == j { noise.w[i] } else { 0.0 });
    let mut c = RowSVector::<f64, N>::zeros();
    c[0] = 1.0;
    let over = discretise(a, b, &w, period_s);
    let continuous = kalman(a, &c, &w, noise.v)?;
    let sampled = sampled_kalman(&over.transition, &c, &over.noise, noise.v / period_s)?;
    Ok((continuous.iter().copied().collect(), sampled.iter().copied().collect()))
}

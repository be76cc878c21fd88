//! `airball design observer`: the steady-state Kalman filter of a config's model and noise.

use super::{Ground, NAME, patch, write};
use crate::cli::ObserverArgs;
use crate::commands::{announce, may_write, say};
use crate::config::Config;
use crate::report::design::observer::Document;
use crate::report::design::page::observer::{self, Report};
use crate::report::kit::page;
use anyhow::{Result, anyhow, bail};
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

pub(super) fn observer(args: &ObserverArgs) -> Result<()> {
    may_write(None, args.html.as_deref(), &[("patch", args.patch_out.as_ref())])?;
    let ground = Ground::of(Config::read(&args.config.config, &args.config.over())?, args.about)?;
    let period_s = ground.config.need(NAME, "loop", |tables| tables.r#loop.as_ref())?.period_s;
    let (plant, observer) = (ground.plant, ground.observer()?);
    let (psd, sensor_mm) = (observer.acceleration_psd_mm2_per_s3, observer.sensor_mm);
    let (continuous, sampled) = if plant.fan_lag_s > 0.0 {
        let (a, b) = plant.three_states();
        design(&a, &b, psd, sensor_mm, period_s)?
    } else {
        let (a, b) = plant.two_states();
        design(&a, &b, psd, sensor_mm, period_s)?
    };
    let states = ["position, mm", "velocity, mm/s", "acceleration by the fan, mm/s²"];
    let document = Document {
        schema: "airball.observer/1",
        states: states[..continuous.len()].to_vec(),
        period_s,
        reading_intensity_mm2_s: sensor_mm * sensor_mm * period_s,
        continuous,
        sampled,
        observer,
        flown: observer.steady_gain(period_s)?.as_slice().to_vec(),
    };
    let patch = patch::of_observer(observer)?;
    if let Some(path) = &args.patch_out {
        write("patch", path, &patch)?;
    }
    if let Some(path) = &args.html {
        let config = args.config.config.display().to_string();
        page::write(path, &observer::page(&Report { config: &config, document: &document, patch: &patch }))?;
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
    let flown: Vec<String> = document.flown.iter().map(|l| format!("{l:.6}")).collect();
    say(format_args!("in flight, with hover as a state: L = [{}] sampled", flown.join(", ")))
}

/// Continuous and sampled gain under white acceleration; the position is read.
fn design<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    psd: f64,
    sensor_mm: f64,
    period_s: f64,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let (mut w, mut c) = (SMatrix::<f64, N, N>::zeros(), RowSVector::<f64, N>::zeros());
    (w[(1, 1)], c[0]) = (psd, 1.0);
    let variance = sensor_mm * sensor_mm;
    let over = discretise(a, b, &w, period_s);
    let continuous = kalman(a, &c, &w, variance * period_s)?;
    let sampled = sampled_kalman(&over.transition, &c, &over.noise, variance)?;
    Ok((continuous.iter().copied().collect(), sampled.iter().copied().collect()))
}

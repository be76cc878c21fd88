//! `airball design observer`: the steady-state Kalman filter of a config's model and noise.

use super::NAME;
use crate::cli::ObserverArgs;
use crate::commands::say;
use crate::config::Config;
use anyhow::Result;
use control::design::discretise::discretise;
use control::design::riccati::{kalman, sampled_kalman};
use nalgebra::{RowSVector, SMatrix, SVector};
use serde::Serialize;

/// The document of `airball design observer --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Document {
    schema: &'static str,
    states: Vec<&'static str>,
    period_s: f64,
    /// V: one reading's variance times the period, as if it were white noise in continuous time, mm²·s.
    reading_intensity_mm2_s: f64,
    /// L of dx̂/dt = … + L·(y − ŷ).
    continuous: Vec<f64>,
    /// L of x̂ ← x̂ + L·(y − ŷ) at every reading.
    sampled: Vec<f64>,
}

pub(super) fn observer(args: &ObserverArgs) -> Result<()> {
    let config = Config::read(&args.config.config, &args.config.patch)?;
    let model = config.need(NAME, "plant", |tables| tables.plant.as_ref())?;
    let period_s = config.need(NAME, "loop", |tables| tables.r#loop.as_ref())?.period_s;
    let (plant, noise) = (model.linear(), model.noise);
    let both = if plant.fan_lag_s > 0.0 {
        let (a, b) = plant.three_states();
        design(&a, &b, noise.acceleration_psd_mm2_per_s3, noise.sensor_mm, period_s)?
    } else {
        let (a, b) = plant.two_states();
        design(&a, &b, noise.acceleration_psd_mm2_per_s3, noise.sensor_mm, period_s)?
    };
    let states = ["position, mm", "velocity, mm/s", "acceleration by the fan, mm/s²"];
    let document = Document {
        schema: "airball.observer/1",
        states: states[..both.0.len()].to_vec(),
        period_s,
        reading_intensity_mm2_s: noise.sensor_mm * noise.sensor_mm * period_s,
        continuous: both.0,
        sampled: both.1,
    };
    if args.json {
        return say(serde_json::to_string(&document)?);
    }
    for (k, state) in document.states.iter().enumerate() {
        say(format_args!(
            "{state:<32} L = {:.5} a second, {:.6} a reading",
            document.continuous[k], document.sampled[k]
        ))?;
    }
    Ok(())
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

//! The gains of the observer in steady state, when every measurement comes once in every period.
//!
//! ```text
//! P = covariance before the readings, of the Riccati equation with all of them      information: Σ hᵀ·h/r
//! in turn   S = h·P·hᵀ + r      L = P·hᵀ/S      P ← P − L·S·Lᵀ
//! ```
//!
//! Sequential updates give the same result as a joint one. A reading without the others is then weighted slightly less
//! than is optimal.

use super::{FAN, Observer, POSITION};
use crate::believed::{State, Transition};
use crate::design::DesignError;
use crate::design::riccati::covariance_of_several;
use nalgebra::{RowSVector, SMatrix};

/// The filter's numbers in steady state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steady {
    /// The position, by the first sensor.
    pub(super) first: Weight,
    /// The same by the second, after the first.
    pub(super) second: Option<Weight>,
    /// The fan's state by its speed, after the sensors.
    pub(super) fan: Option<Weight>,
    /// P after all of them.
    pub(super) covariance: Covariance,
}

/// The weight of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weight {
    /// L.
    pub(super) gain: State,
    /// S of a reading that comes on time.
    pub(super) variance: f64,
}

type Covariance = SMatrix<f64, 4, 4>;

impl Steady {
    /// The gains to which the filter converges when readings come every `period_s`.
    pub(super) fn of(set: &Observer, period_s: f64, transition: &Transition) -> Result<Self, DesignError> {
        let mut covariance = before_readings(set, period_s, transition)?;
        let first = weight(&mut covariance, &POSITION, set.reading_variance());
        let second = set.second_variance().map(|variance| weight(&mut covariance, &POSITION, variance));
        let fan = set.measured_fan().map(|fan| weight(&mut covariance, &FAN, fan.control * fan.control));
        Ok(Self { first, second, fan, covariance })
    }
}

fn before_readings(set: &Observer, period_s: f64, transition: &Transition) -> Result<Covariance, DesignError> {
    let noise = set.noise(period_s, transition);
    let mut information = read(&POSITION, set.reading_variance());
    if let Some(variance) = set.second_variance() {
        information += read(&POSITION, variance);
    }
    if let Some(fan) = set.measured_fan() {
        information += read(&FAN, fan.control * fan.control);
    }
    if set.disturbance_psd_per_s.is_some() {
        return covariance_of_several(&transition.matrix, &information, &noise);
    }
    // A hover that is known never wanders and never decays: it is no state of this filter.
    let first = |whole: &Covariance| whole.fixed_view::<3, 3>(0, 0).into_owned();
    Ok(covariance_of_several(&first(&transition.matrix), &first(&information), &first(&noise))?.fixed_resize(0.0))
}

/// hᵀ·h/r.
fn read(row: &RowSVector<f64, 4>, variance: f64) -> Covariance {
    row.transpose() * row / variance
}

/// The weight of a reading by `row`, and the covariance after it.
fn weight(covariance: &mut Covariance, row: &RowSVector<f64, 4>, variance: f64) -> Weight {
    let along = *covariance * row.transpose();
    let variance = (row * along)[0] + variance;
    let gain = along / variance;
    *covariance -= gain * along.transpose();
    Weight { gain, variance }
}

//! The motion of a ball under constant duty, and the force of that duty.
//!
//! ```text
//! ẏ = v      v̇ = w − a·v + white noise (q)      τ·ẇ = F − w      reading = y + noise (r)
//! ```
//!
//! F is the force of the constant duty, w the part that the fan already exerts. At the start the ball is at rest except
//! for small motions left by the controller: v ~ N(0, s_v²), w ~ N(0, s_w²). A Kalman filter with F as a fourth state
//! gives the likelihood of τ, q, r, s_v, s_w, and F itself. The drag a must be known: the motion does not change if a
//! and 1/τ are exchanged, and only the air's noise separates them weakly. The prior of F is flat in the displacement of
//! the ball, not in mm/s²: otherwise smaller forces would be more likely for no reason.
//! Source: the thesis, equations 3.1.1.14 and 3.1.3.6; the filter: Anderson & Moore, *Optimal Filtering*.

use super::hold::Hold;
use crate::filter::innovation::{Innovation, Reading};
use crate::linear::step::integrals;
use nalgebra::{Matrix4, Vector4};

/// Standard deviation of the prior of the force, mm/s²: practically uninformative.
const ANY_FORCE: f64 = 1e5;
/// Standard deviation of the initial position about the first reading, mm.
const ANY_PLACE: f64 = 100.0;
/// Smallest distance of a·τ from 1, where the exponentials of fan and ball coincide.
const APART: f64 = 1e-5;

/// The parameters that all jumps of a record share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Glide {
    /// a, 1/s.
    drag_per_s: f64,
    /// τ, seconds.
    lag_s: f64,
    /// q, mm²/s³.
    psd: f64,
    /// r, mm².
    sensor_variance: f64,
    /// s_v, mm/s.
    start_speed: f64,
    /// s_w, mm/s².
    start_push: f64,
}

/// The result of one jump under a [`Glide`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    /// ln p of the readings, up to a constant.
    pub(super) nats: f64,
    /// F, mm/s².
    pub(super) force: f64,
    /// Its standard deviation, mm/s².
    pub(super) deviation: f64,
}

/// Initial values of the parameters, and the standard deviations of their logarithms in a weak prior.
const USUAL: [f64; Glide::NUMBERS] = [0.2, 300.0, 6.0, 10.0, 60.0];
const SPREAD: [f64; Glide::NUMBERS] = [1.0, 2.0, 2.0, 1.5, 1.5];

impl Glide {
    /// Number of estimated parameters.
    pub(super) const NUMBERS: usize = 5;

    /// Initial values of the logarithms.
    pub(super) fn start() -> Vec<f64> {
        USUAL.map(f64::ln).to_vec()
    }

    /// From the drag, 1/s, and the logarithms of the estimated parameters.
    pub(super) fn of(drag_per_s: f64, logarithms: &[f64]) -> Self {
        let at = |i: usize| logarithms.get(i).copied().unwrap_or_default().clamp(-20.0, 20.0).exp();
        let lag_s = at(0);
        let near = drag_per_s * lag_s - 1.0;
        let lag_s = if near.abs() < APART { lag_s * (1.0 + APART.copysign(near) - near) } else { lag_s };
        Self { drag_per_s, lag_s, psd: at(1), sensor_variance: at(2), start_speed: at(3), start_push: at(4) }
    }

    /// Log-prior of the parameters, up to a constant.
    pub(super) fn prior(logarithms: &[f64]) -> f64 {
        let off = logarithms.iter().zip(USUAL.iter().zip(SPREAD)).map(|(x, (usual, spread))| (x - usual.ln()) / spread);
        -0.5 * off.map(|x| x * x).sum::<f64>()
    }

    /// Filters the readings of a jump.
    pub(super) fn along(&self, hold: &Hold) -> Way {
        let Some(&(first_s, first_mm)) = hold.readings.first() else {
            return Way { nats: 0.0, force: 0.0, deviation: ANY_FORCE };
        };
        let mut state = Vector4::new(first_mm, 0.0, 0.0, 0.0);
        let spread = [ANY_PLACE, self.start_speed, self.start_push, ANY_FORCE];
        let mut covariance = Matrix4::from_diagonal(&Vector4::from(spread.map(|s| s * s)));
        let mut nats = self.moves(hold.duration_s()).ln();
        let mut before_s = first_s;
        let mut over = (0.0, self.over(0.0));
        for &(time_s, reading) in &hold.readings {
            let dt = time_s - before_s;
            if dt > 0.0 {
                if (dt - over.0).abs() > 1e-9 {
                    over = (dt, self.over(dt));
                }
                let (transition, noise) = over.1;
                state = transition * state;
                covariance = transition * covariance * transition.transpose() + noise;
            }
            before_s = time_s;
            let variance = covariance[(0, 0)] + self.sensor_variance;
            let reading = Reading { row: 0, position_mm: reading, outliers: None, coarse: None };
            let seen = Innovation::of(reading, state[0], variance);
            let gain = covariance.column(0) / variance;
            state += gain * (seen.standardised * variance.sqrt());
            covariance -= gain * gain.transpose() * (variance * seen.weight);
            nats += seen.log_density;
        }
        Way { nats, force: state[3], deviation: covariance[(3, 3)].max(0.0).sqrt() }
    }

    /// Displacement of a ball from rest in `time_s` by a force of 1 mm/s², mm.
    fn moves(&self, time_s: f64) -> f64 {
        self.over(time_s).0[(0, 3)].max(f64::MIN_POSITIVE)
    }

    /// Transition matrix and process noise over `dt` seconds.
    fn over(&self, dt: f64) -> (Matrix4<f64>, Matrix4<f64>) {
        let (a, rate) = (self.drag_per_s, 1.0 / self.lag_s);
        let (ball, fan) = ((-a * dt).exp(), (-rate * dt).exp());
        let [slowed, displacement] = integrals(a, dt);
        // Velocity and displacement by a force that decays with the fan lag.
        let speed = (fan - ball) / (a - rate);
        let way = ((1.0 - fan) * self.lag_s - slowed) / (a - rate);
        #[rustfmt::skip]
        let transition = Matrix4::new(
            1.0, slowed, way,   displacement - way,
            0.0, ball,   speed, slowed - speed,
            0.0, 0.0,    fan,   1.0 - fan,
            0.0, 0.0,    0.0,   1.0,
        );
        // Between two readings the drag hardly changes the process noise.
        let mut noise = Matrix4::zeros();
        noise[(0, 0)] = self.psd * dt.powi(3) / 3.0;
        noise[(0, 1)] = self.psd * dt.powi(2) / 2.0;
        noise[(1, 0)] = noise[(0, 1)];
        noise[(1, 1)] = self.psd * dt;
        (transition, noise)
    }
}

#[cfg(test)]
mod tests {
    use super::Glide;
    use crate::measure::timed_jump::acceleration;

    #[test]
    fn without_a_lag_the_way_is_that_of_the_force_curve() {
        let glide = Glide::of(3.9, &[1e-6_f64.ln(), 5.0, 1.0, 1.0, 1.0]);
        let force = acceleration(300.0, 0.8, 3.9).unwrap();
        assert!((force * glide.moves(0.8) - 300.0).abs() < 1e-2, "{}", force * glide.moves(0.8));
    }

    #[test]
    fn two_short_ways_are_one_long_one() {
        let glide = Glide::of(3.9, &[(1.0_f64 / 3.9).ln(), 5.0, 1.0, 1.0, 1.0]);
        let (short, long) = (glide.over(0.3).0, glide.over(0.6).0);
        assert!((short * short - long).abs().max() < 1e-9, "{}", short * short - long);
    }
}

//! The linear plant of a design.
//!
//! ```text
//!                  K·e^(−s·τ)                       ball: s² + a·s + g      g: lift that falls with height, 1/s²
//! G(s) = ─────────────────────────────────────     fan: 1 + τ_f·s         sensor: 1 + τ_s·s       τ: sum of all delays
//!         (s² + a·s + g)·(1 + τ_f·s)·(1 + τ_s·s)
//! sampled: G(z) = (1 − z⁻¹)·Z{ y(t − τ) }          y: step response; zero-order hold, exact for every delay; δ = z − 1
//! continuous: e^(−s·τ) by the diagonal Padé approximant of order 4, whose phase errs by less than 0.1° up to ω·τ = 3
//! ```
//!
//! Source: the thesis, equations 3.1.1.12 to 14 (K_g/(s(s + a)) and the fan's pole b = 1/τ_f, so that K = K_g);
//! sampling: Åström & Wittenmark, *Computer-Controlled Systems*, "Sampling a system with time delay".

use super::discretise::discretise;
use super::error::DesignError;
use super::polynomial::Polynomial;
use super::transfer::{Plane, Transfer};
use libm::{cos, exp, expm1, floor, sin, sqrt};
use nalgebra::{Complex, SMatrix, SVector};

/// A delay is at most so many periods of the sampled loop.
pub const MOST_PERIODS: usize = 32;

/// The linear plant of a design.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Linear {
    /// K: acceleration per unit of the control value, mm/s² per percent of duty.
    pub gain: f64,
    /// a: linear drag, 1/s.
    pub drag_per_s: f64,
    /// g: how fast the lift falls with height, 1/s². Zero in an even pipe.
    pub gradient_per_s2: f64,
    /// τ_f: time constant of the fan, seconds. Zero: none.
    pub fan_lag_s: f64,
    /// τ_s: time constant of the sensor, seconds. Zero: none.
    pub sensor_lag_s: f64,
    /// τ: delays of actuator and sensor together, seconds.
    pub delay_s: f64,
}

impl Linear {
    /// `K_g/(s(s + a))`, the two-pole model.
    #[must_use]
    pub fn two_poles(gain: f64, drag_per_s: f64) -> Self {
        Self { gain, drag_per_s, ..Self::default() }
    }

    /// `K_g·b/(s(s + a)(s + b))`, the model with the fan's pole b in 1/s.
    #[must_use]
    pub fn three_poles(gain: f64, drag_per_s: f64, fan_pole_per_s: f64) -> Self {
        Self { fan_lag_s: 1.0 / fan_pole_per_s, ..Self::two_poles(gain, drag_per_s) }
    }

    /// G(s).
    #[must_use]
    pub fn continuous(&self) -> Transfer {
        let ball = Polynomial::new(&[self.gradient_per_s2, self.drag_per_s, 1.0]);
        let lag = |time_s: f64| Polynomial::new(&[1.0, time_s]);
        let poles = ball.times(&lag(self.fan_lag_s)).times(&lag(self.sensor_lag_s));
        let (late, early) = pade(self.delay_s);
        Transfer { numerator: late.scaled(self.gain), denominator: poles.times(&early), plane: Plane::Continuous }
    }

    /// G(δ) behind a zero-order hold, sampled every `period_s` seconds.
    ///
    /// # Errors
    /// [`DesignError::DelayTooLong`]: the delay is longer than [`MOST_PERIODS`].
    pub fn sampled(&self, period_s: f64) -> Result<Transfer, DesignError> {
        let poles = self.sampled_poles(period_s);
        // A delay that differs from whole periods by rounding alone is whole periods.
        let periods = self.delay_s / period_s;
        let whole = floor(periods + 1e-9);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let late = whole as usize + usize::from(periods - whole > 1e-9);
        if late > MOST_PERIODS {
            return Err(DesignError::DelayTooLong { delay_s: self.delay_s, period_s, most: MOST_PERIODS });
        }
        let (order, in_z) = (poles.degree(), poles.shifted(-1.0));
        let length = order + late;
        // Everything in powers of z⁻¹, then multiplied by z^length.
        let rise = |j: usize| {
            let time_s = j as f64 * period_s - self.delay_s;
            if time_s <= 1e-9 * period_s { 0.0 } else { self.step_response(time_s) }
        };
        let mut numerator = [0.0; super::polynomial::CAPACITY];
        for j in 0..=length {
            let change = |k: usize| rise(k) - if k > 0 { rise(k - 1) } else { 0.0 };
            let taken = (0..=order.min(j)).map(|i| in_z.ascending()[order - i] * change(j - i));
            numerator[length - j] = taken.sum();
        }
        Ok(Transfer {
            numerator: Polynomial::new(&numerator[..=length]).shifted(1.0),
            denominator: poles.times(&Polynomial::power(late).shifted(1.0)),
            plane: Plane::Sampled(period_s),
        })
    }

    /// Position, mm, `time_s` after the control value went from 0 to 1, without the delay.
    #[must_use]
    pub fn step_response(&self, time_s: f64) -> f64 {
        let moved = discretise(&self.states().0, &self.states().1, &SMatrix::zeros(), time_s).input;
        if self.sensor_lag_s > 0.0 { moved[3] } else { moved[0] }
    }

    /// A and B for position, velocity, the fan's acceleration and the sensor's reading; a lag of 0 is no state.
    fn states(&self) -> (SMatrix<f64, 4, 4>, SVector<f64, 4>) {
        let (mut a, mut b) = (SMatrix::zeros(), SVector::zeros());
        a[(0, 1)] = 1.0;
        (a[(1, 0)], a[(1, 1)]) = (-self.gradient_per_s2, -self.drag_per_s);
        if self.fan_lag_s > 0.0 {
            (a[(1, 2)], a[(2, 2)], b[2]) = (1.0, -1.0 / self.fan_lag_s, self.gain / self.fan_lag_s);
        } else {
            b[1] = self.gain;
        }
        if self.sensor_lag_s > 0.0 {
            (a[(3, 0)], a[(3, 3)]) = (1.0 / self.sensor_lag_s, -1.0 / self.sensor_lag_s);
        }
        (a, b)
    }

    /// A and B for position and velocity: the plant as if the fan were at once.
    #[must_use]
    pub fn two_states(&self) -> (SMatrix<f64, 2, 2>, SVector<f64, 2>) {
        let bare = Self { fan_lag_s: 0.0, sensor_lag_s: 0.0, ..*self };
        let (a, b) = bare.states();
        (a.fixed_view::<2, 2>(0, 0).into_owned(), b.fixed_rows::<2>(0).into_owned())
    }

    /// A and B for position, velocity and the fan's acceleration. Needs [`Linear::fan_lag_s`] above 0.
    #[must_use]
    pub fn three_states(&self) -> (SMatrix<f64, 3, 3>, SVector<f64, 3>) {
        let (a, b) = self.states();
        (a.fixed_view::<3, 3>(0, 0).into_owned(), b.fixed_rows::<3>(0).into_owned())
    }

    /// The polynomial in δ whose roots are e^(p·T) − 1 for every pole p but the delay's.
    fn sampled_poles(&self, period_s: f64) -> Polynomial {
        let half = self.drag_per_s / 2.0;
        let inside = half * half - self.gradient_per_s2;
        let ball = if inside >= 0.0 {
            // The slow one from the product of the two, so that an integrator is 0 exactly.
            let fast = half + sqrt(inside);
            let slow = if fast > 0.0 { self.gradient_per_s2 / fast } else { 0.0 };
            let factor = |pole: f64| Polynomial::new(&[-expm1(-pole * period_s), 1.0]);
            factor(fast).times(&factor(slow))
        } else {
            let (decay, turn) = (exp(-half * period_s), sqrt(-inside) * period_s);
            let pole = Complex::new(decay * cos(turn) - 1.0, decay * sin(turn));
            Polynomial::new(&[pole.norm_sqr(), -2.0 * pole.re, 1.0])
        };
        let lag = |time_s: f64| {
            if time_s > 0.0 { Polynomial::new(&[-expm1(-period_s / time_s), 1.0]) } else { Polynomial::new(&[1.0]) }
        };
        ball.times(&lag(self.fan_lag_s)).times(&lag(self.sensor_lag_s))
    }
}

/// Numerator and denominator of the diagonal Padé approximant of order 4 of e^(−s·τ).
fn pade(delay_s: f64) -> (Polynomial, Polynomial) {
    if delay_s <= 0.0 {
        return (Polynomial::new(&[1.0]), Polynomial::new(&[1.0]));
    }
    let weights = [1.0, 1.0 / 2.0, 3.0 / 28.0, 1.0 / 84.0, 1.0 / 1680.0];
    let (mut late, mut early) = (weights, weights);
    let mut power = 1.0;
    for k in 0..weights.len() {
        late[k] *= if k.is_multiple_of(2) { power } else { -power };
        early[k] *= power;
        power *= delay_s;
    }
    (Polynomial::new(&late), Polynomial::new(&early))
}

#[cfg(test)]
mod tests {
    use super::{DesignError, Linear, Transfer};
    use crate::design::polynomial::magnitude;
    use libm::{atan2, exp};
    use nalgebra::Complex;

    /// The sampled two-pole plant at z = 1 + δ, from the closed form of the ball's move.
    fn closed_form(gain: f64, drag: f64, t: f64, delta: Complex<f64>) -> Complex<f64> {
        let e = exp(-drag * t);
        let f = (1.0 - e) / drag;
        // C·(z·I − Φ)⁻¹·Γ with Φ = [1 f; 0 e].
        let (moved, faster) = (gain * (t - f) / drag, gain * f);
        (moved * (delta + 1.0 - e) + f * faster) / (delta * (delta + 1.0 - e))
    }

    #[test]
    fn the_sampled_two_pole_plant_is_its_closed_form() {
        let (plant, t) = (Linear::two_poles(254.598, 1.889), 0.018);
        let sampled = plant.sampled(t).unwrap();
        for omega in [0.01, 1.0, 30.0, 174.0] {
            let exact = closed_form(plant.gain, plant.drag_per_s, t, sampled.plane.boundary(omega));
            let found = sampled.response(omega);
            assert!(magnitude(found - exact) < 1e-9 * magnitude(exact), "{omega} rad/s: {found}, exact {exact}");
        }
    }

    #[test]
    fn whole_periods_of_delay_are_powers_of_z_and_parts_lie_between() {
        let t = 0.02;
        let at = |delay_s: f64| Linear { delay_s, ..Linear::three_poles(827.2, 3.896, 3.896) }.sampled(t).unwrap();
        let delta = at(0.0).plane.boundary(2.0);
        let z = delta + 1.0;
        let three = at(0.0).at(delta) / (z * z * z);
        assert!(magnitude(at(3.0 * t).at(delta) - three) < 1e-9 * magnitude(three));
        // Slow signals see a part of a period as the delay that it is.
        let slow = at(0.0).plane.boundary(0.1);
        let lag = |transfer: Transfer| {
            let ratio = transfer.at(slow) / at(0.0).at(slow);
            -atan2(ratio.im, ratio.re) / 0.1
        };
        assert!((lag(at(2.3 * t)) - 2.3 * t).abs() < 1e-6, "{} s", lag(at(2.3 * t)));
    }

    #[test]
    fn a_delay_of_too_many_periods_is_refused() {
        let plant = Linear { delay_s: 1.0, ..Linear::two_poles(1.0, 1.0) };
        let error = plant.sampled(0.02).unwrap_err();
        assert_eq!(error, DesignError::DelayTooLong { delay_s: 1.0, period_s: 0.02, most: 32 });
    }

    #[test]
    fn sampled_and_continuous_agree_where_samples_are_dense() {
        let plant =
            Linear { gradient_per_s2: 9.0, sensor_lag_s: 0.03, delay_s: 0.02, ..Linear::three_poles(827.2, 3.9, 4.2) };
        let (s, z) = (plant.continuous(), plant.sampled(0.002).unwrap());
        for omega in [0.1, 1.0, 3.0, 10.0] {
            // The hold itself delays by half a period.
            let hold = Complex::new(libm::cos(omega * 0.001), -libm::sin(omega * 0.001));
            let (a, b) = (s.response(omega) * hold, z.response(omega));
            assert!(magnitude(a - b) < 1e-4 * magnitude(a), "{omega} rad/s: {a} and {b}");
        }
    }

    #[test]
    fn the_delay_of_the_continuous_plant_has_the_phase_of_a_delay() {
        let late = Linear { delay_s: 0.2, ..Linear::two_poles(1.0, 1.0) }.continuous();
        let prompt = Linear::two_poles(1.0, 1.0).continuous();
        for omega in [1.0, 5.0, 15.0] {
            let ratio = late.response(omega) / prompt.response(omega);
            let exact = Complex::new(libm::cos(0.2 * omega), -libm::sin(0.2 * omega));
            assert!(magnitude(ratio - exact) < 2e-3, "{omega} rad/s: {ratio}, exact {exact}");
        }
    }
}

//! The PID as the design sees it, in s and as the firmware computes it, in δ = z − 1.
//!
//! ```text
//! C(s) = K_p·(1 + 1/(T_i·s) + T_d·s/(1 + T_d·s/N))
//! C(δ) = K_p·(1 + T/(T_i·δ) + N·δ/(δ + 1 − e^(−N·T/T_d)))       forward-Euler integral, exact derivative filter
//! ```
//!
//! With the derivative on the measurement the setpoint sees only K_p·(1 + 1/(T_i·s)).
//! Source: the thesis, section 4.1; the recursions of [`crate::pid`] and [`crate::filter`].

use super::polynomial::Polynomial;
use super::transfer::{Plane, Transfer};
use libm::expm1;

/// Gains of a PID.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// K_p: control value per millimetre.
    pub kp_per_mm: f64,
    /// T_i, seconds. Infinite: no integral.
    pub ti_s: f64,
    /// T_d, seconds. Zero: no derivative.
    pub td_s: f64,
    /// N: how many times faster than T_d the derivative filter is.
    pub derivative_n: f64,
}

impl Gains {
    /// Proportional and integral part alone.
    #[must_use]
    pub const fn pi(kp_per_mm: f64, ti_s: f64) -> Self {
        Self { kp_per_mm, ti_s, td_s: 0.0, derivative_n: 10.0 }
    }

    /// The same without the integral.
    #[must_use]
    pub const fn without_integral(self) -> Self {
        Self { ti_s: f64::INFINITY, ..self }
    }

    /// From error to control value.
    #[must_use]
    pub fn feedback(&self, plane: Plane) -> Transfer {
        let (rest, integral, derivative) = self.parts(plane);
        let direct = rest.times(&integral.denominator).times(&derivative.denominator);
        let numerator = direct
            .plus(&integral.numerator.times(&derivative.denominator))
            .plus(&derivative.numerator.times(&integral.denominator));
        let denominator = integral.denominator.times(&derivative.denominator);
        Transfer { numerator: numerator.scaled(self.kp_per_mm), denominator, plane }
    }

    /// From setpoint to control value, where the derivative acts on the measurement. Its denominator is that of
    /// [`Gains::feedback`].
    #[must_use]
    pub fn setpoint(&self, plane: Plane) -> Transfer {
        let (rest, integral, derivative) = self.parts(plane);
        let proportional = rest.times(&integral.denominator).plus(&integral.numerator);
        Transfer {
            numerator: proportional.times(&derivative.denominator).scaled(self.kp_per_mm),
            denominator: integral.denominator.times(&derivative.denominator),
            plane,
        }
    }

    /// 1, the integral and the derivative, for K_p = 1.
    fn parts(&self, plane: Plane) -> (Polynomial, Transfer, Transfer) {
        let one = Polynomial::new(&[1.0]);
        let none = Transfer { numerator: Polynomial::new(&[0.0]), denominator: one, plane };
        let integral = if self.ti_s.is_finite() { integrator(plane).scaled(1.0 / self.ti_s) } else { none };
        let (td, n) = (self.td_s, self.derivative_n);
        let derivative = match plane {
            _ if td <= 0.0 => none,
            Plane::Continuous => {
                Transfer { numerator: Polynomial::new(&[0.0, td]), denominator: Polynomial::new(&[1.0, td / n]), plane }
            }
            Plane::Sampled(t) => {
                let fade = -expm1(-n * t / td);
                Transfer { numerator: Polynomial::new(&[0.0, n]), denominator: Polynomial::new(&[fade, 1.0]), plane }
            }
        };
        (one, integral, derivative)
    }
}

/// 1/s, or T/δ.
#[must_use]
pub fn integrator(plane: Plane) -> Transfer {
    match plane {
        Plane::Continuous => {
            Transfer { numerator: Polynomial::new(&[1.0]), denominator: Polynomial::new(&[0.0, 1.0]), plane }
        }
        Plane::Sampled(period_s) => {
            Transfer { numerator: Polynomial::new(&[period_s]), denominator: Polynomial::new(&[0.0, 1.0]), plane }
        }
    }
}

/// From setpoint to position.
#[must_use]
pub fn closed(gains: &Gains, plant: &Transfer, derivative_on_error: bool) -> Transfer {
    let feedback = gains.feedback(plant.plane);
    let setpoint = if derivative_on_error { feedback } else { gains.setpoint(plant.plane) };
    Transfer {
        numerator: setpoint.numerator.times(&plant.numerator),
        denominator: feedback.then(plant).closed_denominator(1.0),
        plane: plant.plane,
    }
}

#[cfg(test)]
mod tests {
    use super::{Gains, Plane};
    use crate::design::polynomial::magnitude;
    use nalgebra::Complex;

    const GAINS: Gains = Gains { kp_per_mm: 0.018, ti_s: 15.0, td_s: 0.35, derivative_n: 10.0 };

    #[test]
    fn both_forms_are_the_sum_of_their_parts() {
        let (s, t) = (Complex::new(0.0, 2.0), 0.02);
        let exact = 0.018 * (1.0 + 1.0 / (15.0 * s) + 0.35 * s / (1.0 + 0.035 * s));
        assert!(magnitude(GAINS.feedback(Plane::Continuous).at(s) - exact) < 1e-12);
        let delta = Plane::Sampled(t).boundary(2.0);
        let z = delta + 1.0;
        let pole = libm::exp(-10.0 * t / 0.35);
        let exact = 0.018 * (1.0 + t / (15.0 * (z - 1.0)) + 10.0 * (z - 1.0) / (z - pole));
        assert!(magnitude(GAINS.feedback(Plane::Sampled(t)).at(delta) - exact) < 1e-12);
        let exact = 0.018 * (1.0 + t / (15.0 * (z - 1.0)));
        assert!(magnitude(GAINS.setpoint(Plane::Sampled(t)).at(delta) - exact) < 1e-12);
    }

    #[test]
    fn the_sampled_form_is_what_the_controller_of_the_firmware_does_with_a_sine() {
        use crate::Limits;
        use crate::pid::PidState;
        let pid = crate::design::law::tests::firmware();
        let (t, omega) = (0.02, 3.0);
        let limits = Limits { lower: -1e9, upper: 1e9 };
        let mut state = PidState::default();
        let response = GAINS.feedback(Plane::Sampled(t)).response(omega);
        for k in 0..6000_u32 {
            let phase = omega * t * f64::from(k);
            let control = pid.step(&mut state, libm::sin(phase), 0.0, t, limits);
            // The integral of a sine that starts at 0 keeps a constant part.
            let constant = GAINS.kp_per_mm / GAINS.ti_s * t * 0.5 / libm::tan(omega * t / 2.0);
            let exact = response.re * libm::sin(phase) + response.im * libm::cos(phase) + constant;
            if k > 1000 {
                assert!((control - exact).abs() < 1e-9, "sample {k}: {control}, exact {exact}");
            }
        }
    }

    fn firmware() -> crate::pid::Pid {
        crate::pid::Pid {
            kp_per_mm: GAINS.kp_per_mm,
            ti_s: GAINS.ti_s,
            td_s: GAINS.td_s,
            derivative_n: GAINS.derivative_n,
            derivative_on: crate::pid::DerivativeOn::Error,
            setpoint_weight: 1.0,
            rate_limit_per_s: None,
            anti_windup: crate::pid::AntiWindup::Clamping,
        }
    }
}

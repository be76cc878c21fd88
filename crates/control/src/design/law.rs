//! A control law as the design sees it, and the PID among them: in s and as the firmware computes it, in δ = z − 1.
//!
//! ```text
//! u = S·setpoint − C·position                                   two degrees of freedom over one denominator
//! C(s) = K_p·(1 + 1/(T_i·s) + T_d·s/(1 + T_d·s/N))              S: as C, with b for 1 and c·(derivative term)
//! C(δ) = K_p·(1 + T/(T_i·δ) + N·δ/(δ + 1 − e^(−N·T/T_d)))       forward-Euler integral, exact derivative filter
//! ```
//!
//! Feedback of position and filtered velocity is the PID with T_d = k₂/k₁, c = 0 and b = K_r/k₁ (0 with the integral in
//! place of K_r·r).
//! Source: the thesis, section 4.1; the recursions of [`crate::pid`] and [`crate::filter`].

use super::polynomial::Polynomial;
use super::transfer::{Plane, Transfer};
use crate::pid::{DerivativeOn, Pid};
use libm::expm1;

/// What a controller makes of position and setpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// C: from −position to control value.
    pub feedback: Transfer,
    /// S: from setpoint to control value, with the denominator of `feedback`.
    pub setpoint: Transfer,
}

impl Law {
    /// From setpoint to position, around `plant`.
    #[must_use]
    pub fn closed(&self, plant: &Transfer) -> Transfer {
        Transfer {
            numerator: self.setpoint.numerator.times(&plant.numerator),
            denominator: self.feedback.then(plant).closed_denominator(1.0),
            plane: plant.plane,
        }
    }

    /// From setpoint to control value, around `plant`.
    #[must_use]
    pub fn control(&self, plant: &Transfer) -> Transfer {
        let numerator = self.setpoint.numerator.times(&plant.denominator);
        Transfer { numerator, ..self.closed(plant) }
    }

    /// From a disturbance that adds to the control value to position, around `plant`.
    #[must_use]
    pub fn disturbed(&self, plant: &Transfer) -> Transfer {
        let numerator = self.feedback.denominator.times(&plant.numerator);
        Transfer { numerator, ..self.closed(plant) }
    }
}

/// How much of the setpoint's changes a PID's parts see: its second degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// b: of the proportional part.
    pub setpoint: f64,
    /// c: of the derivative; 1 on the error, 0 on the measurement.
    pub derivative: f64,
}

impl Weights {
    /// Proportional part on the error, derivative on the measurement.
    pub const MEASUREMENT: Self = Self { setpoint: 1.0, derivative: 0.0 };
}

impl From<&Pid> for Weights {
    fn from(pid: &Pid) -> Self {
        let derivative = if pid.derivative_on == DerivativeOn::Error { 1.0 } else { 0.0 };
        Self { setpoint: pid.setpoint_weight, derivative }
    }
}

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

impl From<&Pid> for Gains {
    fn from(pid: &Pid) -> Self {
        let Pid { kp_per_mm, ti_s, td_s, derivative_n, .. } = *pid;
        Self { kp_per_mm, ti_s, td_s, derivative_n }
    }
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

    /// C: from −position to control value.
    #[must_use]
    pub fn feedback(&self, plane: Plane) -> Transfer {
        self.weighted(plane, Weights { setpoint: 1.0, derivative: 1.0 })
    }

    /// The law with both degrees of freedom.
    #[must_use]
    pub fn law(&self, plane: Plane, weights: Weights) -> Law {
        Law { feedback: self.feedback(plane), setpoint: self.weighted(plane, weights) }
    }

    fn weighted(&self, plane: Plane, weights: Weights) -> Transfer {
        let (one, integral, derivative) = self.parts(plane);
        let direct = one.scaled(weights.setpoint).times(&integral.denominator).times(&derivative.denominator);
        let numerator = direct
            .plus(&integral.numerator.times(&derivative.denominator))
            .plus(&derivative.numerator.scaled(weights.derivative).times(&integral.denominator));
        let denominator = integral.denominator.times(&derivative.denominator);
        Transfer { numerator: numerator.scaled(self.kp_per_mm), denominator, plane }
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

#[cfg(test)]
mod tests {
    use super::{Gains, Plane, Weights};
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
        let law = GAINS.law(Plane::Sampled(t), Weights { setpoint: 0.6, derivative: 0.0 });
        let exact = 0.018 * (0.6 + t / (15.0 * (z - 1.0)));
        assert!(magnitude(law.setpoint.at(delta) - exact) < 1e-12);
    }

    #[test]
    fn control_value_and_disturbance_close_the_loop_as_its_equations_do() {
        let plant = crate::design::Linear::three_poles(827.2, 3.896, 3.896).continuous();
        let law = GAINS.law(Plane::Continuous, Weights::MEASUREMENT);
        let s = Complex::new(0.1, 1.7);
        let (p, c) = (plant.at(s), law.feedback.at(s));
        let control = law.setpoint.at(s) / (1.0 + c * p);
        assert!(magnitude(law.control(&plant).at(s) - control) < 1e-9 * magnitude(control));
        let moved = p / (1.0 + c * p);
        assert!(magnitude(law.disturbed(&plant).at(s) - moved) < 1e-9 * magnitude(moved));
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

//! PID by pole placement.
//!
//! ```text
//! K_g·b/(s(s + a)(s + b)) with K_p + K_i/s + K_d·s, closed:
//! s⁴ + (a + b)·s³ + (a·b + K_g·b·K_d)·s² + K_g·b·K_p·s + K_g·b·K_i = (s² + 2δω·s + ω²)·(s + p)·(s + q)
//! q = a + b − 2δω − p          the pole that is left over
//!
//! without the fan's pole:
//! s³ + (a + K_g·K_d)·s² + K_g·K_p·s + K_g·K_i = (s² + 2δω·s + ω²)·(s + p)
//! ```
//!
//! T_i = K_p/K_i, T_d = K_d/K_p. With the setpoint's weight b = 1/(p·T_i) the zero b + 1/(T_i·s) cancels the slow pole
//! p, so that a step does not creep to its end behind an overshoot; at most 1. The derivative's filter, lags of the
//! sensor, delays and the sampling are not in the equations; look at the margins of the loop with them.
//! Source: Åström & Hägglund, *Advanced PID Control*, "Pole placement".

use super::error::DesignError;
use super::law::Gains;
use super::plant::Linear;

/// Where the poles of the closed loop shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// δ: damping of the pair.
    pub damping: f64,
    /// ω: natural frequency of the pair, rad/s.
    pub omega: f64,
    /// p: the real pole of the integral, 1/s.
    pub real_pole_per_s: f64,
}

/// A PID, and the pole that its plant leaves over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// The gains.
    pub gains: Gains,
    /// b: the setpoint's weight.
    pub setpoint_weight: f64,
    /// q, 1/s. `None`: the plant has no fan's pole.
    pub left_over_per_s: Option<f64>,
}

/// The PID that gives `plant` the poles `wanted`; `derivative_n` is the N of its filter.
///
/// # Errors
/// [`DesignError::NoRoom`], [`DesignError::NegativeGain`].
pub fn place(plant: &Linear, wanted: Wanted, derivative_n: f64) -> Result<Placed, DesignError> {
    let Wanted { damping, omega, real_pole_per_s: p } = wanted;
    let (sum, square) = (2.0 * damping * omega, omega * omega);
    let (a, gradient) = (plant.drag_per_s, plant.gradient_per_s2);
    // The ball's pair s² + a·s + g in place of s·(s + a) adds g to the coefficients that hold the lift.
    let (kp, ki, kd, left_over) = if plant.fan_lag_s > 0.0 {
        let b = 1.0 / plant.fan_lag_s;
        let q = a + b - sum - p;
        if q <= 0.0 {
            return Err(DesignError::NoRoom { left_over_per_s: q, sum_per_s: a + b });
        }
        let both = p + q;
        let gain = plant.gain * b;
        let kd = (square + sum * both + p * q - a * b - gradient) / gain;
        let kp = (square * both + sum * p * q - gradient * b) / gain;
        (kp, square * p * q / gain, kd, Some(q))
    } else {
        let kd = (sum + p - a) / plant.gain;
        ((square + sum * p - gradient) / plant.gain, square * p / plant.gain, kd, None)
    };
    for (gain, value) in [("K_p", kp), ("K_i", ki), ("K_d", kd)] {
        if value < 0.0 || (gain == "K_p" && value == 0.0) {
            return Err(DesignError::NegativeGain { gain, value });
        }
    }
    let ti_s = if ki > 0.0 { kp / ki } else { f64::INFINITY };
    Ok(Placed {
        gains: Gains { kp_per_mm: kp, ti_s, td_s: kd / kp, derivative_n },
        setpoint_weight: (1.0 / (p * ti_s)).min(1.0),
        left_over_per_s: left_over,
    })
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::{Wanted, place};
    use crate::design::law::Weights;
    use crate::design::polynomial::magnitude;
    use crate::design::step::figures;
    use crate::design::{Complex, Linear, Plane};
    use core::f64::consts::PI;
    use libm::{exp, sqrt};

    const WANTED: Wanted = Wanted { damping: 0.7, omega: 2.0, real_pole_per_s: 0.8 };

    /// With a derivative filter that is very fast the closed loop has the wanted poles.
    fn assert_poles(plant: Linear, wanted: Wanted) {
        let placed = place(&plant, wanted, 1e7).unwrap();
        let found = placed.gains.feedback(Plane::Continuous).then(&plant.continuous()).closed_poles(1.0);
        let Wanted { damping, omega, real_pole_per_s } = wanted;
        let (re, im) = (-damping * omega, omega * sqrt(1.0 - damping * damping));
        let pair = [Complex::new(re, im), Complex::new(re, -im)];
        let real = [Some(real_pole_per_s), placed.left_over_per_s].into_iter().flatten().map(|p| Complex::new(-p, 0.0));
        for pole in pair.into_iter().chain(real) {
            assert!(found.iter().any(|p| magnitude(p - pole) < 1e-4), "{pole} is not in {found:?}");
        }
    }

    #[test]
    fn the_closed_loop_has_the_poles_that_were_asked_for() {
        assert_poles(Linear::two_poles(254.598, 1.889), WANTED);
        assert_poles(Linear::three_poles(827.2, 3.896, 3.896), Wanted { omega: 2.5, ..WANTED });
        assert_poles(
            Linear { gradient_per_s2: 1.5, ..Linear::three_poles(827.2, 3.896, 6.0) },
            Wanted { omega: 3.0, ..WANTED },
        );
    }

    #[test]
    fn with_its_weight_a_step_does_not_see_the_integrals_pole() {
        let plant = Linear::two_poles(254.598, 1.889);
        let placed = place(&plant, WANTED, 1e7).unwrap();
        let step = |setpoint| {
            let law = placed.gains.law(Plane::Continuous, Weights { setpoint, derivative: 0.0 });
            figures(&law.closed(&plant.continuous())).unwrap()
        };
        // What is left is the pair: overshoot e^(−πδ/√(1 − δ²)).
        let exact = 100.0 * exp(-PI * 0.7 / sqrt(1.0 - 0.49));
        let (weighted, whole) = (step(placed.setpoint_weight), step(1.0));
        assert!((weighted.overshoot_percent - exact).abs() < 0.01, "{weighted:?}, exact {exact} %");
        assert!(whole.overshoot_percent > 2.0 * exact && whole.settling_s > weighted.settling_s, "{whole:?}");
    }

    #[test]
    fn poles_faster_than_the_fan_allows_are_refused_with_the_numbers() {
        let error =
            place(&Linear::three_poles(827.2, 3.896, 3.896), Wanted { omega: 6.0, ..WANTED }, 10.0).unwrap_err();
        let said = std::format!("{error}");
        assert!(said.contains("-7.792") && said.contains("-1.408"), "{said}");
    }

    #[test]
    fn poles_slower_than_the_drag_would_need_a_negative_derivative() {
        let error = place(&Linear::two_poles(827.2, 3.896), Wanted { omega: 1.0, ..WANTED }, 10.0).unwrap_err();
        assert!(std::format!("{error}").contains("K_d"), "{error}");
    }
}

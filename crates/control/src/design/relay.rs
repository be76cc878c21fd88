//! A PID from the oscillation that a relay makes.
//!
//! ```text
//! relay of height d and hysteresis ±h at an oscillation of amplitude A:
//! N(A) = 4d/(πA)·( √(1 − h²/A²) − j·h/A )          |N| = 4d/(πA)
//! it oscillates where G(jω) = −1/N(A):              |G| = πA/(4d)        arg G = −180° + asin(h/A)
//! without hysteresis: K_u = 4d/(πA), T_u = 2π/ω
//!
//! Ziegler–Nichols   K_p = 0.6·K_u     T_i = T_u/2      T_d = T_u/8
//! Tyreus–Luyben     K_p = 0.454·K_u   T_i = 2.2·T_u    T_d = T_u/6.3          for integrating plants, as here
//! phase margin φ    the PID turns the point G(jω) to −180° + φ at magnitude 1, with T_i = α·T_d:
//!                   K_p = cos θ/|G|   T_d = ( tan θ + √(4/α + tan²θ) )/(2ω)   θ = φ − asin(h/A)
//! ```
//!
//! Sources: Åström & Hägglund, "Automatic tuning of simple regulators with specifications on phase and amplitude
//! margins", *Automatica* 20, 1984; Tyreus & Luyben, *Ind. Eng. Chem. Res.* 31, 1992; Ziegler & Nichols, *Trans. ASME*
//! 64, 1942.

use super::error::DesignError;
use super::law::Gains;
use core::f64::consts::{PI, TAU};
use libm::{asin, cos, sqrt, tan};
use nalgebra::Complex;

/// T_i/T_d of the rule for a phase margin: 16 is well apart from the double zero at 4 and slow enough for a plant that
/// integrates.
pub const TI_OVER_TD: f64 = 16.0;

/// A relay in place of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relay {
    /// d: control value to either side of hover.
    pub height: f64,
    /// h: the error must pass ±h before it switches, mm.
    pub hysteresis_mm: f64,
}

/// One point of the plant's frequency response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// ω, rad/s.
    pub omega: f64,
    /// |G|, mm per unit of control value.
    pub magnitude: f64,
    /// How far the phase is short of −180°, radians: asin(h/A).
    pub short_of_half_turn: f64,
}

/// How the gains follow from the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// Fast, with a quarter of each swing left in the next.
    ZieglerNichols,
    /// For plants that integrate: half the gain, a slow integral.
    TyreusLuyben,
    /// Phase margin in degrees.
    PhaseMargin(f64),
}

impl Relay {
    /// The relay's next control value, `last` being the one before it.
    #[must_use]
    pub fn control(&self, error_mm: f64, last: f64) -> f64 {
        if error_mm > self.hysteresis_mm {
            self.height
        } else if error_mm < -self.hysteresis_mm || last < 0.0 {
            -self.height
        } else {
            self.height
        }
    }

    /// N(A): fundamental of the relay's output over that of its input, at `amplitude_mm` above the hysteresis.
    #[must_use]
    pub fn describing_function(&self, amplitude_mm: f64) -> Complex<f64> {
        let share = self.hysteresis_mm / amplitude_mm;
        Complex::new(sqrt(1.0 - share * share), -share) * (4.0 * self.height / (PI * amplitude_mm))
    }

    /// The point that an oscillation of `amplitude_mm` and `period_s` shows.
    ///
    /// # Errors
    /// [`DesignError::WithinHysteresis`].
    pub fn point(&self, amplitude_mm: f64, period_s: f64) -> Result<Point, DesignError> {
        let hysteresis_mm = self.hysteresis_mm;
        if amplitude_mm <= hysteresis_mm {
            return Err(DesignError::WithinHysteresis { amplitude_mm, hysteresis_mm });
        }
        Ok(Point {
            omega: TAU / period_s,
            magnitude: PI * amplitude_mm / (4.0 * self.height),
            short_of_half_turn: asin(hysteresis_mm / amplitude_mm),
        })
    }
}

impl Point {
    /// K_u: the proportional gain at which the plant would oscillate at this frequency, hysteresis neglected.
    #[must_use]
    pub fn ultimate_gain(&self) -> f64 {
        1.0 / self.magnitude
    }

    /// T_u, seconds.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        TAU / self.omega
    }

    /// The gains by `rule`; `derivative_n` is the N of the filter.
    ///
    /// # Errors
    /// [`DesignError::PhaseOutOfReach`].
    pub fn gains(&self, rule: Rule, derivative_n: f64) -> Result<Gains, DesignError> {
        let (gain, period_s) = (self.ultimate_gain(), self.period_s());
        let of = |share, ti: f64, td: f64| Gains {
            kp_per_mm: share * gain,
            ti_s: ti * period_s,
            td_s: td * period_s,
            derivative_n,
        };
        match rule {
            Rule::ZieglerNichols => Ok(of(0.6, 0.5, 0.125)),
            Rule::TyreusLuyben => Ok(of(1.0 / 2.2, 2.2, 1.0 / 6.3)),
            Rule::PhaseMargin(margin_deg) => {
                let lead = margin_deg.to_radians() - self.short_of_half_turn;
                if lead.abs() >= 0.49 * PI {
                    return Err(DesignError::PhaseOutOfReach { lead_deg: lead.to_degrees() });
                }
                let slope = tan(lead);
                let td_s = (slope + sqrt(4.0 / TI_OVER_TD + slope * slope)) / (2.0 * self.omega);
                Ok(Gains { kp_per_mm: gain * cos(lead), ti_s: TI_OVER_TD * td_s, td_s, derivative_n })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Relay, Rule, TAU};
    use crate::design::discretise::discretise;
    use crate::design::margins::phase_margins;
    use crate::design::polynomial::magnitude;
    use crate::design::{Complex, Linear, Plane};
    use nalgebra::{SMatrix, SVector};

    #[test]
    fn the_describing_function_is_the_fundamental_of_the_relays_output() {
        let relay = Relay { height: 0.8, hysteresis_mm: 3.0 };
        let (amplitude, steps) = (10.0, 200_000_u32);
        let mut last = -0.8;
        let mut sum = Complex::new(0.0, 0.0);
        for k in 0..2 * steps {
            let phase = TAU * f64::from(k) / f64::from(steps);
            last = relay.control(amplitude * libm::sin(phase), last);
            if k >= steps {
                sum += Complex::new(libm::sin(phase), libm::cos(phase)) * last;
            }
        }
        let exact = relay.describing_function(amplitude);
        let found = sum * (2.0 / f64::from(steps) / amplitude);
        assert!(magnitude(found - exact) < 1e-4 * magnitude(exact), "{found}, exact {exact}");
    }

    /// A relay around the three-pole plant: amplitude and period of what it settles at.
    fn oscillation(plant: &Linear, relay: Relay) -> (f64, f64) {
        let (a, b) = plant.three_states();
        let dt = 1e-4;
        let over = discretise(&a, &b, &SMatrix::zeros(), dt);
        let (mut state, mut control): (SVector<f64, 3>, f64) = (SVector::from([5.0, 0.0, 0.0]), 0.8);
        let (mut highest, mut rising, mut last_rise, mut period) = (0.0_f64, false, 0.0, 0.0);
        for k in 0..400_000_u32 {
            let t = dt * f64::from(k);
            let switched = relay.control(-state[0], control);
            if switched > control {
                (rising, period, last_rise) = (true, t - last_rise, t);
            }
            control = switched;
            state = over.transition * state + over.input * control;
            if rising && t > 30.0 {
                highest = highest.max(state[0]);
            }
        }
        (highest, period)
    }

    #[test]
    fn a_relay_finds_the_critical_gain_of_the_three_pole_plant() {
        let (plant, relay) = (Linear::three_poles(827.2, 3.896, 3.896), Relay { height: 0.8, hysteresis_mm: 0.0 });
        let (amplitude, period_s) = oscillation(&plant, relay);
        let point = relay.point(amplitude, period_s).unwrap();
        // K_u = 2·a²/K_g at ω = a; a relay's harmonics cost the method a few percent.
        let exact = 2.0 * 3.896 * 3.896 / 827.2;
        assert!((point.ultimate_gain() / exact - 1.0).abs() < 0.05, "{} beside {exact}", point.ultimate_gain());
        assert!((point.omega / 3.896 - 1.0).abs() < 0.03, "{} rad/s", point.omega);
    }

    #[test]
    fn the_point_behind_a_hysteresis_lies_on_the_plants_frequency_response() {
        let (plant, relay) = (Linear::three_poles(827.2, 3.896, 3.896), Relay { height: 0.8, hysteresis_mm: 8.0 });
        let (amplitude, period_s) = oscillation(&plant, relay);
        let point = relay.point(amplitude, period_s).unwrap();
        let there = plant.continuous().response(point.omega);
        assert!((point.magnitude / magnitude(there) - 1.0).abs() < 0.05, "{point:?} beside {there}");
        let short = libm::atan2(-there.im, -there.re);
        assert!((point.short_of_half_turn - short).abs() < 0.06, "{point:?} beside {short} rad");
    }

    #[test]
    fn the_rule_for_a_phase_margin_gives_that_margin_at_that_frequency() {
        let plant = Linear::three_poles(827.2, 3.896, 3.896).continuous();
        let there = plant.response(3.0);
        let point = super::Point {
            omega: 3.0,
            magnitude: magnitude(there),
            short_of_half_turn: libm::atan2(-there.im, -there.re),
        };
        // A derivative filter that is very fast takes no phase.
        let gains = point.gains(Rule::PhaseMargin(50.0), 1e7).unwrap();
        let margins = phase_margins(&gains.feedback(Plane::Continuous).then(&plant));
        assert!(
            margins.iter().any(|m| (m.omega - 3.0).abs() < 1e-5 && (m.phase_deg - 50.0).abs() < 1e-3),
            "{margins:?}"
        );
    }

    #[test]
    fn an_oscillation_inside_the_hysteresis_is_refused() {
        assert!(Relay { height: 0.8, hysteresis_mm: 8.0 }.point(5.0, 1.0).is_err());
    }
}

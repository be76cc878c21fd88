//! Margins: the changes of gain, phase and delay at which a loop loses stability.
//!
//! ```text
//! gain    at every ω with Im L = 0, Re L < 0:    1/|L|             above 1: how much more, below 1: how much less
//! phase   at every ω with |L| = 1:               180° + arg L
//! delay   at every ω with |L| = 1:               that phase, as an angle above 0, divided by ω
//! ```
//!
//! Crossings are looked for on a grid of 400 frequencies a decade and refined by bisection; two crossings closer than
//! half a percent may be missed. They are margins only if the loop is stable; check that first.
//! Source: Åström & Murray, *Feedback Systems*, "Stability Margins".

use super::polynomial::magnitude;
use super::transfer::{Plane, Transfer};
use libm::{atan2, log, pow};
use nalgebra::Complex;

/// Crossings at most.
pub const MOST: usize = 16;
/// The frequencies that are looked at, rad/s; a sampled loop ends at π/T.
const LOWEST: f64 = 1e-4;
const HIGHEST: f64 = 1e4;
/// Grid and refinement.
const PER_DECADE: f64 = 400.0;
const BISECTIONS: u32 = 60;

/// Where the loop's phase is −180°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainMargin {
    /// At this frequency, rad/s.
    pub omega: f64,
    /// The factor that brings the loop to the edge of stability.
    pub factor: f64,
}

/// Where the loop's gain is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseMargin {
    /// At this frequency, rad/s.
    pub omega: f64,
    /// Phase that may be lost, degrees; negative: the phase that is missing.
    pub phase_deg: f64,
    /// Delay that may be added, seconds.
    pub delay_s: f64,
}

/// All gain margins of `of`, in the order of frequency.
#[must_use]
pub fn gain_margins(of: &Transfer) -> heapless::Vec<GainMargin, MOST> {
    let margin = |omega: f64| GainMargin { omega, factor: -1.0 / of.response(omega).re };
    let mut found: heapless::Vec<GainMargin, MOST> = heapless::Vec::new();
    let standing = of.rest_gain();
    if standing < 0.0 && standing.is_finite() {
        let _ = found.push(GainMargin { omega: 0.0, factor: -1.0 / standing });
    }
    crossings(
        of.plane,
        |omega| of.response(omega).im,
        |omega| {
            // The sign also changes where the response is positive, and at a pole on the boundary.
            if of.response(omega).re < 0.0 && margin(omega).factor > 1e-12 {
                let _ = found.push(margin(omega));
            }
        },
    );
    if let Plane::Sampled(period_s) = of.plane {
        // At half the sampling frequency every response is real: no sign change shows it.
        let value = of.at(Complex::new(-2.0, 0.0)).re;
        if value < 0.0 {
            let _ = found.push(GainMargin { omega: core::f64::consts::PI / period_s, factor: -1.0 / value });
        }
    }
    found
}

/// All phase and delay margins of `of`, in the order of frequency.
#[must_use]
pub fn phase_margins(of: &Transfer) -> heapless::Vec<PhaseMargin, MOST> {
    let mut found = heapless::Vec::new();
    crossings(
        of.plane,
        |omega| log(magnitude(of.response(omega))),
        |omega| {
            let value = of.response(omega);
            // The angle from −1 on the unit circle, counted against the clock.
            let ahead = atan2(-value.im, -value.re);
            let turn = if ahead > 0.0 { ahead } else { ahead + core::f64::consts::TAU };
            let _ = found.push(PhaseMargin { omega, phase_deg: ahead.to_degrees(), delay_s: turn / omega });
        },
    );
    found
}

/// Calls `take` with every frequency, rising, at which `value` changes its sign.
fn crossings(plane: Plane, value: impl Fn(f64) -> f64, mut take: impl FnMut(f64)) {
    let highest = match plane {
        Plane::Continuous => HIGHEST,
        // Just short of half the sampling frequency, where the sign of a real response is rounding.
        Plane::Sampled(period_s) => core::f64::consts::PI / period_s * (1.0 - 1e-6),
    };
    let ratio = pow(10.0, 1.0 / PER_DECADE);
    let mut low = LOWEST;
    let mut at_low = value(low);
    while low < highest {
        let high = (low * ratio).min(highest);
        let at_high = value(high);
        if (at_low < 0.0) != (at_high < 0.0) {
            take(bisected(&value, low, high, at_low < 0.0));
        }
        (low, at_low) = (high, at_high);
    }
}

fn bisected(value: &impl Fn(f64) -> f64, mut low: f64, mut high: f64, negative_below: bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if (value(middle) < 0.0) == negative_below { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::{gain_margins, phase_margins};
    use crate::design::{Linear, Plane, Polynomial, Transfer};

    #[test]
    fn a_double_pole_and_an_integrator_have_the_margins_of_the_closed_form() {
        // K/(s(s + a)²): phase −180° at ω = a, where |L| = K/(2a³).
        let (k, a) = (20.0, 3.896);
        let plant = Linear::three_poles(k / a, a, a).continuous();
        let gain = gain_margins(&plant);
        assert_eq!(gain.len(), 1);
        assert!((gain[0].omega - a).abs() < 1e-9 && (gain[0].factor - 2.0 * a * a * a / k).abs() < 1e-9, "{gain:?}");

        let phase = phase_margins(&plant);
        assert_eq!(phase.len(), 1);
        let omega = phase[0].omega;
        assert!((k - omega * (omega * omega + a * a)).abs() < 1e-9, "|L| = 1 at {omega}");
        let exact = 90.0 - 2.0 * libm::atan(omega / a).to_degrees();
        assert!((phase[0].phase_deg - exact).abs() < 1e-9, "{phase:?}, exact {exact}");
        assert!((phase[0].delay_s - exact.to_radians() / omega).abs() < 1e-12);
    }

    #[test]
    fn a_loop_that_may_neither_lose_nor_gain_much_has_a_margin_to_either_side() {
        // (s + 1)²/s³ is stable for gains above 1/2: s³ + k·(s + 1)².
        let of = Transfer {
            numerator: Polynomial::new(&[1.0, 2.0, 1.0]),
            denominator: Polynomial::new(&[0.0, 0.0, 0.0, 1.0]),
            plane: Plane::Continuous,
        };
        let found = gain_margins(&of);
        assert_eq!(found.len(), 1);
        assert!((found[0].factor - 0.5).abs() < 1e-9 && (found[0].omega - 1.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn the_delay_margin_is_the_delay_that_takes_the_phase_margin() {
        let plant = Linear::two_poles(20.0, 3.0);
        let margin = phase_margins(&plant.continuous())[0];
        let late = Linear { delay_s: margin.delay_s, ..plant };
        assert!(phase_margins(&late.continuous())[0].phase_deg.abs() < 1e-3);
    }

    #[test]
    fn a_sampled_integrator_loses_stability_at_half_the_sampling_frequency() {
        // T/(z − 1): the pole 1 − k·T leaves the unit circle at k = 2/T.
        let found = gain_margins(&crate::design::law::integrator(Plane::Sampled(0.02)));
        assert_eq!(found.len(), 1);
        assert!((found[0].factor - 100.0).abs() < 1e-9, "{found:?}");
    }
}

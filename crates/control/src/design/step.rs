//! The step response of a closed loop and its figures.
//!
//! ```text
//! rise        from 10 % to 90 % of the end value
//! overshoot   the peak beyond the end value, percent of it; peak: when
//! settling    when it is outside ±5 % of the end value for the last time
//! ```
//!
//! Sampled loops are moved in companion form from sample to sample. Continuous ones are brought to companion form, with
//! time counted in the geometric mean of their time constants so that its entries are near 1, and moved exactly from
//! point to point.
//! Source of the definitions: Åström & Murray, *Feedback Systems*, "Performance Specifications".

use super::discretise::{Discrete, discretise};
use super::polynomial::{CAPACITY, Polynomial};
use super::transfer::{Plane, Transfer};
use libm::{ceil, pow};
use nalgebra::{SMatrix, SVector};

/// Half of the width of the band around the new setpoint that counts as settled, as a share of the step.
pub const BAND: f64 = 0.05;
/// The highest order of a continuous closed loop: four lags, the delay's four, the controller's four.
const ORDER: usize = 12;
/// Points of a response, and how far it goes: time constants of its slowest pole.
const POINTS: f64 = 20_000.0;
const SLOWEST_TIMES: f64 = 7.0;
/// Longest and shortest response, seconds.
const LONGEST_S: f64 = 600.0;
const SHORTEST_S: f64 = 1e-3;

/// The metrics of a step response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Where it ends, for a step of 1.
    pub end: f64,
    /// Percent of the end value.
    pub overshoot_percent: f64,
    /// When it is highest, seconds. `None`: never beyond the end value.
    pub peak_s: Option<f64>,
    /// 10 % to 90 %, seconds.
    pub rise_s: f64,
    /// Outside ±5 % for the last time, seconds.
    pub settling_s: f64,
}

/// The points of a step response, as an iterator over time in s and value.
#[derive(Clone, Debug)]
pub struct Response {
    dt_s: f64,
    left: usize,
    at: usize,
    motion: Motion,
}

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put the larger one on")]
enum Motion {
    Moved { over: Discrete<ORDER>, state: SVector<f64, ORDER>, output: [f64; ORDER], direct: f64 },
    Recurred { numerator: Polynomial, denominator: Polynomial, states: [f64; CAPACITY] },
}

/// The step response of `closed`. `None`: it is not stable, or is no loop of ours (of order above 12, or not proper).
#[must_use]
pub fn response(closed: &Transfer) -> Option<Response> {
    let poles = closed.denominator.roots();
    let slowest = poles.iter().map(|pole| closed.plane.decay_per_s(*pole)).fold(f64::INFINITY, f64::min);
    if slowest <= 0.0 || closed.numerator.degree() > closed.denominator.degree() {
        return None;
    }
    let duration_s = (SLOWEST_TIMES / slowest).clamp(SHORTEST_S, LONGEST_S);
    let (dt_s, motion) = match closed.plane {
        Plane::Sampled(period_s) => {
            let (numerator, denominator) = (closed.numerator, closed.denominator);
            (period_s, Motion::Recurred { numerator, denominator, states: [0.0; CAPACITY] })
        }
        Plane::Continuous => (duration_s / POINTS, companion(closed, duration_s / POINTS)?),
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let left = ceil(duration_s / dt_s) as usize + 1;
    Some(Response { dt_s, left, at: 0, motion })
}

/// Companion form in the time t·σ, moved over `dt_s`.
fn companion(closed: &Transfer, dt_s: f64) -> Option<Motion> {
    let order = closed.denominator.degree();
    if order == 0 || order > ORDER {
        return None;
    }
    let ascending = closed.denominator.ascending();
    let mean = pow((ascending[0] / closed.denominator.leading()).abs(), 1.0 / order as f64);
    let scale = |k: usize| pow(mean, k as f64 - order as f64) / closed.denominator.leading();
    let zeros = closed.numerator.ascending();
    let zero = |k: usize| zeros.get(k).map_or(0.0, |c| c * scale(k));
    let direct = zero(order);
    let (mut a, mut b, mut output) = (SMatrix::<f64, ORDER, ORDER>::zeros(), SVector::zeros(), [0.0; ORDER]);
    for k in 0..order {
        if k + 1 < order {
            a[(k, k + 1)] = 1.0;
        }
        a[(order - 1, k)] = -ascending[k] * scale(k);
        output[k] = zero(k) - direct * ascending[k] * scale(k);
    }
    b[order - 1] = 1.0;
    let over = discretise(&a, &b, &SMatrix::zeros(), mean * dt_s);
    Some(Motion::Moved { over, state: SVector::zeros(), output, direct })
}

impl Iterator for Response {
    type Item = (f64, f64);

    fn next(&mut self) -> Option<(f64, f64)> {
        self.left = self.left.checked_sub(1)?;
        let time_s = self.dt_s * self.at as f64;
        let value = match &mut self.motion {
            Motion::Moved { over, state, output, direct } => {
                let value = output.iter().zip(state.iter()).map(|(c, x)| c * x).sum::<f64>() + *direct;
                *state = over.transition * *state + over.input;
                value
            }
            Motion::Recurred { numerator, denominator, states } => recur(numerator, denominator, states),
        };
        self.at += 1;
        Some((time_s, value))
    }
}

/// The next value of a loop in δ, in companion form: every state grows by the next one, the last by the input and all
/// of them.
fn recur(numerator: &Polynomial, denominator: &Polynomial, states: &mut [f64; CAPACITY]) -> f64 {
    let (order, poles, leading) = (denominator.degree(), denominator.ascending(), denominator.leading());
    let remembered: f64 = (0..order).map(|k| poles[k] * states[k]).sum();
    let highest = (1.0 - remembered) / leading;
    let zero = |k: usize| numerator.ascending().get(k).copied().unwrap_or(0.0);
    let value = (0..order).map(|k| zero(k) * states[k]).sum::<f64>() + zero(order) * highest;
    for k in 0..order {
        states[k] += if k + 1 < order { states[k + 1] } else { highest };
    }
    value
}

/// The figures of the step response of `closed`. `None` where there is no [`response`].
#[must_use]
pub fn figures(closed: &Transfer) -> Option<Figures> {
    let end = closed.rest_gain();
    let (mut highest, mut peak_s, mut settling_s) = (0.0_f64, 0.0, 0.0);
    let (mut tenth_s, mut nine_s) = (None, None);
    for (time_s, value) in response(closed)? {
        let share = value / end;
        if share > highest {
            (highest, peak_s) = (share, time_s);
        }
        if share >= 0.1 {
            tenth_s.get_or_insert(time_s);
        }
        if share >= 0.9 {
            nine_s.get_or_insert(time_s);
        }
        if (share - 1.0).abs() > BAND {
            settling_s = time_s;
        }
    }
    // An approach from below is no overshoot, in spite of rounding errors.
    let beyond = highest - 1.0 > 1e-3;
    Some(Figures {
        end,
        overshoot_percent: if beyond { 100.0 * (highest - 1.0) } else { 0.0 },
        peak_s: beyond.then_some(peak_s),
        rise_s: nine_s? - tenth_s?,
        settling_s,
    })
}

#[cfg(test)]
mod tests {
    use super::{figures, response};
    use crate::design::law::{Gains, Weights};
    use crate::design::{Linear, Plane, Polynomial, Transfer};
    use libm::{exp, sqrt};

    #[test]
    fn a_second_order_loop_has_the_figures_of_the_closed_form() {
        let (delta, omega) = (0.4, 5.0);
        let of = Transfer {
            numerator: Polynomial::new(&[omega * omega]),
            denominator: Polynomial::new(&[omega * omega, 2.0 * delta * omega, 1.0]),
            plane: Plane::Continuous,
        };
        let found = figures(&of).unwrap();
        let root = sqrt(1.0 - delta * delta);
        assert!(
            (found.overshoot_percent - 100.0 * exp(-core::f64::consts::PI * delta / root)).abs() < 1e-3,
            "{found:?}"
        );
        assert!((found.peak_s.unwrap() - core::f64::consts::PI / (omega * root)).abs() < 1e-3, "{found:?}");
        assert!((found.end - 1.0).abs() < 1e-12);
        for (t, value) in response(&of).unwrap().step_by(97) {
            let turn = omega * root * t;
            let exact = 1.0 - exp(-delta * omega * t) * (libm::cos(turn) + delta / root * libm::sin(turn));
            assert!((value - exact).abs() < 1e-9, "{t} s: {value}, exact {exact}");
        }
    }

    #[test]
    fn a_dense_sampled_loop_steps_as_the_continuous_one() {
        let plant = Linear { delay_s: 0.05, sensor_lag_s: 0.02, ..Linear::three_poles(827.2, 3.896, 3.896) };
        // No derivative: the sampled filter's is N·T/(1 − e^(−N·T/T_d)), which is more than T_d.
        let gains = Gains::pi(0.006, 5.0);
        let of = |plant: &Transfer| figures(&gains.law(plant.plane, Weights::MEASUREMENT).closed(plant)).unwrap();
        let (slow, fast) = (of(&plant.continuous()), of(&plant.sampled(0.004).unwrap()));
        assert!((slow.overshoot_percent - fast.overshoot_percent).abs() < 0.3, "{slow:?} {fast:?}");
        assert!((slow.settling_s - fast.settling_s).abs() < 0.05, "{slow:?} {fast:?}");
        assert!((fast.end - 1.0).abs() < 1e-12, "an integral ends at the setpoint: {fast:?}");
        assert!((slow.rise_s - fast.rise_s).abs() < 0.01, "{slow:?} {fast:?}");
    }

    #[test]
    fn an_unstable_loop_has_no_figures() {
        let plant = Linear::three_poles(827.2, 3.896, 3.896).continuous();
        let law = Gains::pi(0.05, 15.0).law(plant.plane, Weights::MEASUREMENT);
        assert!(figures(&law.closed(&plant)).is_none());
    }

    #[test]
    fn a_derivative_on_the_measurement_overshoots_less_than_one_on_the_error() {
        let plant = Linear::three_poles(827.2, 3.896, 3.896).continuous();
        let gains = Gains { kp_per_mm: 0.018, ti_s: 15.0, td_s: 0.35, derivative_n: 10.0 };
        let overshoot = |setpoint, derivative| {
            let law = gains.law(plant.plane, Weights { setpoint, derivative });
            figures(&law.closed(&plant)).unwrap().overshoot_percent
        };
        let (weighted, measured, error) = (overshoot(0.6, 0.0), overshoot(1.0, 0.0), overshoot(1.0, 1.0));
        assert!(weighted < measured && measured < error, "{weighted} %, {measured} % and {error} %");
    }
}

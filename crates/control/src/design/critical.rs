//! Critical gain and critical integral time: where a loop loses stability.
//!
//! ```text
//! gain             D + K·N                               N/D = C·G with K_p = 1
//! integral time    A + (1/T_i)·B                         B/A = K_p·G/(1 + K_p·(1 + derivative)·G) · (1/s or T/δ)
//! between two crossings of the boundary the number of unstable poles is constant: one value in each stretch decides it
//!
//! PI and K_g·b/(s(s + a)(s + b)), by Routh, S = a + b:
//! K_u = S·(a·b − S/T_i)/(K_g·b)        T_i,crit = S²/(S·a·b − K_p·K_g·b)        without the fan's pole: none, 1/a
//! third pole for a given K_u: the positive root of (a − 1/T_i)·b² + (a² − 2a/T_i − K_u·K_g)·b − a²/T_i = 0
//! ```
//!
//! Source: the thesis, section 3.1.4, whose table these numbers are; and its conclusion, which proposes the third pole.
//! Erratum: its table 3.1.4.1 prints a critical T_i of 0.629 s for G_b, which by Routh is 1/a = 1/1.595 s = 0.627 s.

use super::error::DesignError;
use super::law::{Gains, integrator};
use super::margins::{MOST, gain_margins};
use super::plant::Linear;
use super::transfer::Transfer;
use libm::sqrt;

/// Where a loop loses stability as a gain rises from zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Nowhere.
    Never,
    /// At this value.
    At(f64),
    /// It has no stability at any.
    Always,
}

impl Limit {
    /// The value, where there is one.
    #[must_use]
    pub const fn value(self) -> Option<f64> {
        match self {
            Self::At(value) => Some(value),
            Self::Never | Self::Always => None,
        }
    }
}

/// The stretches of gain, lowest first, in which the loop `of` closed with that gain is stable.
#[must_use]
pub fn stable_gains(of: &Transfer) -> heapless::Vec<(f64, f64), MOST> {
    let mut edges: heapless::Vec<f64, { MOST + 2 }> = heapless::Vec::new();
    let _ = edges.push(0.0);
    let _ = edges
        .extend_from_slice(&gain_margins(of).iter().map(|margin| margin.factor).collect::<heapless::Vec<_, MOST>>());
    edges.sort_unstable_by(f64::total_cmp);
    let _ = edges.push(f64::INFINITY);
    let mut stretches: heapless::Vec<(f64, f64), MOST> = heapless::Vec::new();
    for pair in edges.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        if !of.is_stable_closed(between(low, high)) {
            continue;
        }
        match stretches.last_mut() {
            Some(last) if last.1 == low => last.1 = high,
            _ => {
                let _ = stretches.push((low, high));
            }
        }
    }
    stretches
}

fn between(low: f64, high: f64) -> f64 {
    match (low > 0.0, high.is_finite()) {
        (true, true) => sqrt(low * high),
        (true, false) => 2.0 * low,
        (false, true) => 0.5 * high,
        (false, false) => 1.0,
    }
}

/// The critical K_p of a loop whose other gains are `gains`: the upper end of the first stable stretch.
#[must_use]
pub fn critical_gain(gains: &Gains, plant: &Transfer) -> Limit {
    let of = Gains { kp_per_mm: 1.0, ..*gains }.feedback(plant.plane).then(plant);
    match stable_gains(&of).first() {
        None => Limit::Always,
        Some((_, high)) if high.is_finite() => Limit::At(*high),
        Some(_) => Limit::Never,
    }
}

/// The critical T_i, seconds, of a loop whose other gains are `gains`: it is stable with slower integrals.
#[must_use]
pub fn critical_integral_time(gains: &Gains, plant: &Transfer) -> Limit {
    let inner = gains.without_integral().feedback(plant.plane);
    let inside = inner.then(plant);
    // K_p·G/(1 + C'·G), without the denominator of C' that would cancel.
    let closed = Transfer {
        numerator: plant.numerator.times(&inner.denominator).scaled(gains.kp_per_mm),
        denominator: inside.closed_denominator(1.0),
        plane: plant.plane,
    };
    match stable_gains(&closed.then(&integrator(plant.plane))).first() {
        Some((0.0, high)) if high.is_finite() => Limit::At(1.0 / high),
        Some((0.0, _)) => Limit::Never,
        _ => Limit::Always,
    }
}

/// The fan's pole b, 1/s, that gives `plant` with a PI of `ti_s` the critical gain `critical_gain` in continuous time.
/// Only gain and drag of `plant` count.
///
/// # Errors
/// [`DesignError::NoThirdPole`]: no pole does.
pub fn third_pole(plant: &Linear, ti_s: f64, critical_gain: f64) -> Result<f64, DesignError> {
    let (a, rate) = (plant.drag_per_s, 1.0 / ti_s);
    let (square, linear) = (a - rate, a * a - 2.0 * a * rate - critical_gain * plant.gain);
    let root = (sqrt(linear * linear + 4.0 * square * a * a * rate) - linear) / (2.0 * square);
    // Without an integral the roots are 0 and (K_u·K_g − a²)/a.
    if square > 0.0 && root.is_finite() && root > 0.0 {
        Ok(root)
    } else {
        Err(DesignError::NoThirdPole { critical_gain })
    }
}

#[cfg(test)]
mod tests {
    use super::{Limit, critical_gain, critical_integral_time, stable_gains, third_pole};
    use crate::design::law::Gains;
    use crate::design::{Linear, Plane, Polynomial, Transfer};

    fn thesis() -> [Linear; 3] {
        [
            Linear::two_poles(254.598, 1.889),
            Linear::two_poles(423.4, 1.595),
            Linear::three_poles(3222.8 / 3.896, 3.896, 3.896),
        ]
    }

    #[test]
    fn the_table_of_critical_gains_is_that_of_the_thesis() {
        let [a, b, c] = thesis().map(|plant| plant.continuous());
        let at_15_s = |plant: &Transfer| critical_gain(&Gains::pi(1.0, 15.0), plant);
        assert_eq!((at_15_s(&a), at_15_s(&b)), (Limit::Never, Limit::Never));
        assert!((at_15_s(&c).value().unwrap() - 0.035443).abs() < 5e-7, "{:?}", at_15_s(&c));

        let slowest = |plant: &Transfer| critical_integral_time(&Gains::pi(0.01, 15.0), plant).value().unwrap();
        for (plant, expected, half_digit) in [(a, 0.529, 5e-4), (b, 0.627, 5e-4), (c, 0.7056, 5e-5)] {
            assert!((slowest(&plant) - expected).abs() < half_digit, "{} s, not {expected} s", slowest(&plant));
        }
    }

    #[test]
    fn the_sampled_table_is_not_the_continuous_one() {
        for (plant, (expected, half_digit)) in thesis().iter().zip([(0.800, 5e-4), (0.403, 5e-4), (0.0332, 5e-5)]) {
            let found = critical_gain(&Gains::pi(1.0, 15.0), &plant.sampled(0.018).unwrap()).value().unwrap();
            assert!((found - expected).abs() < half_digit, "{found}, not {expected}");
        }
    }

    #[test]
    fn the_search_finds_what_routh_gives_in_closed_form() {
        for (gain, a, b, ti_s, kp) in
            [(827.2, 3.896, 3.896, 15.0, 0.01), (254.6, 1.889, 20.0, 4.0, 0.05), (50.0, 0.5, 1.0, 40.0, 0.004)]
        {
            let plant = Linear::three_poles(gain, a, b).continuous();
            let s = a + b;
            let exact = s * (a * b - s / ti_s) / (gain * b);
            let found = critical_gain(&Gains::pi(1.0, ti_s), &plant).value().unwrap();
            assert!((found / exact - 1.0).abs() < 1e-9, "{found}, exact {exact}");
            let exact = s * s / (s * a * b - kp * gain * b);
            let found = critical_integral_time(&Gains::pi(kp, 1.0), &plant).value().unwrap();
            assert!((found / exact - 1.0).abs() < 1e-9, "T_i {found}, exact {exact}");
        }
    }

    #[test]
    fn a_plant_with_the_chosen_third_pole_has_the_critical_gain_of_the_rig() {
        for plant in thesis() {
            let pole = third_pole(&plant, 15.0, 0.038).unwrap();
            let with_pole = Linear::three_poles(plant.gain, plant.drag_per_s, pole).continuous();
            let found = critical_gain(&Gains::pi(1.0, 15.0), &with_pole).value().unwrap();
            assert!((found - 0.038).abs() < 1e-9, "{found}");
        }
    }

    #[test]
    fn an_integral_too_fast_for_the_drag_has_no_third_pole() {
        assert!(third_pole(&Linear::two_poles(254.6, 1.889), 0.5, 0.038).is_err());
    }

    #[test]
    fn a_loop_that_is_stable_only_between_two_gains_has_one_stretch() {
        // s(s − 1)(s² + 4s + 16) + k(s + 1) is stable for 23.3 < k < 35.7 (Ogata, example 6-4).
        let of = Transfer {
            numerator: Polynomial::new(&[1.0, 1.0]),
            denominator: Polynomial::new(&[0.0, -16.0, 12.0, 3.0, 1.0]),
            plane: Plane::Continuous,
        };
        let stretches = stable_gains(&of);
        assert_eq!(stretches.len(), 1);
        assert!((stretches[0].0 - 23.3).abs() < 0.05 && (stretches[0].1 - 35.7).abs() < 0.05, "{stretches:?}");
    }

    #[test]
    fn more_delay_takes_more_of_the_critical_gain() {
        let at = |delay_s| {
            let plant = Linear { delay_s, ..thesis()[2] };
            critical_gain(&Gains::pi(1.0, 15.0), &plant.sampled(0.02).unwrap()).value().unwrap()
        };
        assert!(at(0.0) > at(0.03) && at(0.03) > at(0.2), "{} {} {}", at(0.0), at(0.03), at(0.2));
    }
}

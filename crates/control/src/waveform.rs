//! Waveforms: what a setpoint, a duty or an excitation does over time.
//!
//! A waveform is a function of the time since its own start and remembers nothing, so that the same
//! programme gives the same values on the rig, on the simulated rig and in a picture of it.

use crate::check::{OutOfRange, within};
use libm::{floor, sin};

/// The most values a [`Waveform::Steps`] can hold.
pub const MAX_STEPS: usize = 64;

/// A programme of values over time. Values are in the unit of the signal that it drives.
#[expect(clippy::large_enum_variant, reason = "a crate without allocation has no box, and a flight holds a few")]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Waveform {
    /// One value for ever.
    Constant {
        /// The value.
        value: f64,
    },
    /// `high` in the first half of each period, `low` in the second.
    Square {
        /// Value of the second half.
        low: f64,
        /// Value of the first half.
        high: f64,
        /// Length of both halves together, seconds.
        period_s: f64,
    },
    /// One value after another, from the first again after the last.
    Steps {
        /// The values, at most [`MAX_STEPS`].
        values: heapless::Vec<f64, MAX_STEPS>,
        /// How long each is held, seconds.
        each_s: f64,
    },
    /// A straight line from `from` to `to`, held at its end.
    Ramp {
        /// Value at the start.
        from: f64,
        /// Value from `over_s` on.
        to: f64,
        /// Length of the line, seconds.
        over_s: f64,
    },
    /// A sine whose frequency rises linearly; it starts again after each sweep.
    Chirp {
        /// Mean value.
        centre: f64,
        /// Half of the swing.
        amplitude: f64,
        /// Frequency at the start of a sweep, hertz.
        from_hz: f64,
        /// Frequency at the end of a sweep, hertz.
        to_hz: f64,
        /// Length of a sweep, seconds.
        sweep_s: f64,
    },
    /// Maximum-length pseudo-random binary sequence of 2^order − 1 bits.
    Prbs {
        /// Value of a zero.
        low: f64,
        /// Value of a one.
        high: f64,
        /// Length of a bit, seconds.
        bit_s: f64,
        /// Length of the shift register, 3 to 10.
        order: u32,
    },
}

impl Waveform {
    /// Checks that every value is within `min` to `max` and every time and frequency is valid.
    ///
    /// # Errors
    /// [`OutOfRange`] names the first number that does not.
    pub fn check(&self, min: f64, max: f64) -> Result<(), OutOfRange> {
        const LONG_S: f64 = 1e6;
        match self {
            Self::Constant { value } => within("constant.value", *value, min, max),
            Self::Square { low, high, period_s } => {
                within("square.low", *low, min, max)?;
                within("square.high", *high, min, max)?;
                within("square.period_s", *period_s, 1e-3, LONG_S)
            }
            Self::Steps { values, each_s } => {
                #[expect(clippy::cast_precision_loss, reason = "at most MAX_STEPS")]
                within("number of steps.values", values.len() as f64, 1.0, MAX_STEPS as f64)?;
                within("steps.each_s", *each_s, 1e-3, LONG_S)?;
                values.iter().try_for_each(|value| within("steps.values", *value, min, max))
            }
            Self::Ramp { from, to, over_s } => {
                within("ramp.from", *from, min, max)?;
                within("ramp.to", *to, min, max)?;
                within("ramp.over_s", *over_s, 1e-3, LONG_S)
            }
            Self::Chirp { centre, amplitude, from_hz, to_hz, sweep_s } => {
                within("chirp.amplitude", *amplitude, 0.0, (max - min) / 2.0)?;
                within("chirp.centre", *centre, min + amplitude, max - amplitude)?;
                within("chirp.from_hz", *from_hz, 0.0, 1e3)?;
                within("chirp.to_hz", *to_hz, 0.0, 1e3)?;
                within("chirp.sweep_s", *sweep_s, 1e-3, LONG_S)
            }
            Self::Prbs { low, high, bit_s, order } => {
                within("prbs.low", *low, min, max)?;
                within("prbs.high", *high, min, max)?;
                within("prbs.bit_s", *bit_s, 1e-3, LONG_S)?;
                within("prbs.order", f64::from(*order), 3.0, 10.0)
            }
        }
    }

    /// The value `t_s` seconds after the start of the waveform. Finite for every checked waveform.
    #[must_use]
    pub fn value(&self, t_s: f64) -> f64 {
        match self {
            Self::Constant { value } => *value,
            Self::Square { low, high, period_s } => {
                if phase(t_s, *period_s) < 0.5 {
                    *high
                } else {
                    *low
                }
            }
            Self::Steps { values, each_s } => {
                values.get(index(t_s, *each_s, values.len())).copied().unwrap_or_default()
            }
            Self::Ramp { from, to, over_s } => from + (to - from) * (t_s / over_s).clamp(0.0, 1.0),
            Self::Chirp { centre, amplitude, from_hz, to_hz, sweep_s } => {
                let t = phase(t_s, *sweep_s) * sweep_s;
                let turns = from_hz * t + (to_hz - from_hz) * t * t / (2.0 * sweep_s);
                centre + amplitude * sin(core::f64::consts::TAU * turns)
            }
            Self::Prbs { low, high, bit_s, order } => {
                let length = (1_usize << order) - 1;
                if prbs_bit(*order, index(t_s, *bit_s, length)) { *high } else { *low }
            }
        }
    }
}

/// Which part of a period has passed, 0 to 1. A boundary that rounding missed by 1 ns counts as reached.
fn phase(t_s: f64, period_s: f64) -> f64 {
    let turns = (t_s + 1e-9) / period_s;
    turns - floor(turns)
}

/// Which of `count` slots of `each_s` seconds the time falls into, starting again after the last.
fn index(t_s: f64, each_s: f64, count: usize) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and the modulus bounds it"
    )]
    let slot = floor((t_s + 1e-9) / each_s) as usize;
    slot % count.max(1)
}

/// Bit `at` of the maximum-length sequence: a Fibonacci shift register that starts from all ones.
///
/// The taps are primitive polynomials x^n + x^k + 1 (or four taps for n = 8) over GF(2).
/// Source: Golomb, *Shift Register Sequences*.
fn prbs_bit(order: u32, at: usize) -> bool {
    let taps: u32 = match order {
        3 => 0b110,
        4 => 0b1100,
        5 => 0b1_0100,
        6 => 0b11_0000,
        7 => 0b110_0000,
        8 => 0b1011_1000,
        9 => 0b1_0001_0000,
        _ => 0b10_0100_0000,
    };
    let mask = (1_u32 << order) - 1;
    let mut register = mask;
    for _ in 0..at {
        register = ((register << 1) | ((register & taps).count_ones() & 1)) & mask;
    }
    register >> (order - 1) == 1
}

#[cfg(test)]
mod tests {
    use super::{Waveform, prbs_bit};

    #[test]
    fn a_square_is_high_first_and_changes_on_time() {
        let square = Waveform::Square { low: 200.0, high: 400.0, period_s: 0.6 };
        // 0.1·3 is above 0.3 and 0.02·15 is not: both are the boundary.
        for (t, expected) in [(0.0, 400.0), (0.29, 400.0), (0.1 * 3.0, 200.0), (0.02 * 15.0, 200.0), (0.6, 400.0)] {
            assert_eq!(square.value(t), expected, "at {t} s");
        }
    }

    #[test]
    fn steps_follow_each_other_and_start_again() {
        let steps = Waveform::Steps { values: [1.0, 5.0, 3.0].into_iter().collect(), each_s: 2.0 };
        let got: [f64; 7] = core::array::from_fn(|k| steps.value(1.0 + 2.0 * k as f64));
        assert_eq!(got, [1.0, 5.0, 3.0, 1.0, 5.0, 3.0, 1.0]);
    }

    #[test]
    fn a_ramp_is_straight_and_held() {
        let ramp = Waveform::Ramp { from: 100.0, to: 300.0, over_s: 4.0 };
        assert_eq!([0.0, 1.0, 4.0, 9.0].map(|t| ramp.value(t)), [100.0, 150.0, 300.0, 300.0]);
    }

    #[test]
    fn a_chirp_crosses_its_centre_where_the_phase_says() {
        let chirp = Waveform::Chirp { centre: 21.0, amplitude: 2.0, from_hz: 0.5, to_hz: 2.5, sweep_s: 10.0 };
        // Phase in turns: 0.5·t + 0.1·t². Half turns are zeros: t = (−0.5 + √(0.25 + 0.4·k/2)) / 0.2.
        for k in 1..20 {
            let t = (-0.5 + libm::sqrt(0.25 + 0.2 * f64::from(k))) / 0.2;
            assert!((chirp.value(t) - 21.0).abs() < 1e-6, "zero {k} at {t} s: {}", chirp.value(t));
        }
    }

    #[test]
    fn every_prbs_runs_through_all_states_and_is_balanced() {
        for order in 3..=10 {
            let length = (1_usize << order) - 1;
            let ones = (0..length).filter(|&at| prbs_bit(order, at)).count();
            assert_eq!(ones, length.div_ceil(2), "order {order}");
            // A maximum-length sequence agrees with a shift of itself in exactly (length − 1)/2 places.
            for shift in [1, 2, length / 2] {
                let agree = (0..length).filter(|&at| prbs_bit(order, at) == prbs_bit(order, (at + shift) % length));
                assert_eq!(agree.count(), length / 2, "order {order}, shift {shift}");
            }
        }
    }

    #[test]
    fn a_value_outside_the_pipe_is_refused_by_name() {
        let square = Waveform::Square { low: 200.0, high: 700.0, period_s: 10.0 };
        let refused = square.check(0.0, 583.0).unwrap_err();
        assert_eq!((refused.key, refused.value, refused.max), ("square.high", 700.0, 583.0));
        let chirp = Waveform::Chirp { centre: 570.0, amplitude: 50.0, from_hz: 0.1, to_hz: 1.0, sweep_s: 10.0 };
        assert_eq!(chirp.check(0.0, 583.0).unwrap_err().key, "chirp.centre");
    }
}

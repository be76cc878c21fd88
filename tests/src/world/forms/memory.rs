//! Parts of the actuator with memory: delay, quantiser, play, lags.

use super::{History, Link, follow, lag};
use crate::catalogue::Effect;

/// A delay with dispersion: the mean over 0.85 to 1.15 of the delay. `delay_s` is its mean.
pub(crate) fn transport_delay(e: &Effect) -> Link {
    let delay = e.get("delay_s");
    let mut history = History::of(1.15 * delay);
    Box::new(move |duty, _| {
        history.push(duty);
        (0..7).map(|i| history.ago(delay * (0.85 + 0.05 * f64::from(i)))).sum::<f64>() / 7.0
    })
}

/// Steps at whole multiples of `step_percent`, each left only when the duty is 0.55 steps away: the hysteresis of a
/// comparator.
pub(crate) fn duty_quantisation(e: &Effect) -> Link {
    let mut round = sticky_round(e.get("step_percent"));
    Box::new(move |duty, _| round(duty))
}

/// Rounds to a multiple of a step, and keeps it until the input is 0.55 steps away.
pub(crate) fn sticky_round(step: f64) -> impl FnMut(f64) -> f64 {
    let mut held = f64::NAN;
    move |value| {
        if held.is_nan() || (value - held).abs() > 0.55 * step {
            held = (value / step).round() * step;
        }
        held
    }
}

/// Nine plays in parallel, half widths 0.6 to 1.4 of `half_width_percent`, which is their mean: after a long swing the
/// force lags by exactly that.
pub(crate) fn hysteresis(e: &Effect) -> Link {
    let widths: Vec<f64> = (0..9).map(|i| e.get("half_width_percent") * (0.6 + 0.1 * f64::from(i))).collect();
    let mut plays = [0.0_f64; 9];
    Box::new(move |u, _| {
        for (play, width) in plays.iter_mut().zip(&widths) {
            *play = play.clamp(u - width, u + width);
        }
        plays.iter().sum::<f64>() / 9.0
    })
}

/// Rotor and air column: two lags in series, 0.93 and 0.07 of `time_constant_s`, which is the area between step and
/// response.
pub(crate) fn fan_lag(e: &Effect) -> Link {
    let tau = e.get("time_constant_s");
    let (mut rotor, mut column) = (lag(0.93 * tau), lag(0.07 * tau));
    Box::new(move |a, _| column(rotor(a)))
}

/// The rate changes from 1/`down_s` to 1/`up_s` as the command passes the state, over 10 mm/s²; at large differences
/// the rates are exact.
pub(crate) fn spin_asymmetry(e: &Effect) -> Link {
    let (up, down, mut state) = (1.0 / e.get("up_s"), 1.0 / e.get("down_s"), 0.0);
    Box::new(move |a, _| {
        let side = 0.5 + 0.5 * ((a - state) / 10.0).tanh();
        follow(&mut state, a, 1.0 / (down + (up - down) * side))
    })
}

#[cfg(test)]
mod tests {
    use super::super::STEP_S;
    use super::*;

    /// The output of a link over these seconds of a constant input.
    fn hold(link: &mut Link, input: f64, seconds: f64) -> Vec<f64> {
        (0..(seconds / STEP_S).round() as usize).map(|_| link(input, 0.0)).collect()
    }

    /// The area between a unit step and its response, which is the mean delay, s.
    fn shortfall(mut link: Link) -> f64 {
        let _ = hold(&mut link, 0.0, 0.5);
        hold(&mut link, 1.0, 5.0).iter().map(|y| (1.0 - y) * STEP_S).sum()
    }

    #[test]
    fn a_step_comes_late_by_the_delay_and_by_the_lag() {
        let delay = shortfall(transport_delay(&Effect::new("transport_delay", &[("delay_s", 0.08)])));
        assert!((delay - 0.08).abs() < STEP_S, "{delay}");
        let lag = shortfall(fan_lag(&Effect::new("fan_lag", &[("time_constant_s", 0.2)])));
        assert!((lag - 0.2).abs() < 2.0 * STEP_S, "{lag}");
    }

    #[test]
    fn large_steps_up_and_down_take_the_two_time_constants() {
        let mut link = spin_asymmetry(&Effect::new("spin_asymmetry", &[("up_s", 0.1), ("down_s", 0.3)]));
        let rest = (-1.0_f64).exp();
        let up = hold(&mut link, 1e4, 0.1);
        assert!((up.last().unwrap() / 1e4 - (1.0 - rest)).abs() < 1e-3);
        let _ = hold(&mut link, 1e4, 3.0);
        let down = hold(&mut link, 0.0, 0.3);
        assert!((down.last().unwrap() / 1e4 - rest).abs() < 1e-3);
    }

    #[test]
    fn after_a_long_swing_the_force_lags_by_the_half_width() {
        let mut link = hysteresis(&Effect::new("hysteresis", &[("half_width_percent", 0.3)]));
        let (up, down) = (hold(&mut link, 2.0, STEP_S)[0], hold(&mut link, -2.0, STEP_S)[0]);
        assert!((up - 1.7).abs() < 1e-12 && (down + 1.7).abs() < 1e-12, "{up}, {down}");
    }

    #[test]
    fn duty_moves_in_whole_steps_near_its_command() {
        let mut link = duty_quantisation(&Effect::new("duty_quantisation", &[("step_percent", 0.8)]));
        for i in 0..400 {
            let duty = 20.0 + 0.01 * f64::from(i);
            let steps = link(duty, 0.0) / 0.8;
            assert!((steps - steps.round()).abs() < 1e-9 && (steps * 0.8 - duty).abs() <= 0.44 + 1e-9);
        }
    }
}

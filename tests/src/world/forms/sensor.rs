//! Forms of the sensor: effects on the signal, and effects on a reading.

use super::memory::sticky_round;
use super::{History, Link, lag};
use crate::catalogue::Effect;
use crate::chance::Chance;

/// Two lags in series, 0.85 and 0.15 of `time_constant_s`, which is the area between step and response.
pub(crate) fn sensor_lag(e: &Effect) -> Link {
    let tau = e.get("time_constant_s");
    let (mut slow, mut fast) = (lag(0.85 * tau), lag(0.15 * tau));
    Box::new(move |x, _| fast(slow(x)))
}

/// The age of a reading varies by ±10 % about `delay_s`, slowly enough that readings keep their order.
pub(crate) fn sensor_delay(e: &Effect, mut chance: Chance) -> Link {
    let (delay, mut wander) = (e.get("delay_s"), lag(0.1));
    let mut history = History::of(1.2 * delay);
    Box::new(move |x, _| {
        history.push(x);
        history.ago(delay * (1.0 + (2.0 * wander(chance.hump())).clamp(-0.1, 0.1)))
    })
}

/// Sum of three uniforms; `sigma_mm` is its standard deviation.
pub(crate) fn sensor_noise(e: &Effect, mut chance: Chance) -> Link {
    let sigma = e.get("sigma_mm");
    Box::new(move |x, _| x + sigma * chance.hump())
}

/// Bursts of 1 reading or more, 1.25 on average, all to one side; sizes 0.85 to 1.15 of `size_mm`. `probability` is the
/// share of outliers.
pub(crate) fn sensor_outliers(e: &Effect, mut chance: Chance) -> Link {
    let (stay, size, mut side) = (0.2, e.get("size_mm"), 0.0);
    let wild = e.get("probability");
    let start = wild * (1.0 - stay) / (1.0 - wild);
    Box::new(move |x, _| {
        if side == 0.0 && chance.happens(start) {
            side = chance.sign();
        } else if side != 0.0 && !chance.happens(stay) {
            side = 0.0;
        }
        x + side * size * chance.between(0.85, 1.15)
    })
}

/// Readings move in whole multiples of `step_mm`, each left only when 0.55 steps away.
pub(crate) fn sensor_quantisation(e: &Effect) -> Link {
    let mut round = sticky_round(e.get("step_mm"));
    Box::new(move |x, _| round(x))
}

/// A sensor with a clock of its own: a new reading after 0.94 to 1.06 of `hold_s`, which is the mean.
pub(crate) fn refresh(e: &Effect, mut chance: Chance) -> Box<dyn FnMut(f64) -> bool> {
    let (hold, mut next) = (e.get("hold_s"), f64::NEG_INFINITY);
    Box::new(move |t| {
        let due = t >= next;
        if due {
            next = if next.is_finite() { next } else { t } + hold * chance.between(0.94, 1.06);
        }
        due
    })
}

#[cfg(test)]
mod tests {
    use super::super::STEP_S;
    use super::*;
    use crate::chance::Source;

    fn chance() -> Chance {
        Source { seed: "sensor".into(), case: 0 }.stream("test")
    }

    /// The area between a step and its response, over its height: the mean delay, s.
    fn shortfall(mut link: Link) -> f64 {
        for _ in 0..4_000 {
            let _ = link(0.0, 0.0);
        }
        (0..16_000).map(|_| (1.0 - link(1.0, 0.0)) * STEP_S).sum()
    }

    #[test]
    fn a_step_of_the_ball_is_seen_late_by_the_lag_and_by_the_delay() {
        let seen = shortfall(sensor_lag(&Effect::new("sensor_lag", &[("time_constant_s", 0.12)])));
        assert!((seen - 0.12).abs() < 2.0 * STEP_S, "{seen}");
        let delay = Effect::new("sensor_delay", &[("delay_s", 0.08)]);
        let seen = (0..20).map(|case| Source { seed: "d".into(), case }.stream("delay"));
        let mean = seen.map(|chance| shortfall(sensor_delay(&delay, chance))).sum::<f64>() / 20.0;
        assert!((mean - 0.08).abs() < 0.004, "{mean}");
    }

    #[test]
    fn the_share_of_wild_readings_and_their_size_are_as_told() {
        let mut link = sensor_outliers(&Effect::new("", &[("probability", 0.04), ("size_mm", 50.0)]), chance());
        let wild: Vec<f64> = (0..200_000).map(|_| link(0.0, 0.0)).filter(|x| *x != 0.0).collect();
        assert!((wild.len() as f64 / 200_000.0 - 0.04).abs() < 0.002, "{}", wild.len());
        let size = wild.iter().map(|x| x.abs()).sum::<f64>() / wild.len() as f64;
        assert!((size - 50.0).abs() < 0.5, "{size}");
    }

    #[test]
    fn noise_has_its_sigma_and_readings_move_in_whole_steps() {
        let mut link = sensor_noise(&Effect::new("", &[("sigma_mm", 3.0)]), chance());
        let variance = (0..100_000).map(|_| link(0.0, 0.0).powi(2)).sum::<f64>() / 1e5;
        assert!((variance.sqrt() - 3.0).abs() < 0.03, "{variance}");
        let mut link = sensor_quantisation(&Effect::new("", &[("step_mm", 7.0)]));
        assert!([(200.0, 203.0), (203.8, 203.0), (207.0, 210.0)].iter().all(|(x, seen)| link(*x, 0.0) == *seen));
    }

    #[test]
    fn the_sensor_refreshes_once_in_its_hold_on_average() {
        let mut due = refresh(&Effect::new("", &[("hold_s", 0.1)]), chance());
        let count = (0..100_000).filter(|i| due(f64::from(*i) * 0.001)).count();
        assert!((count as f64 / 1000.0 - 1.0).abs() < 0.01, "{count} in 100 s");
    }
}

//! Effects outside the catalogue: the right answer to these is "unexplained".

use super::forces::bristle;
use super::{Force, Link, STEP_S, follow, lag};
use crate::catalogue::Effect;
use crate::chance::Chance;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Every duty acts after a random delay of its own, up to `up_to_s`; later duties never overtake earlier ones.
pub(crate) fn late_writes(e: &Effect, mut chance: Chance) -> Link {
    let longest = e.get("up_to_s");
    delayed(move || longest * chance.unit().powi(3))
}

/// Every value acts after a delay of its own, seconds; later ones never overtake earlier ones.
pub(super) fn delayed(mut delay: impl FnMut() -> f64 + 'static) -> Link {
    let (mut last, mut acting, mut on_the_way) = (f64::NAN, 0.0, VecDeque::new());
    Box::new(move |value, t| {
        if last.is_nan() {
            acting = value;
        }
        if value != last {
            last = value;
            on_the_way.push_back((t + delay(), value));
        }
        while on_the_way.front().is_some_and(|(due, _)| *due <= t) {
            acting = on_the_way.pop_front().map_or(acting, |(_, value)| value);
        }
        acting
    })
}

/// Every `every_s` on average, the driver keeps its duty for `for_s`.
pub(crate) fn stuck_driver(e: &Effect, mut chance: Chance) -> Link {
    let (rate, length, mut until, mut held) = (STEP_S / e.get("every_s"), e.get("for_s"), f64::NEG_INFINITY, 0.0);
    Box::new(move |duty, t| {
        if t >= until {
            held = duty;
            if t >= 0.0 && chance.happens(rate) {
                until = t + length * chance.between(0.7, 1.3);
            }
        }
        held
    })
}

/// The gain oscillates by `fraction` to either side with `period_s`, for instance by a room's heating.
pub(crate) fn supply_ripple(e: &Effect, mut chance: Chance) -> Link {
    let (fraction, rate, phase) = (e.get("fraction"), TAU / e.get("period_s"), chance.between(0.0, TAU));
    Box::new(move |a, t| a * (1.0 + fraction * (rate * t + phase).sin()))
}

/// A supply whose voltage gives way: the whole duty is multiplied by 1 − sag, and sag follows `share` times the duty about
/// hover over hover, within two fifths, over `recovery_s`.
pub(crate) fn supply_sag(e: &Effect, hover: f64) -> Link {
    let (share, recovery, mut sag) = (e.get("share"), e.get("recovery_s"), 0.0);
    Box::new(move |u, _| {
        let sag = follow(&mut sag, (share * u / hover).clamp(-0.4, 0.4), recovery);
        u - sag * (hover + u)
    })
}

/// The lag is `at_hover_s` at hover and halves with every `halves_per_percent` above it.
pub(crate) fn duty_dependent_lag(e: &Effect, gain: f64) -> Link {
    let (at_hover, halves, mut state) = (e.get("at_hover_s"), e.get("halves_per_percent") * gain, 0.0);
    Box::new(move |a, _| {
        let tau = (at_hover * (-state / halves).exp2()).clamp(0.03, 1.2);
        follow(&mut state, a, tau)
    })
}

/// A `share` of the thrust passes the air column's resonance, with a damping ratio of 1/12.
pub(crate) fn pipe_resonance(e: &Effect) -> Link {
    let (omega, share, mut y, mut rate) = (TAU * e.get("frequency_hz"), e.get("share"), 0.0, 0.0);
    Box::new(move |a, _| {
        rate += STEP_S * (omega * omega * (a - y) - omega / 6.0 * rate);
        y += STEP_S * rate;
        (1.0 - share) * a + share * y
    })
}

/// Events every `every_s` on average, a third of a second to a second long, rounded at both ends.
pub(crate) fn gusts(e: &Effect, mut chance: Chance) -> Force {
    let (rate, size) = (STEP_S / e.get("every_s"), e.get("size_mm_per_s2"));
    let (mut until, mut push, mut soft) = (0.0, 0.0, lag(0.05));
    Box::new(move |_, _, t| {
        if t >= until {
            push = 0.0;
            if t >= 0.0 && chance.happens(rate) {
                until = t + chance.between(0.33, 1.0);
                push = chance.sign() * size * chance.between(0.7, 1.3);
            }
        }
        soft(push)
    })
}

/// The air column oscillates on its own: a van der Pol oscillator of constant size.
pub(crate) fn limit_cycle(e: &Effect) -> Force {
    let (omega, size, mut y, mut rate) = (TAU * e.get("frequency_hz"), e.get("size_mm_per_s2"), 0.5, 0.0);
    Box::new(move |_, _, _| {
        // Settles at amplitude 2.
        rate += STEP_S * omega * (0.7 * (1.0 - y * y) * rate - omega * y);
        y += STEP_S * rate;
        0.5 * size * y
    })
}

/// Lift that varies periodically with height, from seams of the pipe.
pub(crate) fn height_ripple(e: &Effect) -> Force {
    let (size, rate) = (e.get("size_mm_per_s2"), TAU / e.get("wave_mm"));
    Box::new(move |x, _, _| size * (rate * x).sin())
}

/// A spinning ball: a force periodic in speed.
pub(crate) fn spin_lift(e: &Effect) -> Force {
    let (size, rate) = (e.get("size_mm_per_s2"), TAU / e.get("wave_mm_per_s"));
    Box::new(move |_, v, _| size * (rate * v).sin())
}

/// Friction in one part of the pipe only.
pub(crate) fn sticky_zone(e: &Effect) -> Force {
    let (centre, half) = (e.get("centre_mm"), e.get("half_width_mm"));
    bristle(e.get("size_mm_per_s2"), move |x| 1.0 / (1.0 + ((x - centre) / half).powi(8)))
}

/// The sensor has play in its mount and follows the ball's wake.
pub(crate) fn mount_backlash(e: &Effect) -> Link {
    let (half, mut seen) = (e.get("half_width_mm"), f64::NAN);
    Box::new(move |x, _| {
        seen = if seen.is_nan() { x } else { seen.clamp(x - half, x + half) };
        seen
    })
}

/// The sensor slips between two positions in its mount, every `every_s` on average.
pub(crate) fn mount_slip(e: &Effect, mut chance: Chance) -> Link {
    let (rate, size, mut offset) = (STEP_S / e.get("every_s"), e.get("size_mm"), 0.0);
    Box::new(move |x, t| {
        if t >= 0.0 && chance.happens(rate) {
            offset = if offset == 0.0 { chance.sign() * size } else { 0.0 };
        }
        x + offset
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::Source;

    #[test]
    fn late_writes_keep_their_order_and_all_arrive() {
        let chance = Source { seed: "late".into(), case: 0 }.stream("test");
        let mut link = late_writes(&Effect::new("", &[("up_to_s", 0.3)]), chance);
        let acting: Vec<f64> =
            (0..40_000).map(|i| link((f64::from(i) / 80.0).floor().min(300.0), f64::from(i) * STEP_S)).collect();
        assert!(acting.windows(2).all(|pair| pair[1] >= pair[0]) && acting.last() == Some(&300.0));
    }

    #[test]
    fn the_limit_cycle_keeps_its_size_and_frequency() {
        let mut force = limit_cycle(&Effect::new("", &[("frequency_hz", 1.0), ("size_mm_per_s2", 100.0)]));
        let series: Vec<f64> = (0..80_000).map(|_| force(0.0, 0.0, 0.0)).skip(40_000).collect();
        let peak = series.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
        let rises = series.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
        assert!((peak - 100.0).abs() < 5.0 && (9..=11).contains(&rises), "{peak}, {rises} in 10 s");
    }
}

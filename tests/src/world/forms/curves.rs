//! Static curves of the actuator: softened dead zone, asymmetry, power law of thrust, soft limits.

use super::{Link, approach};
use crate::catalogue::Effect;

/// ln(1 + eˣ), without overflow: a smooth max(0, x).
fn soft_plus(x: f64) -> f64 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

/// Soft edges of a width of 5 % of the zone. Far outside the force counts from exactly `lower` and `upper`.
pub(crate) fn dead_zone(e: &Effect) -> Link {
    let (lower, upper) = (e.get("lower_percent"), e.get("upper_percent"));
    let w = 0.05 * (upper - lower);
    Box::new(move |u, _| w * (soft_plus((u - upper) / w) - soft_plus((lower - u) / w)))
}

/// A hyperbola between the slopes √r above and 1/√r below, through 0; it bends within 0.05 %. `up_over_down` is the
/// exact ratio of the asymptotes.
pub(crate) fn force_asymmetry(e: &Effect) -> Link {
    let up = e.get("up_over_down").sqrt();
    let (mean, half, w) = (0.5 * (up + 1.0 / up), 0.5 * (up - 1.0 / up), 0.05_f64);
    Box::new(move |u, _| mean * u + half * (u.hypot(w) - w))
}

/// Thrust is a power of the duty, `(h/p)·((d/h)^p − 1)`, with p = 1 + 2·c·h: slope 1 and curvature 2c at hover h.
pub(crate) fn thrust_curve(e: &Effect, hover: f64) -> Link {
    let p = 1.0 + 2.0 * e.get("curvature_per_percent") * hover;
    Box::new(move |u, _| hover / p * ((1.0 + u / hover).max(0.02).powf(p) - 1.0))
}

/// A knee of 4 % of the span at either limit; the limits themselves are exact.
pub(crate) fn saturation(e: &Effect) -> Link {
    let (lower, upper) = (e.get("lower_mm_per_s2"), e.get("upper_mm_per_s2"));
    let w = 0.04 * (upper - lower);
    Box::new(move |a, _| a - w * soft_plus((a - upper) / w) + w * soft_plus((lower - a) / w))
}

/// The gain approaches its end exponentially; `fraction_per_s` is its mean rate over the record.
pub(crate) fn gain_drift(e: &Effect, seconds: f64) -> Link {
    let rate = e.get("fraction_per_s");
    Box::new(move |a, t| a * (1.0 + rate * approach(t, seconds)))
}

/// Hover approaches its end exponentially; `percent_per_s` is its mean rate over the record.
pub(crate) fn hover_drift(e: &Effect, seconds: f64) -> Link {
    let rate = e.get("percent_per_s");
    Box::new(move |u, t| u - rate * approach(t, seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn near(value: f64, expected: f64, within: f64) {
        assert!((value - expected).abs() <= within, "{value}, expected {expected}");
    }

    #[test]
    fn the_dead_zone_lets_nothing_pass_inside_and_counts_from_its_edges_outside() {
        let mut zone = dead_zone(&Effect::new("dead_zone", &[("lower_percent", -0.3), ("upper_percent", 0.5)]));
        near(zone(0.1, 0.0), 0.0, 1e-3);
        near(zone(1.5, 0.0), 1.0, 1e-6);
        near(zone(-1.3, 0.0), -1.0, 1e-6);
    }

    #[test]
    fn the_slopes_far_above_and_below_hover_have_the_ratio_of_the_asymmetry() {
        let mut curve = force_asymmetry(&Effect::new("force_asymmetry", &[("up_over_down", 1.7)]));
        let (up, down) = (curve(4.0, 0.0) - curve(2.0, 0.0), curve(-2.0, 0.0) - curve(-4.0, 0.0));
        near(up / down, 1.7, 2e-3);
        near(up * down, 4.0, 1e-2);
    }

    #[test]
    fn the_power_law_has_slope_one_and_the_curvature_at_hover() {
        for c in [0.04, 0.012, -0.015] {
            let mut curve = thrust_curve(&Effect::new("thrust_curve", &[("curvature_per_percent", c)]), 21.0);
            let (d, mut at) = (0.01, |u| curve(u, 0.0));
            near((at(d) - at(-d)) / (2.0 * d), 1.0, 1e-5);
            near((at(d) + at(-d)) / (2.0 * d * d), c, 1e-5);
        }
    }

    #[test]
    fn the_limits_are_reached_and_between_them_nothing_changes() {
        let limits = [("lower_mm_per_s2", -200.0), ("upper_mm_per_s2", 300.0)];
        let mut knee = saturation(&Effect::new("saturation", &limits));
        near(knee(5000.0, 0.0), 300.0, 1e-6);
        near(knee(-5000.0, 0.0), -200.0, 1e-6);
        near(knee(50.0, 0.0), 50.0, 0.01);
    }

    #[test]
    fn the_drifts_reach_what_a_straight_line_would_at_the_end_of_the_record() {
        let mut gain = gain_drift(&Effect::new("gain_drift", &[("fraction_per_s", 0.004)]), 80.0);
        near(gain(100.0, 80.0), 132.0, 1e-9);
        near(gain(100.0, -3.0), 100.0, 0.0);
        near(gain(100.0, 40.0), 116.0, 4.5);
        let mut hover = hover_drift(&Effect::new("hover_drift", &[("percent_per_s", 0.01)]), 60.0);
        near(hover(0.0, 60.0), -0.6, 1e-9);
    }
}

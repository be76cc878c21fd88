//! Forces on the ball from air, pipe and ends.

use super::{Force, STEP_S, Stream, lag};
use crate::catalogue::Effect;
use crate::chance::Chance;

/// Lift decays with height over 900 mm; `gradient_per_s2` is its slope at `centre_mm`, where it is 0.
pub(crate) fn height_dependent_flow(e: &Effect) -> Force {
    let (gradient, centre, length) = (e.get("gradient_per_s2"), e.get("centre_mm"), 900.0);
    Box::new(move |x, _, _| gradient * length * (-(x - centre) / length).exp_m1())
}

/// Air past the ball whose force goes with the power 1.9 of its speed, as between laminar flow and turbulent: with
/// w = speed of the air past the ball, 1 at hover, drag/(1.9·q)·(w·|w|^0.9 − 1). The air's speed is what gives the fan's
/// acceleration to a ball at rest. `inverse_speed_s_per_mm` is q. Returned without the linear part of a rig.
pub(crate) fn relative_airflow(e: &Effect, drag: f64) -> Stream {
    let (q, power) = (e.get("inverse_speed_s_per_mm"), 1.9);
    let size = drag / (power * q);
    Box::new(move |lift, v| {
        let air = (1.0 + lift / size).max(0.0).powf(1.0 / power);
        let past = air - q * v;
        size * (past.signum() * past.abs().powf(power) - 1.0) - (lift - drag * v)
    })
}

/// Noise through two equal lags. `sigma_mm_per_s2` is its standard deviation, `correlation_s` the area under its
/// autocorrelation.
pub(crate) fn turbulence(e: &Effect, mut chance: Chance) -> Force {
    // Autocorrelation (1 + |t|/a)·exp(−|t|/a), area over t > 0: 2a. Input white, variance of the output: its PSD / 4a.
    let a = 0.5 * e.get("correlation_s");
    let white = e.get("sigma_mm_per_s2") * (4.0 * a / STEP_S).sqrt();
    let (mut first, mut second) = (lag(a), lag(a));
    let _ = second(first(0.0));
    Box::new(move |_, _, _| second(first(white * chance.hump())))
}

/// `coefficient_per_mm`·v·√(v² + 10²): the catalogue's law at speed, smooth about rest.
pub(crate) fn quadratic_drag(e: &Effect) -> Force {
    let c = e.get("coefficient_per_mm");
    Box::new(move |_, v, _| -c * v * v.hypot(10.0))
}

/// A bristle that deflects up to 0.1 mm before it slides (Dahl), a tenth stronger below 5 mm/s (Stribeck).
/// `acceleration_mm_per_s2` is its force on a sliding ball.
pub(crate) fn wall_friction(e: &Effect) -> Force {
    bristle(e.get("acceleration_mm_per_s2"), |_| 1.0)
}

/// Friction of a bristle, stronger or weaker with height.
pub(super) fn bristle(size: f64, at_height: impl Fn(f64) -> f64 + 'static) -> Force {
    let (reach_mm, mut bend) = (0.1, 0.0_f64);
    Box::new(move |x, v, _| {
        let end = reach_mm * v.signum();
        bend = end + (bend - end) * (-v.abs() * STEP_S / reach_mm).exp();
        -size * at_height(x) * (1.0 + 0.1 * (-(v / 5.0).powi(2)).exp()) * bend / reach_mm
    })
}

/// Springs with dampers that the ball touches for 4 ms; they never attract the ball. `restitution` is speed after over
/// before.
pub(crate) fn end_stop(e: &Effect) -> Force {
    let (bottom, top, back) = (e.get("bottom_mm"), e.get("top_mm"), e.get("restitution").ln());
    let stiffness = (std::f64::consts::PI / 0.004).powi(2);
    let damping = -2.0 * back / std::f64::consts::PI.hypot(back) * stiffness.sqrt();
    Box::new(move |x, v, _| {
        let depth = if x < bottom { bottom - x } else { (top - x).min(0.0) };
        let push = stiffness * depth - damping * v;
        if depth == 0.0 || push * depth <= 0.0 { 0.0 } else { push }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::Source;

    /// The ball under a force alone: height and speed after this long.
    fn fly(force: &mut Force, (mut x, mut v): (f64, f64), seconds: f64) -> (f64, f64) {
        for _ in 0..(seconds / STEP_S).round() as usize {
            v += force(x, v, 0.0) * STEP_S;
            x += v * STEP_S;
        }
        (x, v)
    }

    #[test]
    fn lift_has_its_slope_at_the_centre_and_vanishes_there() {
        let gradient = [("gradient_per_s2", 1.5), ("centre_mm", 300.0)];
        let mut force = height_dependent_flow(&Effect::new("height_dependent_flow", &gradient));
        assert!((force(299.0, 0.0, 0.0) - force(301.0, 0.0, 0.0) - 3.0).abs() < 1e-5 && force(300.0, 0.0, 0.0) == 0.0);
    }

    #[test]
    fn turbulence_has_its_sigma_and_its_correlation() {
        let effect = Effect::new("turbulence", &[("sigma_mm_per_s2", 40.0), ("correlation_s", 0.5)]);
        let mut force = turbulence(&effect, Source { seed: "air".into(), case: 0 }.stream("turbulence"));
        let series: Vec<f64> = (0..8_000_000).map(|_| force(0.0, 0.0, 0.0)).step_by(40).collect();
        let product = |k: usize| series.windows(k + 1).map(|w| w[0] * w[k]).sum::<f64>() / (series.len() - k) as f64;
        let variance = product(0);
        let area = (0..400).step_by(5).map(|k| product(k) / variance).sum::<f64>() * 0.05;
        assert!((variance.sqrt() / 40.0 - 1.0).abs() < 0.05, "{}", variance.sqrt());
        assert!((area / 0.5 - 1.0).abs() < 0.15, "{area}");
    }

    #[test]
    fn drag_at_speed_is_quadratic() {
        let mut force = quadratic_drag(&Effect::new("quadratic_drag", &[("coefficient_per_mm", 0.01)]));
        assert!((force(0.0, 200.0, 0.0) + 400.0).abs() < 1.0 && (force(0.0, -200.0, 0.0) - 400.0).abs() < 1.0);
    }

    #[test]
    fn a_sliding_ball_loses_the_friction_each_second_and_a_slow_one_sticks() {
        let mut force = wall_friction(&Effect::new("wall_friction", &[("acceleration_mm_per_s2", 40.0)]));
        let (_, v) = fly(&mut force, (100.0, 200.0), 2.0);
        assert!((v - 120.0).abs() < 0.5, "{v}");
        let (x, _) = fly(&mut force, (100.0, 1.0), 3.0);
        assert!((x - 100.0).abs() < 0.3, "{x}");
    }

    #[test]
    fn the_ball_leaves_an_end_with_its_restitution() {
        for restitution in [0.3, 0.6] {
            let ends = [("bottom_mm", 50.0), ("top_mm", 400.0), ("restitution", restitution)];
            let mut force = end_stop(&Effect::new("end_stop", &ends));
            let (_, v) = fly(&mut force, (60.0, -150.0), 0.1);
            assert!((v / 150.0 - restitution).abs() < 0.08, "{v} after {restitution}");
            let (_, v) = fly(&mut force, (390.0, 150.0), 0.1);
            assert!((v / -150.0 - restitution).abs() < 0.08, "{v} after {restitution}");
        }
    }
}

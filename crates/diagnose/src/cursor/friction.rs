//! Friction on a ball whose velocity is known only roughly.
//!
//! ```text
//! F(v) = −f·E sign = −f·erf(v/s)        s = √2·roughness
//! F(v, w) = 1/(w − v)·∫ F               the mean over velocities from v to w: ∫ erf(z) dz = z·erf(z) + e^(−z²)/√π
//! w = w₀ + k·F(v, w)                    over a step: w₀ without friction, k its effect on the velocity; one root, since F falls with w
//! ```
//!
//! Without the mean a filter would take a ball that creeps for one that sticks, and be sure of it. With the friction of a step's start alone a
//! ball that stops within a step would be thrown back.

use plant::{Model, Motion};
use std::f64::consts::{PI, SQRT_2};

/// Below this speed friction is smoothed, whatever the filter knows.
const SLOWEST_MM_PER_S: f64 = 1.0;
/// Velocities nearer than this share of s are one.
const ONE: f64 = 1e-3;
/// Steps at most to the root, and how near is there, mm/s.
const MOST_STEPS: usize = 40;
const THERE_MM_PER_S: f64 = 1e-9;

/// The motion after `dt` seconds under a friction of `full` mm/s², where the velocity is known to `roughness` mm/s.
pub(super) fn slide(model: &Model, motion: &Motion, (commanded, full): (f64, f64), roughness: f64, dt: f64) -> Motion {
    let with = |friction: f64| motion.slide(model, commanded, friction, dt);
    let (free, before) = (with(0.0), motion.velocity_mm_per_s);
    let held = with(-full).velocity_mm_per_s - free.velocity_mm_per_s;
    let scale = SQRT_2 * roughness.max(SLOWEST_MM_PER_S);
    with(full * settled(before, (free.velocity_mm_per_s, -held), scale))
}

/// F(v, w)/f at the root: Newton's steps, or halves of what is left where they leave it. `free`: w₀, and f·k.
fn settled(v: f64, (w0, by): (f64, f64), scale: f64) -> f64 {
    let (mut low, mut high) = (w0 - by.abs(), w0 + by.abs());
    let mut w = w0;
    for _ in 0..MOST_STEPS {
        let (mean, slope) = on_the_way(v, w, scale);
        let over = w - w0 - by * mean;
        if over > 0.0 {
            high = w;
        } else {
            low = w;
        }
        let newton = w - over / (1.0 - by * slope);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - w).abs() < THERE_MM_PER_S {
            break;
        }
        w = next;
    }
    on_the_way(v, w, scale).0
}

/// F(v, w)/f, and its slope over w.
fn on_the_way(v: f64, w: f64, scale: f64) -> (f64, f64) {
    let gaussian = |z: f64| libm::exp(-z * z) / PI.sqrt();
    let integral = |z: f64| z * libm::erf(z) + gaussian(z);
    let (a, b) = (v / scale, w / scale);
    if (b - a).abs() < ONE {
        let middle = 0.5 * (a + b);
        return (-libm::erf(middle), -gaussian(middle) / scale);
    }
    let mean = -(integral(b) - integral(a)) / (b - a);
    (mean, (-libm::erf(b) - mean) / (w - v))
}

#[cfg(test)]
mod tests {
    use super::{on_the_way, slide};
    use crate::tests_support::model;
    use plant::{Effects, Model, Motion};

    #[test]
    fn friction_on_the_way_is_the_mean_over_its_velocities_and_its_slope_the_difference() {
        const PARTS: u32 = 10_000;
        for (v, w, scale) in
            [(-3.0, 9.0, 1.5), (-5.0, 5.0, 3.0), (40.0, 20.0, 14.0), (1.0, -30.0, 6.0), (2.0, 2.001, 4.0)]
        {
            let at = |part: u32| v + (w - v) * (f64::from(part) + 0.5) / f64::from(PARTS);
            let mean = (0..PARTS).map(|part| -libm::erf(at(part) / scale)).sum::<f64>() / f64::from(PARTS);
            let (closed, slope) = on_the_way(v, w, scale);
            assert!((closed - mean).abs() < 1e-6, "{closed} for {mean}");
            let difference = (on_the_way(v, w + 1e-4, scale).0 - on_the_way(v, w - 1e-4, scale).0) / 2e-4;
            assert!((slope - difference).abs() < 1e-5, "{slope} for {difference}");
        }
    }

    /// A rig without a lag, so that the fan's command acts at once.
    fn quick() -> Model {
        Model { effects: Effects::default(), drag_per_s: 0.0, ..model() }
    }

    #[test]
    fn a_ball_that_stops_within_a_step_stays_and_one_that_turns_is_flown_as_by_a_hundred_steps() {
        let rig = quick();
        for (before, commanded, full, dt) in
            [(1.0, 0.0, 500.0, 0.02), (3.0, 0.0, 500.0, 0.02), (5.0, 300.0, 500.0, 0.02), (8.0, -900.0, 150.0, 0.01)]
        {
            let start = Motion { velocity_mm_per_s: before, ..Motion::at_rest(300.0, commanded) };
            let whole = slide(&rig, &start, (commanded, full), 0.5, dt).velocity_mm_per_s;
            let parts = (0..1000).fold(start, |at, _| slide(&rig, &at, (commanded, full), 0.5, dt / 1000.0));
            let parts = parts.velocity_mm_per_s;
            // What is smoothed is no surer: s is 1.4 mm/s.
            assert!((whole - parts).abs() < 1.4, "{whole} for {parts} mm/s from {before}");
        }
        let stopped =
            slide(&rig, &Motion { velocity_mm_per_s: 3.0, ..Motion::at_rest(300.0, 0.0) }, (0.0, 500.0), 0.5, 0.02);
        assert!(stopped.velocity_mm_per_s.abs() < 3.0, "friction drives nothing: {} mm/s", stopped.velocity_mm_per_s);
    }

    #[test]
    fn what_friction_does_has_no_jump_in_the_velocity() {
        let rig = quick();
        let after = |k: u32| {
            let start = Motion { velocity_mm_per_s: 0.01 * f64::from(k) - 10.0, ..Motion::at_rest(300.0, 40.0) };
            slide(&rig, &start, (40.0, 60.0), 1.0, 0.02).velocity_mm_per_s
        };
        for k in 0..2000 {
            let step = after(k + 1) - after(k);
            assert!((-1e-6..0.0101).contains(&step), "{step} mm/s at {k}");
        }
    }
}

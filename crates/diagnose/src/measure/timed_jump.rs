//! The force curve: the acceleration from the time of a jump from rest.
//!
//! ```text
//! ÿ = F/m − a·ẏ,  y(0) = 0, ẏ(0) = 0        Δy = (F/m)/a·( Δt − (1 − e^(−aΔt))/a )
//! F/m = a·Δy/( Δt − (1 − e^(−aΔt))/a )       a → 0: 2·Δy/Δt²
//! ```
//!
//! The duty is constant during the jump. Source: the thesis, section 3.2.2. Erratum: its equations 3.2.2.1 to 3 have
//! −a·y instead of the drag −a·ẏ and lose terms. Its measured curve comes from them and is only comparable with itself.

/// Below this a·Δt the difference above cancels, and its series is exact to 1e-9.
const SHORT: f64 = 0.01;

/// F/m, mm/s², of a ball that moved by `jump_mm` in `time_s` from rest, with the drag `drag_per_s`. `None` if the time
/// is not positive or a value is not finite.
#[must_use]
pub fn acceleration(jump_mm: f64, time_s: f64, drag_per_s: f64) -> Option<f64> {
    if !(time_s > 0.0 && drag_per_s >= 0.0) {
        return None;
    }
    let x = drag_per_s * time_s;
    // (x − 1 + e^(−x))/x², which is 1/2 without drag.
    let share =
        if x < SHORT { 0.5 - x / 6.0 + x * x / 24.0 - x * x * x / 120.0 } else { (x + libm::expm1(-x)) / (x * x) };
    Some(jump_mm / (time_s * time_s * share)).filter(|found| found.is_finite())
}

#[cfg(test)]
mod tests {
    use super::{SHORT, acceleration};

    #[test]
    fn a_fall_without_drag_is_galileis() {
        assert!((acceleration(300.0, 0.5, 0.0).unwrap() - 2.0 * 300.0 / 0.25).abs() < 1e-9);
    }

    #[test]
    fn a_simulated_jump_gives_the_force_that_made_it() {
        let (force, drag, dt) = (-800.0, 1.889, 1e-5);
        let (mut y, mut v) = (0.0_f64, 0.0);
        let mut steps = 0;
        while y > -300.0 {
            let half = v + 0.5 * dt * (force - drag * v);
            y += dt * half;
            v = half + 0.5 * dt * (force - drag * half);
            steps += 1;
        }
        let found = acceleration(y, dt * f64::from(steps), drag).unwrap();
        assert!((found / force - 1.0).abs() < 1e-5, "{found} mm/s², made by {force} mm/s²");
    }

    #[test]
    fn the_series_for_little_drag_joins_the_closed_form() {
        let at = |x: f64| acceleration(300.0, 1.0, x).unwrap();
        let (below, above) = (at(SHORT * (1.0 - 1e-9)), at(SHORT));
        assert!((below / above - 1.0).abs() < 1e-9, "{below} {above}");
    }

    #[test]
    fn no_time_is_no_force() {
        assert!(acceleration(300.0, 0.0, 1.0).is_none() && acceleration(f64::NAN, 1.0, 1.0).is_none());
    }
}

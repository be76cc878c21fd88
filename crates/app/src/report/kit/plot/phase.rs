//! Phases in degrees without the jumps of a whole turn.

/// The phase that differs from `phase` by whole turns and is nearest to `near`.
pub fn nearest(phase: f64, near: f64) -> f64 {
    phase - 360.0 * ((phase - near) / 360.0).round()
}

/// The phases along a frequency response, each nearest to the one before it; the first is nearest to that of a double
/// integrator.
pub fn unwrapped(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut last = -180.0;
    for (_, phase) in &mut points {
        *phase = nearest(*phase, last);
        last = *phase;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::unwrapped;

    #[test]
    fn the_phase_of_a_delay_falls_without_a_jump() {
        // A delay of 1 s behind a double integrator: −180° − ω.
        let wrapped = |k: i32| {
            let phase = (-180.0 - 10.0 * f64::from(k)).to_radians();
            (f64::from(k), phase.sin().atan2(phase.cos()).to_degrees())
        };
        for (k, phase) in unwrapped((0..100).map(wrapped).collect()) {
            assert!((phase - (-180.0 - 10.0 * k)).abs() < 1e-9, "{k}: {phase}");
        }
    }
}

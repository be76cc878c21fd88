//! The classical Runge–Kutta step of order 4: error per step ∝ dt⁵ on smooth right-hand sides.
//!
//! ```text
//! dx/dt = rate(x, force)      force known at the start, the middle and the end of the step
//! ```
//!
//! Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, section II.1.

/// Advances dx/dt = `rate(x, force)` by `dt_s`, with the force at the start, the middle and the end.
// Inlined: a call for each of the four rates costs as much as the rates.
#[inline(always)]
pub(crate) fn step<const N: usize, F: Copy>(
    rate: impl Fn(&[f64; N], F) -> [f64; N],
    x: &[f64; N],
    [start, middle, end]: [F; 3],
    dt_s: f64,
) -> [f64; N] {
    let along = |k: &[f64; N], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
    let k1 = rate(x, start);
    let k2 = rate(&along(&k1, dt_s / 2.0), middle);
    let k3 = rate(&along(&k2, dt_s / 2.0), middle);
    let k4 = rate(&along(&k3, dt_s), end);
    std::array::from_fn(|i| x[i] + dt_s / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

#[cfg(test)]
mod tests {
    use super::step;
    use libm::{cos, sin};

    /// Error at t = 1 of a driven oscillator whose exact state is (cos 3t + sin 2t, its derivative).
    fn error(steps: u32) -> f64 {
        let dt = 1.0 / f64::from(steps);
        let mut x = [1.0, 2.0];
        for k in 0..steps {
            let force = [0.0, 0.5, 1.0].map(|part| 5.0 * sin(2.0 * (f64::from(k) + part) * dt));
            x = step(|x, force| [x[1], force - 9.0 * x[0]], &x, force, dt);
        }
        (x[0] - cos(3.0) - sin(2.0)).hypot(x[1] + 3.0 * sin(3.0) - 2.0 * cos(2.0))
    }

    #[test]
    fn halving_the_step_divides_the_error_by_sixteen() {
        let ratio = error(100) / error(200);
        assert!((ratio - 16.0).abs() < 0.8, "order {}", ratio.log2());
    }
}

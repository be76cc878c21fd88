//! The classical Runge–Kutta step of order 4: error per step ∝ dt⁵ on smooth right-hand sides.
//!
//! Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, section II.1.

/// Advances dx/dt = `rate(x)` by `dt_s`.
pub(crate) fn step<const N: usize>(rate: impl Fn(&[f64; N]) -> [f64; N], x: &[f64; N], dt_s: f64) -> [f64; N] {
    let along = |k: &[f64; N], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
    let k1 = rate(x);
    let k2 = rate(&along(&k1, dt_s / 2.0));
    let k3 = rate(&along(&k2, dt_s / 2.0));
    let k4 = rate(&along(&k3, dt_s));
    std::array::from_fn(|i| x[i] + dt_s / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

#[cfg(test)]
mod tests {
    use super::step;

    /// Error at t = 1 of an oscillator whose exact state is (cos 3t, −3·sin 3t).
    fn error(steps: u32) -> f64 {
        let dt = 1.0 / f64::from(steps);
        let mut x = [1.0, 0.0];
        for _ in 0..steps {
            x = step(|x| [x[1], -9.0 * x[0]], &x, dt);
        }
        (x[0] - libm::cos(3.0)).hypot(x[1] + 3.0 * libm::sin(3.0))
    }

    #[test]
    fn halving_the_step_divides_the_error_by_sixteen() {
        let ratio = error(50) / error(100);
        assert!((ratio - 16.0).abs() < 0.5, "order {}", ratio.log2());
    }
}

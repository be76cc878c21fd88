//! The transient method: a plant `K_g/(s(s + a))` from the step response of its proportional loop.
//!
//! ```text
//! overshoot R = e^(−πδ/√(1 − δ²))      peak time T_p = π/(ω_n·√(1 − δ²))      K_g = ω_n²/K_p      a = 2δω_n
//! δ = −ln R/√(π² + ln² R)
//! dead time L in the loop, s² + a·s + κ·e^(−Ls), e^(−Ls) ≈ 1 − Ls + L²s²/2:     κ = K_p·K_g = ω_n²/(1 − ω_n²L²/2)
//!                                                                               a = 2δω_n·(1 + κL²/2) + κL
//! ```
//!
//! Assumes unit feedback and no other pole: the fan's pole changes δ and ω_n unnoticed.
//! Source: the thesis, section 3.1.2. Erratum: it prints √(δ² − 1) in the peak time, which has no real value for loops
//! with overshoot.

/// A second-order closed loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transient {
    /// δ: damping.
    pub damping: f64,
    /// ω_n: natural frequency, rad/s.
    pub omega: f64,
}

/// The plant of that loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoPoles {
    /// K_g, mm/s² per unit of the control value.
    pub gain: f64,
    /// a: linear drag, 1/s.
    pub drag_per_s: f64,
}

impl Transient {
    /// From the overshoot as a share of the step (between 0 and 1, exclusive) and the peak time in s; `None` for other
    /// values.
    #[must_use]
    pub fn of_step(overshoot: f64, peak_s: f64) -> Option<Self> {
        if !(overshoot > 0.0 && overshoot < 1.0 && peak_s > 0.0 && peak_s.is_finite()) {
            return None;
        }
        let depth = -libm::log(overshoot);
        let damping = depth / libm::hypot(std::f64::consts::PI, depth);
        Some(Self { damping, omega: std::f64::consts::PI / (peak_s * (1.0 - damping * damping).sqrt()) })
    }

    /// Overshoot as a share of the step, and peak time in s; `None` without overshoot.
    #[must_use]
    pub fn step(&self) -> Option<(f64, f64)> {
        let root = (1.0 - self.damping * self.damping).sqrt();
        let pi = std::f64::consts::PI;
        (root > 0.0 && self.omega > 0.0).then(|| (libm::exp(-pi * self.damping / root), pi / (self.omega * root)))
    }

    /// The step response at `t_s` after the step, as a share of the step, for δ up to 1.
    #[must_use]
    pub fn response(&self, t_s: f64) -> f64 {
        if self.damping >= 1.0 {
            return 1.0 - (1.0 + self.omega * t_s) * libm::exp(-self.omega * t_s);
        }
        let (sigma, omega) = (self.damping * self.omega, self.omega * (1.0 - self.damping * self.damping).sqrt());
        let turn = omega * t_s;
        1.0 - libm::exp(-sigma * t_s) * (libm::cos(turn) + sigma / omega * libm::sin(turn))
    }

    /// The plant in a loop with a proportional controller of `kp_per_mm` and a dead time.
    #[must_use]
    pub fn plant_behind(&self, kp_per_mm: f64, dead_time_s: f64) -> TwoPoles {
        let half = 0.5 * dead_time_s * dead_time_s;
        let kappa = self.omega * self.omega / (1.0 - half * self.omega * self.omega);
        let drag_per_s = 2.0 * self.damping * self.omega * (1.0 + half * kappa) + kappa * dead_time_s;
        TwoPoles { gain: kappa / kp_per_mm, drag_per_s }
    }
}

#[cfg(test)]
mod tests {
    use super::{Transient, TwoPoles};

    /// The thesis, table 3.1.2.1: K_p, δ, ω_n, and the K_g and a that it prints.
    const TABLE: [[f64; 5]; 6] = [
        [0.006, 0.809, 1.120, 209.029, 1.813],
        [0.007, 0.922, 0.851, 103.455, 1.569],
        [0.009, 0.752, 1.397, 216.788, 2.100],
        [0.011, 0.585, 1.854, 312.539, 2.171],
        [0.013, 0.479, 1.892, 275.300, 1.812],
        [0.015, 0.392, 1.972, 259.334, 1.547],
    ];

    #[test]
    fn the_table_of_the_thesis_follows_from_its_damping_and_frequency() {
        for [kp, damping, omega, gain, drag] in TABLE {
            let found = Transient { damping, omega }.plant_behind(kp, 0.0);
            // δ and ω_n are printed with three decimals.
            assert!((found.gain / gain - 1.0).abs() < 0.0025, "K_p {kp}: {found:?}");
            assert!((found.drag_per_s / drag - 1.0).abs() < 0.0015, "K_p {kp}: {found:?}");
        }
    }

    #[test]
    fn the_models_gain_and_drag_are_the_means_of_the_table_without_its_outlier() {
        let kept = || TABLE.iter().filter(|row| row[0] != 0.007);
        let mean = |column: usize| kept().map(|row| row[column]).sum::<f64>() / kept().count() as f64;
        assert!((mean(3) - 254.598).abs() < 5e-4 && (mean(4) - 1.889).abs() < 5e-4, "{} {}", mean(3), mean(4));
    }

    #[test]
    fn overshoot_and_peak_of_a_simulated_loop_give_its_plant_back() {
        let (gain, drag_per_s, kp, dt) = (254.598, 1.889, 0.015, 1e-4);
        let (mut y, mut v) = (0.0_f64, 0.0);
        let (mut peak, mut peak_s) = (0.0, 0.0);
        for k in 0..40_000 {
            // Midpoint rule, so that the error is of second order in dt.
            let half = v + 0.5 * dt * (gain * kp * (1.0 - y) - drag_per_s * v);
            y += dt * half;
            v = half + 0.5 * dt * (gain * kp * (1.0 - y) - drag_per_s * half);
            if y > peak {
                (peak, peak_s) = (y, dt * f64::from(k + 1));
            }
        }
        let TwoPoles { gain: found, drag_per_s: drag } =
            Transient::of_step(peak - 1.0, peak_s).unwrap().plant_behind(kp, 0.0);
        assert!((found / gain - 1.0).abs() < 2e-3 && (drag / drag_per_s - 1.0).abs() < 2e-3, "{found} {drag}");
    }

    #[test]
    fn overshoot_and_peak_time_lead_to_the_loop_and_back() {
        let transient = Transient { damping: 0.392, omega: 1.972 };
        let (overshoot, peak_s) = transient.step().unwrap();
        let again = Transient::of_step(overshoot, peak_s).unwrap();
        assert!((again.damping - 0.392).abs() < 1e-12 && (again.omega - 1.972).abs() < 1e-12, "{again:?}");
    }

    #[test]
    fn a_loop_that_does_not_overshoot_has_no_transient() {
        assert!(Transient::of_step(0.0, 1.0).is_none() && Transient::of_step(-0.1, 1.0).is_none());
        assert!(Transient::of_step(f64::NAN, 1.0).is_none() && Transient::of_step(0.2, f64::INFINITY).is_none());
        assert!(Transient { damping: 1.0, omega: 2.0 }.step().is_none());
    }
}

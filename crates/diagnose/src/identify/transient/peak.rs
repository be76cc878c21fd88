//! The first peak of a step response, and the time at which it reaches one half.
//!
//! ```text
//! y ≈ c₀ + c₁·x + c₂·x² + c₃·x³ within 0.2·T_p of the highest point      peak where y' = 0 and y'' < 0
//! ```
//!
//! A cubic instead of a parabola: a decaying oscillation rises faster than it falls, which would shift the maximum of a
//! parabola. Beyond 0.2·T_p a cubic no longer approximates the decay: at a damping of 0.8 K_g would be 0.9 % too low.

use nalgebra::{Matrix4, Vector4};

/// Latest time of the first peak, in times to one half: 4.1 at a damping of 0.7, 6 at 0.85.
const PEAK_WITHIN: f64 = 6.0;
/// Half-width of the window of the cubic, in peak times.
const ABOUT: f64 = 0.2;

/// When `points`, time in s and share of the step, first reach one half, s.
pub(crate) fn half_way_s(points: &[(f64, f64)]) -> Option<f64> {
    let at = points.iter().position(|(_, share)| *share >= 0.5)?;
    let ((t0, y0), (t1, y1)) = (*points.get(at.checked_sub(1)?)?, points[at]);
    Some(t0 + (t1 - t0) * (0.5 - y0) / (y1 - y0).max(1e-12))
}

/// Time and height of the first peak; `None` if there is none.
#[must_use]
pub fn first_peak(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let within_s = PEAK_WITHIN * half_way_s(points)?;
    let early = points.iter().take_while(|(t, _)| *t <= within_s);
    let (top_s, _) = *early.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let near: Vec<(f64, f64)> = points.iter().filter(|(t, _)| (t - top_s).abs() <= ABOUT * top_s).copied().collect();
    // In units of the window, so that the equations are well scaled.
    let unit = ABOUT * top_s;
    let (mut squares, mut products) = (Matrix4::<f64>::zeros(), Vector4::<f64>::zeros());
    for (t, y) in &near {
        let x = (t - top_s) / unit;
        let powers = Vector4::new(1.0, x, x * x, x * x * x);
        squares += powers * powers.transpose();
        products += powers * *y;
    }
    let c = squares.cholesky()?.solve(&products);
    // 3·c₃·x² + 2·c₂·x + c₁ = 0, at the root with a negative second derivative.
    let root = (c[2] * c[2] - 3.0 * c[3] * c[1]).sqrt();
    let x = -c[1] / (c[2] - root);
    (x.abs() <= 1.0).then(|| (top_s + unit * x, c[0] + x * (c[1] + x * (c[2] + x * c[3]))))
}

#[cfg(test)]
mod tests {
    use super::{first_peak, half_way_s};
    use crate::identify::transient::second_order::Transient;

    #[test]
    fn the_peak_of_a_step_of_second_order_is_that_of_the_closed_form() {
        for damping in [0.3, 0.479, 0.585, 0.752, 0.809] {
            let transient = Transient { damping, omega: 1.9 };
            let points: Vec<(f64, f64)> =
                (0..400).map(|k| 0.02 * f64::from(k)).map(|t| (t, transient.response(t))).collect();
            let (overshoot, peak_s) = transient.step().unwrap();
            let (found_s, height) = first_peak(&points).unwrap();
            assert!((height - 1.0 - overshoot).abs() < 1e-3 * overshoot + 1e-4, "{damping}: {height} of {overshoot}");
            assert!((found_s / peak_s - 1.0).abs() < 2e-3, "{damping}: {found_s} of {peak_s}");
        }
    }

    #[test]
    fn a_critically_damped_step_is_half_way_at_the_published_time() {
        let critical = Transient { damping: 1.0, omega: 2.0 };
        let points: Vec<(f64, f64)> =
            (0..400).map(|k| 0.02 * f64::from(k)).map(|t| (t, critical.response(t))).collect();
        assert!((half_way_s(&points).unwrap() - 1.678_347 / 2.0).abs() < 1e-4);
    }
}

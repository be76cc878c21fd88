//! A linear model from one sample to the next, exactly.
//!
//! ```text
//! ẋ = A·x + B·u + w,  u constant, w white with E[w·wᵀ] = W·δ(t)      x[n+1] = Φ·x[n] + Γ·u[n] + w[n]
//! Φ = e^(A·t)      Γ = ∫₀ᵗ e^(A·τ) dτ·B      Q = ∫₀ᵗ e^(A·τ)·W·e^(Aᵀ·τ) dτ
//! over 2·t:        Φ²    Γ + Φ·Γ    Q + Φ·Q·Φᵀ
//! ```
//!
//! A Taylor series over a short time, doubled until the time is right.
//! Source: Van Loan, "Computing integrals involving the matrix exponential", *IEEE Trans. Automatic Control* 23, 1978.

use nalgebra::{SMatrix, SVector};

/// Terms of the series: with |A|·t ≤ 1/2 the rest is below 1e-20.
const TERMS: u32 = 16;
/// Doublings at most.
const MOST_DOUBLINGS: u32 = 64;

/// A model from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discrete<const N: usize> {
    /// Φ: what the state becomes.
    pub transition: SMatrix<f64, N, N>,
    /// Γ: what a constant input adds.
    pub input: SVector<f64, N>,
    /// Q: the covariance that the white noise adds.
    pub noise: SMatrix<f64, N, N>,
}

/// The model over `time_s`; `a`, `b` and `w` are A, B and W.
#[must_use]
pub fn discretise<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    w: &SMatrix<f64, N, N>,
    time_s: f64,
) -> Discrete<N> {
    let (mut t, mut doublings) = (time_s, 0);
    while a.norm() * t.abs() > 0.5 && doublings < MOST_DOUBLINGS {
        t /= 2.0;
        doublings += 1;
    }
    let mut over = series(a, b, w, t);
    for _ in 0..doublings {
        let Discrete { transition: phi, input, noise } = over;
        over = Discrete {
            transition: phi * phi,
            input: input + phi * input,
            noise: noise + phi * noise * phi.transpose(),
        };
    }
    over
}

fn series<const N: usize>(a: &SMatrix<f64, N, N>, b: &SVector<f64, N>, w: &SMatrix<f64, N, N>, t: f64) -> Discrete<N> {
    let mut transition = SMatrix::identity();
    let mut input = b * t;
    let mut noise = w * t;
    let (mut power, mut moved, mut spread) = (transition, input, noise);
    for k in 1..=TERMS {
        let (now, next) = (t / f64::from(k), t / f64::from(k + 1));
        power = a * power * now;
        moved = a * moved * next;
        spread = (a * spread + spread * a.transpose()) * next;
        transition += power;
        input += moved;
        noise += spread;
    }
    Discrete { transition, input, noise }
}

#[cfg(test)]
mod tests {
    use super::discretise;
    use libm::exp;
    use nalgebra::{matrix, vector};

    #[test]
    fn ball_with_drag_moves_as_its_closed_form_over_any_time() {
        let (drag, gain, psd) = (3.896, 827.2, 360.0);
        let (a, b) = (matrix![0.0, 1.0; 0.0, -drag], vector![0.0, gain]);
        let w = matrix![0.0, 0.0; 0.0, psd];
        for t in [0.018, 3.0] {
            let found = discretise(&a, &b, &w, t);
            let decay = exp(-drag * t);
            let f = (1.0 - decay) / drag;
            let g = (1.0 - decay * decay) / (2.0 * drag);
            let phi = matrix![1.0, f; 0.0, decay];
            let gamma = vector![gain * (t - f) / drag, gain * f];
            let q =
                matrix![psd * (t - 2.0 * f + g) / (drag * drag), psd * (f - g) / drag; psd * (f - g) / drag, psd * g];
            assert!((found.transition - phi).norm() < 1e-13 * phi.norm(), "{}", found.transition);
            assert!((found.input - gamma).norm() < 1e-12 * gamma.norm(), "{}", found.input);
            assert!((found.noise - q).norm() < 1e-12 * q.norm(), "{}", found.noise);
        }
    }
}

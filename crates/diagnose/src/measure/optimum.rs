//! The maximum of a smooth function of few parameters, and its covariance.
//!
//! ```text
//! gradient, curvature C: central differences      (C + λ·diag C)·δ = gradient      covariance C⁻¹
//! ```
//!
//! The function is a log-probability, in parameters scaled to sizes of about 1.
//! Source: Nocedal & Wright, *Numerical Optimization*, "Modified Newton".

use nalgebra::{DMatrix, DVector};

/// Step of the numerical derivatives.
const DIFFERENCE: f64 = 0.02;
/// Largest number of steps, and the gain below which a step is the last.
const MOST_STEPS: usize = 40;
const GAIN_ENOUGH: f64 = 1e-4;
/// The longest step in any parameter.
const LONGEST: f64 = 0.7;
/// Number of increases of the damping per step.
const TRIALS: usize = 8;

/// The maximum and the covariance of the parameters; `None` without convergence.
pub(super) fn maximise(f: impl Fn(&[f64]) -> f64, start: &[f64]) -> Option<(Vec<f64>, DMatrix<f64>)> {
    let mut best = start.to_vec();
    let mut value = f(&best);
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        let (gradient, curvature) = slopes(&f, &best, value);
        let before = value;
        for _ in 0..TRIALS {
            let trial = step(&curvature, &gradient, damping).map(|step| moved(&best, &step));
            match trial.map(|at| (f(&at), at)).filter(|(found, _)| *found > value) {
                Some((found, at)) => {
                    (value, best, damping) = (found, at, (damping / 5.0).max(1e-6));
                    break;
                }
                None => damping *= 6.0,
            }
        }
        if value - before < GAIN_ENOUGH {
            let covariance = curvature.try_inverse()?;
            let sound = value.is_finite() && covariance.diagonal().iter().all(|v| *v > 0.0);
            return sound.then_some((best, covariance));
        }
    }
    None
}

/// Gradient and negative second derivatives.
fn slopes(f: &impl Fn(&[f64]) -> f64, at: &[f64], value: f64) -> (DVector<f64>, DMatrix<f64>) {
    let n = at.len();
    let off = |moves: &[(usize, f64)]| {
        let mut there = at.to_vec();
        moves.iter().for_each(|(i, by)| there[*i] += by * DIFFERENCE);
        f(&there)
    };
    let sides: Vec<[f64; 2]> = (0..n).map(|i| [1.0, -1.0].map(|by| off(&[(i, by)]))).collect();
    let gradient = DVector::from_fn(n, |i, _| (sides[i][0] - sides[i][1]) / (2.0 * DIFFERENCE));
    let mut curvature = DMatrix::zeros(n, n);
    for i in 0..n {
        curvature[(i, i)] = (2.0 * value - sides[i][0] - sides[i][1]) / (DIFFERENCE * DIFFERENCE);
        for j in 0..i {
            let both = off(&[(i, 1.0), (j, 1.0)]) + off(&[(i, -1.0), (j, -1.0)]);
            let mixed = sides[i].iter().chain(&sides[j]).sum::<f64>() - both - 2.0 * value;
            curvature[(i, j)] = mixed / (2.0 * DIFFERENCE * DIFFERENCE);
            curvature[(j, i)] = curvature[(i, j)];
        }
    }
    (gradient, curvature)
}

fn step(curvature: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let mut damped = curvature.clone();
    for i in 0..gradient.len() {
        damped[(i, i)] += damping * curvature[(i, i)].abs().max(1e-3);
    }
    Some(damped.cholesky()?.solve(gradient))
}

fn moved(at: &[f64], step: &DVector<f64>) -> Vec<f64> {
    let shorter = (LONGEST / step.amax().max(LONGEST)).min(1.0);
    at.iter().zip(step.iter()).map(|(x, by)| x + shorter * by).collect()
}

#[cfg(test)]
mod tests {
    use super::maximise;

    #[test]
    fn a_normal_density_gives_its_mean_and_covariance() {
        // Precision [[2, 1], [1, 3]]: covariance [[0.6, −0.2], [−0.2, 0.4]].
        let f = |x: &[f64]| {
            let (a, b) = (x[0] - 1.0, x[1] + 2.0);
            -0.5 * (2.0 * a * a + 2.0 * a * b + 3.0 * b * b)
        };
        let (at, covariance) = maximise(f, &[0.0, 0.0]).unwrap();
        assert!((at[0] - 1.0).abs() < 1e-3 && (at[1] + 2.0).abs() < 1e-3, "{at:?}");
        let exact = [0.6, -0.2, -0.2, 0.4];
        assert!(covariance.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-4), "{covariance}");
    }
}

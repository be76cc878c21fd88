//! Riccati equations: linear-quadratic regulator and steady-state Kalman filter.
//!
//! ```text
//! continuous   Aᵀ·X + X·A − X·G·X + Q = 0                      G = B·Bᵀ/R     K = Bᵀ·X/R
//! sampled      X = Aᵀ·X·(I + G·X)⁻¹·A + Q                                     K = Bᵀ·X·A/(R + Bᵀ·X·B)
//!
//! doubling     A ← A·(I + G·H)⁻¹·A     G ← G + A·(I + G·H)⁻¹·G·Aᵀ     H ← H + Aᵀ·H·(I + G·H)⁻¹·A     H → X
//! ```
//!
//! The doubling starts at A, G, Q of the sampled equation; the continuous one is brought to that form by Cayley's
//! transform with γ. It converges quadratically. The filter is the regulator of Aᵀ and Cᵀ, with the noises W and V in
//! place of the weights. A state that decays on its own needs neither weight nor noise; one that does not needs it, or
//! there is no solution.
//! Source: Chu, Fan & Lin, "A structure-preserving doubling algorithm for continuous-time algebraic Riccati equations",
//! *Linear Algebra and its Applications* 396, 2005.
//!
//! Erratum: the thesis prints W = 3·I and V = 5 for its observer, which give L = [1.0013, 0.2013]; its L = [0.449,
//! 0.0508] belongs to W = 0.1·V·I.

use super::error::DesignError;
use nalgebra::{RowSVector, SMatrix, SVector};

/// Doublings at most: what has not died away after 2⁴⁰ samples does not; later, rounding would make it die.
const MOST_DOUBLINGS: u32 = 40;

/// K of u = −K·x that minimises ∫ xᵀQx + R·u² dt along ẋ = A·x + B·u.
///
/// # Errors
/// [`DesignError::NoRiccatiSolution`].
pub fn lqr<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    q: &SMatrix<f64, N, N>,
    r: f64,
) -> Result<RowSVector<f64, N>, DesignError> {
    let x = continuous(a, &(b * b.transpose() / r), q)?;
    Ok(b.transpose() * x / r)
}

/// K of u = −K·x that minimises Σ xᵀQx + R·u² along x ← Φ·x + Γ·u.
///
/// # Errors
/// [`DesignError::NoRiccatiSolution`].
pub fn sampled_lqr<const N: usize>(
    phi: &SMatrix<f64, N, N>,
    gamma: &SVector<f64, N>,
    q: &SMatrix<f64, N, N>,
    r: f64,
) -> Result<RowSVector<f64, N>, DesignError> {
    let x = cost_to_go(phi, gamma, q, r)?;
    let weight = r + (gamma.transpose() * x * gamma)[0];
    Ok(gamma.transpose() * x * phi / weight)
}

/// X of the regulator of [`sampled_lqr`]: xᵀXx is what is still to be paid from the state x on.
///
/// # Errors
/// [`DesignError::NoRiccatiSolution`].
pub fn cost_to_go<const N: usize>(
    phi: &SMatrix<f64, N, N>,
    gamma: &SVector<f64, N>,
    q: &SMatrix<f64, N, N>,
    r: f64,
) -> Result<SMatrix<f64, N, N>, DesignError> {
    doubled(*phi, gamma * gamma.transpose() / r, *q)
}

/// L of dx̂/dt = A·x̂ + B·u + L·(y − C·x̂) under white noise of intensities W on the states and V on the reading.
///
/// # Errors
/// [`DesignError::NoRiccatiSolution`].
pub fn kalman<const N: usize>(
    a: &SMatrix<f64, N, N>,
    c: &RowSVector<f64, N>,
    w: &SMatrix<f64, N, N>,
    v: f64,
) -> Result<SVector<f64, N>, DesignError> {
    let p = continuous(&a.transpose(), &(c.transpose() * c / v), w)?;
    Ok(p * c.transpose() / v)
}

/// L of x̂ ← x̂ + L·(y − C·x̂) after every reading of variance `r`, between which the state moves by Φ and gains the
/// covariance Q.
///
/// # Errors
/// [`DesignError::NoRiccatiSolution`].
pub fn sampled_kalman<const N: usize>(
    phi: &SMatrix<f64, N, N>,
    c: &RowSVector<f64, N>,
    q: &SMatrix<f64, N, N>,
    r: f64,
) -> Result<SVector<f64, N>, DesignError> {
    let p = covariance(phi, c, q, r)?;
    Ok(p * c.transpose() / ((c * p * c.transpose())[0] + r))
}

/// P of the filter of [`sampled_kalman`]: the covariance of its state just before a reading.
///
/// # Errors
/// [`DesignError::NoRiccatiSolution`].
pub fn covariance<const N: usize>(
    phi: &SMatrix<f64, N, N>,
    c: &RowSVector<f64, N>,
    q: &SMatrix<f64, N, N>,
    r: f64,
) -> Result<SMatrix<f64, N, N>, DesignError> {
    covariance_of_several(phi, &(c.transpose() * c / r), q)
}

/// The same where several quantities are read at once, each by a row c with variance r: `information` is Σ cᵀ·c/r.
///
/// # Errors
/// [`DesignError::NoRiccatiSolution`].
pub fn covariance_of_several<const N: usize>(
    phi: &SMatrix<f64, N, N>,
    information: &SMatrix<f64, N, N>,
    q: &SMatrix<f64, N, N>,
) -> Result<SMatrix<f64, N, N>, DesignError> {
    doubled(phi.transpose(), *information, *q)
}

/// X of the continuous equation.
fn continuous<const N: usize>(
    a: &SMatrix<f64, N, N>,
    g: &SMatrix<f64, N, N>,
    q: &SMatrix<f64, N, N>,
) -> Result<SMatrix<f64, N, N>, DesignError> {
    // γ about as large as the closed loop's poles converges in the fewest steps; any γ above 0 does.
    let gamma = (a.norm() + libm::sqrt(g.norm() * q.norm())).max(1e-3);
    let identity = SMatrix::<f64, N, N>::identity();
    let inverse = |m: SMatrix<f64, N, N>| m.try_inverse().ok_or(DesignError::NoRiccatiSolution);
    let shifted = inverse(a - identity * gamma)?;
    let w = inverse(a.transpose() - identity * gamma + q * shifted * g)?;
    doubled(identity + w.transpose() * (2.0 * gamma), shifted * g * w * (2.0 * gamma), w * q * shifted * (2.0 * gamma))
}

/// X of the sampled equation, by doubling.
fn doubled<const N: usize>(
    mut a: SMatrix<f64, N, N>,
    mut g: SMatrix<f64, N, N>,
    mut h: SMatrix<f64, N, N>,
) -> Result<SMatrix<f64, N, N>, DesignError> {
    for _ in 0..MOST_DOUBLINGS {
        let inverse = (SMatrix::identity() + g * h).try_inverse().ok_or(DesignError::NoRiccatiSolution)?;
        let step = a.transpose() * h * inverse * a;
        g += a * inverse * g * a.transpose();
        a = a * inverse * a;
        h += step;
        if !h.iter().chain(&a).all(|x| x.is_finite()) {
            break;
        }
        // What is left of A is the closed loop after 2ⁿ samples: it dies away if that loop is stable, often later than
        // H stands.
        if step.norm() <= 1e-15 * h.norm() && a.norm() < 1e-3 {
            return Ok((h + h.transpose()) * 0.5);
        }
    }
    Err(DesignError::NoRiccatiSolution)
}

#[cfg(test)]
mod tests {
    use super::{cost_to_go, covariance, kalman, lqr, sampled_kalman, sampled_lqr};
    use crate::design::Linear;
    use crate::design::ackermann::characteristic;
    use crate::design::discretise::discretise;
    use crate::kalman::Kalman;
    use libm::sqrt;
    use nalgebra::{SMatrix, SVector, matrix, vector};

    fn linearised() -> Linear {
        Linear::two_poles(0.5894041732678656, 0.7800118875890534)
    }

    #[test]
    fn the_regulator_of_the_thesis_has_its_gains() {
        let (a, b) = linearised().two_states();
        let k = lqr(&a, &b, &matrix![1.0, 0.0; 0.0, 0.01], 0.05).unwrap();
        assert!((k[0] - 4.472136).abs() < 5e-7 && (k[1] - 2.815023).abs() < 5e-7, "{k}");
    }

    #[test]
    fn the_observer_of_the_thesis_belongs_to_a_tenth_of_the_readings_noise() {
        let (a, _) = linearised().two_states();
        let c = matrix![1.0, 0.0];
        for v in [5.0, 0.2] {
            let l = kalman(&a, &c, &(SMatrix::identity() * (0.1 * v)), v).unwrap();
            assert!((l[0] - 0.4490204).abs() < 5e-8 && (l[1] - 0.0508097).abs() < 5e-8, "{l}");
        }
        let printed = kalman(&a, &c, &(SMatrix::identity() * 3.0), 5.0).unwrap();
        assert!((printed[0] - 1.0013).abs() < 5e-5 && (printed[1] - 0.2013).abs() < 5e-5, "{printed}");
    }

    #[test]
    fn a_double_integrator_has_the_closed_forms() {
        let (a, b) = (matrix![0.0, 1.0; 0.0, 0.0], vector![0.0, 1.0]);
        let k = lqr(&a, &b, &matrix![9.0, 0.0; 0.0, 0.0], 1.0).unwrap();
        assert!((k[0] - 3.0).abs() < 1e-12 && (k[1] - sqrt(6.0)).abs() < 1e-12, "{k}");
        // White acceleration: L = [√2·ω, ω²] with ω⁴ = W/V.
        let l = kalman(&a, &matrix![1.0, 0.0], &matrix![0.0, 0.0; 0.0, 16.0], 1.0).unwrap();
        assert!((l[0] - sqrt(2.0) * 2.0).abs() < 1e-12 && (l[1] - 4.0).abs() < 1e-12, "{l}");
    }

    #[test]
    fn the_sampled_designs_become_the_continuous_ones_as_the_period_shrinks() {
        let (a, b) = Linear::three_poles(827.2, 3.896, 3.896).three_states();
        let q = SMatrix::from_diagonal(&vector![1.0, 0.01, 0.0]);
        let w = SMatrix::from_diagonal(&vector![0.0, 360.0, 100.0]);
        let (c, t, v) = (matrix![1.0, 0.0, 0.0], 1e-4, 0.1);
        let over = discretise(&a, &b, &w, t);
        let (k, kd) =
            (lqr(&a, &b, &q, 100.0).unwrap(), sampled_lqr(&over.transition, &over.input, &(q * t), 100.0 * t).unwrap());
        assert!((k - kd).norm() < 1e-3 * k.norm(), "{k} and {kd}");
        let (l, ld) =
            (kalman(&a, &c, &w, v).unwrap(), sampled_kalman(&over.transition, &c, &over.noise, v / t).unwrap());
        assert!((l - ld / t).norm() < 2e-3 * l.norm(), "{l} and {ld}");
    }

    #[test]
    fn what_no_weight_sees_and_nothing_holds_has_no_solution() {
        // The position integrates and costs nothing: no feedback is best, and it does not decay.
        let (a, b) = linearised().two_states();
        assert!(lqr(&a, &b, &SMatrix::zeros(), 1.0).is_err());
        let over = discretise(&a, &b, &SMatrix::zeros(), 0.02);
        assert!(sampled_lqr(&over.transition, &over.input, &SMatrix::zeros(), 1.0).is_err());
    }

    #[test]
    fn a_filter_needs_noise_on_what_does_not_decay_and_none_on_what_does() {
        let c = matrix![1.0, 0.0];
        // A walk that is read, and a state beside it that shrinks by `kept` a sample.
        let gain = |kept: f64, noise: f64| {
            sampled_kalman(&matrix![1.0, 1.0; 0.0, kept], &c, &matrix![1.0, 0.0; 0.0, noise], 1.0)
        };
        for kept in [0.0, 0.5, -0.99] {
            let l = gain(kept, 0.0).unwrap();
            // p² = p + 1 for the walk alone: L = p/(p + 1) with the golden section p; what decays to 0 is known.
            let golden = (1.0 + sqrt(5.0)) / 2.0;
            assert!((l[0] - golden / (golden + 1.0)).abs() < 1e-12 && l[1].abs() < 1e-12, "{kept}: {l}");
        }
        assert!(gain(1.0, 0.0).is_err(), "a constant that was never known is not found by a steady gain");
        assert!(gain(1.0, 1e-12).is_ok() && gain(1.2, 1e-12).is_ok());
        assert!(gain(1.2, 0.0).is_err() && gain(f64::NAN, 1.0).is_err());
    }

    #[test]
    fn the_cost_to_go_is_a_fixed_point_and_the_covariance_is_what_the_running_filter_reaches() {
        let (a, b) = Linear::three_poles(827.2, 3.896, 3.896).three_states();
        let over = discretise(&a, &b, &matrix![0.0, 0.0, 0.0; 0.0, 360.0, 0.0; 0.0, 0.0, 0.0], 0.02);
        let (phi, gamma, q) = (over.transition, over.input, SMatrix::from_diagonal(&vector![2.5e-3, 2.5e-5, 0.0]));
        let x = cost_to_go(&phi, &gamma, &q, 6.25).unwrap();
        let k = sampled_lqr(&phi, &gamma, &q, 6.25).unwrap();
        assert!((q + phi.transpose() * x * (phi - gamma * k) - x).norm() < 1e-12 * x.norm(), "{x}");

        let c = matrix![1.0, 0.0, 0.0];
        let p = covariance(&phi, &c, &over.noise, 6.25).unwrap();
        let mut filter = Kalman { state: SVector::zeros(), covariance: SMatrix::identity() };
        for _ in 0..3000 {
            filter.update(0.0, &c, 6.25);
            let next = phi * filter.state;
            filter.predict(next, &phi, &over.noise);
        }
        assert!((filter.covariance - p).norm() < 1e-9 * p.norm(), "{p} {}", filter.covariance);
    }

    #[test]
    fn the_regulated_loop_is_stable_even_where_the_plant_is_not() {
        let (a, b) = Linear { gradient_per_s2: -20.0, ..Linear::three_poles(827.2, 1.0, 4.0) }.three_states();
        let k = lqr(&a, &b, &SMatrix::identity(), 1.0).unwrap();
        assert!(characteristic(&(a - b * k)).roots().iter().all(|pole| pole.re < 0.0));
    }
}

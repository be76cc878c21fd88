//! Pole placement of a state feedback by Ackermann's formula.
//!
//! ```text
//! u = K_r·r − K·x        K = [0 … 0 1]·[B AB … A^(n−1)B]⁻¹·p(A)       p: the polynomial with the wanted poles as roots
//! K_r = 1/( C·(B·K − A)⁻¹·B )                                          the position ends at the setpoint
//! ```
//!
//! Source: Åström & Murray, *Feedback Systems*, "State Feedback"; the thesis, section 4.2.

use super::error::DesignError;
use super::polynomial::Polynomial;
use nalgebra::{Complex, RowSVector, SMatrix, SVector};

/// K of the state feedback that gives ẋ = A·x + B·u (or x[n+1] = A·x + B·u) these poles.
///
/// # Errors
/// [`DesignError::UnpairedPoles`], [`DesignError::OutOfReach`].
pub fn ackermann<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    poles: &[Complex<f64>; N],
) -> Result<RowSVector<f64, N>, DesignError> {
    let wanted = Polynomial::with_roots(poles).ok_or(DesignError::UnpairedPoles)?;
    let mut reach = SMatrix::<f64, N, N>::zeros();
    let mut column = *b;
    for k in 0..N {
        reach.set_column(k, &column);
        column = a * column;
    }
    let inverse = reach.try_inverse().ok_or(DesignError::OutOfReach)?;
    let zero = SMatrix::<f64, N, N>::zeros();
    let of_a = wanted.ascending().iter().rev().fold(zero, |sum, c| sum * a + SMatrix::identity() * *c);
    let gain = inverse.row(N - 1) * of_a;
    if gain.iter().all(|k| k.is_finite()) { Ok(gain) } else { Err(DesignError::OutOfReach) }
}

/// K_r of a continuous feedback: the position, which is the first state, ends at the setpoint.
///
/// # Errors
/// [`DesignError::OutOfReach`]: the closed loop has no rest.
pub fn setpoint_gain<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    gain: &RowSVector<f64, N>,
) -> Result<f64, DesignError> {
    let rest = (b * gain - a).try_inverse().ok_or(DesignError::OutOfReach)? * b;
    if rest[0] == 0.0 { Err(DesignError::OutOfReach) } else { Ok(1.0 / rest[0]) }
}

/// The poles of A − B·K: the roots of det(x·I − A + B·K), by the recursion of Faddeev and Le Verrier.
#[must_use]
pub fn characteristic<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Polynomial {
    let mut coefficients = [0.0; super::polynomial::CAPACITY];
    coefficients[N] = 1.0;
    let mut power = SMatrix::<f64, N, N>::identity();
    for k in 1..=N {
        let moved = matrix * power;
        let c = -moved.trace() / k as f64;
        coefficients[N - k] = c;
        power = moved + SMatrix::identity() * c;
    }
    Polynomial::new(&coefficients[..=N])
}

#[cfg(test)]
mod tests {
    use super::{ackermann, characteristic, setpoint_gain};
    use crate::design::Linear;
    use crate::design::polynomial::magnitude;
    use nalgebra::Complex;

    /// The thesis' G after linearisation, with all the digits of its program.
    pub(crate) fn linearised() -> Linear {
        Linear::two_poles(0.5894041732678656, 0.7800118875890534)
    }

    #[test]
    fn the_thesis_poles_have_the_gains_of_the_thesis() {
        let (a, b) = linearised().two_states();
        let pair = |re: f64, im: f64| [Complex::new(re, im), Complex::new(re, -im)];
        for (poles, first, second) in [(pair(-0.78, 2.0), 7.8187, 1.32335), (pair(-0.8, 1.2), 3.52899, 1.39122)] {
            let k = ackermann(&a, &b, &poles).unwrap();
            assert!((k[0] - first).abs() < 5e-5 && (k[1] - second).abs() < 5e-6, "{k}");
            assert!((setpoint_gain(&a, &b, &k).unwrap() - k[0]).abs() < 1e-9, "an integrator needs K_r = k₁");
        }
    }

    #[test]
    fn the_closed_loop_has_the_poles_that_were_asked_for() {
        let (a, b) = Linear { gradient_per_s2: 4.0, ..Linear::three_poles(827.2, 3.896, 3.0) }.three_states();
        let poles = [Complex::new(-5.0, 0.0), Complex::new(-2.0, 1.5), Complex::new(-2.0, -1.5)];
        let k = ackermann(&a, &b, &poles).unwrap();
        let found = characteristic(&(a - b * k)).roots();
        for pole in poles {
            assert!(found.iter().any(|p| magnitude(p - pole) < 1e-9), "{pole} is not in {found:?}");
        }
    }

    #[test]
    fn the_position_ends_at_the_setpoint_where_the_lift_falls_with_height() {
        let plant = Linear { gradient_per_s2: 4.0, ..Linear::two_poles(100.0, 1.0) };
        let (a, b) = plant.two_states();
        let k = ackermann(&a, &b, &[Complex::new(-3.0, 0.0), Complex::new(-4.0, 0.0)]).unwrap();
        // At rest K·u = g·y with u = K_r·r − k₁·y.
        let kr = setpoint_gain(&a, &b, &k).unwrap();
        assert!((kr - (k[0] + 4.0 / 100.0)).abs() < 1e-12, "{kr}");
    }

    #[test]
    fn a_fan_without_effect_reaches_nothing() {
        let (a, b) = Linear::two_poles(0.0, 1.0).two_states();
        assert!(ackermann(&a, &b, &[Complex::new(-1.0, 0.0), Complex::new(-2.0, 0.0)]).is_err());
    }
}

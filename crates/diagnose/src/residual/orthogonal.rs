//! Orthonormal columns of the sensitivities to the fitted parameters, by the method of Gram and Schmidt.
//!
//! ```text
//! f' = f − Σ q_i·(q_i·f)       q_i: the columns of the basis
//! ```

/// Share of its square that a column must keep without its projection on others. Below that it is collinear with them.
pub(super) const LEAST_INDEPENDENT: f64 = 1e-3;

/// Orthonormal columns.
pub(super) struct Basis(Vec<Vec<f64>>);

impl Basis {
    /// The basis of these columns, without those that depend on earlier ones.
    pub(super) fn of(columns: impl Iterator<Item = Vec<f64>>) -> Self {
        let mut basis = Self(Vec::new());
        for column in columns {
            let before = dot(&column, &column);
            let mut left = basis.without_projection(column);
            let after = dot(&left, &left);
            if after > LEAST_INDEPENDENT * before && after.is_finite() {
                left.iter_mut().for_each(|value| *value /= after.sqrt());
                basis.0.push(left);
            }
        }
        basis
    }

    /// The products of a column with those of the basis.
    pub(super) fn products<'a>(&'a self, column: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.0.iter().map(|unit| dot(unit, column))
    }

    /// A column without its projection on the basis.
    pub(super) fn without_projection(&self, mut column: Vec<f64>) -> Vec<f64> {
        for unit in &self.0 {
            let share = dot(&column, unit);
            column.iter_mut().zip(unit).for_each(|(value, unit)| *value -= share * unit);
        }
        column
    }
}

/// The scalar product.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::Basis;

    #[test]
    fn a_dependent_column_adds_nothing_and_what_remains_is_orthogonal() {
        let columns = [[3.0, 0.0, 4.0], [6.0, 0.0, 8.0], [0.0, 2.0, 0.0]];
        let basis = Basis::of(columns.into_iter().map(Vec::from));
        assert_eq!(basis.products(&[3.0, 2.0, 4.0]).collect::<Vec<f64>>(), [5.0, 2.0]);
        let left = basis.without_projection(vec![4.0, 7.0, 3.0]);
        assert!(left.iter().zip([1.12, 0.0, -0.84]).all(|(left, exact)| (left - exact).abs() < 1e-12), "{left:?}");
    }
}

//! Scores of terms, summed row by row, and forward selection of the terms that explain most together.
//!
//! ```text
//! G = Σ f·fᵀ, b = Σ f·e               f: sensitivities to the parameters, then the lag forms, then the terms
//! G_jj + 1                             for a form: its size is normal with variance 1 in its own scale
//! z_j = b_j/√G_jj                      after the parameters and the forms have been swept out of G and b
//! nats(m) = −ln P(χ²_m > Σ z²) − ln C(n, m)          forward selection of m of n terms, each swept out in turn
//! ```
//!
//! Source: Goodnight, "A tutorial on the SWEEP operator", The American Statistician 33 (1979).

use crate::residual::orthogonal::LEAST_INDEPENDENT;
use crate::stats::chi_square::ln_chance;
use nalgebra::{DMatrix, DVector};

/// Largest number of selected terms.
const MOST: usize = 6;

/// Sums of products of the columns and of the innovations.
pub(super) struct Scores {
    gram: DMatrix<f64>,
    by: DVector<f64>,
    own: usize,
    forms: usize,
    /// The diagonal of G before anything was swept out.
    before: DVector<f64>,
}

/// A selected term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SelectedTerm {
    /// Its index among the terms.
    pub(super) term: usize,
    /// Its score given the terms before it, standard deviations.
    pub(super) z: f64,
    /// −ln of the joint probability of its score and those before it.
    pub(super) nats: f64,
}

impl Scores {
    /// Empty sums for `own` parameters, `forms` of standard deviation 1, and `terms`.
    pub(super) fn new(own: usize, forms: usize, terms: usize) -> Self {
        let width = own + forms + terms;
        let zeros = DVector::zeros(width);
        Self { gram: DMatrix::zeros(width, width), by: zeros.clone(), own, forms, before: zeros }
    }

    /// The index of the first term.
    fn first(&self) -> usize {
        self.own + self.forms
    }

    /// Adds a row and its innovation.
    pub(super) fn add(&mut self, row: &DVector<f64>, innovation: f64) {
        self.gram.syger(1.0, row, row, 1.0);
        self.by.axpy(innovation, row, 1.0);
    }

    /// Sweeps out the parameters and the forms. Returns the nats that they explain.
    pub(super) fn settle(&mut self) -> f64 {
        self.gram.fill_upper_triangle_with_lower_triangle();
        (self.own..self.first()).for_each(|j| self.gram[(j, j)] += 1.0);
        self.before = self.gram.diagonal();
        let mut explained = 0.0;
        for j in 0..self.first() {
            if self.is_independent(j) {
                explained += 0.5 * self.by[j].powi(2) / self.gram[(j, j)];
                self.sweep(j);
            }
        }
        explained
    }

    /// Whether a column is independent of those swept out.
    fn is_independent(&self, j: usize) -> bool {
        self.gram[(j, j)] > LEAST_INDEPENDENT * self.before[j]
    }

    /// Forward selection of terms, after [`Scores::settle`]. `variance` of the innovations; `weight`: weight of each
    /// row; `behind`: nats that the terms must gain first.
    pub(super) fn selected(mut self, variance: f64, weight: f64, behind: f64) -> Vec<SelectedTerm> {
        let mut left: Vec<usize> = (self.first()..self.by.len()).filter(|j| self.is_independent(*j)).collect();
        let terms = left.len() as f64;
        let (mut selected, mut total, mut ways) = (Vec::new(), -2.0 * weight * behind, 0.0);
        while selected.len() < MOST {
            let z = |j: usize| self.by[j] / (variance * self.gram[(j, j)]).sqrt();
            let Some(j) = left.iter().copied().max_by(|a, b| z(*a).abs().total_cmp(&z(*b).abs())) else { break };
            let (z, m) = (z(j) * weight.sqrt(), selected.len());
            total += z * z;
            ways += ((terms - m as f64) / (m as f64 + 1.0)).ln();
            selected.push(SelectedTerm {
                term: j - self.first(),
                z,
                nats: -ln_chance(total.max(f64::MIN_POSITIVE), m + 1) - ways,
            });
            self.sweep(j);
            left.retain(|other| *other != j && self.is_independent(*other));
        }
        selected
    }

    /// Sweeps column `j` out of all others.
    fn sweep(&mut self, j: usize) {
        let (column, b) = (self.gram.column(j).into_owned(), self.by[j]);
        let pivot = column[j];
        self.by.axpy(-b / pivot, &column, 1.0);
        self.gram.ger(-1.0 / pivot, &column, &column, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::Scores;
    use nalgebra::DVector;
    use plant::Normal;

    /// Rows of independent normal terms. The innovation has `shares` of the first terms and unit noise. Column 0 is a
    /// parameter.
    fn selected(shares: &[f64], seed: u64) -> Vec<super::SelectedTerm> {
        let (terms, mut normal) = (40, Normal::new(seed, 3));
        let mut scores = Scores::new(1, 0, terms - 1);
        for _ in 0..2000 {
            let row = DVector::from_fn(terms, |_, _| normal.draw());
            let e = normal.draw() + shares.iter().zip(row.iter()).map(|(share, f)| share * f).sum::<f64>();
            scores.add(&row, e);
        }
        scores.settle();
        scores.selected(1.0, 1.0, 0.0)
    }

    #[test]
    fn nothing_is_asked_for_by_noise_nor_for_what_the_model_can_do_itself() {
        for seed in 0..40 {
            let most = selected(&[0.5], seed).iter().map(|selected| selected.nats).fold(0.0, f64::max);
            assert!(most < 6.0, "seed {seed}: {most} nats");
        }
    }

    #[test]
    fn two_terms_that_act_are_asked_for_with_the_scores_of_their_shares() {
        let selected = selected(&[0.5, 0.2, -0.15], 1);
        let found: Vec<usize> = selected.iter().take(2).map(|selected| selected.term).collect();
        assert_eq!(found, [0, 1]);
        // z = share·√rows.
        assert!((selected[0].z - 0.2 * 2000_f64.sqrt()).abs() < 4.0, "{}", selected[0].z);
        assert!((selected[1].z + 0.15 * 2000_f64.sqrt()).abs() < 4.0, "{}", selected[1].z);
        assert!(selected[1].nats > selected[0].nats && selected[0].nats > 20.0);
    }

    #[test]
    fn a_form_takes_from_a_term_what_is_within_its_scale_and_leaves_what_is_far_beyond() {
        // Column 0 is the form, with a fifth of the noise as its scale. The first term is nearly collinear with it.
        let most = |share: f64, seed: u64| {
            let (mut scores, mut normal) = (Scores::new(0, 1, 30), Normal::new(seed, 4));
            for _ in 0..2000 {
                let mut row = DVector::from_fn(31, |_, _| normal.draw());
                row[1] = row[0] + 0.1 * row[1];
                row[0] *= 0.2;
                let e = normal.draw() + share * row[0];
                scores.add(&row, e);
            }
            scores.settle();
            scores.selected(1.0, 1.0, 0.0).first().map_or(0.0, |selected| selected.nats)
        };
        for seed in 0..20 {
            assert!(most(1.0, seed) < 6.0, "seed {seed}: {} nats", most(1.0, seed));
        }
        assert!(most(1.0, 1) < 6.0 && most(12.0, 1) > 30.0, "{} nats", most(12.0, 1));
    }
}

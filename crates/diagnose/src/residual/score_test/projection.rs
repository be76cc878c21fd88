//! Scores of single forces, orthogonal to the effects of a model's fitted parameters.
//!
//! ```text
//! q_i           orthonormal columns of the sensitivities of the expected readings to the parameters: Gram–Schmidt
//! e' = e − Σ q_i·(q_i·e)
//! z² = (f·e')²/(f·f − Σ (q_i·f)²)             f: sensitivity of the expected readings to the force
//! ```

use super::scores::LEAST_INDEPENDENT;
use super::sensitivities::{FilterRun, Step};
use crate::filter::ekf::Sensitivity;

/// The innovations of a filter run without the part that the fitted parameters explain.
pub(crate) struct ProjectedInnovations<'a> {
    run: &'a FilterRun,
    own: Vec<Vec<f64>>,
    innovations: Vec<f64>,
}

impl<'a> ProjectedInnovations<'a> {
    pub(crate) fn of(run: &'a FilterRun) -> Self {
        let column = |of: &dyn Fn(usize, &Step) -> f64| -> Vec<f64> {
            let values = run.steps.iter().enumerate();
            values.map(|(k, step)| if counts(step) { of(k, step) } else { 0.0 }).collect()
        };
        let mut own: Vec<Vec<f64>> = Vec::new();
        for numbers in &run.own {
            let mut left = column(&|k, step| step.root_weight() * numbers[k]);
            let before = dot(&left, &left);
            own.iter().for_each(|other| subtract_projection(&mut left, other));
            let after = dot(&left, &left);
            if after > LEAST_INDEPENDENT * before && after.is_finite() {
                left.iter_mut().for_each(|value| *value /= after.sqrt());
                own.push(left);
            }
        }
        let mut innovations = column(&|_, step| step.innovation.standardised / step.root_weight());
        own.iter().for_each(|other| subtract_projection(&mut innovations, other));
        Self { run, own, innovations }
    }

    /// z² of a force. `push` gives its value before each reading, mm/s², from the number of the reading and the seconds
    /// since the previous one.
    pub(crate) fn score(&self, mut push: impl FnMut(usize, f64) -> f64) -> f64 {
        let mut nudged = Sensitivity::zero();
        let column = self.run.steps.iter().enumerate().map(|(k, step)| {
            let Some(dt) = step.dt else {
                nudged = Sensitivity::zero();
                return 0.0;
            };
            let moved_mm = nudged.go(&step.leg, (dt, push(k, dt), 0.0), &step.innovation);
            if counts(step) { step.root_weight() * moved_mm / step.innovation.variance_mm2.sqrt() } else { 0.0 }
        });
        let column: Vec<f64> = column.collect();
        let whole = dot(&column, &column);
        let square = whole - self.own.iter().map(|own| dot(own, &column).powi(2)).sum::<f64>();
        // NaN compares as false: a score that is undefined counts as 0.
        if square > LEAST_INDEPENDENT * whole { dot(&column, &self.innovations).powi(2) / square } else { 0.0 }
    }
}

fn counts(step: &Step) -> bool {
    step.judged && step.has_weight()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Subtracts from `column` its projection on `unit`.
fn subtract_projection(column: &mut [f64], unit: &[f64]) {
    let share = dot(column, unit);
    column.iter_mut().zip(unit).for_each(|(value, unit)| *value -= share * unit);
}

//! Forward selection of terms by the held-out error of a linear regression.
//!
//! ```text
//! e = Σ c_i·r_i + own parameters         e: innovations, r: sensitivities of the expected readings to the terms
//! gain = Σ over blocks of e² − (e − r·c)², halved, c from the other blocks
//! ```
//!
//! The sums of each block are kept, so that a candidate costs the solution of small systems.

use super::dictionary::{FormTerm, MEMORY};
use crate::fit::estimate::Problem;
use crate::residual::score_test::{Before, FilterRun};
use crate::thresholds::TERM_OF_A_FORM;
use formula::Formula;
use nalgebra::{DMatrix, DVector};
use std::array::from_fn;

/// The most terms.
const MOST: usize = 4;
/// Variances beside which a column's own is 0, as a share of it.
const RIDGE: f64 = 1e-6;

/// A term that was chosen, with its coefficient in the regression, mm/s².
#[derive(Clone, Copy, Debug)]
pub(super) struct Selected {
    pub(super) term: usize,
    pub(super) coefficient: f64,
}

/// The blocks of the record that are held out in turn: long, and one after the other, so that what is common to a block
/// by chance is not in the others.
const BLOCKS: usize = 8;
/// A term gains in so many blocks at least, and loses in one at most; by so many nats.
const GAINS_IN: usize = 3;
const NOTABLE: f64 = 1.0;

/// The sums of a regression: products of the columns, and of the columns with the innovations.
#[derive(Clone)]
struct Sums {
    gram: DMatrix<f64>,
    by: DVector<f64>,
}

/// Held-out gain by block, nats.
type GainByBlock = [f64; BLOCKS];

/// The regression of innovations on the parameters of a fit and on terms, by block.
pub(super) struct Regression {
    blocks: [Sums; BLOCKS],
    whole: Sums,
    /// The columns of the fit come first.
    own: usize,
}

impl Regression {
    pub(super) fn of(problem: &Problem<'_>, run: &FilterRun, terms: &[FormTerm]) -> Self {
        let own = run.columns_before();
        let width = own + terms.len();
        let zeros = Sums { gram: DMatrix::zeros(width, width), by: DVector::zeros(width) };
        let mut blocks: [Sums; BLOCKS] = from_fn(|_| zeros.clone());
        let mut values = Values::of(problem, terms);
        let rows = problem.recording.samples().len().max(1);
        run.of_forces(
            terms.len(),
            |before, forces| values.at(before, forces),
            |row, columns, innovation| {
                let block = &mut blocks[row * BLOCKS / rows];
                block.gram.syger(1.0, columns, columns, 1.0);
                block.by.axpy(innovation, columns, 1.0);
            },
        );
        let mut whole = zeros;
        for block in &mut blocks {
            block.gram.fill_upper_triangle_with_lower_triangle();
            whole.gram += &block.gram;
            whole.by += &block.by;
        }
        Self { blocks, whole, own }
    }

    /// The terms that gain, the first one the most, and the held-out gain, nats; `states`: how many of them may have
    /// memory.
    pub(super) fn selected(&self, terms: &[FormTerm], states: usize) -> (Vec<Selected>, f64) {
        let mut columns: Vec<usize> = (0..self.own).collect();
        let mut best = self.held_out_gain(&columns).unwrap_or([0.0; BLOCKS]);
        while columns.len() - self.own < MOST {
            let with_memory = columns[self.own..].iter().filter(|at| terms[**at - self.own].memory.is_some()).count();
            let may =
                |at: &usize| !columns.contains(at) && (terms[*at - self.own].memory.is_none() || with_memory < states);
            let tried = (self.own..self.own + terms.len()).filter(may).filter_map(|at| {
                let with = [&columns[..], &[at]].concat();
                let gain = self.held_out_gain(&with)?;
                is_stable(&gain, &best).then_some((at, gain))
            });
            match tried.max_by(|a, b| total(&a.1).total_cmp(&total(&b.1))) {
                Some((at, gain)) if total(&gain) > total(&best) + TERM_OF_A_FORM => {
                    columns.push(at);
                    best = gain;
                }
                _ => break,
            }
        }
        let Some(solved) = solved(&self.whole, &columns) else { return (Vec::new(), 0.0) };
        let chosen = columns.iter().zip(solved.iter()).skip(self.own);
        let chosen = chosen.map(|(at, coefficient)| Selected { term: at - self.own, coefficient: *coefficient });
        (chosen.collect(), total(&best))
    }

    /// Half of what the squared innovations of each block lose by the coefficients of the others, nats.
    fn held_out_gain(&self, columns: &[usize]) -> Option<GainByBlock> {
        let mut gain = [0.0; BLOCKS];
        let whole = part(&self.whole, columns);
        for (gain, block) in gain.iter_mut().zip(&self.blocks) {
            let block = part(block, columns);
            let c = coefficients(Sums { gram: &whole.gram - &block.gram, by: &whole.by - &block.by })?;
            *gain = block.by.dot(&c) - 0.5 * (&block.gram * &c).dot(&c);
        }
        Some(gain)
    }
}

fn total(gain: &GainByBlock) -> f64 {
    gain.iter().sum()
}

/// Whether a gain over another one is not that of single blocks.
fn is_stable(gain: &GainByBlock, over: &GainByBlock) -> bool {
    let more = || gain.iter().zip(over).map(|(gain, over)| gain - over);
    more().filter(|more| *more > NOTABLE).count() >= GAINS_IN && more().filter(|more| *more < -NOTABLE).count() <= 1
}

/// The sums of some columns.
fn part(sums: &Sums, columns: &[usize]) -> Sums {
    let gram = DMatrix::from_fn(columns.len(), columns.len(), |i, j| sums.gram[(columns[i], columns[j])]);
    Sums { gram, by: DVector::from_fn(columns.len(), |i, _| sums.by[columns[i]]) }
}

/// The coefficients of some columns.
fn solved(sums: &Sums, columns: &[usize]) -> Option<DVector<f64>> {
    coefficients(part(sums, columns))
}

fn coefficients(Sums { mut gram, by }: Sums) -> Option<DVector<f64>> {
    for i in 0..gram.nrows() {
        gram[(i, i)] *= 1.0 + RIDGE;
    }
    Some(gram.cholesky()?.solve(&by))
}

/// The values of the terms along a record.
struct Values<'a> {
    problem: Problem<'a>,
    terms: Vec<(Formula, Option<(Formula, f64)>)>,
    states: Vec<f64>,
    /// The flight that the states belong to.
    flight: usize,
}

impl<'a> Values<'a> {
    fn of(problem: &Problem<'a>, terms: &[FormTerm]) -> Self {
        let read = |text: &str| Formula::parse(text, &["x", "v", "u", MEMORY]);
        let parsed = terms.iter().filter_map(|term| {
            let memory = match &term.memory {
                Some(memory) => Some((read(&memory.of).ok()?, memory.time_constant_s)),
                None => None,
            };
            Some((read(&term.value).ok()?, memory))
        });
        let terms: Vec<_> = parsed.collect();
        Self { problem: *problem, states: vec![0.0; terms.len()], terms, flight: usize::MAX }
    }

    /// Writes the values before a reading, mm/s² by coefficient.
    fn at(&mut self, before: &Before, forces: &mut [f64]) {
        let flight = self.problem.recording.flight_of(before.row).start;
        let is_new = std::mem::replace(&mut self.flight, flight) != flight;
        let duty = self.problem.recording.samples()[before.row].duty_percent;
        let at = [before.height_mm, before.velocity_mm_per_s, duty - self.problem.belief.hover_duty_percent];
        for ((force, state), (value, memory)) in forces.iter_mut().zip(&mut self.states).zip(&self.terms) {
            if let Some((of, time_constant_s)) = memory {
                let towards = of.value(&at);
                let share = if is_new { 1.0 } else { -(-before.dt_s / time_constant_s).exp_m1() };
                *state += share * (towards - *state);
            }
            *force = value.value(&[at[0], at[1], at[2], *state]);
        }
    }
}

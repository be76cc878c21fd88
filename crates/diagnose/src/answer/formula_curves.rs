//! The terms of a formula as curves over the signal that they depend on, with bands.
//!
//! ```text
//! band = ± 1.645·√(gᵀ·C·g)        g: gradient of the term by its parameters, C: their covariance
//! ```

use crate::answer::diagnosis::Diagnosis;
use crate::fit::profile::OF_90_PERCENT;
use plant::{Conditions, Definition, Model, Stage};

/// A signal that a term may be drawn over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Duty, percent.
    Duty,
    /// Height, mm.
    Height,
    /// Speed, mm/s.
    Speed,
}

/// A term over the one signal that it depends on.
#[derive(Clone, Debug)]
pub struct FormulaCurve {
    /// The signal.
    pub over: Over,
    /// Where it acts.
    pub stage: Stage,
    /// What it is, in words.
    pub words: &'static str,
    /// The signal, what the term adds there, and the ends of its 90 % band.
    pub points: Vec<[f64; 4]>,
}

/// Points of a curve.
const POINTS: u32 = 120;

impl Over {
    /// The signals, in the order of the ranges of [`Diagnosis::formula_curves`].
    pub const ALL: [Self; 3] = [Self::Duty, Self::Height, Self::Speed];

    /// The conditions of a ball at rest at mid-pipe and hover, but for this signal.
    fn at(self, model: &Model, value: f64) -> Conditions {
        let rest = model.conditions();
        let rest = Conditions { position_mm: rest.middle_mm, ..rest };
        let force = (value - rest.hover_duty_percent) * rest.gain_mm_per_s2_per_percent;
        match self {
            Self::Duty => Conditions { commanded_mm_per_s2: force, fan_mm_per_s2: force, ..rest },
            Self::Height => Conditions { position_mm: value, ..rest },
            Self::Speed => Conditions { velocity_mm_per_s: value, ..rest },
        }
    }
}

impl Diagnosis {
    /// The terms that depend on one signal alone, drawn over the range seen of it: of duty, height and speed.
    #[must_use]
    pub fn formula_curves(&self, ranges: [(f64, f64); 3]) -> Vec<FormulaCurve> {
        let of = |shape: &&'static Definition| {
            let mut all = Over::ALL.into_iter().zip(ranges).filter_map(|(over, range)| self.curve(shape, over, range));
            all.next().filter(|_| shape.table().states.is_empty() && all.next().is_none())
        };
        self.formula.iter().filter_map(of).collect()
    }

    /// A term over a signal; `None` if it does not depend on it.
    fn curve(&self, shape: &'static Definition, over: Over, (from, to): (f64, f64)) -> Option<FormulaCurve> {
        let model = &self.mended.model;
        let added = |by: &Model, at: f64| {
            let values = by.effects.values(shape.entry().name).unwrap_or_default();
            shape.adds_with(&values, &over.at(model, at))
        };
        let points = (0..=POINTS).map(|k| {
            let at = from + (to - from) * f64::from(k) / f64::from(POINTS);
            let (value, reach) = (added(model, at), OF_90_PERCENT * self.mended.deviation_of(|by| added(by, at)));
            [at, value, value - reach, value + reach]
        });
        let points: Vec<[f64; 4]> = points.collect();
        let depends = points.iter().any(|point| (point[1] - points[0][1]).abs() > 1e-9);
        depends.then_some(FormulaCurve { over, stage: shape.table().stage, words: &shape.table().looks, points })
    }
}

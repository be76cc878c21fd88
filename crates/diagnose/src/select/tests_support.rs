//! For tests of the search: rigs whose effect is not in the catalogue, rigs in closed loop with equations of their own,
//! and the options of a search for few effects.

use crate::options::Options;
use crate::random_for_tests::uniform;
use crate::tests_support::model;
use crate::{Recording, Sample};
use plant::{Definition, DefinitionTable, Effects, Model, ParameterTable, Stage};

/// Options of a search for these effects alone, without a formula: few are sought, because that is quicker.
pub(crate) fn seeking(sought: &[&str]) -> Options {
    let others = Effects::CATALOGUE.iter().map(|entry| entry.name).filter(|name| !sought.contains(name));
    Options { without: others.map(str::to_owned).collect(), without_formula: true, ..Options::default() }
}

/// Integration step of a rig in closed loop, seconds.
pub(crate) const STEP_S: f64 = 1e-3;

/// A PD controller with a setpoint that is drawn anew every 3 s, and the sensor of its rig.
pub(crate) struct ClosedLoop {
    pub(crate) seed: u32,
    /// The middle of the setpoints, where the rig starts, and their range, mm.
    pub(crate) middle_mm: f64,
    pub(crate) range_mm: f64,
    /// A reading has the sum of so many uniform numbers of this range, mm, as noise.
    pub(crate) noise_draws: u32,
    pub(crate) noise_mm: f64,
    /// The duty at the setpoint, percent; percent per mm, and percent per mm/s.
    pub(crate) hover_percent: f64,
    pub(crate) proportional: f64,
    pub(crate) derivative: f64,
}

impl ClosedLoop {
    /// 60 s at 50 Hz of a rig that is at rest first. `step`: position and velocity a step later, from these and the
    /// duty.
    pub(crate) fn record(&self, mut step: impl FnMut([f64; 2], f64) -> [f64; 2]) -> Recording {
        let mut uniform = uniform(self.seed);
        let (mut state, mut setpoint, mut last, mut slope) =
            ([self.middle_mm, 0.0], self.middle_mm, self.middle_mm, 0.0);
        let rows = (0..3000_u32).map(|k| {
            if k % 150 == 0 {
                setpoint = self.middle_mm + self.range_mm * uniform();
            }
            let reading: f64 = state[0] + self.noise_mm * (0..self.noise_draws).map(|_| uniform()).sum::<f64>();
            slope += 0.3 * ((reading - last) / 0.02 - slope);
            last = reading;
            let command = self.hover_percent + self.proportional * (setpoint - reading) - self.derivative * slope;
            let duty_percent: f64 = command.clamp(0.0, 100.0);
            for _ in 0..20 {
                state = step(state, duty_percent);
            }
            Sample { time_s: 0.02 * f64::from(k), duty_percent, position_mm: Some(reading), ..Sample::default() }
        });
        Recording::new(rows.collect()).unwrap()
    }
}

/// 60 s of a ball behind a lag, ẍ = K·a − d·ẋ, ȧ = (u − a)/τ, whose duty is excited by four sines; `tau_s` from the
/// duty about hover and the time.
pub(crate) fn lagging(seed: u32, tau_s: impl Fn(f64, f64) -> f64) -> Recording {
    let (rig, mut uniform) = (model(), uniform(seed));
    let [mut x, mut v, mut acts] = [300.0, 0.0, 0.0];
    let rows = (0..3000_u32).map(|k| {
        let time_s = 0.02 * f64::from(k);
        let reading = x + 5.0 * (0..3).map(|_| uniform()).sum::<f64>();
        let shake: f64 = [3.1_f64, 5.3, 8.9, 13.7].iter().map(|turns| (turns * time_s).sin()).sum();
        let u = 0.01 * (300.0 - reading) + 1.2 * shake;
        for _ in 0..20 {
            acts += STEP_S * (u - acts) / tau_s(u, time_s);
            v += STEP_S * (rig.gain_mm_per_s2_per_percent * acts - rig.drag_per_s * v);
            x += STEP_S * v;
        }
        let duty_percent = rig.hover_duty_percent + u;
        Sample { time_s, duty_percent, position_mm: Some(reading), ..Sample::default() }
    });
    Recording::new(rows.collect()).unwrap()
}

/// A rig with a force of this size and form that no effect of the catalogue has.
pub(super) fn with_force(adds: &str, size: f64) -> Model {
    let range =
        ParameterTable { neutral: Some(0.0), value: None, scale: None, low: -500.0, high: 500.0, unit: String::new() };
    let table = DefinitionTable {
        stage: Stage::Air,
        adds: adds.into(),
        looks: String::new(),
        mend: String::new(),
        parameters: [("size".into(), range)].into(),
        states: [].into(),
    };
    let mut rig = model();
    rig.effects.written.define(Definition::new("strange_force", &table).unwrap());
    rig.effects.set("strange_force", &[size]);
    rig
}

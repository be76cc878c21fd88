//! The critical gain from setpoint steps at rising gains of a proportional-integral controller, and the critical
//! integral time from steps at falling ones.
//!
//! ```text
//! law       Δu = K_p·Δe + (K_p/T_i)·e·dt                    from the log: exact if nothing else acts
//! step      e = c + d·t + e^(σt)·(A·cos ωt + B·sin ωt)      σ: growth rate, negative for a stable loop
//! K_u       zero of σ = α + β·x + γ·x², x = ln K_p          weighted parabola; var x = var σ/(∂σ/∂x)² at the zero
//! T_i       the same with x = −ln T_i, at one K_p
//! ```
//!
//! The parabola uses the steps near the critical gain, with |σ| small against ω. Their scatter about it is the error,
//! whatever its cause: noise that excites the oscillation, air, limits of the fan. A straight line would be 0.7 % low
//! for a fan that is fast against the ball. A dead zone damps small oscillations, and a limit sustains large ones: the
//! gain holds for oscillations of this amplitude.
//! Sources: root locus and logarithmic decrement, Åström & Murray, *Feedback Systems*; the interval: the delta method.

use super::optimum::maximise;
use super::{Estimate, MeasureError};
use crate::record::recording::{Recording, Sample};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use serde::Serialize;

/// Smallest step of the setpoint, mm.
const JUMP_MM: f64 = 20.0;
/// Rows from which the control law is determined, and the largest deviation of the others, as a share of Δu.
const LAW_ROWS: usize = 25;
const EXACT: f64 = 1e-3;
/// Steps of no controller, in any unit: their squares must be finite.
const LARGEST: f64 = 1e100;
/// The fast poles have decayed after this time, seconds, with a slow integral and with a fast one, which leaves a pole
/// of the ball's drag; and the shortest oscillation after it.
const SKIP_S: f64 = 0.8;
const SKIP_OF_TIME_S: f64 = 2.5;
const SHORTEST_S: f64 = 3.0;
/// Largest growth rate of a usable step, as a share of ω, and the smallest number of steps.
const NEAR: f64 = 0.1;
const FEWEST: usize = 6;
/// Range of initial frequencies, rad/s, and their number.
const SLOWEST: f64 = 0.6;
const FASTEST: f64 = 20.0;
const PLACES: u32 = 100;

/// The result of steps at rising gains.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Critical {
    /// K_u, percent of duty per mm.
    pub kp_per_mm: Estimate,
    /// T_i of the controller, seconds.
    pub ti_s: f64,
    /// The frequency of the oscillation at the critical gain, rad/s.
    pub omega: f64,
    /// All steps with an oscillation.
    pub swings: Vec<Swing>,
}

/// The result of steps at falling integral times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CriticalTime {
    /// The integral time below which the loop no longer comes to rest, seconds.
    pub ti_s: Estimate,
    /// K_p of the controller, percent of duty per mm.
    pub kp_per_mm: f64,
    /// The frequency of the oscillation there, rad/s.
    pub omega: f64,
    /// All steps with an oscillation.
    pub swings: Vec<Swing>,
}

/// A step and the oscillation after it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Swing {
    /// Time of the step, seconds.
    pub time_s: f64,
    /// K_p, percent of duty per mm.
    pub kp_per_mm: f64,
    /// T_i, seconds.
    pub ti_s: f64,
    /// σ, 1/s.
    pub growth_per_s: f64,
    /// ω, rad/s.
    pub omega: f64,
    /// Standard deviation of σ for white residuals, 1/s, used as a weight.
    #[serde(skip)]
    deviation: f64,
}

/// The critical gain in a recording.
///
/// # Errors
/// [`MeasureError::NoSwing`]: no step has an oscillation. [`MeasureError::NotCritical`] describes the steps that were
/// found.
pub fn critical(recording: &Recording) -> Result<Critical, MeasureError> {
    let Crossed { at, ti_s, omega, swings, .. } = crossed(recording, Varied::Gain, |swing| swing.kp_per_mm.ln())?;
    let Estimate { value, low, high } = at;
    let kp_per_mm = Estimate { value: value.exp(), low: low.exp(), high: high.exp() };
    Ok(Critical { kp_per_mm, ti_s, omega, swings })
}

/// The critical integral time in a recording.
///
/// # Errors
/// As [`critical`].
pub fn critical_time(recording: &Recording) -> Result<CriticalTime, MeasureError> {
    let Crossed { at, kp_per_mm, omega, swings, .. } = crossed(recording, Varied::Time, |swing| -swing.ti_s.ln())?;
    let Estimate { value, low, high } = at;
    let ti_s = Estimate { value: (-value).exp(), low: (-high).exp(), high: (-low).exp() };
    Ok(CriticalTime { ti_s, kp_per_mm, omega, swings })
}

/// What steps vary on their way to instability.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varied {
    /// The proportional gain, which rises.
    Gain,
    /// The integral time, which falls.
    Time,
}

impl Varied {
    const fn skip_s(self) -> f64 {
        match self {
            Self::Gain => SKIP_S,
            Self::Time => SKIP_OF_TIME_S,
        }
    }

    pub(super) const fn experiment(self) -> &'static str {
        match self {
            Self::Gain => "experiments/critical-gain.toml",
            Self::Time => "experiments/critical-time.toml",
        }
    }

    pub(super) const fn further(self) -> &'static str {
        match self {
            Self::Gain => "higher gains",
            Self::Time => "shorter integral times",
        }
    }
}

/// Where swings no longer die.
struct Crossed {
    /// In the unit of what is varied.
    at: Estimate,
    /// Of the step that is nearest to it.
    kp_per_mm: f64,
    ti_s: f64,
    omega: f64,
    swings: Vec<Swing>,
}

/// Varies `by`, which rises towards the critical value.
fn crossed(recording: &Recording, what: Varied, by: fn(&Swing) -> f64) -> Result<Crossed, MeasureError> {
    let swings: Vec<Swing> = recording
        .flights()
        .iter()
        .flat_map(|flight| stretches(&recording.samples()[flight.clone()]))
        .filter_map(|stretch| stretch.swing(what.skip_s()))
        .filter(|swing| by(swing).is_finite())
        .collect();
    if swings.is_empty() {
        return Err(MeasureError::NoSwing { needed: FEWEST, what });
    }
    let near: Vec<Swing> = swings.iter().filter(|s| s.growth_per_s.abs() < NEAR * s.omega).copied().collect();
    let growths = || swings.iter().map(|swing| swing.growth_per_s);
    let refused = MeasureError::NotCritical {
        what,
        found: near.len(),
        needed: FEWEST,
        slowest: growths().fold(f64::INFINITY, f64::min),
        fastest: growths().fold(f64::NEG_INFINITY, f64::max),
    };
    if near.len() < FEWEST || !near.iter().any(|s| s.growth_per_s > 0.0) {
        return Err(refused);
    }
    let at = crossing(&near, by).ok_or(refused)?;
    let closest = near.iter().min_by(|a, b| a.growth_per_s.abs().total_cmp(&b.growth_per_s.abs()));
    Ok(Crossed {
        at,
        kp_per_mm: closest.map_or(0.0, |swing| swing.kp_per_mm),
        ti_s: closest.map_or(f64::INFINITY, |swing| swing.ti_s),
        omega: closest.map_or(0.0, |swing| swing.omega),
        swings,
    })
}

/// Where the weighted parabola of σ over `by` crosses zero upwards; `None` if not between the steps.
fn crossing(near: &[Swing], by: fn(&Swing) -> f64) -> Option<Estimate> {
    let middle = near.iter().map(by).sum::<f64>() / near.len() as f64;
    let powers = |x: f64| Vector3::new(1.0, x, x * x);
    let mut normal = Matrix3::zeros();
    let mut right = Vector3::zeros();
    let points = || near.iter().map(|s| (powers(by(s) - middle), s.growth_per_s, s.deviation.powi(-2)));
    for (row, growth, weight) in points() {
        normal += row * row.transpose() * weight;
        right += row * (weight * growth);
    }
    let inverse = normal.try_inverse()?;
    let law = inverse * right;
    let misfit: f64 = points().map(|(row, growth, weight)| weight * (growth - law.dot(&row)).powi(2)).sum();
    let freedom = near.len() as f64 - 3.0;
    // The zero with a rising σ, without cancellation if the parabola is nearly a line.
    let root = (law[1] * law[1] - 4.0 * law[0] * law[2]).sqrt();
    let zero = -2.0 * law[0] / (law[1] + root);
    let variance = misfit / freedom * (powers(zero).transpose() * inverse * powers(zero))[0] / (root * root);
    let places = || near.iter().map(|s| by(s) - middle);
    let among = places().any(|x| x <= zero) && places().any(|x| x >= zero);
    (among && root > 0.0).then(|| Estimate::student(middle + zero, variance.sqrt(), freedom))
}

/// A row with all inputs of the control law.
#[derive(Clone, Copy)]
struct Row {
    time_s: f64,
    setpoint: f64,
    error: f64,
    control: f64,
    duration_s: f64,
}

/// A setpoint step and the rows after it that follow one proportional-integral law.
struct Stretch {
    rows: Vec<Row>,
    kp_per_mm: f64,
    ti_s: f64,
}

fn stretches(samples: &[Sample]) -> Vec<Stretch> {
    let mut before_s = None;
    let rows: Vec<Row> = samples
        .iter()
        .filter_map(|sample| {
            let (setpoint, position) = (sample.setpoint_mm?, sample.position_mm?);
            let duration_s = sample.time_s - before_s.replace(sample.time_s).unwrap_or(sample.time_s);
            let control = sample.control_percent?;
            Some(Row { time_s: sample.time_s, setpoint, error: setpoint - position, control, duration_s })
        })
        .collect();
    let jumps = (1..rows.len()).filter(|&k| (rows[k].setpoint - rows[k - 1].setpoint).abs() >= JUMP_MM);
    jumps.filter_map(|start| Stretch::from(&rows[start..])).collect()
}

impl Stretch {
    fn from(rows: &[Row]) -> Option<Self> {
        let setpoint = rows.first()?.setpoint;
        let held = rows.iter().take_while(|row| row.setpoint == setpoint).count();
        let steps: Vec<[f64; 3]> = rows[..held]
            .windows(2)
            .map(|pair| {
                [pair[1].error - pair[0].error, pair[0].error * pair[0].duration_s, pair[1].control - pair[0].control]
            })
            .collect();
        let first = steps.get(..LAW_ROWS).filter(|rows| rows.iter().flatten().all(|step| step.abs() < LARGEST))?;
        let inputs = DMatrix::from_fn(LAW_ROWS, 2, |row, column| first[row][column]);
        let outputs = DVector::from_fn(LAW_ROWS, |row, _| first[row][2]);
        let law = inputs.svd(true, true).solve(&outputs, 0.0).ok()?;
        let (kp_per_mm, ki) = (law[0], law[1]);
        let size = (outputs.norm_squared() / LAW_ROWS as f64).sqrt();
        let keeps = |step: &&[f64; 3]| (kp_per_mm * step[0] + ki * step[1] - step[2]).abs() <= EXACT * size;
        let kept = steps.iter().take_while(keeps).count();
        (kept >= LAW_ROWS && kp_per_mm > 0.0).then(|| Self {
            rows: rows[..=kept].to_vec(),
            kp_per_mm,
            ti_s: if ki > 1e-9 * kp_per_mm { kp_per_mm / ki } else { f64::INFINITY },
        })
    }

    /// The oscillation after the step; `None` if it is too short or does not converge.
    fn swing(&self, skip_s: f64) -> Option<Swing> {
        let start_s = self.rows.first()?.time_s;
        let late: Vec<(f64, f64)> =
            self.rows.iter().map(|row| (row.time_s - start_s - skip_s, row.error)).filter(|(t, _)| *t >= 0.0).collect();
        let lasts_s = late.last()?.0;
        if lasts_s < SHORTEST_S {
            return None;
        }
        // In radians over the whole stretch, so that both parameters have the same scale.
        let nats =
            |at: &[f64]| -0.5 * late.len() as f64 * residue(&late, at[0] / lasts_s, at[1] / lasts_s).max(1e-12).ln();
        let ratio = (FASTEST / SLOWEST).ln() / f64::from(PLACES);
        let places = (0..=PLACES).flat_map(|k| {
            let omega = SLOWEST * (ratio * f64::from(k)).exp();
            [-0.4, 0.0].map(|growth| [growth * lasts_s, omega * lasts_s])
        });
        let start = places.max_by(|a, b| nats(a).total_cmp(&nats(b)))?;
        let (at, covariance) = maximise(nats, &start)?;
        Some(Swing {
            time_s: start_s,
            kp_per_mm: self.kp_per_mm,
            ti_s: self.ti_s,
            growth_per_s: at[0] / lasts_s,
            omega: at[1] / lasts_s,
            deviation: covariance[(0, 0)].sqrt() / lasts_s,
        })
    }
}

/// The residual sum of squares of the best oscillation with this growth rate and frequency.
fn residue(points: &[(f64, f64)], growth: f64, omega: f64) -> f64 {
    let mut normal = nalgebra::Matrix4::<f64>::zeros();
    let mut right = nalgebra::Vector4::<f64>::zeros();
    let mut power = 0.0;
    for &(t, value) in points {
        let size = (growth * t).exp();
        let row = nalgebra::Vector4::new(1.0, t, size * (omega * t).cos(), size * (omega * t).sin());
        normal += row * row.transpose();
        right += row * value;
        power += value * value;
    }
    normal.cholesky().map_or(f64::INFINITY, |solved| (power - right.dot(&solved.solve(&right))).max(0.0))
}

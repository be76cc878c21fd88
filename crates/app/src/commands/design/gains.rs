//! The methods whose result is gains.

use super::{Ground, NAME};
use crate::analysis::loop_margins::Closing;
use crate::cli::{LqrArgs, PidArgs, PolesArgs, RelayArgs, RelayRule};
use crate::commands::note;
use crate::log::reader;
use crate::report::design::words::Feedback;
use anyhow::{Result, anyhow, bail};
use control::design::DesignError;
use control::design::ackermann::{ackermann, setpoint_gain};
use control::design::discretise::discretise;
use control::design::law::{Gains, Weights};
use control::design::lqg::Observed;
use control::design::placement::{Wanted, place};
use control::design::relay::{Point, Relay, Rule};
use control::design::riccati::{lqr as least_cost, sampled_lqr};
use control::regulator::VELOCITY_FILTER_S;
use control::state_feedback::{Integral, Lqg};
use diagnose::identify::{Oscillation, oscillation};
use nalgebra::{RowSVector, SMatrix, SVector};
use std::path::Path;

/// The controller of a design, and the feedback that it was made of.
pub(super) type DesignedGains = (Closing, Option<Feedback>);

pub(super) fn of_config(ground: &Ground) -> Result<DesignedGains> {
    let pid = ground.config.need(NAME, "controller.pid", |tables| tables.controller.as_ref()?.pid.as_ref())?;
    Ok((Closing::Pid(pid.into(), pid.into()), None))
}

pub(super) fn pid(ground: &Ground, args: &PidArgs) -> Result<DesignedGains> {
    let wanted = Wanted {
        damping: above_zero("--damping", args.damping)?,
        omega: above_zero("--omega", args.omega)?,
        real_pole_per_s: above_zero("--real-pole", args.real_pole)?,
    };
    let placed = place(&ground.plant, wanted, above_zero("--derivative-n", args.derivative_n)?)?;
    let setpoint = not_below_zero("--setpoint-weight", args.setpoint_weight.unwrap_or(placed.setpoint_weight))?;
    if setpoint > 1.0 {
        bail!("--setpoint-weight {setpoint}: give 0 to 1");
    }
    let weights = Weights { setpoint, ..Weights::MEASUREMENT };
    Ok((Closing::Pid(placed.gains, weights), None))
}

pub(super) fn poles(ground: &Ground, args: &PolesArgs) -> Result<DesignedGains> {
    let plant = ground.plant;
    let feedback = if let Ok(poles) = <[_; 2]>::try_from(args.poles.as_slice()) {
        let (a, b) = plant.two_states();
        ground.feedback(&a, &b, &ackermann(&a, &b, &poles)?)?
    } else if let Ok(poles) = <[_; 3]>::try_from(args.poles.as_slice()) {
        let (a, b) = plant.three_states();
        needs_fan(plant.fan_lag_s)?;
        ground.feedback(&a, &b, &ackermann(&a, &b, &poles)?)?
    } else {
        let given = args.poles.len();
        bail!("number of --pole: {given}; give two for position and velocity, or three for the fan as well");
    };
    closed(ground, feedback)
}

pub(super) fn lqr(ground: &Ground, args: &LqrArgs) -> Result<DesignedGains> {
    let plant = ground.plant;
    let control = above_zero("--control", args.control)?;
    let (position, velocity) =
        (not_below_zero("--position", args.position)?, not_below_zero("--velocity", args.velocity)?);
    let period_s = if args.sampled {
        Some(ground.config.need(NAME, "loop", |tables| tables.r#loop.as_ref())?.period_s)
    } else {
        None
    };
    let feedback = if args.with_fan {
        needs_fan(plant.fan_lag_s)?;
        let (a, b) = plant.three_states();
        let gain = regulator(&a, &b, &SVector::from([position, velocity, 0.0]), control, period_s)?;
        ground.feedback(&a, &b, &gain)?
    } else {
        let (a, b) = plant.two_states();
        let gain = regulator(&a, &b, &SVector::from([position, velocity]), control, period_s)?;
        ground.feedback(&a, &b, &gain)?
    };
    closed(ground, feedback)
}

/// The regulator of diagonal weights; with `period_s` of the sampled plant.
fn regulator<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    weights: &SVector<f64, N>,
    control: f64,
    period_s: Option<f64>,
) -> Result<RowSVector<f64, N>, DesignError> {
    let q = SMatrix::from_diagonal(weights);
    match period_s {
        None => least_cost(a, b, &q, control),
        Some(period_s) => {
            let over = discretise(a, b, &SMatrix::zeros(), period_s);
            sampled_lqr(&over.transition, &over.input, &q, control)
        }
    }
}

impl Ground {
    /// The feedback with `gain`, and the config's integral.
    fn feedback<const N: usize>(
        &self,
        a: &SMatrix<f64, N, N>,
        b: &SVector<f64, N>,
        gain: &RowSVector<f64, N>,
    ) -> Result<Feedback> {
        for (name, value) in ["k₁", "k₂", "k₃"].into_iter().zip(gain.iter().copied()) {
            if value < 0.0 {
                return Err(DesignError::NegativeGain { gain: name, value }.into());
            }
        }
        let kept = || self.config.tables.controller.as_ref()?.state_feedback?.integral;
        let integral = if N > 2 { None } else { kept() };
        Ok(Feedback { gain: gain.iter().copied().collect(), setpoint_gain: setpoint_gain(a, b, gain)?, integral })
    }
}

/// A feedback of position and velocity is a PID whose derivative acts on the measurement; one of the fan's state needs
/// an observer.
fn closed(ground: &Ground, feedback: Feedback) -> Result<DesignedGains> {
    let closing = match feedback.gain[..] {
        [position_per_mm, velocity_s_per_mm, fan] => {
            // From the acceleration by the fan to its control value.
            let law = Lqg { position_per_mm, velocity_s_per_mm, fan: fan * ground.plant.gain };
            Closing::Lqg(Observed { feedback: law, observer: ground.observer()? })
        }
        _ => as_pid(&feedback),
    };
    Ok((closing, Some(feedback)))
}

/// The PID that does the same as a feedback of position and filtered velocity.
fn as_pid(feedback: &Feedback) -> Closing {
    let (kp_per_mm, td_s) = (feedback.gain[0], feedback.gain[1] / feedback.gain[0]);
    let weight = feedback.setpoint_gain / kp_per_mm;
    let (ti_s, setpoint) = match feedback.integral {
        None => (f64::INFINITY, weight),
        Some(Integral::Added { ti_s }) => (ti_s / weight, weight),
        Some(Integral::InPlace { ti_s }) => (ti_s / weight, 0.0),
    };
    let gains = Gains { kp_per_mm, ti_s, td_s, derivative_n: td_s / VELOCITY_FILTER_S };
    Closing::Pid(gains, Weights { setpoint, ..Weights::MEASUREMENT })
}

pub(super) fn relay(ground: &Ground, args: &RelayArgs) -> Result<DesignedGains> {
    let point = match &args.log {
        Some(log) => point_of(log, ground)?,
        None => point_of_figures(args)?,
    };
    let rule = match args.rule {
        RelayRule::ZieglerNichols => Rule::ZieglerNichols,
        RelayRule::TyreusLuyben => Rule::TyreusLuyben,
        RelayRule::PhaseMargin => Rule::PhaseMargin(args.margin_deg),
    };
    let gains = point.gains(rule, above_zero("--derivative-n", args.derivative_n)?)?;
    let kept = ground.config.tables.controller.as_ref().and_then(|table| table.pid.as_ref());
    let weights = Weights { setpoint: kept.map_or(1.0, |pid| pid.setpoint_weight), ..Weights::MEASUREMENT };
    Ok((Closing::Pid(gains, weights), None))
}

/// The point of the frequency response that a recorded oscillation shows, with the fundamental of its duty for the
/// relay's amplitude.
fn point_of(log: &Path, ground: &Ground) -> Result<Point> {
    let loaded = reader::read(log, ground.config.tables.import.as_ref())?;
    let found = oscillation(&loaded.recording).ok_or_else(|| {
        let log = log.display();
        anyhow!(
            "{log}: fewer than three periods of an oscillation in its last half; fly experiments/relay.toml for longer"
        )
    })?;
    let Oscillation { amplitude_mm, duty_amplitude_percent, period_s, short_of_half_turn } = found;
    note(format_args!("oscillation of {amplitude_mm:.1} mm at {duty_amplitude_percent:.3} % of duty, {period_s:.3} s"));
    let magnitude = amplitude_mm / duty_amplitude_percent;
    Ok(Point { omega: std::f64::consts::TAU / period_s, magnitude, short_of_half_turn })
}

fn point_of_figures(args: &RelayArgs) -> Result<Point> {
    // clap requires the three where there is no log; an absent one is refused as not a number.
    let relay = Relay {
        height: above_zero("--height-percent", args.height_percent.unwrap_or(f64::NAN))?,
        hysteresis_mm: not_below_zero("--hysteresis-mm", args.hysteresis_mm)?,
    };
    let amplitude_mm = above_zero("--amplitude-mm", args.amplitude_mm.unwrap_or(f64::NAN))?;
    Ok(relay.point(amplitude_mm, above_zero("--period-s", args.period_s.unwrap_or(f64::NAN))?)?)
}

fn needs_fan(fan_lag_s: f64) -> Result<()> {
    if fan_lag_s > 0.0 {
        return Ok(());
    }
    bail!("the model has no fan's state: add [plant.effects.fan_lag], or design for position and velocity alone")
}

pub(super) fn above_zero(flag: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(anyhow!("{flag} {value}: give a number above 0")) }
}

fn not_below_zero(flag: &str, value: f64) -> Result<f64> {
    if value >= 0.0 && value.is_finite() { Ok(value) } else { Err(anyhow!("{flag} {value}: give 0 or more")) }
}

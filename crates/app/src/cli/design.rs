//! The command line of `airball design`.

use super::ConfigArgs;
use clap::{Args, Subcommand, ValueEnum};
use control::design::Complex;
use std::path::PathBuf;

/// `airball design`
#[derive(Debug, Subcommand)]
pub enum DesignCommand {
    /// What the loop of the config bears as it is: margins, critical gain, step
    Loop(DesignArgs),
    /// PID by pole placement
    Pid(PidArgs),
    /// State feedback by pole placement (Ackermann)
    Poles(PolesArgs),
    /// State feedback by least cost (LQR)
    Lqr(LqrArgs),
    /// Steady-state Kalman observer from the noise of the model
    Observer(ObserverArgs),
    /// PID from the oscillation that a relay made
    Relay(RelayArgs),
    /// The critical gains of the thesis' three models beside the rig, and the third pole that closes the gap
    CriticalGain(CriticalGainArgs),
}

/// What every design may be told.
#[derive(Debug, Args)]
pub struct DesignArgs {
    /// Which model.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Linearised where.
    #[command(flatten)]
    pub about: AboutArgs,
    /// Write the design as a config patch for --patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Draw step, Bode plot, root locus and poles (SVG)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a report to look at and to print: one page that needs no network (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the design as JSON, and nothing else, to standard output
    #[arg(long)]
    pub json: bool,
}

/// About which height and duty a model is linearised.
#[derive(Clone, Copy, Debug, Args)]
pub struct AboutArgs {
    /// Linearise the model about this duty, percent, 0 to 100 [default: hover]
    #[arg(long, value_name = "PERCENT")]
    pub about_duty: Option<f64>,
    /// Linearise the model about this height, mm [default: mid-pipe]
    #[arg(long, value_name = "MM")]
    pub about_height: Option<f64>,
}

/// `airball design pid`
#[derive(Debug, Args)]
pub struct PidArgs {
    /// What every design may be told.
    #[command(flatten)]
    pub design: DesignArgs,
    /// Damping of the pair of poles
    #[arg(long, value_name = "D", default_value_t = 0.7)]
    pub damping: f64,
    /// Natural frequency of the pair, rad/s
    #[arg(long, value_name = "RAD/S", default_value_t = 2.5)]
    pub omega: f64,
    /// The integral's real pole, 1/s
    #[arg(long, value_name = "1/S", default_value_t = 0.3)]
    pub real_pole: f64,
    /// How much of a setpoint's change the proportional part sees, 0 to 1 [default: so much that a step does not see the
    /// integral's pole]
    #[arg(long, value_name = "B")]
    pub setpoint_weight: Option<f64>,
    /// N: how many times faster than T_d the derivative filter is
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    pub derivative_n: f64,
}

/// `airball design poles`
#[derive(Debug, Args)]
pub struct PolesArgs {
    /// What every design may be told.
    #[command(flatten)]
    pub design: DesignArgs,
    /// A pole, for instance -2.5 or -2+1.5i; two for position and velocity, three for the fan as well
    #[arg(long = "pole", value_name = "POLE", value_parser = pole, required = true, num_args = 1, allow_hyphen_values = true)]
    pub poles: Vec<Complex<f64>>,
}

/// `airball design lqr`
#[derive(Debug, Args)]
pub struct LqrArgs {
    /// What every design may be told.
    #[command(flatten)]
    pub design: DesignArgs,
    /// Weight of the position's square, 1/mm²
    #[arg(long, value_name = "Q", default_value_t = 1.0)]
    pub position: f64,
    /// Weight of the velocity's square, s²/mm²
    #[arg(long, value_name = "Q", default_value_t = 0.01)]
    pub velocity: f64,
    /// Weight of the control value's square
    #[arg(long, value_name = "R", default_value_t = 10_000.0)]
    pub control: f64,
    /// Feed the fan's state back as well: LQG, whose patch brings its observer along
    #[arg(long)]
    pub with_fan: bool,
    /// Minimise the sum over the samples of the loop in place of the integral
    #[arg(long)]
    pub sampled: bool,
}

/// `airball design observer`
#[derive(Debug, Args)]
pub struct ObserverArgs {
    /// Which model.
    #[command(flatten)]
    pub config: ConfigArgs,
    /// Linearised where.
    #[command(flatten)]
    pub about: AboutArgs,
    /// Write the observer as a config patch for --patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Write a report to look at and to print: one page that needs no network (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the design as JSON, and nothing else, to standard output
    #[arg(long)]
    pub json: bool,
}

/// `airball design relay`
#[derive(Debug, Args)]
pub struct RelayArgs {
    /// What every design may be told.
    #[command(flatten)]
    pub design: DesignArgs,
    /// Log of a flight under a relay, as experiments/relay.toml makes one; or give its figures
    #[arg(value_name = "LOG", conflicts_with_all = ["amplitude_mm", "period_s", "height_percent", "hysteresis_mm"])]
    pub log: Option<PathBuf>,
    /// Amplitude of the ball's oscillation, mm
    #[arg(long, value_name = "MM", required_unless_present = "log")]
    pub amplitude_mm: Option<f64>,
    /// Period of the oscillation, seconds
    #[arg(long, value_name = "S", required_unless_present = "log")]
    pub period_s: Option<f64>,
    /// Height of the relay, percent of duty to either side of hover
    #[arg(long, value_name = "PERCENT", required_unless_present = "log")]
    pub height_percent: Option<f64>,
    /// Hysteresis of the relay to either side, mm
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    pub hysteresis_mm: f64,
    /// How the gains follow
    #[arg(long, value_enum, default_value_t = RelayRule::TyreusLuyben)]
    pub rule: RelayRule,
    /// Phase margin of the rule phase-margin, degrees
    #[arg(long, value_name = "DEG", default_value_t = 45.0)]
    pub margin_deg: f64,
    /// N: how many times faster than T_d the derivative filter is
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    pub derivative_n: f64,
}

/// Rules from the ultimate gain and period to a PID.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RelayRule {
    /// Fast; every swing leaves a quarter of itself
    ZieglerNichols,
    /// For plants that integrate, as a ball does
    TyreusLuyben,
    /// The phase margin that --margin-deg asks for
    PhaseMargin,
}

/// `airball design critical-gain`
#[derive(Debug, Args)]
pub struct CriticalGainArgs {
    /// Critical proportional gain that was measured on the rig, percent per mm
    #[arg(long, value_name = "K", default_value_t = 0.038)]
    pub measured: f64,
    /// Integral time at which it was measured, seconds
    #[arg(long, value_name = "S", default_value_t = 15.0)]
    pub ti_s: f64,
    /// Proportional gain of the critical integral times, percent per mm
    #[arg(long, value_name = "K", default_value_t = 0.01)]
    pub kp: f64,
    /// Period of the sampled loop, seconds
    #[arg(long, value_name = "S", default_value_t = 0.018)]
    pub period_s: f64,
    /// Write the third pole for the model of this config as a config patch; names the config with --config
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Config file whose model the patch is for
    #[arg(long, value_name = "FILE", default_value = "config.toml")]
    pub config: PathBuf,
    /// Write a report to look at and to print: one page that needs no network (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the table as JSON, and nothing else, to standard output
    #[arg(long)]
    pub json: bool,
}

/// A real or complex number: -2.5, -2+1.5i, -2-1.5i.
fn pole(text: &str) -> Result<Complex<f64>, String> {
    let wrong = || "give a pole as -2.5 or -2+1.5i, in 1/s".to_owned();
    let number = |text: &str| text.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong);
    let pole = if let Some(complex) = text.strip_suffix('i') {
        let split = complex.rfind(['+', '-']).filter(|at| *at > 0).ok_or_else(wrong)?;
        Complex::new(number(&complex[..split])?, number(&complex[split..])?)
    } else {
        Complex::new(number(text)?, 0.0)
    };
    if pole.re < 0.0 {
        Ok(pole)
    } else {
        Err(format!(
            "a loop with the pole {text} does not settle; give a real part below 0, like -2.5 or -2+1.5i, in 1/s"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::{Complex, pole};

    #[test]
    fn poles_are_read_as_they_are_written() {
        assert_eq!(pole("-2.5"), Ok(Complex::new(-2.5, 0.0)));
        assert_eq!(pole("-0.78+2i"), Ok(Complex::new(-0.78, 2.0)));
        assert_eq!(pole("-0.78-2.5i"), Ok(Complex::new(-0.78, -2.5)));
        assert!(pole("0.78+2i").unwrap_err().contains("does not settle") && pole("0").is_err());
        assert!(pole("i").is_err() && pole("-2i").is_err() && pole("nan").is_err() && pole("two").is_err());
    }
}

//! The command line of `airball design`.

use super::ConfigArgs;
use clap::{Args, Subcommand, ValueEnum};
use config::USUAL;
use control::design::Complex;
use std::path::PathBuf;

/// `airball design`
#[derive(Debug, Subcommand)]
pub enum DesignCommand {
    /// Report margins, critical gain and step response of the loop of the config
    Loop(DesignArgs),
    /// Design a PID controller by pole placement
    Pid(PidArgs),
    /// Design state feedback by pole placement (Ackermann)
    Poles(PolesArgs),
    /// Design state feedback by LQR, or LQG
    Lqr(LqrArgs),
    /// Design a steady-state Kalman observer from the noise of the model
    Observer(ObserverArgs),
    /// Design a PID controller from a relay experiment
    Relay(RelayArgs),
    /// Compare the critical gains of the thesis' three models with its rig, and find the fan pole that each lacks
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
    /// Write a report as one self-contained page (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the design as JSON to standard output, and nothing else there
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
    /// Real pole of the integral action, 1/s, positive
    #[arg(long, value_name = "1/S", default_value_t = 0.3)]
    pub real_pole: f64,
    /// Setpoint weight of the proportional part, 0 to 1 [default: the one whose zero cancels the integral's pole]
    #[arg(long, value_name = "B")]
    pub setpoint_weight: Option<f64>,
    /// N of the derivative filter, whose time constant is T_d / N
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    pub derivative_n: f64,
}

/// `airball design poles`
#[derive(Debug, Args)]
pub struct PolesArgs {
    /// What every design may be told.
    #[command(flatten)]
    pub design: DesignArgs,
    /// Closed-loop pole, for instance -2.5 or -2+1.5i; repeat it: two for position and velocity, three with the fan
    #[arg(long = "pole", value_name = "POLE", value_parser = pole, required = true, num_args = 1, allow_hyphen_values = true)]
    pub poles: Vec<Complex<f64>>,
}

/// `airball design lqr`
#[derive(Debug, Args)]
pub struct LqrArgs {
    /// What every design may be told.
    #[command(flatten)]
    pub design: DesignArgs,
    /// Weight of the squared position, 1/mm²
    #[arg(long, value_name = "Q", default_value_t = 1.0)]
    pub position: f64,
    /// Weight of the squared velocity, s²/mm²
    #[arg(long, value_name = "Q", default_value_t = 0.01)]
    pub velocity: f64,
    /// Weight of the squared control value
    #[arg(long, value_name = "R", default_value_t = 10_000.0)]
    pub control: f64,
    /// Feed back the fan's state as well (LQG); the patch includes the observer
    #[arg(long)]
    pub with_fan: bool,
    /// Minimise the sum over the samples of the loop instead of the integral
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
    /// Process noise W, the diagonal: white noise on the rates of position (mm²/s), velocity (mm²/s³) and, with a fan
    /// lag, of the fan's acceleration (mm²/s⁵) [default: that of the table plant.noise]
    #[arg(long, value_name = "W1,W2[,W3]", value_delimiter = ',', value_parser = intensity, requires = "v")]
    pub w: Vec<f64>,
    /// Measurement noise V: white noise of the reading, mm²·s; a reading's variance times the period
    #[arg(long, value_name = "V", value_parser = positive_intensity, requires = "w")]
    pub v: Option<f64>,
    /// Write the observer as a config patch for --patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Write a report as one self-contained page (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the design as JSON to standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

fn intensity(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if (0.0..=1e12).contains(&value) => Ok(value),
        _ => Err("an intensity of noise is 0 to 1e12".into()),
    }
}

fn positive_intensity(text: &str) -> Result<f64, String> {
    intensity(text)
        .ok()
        .filter(|value| *value >= 1e-12)
        .ok_or_else(|| "the reading's noise is 1e-12 to 1e12 mm²·s".into())
}

/// `airball design relay`
#[derive(Debug, Args)]
pub struct RelayArgs {
    /// What every design may be told.
    #[command(flatten)]
    pub design: DesignArgs,
    /// Log of a relay experiment, as experiments/relay.toml; instead of the four numbers below
    #[arg(value_name = "LOG", conflicts_with_all = ["amplitude_mm", "period_s", "height_percent", "hysteresis_mm"])]
    pub log: Option<PathBuf>,
    /// Amplitude of the oscillation, mm
    #[arg(long, value_name = "MM", required_unless_present = "log")]
    pub amplitude_mm: Option<f64>,
    /// Period of the oscillation, seconds
    #[arg(long, value_name = "S", required_unless_present = "log")]
    pub period_s: Option<f64>,
    /// Amplitude of the relay about hover, percent of duty
    #[arg(long, value_name = "PERCENT", required_unless_present = "log")]
    pub height_percent: Option<f64>,
    /// Hysteresis of the relay, half of its width, mm
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    pub hysteresis_mm: f64,
    /// Tuning rule
    #[arg(long, value_enum, default_value_t = RelayRule::TyreusLuyben)]
    pub rule: RelayRule,
    /// Phase margin of the rule phase-margin, degrees
    #[arg(long, value_name = "DEG", default_value_t = 45.0)]
    pub margin_deg: f64,
    /// N of the derivative filter, whose time constant is T_d / N
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    pub derivative_n: f64,
}

/// Rules from the ultimate gain and period to a PID.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RelayRule {
    /// Fast; quarter-amplitude damping
    ZieglerNichols,
    /// For integrating plants
    TyreusLuyben,
    /// The phase margin of --margin-deg
    PhaseMargin,
}

/// `airball design critical-gain`
#[derive(Debug, Args)]
pub struct CriticalGainArgs {
    /// Measured critical proportional gain of the rig, percent per mm
    #[arg(long, value_name = "K", default_value_t = 0.038)]
    pub measured: f64,
    /// Integral time of that measurement, seconds
    #[arg(long, value_name = "S", default_value_t = 15.0)]
    pub ti_s: f64,
    /// Proportional gain for the critical integral times, percent per mm
    #[arg(long, value_name = "K", default_value_t = 0.01)]
    pub kp: f64,
    /// Period of the sampled loop, seconds
    #[arg(long, value_name = "S", default_value_t = 0.018)]
    pub period_s: f64,
    /// Write the fan pole of the model of --config as a config patch
    #[arg(long, value_name = "FILE")]
    pub patch_out: Option<PathBuf>,
    /// Config file whose model the patch is for
    #[arg(long, value_name = "FILE", default_value = USUAL)]
    pub config: PathBuf,
    /// Write a report as one self-contained page (HTML)
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the table as JSON to standard output, and nothing else there
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

//! The list of experiments that are safe on a rig, scaled to its pipe, its limits and its fan.
//!
//! Every one begins with take-off and settling at mid-pipe, keeps the controller on, and turns the fan off when the
//! ball comes near the top. A lower limit would end a flight by noise, while the ball slowly rises past it. Excitations
//! are sized so that a ball in open loop would move by 6 % of the pipe during one bit:
//!
//! ```text
//! x = K·u·T²/2      u: percent of duty, T: seconds of a bit
//! ```

use super::Rival;
use crate::analysis::virtual_flight::Desk;
use crate::flight::experiment::{Experiment, Limits, Segment};
use control::waveform::Waveform;

/// Take-off and settling, seconds.
const SETTLE_S: f64 = 8.0;
/// The part of the pipe that is used, and the height where the fan is turned off.
const USED: (f64, f64) = (0.2, 0.8);
const TOP: f64 = 0.95;
/// How far one bit of an excitation may move the ball, as a share of the pipe.
const BIT_MOVES: f64 = 0.06;
/// The largest excitation as a share of the range between hover and the limits of the duty.
const ROOM: f64 = 0.5;

/// An experiment of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Its short name.
    pub name: &'static str,
    /// What it shows, in one sentence.
    pub why: &'static str,
    /// The experiment.
    pub experiment: Experiment,
}

/// The sizes of a rig that the list is scaled to, mm and percent.
struct Scale {
    low: f64,
    high: f64,
    top: f64,
    way: f64,
    gain: f64,
    room_percent: f64,
}

/// The list for a rig that is one of `rivals` and is flown by `desk`.
#[must_use]
pub fn candidates(desk: &Desk, rivals: &[Rival]) -> Vec<Candidate> {
    let Some((_, model)) = rivals.first() else { return Vec::new() };
    let (bottom, top) = model.ends_mm();
    let at = |share: f64| bottom + share * (top - bottom);
    let safety = &desk.safety;
    let hover = model.hover_duty_percent;
    let scale = Scale {
        low: at(USED.0).max(safety.setpoint_min_mm),
        high: at(USED.1).min(safety.setpoint_max_mm),
        top: at(TOP),
        way: top - bottom,
        gain: model.gain_mm_per_s2_per_percent,
        room_percent: (hover - safety.duty_min_percent).min(safety.duty_max_percent - hover),
    };
    if scale.low < scale.high && scale.room_percent > 0.0 { scale.list() } else { Vec::new() }
}

impl Scale {
    fn list(&self) -> Vec<Candidate> {
        [self.of_setpoints(), self.of_heights(), self.of_excitations()].concat()
    }

    /// Setpoint changes about mid-pipe.
    fn of_setpoints(&self) -> Vec<Candidate> {
        let square = |share: f64, period_s| {
            let (low, high) = (self.at(0.5 - share / 2.0), self.at(0.5 + share / 2.0));
            vec![segment(40.0, Waveform::Square { low, high, period_s }, None)]
        };
        let sweep = Waveform::Chirp {
            centre: self.at(0.5),
            amplitude: 0.15 * (self.high - self.low),
            from_hz: 0.05,
            to_hz: 1.0,
            sweep_s: 40.0,
        };
        vec![
            self.candidate(
                "still hover",
                "Still hover: what moves is noise, air and the ends of dead zones.",
                vec![segment(40.0, self.middle(), None)],
            ),
            self.candidate(
                "small fast squares",
                "Small fast squares: delays and lags at small force.",
                square(0.1, 2.0),
            ),
            self.candidate("fast squares", "Fast squares: delays and lags at large force.", square(0.35, 4.0)),
            self.candidate("wide squares", "Wide squares: speed, saturation and drag.", square(0.7, 10.0)),
            self.candidate(
                "sweep of the setpoint",
                "A sine of rising frequency: the loop's phase, from slow to fast.",
                vec![segment(40.0, sweep, None)],
            ),
        ]
    }

    /// Setpoint changes along the pipe.
    fn of_heights(&self) -> Vec<Candidate> {
        let steps = |shares: &[f64], each_s: f64| {
            let values = shares.iter().map(|share| self.at(*share)).collect();
            vec![segment(each_s * shares.len() as f64, Waveform::Steps { values, each_s }, None)]
        };
        let (low, high) = (self.at(0.15), self.at(0.85));
        let ramp = |from, to| segment(24.0, Waveform::Ramp { from, to, over_s: 24.0 }, None);
        vec![
            self.candidate(
                "steps of several sizes",
                "Steps of several sizes, up and down: what depends on amplitude or direction.",
                steps(&[0.65, 0.4, 0.8, 0.2, 0.5, 0.55], 7.0),
            ),
            self.candidate(
                "height sweep",
                "Rest at several heights: what depends on height.",
                steps(&[0.0, 0.25, 0.5, 0.75, 1.0, 0.5], 7.0),
            ),
            self.candidate(
                "slow ramp",
                "A slow ramp down and up: dead zone, friction and play, which fast experiments hide.",
                vec![segment(4.0, Waveform::Constant { value: high }, None), ramp(high, low), ramp(low, high)],
            ),
        ]
    }

    /// Excitations of the duty under closed loop.
    fn of_excitations(&self) -> Vec<Candidate> {
        let shaken = |bit_s: f64| {
            let size = self.excitation(bit_s);
            let bits = Waveform::Prbs { low: -size, high: size, bit_s, order: 7 };
            vec![segment(40.0, self.middle(), Some(bits))]
        };
        let slow =
            Waveform::Square { low: -self.excitation(0.4) / 2.0, high: self.excitation(0.4) / 2.0, period_s: 6.0 };
        vec![
            self.candidate(
                "binary excitation",
                "Random bits on the duty while the controller keeps the ball: gain, drag and lag.",
                shaken(0.4),
            ),
            self.candidate(
                "fast binary excitation",
                "Fast random bits on the duty: the lags and delays of fan and sensor.",
                shaken(0.12),
            ),
            self.candidate(
                "slow duty squares",
                "Small slow squares on the duty: dead zone, play and steps of the fan.",
                vec![segment(40.0, self.middle(), Some(slow))],
            ),
        ]
    }

    fn candidate(&self, name: &'static str, why: &'static str, segments: Vec<Segment>) -> Candidate {
        let settle = segment(SETTLE_S, self.middle(), None);
        let limits = Limits { position_min_mm: None, position_max_mm: Some(tenth(self.top)) };
        let segments = [vec![settle], segments].concat().into();
        Candidate { name, why, experiment: Experiment { title: name.to_owned(), limits, segments } }
    }

    /// A height within the part of the pipe that is used.
    fn at(&self, share: f64) -> f64 {
        tenth(self.low + share * (self.high - self.low))
    }

    fn middle(&self) -> Waveform {
        Waveform::Constant { value: self.at(0.5) }
    }

    /// Amplitude of an excitation whose bits last `bit_s`, percent of duty.
    fn excitation(&self, bit_s: f64) -> f64 {
        let moves_mm = BIT_MOVES * self.way;
        let percent = (2.0 * moves_mm / (self.gain * bit_s * bit_s)).min(ROOM * self.room_percent).min(MOST_PERCENT);
        (1000.0 * percent).round() / 1000.0
    }
}

/// Largest excitation of the control value, percent of duty.
const MOST_PERCENT: f64 = 20.0;

/// Rounds to a tenth of a millimetre, for a readable file.
fn tenth(mm: f64) -> f64 {
    (10.0 * mm).round() / 10.0
}

fn segment(duration_s: f64, setpoint: Waveform, excitation_percent: Option<Waveform>) -> Segment {
    Segment { duration_s, setpoint_mm: Some(setpoint), excitation_percent, ..Segment::default() }
}

//! All numbers, words and switches that can be changed in flight, and where they are.

use super::words::WORDS;
use super::{Numbers, Values};
use crate::check::OutOfRange;
use crate::pid::AntiWindup;
use crate::predistortion::MAX_POINTS;
use crate::state_feedback::Integral;

/// A number, a word or a switch that can be changed in flight. A word is held as its place in the list of words.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Table and key.
    pub name: &'static str,
    /// Its unit; `u` stands for that of the control value: %, or mm/s² behind a predistortion. Empty: none.
    pub unit: &'static str,
    /// What it may say; empty: it is a number.
    pub words: &'static [&'static str],
    pub(super) place: Place,
}

/// Where a value is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// A number. `None`: it is absent.
    Number(fn(&mut Numbers) -> Option<&mut f64>),
    /// Says the word of this place in the list, if one is given, and returns the one that is said then.
    Word(fn(&mut Numbers, Option<u8>) -> Option<u8>),
}

/// How many numbers there are without words and points.
const BASE: usize = 70;
/// How many words.
const WORDY: usize = 9;
/// How many numbers of points.
const OF_POINTS: usize = 2 * MAX_POINTS;
/// How many there are.
pub const COUNT: usize = BASE + WORDY + OF_POINTS;

const fn parameter(name: &'static str, unit: &'static str, place: fn(&mut Numbers) -> Option<&mut f64>) -> Parameter {
    Parameter { name, unit, words: &[], place: Place::Number(place) }
}

/// A number of a row of the gain schedule.
macro_rules! row {
    ($name:literal, $unit:literal, $column:ident, $row:literal) => {
        parameter($name, $unit, |n| n.controllers.gain_schedule.as_mut()?.$column.get_mut($row))
    };
}

/// The numbers of points of a predistortion.
macro_rules! points {
    ($($number:literal $place:literal),*) => {
        [$(
            parameter(concat!("compensation.predistortion.points.", $number, ".duty_percent"), "%", |n| {
                n.compensation.predistortion.as_mut()?.points_mut().get_mut($place).map(|[duty, _]| duty)
            }),
            parameter(concat!("compensation.predistortion.points.", $number, ".mm_per_s2"), "mm/s²", |n| {
                n.compensation.predistortion.as_mut()?.points_mut().get_mut($place).map(|[_, force]| force)
            }),
        )*]
    };
}

const POINTS: [Parameter; OF_POINTS] = points![
        1 0, 2 1, 3 2, 4 3, 5 4, 6 5, 7 6, 8 7, 9 8, 10 9, 11 10, 12 11, 13 12, 14 13, 15 14, 16 15, 17 16, 18 17, 19
        18, 20 19, 21 20, 22 21, 23 22, 24 23, 25 24, 26 25, 27 26, 28 27, 29 28, 30 29, 31 30, 32 31, 33 32, 34 33, 35
        34, 36 35, 37 36, 38 37, 39 38, 40 39, 41 40, 42 41, 43 42, 44 43, 45 44, 46 45, 47 46, 48 47, 49 48, 50 49, 51
        50, 52 51, 53 52, 54 53, 55 54, 56 55, 57 56, 58 57, 59 58, 60 59, 61 60, 62 61, 63 62, 64 63, 65 64, 66 65, 67
        66, 68 67, 69 68, 70 69, 71 70, 72 71, 73 72, 74 73, 75 74, 76 75, 77 76, 78 77, 79 78, 80 79, 81 80, 82 81, 83
        82, 84 83, 85 84, 86 85, 87 86, 88 87, 89 88, 90 89, 91 90, 92 91, 93 92, 94 93, 95 94, 96 95, 97 96, 98 97, 99
        98, 100 99, 101 100, 102 101, 103 102, 104 103, 105 104, 106 105, 107 106, 108 107, 109 108, 110 109, 111 110,
        112 111, 113 112, 114 113, 115 114, 116 115, 117 116, 118 117, 119 118, 120 119, 121 120, 122 121, 123 122, 124
        123, 125 124, 126 125, 127 126, 128 127
];

/// The numbers without words and points, in the order of the config.
const NUMBERS: [Parameter; BASE] = [
    parameter("pid.kp_per_mm", "u/mm", |n| Some(&mut n.controllers.pid.as_mut()?.kp_per_mm)),
    parameter("pid.ti_s", "s", |n| Some(&mut n.controllers.pid.as_mut()?.ti_s)),
    parameter("pid.td_s", "s", |n| Some(&mut n.controllers.pid.as_mut()?.td_s)),
    parameter("pid.derivative_n", "", |n| Some(&mut n.controllers.pid.as_mut()?.derivative_n)),
    parameter("pid.setpoint_weight", "", |n| Some(&mut n.controllers.pid.as_mut()?.setpoint_weight)),
    parameter("pid.rate_limit_per_s", "u/s", |n| n.controllers.pid.as_mut()?.rate_limit_per_s.as_mut()),
    parameter("pid.anti_windup.back_calculation.tracking_s", "s", |n| {
        match &mut n.controllers.pid.as_mut()?.anti_windup {
            AntiWindup::BackCalculation { tracking_s } => Some(tracking_s),
            AntiWindup::Clamping => None,
        }
    }),
    parameter("cascade.position_per_s", "1/s", |n| Some(&mut n.controllers.cascade.as_mut()?.position_per_s)),
    parameter("cascade.fastest_mm_per_s", "mm/s", |n| Some(&mut n.controllers.cascade.as_mut()?.fastest_mm_per_s)),
    parameter("cascade.velocity_s_per_mm", "u·s/mm", |n| Some(&mut n.controllers.cascade.as_mut()?.velocity_s_per_mm)),
    parameter("cascade.ti_s", "s", |n| Some(&mut n.controllers.cascade.as_mut()?.ti_s)),
    parameter("state_feedback.position_per_mm", "u/mm", |n| {
        Some(&mut n.controllers.state_feedback.as_mut()?.position_per_mm)
    }),
    parameter("state_feedback.velocity_s_per_mm", "u·s/mm", |n| {
        Some(&mut n.controllers.state_feedback.as_mut()?.velocity_s_per_mm)
    }),
    parameter("state_feedback.setpoint_per_mm", "u/mm", |n| {
        n.controllers.state_feedback.as_mut()?.setpoint_per_mm.as_mut()
    }),
    parameter("state_feedback.integral.ti_s", "s", |n| {
        match n.controllers.state_feedback.as_mut()?.integral.as_mut()? {
            Integral::Added { ti_s } | Integral::InPlace { ti_s } => Some(ti_s),
        }
    }),
    parameter("lqg.position_per_mm", "u/mm", |n| Some(&mut n.controllers.lqg.as_mut()?.position_per_mm)),
    parameter("lqg.velocity_s_per_mm", "u·s/mm", |n| Some(&mut n.controllers.lqg.as_mut()?.velocity_s_per_mm)),
    parameter("lqg.fan", "", |n| Some(&mut n.controllers.lqg.as_mut()?.fan)),
    parameter("mpc.move_s", "s", |n| Some(&mut n.controllers.mpc.as_mut()?.move_s)),
    parameter("mpc.position_mm", "mm", |n| Some(&mut n.controllers.mpc.as_mut()?.position_mm)),
    parameter("mpc.velocity_mm_per_s", "mm/s", |n| Some(&mut n.controllers.mpc.as_mut()?.velocity_mm_per_s)),
    parameter("mpc.control", "u", |n| Some(&mut n.controllers.mpc.as_mut()?.control)),
    parameter("open_loop.control", "u", |n| Some(&mut n.controllers.open_loop.as_mut()?.control)),
    row!("gain_schedule.height_mm.1", "mm", height_mm, 0),
    row!("gain_schedule.factor.1", "", factor, 0),
    row!("gain_schedule.height_mm.2", "mm", height_mm, 1),
    row!("gain_schedule.factor.2", "", factor, 1),
    row!("gain_schedule.height_mm.3", "mm", height_mm, 2),
    row!("gain_schedule.factor.3", "", factor, 2),
    row!("gain_schedule.height_mm.4", "mm", height_mm, 3),
    row!("gain_schedule.factor.4", "", factor, 3),
    row!("gain_schedule.height_mm.5", "mm", height_mm, 4),
    row!("gain_schedule.factor.5", "", factor, 4),
    row!("gain_schedule.height_mm.6", "mm", height_mm, 5),
    row!("gain_schedule.factor.6", "", factor, 5),
    row!("gain_schedule.height_mm.7", "mm", height_mm, 6),
    row!("gain_schedule.factor.7", "", factor, 6),
    row!("gain_schedule.height_mm.8", "mm", height_mm, 7),
    row!("gain_schedule.factor.8", "", factor, 7),
    row!("gain_schedule.height_mm.9", "mm", height_mm, 8),
    row!("gain_schedule.factor.9", "", factor, 8),
    row!("gain_schedule.height_mm.10", "mm", height_mm, 9),
    row!("gain_schedule.factor.10", "", factor, 9),
    row!("gain_schedule.height_mm.11", "mm", height_mm, 10),
    row!("gain_schedule.factor.11", "", factor, 10),
    row!("gain_schedule.height_mm.12", "mm", height_mm, 11),
    row!("gain_schedule.factor.12", "", factor, 11),
    row!("gain_schedule.height_mm.13", "mm", height_mm, 12),
    row!("gain_schedule.factor.13", "", factor, 12),
    row!("gain_schedule.height_mm.14", "mm", height_mm, 13),
    row!("gain_schedule.factor.14", "", factor, 13),
    row!("gain_schedule.height_mm.15", "mm", height_mm, 14),
    row!("gain_schedule.factor.15", "", factor, 14),
    row!("gain_schedule.height_mm.16", "mm", height_mm, 15),
    row!("gain_schedule.factor.16", "", factor, 15),
    parameter("feed_forward.time_constant_s", "s", |n| Some(&mut n.controllers.feed_forward.as_mut()?.time_constant_s)),
    parameter("compensation.hover_duty_percent", "%", |n| Some(&mut n.compensation.hover_duty_percent)),
    parameter("compensation.dead_zone.lower_percent", "%", |n| {
        Some(&mut n.compensation.dead_zone.as_mut()?.lower_percent)
    }),
    parameter("compensation.dead_zone.upper_percent", "%", |n| {
        Some(&mut n.compensation.dead_zone.as_mut()?.upper_percent)
    }),
    parameter("compensation.dither.step_percent", "%", |n| Some(&mut n.compensation.dither.as_mut()?.step_percent)),
    parameter("observer.sensor_mm", "mm", |n| Some(&mut n.observer.as_mut()?.sensor_mm)),
    parameter("observer.acceleration_psd_mm2_per_s3", "mm²/s³", |n| {
        Some(&mut n.observer.as_mut()?.acceleration_psd_mm2_per_s3)
    }),
    parameter("observer.disturbance_psd_per_s", "u²/s", |n| n.observer.as_mut()?.disturbance_psd_per_s.as_mut()),
    parameter("observer.gate_sigma", "", |n| Some(&mut n.observer.as_mut()?.gate_sigma)),
    parameter("observer.second_sensor_mm", "mm", |n| n.observer.as_mut()?.second_sensor_mm.as_mut()),
    parameter("observer.tachometer.control", "u", |n| Some(&mut n.observer.as_mut()?.tachometer.as_mut()?.control)),
    parameter("observer.tachometer.psd_per_s", "u²/s", |n| {
        Some(&mut n.observer.as_mut()?.tachometer.as_mut()?.psd_per_s)
    }),
    parameter("observer.believed.gain_mm_per_s2_per_control", "mm/s² per u", |n| {
        Some(&mut n.observer.as_mut()?.believed.gain_mm_per_s2_per_control)
    }),
    parameter("observer.believed.drag_per_s", "1/s", |n| Some(&mut n.observer.as_mut()?.believed.drag_per_s)),
    parameter("observer.believed.fan_lag_s", "s", |n| n.observer.as_mut()?.believed.fan_lag_s.as_mut()),
];

const fn all() -> [Parameter; COUNT] {
    let mut all = [NUMBERS[0]; COUNT];
    let mut at = 0;
    while at < COUNT {
        all[at] = if at < BASE {
            NUMBERS[at]
        } else if at < BASE + WORDY {
            WORDS[at - BASE]
        } else {
            POINTS[at - BASE - WORDY]
        };
        at += 1;
    }
    all
}

impl Parameter {
    /// All of them: numbers in the order of the config, words, and the points of a predistortion.
    pub const ALL: [Self; COUNT] = all();

    /// Its place in [`Parameter::ALL`] by its name.
    #[must_use]
    pub fn named(name: &str) -> Option<usize> {
        Self::ALL.iter().position(|parameter| parameter.name == name)
    }

    /// The word that a value stands for.
    #[must_use]
    pub fn word(&self, value: f64) -> Option<&'static str> {
        (0_u8..).zip(self.words).find_map(|(at, word)| (f64::from(at) == value).then_some(*word))
    }

    /// The value of a word.
    #[must_use]
    pub fn value_of(&self, said: &str) -> Option<f64> {
        (0_u8..).zip(self.words).find_map(|(at, word)| (*word == said).then_some(f64::from(at)))
    }

    /// The smallest and the largest value that these tables accept. `None`: it is absent there.
    #[must_use]
    pub fn bounds(&self, numbers: &Numbers) -> Option<(f64, f64)> {
        let mut probe = numbers.clone();
        let Place::Number(place) = self.place else {
            return self.words.last().and_then(|last| Some((0.0, self.value_of(last)?)));
        };
        // No bound accepts it, so that the check says which ones there are.
        *place(&mut probe)? = f64::NAN;
        let (_, OutOfRange { min, max, .. }) = probe.check().err()?;
        Some((min, max))
    }

    /// The same where it is absent, and some switch adds it.
    #[must_use]
    pub fn bounds_if_added(&self, numbers: &Numbers) -> Option<(f64, f64)> {
        WORDS.iter().find_map(|switch| {
            (0_u8..).zip(switch.words).find_map(|(at, _)| {
                let mut added = numbers.clone();
                switch.set(&mut added, f64::from(at))?;
                self.get(&mut added).and_then(|_| self.bounds(&added))
            })
        })
    }

    /// The value. `None`: it is absent.
    pub(super) fn get(&self, numbers: &mut Numbers) -> Option<f64> {
        match self.place {
            Place::Number(place) => place(numbers).copied(),
            Place::Word(place) => place(numbers, None).map(f64::from),
        }
    }

    /// Sets the value. `None`: it is absent, or there is no such word.
    pub(super) fn set(&self, numbers: &mut Numbers, value: f64) -> Option<()> {
        match self.place {
            Place::Number(place) => *place(numbers)? = value,
            Place::Word(place) => {
                let at = (0_u8..).zip(self.words).find_map(|(at, _)| (f64::from(at) == value).then_some(at))?;
                place(numbers, Some(at))?;
            }
        }
        Some(())
    }
}

impl Numbers {
    /// All values.
    #[must_use]
    pub fn values(&self) -> Values {
        let mut all = self.clone();
        Parameter::ALL.map(|parameter| parameter.get(&mut all))
    }

    /// The same with the values that are given, words before numbers: a table that a switch adds has its numbers then.
    ///
    /// # Errors
    /// The name of a parameter that is absent here.
    pub fn with(&self, values: &Values) -> Result<Self, &'static str> {
        let mut changed = self.clone();
        for wordy in [true, false] {
            for (parameter, value) in Parameter::ALL.iter().zip(values) {
                if let Some(value) = value.filter(|_| parameter.words.is_empty() != wordy) {
                    parameter.set(&mut changed, value).ok_or(parameter.name)?;
                }
            }
        }
        Ok(changed)
    }
}

//! A second sensor: the position of the ball, unaffected by the first sensor.
//!
//! ```text
//! reading₂ = y + offset + noise₂      noise₂: σ = √(π/12)·mean |y_(k−1) − 2·y_k + y_(k+1)|
//! ```
//!
//! Lag, delay, hold and quantisation belong to the first sensor; the second one shows the motion without them. So a lag
//! of the sensor can be distinguished from one of the fan, and the delay of a reading from that of the duty. The two
//! sensors may have different zeros.

use crate::record::recording::Sample;
use std::f64::consts::PI;

/// With fewer readings than this there is no second sensor.
const ENOUGH: u32 = 50;

/// Offset and noise of a second sensor, estimated before any fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Second {
    /// Mean difference of its reading and that of the first sensor, mm.
    pub(crate) offset_mm: f64,
    /// Variance of its noise, mm².
    pub(crate) variance_mm2: f64,
}

impl Second {
    /// The second sensor of a recording's rows. `None`: it has no or too few readings.
    pub(crate) fn of(rows: &[Sample]) -> Option<Self> {
        let (mut count, mut apart) = (0, 0.0);
        for (second, first) in rows.iter().filter_map(|row| Some((row.position2_mm?, row.position_mm?))) {
            count += 1;
            apart += second - first;
        }
        let (mut bends, mut bent) = (0, 0.0);
        for three in rows.windows(3) {
            if let [Some(a), Some(b), Some(c)] = [0, 1, 2].map(|k: usize| three[k].position2_mm) {
                bends += 1;
                bent += (a - 2.0 * b + c).abs();
            }
        }
        if count < ENOUGH || bends < ENOUGH {
            return None;
        }
        let sigma_mm = (PI / 12.0).sqrt() * bent / f64::from(bends);
        // The variance must be above 0 for the division even without noise.
        Some(Self { offset_mm: apart / f64::from(count), variance_mm2: sigma_mm.powi(2).max(1e-6) })
    }
}

#[cfg(test)]
mod tests {
    use super::Second;
    use crate::tests_support::model;
    use crate::{Options, Recording, Sample, Verdict, diagnose};
    use plant::{Effects, Model, Normal, Simulator};

    /// A flight of `rig` that a second sensor reads directly, with an offset of 7 mm and noise of 2 mm.
    fn seen(rig: &Model, seed: u64) -> Recording {
        let mut simulator = Simulator::new(rig.clone(), seed);
        let mut noise = Normal::new(seed, 8);
        let mut last = 0.0;
        let rows = (0..3000).map(|k| {
            let time_s = 0.02 * f64::from(k);
            simulator.advance_to(time_s);
            let (reading, position_mm) = (simulator.reading_mm(), simulator.motion().position_mm);
            let velocity = (reading - last) / 0.02;
            last = reading;
            let target = if time_s % 6.0 < 3.0 { 350.0 } else { 250.0 };
            let duty_percent = 21.4 + 0.01 * (target - reading) - 0.0005 * velocity;
            simulator.drive(duty_percent);
            let position2_mm = Some(position_mm + 7.0 + 2.0 * noise.draw());
            Sample { time_s, duty_percent, position_mm: Some(reading), position2_mm, ..Sample::default() }
        });
        Recording::new(rows.collect()).unwrap()
    }

    fn without_second(recording: &Recording) -> Recording {
        Recording::new(recording.samples().iter().map(|row| Sample { position2_mm: None, ..*row }).collect()).unwrap()
    }

    #[test]
    fn its_offset_and_noise_are_read_off_the_record() {
        let second = Second::of(seen(&model(), 3).samples()).unwrap();
        assert!((second.offset_mm - 7.0).abs() < 0.3, "{second:?}");
        assert!((second.variance_mm2.sqrt() - 2.0).abs() < 0.15, "{second:?}");
        assert_eq!(Second::of(without_second(&seen(&model(), 3)).samples()), None);
    }

    /// With the second sensor the search names `truth` alone; without it, it names a set of `truth` and `twin`.
    fn is_settled(truth: &'static str, size: f64, twin: &'static str) {
        let belief = Model { effects: Effects::default(), ..model() };
        let mut rig = belief.clone();
        rig.effects.set(truth, &[size]);
        let recording = seen(&rig, 4);
        let names = |recording: &Recording| {
            let found = diagnose(&belief, recording, &Options::default());
            let sets = found.effects.iter();
            let sets = sets.map(|n| [&[n.candidate.entry.name][..], &n.indistinguishable_from].concat());
            (found.verdict, sets.collect::<Vec<_>>())
        };
        assert_eq!(names(&recording), (Verdict::Effect, vec![vec![truth]]));
        let alone = names(&without_second(&recording)).1.remove(0);
        assert!(alone.contains(&truth) && alone.contains(&twin), "{alone:?}");
    }

    #[test]
    fn a_delay_of_the_reading_is_told_from_one_of_the_duty() {
        is_settled("sensor_delay", 0.1, "transport_delay");
    }

    #[test]
    fn a_delay_of_the_duty_is_told_from_one_of_the_reading() {
        is_settled("transport_delay", 0.1, "sensor_delay");
    }

    #[test]
    fn a_lag_of_the_reading_is_told_from_one_of_the_fan() {
        is_settled("sensor_lag", 0.2, "fan_lag");
    }

    #[test]
    fn a_lag_of_the_fan_is_told_from_one_of_the_reading() {
        is_settled("fan_lag", 0.2, "sensor_lag");
    }
}

//! A linear axis at 1 kHz whose only noise is the encoder's quantisation, simulated in closed form for each
//! millisecond.
//!
//! ```text
//! v' = g·u − d·v − f·sign v, u constant: v(t) = F/d + (v₀ − F/d)·e^(−d·t), F = g·u − f·sign v; it stops where v(t) = 0
//! ```
//!
//! These results were wrong while the filter averaged ten duties, kept its noises above a thousandth, or smoothed
//! friction below 1 mm/s; and, without encoder counts, while rounding errors were tested for a cause.

#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use diagnose::{Diagnosis, Options, Recording, Sample, Verdict, diagnose};
use plant::{Effects, Model, Noise};

const ROWS: u32 = 20_000;
const PERIOD_S: f64 = 0.001;
/// One count of the encoder.
const COUNT_MM: f64 = 0.001;

struct Axis {
    gain: f64,
    drag: f64,
    friction: f64,
    late_rows: usize,
    /// Whether its encoder counts steps; otherwise it gives the exact position.
    counts: bool,
}

const BELIEVED: Axis = Axis { gain: 20.0, drag: 4.0, friction: 0.0, late_rows: 0, counts: true };

impl Axis {
    /// Position and velocity after `seconds` at this duty.
    fn moved(&self, (y, v): (f64, f64), duty: f64, seconds: f64) -> (f64, f64) {
        let pushed = self.gain * duty;
        let direction = if v == 0.0 { pushed.signum() } else { v.signum() };
        if v == 0.0 && pushed.abs() <= self.friction {
            return (y, 0.0);
        }
        let force = pushed - self.friction * direction;
        let terminal = force / self.drag;
        let stop_s = -(force / (force - self.drag * v)).ln() / self.drag;
        let used_s = if stop_s > 0.0 && stop_s < seconds { stop_s } else { seconds };
        let left = (-self.drag * used_s).exp();
        let there = y + terminal * used_s + (v - terminal) * (1.0 - left) / self.drag;
        if used_s < seconds {
            return self.moved((there, 0.0), duty, seconds - used_s);
        }
        (there, terminal + (v - terminal) * left)
    }

    /// 20 s of a closed loop that follows steps, with a chirp added to its duty.
    fn flown(&self) -> Recording {
        let mut state = (500.0, 0.0);
        let (mut wanted, mut seen, mut speed) = (500.0, 500.0, 0.0);
        let mut duties = vec![0.0; self.late_rows];
        let rows = (0..ROWS).map(|k| {
            let time_s = f64::from(k) * PERIOD_S;
            // Steps that never repeat: multiples of the golden ratio.
            let target = 350.0 + 300.0 * (f64::from(k / 700) * 0.618_033_988).fract();
            wanted += 0.004 * (target - wanted);
            let reading = if self.counts { (state.0 / COUNT_MM).round() * COUNT_MM } else { state.0 };
            speed += 0.2 * ((reading - seen) / PERIOD_S - speed);
            seen = reading;
            let chirp = 3.0 * (std::f64::consts::TAU * (0.5 + 0.35 * time_s) * time_s).sin();
            let duty = (6.0 * (wanted - reading) - 0.35 * speed + chirp).clamp(-100.0, 100.0);
            duties.push((duty * 100.0).round() / 100.0);
            state = self.moved(state, duties[duties.len() - 1 - self.late_rows], PERIOD_S);
            Sample { time_s, duty_percent: duties[duties.len() - 1], position_mm: Some(reading), ..Sample::default() }
        });
        Recording::new(rows.collect()).unwrap()
    }

    /// The diagnosis with the belief [`BELIEVED`] and a good guess of the noise.
    fn diagnosed(&self) -> Diagnosis {
        self.diagnosed_with(Noise { sensor_mm: 0.0005, acceleration_psd_mm2_per_s3: 1.0 })
    }

    /// The same with this guess of the noise.
    fn diagnosed_with(&self, noise: Noise) -> Diagnosis {
        let belief = Model {
            gain_mm_per_s2_per_percent: BELIEVED.gain,
            drag_per_s: BELIEVED.drag,
            hover_duty_percent: 0.0,
            pipe_bottom_mm: 0.0,
            pipe_length_mm: 1000.0,
            turn_mm: None,
            noise,
            effects: Effects::default(),
        };
        diagnose(&belief, &[self.flown()], &Options::default())
    }
}

/// The only effect named, and its only parameter.
fn only(found: &Diagnosis) -> (&'static str, f64) {
    assert_eq!(found.verdict, Verdict::Effect, "{:?}", found.misfit);
    assert_eq!(found.effects.len(), 1);
    let name = found.effects[0].candidate.entry.name;
    let values = found.mended.model.effects.values(name).unwrap_or_default();
    (name, values[0])
}

#[test]
fn an_axis_as_believed_has_no_gap() {
    let found = BELIEVED.diagnosed();
    assert_eq!((found.verdict, found.effects.len()), (Verdict::NoGap, 0), "{:?}", found.misfit);
    let sensor_mm = found.mended.model.noise.sensor_mm;
    assert!((sensor_mm / COUNT_MM * 12f64.sqrt() - 1.0).abs() < 0.1, "{sensor_mm} mm of a count's 1/√12");
}

#[test]
fn an_axis_of_another_mass_needs_parameters_alone() {
    let found = Axis { gain: 16.0, drag: 5.2, ..BELIEVED }.diagnosed();
    assert_eq!((found.verdict, found.effects.len()), (Verdict::Parameters, 0), "{:?}", found.misfit);
    let gain = found.mended.model.gain_mm_per_s2_per_percent;
    assert!((gain / 16.0 - 1.0).abs() < 1e-4, "{gain}");
}

#[test]
fn neither_no_noise_nor_far_too_much_in_the_belief_turns_another_mass_into_an_effect() {
    for (sensor_mm, acceleration_psd_mm2_per_s3) in [(0.0, 0.0), (0.05, 1000.0)] {
        let noise = Noise { sensor_mm, acceleration_psd_mm2_per_s3 };
        let found = Axis { gain: 16.0, drag: 5.2, ..BELIEVED }.diagnosed_with(noise);
        assert_eq!((found.verdict, found.effects.len()), (Verdict::Parameters, 0), "{noise:?}: {:?}", found.misfit);
    }
}

#[test]
fn a_delay_of_three_cycles_is_found_to_a_hundredth_of_one() {
    let found = Axis { late_rows: 3, ..BELIEVED }.diagnosed();
    let (name, delay_s) = only(&found);
    assert!(["transport_delay", "sensor_delay"].contains(&name), "{name}");
    assert!((delay_s - 0.003).abs() < 1e-5, "{delay_s} s");
}

#[test]
fn friction_that_stops_and_holds_an_axis_is_found_to_a_hundredth() {
    let found = Axis { friction: 40.0, ..BELIEVED }.diagnosed();
    let (name, friction) = only(&found);
    assert_eq!(name, "wall_friction");
    assert!((friction / 40.0 - 1.0).abs() < 0.01, "{friction} mm/s²");
}

#[test]
fn readings_without_any_noise_leave_nothing_over() {
    let found = Axis { counts: false, ..BELIEVED }.diagnosed();
    assert_eq!((found.verdict, found.effects.len()), (Verdict::NoGap, 0), "{:?}", found.misfit);
    let (name, delay_s) = only(&Axis { counts: false, late_rows: 3, ..BELIEVED }.diagnosed());
    assert!(name.ends_with("_delay") && (delay_s - 0.003).abs() < 1e-5, "{name}: {delay_s} s");
}

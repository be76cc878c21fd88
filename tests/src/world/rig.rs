//! The rig: duty in, readings out, every quarter of a millisecond.
//!
//! ```text
//! v ← v·e^(−drag·h) + a·(1 − e^(−drag·h))/drag      a: all other accelerations, held over the step h
//! x ← x + h·(v_before + v_after)/2
//! ```
//!
//! Linear drag is exact, everything else is held over the step. The air's noise is an Ornstein–Uhlenbeck acceleration
//! whose spectrum is flat up to 25 Hz: the velocity variance grows by the stated density per second, without jumps of
//! the velocity.

use crate::catalogue::Effect;
use crate::chance::{Chance, Source};
use crate::forms::{Force, Link, STEP_S, Stream, clutter, curves, forces, memory, outside, sensor};
use serde::Serialize;

/// Standard deviation of one reading, mm.
pub(crate) const SENSOR_MM: f64 = 2.0;
/// Density of the air's noise at low frequency, mm²/s³.
pub(crate) const PSD: f64 = 360.0;
/// Length of the pipe, mm; the ball rests at its ends.
pub(crate) const LENGTH_MM: f64 = 600.0;
/// Correlation time of the air's noise, s.
const AIR_S: f64 = 0.006;

/// The base parameters of a rig.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Base {
    /// Acceleration per percent of duty about hover.
    pub(crate) gain_mm_per_s2_per_percent: f64,
    /// Linear drag.
    pub(crate) drag_per_s: f64,
    /// Hover duty.
    pub(crate) hover_duty_percent: f64,
}

/// The parts of a rig.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    /// Base parameters.
    pub(crate) base: Base,
    /// Effects that act, in the catalogue or outside.
    pub(crate) effects: Vec<Effect>,
    /// Length of the record, s.
    pub(crate) seconds: f64,
    /// Deviations of the noise of sensor and air, and the step of a reading, as a multiple of the usual ones.
    pub(crate) noise: f64,
    /// Whether the sensor's lag and delay act before the ball instead of after it. Without noise, a linear ball gives
    /// the same readings either way; with them in front, the noise does not pass them.
    pub(crate) sensor_first: bool,
}

impl Parts {
    fn effect(&self, name: &str) -> Option<&Effect> {
        self.effects.iter().find(|effect| effect.name == name)
    }
}

/// The state of a rig.
pub(crate) struct Rig {
    /// Height of the ball, mm.
    pub(crate) x: f64,
    /// Speed of the ball, mm/s.
    pub(crate) v: f64,
    /// Duty in force, percent.
    pub(crate) duty: f64,
    step: i64,
    drag: f64,
    actuator: Vec<Link>,
    stream: Option<Stream>,
    forces: Vec<Force>,
    air: Chance,
    psd: f64,
    wind: f64,
    eye: Eye,
}

/// The sensor: the links of its signal at every step, and those of a reading.
struct Eye {
    along: Vec<Link>,
    reading: Vec<Link>,
    refresh: Option<Box<dyn FnMut(f64) -> bool>>,
    seen: f64,
    held: f64,
}

impl Rig {
    /// A rig at this height, at this time before the start of its record.
    pub(crate) fn new(parts: &Parts, source: &Source, height: f64, before_s: f64) -> Self {
        Self {
            x: height,
            v: 0.0,
            duty: parts.base.hover_duty_percent,
            step: -(before_s / STEP_S).round() as i64,
            drag: parts.base.drag_per_s,
            actuator: actuator(parts, source),
            stream: parts.effect("relative_airflow").map(|e| forces::relative_airflow(e, parts.base.drag_per_s)),
            forces: parts.effects.iter().filter_map(|effect| force(effect, source)).collect(),
            air: source.stream("air"),
            psd: PSD * parts.noise.powi(2),
            wind: 0.0,
            eye: eye(parts, source, height),
        }
    }

    /// Time in the record, s; negative before its start.
    pub(crate) fn time(&self) -> f64 {
        self.step as f64 * STEP_S
    }

    /// One step of motion.
    pub(crate) fn advance(&mut self) {
        let keep = (-STEP_S / AIR_S).exp();
        self.wind = keep * self.wind + (self.psd / (2.0 * AIR_S) * (1.0 - keep * keep)).sqrt() * self.air.hump();
        let a = self.push() + self.wind;
        let (before, decay) = (self.v, (-self.drag * STEP_S).exp());
        self.v = decay * before + a * (1.0 - decay) / self.drag;
        self.x += 0.5 * STEP_S * (before + self.v);
        if self.x < 0.0 || self.x > LENGTH_MM {
            self.x = self.x.clamp(0.0, LENGTH_MM);
            self.v = 0.0;
        }
        self.look();
    }

    /// The acceleration of the ball at its position, without drag and noise, mm/s². Advances the effects' memories by a
    /// step.
    pub(crate) fn push(&mut self) -> f64 {
        let (t, x, v) = (self.time(), self.x, self.v);
        let commanded = self.actuator.iter_mut().fold(self.duty, |signal, link| link(signal, t));
        let stream = self.stream.as_ref().map_or(0.0, |stream| stream(commanded, v));
        commanded + stream + self.forces.iter_mut().map(|force| force(x, v, t)).sum::<f64>()
    }

    /// Ends a step of the sensor. Returns its signal, mm, before the noise of a reading.
    pub(crate) fn look(&mut self) -> f64 {
        let (t, x) = (self.time(), self.x);
        self.step += 1;
        self.eye.seen = self.eye.along.iter_mut().fold(x, |signal, link| link(signal, t));
        self.eye.seen
    }

    /// Takes a reading, mm.
    pub(crate) fn read(&mut self) -> f64 {
        let t = self.time();
        let eye = &mut self.eye;
        if eye.refresh.as_mut().is_none_or(|due| due(t)) {
            eye.held = eye.reading.iter_mut().fold(eye.seen, |signal, link| link(signal, t));
        }
        eye.held
    }
}

/// The links from duty to acceleration, in the catalogue's order.
fn actuator(parts: &Parts, source: &Source) -> Vec<Link> {
    let (base, seconds) = (parts.base, parts.seconds);
    let (hover, gain) = (base.hover_duty_percent, base.gain_mm_per_s2_per_percent);
    let link = |name: &str| -> Option<Link> {
        match name {
            "about hover" => return Some(Box::new(move |duty, _| duty - hover)),
            "gain" => return Some(Box::new(move |u, _| u * gain)),
            _ => {}
        }
        let (e, chance) = (parts.effect(name)?, source.stream(name));
        Some(match name {
            "sensor_lag" if parts.sensor_first => sensor::sensor_lag(e),
            "sensor_delay" if parts.sensor_first => sensor::sensor_delay(e, chance),
            "late_writes" => outside::late_writes(e, chance),
            "stuck_driver" => outside::stuck_driver(e, chance),
            "transport_delay" => memory::transport_delay(e),
            "duty_quantisation" => memory::duty_quantisation(e),
            "hover_drift" => curves::hover_drift(e, seconds),
            "hysteresis" => memory::hysteresis(e),
            "dead_zone" => curves::dead_zone(e),
            "thrust_curve" => curves::thrust_curve(e, hover),
            "force_asymmetry" => curves::force_asymmetry(e),
            "gain_drift" => curves::gain_drift(e, seconds),
            "supply_ripple" => outside::supply_ripple(e, chance),
            "supply_sag" => outside::supply_sag(e, hover),
            "saturation" => curves::saturation(e),
            "fan_lag" => memory::fan_lag(e),
            "spin_asymmetry" => memory::spin_asymmetry(e),
            "duty_dependent_lag" => outside::duty_dependent_lag(e, gain),
            "pipe_resonance" => outside::pipe_resonance(e),
            _ => return clutter::link(e, chance),
        })
    };
    ALONG_THE_ACTUATOR.iter().filter_map(|name| link(name)).collect()
}

/// The order of composition.
const ALONG_THE_ACTUATOR: [&str; 25] = [
    "late_writes",
    "stuck_driver",
    "transport_delay",
    "duty_quantisation",
    "about hover",
    "write_jitter",
    "hover_drift",
    "slight_drift",
    "creep",
    "slight_curvature",
    "supply_sag",
    "hysteresis",
    "dead_zone",
    "thrust_curve",
    "force_asymmetry",
    "gain",
    "gain_drift",
    "supply_ripple",
    "saturation",
    "fan_lag",
    "spin_asymmetry",
    "duty_dependent_lag",
    "pipe_resonance",
    "sensor_lag",
    "sensor_delay",
];

fn force(e: &Effect, source: &Source) -> Option<Force> {
    let chance = source.stream(e.name);
    Some(match e.name {
        "height_dependent_flow" => forces::height_dependent_flow(e),
        "turbulence" => forces::turbulence(e, chance),
        "quadratic_drag" => forces::quadratic_drag(e),
        "wall_friction" => forces::wall_friction(e),
        "end_stop" => forces::end_stop(e),
        "gusts" => outside::gusts(e, chance),
        "limit_cycle" => outside::limit_cycle(e),
        "height_ripple" => outside::height_ripple(e),
        "spin_lift" => outside::spin_lift(e),
        "sticky_zone" => outside::sticky_zone(e),
        _ => return clutter::force(e, chance),
    })
}

/// The sensor: mount → lag → delay → noise → outlier → whole millimetres (or its coarser quantisation) → hold.
fn eye(parts: &Parts, source: &Source, height: f64) -> Eye {
    let (mut along, mut reading): (Vec<Link>, Vec<Link>) = (Vec::new(), Vec::new());
    let part = |name| parts.effect(name).map(|effect| (effect, source.stream(name)));
    along.extend(part("mount_backlash").map(|(e, _)| outside::mount_backlash(e)));
    along.extend(part("mount_slip").map(|(e, chance)| outside::mount_slip(e, chance)));
    along.extend(part("sensor_bend").map(|(e, _)| clutter::bend(e)));
    if !parts.sensor_first {
        along.extend(part("sensor_lag").map(|(e, _)| sensor::sensor_lag(e)));
        along.extend(part("sensor_delay").map(|(e, chance)| sensor::sensor_delay(e, chance)));
    }
    let (mut own, noise) = (source.stream("sensor"), parts.noise);
    reading.push(Box::new(move |x, _| x + noise * SENSOR_MM * own.logistic()));
    reading.extend(part("sensor_noise").map(|(e, chance)| sensor::sensor_noise(e, chance)));
    for name in ["uneven_noise", "heavy_tails"] {
        reading.extend(part(name).map(|(e, chance)| clutter::noise(e, chance)));
    }
    reading.extend(part("sensor_outliers").map(|(e, chance)| sensor::sensor_outliers(e, chance)));
    let coarse = part("sensor_quantisation").map(|(e, _)| sensor::sensor_quantisation(e));
    reading.push(coarse.unwrap_or_else(|| Box::new(move |x, _| (x / noise).round() * noise)));
    let refresh = part("stale_samples").map(|(e, chance)| sensor::refresh(e, chance));
    Eye { along, reading, refresh, seen: height, held: height }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{Reach, all_names, draw};

    fn rig(effects: Vec<Effect>, case: usize) -> Rig {
        let base = Base { gain_mm_per_s2_per_percent: 250.0, drag_per_s: 1.6, hover_duty_percent: 21.0 };
        let parts = Parts { base, effects, seconds: 60.0, noise: 1.0, sensor_first: false };
        Rig::new(&parts, &Source { seed: "rig".into(), case }, 300.0, 0.0)
    }

    #[test]
    fn a_percent_above_hover_pushes_with_the_gain() {
        let mut rig = rig(Vec::new(), 0);
        assert_eq!(rig.push(), 0.0);
        rig.duty = 22.0;
        assert_eq!(rig.push(), 250.0);
    }

    #[test]
    fn in_still_hover_speed_and_readings_scatter_as_stated() {
        let (mut speed, mut error) = (0.0, 0.0);
        for case in 0..2_000 {
            let mut rig = rig(Vec::new(), case);
            for _ in 0..800 {
                rig.advance();
            }
            speed += rig.v.powi(2) / 2_000.0;
            error += (rig.read() - rig.x).powi(2) / 2_000.0;
        }
        // Over 0.2 s, minus the part that the air's correlation delays.
        let expected = PSD * -(-2.0 * 1.6 * 0.2_f64).exp_m1() / (2.0 * 1.6) * (1.0 - 1.5 * AIR_S / 0.2);
        assert!((speed / expected - 1.0).abs() < 0.1, "{speed}, expected {expected}");
        assert!((error / (SENSOR_MM * SENSOR_MM + 1.0 / 12.0) - 1.0).abs() < 0.1, "{error}");
    }

    #[test]
    fn every_name_has_a_place_in_the_rig() {
        let reach = Reach { low_mm: 295.0, high_mm: 330.0, seconds: 60.0 };
        let readings = |effects| {
            let mut rig = rig(effects, 0);
            let mut row = |k: i64| {
                rig.duty = 21.0 + [1.9, -1.9, 1.0, 0.0, 7.0, -9.0][usize::try_from(k / 5 % 6).unwrap_or(0)];
                (0..72).for_each(|_| rig.advance());
                rig.read()
            };
            (0..1_500).map(&mut row).collect::<Vec<f64>>()
        };
        let neutral = readings(Vec::new());
        for name in all_names() {
            let effect = draw(name, &mut Source { seed: name.into(), case: 1 }.stream("size"), reach);
            assert!(readings(vec![effect]) != neutral, "{name}");
        }
    }
}

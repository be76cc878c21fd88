//! The dictionary of terms: forces, shifts of readings and spreads that a model may omit, as functions of known
//! signals.
//!
//! u: duty minus hover duty, x: height, v: velocity, each over its standard deviation; t: −1 at the start of the
//! flight, 1 at its end; ~τ: filtered by a first-order low-pass of τ seconds; ⁺: the positive part; u≈f: u filtered by
//! a resonance of f Hz, z ← z·exp((−ζ + i)·2πf·dt) + u·2πf·dt.

use plant::Stage;
use std::f64::consts::PI;

/// Time constants of the low-pass filters, seconds.
const MEMORIES_S: [f64; 5] = [0.1, 0.3, 1.0, 3.0, 10.0];
/// Resonances, Hz, and their damping ratio, with which each covers the band up to the next.
const RESONANCES_HZ: [f64; 7] = [0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0];
const DAMPING: f64 = 0.2;
/// Number of waves over the height, and over the time of the flight.
const WAVES_OF_HEIGHT: u32 = 5;
const WAVES_OF_TIME: u32 = 4;
/// The same for the gain over time. The duty separates it from other slow forces, so more waves are possible.
const WAVES_OF_GAIN: u32 = 16;
/// The same for the friction over the height.
const WAVES_OF_FRICTION: u32 = 3;
/// Angle of the longest wave of height per standard deviation.
const ANGLE: f64 = 1.2;
/// Slope of the smoothed sign per standard deviation.
const STEEP: f64 = 4.0;

/// Signals that are known before a reading.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    pub(super) u: f64,
    pub(super) x: f64,
    pub(super) v: f64,
    pub(super) t: f64,
    memory: [Memory; MEMORIES_S.len()],
    /// Real and imaginary part of each resonance.
    swings: [(f64, f64); RESONANCES_HZ.len()],
}

#[derive(Clone, Copy, Debug, Default)]
struct Memory {
    u: f64,
    above: f64,
    square_of_u: f64,
    v: f64,
}

impl Known {
    /// Updates the signals after `dt` seconds with this duty, height, velocity and time.
    pub(super) fn go_on(&mut self, dt: f64, [u, x, v, t]: [f64; 4]) {
        (self.u, self.x, self.v, self.t) = (u, x, v, t);
        for (memory, memory_s) in self.memory.iter_mut().zip(MEMORIES_S) {
            let share = 1.0 - (-dt / memory_s).exp();
            memory.u += share * (u - memory.u);
            memory.above += share * (u.max(0.0) - memory.above);
            memory.square_of_u += share * (u * u - memory.square_of_u);
            memory.v += share * (v - memory.v);
        }
        for ((re, im), hz) in self.swings.iter_mut().zip(RESONANCES_HZ) {
            let angle = 2.0 * PI * hz * dt;
            // Above the Nyquist frequency of the readings a resonance is aliased.
            if angle > PI {
                continue;
            }
            let (decay, (sin, cos)) = ((-DAMPING * angle).exp(), angle.sin_cos());
            (*re, *im) = (decay * (*re * cos - *im * sin) + angle * u, decay * (*re * sin + *im * cos));
        }
    }
}

/// A function of known signals, with its name.
pub(super) struct Term {
    pub(super) words: String,
    pub(super) of: Box<dyn Fn(&Known) -> f64 + Sync>,
    /// The stage of the signal path where it would act; `None` if unknown.
    pub(super) stage: Option<Stage>,
}

fn term(words: impl Into<String>, of: impl Fn(&Known) -> f64 + Sync + 'static) -> Term {
    Term { words: words.into(), of: Box::new(of), stage: None }
}

/// Assigns a stage to terms.
fn at(stage: Stage, terms: impl IntoIterator<Item = Term>) -> Vec<Term> {
    terms.into_iter().map(|term| Term { stage: Some(stage), ..term }).collect()
}

fn step(value: f64) -> f64 {
    (STEEP * value).tanh()
}

/// Forces. Those with duty act at the actuator, those with velocity at the ball, all others in the air.
pub(super) fn forces() -> Vec<Term> {
    let memories = 0..MEMORIES_S.len();
    [
        at(Stage::Actuator, of_duty()),
        at(Stage::Ball, of_speed()),
        at(Stage::Air, of_height()),
        at(Stage::Air, of_time()),
        at(Stage::Actuator, of_gain_over_time()),
        at(Stage::Air, waves_of_height()),
        at(Stage::Ball, waves_of_friction()),
        at(Stage::Actuator, (0..RESONANCES_HZ.len()).flat_map(of_resonance)),
        at(Stage::Actuator, memories.clone().flat_map(of_duty_before)),
        at(Stage::Ball, memories.map(of_speed_before)),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn of_duty() -> Vec<Term> {
    vec![
        term("u²", |k| k.u * k.u),
        term("u³", |k| k.u.clamp(-3.0, 3.0).powi(3)),
        term("|u|", |k| k.u.abs()),
        term("the sign of u", |k| step(k.u)),
        term("u·x", |k| k.u * k.x),
        term("u·x²", |k| k.u * k.x * k.x),
        term("|u|·x", |k| k.u.abs() * k.x),
        term("u·v", |k| k.u * k.v),
        term("u·|v|", |k| k.u * k.v.abs()),
        term("|u|·v", |k| k.u.abs() * k.v),
    ]
}

fn of_speed() -> Vec<Term> {
    vec![
        term("v·|v|", |k| k.v * k.v.abs()),
        term("v²", |k| k.v * k.v),
        term("the sign of v", |k| step(k.v)),
        term("x·v", |k| k.x * k.v),
        term("t·v", |k| k.t * k.v),
    ]
}

fn of_height() -> Vec<Term> {
    vec![term("x", |k| k.x), term("x²", |k| k.x * k.x), term("x³", |k| k.x.powi(3))]
}

fn of_time() -> Vec<Term> {
    [term("t", |k| k.t), term("t²", |k| k.t * k.t)].into_iter().chain(waves_of_time()).collect()
}

fn waves_of_time() -> Vec<Term> {
    waves(WAVES_OF_TIME, "", |_| 1.0, over_time)
}

fn of_gain_over_time() -> Vec<Term> {
    let products = [term("t·u", |k| k.t * k.u), term("t²·u", |k| k.t * k.t * k.u)];
    products.into_iter().chain(waves(WAVES_OF_GAIN, "u times ", |k| k.u, over_time)).collect()
}

fn waves_of_height() -> Vec<Term> {
    waves(WAVES_OF_HEIGHT, "", |_| 1.0, over_height)
}

fn waves_of_friction() -> Vec<Term> {
    waves(WAVES_OF_FRICTION, "the sign of v times ", |k| step(k.v), over_height)
}

/// A wave: its variable, the angle per unit of it, and the words that follow "wave".
struct Wave {
    over: fn(&Known) -> f64,
    angle: f64,
    words: String,
}

/// Wave number `n` over the time of the flight.
fn over_time(n: u32) -> Wave {
    Wave { over: |k| k.t, angle: f64::from(n) * PI, words: format!("of time, {n} periods a flight") }
}

/// The same over the height.
fn over_height(n: u32) -> Wave {
    let angle = f64::from(n) * ANGLE;
    Wave { over: |k| k.x, angle, words: format!("of height, {:.1} deviations long", 2.0 * PI / angle) }
}

/// `count` even and odd waves, each multiplied by a factor with its own words.
fn waves(count: u32, words: &str, factor: fn(&Known) -> f64, wave: fn(u32) -> Wave) -> Vec<Term> {
    let both = |n: u32| {
        let Wave { over, angle, words: after } = wave(n);
        [
            term(format!("{words}an even wave {after}"), move |k| factor(k) * (angle * over(k)).cos()),
            term(format!("{words}an odd wave {after}"), move |k| factor(k) * (angle * over(k)).sin()),
        ]
    };
    (1..=count).flat_map(both).collect()
}

fn of_resonance(at: usize) -> Vec<Term> {
    let words = |which| format!("u≈{} Hz, {which}", RESONANCES_HZ[at]);
    vec![term(words("in step"), move |k| k.swings[at].0), term(words("a quarter late"), move |k| k.swings[at].1)]
}

/// A term of one of the low-pass filters; `~` in its words stands for the time constant.
fn remembered(at: usize, words: &str, of: fn(&Known, &Memory) -> f64) -> Term {
    term(words.replace('~', &format!("~{} s", MEMORIES_S[at])), move |k: &Known| of(k, &k.memory[at]))
}

fn of_speed_before(at: usize) -> Term {
    remembered(at, "v~", |_, m| m.v)
}

fn of_duty_before(at: usize) -> Vec<Term> {
    let of = |words: &str, of: fn(&Known, &Memory) -> f64| remembered(at, words, of);
    vec![
        of("u~", |_, m| m.u),
        of("u⁺~", |_, m| m.above),
        of("u²~", |_, m| m.square_of_u),
        of("u·u~", |k, m| k.u * m.u),
        of("|u|·u~", |k, m| k.u.abs() * m.u),
        of("u·u⁺~", |k, m| k.u * m.above),
        of("u·u²~", |k, m| k.u * m.square_of_u),
        of("u~·(u − u~)", |k, m| m.u * (k.u - m.u)),
        of("|u~|·(u − u~)", |k, m| m.u.abs() * (k.u - m.u)),
        of("|u − u~|", |k, m| (k.u - m.u).abs()),
        of("the sign of u − u~", |k, m| step(k.u - m.u)),
    ]
}

/// Shifts of a reading.
pub(super) fn shifts() -> Vec<Term> {
    let shifts = vec![
        term("x²", |k| k.x * k.x),
        term("x³", |k| k.x.powi(3)),
        term("v", |k| k.v),
        term("|v|", |k| k.v.abs()),
        term("v·|v|", |k| k.v * k.v.abs()),
        term("the sign of v", |k| step(k.v)),
        term("u", |k| k.u),
        term("|u|", |k| k.u.abs()),
        term("t", |k| k.t),
        term("t²", |k| k.t * k.t),
    ];
    at(Stage::Sensor, shifts.into_iter().chain(waves_of_height()))
}

/// Spreads: dependence of the noise level on known signals.
pub(super) fn spreads() -> Vec<Term> {
    let spreads = vec![
        term("u", |k| k.u),
        term("u²", |k| k.u * k.u),
        term("x", |k| k.x),
        term("x²", |k| k.x * k.x),
        term("v", |k| k.v),
        term("|v|", |k| k.v.abs()),
        term("v²", |k| k.v * k.v),
        term("t", |k| k.t),
        term("t²", |k| k.t * k.t),
        term("|u − u~| of 0.1 s", |k| (k.u - k.memory[0].u).abs()),
        term("(u − u~)² of 0.1 s", |k| (k.u - k.memory[0].u).powi(2)),
        term("|u − u~| of 0.3 s", |k| (k.u - k.memory[1].u).abs()),
        term("(u − u~)² of 0.3 s", |k| (k.u - k.memory[1].u).powi(2)),
    ];
    spreads.into_iter().chain(waves_of_time()).chain(waves_of_height()).collect()
}

#[cfg(test)]
mod tests {
    use super::{Known, forces};
    use nalgebra::{DMatrix, DVector};
    use plant::Normal;

    const DT_S: f64 = 0.02;

    /// Signals along 80 s of a duty that is white noise through a lag of 0.2 s, with independent heights and
    /// velocities.
    fn way() -> Vec<Known> {
        let (mut normal, mut known, mut u, mut x, mut v) = (Normal::new(1, 9), Known::default(), 0.0, 0.0, 0.0);
        let step = |_| {
            u += 0.1 * (4.4 * normal.draw() - u);
            v += 0.05 * (6.3 * normal.draw() - v);
            x += 0.02 * (10.0 * normal.draw() - x);
            known.go_on(DT_S, [u, x, v, 0.0]);
            known
        };
        (0..4000).map(step).collect()
    }

    /// Share of the square of a force that the forces with `word` in their names explain together.
    fn share(force: &[f64], way: &[Known], word: &str) -> f64 {
        let terms: Vec<_> = forces().into_iter().filter(|term| term.words.contains(word)).collect();
        let columns = DMatrix::from_fn(way.len(), terms.len(), |row, at| (terms[at].of)(&way[row]));
        let force = DVector::from_column_slice(force);
        let weights = columns.clone().svd(true, true).solve(&force, 1e-9).unwrap();
        1.0 - (&force - columns * weights).norm_squared() / force.norm_squared()
    }

    #[test]
    fn a_resonance_between_two_of_the_dictionary_is_followed_by_them() {
        let way = way();
        // z″ + 2ζω·z′ + ω²·z = ω²·u, with small time steps.
        let (w, mut z, mut speed) = (2.0 * std::f64::consts::PI * 1.2, 0.0, 0.0);
        let mut swings = Vec::new();
        for known in &way {
            for _ in 0..100 {
                speed += DT_S / 100.0 * (w * w * (known.u - z) - 0.3 * w * speed);
                z += DT_S / 100.0 * speed;
            }
            swings.push(z);
        }
        assert!(share(&swings, &way, "u≈") > 0.95, "{}", share(&swings, &way, "u≈"));
        assert!(share(&swings, &way, "u~") < 0.8, "{}", share(&swings, &way, "u~"));
    }

    #[test]
    fn friction_in_one_part_of_the_pipe_is_followed_by_its_waves() {
        let way = way();
        let stuck = |known: &Known| if (known.x - 0.3).abs() < 0.7 { known.v.signum() } else { 0.0 };
        let stuck: Vec<f64> = way.iter().map(stuck).collect();
        let everywhere: Vec<f64> = way.iter().map(|known| known.v.signum()).collect();
        assert!(share(&stuck, &way, "the sign of v times") > 0.5, "{}", share(&stuck, &way, "the sign of v times"));
        assert!(share(&everywhere, &way, "the sign of v") > 0.8, "{}", share(&everywhere, &way, "the sign of v"));
    }
}

//! How fast a formula is evaluated, beside the same written in Rust.
//!
//! The Rust functions are called through `black_box`, so that each call is one. The last comparison is a whole step of a
//! simulator: RK4 of 1 ms of the ball under a force of the duty, linear drag, and the force in question. Times are taken in turn
//! within one run, and the ratio is the median over the rounds.
//!
//!     cargo bench --package formula

use formula::Formula;
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 41;
const CALLS: u32 = 200_000;
/// x, v, u, k, start.
const NAMES: [&str; 5] = ["x", "v", "u", "k", "start"];

type Native = fn(&[f64]) -> f64;

const FORCES: [(&str, Native); 6] = [
    ("x", |s| s[0]),
    ("-k * max(x - start, 0)", |s| -s[3] * (s[0] - s[4]).max(0.0)),
    ("-k * v * abs(v)", |s| -s[3] * s[1] * s[1].abs()),
    ("k * (u - start) + 3 * v", |s| s[3] * (s[2] - s[4]) + 3.0 * s[1]),
    (
        "if(x < start, -k * v^2, k * min(v, 5))",
        |s| if s[0] < s[4] { -s[3] * s[1] * s[1] } else { s[3] * s[1].min(5.0) },
    ),
    ("-k * tanh(v / 10)", |s| -s[3] * libm::tanh(s[1] / 10.0)),
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("{ROUNDS} rounds of {CALLS} calls, in turn: median time of one, and ratio");
    for (text, native) in FORCES {
        let formula = Formula::parse(text, &NAMES)?;
        let (value, dual) = (|s: &[f64]| formula.value(s), |s: &[f64]| formula.dual(s, &[1.0, 0.0, 0.0, 0.0, 0.0]).1);
        report(&format!("{text}: value / Rust"), || time(value), || time(|s| black_box(native)(s)));
        report(&format!("{text}: dual / Rust's value"), || time(dual), || time(|s| black_box(native)(s)));
        report(&format!("{text}: RK4 step / with Rust"), || fly(value), || fly(|s| black_box(native)(s)));
        if let Some(flight) = inlined(text) {
            report(&format!("{text}: RK4 step / with Rust inlined"), || fly(value), flight);
        }
    }
    Ok(())
}

/// Nanoseconds of one call.
fn time(force: impl Fn(&[f64]) -> f64) -> f64 {
    let mut state = [310.0, 20.0, 21.0, 2.0, 300.0];
    let start = Instant::now();
    for k in 0..CALLS {
        state[0] = 290.0 + f64::from(k % 32);
        black_box(force(black_box(&state)));
    }
    1e9 * start.elapsed().as_secs_f64() / f64::from(CALLS)
}

/// A flight where the compiler sees through the call of the force, as it does for an effect of the catalogue.
fn inlined(text: &str) -> Option<fn() -> f64> {
    match text {
        "-k * max(x - start, 0)" => Some(|| fly(|s| -s[3] * (s[0] - s[4]).max(0.0))),
        "-k * v * abs(v)" => Some(|| fly(|s| -s[3] * s[1] * s[1].abs())),
        _ => None,
    }
}

/// Nanoseconds of one step.
fn fly(force: impl Fn(&[f64]) -> f64) -> f64 {
    let (mut x, mut v, dt) = (310.0, 20.0, 0.001);
    let start = Instant::now();
    for k in 0..CALLS {
        let u = f64::from(k % 32) - 16.0;
        let acceleration = |x: f64, v: f64| 827.0 * u - 3.9 * v + 0.1 * force(&[x, v, u, 0.001, 300.0]);
        let (x1, v1) = (v, acceleration(x, v));
        let (x2, v2) = (v + dt / 2.0 * v1, acceleration(x + dt / 2.0 * x1, v + dt / 2.0 * v1));
        let (x3, v3) = (v + dt / 2.0 * v2, acceleration(x + dt / 2.0 * x2, v + dt / 2.0 * v2));
        let (x4, v4) = (v + dt * v3, acceleration(x + dt * x3, v + dt * v3));
        x += dt / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4);
        v += dt / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    }
    black_box((x, v));
    1e9 * start.elapsed().as_secs_f64() / f64::from(CALLS)
}

fn report(what: &str, ours: impl Fn() -> f64, theirs: impl Fn() -> f64) {
    let (mut first, mut second, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        // Whoever comes second finds the machine in another state: take turns.
        let (a, b) = if round % 2 == 0 { (ours(), theirs()) } else { swap((theirs(), ours())) };
        first.push(a);
        second.push(b);
        ratios.push(a / b);
    }
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    println!("{what:70} {:6.2} ns /{:6.2} ns = {:5.2}", median(first), median(second), median(ratios));
}

fn swap((second, first): (f64, f64)) -> (f64, f64) {
    (first, second)
}

//! How fast the simulated rig flies, beside straight-line C code of the same physics and beside a library's integrator.
//!
//! A flight is 60 s: 3000 control periods of 20 ms with RK4 steps of 1 ms, under PD control of the readings, so that
//! nobody can work the duty out beforehand. All fly by the same equations:
//!
//! - the C code (`flight.c`, compiled here by the system's C compiler with `-O3`) draws the same noise from the same
//!   generators and checks the same ends of the pipe; its readings must agree with the plant's to 1e-9 before anything
//!   is timed. It times itself, in a process of its own;
//! - the crate `ode_solvers` takes the same RK4 steps. It knows neither noise nor ends, so it is compared without noise
//!   only.
//!
//! Times are taken in turn within one run, and the ratio is the median over the rounds with its 95 % interval. The
//! catalogue's effects are timed likewise, beside the plant without any.
//!
//!     cargo bench --package plant                 all of it
//!     cargo bench --package plant -- 'plant /'    what has this in its name

use ode_solvers::{Rk4, System, Vector2};
use plant::effects::{FanLag, SpinAsymmetry};
use plant::{Definition, DefinitionTable, Effects, Model, Noise, ParameterTable, Simulator, Stage};
use std::error::Error;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

type Fallible<T> = Result<T, Box<dyn Error>>;

/// Flights that are timed together, and how often that is done.
const FLIGHTS: u32 = 20;
const ROUNDS: usize = 41;
const CYCLES: u32 = 3000;
const PERIOD_S: f64 = 0.02;
/// Readings of two programs that fly the same flight agree so well, relative to the larger of the reading and 1 mm.
const AGREEMENT: f64 = 1e-9;
const SEED: u64 = 7;

fn main() -> Fallible<()> {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let yardstick = compile(&directory)?;
    let (noisy, quiet) = (rig(2.5, 360.0), rig(0.0, 0.0));
    for model in [&noisy, &quiet] {
        let apart = apart(&flight(model), &printed(&yardstick, model)?);
        say("C code and plant, largest relative difference of a reading", apart)?;
    }
    say("ode_solvers and plant, the same", apart(&flight(&quiet), &integrated(&quiet)?))?;

    let plant = |model: &Model| time(|| Ok(black_box(flight(model)).len()));
    let c = |model: &Model| timed(&yardstick, model);
    println!(
        "\n60 s of flight, {ROUNDS} rounds of {FLIGHTS} flights each, in turn: median time, and ratio with 95 % interval"
    );
    report("plant / C, with noise", || plant(&noisy), || c(&noisy))?;
    report("plant / C, without noise", || plant(&quiet), || c(&quiet))?;
    report("plant / RK4 of ode_solvers", || plant(&quiet), || time(|| Ok(integrated(&quiet)?.len())))?;

    println!("\nWith effects, beside the plant without (both with noise)");
    let lagging = Model { effects: all_with("fan_lag"), ..noisy.clone() };
    let spinning = Model { effects: all_with("spin_asymmetry"), ..noisy.clone() };
    report("all with fan_lag", || plant(&lagging), || plant(&noisy))?;
    report("all with spin_asymmetry", || plant(&spinning), || plant(&noisy))?;
    for entry in Effects::CATALOGUE {
        let mut model = noisy.clone();
        model.effects.set(entry.name, entry.sizes.first().copied().unwrap_or_default());
        report(entry.name, || plant(&model), || plant(&noisy))?;
    }

    println!("\nEffects that are written as formulas, beside the same in Rust (both with noise)");
    for (name, adds) in [("height_dependent_flow", "-k * (x - 291.5)"), ("quadratic_drag", "-k * v * abs(v)")] {
        let [built_in, written] = in_both_ways(&noisy, name, adds)?;
        let apart = apart(&flight(&written), &flight(&built_in));
        say(&format!("{name}, largest relative difference of a reading"), apart)?;
        report(&format!("{name}, written / in Rust"), || plant(&written), || plant(&built_in))?;
    }
    Ok(())
}

/// The rig with an effect of one parameter as it is in the catalogue, and with the same effect as a formula of `k`.
fn in_both_ways(rig: &Model, name: &str, adds: &str) -> Fallible<[Model; 2]> {
    let parameter =
        ParameterTable { neutral: Some(0.0), value: None, scale: None, low: 0.0, high: 1e3, unit: String::new() };
    let table = DefinitionTable {
        stage: Stage::Ball,
        adds: adds.into(),
        looks: String::new(),
        mend: String::new(),
        parameters: [("k".to_owned(), parameter)].into(),
        states: [].into(),
    };
    let definition = Definition::new("written", &table).map_err(|error| error.message)?;
    let size = Effects::built_in(name).and_then(|entry| entry.sizes.first()).copied().unwrap_or_default();
    let (mut built_in, mut written) = (rig.clone(), rig.clone());
    built_in.effects.set(name, size);
    written.effects.written.define(definition);
    written.effects.set("written", &size[..1]);
    Ok([built_in, written])
}

/// The thesis' rig without effects.
fn rig(sensor_mm: f64, acceleration_psd_mm2_per_s3: f64) -> Model {
    Model {
        gain_mm_per_s2_per_percent: 827.2,
        drag_per_s: 3.896,
        hover_duty_percent: 21.4,
        pipe_bottom_mm: 0.0,
        pipe_length_mm: 583.0,
        turn_mm: None,
        noise: Noise { sensor_mm, acceleration_psd_mm2_per_s3 },
        effects: Effects::default(),
    }
}

/// Every effect at the first of its sizes; of the two that exclude each other, `fan`.
fn all_with(fan: &str) -> Effects {
    let mut effects = Effects::default();
    for entry in Effects::CATALOGUE.iter().filter(|entry| !["fan_lag", "spin_asymmetry"].contains(&entry.name)) {
        effects.set(entry.name, entry.sizes.first().copied().unwrap_or_default());
    }
    match fan {
        "fan_lag" => effects.fan_lag = Some(FanLag { time_constant_s: 0.05 }),
        _ => effects.spin_asymmetry = Some(SpinAsymmetry { up_s: 0.1, down_s: 0.25 }),
    }
    effects
}

/// PD control of the readings: what `flight.c` does.
struct Pilot {
    hover: f64,
    last_mm: f64,
}

impl Pilot {
    fn duty(&mut self, cycle: u32, reading_mm: f64) -> f64 {
        let setpoint = if cycle % 800 < 400 { 400.0 } else { 200.0 };
        let duty = self.hover + 0.018 * (setpoint - reading_mm) - 0.3 * (reading_mm - self.last_mm);
        self.last_mm = reading_mm;
        duty.clamp(10.0, 40.0)
    }
}

/// The readings of one flight of the plant.
fn flight(model: &Model) -> Vec<f64> {
    let mut rig = Simulator::new(model.clone(), SEED);
    let mut pilot = Pilot { hover: model.hover_duty_percent, last_mm: 0.0 };
    let cycle = |cycle| {
        let reading = rig.reading_mm();
        rig.drive(pilot.duty(cycle, reading));
        rig.advance_to(PERIOD_S * f64::from(cycle + 1));
        reading
    };
    (0..CYCLES).map(cycle).collect()
}

/// The equation of the rig under a constant force, for `ode_solvers`.
#[derive(Clone, Copy)]
struct Flow {
    force: f64,
    drag: f64,
}

type State = Vector2<f64>;

impl System<f64, State> for Flow {
    fn system(&self, _: f64, x: &State, dx: &mut State) {
        dx[0] = x[1];
        dx[1] = self.force - self.drag * x[1];
    }
}

fn step(flow: Flow, x: State) -> Fallible<State> {
    let mut stepper = Rk4::new(flow, 0.0, x, PERIOD_S, 0.001);
    stepper.integrate()?;
    Ok(*stepper.y_out().last().ok_or("no state")?)
}

/// The flight of the plant without noise, with a library in the place of its integrator.
fn integrated(model: &Model) -> Fallible<Vec<f64>> {
    let mut pilot = Pilot { hover: model.hover_duty_percent, last_mm: 0.0 };
    let mut x = State::zeros();
    let cycle = |cycle| {
        let reading = x[0];
        let force = model.gain_mm_per_s2_per_percent * (pilot.duty(cycle, reading) - model.hover_duty_percent);
        x = step(Flow { force, drag: model.drag_per_s }, x)?;
        Ok(reading)
    };
    (0..CYCLES).map(cycle).collect()
}

/// Seconds for so many flights as are timed together.
fn time(fly: impl Fn() -> Fallible<usize>) -> Fallible<f64> {
    let start = Instant::now();
    for _ in 0..FLIGHTS {
        black_box(fly()?);
    }
    Ok(start.elapsed().as_secs_f64())
}

/// Compiles `flight.c` with `$CC`, or `cc`, as any C programmer would.
fn compile(directory: &Path) -> Fallible<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/flight.c");
    let program = directory.join("flight");
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    let status = Command::new(&compiler).arg("-O3").arg(&source).arg("-o").arg(&program).arg("-lm").status();
    match status {
        Ok(status) if status.success() => Ok(program),
        Ok(status) => Err(format!("{compiler} could not compile {} ({status})", source.display()).into()),
        Err(error) => Err(format!("{compiler} does not run ({error}); install a C compiler or name it in CC").into()),
    }
}

/// The output of `flight.c` when it flies `model`.
fn c_says(program: &Path, word: &str, flights: u32, model: &Model) -> Fallible<String> {
    let noise = model.noise;
    let numbers = [
        model.gain_mm_per_s2_per_percent,
        model.drag_per_s,
        model.hover_duty_percent,
        model.pipe_length_mm,
        noise.sensor_mm,
        noise.acceleration_psd_mm2_per_s3,
    ];
    let mut command = Command::new(program);
    command.arg(word).arg(flights.to_string()).args(numbers.map(|number| number.to_string())).arg(SEED.to_string());
    Ok(String::from_utf8(command.output()?.stdout)?)
}

/// Seconds for so many flights as are timed together, as the C program measures them.
fn timed(program: &Path, model: &Model) -> Fallible<f64> {
    let said = c_says(program, "time", FLIGHTS, model)?;
    Ok(said.split_whitespace().next().ok_or("the C program says nothing")?.parse()?)
}

/// The readings of one flight of the C program.
fn printed(program: &Path, model: &Model) -> Fallible<Vec<f64>> {
    c_says(program, "print", 0, model)?.lines().map(|line| Ok(line.parse()?)).collect()
}

/// The largest relative difference of two flights' readings.
fn apart(ours: &[f64], theirs: &[f64]) -> f64 {
    let same_length = ours.len() == theirs.len();
    let differences = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs() / a.abs().max(1.0));
    if same_length { differences.fold(0.0, f64::max) } else { f64::INFINITY }
}

/// Says how far two flights are apart; too far is an error: the comparison would not be fair.
fn say(what: &str, apart: f64) -> Fallible<()> {
    println!("{what}: {apart:.1e}");
    // A NaN is no agreement either.
    if apart <= AGREEMENT { Ok(()) } else { Err(format!("{what}: more than {AGREEMENT:e}").into()) }
}

/// Times both in turn and prints the medians and their ratio, unless another comparison was requested.
fn report(what: &str, first: impl Fn() -> Fallible<f64>, second: impl Fn() -> Fallible<f64>) -> Fallible<()> {
    let asked_for = std::env::args().skip(1).find(|argument| !argument.starts_with("--"));
    if asked_for.is_some_and(|part| !what.contains(&part)) {
        return Ok(());
    }
    let mut pairs = Vec::new();
    for round in 0..ROUNDS {
        // Whoever comes second finds the machine in another state: take turns.
        let pair = if round % 2 == 0 { (first()?, second()?) } else { swap((second()?, first()?)) };
        pairs.push(pair);
    }
    let of = |part: fn(&(f64, f64)) -> f64| sorted(pairs.iter().map(part).collect());
    let (ours, theirs, ratios) = (of(|p| p.0), of(|p| p.1), of(|p| p.0 / p.1));
    let middle = ROUNDS / 2;
    // Order statistics that hold the median with 95 %: the binomial's deviation is √rounds/2.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss, reason = "small")]
    let half = (0.98 * (ROUNDS as f64).sqrt()).ceil() as usize;
    let milliseconds = |all: &[f64]| 1e3 * all[middle] / f64::from(FLIGHTS);
    println!(
        "{what:30} {:7.3} ms /{:7.3} ms = {:5.2}  ({:.2} to {:.2})",
        milliseconds(&ours),
        milliseconds(&theirs),
        ratios[middle],
        ratios[middle - half],
        ratios[middle + half]
    );
    Ok(())
}

fn swap((second, first): (f64, f64)) -> (f64, f64) {
    (first, second)
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

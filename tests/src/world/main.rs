//! An independent simulator: makes withheld cases for a diagnosis, and shares no equation with the tested program.
//!
//! A case is a record, the belief of the rig's owner, and a truth that is published later: its hash is printed before
//! any record is made.

mod bounds;
mod case;
mod catalogue;
mod chance;
mod flight;
mod forms;
mod linear;
mod mixture;
mod programme;
mod rig;
mod truth;

use case::Case;
use chance::Source;
use clap::Parser;
use mixture::{Kind, Mixture};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Makes withheld cases: records of ball-in-pipe rigs, what their owners believe, and a sealed truth.
#[derive(Debug, Parser)]
#[command(name = "world", max_term_width = 100)]
struct Arguments {
    /// Directory for case-NNN.csv and case-NNN.toml
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Where the sealed truth goes; keep it out of --out
    #[arg(long, value_name = "FILE")]
    truth: PathBuf,
    /// Any text; the whole set follows from it
    #[arg(long, value_name = "TEXT")]
    seed: String,
    /// Number of cases
    #[arg(long, value_name = "N", default_value_t = 120)]
    count: usize,
    /// Weights of the kinds, such as none=2,single=5 [kinds: none, parameters, single, pair, outside,
    /// clutter, amid, several]
    #[arg(long, value_name = "KIND=WEIGHT,…", value_delimiter = ',', value_parser = weight)]
    mix: Vec<(Kind, f64)>,
    /// Draw only this effect; may be given again. Without --mix: singles of it, or outside cases
    #[arg(long, value_name = "EFFECT", value_parser = known)]
    only: Vec<&'static str>,
    /// Never draw this effect; may be given again
    #[arg(long, value_name = "EFFECT", value_parser = known)]
    leave_out: Vec<&'static str>,
    /// Fly the same rigs again, with other setpoints and noise: the number of the flight
    #[arg(long, value_name = "N", default_value_t = 0)]
    flight: usize,
    /// Write only the case with this number; hash and truth are those of the whole set
    #[arg(long, value_name = "K")]
    case: Option<usize>,
    /// What each record could tell at best (nats, Cramér–Rao sigmas) as JSON; as secret as the truth
    #[arg(long, value_name = "FILE")]
    bounds: Option<PathBuf>,
    /// Salt of the truth [default: follows from the seed]
    #[arg(long, value_name = "TEXT")]
    salt: Option<String>,
    /// Cases made at the same time
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
}

/// Kinds and weights of a set like the project's own withheld ones.
const USUAL: [(Kind, f64); 5] =
    [(Kind::None, 0.18), (Kind::Parameters, 0.09), (Kind::Single, 0.48), (Kind::Pair, 0.12), (Kind::Outside, 0.13)];

fn weight(text: &str) -> Result<(Kind, f64), String> {
    let (kind, weight) = text.split_once('=').unwrap_or((text, "1"));
    let kind = <Kind as clap::ValueEnum>::from_str(kind, false)?;
    match weight.parse::<f64>() {
        Ok(weight) if weight.is_finite() && weight >= 0.0 => Ok((kind, weight)),
        _ => Err(format!("weight {weight:?} is not a number of at least 0")),
    }
}

fn known(name: &str) -> Result<&'static str, String> {
    let found = catalogue::find(name).map(|(_, name)| name);
    found.ok_or_else(|| format!("unknown effect, expected one of {}", catalogue::all_names().join(", ")))
}

fn main() {
    if let Err(message) = run(&Arguments::parse()) {
        eprintln!("world: {message}");
        std::process::exit(1);
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let mixture = mixture(arguments)?;
    if let Some(case) = arguments.case.filter(|case| *case >= arguments.count) {
        return Err(format!("no case {case} in a set of {}; the first is 0", arguments.count));
    }
    secret(arguments)?;
    let cases: Vec<(Source, Case)> = (0..arguments.count)
        .map(|case| {
            let source = Source { seed: arguments.seed.clone(), case };
            let case = Case::draw(&source, &mixture);
            (source, case)
        })
        .collect();
    let sealed = sealed(arguments, &cases)?;
    println!("sha256 of the truth: {}", truth::hash(sealed.as_bytes()));
    write(&arguments.truth, &sealed)?;
    let chosen: Vec<usize> = (0..cases.len()).filter(|k| arguments.case.is_none_or(|case| case == *k)).collect();
    let bounds = make(arguments, &cases, &chosen)?;
    if let Some(file) = &arguments.bounds {
        write(file, &serde_json::to_string_pretty(&bounds).map_err(|error| error.to_string())?)?;
    }
    println!("{} cases in {}", chosen.len(), arguments.out.display());
    Ok(())
}

/// Refuses to write the secret truth into the directory of the cases.
fn secret(arguments: &Arguments) -> Result<(), String> {
    std::fs::create_dir_all(&arguments.out).map_err(|error| format!("{}: {error}", arguments.out.display()))?;
    let place = |path: &Path| path.canonicalize().ok();
    for file in [Some(&arguments.truth), arguments.bounds.as_ref()].into_iter().flatten() {
        let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if place(parent) == place(&arguments.out) {
            return Err(format!("{} would lie beside the cases; give it another directory", file.display()));
        }
    }
    Ok(())
}

/// The mixture, after all flags.
fn mixture(arguments: &Arguments) -> Result<Mixture, String> {
    let mut effects = if arguments.only.is_empty() { catalogue::all_names() } else { arguments.only.clone() };
    effects.retain(|name| !arguments.leave_out.contains(name));
    let within = |inside: bool| effects.iter().filter(|name| catalogue::inside(name) == inside).count();
    let kinds = match (arguments.mix.is_empty(), arguments.only.is_empty()) {
        (false, _) => arguments.mix.clone(),
        (true, true) => USUAL.to_vec(),
        (true, false) => vec![(Kind::Single, within(true) as f64), (Kind::Outside, within(false) as f64)],
    };
    let asked = |wanted: &[Kind]| kinds.iter().any(|(kind, weight)| wanted.contains(kind) && *weight > 0.0);
    if kinds.iter().all(|(_, weight)| *weight == 0.0) {
        return Err("all weights of --mix are 0; give one of the kinds a weight".into());
    }
    if asked(&[Kind::Single, Kind::Amid, Kind::Several]) && within(true) == 0
        || asked(&[Kind::Outside]) && within(false) == 0
    {
        return Err("no effect is left for a kind of --mix; look at --only and --leave-out".into());
    }
    if asked(&[Kind::Pair]) && !mixture::pairs_exist(&effects) {
        return Err("no two effects are left that make a pair; look at --only and --leave-out".into());
    }
    Ok(Mixture { kinds, effects, exact: false })
}

/// The text of the truth's file.
fn sealed(arguments: &Arguments, cases: &[(Source, Case)]) -> Result<String, String> {
    let salt = arguments.salt.clone().unwrap_or_else(|| truth::hash(format!("salt\n{}", arguments.seed).as_bytes()));
    let truth = truth::Truth {
        schema: "world.truth/1",
        salt,
        seed: &arguments.seed,
        drawn_with: format!(
            "count {}, mix {:?}, only {:?}, leave out {:?}",
            arguments.count, arguments.mix, arguments.only, arguments.leave_out
        ),
        cases: cases.iter().enumerate().map(|(k, (_, case))| truth::CaseTruth::new(name(k), case)).collect(),
    };
    serde_json::to_string_pretty(&truth).map_err(|error| error.to_string())
}

/// Flies the chosen cases and writes them; gives their bounds when they are wanted.
fn make(arguments: &Arguments, cases: &[(Source, Case)], chosen: &[usize]) -> Result<Vec<bounds::Bounds>, String> {
    let next = AtomicUsize::new(0);
    let work = || -> Result<Vec<bounds::Bounds>, String> {
        let mut done = Vec::new();
        while let Some(&k) = chosen.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (source, case) = &cases[k];
            let (source, case) = &case.flight(source, arguments.flight);
            let file = |ending: &str| arguments.out.join(format!("{}.{ending}", name(k)));
            write(&file("csv"), &flight::csv(&flight::fly(case, source, |_| {})))?;
            write(&file("toml"), &truth::belief(case))?;
            done.extend(arguments.bounds.is_some().then(|| bounds::bounds(&name(k), case, source)));
        }
        Ok(done)
    };
    let results: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..arguments.jobs.max(1)).map(|_| scope.spawn(work)).collect();
        workers.into_iter().map(|worker| worker.join().unwrap_or_else(|_| Err("a worker stopped".into()))).collect()
    });
    let mut all = results.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
    all.sort_by_key(|bounds| (bounds.case.len(), bounds.case.clone()));
    Ok(all)
}

fn name(case: usize) -> String {
    format!("case-{case:03}")
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    std::fs::write(file, text).map_err(|error| format!("{}: {error}; check the directory", file.display()))
}

//! The numbers that decide an answer, in the order in which they are asked.
//!
//! Each says what it decides, and how it was chosen. *False alarms* are the share of right models that pass it, as
//! `cargo test --release -p diagnose -- --ignored --nocapture rates_of_false_alarms` prints them: 200 flights of 60 s
//! and of 5 s, simulated by the very model that is believed, with seeds that nothing else uses. Whoever changes a
//! number runs that again. How often the numbers together are right on rigs whose equations the diagnosis does not know
//! is the proof page's matter (`docs/blind.md`).
//!
//! A number without an origin beside it was chosen by hand, and no rate of it was measured. Likelihoods are in nats.
//! Numbers that belong to one step alone, and decide no answer, stand at the head of that step.

// Is there enough to answer?

/// Readings in free flight that a diagnosis and an identification need. No right model has an effect named with 175 of
/// them (flights of 5 s), as with 2925. A residual is called significant more often: of 200 flights `TOGETHER` is passed
/// by 3 instead of 1, and `OMITTED_BESIDE_NAME` by 44 instead of 1. With 125 readings `TOGETHER` is passed by 8.
pub const ENOUGH_READINGS: usize = 150;
/// Readings that count in full; of a longer record each counts for less. No model is exact, and with readings enough
/// any is found wrong. The number was chosen by hand.
pub(crate) const LONG: f64 = 6000.0;
/// Mean square of the standardised innovations below which they are rounding. A fitted noise leaves 1.
pub(crate) const QUIET: f64 = 0.05;

// Which candidates are fitted in full?

/// Gain at the screening that a full fit takes. Chosen by hand: half of what a name takes.
pub(crate) const SCREENED: f64 = 2.5;
/// How many candidates are fitted in full, and how far behind the best they may be at the screening: nats, and a share
/// of its gain.
pub(crate) const FULL_FITS: usize = 8;
pub(crate) const BEHIND: f64 = 20.0;
pub(crate) const BEHIND_SHARE: f64 = 0.4;
/// A fit is far from the belief where leaving it costs more log-prior than this.
pub(crate) const FAR_FROM_BELIEF: f64 = 3.0;
/// What noise of another order must gain for a refit to start there.
pub(crate) const OTHER_NOISE: f64 = 50.0;

/// The most shapes of a formula. More are no explanation.
pub(crate) const MOST_SHAPES: usize = 4;
/// By how many standard errors over the stretches a shape of a formula lowers the mean squares at all horizons: a
/// one-sided test at 5 %, corrected for the two shapes that are compared (Bonferroni). No rate was measured.
pub(crate) const FORMULA_FORECAST: f64 = 1.96;

/// A model forecasts better than a simpler one where its mean squares at all horizons are lower by so many standard
/// errors over the stretches of the record: a one-sided test at 5 %. No rate was measured.
pub(crate) const BETTER_FORECAST: f64 = 1.645;

// Which effect is named?

/// Gains this close are equivalent. Chosen by hand; no rate was measured.
pub(crate) const EQUIVALENT: f64 = 2.0;
/// What a parameter gains by chance on the rows that it is fitted to and loses on others, together. Akaike (1974).
pub(crate) const COST_OF_A_PARAMETER: f64 = 1.0;
/// The most that it may be worth that gain, drag and hover need not move.
pub(crate) const UNMOVED: f64 = 2.5;
/// Penalised gain that a first effect takes to be named. False alarms: 0 of 200 flights.
pub const FIRST_EFFECT: f64 = 5.0;
/// The same for a second effect, and for what backward elimination keeps.
pub const SECOND_EFFECT: f64 = 5.5;
/// The same for each further one: the form of two effects is never exact, and what that leaves is no third effect.
pub(crate) const FURTHER_EFFECT: f64 = 16.0;
/// The same beside coarse readings, within whose steps nothing is normal.
pub(crate) const BESIDE_COARSE_READINGS: f64 = 20.0;
/// The same as a share of what is explained already, which the form of the named effects may leave.
pub(crate) const SHARE_OF_EXPLAINED: f64 = 0.005;
/// The same as a share of what the score test still asks for without the effect: what explains less is not what is
/// missing.
pub const SHARE_OF_OMITTED: f64 = 0.25;
/// The same for a random force of the air: the growth of the air's noise counts against it already. False alarms: 0 of
/// 200 flights.
pub(crate) const RANDOM_FORCE: f64 = 1.2;
/// A random force yields to another effect that gains more than this share of what it gains.
pub(crate) const RANDOM_FORCE_YIELDS: f64 = 0.5;
/// What the believed values of a believed effect must lose for it to be called retuned or removed.
pub(crate) const CHANGED: f64 = 6.0;
/// A believed value that is off by more than this factor is another one.
pub(crate) const RETUNED: f64 = 1.5;
/// Effects within this gain of the best cannot be told from it.
pub const INDISTINGUISHABLE: f64 = 3.0;
/// The same for twins, which differ by the colour of noise alone.
pub const INDISTINGUISHABLE_TWINS: f64 = 15.0;
/// Nats that count as one: likelihoods take the model for exact, and no model is.
pub(crate) const SCALE_OF_PROBABILITY: f64 = 2.5;
/// Effects that a record can name at most, and searches at most. Chosen by hand.
pub const MOST_EFFECTS: usize = 8;
pub(crate) const MOST_SEARCHES: usize = 12;
/// Numbers within this share of their scale of the neutral value do nothing.
pub(crate) const NOTHING: f64 = 1e-3;
/// What the form of a believed lag may be worth to another effect that makes something late.
pub(crate) const COST_BESIDE_A_LAG: f64 = 7.0;
/// What is late by less than this share of it and of the lag beside it is that lag's form: of two lags in series, the
/// small one.
pub(crate) const SHARE_OF_A_LAG: f64 = 0.16;

// Is the residual significant?

/// −ln p at which one statistic alone is significant: terms of the score test, spectral line, uneven mean, growth of
/// the air's noise. False alarms: 0 of 200 flights each.
pub(crate) const ALONE: f64 = 11.0;
/// The same for the whiteness, standard deviations of its χ². False alarms: 0 of 200 flights.
pub(crate) const WHITENESS: f64 = 5.5;
/// The same for an uneven variance, −ln p. False alarms: 0 of 200 flights.
pub(crate) const UNEVEN_VARIANCE: f64 = 12.0;
/// Σ −ln p of five statistics. Theory: the sum of five exponential numbers passes it four times in a thousand. False
/// alarms: 1 of 200 flights.
pub(crate) const TOGETHER: f64 = 13.0;
/// The air's noise, which an owner guesses, counts no more than the first, in −ln p, as long as it grew by less than
/// the second, a ratio.
pub(crate) const AIR_AS_GUESSED: f64 = 3.0;
/// See above: the ratio.
pub const AIR_RATIO: f64 = 1.3;
/// −ln p of a statistic that is reported beside others.
pub(crate) const REPORTED: f64 = 3.0;
/// −ln p of the score test beside a named effect. Chosen: a doubt costs less there than an alarm where nothing is
/// wrong. False alarms: 1 of 200 flights.
pub(crate) const OMITTED_BESIDE_NAME: f64 = 4.5;
/// −ln p of events, whose many looks differ less than they are counted for. False alarms: 1 of 200 flights.
pub(crate) const EVENTS: f64 = 6.5;
/// −ln p of terms and events of coarse readings: within a step nothing is normal.
pub(crate) const OMITTED_COARSE: f64 = 80.0;
/// Steps of readings wider than so many deviations of the noise are coarse.
pub(crate) const COARSE: f64 = 2.0;
/// Share of what effects explain that their form may leave.
pub(crate) const SHARE_OF_FORM: f64 = 0.02;
/// What an uneven spread must say more than a force, nats: a filter whose model is right but for its form is not
/// equally sure everywhere.
pub(crate) const UNEVEN_SPREAD: f64 = 2.0;
/// Limits beside a random force, which follows most of what is missing: −ln p of the score test and of an uneven mean,
/// standard deviations of bursts, and the ratio that the white noise may change by, unless it is within so many
/// deviations of the belief. False alarms of the mean: 1 of 200 flights; of bursts: 0.
pub(crate) const OMITTED_BESIDE_RANDOM_FORCE: f64 = 4.5;
pub(crate) const MEAN_BESIDE_RANDOM_FORCE: f64 = 5.0;
pub(crate) const BURSTS: f64 = 3.3;
pub(crate) const WHITE_NOISE_KEPT: std::ops::Range<f64> = 0.5..1.6;
pub(crate) const WHITE_NOISE_KEPT_SIGMAS: f64 = 2.0;

// Where does the gap lie?

/// A place or a band is wrong by more than chance when its p-value, over all that were looked at, is below this.
/// Convention.
pub const SIGNIFICANT: f64 = 0.05;

// How far is the answer to be trusted, and how is it ordered?

/// A name is likely from this probability on: likelier than not.
pub(crate) const LIKELY: f64 = 0.5;
/// Share of what can be closed beyond the refit from which on the names carry the answer: the larger half.
pub(crate) const ENOUGH_CLOSED: f64 = 0.5;
/// Fall of the error 1 s ahead for which moved base parameters matter: a share of the noise floor, and mm.
pub(crate) const PARAMETERS_SHARE: f64 = 0.05;
pub(crate) const PARAMETERS_MM: f64 = 0.5;
/// The same as a share of the length of the pipe, for rigs with less room: 0.5 mm of 600.
pub(crate) const PARAMETERS_OF_LENGTH: f64 = PARAMETERS_MM / 600.0;
/// An error this many times the noise floor is a gap whose closed share can be told.
pub(crate) const OPEN_GAP: f64 = 1.5;
/// One mean square is larger than another from this ratio on: the order of the names, and a filter that loses track.
pub(crate) const LARGER: f64 = 2.0;
/// Factors on the widths of intervals: by how near the catalogue's form comes to what rigs do, and of the base
/// parameters. Chosen: so that some 90 % of withheld values lie within.
pub(crate) const WIDER_IMPACTS: f64 = 2.5;
pub(crate) const WIDER_APPROXIMATE: f64 = 1.9;
pub(crate) const WIDER: f64 = 1.25;
/// A gain off by more than this factor either way, or a drag larger by more, is of another rig or unit.
pub(crate) const OTHER_RIG: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::{
        ALONE, BURSTS, EVENTS, FIRST_EFFECT, MEAN_BESIDE_RANDOM_FORCE, OMITTED_BESIDE_NAME, RANDOM_FORCE, TOGETHER,
        UNEVEN_VARIANCE, WHITENESS,
    };
    use crate::options::Options;
    use crate::record::folds::Folds;
    use crate::residual::misfit::Misfit;
    use crate::select::candidates::candidates;
    use crate::select::random_force::is_random_force;
    use crate::select::refit::refitted;
    use crate::select::search::Search;
    use crate::tests_support::{model, record};
    use rayon::prelude::*;

    /// Flights, and the first of their seeds, which nothing else uses.
    const FLIGHTS: u64 = 200;
    const FIRST_SEED: u64 = 770_000;
    /// Their lengths, seconds: a usual one, and one with little more than [`ENOUGH_READINGS`](super::ENOUGH_READINGS).
    const LENGTHS_S: [u32; 2] = [60, 5];

    /// What one flight of a right model says: each statistic beside the threshold that it must not pass.
    fn statistics(seed: u64, seconds: u32) -> Vec<(&'static str, f64, f64)> {
        let (belief, recording) = (model(), record(&model(), seed, seconds));
        let folds = Folds::new(&belief, &recording);
        let search = Search::new(&belief, &recording, &folds, &Options::default());
        let fit = refitted(&search);
        let misfit = Misfit::of(&search.problem, &fit, None);
        let found = candidates(&search, &fit).0;
        let best = |random: bool| {
            let own = found.iter().filter(|candidate| is_random_force(candidate.entry) == random);
            own.map(|candidate| candidate.penalised_gain).fold(f64::NEG_INFINITY, f64::max)
        };
        vec![
            ("FIRST_EFFECT", best(false), FIRST_EFFECT),
            ("RANDOM_FORCE", best(true), RANDOM_FORCE),
            ("ALONE, score test", misfit.omitted, ALONE),
            ("ALONE, spectral line", misfit.spectral_line, ALONE),
            ("ALONE, uneven mean", misfit.mean_by_place, ALONE),
            ("ALONE, air", misfit.air_growth_nats(), ALONE),
            ("WHITENESS", misfit.whiteness, WHITENESS),
            ("UNEVEN_VARIANCE", misfit.variance_by_place, UNEVEN_VARIANCE),
            ("TOGETHER", misfit.joint_nats(), TOGETHER),
            ("EVENTS", misfit.events, EVENTS),
            ("OMITTED_BESIDE_NAME", misfit.omitted, OMITTED_BESIDE_NAME),
            ("MEAN_BESIDE_RANDOM_FORCE", misfit.mean_by_place, MEAN_BESIDE_RANDOM_FORCE),
            ("BURSTS", misfit.bursts, BURSTS),
        ]
    }

    /// Slow: it prints how many flights of right models pass each threshold, and fails where the answer itself would be
    /// wrong.
    #[test]
    #[ignore = "some minutes; run it when a threshold is changed"]
    fn rates_of_false_alarms() {
        for seconds in LENGTHS_S {
            println!("flights of {seconds} s");
            let flights = (FIRST_SEED..FIRST_SEED + FLIGHTS).into_par_iter();
            let all: Vec<_> = flights.map(|seed| statistics(seed, seconds)).collect();
            for (at, (name, _, limit)) in all[0].iter().enumerate() {
                let mut values: Vec<f64> = all.iter().map(|flight| flight[at].1).collect();
                values.sort_by(f64::total_cmp);
                let passed = values.iter().filter(|value| *value > limit).count();
                let largest = values[values.len() - 1];
                println!("{name:26} limit {limit:5.1}: passed by {passed} of {FLIGHTS}, the largest {largest:.2}");
            }
            let named = all.iter().filter(|flight| flight[0].1 >= FIRST_EFFECT).count();
            assert!(named <= 2, "{named} of {FLIGHTS} right models have an effect named");
        }
    }
}

//! Whether the readings lie on a grid that is coarser than the file's resolution: a quantised sensor.
//!
//! ```text
//! on the grid: |y − φ − s·round((y − φ)/s)| ≤ max(0.8·r, 0.08·s)      s: step, φ: phase, r: resolution of the file
//! ```
//!
//! A reading without quantisation lies there only once in s/r times, so every reading that does is evidence for the
//! step.

use crate::record::known::Known;
use crate::record::recording::Recording;
use plant::Model;

/// Share of the readings that must lie on a grid: outliers may not.
const ON_GRID: f64 = 0.97;
/// Largest ratio of successive steps in the scan, and the largest step, mm.
const FINER: f64 = 1.0004;
const COARSEST_MM: f64 = 60.0;
/// The best step is chosen among those from the first one that passes down to this share of it.
const NEAR: f64 = 0.94;
/// It is sought no further than where its grid leaves that of the first one by so many steps over the range of the
/// readings. Chosen wide: the first one passes where its own grid leaves the true one by a share of a step.
const DRIFT: f64 = 2.0;
/// Number of levels that a step is first tried on, and the share of them that must lie on its grid: chance puts a sixth
/// there.
const FEW: usize = 40;
const FEW_ON_GRID: f64 = 0.7;
/// Number of differences between frequent levels that a step is tried on before, and how many of them must be its
/// multiples. Of a grid with 97 of 100 readings on it 94 of 100 are; chance makes a third so.
const DIFFERENCES: usize = 10;
const MULTIPLES: usize = 6;
/// Log-likelihood that a reading off the grid costs, nats: only an outlier is off the grid.
pub(crate) const OFF_GRID: f64 = 12.0;
/// Largest distance of a reading from the grid, in resolutions of the file: rounding gives half of one.
const EDGE: f64 = 0.8;
/// The same as a share of the step, so that the scan does not step over it.
const SLACK: f64 = 0.08;
/// Largest number of steps of a scan, whose time must not grow with the unit of the readings. The longest scan of the
/// records in `data` takes 5 million.
const MOST_STEPS: usize = 10_000_000;
/// A step counts as quantisation if it is at least this many times the noise of a reading.
const COARSE: f64 = 1.2;

/// Every value of a reading, and how often it occurs.
struct Levels(Vec<(f64, f64)>);

impl Levels {
    fn of(recording: &Recording) -> Self {
        let mut readings: Vec<f64> = recording.samples().iter().filter_map(|sample| sample.position_mm).collect();
        readings.sort_by(f64::total_cmp);
        Self(readings.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as f64)).collect())
    }

    /// Some of the levels, evenly chosen.
    fn few(&self) -> Self {
        Self(self.0.iter().step_by(self.0.len().div_ceil(FEW).max(1)).copied().collect())
    }

    /// From the lowest level to the highest, mm.
    fn range(&self) -> f64 {
        self.0.last().zip(self.0.first()).map_or(0.0, |(last, first)| last.0 - first.0)
    }

    /// Differences between some of the most frequent levels, evenly chosen.
    fn differences(&self) -> Vec<f64> {
        let mut counts: Vec<f64> = self.0.iter().map(|(_, count)| *count).collect();
        counts.sort_by(|a, b| b.total_cmp(a));
        let least = counts.get(DIFFERENCES).or(counts.last()).copied().unwrap_or(0.0);
        let frequent: Vec<f64> = self.0.iter().filter(|(_, count)| *count >= least).map(|(y, _)| *y).collect();
        let apart = (frequent.len() / (DIFFERENCES + 1)).max(1);
        let some: Vec<f64> = frequent.into_iter().step_by(apart).take(DIFFERENCES + 1).collect();
        some.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    /// Steps from `step` downwards, each so near to the next that the two grids are apart by no more than half of the
    /// slack at the ends of the range.
    fn finer(&self, step: f64) -> impl Iterator<Item = f64> {
        let range = self.range();
        std::iter::successors(Some(step), move |step| Some(step / (1.0 + SLACK * step / range).min(FINER)))
    }

    /// The phase at which most readings lie on a grid of `step` mm: the circular mean.
    fn phase_mm(&self, step: f64) -> f64 {
        let (sin, cos) = self.circular_sum(step);
        sin.atan2(cos) * step / std::f64::consts::TAU
    }

    /// The step near `step` mm that fits the levels best: least squares of the levels against their indices.
    fn fitted_step(&self, step: f64, fine: f64) -> CoarseStep {
        let phase = self.phase_mm(step);
        let on = self.0.iter().filter(|(y, _)| lies_on(*y, step, phase, fine));
        let points: Vec<(f64, f64)> = on.map(|(y, _)| (((y - phase) / step).round(), *y)).collect();
        let count = points.len().max(1) as f64;
        let (n, y) = points.iter().fold((0.0, 0.0), |(n, y), point| (n + point.0 / count, y + point.1 / count));
        let spread: f64 = points.iter().map(|point| (point.0 - n).powi(2)).sum();
        if spread < 1.0 {
            return CoarseStep { mm: step, sigma_mm: fine };
        }
        let mm = points.iter().map(|point| (point.0 - n) * (point.1 - y)).sum::<f64>() / spread;
        // The file rounds neighbouring levels alike: their errors do not average out.
        CoarseStep { mm, sigma_mm: fine / (4.0 * spread / count).sqrt() }
    }

    /// How closely the readings lie on a grid of `step` mm.
    fn closeness(&self, step: f64) -> f64 {
        let (sin, cos) = self.circular_sum(step);
        sin.hypot(cos)
    }

    fn circular_sum(&self, step: f64) -> (f64, f64) {
        let turn = std::f64::consts::TAU / step;
        let sum = |(s, c), (y, n): &(f64, f64)| (s + n * (turn * y).sin(), c + n * (turn * y).cos());
        self.0.iter().fold((0.0, 0.0), sum)
    }

    /// Share of the readings that lie on a grid of `step` mm.
    fn share(&self, step: f64, fine: f64) -> f64 {
        let phase = self.phase_mm(step);
        let (on, all) = self.0.iter().fold((0.0, 0.0), |(on, all), (y, n)| {
            (on + if lies_on(*y, step, phase, fine) { *n } else { 0.0 }, all + n)
        });
        on / f64::max(all, 1.0)
    }
}

fn lies_on(y: f64, step: f64, phase: f64, fine: f64) -> bool {
    let off = (y - phase) / step;
    (off - off.round()).abs() * step <= slack(step, fine)
}

/// Largest distance of a reading from its grid, mm.
fn slack(step: f64, fine: f64) -> f64 {
    (EDGE * fine).max(SLACK * step)
}

/// Whether enough of these differences between two levels are multiples of the step, for which no phase is needed.
fn are_multiples(differences: &[f64], step: f64, fine: f64) -> bool {
    let is_multiple = |difference: &&f64| {
        let steps = **difference / step;
        (steps - (steps + 0.5).floor()).abs() * step <= 2.0 * slack(step, fine)
    };
    DIFFERENCES * differences.iter().filter(is_multiple).count() >= MULTIPLES * differences.len()
}

/// The step of a quantised sensor, estimated from the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CoarseStep {
    /// The step, mm.
    pub(crate) mm: f64,
    /// Standard deviation of the step, mm: the file rounds every level.
    pub(crate) sigma_mm: f64,
}

/// The grid of a quantised sensor: the readings that it can give, at the resolution of the file.
pub(crate) struct Grid {
    step: f64,
    fine: f64,
    phase: f64,
}

impl Grid {
    /// The grid of `step` mm on which most readings lie.
    pub(crate) fn of(recording: &Recording, step: f64) -> Self {
        let levels = Levels::of(recording);
        let fine = recording.file_resolution_mm();
        let step = step.max(fine);
        Self { step, fine, phase: levels.phase_mm(step) }
    }

    /// Step and resolution of the file, mm; `None` for a reading that the sensor cannot give.
    pub(crate) fn cell(&self, y: f64) -> Option<(f64, f64)> {
        lies_on(y, self.step, self.phase, self.fine).then_some((self.step, self.fine))
    }
}

/// The believed noise that [`coarse_step`] was first called with, mm, and what it found. A search calls it in each
/// round, with the same noise, and a scan of a long range takes a second.
pub(crate) type KnownStep = Known<(f64, Option<CoarseStep>)>;

/// The coarsest grid on which the readings lie, if it is coarse compared with the believed noise and the file's
/// resolution.
pub(crate) fn coarse_step(recording: &Recording, model: &Model) -> Option<CoarseStep> {
    let noise_mm = model.noise.sensor_mm;
    let (known_mm, step) = recording.known_step().get_or_init(|| (noise_mm, coarser_than(recording, noise_mm)));
    if *known_mm == noise_mm { *step } else { coarser_than(recording, noise_mm) }
}

/// The scan for it.
fn coarser_than(recording: &Recording, noise_mm: f64) -> Option<CoarseStep> {
    let [lowest, highest] = recording.height_range();
    // Readings that span more are in another unit.
    if highest - lowest > Model::LONGEST_PIPE_MM {
        return None;
    }
    let levels = Levels::of(recording);
    let fine = recording.file_resolution_mm();
    let least = (COARSE * noise_mm).max(2.0 * fine);
    let narrow = levels.0.windows(2).filter(|pair| pair[1].0 - pair[0].0 < 0.9 * least).count();
    if narrow > levels.0.len() / 10 {
        return None;
    }
    let (few, differences) = (levels.few(), levels.differences());
    let passes = |step: &f64| {
        are_multiples(&differences, *step, fine)
            && few.share(*step, fine) >= FEW_ON_GRID
            && levels.share(*step, fine) >= ON_GRID
    };
    let first = levels.finer(COARSEST_MM).take(MOST_STEPS).take_while(|step| *step > least).find(passes)?;
    // The first step that passes is slightly too large; the best one is where the readings lie closest.
    let finest = first * NEAR.max(1.0 - DRIFT * first / levels.range());
    let near = levels.finer(first).take(MOST_STEPS).take_while(|step| *step > finest);
    let near = near.max_by(|a, b| levels.closeness(*a).total_cmp(&levels.closeness(*b)))?;
    Some(levels.fitted_step(near, fine))
}

#[cfg(test)]
mod tests {
    use super::{Grid, coarse_step};
    use crate::tests_support::{model, record};
    use crate::{Recording, Sample};

    fn coarse(step: f64, fine: f64, phase: f64) -> Recording {
        let flight = record(&model(), 1, 40);
        let round = |mm: f64| (((mm - phase) / step).round() * step + phase) / fine;
        let rows = flight
            .samples()
            .iter()
            .map(|s| Sample { position_mm: s.position_mm.map(|mm| round(mm).round() * fine), ..*s });
        Recording::new(rows.collect()).unwrap()
    }

    #[test]
    fn a_step_is_found_in_whole_and_in_fine_files_wherever_it_starts() {
        for (step, fine, phase) in [(7.3, 1.0, 0.0), (12.0, 0.01, 5.0), (5.5, 0.5, 2.0), (18.5, 1.0, -3.0)] {
            let found = coarse_step(&coarse(step, fine, phase), &model()).unwrap();
            assert!((found.mm - step).abs() < 4.0 * found.sigma_mm.max(1e-6), "{found:?} of {step} mm");
            assert!(found.sigma_mm < 0.01 * step, "{found:?}");
        }
    }

    #[test]
    fn a_step_far_finer_than_the_range_is_found_whole_at_half_a_step_from_zero() {
        // An encoder of 2156 steps a turn over several turns, as 100 mm/rad with four digits behind the point.
        let (step, all) = (0.291_47, 3000);
        let at = |k: i32| ((f64::from(k * 37 % all) + 0.5) * step / 1e-4).round() * 1e-4;
        let row = |k: i32| Sample { time_s: 0.01 * f64::from(k), position_mm: Some(at(k)), ..Sample::default() };
        let recording = Recording::new((0..2900).map(row).collect()).unwrap();
        let mut quiet = model();
        quiet.noise.sensor_mm = 0.1;
        let found = coarse_step(&recording, &quiet).unwrap();
        assert!((found.mm / step - 1.0).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn the_step_follows_the_believed_noise_whatever_was_asked_before() {
        let recording = coarse(7.3, 1.0, 0.0);
        let mut loud = model();
        loud.noise.sensor_mm = 7.0;
        for _ in 0..2 {
            assert!(coarse_step(&recording, &model()).is_some());
            assert_eq!(coarse_step(&recording, &loud), None);
        }
    }

    #[test]
    fn readings_as_fine_as_their_noise_lie_on_no_grid() {
        assert_eq!(coarse_step(&coarse(1.0, 1.0, 0.0), &model()), None);
        assert_eq!(coarse_step(&record(&model(), 2, 40), &model()), None);
    }

    #[test]
    fn a_reading_between_two_steps_has_no_cell() {
        let recording = coarse(8.0, 1.0, 0.0);
        let grid = Grid::of(&recording, 8.0);
        assert!(grid.cell(240.0).is_some() && grid.cell(244.0).is_none());
    }
}

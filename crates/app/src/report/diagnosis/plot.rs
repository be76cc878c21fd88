//! The picture of a diagnosis: free runs before and after the mend, and the missing force over time, duty, height and
//! speed.
//!
//! Over duty, height and speed the force is shown as its mean and standard deviation in bins with equally many readings
//! each. The places where the belief is significantly wrong are shaded; that significance comes from the innovations,
//! never from this force.

use crate::report::kit::palette::{FORCE, MENDED, NOMINAL};
use crate::report::kit::plot::{Diagram, Line, PlotError, drawn, forecasts, panel, recorded, titled, write};
use config::words::Words;
use diagnose::{Diagnosis, FormulaCurve, MissingForce, Place, Series};
use plant::Stage;
use std::path::Path;

/// A sheet of diagrams: its size, pixels, where its rows end, and the largest number of moments of the force over time.
struct Sheet {
    size: (u32, u32),
    rows: [u32; 2],
    most_moments: usize,
}

/// A separate picture, and one for a page of the gallery.
const WHOLE: Sheet = Sheet { size: (1100, 940), rows: [380, 640], most_moments: usize::MAX };
const SMALL: Sheet = Sheet { size: (700, 700), rows: [250, 460], most_moments: 500 };
/// Bins over which the force is averaged, and fewest readings in one.
const PLACES: usize = 24;
const FEWEST: usize = 5;
const UNIT: &str = "residual force, mm/s²";
/// Largest number of points of the force over time.
const MOST_POINTS: usize = 4000;

/// Draws a diagnosis; `places` are shaded.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn diagnosis(path: &Path, title: &str, picture: &Series, places: &[Place], words: &Words) -> Result<(), PlotError> {
    write(path, &words.of_markup(&WHOLE.drawn(title, picture, places)?))
}

/// The same in a small picture without a title.
///
/// # Errors
/// [`PlotError`] names the file.
pub fn small_diagnosis(path: &Path, picture: &Series, places: &[Place]) -> Result<(), PlotError> {
    write(path, &SMALL.drawn("", picture, places)?)
}

impl Sheet {
    fn drawn(&self, title: &str, picture: &Series, places: &[Place]) -> Result<String, PlotError> {
        drawn(self.size, |area| {
            let rows = self.rows.map(|end| area.dim_in_pixel().1 * end / self.size.1);
            let (upper, rest) = area.split_vertically(rows[0]);
            titled(&upper, title, &runs(picture))?;
            if picture.missing.is_empty() {
                return Ok(());
            }
            let (middle, lower) = rest.split_vertically(rows[1] - rows[0]);
            let every = picture.missing.len().div_ceil(self.most_moments).max(1);
            let moments: Vec<MissingForce> = picture.missing.iter().step_by(every).copied().collect();
            panel(&middle, &over_time(&moments, places))?;
            let thirds = lower.split_evenly((1, 3));
            let mut over = thirds.iter().zip(over_signals(&picture.missing, places));
            over.try_for_each(|(third, diagram)| panel(third, &diagram))
        })
    }
}

type Of = fn(&MissingForce) -> f64;
const SIGNALS: [(&str, &str, Of); 3] = [
    ("duty_percent", "duty, %", |moment| moment.duty_percent),
    ("position_mm", "height, mm", |moment| moment.position_mm),
    ("velocity_mm_per_s", "speed, mm/s", |moment| moment.velocity_mm_per_s),
];

fn shaded(places: &[Place], signal: &str) -> Vec<(f64, f64)> {
    places.iter().filter(|place| place.signal == signal).map(|place| (place.from, place.to)).collect()
}

/// Recorded positions, and free runs before and after the mend.
pub fn runs(picture: &Series) -> Diagram {
    let lines = vec![
        recorded(&picture.recording),
        forecasts("as believed", NOMINAL, &picture.recording, &picture.nominal),
        forecasts("mended", MENDED, &picture.recording, &picture.mended),
    ];
    Diagram { abscissa: "time, s", ordinate: "position, mm", lines, ..Diagram::default() }
}

/// The missing force over time, and its standard deviation.
pub fn over_time(missing: &[MissingForce], places: &[Place]) -> Diagram {
    let every = missing.len().div_ceil(MOST_POINTS).max(1);
    let kept = || missing.iter().step_by(every);
    let side = |sign: f64| move |m: &MissingForce| (m.time_s, m.force_mm_per_s2 + sign * m.sigma_mm_per_s2);
    let band = kept().map(side(1.0)).chain(kept().rev().map(side(-1.0))).collect();
    let points = kept().map(|m| (m.time_s, m.force_mm_per_s2)).collect();
    let lines = vec![Line { label: "± 1σ", colour: FORCE, points }];
    let shaded = shaded(places, "time_s");
    Diagram { abscissa: "time, s", ordinate: UNIT, lines, band, shaded, base: Some(0.0), ..Diagram::default() }
}

/// Mean and scatter of the missing force over duty, height and speed.
pub fn over_signals(missing: &[MissingForce], places: &[Place]) -> [Diagram; 3] {
    SIGNALS.map(|(signal, abscissa, of)| {
        let means = means(missing.iter().map(|moment| (of(moment), moment.force_mm_per_s2)).collect());
        let low = means.iter().rev().map(|(at, mean, scatter)| (*at, mean - scatter));
        let band = means.iter().map(|(at, mean, scatter)| (*at, mean + scatter)).chain(low).collect();
        let points = means.iter().map(|(at, mean, _)| (*at, *mean)).collect();
        let lines = vec![Line { label: "mean ± scatter", colour: FORCE, points }];
        let shaded = shaded(places, signal);
        Diagram { abscissa, ordinate: UNIT, lines, band, shaded, base: Some(0.0), ..Diagram::default() }
    })
}

/// The terms of the formula over the signal that each depends on, each with its words.
pub fn formula(found: &Diagnosis, missing: &[MissingForce]) -> Vec<(&'static str, Diagram)> {
    let range = |of: Of| {
        let values = missing.iter().map(of);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    };
    let diagram = |FormulaCurve { over, stage, words, points }: FormulaCurve| {
        let end = |at: usize| move |point: &[f64; 4]| (point[0], point[at]);
        let band = points.iter().map(end(3)).chain(points.iter().rev().map(end(2))).collect();
        let line = Line { label: "formula, 90 % band", colour: MENDED, points: points.iter().map(end(1)).collect() };
        let abscissa = SIGNALS[over as usize].1;
        let ordinate = match stage {
            Stage::Actuator => "added duty, %",
            Stage::Air | Stage::Ball => "added force, mm/s²",
            Stage::Sensor => "added to the reading, mm",
        };
        (words, Diagram { abscissa, ordinate, lines: vec![line], band, base: Some(0.0), ..Diagram::default() })
    };
    let ranges = SIGNALS.map(|(.., of)| range(of));
    if missing.is_empty() { Vec::new() } else { found.formula_curves(ranges).into_iter().map(diagram).collect() }
}

/// Middle of each bin, and mean and standard deviation of the force there.
fn means(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let places = points.chunks(points.len().div_ceil(PLACES).max(FEWEST));
    let mean =
        |place: &[(f64, f64)], of: &dyn Fn(&(f64, f64)) -> f64| place.iter().map(of).sum::<f64>() / place.len() as f64;
    places
        .map(|place| {
            let (at, force) = (mean(place, &|point| point.0), mean(place, &|point| point.1));
            (at, force, mean(place, &|point| (point.1 - force).powi(2)).sqrt())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::means;

    #[test]
    fn the_mean_of_a_place_is_that_of_its_readings_in_the_order_of_the_abscissa() {
        // 240 readings in 24 bins of 10: force 2·x, so that each mean is twice the middle and the deviation that of ten
        // steps.
        let points = (0..240).rev().map(|k| (f64::from(k), 2.0 * f64::from(k))).collect();
        let found = means(points);
        assert_eq!(found.len(), 24);
        for (k, (at, force, scatter)) in (0..).zip(found) {
            assert!((at - (10.0 * f64::from(k) + 4.5)).abs() < 1e-9 && (force - 2.0 * at).abs() < 1e-9);
            assert!((scatter - 2.0 * (99.0_f64 / 12.0).sqrt()).abs() < 1e-9, "{scatter}");
        }
    }
}

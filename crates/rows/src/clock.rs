//! Times of a clock that is coarser than the rows: several rows share a stamp.
//!
//! ```text
//! row j of the n rows at the stamp T_k:   t = T_k + j·min(T_k+1 − T_k, tick)/n      tick: the usual T_k+1 − T_k
//! ```
//!
//! The first stamp may begin within a tick, so its rows end at the second one; the last may end within one, so its rows
//! are as far apart as those before it.

/// Whether more than half of the rows repeat the time of the row before.
#[must_use]
pub fn is_coarse(time_s: &[f64]) -> bool {
    let repeats = time_s.windows(2).filter(|pair| pair[0] == pair[1]).count();
    2 * repeats > time_s.len()
}

/// Spreads the rows of each stamp evenly up to the next stamp. The times must not decrease.
pub fn spread(time_s: &mut [f64]) {
    let stamps: Vec<(f64, usize)> = time_s.chunk_by(|a, b| a == b).map(|rows| (rows[0], rows.len())).collect();
    let mut ticks: Vec<f64> = stamps.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    ticks.sort_by(f64::total_cmp);
    let Some(&tick) = ticks.get(ticks.len() / 2) else { return };
    let own_step = |pair: &[(f64, usize)]| (pair[1].0 - pair[0].0).min(tick) / pair[0].1 as f64;
    let mut steps: Vec<f64> = stamps.windows(2).map(own_step).collect();
    if let [first, second, ..] = &mut steps[..] {
        *first = first.min(*second);
    }
    steps.extend(steps.last().copied());
    let late = stamps.get(1).map_or(0.0, |second| (second.0 - stamps[0].0).min(tick) - steps[0] * stamps[0].1 as f64);
    let mut rows = time_s.iter_mut();
    for (at, ((stamp, count), step)) in stamps.iter().zip(&steps).enumerate() {
        let start = if at == 0 { stamp + late } else { *stamp };
        rows.by_ref().take(*count).enumerate().for_each(|(row, time)| *time = start + row as f64 * step);
    }
}

#[cfg(test)]
mod tests {
    use super::{is_coarse, spread};

    /// Times 0.05 s apart from 0.65 s on, as a clock of whole seconds writes them, and as they are.
    fn stamps(rows: usize) -> (Vec<f64>, Vec<f64>) {
        let exact: Vec<f64> = (0..rows).map(|row| 0.65 + 0.05 * row as f64).collect();
        (exact.iter().map(|time| (time + 1e-9).floor()).collect(), exact)
    }

    #[test]
    fn rows_of_a_clock_of_whole_seconds_get_the_times_at_which_they_were_written() {
        let (mut times, exact) = stamps(100);
        assert!(is_coarse(&times) && !is_coarse(&exact));
        spread(&mut times);
        times.iter().zip(&exact).for_each(|(time, exact)| assert!((time - exact).abs() < 1e-6, "{time} {exact}"));
    }

    #[test]
    fn rows_before_a_pause_are_as_far_apart_as_others() {
        let (mut times, _) = stamps(100);
        times[47..].iter_mut().for_each(|time| *time += 10.0);
        spread(&mut times);
        assert!((times[46] - times[45] - 0.05).abs() < 1e-6 && times[47] == 13.0, "{:?}", &times[44..49]);
    }

    #[test]
    fn one_stamp_alone_is_left_as_it_is() {
        let mut times = vec![3.0; 5];
        spread(&mut times);
        assert_eq!(times, [3.0; 5]);
        spread(&mut []);
    }
}

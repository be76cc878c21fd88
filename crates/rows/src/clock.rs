//! Times of a clock that is coarser than the rows: several rows share a timestamp.
//!
//! ```text
//! row j of the n rows at the timestamp T_k:   t = T_k + j·min(T_k+1 − T_k, tick)/n      tick: the usual T_k+1 − T_k
//! ```
//!
//! The record may begin within the tick of the first timestamp, so its rows end at the second one. It may end within
//! the tick of the last, so its rows are as far apart as those before it.

/// The column of times with the rows of each timestamp spread evenly up to the next one, in the column's own unit.
/// `None`: not every row has a time, or no more than half of the rows repeat the time of the row before.
#[must_use]
pub fn spread_if_coarse(times: &[Option<f64>]) -> Option<Vec<Option<f64>>> {
    let mut times: Vec<f64> = times.iter().copied().collect::<Option<_>>()?;
    if !is_coarse(&times) {
        return None;
    }
    spread(&mut times);
    Some(times.into_iter().map(Some).collect())
}

fn is_coarse(times: &[f64]) -> bool {
    let repeats = times.windows(2).filter(|pair| pair[0] == pair[1]).count();
    2 * repeats > times.len()
}

/// Spreads the rows of each timestamp evenly up to the next one. The times must not decrease.
pub(crate) fn spread(times: &mut [f64]) {
    let mut stamps: Vec<(f64, usize)> = times.chunk_by(|a, b| a == b).map(|rows| (rows[0], rows.len())).collect();
    let mut lengths: Vec<f64> = stamps.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    lengths.sort_by(f64::total_cmp);
    let Some(&tick) = lengths.get(lengths.len() / 2) else { return };
    let own_step = |pair: &[(f64, usize)]| (pair[1].0 - pair[0].0).min(tick) / pair[0].1 as f64;
    let mut steps: Vec<f64> = stamps.windows(2).map(own_step).collect();
    if let [first, second, ..] = &mut steps[..] {
        let own = *first;
        *first = own.min(*second);
        let (start, count) = &mut stamps[0];
        *start += *count as f64 * (own - *first);
    }
    steps.extend(steps.last().copied());
    let mut rows = times.iter_mut();
    for ((start, count), step) in stamps.into_iter().zip(steps) {
        rows.by_ref().take(count).enumerate().for_each(|(row, time)| *time = start + row as f64 * step);
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
    fn one_timestamp_alone_is_left_as_it_is() {
        let mut times = vec![3.0; 5];
        spread(&mut times);
        assert_eq!(times, [3.0; 5]);
        spread(&mut []);
    }
}

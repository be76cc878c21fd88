//! The block bootstrap: an interval of a statistic of the forecast errors, from stretches of the record that are drawn
//! again with replacement, which gives the variation between flights of the same kind.
//!
//! It needs no normal distribution. Where a few stretches have most of the error, as with dry friction, the standard
//! error of the mean is large although the sign of the mean is certain.
//! Source: Künsch, "The jackknife and the bootstrap for general stationary observations", Annals of Statistics 17
//! (1989).

use crate::gap::forecast_error::Tally;
use plant::Normal;

/// Number of draws: the 5 % quantile of so many is off by one percent of the distribution, √(0.05·0.95/500).
const DRAWS: usize = 500;

/// The 90 % interval of a statistic of `count` stretches, given the indices of those that were drawn. `None`: it is no
/// number in any draw.
pub(crate) fn interval(count: usize, statistic: impl Fn(&[usize]) -> Option<f64>) -> Option<[f64; 2]> {
    let mut chance = Normal::new(0, 11);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length")]
    let mut draw = || ((chance.uniform() * count as f64) as usize).min(count - 1);
    let draws = (0..DRAWS).filter_map(|_| statistic(&(0..count).map(|_| draw()).collect::<Vec<_>>()));
    let mut draws: Vec<f64> = draws.filter(|value| value.is_finite()).collect();
    draws.sort_by(f64::total_cmp);
    let at = |part: usize| draws.get(draws.len() * part / 20).or(draws.last()).copied();
    at(1).zip(at(19)).map(<[f64; 2]>::from)
}

/// Mean square at 1 s over the stretches with these indices, mm².
pub(crate) fn square(all: &[Tally], at: &[usize]) -> Option<f64> {
    Tally::sum(at.iter().map(|k| &all[*k])).square_at_1_s()
}

/// Whether the mean square at 1 s is lower in `these` than in `those` by more than chance: a one-sided test at 5 %, the
/// lower end of the interval. The interval of the share that is closed is of the same draws, so that both agree.
pub(crate) fn is_lower(these: &[Tally], those: &[Tally]) -> bool {
    let fall = |at: &[usize]| Some(square(those, at)? - square(these, at)?);
    let count = these.len().min(those.len());
    interval(count, fall).is_some_and(|[low, _]| low > 0.0)
}

#[cfg(test)]
mod tests {
    use super::interval;

    /// The interval of the mean of some numbers.
    fn of_mean(numbers: &[f64]) -> [f64; 2] {
        let mean = |at: &[usize]| Some(at.iter().map(|k| numbers[*k]).sum::<f64>() / at.len() as f64);
        interval(numbers.len(), mean).unwrap()
    }

    #[test]
    fn the_interval_of_a_mean_of_normal_numbers_is_that_of_its_standard_error() {
        let mut chance = plant::Normal::new(3, 5);
        let numbers: Vec<f64> = (0..400).map(|_| 2.0 + chance.draw()).collect();
        let [low, high] = of_mean(&numbers);
        // 90 % of a normal distribution lie within 1.645 deviations; here of 1/20.
        assert!((high - low - 2.0 * 1.645 / 20.0).abs() < 0.02 && low < 2.0 && high > 2.0, "{low} {high}");
    }

    #[test]
    fn a_gain_that_a_few_stretches_have_is_above_chance_though_its_standard_error_is_wide() {
        let gains = [400.0, 60.0, 40.0, 20.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0];
        let count = gains.len() as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0);
        assert!(mean < 1.645 * (variance / count).sqrt(), "a normal distribution cannot tell it from chance");
        assert!(of_mean(&gains)[0] > 0.0);
        // One stretch of two is chance.
        assert!(of_mean(&[400.0, -1.0])[0] < 0.0);
    }

    #[test]
    fn nothing_has_no_interval() {
        assert_eq!(interval(0, |_| Some(1.0)), Some([1.0; 2]));
        assert_eq!(interval(3, |_| None), None);
    }
}

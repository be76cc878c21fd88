//! The standard deviation of a sample.

/// The standard deviation of `values`, in their unit; `None` where they do not differ.
pub(crate) fn spread(values: impl Iterator<Item = f64>) -> Option<f64> {
    let all: Vec<f64> = values.collect();
    let n = all.len() as f64;
    let mean = all.iter().sum::<f64>() / n;
    let spread = (all.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt();
    (spread.is_finite() && spread > 0.0).then_some(spread)
}

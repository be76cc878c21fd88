//! The least-squares line through points.

/// Slope and offset of the least-squares line through the points. `None`: the points determine no slope.
pub(crate) fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (t, y) = (mean(|p| p.0), mean(|p| p.1));
    let square: f64 = points.iter().map(|p| (p.0 - t).powi(2)).sum();
    let slope = points.iter().map(|p| (p.0 - t) * (p.1 - y)).sum::<f64>() / square;
    slope.is_finite().then_some((slope, y - slope * t))
}

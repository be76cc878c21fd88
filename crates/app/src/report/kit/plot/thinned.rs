//! A line with no more points than are visible.

/// A line with about `most` points: the minimum and the maximum of each part, so that no peak is lost. A line whose
/// abscissa turns back, as that of a circle, is not changed.
pub(super) fn thinned(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most.max(2) || !points.is_sorted_by_key(|point| point.0) {
        return points.to_vec();
    }
    let stretch = (2 * points.len()).div_ceil(most.max(2));
    points.chunks(stretch).filter_map(extremes).flatten().collect()
}

/// The points with the least and the greatest ordinate, in the order of their abscissas. `None`: there is no point.
pub fn extremes(points: &[(f64, f64)]) -> Option<[(f64, f64); 2]> {
    let by_ordinate = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    let mut both = [*points.iter().min_by(by_ordinate)?, *points.iter().max_by(by_ordinate)?];
    both.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some(both)
}

#[cfg(test)]
mod tests {
    use super::thinned;

    #[test]
    fn a_thinned_line_keeps_its_peaks_and_its_order() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|k| (f64::from(k), 0.0)).collect();
        points[54_321].1 = 9.0;
        points[65_432].1 = -9.0;
        let thin = thinned(&points, 4000);
        assert!(thin.len() <= 4002, "{}", thin.len());
        assert!(thin.contains(&(54_321.0, 9.0)) && thin.contains(&(65_432.0, -9.0)));
        assert!(thin.is_sorted_by_key(|p| p.0));
    }

    #[test]
    fn a_circle_stays_a_circle() {
        let circle: Vec<(f64, f64)> = (0..1000).map(|k| (0.01 * f64::from(k)).sin_cos()).collect();
        assert_eq!(thinned(&circle, 100), circle);
    }
}

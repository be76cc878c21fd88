//! A line with no more points than are visible.

/// A line with about `most` points: the minimum and the maximum of each part, so that no peak is lost. A line whose
/// abscissa turns back, as that of a circle, is not changed.
pub(super) fn thinned(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most.max(2) || !points.is_sorted_by_key(|point| point.0) {
        return points.to_vec();
    }
    let stretch = (2 * points.len()).div_ceil(most.max(2));
    let extremes = |piece: &[(f64, f64)]| {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let mut both: Vec<(f64, f64)> =
            piece.iter().min_by(by_value).into_iter().chain(piece.iter().max_by(by_value)).copied().collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        both
    };
    points.chunks(stretch).flat_map(extremes).collect()
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

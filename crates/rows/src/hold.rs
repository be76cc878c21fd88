//! Columns that a log fills in some rows only, since each row holds what one of several clocks wrote: an empty cell
//! repeats the last value.

/// The values, where an empty one repeats the last before it. Those before the first value stay empty.
pub(crate) fn held(values: &[Option<f64>]) -> Vec<Option<f64>> {
    let repeat = |last: &mut Option<f64>, value: &Option<f64>| {
        *last = value.or(*last);
        Some(*last)
    };
    values.iter().scan(None, repeat).collect()
}

/// The column with its last value in each empty cell. `None`: no more than half of its cells are empty.
#[must_use]
pub fn held_if_sparse(values: &[Option<f64>]) -> Option<Vec<Option<f64>>> {
    let empty = values.iter().filter(|value| value.is_none()).count();
    (2 * empty > values.len()).then(|| held(values))
}

#[cfg(test)]
mod tests {
    use super::held_if_sparse;

    #[test]
    fn an_empty_cell_repeats_the_last_value_where_most_cells_are_empty() {
        let sparse = [None, Some(1.0), None, None, Some(2.0), None];
        let held = [None, Some(1.0), Some(1.0), Some(1.0), Some(2.0), Some(2.0)];
        assert_eq!(held_if_sparse(&sparse).as_deref(), Some(&held[..]));
        assert_eq!(held_if_sparse(&[Some(1.0), None, Some(2.0), None]), None);
    }
}

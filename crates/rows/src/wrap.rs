//! Counters that wrap: `millis()` in 16 bits begins again after 65.5 s, `micros()` in 32 bits after 72 minutes.

/// The first number above those of a counter, and its lowest number.
const COUNTERS: [(f64, f64); 6] = [
    (65_536.0, 0.0),
    (32_768.0, 0.0),
    (32_768.0, -32_768.0),
    (4_294_967_296.0, 0.0),
    (2_147_483_648.0, 0.0),
    (2_147_483_648.0, -2_147_483_648.0),
];
/// A wrap goes from the last numbers of a counter to its first ones, of this share of all. Chosen: a pause that is
/// longer looks like a restart.
const NEAR: f64 = 0.01;

/// The numbers of a counter that wraps as numbers that go on; all whole, as a counter has them. `None`: they never
/// decrease, or not by a wrap.
pub(crate) fn unwrapped(values: &[f64]) -> Option<Vec<f64>> {
    let decreases = || values.windows(2).filter(|pair| pair[1] < pair[0]);
    let (top, bottom) = decreases().next().and_then(|pair| counter(pair[0], pair[1]))?;
    let is_whole = values.iter().all(|value| value.fract() == 0.0);
    if !is_whole || decreases().any(|pair| counter(pair[0], pair[1]) != Some((top, bottom))) {
        return None;
    }
    let (mut turns, mut last) = (0.0, f64::NEG_INFINITY);
    let on = |value: &f64| {
        turns += if *value < last { top - bottom } else { 0.0 };
        last = *value;
        value + turns
    };
    Some(values.iter().map(on).collect())
}

/// The counter that goes from `last` to `next` by a wrap.
fn counter(last: f64, next: f64) -> Option<(f64, f64)> {
    COUNTERS.into_iter().find(|(top, bottom)| {
        let near = NEAR * (top - bottom);
        last < *top && next >= *bottom && top - last < near && next - bottom < near
    })
}

#[cfg(test)]
mod tests {
    use super::unwrapped;

    #[test]
    fn a_counter_of_16_bits_goes_on_where_it_wraps() {
        let counted = |from: f64| (0..20_000).map(|k| from + (10.0 * f64::from(k)) % 65_536.0).collect::<Vec<_>>();
        let all = (0..20_000).map(|k| 10.0 * f64::from(k)).collect::<Vec<_>>();
        assert_eq!(unwrapped(&counted(0.0)), Some(all.clone()));
        assert_eq!(unwrapped(&counted(-32_768.0)), Some(all.iter().map(|time| time - 32_768.0).collect()));
    }

    #[test]
    fn a_restart_and_rows_in_another_order_are_no_wrap() {
        for times in [&[0.0, 10.0, 20.0, 0.0, 10.0][..], &[65_500.0, 40.0, 50.0, 45.0], &[65_535.5, 0.5], &[1.0, 2.0]] {
            assert_eq!(unwrapped(times), None, "{times:?}");
        }
        assert_eq!(unwrapped(&[65_530.0, 4.0]), Some(vec![65_530.0, 65_540.0]));
        assert_eq!(unwrapped(&[32_760.0, 2.0]), Some(vec![32_760.0, 32_770.0]));
    }
}

//! The range of a power.

use crate::interval::Interval;
use crate::undefined::Undefined;

/// Of a base and an exponent that lie within these.
pub(crate) fn power(base: Interval, exponent: Interval) -> Result<Interval, Undefined> {
    if base.contains(0.0) && exponent.0 < 0.0 {
        return Err(Undefined::PowerOfZero(base.0, base.1));
    }
    if base.0 >= 0.0 {
        // Monotone in the base and in the exponent, each for itself: the extremes are at the corners.
        let corners = [(base.0, exponent.0), (base.0, exponent.1), (base.1, exponent.0), (base.1, exponent.1)];
        let corners = Interval::around(&corners.map(|(base, exponent)| libm::pow(base, exponent)));
        return Ok(not_negative(corners.widened()));
    }
    let whole = exponent.0 == exponent.1 && libm::floor(exponent.0) == exponent.0;
    if !whole {
        return Err(Undefined::PowerOfNegative(base.0, base.1));
    }
    Ok(whole_power(base, exponent.0))
}

/// Of a base that may be negative; not zero where the exponent is negative.
fn whole_power(base: Interval, exponent: f64) -> Interval {
    let even = libm::fmod(exponent, 2.0) == 0.0;
    let ends = Interval::around(&[libm::pow(base.0, exponent), libm::pow(base.1, exponent)]).widened();
    match (even, base.contains(0.0)) {
        (false, _) => ends,
        (true, false) => not_negative(ends),
        // x^0 is 1 everywhere, also at zero.
        (true, true) if exponent == 0.0 => Interval::point(1.0),
        (true, true) => Interval(0.0, ends.1),
    }
}

fn not_negative(interval: Interval) -> Interval {
    Interval(interval.0.max(0.0), interval.1)
}

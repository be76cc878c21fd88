//! The instant at which something crosses zero within a step.
//!
//! The Illinois variant of the rule of false position, superlinear, with a bisection every third round, safe.
//! Source: Dowell and Jarratt, *A Modified Regula Falsi Method*, BIT 11 (1971).

/// The bisections among them alone halve the bracket down to rounding.
const MAX_ROUNDS: u32 = 150;

/// A bracket as short as this part of the step is rounding.
const ROUNDING: f64 = 1e-14;

/// Where `f`, at least 0 at 0 and below 0 at `end`, crosses zero: the last point found before the crossing.
pub(crate) fn falling_zero(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    let (mut low, mut high) = (0.0, end);
    let (mut at_low, mut at_high) = (f(low), f(high));
    let close = ROUNDING * end;
    let mut rose = None;
    for round in 1..=MAX_ROUNDS {
        if at_low <= 0.0 || high - low <= 2.0 * close {
            break;
        }
        // A guess on top of an end is moved off it, so that the bracket closes round a zero that is found.
        let guess = (high - at_high * (high - low) / (at_high - at_low)).max(low + close).min(high - close);
        let middle = if round % 3 == 0 { f64::midpoint(low, high) } else { guess };
        let value = f(middle);
        let rises = value >= 0.0;
        // An end that stays twice pulls half as hard, or the other would creep.
        let pull = if rose == Some(rises) { 0.5 } else { 1.0 };
        if rises {
            (low, at_low, at_high) = (middle, value, at_high * pull);
        } else {
            (high, at_high, at_low) = (middle, value, at_low * pull);
        }
        rose = Some(rises);
    }
    low
}

#[cfg(test)]
mod tests {
    use super::falling_zero;

    #[test]
    fn a_crossing_is_found_to_rounding() {
        let check = |f: fn(f64) -> f64, exact: f64| {
            let found = falling_zero(f, 2.0);
            assert!((found - exact).abs() < 1e-12, "{found}, exact {exact}");
        };
        check(|t| 0.3 - t, 0.3);
        check(|t| 2.0 - t * t, std::f64::consts::SQRT_2);
        check(|t| 1e-9 - t.powi(9), 0.1);
        assert_eq!(falling_zero(|t| -t, 1.0), 0.0);
    }
}

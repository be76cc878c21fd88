//! Ranges by interval arithmetic.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by it")]
#![allow(clippy::float_cmp, reason = "exact numbers")]

mod random;

use formula::{Formula, Mistake, MistakeKind, Undefined};
use random::Random;

/// For x and v.
fn range(text: &str, x: (f64, f64), v: (f64, f64)) -> Result<(f64, f64), Mistake> {
    Formula::parse(text, &["x", "v"]).unwrap_or_else(|mistake| panic!("{text}: {mistake}")).range(&[x, v])
}

const X: (f64, f64) = (-1.0, 1.0);
const V: (f64, f64) = (2.0, 3.0);

#[test]
fn every_value_lies_within_the_range() {
    let mut random = Random(4);
    let (mut defined, mut narrow) = (0, 0);
    for _ in 0..10_000 {
        let formula = random.formula();
        let (one, other) = (random.point(), random.point());
        let bounds: [(f64, f64); 4] = std::array::from_fn(|k| (one[k].min(other[k]), one[k].max(other[k])));
        let Ok((low, high)) = formula.range(&bounds) else { continue };
        defined += 1;
        narrow += u32::from(high - low < 1e6);
        for sample in 0..20 {
            let point = bounds.map(|(low, high)| match sample {
                0 => low,
                1 => high,
                _ => random.within(low, high).clamp(low, high),
            });
            let value = formula.value(&point);
            assert!(low <= value && value <= high, "{formula} at {point:?}: {value} is not within {low} to {high}");
        }
    }
    assert!(defined > 4000 && narrow > 4000, "{defined} {narrow}");
}

#[test]
fn exact_operations_have_exact_ranges() {
    for (text, expected) in [
        ("x", X),
        ("7", (7.0, 7.0)),
        ("x + v", (1.0, 4.0)),
        ("x - v", (-4.0, -1.0)),
        ("x - x", (-2.0, 2.0)),
        ("-v", (-3.0, -2.0)),
        ("x * v", (-3.0, 3.0)),
        ("x / v", (-0.5, 0.5)),
        ("x^2", (0.0, 1.0)),
        ("(v - 5)^2", (4.0, 9.0)),
        ("x^3", (-1.0, 1.0)),
        ("(x + 1)^4", (0.0, 16.0)),
        ("x^0", (1.0, 1.0)),
        ("x * abs(x)", (-1.0, 1.0)),
        ("abs(x)", (0.0, 1.0)),
        ("abs(-v)", (2.0, 3.0)),
        ("sign(x)", (-1.0, 1.0)),
        ("sign(v)", (1.0, 1.0)),
        ("min(x, 0.5)", (-1.0, 0.5)),
        ("max(x, 0.5)", (0.5, 1.0)),
        ("clamp(x, -0.5, 0.25)", (-0.5, 0.25)),
        ("sqrt(v + 1)", (libm::sqrt(3.0), 2.0)),
        ("if(x < v, 1, 2)", (1.0, 1.0)),
        ("if(x > v, 1, 2)", (2.0, 2.0)),
        ("if(x < 0, 1, 2)", (1.0, 2.0)),
        ("if(v <= 3, 1, 2)", (1.0, 1.0)),
        ("if(v < 3, 1, 2)", (1.0, 2.0)),
        ("sin(v * 10)", (-1.0, 1.0)),
    ] {
        assert_eq!(range(text, X, V), Ok(expected), "{text}");
    }
}

#[test]
fn approximated_operations_have_ranges_that_are_wider_by_their_error_only() {
    for (text, (low, high)) in [
        ("exp(x)", (libm::exp(-1.0), libm::exp(1.0))),
        ("ln(v)", (libm::log(2.0), libm::log(3.0))),
        ("tanh(x)", (libm::tanh(-1.0), libm::tanh(1.0))),
        ("sin(x)", (libm::sin(-1.0), libm::sin(1.0))),
        ("cos(x)", (libm::cos(1.0), 1.0)),
        ("sin(v)", (libm::sin(3.0), libm::sin(2.0))),
        ("cos(v)", (libm::cos(3.0), libm::cos(2.0))),
        ("sin(v / 2)", (libm::sin(1.0), libm::sin(1.5))),
        ("v^0.5", (libm::sqrt(2.0), libm::sqrt(3.0))),
        ("v^-1", (1.0 / 3.0, 0.5)),
        ("(-v)^-1", (-0.5, -1.0 / 3.0)),
        ("(-v)^-2", (1.0 / 9.0, 0.25)),
        ("x^6", (0.0, 1.0)),
        ("x^5", (-1.0, 1.0)),
        ("v^x", (1.0 / 3.0, 3.0)),
    ] {
        let (ours_low, ours_high) = range(text, X, V).unwrap();
        let near = |ours: f64, exact: f64| (ours - exact).abs() < 1e-14;
        assert!(ours_low <= low && high <= ours_high, "{text}: {ours_low} to {ours_high}");
        assert!(near(ours_low, low) && near(ours_high, high), "{text}: {ours_low} to {ours_high}");
    }
}

#[test]
fn an_approximated_result_leaves_room_for_its_error() {
    for text in ["exp(v)", "ln(v)", "tanh(v)", "sin(v)", "v^1.5", "(-v)^5"] {
        let (low, high) = range(text, (2.0, 2.0), (2.0, 2.0)).unwrap();
        let value = Formula::parse(text, &["x", "v"]).unwrap().value(&[2.0, 2.0]);
        assert!(low < value && value < high, "{text}: {low} to {high}");
    }
}

#[test]
fn what_can_be_undefined_is_refused_at_its_column() {
    for (text, column, undefined) in [
        ("1/x", 2, Undefined::DivisorMayBeZero(-1.0, 1.0)),
        ("2 + v / (x + 1)", 7, Undefined::DivisorMayBeZero(0.0, 2.0)),
        ("1 / 0", 3, Undefined::DivisorMayBeZero(0.0, 0.0)),
        ("1 + sqrt(x)", 5, Undefined::RootOfNegative(-1.0, 1.0)),
        ("1 + ln(x + 1)", 5, Undefined::LogarithmOfNonPositive(0.0, 2.0)),
        ("1 + x^0.5", 6, Undefined::PowerOfNegative(-1.0, 1.0)),
        ("x^v", 2, Undefined::PowerOfNegative(-1.0, 1.0)),
        ("x^-1", 2, Undefined::PowerOfZero(-1.0, 1.0)),
        ("abs(x)^x", 7, Undefined::PowerOfZero(0.0, 1.0)),
        ("x + exp(v * 1000)", 5, Undefined::Overflow),
        ("v * 1e308", 3, Undefined::Overflow),
        ("1e308 * 10", 7, Undefined::Overflow),
        ("if(x < 0, 1, 1 / x)", 16, Undefined::DivisorMayBeZero(-1.0, 1.0)),
        ("0 * (1 / x)", 8, Undefined::DivisorMayBeZero(-1.0, 1.0)),
    ] {
        assert_eq!(range(text, X, V), Err(Mistake { column, kind: MistakeKind::Undefined(undefined) }), "{text}");
    }
}

#[test]
fn what_is_kept_from_it_passes() {
    for text in [
        "1 / (abs(v) + 1)",
        "1 / (abs(x) + 1)",
        "1 / max(x, 0.1)",
        "v * abs(v)",
        "sqrt(max(x, 0))",
        "ln(max(x, 0.1))",
        "max(x, 0)^0.5",
        "max(x, 0.1)^-1",
        "exp(min(v * 1000, 5))",
        "1 / (x^2 + 0.01)",
    ] {
        assert!(range(text, X, V).is_ok(), "{text}: {:?}", range(text, X, V));
    }
}

#[test]
fn the_branch_that_is_never_taken_may_be_undefined() {
    assert_eq!(range("if(v > 1, v, 1 / x)", X, V), Ok(V));
    assert_eq!(range("if(v < 1, 1 / x, v)", X, V), Ok(V));
}

#[test]
fn variables_that_are_used_need_finite_bounds_in_order() {
    let formula = Formula::parse("1 + x", &["x", "v"]).unwrap();
    assert!(formula.range(&[X]).is_ok());
    for bounds in [&[][..], &[(1.0, -1.0)], &[(f64::NAN, 1.0)], &[(0.0, f64::INFINITY)]] {
        let mistake = Mistake { column: 5, kind: MistakeKind::Undefined(Undefined::Unbounded("x".into())) };
        assert_eq!(formula.range(bounds), Err(mistake), "{bounds:?}");
    }
}

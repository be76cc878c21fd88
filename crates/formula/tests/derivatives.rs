//! Derivatives, against central differences and at the places where there is none.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by it")]
#![allow(clippy::float_cmp, reason = "exact numbers")]

mod random;

use formula::Formula;
use random::Random;

#[test]
fn the_value_of_a_dual_is_the_value_in_every_bit() {
    let mut random = Random(2);
    for _ in 0..20_000 {
        let (formula, point, towards) = (random.formula(), random.point(), random.point());
        let (value, dual) = (formula.value(&point), formula.dual(&point, &towards).0);
        assert_eq!(value.to_bits(), dual.to_bits(), "{formula} at {point:?}: {value}, {dual}");
    }
}

#[test]
fn derivatives_are_those_of_central_differences() {
    let mut random = Random(3);
    let (mut smooth, mut moving, mut infinite) = (0, 0, 0);
    for _ in 0..20_000 {
        let (formula, point, towards) = (random.formula(), random.point(), random.point());
        let moved = |by: f64| std::array::from_fn::<f64, 4, _>(|k| point[k] + by * towards[k]);
        let difference = |step: f64| (formula.value(&moved(step)) - formula.value(&moved(-step))) / (2.0 * step);
        let (value, slope) = formula.dual(&point, &towards);
        // Where two differences agree, the function is smooth and the numbers are not rounded away.
        let (coarse, fine) = (difference(2e-5), difference(1e-5));
        // Infinite on the way, such as 2^ln(0): a value, but no derivative.
        if slope.is_nan() && fine == 0.0 {
            infinite += 1;
            continue;
        }
        let scale = 1.0 + fine.abs() + 1e-3 * value.abs();
        if !((coarse - fine).abs() < 1e-6 * scale && value.abs() < 1e6) {
            continue;
        }
        assert!((slope - fine).abs() < 1e-4 * scale, "{formula} at {point:?} towards {towards:?}: {slope}, {fine}");
        smooth += 1;
        moving += u32::from(fine != 0.0);
    }
    assert!(smooth > 10_000 && moving > 7000 && infinite < 100, "{smooth} {moving} {infinite}");
}

#[test]
fn each_operation_has_its_derivative() {
    let (a, b): (f64, f64) = (1.7, 0.6);
    for (text, by_a) in [
        ("a + b", 1.0),
        ("b - a", -1.0),
        ("-a", -1.0),
        ("a * b", b),
        ("a / b", 1.0 / b),
        ("b / a", -b / (a * a)),
        ("a^b", b * a.powf(b - 1.0)),
        ("b^a", b.powf(a) * b.ln()),
        ("a^2", 2.0 * a),
        ("a^3", 3.0 * a * a),
        ("a^4", 4.0 * a * a * a),
        ("max(a, b)", 1.0),
        ("min(a, b)", 0.0),
        ("abs(-a)", 1.0),
        ("sign(a)", 0.0),
        ("clamp(a, 0, 2)", 1.0),
        ("clamp(a, 0, 1)", 0.0),
        ("sqrt(a)", 0.5 / a.sqrt()),
        ("exp(a)", a.exp()),
        ("ln(a)", 1.0 / a),
        ("tanh(a)", 1.0 - a.tanh().powi(2)),
        ("sin(a)", a.cos()),
        ("cos(a)", -a.sin()),
        ("if(a < b, 5 * a, 7 * a)", 7.0),
    ] {
        let slope = Formula::parse(text, &["a", "b"]).unwrap().dual(&[a, b], &[1.0]).1;
        assert!((slope - by_a).abs() < 1e-14, "{text}: {slope}, {by_a}");
    }
}

#[test]
fn at_a_corner_the_derivative_is_that_of_the_side_that_the_value_takes() {
    let at_zero = |text: &str| Formula::parse(text, &["a"]).unwrap().dual(&[0.0], &[1.0]).1;
    assert_eq!(at_zero("max(a, 0)"), 1.0);
    assert_eq!(at_zero("max(0, a)"), 0.0);
    assert_eq!(at_zero("max(a - 0, 0)"), 1.0);
    assert_eq!(at_zero("max(0, a - 0)"), 0.0);
    assert_eq!(at_zero("2 * max(0, a - 0)"), 0.0);
    assert_eq!(at_zero("2 * max(a - 0, 0)"), 2.0);
    assert_eq!(at_zero("min(2 * a, a)"), 2.0);
    assert_eq!(at_zero("abs(a)"), 1.0);
    assert_eq!(at_zero("if(a < 0, a, 3 * a)"), 3.0);
    assert_eq!(at_zero("if(a <= 0, a, 3 * a)"), 1.0);
}

#[test]
fn what_does_not_move_has_no_derivative_to_take() {
    let formula = Formula::parse("sqrt(max(a, 0)) + b^2", &["a", "b"]).unwrap();
    assert_eq!(formula.dual(&[-1.0, 3.0], &[1.0, 1.0]), (9.0, 6.0));
    assert_eq!(formula.dual(&[4.0, 3.0], &[]), (11.0, 0.0));
    let power = Formula::parse("a^b", &["a", "b"]).unwrap();
    assert_eq!(power.dual(&[0.0, 2.0], &[1.0, 1.0]), (0.0, 0.0));
    assert_eq!(power.dual(&[0.0, 0.0], &[1.0, 0.0]), (1.0, 0.0));
}

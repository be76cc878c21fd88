//! What formulas are worth, against closed forms.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by it")]
#![allow(clippy::float_cmp, reason = "the same operations give the same bits")]

mod random;

use formula::Formula;
use random::{NAMES, Random};

fn value(text: &str, variables: &[f64]) -> f64 {
    Formula::parse(text, &["a", "b", "c"]).unwrap_or_else(|mistake| panic!("{text}: {mistake}")).value(variables)
}

/// At several points, for a formula of a, b and c.
fn is(text: &str, closed_form: fn(f64, f64, f64) -> f64) {
    for [a, b, c] in [[1.5, -2.0, 3.0], [-0.7, 0.3, 2.0], [4.0, 4.0, -1.0], [0.0, 5.0, 0.5], [-3.0, -2.5, -0.1]] {
        let (ours, exact) = (value(text, &[a, b, c]), closed_form(a, b, c));
        assert!(same(ours, exact), "{text} at {a}, {b}, {c}: {ours}, not {exact}");
    }
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

#[test]
fn products_bind_tighter_than_sums_and_both_are_taken_from_the_left() {
    is("a - b - c", |a, b, c| (a - b) - c);
    is("a / b / c", |a, b, c| (a / b) / c);
    is("a - b * c", |a, b, c| a - b * c);
    is("a * b - c", |a, b, c| a * b - c);
    is("a / b * c", |a, b, c| (a / b) * c);
    is("a - b + c", |a, b, c| (a - b) + c);
    is("a * (b - c)", |a, b, c| a * (b - c));
}

#[test]
fn a_power_binds_tighter_than_a_sign_and_is_taken_from_the_right() {
    is("-a^2", |a, _, _| -(a * a));
    is("(-a)^2", |a, _, _| a * a);
    is("2^-1 + a", |a, _, _| 0.5 + a);
    is("2^3^2 + a", |a, _, _| 512.0 + a);
    is("a^b^c", |a, b, c| libm::pow(a, libm::pow(b, c)));
    is("2^-a * b", |a, b, _| libm::pow(2.0, -a) * b);
    is("2^-a^2", |a, _, _| libm::pow(2.0, -(a * a)));
    is("a^2 * b", |a, b, _| (a * a) * b);
    is("a * b^2", |a, b, _| a * (b * b));
}

#[test]
fn a_sign_binds_tighter_than_a_product_and_may_be_repeated() {
    is("-a * b", |a, b, _| -a * b);
    is("a * -b", |a, b, _| a * -b);
    is("a - -b", |a, b, _| a + b);
    is("--a", |a, _, _| a);
    is("-a - b", |a, b, _| -a - b);
}

#[test]
fn small_powers_are_products_and_the_others_those_of_libm() {
    is("a^2", |a, _, _| a * a);
    is("a^3", |a, _, _| a * a * a);
    is("a^4", |a, _, _| (a * a) * (a * a));
    is("a^5", |a, _, _| libm::pow(a, 5.0));
    is("a^0.5", |a, _, _| libm::pow(a, 0.5));
}

#[test]
fn each_function_is_the_one_that_its_name_says() {
    is("min(a, b)", f64_min);
    is("max(a, b)", |a, b, _| if b > a { b } else { a });
    is("min(a, b, c)", |a, b, c| f64_min(f64_min(a, b, 0.0), c, 0.0));
    is("max(a, b, c, 1)", |a, b, c| [a, b, c].into_iter().fold(1.0, f64::max));
    is("abs(a)", |a, _, _| a.abs());
    is("sign(a)", |a, _, _| if a == 0.0 { 0.0 } else { a.signum() });
    is("clamp(a, -1, 2)", |a, _, _| a.clamp(-1.0, 2.0));
    is("sqrt(a)", |a, _, _| libm::sqrt(a));
    is("exp(a)", |a, _, _| libm::exp(a));
    is("ln(a)", |a, _, _| libm::log(a));
    is("tanh(a)", |a, _, _| libm::tanh(a));
    is("sin(a)", |a, _, _| libm::sin(a));
    is("cos(a)", |a, _, _| libm::cos(a));
    is("if(a < b, c, 7)", |a, b, c| if a < b { c } else { 7.0 });
    is("if(a <= b, c, 7)", |a, b, c| if a <= b { c } else { 7.0 });
    is("if(a > b, c, 7)", |a, b, c| if a > b { c } else { 7.0 });
    is("if(a >= b, c, 7)", |a, b, c| if a >= b { c } else { 7.0 });
    is("if(a + 1 < b * 2, c, 7)", |a, b, c| if a + 1.0 < b * 2.0 { c } else { 7.0 });
    is("a * pi", |a, _, _| a * core::f64::consts::PI);
}

fn f64_min(a: f64, b: f64, _: f64) -> f64 {
    if b < a { b } else { a }
}

#[test]
fn joined_steps_have_the_bits_of_the_operations_one_by_one() {
    is("-a * max(b - c, 0)", |a, b, c| -(a * (b - c).max(0.0)));
    is("a * max(b - c, 0)", |a, b, c| a * (b - c).max(0.0));
    is("a * max(b - c, -0)", |a, b, c| a * if b >= c { b - c } else { -0.0 });
    is("-a * max(0, b - c)", |a, b, c| -a * if b > c { b - c } else { 0.0 });
    is("max(a - b, c)", |a, b, c| if c > a - b { c } else { a - b });
    is("-a * b * abs(b)", |a, b, _| -a * b * b.abs());
    is("-a * b * abs(c)", |a, b, c| -a * b * c.abs());
    is("abs(a) * b", |a, b, _| a.abs() * b);
    is("-a * b * c", |a, b, c| -a * b * c);
    is("-(a * b)", |a, b, _| -(a * b));
    is("a * b * c", |a, b, c| a * b * c);
    is("a * (b * c)", |a, b, c| a * (b * c));
    is("a * b + c", |a, b, c| a * b + c);
    is("c + a * b", |a, b, c| a * b + c);
    is("a * (b - c)", |a, b, c| a * (b - c));
    is("a - b * c", |a, b, c| a - b * c);
    is("a / abs(b)", |a, b, _| a / b.abs());
    is("if(a * b < c, a - b, a * abs(c))", |a, b, c| if a * b < c { a - b } else { a * c.abs() });
}

#[test]
fn numbers_are_read_as_rust_reads_them() {
    for text in ["0", "12", "0.5", ".5", "5.", "1e3", "1E-3", "2.5e+2", "1e-400", "1.7976931348623157e308"] {
        assert_eq!(value(text, &[]), text.parse::<f64>().unwrap(), "{text}");
    }
}

#[test]
fn names_have_cases_digits_and_underscores_and_may_hide_the_constant() {
    let formula = Formula::parse("_a1 - X + x * pi", &["x", "X", "_a1", "pi"]).unwrap();
    assert_eq!(formula.value(&[2.0, 3.0, 10.0, 5.0]), 17.0);
    assert!(formula::is_free_name("_a1") && formula::is_free_name("Max"));
    for name in ["", "1a", "max", "pi", "a-b", "é"] {
        assert!(!formula::is_free_name(name), "{name}");
    }
}

#[test]
fn a_missing_variable_is_nan_and_nan_goes_through_max_min_and_sign() {
    for text in ["c", "max(c, 1)", "max(1, c)", "min(c, 1)", "min(1, c)", "clamp(c, 0, 1)", "sign(c)", "abs(c)", "-c"] {
        let bits = value(text, &[1.0, 2.0]).to_bits();
        assert_eq!(bits, f64::NAN.to_bits(), "{text}");
    }
    assert_eq!(value("if(c < 1, 2, 3)", &[]), 3.0);
}

#[test]
fn it_knows_which_variables_it_uses_and_its_text() {
    let formula = Formula::parse(" x * start", &NAMES).unwrap();
    assert_eq!([0, 1, 2, 3, 4].map(|k| formula.uses(k)), [true, false, false, true, false]);
    assert_eq!((formula.text(), formula.to_string().as_str()), (" x * start", " x * start"));
}

#[test]
fn computing_constants_beforehand_does_not_change_a_bit() {
    let mut random = Random(1);
    let mut finite = 0;
    for _ in 0..5000 {
        let text = {
            let operations = random.below(8);
            random.text(operations)
        };
        let point = random.point();
        let mut constant = text.clone();
        for (name, value) in ["start", "k", "v"].into_iter().zip([point[3], point[2], point[1]]) {
            constant = in_place_of(&constant, name, &format!("({value:e})"));
        }
        let (Ok(varying), Ok(constant)) = (Formula::parse(&text, &NAMES), Formula::parse(&constant, &NAMES)) else {
            continue;
        };
        let (expected, folded) = (varying.value(&point), constant.value(&point));
        assert_eq!(expected.to_bits(), folded.to_bits(), "{text} at {point:?}: {expected}, {folded}");
        finite += u32::from(expected.is_finite());
    }
    assert!(finite > 2000, "{finite}");
}

/// Replaces a name, but not within other names.
fn in_place_of(text: &str, name: &str, value: &str) -> String {
    let mut replaced = String::new();
    let mut word = String::new();
    for character in text.chars().chain([' ']) {
        if character.is_ascii_alphabetic() {
            word.push(character);
        } else {
            replaced += if word == name { value } else { &word };
            word.clear();
            replaced.push(character);
        }
    }
    replaced
}

#[test]
fn large_formulas_are_evaluated_as_small_ones_are() {
    for terms in [2_u32, 7, 10, 30, 60, 120] {
        let text: Vec<String> = (1..=terms).map(|k| format!("{k}/a")).collect();
        let (text, exact) = (text.join("+"), (1..=terms).map(f64::from).sum::<f64>() / 0.5);
        match Formula::parse(&text, &["a"]) {
            Ok(formula) => assert_eq!(formula.value(&[0.5]), exact, "{terms}"),
            Err(mistake) => assert!(terms > 100, "{terms}: {mistake}"),
        }
    }
}

#[test]
fn what_a_formula_repeats_is_computed_once_and_has_the_same_bits_as_when_written_once_each() {
    // The repeated term is bound to a variable of its own in the second text.
    let once = |a: f64, b: f64| libm::tanh((a - b) / 3.0);
    for (repeated, named) in [
        ("tanh((a - b) / 3) * (a + b * tanh((a - b) / 3) + abs(tanh((a - b) / 3)))", "c * (a + b * c + abs(c))"),
        ("tanh((a - b) / 3) * tanh((a - b) / 3) + a * tanh((a - b) / 3)", "c * c + a * c"),
        ("max(tanh((a - b) / 3), 0) - -tanh((a - b) / 3) * b * abs(tanh((a - b) / 3))", "max(c, 0) - -c * b * abs(c)"),
    ] {
        for [a, b] in [[1.5, -2.0], [-0.7, 0.3], [4.0, 4.0], [0.0, 5.0]] {
            let (ours, exact) = (value(repeated, &[a, b, 0.0]), value(named, &[a, b, once(a, b)]));
            assert!(same(ours, exact), "{repeated} at {a}, {b}: {ours}, not {exact}");
        }
    }
    // Zeros of both signs differ: 1/0 is not 1/−0.
    is("1 / (a * 0) + 1 / (a * -0)", |a, _, _| 1.0 / (a * 0.0) + 1.0 / (a * -0.0));
}

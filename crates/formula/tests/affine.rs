//! In which variables a formula is affine.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by it")]

use formula::Formula;

/// Of `x, v, u, k`.
fn is_affine(text: &str, variables: &[usize]) -> bool {
    Formula::parse(text, &["x", "v", "u", "k"]).unwrap().is_affine_in(variables)
}

#[test]
fn sums_of_products_with_what_does_not_depend_on_them_are_affine() {
    for text in [
        "7",
        "u * k",
        "x",
        "-x",
        "x + v",
        "x - v - 3",
        "k * x + u^2 * v",
        "x * k * sin(u)",
        "-k * (x - u)",
        "x / k",
        "(x + v) / exp(u)",
        "x^1",
        "if(u < k, x, 2 * v)",
        "max(u, k) * x",
    ] {
        assert!(is_affine(text, &[0, 1]), "{text}");
    }
}

#[test]
fn all_others_are_not() {
    for text in [
        "x * v",
        "x^2",
        "k / x",
        "u + 1 / v",
        "x^k",
        "2^x",
        "max(x, 0)",
        "min(x, k)",
        "abs(v)",
        "sign(v)",
        "clamp(x, 0, 1)",
        "sqrt(x)",
        "exp(x)",
        "sin(v)",
        "x * tanh(v)",
        "if(x < 0, x, v)",
        "if(u < 0, x, v^2)",
        "x^2 - x^2",
        "(x + k) * (v + u)",
    ] {
        assert!(!is_affine(text, &[0, 1]), "{text}");
    }
}

#[test]
fn it_depends_on_the_variables_together() {
    assert!(is_affine("x * v", &[0]) && is_affine("x * v", &[1]) && !is_affine("x * v", &[0, 1]));
    assert!(is_affine("abs(v)", &[]) && is_affine("abs(v)", &[0]) && is_affine("abs(v)", &[9]));
}

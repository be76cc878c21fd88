//! Every mistake, with its column and its message.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by it")]

use formula::{Formula, MAX_CHARACTERS, MAX_DEPTH, MAX_OPERATIONS};

fn message(text: &str) -> String {
    Formula::parse(text, &["x", "v", "u", "k", "start"]).unwrap_err().to_string()
}

const SOME: &str = "x, v, u, k, start";

#[test]
fn an_unknown_name_is_answered_with_the_nearest_and_all_that_there_are() {
    for (text, expected) in [
        ("-k * (x - q)", format!("column 11: there is no variable `q`; there are {SOME}")),
        ("x - strat", format!("column 5: there is no variable `strat`; did you mean `start`? There are {SOME}")),
        ("X", format!("column 1: there is no variable `X`; did you mean `x`? There are {SOME}")),
        ("2 * foo(x)", "column 5: there is no function `foo`; there are min, max, abs, sign, clamp, sqrt, exp, ln, tanh, sin, cos, if".into()),
        ("pow(x, 2)", "column 1: there is no function `pow`; did you mean `^`?".into()),
        ("log(x)", "column 1: there is no function `log`; did you mean `ln`?".into()),
        ("sgn(x)", "column 1: there is no function `sgn`; did you mean `sign`?".into()),
        ("Max(x, 0)", "column 1: there is no function `Max`; did you mean `max`?".into()),
        ("2 + k (x)", "column 5: `k` is no function; a product is written `k * (…)`".into()),
        ("pi(2)", "column 1: `pi` is no function; a product is written `pi * (…)`".into()),
        ("abs x", "column 1: `abs` is a function; write its arguments, `abs(…)`".into()),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
    let alone = |names: &[&str]| Formula::parse("q", names).unwrap_err().to_string();
    assert_eq!(alone(&[]), "column 1: there is no variable `q`; there are none, only the constant pi");
    assert_eq!(alone(&["x"]), "column 1: there is no variable `q`; there is x");
    assert_eq!(alone(&["x", "", "v"]), "column 1: there is no variable `q`; there are x, v", "a place without a name");
}

#[test]
fn a_wrong_number_of_arguments_is_counted() {
    for (text, expected) in [
        ("1 + clamp(x, 0)", "column 5: `clamp` takes 3 arguments, 2 are given"),
        ("clamp(x, 0, 1, 2)", "column 1: `clamp` takes 3 arguments, 4 are given"),
        ("max(x)", "column 1: `max` takes 2 arguments or more, 1 is given"),
        ("min()", "column 1: `min` takes 2 arguments or more, 0 are given"),
        ("abs( )", "column 1: `abs` takes 1 argument, 0 are given"),
        ("sin(x, v)", "column 1: `sin` takes 1 argument, 2 are given"),
        ("if(x < 0, 1)", "column 1: `if` takes 3 arguments, 2 are given"),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
}

#[test]
fn what_is_missing_is_named_where_it_is_missing() {
    const VALUE: &str = "stands where a value is missing; write a number, a variable, a function or a bracket";
    for (text, expected) in [
        ("", "column 1: the formula is empty; write one, such as `-k * x`".into()),
        ("   ", "column 4: the formula is empty; write one, such as `-k * x`".into()),
        ("x +", "column 4: the formula ends where a value is missing; complete it".into()),
        ("x + (", "column 6: the formula ends where a value is missing; complete it".into()),
        ("-", "column 2: the formula ends where a value is missing; complete it".into()),
        ("x * * v", format!("column 5: `*` {VALUE}")),
        ("+x", format!("column 1: `+` {VALUE}")),
        ("()", format!("column 2: `)` {VALUE}")),
        ("max(x,)", format!("column 7: `)` {VALUE}")),
        ("max(,x)", format!("column 5: `,` {VALUE}")),
        ("2 x", "column 3: an operator is missing before `x`; a product is written with `*`".into()),
        ("x 2", "column 3: an operator is missing before `2`; a product is written with `*`".into()),
        ("2(x)", "column 2: an operator is missing before `(`; a product is written with `*`".into()),
        ("x)", "column 2: nothing opened this bracket; delete it, or add a `(` before it".into()),
        ("2 * (x", "column 5: nothing closes this bracket; add a `)`".into()),
        ("2 * max(x, v", "column 5: nothing closes this bracket; add a `)`".into()),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
}

#[test]
fn commas_and_comparisons_have_their_places() {
    const COMMA: &str = "a comma stands only between the arguments of a function; the decimal mark is a point";
    const IF: &str = "a comparison stands only as the first argument of `if`, once, as in `if(x < 0, a, b)`";
    for (text, expected) in [
        ("0,5 * x", format!("column 2: {COMMA}")),
        ("max((x, v), 1)", format!("column 7: {COMMA}")),
        ("x < v", format!("column 3: {IF}")),
        ("max(x >= v, 1)", format!("column 7: {IF}")),
        ("if(x < v < u, 1, 2)", format!("column 10: {IF}")),
        ("if((x < v), 1, 2)", format!("column 7: {IF}")),
        ("if(x < v, x < 1, 2)", format!("column 13: {IF}")),
        ("if(x, 1, 2)", "column 1: `if` compares first, as in `if(x < 0, a, b)`".into()),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
}

#[test]
fn characters_and_numbers_that_are_none_are_shown() {
    for (text, expected) in [
        (
            "x % 2",
            "column 3: `%` means nothing in a formula; there are numbers, names, `+ - * / ^`, brackets, commas, and comparisons within `if`",
        ),
        ("2 \u{2212} x", "column 3: `\u{2212}` means nothing in a formula; a minus is written `-`"),
        ("2 × x", "column 3: `×` means nothing in a formula; a product is written with `*`"),
        ("x²", "column 2: `²` means nothing in a formula; a power is written with `^`, as in `x^2`"),
        ("[x]", "column 1: `[` means nothing in a formula; brackets are `(` and `)`"),
        (
            "if(x == 1, 2, 3)",
            "column 6: `=` means nothing in a formula; the comparisons are `<`, `<=`, `>` and `>=`, within `if`",
        ),
        (
            "\u{7}",
            "column 1: `\\u{7}` means nothing in a formula; there are numbers, names, `+ - * / ^`, brackets, commas, and comparisons within `if`",
        ),
        ("1 + 1.2.3", "column 5: `1.2.3` is no number; write one as `12`, `0.5` or `1e-3`"),
        ("2e", "column 1: `2e` is no number; write one as `12`, `0.5` or `1e-3`"),
        (".", "column 1: `.` is no number; write one as `12`, `0.5` or `1e-3`"),
        ("1e999", "column 1: `1e999` is too large; the largest number is about 1.8e308"),
    ] {
        assert_eq!(message(text), expected, "{text}");
    }
}

#[test]
fn what_can_be_undefined_says_what_to_do() {
    let bounds = [(-0.1, 1.0 / 3.0), (0.0, 2e9), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0)];
    let said = |text: &str| {
        Formula::parse(text, &["x", "v"]).unwrap().range(bounds.get(..2).unwrap()).unwrap_err().to_string()
    };
    for (text, expected) in [
        (
            "1 / x",
            "column 3: the divisor can be zero, it lies within -0.1 to 0.333333; keep it away from zero, as in `max(…, 0.1)` or `abs(…) + 0.1`",
        ),
        (
            "sqrt(x)",
            "column 1: the argument of `sqrt` can be negative, it lies within -0.1 to 0.333333; keep it from that, as in `sqrt(max(…, 0))`",
        ),
        (
            "ln(v)",
            "column 1: the argument of `ln` can be zero or negative, it lies within 0 to 2e9; keep it positive, as in `ln(max(…, 0.1))`",
        ),
        (
            "x^0.5",
            "column 2: the base can be negative, it lies within -0.1 to 0.333333, and the exponent is no whole number; take `abs(…)` or `max(…, 0)` of the base",
        ),
        (
            "x^-1",
            "column 2: the base can be zero, it lies within -0.1 to 0.333333, and the exponent negative; keep the base away from zero, as in `max(…, 0.1)`",
        ),
        (
            "exp(v)",
            "column 1: the result can be too large for a number; narrow the bounds, or limit it with `clamp` before",
        ),
    ] {
        assert_eq!(said(text), expected, "{text}");
    }
    let unbounded = Formula::parse("2 + x", &["x"]).unwrap().range(&[]).unwrap_err().to_string();
    assert_eq!(unbounded, "column 5: the variable `x` has no finite bounds; give it some");
}

#[test]
fn longer_deeper_and_larger_than_allowed_is_an_error_and_no_panic() {
    let long = |characters: usize| format!("x{}", " ".repeat(characters - 1));
    assert!(Formula::parse(&long(MAX_CHARACTERS), &["x"]).is_ok());
    assert_eq!(message(&long(MAX_CHARACTERS + 1)), "column 501: the formula has more than 500 characters; shorten it");
    assert_eq!(message(&"(".repeat(20_000)), "column 501: the formula has more than 500 characters; shorten it");

    let deep = |depth: usize| format!("{}x{}", "(".repeat(depth), ")".repeat(depth));
    assert!(Formula::parse(&deep(MAX_DEPTH), &["x"]).is_ok());
    let too_deep = "column 65: brackets are nested deeper than 64; leave out those that change nothing";
    assert_eq!(message(&deep(MAX_DEPTH + 1)), too_deep);
    assert_eq!(message(&"(".repeat(500)), too_deep);
    assert!(Formula::parse(&format!("x{}", "+(x)".repeat(100)), &["x"]).is_ok(), "beside each other");
    let functions = format!("{}x{}", "abs(".repeat(65), ")".repeat(65));
    assert_eq!(message(&functions), too_deep.replace("65", "257"));

    let sum = |operations: usize| format!("x{}", "+1".repeat(operations));
    assert!(Formula::parse(&sum(MAX_OPERATIONS), &["x"]).is_ok());
    let too_many = "the formula has more than 200 operations; shorten it";
    assert_eq!(message(&sum(MAX_OPERATIONS + 1)), format!("column 402: {too_many}"));
    // Also those of constants, signs, and the arguments of `max`.
    assert_eq!(message(&format!("1{}", "+1".repeat(201))), format!("column 402: {too_many}"));
    assert_eq!(message(&format!("{}x", "-".repeat(201))), format!("column 1: {too_many}"));
    assert_eq!(message(&format!("max(x{})", ",1".repeat(201))), format!("column 1: {too_many}"));
}

#[test]
fn any_text_of_the_grammars_characters_is_refused_or_read_without_a_panic() {
    let mut state = 7_u64;
    let mut next = |end: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from((state >> 33) % end).unwrap()
    };
    let words =
        ["x", "k", "1", ".5", "+", "-", "*", "/", "^", "(", ")", ",", "<", ">=", "max", "if", "abs", "clamp", " ", "é"];
    let mut read = 0;
    for _ in 0..100_000 {
        let text: String = (0..next(12)).map(|_| words[next(20)]).collect();
        read += u32::from(Formula::parse(&text, &["x", "k"]).is_ok());
    }
    assert!(read > 500, "{read}");
}

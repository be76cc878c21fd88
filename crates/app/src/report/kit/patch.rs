//! Config patches for people to read: numbers with six significant digits, which is more than any record determines.

/// A patch with its numbers rounded. Comments, strings and whole numbers stay as they are.
pub fn rounded(patch: &str) -> String {
    patch.split_inclusive('\n').map(line).collect()
}

fn line(line: &str) -> String {
    let Some((key, rest)) = line.split_once(" = ").filter(|(key, _)| !key.starts_with('#')) else {
        return line.to_owned();
    };
    let (value, comment) = rest.split_at(rest.find('#').unwrap_or(rest.len()));
    if value.contains('"') { line.to_owned() } else { format!("{key} = {}{comment}", numbers(value)) }
}

/// The text with each number with a point or an exponent rounded.
fn numbers(value: &str) -> String {
    let of_number = |letter: char| letter.is_ascii_digit() || "+-.eE".contains(letter);
    let mut text = String::new();
    let mut rest = value;
    while let Some(start) = rest.find(of_number) {
        let (before, from) = rest.split_at(start);
        let (number, after) = from.split_at(from.find(|letter| !of_number(letter)).unwrap_or(from.len()));
        text += before;
        text += &one(number);
        rest = after;
    }
    text + rest
}

fn one(number: &str) -> String {
    let rounded = |value: f64| format!("{value:.5e}").parse::<f64>().ok();
    let fraction = Some(number).filter(|number| number.contains(['.', 'e', 'E']));
    match fraction.and_then(|number| number.parse().ok()).and_then(rounded) {
        Some(value) => format!("{value:?}"),
        None => number.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn numbers_of_a_patch_have_six_significant_digits_and_all_else_stays() {
        let patch = "# 0.123456789 stays\n[plant]\ndrag_per_s = 3.887915001121093  # 3.678912345 to 5.2\n\
                     points = [[21.412345678, -0.000123456789], [22.0, 1e-12]]\nticks = 12345678\nbig = -1e300\n\
                     name = \"1.23456789\"\nti_s = inf\nhalf = -0.2964999999999982\n";
        let expected = "# 0.123456789 stays\n[plant]\ndrag_per_s = 3.88792  # 3.678912345 to 5.2\n\
                        points = [[21.4123, -0.000123457], [22.0, 1e-12]]\nticks = 12345678\nbig = -1e300\n\
                        name = \"1.23456789\"\nti_s = inf\nhalf = -0.2965\n";
        assert_eq!(rounded(patch), expected);
    }
}

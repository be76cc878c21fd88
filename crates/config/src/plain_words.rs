//! What the readers of TOML and JSON say of a wrong value, in words of the files instead of those of the program.

/// Words of the readers at the start of a message, and ours.
const FAULTS: [(&str, &str); 4] = [
    ("unknown field", "unknown key"),
    ("missing field", "missing key"),
    ("unknown variant", "unknown word"),
    ("invalid type: unit variant", "wrong type"),
];

/// What a value is, and what is expected of it: words of the readers, and ours.
const KINDS: [(&str, &str); 17] = [
    ("f64", "a number"),
    ("u8", "a whole number of 0 or more"),
    ("u16", "a whole number of 0 or more"),
    ("u32", "a whole number of 0 or more"),
    ("u64", "a whole number of 0 or more"),
    ("usize", "a whole number of 0 or more"),
    ("i64", "a whole number"),
    ("a string", "a text in quotes"),
    ("string only", "a text in quotes"),
    ("path string", "a path in quotes"),
    ("a boolean", "true or false"),
    ("a sequence", "a list"),
    ("sequence", "a list"),
    ("a map", "a table"),
    ("map", "a table"),
    ("string or table", "a text in quotes or a table"),
    ("wanted string or table", "a text in quotes or a table"),
];

/// The message of a reader of TOML or JSON in the words of a config: key, table, list, number.
#[must_use]
pub fn plain_words(message: &str) -> String {
    let message = message.split(" at line ").next().unwrap_or(message);
    if message == "wanted exactly 1 element, more than 1 element" {
        return "several variants where one is possible; leave one of them".into();
    }
    match message.rsplit_once(", expected ") {
        Some((found, expected)) => format!("{}, expected {}", fault(found), kind(expected)),
        None => fault(message),
    }
}

fn fault(found: &str) -> String {
    if let Some((theirs, ours)) = FAULTS.iter().find(|(theirs, _)| found.starts_with(theirs)) {
        return format!("{ours}{}", &found[theirs.len()..]);
    }
    match found.strip_prefix("invalid type: ") {
        Some(what) => format!("wrong type: {}", typed(what)),
        None => found.to_owned(),
    }
}

/// The value as the readers quote it: its type, and itself.
fn typed(what: &str) -> String {
    let own =
        [("floating point", "the number"), ("integer", "the whole number"), ("string", "the text"), ("boolean", "")];
    let value = own.iter().find_map(|(theirs, ours)| Some((ours, what.strip_prefix(theirs)?.strip_prefix(' ')?)));
    value.map_or_else(|| kind(what), |(ours, value)| format!("{ours} {value}").trim_start().to_owned())
}

fn kind(expected: &str) -> String {
    match KINDS.iter().find(|(theirs, _)| *theirs == expected) {
        Some((_, ours)) => (*ours).to_owned(),
        None if expected.starts_with("struct ") || expected.starts_with("enum ") => "a table".to_owned(),
        None => expected.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::plain_words;

    #[test]
    fn types_of_the_program_are_said_in_words_of_the_file() {
        for (theirs, ours) in [
            ("invalid type: string \"fast\", expected f64", "wrong type: the text \"fast\", expected a number"),
            ("invalid type: integer `3`, expected struct Model", "wrong type: the whole number `3`, expected a table"),
            ("invalid type: boolean `true`, expected u32", "wrong type: `true`, expected a whole number of 0 or more"),
            ("invalid type: sequence, expected a string", "wrong type: a list, expected a text in quotes"),
            ("invalid type: unit variant, expected string only", "wrong type, expected a text in quotes"),
            ("missing field `title`", "missing key `title`"),
            (
                "unknown field `x`, expected one of `a`, `b` at line 1 column 4",
                "unknown key `x`, expected one of `a`, `b`",
            ),
            ("unknown variant `nid`, expected `a` or `b`", "unknown word `nid`, expected `a` or `b`"),
        ] {
            assert_eq!(plain_words(theirs), ours);
        }
    }
}

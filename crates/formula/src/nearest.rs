//! Which name may be meant: the one that the fewest typing errors turn into what is written.

use alloc::vec::Vec;

/// The most characters that may be wrong.
const MAX_DISTANCE: usize = 2;

/// The name among `names` with the smallest edit distance to `written`, if much of it is the same.
pub(crate) fn nearest<'a>(written: &str, names: impl Iterator<Item = &'a str> + Clone) -> Option<&'a str> {
    if let Some(other_case) = names.clone().find(|name| name.eq_ignore_ascii_case(written)) {
        return Some(other_case);
    }
    let close = names.filter_map(|name| Some((distance(written, name)?, name)));
    let (distance, name) = close.min_by_key(|(distance, _)| *distance)?;
    // A name of which more than half is wrong is another name.
    (2 * distance <= written.len()).then_some(name)
}

/// How many characters must be inserted, deleted or replaced (Levenshtein), if at most [`MAX_DISTANCE`].
fn distance(from: &str, to: &str) -> Option<usize> {
    if from.len().abs_diff(to.len()) > MAX_DISTANCE {
        return None;
    }
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (k, have) in from.bytes().enumerate() {
        let mut diagonal = k;
        let mut left = k + 1;
        for (want, cell) in to.bytes().zip(row.iter_mut().skip(1)) {
            let replaced = diagonal + usize::from(have != want);
            diagonal = *cell;
            left = replaced.min(left + 1).min(*cell + 1);
            *cell = left;
        }
        if let Some(first) = row.first_mut() {
            *first = k + 1;
        }
    }
    row.last().copied().filter(|distance| *distance <= MAX_DISTANCE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_counts_insertions_deletions_and_replacements() {
        for (from, to, expected) in [
            ("start", "start", Some(0)),
            ("strt", "start", Some(1)),
            ("startt", "start", Some(1)),
            ("stark", "start", Some(1)),
            ("strat", "start", Some(2)),
            ("tanhyp", "tanh", Some(2)),
            ("abc", "xyz", None),
            ("s", "start", None),
            ("", "ab", Some(2)),
        ] {
            assert_eq!(distance(from, to), expected, "{from} {to}");
            assert_eq!(distance(to, from), expected, "{to} {from}");
        }
    }

    #[test]
    fn a_name_that_is_mostly_wrong_is_no_suggestion_but_another_case_is() {
        let names = ["x", "v", "Start"];
        assert_eq!(nearest("q", names.into_iter()), None);
        assert_eq!(nearest("X", names.into_iter()), Some("x"));
        assert_eq!(nearest("start", names.into_iter()), Some("Start"));
        assert_eq!(nearest("Strt", names.into_iter()), Some("Start"));
        assert_eq!(nearest("foo", ["cos"].into_iter()), None);
    }
}

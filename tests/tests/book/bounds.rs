//! The accepted numbers of a config, found by running the program: it refuses a wrong number with the bounds of its
//! key.

use super::keys::{Holds, Key, answer};
use std::collections::BTreeMap;
use system_tests::Bench;

/// A value for each key that holds numbers.
type Values = BTreeMap<String, f64>;
/// Smallest and largest of what is accepted.
type Range = (f64, f64);

/// The bounds of the keys, found in two configs with different values: a bound that differs between them is the value
/// of another key.
pub(crate) struct Bounds(BTreeMap<String, [Probe; 2]>);

/// The bounds of a key in a config whose other keys are sound.
pub(crate) struct Probe {
    key: String,
    config: Config,
    /// All of them must hold.
    ranges: Vec<Range>,
}

/// A whole config: all keys except those that another word of a choice excludes.
#[derive(Clone)]
struct Config {
    keys: Vec<Key>,
    words: BTreeMap<String, String>,
    values: Values,
}

impl Bounds {
    /// Finds those of all keys.
    pub(crate) fn ask(bench: &Bench, keys: &[Key]) -> Self {
        let [one, other] = [(0.3, 0.002), (0.7, -0.002)].map(|shares| probes(bench, keys, shares));
        let pairs = one.into_iter().zip(other).filter(|(one, _)| !one.ranges.is_empty());
        Self(pairs.map(|(one, other)| (one.key.clone(), [one, other])).collect())
    }

    /// In words; nothing for a key without bounds.
    pub(crate) fn words(&self, key: &str) -> Option<String> {
        let [one, other] = self.0.get(key)?;
        let ends = |ends| end(ends, &one.config.values, &other.config.values);
        let ranges = one.ranges.iter().zip(&other.ranges).map(|(a, b)| match (ends((a.0, b.0)), ends((a.1, b.1))) {
            (Some(min), Some(max)) if max == "inf" => format!("{min} or more"),
            (Some(min), Some(max)) => format!("{min} to {max}"),
            (Some(min), None) => format!("{min} to what other keys leave"),
            (None, _) => "within what other keys leave".into(),
        });
        Some(ranges.collect::<Vec<_>>().join(", and "))
    }

    /// The result of each config.
    pub(crate) fn probes(&self) -> impl Iterator<Item = &Probe> {
        self.0.values().flatten()
    }
}

/// The bounds of each key, in configs that have each word of each choice once.
fn probes(bench: &Bench, keys: &[Key], (mut share, step): (f64, f64)) -> Vec<Probe> {
    let choices =
        keys.iter().filter_map(|key| if let Holds::OneOf(words) = &key.holds { Some(words.len()) } else { None });
    let (mut probes, mut settled) = (Vec::new(), Values::new());
    for choice in 0..choices.max().unwrap_or(1) {
        let mut config = Config::unsettled(keys, choice);
        config.values.iter_mut().for_each(|(key, value)| *value = settled.get(key).copied().unwrap_or(*value));
        config.settle(bench, || {
            share += step;
            share
        });
        for (key, value) in config.values.clone() {
            if settled.insert(key.clone(), value).is_none() {
                probes.push(Probe { ranges: config.ranges(bench, &key), config: config.clone(), key });
            }
        }
    }
    probes
}

/// An end of a range that was `a` in one config and `b` in the other: a number, or the key that has this value in both,
/// if there is one.
fn end((a, b): (f64, f64), one: &Values, other: &Values) -> Option<String> {
    let same = || one.iter().find(|(key, value)| **value == a && other.get(*key) == Some(&b));
    if a == b { Some(a.to_string()) } else { same().map(|(key, _)| format!("`{key}`")) }
}

impl Probe {
    /// The intersection of its ranges.
    pub(crate) fn common(&self) -> Range {
        self.ranges.iter().fold((f64::NEG_INFINITY, f64::INFINITY), |all, one| (all.0.max(one.0), all.1.min(one.1)))
    }

    /// Whether the program refuses a value of the key by the bounds of this key.
    pub(crate) fn refuses(&self, bench: &Bench, value: f64) -> bool {
        self.config.refusal(bench, Some((&self.key, value))).is_some_and(|(key, _)| key == self.key)
    }

    /// The key, and the smallest change of it where it holds whole numbers.
    pub(crate) fn key(&self) -> (&str, Option<f64>) {
        let whole = |key: &Key| key.path == self.key && matches!(key.holds, Holds::Whole);
        (&self.key, self.config.keys.iter().any(whole).then_some(1.0))
    }
}

impl Config {
    /// A config with this word of every choice. Its numbers are refused wherever there are bounds: whole ones are 0,
    /// all others NaN.
    fn unsettled(keys: &[Key], choice: usize) -> Self {
        let mut words = BTreeMap::new();
        for key in keys {
            if let Holds::OneOf(all) = &key.holds {
                words.insert(key.path.clone(), all[choice % all.len()].clone());
            }
        }
        let excluded = |path: &str| {
            words.iter().any(|(choice, word)| {
                let below = path.strip_prefix(choice.as_str()).and_then(|rest| rest.strip_prefix('.'));
                below.is_some_and(|rest| rest.split('.').next() != Some(word))
            })
        };
        let keys: Vec<Key> = keys.iter().filter(|key| !excluded(&key.path)).cloned().collect();
        let value = |key: &Key| match key.holds {
            Holds::Number | Holds::Numbers => Some(f64::NAN),
            Holds::Whole => Some(0.0),
            _ => None,
        };
        let values = keys.iter().filter_map(|key| Some((key.path.clone(), value(key)?))).collect();
        Self { keys, words, values }
    }

    /// Sets every refused number to another share of its range, so that none is out of bounds and no two are equal.
    fn settle(&mut self, bench: &Bench, mut share: impl FnMut() -> f64) {
        while let Some((key, (min, max))) = self.refusal(bench, None) {
            let value = self.values.get_mut(&key).unwrap_or_else(|| panic!("{key} is refused, which is no key"));
            *value = min + share() * if max.is_finite() { max - min } else { 1.0 };
        }
    }

    /// The ranges of a number: the one by which all others are refused, and those by which its own ends are refused.
    fn ranges(&self, bench: &Bench, key: &str) -> Vec<Range> {
        let range = |value| self.refusal(bench, Some((key, value))).filter(|(refused, _)| refused == key);
        let first = range(f64::NAN).or_else(|| range(0.0)).map(|(_, range)| range);
        let Some((min, max)) = first else { return vec![] };
        let mut ranges = vec![(min, max)];
        for (_, more) in [min, max].into_iter().filter_map(range) {
            if !ranges.contains(&more) {
                ranges.push(more);
            }
        }
        ranges
    }

    /// The first key that the program refuses by its bounds, and these bounds, with another value of one key.
    fn refusal(&self, bench: &Bench, changed: Option<(&str, f64)>) -> Option<(String, Range)> {
        let lines = self.keys.iter().filter_map(|key| {
            let changed = changed.filter(|(path, _)| *path == key.path).map(|(_, value)| value);
            let value = changed.or_else(|| self.values.get(&key.path).copied());
            Some(format!("{} = {}\n", key.path, self.literal(key, value.unwrap_or_default())?))
        });
        let said = answer(bench, lines.collect());
        let (refused, range) = said.split_once(" is outside ")?;
        let key = refused.rsplit(": ").next()?.split(" = ").next()?;
        let (min, max) = range.split(';').next()?.split_once(" to ")?;
        Some((key.to_owned(), (min.parse().ok()?, max.parse().ok()?)))
    }

    /// A value as TOML. `None`: a table, or an optional key.
    fn literal(&self, key: &Key, value: f64) -> Option<String> {
        match &key.holds {
            Holds::Number => Some(format!("{value:?}").to_lowercase()),
            Holds::Whole => Some(if value.is_nan() { "0".into() } else { value.round().to_string() }),
            Holds::Numbers => Some(format!("[{value:?}]").to_lowercase()),
            Holds::Words(_) => Some("\"x\"".into()),
            Holds::OneOf(_) => {
                let word = &self.words[&key.path];
                let of_word = format!("{}.{word}", key.path);
                let table = self.keys.iter().any(|key| key.path == of_word && matches!(key.holds, Holds::Table(_)));
                (!table).then(|| format!("\"{word}\""))
            }
            Holds::Other(_) | Holds::Table(_) | Holds::Nothing => None,
        }
    }
}

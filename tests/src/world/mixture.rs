//! The mixture of a set: kinds of cases with their weights, and the effects that may be drawn.

use crate::catalogue::inside;
use crate::chance::Chance;
use serde::Serialize;

/// What a rig differs from its belief by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
#[value(rename_all = "lower")]
pub(crate) enum Kind {
    /// Nothing but what an owner never knows exactly.
    None,
    /// Base parameters.
    Parameters,
    /// One effect of the catalogue.
    Single,
    /// Two effects of the catalogue.
    Pair,
    /// Something that the catalogue does not hold.
    Outside,
    /// Clutter alone, see [`crate::forms::clutter`].
    Clutter,
    /// One effect of the catalogue amid clutter.
    Amid,
    /// Three to five effects of the catalogue amid clutter.
    Several,
}

impl Kind {
    /// Whether the rig has clutter, and its owner knows it less well.
    pub(crate) fn has_clutter(self) -> bool {
        matches!(self, Self::Clutter | Self::Amid | Self::Several)
    }
}

/// The mixture of a set.
#[derive(Clone, Debug)]
pub(crate) struct Mixture {
    /// Kinds with their weights.
    pub(crate) kinds: Vec<(Kind, f64)>,
    /// Effects that may be drawn, inside the catalogue and outside.
    pub(crate) effects: Vec<&'static str>,
    /// Whether beliefs are exact, for checks of the world itself.
    pub(crate) exact: bool,
}

/// Names whose effects are not distinguishable in any record; a pair never has two of one group.
const TWINS: [&[&str]; 3] = [
    &["transport_delay", "sensor_delay"],
    &["fan_lag", "spin_asymmetry", "sensor_lag"],
    &["sensor_noise", "turbulence"],
];

/// The effects of a case of this kind.
pub(crate) fn names(c: &mut Chance, kind: Kind, allowed: &[&'static str]) -> Vec<&'static str> {
    let pool =
        |catalogue| -> Vec<&'static str> { allowed.iter().copied().filter(|n| inside(n) == catalogue).collect() };
    match kind {
        Kind::None | Kind::Parameters | Kind::Clutter => Vec::new(),
        Kind::Single | Kind::Amid => vec![*c.pick(&pool(true))],
        Kind::Several => several(c, pool(true)),
        Kind::Outside => vec![*c.pick(&pool(false))],
        Kind::Pair => {
            let pairs = pairs(&pool(true));
            let (first, second) = *c.pick(&pairs);
            vec![first, second]
        }
    }
}

/// Three to five of these that may act together.
fn several(c: &mut Chance, mut pool: Vec<&'static str>) -> Vec<&'static str> {
    let (mut names, count) = (Vec::new(), 3 + (c.unit() * 3.0) as usize);
    while names.len() < count && !pool.is_empty() {
        let name = *c.pick(&pool);
        pool.retain(|other| *other != name && !twins(name, other));
        names.push(name);
    }
    names
}

fn twins(a: &str, b: &str) -> bool {
    TWINS.iter().any(|group| group.contains(&a) && group.contains(&b))
}

/// All pairs of these that may act together.
fn pairs(pool: &[&'static str]) -> Vec<(&'static str, &'static str)> {
    let with = |(i, a): (usize, &&'static str)| {
        let later = pool[i + 1..].iter().map(|b| (*a, *b));
        later.filter(|(a, b)| !twins(a, b)).collect::<Vec<_>>()
    };
    pool.iter().enumerate().flat_map(with).collect()
}

/// Whether two of these effects may act together.
pub(crate) fn pairs_exist(allowed: &[&'static str]) -> bool {
    let pool: Vec<_> = allowed.iter().copied().filter(|name| inside(name)).collect();
    !pairs(&pool).is_empty()
}

/// A kind, by weight.
pub(crate) fn weighted(c: &mut Chance, kinds: &[(Kind, f64)]) -> Kind {
    let mut left = c.between(0.0, kinds.iter().map(|(_, weight)| weight).sum());
    let passed = kinds.iter().find(|(_, weight)| {
        left -= weight;
        left < 0.0
    });
    passed.map_or(Kind::None, |(kind, _)| *kind)
}

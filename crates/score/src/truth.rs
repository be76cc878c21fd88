//! The truth about withheld cases (`world.truth/1`) and the bounds of their records, as in their files.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Values of parameters by their keys.
pub type Values = BTreeMap<String, f64>;

/// The published truth of a set of cases.
#[derive(Clone, Debug, Deserialize)]
pub struct Truth {
    /// Name and version of the format.
    pub schema: String,
    /// The cases in order.
    pub cases: Vec<CaseTruth>,
}

impl Truth {
    /// The format that this program reads.
    pub const SCHEMA: &'static str = "world.truth/1";
}

/// The difference between a rig and its belief.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Only the usual errors of a belief.
    None,
    /// Base parameters.
    Parameters,
    /// One effect of the catalogue.
    Single,
    /// Two effects of the catalogue.
    Pair,
    /// An effect outside the catalogue.
    Outside,
    /// Small pieces that no model holds, alone.
    Clutter,
    /// One effect of the catalogue amid clutter.
    Amid,
    /// Three to five effects of the catalogue amid clutter.
    Several,
}

impl Kind {
    /// Whether the rig has clutter, which the true model of [`crate::true_shares`] lacks: a fit that follows it closes
    /// more than the true effects with their true numbers do.
    #[must_use]
    pub const fn has_clutter(self) -> bool {
        matches!(self, Self::Clutter | Self::Amid | Self::Several)
    }

    /// Every kind, in the order of reports.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Parameters,
        Self::Single,
        Self::Pair,
        Self::Outside,
        Self::Clutter,
        Self::Amid,
        Self::Several,
    ];

    /// Its name in truths and reports.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Parameters => "parameters",
            Self::Single => "single",
            Self::Pair => "pair",
            Self::Outside => "outside",
            Self::Clutter => "clutter",
            Self::Amid => "amid",
            Self::Several => "several",
        }
    }
}

/// The truth of one case.
#[derive(Clone, Debug, Deserialize)]
pub struct CaseTruth {
    /// Its name, and that of its files.
    pub case: String,
    /// The kind of difference between rig and belief.
    pub kind: Kind,
    /// The effects in which they differ.
    #[serde(default)]
    pub effects: Vec<TrueEffect>,
    /// Base parameters that are far from the belief.
    #[serde(default)]
    pub moved: Vec<String>,
    /// True gain, drag and hover.
    pub base: Values,
    /// All effects of the rig, believed or not.
    #[serde(default)]
    pub rig_effects: Vec<TrueEffect>,
    /// The small pieces that no model holds.
    #[serde(default)]
    pub clutter: Vec<Piece>,
}

impl CaseTruth {
    /// Everything that an entry may rightly name: the effects, and what pieces of the clutter may be called by.
    pub fn there(&self) -> impl Iterator<Item = &str> {
        let effects = self.effects.iter().map(|effect| effect.name.as_str());
        effects.chain(self.clutter.iter().filter_map(|piece| piece.kin.as_deref()))
    }
}

/// A piece of the clutter.
#[derive(Clone, Debug, Deserialize)]
pub struct Piece {
    /// The effect of the catalogue that it may rightly be called by.
    pub kin: Option<String>,
}

/// An effect of a rig.
#[derive(Clone, Debug, Deserialize)]
pub struct TrueEffect {
    /// Its name in the catalogue, or of something outside.
    pub name: String,
    /// `added`, `retuned` or `removed`; empty where nothing differs.
    #[serde(default)]
    pub change: String,
    /// True values; empty when removed.
    #[serde(default)]
    pub parameters: Values,
    /// Its stage on the signal path; empty if the truth does not have it.
    #[serde(default)]
    pub stage: String,
}

/// The bounds of a record.
#[derive(Clone, Debug, Deserialize)]
pub struct Bounds {
    /// The case.
    pub case: String,
    /// Log-likelihood gain of a perfect diagnosis over a refitted belief, nats. `None`: the effect changes the variance
    /// only, and no bound is known.
    pub nats: Option<f64>,
    /// The same of each true effect alone, for a belief with the others.
    #[serde(default)]
    pub each: Values,
    /// Cramér–Rao deviation of every true parameter: `gain_mm_per_s2_per_percent`, `fan_lag.time_constant_s`.
    #[serde(default)]
    pub sigma: Values,
}

#[cfg(test)]
pub(crate) mod tests {
    use super::{CaseTruth, Kind, TrueEffect};
    use crate::tests_support::model;

    /// The rig of the tests, whose lag bears this name.
    pub(crate) fn lag_of_a_rig(effect: &str) -> CaseTruth {
        let rig = model();
        let base = [
            ("gain_mm_per_s2_per_percent", rig.gain_mm_per_s2_per_percent),
            ("drag_per_s", rig.drag_per_s),
            ("hover_duty_percent", rig.hover_duty_percent),
        ];
        let lag = TrueEffect {
            name: effect.into(),
            change: "added".into(),
            parameters: [("time_constant_s".to_owned(), 0.2)].into(),
            stage: "actuator".into(),
        };
        CaseTruth {
            case: "made-up".into(),
            kind: Kind::Single,
            effects: vec![lag.clone()],
            moved: Vec::new(),
            base: base.map(|(key, value)| (key.to_owned(), value)).into(),
            rig_effects: vec![lag],
            clutter: Vec::new(),
        }
    }
}

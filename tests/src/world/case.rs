//! A case: the true rig, the believed rig, and their differences.

use crate::catalogue::{Effect, Reach, draw};
use crate::chance::{Chance, Source};
use crate::forms::clutter;
use crate::mixture::{Kind, Mixture, names, weighted};
use crate::programme::Programme;
use crate::rig::{Base, Parts};
use serde::Serialize;
use std::collections::BTreeMap;

/// Errors of the belief about a rig with clutter, as a multiple of the usual ones: gain and drag within 20 %, believed
/// effects within 28 %. Chosen by hand.
const CLUTTERED_BELIEF: f64 = 4.0;

/// The least noise of a rig with clutter, as a multiple of the usual one. Many real rigs have so little noise that every
/// small piece is significant. Chosen by hand.
const LEAST_NOISE: f64 = 0.1;

/// One difference between rig and belief.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Departure {
    /// Effect.
    pub(crate) name: &'static str,
    /// `added`, `retuned` or `removed`.
    pub(crate) change: &'static str,
    /// True values; empty when removed.
    pub(crate) parameters: BTreeMap<&'static str, f64>,
}

/// A withheld case.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    /// Kind.
    pub(crate) kind: Kind,
    /// True base parameters.
    pub(crate) base: Base,
    /// All effects of the rig.
    pub(crate) effects: Vec<Effect>,
    /// The small pieces that no model holds.
    pub(crate) clutter: Vec<Effect>,
    /// The noise of the rig, as a multiple of the usual one.
    pub(crate) noise: f64,
    /// Differences of the effects between rig and belief.
    pub(crate) departures: Vec<Departure>,
    /// Base parameters that differ by more than an owner's error.
    pub(crate) moved: Vec<&'static str>,
    /// Believed base parameters.
    pub(crate) belief: Base,
    /// Believed effects.
    pub(crate) believed: Vec<Effect>,
    /// The flight.
    pub(crate) programme: Programme,
}

impl Case {
    /// The rig's parts.
    pub(crate) fn parts(&self) -> Parts {
        let effects = self.effects.iter().chain(&self.clutter).cloned().collect();
        Parts { base: self.base, effects, seconds: self.programme.seconds, noise: self.noise, sensor_first: false }
    }

    /// The flight of this number of the same rig: 0 is the first one, others have other setpoints and noise.
    pub(crate) fn flight(&self, source: &Source, number: usize) -> (Source, Self) {
        if number == 0 {
            return (source.clone(), self.clone());
        }
        let source = Source { seed: format!("{}\nflight {number}", source.seed), case: source.case };
        let programme = Programme::draw(&mut source.stream("programme"));
        (source, Self { programme, ..self.clone() })
    }

    /// Draws a case. It depends on its source and the mixture only, not on other cases.
    pub(crate) fn draw(source: &Source, mixture: &Mixture) -> Self {
        let programme = Programme::draw(&mut source.stream("programme"));
        let c = &mut source.stream("design");
        let kind = weighted(c, &mixture.kinds);
        let names = names(c, kind, &mixture.effects);
        let base = Base {
            gain_mm_per_s2_per_percent: c.between(200.0, 320.0),
            drag_per_s: c.between(1.2, 2.2),
            hover_duty_percent: c.between(19.0, 25.0),
        };
        let error = match kind {
            _ if mixture.exact => 0.0,
            _ if kind.has_clutter() => CLUTTERED_BELIEF,
            _ => 1.0,
        };
        let mut case = Self {
            kind,
            base,
            effects: believed(c),
            clutter: Vec::new(),
            noise: 1.0,
            departures: Vec::new(),
            moved: Vec::new(),
            belief: near(c, base, error),
            believed: Vec::new(),
            programme,
        };
        case.believed = case.effects.iter().map(|effect| inexact(c, effect, error)).collect();
        for name in names {
            case.depart(c, name);
        }
        if kind == Kind::Parameters {
            case.move_base(c);
        }
        if kind.has_clutter() {
            case.clutter = clutter::draw(c, case.programme.seconds);
            case.noise = c.scale(LEAST_NOISE, 1.0);
        }
        case.belief = rounded(case.belief);
        case
    }

    /// Adds an effect to the rig; a believed one is retuned or removed.
    fn depart(&mut self, c: &mut Chance, name: &'static str) {
        let (low_mm, high_mm) = self.programme.reach();
        let mut effect = draw(name, c, Reach { low_mm, high_mm, seconds: self.programme.seconds });
        if matches!(name, "spin_asymmetry" | "duty_dependent_lag") {
            self.forget("fan_lag");
        }
        let change = *c.pick(&["added", "retuned", "removed"]);
        let old = self.effects.iter().find(|old| old.name == name).cloned();
        match (old, change) {
            (Some(old), "retuned") => effect = retuned(c, &old),
            (Some(_), "removed") => {
                self.effects.retain(|old| old.name != name);
                self.departures.push(Departure { name, change, parameters: BTreeMap::new() });
                return;
            }
            _ => self.forget(name),
        }
        let change = if self.believed.iter().any(|believed| believed.name == name) { "retuned" } else { "added" };
        self.effects.retain(|old| old.name != name);
        self.departures.push(Departure { name, change, parameters: effect.parameters.clone() });
        self.effects.push(effect);
    }

    /// Removes an effect from rig and belief.
    fn forget(&mut self, name: &str) {
        self.effects.retain(|effect| effect.name != name);
        self.believed.retain(|effect| effect.name != name);
    }

    /// Moves one base parameter, or two, far from the belief.
    fn move_base(&mut self, c: &mut Chance) {
        let both = c.happens(0.3);
        let first = (c.unit() * 3.0) as usize;
        for which in [Some(first), both.then_some((first + 1) % 3)].into_iter().flatten() {
            let factor = c.between(1.2, 1.45).powf(c.sign());
            let offset = c.sign() * c.between(0.3, 0.8);
            let (belief, base) = (&mut self.belief, self.base);
            self.moved.push(match which {
                0 => {
                    belief.gain_mm_per_s2_per_percent = base.gain_mm_per_s2_per_percent * factor;
                    "gain_mm_per_s2_per_percent"
                }
                1 => {
                    belief.drag_per_s = base.drag_per_s * factor;
                    "drag_per_s"
                }
                _ => {
                    belief.hover_duty_percent = base.hover_duty_percent + offset;
                    "hover_duty_percent"
                }
            });
        }
    }
}

/// Believed effects of a rig: a fan lag in about half of them, a dead zone in some.
fn believed(c: &mut Chance) -> Vec<Effect> {
    let lag = Effect::new("fan_lag", &[("time_constant_s", c.between(0.1, 0.24))]);
    let half = c.between(0.16, 0.28);
    let zone = Effect::new("dead_zone", &[("lower_percent", -half), ("upper_percent", half)]);
    let (with_lag, with_zone) = (c.happens(0.5), c.happens(0.2));
    with_lag.then_some(lag).into_iter().chain(with_zone.then_some(zone)).collect()
}

/// Believed base parameters: gain and drag within 5 %, hover within 0.08 %.
fn near(c: &mut Chance, base: Base, error: f64) -> Base {
    Base {
        gain_mm_per_s2_per_percent: base.gain_mm_per_s2_per_percent * (1.0 + error * c.between(-0.05, 0.05)),
        drag_per_s: base.drag_per_s * (1.0 + error * c.between(-0.05, 0.05)),
        hover_duty_percent: base.hover_duty_percent + error * c.between(-0.08, 0.08),
    }
}

/// A believed effect: parameters within 7 %.
fn inexact(c: &mut Chance, effect: &Effect, error: f64) -> Effect {
    let factor = 1.0 + error * c.between(-0.07, 0.07);
    let parameters = effect.parameters.iter().map(|(name, value)| (*name, (value * factor * 1e4).round() / 1e4));
    Effect { name: effect.name, parameters: parameters.collect() }
}

/// Wrong by a factor of 1.8 to 3, to either side; a lag to the shorter side where the longer one would make the loop
/// unstable.
fn retuned(c: &mut Chance, effect: &Effect) -> Effect {
    let (factor, up) = (c.between(1.8, 3.0), c.happens(0.5));
    let held = effect.parameters.get("time_constant_s").is_none_or(|tau| tau * factor < 0.42);
    let factor = if up && held { factor } else { factor.recip() };
    let parameters = effect.parameters.iter().map(|(name, value)| (*name, value * factor));
    Effect { name: effect.name, parameters: parameters.collect() }
}

/// As many digits as the belief's file has.
fn rounded(base: Base) -> Base {
    Base {
        gain_mm_per_s2_per_percent: (base.gain_mm_per_s2_per_percent * 1e3).round() / 1e3,
        drag_per_s: (base.drag_per_s * 1e4).round() / 1e4,
        hover_duty_percent: (base.hover_duty_percent * 1e3).round() / 1e3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{all_names, inside};

    fn drawn(kind: Kind) -> impl Iterator<Item = Case> {
        let mixture = Mixture { kinds: vec![(kind, 1.0)], effects: all_names(), exact: false };
        (0..400).map(move |case| Case::draw(&Source { seed: "cases".into(), case }, &mixture))
    }

    fn off(belief: f64, truth: f64) -> f64 {
        (belief / truth).ln().abs()
    }

    #[test]
    fn no_belief_is_exact_and_none_is_far_off_where_only_that_is_wrong() {
        for case in drawn(Kind::None) {
            let (base, belief) = (case.base, case.belief);
            assert!(off(belief.gain_mm_per_s2_per_percent, base.gain_mm_per_s2_per_percent) < 0.052);
            assert!(off(belief.drag_per_s, base.drag_per_s) < 0.052 && belief != base);
            assert!((belief.hover_duty_percent - base.hover_duty_percent).abs() < 0.081);
            for (known, real) in case.believed.iter().zip(&case.effects) {
                assert_eq!(known.name, real.name);
                assert!(known.parameters.iter().all(|(key, value)| off(*value, real.get(key)) < 0.074));
            }
            assert!(case.departures.is_empty() && case.moved.is_empty());
        }
    }

    #[test]
    fn moved_parameters_are_far_off() {
        for case in drawn(Kind::Parameters) {
            assert!(!case.moved.is_empty() && case.departures.is_empty());
            for moved in &case.moved {
                let (belief, base) = (case.belief, case.base);
                assert!(match *moved {
                    "gain_mm_per_s2_per_percent" =>
                        off(belief.gain_mm_per_s2_per_percent, base.gain_mm_per_s2_per_percent) > 0.18,
                    "drag_per_s" => off(belief.drag_per_s, base.drag_per_s) > 0.18,
                    _ => (belief.hover_duty_percent - base.hover_duty_percent).abs() > 0.29,
                });
            }
        }
    }

    #[test]
    fn departures_say_what_separates_rig_and_belief() {
        for case in drawn(Kind::Single).chain(drawn(Kind::Pair)).chain(drawn(Kind::Outside)) {
            assert_eq!(case.departures.len(), if case.kind == Kind::Pair { 2 } else { 1 });
            for Departure { name, change, parameters } in &case.departures {
                let real = case.effects.iter().find(|effect| effect.name == *name);
                let known = case.believed.iter().any(|effect| effect.name == *name);
                assert_eq!(known, *change != "added", "{name} {change}");
                assert_eq!(real.map(|effect| effect.parameters.clone()).unwrap_or_default(), *parameters);
                assert_eq!(real.is_none(), *change == "removed");
                assert_eq!(inside(name), case.kind != Kind::Outside);
            }
            let lags = ["fan_lag", "spin_asymmetry", "duty_dependent_lag"];
            assert!(case.effects.iter().filter(|effect| lags.contains(&effect.name)).count() <= 1);
        }
    }

    #[test]
    fn rigs_amid_clutter_have_pieces_that_no_belief_holds_and_none_one_or_three_to_five_effects() {
        for (kind, counts) in [(Kind::Clutter, 0..=0), (Kind::Amid, 1..=1), (Kind::Several, 3..=5)] {
            for case in drawn(kind).take(100) {
                assert!(counts.contains(&case.departures.len()), "{kind:?}: {}", case.departures.len());
                assert!((5..=8).contains(&case.clutter.len()) && (LEAST_NOISE..=1.0).contains(&case.noise), "{kind:?}");
                assert_eq!(case.parts().effects.len(), case.effects.len() + case.clutter.len());
                assert!(case.believed.iter().all(|known| case.clutter.iter().all(|piece| piece.name != known.name)));
                let (base, belief) = (case.base, case.belief);
                assert!(off(belief.gain_mm_per_s2_per_percent, base.gain_mm_per_s2_per_percent) < 0.23);
            }
        }
        assert!(drawn(Kind::Single).all(|case| case.clutter.is_empty() && case.noise == 1.0));
    }
}

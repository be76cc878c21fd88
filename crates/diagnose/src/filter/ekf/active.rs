//! Sums and products over the states that a model has.

use super::{STATES, Square, State};
use nalgebra::SMatrix;
use plant::Model;

/// A covariance smaller than this, in any unit, counts as 0. The variance of a state without process noise, such as
/// that of a fan lag, tends to 0, and subnormal numbers make a step ten times slower.
const NEGLIGIBLE: f64 = 1e-100;

/// The number, or 0 where it is negligible.
fn flush_tiny(number: f64) -> f64 {
    if number.abs() < NEGLIGIBLE { 0.0 } else { number }
}

/// Evaluates an expression with the indices of the active states as an array, whose length the compiler then knows.
macro_rules! in_active {
    ($active:expr, $own:ident => $body:expr) => {{
        let [a, b, c, d, e, f, g] = $active.own;
        match $active.count {
            2 => in_active!($own = [a, b] => $body),
            3 => in_active!($own = [a, b, c] => $body),
            4 => in_active!($own = [a, b, c, d] => $body),
            5 => in_active!($own = [a, b, c, d, e] => $body),
            6 => in_active!($own = [a, b, c, d, e, f] => $body),
            _ => in_active!($own = [a, b, c, d, e, f, g] => $body),
        }
    }};
    ($own:ident = $indices:expr => $body:expr) => {{
        let $own = $indices;
        $body
    }};
}

/// The active states of a model; the others follow from them or from the command. Most models have two of seven, and
/// the products of the covariance take most of the time of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    own: [usize; STATES],
    count: usize,
}

impl Active {
    /// Those of `model`.
    pub(super) fn of(model: &Model) -> Self {
        let effects = &model.effects;
        let (fan, sensor) = (effects.has_fan_state(), effects.has_sensor_state());
        let (air, number) = (effects.coloured_force().is_some(), effects.own_states());
        let active = [true, true, fan, air, sensor, number > 0, number > 1];
        let (mut own, mut count) = ([0; STATES], 0);
        for (i, _) in active.iter().enumerate().filter(|(_, active)| **active) {
            own[count] = i;
            count += 1;
        }
        Self { own, count }
    }

    /// Their indices, ascending.
    #[inline(always)]
    pub(super) fn indices(&self) -> &[usize] {
        &self.own[..self.count]
    }

    /// P ← Φ·P·Φᵀ + Q. The covariance of the other states is never used.
    pub(super) fn predict(&self, transition: &Square, noise: &Square, covariance: &mut Square) {
        in_active!(self, own => predict_in(own, transition, noise, covariance));
    }

    /// P ← P − t·tᵀ·share.
    #[inline]
    pub(super) fn reduce(&self, covariance: &mut Square, towards: &State, share: f64) {
        in_active!(self, own => reduce_in(own, covariance, towards, share));
    }

    /// δ ← Φ·δ, with `half_kick` added to the velocity before and after it.
    #[inline(always)]
    pub(super) fn transfer(&self, transition: &Square, change: &mut State, half_kick: f64) {
        in_active!(self, own => transfer_in(own, transition, change, half_kick));
    }

    /// δ ← δ − t·share.
    #[inline(always)]
    pub(super) fn correct(&self, change: &mut State, towards: &State, share: f64) {
        in_active!(self, own => own.iter().for_each(|&i| change[i] = flush_tiny(change[i] - towards[i] * share)));
    }
}

#[inline(always)]
fn transfer_in<const N: usize>(own: [usize; N], transition: &Square, change: &mut State, half_kick: f64) {
    change[1] += half_kick;
    let moved = own.map(|i| own.iter().map(|j| transition[(i, *j)] * change[*j]).sum());
    own.iter().zip(moved).for_each(|(i, moved)| change[*i] = moved);
    change[1] += half_kick;
}

#[inline(always)]
fn reduce_in<const N: usize>(own: [usize; N], covariance: &mut Square, towards: &State, share: f64) {
    for i in own {
        for j in own {
            covariance[(i, j)] -= towards[i] * towards[j] * share;
        }
    }
}

#[inline(always)]
fn predict_in<const N: usize>(own: [usize; N], transition: &Square, noise: &Square, covariance: &mut Square) {
    let of = |all: &Square| SMatrix::<f64, N, N>::from_fn(|i, j| all[(own[i], own[j])]);
    let transition = of(transition);
    let known = transition * of(covariance) * transition.transpose() + of(noise);
    for (i, at) in own.iter().enumerate() {
        for (j, and) in own.iter().enumerate() {
            covariance[(*at, *and)] = flush_tiny(known[(i, j)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Square;
    use super::Active;
    use crate::tests_support::model;
    use plant::{Effects, Model};

    /// A test matrix without symmetry, with entries of both signs.
    fn any(seed: f64) -> Square {
        Square::from_fn(|i, j| (seed + 7.1 * i as f64 + 3.3 * j as f64).sin())
    }

    #[test]
    fn the_covariance_of_the_active_states_is_that_of_the_whole_product() {
        let none = Model { effects: Effects::default(), ..model() };
        let mut all = model();
        all.effects.set("turbulence", &[300.0, 0.5]);
        let mut two = all.clone();
        all.effects.set("sensor_lag", &[0.1]);
        two.effects.remove("fan_lag");
        for (model, own) in [(none, &[0, 1][..]), (model(), &[0, 1, 2]), (two, &[0, 1, 3]), (all, &[0, 1, 2, 3, 4])] {
            let is_own = |i: usize| own.contains(&i);
            let of_own = |m: Square| Square::from_fn(|i, j| if is_own(i) && is_own(j) { m[(i, j)] } else { 0.0 });
            let [transition, noise, before] = [1.0, 2.0, 3.0].map(|seed| of_own(any(seed)));
            let whole = transition * before * transition.transpose() + noise;
            let mut after = before;
            Active::of(&model).predict(&transition, &noise, &mut after);
            assert!((after - whole).abs().max() < 1e-14, "{after} for {whole}");
            // The entries of the other states must not be used.
            let mut spoilt = Square::from_fn(|i, j| if is_own(i) && is_own(j) { before[(i, j)] } else { f64::NAN });
            Active::of(&model).predict(&transition, &noise, &mut spoilt);
            assert_eq!(of_own(spoilt), after);
        }
    }

    #[test]
    fn a_covariance_that_decays_becomes_zero_and_no_subnormal_number() {
        let own = |m: Square| Square::from_fn(|i, j| if i < 3 && j < 3 { m[(i, j)] } else { 0.0 });
        let (mut covariance, halve) = (own(any(1.0)), Square::identity() * 0.5);
        for _ in 0..600 {
            Active::of(&model()).predict(&halve, &Square::zeros(), &mut covariance);
            assert!(covariance.iter().all(|number| *number == 0.0 || number.is_normal()), "{covariance}");
        }
        assert_eq!(covariance, Square::zeros());
    }
}

//! The forms of a linear plant that a record may be of, and which of them a first belief begins with.
//!
//! A force that returns the rig to one place is believed only where the input shows nothing without it: dry friction
//! looks a little like one. One that drives it away, as gravity does where a pendulum is upright, is believed where it
//! is more likely than every other form.

use crate::linear::{LinearFit, Order, linear_fit};
use crate::record::recording::Recording;
use rayon::prelude::*;

/// A gain that lies this many of its deviations from 0 is seen.
pub(super) const SEEN: f64 = 4.0;
/// The same, for a form to be preferred to one with a spring.
const WELL_SEEN: f64 = 8.0;
/// A plant of first order must be seen so well, and a form of second order may be better by so much a reading, nats: it
/// describes the noise of a speed better.
const FIRST_ORDER_SEEN: f64 = 10.0;
const FIRST_ORDER_NEAR: f64 = 0.15;
/// Share of the forecasts' variance that an input of the other sign must explain, with or without a spring.
const TURNED: f64 = 0.15;
/// By so much must an unstable plant be more likely than every other form, nats: by chance its spring gains half a nat.
const UNSTABLE: f64 = 10.0;

/// The forms of a linear plant, fitted to a record.
pub(super) struct Forms {
    first: LinearFit,
    second: LinearFit,
    spring: LinearFit,
    unstable: LinearFit,
    drifting: LinearFit,
    readings: f64,
}

impl Forms {
    /// `None`: too few readings, or an input or a position that never moves.
    pub(super) fn of(recording: &Recording) -> Option<Self> {
        let orders = [Order::First, Order::Second, Order::Spring, Order::Unstable, Order::Drifting];
        let fits: Vec<LinearFit> = orders.par_iter().filter_map(|order| linear_fit(recording, *order)).collect();
        let [first, second, spring, unstable, drifting] = fits[..] else { return None };
        Some(Self { first, second, spring, unstable, drifting, readings: recording.readings() as f64 })
    }

    /// The time constant of a plant of first order, seconds, if the record is of one.
    pub(super) fn first_order_s(&self) -> Option<f64> {
        let ahead = (self.spring.log_likelihood - self.first.log_likelihood) / self.readings;
        let second_is_blind = self.second.gain_in_deviations.abs() < SEEN && ahead < FIRST_ORDER_NEAR;
        let is_first = self.first.log_likelihood > self.second.log_likelihood || second_is_blind;
        let is_seen = self.first.gain_in_deviations.abs() > FIRST_ORDER_SEEN;
        (is_first && is_seen).then_some(1.0 / self.first.drag_per_s)
    }

    /// Whether a force drives the rig away from one place.
    fn is_unstable(&self) -> bool {
        let others = [&self.first, &self.second, &self.spring, &self.drifting].map(|form| form.log_likelihood);
        let most = others.into_iter().fold(f64::NEG_INFINITY, f64::max);
        self.unstable.gain_in_deviations.abs() > WELL_SEEN && self.unstable.log_likelihood > most + UNSTABLE
    }

    /// Whether the forms say that the position falls where the input rises.
    pub(super) fn are_turned(&self) -> bool {
        if self.is_unstable() {
            return self.unstable.gain < 0.0;
        }
        let turned = |form: &LinearFit| form.gain < 0.0 && form.explained(self.readings) > TURNED;
        (turned(&self.second) || turned(&self.spring)) && self.drifting.gain_in_deviations < -SEEN
    }

    /// The sign of the input.
    pub(super) fn sign(&self) -> f64 {
        if self.are_turned() { -1.0 } else { 1.0 }
    }

    /// Whether the form to begin with shows that sign.
    pub(super) fn show_sign(&self) -> bool {
        self.sign() * self.start().gain_in_deviations > SEEN
    }

    /// The form to begin with.
    pub(super) fn start(&self) -> LinearFit {
        let sign = self.sign();
        if self.is_unstable() {
            return self.unstable;
        }
        let is_seen = |form: &&LinearFit, least: f64| sign * form.gain_in_deviations > least;
        let spring = is_seen(&&self.spring, SEEN) && self.spring.log_likelihood > self.second.log_likelihood;
        match [&self.second, &self.drifting].into_iter().find(|form| is_seen(form, SEEN)) {
            _ if is_seen(&&self.second, WELL_SEEN) => self.second,
            _ if spring => self.spring,
            Some(form) => *form,
            None => self.second,
        }
    }

    /// The gain of the form that sees it best, in its deviations.
    pub(super) fn best_deviations(&self) -> f64 {
        let forms = [&self.second, &self.spring, &self.unstable, &self.drifting];
        forms.map(|form| form.gain_in_deviations.abs()).into_iter().fold(0.0, f64::max)
    }
}

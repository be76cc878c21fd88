//! Words and switches: which variant of a law flies, and which table is there.
//!
//! A switch that adds a table leaves its numbers without a value (NaN), where no value is without an effect: the check
//! of the tables then asks for them by name, in the same transaction.

use super::Numbers;
use super::parameter::{Parameter, Place};
use crate::compensation::DeadZoneCorrection;
use crate::dither::Dither;
use crate::feed_forward::FeedForward;
use crate::inputs::Source;
use crate::observer::Gain;
use crate::pid::{AntiWindup, DerivativeOn};
use crate::state_feedback::Integral;

/// The words of a switch.
const SWITCH: &[&str] = &["off", "on"];
/// The words of a source of velocity.
const SOURCES: &[&str] = &["filter", "observer"];

const fn word(
    name: &'static str,
    words: &'static [&'static str],
    place: fn(&mut Numbers, Option<u8>) -> Option<u8>,
) -> Parameter {
    Parameter { name, unit: "", words, place: Place::Word(place) }
}

/// All words.
pub(super) const WORDS: [Parameter; 9] = [
    word("pid.derivative_on", &["measurement", "error"], |n, to| {
        let signal = &mut n.controllers.pid.as_mut()?.derivative_on;
        choose(signal, to, &[DerivativeOn::Measurement, DerivativeOn::Error])
    }),
    word("pid.anti_windup", &["clamping", "back_calculation"], |n, to| {
        let law = &mut n.controllers.pid.as_mut()?.anti_windup;
        *law = match (to, *law) {
            (Some(0), _) => AntiWindup::Clamping,
            (Some(_), AntiWindup::Clamping) => AntiWindup::BackCalculation { tracking_s: f64::NAN },
            _ => *law,
        };
        Some(u8::from(*law != AntiWindup::Clamping))
    }),
    word("cascade.velocity", SOURCES, |n, to| source(&mut n.controllers.cascade.as_mut()?.velocity, to)),
    word("state_feedback.velocity", SOURCES, |n, to| source(&mut n.controllers.state_feedback.as_mut()?.velocity, to)),
    word("state_feedback.integral", &["none", "added", "in_place"], |n, to| {
        let integral = &mut n.controllers.state_feedback.as_mut()?.integral;
        let ti_s = match *integral {
            Some(Integral::Added { ti_s } | Integral::InPlace { ti_s }) => ti_s,
            None => f64::NAN,
        };
        match to {
            Some(0) => *integral = None,
            Some(1) => *integral = Some(Integral::Added { ti_s }),
            Some(_) => *integral = Some(Integral::InPlace { ti_s }),
            None => {}
        }
        Some(match integral {
            None => 0,
            Some(Integral::Added { .. }) => 1,
            Some(Integral::InPlace { .. }) => 2,
        })
    }),
    word("feed_forward", SWITCH, |n, to| {
        switch(&mut n.controllers.feed_forward, to, FeedForward { time_constant_s: f64::NAN })
    }),
    word("compensation.dead_zone", SWITCH, |n, to| switch(&mut n.compensation.dead_zone, to, DeadZoneCorrection::NONE)),
    word("compensation.dither", SWITCH, |n, to| {
        switch(&mut n.compensation.dither, to, Dither { step_percent: f64::NAN, seed: 0 })
    }),
    word("observer.gain", &["steady_state", "time_varying"], |n, to| {
        choose(&mut n.observer.as_mut()?.gain, to, &[Gain::SteadyState, Gain::TimeVarying])
    }),
];

/// Sets one of some variants, in the order of their words, and returns which it is.
fn choose<T: Copy + PartialEq>(held: &mut T, to: Option<u8>, all: &[T]) -> Option<u8> {
    if let Some(chosen) = to.and_then(|at| all.get(usize::from(at))) {
        *held = *chosen;
    }
    (0_u8..).zip(all).find_map(|(at, one)| (one == held).then_some(at))
}

fn source(held: &mut Source, to: Option<u8>) -> Option<u8> {
    choose(held, to, &[Source::Filter, Source::Observer])
}

/// Takes a table away or adds it, and returns whether it is there.
fn switch<T>(table: &mut Option<T>, to: Option<u8>, added: T) -> Option<u8> {
    match to {
        Some(0) => *table = None,
        Some(_) if table.is_none() => *table = Some(added),
        _ => {}
    }
    Some(u8::from(table.is_some()))
}

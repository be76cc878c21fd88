//! The faults of the campaign: what is spoilt, how, at which registers and for how long.

use crate::config::{Safety, Tables};
use crate::flight::FAN_FAILURES;
use hal::emulator::{EmulatedBus, Fault, World};

/// The period of a cycle and of the readings, seconds.
pub(super) const PERIOD_S: f64 = 0.02;
/// How late each cycle of a slow processor begins, seconds.
pub(super) const SLOW_BY_S: f64 = 0.03;
/// Two cycles of docs/rig.md, and one for the moment in a cycle.
const CYCLES: f64 = 3.0;
/// Without an edge for so long the tachometer's speed is 0, seconds.
const STANDS_AFTER_S: f64 = 0.25;

pub(super) const SENSOR: u8 = 0x29;
pub(super) const FAN: u8 = 0x40;
/// Of the rig that has one.
pub(super) const SECOND: u8 = 0x30;

/// Registers of which a cycle makes use: ready, range status with distance, and interrupt of the sensor; the fan's
/// channel and its off-bit.
const REGISTERS: [(u8, u8); 5] = [(SENSOR, 0x13), (SENSOR, 0x14), (SENSOR, 0x0B), (FAN, 0x06), (FAN, 0x09)];

/// What happens to the rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mishap {
    /// The wires of these chips, at this register if there is one.
    Wires { chips: &'static [u8], register: Option<u8>, fault: Fault },
    /// Both chips lose their power for a moment.
    Power,
    /// The ball leaves the pipe.
    BallLost,
    /// These sensors see the ball and do not vouch for it: too little light.
    Doubtful { sensors: &'static [u8] },
    /// The ball jams where it is.
    BallStuck,
    /// The sensor gives its last reading for ever, as if it were new.
    SensorFrozen,
    /// The fan stops, for want of a supply or because something blocks it.
    FanStalled,
    /// The tachometer's wire breaks.
    TachometerCut,
    /// The second sensor reads so much too far.
    SecondOff { mm: f64 },
    /// The processor is taken away for so long, once.
    Pause { seconds: f64 },
    /// The processor is taken away in every cycle, for longer than the cycle lasts.
    Slow,
}

/// Of each sensor that there is.
pub(super) const DOUBTFUL: Mishap = Mishap::Doubtful { sensors: &[SENSOR, SECOND] };

/// For how long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lasting {
    /// So many transactions, or cycles where it is no fault of wires.
    Times(u64),
    /// Until it is repaired after the flight.
    ForEver,
}

/// One entry of the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Case {
    pub(super) mishap: Mishap,
    pub(super) lasting: Lasting,
}

impl Case {
    /// Injects a fault of wires from transaction `skip` on.
    pub(super) fn spoil<W: World>(&self, bus: &EmulatedBus<W>, skip: u64) {
        let Mishap::Wires { chips, register, fault } = self.mishap else { return };
        for chip in chips {
            let from = bus.transactions(*chip) + skip;
            let to = match self.lasting {
                Lasting::Times(times) => from + times,
                Lasting::ForEver => u64::MAX,
            };
            match register {
                Some(register) => bus.inject_at(*chip, register, fault, from..to),
                None => bus.inject(*chip, fault, from..to),
            }
        }
    }

    /// Seconds from the fault to the end of the flight, where the loop loses its sight or its hands for good: what
    /// docs/rig.md states, from the config, and a cycle more, because the cycle that it happens in may be past what it
    /// spoils. `None`: the flight may go on.
    pub(super) fn bound_s(&self, tables: &Tables) -> Option<f64> {
        let (safety, rig) = (tables.safety?, tables.rig.as_ref()?);
        let within = |watched_s: f64| Some(watched_s + CYCLES * PERIOD_S);
        match self.mishap {
            Mishap::Wires { chips, register, fault } if self.lasting == Lasting::ForEver => {
                wires_bound_s(chips, register, fault, &safety)
            }
            Mishap::Wires { .. } => None,
            // The fan's chip lost its power too, and that shows first.
            Mishap::Power => Some(f64::from(FAN_FAILURES + 1) * PERIOD_S),
            Mishap::BallLost | Mishap::Doubtful { .. } => within(safety.coast_s),
            // Of each cycle so much is late, and the next deadline is missed.
            Mishap::Slow => {
                let cycle_s = (SLOW_BY_S / PERIOD_S).ceil() * PERIOD_S;
                Some((safety.stall_s / SLOW_BY_S + CYCLES) * cycle_s)
            }
            Mishap::Pause { seconds } => within((seconds >= safety.stall_s).then_some(seconds)?),
            Mishap::FanStalled | Mishap::TachometerCut => within(STANDS_AFTER_S + rig.tachometer?.stalled_after_s),
            Mishap::SecondOff { .. } => within(rig.second_sensor?.disagree_s),
            // As long as the controller is content with what it sees; see `push_bound_s`.
            Mishap::BallStuck | Mishap::SensorFrozen => None,
        }
    }

    /// Seconds for which the controller may push a ball that does not move, or does not seem to.
    pub(super) fn push_bound_s(&self, tables: &Tables) -> Option<f64> {
        let stuck = tables.safety?.stuck?;
        matches!(self.mishap, Mishap::BallStuck | Mishap::SensorFrozen).then_some(stuck.after_s + CYCLES * PERIOD_S)
    }
}

/// The same of wires that stay broken: whichever shows first of no sight for `coast_s`, writes that fail, and a cycle
/// that hangs for `stall_s`.
fn wires_bound_s(chips: &[u8], register: Option<u8>, fault: Fault, safety: &Safety) -> Option<f64> {
    // The driver returns the first error it meets, so that a cycle hangs once for each chip.
    let hangs_s = if let Fault::Timeout { seconds } = fault { seconds * chips.len() as f64 } else { 0.0 };
    let cycle_s = PERIOD_S + hangs_s;
    let says_nothing = matches!(fault, Fault::StuckHigh | Fault::StuckLow);
    let unseen = match (register, fault) {
        (_, Fault::Noise { .. } | Fault::Flips { .. }) => true,
        // "Ready" that is always set, and an interrupt that is never cleared, show old readings as new.
        (Some(0x13), Fault::StuckHigh) => true,
        (Some(0x0B), _) => says_nothing,
        // The off-bit is not in use.
        (Some(0x09), _) => true,
        _ => false,
    };
    let blind_s = (!chips.contains(&FAN) || chips.contains(&SENSOR)).then_some(safety.coast_s + CYCLES * cycle_s);
    let helpless_s = chips.contains(&FAN).then_some(f64::from(FAN_FAILURES + 1) * cycle_s);
    let stalled_s = (hangs_s >= safety.stall_s).then_some(2.0 * cycle_s);
    let first_s = [blind_s, helpless_s, stalled_s].into_iter().flatten().reduce(f64::min);
    first_s.filter(|_| !unseen)
}

fn kinds(seed: u64) -> [Fault; 8] {
    [
        Fault::Nack,
        Fault::StuckHigh,
        Fault::StuckLow,
        Fault::Timeout { seconds: 0.01 },
        Fault::Timeout { seconds: 0.1 },
        Fault::Timeout { seconds: 1.0 },
        Fault::Noise { seed },
        Fault::Flips { seed },
    ]
}

/// The list. `seed` is that of the random bytes.
pub(super) fn cases(seed: u64) -> Vec<Case> {
    let mut cases = Vec::new();
    for fault in kinds(seed) {
        for chips in [&[SENSOR][..], &[FAN], &[SENSOR, FAN]] {
            for lasting in [Lasting::Times(1), Lasting::Times(7), Lasting::Times(60), Lasting::ForEver] {
                cases.push(Case { mishap: Mishap::Wires { chips, register: None, fault }, lasting });
            }
        }
        for (chip, register) in REGISTERS {
            let chips = if chip == SENSOR { &[SENSOR][..] } else { &[FAN] };
            for lasting in [Lasting::Times(20), Lasting::ForEver] {
                cases.push(Case { mishap: Mishap::Wires { chips, register: Some(register), fault }, lasting });
            }
        }
    }
    let others = [Mishap::Power, Mishap::BallLost, DOUBTFUL, Mishap::BallStuck, Mishap::SensorFrozen, Mishap::Slow];
    let pauses = [0.015, 0.1, 0.6, 3.0].map(|seconds| Mishap::Pause { seconds });
    cases.extend(others.into_iter().chain(pauses).map(|mishap| Case { mishap, lasting: Lasting::ForEver }));
    cases
}

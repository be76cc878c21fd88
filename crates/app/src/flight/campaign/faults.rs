//! The faults of the campaign: what fails, how, at which registers and for how long.

use crate::flight::FAN_FAILURES;
use config::{Safety, Tables};
use hal::emulator::{EmulatedBus, Fault, World};

/// The period of a cycle and of the readings, seconds.
pub(super) const PERIOD_S: f64 = 0.02;
/// Lateness of each cycle on a slow processor, seconds.
pub(super) const SLOW_BY_S: f64 = 0.03;
/// Two cycles of docs/rig.md, and one for the time of the fault within a cycle.
const CYCLES: f64 = 3.0;
/// The tachometer's speed is 0 after this time without an edge, seconds.
const STANDS_AFTER_S: f64 = 0.25;

pub(super) const SENSOR: u8 = 0x29;
pub(super) const FAN: u8 = 0x40;
/// Address of the second sensor on a rig that has one.
pub(super) const SECOND: u8 = 0x30;

/// Registers that a cycle uses: ready, range status with distance, and interrupt of the sensor; the fan's channel and
/// its off-bit.
const REGISTERS: [(u8, u8); 5] = [(SENSOR, 0x13), (SENSOR, 0x14), (SENSOR, 0x0B), (FAN, 0x06), (FAN, 0x09)];

/// A failure of the rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mishap {
    /// The wires of these chips, at this register if there is one.
    Wires { chips: &'static [u8], register: Option<u8>, fault: Fault },
    /// Both chips lose their power for a moment.
    Power,
    /// The ball leaves the pipe.
    BallLost,
    /// These sensors see the ball and mark their readings as not valid: too little light.
    Doubtful { sensors: &'static [u8] },
    /// The ball jams where it is.
    BallStuck,
    /// The sensor repeats its last reading for ever, as if it were new.
    SensorFrozen,
    /// The fan stops, for lack of supply or because it is blocked.
    FanStalled,
    /// The tachometer's wire breaks.
    TachometerCut,
    /// The second sensor reads too far by this distance.
    SecondOff { mm: f64 },
    /// The processor is not available for this time, once.
    Pause { seconds: f64 },
    /// In every cycle the processor is not available for longer than the period.
    Slow,
}

/// Readings that each sensor marks as not valid.
pub(super) const DOUBTFUL: Mishap = Mishap::Doubtful { sensors: &[SENSOR, SECOND] };

/// Duration of the fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lasting {
    /// This number of transactions, or of cycles where it is not a fault of wires.
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

    /// Seconds from the fault to the end of the flight, where sensor or fan is lost for good: the bound of docs/rig.md,
    /// from the config, and one cycle more, because the cycle of the fault may already be past the affected
    /// transaction. `None`: the flight may go on.
    pub(super) fn bound_s(&self, tables: &Tables) -> Option<f64> {
        let (safety, rig) = (tables.safety?, tables.rig.as_ref()?);
        let within = |watched_s: f64| Some(watched_s + CYCLES * PERIOD_S);
        match self.mishap {
            Mishap::Wires { chips, register, fault } if self.lasting == Lasting::ForEver => {
                wires_bound_s(chips, register, fault, &safety)
            }
            Mishap::Wires { .. } => None,
            // The fan's chip lost its power too, which is detected first.
            Mishap::Power => Some(f64::from(FAN_FAILURES + 1) * PERIOD_S),
            Mishap::BallLost | Mishap::Doubtful { .. } => within(safety.coast_s),
            // Each cycle is late by this much, and the next deadline is missed.
            Mishap::Slow => {
                let cycle_s = (SLOW_BY_S / PERIOD_S).ceil() * PERIOD_S;
                Some((safety.stall_s / SLOW_BY_S + CYCLES) * cycle_s)
            }
            Mishap::Pause { seconds } => within((seconds >= safety.stall_s).then_some(seconds)?),
            Mishap::FanStalled | Mishap::TachometerCut => within(STANDS_AFTER_S + rig.tachometer?.stalled_after_s),
            Mishap::SecondOff { .. } => within(rig.second_sensor?.disagree_s),
            // No bound as long as the controller has no error; see `push_bound_s`.
            Mishap::BallStuck | Mishap::SensorFrozen => None,
        }
    }

    /// Seconds for which the controller may push a ball that does not move, or seems not to.
    pub(super) fn push_bound_s(&self, tables: &Tables) -> Option<f64> {
        let stuck = tables.safety?.stuck?;
        matches!(self.mishap, Mishap::BallStuck | Mishap::SensorFrozen).then_some(stuck.after_s + CYCLES * PERIOD_S)
    }
}

/// The same for wires that remain broken: the first of no reading for `coast_s`, failed writes, and a cycle that hangs
/// for `stall_s`.
fn wires_bound_s(chips: &[u8], register: Option<u8>, fault: Fault, safety: &Safety) -> Option<f64> {
    // The driver returns the first error, so that a cycle hangs once for each chip.
    let hangs_s = if let Fault::Timeout { seconds } = fault { seconds * chips.len() as f64 } else { 0.0 };
    let cycle_s = PERIOD_S + hangs_s;
    let says_nothing = matches!(fault, Fault::StuckHigh | Fault::StuckLow);
    let unseen = match (register, fault) {
        (_, Fault::Noise { .. } | Fault::Flips { .. }) => true,
        // If "ready" is always set, or the interrupt is never cleared, old readings appear as new.
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

/// The list. `seed` is the seed of the random bytes.
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

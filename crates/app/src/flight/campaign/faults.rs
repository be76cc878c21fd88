//! The faults of the campaign: what is spoilt, how, at which registers and for how long.

use hal::emulator::{EmulatedBus, Fault, World};

pub(super) const SENSOR: u8 = 0x29;
pub(super) const FAN: u8 = 0x40;
/// Of the rig that has one.
pub(super) const SECOND: u8 = 0x30;

/// Registers of which a cycle makes use: status, distance and interrupt of the sensor; the fan's channel and its off-bit.
const REGISTERS: [(u8, u8); 5] = [(SENSOR, 0x13), (SENSOR, 0x1E), (SENSOR, 0x0B), (FAN, 0x06), (FAN, 0x09)];

/// What happens to the rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mishap {
    /// The wires of these chips, at this register if there is one.
    Wires { chips: &'static [u8], register: Option<u8>, fault: Fault },
    /// Both chips lose their power for a moment.
    Power,
    /// The ball leaves the pipe.
    BallLost,
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

    /// Seconds from the fault to fan off, where the loop loses its sight or its hands for good: `[safety] coast_s` or
    /// `stall_s`, and what hangs meanwhile. `None`: the flight may go on.
    pub(super) fn bound_s(&self) -> Option<f64> {
        const COAST_OR_STALL_S: f64 = 0.5;
        const CYCLES_S: f64 = 0.1;
        let held_up_s = match self.mishap {
            Mishap::Wires { register, fault, .. } => {
                let blinds = match (register, fault) {
                    (_, Fault::Noise { .. } | Fault::Flips { .. }) => false,
                    // The status shows old readings as new; an interrupt that stays does so too; the off-bit is not in use.
                    (Some(0x13), Fault::StuckHigh) | (Some(0x0B | 0x09), _) => false,
                    _ => self.lasting == Lasting::ForEver,
                };
                let hangs_s = if let Fault::Timeout { seconds } = fault { 2.0 * seconds } else { 0.0 };
                blinds.then_some(hangs_s)?
            }
            Mishap::Power | Mishap::BallLost => 0.0,
            // A cycle of 20 ms takes 40.
            Mishap::Slow => COAST_OR_STALL_S,
            Mishap::BallStuck | Mishap::SensorFrozen => return None,
            // After 0.25 s without an edge the speed is 0.
            Mishap::FanStalled | Mishap::TachometerCut => 0.25,
            Mishap::SecondOff { .. } => 0.0,
            Mishap::Pause { seconds } => (seconds >= COAST_OR_STALL_S).then_some(seconds)?,
        };
        Some(COAST_OR_STALL_S + CYCLES_S + held_up_s)
    }
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
    let others = [Mishap::Power, Mishap::BallLost, Mishap::BallStuck, Mishap::SensorFrozen, Mishap::Slow];
    let pauses = [0.015, 0.1, 0.6, 3.0].map(|seconds| Mishap::Pause { seconds });
    cases.extend(others.into_iter().chain(pauses).map(|mishap| Case { mishap, lasting: Lasting::ForEver }));
    cases
}

//! The stream of every cycle on request: in batches, and for a limited time after each request, so that it ends when a
//! page is closed.

use crate::flight::vocabulary::Cycle;
use std::time::{Duration, Instant};

/// Validity of a request. A reader requests again within this time.
pub(super) const LEASE: Duration = Duration::from_secs(5);
/// Largest number of cycles in a batch: three times what the fastest loop makes between two.
const ROOM: usize = 64;

/// End of the request, and the cycles that are not yet published.
#[derive(Debug, Default)]
pub(super) struct Stream {
    until: Option<Instant>,
    batch: Vec<Cycle>,
    dropped: u32,
}

impl Stream {
    /// Starts or ends the stream.
    pub(super) fn ask(&mut self, on: bool, now: Instant) {
        if !on || !self.is_on(now) {
            *self = Self::default();
        }
        self.until = on.then(|| now + LEASE);
    }

    /// Takes a cycle if the stream is on. Cycles that do not fit are counted.
    pub(super) fn take(&mut self, cycle: Cycle, now: Instant) {
        if !self.is_on(now) {
            return;
        }
        if self.batch.len() < ROOM {
            self.batch.push(cycle);
        } else {
            self.dropped += 1;
        }
    }

    /// The cycles to be published, and how many did not fit since the first request. `None`: the stream is off.
    pub(super) fn batch(&mut self, now: Instant) -> Option<(Vec<Cycle>, u32)> {
        if !self.is_on(now) {
            *self = Self::default();
        }
        (!self.batch.is_empty()).then(|| (std::mem::take(&mut self.batch), self.dropped))
    }

    fn is_on(&self, now: Instant) -> bool {
        self.until.is_some_and(|until| now < until)
    }
}

#[cfg(test)]
mod tests {
    use super::{LEASE, ROOM, Stream};
    use crate::mqtt::link_support::state;
    use std::time::{Duration, Instant};

    fn times(stream: &mut Stream, now: Instant) -> Vec<f64> {
        stream.batch(now).map_or_else(Vec::new, |(cycles, _)| cycles.iter().map(|cycle| cycle.time_s).collect())
    }

    #[test]
    fn cycles_are_kept_only_for_who_asked_and_only_for_a_while() {
        let (mut stream, now) = (Stream::default(), Instant::now());
        stream.take(state(0.0).cycle, now);
        assert!(times(&mut stream, now).is_empty());
        stream.ask(true, now);
        stream.take(state(1.0).cycle, now);
        stream.take(state(2.0).cycle, now);
        assert_eq!(times(&mut stream, now), [1.0, 2.0]);
        assert!(times(&mut stream, now).is_empty());
        stream.take(state(3.0).cycle, now + LEASE);
        assert!(times(&mut stream, now + LEASE).is_empty());
    }

    #[test]
    fn asking_again_goes_on_without_a_gap_and_off_is_at_once() {
        let (mut stream, now) = (Stream::default(), Instant::now());
        stream.ask(true, now);
        stream.take(state(1.0).cycle, now);
        let later = now + LEASE - Duration::from_secs(1);
        stream.ask(true, later);
        stream.take(state(2.0).cycle, now + LEASE);
        assert_eq!(times(&mut stream, now + LEASE), [1.0, 2.0]);
        stream.ask(false, now + LEASE);
        stream.take(state(3.0).cycle, now + LEASE);
        assert!(times(&mut stream, now + LEASE).is_empty());
    }

    #[test]
    fn what_does_not_fit_into_a_batch_is_counted() {
        let (mut stream, now) = (Stream::default(), Instant::now());
        stream.ask(true, now);
        for _ in 0..ROOM + 3 {
            stream.take(state(0.0).cycle, now);
        }
        let (cycles, dropped) = stream.batch(now).unwrap();
        assert_eq!((cycles.len(), dropped), (ROOM, 3));
    }
}

//! The fan's tachometer: a line that falls so many times in each revolution.
//!
//! ```text
//! rpm = 60 · edges / (pulses per revolution · time between the first and the last of them)
//! between edges: no more than one more edge now would make; after 0.25 s without one the fan stands
//! ```
//!
//! Source: Intel, *4-Wire Pulse Width Modulation (PWM) Controlled Fans*: an open collector, two pulses a revolution.
//! A fan whose supply itself is chopped shows the chopping as edges: its tachometer needs a supply of its own.

/// From here on a fan without edges stands, seconds: with two pulses a revolution, below 120 rpm.
const STANDS_S: f64 = 0.25;
/// Edges taken in one look: a line that rings must not hold the loop.
const MOST_EDGES: u32 = 64;

/// The edges of a line, with the time of each.
pub trait Edges {
    /// The time of the next edge that has not been read yet, seconds on the rig's clock. Never waits.
    fn next_edge_s(&mut self) -> Option<f64>;
}

impl<E: Edges + ?Sized> Edges for Box<E> {
    fn next_edge_s(&mut self) -> Option<f64> {
        (**self).next_edge_s()
    }
}

/// A fan's speed by its edges.
pub struct Tachometer<E> {
    edges: E,
    /// Edge-seconds to rpm.
    rpm_of_one_hertz: f64,
    last_edge_s: Option<f64>,
    rpm: f64,
}

impl<E: Edges> Tachometer<E> {
    /// A tachometer with so many edges in a revolution.
    pub fn new(edges: E, pulses_per_revolution: u32) -> Self {
        Self { edges, rpm_of_one_hertz: 60.0 / f64::from(pulses_per_revolution), last_edge_s: None, rpm: 0.0 }
    }

    /// The speed at `now_s`, rpm; 0 when the fan stands. Does not wait.
    pub fn rpm(&mut self, now_s: f64) -> f64 {
        let (mut first_s, mut last_s, mut edges) = (self.last_edge_s, self.last_edge_s, 0.0);
        for _ in 0..MOST_EDGES {
            let Some(at_s) = self.edges.next_edge_s() else { break };
            match first_s {
                Some(_) => edges += 1.0,
                None => first_s = Some(at_s),
            }
            last_s = Some(at_s);
        }
        self.last_edge_s = last_s;
        let (Some(first_s), Some(last_s)) = (first_s, last_s) else { return 0.0 };
        if last_s > first_s {
            self.rpm = self.rpm_of_one_hertz * edges / (last_s - first_s);
        }
        let silent_s = now_s - last_s;
        if silent_s > STANDS_S {
            (self.last_edge_s, self.rpm) = (None, 0.0);
        }
        // No edge since then: it turns more slowly than one now would show.
        if silent_s > 0.0 { self.rpm.min(self.rpm_of_one_hertz / silent_s) } else { self.rpm }
    }
}

#[cfg(test)]
mod tests {
    use super::{Edges, Tachometer};
    use std::collections::VecDeque;

    impl Edges for VecDeque<f64> {
        fn next_edge_s(&mut self) -> Option<f64> {
            self.pop_front()
        }
    }

    /// The speed when read every 20 ms, with edges at these times.
    fn said(edges: &[f64], cycles: u32) -> Vec<f64> {
        let mut all: VecDeque<f64> = edges.iter().copied().collect();
        let mut tachometer = Tachometer::new(VecDeque::new(), 2);
        let look = |k: u32| {
            let now_s = 0.02 * f64::from(k);
            while all.front().is_some_and(|at_s| *at_s <= now_s) {
                tachometer.edges.extend(all.pop_front());
            }
            tachometer.rpm(now_s)
        };
        (1..=cycles).map(look).collect()
    }

    #[test]
    fn even_edges_give_their_rate_whether_many_come_in_a_cycle_or_few() {
        for hertz in [17.0, 50.0, 80.0, 400.0] {
            let edges: Vec<f64> = (0..2000).map(|k| 0.003 + f64::from(k) / hertz).collect();
            for rpm in &said(&edges, 50)[10..] {
                assert!((rpm - 30.0 * hertz).abs() < 1e-6, "{rpm} rpm at {hertz} Hz");
            }
        }
    }

    #[test]
    fn a_fan_that_stops_is_said_to_slow_down_and_then_to_stand() {
        let edges: Vec<f64> = (0..50).map(|k| f64::from(k) * 0.01).collect();
        let said = said(&edges, 60);
        assert!((said[23] - 3000.0).abs() < 1e-6, "{said:?}");
        // The last edge came at 0.49 s; at 0.6 s there is none for 0.11 s.
        assert!((said[29] - 30.0 / 0.11).abs() < 1e-6, "{}", said[29]);
        assert_eq!(said[40], 0.0);
    }

    #[test]
    fn a_fan_that_starts_again_is_not_measured_across_its_rest() {
        let edges: Vec<f64> = [0.0, 0.01, 0.02].into_iter().chain((0..50).map(|k| 1.0 + f64::from(k) * 0.01)).collect();
        let said = said(&edges, 60);
        assert!((said[54] - 3000.0).abs() < 1e-6, "{}", said[54]);
    }

    #[test]
    fn a_line_that_rings_for_ever_does_not_hold_the_loop() {
        struct Rings(f64);
        impl Edges for Rings {
            fn next_edge_s(&mut self) -> Option<f64> {
                self.0 += 1e-6;
                Some(self.0)
            }
        }
        assert!(Tachometer::new(Rings(0.0), 2).rpm(1.0).is_finite());
    }
}

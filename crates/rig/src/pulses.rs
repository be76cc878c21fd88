//! The simulated fan's tachometer: a rotor that follows the duty, quantised into edges.
//!
//! ```text
//! edges per second = hover_rpm/60 · pulses per revolution · w/hover duty      w of `plant::Rotor`, percent of duty
//! ```
//!
//! The rotor's speed is linear between steps of 1 ms, in which no small fan gives two edges.

use plant::{Model, Rotor};
use std::collections::VecDeque;

const STEP_S: f64 = 0.001;
/// Edges that are kept for a late reader, as many as the kernel keeps.
const KEPT: usize = 64;

/// The edges of a simulated fan.
pub(super) struct Pulses {
    rotor: Rotor,
    /// Edges per second for each percent of w.
    edges_per_s_percent: f64,
    /// Edges since the start, with the fraction of the next.
    turned: f64,
    now_s: f64,
    edges: VecDeque<f64>,
}

impl Pulses {
    /// A fan at rest, at time 0.
    pub(super) fn new(model: &Model, table: &config::Tachometer) -> Self {
        let at_hover = table.hover_rpm / 60.0 * f64::from(table.pulses_per_revolution);
        Self {
            rotor: Rotor::new(model, 0.0),
            edges_per_s_percent: at_hover / model.hover_duty_percent,
            turned: 0.0,
            now_s: 0.0,
            edges: VecDeque::with_capacity(KEPT),
        }
    }

    /// The duty from `now_s` on, percent.
    pub(super) fn drive(&mut self, now_s: f64, duty_percent: f64) {
        self.advance_to(now_s);
        self.rotor.write(now_s, duty_percent);
    }

    /// Time of the next edge, up to `now_s`.
    pub(super) fn next_edge_s(&mut self, now_s: f64) -> Option<f64> {
        self.advance_to(now_s);
        self.edges.pop_front()
    }

    fn advance_to(&mut self, time_s: f64) {
        while self.now_s < time_s {
            let until_s = (self.now_s + STEP_S).min(time_s);
            let before = self.rotor.speed_percent();
            self.rotor.advance_to(until_s);
            let mean = (before + self.rotor.speed_percent()) / 2.0;
            let turned = self.turned + self.edges_per_s_percent * mean * (until_s - self.now_s);
            let mut next = self.turned.floor() + 1.0;
            while next <= turned {
                let share = (next - self.turned) / (turned - self.turned);
                self.keep(self.now_s + share * (until_s - self.now_s));
                next += 1.0;
            }
            (self.turned, self.now_s) = (turned, until_s);
        }
    }

    fn keep(&mut self, edge_s: f64) {
        if self.edges.len() == KEPT {
            self.edges.pop_front();
        }
        self.edges.push_back(edge_s);
    }
}

#[cfg(test)]
mod tests {
    use super::Pulses;
    use config::{Tables, Tachometer};
    use plant::Model;

    const TABLE: Tachometer = Tachometer { line: 0, pulses_per_revolution: 2, hover_rpm: 2400.0, stalled_after_s: 0.5 };

    fn model() -> Model {
        let tables: Tables = toml::from_str(include_str!("../../../config.toml")).unwrap();
        tables.plant.unwrap()
    }

    /// The edges up to `until_s` of a fan that gets hover at time 0.
    fn edges(until_s: f64) -> Vec<f64> {
        let mut pulses = Pulses::new(&model(), &TABLE);
        pulses.drive(0.0, model().hover_duty_percent);
        (0_u32..).map(|k| 0.02 * f64::from(k)).take_while(|now_s| *now_s <= until_s).fold(vec![], |mut all, now_s| {
            all.extend(std::iter::from_fn(|| pulses.next_edge_s(now_s)));
            all
        })
    }

    #[test]
    fn a_fan_at_hover_gives_its_edges_evenly() {
        let all = edges(10.0);
        let late = &all[all.len() - 80..];
        for pair in late.windows(2) {
            // 2400 rpm are 80 edges a second.
            assert!((pair[1] - pair[0] - 1.0 / 80.0).abs() < 1e-9, "{pair:?}");
        }
    }

    #[test]
    fn a_fan_that_spins_up_has_turned_by_the_integral_of_its_lag() {
        let (lag_s, until_s) = (0.257, 0.5_f64);
        let turned = 80.0 * (until_s - lag_s * (1.0 - (-until_s / lag_s).exp()));
        assert_eq!(edges(until_s).len() as f64, turned.floor(), "{turned} edges");
    }
}

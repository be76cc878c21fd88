//! The linear belief in closed form: the covariance of its filter, and (in the tests) the accuracy of its forecasts.
//!
//! ```text
//! x' = v,  v' = −drag·v + a + white noise of density PSD;  reading = x + noise of SENSOR_MM
//! ```

use crate::rig::{PSD, SENSOR_MM};

/// Covariance of height and speed: (xx, xv, vv).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    /// mm².
    pub(crate) xx: f64,
    xv: f64,
    vv: f64,
}

impl Spread {
    /// An uninformative prior.
    pub(crate) const WIDE: Self = Self { xx: 1e5, xv: 0.0, vv: 1e6 };

    /// After dt without a reading.
    pub(crate) fn after(self, dt: f64, drag: f64) -> Self {
        let e = (-drag * dt).exp();
        let f = (1.0 - e) / drag;
        let g = (1.0 - e * e) / (2.0 * drag);
        Self {
            xx: self.xx + 2.0 * f * self.xv + f * f * self.vv + PSD * (dt - 2.0 * f + g) / (drag * drag),
            xv: e * (self.xv + f * self.vv) + PSD * (f - g) / drag,
            vv: e * e * self.vv + PSD * g,
        }
    }

    /// Variance of the next reading, mm².
    pub(crate) fn reading(self) -> f64 {
        self.xx + SENSOR_MM * SENSOR_MM
    }

    /// Takes a reading: the changes of height and speed per millimetre of innovation, and the covariance after it.
    pub(crate) fn corrected(self) -> ((f64, f64), Self) {
        let (kx, kv) = (self.xx / self.reading(), self.xv / self.reading());
        let after = Self { xx: (1.0 - kx) * self.xx, xv: (1.0 - kx) * self.xv, vv: self.vv - kv * self.xv };
        ((kx, kv), after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
    use crate::catalogue::all_names;
    use crate::chance::Source;
    use crate::flight::{Row, fly};
    use crate::mixture::{Kind, Mixture};

    /// The belief, with its lag if it has one.
    struct Belief {
        gain: f64,
        drag: f64,
        hover: f64,
        lag: Option<f64>,
    }

    impl Belief {
        /// Height, speed and thrust after dt of this duty.
        fn moved(&self, (x, v, s): (f64, f64, f64), duty: f64, dt: f64) -> (f64, f64, f64) {
            let (d, c) = (self.drag, self.gain * (duty - self.hover));
            let (e, f) = ((-d * dt).exp(), -(-d * dt).exp_m1() / d);
            let (x, v) = (x + v * f + c * (dt - f) / d, v * e + c * f);
            let Some(tau) = self.lag else { return (x, v, c) };
            // The part (s − c)·exp(−t/τ) of the thrust, through the same two integrals.
            let (r, fade) = (1.0 / tau, (-dt / tau).exp());
            let speed = (s - c) * (fade - e) / (d - r);
            let height = (s - c) * ((1.0 - fade) * tau - f) / (d - r);
            (x + height, v + speed, c + (s - c) * fade)
        }
    }

    /// Sums of squares of the errors 1 s ahead and of those by noise alone, and their number.
    fn forecast(rows: &[Row], belief: &Belief) -> (f64, f64, f64) {
        let (mut state, mut spread) = ((rows[0].position_mm, 0.0, 0.0), Spread::WIDE);
        let mut sums = (0.0, 0.0, 0.0);
        for (k, row) in rows.iter().enumerate() {
            if k > 0 {
                let dt = row.time_s - rows[k - 1].time_s;
                state = belief.moved(state, rows[k - 1].duty_percent, dt);
                spread = spread.after(dt, belief.drag);
            }
            let surprise = row.position_mm - state.0;
            let ((kx, kv), after) = spread.corrected();
            state = (state.0 + kx * surprise, state.1 + kv * surprise, state.2);
            spread = after;
            let ahead = k + 54;
            if row.time_s < 3.0 || ahead >= rows.len() {
                continue;
            }
            let (mut there, mut width) = (state, spread);
            for pair in rows[k..=ahead].windows(2) {
                let dt = pair[1].time_s - pair[0].time_s;
                there = belief.moved(there, pair[0].duty_percent, dt);
                width = width.after(dt, belief.drag);
            }
            let error = there.0 - rows[ahead].position_mm;
            sums = (sums.0 + error * error, sums.1 + width.reading(), sums.2 + 1.0);
        }
        sums
    }

    #[test]
    fn the_neutral_rig_flies_as_its_exact_linear_belief_says_within_five_percent_of_the_floor() {
        let mixture = Mixture { kinds: vec![(Kind::None, 1.0)], effects: all_names(), exact: true };
        let (mut error, mut floor, mut count) = (0.0, 0.0, 0);
        for number in 0..150 {
            let source = Source { seed: "neutral".into(), case: number };
            let case = Case::draw(&source, &mixture);
            if case.believed.iter().any(|effect| effect.name == "dead_zone") {
                continue;
            }
            let belief = Belief {
                gain: case.belief.gain_mm_per_s2_per_percent,
                drag: case.belief.drag_per_s,
                hover: case.belief.hover_duty_percent,
                lag: case.believed.first().map(|lag| lag.get("time_constant_s")),
            };
            let (e, f, n) = forecast(&fly(&case, &source, |_| {}), &belief);
            (error, floor, count) = (error + e / n, floor + f / n, count + 1);
        }
        let ratio = f64::sqrt(error / floor);
        println!(
            "{count} records: {:.2} mm at 1 s, floor {:.2} mm, ratio {ratio:.4}",
            (error / f64::from(count)).sqrt(),
            (floor / f64::from(count)).sqrt()
        );
        assert!(count > 80 && (ratio - 1.0).abs() < 0.05, "{ratio} over {count} records");
    }
}

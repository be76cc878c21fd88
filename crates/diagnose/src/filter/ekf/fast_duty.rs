//! Duties that are written faster than a ball responds: a few commands with the same effect as all of them.
//!
//! ```text
//! c̄ = 1/T·∫ c dt                                    the same velocity of the ball after T
//! c̄ ∓ r in either half, r = 4/T²·∫ c·(t − T/2) dt   and the same position, however the duty changed within T
//! ```
//!
//! The second matters where readings have almost no noise: a command that rises by Δ within T moves the ball by Δ·T²/12
//! less than its mean does.

/// Duties that follow each other faster than this are averaged, seconds.
const CHATTER_S: f64 = 0.005;

/// How the duties between two readings are averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DutyAveraging {
    /// Not at all.
    Each,
    /// To one mean.
    Mean,
    /// To a mean for each half of the time.
    Halves,
}

impl DutyAveraging {
    /// The averaging for a flight of `duration_s` with this many writes.
    pub(super) fn of(duration_s: f64, writes: usize) -> Self {
        if duration_s < CHATTER_S * writes as f64 { Self::Halves } else { Self::Each }
    }

    /// The same for readings whose noise hides what the duties do between two of them.
    pub(super) fn roughly(self) -> Self {
        if self == Self::Halves { Self::Mean } else { self }
    }

    /// Whether duties are averaged.
    pub(super) const fn averages(self) -> bool {
        !matches!(self, Self::Each)
    }
}

/// The duties of a block that is averaged.
pub(super) struct DutyBlock {
    from_s: f64,
    /// The end of the sums so far, seconds since the start of the flight.
    pub(super) until_s: f64,
    /// ∫ command dt, mm/s.
    impulse: f64,
    /// ∫ command · (t − from) dt, mm.
    moment: f64,
    /// Number of commands.
    count: u32,
}

impl DutyBlock {
    /// An empty block from `from_s` seconds since the start of the flight.
    pub(super) const fn from(from_s: f64) -> Self {
        Self { from_s, until_s: from_s, impulse: 0.0, moment: 0.0, count: 0 }
    }

    /// Adds a command, mm/s², that is in force until `until_s`.
    pub(super) fn add(&mut self, commanded: f64, until_s: f64) {
        let impulse = commanded * (until_s - self.until_s);
        self.impulse += impulse;
        self.moment += impulse * (0.5 * (self.until_s + until_s) - self.from_s);
        self.until_s = until_s;
        self.count += 1;
    }

    /// The averaged commands, mm/s², and how long each is in force, seconds.
    pub(super) fn as_few(&self, flown: DutyAveraging) -> (impl Iterator<Item = f64> + use<>, f64) {
        let all_s = self.until_s - self.from_s;
        let (mean, half_s) = (self.impulse / all_s, all_s / 2.0);
        let rise = (self.moment - self.impulse * half_s) / (half_s * half_s);
        let halves = flown == DutyAveraging::Halves && self.count > 1;
        let first = if halves { mean - rise } else { mean };
        let second = halves.then_some(mean + rise);
        (std::iter::once(first).chain(second), if halves { half_s } else { all_s })
    }
}

#[cfg(test)]
mod tests {
    use super::{DutyAveraging, DutyBlock};

    /// Position and velocity of a ball that starts at rest at 0, after commands of `step_s` each.
    fn flown(commands: impl Iterator<Item = f64>, step_s: f64) -> (f64, f64) {
        commands.fold((0.0, 0.0), |(y, v), a| (y + (v + 0.5 * a * step_s) * step_s, v + a * step_s))
    }

    #[test]
    fn two_halves_end_where_all_commands_do_and_their_mean_as_fast() {
        let all = [3.0, -8.0, 41.0, 5.0, -2.5, 17.0, 0.0, 90.0, 12.0, -33.0];
        let mut chatter = DutyBlock::from(2.0);
        (1..=10).zip(all).for_each(|(k, command)| chatter.add(command, 2.0 + 0.001 * f64::from(k)));
        let truth = flown(all.into_iter(), 0.001);
        let [mean, halves] = [DutyAveraging::Mean, DutyAveraging::Halves].map(|how| {
            let (commands, step_s) = chatter.as_few(how);
            let there = flown(commands, step_s);
            assert!((there.1 - truth.1).abs() < 1e-12, "{how:?}: {} mm/s, not {}", there.1, truth.1);
            there.0
        });
        assert!((halves - truth.0).abs() < 1e-12, "{halves} mm, not {}", truth.0);
        assert!((mean - truth.0).abs() > 1e-5, "the mean alone would do");
    }

    #[test]
    fn a_command_alone_is_flown_as_it_is() {
        let mut chatter = DutyBlock::from(2.0);
        chatter.add(7.0, 2.25);
        let (commands, step_s) = chatter.as_few(DutyAveraging::Halves);
        assert_eq!((commands.collect::<Vec<_>>(), step_s), (vec![7.0], 0.25));
    }

    #[test]
    fn duties_are_flown_together_where_many_are_written_a_second() {
        assert_eq!(DutyAveraging::of(10.0, 500), DutyAveraging::Each);
        assert_eq!(DutyAveraging::of(10.0, 10_000), DutyAveraging::Halves);
        assert_eq!(
            (DutyAveraging::Each.roughly(), DutyAveraging::Halves.roughly()),
            (DutyAveraging::Each, DutyAveraging::Mean)
        );
    }
}

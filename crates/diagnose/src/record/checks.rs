//! What is checked of every record, with its limit: the list that a report ticks. And what a finding stops.

use crate::record::check::{COARSE_CLOCK_PERCENT, GAP, OUTLIER, REPEATED_PERCENT, SLOWEST_S, STILL_PERCENT};
use crate::record::finding::Finding;
use crate::thresholds::{ENOUGH_READINGS, OTHER_RIG};

/// A check of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Signs, units and columns, and that the logs are of one rig.
    Units,
    /// The time between rows.
    Clock,
    /// That the duty moves.
    Excitation,
    /// Where the readings lie.
    Readings,
    /// Readings far from their neighbours.
    Outliers,
    /// Readings that are repeated.
    Repeats,
    /// The number of readings in free flight.
    Length,
    /// That the fitted model is of the believed rig.
    Model,
    /// That the fitted numbers lie within the bounds of the record.
    Bounds,
    /// Which rows are used.
    Rows,
}

impl Check {
    /// All checks, in the order of a report.
    pub const ALL: [Self; 10] = [
        Self::Units,
        Self::Clock,
        Self::Excitation,
        Self::Readings,
        Self::Outliers,
        Self::Repeats,
        Self::Length,
        Self::Model,
        Self::Bounds,
        Self::Rows,
    ];

    /// The check and its limit, in words.
    #[must_use]
    pub fn words(self) -> String {
        match self {
            Self::Units => "signs, units and columns fit the belief; all logs are of one rig".into(),
            Self::Clock => format!(
                "rows at most {SLOWEST_S} s apart, no gap above {GAP} times the usual, at most {COARSE_CLOCK_PERCENT} \
                 % at the time of the row before"
            ),
            Self::Excitation => format!("the duty moves by more than {STILL_PERCENT} %, and the position moves"),
            Self::Readings => {
                format!(
                    "readings lie in the pipe, but for {OUTLIER} standard deviations of noise; no codes for \"no \
                        target\""
                )
            }
            Self::Outliers => format!("no reading is {OUTLIER} robust standard deviations off its neighbours"),
            Self::Repeats => format!("at most {REPEATED_PERCENT} % of the readings repeat the one before"),
            Self::Length => format!("at least {ENOUGH_READINGS} readings in free flight"),
            Self::Model => format!("gain and drag within a factor of {OTHER_RIG} of the belief"),
            Self::Bounds => "the fitted numbers lie within the bounds that this record sets".into(),
            Self::Rows => "all rows are used".into(),
        }
    }
}

impl Finding {
    /// The check that it is about.
    #[must_use]
    pub const fn check(&self) -> Check {
        match self {
            Self::FractionalDuty
            | Self::SpuriousDuty { .. }
            | Self::TimeUnit { .. }
            | Self::DutyBeyondPercent { .. }
            | Self::DutyFarBelowHover { .. }
            | Self::PositionReversed { .. }
            | Self::InputReversed { .. }
            | Self::InputInverted { .. }
            | Self::SignReversed { .. }
            | Self::DutyUnit { .. }
            | Self::PositionUnit { .. }
            | Self::GainUnit { .. }
            | Self::Exchanged
            | Self::SeveralRigs { .. } => Check::Units,
            Self::Gaps { .. } | Self::RepeatedTimes { .. } | Self::SlowRows { .. } => Check::Clock,
            Self::StillDuty { .. } | Self::StillPosition { .. } => Check::Excitation,
            Self::ImplausibleReadings { .. } | Self::OutsidePipe { .. } | Self::NoTarget { .. } => Check::Readings,
            Self::Outliers { .. } => Check::Outliers,
            Self::Repeats { .. } => Check::Repeats,
            Self::TooFew { .. } => Check::Length,
            Self::OtherRig { .. } | Self::OtherOrder { .. } => Check::Model,
            Self::NotFinite | Self::Impossible { .. } => Check::Bounds,
            Self::LeftOut
            | Self::Stretches { .. }
            | Self::Decimated { .. }
            | Self::Averaged { .. }
            | Self::AtEnd { .. } => Check::Rows,
        }
    }

    /// Whether it says what was done, and is no fault of the record or the belief.
    #[must_use]
    pub const fn is_note(&self) -> bool {
        matches!(self.check(), Check::Rows) || matches!(self, Self::OtherOrder { .. })
    }

    /// Whether no plant can be identified from such a record, whatever is believed.
    #[must_use]
    pub const fn stops_identification(&self) -> bool {
        matches!(
            self,
            Self::DutyBeyondPercent { .. }
                | Self::Exchanged
                | Self::PositionReversed { .. }
                | Self::InputReversed { .. }
                | Self::InputInverted { .. }
                | Self::SignReversed { .. }
                | Self::SlowRows { .. }
                | Self::RepeatedTimes { .. }
                | Self::StillDuty { .. }
                | Self::StillPosition { .. }
        )
    }

    /// Whether it is a mistake of units, signs or columns, which no other flight mends.
    #[must_use]
    pub const fn is_mistake(&self) -> bool {
        match self {
            // Rows so far apart have another unit of time.
            Self::SlowRows { .. } => true,
            // It may be another rig's.
            Self::DutyFarBelowHover { .. } => false,
            _ => matches!(self.check(), Check::Units),
        }
    }
}

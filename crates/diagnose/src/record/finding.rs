//! Findings about a record: what its reader should know, each a sentence with its values that ends in what to do.

use crate::record::check::OUTLIER;
use crate::record::corrections::{MILLISECOND, by_gain, by_hover, by_length, duty, inverted, position, time};
use crate::record::implausible::DutyScale;
use crate::record::units::{length, short};

/// A finding about a record that its reader should know.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The duty hardly moves.
    #[error(
        "the duty stays within {range_percent:.3} %, which excites nothing: gain, lag and dead zone cannot be told \
         from such a record; fly one with a moving setpoint"
    )]
    StillDuty {
        /// Largest minus smallest duty, percent.
        range_percent: f64,
    },
    /// The duty seems to be recorded as a fraction.
    #[error(
        "every duty lies within 0 to 1, as fractions do; if they are fractions, write under [import]: {}",
        duty(100.0)
    )]
    FractionalDuty,
    /// Duties that no fan takes.
    #[error("{count} duties lie beyond {limit_percent:.0} %, the first in row {row}: {duty_percent:.4e}; {scale}")]
    DutyBeyondPercent {
        /// Number of such duties.
        count: usize,
        /// The row of the first, counted from 1.
        row: usize,
        /// The first, as the record has it.
        duty_percent: f64,
        /// The limit, percent, in both directions.
        limit_percent: f64,
        /// Percent per unit of the column, where its unit is another; `None` where single rows are wrong.
        scale: DutyScale,
    },
    /// A duty in a single row that did not move the ball.
    #[error(
        "the duty of row {row} is {duty_percent:.4}, far from the rows before and after it, and the ball did not \
         respond to it: remove this row, or mend the recorder"
    )]
    SpuriousDuty {
        /// The row, counted from 1.
        row: usize,
        /// Its duty, percent.
        duty_percent: f64,
    },
    /// Duties far below the believed hover.
    #[error(
        "the usual duty is {usual_percent:.4e} % where {hover_percent} % are believed to hold the ball: the column \
         holds another unit, or the record is of another rig; write under [import]: {}, or correct \
         plant.hover_duty_percent", duty(*scale).with_offset(*offset_percent)
    )]
    DutyFarBelowHover {
        /// Median of the duties' sizes, percent.
        usual_percent: f64,
        /// The believed hover, percent.
        hover_percent: f64,
        /// Percent per unit of the column, if its unit is another.
        scale: f64,
        /// Added after scaling, percent.
        offset_percent: f64,
    },
    /// Readings that cannot be positions of the ball.
    #[error(
        "{count} readings cannot be right: they lie more than half the pipe's length outside of it, or jump by three \
         quarters of it and back, the first in row {row}: {reading_mm:.4e} mm; they count as empty"
    )]
    ImplausibleReadings {
        /// Number of such readings.
        count: usize,
        /// The row of the first, counted from 1.
        row: usize,
        /// The first, mm.
        reading_mm: f64,
    },
    /// Numbers that grew beyond any bound.
    #[error(
        "the forecasts of the model are not finite, so nothing can be compared; look for implausible numbers in the \
         record, and in the tables [plant] and [import]"
    )]
    NotFinite,
    /// The position never moves.
    #[error(
        "the position is {position_mm} mm in every row; check that the sensor was read, and the column of [import]"
    )]
    StillPosition {
        /// The one position, mm.
        position_mm: f64,
    },
    /// Readings outside the model's pipe.
    #[error(
        "{count} readings lie outside the model's pipe of {bottom_mm} to {top_mm} mm, the furthest at {} mm; check \
         plant.pipe_length_mm and the scale and offset of [import]",
        short(*furthest_mm)
    )]
    OutsidePipe {
        /// Number of such readings.
        count: usize,
        /// The reading furthest outside, mm.
        furthest_mm: f64,
        /// Lower end of the model's pipe, mm.
        bottom_mm: f64,
        /// Upper end of the model's pipe, mm.
        top_mm: f64,
    },
    /// Readings that are codes for "no target".
    #[error("{count} readings are 8190 or 8191, which a VL53L0X says without a target: they count as empty")]
    NoTarget {
        /// Number of such readings.
        count: usize,
    },
    /// The time between rows is uneven.
    #[error(
        "{count} gaps between rows, the longest {longest_s:.3} s where {usual_s:.4} s is usual; forecasts cross them \
         by the duty before them"
    )]
    Gaps {
        /// Number of gaps.
        count: usize,
        /// The longest gap, seconds.
        longest_s: f64,
        /// The usual time between rows, seconds.
        usual_s: f64,
    },
    /// Rows at the time of the row before them.
    #[error(
        "{percent:.0} % of the rows repeat the time of the row before, the first is row {row}: the clock is coarser \
         than the rows; name a finer one as [import] time_s, write spread = true there, which spreads the rows of each \
         time up to the next, or keep one row of each time"
    )]
    RepeatedTimes {
        /// Share of all rows, percent.
        percent: f64,
        /// The first such row, counted from 1.
        row: usize,
    },
    /// The rows are too far apart.
    #[error(
        "the rows are {usual_s:.3} s apart, and nothing shorter can be seen: record at least 10 a second; if the times \
         are in milliseconds, write under [import]: {}",
        time(MILLISECOND)
    )]
    SlowRows {
        /// The usual time between rows, seconds.
        usual_s: f64,
    },
    /// Too few readings.
    #[error(
        "{readings} readings in free flight, and the diagnosis needs {needed}: fly longer, or name more flights of \
         this rig together"
    )]
    TooFew {
        /// Readings in free flight.
        readings: usize,
        /// Readings that are needed.
        needed: usize,
    },
    /// Readings far from their neighbours.
    #[error(
        "{count} readings jump by more than {OUTLIER} robust deviations ({limit_mm:.1} mm) and back, {percent:.2} % of \
         all; a reading so far off counts for little in the fits: look at them first"
    )]
    Outliers {
        /// Number of such readings.
        count: usize,
        /// Share of all readings, percent.
        percent: f64,
        /// The limit for a jump, mm.
        limit_mm: f64,
    },
    /// A log among several that cannot be diagnosed.
    #[error("this log is left out of the diagnosis, and the others are used without it")]
    LeftOut,
    /// A very long flight, of which parts are used.
    #[error(
        "of {rows} rows {used} are used, in {count} stretches spread evenly over the flight: more would take long and \
         much memory; to diagnose another part, cut the log to it"
    )]
    Stretches {
        /// Rows of the flight.
        rows: usize,
        /// Rows that are used.
        used: usize,
        /// Number of stretches.
        count: usize,
    },
    /// The diagnosis used fewer readings.
    #[error("a fast clock: the diagnosis used every duty, and one reading in {merged}")]
    Decimated {
        /// One reading out of this many was used.
        merged: usize,
    },
    /// The diagnosis used means of readings.
    #[error("a fast clock: the diagnosis used every duty, and the means of {merged} readings each")]
    Averaged {
        /// Number of readings in each mean.
        merged: usize,
    },
    /// The record and the belief do not match.
    #[error(
        "the record fits a {number} that is {ratio:.3} times the believed one: it is in other units, or of another \
         rig; check the scales of [import] and plant.{number}"
    )]
    OtherRig {
        /// The base parameter, as the config names it.
        number: &'static str,
        /// Ratio of the fitted value to the believed one.
        ratio: f64,
    },
    /// The fitted model is outside the bounds that the record sets.
    #[error(
        "no model that this record allows fits it: {key} ends outside its bounds; check the scales of [import] and the \
         table [plant]"
    )]
    Impossible {
        /// The key of the parameter that is outside, in its table of the config.
        key: &'static str,
    },
    /// The position falls where the duty rises, at duties near the believed hover.
    #[error(
        "the position falls where the duty rises ({deviations:.0} deviations from 0), as the distance from a sensor \
         above does: write under [import]: {}", position(-1.0).with_offset(*offset_mm)
    )]
    PositionReversed {
        /// The gain in its standard deviations.
        deviations: f64,
        /// Offset of a distance from the top, mm.
        offset_mm: f64,
    },
    /// The same at duties that have the other sign than hover.
    #[error(
        "the position falls where the duty rises ({deviations:.0} deviations from 0), and the duty has the other sign \
         than plant.hover_duty_percent: write under [import]: {}", duty(-1.0)
    )]
    InputReversed {
        /// The gain in its standard deviations.
        deviations: f64,
    },
    /// The same where 100 % less the duty hovers as believed.
    #[error(
        "the position falls where the duty rises ({deviations:.0} deviations from 0), and its usual duty of \
         {usual_percent:.4} % is that of an inverted output: 100 % less that is near plant.hover_duty_percent; write \
         under [import]: {}",
        inverted()
    )]
    InputInverted {
        /// The gain in its standard deviations.
        deviations: f64,
        /// The usual duty, percent.
        usual_percent: f64,
    },
    /// The same of a rig that rests at a duty of 0.
    #[error(
        "the position falls where the duty rises ({deviations:.0} deviations from 0), so one of them has the wrong \
         sign: write under [import]: {}; or, with an offset where it is measured from the other end: {}",
        duty(-1.0), position(-1.0)
    )]
    SignReversed {
        /// The gain in its standard deviations.
        deviations: f64,
    },
    /// The fitted belief was diagnosed with drag and lag exchanged.
    #[error(
        "drag and lag of the belief were exchanged, which leaves the response to the duty as it is and follows this \
         record better: gain {gain:.4} mm/s² per %, drag {drag_per_s:.4} /s, lag {lag_s:.4} s; the errors as believed \
         are those of these numbers"
    )]
    OtherOrder {
        /// Gain, mm/s² per percent.
        gain: f64,
        /// Drag, 1/s.
        drag_per_s: f64,
        /// Lag, seconds.
        lag_s: f64,
    },
    /// The record hovers at another duty than believed, by a factor.
    #[error(
        "the record hovers at a duty of {hover_percent:.4}, and plant.hover_duty_percent is {believed_percent}: if the \
         duty is in another unit, write under [import]: {}; if the belief is, plant.hover_duty_percent = \
         {hover_percent:.4}", by_hover(*scale)
    )]
    DutyUnit {
        /// Hover of the record, in the unit of its duty.
        hover_percent: f64,
        /// Hover of the belief, percent.
        believed_percent: f64,
        /// Percent per unit of the duty.
        scale: f64,
    },
    /// The gain is off by a factor, and hover is not: the position's unit.
    #[error(
        "the record fits a gain that is {ratio:.3e} times the believed one, and its hover fits: the position is in \
         another unit{}; write under [import]: {}; or, if the belief is wrong, \
         plant.gain_mm_per_s2_per_percent = {gain:.4}", length(*ratio).0, by_length(*ratio)
    )]
    PositionUnit {
        /// Gain of the record over that of the belief.
        ratio: f64,
        /// Gain of the record.
        gain: f64,
    },
    /// The gain is off by a factor, of a rig that rests at a duty of 0: the unit of the duty or of the position.
    #[error(
        "the record fits a gain that is {ratio:.3} times the believed one: if the duty is in another unit, write under \
         [import]: {}; if the position is{}: {}; if the belief is wrong, plant.gain_mm_per_s2_per_percent = {gain:.4}",
        by_gain(*ratio), length(*ratio).0, by_length(*ratio)
    )]
    GainUnit {
        /// Gain of the record over that of the belief.
        ratio: f64,
        /// Gain of the record.
        gain: f64,
    },
    /// The believed plant fits with another clock.
    #[error(
        "the record is that of the believed rig with its times in another unit: write under [import]: {}", time(*scale)
    )]
    TimeUnit {
        /// Seconds per unit of the times.
        scale: f64,
    },
    /// Position and duty are exchanged.
    #[error(
        "the position does not answer the duty, and the duty answers the position: the columns are exchanged; in \
         [import], give duty_percent the column of position_mm, and position_mm that of duty_percent"
    )]
    Exchanged,
    /// Several logs are not of one rig.
    #[error(
        "this log is of another rig than the first: its gain is {gain_ratio:.2} times that one's, and it hovers at \
         {hover_percent:.2} % instead of {first_hover_percent:.2} %; diagnose each by itself: airball diagnose --each \
         LOG… --out reports"
    )]
    SeveralRigs {
        /// Its gain over that of the first log.
        gain_ratio: f64,
        /// Its hover, percent.
        hover_percent: f64,
        /// That of the first, percent.
        first_hover_percent: f64,
    },
    /// Rows before the take-off or after the landing.
    #[error(
        "the ball lies at an end of the pipe for {before_s:.2} s before it takes off and {after_s:.2} s after it \
         lands: these rows are left out"
    )]
    AtEnd {
        /// Time before the take-off, seconds.
        before_s: f64,
        /// Time after the landing, seconds.
        after_s: f64,
    },
    /// The same reading is repeated many times.
    #[error(
        "{percent:.0} % of the readings are repeated, up to {longest} times: the ball stands still, the readings are \
         coarse, or the sensor refreshes slower than the loop reads; in the last case mark repeats by a column `fresh` \
         or leave them empty"
    )]
    Repeats {
        /// Share of readings in such runs, percent.
        percent: f64,
        /// The longest run, rows.
        longest: usize,
    },
}

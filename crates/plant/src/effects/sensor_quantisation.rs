//! Sensor quantisation: the readings are coarse.
//!
//! ```text
//! reading' = step·round(reading / step)      in mm, halves away from zero
//! ```
//!
//! The grid starts at the bottom of the pipe.
//! Source: a VL53L0X reports whole millimetres; other sensors, and logs that were rounded, are coarser.

use crate::acts::Acts;
use crate::effect::{Effect, Entry, InColumn, Neutral, Param, Scale, Similar, Stage, Start, values_in_order};
use serde::{Deserialize, Serialize};

/// A reading is the nearest multiple of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorQuantisation {
    /// Step, mm.
    pub step_mm: f64,
}

impl Effect for SensorQuantisation {
    const ENTRY: Entry = Entry {
        name: "sensor_quantisation",
        stage: Stage::Sensor,
        params: &[Param { name: "step_mm", min: 0.0, max: 200.0, neutral: Neutral::At(0.0), scale: Scale::Value }],
        sizes: &[&[3.0], &[8.0]],
        start: Start::ReadingStep,
        in_columns: &[InColumn::PositionDifference],
        in_a_log: "only certain positions occur, and the speed from one reading to the next is zero or a jump",
        mend: "a sensor or a log format with finer steps; a filter instead of plain differences",
        similar: &[
            Similar {
                name: "sensor_noise",
                distinguished_by: "only multiples of a step occur, and a ball at rest gives one or two of them. Fly \
                     `airball measure noise-floor`",
            },
            Similar {
                name: "stale_samples",
                distinguished_by: "a quantised value repeats until the ball has moved a step, so that a fast ball \
                     repeats none; a stale one repeats for a fixed time",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { rounds: Some(|steps| steps.step_mm), ..Acts::NONE };

    values_in_order!(step_mm);
}

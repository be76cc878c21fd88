//! End stop: the ball bounces at the ends of its way, which need not be the ends of the pipe.
//!
//! ```text
//! v ← −e·v      at x = bottom and x = top      x in mm, v in mm/s, e: restitution
//! ```
//!
//! Takes the place of the ends of the pipe, where the ball rests without a bounce. A hop that would last shorter
//! than the step is none. Leaves out the time of contact and the give of what is hit.
//! Source: Newton's law of restitution; a table tennis ball dropped 305 mm on steel comes back
//! 240 to 260 mm (ITTF), e = 0.89 to 0.92.

use crate::acts::Acts;
use crate::effect::{
    Effect, Entry, Form, InColumn, Neutral, Param, Scale, Similar, Stage, Start, values_in_order, within_bounds,
};
use crate::unsound::Unsound;
use serde::{Deserialize, Serialize};

/// The ends of the ball's way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndStop {
    /// Lowest position, mm.
    pub bottom_mm: f64,
    /// Highest position, mm.
    pub top_mm: f64,
    /// e: speed after a hit over speed before, no unit.
    pub restitution: f64,
}

impl Effect for EndStop {
    const ENTRY: Entry = Entry {
        name: "end_stop",
        stage: Stage::Ball,
        article: "an ",
        params: &[
            Param { name: "bottom_mm", min: -1e6, max: 1e6, neutral: Neutral::PipeBottom, scale: Scale::Height(10.0) },
            Param { name: "top_mm", min: -1e6, max: 1e6, neutral: Neutral::PipeTop, scale: Scale::Height(10.0) },
            Param { name: "restitution", min: 0.0, max: 1.0, neutral: Neutral::At(0.0), scale: Scale::Value },
        ],
        sizes: &[&[20.0, 560.0, 0.3]],
        start: Start::HeightsSeen,
        form: Form::Impacts,
        shown_at: Some(&[150.0, 440.0, 0.6]),
        in_columns: &[InColumn::Position, InColumn::Position],
        in_a_log: "the position never passes a certain height, and the ball rebounds there",
        mend: "keep the setpoints away from the ends ([safety]); a soft pad at that end",
        similar: &[
            Similar {
                name: "saturation",
                distinguished_by: "an end stop holds the ball at one height at any duty; saturation acts at every \
                     height",
            },
            Similar {
                name: "height_dependent_flow",
                distinguished_by: "an end stop acts only at contact, where the ball rebounds. Hold heights far from \
                     the ends as well",
            },
        ],
        ..Entry::PLAIN
    };

    const ACTS: Acts<Self> = Acts { ends: Some(|stop| *stop), ..Acts::NONE };

    values_in_order!(bottom_mm, top_mm, restitution);

    fn check(&self) -> Result<(), Unsound> {
        within_bounds(self)?;
        let message = "bottom_mm is not below top_mm; the ball needs room between them";
        let room = self.bottom_mm < self.top_mm;
        if room { Ok(()) } else { Err(Unsound::Contradiction { key: "bottom_mm", message }) }
    }
}

impl EndStop {
    /// The velocity after a hit at `velocity_mm_per_s`.
    #[must_use]
    pub fn rebound(&self, velocity_mm_per_s: f64) -> f64 {
        -self.restitution * velocity_mm_per_s
    }
}

#[cfg(test)]
mod tests {
    use super::EndStop;
    use crate::effect::Effect;

    #[test]
    fn stops_that_leave_no_room_are_refused() {
        let stop = EndStop { bottom_mm: 300.0, top_mm: 300.0, restitution: 0.5 };
        let error = stop.check().unwrap_err();
        assert_eq!(error.key(), "bottom_mm");
        assert!(error.to_string().contains("not below top_mm"), "{error}");
        assert!(EndStop { top_mm: 300.1, ..stop }.check().is_ok());
    }
}

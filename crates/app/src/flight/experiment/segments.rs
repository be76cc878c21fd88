//! The segments of an experiment, and when each of them ends: a moment is looked up by halving, as every cycle asks.

use super::Segment;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::ops::Deref;

/// Segments one after another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<Segment>", into = "Vec<Segment>")]
pub struct Segments {
    list: Vec<Segment>,
    /// When each ends, seconds after the start of the first.
    ends_s: Vec<f64>,
}

impl Segments {
    /// The segment `t_s` seconds after the start of the first, and its own start. `None` after the last.
    pub(super) fn at(&self, t_s: f64) -> Option<(&Segment, f64)> {
        let index = self.ends_s.partition_point(|end_s| t_s.partial_cmp(end_s) != Some(Ordering::Less));
        let start_s = index.checked_sub(1).and_then(|before| self.ends_s.get(before));
        Some((self.list.get(index)?, start_s.copied().unwrap_or(0.0)))
    }

    /// Duration of all, seconds.
    pub(super) fn duration_s(&self) -> f64 {
        self.ends_s.last().copied().unwrap_or(0.0)
    }
}

impl From<Vec<Segment>> for Segments {
    fn from(list: Vec<Segment>) -> Self {
        let lengths = list.iter().map(|segment| segment.duration_s);
        let ends_s = lengths
            .scan(0.0, |end_s, length_s| {
                *end_s += length_s;
                Some(*end_s)
            })
            .collect();
        Self { list, ends_s }
    }
}

impl From<Segments> for Vec<Segment> {
    fn from(segments: Segments) -> Self {
        segments.list
    }
}

impl Deref for Segments {
    type Target = [Segment];

    fn deref(&self) -> &[Segment] {
        &self.list
    }
}

//! What a diagram shows: lines, marks, a band, shaded places and events.

use plotters::style::RGBColor;

/// A line of a picture.
#[derive(Clone)]
pub struct Line {
    pub label: &'static str,
    pub colour: RGBColor,
    /// Abscissa, usually the time in s, and value. NaN breaks the line.
    pub points: Vec<(f64, f64)>,
}

/// What happened at single times of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// Where a flight begins behind another one: lines are broken there.
    pub breaks: Vec<f64>,
    /// Events: time, and what happened.
    pub events: Vec<(f64, String)>,
}

/// One of the diagrams of a picture.
#[derive(Clone, Default)]
pub struct Diagram {
    pub title: String,
    pub abscissa: &'static str,
    pub ordinate: &'static str,
    pub lines: Vec<Line>,
    /// Crosses, rings and dots.
    pub marks: Vec<(f64, f64)>,
    pub rings: Vec<(f64, f64)>,
    pub dots: Vec<(f64, f64)>,
    /// Vertical bars: abscissa, and both ends.
    pub intervals: Vec<(f64, f64, f64)>,
    /// Outline of a band about the first line.
    pub band: Vec<(f64, f64)>,
    /// Parts of the abscissa to be highlighted.
    pub shaded: Vec<(f64, f64)>,
    /// Events, of a diagram over time.
    pub timeline: Timeline,
    /// A value to compare the lines with.
    pub base: Option<f64>,
    /// The visible range of the plane; `None`: all data.
    pub window: Option<[(f64, f64); 2]>,
    /// Whether the abscissa is log₂ of its labels' values.
    pub octaves: bool,
    /// The same with log₁₀, labelled at whole powers.
    pub decades: bool,
    /// Whether each line is named at its end instead of in a key.
    pub direct: bool,
}

impl Diagram {
    /// The same with events.
    pub fn with_events(self, timeline: &Timeline) -> Self {
        Self { timeline: timeline.clone(), ..self }
    }

    /// The part of the diagram within a range of the abscissa.
    pub fn within(mut self, (from, to): (f64, f64)) -> Self {
        for line in &mut self.lines {
            // NaN, which breaks a line, is kept.
            line.points.retain(|(t, _)| !(*t < from || *t > to));
        }
        self.timeline.events.retain(|(t, _)| (from..=to).contains(t));
        self
    }
}

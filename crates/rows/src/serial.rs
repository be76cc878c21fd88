//! Lines of a microcontroller, as the programs at the other end of its serial line write and want them.
//!
//! ```text
//! 12:03:07.001 -> 0.02,21.5,204     a timestamp before each line (Arduino; `>` in PlatformIO)
//! u:21.5,y:204                      a label before each number, for Arduino's plotter
//! ```

use crate::number::clock_s;

/// The name of the column of the timestamps.
pub(crate) const STAMP: &str = "stamp";

/// Takes the timestamps off the lines, one for each line; none where the first line that holds something has none. A
/// line without one has an empty timestamp.
pub(crate) fn take_stamps<'a>(lines: &mut [&'a str]) -> Vec<&'a str> {
    if lines.iter().find(|line| !line.trim().is_empty()).is_none_or(|line| stamped(line).is_none()) {
        return Vec::new();
    }
    let take = |line: &mut &'a str| {
        let (stamp, rest) = stamped(line).unwrap_or(("", line));
        *line = rest;
        stamp
    };
    lines.iter_mut().map(take).collect()
}

/// The timestamp of a line, and the rest of the line.
fn stamped(line: &str) -> Option<(&str, &str)> {
    let (stamp, rest) = line.split_once("->").or_else(|| line.split_once('>'))?;
    clock_s(stamp.trim()).map(|_| (stamp.trim(), rest.trim()))
}

/// The labels of cells, where each of these has one before its number.
pub(crate) fn labels<'a>(cells: &[&'a str]) -> Option<Vec<&'a str>> {
    cells.iter().map(|cell| labelled(cell).map(|(label, _)| label)).collect()
}

/// The numbers of cells that have these labels.
pub(crate) fn without_labels<'a>(cells: &[&'a str], labels: &[&str]) -> Option<Vec<&'a str>> {
    let number =
        |(cell, label): (&&'a str, &&str)| labelled(cell).filter(|(of, _)| of == label).map(|(_, number)| number);
    (cells.len() == labels.len()).then(|| cells.iter().zip(labels).map(number).collect())?
}

fn labelled(cell: &str) -> Option<(&str, &str)> {
    let (label, number) = cell.split_once([':', '='])?;
    let (label, number) = (label.trim(), number.trim());
    let is_label = label.starts_with(|first: char| first.is_alphabetic() || first == '_');
    (is_label && number.parse::<f64>().is_ok()).then_some((label, number))
}

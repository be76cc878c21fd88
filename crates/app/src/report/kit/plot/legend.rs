//! The names of lines: at their ends, or in a key above the diagram.

use super::PlotError;
use super::diagram::Line;
use super::panel::{Area, Chart, FINE, LETTERS, ROW, failed, fine, is_there, letters, steps};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Length of a line in the key, pixels.
const SAMPLE: u32 = 13;

/// The lines with a name; of several with the same name the first.
pub(super) fn key(lines: &[Line]) -> Vec<&Line> {
    let first = |at: usize| lines[..at].iter().all(|before| before.label != lines[at].label);
    (0..lines.len()).filter(|at| !lines[*at].label.is_empty() && first(*at)).map(|at| &lines[at]).collect()
}

/// Writes each name at the right end of its line; names that would overlap are moved apart.
pub(super) fn name_ends(area: &Area<'_>, chart: &Chart<'_, '_>, lines: &[&Line]) -> Result<(), PlotError> {
    let end = |line: &&&Line| line.points.iter().rev().find(|(t, y)| is_there(*t, *y)).copied();
    let mut ends: Vec<(i32, &Line)> =
        lines.iter().filter_map(|line| Some((chart.backend_coord(&end(&line)?).1, *line))).collect();
    ends.sort_by_key(|(y, _)| *y);
    let apart = fine(LETTERS + 4);
    for at in 1..ends.len() {
        ends[at].0 = ends[at].0.max(ends[at - 1].0 + apart);
    }
    let right = chart.plotting_area().get_pixel_range().0.end + fine(8);
    for (y, line) in ends {
        let style = letters(LETTERS, line.colour).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw_text(line.label, &style, (right, y)).map_err(failed)?;
    }
    Ok(())
}

/// Writes the names above the diagram: at the right of the ordinate's row, or in a row of their own.
pub(super) fn draw_key(area: &Area<'_>, lines: &[&Line], rows: u32, wide: bool) -> Result<(), PlotError> {
    let one = |line: &&Line| f64::from(SAMPLE) + 4.0 + width(line.label) + 11.0;
    let all: f64 = lines.iter().map(one).sum();
    let mut x = if wide { f64::from(area.dim_in_pixel().0 / FINE) - all } else { 8.0 };
    let y = (rows - 1) * ROW + LETTERS / 2 + 4;
    for line in lines {
        let (from, to) = ((steps(x), fine(y)), (steps(x + f64::from(SAMPLE)), fine(y)));
        area.draw(&PathElement::new([from, to], line.colour.stroke_width(3 * FINE))).map_err(failed)?;
        let style = letters(LETTERS, line.colour).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw_text(line.label, &style, (to.0 + fine(4), to.1)).map_err(failed)?;
        x += one(line);
    }
    Ok(())
}

/// Approximate width of words, pixels, of the wider of the usual fonts without serifs.
pub(super) fn width(words: &str) -> f64 {
    f64::from(LETTERS) * words.chars().map(share_of_height).sum::<f64>()
}

/// Width of a letter as a share of its height.
const fn share_of_height(letter: char) -> f64 {
    match letter {
        'm' | 'w' | 'M' | 'W' | '%' => 0.9,
        'i' | 'j' | 'l' | 't' | 'f' | 'r' | ' ' | '.' | ',' | ':' | '\'' => 0.36,
        _ => 0.61,
    }
}

#[cfg(test)]
mod tests {
    use super::width;

    #[test]
    fn wide_letters_take_more_room() {
        assert!(width("mmm") > 1.4 * width("nnn") && width("nnn") > 1.4 * width("iii"));
    }
}

//! One diagram: lines over an abscissa, its shaded places and its key, on axes with units.
//!
//! The library rounds to whole pixels, which turns a slow line into steps: everything is drawn [`FINE`] times larger
//! and shown smaller.

use super::PlotError;
use super::diagram::Diagram;
use super::legend::{draw_key, key, name_ends, width};
use super::thinned::thinned;
use crate::report::kit::palette::{GRID, NOMINAL, SETPOINT, SHADE, TEXT, themed};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::ops::Range;

/// Drawing steps per pixel.
pub(super) const FINE: u32 = 8;
/// Heights of letters, pixels.
pub(super) const LETTERS: u32 = 12;
const TITLE: u32 = 16;
/// Factor by which the library divides every letter size.
const LIBRARY: f64 = 1.24;
/// Margins about a diagram, pixels: a row of words, the labels of the axes.
pub(super) const ROW: u32 = 22;
const LEFT: u32 = 52;
const BELOW: u32 = 40;
/// Half of the last label extends beyond the right end of an axis, pixels.
const HALF_A_LABEL: f64 = 20.0;
/// Distance between two labels of an axis, pixels.
const BETWEEN: (u32, u32) = (90, 42);
/// A key has its own row in a diagram that is narrower than this, pixels.
const NARROW: u32 = 620;
/// Largest number of points of a line per pixel: more are not visible.
const MOST_POINTS_A_PIXEL: usize = 2;
/// No point further than this is drawn, in the unit of its axis, nor is an axis narrower than this share of its ends.
const WIDEST: f64 = 1e100;
const NARROWEST: f64 = 1e-9;
/// Labels of an axis that is shorter would be equal in six decimal places.
const FINEST: f64 = 1e-5;
/// With more crosses than this, they overlap on a phone.
const CROWDED: usize = 40;

/// The drawing area, [`FINE`] steps to a pixel.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// A picture of `size` pixels on white, as a file.
pub fn drawn(size: (u32, u32), draw: impl FnOnce(&Area<'_>) -> Result<(), PlotError>) -> Result<String, PlotError> {
    let svg = drawing(size, |area| {
        area.fill(&WHITE).map_err(failed)?;
        draw(area)
    })?;
    let fine = format!("width=\"{}\" height=\"{}\" viewBox", FINE * size.0, FINE * size.1);
    Ok(svg.replacen(&fine, &format!("width=\"{}\" height=\"{}\" viewBox", size.0, size.1), 1))
}

/// The shapes of a diagram of `size` pixels without title and background, and their bounding box: for a page, which
/// sets the colours.
pub fn shapes(size: (u32, u32), of: &Diagram) -> Result<(String, String), PlotError> {
    let svg = drawing(size, |area| titled(area, "", of))?;
    let inner = svg.split_once('>').map_or("", |(_, rest)| rest).trim_end().trim_end_matches("</svg>");
    Ok((format!("0 0 {} {}", FINE * size.0, FINE * size.1), themed(inner)))
}

fn drawing(size: (u32, u32), draw: impl FnOnce(&Area<'_>) -> Result<(), PlotError>) -> Result<String, PlotError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (FINE * size.0, FINE * size.1)).into_drawing_area();
        draw(&area)?;
        area.present().map_err(failed)?;
    }
    Ok(svg)
}

/// Draws one diagram.
pub fn panel(area: &Area<'_>, of: &Diagram) -> Result<(), PlotError> {
    titled(area, &of.title, of)
}

/// Draws one diagram below a title.
pub fn titled(area: &Area<'_>, title: &str, of: &Diagram) -> Result<(), PlotError> {
    let key = key(&of.lines);
    let wide = area.dim_in_pixel().0 >= FINE * NARROW;
    let direct = of.direct && wide;
    let titles = u32::from(!title.is_empty());
    let rows = titles + 1 + u32::from(!wide && !key.is_empty());
    let longest = key.iter().map(|line| width(line.label)).fold(0.0, f64::max);
    let right = if direct { longest + 18.0 } else { HALF_A_LABEL };
    let (times, values) = ranges(of)?;
    let mut chart = ChartBuilder::on(area)
        .margin_top(fine(rows * ROW))
        .margin_right(steps(right))
        .x_label_area_size(fine(BELOW))
        .y_label_area_size(fine(LEFT))
        .build_cartesian_2d(times, values)
        .map_err(failed)?;
    grounds(&mut chart, of)?;
    axes(&mut chart, of, area.dim_in_pixel())?;
    lines(&mut chart, of)?;
    if direct {
        name_ends(area, &chart, &key)?
    } else {
        draw_key(area, &key, rows, wide)?
    }
    words(area, title, (LEFT, 4), TITLE)?;
    words(area, of.ordinate, (8, titles * ROW + 4), LETTERS)
}

/// The background of the lines: shaded places, and the band about the first line.
fn grounds(chart: &mut Chart<'_, '_>, of: &Diagram) -> Result<(), PlotError> {
    let (times, values) = (chart.x_range(), chart.y_range());
    let shade = |&(from, to): &(f64, f64)| {
        let corners = [(from.max(times.start), values.start), (to.min(times.end), values.end)];
        Rectangle::new(corners, SHADE.mix(0.28).filled())
    };
    let is_within = |(from, to): &&(f64, f64)| *from < times.end && *to > times.start;
    chart.draw_series(of.shaded.iter().filter(is_within).map(shade)).map_err(failed)?;
    let (times, values) = (chart.x_range(), chart.y_range());
    let within = of.timeline.events.iter().filter(|(t, _)| times.contains(t));
    let event = |(t, _): &(f64, String)| {
        plotters::element::DashedPathElement::new(
            [(*t, values.start), (*t, values.end)],
            3 * FINE,
            3 * FINE,
            SETPOINT.stroke_width(FINE),
        )
    };
    chart.draw_series(within.map(event)).map_err(failed)?;
    if let Some(line) = of.lines.first().filter(|_| !of.band.is_empty()) {
        let band = of.band.iter().copied().filter(|(t, y)| is_there(*t, *y)).collect::<Vec<_>>();
        let outline = Polygon::new(band, line.colour.mix(0.22).filled());
        chart.draw_series([outline]).map_err(failed)?;
    }
    Ok(())
}

fn axes(chart: &mut Chart<'_, '_>, of: &Diagram, (width, height): (u32, u32)) -> Result<(), PlotError> {
    let (times, values) = (chart.x_range(), chart.y_range());
    let count = |length: u32, between: u32| (length / FINE / between).clamp(3, 12) as usize;
    let (x_step, y_step) = (times.end - times.start, values.end - values.start);
    let of_x = |x: &f64| match x.round() {
        whole if of.decades && (x - whole).abs() < 1e-9 => number(10_f64.powf(whole), 10_f64.powf(whole)),
        _ if of.decades => String::new(),
        _ if of.octaves => number(x.exp2(), x.exp2()),
        _ => number(*x, x_step),
    };
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(FINE))
        .axis_style(GRID.stroke_width(FINE))
        .set_all_tick_mark_size(fine(4))
        .x_labels(count(width, BETWEEN.0))
        .y_labels(count(height, BETWEEN.1))
        .x_label_formatter(&of_x)
        .y_label_formatter(&|y| number(*y, y_step))
        .label_style(letters(LETTERS, TEXT))
        .axis_desc_style(letters(LETTERS, TEXT))
        .x_desc(of.abscissa)
        .draw()
        .map_err(failed)?;
    let base = of.base.map(|y| PathElement::new([(times.start, y), (times.end, y)], TEXT.stroke_width(FINE)));
    chart.draw_series(base).map_err(failed)?;
    Ok(())
}

fn lines(chart: &mut Chart<'_, '_>, of: &Diagram) -> Result<(), PlotError> {
    let pixels = chart.plotting_area().dim_in_pixel().0 / FINE;
    // Below the lines, which many crosses would hide; where there are many, smaller ones.
    let (size, width) = if of.marks.len() > CROWDED { (3, FINE) } else { (6, 2 * FINE) };
    let cross = |at: &(f64, f64)| Cross::new(*at, fine(size), NOMINAL.stroke_width(width));
    let drawn = |points: &[(f64, f64)]| points.iter().copied().filter(|(t, y)| is_there(*t, *y)).collect::<Vec<_>>();
    chart.draw_series(drawn(&of.marks).iter().map(cross)).map_err(failed)?;
    for line in &of.lines {
        let all = line.points.len();
        let breaks = &of.timeline.breaks;
        let pieces = line.points.split(|(t, y)| !is_there(*t, *y));
        let flight = |point: &(f64, f64)| breaks.partition_point(|end| *end <= point.0);
        for piece in pieces.flat_map(|piece| piece.chunk_by(|a, b| flight(a) == flight(b))) {
            // The limit of points for a piece is in proportion to its share of the points.
            let most = MOST_POINTS_A_PIXEL * pixels as usize * piece.len() / all.max(1);
            let style = line.colour.stroke_width(FINE * 7 / 4);
            chart.draw_series(LineSeries::new(thinned(piece, most), style)).map_err(failed)?;
        }
    }
    let bar = |(at, low, high): &(f64, f64, f64)| {
        PathElement::new([(*at, *low), (*at, *high)], TEXT.stroke_width(FINE * 3 / 2))
    };
    chart.draw_series(of.intervals.iter().map(bar)).map_err(failed)?;
    let outline = NOMINAL.stroke_width(2 * FINE);
    chart.draw_series(drawn(&of.rings).iter().map(|at| Circle::new(*at, fine(5), outline))).map_err(failed)?;
    chart.draw_series(drawn(&of.dots).iter().map(|at| Circle::new(*at, fine(4), TEXT.filled()))).map_err(failed)?;
    Ok(())
}

fn words(area: &Area<'_>, words: &str, at: (u32, u32), size: u32) -> Result<(), PlotError> {
    area.draw_text(words, &letters(size, TEXT), (fine(at.0), fine(at.1))).map_err(failed)
}

pub(super) fn letters(size: u32, colour: RGBColor) -> TextStyle<'static> {
    ("sans-serif", f64::from(size * FINE) * LIBRARY).into_font().color(&colour)
}

/// A number with as many decimal places as labels at a tenth of `span` need.
fn number(value: f64, span: f64) -> String {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a few places")]
    let places = (1.0 - span.abs().max(1e-9).log10().floor()).clamp(0.0, 6.0) as usize;
    // Beyond these an axis is of wild numbers, and a label of all their digits would hide it.
    let plain = value == 0.0 || (value.abs() < 1e7 && span.abs() > FINEST);
    let text = if plain { format!("{value:.places$}") } else { format!("{value:.1e}") };
    let text = if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" { "0".into() } else { text.replace('-', "−") }
}

/// Whether a point can be drawn. No rig has numbers beyond; the library's sums of them would not be numbers of pixels.
pub(super) fn is_there(t: f64, y: f64) -> bool {
    t.abs() <= WIDEST && y.abs() <= WIDEST
}

/// The ranges of the axes.
fn ranges(of: &Diagram) -> Result<(Range<f64>, Range<f64>), PlotError> {
    if let Some([times, values]) = of.window {
        return Ok((times.0..times.1, values.0..values.1));
    }
    let of_lines = of.lines.iter().flat_map(|line| &line.points);
    let ends = of.intervals.iter().flat_map(|(at, low, high)| [(*at, *low), (*at, *high)]);
    let points = || {
        let marks = of.marks.iter().chain(&of.rings).chain(&of.dots);
        let all = of_lines.clone().chain(&of.band).chain(marks).copied().chain(ends.clone());
        all.filter(|(t, y)| is_there(*t, *y))
    };
    let (times, values) = (range(points().map(|p| p.0))?, range(points().map(|p| p.1).chain(of.base))?);
    // A value that does not change lies in the middle of an axis of its own size.
    let is_constant = values.end - values.start <= 2.0 * narrowest(&values);
    let size = values.start.abs().max(values.end.abs());
    let pad = if !is_constant {
        0.05 * (values.end - values.start)
    } else if size > 0.0 {
        0.05 * size
    } else {
        1.0
    };
    Ok((times, values.start - pad..values.end + pad))
}

fn range(values: impl Iterator<Item = f64>) -> Result<Range<f64>, PlotError> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return Err(PlotError::Nothing);
    }
    // The library looks for labels by steps of a share of the range, which must be seen beside its ends.
    Ok(low..high.max(low + narrowest(&(low..high))))
}

fn narrowest(range: &Range<f64>) -> f64 {
    NARROWEST * range.start.abs().max(range.end.abs()).max(1.0)
}

/// Pixels in drawing steps.
pub(super) fn fine(pixels: u32) -> i32 {
    i32::try_from(pixels * FINE).unwrap_or(i32::MAX)
}

#[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
pub(super) fn steps(pixels: f64) -> i32 {
    (pixels * f64::from(FINE)) as i32
}

pub fn failed(error: impl std::fmt::Display) -> PlotError {
    PlotError::Draw(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::diagram::Line;
    use super::{Diagram, number, shapes};
    use crate::report::kit::palette::RECORDED;

    #[test]
    fn labels_have_the_places_that_their_axis_needs_and_no_more() {
        let labels =
            [number(200.0, 400.0), number(-0.5, 3.0), number(21.25, 0.8), number(-0.0, 3.0), number(0.0625, 0.0625)];
        assert_eq!(labels, ["200", "−0.5", "21.25", "0", "0.062"]);
        assert_eq!([number(-2e300, 4e300), number(4e7, 1e8)], ["−2.0e300", "4.0e7"]);
        assert_eq!([number(-2e-7, 4e-7), number(0.0, 4e-7)], ["−2.0e−7", "0"]);
    }

    #[test]
    fn a_value_that_does_not_change_has_an_axis_with_labels_that_differ() {
        for value in [0.0, 21.4] {
            let diagram = Diagram {
                lines: vec![Line { label: "", colour: RECORDED, points: vec![(0.0, value), (9.0, value)] }],
                ..Diagram::default()
            };
            let (_, axis) = super::ranges(&diagram).unwrap();
            let ends = [axis.start, axis.end].map(|end| number(end, axis.end - axis.start));
            assert!(ends[0] != ends[1] && axis.contains(&value), "{ends:?}");
        }
    }

    // Without limits of the axes the library looks for their labels without end.
    #[test]
    fn any_finite_numbers_are_drawn() {
        let odd = [0.0, f64::MAX, f64::MIN, 1e17, 1e9, -1e300, f64::MIN_POSITIVE, 5e-324, 400.0];
        for (a, b) in odd.iter().flat_map(|a| odd.map(|b| (*a, b))) {
            let line = |points| Line { label: "recorded", colour: RECORDED, points };
            for points in [vec![(0.0, a), (1.0, b)], vec![(a, 1.0), (b, 2.0)]] {
                let diagram = Diagram { lines: vec![line(points)], ..Diagram::default() };
                let is_small = |(_, drawn): (String, String)| drawn.len() < 20_000;
                // Where all are beyond what a picture can show, there is none.
                assert!(
                    shapes((360, 240), &diagram).is_ok_and(is_small) || a.abs().max(b.abs()) > 1e100,
                    "{a:e}, {b:e}"
                );
            }
        }
    }
}

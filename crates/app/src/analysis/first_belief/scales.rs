//! From the units of a table to ours: seconds, percent, millimetres. What is no length is read as one.
//!
//! ```text
//! time       by its unit, or by the usual step: 1 to 1000 is milliseconds, more is microseconds or nanoseconds
//! input      by a power of ten to within ±100 %; whole numbers to 255 are a PWM of 8 bits
//! position   a length by its unit, to a range of 10 to 100,000 mm; what has another unit, or is longer or shorter, in
//!            that unit, or in thousandths or millionths of it, to a range of 10 to 100,000; anything else by a power of
//!            ten to a range of 100 to 1000 mm
//! speed      by a power of ten to a range of 100 to 1000 mm/s, or less where its integral would leave the longest pipe
//! ```

use super::asked::Asked;
use super::names::Name;
use super::rig_words::written;
use super::roles::Roles;
use diagnose::SETTLING_S;
use plant::Model;
use rows::{Sheet, SheetColumn, held_if_sparse, spread_if_coarse};

/// A scale, and what it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaled {
    /// Ours per theirs.
    pub scale: f64,
    /// The smallest and the largest value in the file.
    pub range: [f64; 2],
    /// The unit in the file, or what it is read as.
    pub read_as: String,
}

/// The scales of a table, and the pipe that holds the record.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// To seconds.
    pub time: Scaled,
    /// The usual time between rows, seconds.
    pub step_s: f64,
    /// Whether the clock is coarser than the rows, so that these are spread between its timestamps.
    pub has_coarse_clock: bool,
    /// Whether most cells of the input are empty, so that they repeat its last value.
    pub is_input_held: bool,
    /// To percent.
    pub input: Scaled,
    /// To millimetres.
    pub position: Scaled,
    /// Lower end of the pipe, mm.
    pub bottom_mm: f64,
    /// Length of the pipe, mm.
    pub length_mm: f64,
    /// Whether a user gave the length, and so the ends.
    pub has_ends: bool,
}

/// Range of the record beside the length of a pipe whose ends it never meets.
const ROOM: f64 = 3.0;

/// The scales of the columns of a table.
#[must_use]
pub fn scales(sheet: &Sheet, roles: &Roles, asked: &Asked) -> Scales {
    let column = |name: &str| sheet.columns.iter().find(|column| column.name == name);
    let mut clock = column(&roles.time.column).cloned().unwrap_or_default();
    let spread = spread_if_coarse(&clock.values);
    let has_coarse_clock = spread.is_some();
    clock.values = spread.unwrap_or(clock.values);
    let by = |scale: f64, read_as: &str| Scaled { scale, ..of(&clock.values, read_as) };
    let time = match (asked.period_s, asked.time_scale) {
        (Some(period_s), _) => by(period_s, "rows"),
        (None, Some(scale)) => by(scale, &format!("{scale} s")),
        (None, None) => time(&clock),
    };
    let step_s = step(&clock) * time.scale;
    let times = &clock.values[..];
    let input = column(&roles.input.column).map_or_else(nothing, |u| {
        let minus = roles.minus.as_deref().and_then(column);
        let values = difference(u, minus);
        Scaled { scale: asked.input_scale.unwrap_or_else(|| input_scale(u, &values)), ..of(&values, &unit(u)) }
    });
    let position = column(&roles.position.column).map_or_else(nothing, |y| {
        let values = if roles.is_speed { integral(&y.values, times, time.scale) } else { y.values.clone() };
        let by_unit = (!roles.is_speed).then(|| Name::of(y).unit.and_then(|unit| length_mm(&unit))).flatten();
        let own = (y.name == "position_mm").then_some(1.0);
        let range = of(&values, "");
        let in_units = || [1.0, 1e3, 1e6].into_iter().find(|scale| is_usual(scale * span(range.range)));
        let by_unit = by_unit.filter(|scale| is_usual(scale * span(range.range)));
        let has_unit = !roles.is_speed && by_unit.is_none() && Name::of(y).unit.is_some();
        let scale = asked.position_scale.or(own).or(by_unit).or_else(|| in_units().filter(|_| has_unit));
        let by_range =
            || if roles.is_speed { speed_scale(y, span(range.range)) } else { to_hundreds(span(range.range)) };
        Scaled { scale: scale.unwrap_or_else(by_range), ..of(&values, &unit(y)) }
    });
    let (length_mm, bottom_mm) = match asked.length_mm {
        Some(length_mm) => (length_mm, 0.0),
        None => around(&position),
    };
    // The range of the values in the file, also of a speed, of which the position is the integral.
    let range = column(&roles.position.column).map_or(position.range, |y| of(&y.values, "").range);
    Scales {
        time,
        step_s,
        has_coarse_clock,
        is_input_held: column(&roles.input.column).is_some_and(|u| held_if_sparse(&u.values).is_some()),
        input,
        position: Scaled { range, ..position },
        bottom_mm,
        length_mm,
        has_ends: asked.length_mm.is_some(),
    }
}

impl Scales {
    /// The unity gain, mm per percent: that of a position that follows the input in its own unit. `None`: their units
    /// differ, or the input is a difference of command and position already.
    pub(super) fn unity_gain(&self, is_difference: bool) -> Option<f64> {
        let [position, input] = [&self.position, &self.input];
        let is_alike = position.read_as == input.read_as || position.read_as.is_empty() || input.read_as.is_empty();
        (is_alike && !is_difference).then(|| position.scale / input.scale)
    }
}

fn nothing() -> Scaled {
    Scaled { scale: 1.0, range: [0.0, 1.0], read_as: String::new() }
}

/// The range of some values, unscaled.
fn of(values: &[Option<f64>], read_as: &str) -> Scaled {
    let numbers = values.iter().flatten();
    let range = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)]);
    let range = if range[0] <= range[1] { range } else { [0.0, 0.0] };
    Scaled { scale: 1.0, range, read_as: read_as.into() }
}

fn unit(column: &SheetColumn) -> String {
    Name::of(column).unit.map(|unit| written(&unit)).unwrap_or_default()
}

fn span([low, high]: [f64; 2]) -> f64 {
    high - low
}

/// The usual step of a column that grows.
fn step(column: &SheetColumn) -> f64 {
    let mut steps: Vec<f64> = column.values.windows(2).filter_map(|pair| Some(pair[1]? - pair[0]?)).collect();
    steps.retain(|step| *step > 0.0);
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0)
}

pub(super) fn time(column: &SheetColumn) -> Scaled {
    let named = Name::of(column).unit;
    let by_unit = named.as_deref().and_then(|unit| {
        let known = [("s", 1.0), ("sec", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0)];
        known.into_iter().find(|(name, _)| *name == unit)
    });
    let as_read = of(&column.values, "");
    // Rows are 0.1 ms to 1 s apart, and a record is longer than its filter takes to settle.
    let (step, long) = (step(column), span(as_read.range));
    let known = [("ns", 1e-9), ("us", 1e-6), ("ms", 1e-3), ("s", 1.0)];
    let slowest = known.into_iter().rev().find(|(_, scale)| step * scale < 1.0).unwrap_or(known[0]);
    let by_step = known.into_iter().find(|(_, scale)| *scale >= slowest.1 && long * scale > SETTLING_S);
    let (read_as, scale) = by_unit.or(by_step).unwrap_or(slowest);
    Scaled { scale, read_as: read_as.into(), ..as_read }
}

fn input_scale(column: &SheetColumn, values: &[Option<f64>]) -> f64 {
    let [low, high] = of(values, "").range;
    let largest = high.abs().max(low.abs());
    let name = Name::of(column);
    let is_percent =
        name.says(&["pct", "percent", "duty"]) || matches!(name.unit.as_deref(), Some("pct" | "percent" | "%"));
    let is_whole = values.iter().flatten().all(|value| value.fract() == 0.0);
    if is_percent && largest > 1.5 && largest <= 150.0 {
        return 1.0;
    }
    if is_whole && (200.0..=255.0).contains(&largest) {
        return 100.0 / 255.0;
    }
    if largest > 0.0 { 10f64.powf(2.0 - (largest * (1.0 - 1e-9)).log10().ceil()) } else { 1.0 }
}

/// Millimetres of a unit of length.
pub(super) fn length_mm(unit: &str) -> Option<f64> {
    let known = [("m", 1000.0), ("cm", 10.0), ("mm", 1.0), ("um", 1e-3), ("in", 25.4)];
    known.into_iter().find(|(name, _)| *name == unit).map(|(_, scale)| scale)
}

/// Whether a range is one of a rig, mm.
fn is_usual(range_mm: f64) -> bool {
    (10.0..1e5).contains(&range_mm)
}

/// The power of ten by which a range becomes 100 to 1000.
fn to_hundreds(range: f64) -> f64 {
    if range > 0.0 { 10f64.powf(3.0 - (range * (1.0 - 1e-9)).log10().ceil()) } else { 1.0 }
}

/// The scale of a speed. A wheel that turns one way goes far; how it moves within a second shows in its speed.
fn speed_scale(speed: &SheetColumn, range_of_integral: f64) -> f64 {
    let longest = Model::LONGEST_PIPE_MM / (ROOM * range_of_integral.max(f64::MIN_POSITIVE));
    to_hundreds(span(of(&speed.values, "").range)).min(10f64.powf(longest.log10().floor()))
}

/// Length and lower end of a pipe in whose middle the record lies, mm, both round.
fn around(position: &Scaled) -> (f64, f64) {
    let [low, high] = position.range;
    // A distance from above has a scale below 0.
    let length = round(ROOM * span(position.range) * position.scale.abs(), 2).clamp(1.0, Model::LONGEST_PIPE_MM);
    let bottom = 0.5 * (low + high) * position.scale - 0.5 * length;
    let grid = 10f64.powf(length.log10().floor() - 2.0);
    (length, (bottom / grid).round() * grid)
}

/// A number with so many significant digits.
fn round(value: f64, digits: i32) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    #[expect(clippy::cast_possible_truncation, reason = "the exponent of a number")]
    let power = digits - 1 - value.abs().log10().floor() as i32;
    (value * 10f64.powi(power)).round() / 10f64.powi(power)
}

pub(super) fn difference(u: &SheetColumn, minus: Option<&SheetColumn>) -> Vec<Option<f64>> {
    let held = |column: &SheetColumn| held_if_sparse(&column.values).unwrap_or_else(|| column.values.clone());
    let Some(minus) = minus else { return u.values.clone() };
    let (u, minus) = (held(u), held(minus));
    u.iter().zip(&minus).map(|(a, b)| Some((*a)? - (*b)?)).collect()
}

/// The integral of a speed by trapezoids.
pub(super) fn integral(values: &[Option<f64>], times: &[Option<f64>], scale: f64) -> Vec<Option<f64>> {
    let (mut sum, mut last) = (0.0, None);
    let one = |(value, time): (&Option<f64>, &Option<f64>)| {
        let (value, time) = ((*value)?, (*time)? * scale);
        let (before, then) = last.unwrap_or((value, time));
        sum += 0.5 * (value + before) * (time - then);
        last = Some((value, time));
        Some(sum)
    };
    values.iter().zip(times).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::super::asked::Asked;
    use super::super::roles::roles;
    use super::{input_scale, scales};
    use rows::{Sheet, SheetColumn};

    #[test]
    fn whole_numbers_to_255_of_one_sign_or_both_are_a_pwm() {
        let pwm = SheetColumn { name: "pwm".into(), ..SheetColumn::default() };
        let scale = |values: &[f64]| input_scale(&pwm, &values.iter().copied().map(Some).collect::<Vec<_>>());
        assert_eq!([scale(&[0.0, 255.0]), scale(&[-255.0, 40.0, 255.0])], [100.0 / 255.0; 2]);
        assert_eq!([scale(&[-70.0, 70.0]), scale(&[-255.5, 255.0])], [1.0, 0.1]);
    }

    #[test]
    fn a_record_of_a_distance_from_above_lies_in_the_middle_of_its_pipe() {
        let columns = [("t_s", [0.0, 1.0, 2.0]), ("u", [1.0, 2.0, 1.5]), ("y", [12.0, 14.0, 13.0])];
        let columns = columns.map(|(name, values)| {
            let values = values.map(Some).into();
            SheetColumn { name: name.into(), values, ..SheetColumn::default() }
        });
        let sheet = Sheet { columns: columns.into(), rows: 3 };
        let found = roles(&sheet, &Asked::default()).unwrap();
        let asked = Asked { position_scale: Some(-100.0), ..Asked::default() };
        let scales = scales(&sheet, &found, &asked);
        assert_eq!((scales.length_mm, scales.position.scale), (600.0, -100.0));
        assert_eq!(-100.0 * 13.0 - scales.bottom_mm, 300.0);
    }

    #[test]
    fn a_wheel_that_turns_one_way_is_scaled_by_its_speed_and_stays_in_the_longest_pipe() {
        let of = |seconds: usize| {
            let values = |of: fn(f64) -> f64| (0..10 * seconds).map(|k| Some(of(k as f64 / 10.0))).collect();
            let columns = [("t_s", values(|t| t)), ("u", values(|t| t.sin())), ("speed", values(|t| 2.0 + t.cos()))];
            let columns =
                columns.map(|(name, values)| SheetColumn { name: name.into(), values, ..SheetColumn::default() });
            let sheet = Sheet { columns: columns.into(), rows: 10 * seconds };
            let found = roles(&sheet, &Asked::default()).unwrap();
            assert!(found.is_speed);
            let scales = scales(&sheet, &found, &Asked::default());
            (scales.position.scale, scales.length_mm)
        };
        // Its speed spans 2 units; two units a second go 1600 and 16,000 units.
        assert_eq!(of(800).0, 100.0);
        let (scale, length_mm) = of(8000);
        assert_eq!(scale, 10.0);
        assert!(length_mm <= 1e6, "{length_mm}");
    }
}

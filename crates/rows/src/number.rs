//! Numbers and times as programs write them into cells.

use std::borrow::Cow;

/// What programs write where there is no number, in lower case: numpy, pandas, R, spreadsheets and databases.
const NOTHING: [&str; 9] = ["nan", "-nan", "na", "n/a", "#n/a", "null", "none", "-", "--"];

/// How a table writes its numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Decimal {
    /// 1.5
    #[default]
    Point,
    /// 1,5
    Comma,
}

impl Decimal {
    /// That of a table: commas where some number has one, and none has a point.
    pub(crate) fn of<'a>(cells: impl Iterator<Item = &'a str>) -> Self {
        let mut comma = false;
        for cell in cells {
            if cell.contains('.') && cell.parse::<f64>().is_ok() {
                return Self::Point;
            }
            comma |= cell.matches(',').count() == 1 && cell.replace(',', ".").parse::<f64>().is_ok();
        }
        if comma { Self::Comma } else { Self::Point }
    }

    /// The number of a cell; NaN where there is none. `None`: it is something else.
    pub(crate) fn number(self, cell: &str) -> Option<f64> {
        let plain = match self {
            Self::Comma if cell.contains(',') => cell.replace(',', ".").parse(),
            _ => cell.parse(),
        };
        let missing = || NOTHING.iter().any(|word| cell.eq_ignore_ascii_case(word)).then_some(f64::NAN);
        plain.ok().or_else(missing)
    }
}

/// Seconds of a date with time, or of a time of day; an offset from UTC is not applied, because it is the same in every
/// row. `None`: the cell is no time.
pub(crate) fn clock_s(cell: &str) -> Option<f64> {
    let (date, time) = match cell.split_once(['T', ' ']) {
        Some((date, time)) => (date, time.trim_start()),
        None => ("1970-01-01", cell),
    };
    let date = year_first(date);
    let end = time.find(['Z', '+', '-']).unwrap_or(time.len());
    let time = time[..end].trim_end().replace(',', ".");
    if !time.contains(':') {
        return None;
    }
    let seconds = if time.matches(':').count() == 1 { ":00" } else { "" };
    let moment = humantime::parse_rfc3339_weak(&format!("{date} {time}{seconds}")).ok()?;
    let since = moment.duration_since(std::time::UNIX_EPOCH).ok()?;
    Some(since.as_secs_f64())
}

/// A date with the year before month and day, as `31.12.2026`, `31/12/2026` and `12/31/2026` have it behind them. Of
/// two numbers that could both be the month, the one before a slash is.
fn year_first(date: &str) -> Cow<'_, str> {
    let parts: Vec<&str> = date.split(['.', '/']).collect();
    let [first, second, year] = parts[..] else { return date.into() };
    let number = |part: &str| part.parse::<u32>().unwrap_or_default();
    if year.len() != 4 {
        return date.into();
    }
    let day_first = date.contains('.') || number(first) > 12;
    let (day, month) = if day_first { (first, second) } else { (second, first) };
    format!("{year}-{:02}-{:02}", number(month), number(day)).into()
}

#[cfg(test)]
mod tests {
    use super::{Decimal, clock_s};

    #[test]
    fn a_comma_is_decimal_only_where_no_number_has_a_point() {
        let of = |cells: &[&str]| Decimal::of(cells.iter().copied());
        assert_eq!(of(&["1", "0,5", "x"]), Decimal::Comma);
        assert_eq!(of(&["0,5", "0.5"]), Decimal::Point);
        assert_eq!(of(&["1,000,000"]), Decimal::Point);
        assert_eq!(Decimal::Comma.number("-2,5e1"), Some(-25.0));
        assert!(Decimal::Point.number("NA").unwrap().is_nan() && Decimal::Point.number("2,5").is_none());
    }

    #[test]
    fn dates_and_times_of_day_are_seconds() {
        let since = |cell: &str| clock_s(cell).unwrap() - clock_s("2026-03-01T12:00:00Z").unwrap();
        for (cell, seconds) in [
            ("2026-03-01T12:00:01Z", 1.0),
            ("2026-03-01 12:00:00.25", 0.25),
            ("2026-03-01 12:00:00,5", 0.5),
            ("2026-03-01T12:01:00+02:00", 60.0),
            ("01.03.2026 12:00:02,5", 2.5),
            ("1.3.2026 12:01", 60.0),
            ("3/1/2026 12:00:03", 3.0),
            ("31/3/2026 12:00:00", 30.0 * 86_400.0),
            ("2026-03-02T12:00:00.000001", 86_400.000_001),
        ] {
            assert!((since(cell) - seconds).abs() < 1e-6, "{cell}: {}", since(cell));
        }
        assert_eq!(clock_s("00:00:02.5"), Some(2.5));
        assert_eq!(clock_s("01:02"), Some(3720.0));
        for none in ["", "12", "2026-03-01", "2026-13-01T12:00:00", "a:b:c", "1;2 é:ü"] {
            assert_eq!(clock_s(none), None, "{none}");
        }
    }
}

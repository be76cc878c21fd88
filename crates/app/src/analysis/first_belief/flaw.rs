//! What keeps a column from the role that its name says: text, one value in all rows, a number of the row, or a time
//! that goes backwards.

use super::roles::Role;
use rows::{SheetColumn, TextCell, shown};

/// What keeps a column from its role, and the line to mend, as the middle of a message.
pub(super) fn flaw(role: Role, column: &SheetColumn) -> Option<String> {
    let name = shown(&column.name);
    if let Some(TextCell { line, content }) = &column.text {
        let content = shown(content);
        return Some(format!(
            ": line {line} of `{name}` holds `{content}`, which is no number; mend it or remove the row"
        ));
    }
    if column.values.is_empty() {
        return Some(format!(": `{name}` holds no numbers"));
    }
    if role != Role::Time && !moves(column) {
        return Some(format!(": `{name}` has the same value in all rows"));
    }
    if role == Role::Time && counts_rows(column) {
        return Some(format!(": `{name}` counts the rows and does not say how far apart they are"));
    }
    let line = column.decreases_in.filter(|_| role == Role::Time)?;
    let advice = if mostly_rises(column) { "sort the rows, or cut the file there" } else { "so it is no time" };
    Some(format!(": `{name}` goes backwards in line {line}; {advice}"))
}

/// Whether the column has more than one value.
pub(super) fn moves(column: &SheetColumn) -> bool {
    let mut values = column.values.iter().flatten();
    let first = values.next();
    values.any(|value| Some(value) != first)
}

/// Whether every row has a number, and none is smaller than the one before.
pub(super) fn grows(column: &SheetColumn) -> bool {
    let values = &column.values;
    let whole = values.len() > 1 && values.iter().all(Option::is_some) && values.first() != values.last();
    whole && values.windows(2).all(|pair| pair[0] <= pair[1])
}

/// Whether most numbers are larger than the one before, as in a time, and not in a setpoint that waits.
fn mostly_rises(column: &SheetColumn) -> bool {
    let values = &column.values;
    2 * values.windows(2).filter(|pair| pair[1] > pair[0]).count() > values.len()
}

/// Whether each number is larger by one than the one before.
pub(super) fn counts_rows(column: &SheetColumn) -> bool {
    column.values.len() > 1
        && column.values.windows(2).all(|pair| matches!(pair, [Some(one), Some(next)] if next - one == 1.0))
}

/// Whether every row has a number, and fewer than one of a hundred is smaller than the one before, as where a ring
/// buffer was saved or a microcontroller restarted. The share was chosen by hand; it only words an error.
pub(super) fn nearly_grows(column: &SheetColumn) -> bool {
    let values = &column.values;
    let falls = values.windows(2).filter(|pair| pair[1] < pair[0]).count();
    values.iter().all(Option::is_some) && (1..values.len() / 100).contains(&falls)
}

#[cfg(test)]
mod tests {
    use super::super::asked::Asked;
    use super::super::roles::roles;

    #[test]
    fn a_column_with_text_or_a_time_that_goes_backwards_is_named_with_its_line() {
        let table = |at: usize, row: &str| {
            let rows = (0..50).map(|k| if k == at { format!("{row}\n") } else { format!("{k},{},{}\n", k % 7, k % 9) });
            format!("t,duty,position_mm\n{}", rows.collect::<String>())
        };
        let duty = Asked { input: Some("duty".into()), ..Asked::default() };
        for (row, asked, said) in [
            ("30,oops,300", Asked::default(), "the input: line 32 of `duty` holds `oops`, which is no number; mend it"),
            ("30,oops,300", duty, "the input: line 32 of `duty` holds `oops`, which is no number; mend it"),
            ("1,3,300", Asked::default(), "the time: `t` goes backwards in line 32; sort the rows"),
        ] {
            let sheet = rows::sheet("rig.csv", table(30, row).as_bytes()).unwrap();
            let found = roles(&sheet, &asked).unwrap_err().to_string();
            assert!(found.contains(said), "{row}: {found}");
        }
        let waits = (0..50).map(|k| format!("{},{},{}\n", -(k / 9), k % 7, k % 9)).collect::<String>();
        let sheet = rows::sheet("rig.csv", format!("t,duty,position_mm\n{waits}").as_bytes()).unwrap();
        let found = roles(&sheet, &Asked::default()).unwrap_err().to_string();
        assert!(found.contains("`t` goes backwards in line 11; so it is no time"), "{found}");
        let still: String = (0..50).map(|k| format!("{k},{},300\n", k % 7)).collect();
        let sheet = rows::sheet("rig.csv", format!("t,duty,position_mm\n{still}").as_bytes()).unwrap();
        let found = roles(&sheet, &Asked::default()).unwrap_err().to_string();
        assert!(found.contains("the position: `position_mm` has the same value in all rows; name it"), "{found}");
    }

    #[test]
    fn of_columns_that_only_grow_the_first_is_the_time_unless_it_counts_rows() {
        let ramp = |k: f64| format!("{},{},{}", 0.015 * k, (0.3 * k).sin(), 8.0 + 0.0075 * k);
        let ramps: String = (0..200).map(|k| ramp(f64::from(k)) + "\n").collect();
        let counted: String = (0..200).map(|k| format!("{k},{}\n", ramp(f64::from(k)))).collect();
        for (text, time) in [(ramps, "column1"), (counted, "column2")] {
            let sheet = rows::sheet("rig.csv", text.as_bytes()).unwrap();
            assert_eq!(roles(&sheet, &Asked::default()).unwrap().time.column, time);
        }
    }

    #[test]
    fn a_column_that_counts_the_rows_is_the_time_only_with_the_period_or_a_unit() {
        let rows: String = (0..200).map(|k| format!("{k},{},{}\n", k % 7, k % 9)).collect();
        let time = |header: &str, asked: &Asked| {
            let sheet = rows::sheet("rig.csv", format!("{header},duty,position_mm\n{rows}").as_bytes()).unwrap();
            roles(&sheet, asked).map(|found| found.time.column).map_err(|error| error.to_string())
        };
        let refused = time("sample", &Asked::default()).unwrap_err();
        let said = "the time: `sample` counts the rows and does not say how far apart they are; name it with --time \
                    COLUMN, or give the time between two rows with --period SECONDS";
        assert!(refused.contains(said), "{refused}");
        let asked = Asked { period_s: Some(0.005), ..Asked::default() };
        assert_eq!(time("sample", &asked), Ok("sample".into()));
        for header in ["t", "clock [ms]"] {
            assert_eq!(time(header, &Asked::default()), Ok(header.into()));
        }
    }
}

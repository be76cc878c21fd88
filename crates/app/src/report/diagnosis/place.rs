//! Where a model is wrong, in the columns of the log: there a user looks for it, and positions of a rig without ends
//! have another origin in the config.

use diagnose::{Place, SourceColumns, decimals};

/// A place as written after "wrong".
#[must_use]
pub fn words(place: &Place, columns: &SourceColumns) -> String {
    match place.signal {
        "lag_s" => format!("{:.2} to {:.2} s after the duty moves", place.from, place.to),
        signal => in_the_log(place, columns).map_or_else(
            || format!("where {signal} is {:.1} to {:.1}", place.from, place.to),
            |said| format!("where {said}"),
        ),
    }
}

/// The same in a column of the log. `None`: the log has our own column, or none that is this quantity. A time counts
/// from the start of the record, and its column from any moment.
#[must_use]
pub fn in_the_log(place: &Place, columns: &SourceColumns) -> Option<String> {
    let SourceColumns { duty_percent, position_mm, .. } = columns;
    let own = SourceColumns::default();
    let (source, own, offset, verb, unit) = match place.signal {
        "duty_percent" => (duty_percent, own.duty_percent, duty_percent.offset, "is", ""),
        "position_mm" => (position_mm, own.position_mm, position_mm.offset, "is", ""),
        "velocity_mm_per_s" => (position_mm, own.position_mm, 0.0, "changes by", " per s"),
        _ => return None,
    };
    if !source.is_foreign(&own) {
        return None;
    }
    let [a, b] = [place.from, place.to].map(|end| (end - offset) / source.scale);
    let [low, high] = [a.min(b), a.max(b)].map(|end| format!("{end:.*}", decimals(end)));
    Some(format!("{} {verb} {low} to {high}{unit}", source.column))
}

#[cfg(test)]
mod tests {
    use super::words;
    use diagnose::{Place, SourceColumn, SourceColumns};

    fn place(signal: &'static str, from: f64, to: f64) -> Place {
        Place { signal, from, to, p_value: 0.01, share: 0.5 }
    }

    fn column(name: &str, scale: f64, offset: f64) -> SourceColumn {
        SourceColumn { column: name.into(), scale, offset, ..SourceColumns::default().position_mm }
    }

    #[test]
    fn a_place_is_told_in_the_columns_of_the_log_also_where_these_have_another_origin_or_sign() {
        let columns = SourceColumns {
            time_s: column("t [ms]", 1e-3, 0.0),
            duty_percent: column("u", -10.0, 50.0),
            position_mm: column("angle_deg", 2.0, 300.0),
        };
        for (place, said) in [
            (place("position_mm", 100.0, 400.0), "where angle_deg is -100 to 50.0"),
            (place("velocity_mm_per_s", -8.0, 12.0), "where angle_deg changes by -4.00 to 6.00 per s"),
            (place("duty_percent", 20.0, 80.0), "where u is -3.00 to 3.00"),
            (place("time_s", 1.5, 2.0), "where time_s is 1.5 to 2.0"),
            (place("lag_s", 0.25, 0.5), "0.25 to 0.50 s after the duty moves"),
        ] {
            assert_eq!(words(&place, &columns), said);
        }
    }

    #[test]
    fn a_log_with_our_columns_and_a_quantity_of_no_column_keep_the_names_of_the_config() {
        let mut columns = SourceColumns::default();
        let height = place("position_mm", 100.0, 400.0);
        assert_eq!(words(&height, &columns), "where position_mm is 100.0 to 400.0");
        columns.position_mm = column("speed", 1.0, 0.0);
        columns.position_mm.further_keys = ", integrate = true".into();
        assert_eq!(words(&height, &columns), "where position_mm is 100.0 to 400.0");
    }
}

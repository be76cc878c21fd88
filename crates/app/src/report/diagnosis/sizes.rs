//! The size of an effect in the columns of the log, whose units a user knows.
//!
//! ```text
//! column = (value − offset)/scale
//! duty   = hover + A/K_g            for an acceleration A that is commanded about hover
//! ```

use diagnose::{Diagnosis, NamedEffect, SourceColumn, SourceColumns, decimals};
use plant::{InColumn, Model};

/// The sizes as written after "that is"; `None` where the effect has none in a column, or the log has our own columns.
#[must_use]
pub fn in_the_log(named: &NamedEffect, found: &Diagnosis, columns: &SourceColumns) -> Option<String> {
    let entry = named.candidate.entry;
    let fitted = found.effect_parameters(named);
    let values = entry.params.iter().map_while(|param| Some(fitted.get(param.name)?.value));
    let sizes: Vec<(InColumn, f64)> = entry.in_columns.iter().copied().zip(values).collect();
    words(&sizes, &found.mended.model, columns)
}

/// The same of these sizes, all in one column.
fn words(sizes: &[(InColumn, f64)], model: &Model, columns: &SourceColumns) -> Option<String> {
    let of = |&(kind, value): &(InColumn, f64)| Size::new(kind, value, model, columns);
    let sizes = sizes.iter().map(of).collect::<Option<Vec<Size<'_>>>>()?;
    let first = sizes.first()?;
    let mut values: Vec<f64> = sizes.iter().map(|size| size.value).collect();
    values.sort_by(f64::total_cmp);
    let said: Vec<String> = values.iter().map(|value| format!("{value:.*}", decimals(*value))).collect();
    let (said, column) = (said.join(" and "), &first.column.column);
    Some(if first.is_difference { format!("{said} of {column}") } else { format!("{column} = {said}") })
}

/// A size in a column.
struct Size<'a> {
    column: &'a SourceColumn,
    value: f64,
    is_difference: bool,
}

impl<'a> Size<'a> {
    /// `None` where the log has our own column, or none that is this quantity.
    fn new(kind: InColumn, value: f64, model: &Model, columns: &'a SourceColumns) -> Option<Self> {
        let SourceColumns { duty_percent, position_mm, .. } = columns;
        let own = SourceColumns::default();
        let (duty, position) = ((duty_percent, own.duty_percent), (position_mm, own.position_mm));
        let (gain, hover) = (model.gain_mm_per_s2_per_percent, model.hover_duty_percent);
        let ((column, own), value, is_difference) = match kind {
            InColumn::Input => (duty, hover + value, false),
            InColumn::InputByForce => (duty, hover + value / gain, false),
            InColumn::InputDifference => (duty, value, true),
            InColumn::InputDifferenceByForce => (duty, value / gain, true),
            InColumn::Position => (position, value, false),
            InColumn::PositionDifference => (position, value, true),
        };
        if !column.is_foreign(&own) {
            return None;
        }
        let value = if is_difference { (value / column.scale).abs() } else { (value - column.offset) / column.scale };
        value.is_finite().then_some(Self { column, value, is_difference })
    }
}

#[cfg(test)]
mod tests {
    use super::words;
    use crate::analysis::closed_loop::tests::project;
    use diagnose::{SourceColumn, SourceColumns};
    use plant::InColumn::{Input, InputByForce, InputDifference, InputDifferenceByForce, Position, PositionDifference};
    use plant::{InColumn, Model};

    fn model() -> Model {
        Model { gain_mm_per_s2_per_percent: 200.0, hover_duty_percent: 30.0, ..project().plant.unwrap() }
    }

    fn columns() -> SourceColumns {
        let column = |name: &str, scale: f64, offset: f64| SourceColumn {
            column: name.into(),
            scale,
            offset,
            ..SourceColumns::default().position_mm
        };
        SourceColumns {
            duty_percent: column("volts", -10.0, 50.0),
            position_mm: column("angle_deg", 2.0, 300.0),
            ..SourceColumns::default()
        }
    }

    #[test]
    fn a_size_is_told_in_its_column_whatever_the_scale_origin_and_sign_of_that() {
        for (sizes, said) in [
            // Duties of 20 and 40 %.
            (&[(Input, -10.0), (Input, 10.0)][..], "volts = 1.00 and 3.00"),
            // Of 25 and 40 %.
            (&[(InputByForce, -1000.0), (InputByForce, 2000.0)], "volts = 1.00 and 2.50"),
            (&[(InputDifference, 2.5)], "0.250 of volts"),
            // Of 0.2 %.
            (&[(InputDifferenceByForce, 40.0)], "0.0200 of volts"),
            (&[(Position, 100.0), (Position, 500.0)], "angle_deg = -100 and 100"),
            (&[(PositionDifference, 5.0)], "2.50 of angle_deg"),
        ] {
            assert_eq!(words(sizes, &model(), &columns()).as_deref(), Some(said));
        }
    }

    #[test]
    fn a_log_with_our_columns_a_quantity_of_no_column_and_an_effect_without_sizes_say_nothing() {
        let size: &[(InColumn, f64)] = &[(Position, 100.0)];
        assert_eq!(words(size, &model(), &SourceColumns::default()), None);
        let mut integrated = columns();
        integrated.position_mm.further_keys = ", integrate = true".into();
        assert_eq!(words(size, &model(), &integrated), None);
        assert_eq!(words(&[], &model(), &columns()), None);
    }
}

//! The format of every table in words: lines above and below, the first column to the left and the others to the right.

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{CellAlignment, Row, Table, TableComponent};
use config::words::Words;

/// A table without rows.
pub fn empty(header: impl Into<Row>) -> Table {
    let mut table = Table::new();
    table.load_preset(UTF8_HORIZONTAL_ONLY);
    table.remove_style(TableComponent::HorizontalLines).remove_style(TableComponent::MiddleIntersections);
    table.set_header(header);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// A table in the words of a rig, aligned by them.
pub fn in_words(table: &Table, rig: &Words) -> String {
    let cells = |row: &Row| row.cell_iter().map(|cell| rig.of(&cell.content())).collect::<Vec<_>>();
    let mut said = empty(table.header().map(cells).unwrap_or_default());
    said.add_rows(table.row_iter().map(cells));
    said.to_string()
}

#[cfg(test)]
mod tests {
    use super::{empty, in_words};
    use config::words::Words;

    #[test]
    fn a_table_in_longer_words_has_lines_of_one_length() {
        let rig = Words { input: Some("propeller torque".into()), ..Words::default() };
        let mut table = empty(["", "duty"]);
        table.add_rows([["drag", "1.0"], ["duty", "20"]]);
        let said = in_words(&table, &rig);
        let lengths: Vec<usize> = said.lines().map(|line| line.chars().count()).collect();
        assert!(said.contains("propeller torque") && !said.contains("duty"), "{said}");
        assert!(lengths.iter().all(|length| *length == lengths[0]), "{said}");
        assert_eq!(in_words(&table, &Words::default()), table.to_string());
    }
}

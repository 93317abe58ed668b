//! The look of all tables.

use comfy_table::{CellAlignment, Table};

/// Lines above, below the header and below the table, in comfy-table's order of components.
const LINES: &str = "  ── ══      ──    ";

/// An empty table with this header.
pub(crate) fn with_header<T: Into<comfy_table::Row>>(header: T) -> Table {
    let mut table = Table::new();
    table.load_preset(LINES);
    table.set_header(header);
    table
}

/// Aligns columns of numbers and prints the table.
pub(crate) fn finished(mut table: Table, numbers: impl IntoIterator<Item = usize>) -> String {
    for column in numbers {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.trim_fmt()
}

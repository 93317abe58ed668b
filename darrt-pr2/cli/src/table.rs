//! The look of all tables.

use comfy_table::{CellAlignment, ContentArrangement, Table};

/// Columns of a terminal; only what must not be broken is wider.
pub(crate) const WIDTH: u16 = 80;

/// Lines above, below the header and below the table, in comfy-table's order of components.
const LINES: &str = "  ── ══      ──    ";

/// An empty table with this header; what does not fit into the width goes on in another line of its cell.
pub(crate) fn with_header<T: Into<comfy_table::Row>>(header: T) -> Table {
    let mut table = Table::new();
    table.load_preset(LINES).set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table.set_header(header);
    table
}

/// An empty table with this header whose cells are never broken, so that names stay whole.
pub(crate) fn unbroken<T: Into<comfy_table::Row>>(header: T) -> Table {
    let mut table = with_header(header);
    table.set_content_arrangement(ContentArrangement::Disabled);
    table
}

/// Aligns columns of numbers and prints the table.
pub(crate) fn finished(mut table: Table, numbers: impl IntoIterator<Item = usize>) -> String {
    for column in numbers {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    for column in table.column_iter_mut() {
        column.set_padding((0, 1));
    }
    table.trim_fmt()
}

//! The steps of a plan as a table.

use comfy_table::ColumnConstraint;

use super::table;
use darrt_task::picture::story::Story;
use darrt_task::picture::travel::{Travel, amount};

/// One row per step (what moved how far) and a row of totals.
pub(crate) fn table(story: &Story) -> String {
    let mut table = table::with_header(["step", "primitive", "object", "base", "hand", "object moves"]);
    let mut total = Travel::default();
    for (number, step) in (1_usize..).zip(&story.steps) {
        let travel = Travel::of(story, step);
        let object = step.object.or(travel.object).and_then(|object| story.problem.objects.get(object));
        let name = object.map_or("", |object| &object.name);
        let tool = story.tool_of(step).map_or_else(String::new, |tool| format!(", {tool}"));
        table.add_row(row(&number.to_string(), &format!("{}{tool}", step.primitive), name, &travel));
        total = total.plus(&travel);
    }
    table.add_row(row("", "all", "", &total));
    // Names of primitives stay whole; what is long is the user's name of an object.
    if let Some(column) = table.column_mut(1) {
        column.set_constraint(ColumnConstraint::ContentWidth);
    }
    table::finished(table, [0])
}

fn row(number: &str, primitive: &str, object: &str, travel: &Travel) -> [String; 6] {
    [
        number.to_owned(),
        primitive.to_owned(),
        object.to_owned(),
        amount(travel.base_m, travel.base_turn),
        amount(travel.hand_m, travel.hand_turn),
        amount(travel.object_m, travel.object_turn),
    ]
}

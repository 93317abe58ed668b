//! The bounds of single numbers and lists of a problem file as the schema tells them. A test holds each against the reader: what
//! one refuses the other refuses.
//!
//! Bounds that depend on other keys (a margin on the least one, a start on `[bounds]`) are the reader's alone.

use std::f64::consts::{PI, TAU};

use serde_json::{Map, Value, json};

/// A range of numbers: of the key itself, or of all numbers in its list.
struct Range {
    /// The type, and the key in it.
    key: (&'static str, &'static str),
    /// A key under which the number is in a problem: what the test writes.
    #[cfg(test)]
    at: &'static str,
    least: Option<f64>,
    /// The least value is not among them.
    is_open: bool,
    most: Option<f64>,
}

/// One entry of [`RANGES`]; `open` leaves the least value out.
macro_rules! range {
    ($type:literal, $key:literal, $at:literal, open $least:expr, $most:expr) => {
        Range {
            key: ($type, $key),
            #[cfg(test)]
            at: $at,
            least: Some($least),
            is_open: true,
            most: $most,
        }
    };
    ($type:literal, $key:literal, $at:literal, $least:expr, $most:expr) => {
        Range {
            key: ($type, $key),
            #[cfg(test)]
            at: $at,
            least: Some($least),
            is_open: false,
            most: $most,
        }
    };
}

/// Smallest size of a body, metres.
const SIZE: f64 = 1e-6;

/// What the contact margin is at least, metres; no other margin but that of edges is less than it.
const LEAST_MARGIN: f64 = 1e-4;

const RANGES: &[Range] = &[
    range!("ProblemFile", "version", "version", 1.0, Some(1.0)),
    range!("Object", "mass_kg", "object.0.mass_kg", open 0.0, None),
    range!("Object", "yaw", "object.0.yaw", -TAU, Some(TAU)),
    range!("Object", "max_tilt_deg", "object.0.max_tilt_deg", 0.0, Some(180.0)),
    range!("Friction", "table", "object.0.friction.table", 0.0, Some(2.0)),
    range!("Friction", "fingers", "object.0.friction.fingers", 0.0, Some(2.0)),
    range!("PlateRim", "slope_deg", "object.1.shape.plate.rim.slope_deg", 0.0, Some(45.0)),
    range!("PlateRim", "width_m", "object.1.shape.plate.rim.width_m", SIZE, None),
    range!("PlateRim", "thickness_m", "object.1.shape.plate.rim.thickness_m", SIZE, None),
    range!("RimGrasp", "tilts_deg", "object.0.rim.tilts_deg", -90.0, Some(90.0)),
    range!("RimGrasp", "azimuths", "object.0.rim.azimuths", 1.0, Some(3600.0)),
    range!("RimGrasp", "insertion_m", "object.0.rim.insertion_m", 0.0, Some(1.0)),
    range!("RimGrasp", "opening_m", "object.0.rim.opening_m", 0.0, Some(0.09)),
    range!("RimGrasp", "lift_m", "object.0.rim.lift_m", 0.0, Some(1.0)),
    range!("OverheadGrasp", "tilts_deg", "object.0.overhead.tilts_deg", -90.0, Some(90.0)),
    range!("OverheadGrasp", "azimuths", "object.0.overhead.azimuths", 1.0, Some(3600.0)),
    range!("OverheadGrasp", "opening_m", "object.0.overhead.opening_m", 0.0, Some(0.09)),
    range!("OverheadGrasp", "lift_m", "object.0.overhead.lift_m", 0.0, Some(1.0)),
    range!("SideGrasp", "tilts_deg", "object.0.side.tilts_deg", -90.0, Some(90.0)),
    range!("SideGrasp", "azimuths", "object.0.side.azimuths", 1.0, Some(3600.0)),
    range!("SideGrasp", "insertion_m", "object.0.side.insertion_m", 0.0, Some(1.0)),
    range!("SideGrasp", "opening_m", "object.0.side.opening_m", 0.0, Some(0.09)),
    range!("SideGrasp", "lift_m", "object.0.side.lift_m", 0.0, Some(1.0)),
    range!("LengthRange", "", "object.0.side.approach_m", 0.0, Some(1.0)),
    range!("Obstacle", "yaw", "obstacle.1.yaw", -TAU, Some(TAU)),
    range!("Obstacle", "rpy", "obstacle.2.rpy", -TAU, Some(TAU)),
    range!("ObjectGoal", "tolerance_m", "goal.object.0.tolerance_m", 1e-6, Some(1.0)),
    range!("ObjectGoal", "yaw", "goal.object.0.yaw", -TAU, Some(TAU)),
    range!("ObjectGoal", "yaw_tolerance", "goal.object.0.yaw_tolerance", 1e-6, Some(PI)),
    range!("RobotGoal", "tolerance_m", "goal.robot.tolerance_m", 1e-6, Some(1.0)),
    range!("RobotGoal", "tolerance_rad", "goal.robot.tolerance_rad", 1e-6, Some(PI)),
    range!("ToolGoal", "rpy", "goal.robot.tool.rpy", -TAU, Some(TAU)),
    range!("Push", "gap_m", "push.gap_m", open 0.0, Some(0.09)),
    range!("Push", "leans_deg", "push.leans_deg", 0.0, Some(75.0)),
    range!("Push", "max_turn_deg", "push.max_turn_deg", 0.0, Some(120.0)),
    range!("Push", "fingertip_clearance_m", "push.fingertip_clearance_m", 0.0, Some(1.0)),
    range!("Push", "position_error_m", "push.position_error_m", 0.0, Some(1.0)),
    range!("Push", "edge_distance_m", "push.edge_distance_m", 0.0, Some(1.0)),
    range!("Safety", "robot_margin_m", "safety.robot_margin_m", LEAST_MARGIN, Some(0.5)),
    range!("Safety", "held_margin_m", "safety.held_margin_m", LEAST_MARGIN, Some(0.5)),
    range!("Safety", "object_margin_m", "safety.object_margin_m", LEAST_MARGIN, Some(0.5)),
    range!("Safety", "least_margin_m", "safety.least_margin_m", LEAST_MARGIN, Some(0.5)),
    range!("Safety", "contact_margin_m", "safety.contact_margin_m", LEAST_MARGIN, Some(0.5)),
    range!("Safety", "edge_margin_m", "safety.edge_margin_m", 0.0, Some(0.5)),
    range!("Sampling", "object_share", "sampling.object_share", 0.0, Some(1.0)),
    range!("Sampling", "goal_bias", "sampling.goal_bias", 0.0, Some(1.0)),
    range!("Sampling", "base_only_share", "sampling.base_only_share", 0.0, Some(1.0)),
    range!("Sampling", "edge_share", "sampling.edge_share", 0.0, Some(0.9)),
    range!("Budget", "time_limit_s", "budget.time_limit_s", open 0.0, None),
    range!("Budget", "iterations", "budget.iterations", 1.0, None),
    range!("Budget", "nodes", "budget.nodes", 1.0, None),
    range!("Budget", "restart_iterations", "budget.restart_iterations", 1.0, None),
    range!("Steer", "from_deg", "steer.0.from_deg", -360.0, Some(360.0)),
];

/// Sizes of bodies: the kind of shape, and the key.
const SIZES: &[(&str, &str)] = &[
    ("box", "size"),
    ("sphere", "radius"),
    ("cylinder", "radius"),
    ("cylinder", "height"),
    ("capsule", "radius"),
    ("capsule", "height"),
    ("bowl", "radius"),
    ("bowl", "height"),
    ("bowl", "wall"),
    ("plate", "radius"),
    ("plate", "height"),
    ("mesh", "scale"),
];

/// How many entries lists have: the type, the key, least and most.
const COUNTS: &[(&str, &str, usize, usize)] = &[
    ("ProblemFile", "primitives", 1, 64),
    ("ProblemFile", "object", 1, 64),
    ("ProblemFile", "obstacle", 0, 10_000),
    ("ProblemFile", "steer", 0, 64),
    ("Goal", "object", 0, 1000),
    ("RimGrasp", "tilts_deg", 1, 64),
    ("OverheadGrasp", "tilts_deg", 1, 64),
    ("SideGrasp", "tilts_deg", 1, 64),
    ("Push", "leans_deg", 1, 16),
    ("Place", "approach_directions", 1, 64),
    ("Transit", "postures", 0, 64),
    ("Surface", "polygon", 3, 512),
];

/// Where the yaw of a base is the third number.
const BASES: [&str; 2] = ["Robot", "RobotGoal"];

/// Writes the bounds into a schema that holds that of a problem file; leaves any other one alone.
pub(crate) fn write(schema: &mut Value) {
    let is_problem = schema.get("title").and_then(Value::as_str) == Some("ProblemFile");
    if !is_problem && schema.pointer("/$defs/ProblemFile").is_none() {
        return;
    }
    let of_type =
        |name: &str| if is_problem && name == "ProblemFile" { String::new() } else { format!("/$defs/{name}") };
    let property = |name: &str, key: &str| format!("{}/properties/{key}", of_type(name));
    for range in RANGES {
        let (name, key) = range.key;
        let pointer = if key.is_empty() { of_type(name) } else { property(name, key) };
        if let Some(schema) = schema.pointer_mut(&pointer) {
            each_number(schema, &mut |number| range.write(number));
        }
    }
    let shapes = schema.pointer_mut("/$defs/ShapeSpec/oneOf").and_then(Value::as_array_mut);
    for shape in shapes.into_iter().flatten() {
        for (kind, key) in SIZES {
            if let Some(size) = shape.pointer_mut(&format!("/properties/{kind}/properties/{key}")) {
                each_number(size, &mut |number| drop(number.insert("minimum".to_owned(), json!(SIZE))));
            }
        }
        if let Some(points) = shape.pointer_mut("/properties/hull/properties/points").and_then(Value::as_object_mut) {
            points.insert("minItems".to_owned(), json!(4));
            points.insert("maxItems".to_owned(), json!(10_000));
        }
    }
    for (name, key, least, most) in COUNTS {
        if let Some(list) = schema.pointer_mut(&property(name, key)).and_then(Value::as_object_mut) {
            list.insert("minItems".to_owned(), json!(least));
            list.insert("maxItems".to_owned(), json!(most));
        }
    }
    for name in BASES {
        if let Some(base) = schema.pointer_mut(&property(name, "base")).and_then(Value::as_object_mut) {
            let number = json!({ "type": "number" });
            let yaw = json!({ "type": "number", "minimum": -TAU, "maximum": TAU });
            base.insert("prefixItems".to_owned(), json!([number, number, yaw]));
        }
    }
    if let Some(goal) = schema.pointer_mut("/$defs/ObjectGoal").and_then(Value::as_object_mut) {
        let given = |key: &str| json!({ "required": [key] });
        goal.insert("anyOf".to_owned(), json!([given("on"), given("position")]));
    }
}

impl Range {
    fn write(&self, number: &mut Map<String, Value>) {
        let is_integer = number.get("format").and_then(Value::as_str).is_some_and(|format| format.starts_with("uint"));
        #[expect(clippy::cast_possible_truncation, reason = "the bounds of counts are small whole numbers")]
        let shown = |bound: f64| if is_integer { json!(bound as i64) } else { json!(bound) };
        if let Some(least) = self.least {
            let key = if self.is_open { "exclusiveMinimum" } else { "minimum" };
            number.insert(key.to_owned(), shown(least));
        }
        if let Some(most) = self.most {
            number.insert("maximum".to_owned(), shown(most));
        }
    }
}

/// Visits the schema of a number, or of all numbers in a list, or in alternatives.
fn each_number(schema: &mut Value, visit: &mut dyn FnMut(&mut Map<String, Value>)) {
    let Value::Object(schema) = schema else { return };
    let is_number =
        ["double", "uint32", "uint64"].contains(&schema.get("format").and_then(Value::as_str).unwrap_or(""));
    if is_number {
        visit(schema);
        return;
    }
    if let Some(items) = schema.get_mut("items") {
        each_number(items, visit);
    }
    for alternative in schema.get_mut("anyOf").and_then(Value::as_array_mut).into_iter().flatten() {
        each_number(alternative, visit);
    }
}

#[cfg(test)]
mod tests;

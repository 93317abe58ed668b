use super::*;
use crate::problem_file::ProblemFile;
use crate::schema::schema;

/// A problem that has every key of the table.
const FULL: &str = r#"
format = "darrt-problem"
version = 1
name = "full"
primitives = ["Base-Transit", "Pick"]
[robot]
base = [-1.0, 0.0, 0.0]
[[obstacle]]
name = "table"
shape = { box = { size = [0.8, 0.8, 0.7] } }
at = [0.0, 0.0, 0.35]
[[obstacle]]
name = "cup"
shape = { cylinder = { radius = 0.04, height = 0.1 } }
standing_on = "table"
at = [0.2, 0.2]
yaw = 0.5
[[obstacle]]
name = "sign"
shape = { sphere = { radius = 0.1 } }
at = [2, 2, 2]
rpy = [0.1, 0.2, 0.3]
[[surface]]
name = "table"
top_of = "table"
[[object]]
name = "mug"
shape = { cylinder = { radius = 0.04, height = 0.1 } }
on = "table"
at = [0.0, 0.0]
yaw = 0.1
mass_kg = 0.3
max_tilt_deg = 20.0
friction = { table = 0.3, fingers = 0.4 }
rim = { tilts_deg = [0.0], azimuths = 24, insertion_m = 0.04, opening_m = 0.06, lift_m = 0.1 }
overhead = { tilts_deg = [0.0], azimuths = 24, opening_m = 0.06, lift_m = 0.1 }
side = { tilts_deg = [0.0], azimuths = 24, insertion_m = 0.04, opening_m = 0.06, lift_m = 0.1, approach_m = [0.1, 0.2] }
[[object]]
name = "dish"
shape = { plate = { radius = 0.1, height = 0.02, rim = { slope_deg = 20.0, width_m = 0.02, thickness_m = 0.003 } } }
on = "table"
at = [-0.2, -0.2]
[[goal.object]]
object = "mug"
position = [-1.0, 0.0, 0.9]
tolerance_m = 0.01
yaw = 0.1
yaw_tolerance = 0.1
[goal.robot]
tool = { position = [0.0, 0.0, 1.0], rpy = [0.0, 0.0, 0.0] }
tolerance_m = 0.01
tolerance_rad = 0.01
[push]
gap_m = 0.05
leans_deg = [0.0]
max_turn_deg = 10.0
fingertip_clearance_m = 0.01
position_error_m = 0.01
edge_distance_m = [0.03, 0.08]
[safety]
robot_margin_m = 0.02
held_margin_m = 0.02
object_margin_m = 0.01
least_margin_m = 0.005
contact_margin_m = 0.002
edge_margin_m = 0.03
[sampling]
object_share = 0.5
goal_bias = 0.5
base_only_share = 0.1
edge_share = 0.1
[budget]
time_limit_s = 5.0
iterations = 5
nodes = 5
restart_iterations = 5
[[steer]]
from_deg = [0.0, 10.0]
"#;

/// The entry of a table or list under a key with dots.
fn at<'a>(value: &'a mut toml::Value, key: &str) -> &'a mut toml::Value {
    key.split('.').fold(value, |value, part| match part.parse::<usize>() {
        Ok(index) => &mut value[index],
        Err(_) => &mut value[part],
    })
}

/// Margins of which none may be less than one before it.
const MARGINS: [&str; 5] = ["contact_margin_m", "least_margin_m", "robot_margin_m", "held_margin_m", "object_margin_m"];

/// The problem with a number in the place of another, or of all of a list. Where it is a margin, the others leave it all its room.
fn with(key: &str, number: f64) -> toml::Value {
    let mut problem: toml::Value = toml::from_str(FULL).unwrap();
    let place = key.strip_prefix("safety.").and_then(|key| MARGINS.iter().position(|other| *other == key));
    if let Some(place) = place {
        for (other, name) in MARGINS.iter().enumerate() {
            let margin = if other < place.min(2) { LEAST_MARGIN } else { 0.5 };
            *at(&mut problem, &format!("safety.{name}")) = toml::Value::Float(margin);
        }
    }
    let slot = at(&mut problem, key);
    let written = |old: &toml::Value| match old {
        #[expect(clippy::cast_possible_truncation, reason = "the test gives whole numbers where these belong")]
        toml::Value::Integer(_) => toml::Value::Integer(number as i64),
        _ => toml::Value::Float(number),
    };
    match slot {
        toml::Value::Array(numbers) => numbers.iter_mut().for_each(|old| *old = written(old)),
        old => *old = written(old),
    }
    problem
}

fn is_read(problem: &toml::Value) -> bool {
    ProblemFile::from_toml(&toml::to_string(problem).unwrap(), "full").is_ok()
}

/// Does a schema of a number allow it?
fn allows(schema: &Value, number: f64) -> bool {
    let bound = |key: &str| schema.get(key).and_then(Value::as_f64);
    bound("minimum").is_none_or(|least| number >= least)
        && bound("exclusiveMinimum").is_none_or(|least| number > least)
        && bound("maximum").is_none_or(|most| number <= most)
}

#[test]
fn the_problem_with_every_key_is_read() {
    ProblemFile::from_toml(FULL, "full").unwrap();
}

/// At every bound, a little within and beyond it, and far beyond: what the schema allows is read, and nothing else.
#[test]
fn schema_and_reader_have_the_same_ranges() {
    let mut whole = schema::<ProblemFile>();
    for range in RANGES {
        let (name, key) = range.key;
        let is_integer = at(&mut toml::from_str(FULL).unwrap(), range.at).is_integer();
        let step = |bound: f64| if is_integer { 1.0 } else { 1e-9 * bound.abs().max(1e-3) };
        let mut numbers = Vec::new();
        for bound in [range.least, range.most].into_iter().flatten() {
            numbers.extend([bound, bound - step(bound), bound + step(bound)]);
        }
        if !is_integer {
            numbers.extend([-1e5, 1e5, -1.0]);
        }
        let pointer = match (name, key) {
            ("ProblemFile", key) => format!("/properties/{key}"),
            (name, "") => format!("/$defs/{name}"),
            (name, key) => format!("/$defs/{name}/properties/{key}"),
        };
        let mut schemas = Vec::new();
        if let Some(schema) = whole.pointer_mut(&pointer) {
            each_number(schema, &mut |number| schemas.push(Value::Object(number.clone())));
        }
        assert!(!schemas.is_empty(), "{pointer} is no number of the schema");
        for number in numbers.into_iter().filter(|number| !is_integer || *number >= 0.0) {
            let is_allowed = schemas.iter().all(|schema| allows(schema, number));
            let is_read = is_read(&with(range.at, number));
            // A rim that is too wide or thick for its plate is the reader's to refuse.
            let is_between = name == "PlateRim" && number > 0.01;
            assert!(
                is_allowed == is_read || is_between && !is_read,
                "{} = {number}: schema {is_allowed}, reader {is_read}",
                range.at
            );
        }
    }
}

#[test]
fn schema_and_reader_have_the_same_counts() {
    let whole = schema::<ProblemFile>();
    let list =
        |key: &str| toml::from_str::<toml::Value>(FULL).map(|mut problem| at(&mut problem, key).clone()).unwrap();
    for (name, key, place) in [
        ("RimGrasp", "tilts_deg", "object.0.rim.tilts_deg"),
        ("OverheadGrasp", "tilts_deg", "object.0.overhead.tilts_deg"),
        ("SideGrasp", "tilts_deg", "object.0.side.tilts_deg"),
        ("Push", "leans_deg", "push.leans_deg"),
    ] {
        let (.., least, most) = COUNTS.iter().find(|count| (count.0, count.1) == (name, key)).unwrap();
        let told = &whole["$defs"][name]["properties"][key];
        assert_eq!((told["minItems"].as_u64(), told["maxItems"].as_u64()), (Some(*least as u64), Some(*most as u64)));
        let first = list(place)[0].clone();
        for count in [0, 1, *most, most + 1] {
            let mut problem: toml::Value = toml::from_str(FULL).unwrap();
            *at(&mut problem, place) = toml::Value::Array(vec![first.clone(); count]);
            assert_eq!(is_read(&problem), (*least..=*most).contains(&count), "{place} with {count} entries");
        }
    }
    let mut problem: toml::Value = toml::from_str(FULL).unwrap();
    *at(&mut problem, "primitives") = toml::Value::Array(Vec::new());
    assert!(!is_read(&problem) && whole["properties"]["primitives"]["minItems"] == 1);
    let mut problem: toml::Value = toml::from_str(FULL).unwrap();
    *at(&mut problem, "object") = toml::Value::Array(Vec::new());
    assert!(!is_read(&problem) && whole["properties"]["object"]["minItems"] == 1);
}

#[test]
fn sizes_of_bodies_are_positive_in_both() {
    let whole = schema::<ProblemFile>();
    let shapes = whole["$defs"]["ShapeSpec"]["oneOf"].as_array().unwrap();
    for (kind, key) in SIZES {
        let size = shapes.iter().find_map(|shape| shape["properties"].get(kind)).map(|shape| &shape["properties"][key]);
        let size = size.unwrap();
        let number = if size["items"].is_object() { &size["items"] } else { size };
        assert_eq!(number["minimum"].as_f64(), Some(SIZE), "{kind}.{key}");
    }
    let radius = |value: f64| {
        let mut problem: toml::Value = toml::from_str(FULL).unwrap();
        *at(&mut problem, "obstacle.2.shape.sphere.radius") = toml::Value::Float(value);
        is_read(&problem)
    };
    assert!(radius(SIZE) && !radius(0.5 * SIZE) && !radius(-1.0));
    // A base turned by more than a turn, and a goal without a place.
    let mut problem: toml::Value = toml::from_str(FULL).unwrap();
    *at(&mut problem, "robot.base.2") = toml::Value::Float(90.0);
    assert!(!is_read(&problem));
    assert_eq!(whole["$defs"]["Robot"]["properties"]["base"]["prefixItems"][2]["maximum"].as_f64(), Some(TAU));
    let mut problem: toml::Value = toml::from_str(FULL).unwrap();
    at(&mut problem, "goal.object.0").as_table_mut().unwrap().remove("position");
    assert!(!is_read(&problem) && whole["$defs"]["ObjectGoal"]["anyOf"].is_array());
}

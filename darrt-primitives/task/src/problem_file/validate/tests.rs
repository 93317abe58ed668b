use crate::problem_file::ProblemFile;
use crate::testing::{builtin_text, registry};

/// The smallest problem that exercises every section.
const SMALL: &str = r#"
format = "darrt-problem"
version = 1
name = "small"
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
[[surface]]
name = "table"
top_of = "table"
[[object]]
name = "plate"
shape = { cylinder = { radius = 0.14, height = 0.02 } }
on = "table"
at = [0.0, 0.0]
[[goal.object]]
object = "plate"
position = [-1.0, 0.0, 0.9]
"#;

/// Replaces `old` by `new` in [`SMALL`] and checks that the error holds every part.
fn refused(old: &str, new: &str, parts: &[&str]) {
    assert!(SMALL.contains(old), "the test replaces `{old}`, which is not there");
    let read = ProblemFile::from_toml(&SMALL.replacen(old, new, 1), "small.toml");
    let message = read.and_then(|problem| registry().check(&problem, "small.toml")).unwrap_err().to_string();
    for part in ["small.toml"].iter().chain(parts) {
        assert!(message.contains(part), "`{part}` is missing from: {message}");
    }
}

/// Adds `more` at the end.
fn refused_more(more: &str, parts: &[&str]) {
    refused("position = [-1.0, 0.0, 0.9]\n", &format!("position = [-1.0, 0.0, 0.9]\n{more}\n"), parts);
}

#[test]
fn the_small_problem_is_valid() {
    ProblemFile::from_toml(SMALL, "small.toml").unwrap();
}

#[test]
fn unknown_keys_and_values_give_the_nearest() {
    refused("version = 1", "version = 1\ntitel = \"x\"", &["small.toml:4:1: at `titel`: ", "did you mean `title`?"]);
    refused("size = [", "sise = [", &["at `obstacle[0].shape.box.sise`", "did you mean `size`?"]);
    refused("{ box =", "{ boks =", &["boks", "did you mean `box`?"]);
    refused("\"Pick\"", "\"Pik\"", &["`primitives[1]`", "Pik", "did you mean `Pick`?"]);
    refused("\"Pick\"", "\"Push-Pull\"", &["Push-Pull", "did you mean `Push`?"]);
    refused("[robot]", "[robott]", &["robott", "did you mean `robot`?"]);
    refused("[robot]", "[robot]\nlimits = \"hart\"", &["hart", "did you mean `hard`?"]);
    refused_more("[sampling]\nsampler = \"robot-or-object\"", &["did you mean `robot-or-objects`?"]);
    refused_more("[sampling]\ndistance = \"greedi\"", &["greedi", "did you mean `greedy`?"]);
    refused_more("[push]\nedge_rule = \"line\"", &["did you mean `line-crossing`?"]);
    refused("darrt-problem", "dart-problem", &["dart-problem", "did you mean `darrt-problem`?"]);
}

#[test]
fn names_that_refer_to_nothing_give_the_nearest() {
    refused(
        "on = \"table\"\nat = [0.0",
        "on = \"tabel\"\nat = [0.0",
        &["`object[0].on`", "tabel", "did you mean `table`?"],
    );
    refused("standing_on = \"table\"", "standing_on = \"tables\"", &["`obstacle[1].standing_on`", "surface `tables`"]);
    refused("top_of = \"table\"", "top_of = \"tablet\"", &["`surface[0].top_of`", "obstacle `tablet`"]);
    refused("object = \"plate\"", "object = \"plat\"", &["`goal.object[0].object`", "did you mean `plate`?"]);
    refused("[robot]", "[robot]\nposture = \"sides\"", &["`robot.posture`", "sides", "did you mean `side`?", "tucked"]);
    refused_more("[transit]\npostures = [\"upp\"]", &["`transit.postures[0]`", "did you mean `up`?"]);
}

#[test]
fn names_are_unique_and_not_empty() {
    refused("name = \"cup\"", "name = \"table\"", &["`obstacle[1].name`", "`table`", "already taken by `obstacle[0]`"]);
    refused("name = \"plate\"", "name = \"cup\"", &["`object[0].name`", "`obstacle[1]`"]);
    refused("name = \"cup\"", "name = \"floor\"", &["`floor`", "already taken"]);
    refused("name = \"cup\"", "name = \"\"", &["`obstacle[1].name`", "0 entries"]);
    refused("\"Pick\"]", "\"Pick\", \"Pick\"]", &["`primitives[2]`", "`primitives[1]`"]);
}

#[test]
fn numbers_are_finite() {
    refused("base = [-1.0", "base = [nan", &["`robot.base[0]`", "NaN", "finite"]);
    refused("size = [0.8", "size = [inf", &["`obstacle[0].shape.box.size[0]`", "inf", "finite"]);
    refused("position = [-1.0", "position = [1e300", &["`goal.object[0].position[0]`", "1000000"]);
}

#[test]
fn lengths_are_positive() {
    refused("size = [0.8", "size = [-0.8", &["`obstacle[0].shape.box.size[0]`", "-0.8", "positive"]);
    refused("radius = 0.04", "radius = 0.0", &["`obstacle[1].shape.cylinder.radius`", "is 0", "positive"]);
    let capsule = "capsule = { radius = 0.1, height = 0.15 }";
    refused("cylinder = { radius = 0.04, height = 0.1 }", capsule, &["capsule.height", "0.15", "0.2"]);
    let bowl = "bowl = { radius = 0.1, height = 0.1, wall = 0.1 }";
    refused("cylinder = { radius = 0.04, height = 0.1 }", bowl, &["bowl.wall", "less than the radius, 0.1"]);
    let plate = |slope: f64, width: f64, height: f64| {
        format!(
            "plate = {{ radius = 0.1, height = {height}, rim = {{ slope_deg = {slope}, width_m = {width}, thickness_m = 0.005 }} }}"
        )
    };
    let cylinder = "cylinder = { radius = 0.04, height = 0.1 }";
    refused(cylinder, &plate(50.0, 0.03, 0.03), &["plate.rim.slope_deg", "is 50"]);
    refused(cylinder, &plate(15.0, 0.1, 0.03), &["plate.rim.width_m", "less than the radius, 0.1"]);
    refused(cylinder, &plate(30.0, 0.04, 0.024), &["plate.height", "at least the height of its rim, 0.0243"]);
    let hull = "hull = { points = [[0,0,0],[1,0,0],[0,1,0]] }";
    refused("cylinder = { radius = 0.04, height = 0.1 }", hull, &["hull.points", "has 3 entries", "4 to 10000"]);
    refused("at = [0.0, 0.0]\n[[goal", "at = [0.0, 0.0]\nmass_kg = -1\n[[goal", &["`object[0].mass_kg`", "-1"]);
}

#[test]
fn quaternions_are_unit_and_alone() {
    refused(
        "at = [0.0, 0.0, 0.35]",
        "at = [0.0, 0.0, 0.35]\nquaternion = [0, 0, 0, 2]",
        &["`obstacle[0].quaternion`", "norm 2", "0.001"],
    );
    refused(
        "at = [0.0, 0.0, 0.35]",
        "at = [0.0, 0.0, 0.35]\nyaw = 0\nrpy = [0, 0, 0]",
        &["`obstacle[0]`", "at most one of", "`yaw`, `rpy`"],
    );
    refused(
        "at = [0.0, 0.0, 0.35]",
        "at = [0.0, 0.0, 0.35]\nrpy = [0.1, 0, 0]",
        &["`surface[0]`", "leans 5.7", "level"],
    );
    refused("at = [0.2, 0.2]", "at = [0.2, 0.2]\nrpy = [0.1, 0, 0]", &["`obstacle[1]`", "only be turned by `yaw`"]);
}

#[test]
fn ranges_and_shares_are_bounded() {
    refused_more("[bounds]\nbase_x = [1, -1]", &["`bounds.base_x`", "[1, -1]"]);
    refused_more("[bounds]\nbase_x = [0, 1]", &["`robot.base[0]`", "-1", "`bounds.base_x` = [0, 1]"]);
    refused_more("[bounds]\nobject_z = [0, 0.5]", &["position[2]", "0.9", "`bounds.object_z` = [0, 0.5]"]);
    refused_more("[bounds]\nobject_x = [-2, -0.5]", &["`object[0].at[0]`", "`bounds.object_x`"]);
    refused_more("[sampling]\nobject_share = 1.5", &["`sampling.object_share`", "1.5", "[0, 1]"]);
    refused_more("[sampling]\ngoal_bias = -0.1", &["`sampling.goal_bias`", "-0.1", "[0, 1]"]);
    refused_more("[sampling]\nedge_share = 1.0", &["`sampling.edge_share`", "1", "[0, 0.9]"]);
    refused_more("[budget]\ntime_limit_s = 0", &["`budget.time_limit_s`", "greater than 0"]);
    refused_more("[budget]\nnodes = 0", &["`budget.nodes`", "greater than 0"]);
    refused_more("[push]\nedge_distance_m = [0.1, 0.05]", &["`push.edge_distance_m`", "[0.1, 0.05]"]);
    refused_more("[push]\ngap_m = 0.2", &["`push.gap_m`", "0.2", "[0, 0.09]"]);
    refused_more("[place]\napproach_directions = [[0, 0, 1]]", &["approach_directions[0][2]", "from above"]);
    refused("version = 1", "version = 2\ncolour = 3", &["`version`", "is 2", "newer than what this program reads"]);
    refused(
        "size = [0.8, 0.8, 0.7]",
        "size = [0.8, 0.8, 0.7, 1]",
        &["`obstacle[0].shape.box.size`", "has 4 entries", "3"],
    );
    refused("at = [0.0, 0.0]\n[[goal", "at = [0.0, 0.0, 0.7]\n[[goal", &["`object[0].at`", "has 3 entries", "2"]);
}

#[test]
fn starts_are_complete_and_single() {
    let both = "[robot]\nposture = \"side\"\njoints = [0, 0, 0, 0, 0, 0, 0]";
    refused("[robot]", both, &["at most one of `posture`, `joints`"]);
    refused("base = [-1.0, 0.0, 0.0]", "", &[":6:1: at `robot`: missing field `base`"]);
    refused("at = [0.2, 0.2]", "at = [0.2, 0.2, 0.7]", &["`obstacle[1].at`", "has 3 entries", "must have 2"]);
}

#[test]
fn things_stand_on_their_surfaces() {
    refused("at = [0.0, 0.0]\n[[goal", "at = [0.5, 0.0]\n[[goal", &["`object[0].at`", "plate", "[0.5, 0]", "`table`"]);
    refused("at = [0.2, 0.2]", "at = [0.2, -0.6]", &["`obstacle[1].at`", "cup", "outside the surface `table`"]);
    let goal = "on = \"table\"\nat = [0.0, 9.0]";
    refused("position = [-1.0, 0.0, 0.9]", goal, &["`goal.object[0].at`", "8.6 m outside"]);
    let region = "on = \"table\"\nregion = { min = [0.1, 0], max = [0, 0] }";
    refused("position = [-1.0, 0.0, 0.9]", region, &["region, x", "[0.1, 0]"]);
    let circle = "top_of = \"cup\"";
    refused("top_of = \"table\"", circle, &["`surface[0].top_of`", "a cylinder", "only a box"]);
    let stacked = "shape = { box = { size = [1, 1, 1] } }\nstanding_on = \"table\"\nat = [0, 0]";
    let below = "shape = { box = { size = [0.8, 0.8, 0.7] } }\nat = [0.0, 0.0, 0.35]";
    refused(below, stacked, &["stands on itself"]);
    let bow_tie = "polygon = [[0,0],[1,1],[1,0],[0,2]]\nz = 1\nbody = \"table\"";
    refused("top_of = \"table\"", bow_tie, &["`surface[0]`", "touch or cross"]);
    refused("top_of = \"table\"", "polygon = [[0,0],[1,1],[1,0]]", &["`surface[0]`", "height `z`"]);
    refused("top_of = \"table\"", "polygon = [[0,0],[1,1],[1,0]]\nz = 1", &["`surface[0]`", "needs `body`"]);
}

#[test]
fn degrees_are_not_taken_for_radians() {
    for (old, new, key) in [
        ("at = [0.0, 0.0]\n[[goal", "at = [0.0, 0.0]\nyaw = 45\n[[goal", "`object[0].yaw`"),
        ("at = [0.0, 0.0, 0.35]", "at = [0.0, 0.0, 0.35]\nrpy = [0, 0, 90]", "`obstacle[0].rpy[2]`"),
        ("at = [0.2, 0.2]", "at = [0.2, 0.2]\nyaw = -180", "`obstacle[1].yaw`"),
    ] {
        refused(old, new, &[key, "radians"]);
    }
    refused_more("yaw = 90", &["`goal.object[0].yaw`", "radians"]);
}

#[test]
fn addresses_are_no_paths() {
    let mesh = "shape = { mesh = { file = \"package://cups/cup.stl\" } }";
    let cup = "shape = { cylinder = { radius = 0.04, height = 0.1 } }";
    refused(cup, mesh, &["`obstacle[1].shape.mesh.file`", "package://cups/cup.stl", "relative to the folder"]);
}

#[test]
fn tables_are_not_given_as_lists() {
    for (list, key) in [("friction = [0.3, 0.4]", "`object[0].friction`"), ("rim = []", "`object[0].rim`")] {
        let with = format!("at = [0.0, 0.0]\n{list}\n[[goal");
        refused("at = [0.0, 0.0]\n[[goal", &with, &[key, "must be a table"]);
    }
}

#[test]
fn goals_are_clear() {
    let both = "position = [-1.0, 0.0, 0.9]\non = \"table\"\nat = [0, 0]";
    refused("position = [-1.0, 0.0, 0.9]", both, &["`goal.object[0]`", "either `on`, alone or with one of"]);
    refused_more("state = \"released\"", &["`goal.object[0].state`", "off every surface"]);
    let held = "on = \"table\"\nstate = \"held\"";
    refused("position = [-1.0, 0.0, 0.9]", held, &["`goal.object[0].state`", "on no surface", "`position`"]);
    refused_more("tolerance_m = 0", &["`goal.object[0].tolerance_m`", "is 0"]);
    refused_more("yaw_tolerance = 4", &["`goal.object[0].yaw_tolerance`", "is 4"]);
    let elsewhere = "at = [0.0, 0.0]\nsurfaces = []\n[[goal";
    refused("at = [0.0, 0.0]\n[[goal", elsewhere, &["`object[0].surfaces`", "does not list `table`"]);
    refused(
        "[[goal.object]]\nobject = \"plate\"\nposition = [-1.0, 0.0, 0.9]",
        "[goal]\nobject = []",
        &["`goal.object`", "0 entries"],
    );
}

#[test]
fn only_round_objects_are_pushed_or_taken_by_the_rim() {
    let cylinder = "shape = { cylinder = { radius = 0.14, height = 0.02 } }\non";
    for (key, part) in [
        ("pushable = true", "`object[0].pushable`"),
        ("grasps = [\"rim\"]", "`object[0].grasps`"),
        ("symmetry = \"z\"", "`object[0].symmetry`"),
    ] {
        let cuboid = format!("shape = {{ box = {{ size = [0.1, 0.1, 0.1] }} }}\n{key}\non");
        refused(cylinder, &cuboid, &[part, "round about z", "a box"]);
    }
    refused(cylinder, "shape = { sphere = { radius = 0.1 } }\ngrasps = [\"side\", \"side\"]\non", &["grasps[1]"]);
}

#[test]
fn every_cut_of_an_embedded_file_is_refused_or_valid_without_panic() {
    let text = builtin_text("plate1").unwrap();
    for end in (0..text.len()).step_by(97) {
        let _ = ProblemFile::from_toml(&text[..end], "cut");
    }
}

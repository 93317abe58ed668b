//! The program on bad input: one message with file, key, value and bound, an exit code, no panic, no hang, and nothing
//! written.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

#[path = "bad_input/desk.rs"]
mod desk;
#[path = "bad_input/plans.rs"]
mod plans;

use darrt_pr2::model::URDF;
use desk::Desk;

const GOAL: &str = "on = \"side table\"\nat = [-2.14, -1.09]";
const BASE: &str = "base = [-0.80, 0.0, 0.0]";
const POSTURE: &str = "\nposture = \"side\"";
const BOWL: &str =
    "shape = { box = { size = [0.18, 0.18, 0.09] } }\nstanding_on = \"central table\"\nat = [0.07, 0.05]";

/// Every edit of Plate1 is refused with these parts.
fn all_refused(cases: &[(&str, &str, &[&str])]) {
    let desk = Desk::new();
    for (old, new, parts) in cases {
        desk.problem("bad.toml", &[(old, new)]);
        desk.plan_refused("bad.toml", parts);
    }
}

#[test]
fn what_is_edited_here_is_sound_before() {
    let desk = Desk::new();
    desk.problem("good.toml", &[]);
    let output = desk.run(&["plan", "good.toml", "--iterations", "1"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn missing_files_are_named() {
    let desk = Desk::new();
    desk.refused(&["plan", "missing.toml"], 2, &["missing.toml", "built-in problems: ", "plate1"]);
    desk.refused(&["show", "missing.toml"], 2, &["missing.toml"]);
    desk.refused(&["show", "missing.json"], 2, &["missing.json: cannot be read: "]);
    desk.refused(&["check", "missing.json"], 2, &["missing.json: cannot be read: "]);
    desk.refused(&["plan", ""], 2, &["built-in problems: "]);
}

#[test]
fn malformed_texts_are_refused_with_line_and_column() {
    let desk = Desk::new();
    let texts: [(&str, &[u8], &str); 7] = [
        ("a.toml", b"format = \"darrt-problem\"\nversion = = 1\n", "a.toml:2:"),
        ("b.toml", b"", "b.toml:1:1: missing field `format`"),
        ("c.toml", b"name = \"\xff\"", "c.toml: is not UTF-8 text, the byte at offset 8"),
        ("d.json", b"{\"format\": ", "d.json:1:11: "),
        ("e.json", b"", "e.json:1:0: "),
        ("f.json", b"\xfe{}", "f.json: is not UTF-8 text, the byte at offset 0"),
        ("g.json", b"[1, 2]", "g.json:1:"),
    ];
    for (name, text, part) in texts {
        desk.write(name, text);
        desk.refused(&["show", name], 2, &[part]);
        desk.refused(&[if name.ends_with("toml") { "plan" } else { "check" }, name], 2, &[part]);
    }
}

#[test]
fn unknown_keys_and_names_give_the_nearest() {
    all_refused(&[
        ("mass_kg", "masss_kg", &["at `object[0].masss_kg`", "did you mean `mass_kg`?"]),
        ("[bounds]", "[bound]", &["at `bound`", "did you mean `bounds`?"]),
        ("  \"Place\"", "  \"Plaice\"", &["`primitives[6]`", "Plaice", "did you mean `Place`?"]),
        (POSTURE, "\nposture = \"sides\"", &["`robot.posture`", "`sides`", "did you mean `side`?"]),
        ("\non = \"central table\"", "\non = \"centre table\"", &["`object[0].on`", "did you mean `central table`?"]),
        (GOAL, "on = \"side tabel\"\nat = [0, 0]", &["`goal.object[0].on`", "did you mean `side table`?"]),
        ("object = \"plate\"", "object = \"plat\"", &["`goal.object[0].object`", "did you mean `plate`?"]),
        ("top_of = \"side table\"", "top_of = \"side\"", &["`surface[1].top_of`", "did you mean `side table`?"]),
        ("restart_time_s = 60", "restart_time_s = \"60\"", &["at `paper.restart_time_s`", "string", "f64"]),
        (BASE, "base = [0.0, 0.0]", &["at `robot.base`", "length 2", "length 3"]),
        (BASE, "", &["at `robot`", "missing field `base`"]),
    ]);
}

#[test]
fn numbers_are_finite_positive_and_in_range() {
    all_refused(&[
        (BASE, "base = [nan, 0.0, 0.0]", &["`robot.base[0]`", "NaN", "finite"]),
        (BASE, "base = [0.0, -inf, 0.0]", &["`robot.base[1]`", "-inf", "finite"]),
        (BASE, "base = [0.0, 0.0, 1e999]", &["bad.toml:26:19: at `robot.base[2]`", "overflowed"]),
        (BASE, "base = [-3.5, 0.0, 0.0]", &["`robot.base[0]`", "-3.5", "`bounds.base_x` = [-3, 2.5]"]),
        (BASE, "base = [-0.8, 0.0, 90.0]", &["`robot.base[2]`", "is 90", "radians"]),
        ("torso_m = 0.20", "torso_m = 0.5", &["`robot.torso_m`", "0.5", "[0, 0.33]"]),
        ("size = [0.90, ", "size = [0, ", &["`obstacle[0].shape.box.size[0]`", "is 0", "positive"]),
        ("radius = 0.14", "radius = -0.14", &["`object[0].shape.cylinder.radius`", "-0.14", "positive"]),
        ("mass_kg = 0.5", "mass_kg = 0", &["`object[0].mass_kg`", "is 0", "greater than 0"]),
        ("time_limit_s = 120", "time_limit_s = -1", &["`budget.time_limit_s`", "-1", "greater than 0"]),
        ("tolerance_m = 0.005", "tolerance_m = 0", &["`goal.object[0].tolerance_m`", "is 0", "[0.000001, 1]"]),
        ("goal_bias = 0.2", "goal_bias = 1.5", &["`sampling.goal_bias`", "1.5", "[0, 1]"]),
        ("base_x = [-3.0, 2.5]", "base_x = [2.5, -3.0]", &["`bounds.base_x`", "[2.5, -3]", "lower end"]),
        ("object_z = [0.0, 1.5]", "object_z = [1.5, 0.0]", &["`bounds.object_z`", "[1.5, 0]", "lower end"]),
        ("[0.03, 0.08]", "[0.08, 0.03]", &["`push.edge_distance_m`", "[0.08, 0.03]", "lower end"]),
        (
            "at = [0.0, 0.0, 0.73]",
            "at = [0.0, 0.0, 0.73]\nquaternion = [0, 0, 0, 1.1]",
            &["`obstacle[0].quaternion`", "norm 1.1", "1 within 0.001"],
        ),
        ("version = 1", "version = 7", &["`version`", "is 7"]),
    ]);
}

#[test]
fn starts_are_possible() {
    all_refused(&[
        (POSTURE, "\njoints = [0, 0, 0, 0.2, 0, -1, 0]", &["`r_elbow_flex_joint`", "0.2", "soft", "[-2.1213, -0.15]"]),
        (
            POSTURE,
            "\nposture = \"tucked\"",
            &["`r_elbow_flex_joint`", "-2.124408", "soft", "[-2.1213, -0.15]", "`limits = \"hard\"`"],
        ),
        (
            "other_posture = \"side\"",
            "other_joints = [0, 0, 0, 0.2, 0, 0, 0]",
            &["`l_elbow_flex_joint`", "0.2", "hard", "[-2.3213, 0]"],
        ),
        (POSTURE, "\njoints = [0, 0, 0]", &["`robot.joints`", "3 entries", "must have 7"]),
        (BASE, "base = [-0.2, 0.0, 0.0]", &["the start is not valid: robot against", "torso_lift_link"]),
        (
            "at = [-0.20, 0.05]\ngrasps",
            "at = [0.07, 0.05]\ngrasps",
            &["the start is not valid: object against obstacle: plate and big bowl"],
        ),
        (
            "at = [-0.20, 0.05]\ngrasps",
            "at = [-0.20, 0.75]\ngrasps",
            &["`object[0].at`", "`plate`", "[-0.2, 0.75]", "0.15 m outside", "`central table`"],
        ),
    ]);
}

#[test]
fn grasps_fit_their_object() {
    all_refused(&[
        (
            "[object.rim]",
            "[object.rim]\nopening_m = 0.02",
            &["the grasps of `plate`", "`object[0].rim.opening_m`", "below 0.02, found 0.02"],
        ),
        (
            "grasps = [\"rim\"]",
            "grasps = [\"overhead\"]\noverhead = { insertion_m = 0.01 }",
            &["the grasps of `plate`", "`object[0].overhead.opening_m`", "below 0.05, found 0.28"],
        ),
    ]);
}

#[test]
fn goals_are_possible() {
    all_refused(&[(
        GOAL,
        "on = \"side table\"\nat = [-1.165, -1.115]",
        &["`goal.object[0].at`", "`plate`", "[-1.165, -1.115]", "0.885 m outside", "`side table`"],
    )]);
    let desk = Desk::new();
    let hopeless: [(&str, &str, i32, &[&str]); 4] = [
        ("  \"Straight-Line-Arm-Transit\",\n", "", 2, &["`Pick` is allowed but not `Straight-Line-Arm-Transit`"]),
        (
            GOAL,
            "on = \"central table\"\nat = [0.07, 0.05]",
            6,
            &["the goal of `plate` is blocked: at (0.070, 0.050, 0.760) it touches `big bowl`"],
        ),
        (
            "  \"Place\",\n",
            "",
            6,
            &["the goal of `plate` cannot be reached", "`goal.object[0]`", "`side table`", "`Place` is not among"],
        ),
        (
            "grasps = [\"rim\"]",
            "grasps = []",
            6,
            &["the goal of `plate` cannot be reached", "`goal.object[0]`", "no `grasps` for Pick"],
        ),
    ];
    for (old, new, exit, parts) in hopeless {
        desk.problem("bad.toml", &[(old, new)]);
        desk.plan_hopeless("bad.toml", exit, parts);
    }
}

#[test]
fn large_files_are_refused_by_size_and_deep_ones_by_depth() {
    let desk = Desk::new();
    desk.sparse("large.toml", 150_000_000);
    desk.plan_refused("large.toml", &["150000000", "4194304"]);
    desk.sparse("large.json", 300_000_000);
    for command in ["check", "show"] {
        desk.refused(&[command, "large.json"], 2, &["large.json", "300000000", "268435456"]);
    }
    for (name, key, value) in [
        ("deep.toml", "mesh = ", "["),
        ("tables.toml", "mesh = ", "{a="),
        ("dots.toml", "", "a."),
        ("deep.json", "", "["),
        ("objects.json", "", "{\"a\":"),
    ] {
        desk.write(name, format!("{key}{}", value.repeat(10_000)));
        desk.refused(&["show", name], 2, &[name, ":1:", "nested deeper than 64 levels"]);
    }
    desk.sparse("large.obj", 150_000_000);
    desk.sparse("large.urdf", 150_000_000);
    desk.problem("mesh.toml", &[(BOWL, "shape = { mesh = { file = \"large.obj\" } }\nat = [0, 0, 1]")]);
    desk.plan_refused("mesh.toml", &["`obstacle[10]`", "large.obj", "150000000", "67108864"]);
    desk.problem("robot.toml", &[("model = \"pr2\"", "urdf = \"large.urdf\"")]);
    desk.plan_refused("robot.toml", &["large.urdf", "150000000", "16777216"]);
}

#[test]
fn robot_descriptions_are_checked() {
    let desk = Desk::new();
    desk.problem("robot.toml", &[("model = \"pr2\"", "urdf = \"robot.urdf\"")]);
    let edited = |old: &str, new: &str| {
        assert!(URDF.contains(old), "the test replaces `{old}`, which is not there");
        URDF.replacen(old, new, 1)
    };
    let nested = format!("{}{}", "<a>".repeat(10_000), "</a>".repeat(10_000));
    let cases: [(String, &[&str]); 10] = [
        (String::new(), &["not a robot description"]),
        ("no XML".to_owned(), &["text outside the root element"]),
        (URDF.chars().take(2000).collect(), &["not well-formed at byte"]),
        (nested, &["65 deep", "at most 64"]),
        ("<!DOCTYPE a><robot name='a'/>".to_owned(), &["document type"]),
        ("<robot name='a'><link name='b'/></robot>".to_owned(), &["torso_lift_joint"]),
        (edited("name=\"r_elbow_flex_joint\"", "name=\"r_elbow\""), &["r_elbow_flex_joint"]),
        (edited("lower=\"-2.3213\"", "lower=\"0.5\""), &["elbow_flex_joint", "[0.5, 0]", "wrong order"]),
        (edited("lower=\"-2.3213\"", "lower=\"nan\""), &["elbow_flex_joint", "NaN", "finite"]),
        (edited("<link name=\"r_elbow_flex_link\"", "<link name=\"base_link\""), &["base_link"]),
    ];
    for (text, parts) in cases {
        desk.write("robot.urdf", text);
        let parts: Vec<&str> = ["robot.urdf: "].iter().chain(parts).copied().collect();
        desk.plan_refused("robot.toml", &parts);
    }
    std::fs::remove_file(desk.path("robot.urdf")).unwrap();
    desk.plan_refused("robot.toml", &["robot.urdf: cannot be read: "]);
}

#[test]
fn meshes_are_checked() {
    let desk = Desk::new();
    let cases: [(&str, Option<&[u8]>, &str); 7] = [
        ("none.stl", None, "cannot be read"),
        ("bowl.ply", Some(b""), "`ply`"),
        ("bowl.dae", Some(b""), "not a valid COLLADA"),
        ("cut.stl", Some(b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n"), "not a valid STL"),
        ("nan.obj", Some(b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "NaN"),
        ("flat.obj", Some(b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "triangles with an area"),
        ("far.obj", Some(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), "not a valid OBJ"),
    ];
    for (name, content, part) in cases {
        if let Some(content) = content {
            desk.write(name, content);
        }
        let shape = format!("shape = {{ mesh = {{ file = \"{name}\" }} }}\nat = [0, 0, 1]");
        desk.problem("mesh.toml", &[(BOWL, &shape)]);
        desk.plan_refused("mesh.toml", &["`obstacle[10]`", name, part]);
        desk.refused(&["show", "mesh.toml", "-o", "kept.html"], 2, &["`obstacle[10]`", name, part]);
    }
}

#[test]
fn surfaces_lie_on_their_bodies() {
    let polygon = |z: f64, far: f64, rest: &str| {
        format!("polygon = [[-0.45, -0.6], [{far}, -0.6], [{far}, 0.6], [-0.45, 0.6]]\nz = {z}\n{rest}")
    };
    let body = "body = \"central table top\"";
    let top = "top_of = \"central table top\"";
    let desk = Desk::new();
    desk.problem("good.toml", &[(top, &polygon(0.75, 0.45, body))]);
    assert_eq!(desk.run(&["plan", "good.toml", "--iterations", "1"]).status.code(), Some(1));
    all_refused(&[
        (top, &polygon(0.75, 0.45, ""), &["`surface[0]`", "needs `body`"]),
        (
            top,
            &polygon(0.9, 0.45, body),
            &["`surface[0].z`", "`central table`", "0.9", "`central table top`", "at 0.75", "0.001 m"],
        ),
        (
            top,
            &polygon(0.75, 0.5, body),
            &["`surface[0].polygon[1]`", "[0.5, -0.6]", "`central table`", "0.05 m beside", "`central table top`"],
        ),
    ]);
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let desk = Desk::new();
    desk.problem("good.toml", &[]);
    std::fs::create_dir(desk.path("folder")).unwrap();
    for (place, part) in [
        ("no/such/folder/a.json", "cannot be written: "),
        ("good.toml/a.json", "cannot be written: not a directory"),
        ("folder", "not a regular file"),
        ("folder/", "not a regular file"),
        ("..", "not a regular file"),
    ] {
        desk.refused(&["plan", "good.toml", "-o", place], 4, &[&format!("{place}: "), part]);
    }
    desk.refused(&["show", "good.toml", "-o", "no/such/folder/a.svg"], 4, &["no/such/folder/a.svg"]);
    desk.refused(&["plan", "good.toml", "--picture", "no/a.svg"], 4, &["no/a.svg"]);
    desk.refused(&["plan", "good.toml", "-o", "kept.html", "--picture", "kept.html"], 2, &["kept.html", "both"]);
    desk.refused(&["show", "good.toml", "-o", "a.gif"], 2, &["a.gif", ".html, .svg, .png or .glb"]);
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_and_not_waited_for() {
    let desk = Desk::new();
    for name in ["pipe.toml", "pipe.json", "pipe", "pipe.obj", "pipe.urdf"] {
        desk.pipe(name);
    }
    let cases =
        [("plan", "pipe.toml"), ("show", "pipe.toml"), ("show", "pipe.json"), ("show", "pipe"), ("check", "pipe")];
    for (command, name) in cases.into_iter().chain([("plan", "/dev/zero"), ("check", "/dev/zero")]) {
        desk.refused(&[command, name], 2, &[name, "is not a regular file"]);
    }
    desk.problem("mesh.toml", &[(BOWL, "shape = { mesh = { file = \"pipe.obj\" } }\nat = [0, 0, 1]")]);
    desk.plan_refused("mesh.toml", &["pipe.obj: is not a regular file"]);
    desk.problem("robot.toml", &[("model = \"pr2\"", "urdf = \"pipe.urdf\"")]);
    desk.plan_refused("robot.toml", &["pipe.urdf: is not a regular file"]);
    desk.problem("good.toml", &[]);
    for place in ["pipe.json", "/dev/full"] {
        desk.refused(&["plan", "good.toml", "-o", place], 4, &[place, "not a regular file"]);
    }
}

#[test]
fn results_of_an_earlier_run_survive_a_search_without_success() {
    let desk = Desk::new();
    desk.problem("good.toml", &[]);
    let output =
        desk.run(&["plan", "good.toml", "--iterations", "1", "-o", "kept.json", "--picture", "kept.html", "--quiet"]);
    assert_eq!(output.status.code(), Some(1));
    for name in ["kept.json", "kept.html"] {
        assert_eq!(std::fs::read_to_string(desk.path(name)).unwrap(), desk::KEPT);
    }
}

//! Small problems with one thing about them each, and the verdict that they must have: refused, proven to have no plan, doubted
//! and searched for, or planned. Held on exit code, cause and bodies.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

use std::fmt::Write as _;
use std::path::Path;
use std::process::Output;

use darrt_pr2::model::URDF;

use crate::program::darrt;

const SOLVED: i32 = 0;
const NOT_SOLVED: i32 = 1;
const BAD_INPUT: i32 = 2;
const PARTIAL: i32 = 5;
const IMPOSSIBLE: i32 = 6;

/// A cup on a desk that shall go to another place there.
const CUP: &str = r#"format = "darrt-problem"
version = 1
name = "cup"
primitives = ["Arm-Transit", "Straight-Line-Arm-Transit", "Arm-Rigid-Transfer", "Base-Transit", "Base-Rigid-Transfer",
    "Pick", "Place", "Push"]
[robot]
base = [-1.05, 0.0, 0.0]
[[obstacle]]
name = "desk"
shape = { box = { size = [0.9, 1.1, 0.7] } }
at = [0.0, 0.0, 0.35]
[[surface]]
name = "desk"
top_of = "desk"
[[object]]
name = "cup"
shape = { cylinder = { radius = 0.04, height = 0.09 } }
on = "desk"
at = [-0.3, 0.15]
grasps = ["side"]
[[goal.object]]
object = "cup"
on = "desk"
at = [-0.3, -0.25]
"#;

/// The cup's place and its goal, to be replaced.
const START: &str = "at = [-0.3, 0.15]";
const GOAL: &str = "on = \"desk\"\nat = [-0.3, -0.25]";
const ROUND: &str = "shape = { cylinder = { radius = 0.04, height = 0.09 } }";

/// [`CUP`] with edits, each a text that is there and what takes its place, and more at its end.
fn cup(edits: &[(&str, &str)], more: &str) -> String {
    let mut text = CUP.to_owned();
    for (old, new) in edits {
        assert!(text.contains(old), "`{old}` is not there");
        text = text.replacen(old, new, 1);
    }
    text + more
}

fn block(name: &str, size: [f64; 3], at: [f64; 3]) -> String {
    format!("[[obstacle]]\nname = \"{name}\"\nshape = {{ box = {{ size = {size:?} }} }}\nat = {at:?}\n")
}

struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.0.path().join(name), content).unwrap();
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    /// Plans with at most so many iterations; the exit code and all that was said.
    fn plan(&self, problem: &str, iterations: u32) -> (i32, String) {
        self.write("p.toml", problem);
        let limit = iterations.to_string();
        let output =
            self.run(&["plan", "p.toml", "--iterations", &limit, "--time-limit", "60", "--no-picture", "-o", "o.json"]);
        verdict(&output)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        darrt(self.path(), arguments)
    }
}

fn verdict(output: &Output) -> (i32, String) {
    let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    assert!(!said.contains("panicked"), "{said}");
    (output.status.code().unwrap(), said)
}

/// The problem ends with this code, and all `parts` are said.
fn ends(problem: &str, iterations: u32, codes: &[i32], parts: &[&str]) -> String {
    let (code, said) = Desk::new().plan(problem, iterations);
    assert!(codes.contains(&code), "{code}: {said}");
    for part in parts {
        assert!(said.contains(part), "`{part}` is missing from: {said}");
    }
    said
}

/// The problem has a plan within so many iterations, and nothing was doubted.
fn solved(problem: &str, iterations: u32) -> String {
    let said = ends(problem, iterations, &[SOLVED], &[]);
    assert!(!said.contains("doubtful"), "{said}");
    said
}

#[test]
fn the_cup_has_a_plan_as_it_is() {
    solved(CUP, 200);
}

#[test]
fn an_entry_too_many_is_refused_in_every_list() {
    for (old, new, key) in [
        ("base = [-1.05, 0.0, 0.0]", "base = [-1.05, 0.0, 0.0, 0.0]", "`robot.base` has 4"),
        ("size = [0.9, 1.1, 0.7]", "size = [0.9, 1.1, 0.7, 1.0]", "size` has 4"),
        ("at = [0.0, 0.0, 0.35]", "at = [0.0, 0.0, 0.35, 0.0]", "`obstacle[0].at` has 4"),
        (START, "at = [-0.3, 0.15, 0.7]", "`object[0].at` has 3"),
        (GOAL, "on = \"desk\"\nat = [-0.3, -0.25, 0.7]", "`goal.object[0].at` has 3"),
        (GOAL, "position = [-0.3, -0.25, 0.9, 0.0]", "`goal.object[0].position` has 4"),
        (GOAL, "on = \"desk\"\nregion = { min = [0, 0], max = [0.1, 0.1, 0.1] }", "region.max` has 3"),
    ] {
        ends(&cup(&[(old, new)], ""), 1, &[BAD_INPUT], &[key]);
    }
    for (more, key) in [
        ("[bounds]\nbase_x = [-2, 2, 3]", "`bounds.base_x` has 3"),
        ("[push]\nedge_distance_m = [0.03, 0.05, 0.08]", "`push.edge_distance_m` has 3"),
        ("[place]\napproach_directions = [[0, 0, -1, 0]]", "`place.approach_directions[0]` has 4"),
        ("[goal.robot]\ntool = { position = [0, 0, 1], rpy = [0, 0, 0, 0] }", "`goal.robot.tool.rpy` has 4"),
        ("[[steer]]\nfrom_deg = [0, 90, 180]", "`steer[0].from_deg` has 3"),
    ] {
        ends(&cup(&[], more), 1, &[BAD_INPUT], &[key]);
    }
}

#[test]
fn angles_wrap_within_a_turn_and_are_degrees_beyond() {
    let base = |yaw: &str| cup(&[("base = [-1.05, 0.0, 0.0]", &format!("base = [-1.05, 0.0, {yaw}]"))], "");
    for yaw in ["3.1416", "-3.2", "6.28"] {
        ends(&base(yaw), 1, &[SOLVED, NOT_SOLVED, PARTIAL], &[]);
    }
    ends(&base("90"), 1, &[BAD_INPUT], &["`robot.base[2]`", "radians"]);
    ends(&cup(&[(START, "at = [-0.3, 0.15]\nyaw = 45")], ""), 1, &[BAD_INPUT], &["`object[0].yaw`", "radians"]);
    ends(&cup(&[], "yaw = 90"), 1, &[BAD_INPUT], &["`goal.object[0].yaw`", "radians"]);
    for (more, key) in [
        ("[goal.robot]\nbase = [0, 0, 180]", "goal.robot.base[2]"),
        ("[goal.robot]\ntool = { position = [0, 0, 1], rpy = [0, 0, 90] }", "goal.robot.tool.rpy[2]"),
        ("[goal.robot]\njoints = [0, 0, 0, -1, 90, -1, 0]", "goal.robot.joints"),
        (
            "[[obstacle]]\nname = \"o\"\nshape = { sphere = { radius = 0.1 } }\nat = [2, 2, 1]\nrpy = [90, 0, 0]",
            "rpy[0]",
        ),
        (
            "[[obstacle]]\nname = \"o\"\nshape = { sphere = { radius = 0.1 } }\nat = [2, 2, 1]\nyaw = 30",
            "`obstacle[1].yaw`",
        ),
    ] {
        ends(&cup(&[], more), 1, &[BAD_INPUT], &[key, "radians"]);
    }
    let joints = cup(&[("base = [", "joints = [0, 0, 0, -1, 45, -1, 0]\nbase = [")], "");
    ends(&joints, 1, &[BAD_INPUT], &["r_forearm_roll_joint"]);
}

#[test]
fn what_is_too_heavy_or_too_smooth_is_said() {
    let heavy = cup(&[(START, "at = [-0.3, 0.15]\nmass_kg = 300.0")], "");
    ends(&heavy, 1, &[IMPOSSIBLE], &["`cup`", "300 kg"]);
    // No grasp holds it; that it is pushed is said.
    let smooth = |table: f64| {
        cup(&[(START, &format!("at = [-0.3, 0.15]\nfriction = {{ table = {table}, fingers = 0.0 }}"))], "")
    };
    ends(&smooth(0.3), 1, &[SOLVED, NOT_SOLVED, PARTIAL], &["doubtful", "no grasp holds `cup`", "no friction"]);
    let carried = cup(&[(START, "at = [-0.3, 0.15]\npushable = false\nfriction = { table = 0.3, fingers = 0.0 }")], "");
    ends(&carried, 1, &[IMPOSSIBLE], &["no grasp holds it", "no friction"]);
}

#[test]
fn goals_that_are_taken_are_proven_to_be() {
    let jar = "[[object]]\nname = \"jar\"\nshape = { cylinder = { radius = 0.05, height = 0.12 } }\non = \"desk\"\n\
               at = [-0.3, -0.25]\npushable = false\n";
    ends(&cup(&[], jar), 1, &[IMPOSSIBLE], &["the goal of `cup`", "`jar`", "never moves"]);
    let bin = block("bin", [0.1, 0.1, 0.2], [-0.3, -0.25, 0.8]);
    ends(&cup(&[], &bin), 1, &[IMPOSSIBLE], &["the goal of `cup`", "`bin`"]);
    let both = "[[object]]\nname = \"mug\"\nshape = { cylinder = { radius = 0.04, height = 0.1 } }\non = \"desk\"\n\
                at = [-0.3, 0.4]\ngrasps = [\"side\"]\n[[goal.object]]\nobject = \"mug\"\non = \"desk\"\nat = [-0.3, -0.26]\n";
    ends(&cup(&[], both), 1, &[IMPOSSIBLE], &["the goal of `cup`", "`mug`", "has its goal there"]);
    // What the tolerance may save is doubted, and what may move is not in the way.
    let near = block("bin", [0.1, 0.1, 0.2], [-0.3, -0.335, 0.8]);
    ends(&cup(&[], &near), 1, &[NOT_SOLVED, PARTIAL], &["doubtful", "`bin`"]);
    ends(&cup(&[], &jar.replace("pushable = false\n", "")), 1, &[SOLVED, NOT_SOLVED, PARTIAL], &[]);
}

/// A box around `at` in the format STL, text; every other face is turned inside out.
fn stl(name: &str, half: f64, at: [f64; 3]) -> String {
    let corner = |i: usize| [0, 1, 2].map(|bit| at[bit] + if i >> bit & 1 == 1 { half } else { -half });
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let mut text = format!("solid {name}\n");
    for [a, b, c, d] in faces {
        for triangle in [[a, b, c], [d, c, a]] {
            text += " facet normal 0 0 0\n  outer loop\n";
            for [x, y, z] in triangle.map(corner) {
                let _ = writeln!(text, "   vertex {x} {y} {z}");
            }
            text += "  endloop\n endfacet\n";
        }
    }
    text + "endsolid " + name + "\n"
}

/// The triangles of a text STL as a binary one that tells of `told`.
fn binary(text: &str, told: u32) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(told.to_le_bytes());
    let numbers: Vec<f32> = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("vertex "))
        .flat_map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect::<Vec<f32>>())
        .collect();
    for triangle in numbers.chunks(9) {
        bytes.extend([0; 12]);
        for number in triangle {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn with_mesh(content: impl AsRef<[u8]>, at: [f64; 3], iterations: u32) -> (i32, String) {
    let desk = Desk::new();
    desk.write("lamp.stl", content);
    let lamp = format!("[[obstacle]]\nname = \"lamp\"\nshape = {{ mesh = {{ file = \"lamp.stl\" }} }}\nat = {at:?}\n");
    desk.plan(&cup(&[], &lamp), iterations)
}

#[test]
fn nothing_of_a_mesh_file_is_lost() {
    // Far from everything, and where the robot starts.
    let (far, near) = ([0.0, 3.0, 0.0], [-1.05, 0.0, 0.5]);
    let one = stl("one", 0.1, [0.0; 3]);
    let two = one.clone() + &stl("two", 0.2, [near[0] - far[0], near[1] - far[1], near[2] - far[2]]);
    let (code, said) = with_mesh(&one, far, 1);
    assert!([SOLVED, NOT_SOLVED, PARTIAL].contains(&code), "{said}");
    let spelled = two.replace("solid one", "solid").replace("endsolid", "end solid");
    for text in [two.clone(), two.replace('\n', "\r\n"), format!("\u{feff}{two}"), two.to_uppercase(), spelled] {
        let (code, said) = with_mesh(text, far, 1);
        assert!(code == BAD_INPUT && said.contains("start is not valid") && said.contains("lamp"), "{said}");
    }
    let (code, said) = with_mesh(binary(&two, 24), far, 1);
    assert!(code == BAD_INPUT && said.contains("start is not valid") && said.contains("lamp"), "{said}");
    for told in [0, 12, 25, u32::MAX] {
        let (code, said) = with_mesh(binary(&two, told), far, 1);
        assert!(code == BAD_INPUT && said.contains("it tells of") && said.contains("lamp.stl"), "{said}");
    }
    for (old, new) in
        [("0.1", "0,1"), ("0.1", "nan"), ("0.1", "inf"), ("endloop", "endlop"), ("endsolid one", "endsolid one\nx")]
    {
        let (code, said) = with_mesh(one.replacen(old, new, 1), far, 1);
        assert!(code == BAD_INPUT && said.contains("lamp.stl"), "{new}: {said}");
    }
}

#[test]
fn a_closed_mesh_is_solid_and_an_open_one_says_that_it_is_not() {
    let around = [-1.05, 0.0, 1.0];
    let (code, said) = with_mesh(stl("solid", 3.0, [0.0; 3]), around, 1);
    // Start and goal are in it; the goal is looked at first.
    assert!(code == IMPOSSIBLE && said.contains("lamp"), "{said}");
    let (code, said) = with_mesh(stl("solid", 0.4, [0.0; 3]), [-1.05, 0.0, 0.6], 1);
    assert!(code == BAD_INPUT && said.contains("start is not valid") && said.contains("lamp"), "{said}");
    // A room has an inside: the inner box is a cavity.
    let room = stl("room", 3.2, [0.0; 3]) + &stl("air", 3.0, [0.0; 3]);
    let (code, said) = with_mesh(room, [-1.05, 0.0, 2.95], 1);
    assert!([SOLVED, NOT_SOLVED, PARTIAL].contains(&code), "{said}");
    let open: String = stl("open", 3.0, [0.0; 3]).replacen("facet normal", "FACET NORMAL", 1);
    let first = open.find("FACET").unwrap() - 1;
    let end = open.find("endfacet").unwrap() + "endfacet\n".len();
    let open = open[..first].to_owned() + &open[end..];
    let (code, said) = with_mesh(open, around, 1);
    assert!(code != BAD_INPUT && said.contains("`lamp` is not closed (3 edges"), "{said}");
    // Around the goal.
    let safe = stl("safe", 0.2, [0.0; 3]) + &stl("air", 0.18, [0.0; 3]);
    let (code, said) = with_mesh(safe, [-0.3, -0.25, 0.87], 1);
    assert!(code == IMPOSSIBLE && said.contains("`cup`") && said.contains("enclosed by `lamp`"), "{said}");
}

#[test]
fn a_mesh_in_millimetres_is_doubted() {
    for at in [[300.0, 0.0, 0.0], [-1.05, 0.0, 0.5]] {
        let (_, said) = with_mesh(stl("mm", 100.0, [0.0; 3]), at, 1);
        assert!(said.contains("`lamp` is 200 m wide") && said.contains("scale = 0.001"), "{said}");
    }
}

#[test]
fn addresses_of_files_are_refused_with_what_is_known() {
    let lamp =
        "[[obstacle]]\nname = \"lamp\"\nshape = { mesh = { file = \"package://lamps/lamp.stl\" } }\nat = [2, 2, 1]\n";
    ends(&cup(&[], lamp), 1, &[BAD_INPUT], &["package://lamps/lamp.stl", "relative to the folder"]);
    let desk = Desk::new();
    let urdf = "<robot name=\"r\"><link name=\"base_link\"><collision><geometry><mesh filename=\"package://no/a.stl\"/>\
                </geometry></collision></link></robot>";
    desk.write("r.urdf", urdf);
    let (code, said) = desk.plan(&cup(&[("base = [", "urdf = \"r.urdf\"\nbase = [")], ""), 1);
    assert!(code == BAD_INPUT && said.contains("package://no/a.stl") && said.contains("folder"), "{said}");
}

#[test]
fn nothing_of_a_robot_description_is_lost() {
    let desk = Desk::new();
    for (text, why) in [
        (format!("{URDF}\nand so on"), "root"),
        (format!("{URDF}<robot name=\"second\"/>"), "root"),
        (URDF.replacen("<collision", "<colision", 1).replacen("</collision", "</colision", 1), "colision"),
    ] {
        desk.write("r.urdf", &text);
        let (code, said) = desk.plan(&cup(&[("base = [", "urdf = \"r.urdf\"\nbase = [")], ""), 1);
        assert!(code == BAD_INPUT && said.contains("r.urdf") && said.contains(why), "{said}");
    }
}

#[test]
fn polygons_may_be_closed_and_regions_may_overhang() {
    let polygon = "polygon = [[-0.45, -0.55], [0.45, -0.55], [0.45, 0.55], [-0.45, 0.55], [-0.45, -0.55]]\nz = 0.7\nbody = \"desk\"";
    solved(&cup(&[("top_of = \"desk\"", polygon)], ""), 200);
    let region = "on = \"desk\"\nregion = { min = [-0.4, -1.5], max = [-0.3, -0.4] }";
    solved(&cup(&[(GOAL, region)], ""), 200);
    let point = "on = \"desk\"\nregion = { min = [-0.3, -0.25], max = [-0.3, -0.25] }";
    solved(&cup(&[(GOAL, point)], ""), 200);
    solved(&cup(&[], "yaw = 1.0\nyaw_tolerance = 0.001"), 200);
}

#[test]
fn a_newer_version_is_said_first() {
    let text = cup(&[("version = 1", "version = 2\ncolour = \"red\"")], "");
    ends(&text, 1, &[BAD_INPUT], &["`version` is 2", "newer"]);
}

#[test]
fn what_hardly_has_a_plan_is_doubted_and_looked_for() {
    let shelf = |z: f64| {
        block("shelf", [0.6, 0.6, 0.05], [0.0, 2.0, z]) + "[[surface]]\nname = \"shelf\"\ntop_of = \"shelf\"\n"
    };
    let high = cup(&[(GOAL, "on = \"shelf\"\nat = [-0.1, 1.9]")], &(shelf(1.95) + "[bounds]\nobject_z = [0, 2.5]\n"));
    ends(&high, 20, &[NOT_SOLVED, PARTIAL], &["doubtful", "`cup` can hardly be set down at its goal", "reach"]);
    let wide = block("wide", [3.0, 3.0, 0.7], [0.0, 3.0, 0.35]) + "[[surface]]\nname = \"wide\"\ntop_of = \"wide\"\n";
    let deep = cup(&[(GOAL, "on = \"wide\"\nat = [0.0, 3.0]")], &wide);
    ends(&deep, 20, &[NOT_SOLVED, PARTIAL], &["doubtful", "`cup` can hardly be set down at its goal", "reach"]);
    let mut cage = String::new();
    for i in 0..8_u32 {
        let (y, x) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
        cage += &block(&format!("bar {i}"), [0.02, 0.02, 0.3], [-0.3 + 0.075 * x, 0.15 + 0.075 * y, 0.85]);
    }
    ends(&cup(&[], &cage), 20, &[NOT_SOLVED], &["doubtful", "`cup` can hardly leave", "bar "]);
}

#[test]
fn a_plate_that_lies_flat_needs_a_push() {
    let dish = "shape = { cylinder = { radius = 0.13, height = 0.02 } }";
    let table =
        block("shelf", [0.6, 0.6, 0.7], [0.0, 2.0, 0.35]) + "[[surface]]\nname = \"shelf\"\ntop_of = \"shelf\"\n";
    let flat =
        [(ROUND, dish), ("grasps = [\"side\"]", "grasps = [\"rim\"]"), (GOAL, "on = \"shelf\"\nat = [-0.2, 2.0]")];
    let without = cup(&[&flat[..], &[(", \"Push\"]", "]")]].concat(), &table);
    ends(&without, 1, &[IMPOSSIBLE], &["`cup`", "overhang", "`Push` is not among the primitives"]);
    // Walls end every push before the edge.
    let mut walls = String::new();
    for (i, (x, y)) in [(0.47, 0.0), (-0.47, 0.0), (0.0, 0.57), (0.0, -0.57)].into_iter().enumerate() {
        let size = if y == 0.0 { [0.04, 1.18, 0.9] } else { [0.9, 0.04, 0.9] };
        walls += &block(&format!("wall {i}"), size, [x, y, 0.45]);
    }
    let (code, said) = Desk::new().plan(&cup(&flat, &(table + &walls)), 20);
    assert!([NOT_SOLVED, PARTIAL].contains(&code) && said.contains("wall "), "{said}");
}

#[test]
fn tight_places_are_left() {
    let board = |z: f64, name: &str| block(name, [0.35, 0.8, 0.02], [0.0, 1.5, z]);
    let boards = board(0.8, "lower") + &board(0.96, "upper") + "[[surface]]\nname = \"lower\"\ntop_of = \"lower\"\n";
    solved(&cup(&[(GOAL, "on = \"lower\"\nat = [-0.1, 1.5]")], &boards), 2000);
    let book = [
        (ROUND, "shape = { box = { size = [0.06, 0.2, 0.028] } }"),
        ("grasps = [\"side\"]", "grasps = [\"overhead\"]\noverhead = { opening_m = 0.08 }"),
    ];
    solved(&cup(&book, ""), 300);
    // Two cups with less between them than the margin.
    let beside = "[[object]]\nname = \"mug\"\nshape = { cylinder = { radius = 0.04, height = 0.09 } }\non = \"desk\"\n\
                  at = [-0.2181, 0.15]\ngrasps = [\"side\"]\n";
    let said = solved(&cup(&[], beside), 500);
    assert!(said.contains("cup and mug are 1.90 mm apart"), "{said}");
    // A wall two millimetres beside: not refused, and what is near is said.
    let wall = block("wall", [0.1, 0.1, 0.2], [-0.3, 0.242, 0.8]);
    let (code, said) = Desk::new().plan(&cup(&[], &wall), 1);
    assert!(code != BAD_INPUT && code != IMPOSSIBLE && said.contains("cup and wall"), "{said}");
}

#[test]
fn a_door_and_a_seam_are_passed() {
    let mut rooms = String::new();
    for (name, size, at) in [
        ("left", [0.1, 2.6, 2.0], [1.5, 1.66, 1.0]),
        ("right", [0.1, 2.6, 2.0], [1.5, -1.66, 1.0]),
        ("north", [6.0, 0.1, 2.0], [1.5, 3.0, 1.0]),
        ("south", [6.0, 0.1, 2.0], [1.5, -3.0, 1.0]),
        ("stand", [0.8, 0.8, 0.7], [3.5, 0.0, 0.35]),
    ] {
        rooms += &block(name, size, at);
    }
    rooms += "[[surface]]\nname = \"stand\"\ntop_of = \"stand\"\n";
    ends(&cup(&[(GOAL, "on = \"stand\"\nat = [3.2, 0.0]")], &rooms), 100, &[SOLVED], &[]);
    let leaf = block("leaf", [0.9, 0.8, 0.7], [0.9, 0.15, 0.35]) + "[[surface]]\nname = \"leaf\"\ntop_of = \"leaf\"\n";
    let dish =
        [(ROUND, "shape = { cylinder = { radius = 0.12, height = 0.02 } }"), ("grasps = [\"side\"]", "grasps = []")];
    let over = [&dish[..], &[(START, "at = [0.25, 0.15]"), (GOAL, "on = \"leaf\"\nat = [0.62, 0.15]")]].concat();
    ends(&cup(&over, &leaf), 500, &[SOLVED], &[]);
}

#[test]
fn no_time_gives_no_diagnosis() {
    let desk = Desk::new();
    desk.write("p.toml", cup(&[], "[budget]\ntime_limit_s = 0.000001\n"));
    let (code, said) = verdict(&desk.run(&["plan", "p.toml", "--no-picture", "-o", "o.json"]));
    assert_eq!(code, NOT_SOLVED, "{said}");
    assert!(said.contains("--time-limit") && said.lines().count() <= 3 && !said.contains("after 0.0 s"), "{said}");
}

#[test]
fn hundreds_of_obstacles_are_read_and_the_limit_has_a_name() {
    let posts = |count: u32| {
        let mut text = String::new();
        for i in 0..count {
            let at = [f64::from(i % 100) * 0.3 - 15.0, f64::from(i / 100) * 0.3 + 2.0, 0.05];
            text += &block(&format!("post {i}"), [0.05, 0.05, 0.1], at);
        }
        cup(&[], &text)
    };
    solved(&posts(700), 200);
    ends(&posts(10_000), 1, &[BAD_INPUT], &["`obstacle` has 10001 entries", "10000"]);
}

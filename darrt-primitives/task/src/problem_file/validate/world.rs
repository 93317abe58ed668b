//! Rules of the robot, the bounds, the obstacles and the surfaces.

use std::f64::consts::PI;

use super::names::{obstacle, surface};
use super::numbers::{angle, length, ordered, size, within};
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::robot::Robot;
use crate::problem_file::{Bounds, Obstacle, ProblemFile, ShapeSpec, Surface};

/// How far the norm of a quaternion may be from 1.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// Most obstacles.
const MOST_OBSTACLES: usize = 10_000;

/// Most corners of a polygon.
const MOST_CORNERS: usize = darrt_geom::support::MAXIMUM_VERTICES;

/// Most points of a hull.
const MOST_POINTS: usize = 10_000;

/// Steepest rim of a plate, degrees.
const STEEPEST_RIM_DEG: f64 = 45.0;

/// What rounding may do to a length (m).
const ROUNDING: f64 = 1e-9;

/// Checks robot, bounds, obstacles and surfaces.
pub(super) fn check(problem: &ProblemFile) -> Result<(), Located> {
    for (name, range) in problem.bounds.ranges() {
        ordered(&format!("bounds.{name}"), range)?;
    }
    check_robot(&problem.robot, &problem.bounds)?;
    length("obstacle", problem.obstacles.len(), 0, MOST_OBSTACLES)?;
    for (index, obstacle) in problem.obstacles.iter().enumerate() {
        check_obstacle(problem, obstacle, &format!("obstacle[{index}]"))?;
    }
    for (index, surface) in problem.surfaces.iter().enumerate() {
        check_surface(problem, surface, &format!("surface[{index}]"))?;
    }
    Ok(())
}

fn check_robot(robot: &Robot, bounds: &Bounds) -> Result<(), Located> {
    exclusive("robot", &[("model", robot.model.is_some()), ("urdf", robot.urdf.is_some())], false)?;
    in_bounds("robot.base[0]", robot.base[0], "base_x", bounds.base_x)?;
    in_bounds("robot.base[1]", robot.base[1], "base_y", bounds.base_y)?;
    angle("robot.base[2]", robot.base[2])?;
    within("robot.base[2]", robot.base[2], -PI, PI)?;
    let arms = [
        ("posture", &robot.posture, "joints", &robot.joints),
        ("other_posture", &robot.other_posture, "other_joints", &robot.other_joints),
    ];
    for (posture_key, name, joints_key, joints) in arms {
        let given = [(posture_key, name.is_some()), (joints_key, joints.is_some())];
        exclusive("robot", &given, false)?;
    }
    Ok(())
}

fn check_obstacle(problem: &ProblemFile, body: &Obstacle, key: &str) -> Result<(), Located> {
    check_shape(&body.shape, &format!("{key}.shape"))?;
    let numbers = if body.standing_on.is_some() { 2 } else { 3 };
    length(&format!("{key}.at"), body.at.len(), numbers, numbers)?;
    let turns = [("yaw", body.yaw.is_some()), ("rpy", body.rpy.is_some()), ("quaternion", body.quaternion.is_some())];
    exclusive(key, &turns, false)?;
    let turned = body.yaw.iter().map(|yaw| ("yaw".to_owned(), *yaw));
    let rolled = body.rpy.iter().flatten().enumerate().map(|(i, value)| (format!("rpy[{i}]"), *value));
    turned.chain(rolled).try_for_each(|(name, value)| angle(&format!("{key}.{name}"), value))?;
    if let Some(name) = &body.standing_on {
        surface(problem, &format!("{key}.standing_on"), name)?;
        if body.rpy.is_some() || body.quaternion.is_some() {
            let text = "stands on a surface and can only be turned by `yaw`";
            return Err(Flaw::Inconsistent(text.to_owned()).at(key));
        }
    }
    body.quaternion.map_or(Ok(()), |quaternion| check_unit(&format!("{key}.quaternion"), quaternion))
}

fn check_unit(key: &str, quaternion: [f64; 4]) -> Result<(), Located> {
    let norm = quaternion.iter().map(|q| q * q).sum::<f64>().sqrt();
    if (norm - 1.0).abs() <= QUATERNION_TOLERANCE {
        return Ok(());
    }
    let tolerance = QUATERNION_TOLERANCE;
    Err(Flaw::NotUnit { norm, tolerance }.at(key))
}

fn check_surface(problem: &ProblemFile, plane: &Surface, key: &str) -> Result<(), Located> {
    let given = [("top_of", plane.top_of.is_some()), ("polygon", plane.polygon.is_some())];
    exclusive(key, &given, true)?;
    if let Some(name) = &plane.top_of {
        let top_key = format!("{key}.top_of");
        obstacle(problem, &top_key, name)?;
        let other = [("top_of", true), ("z", plane.z.is_some())];
        exclusive(key, &other, true)?;
        let other = [("top_of", true), ("body", plane.body.is_some())];
        exclusive(key, &other, true)?;
        let shape = problem.obstacle(name).map(|o| &o.shape);
        if !matches!(shape, Some(ShapeSpec::Box { .. })) {
            let kind = shape.map_or("nothing", ShapeSpec::kind);
            let text = format!("names the obstacle `{name}`, a {kind}; only a box has a top face");
            return Err(Flaw::Inconsistent(text).at(top_key));
        }
    }
    if let Some(polygon) = &plane.polygon {
        length(&format!("{key}.polygon"), polygon.len(), 3, MOST_CORNERS)?;
        if plane.z.is_none() {
            let text = "has a polygon and needs its height `z`";
            return Err(Flaw::Inconsistent(text.to_owned()).at(key));
        }
        if plane.body.is_none() {
            let text = "has a polygon and needs `body`, the obstacle on whose upper face it lies";
            return Err(Flaw::Inconsistent(text.to_owned()).at(key));
        }
    }
    plane.body.as_ref().map_or(Ok(()), |name| obstacle(problem, &format!("{key}.body"), name))
}

/// Lengths of a shape are positive and fit together.
pub(super) fn check_shape(shape: &ShapeSpec, key: &str) -> Result<(), Located> {
    let key = format!("{key}.{}", shape.kind());
    let lengths: Vec<(String, f64)> = match shape {
        ShapeSpec::Box { size } => (0..).zip(size).map(|(i, &s)| (format!("size[{i}]"), s)).collect(),
        ShapeSpec::Sphere { radius } => vec![("radius".to_owned(), *radius)],
        ShapeSpec::Cylinder { radius, height } | ShapeSpec::Capsule { radius, height } => {
            vec![("radius".to_owned(), *radius), ("height".to_owned(), *height)]
        }
        ShapeSpec::Bowl { radius, height, wall } => {
            vec![("radius".to_owned(), *radius), ("height".to_owned(), *height), ("wall".to_owned(), *wall)]
        }
        ShapeSpec::Plate { radius, height, rim } => vec![
            ("radius".to_owned(), *radius),
            ("height".to_owned(), *height),
            ("rim.width_m".to_owned(), rim.width_m),
            ("rim.thickness_m".to_owned(), rim.thickness_m),
        ],
        ShapeSpec::Hull { .. } => Vec::new(),
        ShapeSpec::Mesh { scale, .. } => vec![("scale".to_owned(), *scale)],
    };
    for (name, value) in lengths {
        size(&format!("{key}.{name}"), value)?;
    }
    let range = |name, value, bad: bool, bound: String| {
        if bad { Err(Flaw::OutOfRange { value, bound }.at(format!("{key}.{name}"))) } else { Ok(()) }
    };
    match shape {
        ShapeSpec::Capsule { radius, height } => {
            let bound = format!("greater than two radii, {}", 2.0 * radius);
            range("height", *height, *height <= 2.0 * radius, bound)
        }
        ShapeSpec::Bowl { radius, wall, .. } => {
            range("wall", *wall, wall >= radius, format!("less than the radius, {radius}"))
        }
        ShapeSpec::Plate { radius, height, rim } => {
            within(&format!("{key}.rim.slope_deg"), rim.slope_deg, 0.0, STEEPEST_RIM_DEG)?;
            let bound = format!("less than the radius, {radius}");
            range("rim.width_m", rim.width_m, rim.width_m >= *radius, bound)?;
            let bound = format!("at least the height of its rim, {:.4}", rim.height());
            range("height", *height, *height < rim.height() - ROUNDING, bound)
        }
        ShapeSpec::Hull { points } => length(&format!("{key}.points"), points.len(), 4, MOST_POINTS),
        // A path joined to a folder keeps one slash.
        ShapeSpec::Mesh { file, .. } if file.to_string_lossy().contains(":/") => {
            let text = format!(
                "is `{}`, but packages and other addresses are not known here; give the path of the file, relative to the \
                 folder of the problem file",
                file.display()
            );
            Err(Flaw::Inconsistent(text).at(format!("{key}.file")))
        }
        _ => Ok(()),
    }
}

/// `value` lies in the range that the section `[bounds]` gives under `name`.
pub(super) fn in_bounds(key: &str, value: f64, name: &str, [low, high]: [f64; 2]) -> Result<(), Located> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let bound = format!("in `bounds.{name}` = [{low}, {high}]");
    Err(Flaw::OutOfRange { value, bound }.at(key))
}

/// At most one of the keys is given, exactly one when `needed`.
pub(super) fn exclusive(key: &str, given: &[(&str, bool)], needed: bool) -> Result<(), Located> {
    let count = given.iter().filter(|(_, present)| *present).count();
    if count == 1 || (count == 0 && !needed) {
        return Ok(());
    }
    let join = |names: Vec<String>| names.join(", ");
    let all = join(given.iter().map(|(name, _)| format!("`{name}`")).collect());
    let present = join(given.iter().filter(|(_, present)| *present).map(|(name, _)| format!("`{name}`")).collect());
    let rule = if needed { "exactly one" } else { "at most one" };
    let found = if present.is_empty() { "none".to_owned() } else { present };
    Err(Flaw::Inconsistent(format!("must have {rule} of {all}, has {found}")).at(key))
}

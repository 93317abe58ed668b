//! Rules of the movable objects.

use super::names::surface;
use super::numbers::{angle, length, motion, positive, within};
use super::world::check_shape;
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::{GraspFamily, LengthRange, Object, ProblemFile, ShapeSpec, Symmetry};

/// Most movable objects.
const MOST_OBJECTS: usize = 64;

/// Most entries of `tilts_deg`.
const MOST_TILTS: usize = 64;

/// Most directions around an object.
const MOST_AZIMUTHS: u32 = 3600;

/// Largest coefficient of friction.
const LARGEST_FRICTION: f64 = 2.0;

/// Widest gap between the fingers (m).
pub(super) const WIDEST_GAP: f64 = 0.09;

/// Checks all movable objects.
pub(super) fn check(problem: &ProblemFile) -> Result<(), Located> {
    length("object", problem.objects.len(), 1, MOST_OBJECTS)?;
    for (index, object) in problem.objects.iter().enumerate() {
        check_object(problem, object, &format!("object[{index}]"))?;
    }
    Ok(())
}

fn check_object(problem: &ProblemFile, object: &Object, key: &str) -> Result<(), Located> {
    angle(&format!("{key}.yaw"), object.yaw)?;
    check_shape(&object.shape, &format!("{key}.shape"))?;
    positive(&format!("{key}.mass_kg"), object.mass_kg)?;
    within(&format!("{key}.friction.table"), object.friction.table, 0.0, LARGEST_FRICTION)?;
    within(&format!("{key}.friction.fingers"), object.friction.fingers, 0.0, LARGEST_FRICTION)?;
    within(&format!("{key}.max_tilt_deg"), object.max_tilt_deg(), 0.0, 180.0)?;
    check_surfaces(problem, object, key)?;
    check_roundness(object, key)?;
    for (index, family) in object.grasps.iter().enumerate() {
        if object.grasps.iter().take(index).any(|earlier| earlier == family) {
            let flaw = Flaw::Inconsistent("names a family a second time".to_owned());
            return Err(flaw.at(format!("{key}.grasps[{index}]")));
        }
    }
    check_families(object, key)
}

fn check_surfaces(problem: &ProblemFile, object: &Object, key: &str) -> Result<(), Located> {
    surface(problem, &format!("{key}.on"), &object.on)?;
    let Some(names) = &object.surfaces else {
        return Ok(());
    };
    for (index, name) in names.iter().enumerate() {
        surface(problem, &format!("{key}.surfaces[{index}]"), name)?;
    }
    if names.contains(&object.on) {
        return Ok(());
    }
    let text = format!("does not list `{}`, on which the object starts", object.on);
    Err(Flaw::Inconsistent(text).at(format!("{key}.surfaces")))
}

/// Only round objects can be pushed and taken by the rim; a box is not symmetric.
fn check_roundness(object: &Object, key: &str) -> Result<(), Located> {
    let kind = object.shape.kind();
    let refuse = |name: &str, what: &str| {
        let text = format!("{what}, but the shape is a {kind}");
        Err(Flaw::Inconsistent(text).at(format!("{key}.{name}")))
    };
    if object.symmetry() == Symmetry::Z && matches!(object.shape, ShapeSpec::Box { .. }) {
        return refuse("symmetry", "is `z`, which needs a shape round about z");
    }
    if object.is_round() {
        return Ok(());
    }
    if object.pushable() {
        return refuse("pushable", "is true, and Push needs a shape round about z");
    }
    if object.grasps.contains(&GraspFamily::Rim) {
        return refuse("grasps", "has `rim`, which needs a shape round about z");
    }
    Ok(())
}

fn check_families(object: &Object, key: &str) -> Result<(), Located> {
    let (rim, overhead, side) = (&object.rim, &object.overhead, &object.side);
    let rim_tilts = object.rim_tilts_deg();
    let exact = |length_m| LengthRange::new(length_m, length_m);
    let families = [
        ("rim", &rim_tilts, rim.azimuths, [exact(rim.insertion_m), rim.approach_m, exact(rim.lift_m)], rim.opening_m),
        (
            "overhead",
            &overhead.tilts_deg,
            overhead.azimuths,
            [overhead.insertion_m, overhead.approach_m, exact(overhead.lift_m)],
            overhead.opening_m,
        ),
        (
            "side",
            &side.tilts_deg,
            side.azimuths,
            [exact(side.insertion_m), side.approach_m, exact(side.lift_m)],
            side.opening_m,
        ),
    ];
    for (name, tilts, azimuths, lengths, opening) in families {
        let key = format!("{key}.{name}");
        length(&format!("{key}.tilts_deg"), tilts.len(), 1, MOST_TILTS)?;
        for (index, &tilt) in tilts.iter().enumerate() {
            within(&format!("{key}.tilts_deg[{index}]"), tilt, -90.0, 90.0)?;
        }
        within(&format!("{key}.azimuths"), f64::from(azimuths), 1.0, f64::from(MOST_AZIMUTHS))?;
        for (name, value) in ["insertion_m", "approach_m", "lift_m"].into_iter().zip(lengths) {
            motion(&format!("{key}.{name}"), value)?;
        }
        within(&format!("{key}.opening_m"), opening, 0.0, WIDEST_GAP)?;
    }
    Ok(())
}

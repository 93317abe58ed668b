//! Names are usable, unique, and refer to something.

use std::collections::BTreeMap;

use super::numbers::length;
use crate::problem_file::ProblemFile;
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::suggest::{nearest, shown};
use crate::text::acts;

/// Longest accepted name in bytes.
const LONGEST_NAME: usize = 100;

/// The name of the body that is always there.
const FLOOR: &str = crate::problem_file::geometry::FLOOR;

/// Bodies (obstacles, objects, the floor) have different names, and so have surfaces.
pub(super) fn check_unique(problem: &ProblemFile) -> Result<(), Located> {
    usable("name", &problem.name)?;
    let mut bodies = BTreeMap::from([(FLOOR, FLOOR.to_owned())]);
    for (index, obstacle) in problem.obstacles.iter().enumerate() {
        claim(&mut bodies, &obstacle.name, format!("obstacle[{index}]"))?;
    }
    for (index, object) in problem.objects.iter().enumerate() {
        claim(&mut bodies, &object.name, format!("object[{index}]"))?;
    }
    let mut surfaces = BTreeMap::new();
    for (index, surface) in problem.surfaces.iter().enumerate() {
        claim(&mut surfaces, &surface.name, format!("surface[{index}]"))?;
    }
    Ok(())
}

fn claim<'a>(taken: &mut BTreeMap<&'a str, String>, name: &'a str, owner: String) -> Result<(), Located> {
    let key = format!("{owner}.name");
    usable(&key, name)?;
    match taken.insert(name, owner) {
        None => Ok(()),
        Some(taken_by) => {
            let name = shown(name);
            Err(Flaw::Duplicate { name, taken_by }.at(key))
        }
    }
}

/// A name is not empty, not long, and can be printed as it is.
fn usable(key: &str, name: &str) -> Result<(), Located> {
    length(key, name.len(), 1, LONGEST_NAME)?;
    if name.chars().any(acts) {
        return Err(Flaw::Unprintable { name: name.to_owned() }.at(key));
    }
    Ok(())
}

/// There is a support surface called `value`.
pub(super) fn surface(problem: &ProblemFile, key: &str, value: &str) -> Result<(), Located> {
    let names: Vec<&str> = problem.surfaces.iter().map(|s| s.name.as_str()).collect();
    one_of("surface", key, value, &names)
}

/// There is an obstacle called `value`.
pub(super) fn obstacle(problem: &ProblemFile, key: &str, value: &str) -> Result<(), Located> {
    let names: Vec<&str> = problem.obstacles.iter().map(|o| o.name.as_str()).collect();
    one_of("obstacle", key, value, &names)
}

/// There is a movable object called `value`.
pub(super) fn object(problem: &ProblemFile, key: &str, value: &str) -> Result<(), Located> {
    let names: Vec<&str> = problem.objects.iter().map(|o| o.name.as_str()).collect();
    one_of("object", key, value, &names)
}

fn one_of(kind: &'static str, key: &str, value: &str, names: &[&str]) -> Result<(), Located> {
    if names.contains(&value) {
        return Ok(());
    }
    Err(Flaw::UnknownName {
        kind,
        value: shown(value),
        nearest: nearest(value, names.iter().copied()).map(str::to_owned),
        available: names.iter().map(|&name| name.to_owned()).collect(),
    }
    .at(key))
}

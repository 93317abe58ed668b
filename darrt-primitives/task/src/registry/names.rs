//! Names in a problem file that only a program can know.

use crate::problem_file::ProblemFile;
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::suggest::{nearest, shown};

/// The first name that nothing has.
pub(super) fn unknown(
    problem: &ProblemFile,
    models: &[&str],
    primitives: &[&str],
    postures: &[&str],
    samplers: &[&str],
    distances: &[&str],
) -> Option<Located> {
    let robot = &problem.robot;
    let allowed = problem.primitives.iter().enumerate();
    let allowed = allowed.map(|(i, name)| ("primitive", format!("primitives[{i}]"), name.as_str(), primitives));
    let settings = problem.primitive_settings.keys();
    let settings = settings.map(|name| ("primitive", format!("primitive.{name}"), name.as_str(), primitives));
    let starts = [("robot.posture", &robot.posture), ("robot.other_posture", &robot.other_posture)];
    let starts = starts.into_iter().filter_map(|(key, name)| Some((key.to_owned(), name.as_deref()?)));
    let through = problem.transit.postures.iter().enumerate();
    let through = through.map(|(i, name)| (format!("transit.postures[{i}]"), name.as_str()));
    let stances = starts.chain(through).map(|(key, name)| ("posture", key, name, postures));
    let sampling = &problem.sampling;
    let chosen = [
        ("sampler", "sampling.sampler".to_owned(), sampling.sampler.as_str(), samplers),
        ("distance", "sampling.distance".to_owned(), sampling.distance.as_str(), distances),
    ];
    let asked = robot.model.iter().map(|name| ("robot", "robot.model".to_owned(), name.as_str(), models));
    let mut all = asked.chain(allowed).chain(settings).chain(stances).chain(chosen);
    all.find_map(|(kind, key, name, known)| one_of(kind, &key, name, known).err())
}

/// `value` is among `names`.
pub(super) fn one_of(kind: &'static str, key: &str, value: &str, names: &[&str]) -> Result<(), Located> {
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

/// A primitive without settings of its own has none in the file.
pub(super) fn no_setting(problem: &ProblemFile, name: &str) -> Result<(), Located> {
    let key = problem.primitive_settings.get(name).and_then(|table| table.keys().next());
    match key {
        Some(key) => Err(Flaw::Inconsistent("is unknown: this primitive has no settings of its own".to_owned())
            .at(format!("primitive.{name}.{key}"))),
        None => Ok(()),
    }
}

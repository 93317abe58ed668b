//! The paper's problems, and further ones, embedded in the program.

use super::ProblemFile;
use super::error::ProblemFileError;
use super::suggest::nearest;

/// Name and text of the paper's problems, from easy to hard.
const PROBLEMS: [(&str, &str); 6] = [
    ("simple-plate", include_str!("../../scenes/simple-plate.toml")),
    ("bowl", include_str!("../../scenes/bowl.toml")),
    ("plate3-no-place", include_str!("../../scenes/plate3-no-place.toml")),
    ("plate1", include_str!("../../scenes/plate1.toml")),
    ("plate2", include_str!("../../scenes/plate2.toml")),
    ("plate3", include_str!("../../scenes/plate3.toml")),
];

/// Problems on which other planners have been measured, and larger ones of the paper's kind.
const FURTHER: [(&str, &str); 6] = [
    ("two-tables", include_str!("../../scenes/two-tables.toml")),
    ("two-tables-cups", include_str!("../../scenes/two-tables-cups.toml")),
    ("sloping-rim-plate", include_str!("../../scenes/sloping-rim-plate.toml")),
    ("plate-and-bowl", include_str!("../../scenes/plate-and-bowl.toml")),
    ("plate-and-two-bowls", include_str!("../../scenes/plate-and-two-bowls.toml")),
    ("bowl-in-the-way", include_str!("../../scenes/bowl-in-the-way.toml")),
];

/// Small problems of a household, each with one thing that a planner may get wrong.
const EVERYDAY: [(&str, &str); 13] = [
    ("mug-beside", include_str!("../../scenes/everyday/mug-beside.toml")),
    ("bottle-behind-cups", include_str!("../../scenes/everyday/bottle-behind-cups.toml")),
    ("three-mugs", include_str!("../../scenes/everyday/three-mugs.toml")),
    ("mug-to-shelf", include_str!("../../scenes/everyday/mug-to-shelf.toml")),
    ("box-beside-others", include_str!("../../scenes/everyday/box-beside-others.toml")),
    ("plate-over-seam", include_str!("../../scenes/everyday/plate-over-seam.toml")),
    ("l-shaped-table", include_str!("../../scenes/everyday/l-shaped-table.toml")),
    ("plate-under-shelf", include_str!("../../scenes/everyday/plate-under-shelf.toml")),
    ("door-74-cm", include_str!("../../scenes/everyday/door-74-cm.toml")),
    ("door-70-cm", include_str!("../../scenes/everyday/door-70-cm.toml")),
    ("bowl-upright", include_str!("../../scenes/everyday/bowl-upright.toml")),
    ("goal-near-edge", include_str!("../../scenes/everyday/goal-near-edge.toml")),
    ("low-plank", include_str!("../../scenes/everyday/low-plank.toml")),
];

/// Everyday problems without a plan, for which the answer says why.
const HOPELESS: [(&str, &str); 2] = [
    ("heavy-plate", include_str!("../../scenes/everyday/heavy-plate.toml")),
    ("slippery-fingers", include_str!("../../scenes/everyday/slippery-fingers.toml")),
];

/// The names of the embedded problems that have no plan.
pub fn hopeless_names() -> [&'static str; 2] {
    HOPELESS.map(|(name, _)| name)
}

/// The names of the embedded everyday problems.
pub fn everyday_names() -> [&'static str; 13] {
    EVERYDAY.map(|(name, _)| name)
}

/// The names of the embedded problems that are not the paper's, from easy to hard.
pub fn further_names() -> [&'static str; 6] {
    FURTHER.map(|(name, _)| name)
}

/// The names of the paper's problems, from easy to hard.
pub fn builtin_names() -> [&'static str; 6] {
    PROBLEMS.map(|(name, _)| name)
}

/// The embedded problem called `name`, in any case and also in the paper's spelling, such as `Plate3 (No Place)`.
///
/// # Errors
/// [`ProblemFileError::UnknownProblem`] with all names and the nearest one.
pub fn builtin(name: &str) -> Result<ProblemFile, ProblemFileError> {
    let (canonical, text) = find(name).ok_or_else(|| unknown(name))?;
    ProblemFile::from_toml(text, &format!("built-in {canonical}"))
}

/// The text of the embedded problem called `name`, for a person who wants a copy to edit.
///
/// # Errors
/// As [`builtin`].
pub fn builtin_text(name: &str) -> Result<&'static str, ProblemFileError> {
    find(name).map(|(_, text)| text).ok_or_else(|| unknown(name))
}

/// The built-in spelling of `name`, if it is one.
pub fn canonical_name(name: &str) -> Option<&'static str> {
    find(name).map(|(canonical, _)| canonical)
}

/// The error for a name that is neither a built-in problem nor a file.
pub(super) fn unknown(name: &str) -> ProblemFileError {
    ProblemFileError::UnknownProblem {
        name: super::suggest::shown(name),
        nearest: nearest(name, all_names()).map(str::to_owned),
        available: all_names().map(str::to_owned).collect(),
    }
}

fn all_names() -> impl Iterator<Item = &'static str> {
    builtin_names().into_iter().chain(further_names()).chain(everyday_names()).chain(hopeless_names())
}

fn find(name: &str) -> Option<(&'static str, &'static str)> {
    let wanted = folded(name);
    PROBLEMS
        .into_iter()
        .chain(FURTHER)
        .chain(EVERYDAY)
        .chain(HOPELESS)
        .find(|(candidate, _)| folded(candidate) == wanted)
}

/// Letters and digits only, in lower case: what the spellings of one name have in common.
fn folded(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

#[cfg(test)]
mod tests;

//! The paper's problems, and further ones, embedded in the program.

use darrt_task::problem_file::collection::{BuiltIn, Collection, ProblemGroup};
use darrt_task::problem_file::{ProblemFile, ProblemFileError};

/// The paper's problems, from easy to hard.
const PAPER: [BuiltIn; 6] = [
    BuiltIn { name: "simple-plate", text: include_str!("../scenes/simple-plate.toml") },
    BuiltIn { name: "bowl", text: include_str!("../scenes/bowl.toml") },
    BuiltIn { name: "plate3-no-place", text: include_str!("../scenes/plate3-no-place.toml") },
    BuiltIn { name: "plate1", text: include_str!("../scenes/plate1.toml") },
    BuiltIn { name: "plate2", text: include_str!("../scenes/plate2.toml") },
    BuiltIn { name: "plate3", text: include_str!("../scenes/plate3.toml") },
];

/// Problems on which other planners have been measured, and larger ones of the paper's kind.
const FURTHER: [BuiltIn; 6] = [
    BuiltIn { name: "two-tables", text: include_str!("../scenes/two-tables.toml") },
    BuiltIn { name: "two-tables-cups", text: include_str!("../scenes/two-tables-cups.toml") },
    BuiltIn { name: "sloping-rim-plate", text: include_str!("../scenes/sloping-rim-plate.toml") },
    BuiltIn { name: "plate-and-bowl", text: include_str!("../scenes/plate-and-bowl.toml") },
    BuiltIn { name: "plate-and-two-bowls", text: include_str!("../scenes/plate-and-two-bowls.toml") },
    BuiltIn { name: "bowl-in-the-way", text: include_str!("../scenes/bowl-in-the-way.toml") },
];

/// Small problems of a household, each with one thing that a planner may get wrong.
const EVERYDAY: [BuiltIn; 13] = [
    BuiltIn { name: "mug-beside", text: include_str!("../scenes/everyday/mug-beside.toml") },
    BuiltIn { name: "bottle-behind-cups", text: include_str!("../scenes/everyday/bottle-behind-cups.toml") },
    BuiltIn { name: "three-mugs", text: include_str!("../scenes/everyday/three-mugs.toml") },
    BuiltIn { name: "mug-to-shelf", text: include_str!("../scenes/everyday/mug-to-shelf.toml") },
    BuiltIn { name: "box-beside-others", text: include_str!("../scenes/everyday/box-beside-others.toml") },
    BuiltIn { name: "plate-over-seam", text: include_str!("../scenes/everyday/plate-over-seam.toml") },
    BuiltIn { name: "l-shaped-table", text: include_str!("../scenes/everyday/l-shaped-table.toml") },
    BuiltIn { name: "plate-under-shelf", text: include_str!("../scenes/everyday/plate-under-shelf.toml") },
    BuiltIn { name: "door-74-cm", text: include_str!("../scenes/everyday/door-74-cm.toml") },
    BuiltIn { name: "door-70-cm", text: include_str!("../scenes/everyday/door-70-cm.toml") },
    BuiltIn { name: "bowl-upright", text: include_str!("../scenes/everyday/bowl-upright.toml") },
    BuiltIn { name: "goal-near-edge", text: include_str!("../scenes/everyday/goal-near-edge.toml") },
    BuiltIn { name: "low-plank", text: include_str!("../scenes/everyday/low-plank.toml") },
];

/// Everyday problems without a plan, for which the answer says why.
const HOPELESS: [BuiltIn; 2] = [
    BuiltIn { name: "heavy-plate", text: include_str!("../scenes/everyday/heavy-plate.toml") },
    BuiltIn { name: "slippery-fingers", text: include_str!("../scenes/everyday/slippery-fingers.toml") },
];

/// For arms of fewer joints than six, each for the robot that it names.
const FEWER_JOINTS: [BuiltIn; 1] = [BuiltIn { name: "puck", text: include_str!("../scenes/puck.toml") }];

/// For robots with two arms, each for the robot that it names.
const TWO_ARMS: [BuiltIn; 1] = [BuiltIn { name: "hand-over", text: include_str!("../scenes/hand-over.toml") }];

/// All of them; the paper's first.
pub fn collection() -> Collection {
    Collection::new([
        ProblemGroup { title: "The paper's problems", problems: &PAPER },
        ProblemGroup { title: "Two tables, several objects", problems: &FURTHER },
        ProblemGroup { title: "Everyday problems, each with one thing that is easy to get wrong", problems: &EVERYDAY },
        ProblemGroup { title: "Without a plan, and the answer says why", problems: &HOPELESS },
        ProblemGroup { title: "For an arm with few joints", problems: &FEWER_JOINTS },
        ProblemGroup { title: "For a robot with two arms", problems: &TWO_ARMS },
    ])
}

/// The embedded problem called `name`, in any case and also in the paper's spelling, such as `Plate3 (No Place)`.
///
/// # Errors
/// [`ProblemFileError::UnknownProblem`] with all names and the nearest one.
pub fn builtin(name: &str) -> Result<ProblemFile, ProblemFileError> {
    collection().read(name)
}

/// The text of the embedded problem called `name`, for a person who wants a copy to edit.
///
/// # Errors
/// As [`builtin`].
pub fn builtin_text(name: &str) -> Result<&'static str, ProblemFileError> {
    let collection = collection();
    collection.find(name).map(|problem| problem.text).ok_or_else(|| collection.unknown(name))
}

/// The names of the paper's problems, from easy to hard.
pub fn builtin_names() -> [&'static str; 6] {
    PAPER.map(|problem| problem.name)
}

/// The names of the embedded problems that are not the paper's, from easy to hard.
pub fn further_names() -> [&'static str; 6] {
    FURTHER.map(|problem| problem.name)
}

/// The names of the embedded everyday problems.
pub fn everyday_names() -> [&'static str; 13] {
    EVERYDAY.map(|problem| problem.name)
}

/// The names of the embedded problems that have no plan.
pub fn hopeless_names() -> [&'static str; 2] {
    HOPELESS.map(|problem| problem.name)
}

#[cfg(test)]
mod tests;

//! The robots that come with the program: small ones, written for it, each a description and a robot file.

use crate::problem_file::suggest::{nearest, shown};
use crate::robot_file::RobotFileError;

/// A robot inside the program.
#[derive(Debug, Clone, Copy)]
pub struct Shipped {
    /// Its name, for `model` in problem files.
    pub name: &'static str,
    /// Its robot file.
    pub text: &'static str,
    /// Its description.
    pub urdf: &'static str,
}

macro_rules! shipped {
    ($name:literal) => {
        Shipped {
            name: $name,
            text: include_str!(concat!("../../robots/", $name, "/", $name, ".toml")),
            urdf: include_str!(concat!("../../robots/", $name, "/", $name, ".urdf")),
        }
    };
}

const ALL: [Shipped; 5] =
    [shipped!("mobile-arm"), shipped!("panda-arm"), shipped!("planar-arm"), shipped!("table-arm"), shipped!("two-arm")];

/// All of them.
pub fn all() -> &'static [Shipped] {
    &ALL
}

/// The robot of this name.
///
/// # Errors
/// [`RobotFileError::UnknownRobot`] with the nearest name.
pub fn find(name: &str) -> Result<&'static Shipped, RobotFileError> {
    let unknown = || RobotFileError::UnknownRobot {
        name: shown(name),
        nearest: nearest(name, ALL.iter().map(|robot| robot.name)).map(str::to_owned),
        available: ALL.iter().map(|robot| robot.name.to_owned()).collect(),
    };
    ALL.iter().find(|robot| robot.name == name).ok_or_else(unknown)
}

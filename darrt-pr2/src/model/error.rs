//! What can be wrong with a robot.

use std::path::PathBuf;

use darrt_primitives::kinematics::UrdfError;

/// Why a robot, or a part of it, could not be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The description is not sound.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// The description in a file is sound, but no PR2.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with the robot.
        source: Box<ModelError>,
    },
    /// A joint the PR2 has is missing (or cannot move).
    #[error("the description has no movable joint {name:?}; a PR2 has one")]
    MissingJoint {
        /// The joint.
        name: String,
    },
    /// A link the PR2 has is missing.
    #[error("the description has no link {name:?}; a PR2 has one")]
    MissingLink {
        /// The link.
        name: String,
    },
    /// An arm has other dimensions than the PR2's.
    #[error(
        "link {link:?} stands {distance} m and {angle} rad from where the PR2's dimensions put it; at most {bound} is \
         accepted, because the inverse kinematics has these dimensions built in"
    )]
    OtherKinematics {
        /// The first link that differs.
        link: String,
        /// Distance, m.
        distance: f64,
        /// Angle, rad.
        angle: f64,
        /// Largest accepted value of either.
        bound: f64,
    },
    /// A joint of an arm starts outside its limits.
    #[error(
        "joint `{joint}` starts at {value} rad, outside its {which} limits [{lower}, {upper}]{}",
        if *would_do_hard { "; `limits = \"hard\"` in `[robot]` allows it" } else { "" }
    )]
    StartOutside {
        /// The joint.
        joint: String,
        /// Where it starts, rad.
        value: f64,
        /// `soft` or `hard`.
        which: &'static str,
        /// Lower limit, rad.
        lower: f64,
        /// Upper limit, rad.
        upper: f64,
        /// Whether it is inside the hard limits, so that the problem only has to ask for those.
        would_do_hard: bool,
    },
    /// The torso height is out of range.
    #[error("torso height {value} m is outside [{lower}, {upper}] m")]
    Torso {
        /// The height asked for.
        value: f64,
        /// Lowest.
        lower: f64,
        /// Highest.
        upper: f64,
    },
}

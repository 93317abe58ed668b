//! A picture of a problem or a plan: one self-contained SVG file, also for papers.
//!
//! It shows the room from above and from two sides, a close-up of the surface where the object starts, and for a plan
//! the object's way and the robot at the end of each step, coloured by primitive as in the paper's figures 5 and 6, and
//! one small view per step.
//!
//! | question | file |
//! |---|---|
//! | what is told? | [`story`], [`act`], [`model`] |
//! | how far does what move in a step? | [`travel`] |
//! | how is a long plan told shortly? | `abridged` |
//! | where on the page is a point of the world? | `view` |
//! | what is the silhouette of a solid? | `outline` |
//! | how are the room, the robot, the ways drawn? | `room`, `figure`, `journey` |
//! | what is on the page? | `page`, `overview`, `filmstrip` |
//! | how does a plan move in one SVG file? | `moving` |
//! | how does it become a PNG file? | [`raster`] |

mod abridged;
pub mod act;
mod badge;
mod figure;
mod filmstrip;
pub mod ink;
mod journey;
pub mod model;
mod moving;
mod outline;
mod overview;
mod page;
pub mod palette;
mod panel;
pub mod raster;
mod room;
pub mod story;
pub mod travel;
mod view;

use std::path::Path;

pub use act::Act;
pub use moving::animate;
pub use story::{Snapshot, Story, StoryStep};
pub use travel::Travel;

use crate::clock::ClockError;
use crate::plan_file::UnknownTool;
use crate::plan_file::joints::JointFlaw;
use crate::problem_file::ProblemFileError;
use crate::robot::RobotError;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The room or an object cannot be built.
    #[error(transparent)]
    Problem(#[from] ProblemFileError),
    /// The robot cannot be built.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The plan has no clock.
    #[error(transparent)]
    Clock(#[from] ClockError),
    /// A plan refers to something that is not there.
    #[error("`{place}` lacks the {what} `{name}`")]
    Missing {
        /// Path of the key in the plan file.
        place: String,
        /// Kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// A step names a tool that the robot does not have.
    #[error("`{place}`: {error}")]
    Tool {
        /// Path of the key in the plan file.
        place: String,
        /// What is wrong.
        error: Box<UnknownTool>,
    },
    /// The joints of a waypoint are not those of the robot.
    #[error("`{place}`: {flaw}")]
    Joints {
        /// Path of the key in the plan file.
        place: String,
        /// What is wrong.
        flaw: Box<JointFlaw>,
    },
    /// A number of a plan is too large to be drawn.
    #[error("`{place}`: {name} is {value:e}, at most {bound} can be drawn")]
    OutOfRange {
        /// Path of the key in the plan file.
        place: String,
        /// What the number is.
        name: String,
        /// The number.
        value: f64,
        /// Its largest size.
        bound: f64,
    },
    /// The picture cannot be turned into dots.
    #[error("the picture cannot be written as PNG: {reason}")]
    Raster {
        /// Why.
        reason: String,
    },
    /// The ending of the file names no format.
    #[error("{file}: a picture is an .html, .svg, .png or .glb file")]
    Format {
        /// The file.
        file: String,
    },
}

/// The kinds of picture file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// The picture as an SVG image.
    Svg,
    /// The same as a raster image.
    Png,
    /// The [viewer](crate::viewer)'s page, the picture inside.
    Html,
    /// The [viewer](crate::viewer)'s scene, moving, for other programs: binary glTF.
    Glb,
}

impl Format {
    /// The format that the ending of a file name asks for.
    ///
    /// # Errors
    /// [`PictureError::Format`] for any ending but `svg`, `png`, `html`, `htm` and `glb` (in any case).
    pub fn of_path(path: &Path) -> Result<Self, PictureError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            Some("html" | "htm") => Ok(Self::Html),
            Some("glb") => Ok(Self::Glb),
            _ => Err(PictureError::Format { file: path.display().to_string() }),
        }
    }
}

/// How much a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Extent {
    /// The large views, and a small one per step.
    #[default]
    Whole,
    /// The large views only.
    Overview,
}

/// The picture as an SVG file; the same story gives the same bytes. Of a long plan only some steps are drawn, which the
/// picture says.
pub fn draw(story: &Story, extent: Extent) -> String {
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n", page::draw(&story.abridged(), extent))
}

#[cfg(test)]
mod tests;

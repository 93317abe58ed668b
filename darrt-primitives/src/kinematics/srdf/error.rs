//! What can be wrong with a semantic description.

use std::path::PathBuf;

use darrt_geom::FileError;

use crate::kinematics::urdf::UrdfError;

/// Why a semantic description was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SrdfError {
    /// The file was not read.
    #[error(transparent)]
    File(FileError),
    /// The file was read, and its text refused.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with its text.
        source: Box<SrdfError>,
    },
    /// The text is too large, nested too deeply, or no XML that may be read: the same bounds as for a URDF.
    #[error(transparent)]
    Unsafe(#[from] UrdfError),
    /// The text is not well-formed.
    #[error("not a semantic description: {message}")]
    Syntax {
        /// What the reader said.
        message: String,
    },
    /// An attribute that is needed is missing or empty.
    #[error("line {line}: <{element}> has no `{attribute}`")]
    Missing {
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// Line of the text, from 1.
        line: u32,
    },
    /// A name does not resolve.
    #[error("line {line}: <{element}> names the {kind} {name:?}, which does not exist{}", suggestion(nearest.as_deref()))]
    Dangling {
        /// The element.
        element: String,
        /// `link`, `joint` or `group`.
        kind: &'static str,
        /// The name.
        name: String,
        /// A name that is like it.
        nearest: Option<String>,
        /// Line of the text, from 1.
        line: u32,
    },
    /// Two elements of one kind share a name.
    #[error("line {line}: <{element}> {name:?} has the name of another")]
    DuplicateName {
        /// The element.
        element: String,
        /// The name.
        name: String,
        /// Line of the text, from 1.
        line: u32,
    },
    /// A chain does not go from a link to one below it.
    #[error("line {line}: <chain>: link {base:?} is not above link {tip:?}")]
    NotAbove {
        /// Where it starts.
        base: String,
        /// Where it ends.
        tip: String,
        /// Line of the text, from 1.
        line: u32,
    },
    /// Groups name one another in a circle.
    #[error("line {line}: group {name:?} holds itself, directly or through others")]
    GroupCycle {
        /// A group of the circle.
        name: String,
        /// Line of the text, from 1.
        line: u32,
    },
    /// A word is none of those that may stand there.
    #[error("line {line}: <{element}>: `{attribute}` is {value:?}; it must be {bound}")]
    Value {
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// What stands there.
        value: String,
        /// What may.
        bound: String,
        /// Line of the text, from 1.
        line: u32,
    },
}

fn suggestion(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(", did you mean {name:?}?"))
}
